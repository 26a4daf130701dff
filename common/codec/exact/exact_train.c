/* exact_train.c - fits the model of an exact level to tiles of it.
 *
 * Prediction: least squares by the normal equations, samples weighted by the inverse square of the error expected
 * there, which comes near to the least code length; so twice around, the first time without weights. Expected errors:
 * maximum likelihood of exponentially distributed sizes over non-negative weights, by multiplicative updates
 * (Lee, Seung 2000). What a tile teaches is found by any thread, and put together in the tiles' order, so that a model
 * does not depend on how many threads there are. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_tile.h"
#include "common/codec/lifting/codec_fit.h"
#include "common/base/parallel.h"

enum { ROUNDS = 3, ITERATIONS = 12, MOST_TILES = 64, N = TC_EXACT_TERMS, SCALES = TC_EXACT_SCALES };

typedef struct normal {
    double a[N][N + 1];
} normal;

/* What one tile teaches. */
typedef struct lesson {
    tc_exact_work *work;
    normal equations[TC_EXACT_PHASES];
    double up[TC_EXACT_PHASES][SCALES], down[TC_EXACT_PHASES][SCALES];
} lesson;

typedef struct trainer {
    tc_exact *codec;
    const tc_exact_tile *tiles;
    int count, threads;
    int round;
    lesson *lesson; /* one for each tile */
    double scale[TC_EXACT_PHASES][SCALES];
} trainer;

/* Solves equations of which the upper triangle is known. */
static void solve(normal *n, double x[N])
{
    for (int k = 0; k < N; k++)
        for (int i = 0; i < k; i++)
            n->a[k][i] = n->a[i][k];
    tc_solve_normal(n->a[0], N + 1, N, x);
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

/* Fields of a tile, the errors of the prediction among them from the first round on. */
static void prepare(void *context, int64_t n)
{
    const trainer *t = context;
    const tc_exact_tile *tile = &t->tiles[n];
    tc_exact_work *w = t->lesson[n].work;
    tc_rect r = tile_rect(t, (int)n);
    tc_exact_prepare(t->codec, tile->tx, tile->ty, &tile->coarse, w);
    for (int64_t y = 0; y < r.y1 - r.y0; y++)
        for (int64_t x = 0; x < r.x1 - r.x0; x++) {
            int64_t k = *tc_plane_at(&tile->fine, r.x0 + x, r.y0 + y) / t->codec->model.step - w->base;
            w->signal[y + TC_EXACT_REACH][x + TC_EXACT_REACH] =
                tc_exact_clamp(k * TC_EXACT_PART - w->up[y][x], TC_EXACT_SIGNAL);
        }
    for (int y = 0; y < (int)(r.y1 - r.y0) && t->round >= 0; y++)
        for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
            int phase = (y & 1) * 2 + (x & 1);
            int64_t k = *tc_plane_at(&tile->fine, r.x0 + x, r.y0 + y) / t->codec->model.step - w->base;
            int32_t p = tc_exact_predict(w, t->codec->model.predict[phase] + TC_EXACT_COARSE, x, y);
            w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH] = tc_exact_clamp(k * TC_EXACT_PART - p, TC_EXACT_ERROR);
        }
}

/* A tile's share of the normal equations. */
static void add_equations(void *context, int64_t n)
{
    const trainer *t = context;
    lesson *l = &t->lesson[n];
    const tc_exact_work *w = l->work;
    tc_rect r = tile_rect(t, (int)n);
    memset(l->equations, 0, sizeof l->equations);
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
            if (t->round > 0) {
                uint32_t g[SCALES - 1];
                tc_exact_scale_features(w, x, y, g);
                double s = expected(t, g, phase) + 0.2;
                weight = 1 / (s * s);
            }
            normal *e = &l->equations[phase];
            for (int k = 0; k < N; k++) {
                double v = f[k] * weight;
                for (int i = k; i <= N; i++)
                    e->a[k][i] += v * f[i];
            }
        }
}

static void fit_prediction(trainer *t)
{
    tc_parallel_for(t->threads, t->count, add_equations, t);
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        normal all = {{{0}}};
        for (int n = 0; n < t->count; n++)
            for (int k = 0; k < N; k++)
                for (int i = k; i <= N; i++)
                    all.a[k][i] += t->lesson[n].equations[p].a[k][i];
        double x[N];
        solve(&all, x);
        for (int k = 0; k < N; k++) {
            double v = isfinite(x[k]) ? x[k] * 4096 : 0;
            t->codec->model.predict[p][k] = (int16_t)lrint(fmin(fmax(v, INT16_MIN), INT16_MAX));
        }
    }
}

/* A tile's share of what the weights of expected errors are multiplied by. */
static void add_sizes(void *context, int64_t n)
{
    const trainer *t = context;
    lesson *l = &t->lesson[n];
    const tc_exact_work *w = l->work;
    tc_rect r = tile_rect(t, (int)n);
    memset(l->up, 0, sizeof l->up), memset(l->down, 0, sizeof l->down);
    for (int y = 0; y < (int)(r.y1 - r.y0); y++)
        for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
            int phase = (y & 1) * 2 + (x & 1);
            uint32_t g[SCALES - 1];
            tc_exact_scale_features(w, x, y, g);
            double s = expected(t, g, phase), truth = w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH];
            double a = fabs(truth) / TC_EXACT_PART / (s * s), b = 1 / s;
            for (int k = 0; k < SCALES - 1; k++)
                l->up[phase][k] += g[k] * a, l->down[phase][k] += g[k] * b;
            l->up[phase][SCALES - 1] += a, l->down[phase][SCALES - 1] += b;
        }
}

