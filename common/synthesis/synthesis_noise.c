/* synthesis_noise.c - noise by place: 32-bit hashes with the finaliser of MurmurHash3 (Appleby, public domain), and
 * sums of them. Whole numbers, 32 at once where the processor can. */
#include "synthesis_noise.h"

#include <math.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/base/rect.h"
#include "common/base/simd.h"

uint64_t tc_noise_seed(int chart, int level)
{
    return tc_hash64(tc_hash64((uint64_t)chart, 0) ^ (uint64_t)level, 0);
}

/* ---- White noise ------------------------------------------------------------------------------------------------- */

static inline uint32_t mix(uint32_t h)
{
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    return h ^ h >> 16;
}

/* Two even shares: a triangle. */
static inline int8_t triangle(uint32_t h)
{
    return (int8_t)((int32_t)(h & 31) + (int32_t)(h >> 5 & 31) - 31);
}

static inline void white_run(uint32_t row, uint32_t column, int64_t count, int8_t *restrict x, int8_t *restrict y,
                             int8_t *restrict xy)
{
    for (int64_t k = 0; k < count; k++) {
        uint32_t h = mix(row ^ (column + (uint32_t)k) * 0x9e3779b1u);
        x[k] = triangle(h), y[k] = triangle(h >> 10), xy[k] = triangle(h >> 20);
    }
}

/* Row n->next. */
static inline void make_white(tc_noise_rows *n)
{
    if (n->rows == TC_NOISE_ROWS) { /* those that are still needed begin anew */
        n->rows = 2 * TC_NOISE_REACH;
        for (int b = 0; b < TC_DETAIL_BANDS; b++)
            memcpy(n->white[b], n->white[b][TC_NOISE_ROWS - n->rows], (size_t)n->rows * sizeof n->white[b][0]);
    }
    int8_t *x = n->white[TC_HIGH_X][n->rows], *y = n->white[TC_HIGH_Y][n->rows], *xy = n->white[TC_HIGH_XY][n->rows];
    int64_t begin = n->x0 - TC_NOISE_REACH, end = begin + tc_thirty_twos(n->cells + 2 * TC_NOISE_REACH);
    for (int64_t i = begin; i < end;) {
        int64_t column = i, count = end - i;
        if (n->period > 0) {
            column = i - tc_turn(i, n->period);
            count = tc_min64(count, n->period - column);
        }
        int64_t upper = column >> 32; /* columns whose upper halves are equal */
        count = tc_min64(count, (upper + 1) * ((int64_t)1 << 32) - column);
        uint64_t row = tc_hash64(n->seed ^ tc_hash64((uint64_t)n->next ^ tc_hash64((uint64_t)upper, 0), 0), 0);
        white_run((uint32_t)row, (uint32_t)column, count, x, y, xy);
        x += count, y += count, xy += count, i += count;
    }
    n->next++, n->rows++;
}

/* ---- Smearing ---------------------------------------------------------------------------------------------------- */

tc_smear tc_smear_of(const tc_synthesis_fit *fit)
{
    float one = fabsf(fit->smear), two = one * one, spread = fit->spread;
    return (tc_smear){(int16_t)rintf(64 * one), (int16_t)rintf(64 * two), (int16_t)rintf(64 * spread),
                      64 * TC_NOISE_RMS * sqrtf(1 + 2 * one * one + 2 * two * two + 4 * spread * spread)};
}

/* r: white noise of a row, at the first cell, amid four other rows. Positive neighbours along an axis that a band is
 * low on, and negative ones along one that it is high on, move its energy to the lower frequencies of the octave. */
static inline void smear_run(const int8_t *restrict r, const tc_directions *restrict d, tc_smear s, int16_t share_x,
                             int16_t share_y, int64_t count, int16_t *restrict out)
{
    enum { P = TC_ROW_PITCH };
    for (int64_t i = 0; i < count; i++) {
        int8_t x = (int8_t)(r[i - 1] + r[i + 1]), y = (int8_t)(r[i - P] + r[i + P]);
        int8_t one = (int8_t)((d->one[0][i] & x) | (d->one[1][i] & (r[i - P - 1] + r[i + P + 1])) | (d->one[2][i] & y) |
                              (d->one[3][i] & (r[i - P + 1] + r[i + P - 1])));
        int8_t two = (int8_t)((d->two[0][i] & (r[i - 2] + r[i + 2])) | (d->two[1][i] & (r[i - P - 2] + r[i + P + 2])) |
                              (d->two[2][i] & (r[i - 2 * P - 2] + r[i + 2 * P + 2])) |
                              (d->two[3][i] & (r[i - 2 * P - 1] + r[i + 2 * P + 1])) |
                              (d->two[4][i] & (r[i - 2 * P] + r[i + 2 * P])) |
                              (d->two[5][i] & (r[i - 2 * P + 1] + r[i + 2 * P - 1])) |
                              (d->two[6][i] & (r[i - 2 * P + 2] + r[i + 2 * P - 2])) |
                              (d->two[7][i] & (r[i - P + 2] + r[i + P - 2])));
        out[i] = (int16_t)(64 * r[i] + x * share_x + y * share_y + one * s.one + two * s.two);
    }
}

void tc_noise_begin(tc_noise_rows *n, uint64_t seed, int64_t period, int64_t x0, int64_t cells, int64_t first,
                    const tc_synthesis_fit *fit)
{
    n->seed = seed, n->period = period, n->x0 = x0, n->cells = cells;
    n->rows = 0, n->next = first - TC_NOISE_REACH;
    n->smear = tc_smear_of(fit);
}

static inline void smeared(tc_noise_rows *n, const tc_directions *d, int16_t (*out)[TC_ROW_PITCH])
{
    static const int along_x[TC_DETAIL_BANDS] = {-1, 1, -1}, along_y[TC_DETAIL_BANDS] = {1, -1, -1};
    do
        make_white(n);
    while (n->rows < 2 * TC_NOISE_REACH + 1);
    for (int b = 0; b < TC_DETAIL_BANDS; b++)
        smear_run(n->white[b][n->rows - 1 - TC_NOISE_REACH] + TC_NOISE_REACH, d, n->smear,
                  (int16_t)(along_x[b] * n->smear.spread), (int16_t)(along_y[b] * n->smear.spread),
                  tc_thirty_twos(n->cells), out[b]);
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void smeared_avx2(tc_noise_rows *n, const tc_directions *d,
                                                                           int16_t (*out)[TC_ROW_PITCH])
{
    smeared(n, d, out);
}

void tc_noise_smeared(tc_noise_rows *n, const tc_directions *d, int16_t (*out)[TC_ROW_PITCH])
{
    (tc_have_avx2() ? smeared_avx2 : smeared)(n, d, out);
}
