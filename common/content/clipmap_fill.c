/* clipmap_fill.c - what a clipmap window contains: heights, morph targets, normals, voids.
 *
 * z_c is the height of the coarser level's MESH below a fine vertex (LH04 section 6.2): that of the coarse vertex where
 * there is one on the spot, copied bit for bit, else that of the middle of a coarse edge. Where the terrain ends
 * between two coarse samples the last cells are narrower than the others, so weights come from positions.
 *
 * Normals come from the next finer level, whose samples are half as far apart: twice the resolution of the geometry
 * (LH04 section 6.3), of real data; below the finest level from its heights upsampled with U. The coarser level's
 * normal stands beside each, as z_c beside z: one texture fetch a pixel instead of two. */
#include <math.h>
#include <string.h>

#include "common/window/clipmap_internal.h"
#include "common/field/filter.h"
#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "common/base/simd.h"

enum { MARGIN = 8 };

size_t tc_fill_scratch(int n, bool normals)
{
    size_t fine = (size_t)(2 * n + MARGIN), coarse = (size_t)(n + MARGIN);
    if (!normals) /* heights, voids, a row of pairs */
        return 2 * coarse * coarse + 2 * coarse;
    return fine * fine + 3 * coarse * fine + coarse * coarse;
}

/* How heights go on beyond the level's last samples. */
typedef struct beyond {
    bool wraps;    /* in x */
    bool straight; /* in a straight line; else all on the terrain's edge: */
    float x, y;    /* the edge lies this far beyond the last sample, 0 <= x < 1 */
} beyond;

/* Steps of the slope between the last two samples to add at sample i of `size`; 0 inside. */
static inline float steps_beyond(int64_t i, int64_t size, bool straight, float edge)
{
    return i < 0 ? (float)-i : i < size ? 0 : straight ? (float)(i - size + 1) : edge;
}

static inline int64_t border(int64_t i, int64_t size)
{
    return i < 0 ? 0 : i < size ? i : size - 1;
}

/* The inner neighbour that gives the slope at border sample b. */
static inline int64_t inner(int64_t b, int64_t size)
{
    return size < 2 ? b : b == 0 ? 1 : b == size - 1 ? size - 2 : b;
}

/* Reads rect, which may go beyond the level, into buffer; *z_ret points at its first sample, rows are *stride_ret
 * apart. buffer: (width + 2) * (height + 2) floats. voids: the same layout, or NULL. */
static tc_status read_beyond(const tc_field *field, int level, tc_rect rect, beyond how, float *buffer, uint8_t *voids,
                             float **z_ret, ptrdiff_t *stride_ret)
{
    tc_level size = tc_field_level(field, level);
    int64_t w = size.width, h = size.height;
    /* The part that exists, and what its continuation needs. */
    tc_rect part = {border(rect.x0, w), border(rect.y0, h), border(rect.x1 - 1, w) + 1, border(rect.y1 - 1, h) + 1};
    if (how.wraps)
        part.x0 = rect.x0, part.x1 = rect.x1;
    else if (rect.x0 < 0)
        part.x1 = tc_max64(part.x1, tc_min64(2, w));
    if (rect.y0 < 0)
        part.y1 = tc_max64(part.y1, tc_min64(2, h));
    if (rect.x1 > w && !how.wraps)
        part.x0 = tc_min64(part.x0, tc_max64(w - 2, 0));
    if (rect.y1 > h)
        part.y0 = tc_min64(part.y0, tc_max64(h - 2, 0));
    /* The buffer spans both. */
    int64_t x0 = tc_min64(rect.x0, part.x0), x1 = tc_max64(rect.x1, part.x1), y0 = tc_min64(rect.y0, part.y0);
    ptrdiff_t stride = x1 - x0;
    ptrdiff_t start = (part.y0 - y0) * stride + part.x0 - x0;
    tc_status status = tc_field_read(field, level, part, buffer + start, voids ? voids + start : NULL, stride);
    if (status)
        return status;
    for (int64_t j = part.y0; j < part.y1; j++) {
        ptrdiff_t row = (j - y0) * stride - x0; /* sample (i, j) is at row + i */
        for (int64_t i = rect.x0; i < rect.x1 && !how.wraps; i++) {
            float steps = steps_beyond(i, w, how.straight, how.x);
            int64_t b = border(i, w);
            if (i != b) {
                buffer[row + i] = buffer[row + b] + steps * (buffer[row + b] - buffer[row + inner(b, w)]);
                if (voids)
                    voids[row + i] = voids[row + b];
            } else if (i < w - 1) {
                i = tc_max64(i, tc_min64(rect.x1, w) - 1); /* on to the other side */
            }
        }
    }
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        int64_t b = border(j, h);
        if (j == b)
            continue;
        float steps = steps_beyond(j, h, how.straight, how.y);
        ptrdiff_t row = (j - y0) * stride - x0, r0 = (b - y0) * stride - x0, r1 = (inner(b, h) - y0) * stride - x0;
        for (int64_t i = rect.x0; i < rect.x1; i++)
            buffer[row + i] = buffer[r0 + i] + steps * (buffer[r0 + i] - buffer[r1 + i]);
        if (voids)
            memcpy(voids + row + rect.x0, voids + r0 + rect.x0, (size_t)(rect.x1 - rect.x0));
    }
    *z_ret = buffer + (rect.y0 - y0) * stride + rect.x0 - x0;
    *stride_ret = stride;
    return TC_OK;
}

