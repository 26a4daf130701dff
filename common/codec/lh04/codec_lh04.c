/* codec_lh04.c - decoding a tile of residuals.
 *
 * A tile's bytes: one byte (0 or 1: four or eight lanes), a rANS stream (rans.h), and raw bits (raw_bits.h). The stream
 * holds a flag for each frequency in the order of coding, number n on lane n modulo lanes: whether the tile has it; at
 * least one it has. Then the magnitudes of those that it has, in the order of codec_lh04_tile.h; a run of a phase
 * starts on lane 0. Raw bits follow the same order: for every run the low bits of magnitudes and what escapes add,
 * then the signs of all that is not zero. The first 16 raw bits of each lane travel in its state. Nothing is left over
 * at the end, and no raw bit behind the last one is set. */
#include "codec_lh04_tile.h"

#include "common/codec/entropy/raw_bits.h"

#if defined __x86_64__ && defined __GNUC__
#define HAVE_AVX2 1
#else
#define HAVE_AVX2 0
#endif

size_t tc_lh04_work_bytes(void)
{
    return sizeof(tc_lh04_work);
}

tc_rect tc_lh04_tile_rect(const tc_lh04_codec *c, int64_t tx, int64_t ty, int64_t shift)
{
    return (tc_rect){tx * SPAN + shift, ty * SPAN, tc_min64((tx + 1) * SPAN, c->level.width) + shift,
                     tc_min64((ty + 1) * SPAN, c->level.height)};
}

/* ---- Symbols ------------------------------------------------------------------------------------------------- */

/* A flag: as tc_rans_decode() of a table with two symbols. */
TC_LH04_INLINE bool decode_flag(tc_rans_decoder *d, int lane, uint32_t empty)
{
    uint32_t x = d->state[lane], slot = x & (TC_RANS_SLOTS - 1);
    bool coded = slot >= empty;
    x = (coded ? TC_RANS_SLOTS - empty : empty) * (x >> TC_RANS_BITS) + slot - (coded ? empty : 0);
    if (x < 1u << 16) {
        uint32_t word = 0;
        if (d->end - d->at >= 2)
            word = (uint32_t)d->at[0] | (uint32_t)d->at[1] << 8, d->at += 2;
        else
            d->overrun = true;
        x = x << 16 | word;
    }
    d->state[lane] = x;
    return coded;
}

/* One step, reading its word without asking whether there is one. */
TC_LH04_INLINE uint32_t fast_step(const tc_rans_table *table, uint32_t *state, const uint8_t **at)
{
    uint32_t symbol = tc_rans_step(table, state), x = *state;
    uint32_t word = (uint32_t)(*at)[0] | (uint32_t)(*at)[1] << 8;
    uint32_t low = -(uint32_t)(x < 1u << 16); /* without a branch: nobody could foresee it */
    *state = x << (low & 16) | (word & low);
    *at += low & 2;
    return symbol;
}

TC_LH04_INLINE void decode_run(const tc_lh04_codec *c, tc_rans_decoder *d, const uint8_t bin[RUN], int count,
                               uint8_t symbol[RUN])
{
    if (count < RUN || d->end - d->at < 2 * RUN) {
        for (int k = 0; k < count; k++)
            symbol[k] = (uint8_t)tc_rans_decode(d, k & (d->lanes - 1), &c->table[bin[k]]);
        for (int k = count; k < RUN; k++)
            symbol[k] = 0;
        return;
    }
    const uint8_t *at = d->at;
    if (d->lanes == RUN)
        for (int k = 0; k < RUN; k++)
            symbol[k] = (uint8_t)fast_step(&c->table[bin[k]], &d->state[k], &at);
    else
        for (int k = 0; k < RUN; k++)
            symbol[k] = (uint8_t)fast_step(&c->table[bin[k]], &d->state[k & 3], &at);
    d->at = at;
}

/* Magnitudes of a frequency. */
TC_LH04_INLINE void decode_band(const tc_lh04_codec *c, tc_rans_decoder *d, int place, int columns, int rows,
                                tc_lh04_work *w)
{
    const tc_lh04_band *b = &c->band[place];
    for (int j = 0; j < rows; j++) {
        tc_lh04_row(b, j, w);
        for (int p = 0; p < TC_PHASES; p++) {
            uint8_t *bin = w->bin[place][j][p], *symbol = w->symbol[place][j][p], *seen = seen_at(w, place, j, p);
            int count = tc_lh04_run(columns, p);
            if (p == 0)
                tc_lh04_bins(b, w, place, 0, j, bin);
            else
                tc_lh04_bins(b, w, place, 1, j, bin);
            decode_run(c, d, bin, count, symbol);
            for (int k = count; k < RUN; k++)
                bin[k] = 0; /* blocks that do not exist have no raw bits */
            for (int k = 0; k < RUN; k++)
                seen[k] = tc_lh04_seen(symbol[k], bin[k]);
        }
    }
    tc_lh04_add(w, place, rows);
}

