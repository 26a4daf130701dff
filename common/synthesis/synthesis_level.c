/* synthesis_level.c - one level of synthesised heights from the coarser one.
 *
 * The inverse lifting (filter.c has the forward one, with the same border rule) gives four fine samples of each cell.
 * Being linear, it is done of the details alone; what it gives is bounded and added to U of the heights. Rows pass
 * through it one after the other, the last few of them kept, along y first: a row of cells, then the two finer rows. */
#include "synthesis_level.h"

#include <string.h>

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "common/field/filter.h"
#include "synthesis_detail.h"
#include "synthesis_flat.h"

tc_rect tc_synthesis_needs(tc_rect fine, int reach)
{
    return (tc_rect){tc_floor_shift(fine.x0, 1) - reach, tc_floor_shift(fine.y0, 1) - reach,
                     tc_floor_shift(fine.x1 - 1, 1) + 1 + reach, tc_floor_shift(fine.y1 - 1, 1) + 1 + reach};
}

/* A row `times` rows beyond an edge, in the straight line from the row before it. */
static inline void beyond_row(const float *restrict edge, const float *restrict inner, float times, int64_t count,
                              float *restrict row)
{
    for (int64_t i = 0; i < count; i++)
        row[i] = edge[i] + times * (edge[i] - inner[i]);
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
        beyond_row(edge, inner, (float)(j < y0 ? y0 - j : j - y1 + 1), w, tc_patch_at(p, p->rect.x0, j));
    }
}

/* ---- Inverse lifting --------------------------------------------------------------------------------------------- */

/* Evens of rows: `low` less what four rows of details around would add; of nothing where low is NULL. */
static inline void even_row(const float *restrict low, const float *restrict p, const float *restrict q,
                            const float *restrict r, const float *restrict s, int64_t count, float *restrict even)
{
    for (int64_t i = 0; i < count; i++) {
        float update = TC_UPDATE_NEAR * (q[i] + r[i]) + TC_UPDATE_FAR * (p[i] + s[i]);
        even[i] = low ? low[i] - update : -update;
    }
}

/* Odds: what is foretold by four rows of evens around, and the detail; d may be NULL. */
static inline void odd_row(const float *restrict d, const float *restrict p, const float *restrict q,
                           const float *restrict r, const float *restrict s, int64_t count, float *restrict odd)
{
    for (int64_t i = 0; i < count; i++) {
        float v = tc_predict(p[i], q[i], r[i], s[i]);
        odd[i] = d ? d[i] + v : v;
    }
}

/* Evens and odds of a finer row, from what of it is low and high along x: both from cell i0 - 1 on, with two more
 * before and one more behind. */
static inline void invert_x(const tc_level_recipe *r, const float *low, const float *high, int64_t i0, int64_t i1,
                            float *even, float *odd)
{
    int64_t first = r->wraps ? i0 - 1 : tc_max64(i0 - 1, 0), end = r->wraps ? i1 + 2 : tc_min64(i1 + 2, r->width);
    const float *d = high + (first - (i0 - 1));
    even_row(low + (first - (i0 - 1)), d - 2, d - 1, d, d + 1, tc_eights(end - first), even + (first - (i0 - 1)));
    tc_extend_beyond(&(tc_patch){even, 0, {i0 - 1, 0, i1 + 2, 1}}, r->width, 1, r->wraps);
    odd_row(high + 1, even, even + 1, even + 2, even + 3, tc_eights(i1 - i0), odd);
}

/* Heights of a finer row: U's, and what is beyond them, bounded by A; and all by the terrain's range. */
static inline void bounded_row(const tc_level_recipe *r, const float *restrict even, const float *restrict odd,
                               const float *restrict under_even, const float *restrict under_odd,
                               const float *restrict amplitude, int64_t cells, float *restrict out)
{
    float lowest = r->lowest, highest = r->highest;
    for (int64_t i = 0; i < cells; i++) {
        float most = TC_ADDED_MOST * amplitude[i];
        out[2 * i] = tc_cut(tc_cut(even[i], -most, most) + under_even[i], lowest, highest);
        out[2 * i + 1] = tc_cut(tc_cut(odd[i], -most, most) + under_odd[i], lowest, highest);
    }
}

/* ---- What passes through ----------------------------------------------------------------------------------------- */

enum {
    AROUND = TC_AMPLITUDE_REACH,               /* cells around those of a rectangle whose details it depends on, */
    BEYOND = TC_COARSE_REACH - AROUND,         /* samples beyond these that details depend on */
    FINE = 2 * (TC_ROW_CELLS - 2 * AROUND - 1) /* columns of heights that are made at once */
};
/* While details reach AROUND rows further, and samples three more for these, the row before is still looked at. */
_Static_assert(1 + 1 + AROUND + 3 <= TC_ROWS_KEPT, "rows of samples");

