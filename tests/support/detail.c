/* detail.c - what a level adds to the upsampled coarser one, measured. */
#include "detail.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/load.h"
#include "common/base/rect.h"

typedef struct sample {
    double slope, d;
    float place;
} sample;

static int by_slope(const void *a, const void *b)
{
    const sample *p = a, *q = b;
    return p->slope != q->slope ? (p->slope < q->slope ? -1 : 1) : (p->place > q->place) - (p->place < q->place);
}

static float *read_level(const tc_field *f, int level, tc_rect r, uint8_t **voids_ret)
{
    int64_t w = r.x1 - r.x0, h = r.y1 - r.y0;
    float *z = malloc((size_t)(w * h) * sizeof *z);
    uint8_t *v = voids_ret ? malloc((size_t)(w * h)) : NULL;
    if (!z || tc_field_read(f, level, r, z, v, w))
        abort();
    if (voids_ret)
        *voids_ret = v;
    return z;
}

static double four(const float *p, ptrdiff_t s)
{
    return 0.5625 * ((double)p[0] + p[s]) - 0.0625 * ((double)p[-s] + p[2 * s]);
}

/* U of the coarse level at fine sample (x, y). */
static double upsampled(const float *c, int64_t w, int64_t x, int64_t y)
{
    const float *p = c + (y >> 1) * w + (x >> 1);
    if (!(y & 1))
        return x & 1 ? four(p, 1) : p[0];
    if (!(x & 1))
        return four(p, w);
    return 0.5625 * (four(p, 1) + four(p + w, 1)) - 0.0625 * (four(p - w, 1) + four(p + 2 * w, 1));
}

/* Mean square of second differences `step` apart, both axes: as a power of the scale its exponent is that of the
 * spectrum, but for a constant. */
static double structure(const float *z, int64_t w, int64_t h, int64_t step)
{
    double sum = 0, count = 0;
    for (int64_t y = step; y + step < h; y++)
        for (int64_t x = step; x + step < w; x++) {
            const float *p = z + y * w + x;
            double a = (double)p[-step] - 2.0 * p[0] + p[step], b = (double)p[-step * w] - 2.0 * p[0] + p[step * w];
            sum += a * a + b * b, count++;
        }
    return sum / fmax(count, 1);
}