/* Copies `count` elements of `size` bytes to toroidal columns x, x + 1, ... of a row with mask + 1 columns. */
static void store_row(void *row, int64_t x, int64_t mask, const void *from, int64_t count, size_t size)
{
    while (count > 0) {
        int64_t at = x & mask, run = tc_min64(count, mask + 1 - at);
        memcpy((char *)row + (size_t)at * size, from, (size_t)run * size);
        from = (const char *)from + (size_t)run * size;
        x += run;
        count -= run;
    }
}

/* Place of fine vertex i between its coarse neighbours a and b: 0 .. 1, exact. */
typedef struct between {
    int64_t a, b;
    float t;
} between;

static between coarse_neighbours(int64_t i, int shift, int64_t edge)
{
    if ((i & 1) == 0)
        return (between){i / 2, i / 2, 0};
    int64_t g = (int64_t)1 << shift;
    int64_t pa = tc_min64((i - 1) * g, edge), p = tc_min64(i * g, edge), pb = tc_min64((i + 1) * g, edge);
    return (between){(i - 1) / 2, (i + 1) / 2, pb > pa ? (float)(p - pa) / (float)(pb - pa) : 0.0f};
}

/* z_c of fine vertex (i, j), wherever it lies. */
static float morph_target(between u, between v, const float (*c0)[2], const float (*c1)[2], int64_t mask)
{
    int64_t a = u.a & mask, b = u.b & mask;
    if (u.t == 0 && v.t == 0)
        return c0[a][0];
    if (u.t == 0.5f && v.t == 0) /* the common cases, without the general one's rounding */
        return 0.5f * (c0[a][0] + c0[b][0]);
    if (u.t == 0 && v.t == 0.5f)
        return 0.5f * (c0[a][0] + c1[a][0]);
    if (u.t == 0.5f && v.t == 0.5f)
        return 0.5f * (c0[b][0] + c1[a][0]);
    return (float)tc_triangle_height(c0[a][0], c0[b][0], c1[a][0], c1[b][0], u.t, v.t);
}

/* `count` heights of a toroidal row from column x on, one after the other. */
static void unwrap(const float (*row)[2], int64_t x, int64_t mask, int64_t count, float *z)
{
    for (int64_t k = 0; k < count;) {
        int64_t at = (x + k) & mask, run = tc_min64(count - k, mask + 1 - at);
        for (int64_t i = 0; i < run; i++)
            z[k + i] = row[at + i][0];
        k += run;
    }
}

/* z_c of vertices x0, x0 + 1, ..., both x0 and count even, in cells that are all as wide; v is on a coarse sample or in
 * the middle between two. In loops without conditions, unlike morph_target(), whose values these are. */
