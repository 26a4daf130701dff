/* synthesis_detail.c - details of a level's cells: noise smeared along the slope, shaped and scaled by A, and what
 * curvature foretells.
 *
 * A cell (i, j) of the coarser level, from its sample (i, j) to the next, has three details, one a band. */
#include "synthesis_detail.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/simd.h"

/* ---- Amplitude --------------------------------------------------------------------------------------------------- */

/* Those of a line, `steps` of them and one more, and between them their means. */
static inline void halve_steps(const float *restrict line, int64_t steps, float *restrict out)
{
    for (int64_t u = 0; u < steps; u++)
        out[2 * u] = line[u], out[2 * u + 1] = line[u] + 0.5f * (line[u + 1] - line[u]);
    out[2 * steps] = line[steps];
}

/* A at cells of row j, interpolated from the coarser grid. line: scratch. */
static inline void amplitude_row(const tc_level_recipe *r, int64_t j, int64_t x0, int64_t x1,
                                 float (*line)[TC_ROW_PITCH], float *restrict row)
{
    const tc_patch *a = r->amplitude;
    int64_t v = tc_floor_shift(j, r->shift), u0 = tc_floor_shift(x0, r->shift), from = 0;
    if (r->shift == 0) {
        memcpy(row, tc_patch_at(a, x0, j), (size_t)(x1 - x0) * sizeof *row);
        return;
    }
    int64_t grain = (int64_t)1 << r->shift, count = tc_floor_shift(x1 - 1, r->shift) + 2 - u0;
    float share = (float)(j - v * grain) / (float)grain;
    const float *south = tc_patch_at(a, u0, v), *north = tc_patch_at(a, u0, v + (share > 0));
    int which = 0;
    for (int64_t u = 0; u < count; u++)
        line[0][u] = south[u] + share * (north[u] - south[u]);
    for (int k = r->shift - 1; k >= 0; k--) { /* 2^k cells apart, from one at or before x0 to one behind x1 - 1 */
        halve_steps(line[which] + from, count - 1, line[!which]);
        which = !which, from = tc_floor_shift(x0, k) & 1;
        count = tc_floor_shift(x1 - 1, k) + 2 - tc_floor_shift(x0, k);
    }
    memcpy(row, line[which] + from, (size_t)(x1 - x0) * sizeof *row);
}

/* ---- Direction --------------------------------------------------------------------------------------------------- */

/* Directions of cells: of the slope of the coarser level, or across it. s, c, n: rows of samples. */
static inline void direction_row(const tc_level_recipe *r, const float *restrict south, const float *restrict c,
                                 const float *restrict north, int64_t count, tc_directions *restrict d)
{
    const float ratio = r->spacing_x / r->spacing_y, square = ratio * ratio;
    const bool across = r->fit->smear < 0;
    int8_t first[TC_ROW_PITCH], second[TC_ROW_PITCH];
    for (int64_t i = 0; i < count; i++) {
        float gx = c[i + 1] - c[i - 1], gy = north[i] - south[i];
        float dx = across ? -gy : gx, dy = across ? gx : gy * square, ax = fabsf(dx), ay = fabsf(dy);
        float lo = ax < ay ? ax : ay, hi = ax > ay ? ax : ay;
        /* Masks. Eighths of a turn away from the nearer axis: towards the diagonal up to the right, or to the left. */
        int32_t steep = -(ay > ax), left = -(dx * dy < 0), other = steep ^ left, half = -(2 * lo > hi);
        int32_t eighths = (4 * lo > hi) + (4 * lo > 3 * hi);
        first[i] = (int8_t)((half & (1 + (left & 2))) | (~half & steep & 2));
        second[i] = (int8_t)(((steep & 4) + (eighths ^ other) - other) & 7);
    }
    /* From numbers of lines to a choice of them. */
    for (int64_t i = 0; i < count; i++) {
        int8_t one = first[i], two = second[i];
        for (int k = 0; k < TC_LINES_ONE; k++)
            d->one[k][i] = (int8_t) - (one == k);
        for (int k = 0; k < TC_LINES_TWO; k++)
            d->two[k][i] = (int8_t) - (two == k);
    }
}

/* ---- Bands ------------------------------------------------------------------------------------------------------- */

/* Noise of variance 1, shaped to the kurtosis and cut, times A. */
static inline float shaped(float n, float peak, float amplitude)
{
    n = n + peak * (n * n * n);
    return tc_cut(n, -TC_NOISE_MOST, TC_NOISE_MOST) * amplitude;
}

/* Details high along one axis, along which p[.] are samples one after the other, from smeared noise and what curvature
 * foretells. */