detail_figures detail_measure(const tc_field *field, const tc_field *slopes, int level, int64_t side)
{
    enum { EDGE = 8, AROUND = 3 };
    const tc_level size = tc_field_level(field, level), low = tc_field_level(field, level - 1);
    int64_t w = tc_min64(size.width, side), h = tc_min64(size.height, side);
    int64_t cw = tc_min64(low.width, w / 2 + 4), ch = tc_min64(low.height, h / 2 + 4);
    uint8_t *voids;
    float *z = read_level(field, level, (tc_rect){0, 0, w, h}, NULL);
    float *c = read_level(field, level - 1, (tc_rect){0, 0, cw, ch}, NULL);
    float *s = read_level(slopes, level - 1, (tc_rect){0, 0, cw, ch}, &voids);
    float *d = calloc((size_t)(w * h), sizeof *d);
    uint8_t *bad = calloc((size_t)(w * h), 1);
    sample *list = malloc((size_t)(w * h) * sizeof *list);
    detail_figures f = {0};
    int64_t x1 = tc_min64(w, 2 * (cw - 3)) - EDGE, y1 = tc_min64(h, 2 * (ch - 3)) - EDGE, count = 0;
    for (int64_t y = EDGE - AROUND; y < y1 + AROUND; y++)
        for (int64_t x = EDGE - AROUND; x < x1 + AROUND; x++) {
            d[y * w + x] = (float)(z[y * w + x] - upsampled(c, cw, x, y));
            for (int64_t j = -2; j <= 3; j++)
                for (int64_t i = -2; i <= 3; i++)
                    bad[y * w + x] |=
                        voids[tc_clamp64((y >> 1) + j, 0, ch - 1) * cw + tc_clamp64((x >> 1) + i, 0, cw - 1)];
        }
    double square = 0, fourth = 0, along = 0, across = 0, ratio = low.spacing_x / low.spacing_y;
    for (int64_t y = EDGE; y < y1; y++)
        for (int64_t x = EDGE; x < x1; x++) {
            if (bad[y * w + x])
                continue;
            const float *p = s + (y >> 1) * cw + (x >> 1), *v = d + y * w + x;
            double gx = ((double)p[1] - p[-1]) * ratio, gy = (double)p[cw] - p[-cw], steep = gx * gx + gy * gy,
                   e = v[0];
            double here = 0;
            for (int64_t j = -AROUND; j <= AROUND; j++)
                for (int64_t i = -AROUND; i <= AROUND; i++)
                    here += (double)v[j * w + i] * v[j * w + i];
            list[count] = (sample){.slope = steep, .d = e, .place = (float)((y * 7919 + x * 104729) % 65536)};
            count++;
            square += e * e, fourth += e * e * e * e;
            if (steep > 0 && here > 0) {
                double dx = ((double)v[1] - v[0]) / ratio, dy = (double)v[w] - v[0], sx = gx / ratio / ratio, sy = gy;
                double norm = sx * sx + sy * sy, a = dx * sx + dy * sy, b = dx * sy - dy * sx;
                along += a * a / norm / here, across += b * b / norm / here;
            }
        }
    f.spectrum = log2(structure(d, w, h, 2) / structure(d, w, h, 1)) + 2;
    qsort(list, (size_t)count, sizeof *list, by_slope);
    f.rms = sqrt(square / (double)tc_max64(count, 1));
    f.kurtosis = fourth * (double)count / (square * square);
    f.anisotropy = across / along;
    for (int k = 0; k < DETAIL_DECILES; k++) {
        int64_t from = count * k / DETAIL_DECILES, to = count * (k + 1) / DETAIL_DECILES;
        double sum = 0;
        for (int64_t i = from; i < to; i++)
            sum += list[i].d * list[i].d;
        f.decile[k] = sqrt(sum / (double)tc_max64(to - from, 1)) / f.rms;
    }
    free(z), free(c), free(s), free(voids), free(d), free(bad), free(list);
    return f;
}

void detail_compare(const detail_figures *a, const detail_figures *b, double *mean_ret, double *worst_ret)
{
    double sum = 0, worst = 0;
    for (int k = 0; k < DETAIL_DECILES; k++) {
        double off = fabs(log2(a->decile[k] / b->decile[k]));
        sum += off, worst = fmax(worst, off);
    }
    *mean_ret = sum / DETAIL_DECILES, *worst_ret = worst;
}

/* ---- Levels dropped and made again ------------------------------------------------------------------------------- */

static tc_field *cut_off(const tc_field *field, int finest)
{
    const tc_level size = tc_field_level(field, finest);
    tc_rect all = {0, 0, size.width, size.height};
    tc_grid g = {.width = size.width, .height = size.height, .spacing_x = size.spacing_x, .spacing_y = size.spacing_y};
    tc_field *cut;
    g.z = read_level(field, finest, all, &g.voids);
    tc_grid_measure(&g);
    if (tc_field_build(&g, 0, &cut, NULL))
        abort();
    return cut;
}

tc_field *detail_synthesise(const tc_field *field, int dropped, detail_kind kind, tc_synthesis_fit *fit)
{
    tc_error error = {TC_OK, ""};
    tc_field *cut = cut_off(field, tc_field_info(field)->levels - dropped), *made;
    tc_status status = tc_synthesis_learn(cut, fit, &error);
    if (!status && kind == DETAIL_GAUSSIAN)
        tc_synthesis_uniform(fit);
    fit->none |= kind == DETAIL_NONE;
    if (!status)
        status = tc_synthesis_create(cut, dropped, fit, 0, (tc_synthesis_share){NULL, NULL}, &made, &error);
    if (status) {
        printf("%s\n", error.text);
        exit(99);
    }
    return made;
}
