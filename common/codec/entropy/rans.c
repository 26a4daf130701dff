/* rans.c - tables and ends of rANS streams; the steps themselves are inline in rans.h. */
#include "rans.h"

#include <string.h>

enum { LOW = 1 << 16 }; /* states are never below, between symbols */

static uint32_t load32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void store32(uint8_t *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (uint8_t)(v >> 8 * i);
}

tc_rans_frequencies tc_rans_normalise(const uint64_t weight[TC_RANS_SYMBOLS])
{
    uint64_t total = 0, most = 0, w[TC_RANS_SYMBOLS];
    int shift = 0; /* keeps the products below within 64 bits */
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        most = weight[s] > most ? weight[s] : most;
    while (most >> shift >> 40)
        shift++;
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        total += w[s] = weight[s] >> shift;
    tc_rans_frequencies f;
    int32_t sum = 0, largest = 0;
    for (int s = 0; s < TC_RANS_SYMBOLS; s++) {
        uint64_t share = total ? (w[s] * (TC_RANS_SLOTS - TC_RANS_SYMBOLS) + total / 2) / total
                               : TC_RANS_SLOTS / TC_RANS_SYMBOLS - 1;
        /* One slot is everybody's; the rest goes by weight. */
        f.of[s] = (uint16_t)(share + 1);
        sum += f.of[s];
        if (f.of[s] > f.of[largest])
            largest = s;
    }
    f.of[largest] = (uint16_t)(f.of[largest] + TC_RANS_SLOTS - sum);
    return f;
}

bool tc_rans_valid(const tc_rans_frequencies *frequencies)
{
    uint32_t sum = 0;
    for (int s = 0; s < TC_RANS_SYMBOLS; s++) {
        if (frequencies->of[s] == 0)
            return false;
        sum += frequencies->of[s];
    }
    return sum == TC_RANS_SLOTS;
}

void tc_rans_table_build(const tc_rans_frequencies *frequencies, tc_rans_table *table)
{
    uint32_t at = 0;
    for (int s = 0; s < TC_RANS_SYMBOLS; at += frequencies->of[s++]) {
        memset(table->slot + at, s, frequencies->of[s]);
        table->symbol[s] = frequencies->of[s] | at << TC_RANS_BITS | (uint32_t)s << 2 * TC_RANS_BITS;
    }
}

void tc_rans_symbols_build(const tc_rans_frequencies *frequencies, tc_rans_symbol symbol[TC_RANS_SYMBOLS])
{
    uint32_t at = 0;
    for (int s = 0; s < TC_RANS_SYMBOLS; at += frequencies->of[s++])
        symbol[s] = tc_rans_symbol_of(at, frequencies->of[s]);
}

void tc_rans_encode_begin(tc_rans_encoder *e, int lanes, uint8_t *begin, uint8_t *end, const uint8_t *payload)
{
    e->lanes = lanes;
    for (int lane = 0; lane < lanes; lane++)
        e->state[lane] = LOW | (uint32_t)payload[2 * lane] | (uint32_t)payload[2 * lane + 1] << 8;
    e->begin = begin, e->at = end;
}

void tc_rans_encode_end(tc_rans_encoder *e)
{
    e->at -= 4 * e->lanes;
    for (int lane = 0; lane < e->lanes; lane++)
        store32(e->at + 4 * lane, e->state[lane]);
}

bool tc_rans_decode_begin(tc_rans_decoder *d, int lanes, const uint8_t *bytes, size_t size)
{
    if (size < 4 * (size_t)lanes)
        return false;
    for (int lane = 0; lane < lanes; lane++)
        if ((d->state[lane] = load32(bytes + 4 * lane)) < LOW)
            return false;
    d->lanes = lanes, d->at = bytes + 4 * lanes, d->end = bytes + size, d->overrun = false;
    return true;
}

bool tc_rans_decode_end(const tc_rans_decoder *d, uint8_t *payload)
{
    if (d->overrun)
        return false;
    for (int lane = 0; lane < d->lanes; lane++) {
        if (d->state[lane] >> 16 != 1)
            return false;
        payload[2 * lane] = (uint8_t)d->state[lane], payload[2 * lane + 1] = (uint8_t)(d->state[lane] >> 8);
    }
    return true;
}
