/* bench_filter.c - how close D comes to the best L2 filter for U, on real terrains.
 *
 * The coarse level c that makes U(c) the best L2 approximation of a terrain T solves U'U c = U'T. It is found by
 * conjugate gradients from D(T) on, in double, and the rms of T - U(c) is printed beside that of T - U(D(T)) and of
 * plain decimation. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/filter.h"
#include "common/base/rect.h"
#include "tests/support/datasets.h"

enum { MOST = 1400, ITERATIONS = 40 };

/* Weights of coarse samples in the odd fine sample 2i + 1 of an axis with n coarse samples: four taps, those beyond
 * the border replaced by the straight line through the last two. */
static void odd_weights(int64_t i, int64_t n, double *w /* n */, int64_t *lo, int64_t *hi)
{
    static const double tap[4] = {-1.0 / 16, 9.0 / 16, 9.0 / 16, -1.0 / 16};
    *lo = tc_max64(0, i - 2), *hi = tc_min64(n, i + 3);
    for (int64_t k = *lo; k < *hi; k++)
        w[k - *lo] = 0;
    for (int k = 0; k < 4; k++) {
        int64_t at = i - 1 + k;
        if (at >= 0 && at < n) {
            w[at - *lo] += tap[k];
        } else if (n == 1) {
            w[0] += tap[k];
        } else {
            int64_t edge = at < 0 ? 0 : n - 1, next = at < 0 ? 1 : n - 2, steps = at < 0 ? -at : at - n + 1;
            w[edge - *lo] += tap[k] * (double)(1 + steps);
            w[next - *lo] -= tap[k] * (double)steps;
        }
    }
}

/* f = U c (transpose false) or c = U' f along one axis of m fine and n coarse samples, `stride` apart. */
static void axis(double *c, int64_t n, double *f, int64_t m, int64_t stride, bool transpose)
{
    if (transpose)
        for (int64_t i = 0; i < n; i++)
            c[i * stride] = 0;
    for (int64_t x = 0; x < m; x++) {
        if (x % 2 == 0) {
            if (transpose)
                c[x / 2 * stride] += f[x * stride];
            else
                f[x * stride] = c[x / 2 * stride];
            continue;
        }
        double w[8], sum = 0;
        int64_t lo, hi;
        odd_weights(x / 2, n, w, &lo, &hi);
        for (int64_t k = lo; k < hi; k++) {
            sum += w[k - lo] * c[k * stride];
            if (transpose)
                c[k * stride] += w[k - lo] * f[x * stride];
        }
        if (!transpose)
            f[x * stride] = sum;
    }
}

typedef struct shape {
    int64_t w, h, cw, ch;
    double *rows; /* cw * h */
} shape;

static void up(const shape *s, double *c, double *f)
{
    for (int64_t i = 0; i < s->cw; i++)
        axis(c + i, s->ch, s->rows + i, s->h, s->cw, false);
    for (int64_t j = 0; j < s->h; j++)
        axis(s->rows + j * s->cw, s->cw, f + j * s->w, s->w, 1, false);
}

static void down(const shape *s, double *f, double *c)
{
    for (int64_t j = 0; j < s->h; j++)
        axis(s->rows + j * s->cw, s->cw, f + j * s->w, s->w, 1, true);
    for (int64_t i = 0; i < s->cw; i++)
        axis(c + i, s->ch, s->rows + i, s->h, s->cw, true);
}

static double dot(const double *a, const double *b, int64_t n)
{
    double sum = 0;
    for (int64_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* rms of T - U(c); f is overwritten. */
static double residual(const shape *s, double *c, const double *t, double *f)
{
    up(s, c, f);
    double sum = 0;
    for (int64_t i = 0; i < s->w * s->h; i++)
        sum += (t[i] - f[i]) * (t[i] - f[i]);
    return sqrt(sum / (double)(s->w * s->h));
}

static double *array(int64_t count)
{
    double *a = malloc((size_t)count * sizeof *a);
    if (!a)
        exit(99);
    return a;
}

static void measure(const dataset *d)
{
    tc_grid g;
    if (!dataset_load(d, &g))
        return;
    shape s = {.w = tc_min64(g.width, MOST), .h = tc_min64(g.height, MOST)};
    s.cw = tc_coarse_size(s.w), s.ch = tc_coarse_size(s.h);
    s.rows = array(s.cw * s.h);
    int64_t n = s.cw * s.ch, x0 = (g.width - s.w) / 2, y0 = (g.height - s.h) / 2;
    float *z = malloc((size_t)(s.w * s.h) * sizeof *z), *low = malloc((size_t)n * sizeof *low);
    float *scratch = malloc(tc_downsample_scratch(s.w, s.ch) * sizeof *scratch);
    double *t = array(s.w * s.h), *f = array(s.w * s.h), *c = array(n), *r = array(n), *p = array(n), *q = array(n);
    for (int64_t j = 0; j < s.h; j++)
        for (int64_t i = 0; i < s.w; i++)
            t[j * s.w + i] = z[j * s.w + i] = g.z[(y0 + j) * g.width + x0 + i];
    for (int64_t i = 0; i < n; i++)
        c[i] = t[i / s.cw * 2 * s.w + i % s.cw * 2];
    double decimated = residual(&s, c, t, f);
    tc_downsample(z, s.w, s.h, false, 0, s.ch, low, scratch);
    for (int64_t i = 0; i < n; i++)
        c[i] = low[i];
    double lifted = residual(&s, c, t, f);

    for (int64_t i = 0; i < s.w * s.h; i++) /* r = U'(T - U c) */
        f[i] = t[i] - f[i];
    down(&s, f, r);
    memcpy(p, r, (size_t)n * sizeof *p);
    double rr = dot(r, r, n);
    for (int k = 0; k < ITERATIONS && rr > 0; k++) {
        up(&s, p, f);
        double a = rr / dot(f, f, s.w * s.h);
        down(&s, f, q);
        for (int64_t i = 0; i < n; i++)
            c[i] += a * p[i], r[i] -= a * q[i];
        double next = dot(r, r, n);
        for (int64_t i = 0; i < n; i++)
            p[i] = r[i] + next / rr * p[i];
        rr = next;
    }
    double best = residual(&s, c, t, f);
    printf("filter: %-40s decimation %8.4f m, D %8.4f m, best L2 %8.4f m, D / best %.5f\n", d->name, decimated, lifted,
           best, lifted / best);
    free(s.rows), free(z), free(low), free(scratch), free(t), free(f), free(c), free(r), free(p), free(q);
    tc_grid_free(&g);
}

int main(void)
{
    const dataset sets[] = {{"default", 0, 0},
                            {"ps_height_1k.png", 160, 0.1},
                            {"srtm3_tatra_poland_4801.tif", 0, 0},
                            {"srtm3_canyonlands_voids_2401x3601.tif", 0, 0},
                            {"moon_gld100_256ppd_ne_4097.png", 0, 0},
                            {"N46E008.tif", 0, 0}};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++)
        measure(&sets[i]);
    return 0;
}
