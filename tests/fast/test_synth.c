/* test_synth.c - the synthetic terrain and what it is made of: the same for all threads, different for all seeds, and
 * within what a landscape can be. What it looks like, only eyes can tell. */
#include "data/erosion.h"
#include "data/noise.h"
#include "data/synth_planar.h"
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float *make(int64_t size, uint64_t seed, int threads, double spacing)
{
    float *z = malloc((size_t)(size * size) * sizeof *z);
    assert_non_null(z);
    for (int64_t i = 0; i < size * size; i++)
        z[i] = NAN;
    tc_error error = {TC_OK, ""};
    tc_synth_planar_options options = {.seed = seed, .threads = threads, .spacing = spacing};
    if (tc_synth_planar(size, &options, z, &error) != TC_OK)
        fail_msg("size %d: %s", (int)size, error.text);
    return z;
}

/* ---- Noise --------------------------------------------------------------------------------------------------- */

static void noise_is_bounded_and_varied(void **state)
{
    (void)state;
    double sum = 0, squares = 0;
    enum { COUNT = 100000 };
    for (int i = 0; i < COUNT; i++) {
        float v = tc_noise(7, 0.37 * i - 9000, -0.23 * i + 5000);
        assert_true(v > -1 && v < 1);
        sum += v;
        squares += v * v;
    }
    assert_true(fabs(sum / COUNT) < 0.01);
    assert_true(sqrt(squares / COUNT) > 0.15 && sqrt(squares / COUNT) < 0.35);
    for (int i = -3; i < 3; i++) /* nothing at lattice points, and no jump beside them */
        for (int j = -3; j < 3; j++) {
            assert_true(tc_noise(1, i, j) == 0);
            assert_true(fabs(tc_noise(1, i - 1e-4, j + 0.5) - tc_noise(1, i + 1e-4, j + 0.5)) < 1e-3);
        }
}

static void noise_rows_are_noise(void **state)
{
    (void)state;
    for (int k = 0; k < 40; k++) {
        float row[100] = {0};
        double x = -17.3 + k, dx = 0.013 * (k + 1), y = 4.7 - 0.31 * k;
        tc_noise_row(99, x, dx, y, 100, 0.5f, row);
        for (int i = 0; i < 100; i++)
            assert_true(row[i] == 0.5f * tc_noise(99, x + i * dx, y));
    }
}

/* The hash and the noise of other machines, which only they could disagree with. */
static void noise_is_what_it_was(void **state)
{
    (void)state;
    assert_true(tc_hash64(1, 2) == 0xF893A2EEFB32555Eu);
    assert_true(tc_hash_point(1, -2, 3) == 0xEEA4064Eu);
    assert_true(tc_noise(5, 1.25, -2.5) == 0x1.4794fp-2f);
    assert_true(tc_fbm(5, 100.1, 7.3, 5, 0.5f) == -0x1.012536p-1f);
}

/* ---- Erosion ------------------------------------------------------------------------------------------------- */

enum { SIDE = 60 };

static tc_erosion make_erosion(void)
{
    enum { CELLS = SIDE * SIDE };
    tc_erosion e = {.n = SIDE,
                    .dx = 100,
                    .seed = 3,
                    .threads = 1,
                    .talus = 0.8f,
                    .firm = 500,
                    .broad = 8000,
                    .gully = 10,
                    .least = 0.001f};
    e.z = malloc(CELLS * sizeof *e.z);
    e.steepness = malloc(CELLS * sizeof *e.steepness);
    e.area = malloc(CELLS * sizeof *e.area);
    e.flow = calloc(CELLS, 1);
    e.order = malloc(CELLS * sizeof *e.order);
    for (int i = 0; i < CELLS; i++) {
        e.z[i] = (float)(tc_hash_point(1, i % SIDE, i / SIDE) % 1000);
        e.steepness[i] = 300;
    }
    e.flow[0] = TC_FLOW_OUTLET;
    return e;
}

