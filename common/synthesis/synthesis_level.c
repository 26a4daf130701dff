/* synthesis_level.c - one level of synthesised heights from the coarser one.
 *
 * The inverse lifting (filter.c has the forward one, with the same border rule) gives four fine samples of each cell:
 * of its heights and its three details. U of the heights alone lies beneath, so that what is beyond it can be bounded.
 */
#include "synthesis_level.h"

#include <string.h>

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "common/field/filter.h"
#include "synthesis_detail.h"

tc_rect tc_synthesis_needs(tc_rect fine, int reach)
{
    return (tc_rect){tc_floor_shift(fine.x0, 1) - reach, tc_floor_shift(fine.y0, 1) - reach,
                     tc_floor_shift(fine.x1 - 1, 1) + 1 + reach, tc_floor_shift(fine.y1 - 1, 1) + 1 + reach};
}

void tc_extend_beyond(const tc_patch *p, int64_t width, int64_t height, bool wraps)
{
    int64_t x0 = wraps ? p->rect.x0 : tc_max64(p->rect.x0, 0), x1 = wraps ? p->rect.x1 : tc_min64(p->rect.x1, width);
    int64_t y0 = tc_max64(p->rect.y0, 0), y1 = tc_min64(p->rect.y1, height);
    for (int64_t j = y0; j < y1; j++) {
        const float *first = tc_patch_at(p, x0, j), *last = tc_patch_at(p, x1 - 1, j);
        float before = width > 1 ? first[1] - first[0] : 0, behind = width > 1 ? last[0] - last[-1] : 0;
        for (int64_t i = p->rect.x0; i < x0; i++)
            *tc_patch_at(p, i, j) = first[0] - (float)(x0 - i) * before;
        for (int64_t i = x1; i < p->rect.x1; i++)
            *tc_patch_at(p, i, j) = last[0] + (float)(i - x1 + 1) * behind;
    }
    int64_t w = p->rect.x1 - p->rect.x0, step = height > 1 ? p->stride : 0;
    for (int64_t j = p->rect.y0; j < p->rect.y1; j++) {
        if (j >= y0 && j < y1)
            continue;
        const float *edge = tc_patch_at(p, p->rect.x0, j < y0 ? y0 : y1 - 1), *inner = edge + (j < y0 ? step : -step);
        float times = (float)(j < y0 ? y0 - j : j - y1 + 1), *row = tc_patch_at(p, p->rect.x0, j);
        for (int64_t i = 0; i < w; i++)
            row[i] = edge[i] + times * (edge[i] - inner[i]);
    }
}

/* ---- What is flat ------------------------------------------------------------------------------------------------ */

/* flat[.]: 1 where the sample or a neighbour is the middle of 3 x 3 equal ones. Over rect, of which coarse has two more
 * samples to all sides. work: as large as coarse. Whether any is. */
static bool find_flats(const tc_patch *coarse, tc_rect rect, uint8_t *flat, uint8_t *work)
{
    tc_rect middle = {rect.x0 - 1, rect.y0 - 1, rect.x1 + 1, rect.y1 + 1};
    int64_t w = middle.x1 - middle.x0, n = rect.x1 - rect.x0;
    ptrdiff_t s = coarse->stride;
    uint8_t any = 0;
    for (int64_t j = middle.y0; j < middle.y1; j++) {
        const float *restrict z = tc_patch_at(coarse, middle.x0, j);
        uint8_t *restrict out = work + (j - middle.y0) * w;
        for (int64_t i = 0; i < w; i++) {
            float c = z[i];
            out[i] = (z[i - 1] == c) & (z[i + 1] == c) & (z[i - s] == c) & (z[i + s] == c) & (z[i - s - 1] == c) &
                     (z[i - s + 1] == c) & (z[i + s - 1] == c) & (z[i + s + 1] == c);
        }
        for (int64_t i = 0; i < w; i++)
            any |= out[i];
    }
    if (!any)
        return false;
    for (int64_t j = 0; j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < n; i++) {
            const uint8_t *c = work + (j + 1) * w + i + 1;
            flat[j * n + i] = c[0] | c[-1] | c[1] | c[-w] | c[w] | c[-w - 1] | c[-w + 1] | c[w - 1] | c[w + 1];
        }
    return true;
}

/* ---- Inverse lifting --------------------------------------------------------------------------------------------- */

