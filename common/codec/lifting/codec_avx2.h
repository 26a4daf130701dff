/* codec_avx2.h - inner loops of codec_tile.h and codec_symbols.h for processors with AVX2: the same results to the
 * bit, which tests/fast/test_codec.c checks. Functions here must only be called where tc_have_avx2() is true; they
 * are not always inlined, as code for other processors mentions them too. */
#ifndef TC_CODEC_AVX2_H
#define TC_CODEC_AVX2_H

#include "codec_tile.h"
#include "common/base/simd.h"

#if TC_AVX2
#include <immintrin.h>

/* ---- Curvatures ---------------------------------------------------------------------------------------------- */

TC_TARGET_AVX2 static inline __m256i load_avx2(const void *p)
{
    return _mm256_loadu_si256((const __m256i *)p);
}

/* curvature() of 8 columns. */
TC_TARGET_AVX2 static inline __m256i curvature_avx2(__m256i sum, __m128i shift)
{
    __m256i v = _mm256_srl_epi32(_mm256_abs_epi32(sum), shift);
    return _mm256_min_epu32(v, _mm256_set1_epi32(CURVE_LIMIT));
}

/* 16 columns, even ones and odd ones apart. */
TC_TARGET_AVX2 static inline void put_curves_avx2(__m256i a, __m256i b, int16_t *even, int16_t *odd)
{
    const __m256i apart =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, 2, 3, 6, 7, 10, 11, 14, 15));
    __m256i v = _mm256_shuffle_epi8(_mm256_packus_epi32(a, b), apart);
    v = _mm256_permutevar8x32_epi32(v, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
    _mm_storeu_si128((__m128i *)even, _mm256_castsi256_si128(v));
    _mm_storeu_si128((__m128i *)odd, _mm256_extracti128_si256(v, 1));
}

/* tc_tile_curves() */
TC_TARGET_AVX2 static inline void tile_curves_avx2(const tc_codec *c, tc_tile_work *w)
{
    const __m128i shift = _mm_cvtsi32_si128(c->coarse_shift);
    for (int j = -1; j <= TC_TILE + 1; j++) {
        const int32_t *p = patch_at(w, 0, j - 1), *q = patch_at(w, 0, j), *r = patch_at(w, 0, j + 1),
                      *s = patch_at(w, 0, j + 2);
        for (int n = 0; n < 5; n++) {
            int i0 = n < 4 ? 16 * n - 2 : TC_TILE + 2 - 16; /* the last 16 columns overlap the ones before */
            __m256i v[CURVES][2];
            for (int m = 0; m < 2; m++) {
                int i = i0 + 8 * m;
                __m256i q0 = load_avx2(q + i), q1 = load_avx2(q + i + 1), r0 = load_avx2(r + i);
                __m256i p0 = load_avx2(p + i), s0 = load_avx2(s + i);
                __m256i before = load_avx2(q + i - 1), after = load_avx2(q + i + 2);
                __m256i h = _mm256_sub_epi32(q0, q1),
                        x = _mm256_sub_epi32(h, _mm256_sub_epi32(r0, load_avx2(r + i + 1)));
                __m256i y = _mm256_sub_epi32(q0, r0);
                __m256i sum = _mm256_sub_epi32(_mm256_add_epi32(before, after), _mm256_add_epi32(q0, q1));
                v[CURVE_H][m] = curvature_avx2(sum, shift);
                sum = _mm256_sub_epi32(_mm256_add_epi32(p0, s0), _mm256_add_epi32(q0, r0));
                v[CURVE_V][m] = curvature_avx2(sum, shift);
                v[CURVE_X2][m] = curvature_avx2(x, shift);
                sum = _mm256_add_epi32(_mm256_sub_epi32(after, before), _mm256_add_epi32(h, _mm256_add_epi32(h, h)));
                v[CURVE_H3][m] = curvature_avx2(sum, shift);
                sum = _mm256_add_epi32(_mm256_sub_epi32(s0, p0), _mm256_add_epi32(y, _mm256_add_epi32(y, y)));
                v[CURVE_V3][m] = curvature_avx2(sum, shift);
            }
            int k = CURVE_X + i0 / 2; /* i0 is even */
            for (int kind = 0; kind < CURVES; kind++)
                put_curves_avx2(v[kind][0], v[kind][1], w->curve[kind][j + 1][0] + k, w->curve[kind][j + 1][1] + k);
        }
    }
}

/* ---- Contexts ------------------------------------------------------------------------------------------------ */

/* 16 bytes as 16-bit numbers. */
TC_TARGET_AVX2 static inline __m256i load8_avx2(const uint8_t *p)
{
    return _mm256_cvtepu8_epi16(_mm_loadu_si128((const __m128i *)p));
}

TC_TARGET_AVX2 static inline __m256i sum8_avx2(const uint8_t *p, const uint8_t *q)
{
    return _mm256_add_epi16(load8_avx2(p), load8_avx2(q));
}

TC_TARGET_AVX2 static inline __m256i sum16_avx2(const int16_t *p, const int16_t *q)
{
    return _mm256_add_epi16(load_avx2(p), load_avx2(q));
}

