/* codec_symbols.h - decoding a tile's symbols: runs of a rANS stream, each once its bins are known. For codec_tile.c
 * alone; inlined so that it can be compiled for more than one processor. */
#ifndef TC_CODEC_SYMBOLS_H
#define TC_CODEC_SYMBOLS_H

#include "codec_avx2.h"
#include "common/codec/entropy/raw_bits.h"

/* One step, reading its word without asking whether there is one. */
TC_INLINE uint32_t fast_step(const tc_rans_table *table, uint32_t *state, const uint8_t **at)
{
    uint32_t symbol = tc_rans_step(table, state), x = *state;
    uint16_t word;
    memcpy(&word, *at, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap16(word);
#endif
    uint32_t low = -(uint32_t)(x < 1u << 16); /* without a branch: nobody could foresee it */
    *state = x << (low & 16) | (word & low);
    *at += low & 2;
    return symbol;
}

#if TC_AVX2
enum { AHEAD = 16 }; /* bytes that a step of eight lanes loads, whether it needs them or not */

/* The tables' entries for eight states. By loads, one after the other: gathers take several times as long on processors
 * that keep them from leaking what they read. */
TC_TARGET_AVX2 static inline __attribute__((always_inline)) __m256i look_up_avx2(const tc_codec *c, __m256i slots,
                                                                                 const uint8_t *bin)
{
    const uint8_t *tables = c->table[0].slot, *entries = (const uint8_t *)c->table[0].symbol;
    __m256i bins = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)bin));
    _Alignas(32) uint32_t table[8], slot[8];
    int32_t entry[8];
    bins = _mm256_mullo_epi32(bins, _mm256_set1_epi32(sizeof *c->table));
    _mm256_store_si256((__m256i *)table, bins);
    _mm256_store_si256((__m256i *)slot, _mm256_add_epi32(bins, slots));
    /* Loading them again takes less than taking vectors apart, which the compiler would do. */
    __asm__("" : "+m"(table), "+m"(slot));
#pragma GCC unroll 8
    for (int lane = 0; lane < 8; lane++)
        memcpy(&entry[lane], entries + table[lane] + sizeof *entry * tables[slot[lane]], sizeof *entry);
    return _mm256_setr_epi32(entry[0], entry[1], entry[2], entry[3], entry[4], entry[5], entry[6], entry[7]);
}

/* Eight lanes at once; the words that some of them want are dealt out by a permutation (Giesen 2014, "SIMD entropy
 * coding"). Returns their symbols, as bytes. */
TC_TARGET_AVX2 static inline __attribute__((always_inline)) __m128i
decode_8_avx2(const tc_codec *c, __m256i *state, const uint8_t **at, const uint8_t *bin)
{
    const __m256i slots = _mm256_set1_epi32(TC_RANS_SLOTS - 1);
    __m256i x = *state, slot = _mm256_and_si256(x, slots), entry = look_up_avx2(c, slot, bin);
    __m256i frequency = _mm256_and_si256(entry, slots);
    __m256i start = _mm256_and_si256(_mm256_srli_epi32(entry, TC_RANS_BITS), slots);
    x = _mm256_mullo_epi32(frequency, _mm256_srli_epi32(x, TC_RANS_BITS));
    x = _mm256_add_epi32(x, _mm256_sub_epi32(slot, start));
    __m256i low = _mm256_cmpeq_epi32(_mm256_srli_epi32(x, 16), _mm256_setzero_si256());
    unsigned mask = (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(low));
    __m256i words = _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)*at));
    __m256i from = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)c->spread[mask]));
    words = _mm256_permutevar8x32_epi32(words, from);
    *state = _mm256_blendv_epi8(x, _mm256_or_si256(_mm256_slli_epi32(x, 16), words), low);
    *at += 2 * __builtin_popcount(mask);
    entry = _mm256_shuffle_epi8(entry, _mm256_set1_epi32(0x0f0b0703)); /* the bytes with the symbols */
    return _mm_unpacklo_epi32(_mm256_castsi256_si128(entry), _mm256_extracti128_si256(entry, 1));
}

