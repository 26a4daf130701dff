/* mixing_coder.h - adaptive binary arithmetic coding with probabilities mixed from several contexts.
 *
 * Every decision has three adaptive probabilities, each counted in a context of its own. Their logits are added with
 * weights that follow the gradient of the code length, and the sum's probability drives a carryless binary range
 * coder (logistic mixing and the state that learns at rate 1/n, then at a fixed one: Mahoney 2005, "Adaptive weighing
 * of context models for lossless data compression"). All integers. A stream carries no length: bytes missing at its
 * end read as zeros, and trailing zeros are left out. */
#ifndef TC_MIXING_CODER_H
#define TC_MIXING_CODER_H

#include "common/terraclip.h"

enum {
    TC_MIX_INPUTS = 3,
    TC_LOGIT_LIMIT = 2047, /* logits are in 1/256 */
    TC_STATE_COUNT = 1023,
    TC_MIX_ONE = 1 << 16, /* of weights */
    TC_MIX_WEIGHT_LIMIT = 1 << 20,
    TC_MIX_RATE = 15,
    TC_STATE_LIMIT = 255,
    TC_MIX_LEAST = 24 /* of a probability, in 1/65536 */
};

/* A probability of a one, 22 bits, and how many bits it has seen, 10 bits. */
typedef uint32_t tc_mix_state;

/* Tables that coding needs; the same for everyone. */
typedef struct tc_mix_tables {
    int16_t stretch[4096];                   /* logit of a probability in 1/4096 */
    uint16_t squash[2 * TC_LOGIT_LIMIT + 2]; /* probability in 1/65536 of logit + TC_LOGIT_LIMIT */
    uint16_t rate[TC_STATE_LIMIT + 1];       /* 65536 / (n + 1.5) */
} tc_mix_tables;

void tc_mix_tables_init(tc_mix_tables *tables);

/* A state of probability p (1/65536) that weighs as much as `count` bits seen. */
static inline tc_mix_state tc_mix_state_of(uint32_t p, uint32_t count)
{
    return p << 16 | count;
}

static inline void tc_mix_state_learn(const tc_mix_tables *t, tc_mix_state *state, int bit)
{
    uint32_t s = *state, n = s & TC_STATE_COUNT;
    int32_t delta = (bit ? (1 << 22) - 1 : 0) - (int32_t)(s >> 10);
    int32_t move = (int32_t)((int64_t)delta * t->rate[n] >> 16);
    *state = s + ((uint32_t)move << 10) + (n < TC_STATE_LIMIT);
}

/* ---- The range coder: [low, high] ---------------------------------------------------------------------------- */

typedef struct tc_mix_coder {
    uint32_t low, high, code;
    uint8_t *at, *end;              /* encoder */
    const uint8_t *from, *from_end; /* decoder */
    size_t missing;                 /* bytes read beyond the end; bytes that found no room */
} tc_mix_coder;

static inline void tc_mix_put(tc_mix_coder *c, uint8_t byte)
{
    if (c->at < c->end)
        *c->at++ = byte;
    else
        c->missing++;
}

static inline uint32_t tc_mix_get(tc_mix_coder *c)
{
    if (c->from < c->from_end)
        return *c->from++;
    c->missing++;
    return 0;
}

void tc_mix_encode_begin(tc_mix_coder *c, uint8_t *bytes, size_t room);
size_t tc_mix_encode_end(tc_mix_coder *c, const uint8_t *bytes);
void tc_mix_decode_begin(tc_mix_coder *c, const uint8_t *bytes, size_t size);
/* Whether the bytes are as many as a stream that ended here has. */
bool tc_mix_decode_end(const tc_mix_coder *c);

/* Codes one bit whose probability of being one is p / 65536, 0 < p < 65536. */
static inline int tc_mix_code(tc_mix_coder *c, uint32_t p, int bit, bool encode)
{
    uint32_t middle = c->low + (uint32_t)((uint64_t)(c->high - c->low) * p >> 16);
    if (!encode)
        bit = c->code <= middle;
    if (bit)
        c->high = middle;
    else
        c->low = middle + 1;
    while (((c->low ^ c->high) & 0xff000000u) == 0) {
        if (encode)
            tc_mix_put(c, (uint8_t)(c->high >> 24));
        else
            c->code = c->code << 8 | tc_mix_get(c);
        c->low <<= 8;
        c->high = c->high << 8 | 255;
    }
    return bit;
}

/* One decision from three states and the weights of their logits. */
static inline int tc_mix_bit(const tc_mix_tables *t, tc_mix_coder *c, tc_mix_state *a, tc_mix_state *b, tc_mix_state *d,
                             int32_t weight[TC_MIX_INPUTS], int bit, bool encode)
{
    int32_t logit[TC_MIX_INPUTS] = {t->stretch[*a >> 20], t->stretch[*b >> 20], t->stretch[*d >> 20]};
    int64_t sum = (int64_t)weight[0] * logit[0] + (int64_t)weight[1] * logit[1] + (int64_t)weight[2] * logit[2];
    sum = sum / TC_MIX_ONE;
    int32_t dot = (int32_t)(sum < -TC_LOGIT_LIMIT ? -TC_LOGIT_LIMIT : sum > TC_LOGIT_LIMIT ? TC_LOGIT_LIMIT : sum);
    int32_t p = t->squash[dot + TC_LOGIT_LIMIT];
    bit = tc_mix_code(c, (uint32_t)p, bit, encode);
    int32_t error = (bit ? 65535 : 0) - p;
    for (int k = 0; k < TC_MIX_INPUTS; k++) {
        int32_t w = weight[k] + ((error * logit[k] + (1 << (TC_MIX_RATE - 1))) >> TC_MIX_RATE);
        weight[k] = w < -TC_MIX_WEIGHT_LIMIT ? -TC_MIX_WEIGHT_LIMIT : w > TC_MIX_WEIGHT_LIMIT ? TC_MIX_WEIGHT_LIMIT : w;
    }
    tc_mix_state_learn(t, a, bit), tc_mix_state_learn(t, b, bit), tc_mix_state_learn(t, d, bit);
    return bit;
}

/* One decision of one adaptive probability. */
static inline int tc_mix_plain(const tc_mix_tables *t, tc_mix_coder *c, tc_mix_state *state, int bit, bool encode)
{
    uint32_t p = *state >> 16;
    p = p < TC_MIX_LEAST ? TC_MIX_LEAST : p > 65536 - TC_MIX_LEAST ? 65536 - TC_MIX_LEAST : p;
    bit = tc_mix_code(c, p, bit, encode);
    tc_mix_state_learn(t, state, bit);
    return bit;
}

/* The low `count` bits of value, at even chances. */
static inline uint32_t tc_mix_raw(tc_mix_coder *c, uint32_t value, int count, bool encode)
{
    uint32_t read = 0;
    while (count-- > 0)
        read = read << 1 | (uint32_t)tc_mix_code(c, 1 << 15, (int)(value >> count & 1), encode);
    return read;
}

#endif
