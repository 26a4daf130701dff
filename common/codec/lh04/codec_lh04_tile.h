/* codec_lh04_tile.h - inside a tile of codec_lh04.h: the transform and the contexts. Shared by encoder and decoder,
 * which must agree to the bit; inlined so that the decoder can be compiled for more than one processor.
 *
 * Frequency after frequency, all blocks of the tile row by row, even columns of blocks before odd ones. The expected
 * magnitude of a coefficient is a weighted sum of magnitudes known by then: of the same frequency in blocks around it,
 * and, in proportion to the mean magnitudes of the frequencies, of frequencies beside it in the same block, of all
 * frequencies before it in the same block and in the four blocks around it, and a constant. */
#ifndef TC_CODEC_LH04_TILE_H
#define TC_CODEC_LH04_TILE_H

#include <string.h>

#include "codec_lh04.h"
#include "common/base/rect.h"

#define TC_LH04_INLINE static inline __attribute__((always_inline))

enum {
    SIDE = TC_LH04_SIDE,
    BANDS = TC_LH04_BANDS,
    SPAN = TC_LH04_SPAN,
    BLOCKS = TC_LH04_BLOCKS,
    RUN = BLOCKS / TC_PHASES, /* blocks of a phase of a row */
    SEEN_X = 4,
    SEEN_STRIDE = RUN + 2 * SEEN_X,
    SEEN_ROWS = BLOCKS + 3, /* rows -2 .. BLOCKS */
    TOTAL_LIMIT = 4095,
    SCALE_MOST = 32767,
    TILE_EIGHT = 1 /* flag of a tile: eight lanes */
};

/* Features. */
enum { F_N, F_NN, F_DIAGONAL, F_SIDES, F_NEAR, F_FAR, F_BLOCK, F_AROUND, F_ONE };

struct tc_lh04_work {
    uint8_t seen[BANDS][SEEN_ROWS][TC_PHASES][SEEN_STRIDE]; /* magnitudes as contexts see them, by place */
    int16_t total[SEEN_ROWS][TC_PHASES][SEEN_STRIDE];       /* of all frequencies so far */
    int16_t near[TC_PHASES][RUN], far[TC_PHASES][RUN];      /* of one row */
    uint8_t symbol[BANDS][BLOCKS][TC_PHASES][RUN];
    uint8_t bin[BANDS][BLOCKS][TC_PHASES][RUN];
    int32_t value[BANDS][BLOCKS][BLOCKS];    /* by frequency, not place: multiples of the step */
    bool coded[BANDS];                       /* by place */
    uint16_t order[BANDS * BLOCKS * BLOCKS]; /* encoder: bin, symbol, lane, in the order of decoding */
    double exact[BANDS][BLOCKS][BLOCKS];     /* encoder: coefficients in steps, by frequency */
    double smooth[SPAN][SPAN];               /* encoder: residual before the transform of blocks */
    int32_t residual[SPAN][SPAN];
};

/* ---- Transform ------------------------------------------------------------------------------------------------
 *
 * A lapped orthogonal transform (Malvar, Staelin 1989) as a filter across the edges of blocks behind the inverse DCT
 * (Tran, Liang, Tu 2003, "Lapped transform via time-domain pre- and post-filtering"), within the tile. Of the 8 samples
 * x across an edge, with s[i] = x[i] + x[7 - i] and d[i] = x[3 - i] - x[4 + i], the filter makes
 *     x[3 - i], x[4 + i] = (s[3 - i] +- sum over k of lap[i][k] d[k]) / 2. */

/* In 1/256; C4^T C2 of 4 points, both mirrored. The encoder takes the inverse of just these numbers. */
static const int16_t tc_lh04_lap[4][4] = {
    {207, -146, 31, -21}, {143, 179, -114, -7}, {37, 108, 220, -64}, {31, 21, 56, 247}};
enum { LAP_BITS = 8 };

/* Rows of the matrix are 2^7.5 times an orthonormal basis, to a thousandth; that of H.265. */
static const int8_t tc_lh04_dct[SIDE][SIDE] = {
    {64, 64, 64, 64, 64, 64, 64, 64},     {89, 75, 50, 18, -18, -50, -75, -89}, {83, 36, -36, -83, -83, -36, 36, 83},
    {75, -18, -89, -50, 50, 89, 18, -75}, {64, -64, -64, 64, 64, -64, -64, 64}, {50, -89, 18, 75, -75, -18, 89, -50},
    {36, -83, 83, -36, -36, 83, -83, 36}, {18, -50, 75, -89, 89, -75, 50, -18},
};

/* Blocks of a tile. */
TC_LH04_INLINE void tc_lh04_extent(tc_rect tile, int *columns, int *rows)
{
    *columns = (int)((tile.x1 - tile.x0 + SIDE - 1) / SIDE), *rows = (int)((tile.y1 - tile.y0 + SIDE - 1) / SIDE);
}

TC_LH04_INLINE int tc_lh04_run(int columns, int phase)
{
    return (columns + 1 - phase) / 2;
}

TC_LH04_INLINE uint8_t *seen_at(tc_lh04_work *w, int place, int j, int phase)
{
    return &w->seen[place][j + 2][phase][SEEN_X];
}

TC_LH04_INLINE int16_t *total_at(tc_lh04_work *w, int j, int phase)
{
    return &w->total[j + 2][phase][SEEN_X];
}

/* Context of the flag that says whether a tile has a frequency: its mean, and how many beside it the tile has. */
TC_LH04_INLINE int tc_lh04_flag(const tc_lh04_band *b, const bool coded[BANDS])
{
    int n = 0;
    for (int i = 0; i < b->nears; i++)
        n += coded[b->near[i]];
    return b->flag + (n > 2 ? 2 : n);
}

