/* test_synth_planet.c - the synthetic planet: the same for all threads and in all sizes, different for all seeds, one
 * surface without seam or pole, and within what a planet can be. What it looks like, only eyes can tell. */
#include "data/noise.h"
#include "data/plates.h"
#include "data/synth_planet.h"
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.141592653589793;

static tc_synth_planet *open_planet(int64_t size, uint64_t seed, int threads)
{
    tc_synth_planet *planet;
    tc_error error = {TC_OK, ""};
    if (tc_synth_planet_open(size, seed, threads, &planet, &error) != TC_OK)
        fail_msg("size %d: %s", (int)size, error.text);
    return planet;
}

static float *make(int64_t size, uint64_t seed, int threads)
{
    float *z = malloc((size_t)(size * size / 2) * sizeof *z);
    assert_non_null(z);
    tc_synth_planet *planet = open_planet(size, seed, threads);
    tc_synth_planet_rows(planet, 0, size / 2, z);
    tc_synth_planet_close(planet);
    return z;
}

/* ---- What it is made of ---------------------------------------------------------------------------------------- */

static void noise_is_bounded_and_varied(void **state)
{
    (void)state;
    double sum = 0, squares = 0;
    enum { COUNT = 100000 };
    for (int i = 0; i < COUNT; i++) {
        float v = tc_noise3(7, 0.37 * i - 9000, -0.23 * i + 5000, 0.119 * i - 700);
        assert_true(v > -1 && v < 1);
        sum += v;
        squares += v * v;
    }
    assert_true(fabs(sum / COUNT) < 0.01);
    assert_true(sqrt(squares / COUNT) > 0.15 && sqrt(squares / COUNT) < 0.35);
    for (int i = -3; i < 3; i++) /* nothing at lattice points, and no jump from cell to cell */
        for (int j = -3; j < 3; j++) {
            assert_true(tc_noise3(1, i, j, i + j) == 0);
            assert_true(fabs(tc_noise3(1, i - 1e-4, j + 0.5, 0.3) - tc_noise3(1, i + 1e-4, j + 0.5, 0.3)) < 1e-3);
            assert_true(fabs(tc_noise3(1, 0.7, i - 1e-4, j + 0.5) - tc_noise3(1, 0.7, i + 1e-4, j + 0.5)) < 1e-3);
            assert_true(fabs(tc_noise3(1, i + 0.2, 0.6, j - 1e-4) - tc_noise3(1, i + 0.2, 0.6, j + 1e-4)) < 1e-3);
        }
}

/* The sum of what boundaries do, as the planet uses it, along great circles: it moves in small steps. */
static void plates_do_not_jump(void **state)
{
    (void)state;
    static tc_plates plates;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        tc_plates_make(&plates, seed);
        for (int turn = 0; turn < 40; turn++) {
            double before = 0, step = 1e-4;
            for (int i = 0; i < 20000; i++) {
                double a = i * step, b = 0.07 * turn;
                double q[3] = {cos(a) * cos(b), sin(a), cos(a) * sin(b)};
                tc_plate_site site;
                tc_plates_at(&plates, q, &site);
                assert_true(site.land >= -1 && site.land <= 1);
                double sum = 3 * site.land;
                for (int k = 0; k < site.edges; k++) {
                    const tc_plate_edge *e = &site.edge[k];
                    double d = e->distance / 0.2, t = 1 - d * d;
                    if (t > 0)
                        sum += e->weight * e->approach * t * t;
                }
                if (i > 0 && fabs(sum - before) > 0.02)
                    fail_msg("seed %d, turn %d, step %d: from %g to %g", (int)seed, turn, i, before, sum);
                before = sum;
            }
        }
    }
}

/* ---- The planet ------------------------------------------------------------------------------------------------- */

