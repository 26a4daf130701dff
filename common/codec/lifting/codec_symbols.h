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

/* Symbols of eight states and the tables' entries for them. By loads, one after the other: gathers take several times
 * as long on processors that keep them from leaking what they read. */
TC_TARGET_AVX2 static inline __m256i look_up_avx2(const tc_codec *c, __m256i slots, const uint8_t *bin, uint8_t *symbol)
{
    _Alignas(32) uint32_t slot[8];
    int32_t entry[8];
    _mm256_store_si256((__m256i *)slot, slots);
#pragma GCC unroll 8
    for (int lane = 0; lane < 8; lane++) {
        const tc_rans_table *table = &c->table[bin[lane]];
        uint32_t s = table->slot[slot[lane]];
        symbol[lane] = (uint8_t)s, entry[lane] = (int32_t)table->symbol[s];
    }
    return _mm256_setr_epi32(entry[0], entry[1], entry[2], entry[3], entry[4], entry[5], entry[6], entry[7]);
}

/* Eight lanes at once; the words that some of them want are dealt out by a permutation (Giesen 2014, "SIMD entropy
 * coding"). */
TC_TARGET_AVX2 static inline void decode_8_avx2(const tc_codec *c, __m256i *state, const uint8_t **at,
                                                const uint8_t *bin, uint8_t *symbol)
{
    __m256i x = *state, slot = _mm256_and_si256(x, _mm256_set1_epi32(TC_RANS_SLOTS - 1));
    __m256i entry = look_up_avx2(c, slot, bin, symbol);
    __m256i frequency = _mm256_and_si256(entry, _mm256_set1_epi32(0xffff));
    x = _mm256_mullo_epi32(frequency, _mm256_srli_epi32(x, TC_RANS_BITS));
    x = _mm256_add_epi32(x, _mm256_sub_epi32(slot, _mm256_srli_epi32(entry, 16)));
    __m256i low = _mm256_cmpeq_epi32(_mm256_srli_epi32(x, 16), _mm256_setzero_si256());
    unsigned mask = (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(low));
    __m256i words = _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)*at));
    __m256i from = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)c->spread[mask]));
    words = _mm256_permutevar8x32_epi32(words, from);
    *state = _mm256_blendv_epi8(x, _mm256_or_si256(_mm256_slli_epi32(x, 16), words), low);
    *at += 2 * __builtin_popcount(mask);
}

/* A run that is being decoded on 8 or 16 lanes. Of 16, each half waits for nothing of the other but where its words
 * start, so that the processor works on both at a time. lanes: a constant. */
typedef struct run_avx2 {
    __m256i state[2];
    const uint8_t *at;
} run_avx2;

TC_TARGET_AVX2 static inline void run_begin_avx2(run_avx2 *r, const tc_rans_decoder *d)
{
    r->state[0] = load_avx2(d->state), r->state[1] = load_avx2(d->state + 8), r->at = d->at;
}

TC_TARGET_AVX2 static inline void run_step_avx2(const tc_codec *c, run_avx2 *r, int lanes, const uint8_t *bin, int k,
                                                uint8_t *symbol)
{
    decode_8_avx2(c, &r->state[lanes == 16 ? k % 2 : 0], &r->at, bin + 8 * k, symbol + 8 * k);
}

TC_TARGET_AVX2 static inline void run_end_avx2(const run_avx2 *r, int lanes, tc_rans_decoder *d)
{
    _mm256_storeu_si256((__m256i *)d->state, r->state[0]);
    if (lanes == 16)
        _mm256_storeu_si256((__m256i *)(d->state + 8), r->state[1]);
    d->at = r->at;
}

TC_TARGET_AVX2 static inline void decode_run_avx2(const tc_codec *c, tc_rans_decoder *d, int lanes,
                                                  const uint8_t bin[HALF], uint8_t symbol[HALF])
{
    run_avx2 r;
    run_begin_avx2(&r, d);
    for (int k = 0; k < HALF / 8; k++)
        run_step_avx2(c, &r, lanes, bin, k, symbol);
    run_end_avx2(&r, lanes, d);
}

