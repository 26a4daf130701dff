/* codec_tile.c - decoding a tile.
 *
 * A tile's bytes: one byte of flags (bit b: band b is coded; bits 3-4: 0 for 4 lanes, 1 for 8, 2 for 16), a rANS
 * stream (rans.h), and raw bits, low ones first. The symbols (magnitudes) come band after band, row after row, even
 * columns before odd ones; a run of a phase starts on lane 0. Raw bits hold what contexts do not need: for every run
 * the low bits of magnitudes and what escapes add, then the signs of all that is not zero. The first 16 raw bits of
 * each lane travel in its state. Nothing is left over at the end, and no raw bit behind the last one is set. */
#include "codec_tile.h"

#include "codec_avx2.h"
#include "raw_bits.h"

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

/* Eight lanes at once: gathers for the tables, and the words that some lanes want are dealt out by a permutation
 * (Giesen 2014, "SIMD entropy coding"). */
TC_TARGET_AVX2 static inline __m256i decode_8_avx2(const tc_codec *c, __m256i *state, const uint8_t **at,
                                                   const uint8_t *bin)
{
    __m256i b = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)bin)), x = *state;
    /* Offsets of tables, in bytes. What the first gather reads behind slots is still of their table. */
    __m256i table = _mm256_mullo_epi32(b, _mm256_set1_epi32(sizeof(tc_rans_table)));
    __m256i slot = _mm256_and_si256(x, _mm256_set1_epi32(TC_RANS_SLOTS - 1));
    __m256i symbol = _mm256_i32gather_epi32((const int *)c->table[0].slot, _mm256_add_epi32(table, slot), 1);
    symbol = _mm256_and_si256(symbol, _mm256_set1_epi32(TC_RANS_SYMBOLS - 1));
    __m256i entry = _mm256_i32gather_epi32((const int *)c->table[0].symbol,
                                           _mm256_add_epi32(table, _mm256_slli_epi32(symbol, 2)), 1);
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
    return symbol;
}

/* A run that is being decoded on 8 or 16 lanes. Of 16, each half waits for nothing of the other but where its words
 * start, so that the processor works on both at a time. lanes: a constant. */
typedef struct run_avx2 {
    __m256i state[2], symbol[HALF / 8];
    const uint8_t *at;
} run_avx2;

TC_TARGET_AVX2 static inline void run_begin_avx2(run_avx2 *r, const tc_rans_decoder *d)
{
    r->state[0] = load_avx2(d->state), r->state[1] = load_avx2(d->state + 8), r->at = d->at;
}

TC_TARGET_AVX2 static inline void run_step_avx2(const tc_codec *c, run_avx2 *r, int lanes, const uint8_t *bin, int k)
{
    r->symbol[k] = decode_8_avx2(c, &r->state[lanes == 16 ? k % 2 : 0], &r->at, bin + 8 * k);
}

