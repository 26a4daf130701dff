/* codec_tile.h - inside a tile: its surroundings in the coarser level, predictions, and contexts. Shared by encoder and
 * decoder, which must agree to the bit; inlined so that the decoder can be compiled for more than one processor. */
#ifndef TC_CODEC_TILE_H
#define TC_CODEC_TILE_H

#include <string.h>

#include "codec.h"
#include "common/base/rect.h"

#define TC_INLINE static inline __attribute__((always_inline))

enum {
    HALF = TC_TILE / TC_PHASES, /* columns of a phase */
    PATCH_X = 8,                /* column of position 0 in a patch row */
    PATCH_STRIDE = TC_TILE + 2 * PATCH_X,
    PATCH_ROWS = TC_TILE + 2 * TC_TILE_MARGIN,
    HL_X = 8, /* likewise in rows of HL; columns -2 .. TC_TILE and rows -1 .. TC_TILE are used */
    HL_STRIDE = TC_TILE + 2 * HL_X,
    HL_ROWS = TC_TILE + 3,
    CURVE_X = 8, /* likewise in rows of curvatures of a phase; rows and columns -2 .. TC_TILE + 1 of the tile */
    CURVE_STRIDE = HALF + 2 * CURVE_X,
    CURVE_ROWS = TC_TILE + 3,
    MAGNITUDE_X = 16,
    MAGNITUDE_STRIDE = HALF + 2 * MAGNITUDE_X,
    MAGNITUDE_ROWS = TC_TILE + 4, /* rows -2 .. TC_TILE + 1 */
    CURVE_LIMIT = 8191,           /* curvatures are cut off here, so that weighted sums fit */
    SCALE_LIMIT = 32767,
    TC_TILE_LANES = TC_BANDS /* from this bit on, a tile's flags are log2(lanes / 4) */
};

/* Curvatures of the coarser level at (i, j): between columns i and i + 1, between rows j and j + 1, both. */
enum { CURVE_H, CURVE_V, CURVE_X2, CURVE_H3, CURVE_V3, CURVES };

struct tc_tile_work {
    int32_t patch[PATCH_ROWS][PATCH_STRIDE];                    /* coarser level from row -TC_TILE_MARGIN on */
    int32_t hl[HL_ROWS][HL_STRIDE];                             /* HL predicted, then reconstructed; rows from -1 on */
    int32_t pred[TC_TILE][TC_TILE];                             /* LH predicted */
    int16_t curve[CURVES][CURVE_ROWS][TC_PHASES][CURVE_STRIDE]; /* rows from -1 on */
    uint8_t magnitude[TC_BANDS][MAGNITUDE_ROWS][TC_PHASES][MAGNITUDE_STRIDE]; /* as contexts see them */
    uint8_t symbol[TC_BANDS][TC_TILE][TC_PHASES][HALF];
    uint8_t bin[TC_BANDS][TC_TILE][TC_PHASES][HALF];
    bool plain[TC_BANDS][TC_TILE][TC_PHASES];          /* decoder: no bin of the run has low bits */
    int32_t value[TC_BANDS][TC_TILE][TC_PHASES][HALF]; /* encoder: quantised */
};

/* Columns and rows of a band within a tile at position (x0, y0). */
TC_INLINE void tc_tile_extent(const tc_codec *c, int band, tc_rect tile, int64_t shift, int *columns, int *rows)
{
    int64_t w = c->level.width, h = c->level.height;
    int64_t limit_x = shift + (band == TC_LH ? tc_coarse_size(w) : w / 2);
    int64_t limit_y = band == TC_HL ? tc_coarse_size(h) : h / 2;
    *columns = (int)(tc_min64(tile.x1, limit_x) - tile.x0);
    *rows = (int)(tc_min64(tile.y1, limit_y) - tile.y0);
}

/* Columns of a phase. */
TC_INLINE int tc_phase_columns(int columns, int phase)
{
    return columns <= 0 ? 0 : (columns + 1 - phase) / 2;
}

/* ---- The coarser level around the tile ------------------------------------------------------------------------ */

TC_INLINE int32_t *patch_at(tc_tile_work *w, int i, int j)
{
    return &w->patch[j + TC_TILE_MARGIN][i + PATCH_X];
}

