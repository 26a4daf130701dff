/* synthesis_noise.c - white noise by place: 32-bit hashes with the finaliser of MurmurHash3 (Appleby, public domain).
 */
#include "synthesis_noise.h"

#include "common/base/hash.h"
#include "common/base/simd.h"

static inline uint32_t mix(uint32_t h)
{
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    return h ^ h >> 16;
}

uint64_t tc_noise_seed(int chart, int level)
{
    return tc_hash64(tc_hash64((uint64_t)chart, 0) ^ (uint64_t)level, 0);
}

static void noise_run(uint32_t row, uint32_t column, int64_t count, float *restrict out)
{
    for (int64_t k = 0; k < 4 * count; k++) {
        uint32_t h = mix(row ^ (column + (uint32_t)(k >> 2)) * 0x9e3779b1u ^ (uint32_t)(k & 3) * 0x7feb352du);
        /* A triangle: two even shares. Its variance is 2 x 65536^2 / 12. */
        out[k] = (float)((int32_t)(h & 0xffff) + (int32_t)(h >> 16) - 65535) * (float)(2.449489742783178 / 65536);
    }
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void noise_run_avx2(uint32_t row, uint32_t column,
                                                                             int64_t count, float *out)
{
    noise_run(row, column, count, out);
}

void tc_white_noise(uint64_t seed, int64_t period, tc_rect rect, float *out)
{
    for (int64_t j = rect.y0; j < rect.y1; j++)
        for (int64_t i = rect.x0; i < rect.x1;) {
            int64_t x = i, end = rect.x1 - i;
            if (period > 0) {
                x = i % period + (i % period < 0 ? period : 0);
                end = end < period - x ? end : period - x;
            }
            int64_t left = ((x >> 32) + 1) * ((int64_t)1 << 32) - x; /* columns whose upper halves are equal */
            end = end < left ? end : left;
            uint32_t row = (uint32_t)tc_hash64(seed ^ tc_hash64((uint64_t)j ^ tc_hash64((uint64_t)(x >> 32), 0), 0), 0);
            (tc_have_avx2() ? noise_run_avx2 : noise_run)(row, (uint32_t)x, end, out);
            out += 4 * end, i += end;
        }
}
