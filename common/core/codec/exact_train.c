/* exact_train.c - fits the model of an exact level to tiles of it.
 *
 * Prediction: least squares by the normal equations, samples weighted by the inverse square of the error expected
 * there, which comes near to the least code length; so twice around, the first time without weights. Expected errors:
 * maximum likelihood of exponentially distributed sizes over non-negative weights, by multiplicative updates
 * (Lee, Seung 2000). */
#include <math.h>
#include <stdlib.h>

#include "exact_tile.h"

enum { ROUNDS = 3, ITERATIONS = 12, MOST_TILES = 64, N = TC_EXACT_TERMS, SCALES = TC_EXACT_SCALES };

typedef struct trainer {
    tc_exact *codec;
    const tc_exact_tile *tiles;
    int count;
    tc_exact_work **work; /* one for each tile */
    double predict[TC_EXACT_PHASES][N], scale[TC_EXACT_PHASES][SCALES];
} trainer;

typedef struct normal {
    double a[N][N + 1];
} normal;

/* Solves by elimination with pivots; a slight ridge keeps what the data does not say at zero. */
static void solve(normal *n, double x[N])
{
    for (int k = 0; k < N; k++) {
        for (int i = 0; i < k; i++)
            n->a[k][i] = n->a[i][k];
    }
    for (int k = 0; k < N; k++)
        n->a[k][k] = n->a[k][k] * (1 + 1e-6) + 1e-3;
    int order[N];
    for (int k = 0; k < N; k++)
        order[k] = k;
    for (int k = 0; k < N; k++) {
        int pivot = k;
        for (int i = k + 1; i < N; i++)
            if (fabs(n->a[order[i]][k]) > fabs(n->a[order[pivot]][k]))
                pivot = i;
        int swap = order[k];
        order[k] = order[pivot], order[pivot] = swap;
        double *p = n->a[order[k]];
        for (int i = k + 1; i < N; i++) {
            double *q = n->a[order[i]], f = q[k] / p[k];
            for (int m = k; m <= N; m++)
                q[m] -= f * p[m];
        }
    }
    for (int k = N - 1; k >= 0; k--) {
        const double *p = n->a[order[k]];
        double sum = p[N];
        for (int i = k + 1; i < N; i++)
            sum -= p[i] * x[i];
        x[k] = sum / p[k];
    }
}

static double expected(const trainer *t, const uint32_t f[SCALES - 1], int phase)
{
    double s = 16 * t->scale[phase][SCALES - 1] + TC_EXACT_SCALE_LEAST;
    for (int k = 0; k < SCALES - 1; k++)
        s += t->scale[phase][k] * f[k];
    return s / (1024 * TC_EXACT_PART);
}

static tc_rect tile_rect(const trainer *t, int n)
{
    return tc_exact_tile_rect(t->codec, t->tiles[n].tx, t->tiles[n].ty);
}

/* Fields of every tile as the prediction now is. */
static void prepare(trainer *t, bool errors)
{
    for (int n = 0; n < t->count; n++) {
        const tc_exact_tile *tile = &t->tiles[n];
        tc_exact_work *w = t->work[n];
        tc_rect r = tile_rect(t, n);
        tc_exact_prepare(t->codec, tile->tx, tile->ty, &tile->coarse, w);
        for (int64_t y = 0; y < r.y1 - r.y0; y++)
            for (int64_t x = 0; x < r.x1 - r.x0; x++) {
                int64_t k = *tc_plane_at(&tile->fine, r.x0 + x, r.y0 + y) / t->codec->model.step - w->base;
                w->signal[y + TC_EXACT_REACH][x + TC_EXACT_REACH] =
                    tc_exact_clamp(k * TC_EXACT_PART - w->up[y][x], TC_EXACT_SIGNAL);
            }
        for (int y = 0; y < (int)(r.y1 - r.y0) && errors; y++)
            for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
                int phase = (y & 1) * 2 + (x & 1);
                int64_t k = *tc_plane_at(&tile->fine, r.x0 + x, r.y0 + y) / t->codec->model.step - w->base;
                int32_t p = tc_exact_predict(w, t->codec->model.predict[phase] + TC_EXACT_COARSE, x, y);
                w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH] =
                    tc_exact_clamp(k * TC_EXACT_PART - p, TC_EXACT_ERROR);
            }
    }
}