/* Copies the coarser level around the tile's first `rows` rows; beyond its border it goes on in a straight line (of at
 * most as many steps as anything that counts looks beyond). */
TC_INLINE void tc_tile_load(const tc_codec *c, tc_rect tile, int rows, const tc_plane *coarse, tc_tile_work *w)
{
    tc_rect have = tc_codec_tile_needs(c, tile);
    int i0 = (int)(have.x0 - tile.x0), i1 = (int)(have.x1 - tile.x0);
    int j0 = (int)(have.y0 - tile.y0), j1 = (int)(have.y1 - tile.y0);
    for (int j = j0; j < j1; j++) {
        int32_t *row = patch_at(w, 0, j);
        memcpy(row + i0, tc_plane_at(coarse, have.x0, have.y0 + j - j0), (size_t)(i1 - i0) * sizeof *row);
        uint32_t left = (uint32_t)row[i0] - (uint32_t)row[i0 + (i1 - i0 > 1)];
        uint32_t right = (uint32_t)row[i1 - 1] - (uint32_t)row[i1 - 1 - (i1 - i0 > 1)];
        for (int i = i0 - 1; i >= -TC_TILE_MARGIN; i--)
            row[i] = (int32_t)((uint32_t)row[i + 1] + left);
        for (int i = i1; i < TC_TILE + TC_TILE_MARGIN; i++)
            row[i] = (int32_t)((uint32_t)row[i - 1] + (i < i1 + TC_TILE_MARGIN ? right : 0));
    }
    for (int side = 0; side < 2; side++) {
        int from = side ? j1 : j0 - 1, end = side ? rows + TC_TILE_MARGIN : -TC_TILE_MARGIN - 1, step = side ? 1 : -1;
        for (int j = from; j != end; j += step) {
            const int32_t *a = patch_at(w, -TC_TILE_MARGIN, j - step);
            const int32_t *b = j1 - j0 > 1 ? patch_at(w, -TC_TILE_MARGIN, j - 2 * step) : a;
            if (j - j1 >= TC_TILE_MARGIN)
                b = a;
            int32_t *row = patch_at(w, -TC_TILE_MARGIN, j);
            for (int i = 0; i < TC_TILE + 2 * TC_TILE_MARGIN; i++)
                row[i] = (int32_t)(2 * (uint32_t)a[i] - (uint32_t)b[i]);
        }
    }
}

TC_INLINE int16_t curvature(uint32_t sum, int shift)
{
    int32_t v = (int32_t)sum;
    v = (v < 0 ? (v == INT32_MIN ? INT32_MAX : -v) : v) >> shift;
    return (int16_t)(v > CURVE_LIMIT ? CURVE_LIMIT : v);
}

/* Curvatures for contexts. */
TC_INLINE void tc_tile_curves(const tc_codec *c, tc_tile_work *w)
{
    int shift = c->coarse_shift;
    for (int j = -1; j <= TC_TILE + 1; j++) {
        const uint32_t *p = (const uint32_t *)patch_at(w, 0, j - 1), *q = (const uint32_t *)patch_at(w, 0, j);
        const uint32_t *r = (const uint32_t *)patch_at(w, 0, j + 1), *s = (const uint32_t *)patch_at(w, 0, j + 2);
        int16_t row[CURVES][TC_TILE + 4]; /* from column -2 on */
        for (int i = -2; i < TC_TILE + 2; i++) {
            row[CURVE_H][i + 2] = curvature(q[i - 1] - q[i] - q[i + 1] + q[i + 2], shift);
            row[CURVE_H3][i + 2] = curvature(q[i + 2] - q[i - 1] + 3 * (q[i] - q[i + 1]), shift);
            row[CURVE_V][i + 2] = curvature(p[i] - q[i] - r[i] + s[i], shift);
            row[CURVE_V3][i + 2] = curvature(s[i] - p[i] + 3 * (q[i] - r[i]), shift);
            row[CURVE_X2][i + 2] = curvature(q[i] - q[i + 1] - r[i] + r[i + 1], shift);
        }
        for (int k = 0; k < CURVES; k++) {
            int16_t *restrict even = w->curve[k][j + 1][0] + CURVE_X - 1, *restrict odd =
                                                                              w->curve[k][j + 1][1] + CURVE_X - 1;
            for (int i = 0; i < HALF + 2; i++)
                even[i] = row[k][2 * i], odd[i] = row[k][2 * i + 1];
        }
    }
}