static void free_erosion(tc_erosion *e)
{
    free(e->z);
    free(e->steepness);
    free(e->area);
    free(e->flow);
    free(e->order);
}

/* All water of a grid full of hollows reaches the one outlet, before and after a step, and order is an order. */
static void all_water_reaches_the_sea(void **state)
{
    (void)state;
    tc_erosion e = make_erosion();
    float outlet = e.z[0];
    tc_erosion_fill(&e);
    for (int round = 0; round < 20; round++) {
        tc_erosion_route(&e);
        assert_true(e.area[0] == SIDE * SIDE);
        static uint8_t seen[SIDE * SIDE];
        memset(seen, 0, sizeof seen);
        for (int q = 0; q < SIDE * SIDE; q++) {
            int32_t i = e.order[q];
            assert_true(i >= 0 && i < SIDE * SIDE && !seen[i]);
            seen[i] = 1;
        }
        tc_erosion_incise(&e, 0.5f);
        tc_erosion_fill(&e);
        assert_true(e.z[0] == outlet);
    }
    free_erosion(&e);
}

/* The analytical balance of a river: slope = U/K / sqrt(A). */
static void rivers_come_to_balance(void **state)
{
    (void)state;
    tc_erosion e = make_erosion();
    for (int i = 0; i < SIDE * SIDE; i++)
        e.steepness[i] = 20;
    e.broad = 1e30f;
    tc_erosion_fill(&e);
    for (int round = 0; round < 300; round++) {
        tc_erosion_route(&e);
        tc_erosion_incise(&e, 1000);
    }
    int checked = 0;
    for (int q = 1; q < SIDE * SIDE; q++) {
        static const int by[8] = {1, SIDE + 1, SIDE, SIDE - 1, -1, -SIDE - 1, -SIDE, 1 - SIDE};
        int32_t i = e.order[q];
        if (e.area[i] < 20)
            continue;
        double distance = e.flow[i] & 1 ? 100 * sqrt(2) : 100;
        double slope = (e.z[i] - e.z[i + by[e.flow[i]]]) / distance;
        assert_true(fabs(slope * sqrt(e.area[i] * 1e4) / 20 - 1) < 0.02);
        checked++;
    }
    assert_true(checked > 50);
    free_erosion(&e);
}

/* ---- Terrain ------------------------------------------------------------------------------------------------- */

static void threads_do_not_matter(void **state)
{
    (void)state;
    float *one = make(600, 3, 1, 0), *four = make(600, 3, 4, 0);
    assert_memory_equal(one, four, 600 * 600 * sizeof *one);
    free(one);
    free(four);
}

/* The same bits from every compiler, optimisation and machine. A change of the generator changes the number; nothing
 * else may. */
static void terrain_is_what_it_was(void **state)
{
    (void)state;
    float *z = make(400, 11, 0, 0);
    uint64_t hash = 0;
    for (int i = 0; i < 400 * 400; i++) {
        uint32_t bits;
        memcpy(&bits, &z[i], sizeof bits);
        hash = tc_hash64(hash, bits);
    }
    if (hash != 0xA0CCF70BCFC2F765u)
        fail_msg("the terrain's hash is 0x%016llX", (unsigned long long)hash);
    free(z);
}

static void seeds_differ(void **state)
{
    (void)state;
    float *a = make(129, 1, 0, 0), *b = make(129, 2, 0, 0), *c = make(129, UINT64_MAX, 0, 0);
    double ab = 0, bc = 0;
    for (int i = 0; i < 129 * 129; i++) {
        ab += fabs(a[i] - b[i]);
        bc += fabs(b[i] - c[i]);
    }
    assert_true(ab / (129 * 129) > 10 && bc / (129 * 129) > 10);
    free(a);
    free(b);
    free(c);
}