/* One tile's share of the normal equations. */
static void add_tile(const trainer *t, int n, bool weighted, normal equations[TC_EXACT_PHASES])
{
    const tc_exact_work *w = t->work[n];
    tc_rect r = tile_rect(t, n);
    for (int y = 0; y < (int)(r.y1 - r.y0); y++)
        for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
            int phase = (y & 1) * 2 + (x & 1);
            double f[N + 1], weight = 1;
            const int32_t *c = &w->coarse[(y >> 1) + TC_EXACT_MARGIN][(x >> 1) + TC_EXACT_MARGIN];
            const int32_t *d = &w->signal[y + TC_EXACT_REACH][x + TC_EXACT_REACH];
            for (int k = 0; k < TC_EXACT_COARSE; k++)
                f[k] = c[tc_exact_coarse_at[k][1] * TC_EXACT_COARSE_SIDE + tc_exact_coarse_at[k][0]] - c[0];
            for (int k = 0; k < TC_EXACT_CAUSAL; k++)
                f[TC_EXACT_COARSE + k] = d[tc_exact_causal_at[k][1] * TC_EXACT_ROW + tc_exact_causal_at[k][0]];
            f[N] = d[0];
            if (weighted) {
                uint32_t g[SCALES - 1];
                tc_exact_scale_features(w, x, y, g);
                double s = expected(t, g, phase) + 0.2;
                weight = 1 / (s * s);
            }
            normal *e = &equations[phase];
            for (int k = 0; k < N; k++) {
                double v = f[k] * weight;
                for (int i = k; i <= N; i++)
                    e->a[k][i] += v * f[i];
            }
        }
}

static void fit_prediction(trainer *t, bool weighted, normal equations[TC_EXACT_PHASES])
{
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        equations[p] = (normal){0};
    for (int n = 0; n < t->count; n++)
        add_tile(t, n, weighted, equations);
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        double x[N];
        solve(&equations[p], x);
        for (int k = 0; k < N; k++) {
            double v = isfinite(x[k]) ? x[k] * 4096 : 0;
            t->codec->model.predict[p][k] = (int16_t)lrint(fmin(fmax(v, INT16_MIN), INT16_MAX));
        }
    }
}

static void fit_scale(trainer *t)
{
    static const double first[SCALES] = {300, 300, 100, 100, 50, 50, 50, 100, 10};
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        for (int k = 0; k < SCALES; k++)
            t->scale[p][k] = first[k];
    for (int round = 0; round < ITERATIONS; round++) {
        double up[TC_EXACT_PHASES][SCALES] = {{0}}, down[TC_EXACT_PHASES][SCALES] = {{0}};
        for (int n = 0; n < t->count; n++) {
            const tc_exact_work *w = t->work[n];
            tc_rect r = tile_rect(t, n);
            for (int y = 0; y < (int)(r.y1 - r.y0); y++)
                for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
                    int phase = (y & 1) * 2 + (x & 1);
                    uint32_t g[SCALES - 1];
                    tc_exact_scale_features(w, x, y, g);
                    double s = expected(t, g, phase), truth = w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH];
                    double a = fabs(truth) / TC_EXACT_PART / (s * s), b = 1 / s;
                    for (int k = 0; k < SCALES - 1; k++)
                        up[phase][k] += g[k] * a, down[phase][k] += g[k] * b;
                    up[phase][SCALES - 1] += a, down[phase][SCALES - 1] += b;
                }
        }
        for (int p = 0; p < TC_EXACT_PHASES; p++)
            for (int k = 0; k < SCALES; k++)
                if (down[p][k] > 0)
                    t->scale[p][k] *= sqrt(up[p][k] / down[p][k]);
    }
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        /* Three octaves above what any terrain needs, and small enough in sum (exact_model.c). */
        for (int k = 0; k < SCALES; k++)
            t->codec->model.scale[p][k] = (uint16_t)lrint(fmin(t->scale[p][k], k == SCALES - 1 ? 60000 : 2900));
    }
}

tc_status tc_exact_train(const tc_lifting_level *level, const tc_exact_tile *tiles, int count, int32_t step,
                         tc_exact_model *model)
{
    trainer t = {.tiles = tiles, .count = count < MOST_TILES ? count : MOST_TILES};
    tc_exact_model plain = {.step = step};
    normal *equations = malloc(TC_EXACT_PHASES * sizeof *equations);
    t.codec = malloc(sizeof *t.codec);
    t.work = calloc((size_t)t.count + 1, sizeof *t.work);
    tc_status status = equations && t.codec && t.work ? TC_OK : TC_ERR_MEMORY;
    for (int n = 0; n < t.count && !status; n++)
        if (!(t.work[n] = malloc(tc_exact_work_bytes())))
            status = TC_ERR_MEMORY;
    if (!status) {
        tc_exact_init(t.codec, level, &plain);
        prepare(&t, false);
        for (int round = 0; round < ROUNDS; round++) {
            fit_prediction(&t, round > 0, equations);
            prepare(&t, true);
            fit_scale(&t);
        }
        *model = t.codec->model;
    }
    for (int n = 0; n < t.count && t.work; n++)
        free(t.work[n]);
    free(t.work), free(t.codec), free(equations);
    return status;
}