/* Runs of several tiles that are decoded in turn, so that none waits for its own states to become known. Of 16 lanes
 * each half is a turn, too: it waits for nothing of the other but where its words start. count: a constant. */
TC_TARGET_AVX2 static inline __attribute__((always_inline)) void decode_runs_avx2(const tc_codec *c,
                                                                                  tc_rans_decoder *const d[],
                                                                                  const uint8_t *const bin[],
                                                                                  uint8_t *const symbol[], int count)
{
    __m256i state[TC_TOGETHER][2];
    __m128i got[TC_TOGETHER][HALF / 8];
    const uint8_t *at[TC_TOGETHER];
#pragma GCC unroll 4
    for (int n = 0; n < count; n++)
        state[n][0] = load_avx2(d[n]->state), state[n][1] = load_avx2(d[n]->state + 8), at[n] = d[n]->at;
    for (int k = 0; k < HALF / 8; k++)
#pragma GCC unroll 4
        for (int n = 0; n < count; n++)
            got[n][k] = decode_8_avx2(c, &state[n][d[n]->lanes == 16 ? k % 2 : 0], &at[n], bin[n] + 8 * k);
#pragma GCC unroll 4
    for (int n = 0; n < count; n++) {
        __m128i low = _mm_unpacklo_epi64(got[n][0], got[n][1]), high = _mm_unpacklo_epi64(got[n][2], got[n][3]);
        _mm256_storeu_si256((__m256i *)symbol[n], _mm256_set_m128i(high, low));
        _mm256_storeu_si256((__m256i *)d[n]->state, state[n][0]);
        _mm256_storeu_si256((__m256i *)(d[n]->state + 8), state[n][1]);
        d[n]->at = at[n];
    }
}

TC_TARGET_AVX2 static __attribute__((noinline)) void decode_few_avx2(const tc_codec *c, tc_rans_decoder *const d[],
                                                                     const uint8_t *const bin[],
                                                                     uint8_t *const symbol[], int count)
{
    switch (count) {
    case 1: decode_runs_avx2(c, d, bin, symbol, 1); break;
    case 2: decode_runs_avx2(c, d, bin, symbol, 2); break;
    case 3: decode_runs_avx2(c, d, bin, symbol, 3); break;
    case 4: decode_runs_avx2(c, d, bin, symbol, 4); break;
    default: break;
    }
}

/* Whether a run can be decoded by vectors without looking where the stream ends. */
TC_INLINE bool is_fast(const tc_rans_decoder *d, int count)
{
    return count == HALF && d->lanes > 4 && d->end - d->at >= 2 * HALF + AHEAD;
}
#endif

/* A whole run without AVX2. lanes: a constant. */
TC_INLINE void decode_run_lanes(const tc_codec *c, tc_rans_decoder *d, const uint8_t bin[HALF], uint8_t symbol[HALF],
                                int lanes)
{
    uint32_t state[TC_RANS_LANES];
    const uint8_t *at = d->at;
    memcpy(state, d->state, sizeof state);
    for (int k = 0; k < HALF; k += lanes)
        for (int lane = 0; lane < lanes; lane++)
            symbol[k + lane] = (uint8_t)fast_step(&c->table[bin[k + lane]], &state[lane], &at);
    memcpy(d->state, state, sizeof state);
    d->at = at;
}

/* Symbols of one phase of a row. */
TC_INLINE void decode_run(const tc_codec *c, tc_rans_decoder *d, const uint8_t bin[HALF], int count,
                          uint8_t symbol[HALF])
{
    if (count < HALF || d->end - d->at < 2 * HALF) {
        for (int k = 0; k < count; k++)
            symbol[k] = (uint8_t)tc_rans_decode(d, k % d->lanes, &c->table[bin[k]]);
        for (int k = count; k < HALF; k++)
            symbol[k] = 0;
    } else if (d->lanes == 16) {
        decode_run_lanes(c, d, bin, symbol, 16);
    } else if (d->lanes == 8) {
        decode_run_lanes(c, d, bin, symbol, 8);
    } else {
        decode_run_lanes(c, d, bin, symbol, 4);
    }
}