static inline void band_row(const tc_synthesis_fit *fit, float share, float norm, const int16_t *restrict noise,
                            const float *const p[6], const float *restrict amplitude, int64_t count,
                            float *restrict out)
{
    const float *restrict a = p[0], *restrict b = p[1], *restrict c = p[2], *restrict d = p[3], *restrict e = p[4],
                          *restrict f = p[5];
    float c0 = fit->curvature[0], c1 = fit->curvature[1], peak = fit->peak;
    for (int64_t i = 0; i < count; i++)
        out[i] = share * shaped(norm * (float)noise[i], peak, amplitude[i]) +
                 tc_foretold(a[i], b[i], c[i], d[i], e[i], f[i], c0, c1);
}

static inline void diagonal_row(const tc_synthesis_fit *fit, float norm, const int16_t *restrict noise,
                                const float *restrict amplitude, int64_t count, float *restrict out)
{
    float share = fit->band[TC_HIGH_XY], peak = fit->peak;
    for (int64_t i = 0; i < count; i++)
        out[i] = share * shaped(norm * (float)noise[i], peak, amplitude[i]);
}

/* Nothing where a corner is flat. */
static inline void leave_flats(const uint8_t *restrict f, const uint8_t *restrict g, int64_t count, float *restrict x,
                               float *restrict y, float *restrict xy, float *restrict amplitude)
{
    for (int64_t i = 0; i < count; i++) {
        float open = 1 - (float)(f[i] | f[i + 1] | g[i] | g[i + 1]);
        x[i] *= open, y[i] *= open, xy[i] *= open, amplitude[i] *= open;
    }
}

/* Nor beyond the last sample, where there is no data to be corrected. */
static inline void leave_beyond(const tc_level_recipe *r, tc_rect rect, int64_t j, float *x, float *y, float *xy)
{
    int64_t count = rect.x1 - rect.x0;
    int64_t first = r->wraps ? 0 : tc_clamp64(-rect.x0, 0, count);
    int64_t end = r->wraps ? count : tc_clamp64(r->width - 1 - rect.x0, first, count);
    for (int64_t i = 0; i < first; i++)
        x[i] = xy[i] = 0;
    for (int64_t i = end; i < count; i++)
        x[i] = xy[i] = 0;
    if (j < 0 || j >= r->height - 1)
        memset(y, 0, (size_t)count * sizeof *y), memset(xy, 0, (size_t)count * sizeof *xy);
}

/* ---- Rows -------------------------------------------------------------------------------------------------------- */

void tc_details_begin(tc_details *d, const tc_level_recipe *r, tc_rect rect)
{
    d->recipe = r, d->rect = rect;
    tc_noise_begin(&d->noise, r->seed, r->wraps ? r->width : 0, rect.x0, rect.x1 - rect.x0, rect.y0, r->fit);
}

static inline void details_row(tc_details *d, int64_t j, const tc_detail_sources *from,
                               float *const band[TC_DETAIL_BANDS], float *amplitude)
{
    const tc_level_recipe *r = d->recipe;
    const tc_synthesis_fit *fit = r->fit;
    const int64_t cells = d->rect.x1 - d->rect.x0, w = tc_eights(cells);
    const float *z = from->z[2], *const along_x[6] = {z - 2, z - 1, z, z + 1, z + 2, z + 3};
    float norm = 1 / d->noise.smear.rms, *x = band[TC_HIGH_X], *y = band[TC_HIGH_Y], *xy = band[TC_HIGH_XY];
    amplitude_row(r, j, d->rect.x0, d->rect.x1, d->line, amplitude);
    direction_row(r, from->z[1], z, from->z[3], tc_thirty_twos(cells), &d->directions);
    tc_noise_smeared(&d->noise, &d->directions, d->smeared);
    band_row(fit, fit->band[TC_HIGH_X], norm, d->smeared[TC_HIGH_X], along_x, amplitude, w, x);
    band_row(fit, fit->band[TC_HIGH_Y], norm, d->smeared[TC_HIGH_Y], from->z, amplitude, w, y);
    diagonal_row(fit, norm, d->smeared[TC_HIGH_XY], amplitude, w, xy);
    if (from->any_flat)
        leave_flats(from->flat[0], from->flat[1], w, x, y, xy, amplitude);
    leave_beyond(r, d->rect, j, x, y, xy);
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void details_row_avx2(tc_details *d, int64_t j,
                                                                               const tc_detail_sources *from,
                                                                               float *const band[TC_DETAIL_BANDS],
                                                                               float *amplitude)
{
    details_row(d, j, from, band, amplitude);
}

void tc_details_row(tc_details *d, int64_t j, const tc_detail_sources *from, float *const band[TC_DETAIL_BANDS],
                    float *amplitude)
{
    (tc_have_avx2() ? details_row_avx2 : details_row)(d, j, from, band, amplitude);
}
