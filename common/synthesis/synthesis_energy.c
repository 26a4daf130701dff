/* synthesis_energy.c - how much detail there is around a sample, and how steep it is: what amplitudes follow from. */
#include <string.h>

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "synthesis_level.h"

enum { SMOOTH = 2 }; /* reach of smoothing; that of the detail before it is 3: together TC_ENERGY_REACH */

/* Logarithms and powers of two to 1e-4 and 7e-4, of the same bits everywhere, which a C library's are not: polynomials
 * for log2(1 + t) / t and (2^t - 1) / t over 0 .. 1, by least squares in Chebyshev's points, that meet both ends. */
static inline float log2_of(float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    int32_t exponent = (int32_t)(bits >> 23) - 127;
    bits = (bits & 0x7fffff) | 0x3f800000;
    float t;
    memcpy(&t, &bits, sizeof t);
    t -= 1;
    float curve = 1.44255681f + t * (-0.71706393f + t * (0.44227418f + t * (-0.22771264f + t * 0.05994559f)));
    return (float)exponent + t * curve;
}

static inline float exp2_of(float v)
{
    v = v < -120 ? -120 : v;
    v = v > 120 ? 120 : v;
    int32_t whole = (int32_t)(v + 128) - 128;
    float t = v - (float)whole;
    float curve = 1 + t * (0.69394650f + t * (0.23346772f + t * 0.07258578f));
    uint32_t bits = (uint32_t)(whole + 127) << 23;
    float scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale * curve;
}

/* ---- Energy and slope -----------------------------------------------------------------------------------------------
 */

static inline void raw_row(const float *restrict z, ptrdiff_t s, float ix, float iy, int64_t count,
                           float *restrict energy, float *restrict slope)
{
    for (int64_t i = 0; i < count; i++) {
        float hx = z[i] - 0.5625f * (z[i - 1] + z[i + 1]) + 0.0625f * (z[i - 3] + z[i + 3]);
        float hy = z[i] - 0.5625f * (z[i - s] + z[i + s]) + 0.0625f * (z[i - 3 * s] + z[i + 3 * s]);
        float gx = (z[i + 1] - z[i - 1]) * ix, gy = (z[i + s] - z[i - s]) * iy;
        energy[i] = 0.5f * (hx * hx + hy * hy);
        slope[i] = gx * gx + gy * gy;
    }
}

/* 1 2 3 2 1 ninths of values `step` apart. */
static inline void smooth_row(const float *restrict in, ptrdiff_t step, int64_t count, float *restrict out)
{
    for (int64_t i = 0; i < count; i++)
        out[i] = (1.0f / 9) * (3 * in[i] + 2 * (in[i - step] + in[i + step]) + (in[i - 2 * step] + in[i + 2 * step]));
}

static inline void log_row(float floor, int64_t count, float *restrict row)
{
    for (int64_t i = 0; i < count; i++)
        row[i] = log2_of(row[i] + floor);
}

static inline void local_energy(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y,
                                tc_rect rect, float *energy, float *slope, float *scratch)
{
    tc_rect wide = {rect.x0 - SMOOTH, rect.y0 - SMOOTH, rect.x1 + SMOOTH, rect.y1 + SMOOTH};
    int64_t w = wide.x1 - wide.x0, h = wide.y1 - wide.y0, n = rect.x1 - rect.x0;
    float *raw[2] = {scratch, scratch + w * h}, *line = raw[1] + w * h, *out[2] = {energy, slope};
    const float floors[2] = {fit->energy_floor, fit->slope_floor};
    for (int64_t j = 0; j < h; j++)
        raw_row(tc_patch_at(z, wide.x0, wide.y0 + j), z->stride, 0.5f / spacing_x, 0.5f / spacing_y, w, raw[0] + j * w,
                raw[1] + j * w);
    for (int k = 0; k < 2; k++)
        for (int64_t j = 0; j < rect.y1 - rect.y0; j++) {
            smooth_row(raw[k] + (j + SMOOTH) * w, w, w, line);
            smooth_row(line + SMOOTH, 1, n, out[k] + j * n);
            log_row(floors[k], n, out[k] + j * n);
        }
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void
local_energy_avx2(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y, tc_rect rect,
                  float *energy, float *slope, float *scratch)
{
    local_energy(z, fit, spacing_x, spacing_y, rect, energy, slope, scratch);
}

void tc_local_energy(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y, tc_rect rect,
                     float *energy, float *slope, float *scratch)
{
    (tc_have_avx2() ? local_energy_avx2 : local_energy)(z, fit, spacing_x, spacing_y, rect, energy, slope, scratch);
}

/* ---- Amplitude --------------------------------------------------------------------------------------------------- */

static inline void amplitudes(const tc_synthesis_fit *fit, int k, const float *restrict energy,
                              const float *restrict slope, int64_t count, float *restrict amplitude)
{
    float a = 0.5f * fit->level[k - 1].a, b = 0.5f * fit->level[k - 1].b, c = 0.5f * fit->level[k - 1].c;
    float cap = fit->level[k - 1].cap;
    for (int64_t i = 0; i < count; i++) {
        float v = exp2_of(a + b * energy[i] + c * slope[i]);
        amplitude[i] = v > cap ? cap : v;
    }
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void amplitudes_avx2(const tc_synthesis_fit *fit, int k,
                                                                              const float *energy, const float *slope,
                                                                              int64_t count, float *amplitude)
{
    amplitudes(fit, k, energy, slope, count, amplitude);
}

void tc_amplitudes(const tc_synthesis_fit *fit, int k, const float *energy, const float *slope, int64_t count,
                   float *amplitude)
{
    (tc_have_avx2() ? amplitudes_avx2 : amplitudes)(fit, k, energy, slope, count, amplitude);
}
