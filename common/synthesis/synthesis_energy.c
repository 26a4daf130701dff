/* synthesis_energy.c - how much detail there is around a sample, and how steep it is: what amplitudes follow from. */
#include <string.h>

#include "common/base/rect.h"
#include "common/base/simd.h"
#include "synthesis_level.h"
#include "synthesis_rows.h"

enum { SMOOTH = 2, DETAIL = TC_ENERGY_REACH - SMOOTH }; /* reaches: of smoothing, and of the detail before it */

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

/* What passes through: samples; energies and slopes of single samples; sums of three rows and of three of these.
 * Columns begin SMOOTH before the first one that is asked for, and of samples DETAIL before that. */
typedef struct energy_flow {
    tc_rows samples, raw[2], three[2];
    float nine[TC_ROW_PITCH];
} energy_flow;
_Static_assert(2 * DETAIL + 1 <= TC_ROWS_KEPT, "rows of samples");
_Static_assert(sizeof(energy_flow) <= TC_ENERGY_ROWS * TC_ROW_PITCH * sizeof(float), "scratch");

/* z: rows j - 3 .. j + 3. */
static inline void raw_row(const float *const z[7], float ix, float iy, int64_t count, float *restrict energy,
                           float *restrict slope)
{
    const float *restrict a = z[0], *restrict b = z[2], *restrict c = z[3], *restrict d = z[4], *restrict e = z[6];
    for (int64_t i = 0; i < count; i++) {
        float hx = c[i] - 0.5625f * (c[i - 1] + c[i + 1]) + 0.0625f * (c[i - 3] + c[i + 3]);
        float hy = c[i] - 0.5625f * (b[i] + d[i]) + 0.0625f * (a[i] + e[i]);
        float gx = (c[i + 1] - c[i - 1]) * ix, gy = (d[i] - b[i]) * iy;
        energy[i] = 0.5f * (hx * hx + hy * hy);
        slope[i] = gx * gx + gy * gy;
    }
}

static inline void add_three(const float *restrict a, const float *restrict b, const float *restrict c, int64_t count,
                             float *restrict sum)
{
    for (int64_t i = 0; i < count; i++)
        sum[i] = a[i] + b[i] + c[i];
}

/* log2 of a row that is smoothed by threes twice, and a floor. */
static inline void log_row(const float *restrict v, float floor, int64_t count, float *restrict out)
{
    for (int64_t i = 0; i < count; i++) {
        float sum = (v[i] + v[i + 4]) + 2 * (v[i + 1] + v[i + 3]) + 3 * v[i + 2];
        out[i] = log2_of((1.0f / 81) * sum + floor);
    }
}

/* Smoothed by threes, twice along both axes: 1 2 3 2 1 ninths. */
static inline void energy_columns(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y,
                                  tc_rect rect, float *const out[2], int64_t stride, energy_flow *f)
{
    const int64_t n = rect.x1 - rect.x0, samples = n + 2 * TC_ENERGY_REACH, w = tc_eights(n + 2 * SMOOTH);
    const float floors[2] = {fit->energy_floor, fit->slope_floor};
    int64_t next = rect.y0 - TC_ENERGY_REACH;
    for (int k = 0; k < TC_ROWS_KEPT; k++) /* what is done more than there is had better be numbers */
        memset(f->samples[k] + samples, 0, (size_t)(TC_ROW_PITCH - samples) * sizeof(float));
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        for (; next <= j + TC_ENERGY_REACH; next++) {
            memcpy(f->samples[tc_row_slot(next)], tc_patch_at(z, rect.x0 - TC_ENERGY_REACH, next),
                   (size_t)samples * sizeof(float));
            int64_t raw = next - DETAIL, three = raw - 1;
            const float *rows[7];
            for (int k = 0; k < 7; k++)
                rows[k] = f->samples[tc_row_slot(raw - 3 + k)] + DETAIL;
            if (raw >= rect.y0 - SMOOTH)
                raw_row(rows, 0.5f / spacing_x, 0.5f / spacing_y, w, f->raw[0][tc_row_slot(raw)],
                        f->raw[1][tc_row_slot(raw)]);
            for (int k = 0; k < 2 && three >= rect.y0 - 1; k++)
                add_three(f->raw[k][tc_row_slot(three - 1)], f->raw[k][tc_row_slot(three)],
                          f->raw[k][tc_row_slot(three + 1)], w, f->three[k][tc_row_slot(three)]);
        }
        for (int k = 0; k < 2; k++) {
            add_three(f->three[k][tc_row_slot(j - 1)], f->three[k][tc_row_slot(j)], f->three[k][tc_row_slot(j + 1)], w,
                      f->nine);
            log_row(f->nine, floors[k], n, out[k] + (j - rect.y0) * stride);
        }
    }
}

static inline void local_energy(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y,
                                tc_rect rect, float *energy, float *slope, float *scratch)
{
    for (int64_t x = rect.x0; x < rect.x1; x += TC_ROW_CELLS) {
        float *const out[2] = {energy + (x - rect.x0), slope + (x - rect.x0)};
        energy_columns(z, fit, spacing_x, spacing_y,
                       (tc_rect){x, rect.y0, tc_min64(x + TC_ROW_CELLS, rect.x1), rect.y1}, out, rect.x1 - rect.x0,
                       (energy_flow *)scratch);
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
