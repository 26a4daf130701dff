/* synthesis_flat.c - what of a level is flat: 3 x 3 equal samples and those that touch them. Where a row has no three
 * equal samples one beside the other, which is the rule, little is looked at. */
#include "synthesis_flat.h"

#include <string.h>

#include "common/base/simd.h"

/* What is done of a row at once, and somewhat more that is looked at beside it. */
_Static_assert(((TC_ROW_CELLS + 4 + 31) & ~31) + 4 <= TC_ROW_PITCH, "cells of a row");

void tc_flats_begin(tc_flats *f, int64_t cells)
{
    f->cells = cells;
    memset(f->any, 0, sizeof f->any), memset(f->nothing, 0, sizeof f->nothing);
}

static inline bool any_of(const uint8_t *restrict v, int64_t count)
{
    uint8_t any = 0;
    for (int64_t i = 0; i < count; i++)
        any |= v[i];
    return any != 0;
}

/* Whether there is a middle in row j - 1, and where: row j has passed. */
static inline bool near_row(tc_flats *f, int64_t j, int64_t count)
{
    const uint8_t *restrict a = f->along[tc_row_slot(j - 2)], *restrict b = f->along[tc_row_slot(j - 1)];
    const uint8_t *restrict c = f->along[tc_row_slot(j)], *restrict same = f->same[tc_row_slot(j)];
    const uint8_t *restrict same_before = f->same[tc_row_slot(j - 1)];
    uint8_t middle[TC_ROW_PITCH], *restrict near = f->near[tc_row_slot(j - 1)];
    for (int64_t i = 0; i < count; i++)
        middle[i] = a[i] & b[i] & c[i] & same_before[i] & same[i];
    memset(middle + count, 0, 2);
    for (int64_t i = 0; i < count; i++)
        near[i] = middle[i] | middle[i + 1] | middle[i + 2];
    return any_of(near, count);
}

static inline void pass(tc_flats *f, int64_t j, const float *restrict south, const float *restrict z)
{
    const int64_t count = tc_thirty_twos(f->cells + 3);
    const int at = tc_row_slot(j), before = tc_row_slot(j - 1), earlier = tc_row_slot(j - 2);
    uint8_t *restrict along = f->along[at], *restrict same = f->same[at];
    const uint8_t *near[3];
    bool any = false;
    for (int64_t i = 0; i < count; i++)
        along[i] = (z[i - 2] == z[i - 1]) & (z[i] == z[i - 1]);
    f->any[at].along = any_of(along, count);
    if (f->any[at].along && f->any[before].along)
        for (int64_t i = 0; i < count; i++)
            same[i] = z[i - 1] == south[i - 1];
    f->any[before].middle = f->any[at].along && f->any[before].along && f->any[earlier].along && near_row(f, j, count);
    for (int k = 0; k < 3; k++) {
        int slot = tc_row_slot(j - 1 - k);
        near[k] = f->any[slot].middle ? f->near[slot] : f->nothing;
        any |= f->any[slot].middle;
    }
    f->any[earlier].flat = any;
    if (any) {
        const uint8_t *restrict a = near[0], *restrict b = near[1], *restrict c = near[2];
        uint8_t *restrict flat = f->flat[earlier];
        for (int64_t i = 0; i < count; i++)
            flat[i] = a[i] | b[i] | c[i];
    }
}

static inline void keep(const uint8_t *restrict f, const uint8_t *restrict g, int half, int64_t count,
                        const float *restrict z, const float *restrict north, float *restrict even, float *restrict odd)
{
    for (int64_t i = 0; i < count && half; i++) {
        int up = f[i] & g[i] & (north[i] == z[i]), both = up & f[i + 1] & g[i + 1] & (z[i + 1] == z[i]);
        even[i] = up ? z[i] : even[i];
        odd[i] = both & (north[i + 1] == z[i]) ? z[i] : odd[i];
    }
    for (int64_t i = 0; i < count && !half; i++)
        odd[i] = f[i] & f[i + 1] & (z[i + 1] == z[i]) ? z[i] : odd[i];
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void pass_avx2(tc_flats *f, int64_t j, const float *south,
                                                                        const float *z)
{
    pass(f, j, south, z);
}

TC_TARGET_AVX2 __attribute__((flatten, noinline)) static void keep_avx2(const uint8_t *f, const uint8_t *g, int half,
                                                                        int64_t count, const float *z,
                                                                        const float *north, float *even, float *odd)
{
    keep(f, g, half, count, z, north, even, odd);
}

void tc_flats_pass(tc_flats *f, int64_t j, const float *south, const float *z)
{
    (tc_have_avx2() ? pass_avx2 : pass)(f, j, south, z);
}

void tc_flats_keep(const tc_flats *f, int64_t j, int half, int64_t first, int64_t count, const float *z,
                   const float *north, float *even, float *odd)
{
    if (tc_flats_any(f, j) && (!half || tc_flats_any(f, j + 1)))
        (tc_have_avx2() ? keep_avx2 : keep)(tc_flats_row(f, j) + first, tc_flats_row(f, j + 1) + first, half, count, z,
                                            north, even, odd);
}
