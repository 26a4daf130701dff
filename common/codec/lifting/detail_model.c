/* detail_model.c - headers of levels.
 *
 * Layout, little-endian: one byte of part numbers (bits 0-1 prediction, 2-3 scale, 4-5 symbols); three steps as
 * base-128 numbers (low 7 bits first, the top bit says that more follow); then what the level has of its own:
 * prediction as 16-bit integers, 8 for HL and 12 for LH; scale weights as one byte each (weight_of()); symbols as a
 * bit stream of logarithms of frequencies, each as the difference from those of built-in set 0. */
#include "detail_model.h"

#include <stdlib.h>
#include <string.h>

/* Powers of 3/2, from 1/128 of a step on. */
const int16_t tc_bin_threshold[TC_BINS - 1] = {2,   3,   5,   7,   10,   15,   23,   34,   51,   77,   115,  173,
                                               259, 389, 584, 876, 1314, 1971, 2956, 4434, 6651, 9976, 14964};
const uint8_t tc_bin_shift[TC_BINS] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4};

/* ---- Numbers on logarithmic scales --------------------------------------------------------------------------- */

/* 2^(n/16) in 1/4096, 0 <= n < 16. */
static const uint16_t root[16] = {4096, 4277, 4467, 4664, 4871, 5087, 5312, 5547,
                                  5793, 6049, 6317, 6597, 6889, 7194, 7512, 7845};

/* Weight of a code: 0 is 0, then 2^((code - 1) / 16), at most 2^13. */
static uint32_t weight_of(int code)
{
    return code == 0 ? 0 : ((((uint32_t)root[(code - 1) % 16] << (code - 1) / 16) + 2048) >> 12);
}

enum { WEIGHT_CODES = 13 * 16 + 2, LOG_CODES = 12 * 8 + 1 };

/* The code, of `codes`, whose value is nearest; the lowest of equals. Values never fall from code to code. */
static int nearest_code(uint32_t (*value_of)(int code), int codes, uint32_t value)
{
    int low = 0, high = codes - 1; /* the first code that is not below, or the last */
    while (low < high) {
        int middle = (low + high) / 2;
        if (value_of(middle) < value)
            low = middle + 1;
        else
            high = middle;
    }
    int below = low > 0 ? low - 1 : low;
    while (below > 0 && value_of(below - 1) == value_of(below))
        below--;
    return (int64_t)value - value_of(below) <= llabs((int64_t)value_of(low) - value) ? below : low;
}

static int weight_code(uint32_t weight)
{
    return nearest_code(weight_of, WEIGHT_CODES, weight);
}

/* Frequency of a logarithm: 2^(code/8). */
static uint32_t frequency_of(int code)
{
    return ((uint32_t)root[code % 8 * 2] << code / 8) >> 12;
}

static int frequency_code(uint32_t frequency)
{
    return nearest_code(frequency_of, LOG_CODES, frequency);
}

static tc_rans_frequencies frequencies_of(const uint8_t code[TC_RANS_SYMBOLS])
{
    uint64_t w[TC_RANS_SYMBOLS];
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        w[s] = frequency_of(code[s]);
    return tc_rans_normalise(w);
}

static void frequency_codes(const tc_rans_frequencies *f, uint8_t code[TC_RANS_SYMBOLS])
{
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        code[s] = (uint8_t)frequency_code(f->of[s]);
}

/* Codes of weights whose sum stays within 65535. */
static void weight_codes(const uint16_t scale[TC_SCALE], uint8_t code[TC_SCALE])
{
    for (int shift = 0;; shift++) {
        uint32_t sum = 0;
        for (int k = 0; k < TC_SCALE; k++)
            sum += weight_of(code[k] = (uint8_t)weight_code((uint32_t)scale[k] >> shift));
        if (sum <= UINT16_MAX)
            return;
    }
}

/* ---- Header -------------------------------------------------------------------------------------------------- */

/* Bits, low ones first. */
typedef struct bit_writer {
    uint8_t *bytes;
    size_t bits;
} bit_writer;

static void put_bits(bit_writer *w, uint32_t value, int count)
{
    for (int i = 0; i < count; i++, w->bits++) {
        if (w->bits % 8 == 0)
            w->bytes[w->bits / 8] = 0;
        w->bytes[w->bits / 8] |= (uint8_t)((value >> i & 1) << w->bits % 8);
    }
}

typedef struct bit_reader {
    const uint8_t *bytes;
    size_t bits, end; /* in bits */
    bool failed;
} bit_reader;

static uint32_t get_bits(bit_reader *r, int count)
{
    uint32_t value = 0;
    for (int i = 0; i < count; i++, r->bits++) {
        if (r->bits >= r->end) {
            r->failed = true;
            return 0;
        }
        value |= (uint32_t)(r->bytes[r->bits / 8] >> r->bits % 8 & 1) << i;
    }
    return value;
}

enum { UNARY_LIMIT = 200 };

/* Golomb-Rice code with one low bit of the difference folded to 0, -1, 1, -2, ... */
static void put_difference(bit_writer *w, int difference)
{
    uint32_t folded = difference < 0 ? (uint32_t)(-2 * difference - 1) : (uint32_t)(2 * difference);
    for (uint32_t i = 0; i < folded >> 1; i++)
        put_bits(w, 1, 1);
    put_bits(w, 0, 1);
    put_bits(w, folded & 1, 1);
}

static int get_difference(bit_reader *r)
{
    uint32_t folded = 0;
    while (!r->failed && folded < UNARY_LIMIT && get_bits(r, 1))
        folded++;
    folded = folded << 1 | get_bits(r, 1);
    return folded & 1 ? -(int)(folded + 1) / 2 : (int)folded / 2;
}

