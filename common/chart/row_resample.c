/* row_resample.c - rows once around a globe, resampled: by the polynomial through the eight columns around. Of all
 * kernels that wide it is the flattest, so that smooth terrain comes through as it is; windowed sincs ripple by 2e-4.
 */
#include "row_resample.h"

#include <math.h>
#include <stdlib.h>

enum { TAPS = 8 };

typedef struct taps {
    int64_t first; /* column of the first tap, may lie before 0 or lead beyond the last */
    int64_t nearest;
    double weight[TAPS];
} taps;

struct tc_row_resampler {
    int64_t from, to;
    taps taps[];
};

/* Lagrange's polynomial of tap k, at the position `at` counted from tap 0. */
static double polynomial(int k, double at)
{
    double product = 1;
    for (int n = 0; n < TAPS; n++)
        product *= n == k ? 1 : (at - n) / (k - n);
    return product;
}

tc_row_resampler *tc_row_resampler_create(int64_t from, int64_t to)
{
    tc_row_resampler *r = malloc(sizeof *r + (size_t)to * sizeof *r->taps);
    if (!r)
        return NULL;
    r->from = from;
    r->to = to;
    for (int64_t i = 0; i < to; i++) {
        taps *t = &r->taps[i];
        double at = (double)i * (double)from / (double)to, sum = 0;
        int64_t column = (int64_t)floor(at);
        t->first = column - (TAPS / 2 - 1);
        t->nearest = (column + (at - (double)column >= 0.5)) % from;
        for (int k = 0; k < TAPS; k++) {
            t->weight[k] = polynomial(k, at - (double)t->first);
            sum += t->weight[k];
        }
        for (int k = 0; k < TAPS; k++)
            t->weight[k] /= sum;
    }
    return r;
}

void tc_row_resampler_destroy(tc_row_resampler *resampler)
{
    free(resampler);
}

void tc_row_resample(const tc_row_resampler *r, const float *z, float *out)
{
    for (int64_t i = 0; i < r->to; i++) {
        const taps *t = &r->taps[i];
        double sum = 0;
        if (t->first >= 0 && t->first + TAPS <= r->from)
            for (int k = 0; k < TAPS; k++)
                sum += t->weight[k] * (double)z[t->first + k];
        else
            for (int k = 0; k < TAPS; k++)
                sum += t->weight[k] * (double)z[(t->first + k + TAPS * r->from) % r->from];
        out[i] = (float)sum;
    }
}

void tc_row_resample_voids(const tc_row_resampler *r, const uint8_t *voids, uint8_t *out)
{
    for (int64_t i = 0; i < r->to; i++)
        out[i] = voids[r->taps[i].nearest];
}
