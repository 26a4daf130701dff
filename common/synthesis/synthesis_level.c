/* synthesis_level.c - one level of synthesised heights from the coarser one.
 *
 * A cell (i, j) of the coarser level, from its sample (i, j) to the next, has three details, one a band. The inverse
 * lifting (filter.c has the forward one, with the same border rule) gives four fine samples of each cell. */
#include "synthesis_level.h"

#include <math.h>
#include <string.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "common/field/filter.h"
#include "synthesis_noise.h"

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

/* ---- Amplitude --------------------------------------------------------------------------------------------------- */

/* A at cells x0 .. x1 - 1 of row j, interpolated from the coarser grid. */
static void amplitude_row(const tc_level_recipe *r, int64_t j, int64_t x0, int64_t x1, float *row, float *line)
{
    const tc_patch *a = r->amplitude;
    int64_t grain = (int64_t)1 << r->shift, v = tc_floor_shift(j, r->shift), u0 = tc_floor_shift(x0, r->shift);
    int64_t u1 = tc_floor_shift(x1 - 1, r->shift) + 2;
    float share = (float)(j - v * grain) / (float)grain, inverse = 1.0f / (float)grain;
    const float *south = tc_patch_at(a, u0, v), *north = tc_patch_at(a, u0, v + (share > 0));
    for (int64_t u = 0; u < u1 - u0 - (r->shift == 0); u++)
        line[u] = south[u] + share * (north[u] - south[u]);
    if (r->shift == 0) {
        memcpy(row, line, (size_t)(x1 - x0) * sizeof *row);
        return;
    }
    for (int64_t i = x0; i < x1; i++) {
        int64_t u = tc_floor_shift(i, r->shift);
        float t = (float)(i - u * grain) * inverse;
        row[i - x0] = line[u - u0] + t * (line[u - u0 + 1] - line[u - u0]);
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

/* ---- Details ----------------------------------------------------------------------------------------------------- */

typedef struct details {
    tc_rect rect; /* cells */
    int64_t stride;
    float *band[TC_DETAIL_BANDS], *amplitude;
} details;

/* Steps, in white noise of that stride, by one and by two cells along the direction (dx, dy). */
static inline void direction_row(const float *restrict dx, const float *restrict dy, int64_t count, int32_t stride,
                                 int32_t *restrict one, int32_t *restrict two)
{
    for (int64_t i = 0; i < count; i++) {
        float ax = dx[i] < 0 ? -dx[i] : dx[i], ay = dy[i] < 0 ? -dy[i] : dy[i];
        int32_t steep = ay > ax, sign = (dx[i] < 0) == (dy[i] < 0) ? 1 : -1;
        float lo = steep ? ax : ay, hi = steep ? ay : ax;
        int32_t t1 = 2 * lo >= hi ? sign : 0;
        int32_t t2 = 4 * lo >= 3 * hi ? 2 * sign : 4 * lo >= hi ? sign : 0;
        t1 = hi > 0 ? t1 : 0, t2 = hi > 0 ? t2 : 0;
        one[i] = steep ? stride + t1 : 1 + t1 * stride;
        two[i] = steep ? 2 * stride + t2 : 2 + t2 * stride;
    }
}

/* Directions of cells x0 .. of row j: of the slope of the coarser level, or across it. */
static inline void slopes_row(const tc_level_recipe *r, const tc_patch *coarse, int64_t j, int64_t x0, int64_t count,
                              float *restrict dx, float *restrict dy)
{
    const float *restrict z = tc_patch_at(coarse, x0, j);
    ptrdiff_t s = coarse->stride;
    float ratio = r->spacing_x / r->spacing_y, square = ratio * ratio;
    bool across = r->fit->smear < 0;
    for (int64_t i = 0; i < count; i++) {
        float gx = (z[i + 1] - z[i - 1]), gy = (z[i + s] - z[i - s]);
        dx[i] = across ? -gy * ratio : gx;
        dy[i] = across ? gx * ratio : gy * square;
    }
}

typedef float quad __attribute__((vector_size(16)));

/* Four bands' noise at once, smeared. Positive neighbours along an axis that a band is low on, and negative ones along
 * one that it is high on, move its energy to the lower frequencies of the octave. */
static inline void smear_row(const tc_synthesis_fit *fit, const float *white, int64_t stride,
                             const int32_t *restrict one, const int32_t *restrict two, int64_t count,
                             float *restrict out)
{
    float s = fit->smear < 0 ? -fit->smear : fit->smear, w1 = s, w2 = s * s, t = fit->spread;
    const quad along_x = {-t, t, -t, 0}, along_y = {t, -t, -t, 0};
    for (int64_t i = 0; i < count; i++) {
        const float *p = white + 4 * i;
        quad c, a, b, d, e, west, east, south, north;
        memcpy(&c, p, sizeof c);
        memcpy(&west, p - 4, sizeof west), memcpy(&east, p + 4, sizeof east);
        memcpy(&south, p - 4 * stride, sizeof south), memcpy(&north, p + 4 * stride, sizeof north);
        memcpy(&a, p + 4 * one[i], sizeof a), memcpy(&b, p - 4 * one[i], sizeof b);
        memcpy(&d, p + 4 * two[i], sizeof d), memcpy(&e, p - 4 * two[i], sizeof e);
        quad n = c + along_x * (west + east) + along_y * (south + north) + w1 * (a + b) + w2 * (d + e);
        memcpy(out + 4 * i, &n, sizeof n);
    }
}

/* Four values a cell into a row for each of the three bands. */
static inline void split_bands(const float *noise, int64_t count, float *restrict x, float *restrict y,
                               float *restrict xy)
{
    int64_t i = 0;
#ifdef __SSE__
    for (; i + 4 <= count; i += 4) {
        __m128 a = _mm_loadu_ps(noise + 4 * i), b = _mm_loadu_ps(noise + 4 * i + 4);
        __m128 c = _mm_loadu_ps(noise + 4 * i + 8), d = _mm_loadu_ps(noise + 4 * i + 12);
        _MM_TRANSPOSE4_PS(a, b, c, d);
        _mm_storeu_ps(x + i, a), _mm_storeu_ps(y + i, b), _mm_storeu_ps(xy + i, c);
    }
#endif
    for (; i < count; i++)
        x[i] = noise[4 * i], y[i] = noise[4 * i + 1], xy[i] = noise[4 * i + 2];
}

static inline float cut(float v, float lowest, float highest)
{
    v = v < lowest ? lowest : v;
    return v > highest ? highest : v;
}

/* Noise of variance 1, shaped to the kurtosis and cut, times A. */
static inline float shaped(float n, float norm, float peak, float amplitude)
{
    n *= norm;
    n = n + peak * (n * n * n);
    return cut(n, -TC_NOISE_MOST, TC_NOISE_MOST) * amplitude;
}

/* Details from smeared noise and what curvature foretells, in place. */
static inline void bands_row(const tc_level_recipe *r, const float *restrict z, ptrdiff_t s, const float *restrict open,
                             const float *restrict amplitude, int64_t count, float *restrict hx, float *restrict hy,
                             float *restrict hxy)
{
    const tc_synthesis_fit *fit = r->fit;
    float b0 = fit->band[0], b1 = fit->band[1], b2 = fit->band[2], c0 = fit->curvature[0], c1 = fit->curvature[1];
    float w1 = fit->smear * fit->smear, peak = fit->peak;
    float norm = 1 / sqrtf(1 + 2 * w1 + 2 * w1 * w1 + 4 * fit->spread * fit->spread);
    for (int64_t i = 0; i < count; i++)
        hx[i] = b0 * shaped(hx[i], norm, peak, amplitude[i]) +
                open[i] * (c0 * tc_second_difference(z + i, 1) + c1 * tc_sixth_difference(z + i, 1));
    for (int64_t i = 0; i < count; i++)
        hy[i] = b1 * shaped(hy[i], norm, peak, amplitude[i]) +
                open[i] * (c0 * tc_second_difference(z + i, s) + c1 * tc_sixth_difference(z + i, s));
    for (int64_t i = 0; i < count; i++)
        hxy[i] = b2 * shaped(hxy[i], norm, peak, amplitude[i]);
}

typedef struct workspace {
    float *white, *noise, *row[3], *line;
    int32_t *one, *two;
    uint8_t *flat, *flat_work;
} workspace;

static inline void detail_rows(const tc_level_recipe *r, const tc_patch *coarse, const details *d, const uint8_t *flat,
                               const workspace *s)
{
    enum { SMEAR = 2 };
    int64_t w = d->rect.x1 - d->rect.x0, white_width = w + 2 * SMEAR;
    int64_t last_x = r->wraps ? INT64_MAX : r->width - 1, last_y = r->height - 1;
    for (int64_t j = d->rect.y0; j < d->rect.y1; j++) {
        float *open = s->row[0], *dx = s->row[1], *dy = s->row[2];
        int64_t at = (j - d->rect.y0) * d->stride;
        float *amplitude = d->amplitude + at;
        const float *white = s->white + 4 * ((j - d->rect.y0 + SMEAR) * white_width + SMEAR);
        amplitude_row(r, j, d->rect.x0, d->rect.x1, amplitude, s->line);
        const uint8_t *f = flat ? flat + (j - d->rect.y0) * (w + 1) : NULL;
        for (int64_t i = 0; i < w; i++)
            open[i] = f && (f[i] | f[i + 1] | f[w + 1 + i] | f[w + 2 + i]) ? 0.0f : 1.0f;
        for (int64_t i = 0; i < w; i++)
            amplitude[i] *= open[i];
        slopes_row(r, coarse, j, d->rect.x0, w, dx, dy);
        direction_row(dx, dy, w, (int32_t)white_width, s->one, s->two);
        smear_row(r->fit, white, white_width, s->one, s->two, w, s->noise);
        float *hx = d->band[TC_HIGH_X] + at, *hy = d->band[TC_HIGH_Y] + at, *hxy = d->band[TC_HIGH_XY] + at;
        split_bands(s->noise, w, hx, hy, hxy);
        bands_row(r, tc_patch_at(coarse, d->rect.x0, j), coarse->stride, open, amplitude, w, hx, hy, hxy);
        /* There are no details beyond the last sample. */
        for (int64_t i = 0; i < w && !r->wraps; i++)
            if (d->rect.x0 + i < 0 || d->rect.x0 + i >= last_x)
                hx[i] = hxy[i] = 0;
        if (j < 0 || j >= last_y)
            memset(hy, 0, (size_t)w * sizeof *hy), memset(hxy, 0, (size_t)w * sizeof *hxy);
    }
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
    size_t w = (size_t)(width / 2 + 2), h = (size_t)(height / 2 + 2), reach = 2 * TC_COARSE_REACH + 8;
    size_t area = (w + reach) * (h + reach), rows = 24 * (2 * w + 2 * reach);
    return 4 * area + (TC_DETAIL_BANDS + 1) * area + 5 * area + 6 * area + area + rows;
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
        out[i] = cut(cut(v, -most, most) + base[i], lowest, highest);
    }
}

static inline void make_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z,
                              ptrdiff_t stride, float *scratch)
{
    tc_rect cells = tc_synthesis_needs(rect, 0);
    int64_t i0 = cells.x0, i1 = cells.x1, j0 = cells.y0, j1 = cells.y1;
    details d = {.rect = {i0 - AROUND, j0 - AROUND, i1 + AROUND, j1 + AROUND}};
    int64_t w = d.stride = d.rect.x1 - d.rect.x0, h = d.rect.y1 - d.rect.y0, rows = 2 * (j1 - j0);
    workspace s;
    s.white = scratch, scratch += 4 * (w + 4) * (h + 4);
    for (int b = 0; b < TC_DETAIL_BANDS; b++)
        d.band[b] = scratch, scratch += w * h;
    d.amplitude = scratch, scratch += w * h;
    float *even = scratch, *low = even + w * h, *high = low + rows * w, *base = high + rows * w;
    float *upsampling = base + 2 * (i1 - i0) * rows;
    scratch = upsampling + 2 * (i1 - i0) * (j1 - j0 + 3);
    s.flat = (uint8_t *)scratch, s.flat_work = s.flat + (w + 1) * (h + 1);
    scratch += (2 * (w + 5) * (h + 5)) / 4 + 1;
    s.noise = scratch, scratch += 4 * w;
    for (int k = 0; k < 3; k++)
        s.row[k] = scratch, scratch += w;
    s.line = scratch, scratch += w + 4;
    s.one = (int32_t *)scratch, s.two = s.one + w, scratch += 2 * w;
    float *line_even = scratch, *line_odd = line_even + w + 4, *fine = line_odd + w + 4, *line = fine + 2 * w;

    bool flats = find_flats(coarse, (tc_rect){d.rect.x0, d.rect.y0, d.rect.x1 + 1, d.rect.y1 + 1}, s.flat, s.flat_work);
    tc_upsample(tc_patch_at(coarse, i0, j0), coarse->stride, i1 - i0, j1 - j0, base, upsampling);
    if (flats)
        keep_flat(coarse, cells, s.flat + AROUND * (w + 1) + AROUND, w + 1, base);
    if (!r->fit->none) {
        tc_white_noise(r->seed, r->wraps ? r->width : 0,
                       (tc_rect){d.rect.x0 - 2, d.rect.y0 - 2, d.rect.x1 + 2, d.rect.y1 + 2}, s.white);
        detail_rows(r, coarse, &d, flats ? s.flat : NULL, &s);
        ptrdiff_t at = (AROUND - 1) * w; /* row j0 - 1 */
        invert_y(tc_patch_at(coarse, d.rect.x0, j0 - 1), coarse->stride, d.band[TC_HIGH_Y] + at, w, j0, j1, r->height,
                 w, even, low);
        invert_y(d.band[TC_HIGH_X] + at, w, d.band[TC_HIGH_XY] + at, w, j0, j1, r->height, w, even, high);
    }
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        int64_t row = y - 2 * j0;
        const float *under = base + row * 2 * (i1 - i0);
        if (r->fit->none) {
            for (int64_t i = 0; i < 2 * (i1 - i0); i++)
                line[i] = cut(under[i], r->lowest, r->highest);
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