static void threads_and_rows_do_not_matter(void **state)
{
    (void)state;
    enum { N = 300 };
    float *one = make(N, 3, 1), *four = make(N, 3, 4), row[N];
    assert_memory_equal(one, four, N * N / 2 * sizeof *one);
    tc_synth_planet *planet = open_planet(N, 3, 2);
    for (int j = N / 2 - 1; j >= 0; j -= 7) {
        tc_synth_planet_rows(planet, j, 1, row);
        assert_memory_equal(row, one + j * N, sizeof row);
    }
    tc_synth_planet_close(planet);
    free(one);
    free(four);
}

/* The same bits from every compiler, optimisation and machine. A change of the generator changes the number; nothing
 * else may. */
static void planet_is_what_it_was(void **state)
{
    (void)state;
    enum { N = 400 };
    float *z = make(N, 11, 0);
    uint64_t hash = 0;
    for (int i = 0; i < N * N / 2; i++) {
        uint32_t bits;
        memcpy(&bits, &z[i], sizeof bits);
        hash = tc_hash64(hash, bits);
    }
    if (hash != 0x033427303F22533Fu)
        fail_msg("the planet's hash is 0x%016llX", (unsigned long long)hash);
    free(z);
}

static void seeds_differ(void **state)
{
    (void)state;
    enum { N = 128, COUNT = N * N / 2 };
    float *a = make(N, 1, 0), *b = make(N, 2, 0), *c = make(N, UINT64_MAX, 0);
    double ab = 0, bc = 0;
    for (int i = 0; i < COUNT; i++) {
        ab += fabs(a[i] - b[i]);
        bc += fabs(b[i] - c[i]);
    }
    assert_true(ab / COUNT > 500 && bc / COUNT > 500);
    free(a);
    free(b);
    free(c);
}

/* Root mean square of the step from column i to column i + 1, over the rows between 60 degrees south and north. */
static double step_east(const float *z, int n, int i)
{
    double squares = 0;
    for (int j = n / 12; j < n / 2 - n / 12; j++) {
        double d = z[j * n + (i + 1) % n] - z[j * n + i];
        squares += d * d;
    }
    return sqrt(squares / (n / 3));
}

static void there_is_no_seam(void **state)
{
    (void)state;
    enum { N = 512 };
    for (uint64_t seed = 1; seed <= 3; seed++) {
        float *z = make(N, seed, 0);
        double most = 0, sum = 0;
        for (int i = 0; i < N - 1; i++) {
            double step = step_east(z, N, i);
            sum += step;
            most = fmax(most, step);
        }
        double seam = step_east(z, N, N - 1);
        assert_true(seam > 0.2 * sum / (N - 1) && seam < most * 1.05);
        free(z);
    }
}

/* Around a pole the rows are small circles of one smooth cap: neighbours differ by little, opposite samples too. */
static void poles_are_places_like_others(void **state)
{
    (void)state;
    enum { N = 1024 };
    float row[2][N];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        tc_synth_planet *planet = open_planet(N, seed, 0);
        for (int pole = 0; pole < 2; pole++) {
            tc_synth_planet_rows(planet, pole ? N / 2 - 1 : 0, 1, row[0]);
            tc_synth_planet_rows(planet, pole ? N / 2 - 2 : 1, 1, row[1]);
            for (int i = 0; i < N; i++) {
                assert_true(fabsf(row[0][i] - row[0][(i + 1) % N]) < 10);
                assert_true(fabsf(row[0][i] - row[0][(i + N / 2) % N]) < 400);
                assert_true(fabsf(row[0][i] - row[1][i]) < 400);
                assert_true(row[0][i] > 1000 && row[0][i] < 5000); /* ice */
            }
        }
        tc_synth_planet_close(planet);
    }
}

