/* row_filter.c - low-pass filter along a parallel, as wide on the ground everywhere.
 *
 * Towards the pole the columns of a grid crowd: a sample of a cap has a footprint of h = spacing / (column's width)
 * columns, up to all of them. K is a triangle of half width h, as two boxes of width h by prefix sums, and the filter
 * is 2 K - K K, which is flat where K is not yet: 0.65 at the cap's Nyquist frequency, 0 at twice that. A triangle of
 * half width 1 is one sample, so that the filter sets in gradually.
 *
 * On the few rows next to the pole even the first harmonic is attenuated, and that is the terrain's slope at the pole.
 * Its wave is longer than any that the cap cannot hold, so what it lost is given back. */
#include "atlas_caps.h"

#include <math.h>
#include <string.h>

static const double turn = 6.283185307179586;

/* A box of 2 * reach + 1 columns and the share `edge` of one more on either side. */
typedef struct box {
    int64_t reach;
    double edge, width;
} box;

size_t tc_row_filter_scratch(int64_t n)
{
    return 6 * (size_t)n + 16; /* a row, twice; and a row that goes on by half on either side, and its sums */
}

/* out may be f. */
static void apply_box(const box *b, const double *f, int64_t n, double *out, double *scratch)
{
    int64_t pad = b->reach + 1, length = n + 2 * pad;
    double *padded = scratch, *sum = padded + length; /* sum[k]: of padded samples before k */
    for (int64_t k = 0; k < pad; k++) {
        padded[k] = f[((k - pad) % n + n) % n];
        padded[pad + n + k] = f[k % n];
    }
    memcpy(padded + pad, f, (size_t)n * sizeof *f);
    sum[0] = 0;
    for (int64_t k = 0; k < length; k++)
        sum[k + 1] = sum[k] + padded[k];
    double scale = 1 / b->width;
    int64_t span = 2 * b->reach + 1;
    for (int64_t i = 0; i < n; i++)
        out[i] = (sum[i + 1 + span] - sum[i + 1] + b->edge * (padded[i] + padded[i + span + 1])) * scale;
}

/* What the filter leaves of the first harmonic. */
static double first_harmonic(const box *b, double column)
{
    double inner = sin(((double)b->reach + 0.5) * column) / sin(0.5 * column);
    double boxed = (inner + 2 * b->edge * cos((double)(b->reach + 1) * column)) / b->width;
    double k = boxed * boxed;
    return k * (2 - k);
}

/* Adds the first harmonic of row, times factor. */
static void add_first_harmonic(const float *row, int64_t n, double factor, double *out)
{
    double column = turn / (double)n, a = 0, b = 0;
    for (int64_t i = 0; i < n; i++) {
        double x = column * (double)i, z = (double)row[i] - (double)row[0]; /* exactly none in a constant row */
        a += z * cos(x);
        b += z * sin(x);
    }
    a *= 2 * factor / (double)n, b *= 2 * factor / (double)n;
    for (int64_t i = 0; i < n; i++)
        out[i] += a * cos(column * (double)i) + b * sin(column * (double)i);
}

void tc_row_filter(const float *row, int64_t n, double theta, double spacing, float *out, double *scratch)
{
    double *once = scratch, *twice = once + n, *rest = twice + n, column = turn / (double)n;
    double width = fmin(spacing / (column * fmax(sin(theta), 1e-12)), (double)n), half = 0.5 * (width - 1);
    if (!(width > 1 + 1e-9)) {
        memmove(out, row, (size_t)n * sizeof *out);
        return;
    }
    box b = {(int64_t)half, half - floor(half), width};
    for (int64_t i = 0; i < n; i++)
        twice[i] = row[i];
    apply_box(&b, twice, n, once, rest);
    apply_box(&b, once, n, once, rest);
    apply_box(&b, once, n, twice, rest);
    apply_box(&b, twice, n, twice, rest);
    for (int64_t i = 0; i < n; i++)
        twice[i] = 2 * once[i] - twice[i];
    double lost = 1 - first_harmonic(&b, column);
    if (theta > 0 && lost > 1e-6)
        add_first_harmonic(row, n, lost, twice);
    for (int64_t i = 0; i < n; i++)
        out[i] = (float)twice[i];
}