/* Evens of rows: low less what the details around would add. d: of the same row; step: between rows. */
static inline void even_row(const float *restrict low, const float *restrict d, ptrdiff_t step, int64_t count,
                            float *restrict even)
{
    for (int64_t i = 0; i < count; i++)
        even[i] = low[i] - (TC_UPDATE_NEAR * (d[i - step] + d[i]) + TC_UPDATE_FAR * (d[i - 2 * step] + d[i + step]));
}

static inline void odd_row(const float *restrict even, ptrdiff_t step, const float *restrict d, int64_t count,
                           float *restrict odd)
{
    for (int64_t i = 0; i < count; i++)
        odd[i] = d[i] + tc_predict(even[i - step], even[i], even[i + step], even[i + 2 * step]);
}

/* Rows 2 j0 .. 2 j1 - 1 of what was low and high along y, from evens j0 - 1 .. j1 + 1. low: row j0 - 1 on; detail: row
 * j0 - 1, with two before and one behind. even: j1 - j0 + 3 rows; out: 2 (j1 - j0) rows. All of one stride but low. */
static inline void invert_y(const float *low, ptrdiff_t low_stride, const float *detail, ptrdiff_t stride, int64_t j0,
                            int64_t j1, int64_t height, int64_t count, float *even, float *out)
{
    int64_t first = tc_max64(j0 - 1, 0), end = tc_min64(j1 + 2, height);
    for (int64_t j = first; j < end; j++) {
        int64_t k = j - (j0 - 1);
        even_row(low + k * low_stride, detail + k * stride, stride, count, even + k * stride);
    }
    tc_extend_beyond(&(tc_patch){even, stride, {0, j0 - 1, count, j1 + 2}}, count, height, true);
    for (int64_t j = j0; j < j1; j++) {
        const float *e = even + (j - j0 + 1) * stride;
        memcpy(out + 2 * (j - j0) * stride, e, (size_t)count * sizeof *out);
        odd_row(e, stride, detail + (j - j0 + 1) * stride, count, out + (2 * (j - j0) + 1) * stride);
    }
}

/* The same along a row. low: from i0 - 1 on; detail: from i0 - 1 on, with two before and one behind. fine: 2 (i1 - i0).
 */
static inline void invert_x(const float *low, const float *detail, int64_t i0, int64_t i1, int64_t width, bool wraps,
                            float *restrict even, float *restrict odd, float *restrict fine)
{
    int64_t first = wraps ? i0 - 1 : tc_max64(i0 - 1, 0), end = wraps ? i1 + 2 : tc_min64(i1 + 2, width);
    int64_t at = i0 - 1;
    even_row(low + (first - at), detail + (first - at), 1, end - first, even + (first - at));
    tc_extend_beyond(&(tc_patch){even, 0, {at, 0, i1 + 2, 1}}, width, 1, wraps);
    odd_row(even + 1, 1, detail + 1, i1 - i0, odd);
    for (int64_t i = 0; i < i1 - i0; i++)
        fine[2 * i] = even[i + 1], fine[2 * i + 1] = odd[i];
}

/* ---- A level ----------------------------------------------------------------------------------------------------- */

/* Cells around those of a rectangle whose details its heights depend on. */
enum { AROUND = TC_AMPLITUDE_REACH };

size_t tc_synthesis_scratch(int64_t width, int64_t height)
{
    int64_t w = width / 2 + 2 + 2 * AROUND, h = height / 2 + 2 + 2 * AROUND, rows = 2 * h, columns = 2 * w;
    int64_t planes = (TC_DETAIL_BANDS + 1) * w * h, lifted = w * h + 2 * rows * w, base = rows * columns;
    int64_t upsampling = columns * (h + 3), flat = (2 * (w + 5) * (h + 5)) / 4 + 1, lines = 6 * w + 8;
    return (size_t)(planes + lifted + base + upsampling + flat + lines) + tc_details_scratch(w, h);
}

/* Between equal samples of what is flat lie those themselves, where U would swing. base: 2 x 2 a cell. */
static void keep_flat(const tc_patch *coarse, tc_rect cells, const uint8_t *flat, int64_t flat_stride, float *base)
{
    int64_t w = cells.x1 - cells.x0, s = coarse->stride;
    for (int64_t j = 0; j < cells.y1 - cells.y0; j++) {
        const float *c = tc_patch_at(coarse, cells.x0, cells.y0 + j);
        const uint8_t *f = flat + j * flat_stride;
        float *row = base + 4 * w * j;
        for (int64_t i = 0; i < w; i++) {
            bool right = (f[i] & f[i + 1]) && c[i + 1] == c[i];
            bool up = (f[i] & f[i + flat_stride]) && c[i + s] == c[i];
            if (right)
                row[2 * i + 1] = c[i];
            if (up)
                row[2 * w + 2 * i] = c[i];
            if (right && up && f[i + flat_stride + 1] && c[i + s + 1] == c[i])
                row[2 * w + 2 * i + 1] = c[i];
        }
    }
}