/* ---- Prediction ------------------------------------------------------------------------------------------------
 *
 * A symmetric kernel without constant part is a sum of 8 products of one function across the detail (sums of samples
 * at equal distance, or their second differences) and one along it (the sample, or second differences). For HL,
 * "across" is horizontal:
 *     C0 = c[0] + c[1]     C1 = c[-1] - c[0] - c[1] + c[2]     C2 = c[-2] - c[-1] - c[2] + c[3]
 *     R0 = c[0]            R1 = c[-1] - 2 c[0] + c[1]          R2 = c[-2] - c[-1] - c[1] + c[2]
 * in the order C1 R0, C2 R0, C0 R1, C1 R1, C2 R1, C0 R2, C1 R2, C2 R2. Sums wrap, which harms none that fits in the
 * end. */

/* The 8 terms of HL at (i, j) in a patch row pointer's columns. */
TC_INLINE void tc_terms_hl(tc_tile_work *w, int i, int j, uint32_t t[TC_PREDICT_KERNEL])
{
    uint32_t r[3][6];
    for (int k = 0; k < 6; k++) {
        const uint32_t *p = (const uint32_t *)patch_at(w, i - 2 + k, j);
        r[0][k] = p[0];
        r[1][k] = p[-PATCH_STRIDE] + p[PATCH_STRIDE] - 2 * p[0];
        r[2][k] = p[-2 * PATCH_STRIDE] - p[-PATCH_STRIDE] - p[PATCH_STRIDE] + p[2 * PATCH_STRIDE];
    }
    int n = 0;
    for (int a = 0; a < 3; a++) {
        if (a > 0)
            t[n++] = r[a][2] + r[a][3];
        t[n++] = r[a][1] - r[a][2] - r[a][3] + r[a][4];
        t[n++] = r[a][0] - r[a][1] - r[a][4] + r[a][5];
    }
}

/* The same for LH, "across" being vertical. */
TC_INLINE void tc_terms_lh(tc_tile_work *w, int i, int j, uint32_t t[TC_PREDICT_KERNEL])
{
    uint32_t c[3][5];
    for (int k = 0; k < 5; k++) {
        const uint32_t *p = (const uint32_t *)patch_at(w, i - 2 + k, j);
        c[0][k] = p[0] + p[PATCH_STRIDE];
        c[1][k] = p[-PATCH_STRIDE] - p[0] - p[PATCH_STRIDE] + p[2 * PATCH_STRIDE];
        c[2][k] = p[-2 * PATCH_STRIDE] - p[-PATCH_STRIDE] - p[2 * PATCH_STRIDE] + p[3 * PATCH_STRIDE];
    }
    int n = 0;
    for (int a = 0; a < 3; a++)
        for (int k = a == 0; k < 3; k++)
            t[n++] = a == 0   ? c[k][2]
                     : a == 1 ? c[k][1] - 2 * c[k][2] + c[k][3]
                              : c[k][0] - c[k][1] - c[k][3] + c[k][4];
}

/* The 4 sums of HL around LH at (i, j): near, far in x, far in y, far in both. */
TC_INLINE void tc_terms_cross(const tc_tile_work *w, int i, int j, uint32_t t[TC_PREDICT_CROSS])
{
    const uint32_t *p = (const uint32_t *)&w->hl[j + 1][i + HL_X], *q = p + HL_STRIDE;
    const uint32_t *o = p - HL_STRIDE, *r = q + HL_STRIDE;
    t[0] = p[-1] + p[0] + q[-1] + q[0];
    t[1] = p[-2] + p[1] + q[-2] + q[1];
    t[2] = o[-1] + o[0] + r[-1] + r[0];
    t[3] = o[-2] + o[1] + r[-2] + r[1];
}

enum { PREDICT_ROUND = 1 << (TC_PREDICT_BITS - 1) };