static void even_targets(between v, const float (*c0)[2], const float (*c1)[2], int64_t mask, int64_t x0, int64_t count,
                         float (*row)[2])
{
    float z0[TC_CLIPMAP_MAX_N / 2 + 2], z1[TC_CLIPMAP_MAX_N / 2 + 2];
    unwrap(c0, x0 / 2, mask, count / 2 + 1, z0);
    if (v.t == 0) {
        for (int64_t k = 0; k < count / 2; k++)
            row[2 * k][1] = z0[k], row[2 * k + 1][1] = 0.5f * (z0[k] + z0[k + 1]);
    } else {
        unwrap(c1, x0 / 2, mask, count / 2 + 1, z1);
        for (int64_t k = 0; k < count / 2; k++)
            row[2 * k][1] = 0.5f * (z0[k] + z1[k]), row[2 * k + 1][1] = 0.5f * (z0[k + 1] + z1[k]);
    }
}

/* z_c of row j for columns x0 .. x1 - 1 into row[..][1]. */
static void morph_targets(const tc_clip_state *s, const tc_clip_state *coarse, int64_t mask, int64_t j, int64_t x0,
                          int64_t x1, float (*row)[2])
{
    between v = coarse_neighbours(j, s->view.shift, s->view.edge_y);
    const float(*c0)[2] = coarse->heights + (v.a & mask) * (mask + 1);
    const float(*c1)[2] = coarse->heights + (v.b & mask) * (mask + 1);
    int64_t first = x0 + (x0 & 1); /* to `even`, both even, cells are whole */
    int64_t even = tc_min64(x1, tc_floor_shift(s->view.edge_x, s->view.shift)) & ~(int64_t)1;
    if (even <= first || (v.t != 0 && v.t != 0.5f))
        first = even = x0; /* none */
    for (int64_t i = x0; i < first; i++)
        row[i - x0][1] = morph_target(coarse_neighbours(i, s->view.shift, s->view.edge_x), v, c0, c1, mask);
    if (even > first)
        even_targets(v, c0, c1, mask, first, even - first, row + (first - x0));
    for (int64_t i = even; i < x1; i++)
        row[i - x0][1] = morph_target(coarse_neighbours(i, s->view.shift, s->view.edge_x), v, c0, c1, mask);
}