/* Adds a * low half of pair + b * its high half. Halves of 128 bits are interleaved as _mm256_packs_epi32() undoes. */
TC_TARGET_AVX2 static inline void weigh_avx2(__m256i sum[2], __m256i a, __m256i b, const int32_t *pair)
{
    __m256i weight = _mm256_set1_epi32(*pair);
    sum[0] = _mm256_add_epi32(sum[0], _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), weight));
    sum[1] = _mm256_add_epi32(sum[1], _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), weight));
}

/* One of 32 bytes for each index of 0 ... 31. */
TC_TARGET_AVX2 static inline __m256i choose_avx2(const uint8_t table[TC_BIN_SPANS], __m256i index)
{
    __m256i low = _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)table));
    __m256i high = _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)(table + 16)));
    /* A shuffle gives zero where an index has its uppermost bit. */
    return _mm256_or_si256(_mm256_shuffle_epi8(low, _mm256_add_epi8(index, _mm256_set1_epi8(0x70))),
                           _mm256_shuffle_epi8(high, _mm256_sub_epi8(index, _mm256_set1_epi8(16))));
}

/* Spans of 8 sizes, tc_codec.span_bin, those of 0 and 1 being 0: exponent and uppermost bit of the mantissa. */
TC_TARGET_AVX2 static inline __m256i span_avx2(__m256i size)
{
    return _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(size)), 22);
}

/* tc_context_bins() */
TC_TARGET_AVX2 static inline void context_bins_avx2(const tc_codec *c, tc_tile_work *w, int band, int j, int phase,
                                                    uint8_t bin[HALF])
{
#define CURVE(kind, di, dj) (&w->curve[kind][j + 1 + (dj)][(phase + (di)) & 1][CURVE_X + k + ((phase + (di)) >> 1)])
    const int32_t *pair = c->pair[band][phase], step = c->coarse_scale[band], limit = (INT32_MAX / step) << 6;
    const uint8_t *same = magnitude_at(w, band, j - 1, phase), *same2 = magnitude_at(w, band, j - 2, phase);
    const uint8_t *n = magnitude_at(w, band, j - 1, !phase) - !phase,
                  *nn = magnitude_at(w, band, j - 2, !phase) - !phase;
    const uint8_t *here = magnitude_at(w, band, j, !phase);
    const uint8_t *f4a = phase ? here : same - 1, *f4b = f4a + (phase ? 1 : 2);
    __m256i scale[HALF / 16], span[HALF / 16];
    for (int k = 0; k < HALF; k += 16) {
        __m256i sum[2] = {_mm256_setzero_si256(), _mm256_setzero_si256()}, f5, f6;
        if (band == TC_HL) {
            weigh_avx2(sum, load_avx2(CURVE(CURVE_H, 0, 0)), sum16_avx2(CURVE(CURVE_H, -1, 0), CURVE(CURVE_H, 1, 0)),
                       pair + 4);
            weigh_avx2(sum, sum16_avx2(CURVE(CURVE_H, 0, -1), CURVE(CURVE_H, 0, 1)),
                       _mm256_add_epi16(sum16_avx2(CURVE(CURVE_V, 0, -1), CURVE(CURVE_V, 0, 0)),
                                        sum16_avx2(CURVE(CURVE_V, 1, -1), CURVE(CURVE_V, 1, 0))),
                       pair + 5);
            weigh_avx2(sum, load_avx2(CURVE(CURVE_H3, 0, 0)), _mm256_setzero_si256(), pair + 6);
            f5 = f6 = _mm256_setzero_si256();
        } else if (band == TC_LH) {
            weigh_avx2(sum, load_avx2(CURVE(CURVE_V, 0, 0)), sum16_avx2(CURVE(CURVE_V, 0, -1), CURVE(CURVE_V, 0, 1)),
                       pair + 4);
            weigh_avx2(sum, sum16_avx2(CURVE(CURVE_V, -1, 0), CURVE(CURVE_V, 1, 0)),
                       _mm256_add_epi16(sum16_avx2(CURVE(CURVE_H, -1, 0), CURVE(CURVE_H, 0, 0)),
                                        sum16_avx2(CURVE(CURVE_H, -1, 1), CURVE(CURVE_H, 0, 1))),
                       pair + 5);
            weigh_avx2(sum, load_avx2(CURVE(CURVE_V3, 0, 0)), _mm256_setzero_si256(), pair + 6);
            int left = phase ? k : k - 1;
            f5 = _mm256_add_epi16(
                sum8_avx2(magnitude_at(w, TC_HL, j, !phase) + left, magnitude_at(w, TC_HL, j, phase) + k),
                sum8_avx2(magnitude_at(w, TC_HL, j + 1, !phase) + left, magnitude_at(w, TC_HL, j + 1, phase) + k));
            f6 = sum8_avx2(magnitude_at(w, TC_HL, j - 1, !phase) + left, magnitude_at(w, TC_HL, j - 1, phase) + k);
        } else {
            weigh_avx2(sum, sum16_avx2(CURVE(CURVE_H, 0, 0), CURVE(CURVE_H, 0, 1)),
                       sum16_avx2(CURVE(CURVE_V, 0, 0), CURVE(CURVE_V, 1, 0)), pair + 4);
            weigh_avx2(sum, load_avx2(CURVE(CURVE_X2, 0, 0)), sum16_avx2(CURVE(CURVE_X2, -1, 0), CURVE(CURVE_X2, 1, 0)),
                       pair + 5);
            weigh_avx2(sum, sum16_avx2(CURVE(CURVE_X2, 0, -1), CURVE(CURVE_X2, 0, 1)), _mm256_setzero_si256(),
                       pair + 6);
            int right = phase ? k + 1 : k;
            f5 = sum8_avx2(magnitude_at(w, TC_HL, j, phase) + k, magnitude_at(w, TC_HL, j + 1, phase) + k);
            f6 = sum8_avx2(magnitude_at(w, TC_LH, j, phase) + k, magnitude_at(w, TC_LH, j, !phase) + right);
        }
        for (int m = 0; m < 2; m++) {
            sum[m] = _mm256_srai_epi32(_mm256_min_epi32(sum[m], _mm256_set1_epi32(limit)), 6);
            sum[m] = _mm256_srai_epi32(_mm256_mullo_epi32(sum[m], _mm256_set1_epi32(step)), 14);
            sum[m] = _mm256_add_epi32(sum[m], _mm256_set1_epi32(c->model.scale[band][phase][TC_SCALE - 1]));
        }
        weigh_avx2(sum, load8_avx2(same + k), load8_avx2(same2 + k), pair);
        weigh_avx2(sum, sum8_avx2(n + k, n + k + 1), sum8_avx2(nn + k, nn + k + 1), pair + 1);
        weigh_avx2(sum, sum8_avx2(f4a + k, f4b + k), f5, pair + 2);
        weigh_avx2(sum, f6, _mm256_setzero_si256(), pair + 3);
        for (int m = 0; m < 2; m++)
            sum[m] = _mm256_srai_epi32(sum[m], 2);
        /* This packing cuts off at SCALE_LIMIT. */
        scale[k / 16] = _mm256_packs_epi32(sum[0], sum[1]);
        span[k / 16] = _mm256_subs_epu16(_mm256_packs_epi32(span_avx2(sum[0]), span_avx2(sum[1])),
                                         _mm256_set1_epi16(2 * 127)); /* the exponent of 1 */
    }
    __m256i index = _mm256_min_epu8(_mm256_packus_epi16(span[0], span[1]), _mm256_set1_epi8(TC_BIN_SPANS - 1));
    __m256i low = choose_avx2(c->span_last[0], index), high = choose_avx2(c->span_last[1], index);
    __m256i above = _mm256_packs_epi16(_mm256_cmpgt_epi16(scale[0], _mm256_unpacklo_epi8(low, high)),
                                       _mm256_cmpgt_epi16(scale[1], _mm256_unpackhi_epi8(low, high)));
    __m256i all = _mm256_sub_epi8(choose_avx2(c->span_bin, index), above);
    _mm256_storeu_si256((__m256i *)bin, _mm256_permute4x64_epi64(all, 0xd8));
#undef CURVE
}