#define ONES UINT64_C(0x0101010101010101)
#define HIGHS UINT64_C(0x8080808080808080)

/* Signed multiples of the step of a run, every other column of a row; the largest magnitude is gathered in *most. */
TC_LH04_INLINE void decode_values(tc_raw_reader *raw, const uint8_t symbol[RUN], const uint8_t bin[RUN], int32_t *value,
                                  int32_t *most)
{
    uint64_t any, bins, escapes;
    memcpy(&any, symbol, sizeof any), memcpy(&bins, bin, sizeof bins);
    bool plain = ((bins + ONES * (127 - 16)) & HIGHS) == 0; /* bins up to 16 have no low bits */
    if (any == 0 && plain)
        return; /* the row was zero before */
    escapes = (any + ONES * (128 - (TC_RANS_SYMBOLS - 1))) & HIGHS;
    uint32_t v[RUN], mask = 0;
    for (int k = 0; k < RUN; k++)
        v[k] = symbol[k];
    if (escapes || !plain)
        for (int k = 0; k < RUN; k++) {
            if (v[k] == TC_RANS_SYMBOLS - 1)
                v[k] += tc_raw_take_escape(raw);
            int shift = tc_bin_shift[bin[k]];
            v[k] = v[k] << shift | tc_raw_take(raw, shift);
        }
    for (int k = 0; k < RUN; k++)
        mask |= (uint32_t)(v[k] != 0) << k, *most = (int32_t)v[k] > *most ? (int32_t)v[k] : *most;
    uint32_t signs = tc_raw_take(raw, __builtin_popcount(mask));
    for (int k = 0; k < RUN; k++) {
        uint32_t some = mask >> k & 1, minus = -(signs & some);
        value[TC_PHASES * k] = (int32_t)((v[k] ^ minus) - minus);
        signs >>= some;
    }
}

/* Decodes all of a tile but the transform; false where its bytes are damaged. */
TC_LH04_INLINE bool decode_streams(const tc_lh04_codec *c, tc_rect tile, const uint8_t *bytes, size_t size,
                                   int32_t *most, tc_lh04_work *w)
{
    int lanes = bytes[0] & TILE_EIGHT ? 8 : 4, columns, rows;
    tc_rans_decoder d;
    bool any = false;
    if (bytes[0] > TILE_EIGHT || !tc_rans_decode_begin(&d, lanes, bytes + 1, size - 1))
        return false;
    tc_lh04_extent(tile, &columns, &rows);
    for (int n = 0; n < BANDS; n++)
        any |= w->coded[n] = decode_flag(&d, n & (lanes - 1), tc_lh04_empty(c, tc_lh04_flag(&c->band[n], w->coded)));
    if (!any)
        return false;
    memset(w->seen, 0, sizeof w->seen), memset(w->total, 0, sizeof w->total);
    for (int n = 0; n < BANDS && !d.overrun; n++)
        if (w->coded[n])
            decode_band(c, &d, n, columns, rows, w);
    uint8_t payload[TC_RANS_PAYLOAD];
    if (!tc_rans_decode_end(&d, payload))
        return false;
    tc_raw_reader raw = {.at = payload, .end = payload + 2 * lanes, .next = d.at, .next_end = d.end};
    for (int n = 0; n < BANDS; n++) {
        int32_t(*value)[BLOCKS] = w->value[c->band[n].index];
        memset(value, 0, sizeof w->value[0]);
        for (int j = 0; j < rows && w->coded[n]; j++)
            for (int p = 0; p < TC_PHASES; p++)
                decode_values(&raw, w->symbol[n][j][p], w->bin[n][j][p], &value[j][p], most);
    }
    return tc_raw_finished(&raw);
}

/* ---- Transform ----------------------------------------------------------------------------------------------- */

/* RUN blocks beside each other at once: out[k] = (sum over n of matrix[n][k] in[n] + round) >> shift. `wide` is the
 * type of sums; results are the same wherever the narrow one holds them. */