/* HL of the tile's first columns, a multiple of 8, and rows, and of what LH asks of them around: columns from -2 on,
 * rows from -1 to one behind the next. The sums of
 * tc_terms_hl(), in whole rows and in the order in which they take least: every three rows at equal distance make one
 * sum for the two middle columns, one for the two beside them, one for the outer two. Loops that are a multiple of 8
 * long take less than what is needed would, and reach into the padding of rows. */
TC_INLINE void tc_predict_hl(const tc_codec *c, tc_tile_work *w, int columns, int rows)
{
    uint32_t g[TC_PREDICT_KERNEL], row[3][PATCH_STRIDE];
    for (int k = 0; k < TC_PREDICT_KERNEL; k++)
        g[k] = (uint32_t)(int32_t)c->model.predict[TC_HL][k];
    /* What r0, r1 and r2 of middle, inner and outer columns weigh; then what the row, and the two sums of rows do. */
    const uint32_t r0[3] = {-g[0], g[0] - g[1], g[1]};
    const uint32_t r1[3] = {g[2] - g[3], g[3] - g[4], g[4]}, r2[3] = {g[5] - g[6], g[6] - g[7], g[7]};
    uint32_t by[3][3];
    for (int k = 0; k < 3; k++)
        by[k][0] = r0[k] - 2 * r1[k], by[k][1] = r1[k] - r2[k], by[k][2] = r2[k];
    uint32_t *middle = row[0] + PATCH_X, *inner = row[1] + PATCH_X, *outer = row[2] + PATCH_X;
    for (int j = -1; j < rows + 2; j++) {
        const uint32_t *p = (const uint32_t *)patch_at(w, 0, j);
        for (int i = -8; i < columns + 8; i++) {
            uint32_t near = p[i - PATCH_STRIDE] + p[i + PATCH_STRIDE];
            uint32_t far = p[i - 2 * PATCH_STRIDE] + p[i + 2 * PATCH_STRIDE];
            middle[i] = by[0][0] * p[i] + by[0][1] * near + by[0][2] * far;
            inner[i] = by[1][0] * p[i] + by[1][1] * near + by[1][2] * far;
            outer[i] = by[2][0] * p[i] + by[2][1] * near + by[2][2] * far;
        }
        int32_t *out = &w->hl[j + 1][HL_X];
        for (int i = -4; i < columns + 4; i++) {
            uint32_t sum = middle[i] + middle[i + 1] + inner[i - 1] + inner[i + 2] + outer[i - 2] + outer[i + 3];
            out[i] = (int32_t)(sum + PREDICT_ROUND) >> TC_PREDICT_BITS;
        }
    }
}

/* LH of the same columns and rows, once HL is reconstructed; arranged likewise: one sum for the column itself, one for
 * the two beside it, one for the outer two. */
