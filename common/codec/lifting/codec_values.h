/* codec_values.h - a tile's values from its symbols and raw bits, added to rows of predictions. For codec_tile.c alone;
 * inlined so that it can be compiled for more than one processor. */
#ifndef TC_CODEC_VALUES_H
#define TC_CODEC_VALUES_H

#include "codec_avx2.h"
#include "common/codec/entropy/raw_bits.h"

/* Bit k is set where byte k, at most 127, is not zero. */
TC_INLINE uint32_t nonzero_mask(const uint8_t symbol[HALF])
{
    uint32_t mask = 0;
    for (int n = 0; n < HALF; n += 8) {
        uint64_t x = 0;
        memcpy(&x, symbol + n, 8);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
        x = __builtin_bswap64(x);
#endif
        x = (x + 0x7f7f7f7f7f7f7f7f) >> 7 & 0x0101010101010101;
        mask |= (uint32_t)(x * 0x0102040810204080 >> 56) << n;
    }
    return mask;
}

/* Signed multiples of the step of one phase of a row. False, and nothing written, where all are zero. */
TC_INLINE bool decode_values(tc_raw_reader *raw, int band, int j, int phase, const tc_tile_work *w, int32_t value[HALF])
{
    const uint8_t *symbol = w->symbol[band][j][phase], *bin = w->bin[band][j][phase];
    uint32_t mask = nonzero_mask(symbol);
    if (mask == 0 && w->plain[band][j][phase])
        return false;
    uint8_t most = 0;
    for (int k = 0; k < HALF; k++) {
        value[k] = symbol[k];
        most = symbol[k] > most ? symbol[k] : most;
    }
    if (most == TC_RANS_SYMBOLS - 1 || !w->plain[band][j][phase])
        for (int k = 0; k < HALF; k++) {
            uint32_t m = symbol[k];
            if (m == TC_RANS_SYMBOLS - 1)
                m += tc_raw_take_escape(raw);
            int shift = tc_bin_shift[bin[k]];
            value[k] = (int32_t)(m << shift | tc_raw_take(raw, shift));
            mask |= (uint32_t)(value[k] != 0) << k;
        }
    uint32_t signs = tc_raw_take(raw, __builtin_popcount(mask)), negative = 0;
    for (; mask; mask &= mask - 1, signs >>= 1)
        negative |= (mask & -mask) & -(signs & 1);
    for (int k = 0; k < HALF; k++) {
        int32_t minus = -(int32_t)(negative >> k & 1);
        value[k] = (value[k] ^ minus) - minus;
    }
    return true;
}

/* Adds what was coded of one phase of row j to its prediction. */
TC_INLINE void add_phase_any(const tc_codec *c, tc_raw_reader *raw, int band, int j, int phase, const tc_tile_work *w,
                             int32_t out[TC_TILE])
{
    uint32_t step = (uint32_t)c->model.step[band];
    int32_t value[HALF];
    if (decode_values(raw, band, j, phase, w, value))
        for (int k = 0; k < HALF; k++)
            out[TC_PHASES * k + phase] = (int32_t)((uint32_t)out[TC_PHASES * k + phase] + (uint32_t)value[k] * step);
}

/* Adds what was coded of row j. */
TC_INLINE void add_row_any(const tc_codec *c, tc_raw_reader *raw, int band, int j, const tc_tile_work *w,
                           int32_t out[TC_TILE])
{
    for (int phase = 0; phase < TC_PHASES; phase++)
        add_phase_any(c, raw, band, j, phase, w, out);
}

#if TC_AVX2
/* A sign for each bit of mask: byte k is all ones where that of bit k is minus, else 0. */
TC_TARGET_AVX2 static inline __m256i take_signs_avx2(tc_raw_reader *raw, uint32_t mask)
{
    uint32_t negative = _pdep_u32(tc_raw_take(raw, __builtin_popcount(mask)), mask);
    /* Bit k to byte k. */
    __m256i byte =
        _mm256_shuffle_epi8(_mm256_set1_epi32((int32_t)negative),
                            _mm256_setr_epi64x(0, 0x0101010101010101, 0x0202020202020202, 0x0303030303030303));
    __m256i bit = _mm256_set1_epi64x((int64_t)0x8040201008040201);
    return _mm256_cmpeq_epi8(_mm256_and_si256(byte, bit), bit);
}