/* A tile that is being decoded. */
typedef struct tc_tile_state {
    tc_rect rect;
    int64_t shift;
    tc_tile_work *w;
    tc_rans_decoder rans;
    tc_raw_reader raw;
    uint8_t payload[TC_RANS_PAYLOAD];
    int coded;   /* bands that are */
    int columns; /* of the band that is being decoded */
    tc_status status;
} tc_tile_state;

/* Bins of one phase of a row. */
TC_INLINE void find_bins(const tc_codec *c, int band, int j, int phase, tc_tile_work *w, bool simd)
{
    uint8_t *bin = w->bin[band][j][phase];
#if TC_AVX2
    if (simd)
        context_bins_avx2(c, w, band, j, phase, bin);
    else
#endif
        tc_context_bins(c, w, band, j, phase, bin);
    (void)simd;
}

/* What the contexts of others see of one phase of a row. */
TC_INLINE void show_symbols(int band, int count, int j, int phase, tc_tile_work *w, bool simd)
{
    uint8_t *bin = w->bin[band][j][phase], *symbol = w->symbol[band][j][phase], *seen = magnitude_at(w, band, j, phase);
    for (int k = count; k < HALF; k++)
        bin[k] = 0; /* columns that do not exist have no raw bits */
#if TC_AVX2
    if (simd) {
        w->plain[band][j][phase] = show_symbols_avx2(bin, symbol, seen);
        return;
    }
#endif
    (void)simd;
    uint8_t most = 0;
    for (int k = 0; k < HALF; k++)
        most = bin[k] > most ? bin[k] : most;
    w->plain[band][j][phase] = tc_bin_shift[most] == 0;
    if (tc_bin_shift[most] == 0)
        memcpy(seen, symbol, HALF);
    else
        for (int k = 0; k < HALF; k++)
            seen[k] = tc_context_magnitude(symbol[k], bin[k]);
}

/* One phase of a row of a few tiles. band and simd: constants. */
TC_INLINE void decode_phases(const tc_codec *c, int band, int j, int phase, tc_tile_state *const t[], int tiles,
                             bool simd)
{
    const uint8_t *bin[TC_TOGETHER];
    uint8_t *symbol[TC_TOGETHER];
    tc_rans_decoder *rans[TC_TOGETHER];
    int fast = 0, count[TC_TOGETHER];
    for (int n = 0; n < tiles; n++) {
        tc_tile_work *w = t[n]->w;
        find_bins(c, band, j, phase, w, simd);
        bin[fast] = w->bin[band][j][phase], symbol[fast] = w->symbol[band][j][phase], rans[fast] = &t[n]->rans;
        count[n] = tc_phase_columns(t[n]->columns, phase);
#if TC_AVX2
        if (simd && is_fast(rans[fast], count[n]))
            fast++;
        else
#endif
            decode_run(c, rans[fast], bin[fast], count[n], symbol[fast]);
    }
#if TC_AVX2
    if (simd)
        decode_few_avx2(c, rans, bin, symbol, fast);
#endif
    for (int n = 0; n < tiles; n++)
        show_symbols(band, count[n], j, phase, t[n]->w, simd);
}

/* A band of a few tiles, of which some may not have it. band and simd: constants. */
TC_INLINE void tc_decode_symbols(const tc_codec *c, int band, tc_tile_state t[], int tiles, bool simd)
{
    int rows[TC_TOGETHER], most = 0;
    for (int n = 0; n < tiles; n++) {
        tc_tile_extent(c, band, t[n].rect, t[n].shift, &t[n].columns, &rows[n]);
        rows[n] = t[n].coded >> band & 1 ? rows[n] : 0;
        most = rows[n] > most ? rows[n] : most;
    }
    for (int j = 0; j < most; j++) {
        tc_tile_state *some[TC_TOGETHER];
        int count = 0;
        for (int n = 0; n < tiles; n++)
            if (j < rows[n])
                some[count++] = &t[n];
        decode_phases(c, band, j, 0, some, count, simd);
        decode_phases(c, band, j, 1, some, count, simd);
    }
}

#endif