/* Runs of two streams in turn: neither waits for the other. */
TC_TARGET_AVX2 static inline void decode_runs_avx2(const tc_codec *c, tc_rans_decoder *d0, tc_rans_decoder *d1,
                                                   int lanes0, int lanes1, const uint8_t *bin0, const uint8_t *bin1,
                                                   uint8_t *symbol0, uint8_t *symbol1)
{
    run_avx2 r0, r1;
    run_begin_avx2(&r0, d0);
    run_begin_avx2(&r1, d1);
    for (int k = 0; k < HALF / 8; k++) {
        run_step_avx2(c, &r0, lanes0, bin0, k, symbol0);
        run_step_avx2(c, &r1, lanes1, bin1, k, symbol1);
    }
    run_end_avx2(&r0, lanes0, d0);
    run_end_avx2(&r1, lanes1, d1);
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

#if TC_AVX2
/* Whether a run can be decoded by vectors without looking where the stream ends. */
TC_INLINE bool is_fast(const tc_rans_decoder *d, int count)
{
    return count == HALF && d->lanes > 4 && d->end - d->at >= 2 * HALF + AHEAD;
}
#endif

/* Symbols of one phase of a row. simd: a constant, whether there is AVX2. */
TC_INLINE void decode_run(const tc_codec *c, tc_rans_decoder *d, const uint8_t bin[HALF], int count,
                          uint8_t symbol[HALF], bool simd)
{
#if TC_AVX2
    if (simd && is_fast(d, count)) {
        if (d->lanes == 16)
            decode_run_avx2(c, d, 16, bin, symbol);
        else
            decode_run_avx2(c, d, 8, bin, symbol);
        return;
    }
#endif
    (void)simd;
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
    int coded; /* bands that are */
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

/* Symbols of one phase of a row. */
TC_INLINE void decode_phase(const tc_codec *c, int band, int columns, int j, int phase, tc_tile_state *t, bool simd)
{
    tc_tile_work *w = t->w;
    int count = tc_phase_columns(columns, phase);
    find_bins(c, band, j, phase, w, simd);
    decode_run(c, &t->rans, w->bin[band][j][phase], count, w->symbol[band][j][phase], simd);
    show_symbols(band, count, j, phase, w, simd);
}

/* A band of a tile. band and simd: constants. */
TC_INLINE void tc_decode_symbols(const tc_codec *c, int band, tc_tile_state *t, bool simd)
{
    int columns, rows;
    tc_tile_extent(c, band, t->rect, t->shift, &columns, &rows);
    for (int j = 0; j < rows; j++) {
        decode_phase(c, band, columns, j, 0, t, simd);
        decode_phase(c, band, columns, j, 1, t, simd);
    }
}

#if TC_AVX2
/* One phase of a row of two tiles that are both there. */
TC_TARGET_AVX2 static inline __attribute__((always_inline)) void
decode_phases(const tc_codec *c, int band, const int columns[2], int j, int phase, tc_tile_state t[2])
{
    tc_tile_work *w0 = t[0].w, *w1 = t[1].w;
    int count[2] = {tc_phase_columns(columns[0], phase), tc_phase_columns(columns[1], phase)};
    if (!is_fast(&t[0].rans, count[0]) || !is_fast(&t[1].rans, count[1])) {
        decode_phase(c, band, columns[0], j, phase, &t[0], true);
        decode_phase(c, band, columns[1], j, phase, &t[1], true);
        return;
    }
    find_bins(c, band, j, phase, w0, true);
    find_bins(c, band, j, phase, w1, true);
    const uint8_t *bin0 = w0->bin[band][j][phase], *bin1 = w1->bin[band][j][phase];
    uint8_t *symbol0 = w0->symbol[band][j][phase], *symbol1 = w1->symbol[band][j][phase];
    int lanes0 = t[0].rans.lanes, lanes1 = t[1].rans.lanes;
    if (lanes0 == 16 && lanes1 == 16)
        decode_runs_avx2(c, &t[0].rans, &t[1].rans, 16, 16, bin0, bin1, symbol0, symbol1);
    else if (lanes0 == 16)
        decode_runs_avx2(c, &t[0].rans, &t[1].rans, 16, 8, bin0, bin1, symbol0, symbol1);
    else if (lanes1 == 16)
        decode_runs_avx2(c, &t[0].rans, &t[1].rans, 8, 16, bin0, bin1, symbol0, symbol1);
    else
        decode_runs_avx2(c, &t[0].rans, &t[1].rans, 8, 8, bin0, bin1, symbol0, symbol1);
    show_symbols(band, HALF, j, phase, w0, true);
    show_symbols(band, HALF, j, phase, w1, true);
}

/* A band of two tiles at a time: the one waits while the other's states become known. */
TC_TARGET_AVX2 static inline __attribute__((always_inline)) void tc_decode_symbols_pair(const tc_codec *c, int band,
                                                                                        tc_tile_state t[2])
{
    int columns[2], rows[2];
    for (int n = 0; n < 2; n++)
        tc_tile_extent(c, band, t[n].rect, t[n].shift, &columns[n], &rows[n]);
    int both = rows[0] < rows[1] ? rows[0] : rows[1];
    for (int j = 0; j < both; j++) {
        decode_phases(c, band, columns, j, 0, t);
        decode_phases(c, band, columns, j, 1, t);
    }
    for (int n = 0; n < 2; n++)
        for (int j = both; j < rows[n]; j++) {
            decode_phase(c, band, columns[n], j, 0, &t[n], true);
            decode_phase(c, band, columns[n], j, 1, &t[n], true);
        }
}
#endif

#endif
