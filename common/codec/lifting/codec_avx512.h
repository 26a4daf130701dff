/* codec_avx512.h - the contexts of codec_avx2.h for processors with AVX-512: a whole run at a time, the same results to
 * the bit. Functions here must only be called where tc_have_avx512() is true. */
#ifndef TC_CODEC_AVX512_H
#define TC_CODEC_AVX512_H

#include "codec_avx2.h"

#if TC_AVX512

TC_TARGET_AVX512 static inline __m512i load_avx512(const void *p)
{
    return _mm512_loadu_si512(p);
}

/* 32 bytes as 16-bit numbers. */
TC_TARGET_AVX512 static inline __m512i load8_avx512(const uint8_t *p)
{
    return _mm512_cvtepu8_epi16(load_avx2(p));
}

TC_TARGET_AVX512 static inline __m512i sum8_avx512(const uint8_t *p, const uint8_t *q)
{
    return _mm512_add_epi16(load8_avx512(p), load8_avx512(q));
}

TC_TARGET_AVX512 static inline __m512i sum16_avx512(const int16_t *p, const int16_t *q)
{
    return _mm512_add_epi16(load_avx512(p), load_avx512(q));
}

/* weigh_avx2() */
TC_TARGET_AVX512 static inline void weigh_avx512(__m512i sum[2], __m512i a, __m512i b, const int32_t *pair)
{
    __m512i weight = _mm512_set1_epi32(*pair);
    sum[0] = _mm512_add_epi32(sum[0], _mm512_madd_epi16(_mm512_unpacklo_epi16(a, b), weight));
    sum[1] = _mm512_add_epi32(sum[1], _mm512_madd_epi16(_mm512_unpackhi_epi16(a, b), weight));
}

