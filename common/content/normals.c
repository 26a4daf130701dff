/* normals.c - normals at twice the resolution of the geometry (LH04 section 6.3): the level's own and the coarser
 * level's on the same spot, as z_c stands beside z: one texture fetch a pixel instead of two.
 *
 * They come from the next finer level, whose samples are half as far apart, so from real data; below the finest level
 * from its heights upsampled with U. Levels of spacing g keep slopes times tc_normal_relief(g, relief). */
#include <math.h>

#include "common/base/simd.h"
#include "common/field/filter.h"
#include "beyond.h"
#include "ground.h"
#include "torus.h"

enum { MARGIN = 8 };

/* Fine heights, what they are upsampled from by way of rows, and a row of texels. */
static size_t scratch_bytes(int n)
{
    size_t fine = (size_t)(2 * n + MARGIN), coarse = (size_t)(n + MARGIN);
    return (fine * fine + 3 * coarse * fine + coarse * coarse) * sizeof(float);
}

/* Heights at twice the resolution around rect, for normals: first sample at (2 rect.x0 - 2, 2 rect.y0 - 2). */
static tc_status fine_heights(const tc_fill *f, float **z_ret, ptrdiff_t *stride_ret)
{
    const tc_field *field = tc_clipmap_field(f->clipmap);
    const tc_rect rect = f->rect;
    int level = tc_clipmap_field_level(f->clipmap, f->level), n = tc_clipmap_n(f->clipmap);
    tc_beyond straight = {.wraps = tc_clipmap_level(f->clipmap, f->level)->wraps, .straight = true};
    int64_t w = rect.x1 - rect.x0, h = rect.y1 - rect.y0;
    if (level < tc_field_info(field)->levels) {
        tc_rect fine = {2 * rect.x0 - 2, 2 * rect.y0 - 2, 2 * rect.x1 + 1, 2 * rect.y1 + 1};
        return tc_read_beyond(f, level + 1, fine, straight, f->scratch, z_ret, stride_ret);
    }
    size_t side = (size_t)(2 * n + MARGIN);
    float *fine = f->scratch, *rows = fine + side * side, *buffer = rows + side * (size_t)(n + MARGIN);
    tc_rect coarse = {rect.x0 - 2, rect.y0 - 2, rect.x1 + 3, rect.y1 + 3};
    float *z;
    ptrdiff_t stride;
    tc_status status = tc_read_beyond(f, level, coarse, straight, buffer, &z, &stride);
    if (status)
        return status;
    tc_upsample(z + stride + 1, stride, w + 2, h + 2, fine, rows);
    *z_ret = fine;
    *stride_ret = 2 * (w + 2);
    return TC_OK;
}

/* A normal's components with slopes times `by`. */
static void steepen(int16_t *nx, int16_t *ny, float by)
{
    float x = (float)*nx / 127, y = (float)*ny / 127, z2 = 1 - x * x - y * y;
    float scale = 127 * by / sqrtf((z2 > 1e-4f ? z2 : 1e-4f) + by * by * (x * x + y * y));
    *nx = (int16_t)lrintf(x * scale);
    *ny = (int16_t)lrintf(y * scale);
}

/* A row of normals, texels in a line: components next to each other, so that loops over them need no conditions. */
typedef struct normal_row {
    int16_t xy[2][2 * (TC_CLIPMAP_MAX_N + 1)];
} normal_row;

/* Sums of two toroidal rows of texels, from column x on. */
static void unwrap_sums(const int8_t (*r0)[4], const int8_t (*r1)[4], int64_t x, int64_t mask, int64_t count,
                        normal_row *sums)
{
    for (int64_t k = 0; k < count;) {
        int64_t at = (x + k) & mask, run = tc_min64(count - k, mask + 1 - at);
        for (int64_t i = 0; i < run; i++) {
            sums->xy[0][k + i] = (int16_t)(r0[at + i][0] + r1[at + i][0]);
            sums->xy[1][k + i] = (int16_t)(r0[at + i][1] + r1[at + i][1]);
        }
        k += run;
    }
}

static inline int16_t quarter(int sum)
{
    return (int16_t)((sum + (sum < 0 ? -2 : 2)) / 4);
}

/* The coarser level's normals below row b from texel a on, a odd: its texels are twice as far apart; what the bilinear
 * filter would give there. */
static void coarse_normals(const int8_t (*coarse)[4], float by, int64_t mask, int64_t a, int64_t b, int64_t count,
                           normal_row *out)
{
    const int8_t(*r0)[4] = coarse + (tc_floor_shift(b, 1) & mask) * (mask + 1);
    const int8_t(*r1)[4] = coarse + (tc_floor_shift(b + 1, 1) & mask) * (mask + 1);
    normal_row sums;
    unwrap_sums(r0, r1, tc_floor_shift(a, 1), mask, count / 2 + 2, &sums);
    for (int k = 0; k < 2; k++) {
        const int16_t *v = sums.xy[k];
        int16_t *to = out->xy[k];
        for (int64_t i = 0; i < count / 2; i++)
            to[2 * i] = quarter(v[i] + v[i + 1]), to[2 * i + 1] = quarter(2 * v[i + 1]);
        if (count % 2)
            to[count - 1] = quarter(v[count / 2] + v[count / 2 + 1]);
    }
    for (int64_t i = 0; i < count && by != 1; i++)
        steepen(&out->xy[0][i], &out->xy[1][i], by);
}