#define INVERSE(wide)                                                                                                  \
    for (int k = 0; k < RUN; k++) {                                                                                    \
        wide x[SIDE], even[4], odd[4];                                                                                 \
        for (int n = 0; n < SIDE; n++)                                                                                 \
            x[n] = in[n * in_stride + k];                                                                              \
        wide a = 64 * (x[0] + x[4]), b = 64 * (x[0] - x[4]), e = 83 * x[2] + 36 * x[6], f = 36 * x[2] - 83 * x[6];     \
        even[0] = a + e, even[1] = b + f, even[2] = b - f, even[3] = a - e;                                            \
        odd[0] = 89 * x[1] + 75 * x[3] + 50 * x[5] + 18 * x[7];                                                        \
        odd[1] = 75 * x[1] - 18 * x[3] - 89 * x[5] - 50 * x[7];                                                        \
        odd[2] = 50 * x[1] - 89 * x[3] + 18 * x[5] + 75 * x[7];                                                        \
        odd[3] = 18 * x[1] - 50 * x[3] + 75 * x[5] - 89 * x[7];                                                        \
        for (int n = 0; n < 4; n++) {                                                                                  \
            out[n * RUN + k] = (even[n] + odd[n] + (1 << (shift - 1))) >> shift;                                       \
            out[(7 - n) * RUN + k] = (even[n] - odd[n] + (1 << (shift - 1))) >> shift;                                 \
        }                                                                                                              \
    }

TC_LH04_INLINE void inverse32(const int32_t *in, ptrdiff_t in_stride, int shift,
                              int32_t *restrict out){INVERSE(int32_t)}

TC_LH04_INLINE void inverse64(const int64_t *in, ptrdiff_t in_stride, int shift, int64_t *restrict out)
{
    INVERSE(int64_t)
}

enum { COEFFICIENT_MOST = 1 << 29, SAMPLE_MOST = 1 << 29, SMALL = 1 << 15, FIRST_SHIFT = 7, SECOND_SHIFT = 8 };

/* Residual of RUN blocks from column i, row j of blocks on: first down the columns, then along the rows. small: no
 * coefficient is above SMALL, and 32 bits are enough for all sums to the end of the tile. */
TC_LH04_INLINE void inverse_blocks(const tc_lh04_codec *c, const bool column[SIDE], int i, int j, bool small,
                                   tc_lh04_work *w)
{
    int32_t step = c->model.step;
    if (small) {
        int32_t half[SIDE][SIDE][RUN] = {{{0}}}, x[SIDE][RUN], y[SIDE][RUN]; /* half[u][y] */
        for (int u = 0; u < SIDE; u++) {
            if (!column[u])
                continue;
            for (int v = 0; v < SIDE; v++)
                for (int k = 0; k < RUN; k++)
                    x[v][k] = w->value[SIDE * v + u][j][i + k] * step;
            inverse32(x[0], RUN, FIRST_SHIFT, half[u][0]);
        }
        for (int r = 0; r < SIDE; r++) {
            int32_t *out = &w->residual[SIDE * j + r][SIDE * i];
            inverse32(half[0][r], SIDE * RUN, SECOND_SHIFT, y[0]);
            for (int k = 0; k < RUN; k++)
                for (int n = 0; n < SIDE; n++)
                    out[SIDE * k + n] = y[n][k];
        }
        return;
    }
    int64_t half[SIDE][SIDE][RUN], x[SIDE][RUN], y[SIDE][RUN];
    for (int u = 0; u < SIDE; u++) {
        for (int v = 0; v < SIDE; v++)
            for (int k = 0; k < RUN; k++)
                x[v][k] =
                    tc_clamp64((int64_t)w->value[SIDE * v + u][j][i + k] * step, -COEFFICIENT_MOST, COEFFICIENT_MOST);
        inverse64(x[0], RUN, FIRST_SHIFT, half[u][0]);
    }
    for (int r = 0; r < SIDE; r++) {
        int32_t *out = &w->residual[SIDE * j + r][SIDE * i];
        inverse64(half[0][r], SIDE * RUN, SECOND_SHIFT, y[0]);
        for (int k = 0; k < RUN; k++)
            for (int n = 0; n < SIDE; n++)
                out[SIDE * k + n] = (int32_t)tc_clamp64(y[n][k], -SAMPLE_MOST, SAMPLE_MOST);
    }
}

