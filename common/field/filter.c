/* filter.c - D and U of the pyramid (LH04 section 4 and its footnote 1; lifting after Sweldens 1996).
 *
 * One lifting step splits x into evens s and odds d:
 *     d[i] = x[2i+1] - (9/16 (x[2i] + x[2i+2]) - 1/16 (x[2i-2] + x[2i+4]))      predict: what U would have said
 *     s[i] = x[2i] + 19/64 (d[i-1] + d[i]) - 3/64 (d[i-2] + d[i+1])              update: moves s to the L2 optimum
 * and D keeps s. Beyond a border the evens go on in a straight line, which reproduces constants and ramps, and the
 * details are zero: there is no data to correct for. Where the level wraps, both go on from the other side. */
#include "filter.h"

#include <string.h>

enum { REACH = 3 }; /* even samples that d[i-2] .. d[i+1] look at beyond i, on either side */

/* Fills e[-1] and e[count], e[count + 1] so that the straight line through the border goes on. */
static void extend_line(float *e, int64_t count)
{
    float first = count > 1 ? e[1] - e[0] : 0, last = count > 1 ? e[count - 1] - e[count - 2] : 0;
    e[-1] = e[0] - first;
    e[count] = e[count - 1] + last;
    e[count + 1] = e[count - 1] + 2 * last;
}

/* Low band of one row of `width` samples, an even number where it wraps. e: space for tc_coarse_size(width) + 3 samples
 * after one in front; d: the same with two in front. */
static void lift_row(const float *restrict x, int64_t width, bool wrap_x, float *restrict e, float *restrict d,
                     float *restrict low)
{
    int64_t evens = tc_coarse_size(width), odds = width / 2;
    for (int64_t i = 0; i < evens; i++)
        e[i] = x[2 * i];
    if (wrap_x)
        e[-1] = e[evens - 1], e[evens] = e[0], e[evens + 1] = e[1 % evens];
    else
        extend_line(e, evens);
    for (int64_t i = 0; i < odds; i++)
        d[i] = x[2 * i + 1] - tc_predict(e[i - 1], e[i], e[i + 1], e[i + 2]);
    d[-2] = d[-1] = 0;
    for (int64_t i = odds; i < evens + 1; i++)
        d[i] = 0;
    if (wrap_x)
        d[-1] = d[evens - 1], d[-2] = d[(2 * evens - 2) % evens], d[evens] = d[0];
    for (int64_t i = 0; i < evens; i++)
        low[i] = e[i] + TC_UPDATE_NEAR * (d[i - 1] + d[i]) + TC_UPDATE_FAR * (d[i - 2] + d[i + 1]);
}

/* Rows of the horizontally filtered input that rows j0 .. j1 - 1 of the result look at, plus those that extend it. */
static int64_t band_rows(int64_t rows)
{
    return 2 * (rows + 2 * REACH) + 2;
}

size_t tc_downsample_scratch(int64_t width, int64_t rows)
{
    int64_t cw = tc_coarse_size(width);
    return (size_t)(cw * (band_rows(rows) + rows + 3 + 3) + 2 * (cw + 8));
}

/* A vertical band of horizontally filtered rows; evens beyond the border are made on demand in `line`. */
typedef struct band {
    const float *rows; /* of input rows first .. */
    int64_t first, cw, evens;
    float *line[3]; /* extended evens: -1, evens, evens + 1 */
} band;

static const float *even_row(const band *b, int64_t i)
{
    if (i < 0)
        return b->line[0];
    if (i >= b->evens)
        return b->line[1 + (i - b->evens)];
    return b->rows + (2 * i - b->first) * b->cw;
}

