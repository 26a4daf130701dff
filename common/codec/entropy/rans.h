/* rans.h - range asymmetric numeral systems with static tables of 12 bits and 4, 8 or 16 interleaved states.
 *
 * Duda 2013, "Asymmetric numeral systems"; Giesen 2014, "Interleaved entropy coders". States are 32 bits in
 * [2^16, 2^32) and renormalise by 16 bits. A stream decodes forwards: the states, little-endian, then 16-bit words;
 * symbol number k of a run belongs to state k mod `lanes`. Few lanes cost fewer bytes (about one each), many decode
 * faster. The
 * encoder works backwards from the last symbol. It does not start from empty states: the low 16 bits of each are
 * payload, so that closing a stream wastes no room where the caller has 2 bytes a lane of other data to put there. */
#ifndef TC_RANS_H
#define TC_RANS_H

#include "common/terraclip.h"

enum {
    TC_RANS_BITS = 12,
    TC_RANS_SLOTS = 1 << TC_RANS_BITS,
    TC_RANS_SYMBOLS = 16,
    TC_RANS_LANES = 16,                  /* at most */
    TC_RANS_PAYLOAD = 2 * TC_RANS_LANES, /* bytes carried by the states, at most: two for each */
    TC_RANS_HEAD = 4 * TC_RANS_LANES     /* bytes in front of the words, at most: four for each */
};

/* Frequencies of the symbols, each at least 1, TC_RANS_SLOTS in all. */
typedef struct tc_rans_frequencies {
    uint16_t of[TC_RANS_SYMBOLS];
} tc_rans_frequencies;

/* A decoding table: the symbol of each slot, and for each symbol its frequency, which is below 2^12, from bit 12 on its
 * first slot, and from bit 24 on itself. In two parts, so that the tables in use fit into the first cache. */
typedef struct tc_rans_table {
    uint8_t slot[TC_RANS_SLOTS];
    uint32_t symbol[TC_RANS_SYMBOLS];
} tc_rans_table;

/* Frequencies nearest to weights (any non-negative integers; all zero: uniform). */
tc_rans_frequencies tc_rans_normalise(const uint64_t weight[TC_RANS_SYMBOLS]);

/* Whether the frequencies are as they must be. */
bool tc_rans_valid(const tc_rans_frequencies *frequencies);

/* frequencies must be valid. */
void tc_rans_table_build(const tc_rans_frequencies *frequencies, tc_rans_table *table);

/* ---- Encoding ------------------------------------------------------------------------------------------------ */

typedef struct tc_rans_encoder {
    uint32_t state[TC_RANS_LANES];
    int lanes;
    uint8_t *begin, *at; /* words are put in front of `at` */
} tc_rans_encoder;

/* Bytes that `symbols` symbols can take at most, head included. */
static inline size_t tc_rans_bound(size_t symbols)
{
    return TC_RANS_HEAD + 2 * symbols;
}

/* Starts a stream that ends at `end` and grows towards `begin`, which the caller puts tc_rans_bound() before it. */
void tc_rans_encode_begin(tc_rans_encoder *e, int lanes, uint8_t *begin, uint8_t *end, const uint8_t *payload);

/* A symbol to encode. */
typedef struct tc_rans_symbol {
    uint64_t reciprocal; /* 2^44 / frequency, rounded up */
    uint32_t start, frequency;
} tc_rans_symbol;

/* The symbol of `frequency` slots from `start` on. */
static inline tc_rans_symbol tc_rans_symbol_of(uint32_t start, uint32_t frequency)
{
    return (tc_rans_symbol){(((uint64_t)1 << 44) + frequency - 1) / frequency, start, frequency};
}

/* frequencies must be valid. */
void tc_rans_symbols_build(const tc_rans_frequencies *frequencies, tc_rans_symbol symbol[TC_RANS_SYMBOLS]);

/* Puts one symbol on a state, a word in front of *at; last symbol first. The two bytes there are written in any case.
 * The division is exact: x < frequency * 2^20 by then, so that the product stays below 2^64 and, as frequency < 2^12,
 * what rounding the reciprocal adds to it below 2^44 / frequency. */
static inline void tc_rans_put(const tc_rans_symbol *symbol, uint32_t *state, uint8_t **at)
{
    uint32_t x = *state, frequency = symbol->frequency, full = x >= frequency << (32 - TC_RANS_BITS);
    (*at)[-2] = (uint8_t)x, (*at)[-1] = (uint8_t)(x >> 8);
    *at -= 2 * full;
    x >>= 16 * full;
    uint32_t quotient = (uint32_t)(x * symbol->reciprocal >> 44);
    *state = x + symbol->start + quotient * (TC_RANS_SLOTS - frequency);
}

/* Writes the head; the stream is e->at up to the end that was given. */
void tc_rans_encode_end(tc_rans_encoder *e);

/* ---- Decoding ------------------------------------------------------------------------------------------------ */

typedef struct tc_rans_decoder {
    uint32_t state[TC_RANS_LANES];
    int lanes;
    const uint8_t *at, *end;
    bool overrun; /* words were missing and read as zero */
} tc_rans_decoder;

/* False where the head is missing or holds an impossible state. */
bool tc_rans_decode_begin(tc_rans_decoder *d, int lanes, const uint8_t *bytes, size_t size);

/* One step without any check: the symbol of the state, and the state behind it. */
static inline uint32_t tc_rans_step(const tc_rans_table *table, uint32_t *state)
{
    uint32_t x = *state, slot = x & (TC_RANS_SLOTS - 1), symbol = table->slot[slot], entry = table->symbol[symbol];
    *state = (entry & (TC_RANS_SLOTS - 1)) * (x >> TC_RANS_BITS) + slot - (entry >> TC_RANS_BITS & (TC_RANS_SLOTS - 1));
    return symbol;
}

/* Decodes one symbol with every check. */
static inline uint32_t tc_rans_decode(tc_rans_decoder *d, int lane, const tc_rans_table *table)
{
    uint32_t symbol = tc_rans_step(table, &d->state[lane]);
    if (d->state[lane] < 1u << 16) {
        uint32_t word = 0;
        if (d->end - d->at >= 2)
            word = (uint32_t)d->at[0] | (uint32_t)d->at[1] << 8, d->at += 2;
        else
            d->overrun = true;
        d->state[lane] = d->state[lane] << 16 | word;
    }
    return symbol;
}

/* The payload of the states once every symbol is decoded; false where the stream is damaged. */
bool tc_rans_decode_end(const tc_rans_decoder *d, uint8_t *payload);

#endif