TC_INLINE void tc_predict_lh(const tc_codec *c, tc_tile_work *w, int columns, int rows)
{
    uint32_t g[TC_PREDICT], row[5][PATCH_STRIDE];
    for (int k = 0; k < TC_PREDICT; k++)
        g[k] = (uint32_t)(int32_t)c->model.predict[TC_LH][k];
    /* What c0, c1 and c2 weigh at each distance; then what the near, middle and far two rows do. */
    const uint32_t c0[3] = {-2 * g[2], g[2] - g[5], g[5]};
    const uint32_t c1[3] = {g[0] - 2 * g[3], g[3] - g[6], g[6]}, c2[3] = {g[1] - 2 * g[4], g[4] - g[7], g[7]};
    uint32_t by[3][3];
    for (int k = 0; k < 3; k++)
        by[k][0] = c0[k] - c1[k], by[k][1] = c1[k] - c2[k], by[k][2] = c2[k];
    uint32_t *own = row[0] + PATCH_X, *inner = row[1] + PATCH_X, *outer = row[2] + PATCH_X;
    uint32_t *beside = row[3] + PATCH_X, *off = row[4] + PATCH_X; /* of HL */
    for (int j = 0; j < rows; j++) {
        const uint32_t *p = (const uint32_t *)patch_at(w, 0, j);
        const uint32_t *h1 = (const uint32_t *)&w->hl[j + 1][HL_X], *h2 = h1 + HL_STRIDE;
        const uint32_t *h0 = h1 - HL_STRIDE, *h3 = h2 + HL_STRIDE;
        for (int i = -4; i < columns + 4; i++) {
            uint32_t near = p[i] + p[i + PATCH_STRIDE], middle = p[i - PATCH_STRIDE] + p[i + 2 * PATCH_STRIDE];
            uint32_t far = p[i - 2 * PATCH_STRIDE] + p[i + 3 * PATCH_STRIDE];
            own[i] = by[0][0] * near + by[0][1] * middle + by[0][2] * far;
            inner[i] = by[1][0] * near + by[1][1] * middle + by[1][2] * far;
            outer[i] = by[2][0] * near + by[2][1] * middle + by[2][2] * far;
        }
        for (int i = -4; i < columns + 4; i++) {
            uint32_t close = h1[i] + h2[i], distant = h0[i] + h3[i];
            beside[i] = g[8] * close + g[10] * distant, off[i] = g[9] * close + g[11] * distant;
        }
        int32_t *out = w->pred[j];
        for (int i = 0; i < columns; i++) {
            uint32_t sum = own[i] + inner[i - 1] + inner[i + 1] + outer[i - 2] + outer[i + 2];
            sum += beside[i - 1] + beside[i] + off[i - 2] + off[i + 1];
            out[i] = (int32_t)(sum + PREDICT_ROUND) >> TC_PREDICT_BITS;
        }
    }
}

/* ---- Contexts ------------------------------------------------------------------------------------------------ */

TC_INLINE uint8_t *magnitude_at(tc_tile_work *w, int band, int j, int phase)
{
    return &w->magnitude[band][j + 2][phase][MAGNITUDE_X];
}

/* The TC_SCALE_COARSE curvature features of column k of a phase. */
TC_INLINE void tc_coarse_features(const tc_tile_work *w, int band, int phase, int k, int j, int32_t f[TC_SCALE_COARSE])
{
/* Column 2k + phase + di lies in the other phase for odd di, at a column of it that is rounded down. */
#define CURVE(kind, di, dj)                                                                                            \
    ((int32_t)w->curve[kind][j + 1 + (dj)][(phase + (di)) & 1][CURVE_X + k + ((phase + (di)) >> 1)])
    if (band == TC_HL) {
        f[0] = CURVE(CURVE_H, 0, 0);
        f[1] = CURVE(CURVE_H, -1, 0) + CURVE(CURVE_H, 1, 0);
        f[2] = CURVE(CURVE_H, 0, -1) + CURVE(CURVE_H, 0, 1);
        f[3] = CURVE(CURVE_V, 0, -1) + CURVE(CURVE_V, 0, 0) + CURVE(CURVE_V, 1, -1) + CURVE(CURVE_V, 1, 0);
        f[4] = CURVE(CURVE_H3, 0, 0);
    } else if (band == TC_LH) {
        f[0] = CURVE(CURVE_V, 0, 0);
        f[1] = CURVE(CURVE_V, 0, -1) + CURVE(CURVE_V, 0, 1);
        f[2] = CURVE(CURVE_V, -1, 0) + CURVE(CURVE_V, 1, 0);
        f[3] = CURVE(CURVE_H, -1, 0) + CURVE(CURVE_H, 0, 0) + CURVE(CURVE_H, -1, 1) + CURVE(CURVE_H, 0, 1);
        f[4] = CURVE(CURVE_V3, 0, 0);
    } else {
        f[0] = CURVE(CURVE_H, 0, 0) + CURVE(CURVE_H, 0, 1);
        f[1] = CURVE(CURVE_V, 0, 0) + CURVE(CURVE_V, 1, 0);
        f[2] = CURVE(CURVE_X2, 0, 0);
        f[3] = CURVE(CURVE_X2, -1, 0) + CURVE(CURVE_X2, 1, 0);
        f[4] = CURVE(CURVE_X2, 0, -1) + CURVE(CURVE_X2, 0, 1);
    }
#undef CURVE
}