typedef struct flow {
    const tc_level_recipe *recipe;
    const tc_patch *coarse;
    tc_rect cells, around; /* with those around */
    int64_t next_sample, next_detail, next_even;
    tc_rows samples;
    tc_flats flats;
    tc_details details;
    tc_rows band[TC_DETAIL_BANDS], amplitude;
    tc_rows low, high; /* evens along y of what is low and high along x */
    /* Of a finer row: what is low and high along x, U, evens and odds of what is beyond it, and heights. */
    float line_low[TC_ROW_PITCH], line_high[TC_ROW_PITCH], even[TC_ROW_PITCH], odd[TC_ROW_PITCH];
    float under_even[TC_ROW_PITCH], under_odd[TC_ROW_PITCH], line[2 * TC_ROW_PITCH];
} flow;

/* What is taken of scratch before may be an odd number of floats: one more than a flow has, to begin at an even one. */
_Static_assert(_Alignof(flow) <= 2 * sizeof(float) && sizeof(flow) % sizeof(float) == 0, "scratch");

static inline flow *flow_in(float *scratch)
{
    return (flow *)(scratch + ((uintptr_t)scratch % _Alignof(flow) != 0));
}

size_t tc_synthesis_scratch(void)
{
    const size_t most = sizeof(flow) / sizeof(float) + 1, energy = TC_ENERGY_ROWS * TC_ROW_PITCH;
    return most > energy ? most : energy;
}

/* Row j of what is kept. */
static inline float *row_at(tc_rows r, int64_t j)
{
    return r[tc_row_slot(j)];
}

/* Samples of row j at the first cell around. */
static inline float *samples_at(flow *f, int64_t j)
{
    return row_at(f->samples, j) + BEYOND;
}

static inline void begin(flow *f, const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect)
{
    const int64_t cells = tc_synthesis_needs(rect, AROUND).x1 - tc_synthesis_needs(rect, AROUND).x0;
    f->recipe = r, f->coarse = coarse, f->cells = tc_synthesis_needs(rect, 0);
    f->around = tc_synthesis_needs(rect, AROUND);
    f->next_sample = f->around.y0 - 2, f->next_detail = f->around.y0, f->next_even = tc_max64(f->cells.y0 - 1, 0);
    /* What is done more than there is had better be numbers. */
    for (int k = 0; k < TC_ROWS_KEPT; k++) {
        memset(f->samples[k] + cells + 2 * BEYOND, 0, (size_t)(TC_ROW_PITCH - cells - 2 * BEYOND) * sizeof(float));
        memset(f->amplitude[k] + cells, 0, (size_t)(TC_ROW_PITCH - cells) * sizeof(float));
    }
    tc_flats_begin(&f->flats, cells);
    tc_details_begin(&f->details, r, f->around);
}

/* Samples up to row `last`. */
static inline void samples_to(flow *f, int64_t last)
{
    for (; f->next_sample <= last; f->next_sample++) {
        int64_t j = f->next_sample;
        memcpy(row_at(f->samples, j), tc_patch_at(f->coarse, f->around.x0 - BEYOND, j),
               (size_t)(f->around.x1 - f->around.x0 + 2 * BEYOND) * sizeof(float));
        tc_flats_pass(&f->flats, j, samples_at(f, j - 1), samples_at(f, j));
    }
}

/* Details up to row `last`. */
static inline void details_to(flow *f, int64_t last)
{
    for (; f->next_detail <= last; f->next_detail++) {
        int64_t j = f->next_detail;
        samples_to(f, j + 3);
        tc_detail_sources from = {.any_flat = tc_flats_any(&f->flats, j) || tc_flats_any(&f->flats, j + 1),
                                  .flat = {tc_flats_row(&f->flats, j), tc_flats_row(&f->flats, j + 1)}};
        for (int k = 0; k < 6; k++)
            from.z[k] = samples_at(f, j - 2 + k);
        float *const band[TC_DETAIL_BANDS] = {row_at(f->band[0], j), row_at(f->band[1], j), row_at(f->band[2], j)};
        tc_details_row(&f->details, j, &from, band, row_at(f->amplitude, j));
    }
}

