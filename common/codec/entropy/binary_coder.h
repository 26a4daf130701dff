/* binary_coder.h - adaptive binary range coder, and numbers coded bit by bit with it: for what is small and irregular
 * (index pages, void masks, corrections), where the static tables of rans.h would not pay.
 *
 * Martin 1979, "Range encoding"; carry propagation and the shift-5 adaptation as in Pavlov's LZMA. Probabilities are of
 * a zero, in 1/4096, and belong to the caller. */
#ifndef TC_BINARY_CODER_H
#define TC_BINARY_CODER_H

#include "common/terraclip.h"

typedef uint16_t tc_bit_model;
#define TC_BIT_EVEN ((tc_bit_model)2048)

/* Sets `count` models to even chances. */
void tc_bit_models_reset(tc_bit_model *models, size_t count);

typedef struct tc_bit_encoder {
    uint64_t low;
    uint32_t range;
    uint8_t cache;
    bool started;     /* the first byte, always zero, was left out */
    bool full;        /* room was missing: the stream is useless */
    uint64_t pending; /* bytes held back because a carry may still change them: cache, then 0xff */
    uint8_t *begin, *at, *end;
} tc_bit_encoder;

void tc_bit_encode_begin(tc_bit_encoder *e, uint8_t *bytes, size_t room);
void tc_bit_encode(tc_bit_encoder *e, tc_bit_model *model, int bit);
/* The low `count` bits of value, 0 to 32, without a model. */
void tc_bit_encode_raw(tc_bit_encoder *e, uint32_t value, int count);
/* Bytes written, trailing zeros left out; also 0 where they did not fit: ask `full`. */
size_t tc_bit_encode_end(tc_bit_encoder *e);

typedef struct tc_bit_decoder {
    uint32_t range, code;
    const uint8_t *at, *end;
    size_t missing; /* bytes read beyond the end, as zeros */
} tc_bit_decoder;

void tc_bit_decode_begin(tc_bit_decoder *d, const uint8_t *bytes, size_t size);
int tc_bit_decode(tc_bit_decoder *d, tc_bit_model *model);
uint32_t tc_bit_decode_raw(tc_bit_decoder *d, int count);
/* Whether all bytes were used, as those of a stream that its writer ended here are. Damage is not always noticed. */
bool tc_bit_decode_end(const tc_bit_decoder *d);

/* Non-negative numbers up to 2^32 - 2 in an adaptive exponential Golomb code: the length in unary and the leading bits
 * with models, the rest raw. */
enum { TC_NUMBER_LENGTHS = 32, TC_NUMBER_LEAD = 3 };
typedef struct tc_number_model {
    tc_bit_model length[TC_NUMBER_LENGTHS];
    tc_bit_model lead[TC_NUMBER_LENGTHS][1 << TC_NUMBER_LEAD];
} tc_number_model;

void tc_number_reset(tc_number_model *model);
void tc_number_encode(tc_bit_encoder *e, tc_number_model *model, uint32_t value);
uint32_t tc_number_decode(tc_bit_decoder *d, tc_number_model *model);

/* Signed numbers, |value| < 2^31, small ones first. */
static inline uint32_t tc_zigzag(int32_t value)
{
    return (uint32_t)value << 1 ^ (uint32_t) - (value < 0);
}
static inline int32_t tc_unzigzag(uint32_t code)
{
    return (int32_t)(code >> 1 ^ (uint32_t) - (int32_t)(code & 1));
}

#endif
