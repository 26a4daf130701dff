/* exact_values.c - tiles that take few of the values in their range.
 *
 * Where heights were converted from another unit, or resampled from contours, a tile takes values of a lattice of its
 * own. Then the set of its values is coded first, and samples by their rank in it (histogram packing: Pinho 2002). */
#include <math.h>
#include <string.h>

#include "exact_tile.h"

enum { FIRST_BITS = 27, NEAR = 40 };

static int set_bit(const tc_mix_tables *t, tc_mix_coder *coder, tc_exact_values *v, uint32_t past, uint32_t gap,
                   int bit, bool encode)
{
    int32_t run = past ? __builtin_ctz(past) : 15;
    run = run < 15 ? run : 15;
    return tc_mix_bit(t, coder, &v->recent[past & 255], &v->gaps[(uint32_t)run << 4 | gap], &v->past[past & 4095],
                      v->weight, bit, encode);
}

bool tc_exact_values_code(const tc_mix_tables *t, tc_mix_coder *coder, tc_exact_values *v, bool encode)
{
    enum { BIAS = 1 << (FIRST_BITS - 1) };
    for (size_t i = 0; i < sizeof v->recent / sizeof *v->recent; i++)
        v->recent[i] = v->gaps[i] = tc_mix_state_of(1 << 14, 2);
    for (size_t i = 0; i < sizeof v->past / sizeof *v->past; i++)
        v->past[i] = tc_mix_state_of(1 << 14, 2);
    for (int k = 0; k < TC_MIX_INPUTS; k++)
        v->weight[k] = TC_MIX_ONE * 2 / 5;
    v->first = (int32_t)tc_mix_raw(coder, (uint32_t)(v->first + BIAS), FIRST_BITS, encode) - BIAS;
    v->range = (int32_t)tc_mix_raw(coder, (uint32_t)v->range - 1, 16, encode) + 1;
    uint32_t past = 0, gap = 0;
    int32_t last = 0;
    v->count = 0;
    for (int32_t n = 0; n < v->range; n++) {
        int bit = encode ? v->below[n + 1] != v->below[n] : 1;
        if (n > 0 && n < v->range - 1)
            bit = set_bit(t, coder, v, past, gap, bit, encode);
        past = past << 1 | (uint32_t)bit;
        v->below[n] = (uint16_t)v->count;
        if (bit) {
            if (v->count == TC_EXACT_VALUES)
                return false;
            gap = (uint32_t)(n - last < 15 ? n - last : 15), last = n;
            v->value[v->count++] = (uint16_t)n;
        }
    }
    v->below[v->range] = (uint16_t)v->count;
    return true;
}

bool tc_exact_values_find(const tc_mix_tables *t, tc_exact_values *v, const tc_plane *fine, tc_rect tile, int32_t step,
                          int64_t base, uint8_t *spare)
{
    int64_t least = INT64_MAX, most = INT64_MIN;
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++)
            least = tc_min64(least, z[x] / step), most = tc_max64(most, z[x] / step);
    }
    if (most - least >= TC_EXACT_RANGE || most - least < 4)
        return false;
    v->first = (int32_t)(least - base), v->range = (int32_t)(most - least + 1);
    memset(v->below, 0, (size_t)(v->range + 1) * sizeof *v->below);
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++)
            v->below[z[x] / step - least + 1] = 1;
    }
    for (int32_t n = 0; n < v->range; n++)
        v->below[n + 1] = (uint16_t)(v->below[n] + v->below[n + 1]);
    if (v->below[v->range] * 5 > v->range * 4)
        return false;
    double saved = 0;
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++) {
            int64_t at = z[x] / step - least, from = tc_max64(at - NEAR, 0), to = tc_min64(at + NEAR + 1, v->range);
            saved += log2((double)(to - from) / (v->below[to] - v->below[from]));
        }
    }
    tc_mix_coder coder;
    tc_mix_encode_begin(&coder, spare, TC_EXACT_RANGE / 2);
    tc_exact_values_code(t, &coder, v, true);
    size_t size = tc_mix_encode_end(&coder, spare);
    return coder.missing == 0 && 8 * (double)size < 0.9 * saved;
}
