/* bench_synthesis.c - synthesised levels against the real ones: a terrain's two finest levels are dropped, synthesised
 * from what is left, and compared; beside one Gaussian a level (LH04). And what a level costs.
 *
 *     bench_synthesis truth        bench_synthesis time */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/field/filter.h"
#include "common/synthesis/synthesis.h"
#include "tests/support/datasets.h"
#include "tests/support/detail.h"

enum { DROPPED = 2 };

static void die(const char *what, const tc_error *error)
{
    printf("%s: %s\n", what, error->text);
    exit(1);
}

static void truth(const dataset *d)
{
    tc_grid grid;
    tc_field *real;
    tc_error error = {TC_OK, ""};
    if (!dataset_load(d, &grid))
        return;
    if (tc_field_build(&grid, 0, &real, &error))
        die(d->name, &error);
    int m = tc_field_info(real)->levels;
    tc_synthesis_fit fit[2];
    tc_field *made[2] = {detail_synthesise(real, DROPPED, DETAIL_FITTED, &fit[0]),
                         detail_synthesise(real, DROPPED, DETAIL_GAUSSIAN, &fit[1])};
    printf("%s: ratio %.2f, anisotropy %.2f, kurtosis %.1f -> b %.2f c %.2f smear %.2f spread %.2f peak %.2f curvature "
           "%.2f %.2f "
           "bands %.2f "
           "%.2f %.2f\n",
           d->name, fit[0].ratio, fit[0].anisotropy, fit[0].kurtosis, (double)fit[0].level[0].b,
           (double)fit[0].level[0].c, (double)fit[0].smear, (double)fit[0].spread, (double)fit[0].peak,
           (double)fit[0].curvature[0], (double)fit[0].curvature[1], (double)fit[0].band[0], (double)fit[0].band[1],
           (double)fit[0].band[2]);
    for (int l = m - 1; l <= m; l++) {
        const int64_t side = 2400;
        const detail_figures t = detail_measure(real, real, l, side);
        for (int k = 0; k < 2; k++) {
            const detail_figures s = detail_measure(made[k], real, l, side);
            double mean, worst;
            detail_compare(&s, &t, &mean, &worst);
            printf(
                "  %d %-8s rms %7.3f of %7.3f  deciles %.2f %.2f  kurtosis %6.1f of %6.1f  across/along %.2f of %.2f  "
                "spectrum %.2f of %.2f\n",
                l - m + DROPPED, k ? "gaussian" : "fitted", s.rms, t.rms, mean, worst, s.kurtosis, t.kurtosis,
                s.anisotropy, t.anisotropy, s.spectrum, t.spectrum);
        }
    }
    tc_field_destroy(made[0]), tc_field_destroy(made[1]);
    tc_field_destroy(real);
}

enum { N = 255 };

static double read_ms(const tc_field *f, int level, int64_t x, int64_t y)
{
    static float z[N * N];
    double start = tc_clock_ms();
    if (tc_field_read(f, level, (tc_rect){x, y, x + N, y + N}, z, NULL, N))
        abort();
    return tc_clock_ms() - start;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void time_levels(const dataset *d)
{
    enum { TIMES = 200, PLACES = 15 };
    tc_grid grid;
    tc_field *real, *made;
    tc_error error = {TC_OK, ""};
    tc_synthesis_fit fit;
    if (!dataset_load(d, &grid))
        return;
    if (tc_field_build(&grid, 0, &real, &error))
        die(d->name, &error);
    double start = tc_clock_ms();
    if (tc_synthesis_learn(real, &fit, &error))
        die(d->name, &error);
    double fitted = tc_clock_ms() - start;
    int m = tc_field_info(real)->levels;
    if (tc_synthesis_create(real, 8, &fit, 0, (tc_synthesis_share){0}, &made, &error))
        die(d->name, &error);
    printf("%-40s fit %.0f ms;", d->name, fitted);
    for (int l = m + 1; l <= m + 8; l++) { /* the levels below are there, as in a flight */
        double best = INFINITY;
        const tc_level size = tc_field_level(made, l);
        for (int n = 0; n < TIMES; n++)
            best = fmin(best, read_ms(made, l, size.width / 2, size.height / 2));
        printf(" %.3f", best);
    }
    printf("; anew");
    for (int l = m + 1; l <= m + 8; l++) { /* in the middle of a few places far from one another */
        double ms[PLACES];
        const tc_level size = tc_field_level(made, l);
        for (int n = 0; n < PLACES; n++)
            ms[n] = read_ms(made, l, (int64_t)(fmod(0.7548776662466927 * (n + l), 1) * (double)(size.width - N)),
                            (int64_t)(fmod(0.5698402909980532 * (n + l), 1) * (double)(size.height - N)));
        qsort(ms, PLACES, sizeof *ms, by_size);
        printf(" %.3f", ms[PLACES / 2]);
    }
    /* Beside it: U of as many samples, and copying them. */
    enum { C = (N + 1) / 2, AROUND = C + 3 };
    static float coarse[AROUND * AROUND], fine[4 * C * C], work[2 * C * (C + 3)], copy[4 * C * C];
    double upsampling = INFINITY, copying = INFINITY;
    for (int n = 0; n < 10 * TIMES; n++) {
        coarse[n % AROUND] = (float)n;
        start = tc_clock_ms();
        tc_upsample(coarse + AROUND + 1, AROUND, C, C, fine, work);
        double middle = tc_clock_ms();
        memcpy(copy, fine, sizeof copy);
        copying = fmin(copying, tc_clock_ms() - middle), upsampling = fmin(upsampling, middle - start);
    }
    printf(" ms; U alone %.4f, copying %.4f%s\n", upsampling, copying, copy[0] > 0 ? "" : " ");
    tc_field_destroy(made);
}

int main(int argc, char **argv)
{
    dataset list[DATASETS_MAX];
    int count = dataset_list(list, DATASETS_MAX);
    bool timed = argc > 1 && !strcmp(argv[1], "time");
    for (int n = 0; n < count; n++)
        (timed ? time_levels : truth)(&list[n]);
    return 0;
}
