/* synthesis_detail.c - details of a level's cells: noise smeared along the slope, shaped and scaled by A, and what
 * curvature foretells.
 *
 * A cell (i, j) of the coarser level, from its sample (i, j) to the next, has three details, one a band. */
#include <math.h>
#include <string.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "synthesis_detail.h"
#include "synthesis_noise.h"

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

/* ---- Noise ------------------------------------------------------------------------------------------------------- */

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

/* ---- Bands ------------------------------------------------------------------------------------------------------- */

/* Noise of variance 1, shaped to the kurtosis and cut, times A. */
static inline float shaped(float n, float norm, float peak, float amplitude)
{
    n *= norm;
    n = n + peak * (n * n * n);
    return tc_cut(n, -TC_NOISE_MOST, TC_NOISE_MOST) * amplitude;
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

/* ---- Details ----------------------------------------------------------------------------------------------------- */

/* Cells around one whose noise is smeared into it. */
enum { SMEAR = 2 };

size_t tc_details_scratch(int64_t width, int64_t height)
{
    return (size_t)(4 * (width + 2 * SMEAR) * (height + 2 * SMEAR) + 10 * width + 4);
}

static inline void make_details(const tc_level_recipe *r, const tc_patch *coarse, const uint8_t *flat,
                                const tc_details *d, float *scratch)
{
    int64_t w = d->rect.x1 - d->rect.x0, white_width = w + 2 * SMEAR;
    int64_t last_x = r->wraps ? INT64_MAX : r->width - 1, last_y = r->height - 1;
    tc_rect around = tc_rect_grown(d->rect, SMEAR);
    float *white = scratch, *noise = white + 4 * tc_rect_area(around), *open = noise + 4 * w;
    float *dx = open + w, *dy = dx + w, *line = dy + w;
    int32_t *one = (int32_t *)(line + w + 4), *two = one + w;
    tc_white_noise(r->seed, r->wraps ? r->width : 0, around, white);
    for (int64_t j = d->rect.y0; j < d->rect.y1; j++) {
        int64_t row = j - d->rect.y0, at = row * d->stride;
        float *amplitude = d->amplitude + at;
        amplitude_row(r, j, d->rect.x0, d->rect.x1, amplitude, line);
        const uint8_t *f = flat ? flat + row * (w + 1) : NULL;
        for (int64_t i = 0; i < w; i++)
            open[i] = f && (f[i] | f[i + 1] | f[w + 1 + i] | f[w + 2 + i]) ? 0.0f : 1.0f;
        for (int64_t i = 0; i < w; i++)
            amplitude[i] *= open[i];
        slopes_row(r, coarse, j, d->rect.x0, w, dx, dy);
        direction_row(dx, dy, w, (int32_t)white_width, one, two);
        smear_row(r->fit, white + 4 * ((row + SMEAR) * white_width + SMEAR), white_width, one, two, w, noise);
        float *hx = d->band[TC_HIGH_X] + at, *hy = d->band[TC_HIGH_Y] + at, *hxy = d->band[TC_HIGH_XY] + at;
        split_bands(noise, w, hx, hy, hxy);
        bands_row(r, tc_patch_at(coarse, d->rect.x0, j), coarse->stride, open, amplitude, w, hx, hy, hxy);
        /* There are no details beyond the last sample. */
        for (int64_t i = 0; i < w && !r->wraps; i++)
            if (d->rect.x0 + i < 0 || d->rect.x0 + i >= last_x)
                hx[i] = hxy[i] = 0;
        if (j < 0 || j >= last_y)
            memset(hy, 0, (size_t)w * sizeof *hy), memset(hxy, 0, (size_t)w * sizeof *hxy);
    }
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void make_details_avx2(const tc_level_recipe *r,
                                                                                const tc_patch *coarse,
                                                                                const uint8_t *flat,
                                                                                const tc_details *d, float *scratch)
{
    make_details(r, coarse, flat, d, scratch);
}

void tc_details_make(const tc_level_recipe *r, const tc_patch *coarse, const uint8_t *flat, const tc_details *d,
                     float *scratch)
{
    (tc_have_avx2() ? make_details_avx2 : make_details)(r, coarse, flat, d, scratch);
}