static void fit_scale(trainer *t)
{
    static const double first[SCALES] = {300, 300, 100, 100, 50, 50, 50, 100, 10};
    for (int p = 0; p < TC_EXACT_PHASES; p++)
        for (int k = 0; k < SCALES; k++)
            t->scale[p][k] = first[k];
    for (int i = 0; i < ITERATIONS; i++) {
        tc_parallel_for(t->threads, t->count, add_sizes, t);
        for (int p = 0; p < TC_EXACT_PHASES; p++)
            for (int k = 0; k < SCALES; k++) {
                double up = 0, down = 0;
                for (int n = 0; n < t->count; n++)
                    up += t->lesson[n].up[p][k], down += t->lesson[n].down[p][k];
                if (down > 0)
                    t->scale[p][k] *= sqrt(up / down);
            }
    }
    for (int p = 0; p < TC_EXACT_PHASES; p++) {
        /* Three octaves above what any terrain needs, and small enough in sum (exact_model.c). */
        for (int k = 0; k < SCALES; k++)
            t->codec->model.scale[p][k] = (uint16_t)lrint(fmin(t->scale[p][k], k == SCALES - 1 ? 60000 : 2900));
    }
}

/* ---- Probabilities ------------------------------------------------------------------------------------------- */

typedef struct counts {
    double of[TC_EXACT_CONTEXTS1][TC_EXACT_NODES][2];
} counts;

static void count_tile(const trainer *t, int n, counts *seen)
{
    const tc_exact_work *w = t->lesson[n].work;
    const tc_exact_model *m = &t->codec->model;
    tc_rect r = tile_rect(t, n);
    for (int y = 0; y < (int)(r.y1 - r.y0); y++)
        for (int x = 0; x < (int)(r.x1 - r.x0); x++) {
            int phase = (y & 1) * 2 + (x & 1);
            int32_t p = tc_exact_predict(w, m->predict[phase] + TC_EXACT_COARSE, x, y);
            int32_t nearest = (p + TC_EXACT_PART / 2) >> 4, fraction = p - nearest * TC_EXACT_PART;
            int32_t d = w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH] + fraction;
            d = (fraction < 0 ? -d : d) / TC_EXACT_PART;
            uint32_t scale = tc_exact_scale(w, m->scale[phase], x, y);
            int shift = tc_exact_shift(scale), high = (d + (1 << shift >> 1)) >> shift, first;
            int context = tc_exact_bin(scale) * TC_EXACT_FRACTIONS + tc_exact_fraction(shift, abs(fraction));
            seen->of[context][0][high != 0]++;
            if (high == 0)
                continue;
            seen->of[context][1][high < 0]++;
            first = high < 0 ? TC_EXACT_AWAY : TC_EXACT_TOWARDS;
            for (int k = 0; k < TC_EXACT_UNARY; k++) {
                seen->of[context][first + k][abs(high) > k + 1]++;
                if (abs(high) <= k + 1)
                    break;
            }
        }
}

static double logit(double p)
{
    return log(p / (1 - p));
}

/* Corrections of the probabilities that tiles start from, where they save bits. tiles: of the level. */
static void fit_start(trainer *t, counts *seen, int64_t tiles)
{
    enum { PRIOR = 6, BITS = 4, MOST = 4 };
    *seen = (counts){0};
    for (int n = 0; n < t->count; n++)
        count_tile(t, n, seen);
    for (int c = 0; c < TC_EXACT_CONTEXTS1; c++) {
        tc_mix_state node[TC_EXACT_NODES];
        tc_exact_start_nodes(c / TC_EXACT_FRACTIONS, c % TC_EXACT_FRACTIONS, node);
        for (int k = 0; k < TC_EXACT_NODES; k++) {
            const double *bit = seen->of[c][k];
            double before = (node[k] >> 16) / 65536.0, total = bit[0] + bit[1];
            double p = (bit[1] + PRIOR * before) / (total + PRIOR);
            /* A tile adapts itself: no correction saves more than a few bits of it. */
            double saved =
                total > 0 ? (bit[1] * log2(p / before) + bit[0] * log2((1 - p) / (1 - before))) / t->count : 0;
            double by = rint(16 * (logit(p) - logit(before)));
            if (fmin(saved, MOST) * (double)tiles > BITS && isfinite(by))
                t->codec->model.start[c][k] = (int8_t)fmin(fmax(by, INT8_MIN), INT8_MAX);
        }
    }
}

tc_status tc_exact_train(const tc_lifting_level *level, const tc_exact_tile *tiles, int count, int32_t step,
                         int threads, tc_exact_model *model)
{
    trainer t = {.tiles = tiles, .count = count < MOST_TILES ? count : MOST_TILES, .threads = threads, .round = -1};
    tc_exact_model plain = {.step = step};
    counts *seen = malloc(sizeof *seen);
    t.codec = malloc(sizeof *t.codec);
    t.lesson = calloc((size_t)t.count + 1, sizeof *t.lesson);
    tc_status status = seen && t.codec && t.lesson ? TC_OK : TC_ERR_MEMORY;
    for (int n = 0; n < t.count && !status; n++)
        if (!(t.lesson[n].work = malloc(tc_exact_work_bytes())))
            status = TC_ERR_MEMORY;
    if (!status) {
        tc_exact_init(t.codec, level, &plain);
        tc_parallel_for(threads, t.count, prepare, &t);
        for (t.round = 0; t.round < ROUNDS; t.round++) {
            fit_prediction(&t);
            tc_parallel_for(threads, t.count, prepare, &t);
            fit_scale(&t);
        }
        fit_start(&t, seen, t.codec->tiles_x * t.codec->tiles_y);
        *model = t.codec->model;
    }
    for (int n = 0; n < t.count && t.lesson; n++)
        free(t.lesson[n].work);
    free(t.lesson), free(t.codec), free(seen);
    return status;
}