static void extend_rows(const band *b, int64_t j0, int64_t j1)
{
    int64_t step = b->evens > 1 ? 1 : 0;
    if (j0 - 2 <= 0) {
        const float *r0 = even_row(b, 0), *r1 = even_row(b, step);
        for (int64_t i = 0; i < b->cw; i++)
            b->line[0][i] = r0[i] - (r1[i] - r0[i]);
    }
    if (j1 + REACH >= b->evens) {
        const float *r0 = even_row(b, b->evens - 1), *r1 = even_row(b, b->evens - 1 - step);
        for (int64_t i = 0; i < b->cw; i++) {
            float last = r0[i] - r1[i];
            b->line[1][i] = r0[i] + last;
            b->line[2][i] = r0[i] + 2 * last;
        }
    }
}

void tc_downsample(const float *fine, int64_t width, int64_t height, bool wrap_x, int64_t j0, int64_t j1, float *coarse,
                   float *scratch)
{
    int64_t cw = tc_coarse_size(width), evens = tc_coarse_size(height), odds = height / 2, rows = j1 - j0;
    float *e = scratch + 1, *d_row = e + cw + 3 + 2;
    float *detail = scratch + 2 * (cw + 8); /* rows + 3 rows of details */
    float *line = detail + (rows + 3) * cw; /* three extended rows */
    float *low = line + 3 * cw;             /* the band */

    int64_t first = j0 - REACH > 0 ? 2 * (j0 - REACH) : 0;
    int64_t end = 2 * (j1 + REACH) < height ? 2 * (j1 + REACH) : height;
    for (int64_t y = first; y < end; y++)
        lift_row(fine + y * width, width, wrap_x, e, d_row, low + (y - first) * cw);

    band b = {low, first, cw, evens, {line, line + cw, line + 2 * cw}};
    extend_rows(&b, j0, j1);
    for (int64_t k = j0 - 2; k < j1 + 1; k++) {
        float *restrict d = detail + (k - (j0 - 2)) * cw;
        if (k < 0 || k >= odds) {
            memset(d, 0, (size_t)cw * sizeof *d);
            continue;
        }
        const float *restrict x = low + (2 * k + 1 - first) * cw;
        const float *p = even_row(&b, k - 1), *q = even_row(&b, k), *r = even_row(&b, k + 1), *s = even_row(&b, k + 2);
        for (int64_t i = 0; i < cw; i++)
            d[i] = x[i] - tc_predict(p[i], q[i], r[i], s[i]);
    }
    for (int64_t j = j0; j < j1; j++) {
        const float *restrict d = detail + (j - j0) * cw; /* of row j - 2 */
        const float *restrict x = even_row(&b, j);
        float *restrict out = coarse + (j - j0) * cw;
        for (int64_t i = 0; i < cw; i++)
            out[i] = x[i] + TC_UPDATE_NEAR * (d[cw + i] + d[2 * cw + i]) + TC_UPDATE_FAR * (d[i] + d[3 * cw + i]);
    }
}

void tc_upsample_1d(const float *c, ptrdiff_t stride, int64_t count, float *f, ptrdiff_t stride_f)
{
    for (int64_t i = 0; i < count; i++) {
        const float *p = c + i * stride;
        f[2 * i * stride_f] = p[0];
        f[(2 * i + 1) * stride_f] = tc_predict(p[-stride], p[0], p[stride], p[2 * stride]);
    }
}

void tc_upsample(const float *c, ptrdiff_t stride, int64_t cw, int64_t ch, float *fine, float *scratch)
{
    int64_t fw = 2 * cw;
    for (int64_t j = -1; j < ch + 2; j++)
        tc_upsample_1d(c + j * stride, 1, cw, scratch + (j + 1) * fw, 1);
    for (int64_t j = 0; j < ch; j++) {
        const float *restrict p = scratch + j * fw;
        memcpy(fine + 2 * j * fw, p + fw, (size_t)fw * sizeof *fine);
        float *restrict out = fine + (2 * j + 1) * fw;
        for (int64_t i = 0; i < fw; i++)
            out[i] = tc_predict(p[i], p[fw + i], p[2 * fw + i], p[3 * fw + i]);
    }
}
