/* codec_predict.c - details of empty tiles: predictions alone, of any rectangle of them at once.
 *
 * Where no sample that is looked at lies beyond the level's sides, rows of the coarser level are read where they are,
 * and of sums and of HL only the last rows are kept, so that all stays in the nearest cache. What is nearer to a side
 * goes through the surroundings of a tile (codec_tile.h), which know how the level goes on there. */
#include "codec_tile.h"
#include "common/base/simd.h"

enum {
    SPAN = 256, /* columns at once */
    ROW = SPAN + 16
};

/* What the rows at each distance weigh in a sum of columns; numbered by the columns' distance. */
typedef struct row_weights {
    uint32_t of[3][3];
} row_weights;

static row_weights weights_hl(const tc_codec *c)
{
    const int16_t *g = c->model.predict[TC_HL];
    const int r0[3] = {-g[0], g[0] - g[1], g[1]}, r1[3] = {g[2] - g[3], g[3] - g[4], g[4]};
    const int r2[3] = {g[5] - g[6], g[6] - g[7], g[7]};
    row_weights w;
    for (int k = 0; k < 3; k++) {
        w.of[k][0] = (uint32_t)(r0[k] - 2 * r1[k]);
        w.of[k][1] = (uint32_t)(r1[k] - r2[k]), w.of[k][2] = (uint32_t)r2[k];
    }
    return w;
}

static row_weights weights_lh(const tc_codec *c)
{
    const int16_t *g = c->model.predict[TC_LH];
    const int c0[3] = {-2 * g[2], g[2] - g[5], g[5]}, c1[3] = {g[0] - 2 * g[3], g[3] - g[6], g[6]};
    const int c2[3] = {g[1] - 2 * g[4], g[4] - g[7], g[7]};
    row_weights w;
    for (int k = 0; k < 3; k++) {
        w.of[k][0] = (uint32_t)(c0[k] - c1[k]);
        w.of[k][1] = (uint32_t)(c1[k] - c2[k]), w.of[k][2] = (uint32_t)c2[k];
    }
    return w;
}

/* `columns` predictions of HL, the first one for the column of p, a row of the coarser level. */
TC_INLINE void hl_row(const row_weights *w, const uint32_t *restrict p, ptrdiff_t stride, int columns,
                      int32_t *restrict out)
{
    uint32_t row[3][ROW], *middle = row[0] + 2, *inner = row[1] + 2, *outer = row[2] + 2;
    for (int i = -2; i < columns + 3; i++) {
        uint32_t near = p[i - stride] + p[i + stride], far = p[i - 2 * stride] + p[i + 2 * stride];
        middle[i] = w->of[0][0] * p[i] + w->of[0][1] * near + w->of[0][2] * far;
        inner[i] = w->of[1][0] * p[i] + w->of[1][1] * near + w->of[1][2] * far;
        outer[i] = w->of[2][0] * p[i] + w->of[2][1] * near + w->of[2][2] * far;
    }
    for (int i = 0; i < columns; i++) {
        uint32_t sum = middle[i] + middle[i + 1] + inner[i - 1] + inner[i + 2] + outer[i - 2] + outer[i + 3];
        out[i] = (int32_t)(sum + PREDICT_ROUND) >> TC_PREDICT_BITS;
    }
}

/* The same of LH; h: the rows of HL before it, its own and the two behind it. g: what sums of HL weigh. */
TC_INLINE void lh_row(const row_weights *w, const uint32_t g[TC_PREDICT_CROSS], const uint32_t *restrict p,
                      ptrdiff_t stride, const int32_t *const h[4], int columns, int32_t *restrict out)
{
    /* Sums of columns at their distance from the one predicted: two to the left, one, none, and to the right. */
    uint32_t row[5][ROW], *left2 = row[0] + 2, *left = row[1] + 2, *own = row[2] + 2, *right = row[3] + 2;
    uint32_t *right2 = row[4] + 2;
    const uint32_t *h0 = (const uint32_t *)h[0], *h1 = (const uint32_t *)h[1];
    const uint32_t *h2 = (const uint32_t *)h[2], *h3 = (const uint32_t *)h[3];
    for (int i = -2; i < columns + 2; i++) {
        uint32_t near = p[i] + p[i + stride], middle = p[i - stride] + p[i + 2 * stride];
        uint32_t far = p[i - 2 * stride] + p[i + 3 * stride], close = h1[i] + h2[i], distant = h0[i] + h3[i];
        uint32_t inner = w->of[1][0] * near + w->of[1][1] * middle + w->of[1][2] * far;
        uint32_t outer = w->of[2][0] * near + w->of[2][1] * middle + w->of[2][2] * far;
        uint32_t beside = g[0] * close + g[2] * distant, off = g[1] * close + g[3] * distant;
        own[i] = w->of[0][0] * near + w->of[0][1] * middle + w->of[0][2] * far + beside;
        left[i] = inner + beside, right[i] = inner + off, left2[i] = outer + off, right2[i] = outer;
    }
    for (int i = 0; i < columns; i++) {
        uint32_t sum = left2[i - 2] + left[i - 1] + own[i] + right[i + 1] + right2[i + 2];
        out[i] = (int32_t)(sum + PREDICT_ROUND) >> TC_PREDICT_BITS;
    }
}

