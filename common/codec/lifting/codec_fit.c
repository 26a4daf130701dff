/* codec_fit.c - weights by least squares and by maximum likelihood.
 *
 * Scales: magnitudes q are geometrically distributed (a quantised Laplacian) with expected value s = sum of w_k f_k
 * over non-negative weights. The likelihood of q is s^q / (1 + s)^(q + 1); Fisher scoring (McCullagh, Nelder 1989)
 * climbs it by steps that solve (sum f f' / (s (1 + s))) step = sum f (q / s - (1 + q) / (1 + s)), where weights that
 * would fall below zero are held there. A continuous exponential would not do: where s is small, it fears the rare one
 * far more than the code does. */
#include <math.h>

#include "codec_fit.h"
#include "codec_tile.h"
#include "common/base/simd.h"

enum { ITERATIONS = 3, COLUMNS = TC_FIT_COLUMNS, STRANDS = TC_FIT_STRANDS };

void tc_normal_add(tc_normal *n, const uint32_t *term, int count, double truth)
{
    double t[COLUMNS];
    for (int k = 0; k < count; k++)
        t[k] = (int32_t)term[k];
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < count; i++)
            n->a[k][i] += t[k] * t[i];
        n->a[k][COLUMNS] += t[k] * truth;
    }
}

void tc_normal_join(tc_normal *n, const tc_normal *other)
{
    for (int k = 0; k < COLUMNS; k++)
        for (int i = 0; i <= COLUMNS; i++)
            n->a[k][i] += other->a[k][i];
}

void tc_solve_normal(double *a, ptrdiff_t stride, int count, double x[])
{
    const ptrdiff_t right = stride - 1;
    int order[TC_SOLVE_MOST];
    for (int k = 0; k < count; k++)
        a[k * stride + k] = a[k * stride + k] * (1 + 1e-6) + 1e-3, order[k] = k;
    for (int k = 0; k < count; k++) {
        int pivot = k;
        for (int i = k + 1; i < count; i++)
            if (fabs(a[order[i] * stride + k]) > fabs(a[order[pivot] * stride + k]))
                pivot = i;
        int swap = order[k];
        order[k] = order[pivot], order[pivot] = swap;
        const double *p = a + order[k] * stride;
        for (int i = k + 1; i < count; i++) {
            double *q = a + order[i] * stride, f = q[k] / p[k];
            for (int m = k; m < count; m++)
                q[m] -= f * p[m];
            q[right] -= f * p[right];
        }
    }
    for (int k = count - 1; k >= 0; k--) {
        const double *p = a + order[k] * stride;
        double sum = p[right];
        for (int i = k + 1; i < count; i++)
            sum -= p[i] * x[i];
        x[k] = sum / p[k];
    }
}

void tc_normal_solve(tc_normal *n, int count, double x[])
{
    tc_solve_normal(n->a[0], COLUMNS + 1, count, x);
}

/* The matrix of a step and its right side. */
TC_INLINE void scoring(const tc_strands *feature, int64_t count, const float w[TC_SCALE], tc_normal *sum)
{
    float matrix[TC_SCALE][TC_SCALE][STRANDS] = {{{0}}}, side[TC_SCALE][STRANDS] = {{0}};
    for (int64_t i = 0; i < (count + STRANDS - 1) / STRANDS; i++) {
        const tc_strands *f = &feature[i];
        float s[STRANDS], slope[STRANDS], inverse[STRANDS];
        for (int l = 0; l < STRANDS; l++)
            s[l] = 0.001F;
        for (int k = 0; k < TC_SCALE; k++)
            for (int l = 0; l < STRANDS; l++)
                s[l] += w[k] * f->of[k][l];
        for (int l = 0; l < STRANDS; l++) {
            float q = f->of[TC_SCALE][l];
            inverse[l] = 1 / (s[l] * (1 + s[l]));
            slope[l] = (q - s[l]) * inverse[l]; /* q / s - (1 + q) / (1 + s) */
        }
        for (int k = 0; k < TC_SCALE; k++) {
            float weighed[STRANDS];
            for (int l = 0; l < STRANDS; l++) {
                side[k][l] += f->of[k][l] * slope[l];
                weighed[l] = f->of[k][l] * inverse[l];
            }
            for (int m = 0; m <= k; m++)
                for (int l = 0; l < STRANDS; l++)
                    matrix[k][m][l] += weighed[l] * f->of[m][l];
        }
    }
    memset(sum, 0, sizeof *sum);
    for (int k = 0; k < TC_SCALE; k++) {
        for (int m = 0; m <= k; m++) {
            for (int l = 0; l < STRANDS; l++)
                sum->a[k][m] += matrix[k][m][l];
            sum->a[m][k] = sum->a[k][m];
        }
        for (int l = 0; l < STRANDS; l++)
            sum->a[k][COLUMNS] += side[k][l];
    }
}

#if TC_AVX2
TC_TARGET_AVX2 static void scoring_avx2(const tc_strands *feature, int64_t count, const float w[TC_SCALE],
                                        tc_normal *sum)
{
    scoring(feature, count, w, sum);
}
#endif

/* Goes one step; weights that would fall below zero go to zero, which the others then answer to. */
static void take_step(const tc_normal *sum, float w[TC_SCALE])
{
    bool held[TC_SCALE] = {false};
    double x[COLUMNS];
    for (bool again = true; again;) {
        tc_normal n = *sum;
        for (int k = 0; k < TC_SCALE; k++)
            for (int m = 0; m < TC_SCALE && held[k]; m++) { /* x[k] is known: -w[k] */
                n.a[m][COLUMNS] += n.a[m][k] * w[k];
                n.a[m][k] = n.a[k][m] = 0;
            }
        for (int k = 0; k < TC_SCALE; k++)
            if (held[k])
                n.a[k][k] = 1, n.a[k][COLUMNS] = -w[k];
        tc_normal_solve(&n, TC_SCALE, x);
        again = false;
        for (int k = 0; k < TC_SCALE; k++)
            if (!held[k] && !(w[k] + x[k] >= 0))
                held[k] = again = true;
    }
    for (int k = 0; k < TC_SCALE; k++)
        w[k] = held[k] ? 0 : (float)fmin(w[k] + x[k], 4);
}

void tc_fit_scale(const tc_strands *feature, int64_t count, uint16_t weight[TC_SCALE])
{
    enum { UNIT = 1 << TC_SCALE_BITS };
    float w[TC_SCALE];
    for (int k = 0; k < TC_SCALE; k++)
        w[k] = (float)weight[k] / UNIT;
    for (int n = 0; n < ITERATIONS; n++) {
        tc_normal sum;
#if TC_AVX2
        if (tc_have_avx2())
            scoring_avx2(feature, count, w, &sum);
        else
#endif
            scoring(feature, count, w, &sum);
        take_step(&sum, w);
    }
    for (int k = 0; k < TC_SCALE; k++)
        weight[k] = (uint16_t)lrintf(w[k] * UNIT);
}