static void any_size_works(void **state)
{
    (void)state;
    static const int sizes[] = {2, 3, 17, 191, 192, 1000};
    static const double spacings[] = {0, 1, 1000};
    for (size_t s = 0; s < sizeof spacings / sizeof *spacings; s++)
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            if (sizes[k] > 17 && s != k % 3)
                continue;
            float *z = make(sizes[k], 5, 0, spacings[s]);
            for (int i = 0; i < sizes[k] * sizes[k]; i++)
                assert_true(z[i] > -1000 && z[i] < 9000);
            free(z);
        }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    static const struct {
        int64_t size;
        double spacing;
    } bad[] = {{0, 0}, {1, 0}, {-5, 0}, {65538, 0}, {INT64_MAX, 0}, {INT64_MIN, 0}, {9, -1}, {9, NAN}, {9, INFINITY}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        float z[81] = {42};
        tc_error error = {TC_OK, ""};
        tc_synth_planar_options options = {.spacing = bad[i].spacing};
        assert_int_equal(tc_synth_planar(bad[i].size, &options, z, &error), TC_ERR_USAGE);
        assert_true(error.text[0] && z[0] == 42);
    }
}

/* Root mean square of what cubic interpolation along rows leaves, with samples `step` apart. */
static double relief_at(const float *z, int size, int step)
{
    double squares = 0;
    long count = 0;
    for (int y = 0; y < size; y += step)
        for (int x = 3 * step; x < size - 3 * step; x += 2 * step) {
            const float *p = z + (long)y * size + x;
            double r = p[0] - (9 * (p[-step] + p[step]) - p[-3 * step] - p[3 * step]) / 16.0;
            squares += r * r;
            count++;
        }
    return sqrt(squares / (double)count);
}

/* Of two seeds: mountains, a sea, gentle ground and slopes that stand, and relief at every scale that grows from
 * scale to scale, less so beyond the size of a mountain. */
static void looks_like_a_landscape(void **state)
{
    (void)state;
    enum { N = 513 };
    for (uint64_t seed = 1; seed <= 2; seed++) {
        float *z = make(N, seed, 0, 240);
        float low = z[0], high = z[0];
        long sea = 0, gentle = 0, steep = 0, count = 0;
        for (int i = 0; i < N * N; i++) {
            low = z[i] < low ? z[i] : low;
            high = z[i] > high ? z[i] : high;
            sea += z[i] < 0;
        }
        assert_true(low < -60 && low > -500);
        assert_true(high > 2000 && high < 4500);
        assert_true(sea > 0.01 * N * N && sea < 0.35 * N * N);
        for (int y = 1; y < N - 1; y++)
            for (int x = 1; x < N - 1; x++, count++) {
                const float *p = z + y * N + x;
                double slope = hypot(p[1] - p[-1], p[N] - p[-N]) / 480;
                gentle += slope < 0.1;
                steep += slope > 1.2;
                /* no spike: no sample stands alone */
                float most = fmaxf(fmaxf(p[-1], p[1]), fmaxf(p[-N], p[N]));
                assert_true(p[0] - most < 240);
            }
        assert_true(gentle > 0.05 * (double)count && steep < 0.005 * (double)count);
        double finer = relief_at(z, N, 1);
        assert_true(finer > 2);
        for (int step = 2; step <= 8; step *= 2) {
            double coarser = relief_at(z, N, step);
            assert_true(coarser > 1.1 * finer && coarser < 4 * finer);
            finer = coarser;
        }
        free(z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_bounded_and_varied),
        cmocka_unit_test(noise_rows_are_noise),
        cmocka_unit_test(noise_is_what_it_was),
        cmocka_unit_test(all_water_reaches_the_sea),
        cmocka_unit_test(rivers_come_to_balance),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(terrain_is_what_it_was),
        cmocka_unit_test(seeds_differ),
        cmocka_unit_test(any_size_works),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(looks_like_a_landscape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