/* Evens along y up to row `last`, in a straight line beyond the sides. */
static inline void evens_to(flow *f, int64_t last)
{
    const int64_t w = tc_eights(f->around.x1 - f->around.x0), end = f->recipe->height - 1, inner = end > 0;
    for (; f->next_even <= last; f->next_even++) {
        int64_t j = f->next_even;
        const float *y[4], *xy[4];
        for (int k = 0; k < 4; k++)
            y[k] = row_at(f->band[TC_HIGH_Y], j - 2 + k), xy[k] = row_at(f->band[TC_HIGH_XY], j - 2 + k);
        if (j <= end) {
            even_row(NULL, y[0], y[1], y[2], y[3], w, row_at(f->low, j));
            even_row(row_at(f->band[TC_HIGH_X], j), xy[0], xy[1], xy[2], xy[3], w, row_at(f->high, j));
        } else {
            beyond_row(row_at(f->low, end), row_at(f->low, end - inner), (float)(j - end), w, row_at(f->low, j));
            beyond_row(row_at(f->high, end), row_at(f->high, end - inner), (float)(j - end), w, row_at(f->high, j));
        }
        if (j == 1 && f->cells.y0 == 0) { /* row -1 is asked for */
            beyond_row(row_at(f->low, 0), row_at(f->low, inner), 1, w, row_at(f->low, -1));
            beyond_row(row_at(f->high, 0), row_at(f->high, inner), 1, w, row_at(f->high, -1));
        }
    }
}

/* ---- A level ----------------------------------------------------------------------------------------------------- */

/* U of the finer row 2 j + half: of the coarser level or of what lies between four of its rows, and between their
 * samples. Evens, from one cell before the first one on. */
static inline const float *under_row(flow *f, int64_t j, int half)
{
    const int64_t count = f->cells.x1 - f->cells.x0;
    const float *c = samples_at(f, j) + AROUND - 1, *north = samples_at(f, j + 1) + AROUND - 1;
    if (half)
        odd_row(NULL, samples_at(f, j - 1) + AROUND - 1, c, north, samples_at(f, j + 2) + AROUND - 1,
                tc_eights(count + 3), f->under_even);
    const float *even = half ? f->under_even : c;
    odd_row(NULL, even, even + 1, even + 2, even + 3, tc_eights(count), f->under_odd);
    tc_flats_keep(&f->flats, j, half, AROUND, count, c + 1, north + 1, f->under_even + 1, f->under_odd);
    return even;
}

/* What the details add to it. */
static inline void over_row(flow *f, int64_t j, int half)
{
    const float *low = row_at(f->low, j), *high = row_at(f->high, j);
    const int64_t w = tc_eights(f->around.x1 - f->around.x0);
    if (half) {
        odd_row(row_at(f->band[TC_HIGH_Y], j), row_at(f->low, j - 1), low, row_at(f->low, j + 1), row_at(f->low, j + 2),
                w, f->line_low);
        odd_row(row_at(f->band[TC_HIGH_XY], j), row_at(f->high, j - 1), high, row_at(f->high, j + 1),
                row_at(f->high, j + 2), w, f->line_high);
        low = f->line_low, high = f->line_high;
    }
    invert_x(f->recipe, low + AROUND - 1, high + AROUND - 1, f->cells.x0, f->cells.x1, f->even, f->odd);
}

static inline void make_columns(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z,
                                ptrdiff_t stride, flow *f)
{
    begin(f, r, coarse, rect);
    const int64_t count = f->cells.x1 - f->cells.x0;
    if (r->fit->none) {
        memset(f->amplitude, 0, sizeof f->amplitude);
        memset(f->even, 0, sizeof f->even), memset(f->odd, 0, sizeof f->odd);
    }
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        int64_t j = y >> 1;
        int half = (int)(y & 1);
        if (r->fit->none) {
            samples_to(f, j + 3); /* as far as what is flat depends on */
        } else {
            details_to(f, j + AROUND);
            evens_to(f, j + 2);
            over_row(f, j, half);
        }
        const float *under = under_row(f, j, half);
        bounded_row(r, f->even + 1, f->odd, under + 1, f->under_odd, row_at(f->amplitude, j) + AROUND, tc_eights(count),
                    f->line);
        memcpy(z + (y - rect.y0) * stride, f->line + (rect.x0 - 2 * f->cells.x0),
               (size_t)(rect.x1 - rect.x0) * sizeof *z);
    }
}

static inline void make_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z,
                              ptrdiff_t stride, float *scratch)
{
    for (int64_t x = rect.x0; x < rect.x1; x += FINE)
        make_columns(r, coarse, (tc_rect){x, rect.y0, tc_min64(x + FINE, rect.x1), rect.y1}, z + (x - rect.x0), stride,
                     flow_in(scratch));
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