/* Frequency of "has not", of TC_RANS_SLOTS. */
TC_LH04_INLINE uint32_t tc_lh04_empty(const tc_lh04_codec *c, int flag)
{
    return (uint32_t)c->model.empty[flag] << 4;
}

/* Before a row: sums over the frequencies beside this one. */
TC_LH04_INLINE void tc_lh04_row(const tc_lh04_band *b, int j, tc_lh04_work *w)
{
    for (int p = 0; p < TC_PHASES; p++) {
        int16_t near[RUN] = {0}, far[RUN] = {0};
        for (int n = 0; n < b->nears; n++) {
            const uint8_t *s = seen_at(w, b->near[n], j, p);
            for (int k = 0; k < RUN; k++)
                near[k] = (int16_t)(near[k] + s[k]);
        }
        for (int n = 0; n < b->fars; n++) {
            const uint8_t *s = seen_at(w, b->far[n], j, p);
            for (int k = 0; k < RUN; k++)
                far[k] = (int16_t)(far[k] + s[k]);
        }
        memcpy(w->near[p], near, sizeof near), memcpy(w->far[p], far, sizeof far);
    }
}

/* Features of block k of a phase of row j. */
TC_LH04_INLINE void tc_lh04_features(tc_lh04_work *w, int place, int phase, int j, int k, int32_t f[TC_LH04_SCALE])
{
    const uint8_t *north = seen_at(w, place, j - 1, phase) + k;
    /* Of the other phase: the columns left and right of this one are [0] and [1]. */
    const uint8_t *across = seen_at(w, place, j - 1, !phase) + k - !phase;
    const uint8_t *here = seen_at(w, place, j, !phase) + k - !phase;
    const int16_t *beside = total_at(w, j, !phase) + k - !phase;
    f[F_N] = north[0];
    f[F_NN] = seen_at(w, place, j - 2, phase)[k];
    f[F_DIAGONAL] = across[0] + across[1];
    f[F_SIDES] = phase ? here[0] + here[1] : north[-1] + north[1];
    f[F_NEAR] = w->near[phase][k];
    f[F_FAR] = w->far[phase][k];
    f[F_BLOCK] = total_at(w, j, phase)[k];
    f[F_AROUND] = beside[0] + beside[1] + total_at(w, j - 1, phase)[k] + total_at(w, j + 1, phase)[k];
    f[F_ONE] = 1;
}

/* Bins of a phase of row j. The totals of this row and the one above must not yet hold this frequency: they are added
 * to by tc_lh04_add() when it is done. phase should be a constant. */
TC_LH04_INLINE void tc_lh04_bins(const tc_lh04_band *b, tc_lh04_work *w, int place, int phase, int j, uint8_t bin[RUN])
{
    const int32_t *weight = b->weight[phase];
    int16_t scale[RUN], count[RUN] = {0};
    int32_t sum[RUN];
    /* tc_lh04_features(), arranged for whole runs. */
    const uint8_t *north = seen_at(w, place, j - 1, phase), *north2 = seen_at(w, place, j - 2, phase);
    const uint8_t *across = seen_at(w, place, j - 1, !phase) - !phase, *here = seen_at(w, place, j, !phase) - !phase;
    const int16_t *beside = total_at(w, j, !phase) - !phase, *block = total_at(w, j, phase);
    const int16_t *above = total_at(w, j - 1, phase), *below = total_at(w, j + 1, phase);
    const uint8_t *side[2] = {phase ? here : north - 1, phase ? here + 1 : north + 1};
    for (int k = 0; k < RUN; k++)
        sum[k] = weight[F_ONE] + north[k] * weight[F_N] + north2[k] * weight[F_NN];
    for (int k = 0; k < RUN; k++)
        sum[k] += (across[k] + across[k + 1]) * weight[F_DIAGONAL] + (side[0][k] + side[1][k]) * weight[F_SIDES];
    for (int k = 0; k < RUN; k++)
        sum[k] += w->near[phase][k] * weight[F_NEAR] + w->far[phase][k] * weight[F_FAR];
    for (int k = 0; k < RUN; k++)
        sum[k] += block[k] * weight[F_BLOCK] + (beside[k] + beside[k + 1] + above[k] + below[k]) * weight[F_AROUND];
    for (int k = 0; k < RUN; k++)
        scale[k] = (int16_t)(sum[k] >> 4 > SCALE_MOST ? SCALE_MOST : sum[k] >> 4);
    for (int n = 0; n < TC_BINS - 1; n++)
        for (int k = 0; k < RUN; k++)
            count[k] = (int16_t)(count[k] + (scale[k] >= tc_bin_threshold[n]));
    for (int k = 0; k < RUN; k++)
        bin[k] = (uint8_t)count[k];
}

/* What contexts see of a symbol. */
TC_LH04_INLINE uint8_t tc_lh04_seen(uint32_t symbol, uint32_t bin)
{
    uint32_t shift = tc_bin_shift[bin];
    return (uint8_t)((symbol << shift) + (symbol && shift ? 1u << shift >> 1 : 0));
}

/* Adds a finished frequency to the totals. */
TC_LH04_INLINE void tc_lh04_add(tc_lh04_work *w, int place, int rows)
{
    for (int j = 0; j < rows; j++)
        for (int p = 0; p < TC_PHASES; p++) {
            const uint8_t *s = seen_at(w, place, j, p);
            int16_t *t = total_at(w, j, p);
            for (int k = 0; k < RUN; k++) {
                int sum = t[k] + s[k];
                t[k] = (int16_t)(sum > TOTAL_LIMIT ? TOTAL_LIMIT : sum);
            }
        }
}

#endif
