/* row_resample.c - rows once around a globe, resampled: sinc(x) sinc(x / 4) over eight columns. */
#include "row_resample.h"

#include <math.h>
#include <stdlib.h>

enum { TAPS = 8 };

static const double pi = 3.141592653589793;

typedef struct taps {
    int64_t first; /* column of the first tap, may lie before 0 or lead beyond the last */
    int64_t nearest;
    double weight[TAPS];
} taps;

struct tc_row_resampler {
    int64_t from, to;
    taps taps[];
};

static double sinc(double x)
{
    return fabs(x) < 1e-12 ? 1 : sin(pi * x) / (pi * x);
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
            double x = at - (double)(t->first + k);
            t->weight[k] = fabs(x) < TAPS / 2 ? sinc(x) * sinc(x / (TAPS / 2)) : 0;
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
