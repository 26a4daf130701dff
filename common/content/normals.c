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

/* A row of what normals are made of. */
typedef struct normal_source {
    const float *z; /* of its first texel, at twice the resolution */
    ptrdiff_t stride;
    float ix, iy;       /* of the slopes */
    const void *coarse; /* the coarser level's array; NULL: none */
    float steeper;      /* than the coarser level's normals */
    int64_t x, y;       /* the first texel */
    int64_t mask;       /* of the toroidal rows */
    const float *turn;  /* of its texels (tc_shear); NULL: none */
} normal_source;

#define TEXEL int8_t
#define ONE 127
#define SUM int16_t
#define NAME(name) name
#include "normal_rows.h"

#define TEXEL int16_t
#define ONE 32767
#define SUM int32_t
#define NAME(name) fine_##name
#include "normal_rows.h"

/* The same code, and bits, for processors with AVX2. */
#define ROW_MAKER(name, target, of)                                                                                    \
    target __attribute__((flatten, noinline)) static void name(const normal_source *from, int64_t count, void *row)    \
    {                                                                                                                  \
        of(from, count, row);                                                                                          \
    }
ROW_MAKER(make, , make_normals)
ROW_MAKER(make_avx2, TC_TARGET_AVX2, make_normals)
ROW_MAKER(make_fine, , fine_make_normals)
ROW_MAKER(make_fine_avx2, TC_TARGET_AVX2, fine_make_normals)

/* Shares of a row of texels, of a level of so many cells a side. */
static void turns_of(const tc_shear *shear, const normal_source *from, int64_t cells, int64_t count, float *turn)
{
    const double scale = 0.5 / (double)cells, y = (double)from->y * scale;
    for (int64_t i = 0; i < count; i++)
        turn[i] = (float)shear->turn((double)(from->x + i) * scale, y);
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
    const bool fine = f->content->class == &tc_fine_normals_content, avx2 = tc_have_avx2();
    const size_t texel = tc_texel_bytes(f->content->class->format);
    char *row = (char *)f->scratch + scratch_bytes(n) - (size_t)(2 * n + MARGIN) * texel;
    double relief = relief_of(f, f->level);
    void (*const make_row)(const normal_source *, int64_t, void *) = fine   ? avx2 ? make_fine_avx2 : make_fine
                                                                     : avx2 ? make_avx2
                                                                            : make;
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
    const tc_shear *shear = f->content->context;
    const tc_level size = tc_field_level(tc_clipmap_field(f->clipmap), tc_clipmap_field_level(f->clipmap, f->level));
    float turn[2 * (TC_CLIPMAP_MAX_N + 1)];
    from.turn = shear ? turn : NULL;
    for (int64_t j = 0; j < h; j++, from.y++) {
        from.z += stride;
        if (shear)
            turns_of(shear, &from, size.width - 1, w, turn);
        make_row(&from, w, row);
        tc_torus_store((char *)f->texels + (size_t)((from.y & mask) * f->size) * texel, from.x, mask, row, w, texel);
    }
    return TC_OK;
}

#define NORMALS(title, texels)                                                                                         \
    {                                                                                                                  \
        .name = title, .format = texels, .scale = 2, .border = 1, .reach = 3, .reach_finer = 6,                        \
        .scratch_bytes = scratch_bytes, .fill = fill                                                                   \
    }
const tc_content_class tc_normals_content = NORMALS("normals", TC_TEXEL_RGBA8_SNORM);
const tc_content_class tc_fine_normals_content = NORMALS("fine normals", TC_TEXEL_RGBA16_SNORM);