TC_TARGET_AVX2 static inline void run_end_avx2(const run_avx2 *r, int lanes, tc_rans_decoder *d, uint8_t symbol[HALF])
{
    _mm256_storeu_si256((__m256i *)d->state, r->state[0]);
    if (lanes == 16)
        _mm256_storeu_si256((__m256i *)(d->state + 8), r->state[1]);
    d->at = r->at;
    __m256i all = _mm256_packus_epi16(_mm256_packus_epi32(r->symbol[0], r->symbol[1]),
                                      _mm256_packus_epi32(r->symbol[2], r->symbol[3]));
    all = _mm256_permutevar8x32_epi32(all, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
    _mm256_storeu_si256((__m256i *)symbol, all);
}

TC_TARGET_AVX2 static inline void decode_run_avx2(const tc_codec *c, tc_rans_decoder *d, int lanes,
                                                  const uint8_t bin[HALF], uint8_t symbol[HALF])
{
    run_avx2 r;
    run_begin_avx2(&r, d);
    for (int k = 0; k < HALF / 8; k++)
        run_step_avx2(c, &r, lanes, bin, k);
    run_end_avx2(&r, lanes, d, symbol);
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
        run_step_avx2(c, &r0, lanes0, bin0, k);
        run_step_avx2(c, &r1, lanes1, bin1, k);
    }
    run_end_avx2(&r0, lanes0, d0, symbol0);
    run_end_avx2(&r1, lanes1, d1, symbol1);
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
typedef struct tile_state {
    tc_rect rect;
    int64_t shift;
    tc_tile_work *w;
    tc_rans_decoder rans;
    tc_raw_reader raw;
    uint8_t payload[TC_RANS_PAYLOAD];
    int coded; /* bands that are */
    tc_status status;
} tile_state;

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
TC_INLINE void decode_phase(const tc_codec *c, int band, int columns, int j, int phase, tile_state *t, bool simd)
{
    tc_tile_work *w = t->w;
    int count = tc_phase_columns(columns, phase);
    find_bins(c, band, j, phase, w, simd);
    decode_run(c, &t->rans, w->bin[band][j][phase], count, w->symbol[band][j][phase], simd);
    show_symbols(band, count, j, phase, w, simd);
}

TC_INLINE void decode_symbols(const tc_codec *c, int band, tile_state *t, bool simd)
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
decode_phases(const tc_codec *c, int band, const int columns[2], int j, int phase, tile_state t[2])
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
TC_TARGET_AVX2 static inline __attribute__((always_inline)) void decode_symbols_pair(const tc_codec *c, int band,
                                                                                     tile_state t[2])
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
/* Symbols with their signs, of a run that has neither escapes nor low bits. */
TC_TARGET_AVX2 static inline __m256i signed_run_avx2(tc_raw_reader *raw, __m256i symbol)
{
    uint32_t mask = ~(uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(symbol, _mm256_setzero_si256()));
    if (mask == 0)
        return symbol;
    uint32_t negative = _pdep_u32(tc_raw_take(raw, __builtin_popcount(mask)), mask);
    /* Bit k to byte k. */
    __m256i byte =
        _mm256_shuffle_epi8(_mm256_set1_epi32((int32_t)negative),
                            _mm256_setr_epi64x(0, 0x0101010101010101, 0x0202020202020202, 0x0303030303030303));
    __m256i bit = _mm256_set1_epi64x((int64_t)0x8040201008040201);
    __m256i minus = _mm256_cmpeq_epi8(_mm256_and_si256(byte, bit), bit);
    return _mm256_sub_epi8(_mm256_xor_si256(symbol, minus), minus);
}

TC_TARGET_AVX2 static inline void add_8_avx2(__m128i value, __m256i step, int32_t *out)
{
    __m256i v = _mm256_mullo_epi32(_mm256_cvtepi8_epi32(value), step);
    _mm256_storeu_si256((__m256i *)out, _mm256_add_epi32(load_avx2(out), v));
}

/* Signed multiples of one phase of a row, as 16-bit numbers; false, and nothing taken, where an escape is among them.
 */
TC_TARGET_AVX2 static inline bool decode_values_avx2(tc_raw_reader *raw, int band, int j, int phase,
                                                     const tc_tile_work *w, __m256i value[2])
{
    __m256i symbol = load_avx2(w->symbol[band][j][phase]), last = _mm256_set1_epi8(TC_RANS_SYMBOLS - 1);
    __m256i zero = _mm256_setzero_si256(), low = zero;
    if (_mm256_movemask_epi8(_mm256_cmpeq_epi8(symbol, last)))
        return false;
    __m256i by = _mm256_set1_epi8(1);
    if (!w->plain[band][j][phase]) {
        uint64_t masks[HALF / 8], bits[HALF / 8];
        by = power_avx2(load_avx2(w->bin[band][j][phase]));
        _mm256_storeu_si256((__m256i *)masks, _mm256_sub_epi8(by, _mm256_set1_epi8(1)));
        for (int n = 0; n < HALF / 8; n++) /* 4 bits each at most, which makes 32 */
            bits[n] = _pdep_u64(tc_raw_take(raw, __builtin_popcountll(masks[n])), masks[n]);
        low = load_avx2(bits);
    }
    value[0] = _mm256_mullo_epi16(_mm256_unpacklo_epi8(symbol, zero), _mm256_unpacklo_epi8(by, zero));
    value[1] = _mm256_mullo_epi16(_mm256_unpackhi_epi8(symbol, zero), _mm256_unpackhi_epi8(by, zero));
    value[0] = _mm256_or_si256(value[0], _mm256_unpacklo_epi8(low, zero));
    value[1] = _mm256_or_si256(value[1], _mm256_unpackhi_epi8(low, zero));
    uint32_t mask = ~(uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_packus_epi16(value[0], value[1]), zero));
    if (mask == 0)
        return true;
    uint32_t negative = _pdep_u32(tc_raw_take(raw, __builtin_popcount(mask)), mask);
    __m256i byte =
        _mm256_shuffle_epi8(_mm256_set1_epi32((int32_t)negative),
                            _mm256_setr_epi64x(0, 0x0101010101010101, 0x0202020202020202, 0x0303030303030303));
    __m256i bit = _mm256_set1_epi64x((int64_t)0x8040201008040201);
    __m256i minus = _mm256_cmpeq_epi8(_mm256_and_si256(byte, bit), bit);
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

/* Adds one phase of a row; false where it has escapes. */
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

TC_INLINE void add_row(const tc_codec *c, tc_raw_reader *raw, int band, int j, const tc_tile_work *w,
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

/* The part of a tile's row that a plane holds. */
TC_INLINE void put_row(const tc_plane *p, tc_rect part, tc_rect tile, int j, const int32_t row[TC_TILE])
{
    int64_t y = tile.y0 + j;
    if (y >= part.y0 && y < part.y1)
        memcpy(tc_plane_at(p, part.x0, y), row + (part.x0 - tile.x0), (size_t)(part.x1 - part.x0) * sizeof *row);
}

/* Details of the tile from predictions and, where raw is not NULL, what was decoded. */
TC_INLINE void reconstruct(const tc_codec *c, tc_raw_reader *raw, int coded, tc_rect tile, int64_t shift,
                           const tc_plane band[TC_BANDS], tc_tile_work *w, bool simd)
{
    tc_rect part = tc_rect_intersect(tile, band[0].rect);
    tc_predict_hl(c, w);
    int columns, rows;
    tc_tile_extent(c, TC_HL, tile, shift, &columns, &rows);
    for (int j = 0; j < rows && coded >> TC_HL & 1; j++)
        add_row(c, raw, TC_HL, j, w, &w->hl[j + 1][HL_X], simd);
    tc_predict_lh(c, w);
    tc_tile_extent(c, TC_LH, tile, shift, &columns, &rows);
    for (int j = 0; j < rows && coded >> TC_LH & 1; j++)
        add_row(c, raw, TC_LH, j, w, w->pred[j], simd);
    for (int j = 0; j < TC_TILE && !tc_rect_empty(part); j++) {
        put_row(&band[TC_HL], part, tile, j, &w->hl[j + 1][HL_X]);
        put_row(&band[TC_LH], part, tile, j, w->pred[j]);
    }
    tc_tile_extent(c, TC_HH, tile, shift, &columns, &rows);
    for (int j = 0; j < TC_TILE; j++) {
        int32_t row[TC_TILE] = {0};
        if (j < rows && coded >> TC_HH & 1)
            add_row(c, raw, TC_HH, j, w, row, simd);
        if (!tc_rect_empty(part))
            put_row(&band[TC_HH], part, tile, j, row);
    }
}

/* Starts a tile: what its contexts need, and its stream. */
TC_INLINE void begin_tile(const tc_codec *c, const tc_tile_job *job, const tc_plane *coarse, tile_state *t, bool simd)
{
    t->rect = tc_codec_tile_rect(c, job->tx, job->ty, job->shift);
    t->shift = job->shift, t->w = job->work, t->coded = 0, t->status = TC_OK;
    tc_tile_load(c, t->rect, coarse, t->w);
    if (job->size == 0)
        return;
    int flags = job->bytes[0], lanes = 4 << (flags >> TC_TILE_LANES & 3);
    if (flags % (1 << TC_TILE_LANES) == 0 || flags >= 3 << TC_TILE_LANES ||
        !tc_rans_decode_begin(&t->rans, lanes, job->bytes + 1, job->size - 1)) {
        t->status = TC_ERR_FORMAT;
        return;
    }
    t->coded = flags % (1 << TC_TILE_LANES);
    memset(t->w->magnitude, 0, sizeof t->w->magnitude);
#if TC_AVX2
    if (simd)
        tile_curves_avx2(c, t->w);
    else
#endif
        tc_tile_curves(c, t->w);
    (void)simd;
}

/* Details, once all symbols are there; those of the empty tile where the bytes are damaged. */
TC_INLINE tc_status end_tile(const tc_codec *c, const tc_plane band[TC_BANDS], tile_state *t, bool simd)
{
    if (t->coded) {
        t->raw = (tc_raw_reader){
            .at = t->payload, .end = t->payload + 2 * t->rans.lanes, .next = t->rans.at, .next_end = t->rans.end};
        if (!tc_rans_decode_end(&t->rans, t->payload))
            t->coded = 0, t->status = TC_ERR_FORMAT;
    }
    for (;;) {
        reconstruct(c, t->coded ? &t->raw : NULL, t->coded, t->rect, t->shift, band, t->w, simd);
        if (!t->coded || tc_raw_finished(&t->raw))
            return t->status;
        t->coded = 0, t->status = TC_ERR_FORMAT; /* once more */
    }
}

TC_INLINE void decode_tile(const tc_codec *c, tc_tile_job *job, const tc_plane *coarse, bool simd)
{
    tile_state t;
    begin_tile(c, job, coarse, &t, simd);
    if (t.coded >> TC_HL & 1)
        decode_symbols(c, TC_HL, &t, simd);
    if (t.coded >> TC_LH & 1)
        decode_symbols(c, TC_LH, &t, simd);
    if (t.coded >> TC_HH & 1)
        decode_symbols(c, TC_HH, &t, simd);
    job->status = end_tile(c, job->band, &t, simd);
}

/* The same code for processors with AVX2 and without. */
#if TC_AVX2
TC_TARGET_AVX2 static __attribute__((noinline)) void decode_tile_avx2(const tc_codec *c, tc_tile_job *job,
                                                                      const tc_plane *coarse)
{
    decode_tile(c, job, coarse, true);
}

TC_TARGET_AVX2 static __attribute__((noinline)) void begin_tile_avx2(const tc_codec *c, const tc_tile_job *job,
                                                                     const tc_plane *coarse, tile_state *t)
{
    begin_tile(c, job, coarse, t, true);
}

TC_TARGET_AVX2 static __attribute__((noinline)) void decode_symbols_avx2(const tc_codec *c, int band, tile_state *t)
{
    if (band == TC_HL)
        decode_symbols(c, TC_HL, t, true);
    else if (band == TC_LH)
        decode_symbols(c, TC_LH, t, true);
    else
        decode_symbols(c, TC_HH, t, true);
}

TC_TARGET_AVX2 static __attribute__((noinline)) tc_status end_tile_avx2(const tc_codec *c,
                                                                        const tc_plane band[TC_BANDS], tile_state *t)
{
    return end_tile(c, band, t, true);
}

TC_TARGET_AVX2 static void decode_pair_avx2(const tc_codec *c, tc_tile_job job[2], const tc_plane *coarse)
{
    tile_state t[2];
    for (int n = 0; n < 2; n++)
        begin_tile_avx2(c, &job[n], coarse, &t[n]);
    int both = t[0].coded & t[1].coded;
    for (int n = 0; n < 2; n++)
        if ((t[n].coded & ~both) >> TC_HL & 1)
            decode_symbols_avx2(c, TC_HL, &t[n]);
    if (both >> TC_HL & 1)
        decode_symbols_pair(c, TC_HL, t);
    for (int n = 0; n < 2; n++)
        if ((t[n].coded & ~both) >> TC_LH & 1)
            decode_symbols_avx2(c, TC_LH, &t[n]);
    if (both >> TC_LH & 1)
        decode_symbols_pair(c, TC_LH, t);
    for (int n = 0; n < 2; n++)
        if ((t[n].coded & ~both) >> TC_HH & 1)
            decode_symbols_avx2(c, TC_HH, &t[n]);
    if (both >> TC_HH & 1)
        decode_symbols_pair(c, TC_HH, t);
    for (int n = 0; n < 2; n++)
        job[n].status = end_tile_avx2(c, job[n].band, &t[n]);
}
#endif

void tc_codec_decode_pair(const tc_codec *codec, tc_tile_job job[2], const tc_plane *coarse, tc_simd simd)
{
#if TC_AVX2
    if (simd == TC_SIMD_AUTO && tc_have_avx2()) {
        decode_pair_avx2(codec, job, coarse);
        return;
    }
#endif
    (void)simd;
    for (int n = 0; n < 2; n++)
        decode_tile(codec, &job[n], coarse, false);
}

tc_status tc_codec_decode_tile(const tc_codec *codec, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes,
                               size_t size, const tc_plane *coarse, const tc_plane band[TC_BANDS], tc_tile_work *work,
                               tc_simd simd)
{
    tc_tile_job job = {tx, ty, shift, bytes, size, band, work, TC_OK};
#if TC_AVX2
    if (simd == TC_SIMD_AUTO && tc_have_avx2()) {
        decode_tile_avx2(codec, &job, coarse);
        return job.status;
    }
#endif
    (void)simd;
    decode_tile(codec, &job, coarse, false);
    return job.status;
}