size_t tc_detail_model_bound(void)
{
    return 1 + 3 * 5 + 2 * (TC_PREDICT_KERNEL + TC_PREDICT) + TC_BANDS * TC_PHASES * TC_SCALE +
           TC_BINS * (1 + TC_RANS_SYMBOLS * (LOG_CODES + 2)) / 8 + 8;
}

size_t tc_detail_model_write(const tc_detail_model *model, tc_detail_parts parts, uint8_t *bytes)
{
    bit_writer w = {bytes, 0};
    put_bits(&w, (uint32_t)(parts.predict | parts.scale << 2 | parts.symbols << 4), 8);
    for (int b = 0; b < TC_BANDS; b++) {
        uint32_t v = (uint32_t)model->step[b];
        for (; v >> 7; v >>= 7)
            put_bits(&w, 0x80 | (v & 0x7f), 8);
        put_bits(&w, v, 8);
    }
    if (parts.predict == TC_MODEL_OWN)
        for (int b = 0; b < 2; b++)
            for (int k = 0; k < (b == TC_HL ? TC_PREDICT_KERNEL : TC_PREDICT); k++)
                put_bits(&w, (uint16_t)model->predict[b][k], 16);
    if (parts.scale == TC_MODEL_OWN)
        for (int b = 0; b < TC_BANDS; b++)
            for (int p = 0; p < TC_PHASES; p++) {
                uint8_t code[TC_SCALE];
                weight_codes(model->scale[b][p], code);
                for (int k = 0; k < TC_SCALE; k++)
                    put_bits(&w, code[k], 8);
            }
    if (parts.symbols == TC_MODEL_OWN) {
        tc_detail_model base;
        tc_detail_model_builtin(0, &base);
        for (int b = 0; b < TC_BINS; b++) {
            uint8_t code[TC_RANS_SYMBOLS], from[TC_RANS_SYMBOLS];
            bool same = memcmp(&model->symbols[b], &base.symbols[b], sizeof base.symbols[b]) == 0;
            put_bits(&w, !same, 1);
            frequency_codes(&model->symbols[b], code), frequency_codes(&base.symbols[b], from);
            for (int s = 0; s < TC_RANS_SYMBOLS && !same; s++)
                put_difference(&w, code[s] - from[s]);
        }
    }
    return (w.bits + 7) / 8;
}

tc_status tc_detail_model_read(const uint8_t *bytes, size_t size, tc_detail_model *model_ret,
                               tc_detail_parts *parts_ret)
{
    bit_reader r = {bytes, 0, size * 8, false};
    tc_detail_model model = {0}, base;
    tc_detail_parts parts = {(int)get_bits(&r, 2), (int)get_bits(&r, 2), (int)get_bits(&r, 2)};
    const int part[3] = {parts.predict, parts.scale, parts.symbols};
    for (int i = 0; i < 3; i++)
        if (part[i] != TC_MODEL_OWN && part[i] >= TC_BUILTIN_MODELS)
            return TC_ERR_FORMAT;
    if (get_bits(&r, 2) != 0)
        return TC_ERR_FORMAT;
    for (int b = 0; b < TC_BANDS; b++) {
        uint32_t v = 0, byte = 0x80;
        for (int i = 0; i < 4 && byte & 0x80; i++)
            v |= ((byte = get_bits(&r, 8)) & 0x7f) << 7 * i;
        if (byte & 0x80 || v < 1 || v > TC_MAX_STEP)
            return TC_ERR_FORMAT;
        model.step[b] = (int32_t)v;
    }
    if (parts.predict == TC_MODEL_OWN)
        for (int b = 0; b < 2; b++)
            for (int k = 0; k < (b == TC_HL ? TC_PREDICT_KERNEL : TC_PREDICT); k++)
                model.predict[b][k] = (int16_t)(uint16_t)get_bits(&r, 16);
    if (parts.scale == TC_MODEL_OWN)
        for (int b = 0; b < TC_BANDS; b++)
            for (int p = 0; p < TC_PHASES; p++) {
                uint32_t sum = 0;
                for (int k = 0; k < TC_SCALE; k++) {
                    int code = (int)get_bits(&r, 8);
                    if (code >= WEIGHT_CODES)
                        return TC_ERR_FORMAT;
                    sum += model.scale[b][p][k] = weight_of(code);
                }
                if (sum > UINT16_MAX)
                    return TC_ERR_FORMAT;
            }
    if (parts.symbols == TC_MODEL_OWN) {
        tc_detail_model_builtin(0, &base);
        for (int b = 0; b < TC_BINS; b++) {
            uint8_t code[TC_RANS_SYMBOLS];
            model.symbols[b] = base.symbols[b];
            if (!get_bits(&r, 1))
                continue;
            frequency_codes(&base.symbols[b], code);
            for (int s = 0; s < TC_RANS_SYMBOLS; s++) {
                int c = code[s] + get_difference(&r);
                if (c < 0 || c >= LOG_CODES)
                    return TC_ERR_FORMAT;
                code[s] = (uint8_t)c;
            }
            model.symbols[b] = frequencies_of(code);
        }
    }
    while (r.bits % 8 != 0)
        if (get_bits(&r, 1))
            return TC_ERR_FORMAT;
    if (r.failed || r.bits != r.end)
        return TC_ERR_FORMAT;
    for (int i = 0; i < 3; i++)
        if (part[i] != TC_MODEL_OWN) {
            tc_detail_model_builtin(part[i], &base);
            if (i == 0)
                memcpy(model.predict, base.predict, sizeof base.predict);
            else if (i == 1)
                memcpy(model.scale, base.scale, sizeof base.scale);
            else
                memcpy(model.symbols, base.symbols, sizeof base.symbols);
        }
    *model_ret = model;
    *parts_ret = parts;
    return TC_OK;
}