/* Symbols with their signs, of a run that has neither escapes nor low bits. */
TC_TARGET_AVX2 static inline __m256i signed_run_avx2(tc_raw_reader *raw, __m256i symbol)
{
    uint32_t mask = ~(uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(symbol, _mm256_setzero_si256()));
    if (mask == 0)
        return symbol;
    __m256i minus = take_signs_avx2(raw, mask);
    return _mm256_sub_epi8(_mm256_xor_si256(symbol, minus), minus);
}

TC_TARGET_AVX2 static inline void add_8_avx2(__m128i value, __m256i step, int32_t *out)
{
    __m256i v = _mm256_mullo_epi32(_mm256_cvtepi8_epi32(value), step);
    _mm256_storeu_si256((__m256i *)out, _mm256_add_epi32(load_avx2(out), v));
}

/* Low bits of the magnitudes of a run, as bytes: as many of each as its byte of mask has ones; and what escapes add,
 * the low byte and the high one. False where that is too much for 16 bits. */
TC_TARGET_AVX2 static inline bool take_lows_avx2(tc_raw_reader *raw, uint32_t escapes, const uint64_t mask[HALF / 8],
                                                 uint64_t low[HALF / 8], uint8_t more[2][HALF])
{
    enum { MOST = INT16_MAX / 16 - TC_RANS_SYMBOLS };
    for (int n = 0; n < HALF / 8; n++) { /* 4 bits each at most, which makes 32 */
        uint64_t rest = mask[n];
        low[n] = 0;
        for (uint32_t e = escapes >> 8 * n & 0xff; e; e &= e - 1) { /* an escape, and the low bits before it */
            int k = __builtin_ctz(e);
            uint64_t before = rest & (((uint64_t)1 << 8 * k) - 1);
            low[n] |= _pdep_u64(tc_raw_take(raw, __builtin_popcountll(before)), before);
            rest ^= before;
            uint32_t beyond = tc_raw_take_escape(raw);
            if (beyond > MOST)
                return false;
            more[0][8 * n + k] = (uint8_t)beyond, more[1][8 * n + k] = (uint8_t)(beyond >> 8);
        }
        low[n] |= _pdep_u64(tc_raw_take(raw, __builtin_popcountll(rest)), rest);
    }
    return true;
}

/* Signed multiples of one phase of a row, as 16-bit numbers; false, and nothing taken, where one may be larger. */
TC_TARGET_AVX2 static inline bool decode_values_avx2(tc_raw_reader *raw, int band, int j, int phase,
                                                     const tc_tile_work *w, __m256i value[2])
{
    __m256i symbol = load_avx2(w->symbol[band][j][phase]), last = _mm256_set1_epi8(TC_RANS_SYMBOLS - 1);
    __m256i zero = _mm256_setzero_si256(), low = zero, by = _mm256_set1_epi8(1);
    uint32_t escapes = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(symbol, last));
    value[0] = _mm256_unpacklo_epi8(symbol, zero), value[1] = _mm256_unpackhi_epi8(symbol, zero);
    if (escapes || !w->plain[band][j][phase]) {
        uint64_t masks[HALF / 8], bits[HALF / 8];
        uint8_t more[2][HALF] = {0};
        const tc_raw_reader before = *raw;
        by = power_avx2(load_avx2(w->bin[band][j][phase]));
        _mm256_storeu_si256((__m256i *)masks, _mm256_sub_epi8(by, _mm256_set1_epi8(1)));
        if (!take_lows_avx2(raw, escapes, masks, bits, more)) {
            *raw = before;
            return false;
        }
        low = load_avx2(bits);
        __m256i more_low = load_avx2(more[0]), more_high = load_avx2(more[1]);
        value[0] = _mm256_add_epi16(value[0], _mm256_unpacklo_epi8(more_low, more_high));
        value[1] = _mm256_add_epi16(value[1], _mm256_unpackhi_epi8(more_low, more_high));
    }
    value[0] = _mm256_mullo_epi16(value[0], _mm256_unpacklo_epi8(by, zero));
    value[1] = _mm256_mullo_epi16(value[1], _mm256_unpackhi_epi8(by, zero));
    value[0] = _mm256_or_si256(value[0], _mm256_unpacklo_epi8(low, zero));
    value[1] = _mm256_or_si256(value[1], _mm256_unpackhi_epi8(low, zero));
    __m256i none = _mm256_packs_epi16(_mm256_cmpeq_epi16(value[0], zero), _mm256_cmpeq_epi16(value[1], zero));
    uint32_t mask = ~(uint32_t)_mm256_movemask_epi8(none);
    if (mask == 0)
        return true;
    __m256i minus = take_signs_avx2(raw, mask);
    __m256i minus0 = _mm256_unpacklo_epi8(minus, minus), minus1 = _mm256_unpackhi_epi8(minus, minus);
    value[0] = _mm256_sub_epi16(_mm256_xor_si256(value[0], minus0), minus0);
    value[1] = _mm256_sub_epi16(_mm256_xor_si256(value[1], minus1), minus1);
    return true;
}

