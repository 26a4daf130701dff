/* mixing_coder.c - the mixing coder's tables, and where its streams begin and end (mixing_coder.h). */
#include "mixing_coder.h"

void tc_mix_tables_init(tc_mix_tables *t)
{
    /* 65536 / (1 + exp(-x)) for x = -8, -7.5, ... 8. */
    static const int32_t knot[33] = {22,    36,    60,    98,    162,   267,   439,   721,   1179,  1918,  3108,
                                     4971,  7812,  11954, 17625, 24743, 32768, 40793, 47911, 53582, 57724, 60565,
                                     62428, 63618, 64357, 64815, 65097, 65269, 65374, 65438, 65476, 65500, 65514};
    int filled = 0;
    for (int x = -TC_LOGIT_LIMIT; x <= TC_LOGIT_LIMIT; x++) {
        int at = (x + 2048) >> 7, part = (x + 2048) & 127;
        int32_t p = knot[at] + ((knot[at + 1] - knot[at]) * part + 64) / 128;
        p = p < TC_MIX_LEAST ? TC_MIX_LEAST : p > 65536 - TC_MIX_LEAST ? 65536 - TC_MIX_LEAST : p;
        t->squash[x + TC_LOGIT_LIMIT] = (uint16_t)p;
        for (; filled <= p >> 4; filled++)
            t->stretch[filled] = (int16_t)x;
    }
    for (; filled < 4096; filled++)
        t->stretch[filled] = TC_LOGIT_LIMIT;
    t->squash[2 * TC_LOGIT_LIMIT + 1] = 0;
    for (int n = 0; n <= TC_STATE_LIMIT; n++)
        t->rate[n] = (uint16_t)(131072 / (2 * n + 3));
}

void tc_mix_encode_begin(tc_mix_coder *c, uint8_t *bytes, size_t room)
{
    *c = (tc_mix_coder){.high = UINT32_MAX, .at = bytes, .end = bytes + room};
}

size_t tc_mix_encode_end(tc_mix_coder *c, const uint8_t *bytes)
{
    /* Of all numbers in [low, high] the one with the most zeros at its end. */
    uint32_t last = c->low;
    for (int bits = 32; bits > 0; bits--) {
        uint64_t mask = ((uint64_t)1 << bits) - 1, rounded = (c->low + mask) & ~mask;
        if (rounded <= c->high) {
            last = (uint32_t)rounded;
            break;
        }
    }
    for (int shift = 24; shift >= 0; shift -= 8)
        tc_mix_put(c, (uint8_t)(last >> shift));
    while (c->at > bytes && c->at[-1] == 0)
        c->at--;
    return (size_t)(c->at - bytes);
}

void tc_mix_decode_begin(tc_mix_coder *c, const uint8_t *bytes, size_t size)
{
    *c = (tc_mix_coder){.high = UINT32_MAX, .from = bytes, .from_end = bytes + size};
    for (int i = 0; i < 4; i++)
        c->code = c->code << 8 | tc_mix_get(c);
}

bool tc_mix_decode_end(const tc_mix_coder *c)
{
    return c->from == c->from_end;
}