/* base plus what the inverse lifting gives beyond it, which is bounded by A; and all by the terrain's range. */
static inline void bounded_row(const tc_level_recipe *r, const float *restrict fine, const float *restrict base,
                               const float *restrict amplitude, int64_t cells, float *restrict out)
{
    float lowest = r->lowest, highest = r->highest;
    for (int64_t i = 0; i < cells; i++)
        out[2 * i] = out[2 * i + 1] = TC_ADDED_MOST * amplitude[i];
    for (int64_t i = 0; i < 2 * cells; i++) {
        float most = out[i], v = fine[i] - base[i];
        out[i] = tc_cut(tc_cut(v, -most, most) + base[i], lowest, highest);
    }
}

static inline void make_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z,
                              ptrdiff_t stride, float *scratch)
{
    tc_rect cells = tc_synthesis_needs(rect, 0);
    int64_t i0 = cells.x0, i1 = cells.x1, j0 = cells.y0, j1 = cells.y1;
    tc_details d = {.rect = tc_rect_grown(cells, AROUND)};
    int64_t w = d.stride = d.rect.x1 - d.rect.x0, h = d.rect.y1 - d.rect.y0;
    int64_t columns = 2 * (i1 - i0), rows = 2 * (j1 - j0);
    for (int b = 0; b < TC_DETAIL_BANDS; b++)
        d.band[b] = scratch, scratch += w * h;
    d.amplitude = scratch, scratch += w * h;
    float *even = scratch, *low = even + w * h, *high = low + rows * w, *base = high + rows * w;
    float *upsampling = base + columns * rows;
    scratch = upsampling + columns * (j1 - j0 + 3);
    uint8_t *flat = (uint8_t *)scratch, *flat_work = flat + (w + 1) * (h + 1);
    scratch += (2 * (w + 5) * (h + 5)) / 4 + 1;
    float *line_even = scratch, *line_odd = line_even + w + 4, *fine = line_odd + w + 4, *line = fine + 2 * w;
    scratch = line + 2 * w;

    bool flats = find_flats(coarse, (tc_rect){d.rect.x0, d.rect.y0, d.rect.x1 + 1, d.rect.y1 + 1}, flat, flat_work);
    tc_upsample(tc_patch_at(coarse, i0, j0), coarse->stride, i1 - i0, j1 - j0, base, upsampling);
    if (flats)
        keep_flat(coarse, cells, flat + AROUND * (w + 1) + AROUND, w + 1, base);
    if (!r->fit->none) {
        tc_details_make(r, coarse, flats ? flat : NULL, &d, scratch);
        ptrdiff_t at = (AROUND - 1) * w; /* row j0 - 1 */
        invert_y(tc_patch_at(coarse, d.rect.x0, j0 - 1), coarse->stride, d.band[TC_HIGH_Y] + at, w, j0, j1, r->height,
                 w, even, low);
        invert_y(d.band[TC_HIGH_X] + at, w, d.band[TC_HIGH_XY] + at, w, j0, j1, r->height, w, even, high);
    }
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        int64_t row = y - 2 * j0;
        const float *under = base + row * columns;
        if (r->fit->none) {
            for (int64_t i = 0; i < columns; i++)
                line[i] = tc_cut(under[i], r->lowest, r->highest);
        } else {
            invert_x(low + row * w + AROUND - 1, high + row * w + AROUND - 1, i0, i1, r->width, r->wraps, line_even,
                     line_odd, fine);
            bounded_row(r, fine, under, d.amplitude + (AROUND + (row >> 1)) * w + AROUND, i1 - i0, line);
        }
        memcpy(z + (y - rect.y0) * stride, line + (rect.x0 - 2 * i0), (size_t)(rect.x1 - rect.x0) * sizeof *z);
    }
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void make_level_avx2(const tc_level_recipe *r,
                                                                              const tc_patch *coarse, tc_rect rect,
                                                                              float *z, ptrdiff_t stride,
                                                                              float *scratch)
{
    make_level(r, coarse, rect, z, stride, scratch);
}

void tc_synthesis_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z, ptrdiff_t stride,
                        float *scratch)
{
    (tc_have_avx2() ? make_level_avx2 : make_level)(r, coarse, rect, z, stride, scratch);
}