/* The features of magnitudes for column k of a phase: TC_SCALE_OWN of the band, TC_SCALE_CROSS of others. */
TC_INLINE void tc_known_features(tc_tile_work *w, int band, int phase, int k, int j,
                                 int32_t f[TC_SCALE_OWN + TC_SCALE_CROSS])
{
    const uint8_t *n_same = magnitude_at(w, band, j - 1, phase) + k, *nn_same = magnitude_at(w, band, j - 2, phase) + k;
    /* Of the other phase: the columns left and right of this one are [0] and [1]. */
    const uint8_t *n = magnitude_at(w, band, j - 1, !phase) + k - !phase;
    const uint8_t *nn = magnitude_at(w, band, j - 2, !phase) + k - !phase;
    const uint8_t *here = magnitude_at(w, band, j, !phase) + k - !phase;
    f[0] = n_same[0];
    f[1] = nn_same[0];
    f[2] = n[0] + n[1];
    f[3] = nn[0] + nn[1];
    f[4] = phase ? here[0] + here[1] : n_same[-1] + n_same[1];
    f[5] = f[6] = 0;
    if (band == TC_LH) { /* HL at columns i - 1 and i */
        int left = phase ? k : k - 1;
        f[5] = magnitude_at(w, TC_HL, j, !phase)[left] + magnitude_at(w, TC_HL, j, phase)[k] +
               magnitude_at(w, TC_HL, j + 1, !phase)[left] + magnitude_at(w, TC_HL, j + 1, phase)[k];
        f[6] = magnitude_at(w, TC_HL, j - 1, !phase)[left] + magnitude_at(w, TC_HL, j - 1, phase)[k];
    } else if (band == TC_HH) { /* HL at rows j and j + 1, LH at columns i and i + 1 */
        int right = phase ? k + 1 : k;
        f[5] = magnitude_at(w, TC_HL, j, phase)[k] + magnitude_at(w, TC_HL, j + 1, phase)[k];
        f[6] = magnitude_at(w, TC_LH, j, phase)[k] + magnitude_at(w, TC_LH, j, !phase)[right];
    }
}

/* The bins of a phase of row j. band and phase should be constants. */
TC_INLINE void tc_context_bins(const tc_codec *c, tc_tile_work *w, int band, int j, int phase, uint8_t bin[HALF])
{
    int32_t weight[TC_SCALE], step = c->coarse_scale[band], limit = (INT32_MAX / step) << 6;
    for (int n = 0; n < TC_SCALE; n++)
        weight[n] = c->model.scale[band][phase][n];
    enum { COARSE = TC_SCALE_OWN + TC_SCALE_CROSS };
    int16_t scale[HALF];
    for (int k = 0; k < HALF; k++) {
        int32_t f[TC_SCALE_COARSE];
        tc_coarse_features(w, band, phase, k, j, f);
        int32_t sum = f[0] * weight[COARSE] + f[1] * weight[COARSE + 1] + f[2] * weight[COARSE + 2] +
                      f[3] * weight[COARSE + 3] + f[4] * weight[COARSE + 4];
        sum = sum > limit ? limit : sum;
        sum = ((sum >> 6) * step >> 14) + weight[TC_SCALE - 1];
        int32_t m[COARSE];
        tc_known_features(w, band, phase, k, j, m);
        sum += m[0] * weight[0] + m[1] * weight[1] + m[2] * weight[2] + m[3] * weight[3] + m[4] * weight[4];
        if (band != TC_HL)
            sum += m[5] * weight[5] + m[6] * weight[6];
        sum >>= 2;
        scale[k] = (int16_t)(sum > SCALE_LIMIT ? SCALE_LIMIT : sum);
    }
    int16_t count[HALF] = {0};
    for (int b = 0; b < TC_BINS - 1; b++)
        for (int k = 0; k < HALF; k++)
            count[k] = (int16_t)(count[k] + (scale[k] >= tc_bin_threshold[b]));
    for (int k = 0; k < HALF; k++)
        bin[k] = (uint8_t)count[k];
}

/* What contexts see of a symbol. */
TC_INLINE uint8_t tc_context_magnitude(uint32_t symbol, uint32_t bin)
{
    uint32_t shift = tc_bin_shift[bin];
    return (uint8_t)((symbol << shift) + (symbol && shift ? 1u << shift >> 1 : 0));
}

#endif