/* Of several seeds: land and sea, shallow and deep, plains and mountains, in the shares of a planet like the Earth. */
static void looks_like_a_planet(void **state)
{
    (void)state;
    enum { N = 512 };
    for (uint64_t seed = 1; seed <= 8; seed++) {
        float *z = make(N, seed, 0);
        double all = 0, land = 0, dry = 0, low_land = 0, mountains = 0, abyss = 0, shelf = 0;
        float low = 0, high = 0;
        for (int j = 0; j < N / 2; j++)
            for (int i = 0; i < N; i++) {
                float h = z[j * N + i];
                double area = cos(((j + 0.5) * 2 / N - 0.5) * pi), latitude = (j + 0.5) * 360 / N - 90;
                all += area;
                abyss += h < -3500 ? area : 0;
                shelf += h < 0 && h > -300 ? area : 0;
                land += h > 0 ? area : 0;
                if (h > 0 && fabs(latitude) < 60) { /* free of ice */
                    dry += area;
                    low_land += h < 1000 ? area : 0;
                    mountains += h > 2500 ? area : 0;
                }
                low = fminf(low, h);
                high = fmaxf(high, h);
            }
        if (!(land > 0.25 * all && land < 0.55 * all && low > -9500 && low < -6000 && high > 4500 && high < 9000 &&
              low_land > 0.6 * dry && mountains > 0.002 * dry && abyss > 0.25 * all && shelf > 0.02 * all))
            fail_msg("seed %d: land %.3f, %.0f to %.0f m; of dry land low %.3f, mountains %.4f; abyss %.3f shelf %.3f",
                     (int)seed, land / all, low, high, low_land / dry, mountains / dry, abyss / all, shelf / all);
        free(z);
    }
}

/* Block means of a larger size are close to the smaller one's samples, and there is more in between. */
static void larger_is_the_same_planet(void **state)
{
    (void)state;
    enum { N = 256, BY = 4, LARGE = N * BY };
    float *small = make(N, 5, 0), *large = make(LARGE, 5, 0);
    double difference = 0, variance = 0, mean = 0, detail = 0;
    int count = 0;
    for (int j = N / 16; j < N / 2 - N / 16; j++)
        for (int i = 0; i < N; i++, count++) {
            double block = 0;
            for (int k = 0; k < BY * BY; k++)
                block += large[(j * BY + k / BY) * LARGE + i * BY + k % BY];
            block /= BY * BY;
            double d = block - small[j * N + i], e = large[(j * BY + 1) * LARGE + i * BY + 1] - block;
            difference += d * d;
            detail += e * e;
            mean += small[j * N + i];
            variance += (double)small[j * N + i] * small[j * N + i];
        }
    variance = variance / count - mean / count * mean / count;
    if (!(difference / count < 0.03 * variance))
        fail_msg("differs by %.0f m rms of %.0f m", sqrt(difference / count), sqrt(variance));
    assert_true(sqrt(detail / count) > 20);
    free(small);
    free(large);
}

static void sizes_are_checked(void **state)
{
    (void)state;
    static const int64_t good[] = {4, 6, 10, 62}, bad[] = {0, -4, 2, 3, 5, 4097, 65538, INT64_MAX, INT64_MIN};
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        float *z = make(good[k], 9, 0);
        for (int i = 0; i < good[k] * good[k] / 2; i++)
            assert_true(z[i] > -10000 && z[i] < 9500);
        free(z);
    }
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        tc_synth_planet *planet = (tc_synth_planet *)&planet;
        tc_error error = {TC_OK, ""};
        assert_int_equal(tc_synth_planet_open(bad[k], 1, 1, &planet, &error), TC_ERR_USAGE);
        assert_true(error.text[0] && !planet);
    }
    tc_synth_planet_close(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_bounded_and_varied),
        cmocka_unit_test(plates_do_not_jump),
        cmocka_unit_test(threads_and_rows_do_not_matter),
        cmocka_unit_test(planet_is_what_it_was),
        cmocka_unit_test(seeds_differ),
        cmocka_unit_test(there_is_no_seam),
        cmocka_unit_test(poles_are_places_like_others),
        cmocka_unit_test(looks_like_a_planet),
        cmocka_unit_test(larger_is_the_same_planet),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
