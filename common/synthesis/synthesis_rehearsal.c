/* synthesis_rehearsal.c - level m synthesised from level m - 1 and held against the true one, until the noise has the
 * terrain's own direction, kurtosis and shares of the bands. */
#include "synthesis_rehearsal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/same_math.h"
#include "common/field/filter.h"
#include "synthesis_noise.h"

enum {
    SIDE = TC_PAIR_SIDE,
    COARSE = SIDE + 2 * TC_PAIR_REACH,
    FINE = 2 * SIDE + 2 * TC_PAIR_LIFT,     /* of the finer level, with what lifting needs */
    INNER = TC_PAIR_REACH - TC_ENERGY_REACH /* cells around a block that have amplitudes */
};

/* A block: what is there. */
typedef struct scene {
    tc_rect block;
    float coarse[COARSE * COARSE];
    float amplitude[(SIDE + 2 * INNER) * (SIDE + 2 * INNER)];
    float fine[FINE * FINE];
} scene;

/* Heights of the finer level seen as details: sums of squares over A^2, and directions. */
typedef struct look {
    double band[TC_DETAIL_BANDS], cells;
    double square, fourth, samples;
    double along, across;
    double near, far; /* second differences one and two samples apart */
} look;

typedef struct stage {
    scene *scene;
    int scenes;
    tc_level coarse;
    float *scratch, *work, *fine, *base;
} stage;

static const float *coarse_at(const scene *s, int64_t i, int64_t j)
{
    return s->coarse + (j + TC_PAIR_REACH) * (s->block.x1 - s->block.x0 + 2 * TC_PAIR_REACH) + i + TC_PAIR_REACH;
}

static float amplitude_at(const scene *s, int64_t i, int64_t j)
{
    return s->amplitude[(j + INNER) * (s->block.x1 - s->block.x0 + 2 * INNER) + i + INNER];
}

/* ---- Looking ----------------------------------------------------------------------------------------------------- */

/* Directions of what heights of the finer level add to the upsampled coarser one, over A. */
static void look_at_directions(const stage *g, const scene *s, const float *fine, int64_t stride, look *l)
{
    int64_t w = s->block.x1 - s->block.x0, h = s->block.y1 - s->block.y0, coarse_stride = w + 2 * TC_PAIR_REACH;
    tc_upsample(coarse_at(s, 0, 0), coarse_stride, w, h, g->base, g->work);
    for (int64_t y = 0; y < 2 * h; y++)
        for (int64_t x = 0; x < 2 * w; x++) {
            float a = amplitude_at(s, x >> 1, y >> 1);
            g->base[y * 2 * w + x] = a > 0 ? (fine[y * stride + x] - g->base[y * 2 * w + x]) / a : 0;
        }
    for (int64_t y = 2; y < 2 * h - 2; y++)
        for (int64_t x = 2; x < 2 * w - 2; x++) {
            const float *v = g->base + y * 2 * w + x;
            double a = v[-1] - 2 * v[0] + v[1], b = v[-2 * w] - 2 * v[0] + v[2 * w];
            double c = v[-2] - 2 * v[0] + v[2], d = v[-4 * w] - 2 * v[0] + v[4 * w];
            l->near += a * a + b * b, l->far += c * c + d * d;
        }
    double ratio = g->coarse.spacing_x / g->coarse.spacing_y;
    for (int64_t y = 0; y < 2 * h - 1; y++)
        for (int64_t x = 0; x < 2 * w - 1; x++) {
            const float *v = g->base + y * 2 * w + x, *c = coarse_at(s, x >> 1, y >> 1);
            double square = (double)v[0] * v[0], sx = c[1] - c[-1], sy = ratio * (c[coarse_stride] - c[-coarse_stride]);
            double steep = sx * sx + sy * sy, vx = v[1] - v[0], vy = ratio * (v[2 * w] - v[0]);
            l->square += square, l->fourth += square * square, l->samples++;
            if (!(steep > 0))
                continue;
            double along = vx * sx + vy * sy, across = vx * sy - vy * sx;
            l->along += along * along / steep, l->across += across * across / steep;
        }
}

/* fine: with TC_PAIR_LIFT around the block. */
static void look_at(const stage *g, const scene *s, const float *fine, look *l)
{
    int64_t w = s->block.x1 - s->block.x0, h = s->block.y1 - s->block.y0, stride = 2 * w + 2 * TC_PAIR_LIFT;
    float *band[TC_DETAIL_BANDS];
    for (int b = 0; b < TC_DETAIL_BANDS; b++)
        band[b] = g->base + b * w * h;
    tc_true_details(fine, w, h, band, g->work);
    for (int64_t j = 0; j < h; j++)
        for (int64_t i = 0; i < w; i++) {
            double a = amplitude_at(s, i, j);
            for (int b = 0; b < TC_DETAIL_BANDS && a > 0; b++)
                l->band[b] += band[b][j * w + i] / a * (band[b][j * w + i] / a);
            l->cells += a > 0;
        }
    look_at_directions(g, s, fine + TC_PAIR_LIFT * (stride + 1), stride, l);
}