/* 2^shift of bins' low bits. */
TC_TARGET_AVX2 static inline __m256i power_avx2(__m256i bin)
{
    const __m256i power = _mm256_broadcastsi128_si256(_mm_setr_epi8(1, 2, 2, 4, 4, 8, 8, 16, 0, 0, 0, 0, 0, 0, 0, 0));
    return _mm256_shuffle_epi8(power, _mm256_subs_epu8(bin, _mm256_set1_epi8(TC_PLAIN_BINS - 1)));
}

/* tc_context_magnitude() of a run; whether no bin of it has low bits. */
TC_TARGET_AVX2 static inline bool show_symbols_avx2(const uint8_t bin[HALF], const uint8_t symbol[HALF],
                                                    uint8_t seen[HALF])
{
    __m256i s = load_avx2(symbol), b = load_avx2(bin);
    __m256i above = _mm256_subs_epu8(b, _mm256_set1_epi8(TC_PLAIN_BINS - 1));
    bool plain = _mm256_testz_si256(above, above);
    if (!plain) {
        __m256i by = power_avx2(b), zero = _mm256_setzero_si256();
        __m256i half = _mm256_and_si256(_mm256_srli_epi16(by, 1), _mm256_set1_epi8(0x7f));
        half = _mm256_andnot_si256(_mm256_cmpeq_epi8(s, zero), half);
        __m256i low = _mm256_mullo_epi16(_mm256_unpacklo_epi8(s, zero), _mm256_unpacklo_epi8(by, zero));
        __m256i high = _mm256_mullo_epi16(_mm256_unpackhi_epi8(s, zero), _mm256_unpackhi_epi8(by, zero));
        s = _mm256_add_epi8(_mm256_packus_epi16(low, high), half);
    }
    _mm256_storeu_si256((__m256i *)seen, s);
    return plain;
}

#endif

#endif