/* The filter across an edge: x[0], x[stride] .. x[7 stride]. */
#define LAP(wide)                                                                                                      \
    wide d[4], s[4];                                                                                                   \
    for (int n = 0; n < 4; n++) {                                                                                      \
        wide a = x[(3 - n) * stride], b = x[(4 + n) * stride];                                                         \
        s[n] = (a + b) * (1 << LAP_BITS) + (1 << LAP_BITS), d[n] = a - b;                                              \
    }                                                                                                                  \
    for (int n = 0; n < 4; n++) {                                                                                      \
        wide e = 0;                                                                                                    \
        for (int k = 0; k < 4; k++)                                                                                    \
            e += tc_lh04_lap[n][k] * d[k];                                                                             \
        x[(3 - n) * stride] = (int32_t)((s[n] + e) >> (LAP_BITS + 1));                                                 \
        x[(4 + n) * stride] = (int32_t)((s[n] - e) >> (LAP_BITS + 1));                                                 \
    }

TC_LH04_INLINE void lap32(int32_t *x, ptrdiff_t stride){LAP(int32_t)}

TC_LH04_INLINE void lap64(int32_t *x, ptrdiff_t stride){LAP(int64_t)}

/* All edges between blocks: of columns, then of rows. */
TC_LH04_INLINE void lap_tile(int columns, int rows, bool small, tc_lh04_work *w)
{
    for (int j = SIDE; j < SIDE * rows; j += SIDE)
        for (int i = 0; i < SIDE * columns; i++)
            if (small)
                lap32(&w->residual[j - SIDE / 2][i], SPAN);
            else
                lap64(&w->residual[j - SIDE / 2][i], SPAN);
    for (int j = 0; j < SIDE * rows; j++)
        for (int i = SIDE; i < SIDE * columns; i += SIDE)
            if (small)
                lap32(&w->residual[j][i - SIDE / 2], 1);
            else
                lap64(&w->residual[j][i - SIDE / 2], 1);
}

TC_LH04_INLINE void inverse_tile(const tc_lh04_codec *c, tc_rect tile, int32_t most, const tc_plane *residual,
                                 tc_lh04_work *w)
{
    tc_rect part = tc_rect_intersect(tile, residual->rect);
    bool small = (int64_t)most * c->model.step <= SMALL, column[SIDE] = {false};
    int columns, rows;
    tc_lh04_extent(tile, &columns, &rows);
    for (int n = 0; n < BANDS; n++)
        column[c->band[n].index % SIDE] |= w->coded[n];
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i += RUN)
            if (small)
                inverse_blocks(c, column, i, j, true, w);
            else
                inverse_blocks(c, column, i, j, false, w);
    lap_tile(columns, rows, small, w);
    for (int64_t y = part.y0; y < part.y1; y++)
        memcpy(tc_plane_at(residual, part.x0, y), &w->residual[y - tile.y0][part.x0 - tile.x0],
               (size_t)(part.x1 - part.x0) * sizeof *residual->z);
}

TC_LH04_INLINE tc_status decode_tile(const tc_lh04_codec *c, int64_t tx, int64_t ty, int64_t shift,
                                     const uint8_t *bytes, size_t size, const tc_plane *residual, tc_lh04_work *w)
{
    tc_rect tile = tc_lh04_tile_rect(c, tx, ty, shift);
    int32_t most = 0;
    if (size > 0 && decode_streams(c, tile, bytes, size, &most, w)) {
        inverse_tile(c, tile, most, residual, w);
        return TC_OK;
    }
    tc_rect part = tc_rect_intersect(tile, residual->rect);
    for (int64_t y = part.y0; y < part.y1; y++)
        memset(tc_plane_at(residual, part.x0, y), 0, (size_t)(part.x1 - part.x0) * sizeof *residual->z);
    return size > 0 ? TC_ERR_FORMAT : TC_OK;
}

/* The same code for processors with AVX2 and without. */
#if HAVE_AVX2
__attribute__((target("avx2,bmi,bmi2"), noinline)) static tc_status
decode_tile_avx2(const tc_lh04_codec *c, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes, size_t size,
                 const tc_plane *residual, tc_lh04_work *w)
{
    return decode_tile(c, tx, ty, shift, bytes, size, residual, w);
}
#endif

tc_status tc_lh04_decode_tile(const tc_lh04_codec *codec, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes,
                              size_t size, const tc_plane *residual, tc_lh04_work *work, tc_simd simd)
{
#if HAVE_AVX2
    if (simd == TC_SIMD_AUTO && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
        __builtin_cpu_supports("bmi2"))
        return decode_tile_avx2(codec, tx, ty, shift, bytes, size, residual, work);
#endif
    (void)simd;
    return decode_tile(codec, tx, ty, shift, bytes, size, residual, work);
}