/* Heights at twice the resolution around rect, for normals: first sample at (2 rect.x0 - 2, 2 rect.y0 - 2). */
static tc_status fine_heights(const tc_clipmap *clipmap, const tc_clip_state *s, tc_rect rect, float **z_ret,
                              ptrdiff_t *stride_ret)
{
    const tc_field *field = clipmap->field;
    beyond straight = {.wraps = s->wraps, .straight = true};
    int64_t w = rect.x1 - rect.x0, h = rect.y1 - rect.y0;
    if (s->field_level < tc_field_info(field)->levels) {
        tc_rect fine = {2 * rect.x0 - 2, 2 * rect.y0 - 2, 2 * rect.x1 + 1, 2 * rect.y1 + 1};
        return read_beyond(field, s->field_level + 1, fine, straight, clipmap->scratch, NULL, z_ret, stride_ret);
    }
    size_t side = (size_t)(2 * clipmap->n + MARGIN);
    float *fine = clipmap->scratch, *rows = fine + side * side, *buffer = rows + side * (size_t)(clipmap->n + MARGIN);
    tc_rect coarse = {rect.x0 - 2, rect.y0 - 2, rect.x1 + 3, rect.y1 + 3};
    float *z;
    ptrdiff_t stride;
    tc_status status = read_beyond(field, s->field_level, coarse, straight, buffer, NULL, &z, &stride);
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
static void coarse_normals(const tc_clip_state *coarse, float by, int64_t mask, int64_t a, int64_t b, int64_t count,
                           normal_row *out)
{
    const int8_t(*r0)[4] = coarse->normals + (tc_floor_shift(b, 1) & mask) * (mask + 1);
    const int8_t(*r1)[4] = coarse->normals + (tc_floor_shift(b + 1, 1) & mask) * (mask + 1);
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
    float ix, iy;                /* of the slopes */
    const tc_clip_state *coarse; /* NULL: none */
    float steeper;               /* than the coarser level's normals */
    int64_t x, y;                /* the first texel */
    int64_t mask;                /* of the toroidal rows */
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

/* Normals of the texels (2 rect.x0 - 1 .. 2 rect.x1 - 1), and so in y. */
static tc_status fill_normals(const tc_clipmap *clipmap, int level, tc_rect rect)
{
    const tc_clip_state *s = &clipmap->level[level - 1];
    float *z;
    ptrdiff_t stride;
    tc_status status = fine_heights(clipmap, s, rect, &z, &stride);
    if (status)
        return status;
    int64_t mask = 2 * (clipmap->n + 1) - 1, w = 2 * (rect.x1 - rect.x0) + 1, h = 2 * (rect.y1 - rect.y0) + 1;
    int8_t(*row)[4] = (int8_t(*)[4])(clipmap->scratch + tc_fill_scratch(clipmap->n, true)) - (2 * clipmap->n + MARGIN);
    const bool avx2 = tc_have_avx2();
    normal_source from = {.z = z + 1,
                          .stride = stride,
                          .ix = (float)(s->relief / s->view.spacing_x),
                          .iy = (float)(s->relief / s->view.spacing_y),
                          .coarse = level > 1 ? s - 1 : NULL,
                          .steeper = level > 1 ? (float)(s->relief / s[-1].relief) : 1,
                          .x = 2 * rect.x0 - 1,
                          .y = 2 * rect.y0 - 1,
                          .mask = mask};
    for (int64_t j = 0; j < h; j++, from.y++) {
        from.z += stride;
        (avx2 ? make_normals_avx2 : make_normals)(&from, w, row);
        store_row(s->normals + (from.y & mask) * (mask + 1), from.x, mask, row, w, sizeof *row);
    }
    return TC_OK;
}

static tc_status fill_heights(const tc_clipmap *clipmap, int level, tc_rect rect)
{
    tc_clip_state *s = (tc_clip_state *)&clipmap->level[level - 1];
    const tc_clip_state *coarse = level > 1 ? s - 1 : NULL;
    int64_t mask = clipmap->n, g = (int64_t)1 << s->view.shift;
    beyond edge = {s->wraps, false, (float)((double)s->view.edge_x / (double)g - (double)(s->width - 1)),
                   (float)((double)s->view.edge_y / (double)g - (double)(s->height - 1))};
    size_t side = (size_t)(clipmap->n + MARGIN);
    float *buffer = clipmap->scratch;
    uint8_t *voids = s->voids ? (uint8_t *)(buffer + side * side) : NULL;
    float(*row)[2] = (float(*)[2])(buffer + 2 * side * side);
    float *z;
    ptrdiff_t stride;
    tc_status status = read_beyond(clipmap->field, s->field_level, rect, edge, buffer, voids, &z, &stride);
    if (status)
        return status;
    int64_t w = rect.x1 - rect.x0;
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        const float *in = z + (j - rect.y0) * stride;
        for (int64_t i = 0; i < w; i++)
            row[i][0] = row[i][1] = in[i];
        if (coarse)
            morph_targets(s, coarse, mask, j, rect.x0, rect.x1, row);
        store_row(s->heights + (j & mask) * (mask + 1), rect.x0, mask, row, w, sizeof *row);
        if (voids) {
            uint8_t *v = voids + (in - buffer);
            for (int64_t i = 0; i < w; i++)
                v[i] = v[i] ? 255 : 0;
            store_row(s->voids + (j & mask) * (mask + 1), rect.x0, mask, v, w, 1);
        }
    }
    return TC_OK;
}

static void note_change(tc_clip_state *s, tc_rect rect, int n)
{
    if (s->change_count == TC_MAX_CHANGES) { /* too many to tell apart: the whole array */
        s->changes[0] = (tc_rect){0, 0, n + 1, n + 1};
        s->change_count = 1;
        return;
    }
    s->changes[s->change_count++] = rect;
}

void tc_clipmap_fill(tc_clipmap *clipmap, int level, tc_rect rect)
{
    if (tc_rect_empty(rect))
        return;
    tc_clip_state *s = &clipmap->level[level - 1];
    if (fill_heights(clipmap, level, rect) || (s->normals && fill_normals(clipmap, level, rect)))
        clipmap->failed = true;
    else
        note_change(s, rect, clipmap->n);
}