static double anisotropy(const look *l)
{
    return l->along > 0 && l->across > 0 ? l->across / l->along : 1;
}

static double spectrum(const look *l)
{
    return l->near > 0 && l->far > 0 ? l->far / l->near : 1;
}

static double kurtosis(const look *l)
{
    return l->square > 0 ? l->fourth * l->samples / (l->square * l->square) : 3;
}

/* All blocks, as they are or as the fit makes them. */
static look look_at_truth(const stage *g)
{
    look l = {0};
    for (int n = 0; n < g->scenes; n++)
        look_at(g, &g->scene[n], g->scene[n].fine, &l);
    return l;
}

static look rehearse(const stage *g, const tc_synthesis_fit *fit)
{
    look l = {0};
    for (int n = 0; n < g->scenes; n++) {
        const scene *s = &g->scene[n];
        tc_rect b = s->block, around = tc_rect_grown(b, TC_PAIR_REACH), inner = tc_rect_grown(b, INNER);
        tc_patch coarse = {(float *)s->coarse, around.x1 - around.x0, around};
        tc_patch amplitude = {(float *)s->amplitude, inner.x1 - inner.x0, inner};
        const tc_level_recipe r = {.fit = fit,
                                   .seed = tc_noise_seed(0, 0),
                                   .width = g->coarse.width,
                                   .height = g->coarse.height,
                                   .spacing_x = (float)g->coarse.spacing_x,
                                   .spacing_y = (float)g->coarse.spacing_y,
                                   .lowest = -INFINITY,
                                   .highest = INFINITY,
                                   .amplitude = &amplitude};
        tc_rect fine = {2 * b.x0, 2 * b.y0, 2 * b.x1, 2 * b.y1};
        int64_t stride = fine.x1 - fine.x0 + 2 * TC_PAIR_LIFT;
        memcpy(g->fine, s->fine, sizeof s->fine); /* the true ones around */
        tc_synthesis_level(&r, &coarse, fine, g->fine + TC_PAIR_LIFT * (stride + 1), stride, g->scratch);
        look_at(g, s, g->fine, &l);
    }
    return l;
}

/* ---- Settling ---------------------------------------------------------------------------------------------------- */

/* Shares of curvature in details along one axis, by least squares over A^2. */
static void settle_curvature(const stage *g, tc_synthesis_fit *fit)
{
    double m[2][2] = {{0}}, v[2] = {0};
    for (int n = 0; n < g->scenes; n++) {
        const scene *s = &g->scene[n];
        int64_t w = s->block.x1 - s->block.x0, h = s->block.y1 - s->block.y0, stride = w + 2 * TC_PAIR_REACH;
        float *band[TC_DETAIL_BANDS];
        for (int b = 0; b < TC_DETAIL_BANDS; b++)
            band[b] = g->base + b * w * h;
        tc_true_details(s->fine, w, h, band, g->work);
        for (int64_t i = 0; i < w * h; i++) {
            double a = amplitude_at(s, i % w, i / w);
            for (int axis = 0; axis < 2 && a > 0; axis++) {
                const float *p = coarse_at(s, i % w, i / w);
                const ptrdiff_t s1 = axis ? stride : 1;
                const float q[6] = {p[-2 * s1], p[-s1], p[0], p[s1], p[2 * s1], p[3 * s1]};
                double d = band[axis][i] / a, f = tc_foretold(q[0], q[1], q[2], q[3], q[4], q[5], 1, 0) / a;
                double e = tc_foretold(q[0], q[1], q[2], q[3], q[4], q[5], 0, 1) / a;
                m[0][0] += f * f, m[0][1] += f * e, m[1][1] += e * e, v[0] += f * d, v[1] += e * d;
            }
        }
    }
    m[0][0] *= 1 + 1e-6, m[1][1] *= 1 + 1e-6;
    double det = m[0][0] * m[1][1] - m[0][1] * m[0][1];
    if (!(det > 0))
        return;
    fit->curvature[0] = (float)fmin(fmax((v[0] * m[1][1] - v[1] * m[0][1]) / det, -1), 1);
    fit->curvature[1] = (float)fmin(fmax((v[1] * m[0][0] - v[0] * m[0][1]) / det, -4), 4);
}

/* Gives the bands the energies that they have. */
static void settle_bands(const stage *g, const look *truth, tc_synthesis_fit *fit)
{
    tc_synthesis_fit silent = *fit;
    memset(silent.band, 0, sizeof silent.band);
    const look foretold = rehearse(g, &silent), both = rehearse(g, fit);
    for (int b = 0; b < TC_DETAIL_BANDS; b++) {
        double wanted = fmax(truth->band[b] - foretold.band[b], 0.05 * truth->band[b]);
        double has = both.band[b] - foretold.band[b];
        if (has > 0 && wanted > 0)
            fit->band[b] *= (float)fmin(fmax(sqrt(wanted / has), 0.1), 10);
    }
}