/* add_row_any() for a row that has neither escapes nor low bits; false where it has some. */
TC_TARGET_AVX2 static inline bool add_plain_row_avx2(const tc_codec *c, tc_raw_reader *raw, int band, int j,
                                                     const tc_tile_work *w, int32_t out[TC_TILE])
{
    __m256i even = load_avx2(w->symbol[band][j][0]), odd = load_avx2(w->symbol[band][j][1]);
    __m256i any = _mm256_or_si256(even, odd), last = _mm256_set1_epi8(TC_RANS_SYMBOLS - 1);
    bool plain = w->plain[band][j][0] && w->plain[band][j][1];
    if (!plain || _mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epu8(even, odd), last)))
        return false;
    if (_mm256_testz_si256(any, any))
        return true;
    even = signed_run_avx2(raw, even), odd = signed_run_avx2(raw, odd);
    __m256i low = _mm256_unpacklo_epi8(even, odd), high = _mm256_unpackhi_epi8(even, odd);
    __m256i step = _mm256_set1_epi32(c->model.step[band]);
    __m128i part[4] = {_mm256_castsi256_si128(low), _mm256_castsi256_si128(high), _mm256_extracti128_si256(low, 1),
                       _mm256_extracti128_si256(high, 1)};
    for (int n = 0; n < 4; n++) {
        add_8_avx2(part[n], step, out + 16 * n);
        add_8_avx2(_mm_srli_si128(part[n], 8), step, out + 16 * n + 8);
    }
    return true;
}

/* Adds one phase of a row; false where decode_values_avx2() is. */
TC_TARGET_AVX2 static inline bool add_phase_avx2(const tc_codec *c, tc_raw_reader *raw, int band, int j, int phase,
                                                 const tc_tile_work *w, int32_t out[TC_TILE])
{
    __m256i value[2], step = _mm256_set1_epi32(c->model.step[band]), zero = _mm256_setzero_si256();
    if (!decode_values_avx2(raw, band, j, phase, w, value))
        return false;
    __m128i part[4] = {_mm256_castsi256_si128(value[0]), _mm256_castsi256_si128(value[1]),
                       _mm256_extracti128_si256(value[0], 1), _mm256_extracti128_si256(value[1], 1)};
    for (int n = 0; n < 4; n++) {
        /* Eight columns of the phase, spread over sixteen. */
        __m256i v = _mm256_permute4x64_epi64(_mm256_mullo_epi32(_mm256_cvtepi16_epi32(part[n]), step), 0xd8);
        __m256i low = phase ? _mm256_unpacklo_epi32(zero, v) : _mm256_unpacklo_epi32(v, zero);
        __m256i high = phase ? _mm256_unpackhi_epi32(zero, v) : _mm256_unpackhi_epi32(v, zero);
        int32_t *to = out + 16 * n;
        _mm256_storeu_si256((__m256i *)to, _mm256_add_epi32(load_avx2(to), low));
        _mm256_storeu_si256((__m256i *)(to + 8), _mm256_add_epi32(load_avx2(to + 8), high));
    }
    return true;
}

TC_TARGET_AVX2 static inline void add_row_avx2(const tc_codec *c, tc_raw_reader *raw, int band, int j,
                                               const tc_tile_work *w, int32_t out[TC_TILE])
{
    if (!add_plain_row_avx2(c, raw, band, j, w, out))
        for (int phase = 0; phase < TC_PHASES; phase++)
            if (!add_phase_avx2(c, raw, band, j, phase, w, out))
                add_phase_any(c, raw, band, j, phase, w, out);
}
#endif

/* add_row_any(), with AVX2 where simd says so. simd: a constant. */
TC_INLINE void tc_add_row(const tc_codec *c, tc_raw_reader *raw, int band, int j, const tc_tile_work *w,
                          int32_t out[TC_TILE], bool simd)
{
#if TC_AVX2
    if (simd) {
        add_row_avx2(c, raw, band, j, w, out);
        return;
    }
#endif
    (void)simd;
    add_row_any(c, raw, band, j, w, out);
}

#endif
