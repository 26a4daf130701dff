/* binary_coder.c - the adaptive binary range coder (binary_coder.h). */
#include "binary_coder.h"

enum { PROBABILITY_BITS = 12, ADAPTATION = 5, CODE_BYTES = 4 };
static const uint32_t LOWEST_RANGE = 1u << 24;

void tc_bit_models_reset(tc_bit_model *models, size_t count)
{
    for (size_t i = 0; i < count; i++)
        models[i] = TC_BIT_EVEN;
}

/* Moves a probability of a zero towards what was seen; it stays within 31 .. 4065. */
static void adapt(tc_bit_model *model, int bit)
{
    if (bit)
        *model = (tc_bit_model)(*model - (*model >> ADAPTATION));
    else
        *model = (tc_bit_model)(*model + (((1 << PROBABILITY_BITS) - *model) >> ADAPTATION));
}

/* ---- Encoding ------------------------------------------------------------------------------------------------ */

void tc_bit_encode_begin(tc_bit_encoder *e, uint8_t *bytes, size_t room)
{
    *e = (tc_bit_encoder){.range = UINT32_MAX, .pending = 1, .begin = bytes, .at = bytes, .end = bytes + room};
}

static void emit(tc_bit_encoder *e, uint8_t byte)
{
    if (!e->started)
        e->started = true;
    else if (e->at == e->end)
        e->full = true;
    else
        *e->at++ = byte;
}

/* Takes the top byte off low; bytes that a carry can no longer reach are written. */
static void shift_low(tc_bit_encoder *e)
{
    if (e->low < 0xff000000u || e->low > UINT32_MAX) {
        uint8_t carry = (uint8_t)(e->low >> 32);
        emit(e, (uint8_t)(e->cache + carry));
        while (--e->pending > 0)
            emit(e, (uint8_t)(0xff + carry));
        e->cache = (uint8_t)(e->low >> 24);
    }
    e->pending++;
    e->low = (e->low & 0x00ffffffu) << 8;
}

static void normalise(tc_bit_encoder *e)
{
    while (e->range < LOWEST_RANGE) {
        e->range <<= 8;
        shift_low(e);
    }
}

void tc_bit_encode(tc_bit_encoder *e, tc_bit_model *model, int bit)
{
    uint32_t zero = (e->range >> PROBABILITY_BITS) * *model;
    if (bit)
        e->low += zero, e->range -= zero;
    else
        e->range = zero;
    adapt(model, bit);
    normalise(e);
}

void tc_bit_encode_raw(tc_bit_encoder *e, uint32_t value, int count)
{
    while (count-- > 0) {
        e->range >>= 1;
        if (value >> count & 1)
            e->low += e->range;
        normalise(e);
    }
}

size_t tc_bit_encode_end(tc_bit_encoder *e)
{
    /* Of all numbers within the range the one with the most zeros at its end. */
    uint64_t last = e->low + e->range - 1;
    for (int bits = 32; bits > 0; bits--) {
        uint64_t mask = ((uint64_t)1 << bits) - 1, rounded = (e->low + mask) & ~mask;
        if (rounded <= last) {
            e->low = rounded;
            break;
        }
    }
    for (int i = 0; i < CODE_BYTES + 1; i++)
        shift_low(e);
    while (e->at > e->begin && e->at[-1] == 0)
        e->at--;
    return e->full ? 0 : (size_t)(e->at - e->begin);
}

/* ---- Decoding ------------------------------------------------------------------------------------------------ */

static uint32_t next_byte(tc_bit_decoder *d)
{
    if (d->at < d->end)
        return *d->at++;
    d->missing++;
    return 0;
}

void tc_bit_decode_begin(tc_bit_decoder *d, const uint8_t *bytes, size_t size)
{
    *d = (tc_bit_decoder){.range = UINT32_MAX, .at = bytes, .end = bytes + size};
    for (int i = 0; i < CODE_BYTES; i++)
        d->code = d->code << 8 | next_byte(d);
}

static void refill(tc_bit_decoder *d)
{
    while (d->range < LOWEST_RANGE) {
        d->range <<= 8;
        d->code = d->code << 8 | next_byte(d);
    }
}

int tc_bit_decode(tc_bit_decoder *d, tc_bit_model *model)
{
    uint32_t zero = (d->range >> PROBABILITY_BITS) * *model;
    int bit = d->code >= zero;
    if (bit)
        d->code -= zero, d->range -= zero;
    else
        d->range = zero;
    adapt(model, bit);
    refill(d);
    return bit;
}

uint32_t tc_bit_decode_raw(tc_bit_decoder *d, int count)
{
    uint32_t value = 0;
    while (count-- > 0) {
        d->range >>= 1;
        uint32_t bit = d->code >= d->range;
        d->code -= bit ? d->range : 0;
        value = value << 1 | bit;
        refill(d);
    }
    return value;
}

bool tc_bit_decode_end(const tc_bit_decoder *d)
{
    return d->at == d->end;
}

/* ---- Numbers ------------------------------------------------------------------------------------------------- */

void tc_number_reset(tc_number_model *model)
{
    tc_bit_models_reset(model->length, TC_NUMBER_LENGTHS);
    tc_bit_models_reset(model->lead[0], sizeof model->lead / sizeof(tc_bit_model));
}

void tc_number_encode(tc_bit_encoder *e, tc_number_model *model, uint32_t value)
{
    uint32_t v = value + 1;
    int n = 31 - __builtin_clz(v), node = 1, bit = n;
    for (int i = 0; i < n; i++)
        tc_bit_encode(e, &model->length[i], 1);
    if (n < TC_NUMBER_LENGTHS - 1)
        tc_bit_encode(e, &model->length[n], 0);
    while (bit > 0 && node < 1 << TC_NUMBER_LEAD) {
        int b = (int)(v >> --bit & 1);
        tc_bit_encode(e, &model->lead[n][node], b);
        node = 2 * node + b;
    }
    tc_bit_encode_raw(e, v, bit);
}

uint32_t tc_number_decode(tc_bit_decoder *d, tc_number_model *model)
{
    int n = 0, node = 1;
    while (n < TC_NUMBER_LENGTHS - 1 && tc_bit_decode(d, &model->length[n]))
        n++;
    uint32_t v = 1;
    int bit = n;
    for (; bit > 0 && node < 1 << TC_NUMBER_LEAD; bit--) {
        uint32_t b = (uint32_t)tc_bit_decode(d, &model->lead[n][node]);
        v = v << 1 | b, node = 2 * node + (int)b;
    }
    v = bit > 0 ? v << bit | tc_bit_decode_raw(d, bit) : v;
    return v - 1;
}