/* The value between first and last, of `count` evenly spaced ones, at which `measure` is nearest to target. */
static float nearest(const stage *g, const tc_synthesis_fit *fit, float *value, float first, float last, int count,
                     double (*measure)(const look *), double target)
{
    double before = 0, best = INFINITY, at = first;
    for (int n = 0; n < count; n++) {
        *value = first + (last - first) * (float)n / (float)(count - 1);
        const look l = rehearse(g, fit);
        double log = tc_log2(measure(&l) / target), step = (last - first) / (count - 1);
        if (fabs(log) < best)
            best = fabs(log), at = *value;
        if (n > 0 && before * log < 0) { /* it lies between */
            at = *value - step * log / (log - before);
            break;
        }
        before = log;
    }
    return (float)at;
}

static void settle(const stage *g, tc_synthesis_fit *fit)
{
    const look truth = look_at_truth(g);
    fit->anisotropy = anisotropy(&truth), fit->kurtosis = kurtosis(&truth);
    if (!(truth.cells > 0) || !(truth.square > 0))
        return;
    settle_curvature(g, fit);
    for (int b = 0; b < TC_DETAIL_BANDS; b++)
        fit->band[b] = (float)sqrt(truth.band[b] / truth.cells);
    settle_bands(g, &truth, fit);
    for (int n = 0; n < 2; n++) {
        fit->spread = nearest(g, fit, &fit->spread, -0.3f, 1.2f, 11, spectrum, spectrum(&truth));
        settle_bands(g, &truth, fit);
        fit->smear = nearest(g, fit, &fit->smear, -1, 1, 9, anisotropy, fit->anisotropy);
        settle_bands(g, &truth, fit);
    }
    fit->peak = nearest(g, fit, &fit->peak, 0, 0.4f, 6, kurtosis, fit->kurtosis);
    for (int n = 0; n < 2; n++)
        settle_bands(g, &truth, fit);
}

/* ---- Reading ----------------------------------------------------------------------------------------------------- */

/* Heights and amplitudes of a block, none next to voids: what has no amplitude does not count. */
static tc_status set_scene(const tc_field *field, int level, tc_rect b, const tc_synthesis_fit *fit, uint8_t *voids,
                           float *energy, scene *s, float *scratch)
{
    tc_level size = tc_field_level(field, level);
    tc_rect around = tc_rect_grown(b, TC_PAIR_REACH), inner = tc_rect_grown(b, INNER), fine = tc_pair_fine(b);
    int64_t w = around.x1 - around.x0, inner_w = inner.x1 - inner.x0, area = tc_rect_area(inner);
    s->block = b;
    tc_status status = tc_field_read(field, level, around, s->coarse, voids, w);
    if (!status)
        status = tc_field_read(field, level + 1, fine, s->fine, NULL, fine.x1 - fine.x0);
    if (status)
        return status;
    tc_patch patch = {s->coarse, w, around};
    tc_local_energy(&patch, fit, (float)size.spacing_x, (float)size.spacing_y, inner, energy, energy + area, scratch);
    tc_amplitudes(fit, 1, energy, energy + area, area, s->amplitude);
    for (int64_t i = 0; i < area; i++)
        if (tc_near_void(voids + (i / inner_w + TC_ENERGY_REACH) * w + i % inner_w + TC_ENERGY_REACH, w))
            s->amplitude[i] = 0;
    return TC_OK;
}

tc_status tc_synthesis_rehearse(const tc_field *field, const tc_pair *pair, double a, double b, double c,
                                tc_synthesis_fit *fit)
{
    const size_t fine = (size_t)FINE * FINE, scratch = tc_synthesis_scratch();
    float *memory = malloc((scratch + 6 * fine) * sizeof *memory);
    scene *scenes = malloc(TC_PAIR_BLOCKS * sizeof *scenes);
    uint8_t *voids = malloc(fine);
    stage g = {scenes, 0, tc_field_level(field, pair->coarse), memory, NULL, NULL, NULL};
    tc_status status = memory && scenes && voids ? TC_OK : TC_ERR_MEMORY;
    if (!status)
        g.work = memory + scratch, g.fine = g.work + 3 * fine, g.base = g.fine + fine;
    /* The regression of the pair in place of that of what comes after it. */
    tc_synthesis_fit known = *fit;
    known.level[0].a = (float)a, known.level[0].b = (float)b, known.level[0].c = (float)c,
    known.level[0].cap = INFINITY;
    for (int n = 0; n < pair->blocks && !status; n++)
        status = set_scene(field, pair->coarse, pair->block[n], &known, voids, g.work, &scenes[g.scenes++], memory);
    if (!status)
        settle(&g, fit);
    free(memory), free(scenes), free(voids);
    return status;
}