/* tc_context_bins(); band and phase: constants. */
TC_TARGET_AVX512 static inline void context_bins_avx512(const tc_codec *c, tc_tile_work *w, int band, int j, int phase, uint8_t bin[HALF])
{
#define CURVE(kind, di, dj) (&w->curve[kind][j + 1 + (dj)][(phase + (di)) & 1][CURVE_X + ((phase + (di)) >> 1)])
    const int32_t *pair = c->pair[band][phase], step = c->coarse_scale[band], limit = (INT32_MAX / step) << 6;
    const uint8_t *same = magnitude_at(w, band, j - 1, phase), *same2 = magnitude_at(w, band, j - 2, phase);
    const uint8_t *n = magnitude_at(w, band, j - 1, !phase) - !phase,
                  *nn = magnitude_at(w, band, j - 2, !phase) - !phase;
    const uint8_t *here = magnitude_at(w, band, j, !phase);
    const uint8_t *f4a = phase ? here : same - 1, *f4b = f4a + (phase ? 1 : 2);
    const __m512i zero = _mm512_setzero_si512();
    __m512i sum[2] = {zero, zero}, f5 = zero, f6 = zero;
    if (band == TC_HL) {
        weigh_avx512(sum, load_avx512(CURVE(CURVE_H, 0, 0)),
                     sum16_avx512(CURVE(CURVE_H, -1, 0), CURVE(CURVE_H, 1, 0)), pair + 4);
        weigh_avx512(sum, sum16_avx512(CURVE(CURVE_H, 0, -1), CURVE(CURVE_H, 0, 1)),
                     _mm512_add_epi16(sum16_avx512(CURVE(CURVE_V, 0, -1), CURVE(CURVE_V, 0, 0)),
                                      sum16_avx512(CURVE(CURVE_V, 1, -1), CURVE(CURVE_V, 1, 0))),
                     pair + 5);
        weigh_avx512(sum, load_avx512(CURVE(CURVE_H3, 0, 0)), zero, pair + 6);
    } else if (band == TC_LH) {
        weigh_avx512(sum, load_avx512(CURVE(CURVE_V, 0, 0)),
                     sum16_avx512(CURVE(CURVE_V, 0, -1), CURVE(CURVE_V, 0, 1)), pair + 4);
        weigh_avx512(sum, sum16_avx512(CURVE(CURVE_V, -1, 0), CURVE(CURVE_V, 1, 0)),
                     _mm512_add_epi16(sum16_avx512(CURVE(CURVE_H, -1, 0), CURVE(CURVE_H, 0, 0)),
                                      sum16_avx512(CURVE(CURVE_H, -1, 1), CURVE(CURVE_H, 0, 1))),
                     pair + 5);
        weigh_avx512(sum, load_avx512(CURVE(CURVE_V3, 0, 0)), zero, pair + 6);
        int left = phase ? 0 : -1;
        f5 = _mm512_add_epi16(
            sum8_avx512(magnitude_at(w, TC_HL, j, !phase) + left, magnitude_at(w, TC_HL, j, phase)),
            sum8_avx512(magnitude_at(w, TC_HL, j + 1, !phase) + left, magnitude_at(w, TC_HL, j + 1, phase)));
        f6 = sum8_avx512(magnitude_at(w, TC_HL, j - 1, !phase) + left, magnitude_at(w, TC_HL, j - 1, phase));
    } else {
        weigh_avx512(sum, sum16_avx512(CURVE(CURVE_H, 0, 0), CURVE(CURVE_H, 0, 1)),
                     sum16_avx512(CURVE(CURVE_V, 0, 0), CURVE(CURVE_V, 1, 0)), pair + 4);
        weigh_avx512(sum, load_avx512(CURVE(CURVE_X2, 0, 0)),
                     sum16_avx512(CURVE(CURVE_X2, -1, 0), CURVE(CURVE_X2, 1, 0)), pair + 5);
        weigh_avx512(sum, sum16_avx512(CURVE(CURVE_X2, 0, -1), CURVE(CURVE_X2, 0, 1)), zero, pair + 6);
        int right = phase ? 1 : 0;
        f5 = sum8_avx512(magnitude_at(w, TC_HL, j, phase), magnitude_at(w, TC_HL, j + 1, phase));
        f6 = sum8_avx512(magnitude_at(w, TC_LH, j, phase), magnitude_at(w, TC_LH, j, !phase) + right);
    }
    for (int m = 0; m < 2; m++) {
        sum[m] = _mm512_srai_epi32(_mm512_min_epi32(sum[m], _mm512_set1_epi32(limit)), 6);
        sum[m] = _mm512_srai_epi32(_mm512_mullo_epi32(sum[m], _mm512_set1_epi32(step)), 14);
        sum[m] = _mm512_add_epi32(sum[m], _mm512_set1_epi32(c->model.scale[band][phase][TC_SCALE - 1]));
    }
    weigh_avx512(sum, load8_avx512(same), load8_avx512(same2), pair);
    weigh_avx512(sum, sum8_avx512(n, n + 1), sum8_avx512(nn, nn + 1), pair + 1);
    weigh_avx512(sum, sum8_avx512(f4a, f4b), f5, pair + 2);
    weigh_avx512(sum, f6, zero, pair + 3);
    __m512i span[2];
    for (int m = 0; m < 2; m++) {
        sum[m] = _mm512_srai_epi32(sum[m], 2);
        span[m] = _mm512_srli_epi32(_mm512_castps_si512(_mm512_cvtepi32_ps(sum[m])), 22);
    }
    /* This packing cuts off at SCALE_LIMIT. */
    __m512i scale = _mm512_packs_epi32(sum[0], sum[1]);
    __m512i index = _mm512_subs_epu16(_mm512_packs_epi32(span[0], span[1]), _mm512_set1_epi16(2 * 127));
    index = _mm512_min_epu16(index, _mm512_set1_epi16(TC_BIN_SPANS - 1));
    __m512i last = _mm512_slli_epi16(load8_avx512(c->span_last[1]), 8);
    last = _mm512_permutexvar_epi16(index, _mm512_or_si512(last, load8_avx512(c->span_last[0])));
    __m512i all = _mm512_permutexvar_epi16(index, load8_avx512(c->span_bin));
    all = _mm512_mask_add_epi16(all, _mm512_cmpgt_epi16_mask(scale, last), all, _mm512_set1_epi16(1));
    _mm256_storeu_si256((__m256i *)bin, _mm512_cvtepi16_epi8(all));
#undef CURVE
}
#endif

#endif