/* A level's own normals, by central differences of the heights c, rows `stride` apart. */
static void own_normals(const float *c, ptrdiff_t stride, float ix, float iy, int64_t count, normal_row *out)
{
    for (int64_t i = 0; i < count; i++) {
        float dx = (c[i + 1] - c[i - 1]) * ix, dy = (c[i + stride] - c[i - stride]) * iy;
        float scale = -127 / sqrtf(1 + dx * dx + dy * dy);
        out->xy[0][i] = (int16_t)(int)(dx * scale + (dx < 0 ? 0.5f : -0.5f));
        out->xy[1][i] = (int16_t)(int)(dy * scale + (dy < 0 ? 0.5f : -0.5f));
    }
}

/* A row of what normals are made of. */
typedef struct normal_source {
    const float *z; /* of its first texel, at twice the resolution */
    ptrdiff_t stride;
    float ix, iy;              /* of the slopes */
    const int8_t (*coarse)[4]; /* the coarser level's array; NULL: none */
    float steeper;             /* than the coarser level's normals */
    int64_t x, y;              /* the first texel */
    int64_t mask;              /* of the toroidal rows */
} normal_source;

static inline void make_normals(const normal_source *from, int64_t count, int8_t (*row)[4])
{
    normal_row own, coarse;
    own_normals(from->z, from->stride, from->ix, from->iy, count, &own);
    const normal_row *beside = &own;
    if (from->coarse) {
        beside = &coarse;
        coarse_normals(from->coarse, from->steeper, from->mask, from->x, from->y, count, &coarse);
    }
    for (int64_t i = 0; i < count; i++) {
        row[i][0] = (int8_t)own.xy[0][i], row[i][1] = (int8_t)own.xy[1][i];
        row[i][2] = (int8_t)beside->xy[0][i], row[i][3] = (int8_t)beside->xy[1][i];
    }
}

/* The same code, and bits, for processors with AVX2. */
TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void make_normals_avx2(const normal_source *from,
                                                                                int64_t count, int8_t (*row)[4])
{
    make_normals(from, count, row);
}

/* By how much a level's normals are steeper than the terrain. */
static double relief_of(const tc_fill *f, int level)
{
    const tc_clip_level *l = tc_clipmap_level(f->clipmap, level);
    return tc_normal_relief(sqrt(l->spacing_x * l->spacing_y), f->content->parameter);
}

/* Normals of the texels (2 rect.x0 - 1 .. 2 rect.x1 - 1), and so in y. */
static tc_status fill(const tc_fill *f)
{
    const tc_clip_level *l = tc_clipmap_level(f->clipmap, f->level);
    float *z;
    ptrdiff_t stride;
    tc_status status = fine_heights(f, &z, &stride);
    if (status)
        return status;
    int64_t mask = f->size - 1, w = 2 * (f->rect.x1 - f->rect.x0) + 1, h = 2 * (f->rect.y1 - f->rect.y0) + 1;
    int n = tc_clipmap_n(f->clipmap);
    int8_t(*row)[4] = (int8_t(*)[4])((char *)f->scratch + scratch_bytes(n)) - (2 * n + MARGIN);
    double relief = relief_of(f, f->level);
    const bool avx2 = tc_have_avx2();
    normal_source from = {.z = z + 1,
                          .stride = stride,
                          .ix = (float)(relief / l->spacing_x),
                          .iy = (float)(relief / l->spacing_y),
                          .coarse = f->coarse,
                          .steeper = 1,
                          .x = 2 * f->rect.x0 - 1,
                          .y = 2 * f->rect.y0 - 1,
                          .mask = mask};
    if (f->coarse)
        from.steeper = (float)(relief / relief_of(f, f->level - 1));
    for (int64_t j = 0; j < h; j++, from.y++) {
        from.z += stride;
        (avx2 ? make_normals_avx2 : make_normals)(&from, w, row);
        tc_torus_store((int8_t(*)[4])f->texels + (from.y & mask) * f->size, from.x, mask, row, w, sizeof *row);
    }
    return TC_OK;
}

const tc_content_class tc_normals_content = {.name = "normals",
                                             .format = TC_TEXEL_RGBA8_SNORM,
                                             .scale = 2,
                                             .border = 1,
                                             .reach = 3,
                                             .reach_finer = 6,
                                             .scratch_bytes = scratch_bytes,
                                             .fill = fill};