/* A part at most SPAN wide of which no sample looks beyond the level's sides. */
TC_INLINE void predict_inside(const tc_codec *c, tc_rect part, const tc_plane *coarse, const tc_plane band[TC_BANDS])
{
    const row_weights of_hl = weights_hl(c), of_lh = weights_lh(c);
    uint32_t cross[TC_PREDICT_CROSS];
    for (int k = 0; k < TC_PREDICT_CROSS; k++)
        cross[k] = (uint32_t)(int32_t)c->model.predict[TC_LH][TC_PREDICT_KERNEL + k];
    int32_t hl[4][ROW]; /* row j in hl[j & 3], from two columns before the part on */
    int columns = (int)(part.x1 - part.x0);
    size_t size = (size_t)columns * sizeof(int32_t);
    for (int64_t y = part.y0 - 1; y < part.y1 + 2; y++) {
        hl_row(&of_hl, (const uint32_t *)tc_plane_at(coarse, part.x0 - 2, y), coarse->stride, columns + 4, hl[y & 3]);
        if (y >= part.y0 && y < part.y1) {
            memcpy(tc_plane_at(&band[TC_HL], part.x0, y), hl[y & 3] + 2, size);
            memset(tc_plane_at(&band[TC_HH], part.x0, y), 0, size);
        }
        if (y < part.y0 + 2)
            continue;
        const int32_t *const h[4] = {hl[(y - 3) & 3] + 2, hl[(y - 2) & 3] + 2, hl[(y - 1) & 3] + 2, hl[y & 3] + 2};
        lh_row(&of_lh, cross, (const uint32_t *)tc_plane_at(coarse, part.x0, y - 2), coarse->stride, h, columns,
               tc_plane_at(&band[TC_LH], part.x0, y - 2));
    }
}

/* A part at most TC_TILE either way, anywhere. */
TC_INLINE void predict_anywhere(const tc_codec *c, tc_rect part, const tc_plane *coarse, const tc_plane band[TC_BANDS],
                                tc_tile_work *w)
{
    int columns = (int)(part.x1 - part.x0 + 7) / 8 * 8, rows = (int)(part.y1 - part.y0);
    size_t size = (size_t)(part.x1 - part.x0) * sizeof(int32_t);
    tc_tile_load(c, part, rows, coarse, w);
    tc_predict_hl(c, w, columns, rows);
    tc_predict_lh(c, w, columns, rows);
    for (int j = 0; j < rows; j++) {
        memcpy(tc_plane_at(&band[TC_HL], part.x0, part.y0 + j), &w->hl[j + 1][HL_X], size);
        memcpy(tc_plane_at(&band[TC_LH], part.x0, part.y0 + j), w->pred[j], size);
        memset(tc_plane_at(&band[TC_HH], part.x0, part.y0 + j), 0, size);
    }
}

/* The same code for processors with AVX2 and without. */
#if TC_AVX2
TC_TARGET_AVX2 static __attribute__((noinline)) void
predict_inside_avx2(const tc_codec *c, tc_rect part, const tc_plane *coarse, const tc_plane band[TC_BANDS])
{
    predict_inside(c, part, coarse, band);
}

TC_TARGET_AVX2 static __attribute__((noinline)) void predict_anywhere_avx2(const tc_codec *c, tc_rect part,
                                                                           const tc_plane *coarse,
                                                                           const tc_plane band[TC_BANDS],
                                                                           tc_tile_work *w)
{
    predict_anywhere(c, part, coarse, band, w);
}
#endif

/* A rectangle in pieces of at most columns x rows. work: NULL where all of it is inside. */
static void predict_pieces(const tc_codec *c, tc_rect part, int64_t columns, int64_t rows, const tc_plane *coarse,
                           const tc_plane band[TC_BANDS], tc_tile_work *work, bool simd)
{
    for (int64_t y = part.y0; y < part.y1; y += rows)
        for (int64_t x = part.x0; x < part.x1; x += columns) {
            tc_rect piece = {x, y, tc_min64(x + columns, part.x1), tc_min64(y + rows, part.y1)};
#if TC_AVX2
            if (simd && work)
                predict_anywhere_avx2(c, piece, coarse, band, work);
            else if (simd)
                predict_inside_avx2(c, piece, coarse, band);
            else
#endif
                if (work)
                predict_anywhere(c, piece, coarse, band, work);
            else
                predict_inside(c, piece, coarse, band);
        }
    (void)simd;
}

void tc_codec_predict(const tc_codec *c, tc_rect part, const tc_plane *coarse, const tc_plane band[TC_BANDS],
                      tc_tile_work *work, tc_simd simd)
{
    enum { MARGIN = TC_TILE_MARGIN };
    bool wide = TC_AVX2 && simd == TC_SIMD_AUTO && tc_have_avx2();
    tc_rect inside = {part.x0, tc_max64(part.y0, MARGIN), part.x1, tc_min64(part.y1, c->ch - MARGIN)};
    if (!c->level.wrap_x)
        inside.x0 = tc_max64(part.x0, MARGIN), inside.x1 = tc_min64(part.x1, c->cw - MARGIN);
    if (tc_rect_empty(inside)) {
        predict_pieces(c, part, TC_TILE, TC_TILE, coarse, band, work, wide);
        return;
    }
    predict_pieces(c, inside, SPAN, part.y1 - part.y0, coarse, band, NULL, wide);
    const tc_rect around[] = {{part.x0, part.y0, part.x1, inside.y0},
                              {part.x0, inside.y0, inside.x0, inside.y1},
                              {inside.x1, inside.y0, part.x1, inside.y1},
                              {part.x0, inside.y1, part.x1, part.y1}};
    for (int n = 0; n < 4; n++)
        predict_pieces(c, around[n], TC_TILE, TC_TILE, coarse, band, work, wide);
}
