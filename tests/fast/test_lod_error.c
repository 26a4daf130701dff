/* test_lod_error.c - statistics of errors, and levels against the finest one. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "common/measure/error_stats.h"
#include "common/measure/lod_error.h"
#include "common/base/mesh.h"
#include "tests/support/terrains.h"

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void statistics_match_sorting(void **state)
{
    (void)state;
    enum { N = 100000 };
    double *e = malloc(N * sizeof *e), squares = 0;
    tc_error_stats all, half;
    assert_int_equal(tc_error_stats_init(&all), TC_OK);
    assert_int_equal(tc_error_stats_init(&half), TC_OK);
    test_random r = {1};
    for (int i = 0; i < N; i++) {
        e[i] = pow(10, test_random_range(&r, -6, 4));
        squares += e[i] * e[i];
        tc_error_stats_add(i & 1 ? &all : &half, i % 3 ? e[i] : -e[i]);
    }
    tc_error_stats_merge(&all, &half);
    qsort(e, N, sizeof *e, by_value);
    assert_int_equal(all.count, N);
    assert_float_equal(tc_error_stats_rms(&all), sqrt(squares / N), 1e-9 * sqrt(squares / N));
    assert_true(all.max == e[N - 1]);
    for (double f = 0.001; f < 1; f += 0.0873) {
        double want = e[(int)ceil(f * N) - 1];
        assert_float_equal(tc_error_stats_percentile(&all, f), want, want / 256);
    }
    tc_error_stats_free(&all), tc_error_stats_free(&half);
    free(e);
}

static void no_errors_are_no_error(void **state)
{
    (void)state;
    tc_error_stats s;
    assert_int_equal(tc_error_stats_init(&s), TC_OK);
    assert_true(tc_error_stats_rms(&s) == 0 && tc_error_stats_percentile(&s, 0.999) == 0);
    tc_error_stats_add(&s, 0);
    assert_true(tc_error_stats_rms(&s) == 0 && tc_error_stats_percentile(&s, 0.999) == 0);
    tc_error_stats_free(&s);
}

/* Straight from the definition, sample by sample. */
static void levels_against_the_finest(void **state)
{
    (void)state;
    enum { W = 131, H = 90 };
    tc_field *p = terrain_field(TERRAIN_CLIFF, W, H, 30, 3);
    int m = tc_field_info(p)->levels;
    float fine[W * H], mesh[W * H];
    assert_int_equal(tc_field_read(p, m, (tc_rect){0, 0, W, H}, fine, NULL, W), TC_OK);
    for (int l = m; l >= m - 3; l--) {
        tc_level level = tc_field_level(p, l);
        int g = 1 << (m - l), w = (int)level.width;
        assert_int_equal(tc_field_read(p, l, (tc_rect){0, 0, level.width, level.height}, mesh, NULL, w), TC_OK);
        double squares = 0, most = 0;
        for (int j = 0; j < H; j++)
            for (int i = 0; i < W; i++) {
                int a = i / g < w - 1 ? i / g : w - 2, b = j / g < level.height - 1 ? j / g : (int)level.height - 2;
                double x = (double)(i - a * g) / g, y = (double)(j - b * g) / g;
                const float *z = mesh + b * w + a;
                double h = x <= 1 && y <= 1 ? tc_triangle_height(z[0], z[1], z[w], z[w + 1], x, y)
                                            : (1 - y) * (z[0] + x * (z[1] - (double)z[0])) +
                                                  y * (z[w] + x * (z[w + 1] - (double)z[w]));
                double e = fabs(h - fine[j * W + i]);
                squares += e * e, most = fmax(most, e);
            }
        tc_lod_error e;
        assert_int_equal(tc_lod_error_measure(p, l, 255, 640, M_PI / 2, 3, &e), TC_OK);
        assert_float_equal(e.rms_m, sqrt(squares / (W * H)), 1e-6 * (1 + most));
        assert_float_equal(e.max_m, most, 1e-6 * (1 + most));
        assert_float_equal(e.rms_px, e.rms_m * 320 / (0.4 * 255 * 30 * g), 1e-9 * (1 + most));
        assert_true(e.rms_m <= e.p999_m && e.p999_m <= e.max_m);
    }
    tc_field_destroy(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statistics_match_sorting),
        cmocka_unit_test(no_errors_are_no_error),
        cmocka_unit_test(levels_against_the_finest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
