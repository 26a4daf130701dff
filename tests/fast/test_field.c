/* test_field.c - filters and the pyramid in memory. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/filter.h"
#include "common/field/field.h"
#include "common/base/rect.h"
#include "tests/support/terrains.h"

/* D by its definition, on one axis, in double: the oracle. */
static void lift(const double *x, int64_t n, ptrdiff_t stride, double *low)
{
    int64_t evens = (n + 1) / 2, odds = n / 2;
    double *e = calloc((size_t)evens + 4, sizeof *e), *d = calloc((size_t)evens + 4, sizeof *d);
    e += 1, d += 2;
    for (int64_t i = 0; i < evens; i++)
        e[i] = x[2 * i * stride];
    double first = evens > 1 ? e[1] - e[0] : 0, last = evens > 1 ? e[evens - 1] - e[evens - 2] : 0;
    e[-1] = e[0] - first, e[evens] = e[evens - 1] + last, e[evens + 1] = e[evens - 1] + 2 * last;
    for (int64_t i = 0; i < odds; i++)
        d[i] = x[(2 * i + 1) * stride] - (9 * (e[i] + e[i + 1]) - e[i - 1] - e[i + 2]) / 16;
    for (int64_t i = 0; i < evens; i++)
        low[i] = e[i] + 19. / 64 * (d[i - 1] + d[i]) - 3. / 64 * (d[i - 2] + d[i + 1]);
    free(e - 1), free(d - 2);
}

static void downsample_follows_its_definition(void **state)
{
    (void)state;
    const int64_t sizes[][2] = {{1, 1}, {2, 1}, {1, 2}, {2, 2}, {3, 3}, {4, 5}, {5, 4}, {7, 6}, {33, 18}, {64, 131}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        int64_t w = sizes[s][0], h = sizes[s][1], cw = (w + 1) / 2, ch = (h + 1) / 2;
        float *z = malloc((size_t)(w * h) * sizeof *z), *coarse = malloc((size_t)(cw * ch) * sizeof *coarse);
        double *rows = malloc((size_t)(cw * h) * sizeof *rows), *x = malloc((size_t)w * sizeof *x);
        double *column = malloc((size_t)ch * sizeof *column);
        test_random r = {s};
        for (int64_t i = 0; i < w * h; i++)
            z[i] = (float)test_random_range(&r, -1000, 1000);
        for (int64_t j = 0; j < h; j++) {
            for (int64_t i = 0; i < w; i++)
                x[i] = z[j * w + i];
            lift(x, w, 1, rows + j * cw);
        }
        /* In bands of every size: the cut must not matter. */
        for (int64_t band = 1; band <= ch; band = band * 2 + 1) {
            float *scratch = malloc(tc_downsample_scratch(w, band) * sizeof *scratch);
            for (int64_t j = 0; j < ch; j += band)
                tc_downsample(z, w, h, false, j, tc_min64(j + band, ch), coarse + j * cw, scratch);
            free(scratch);
            for (int64_t i = 0; i < cw; i++) {
                lift(rows + i, h, cw, column);
                for (int64_t j = 0; j < ch; j++)
                    assert_float_equal(coarse[j * cw + i], column[j], 2e-3);
            }
        }
        free(z), free(coarse), free(rows), free(x), free(column);
    }
}

static void filters_reproduce_planes(void **state)
{
    (void)state;
    const int64_t sizes[][2] = {{2, 2}, {3, 2}, {97, 64}, {130, 131}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        tc_field *p = terrain_field(TERRAIN_SLOPE, sizes[s][0], sizes[s][1], 1, 0);
        for (int l = 1; l <= tc_field_info(p)->levels; l++) {
            tc_level level = tc_field_level(p, l);
            if (level.width < 2 || level.height < 2)
                continue; /* of two samples only one is even: no line can be known */
            for (int64_t j = 0; j < level.height; j++)
                for (int64_t i = 0; i < level.width; i++) {
                    float z;
                    assert_int_equal(tc_field_read(p, l, (tc_rect){i, j, i + 1, j + 1}, &z, NULL, 1), TC_OK);
                    assert_float_equal(z, 0.25 * (double)i * level.spacing_x + 0.5 * (double)j * level.spacing_y, 1e-4);
                }
        }
        tc_field_destroy(p);
    }
}

static void upsample_undoes_downsample_of_smooth_data(void **state)
{
    (void)state;
    enum { N = 20 };
    float c[(N + 3) * (N + 3)], fine[4 * N * N], scratch[2 * N * (N + 3)];
    for (int j = 0; j < N + 3; j++)
        for (int i = 0; i < N + 3; i++) /* cubic in both axes: four-point subdivision reproduces it */
            c[j * (N + 3) + i] = (float)(i * i * i - 3 * i * j + 0.5 * j * j * j);
    tc_upsample(c + N + 3 + 1, N + 3, N, N, fine, scratch);
    for (int j = 0; j < 2 * N; j++)
        for (int i = 0; i < 2 * N; i++) {
            double x = i / 2.0 + 1, y = j / 2.0 + 1;
            assert_float_equal(fine[j * 2 * N + i], x * x * x - 3 * x * y + 0.5 * y * y * y, 2e-2);
        }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    tc_field *a, *b;
    tc_grid grid = terrain_grid(TERRAIN_CLIFF, 700, 501, 30, 5);
    assert_int_equal(tc_field_build(&grid, 1, &a, NULL), TC_OK);
    grid = terrain_grid(TERRAIN_CLIFF, 700, 501, 30, 5);
    assert_int_equal(tc_field_build(&grid, 7, &b, NULL), TC_OK);
    for (int l = 1; l <= tc_field_info(a)->levels; l++) {
        tc_level level = tc_field_level(a, l);
        size_t count = (size_t)(level.width * level.height);
        float *za = malloc(count * sizeof *za), *zb = malloc(count * sizeof *zb);
        tc_rect all = {0, 0, level.width, level.height};
        assert_int_equal(tc_field_read(a, l, all, za, NULL, level.width), TC_OK);
        assert_int_equal(tc_field_read(b, l, all, zb, NULL, level.width), TC_OK);
        assert_memory_equal(za, zb, count * sizeof *za);
        free(za), free(zb);
    }
    tc_field_destroy(a), tc_field_destroy(b);
}

static void bounds_hold(void **state)
{
    (void)state;
    tc_field *p = terrain_field(TERRAIN_CLIFF, 333, 200, 30, 9);
    test_random r = {1};
    for (int k = 0; k < 3000; k++) {
        int l = (int)test_random_int(&r, 1, tc_field_info(p)->levels);
        tc_level level = tc_field_level(p, l);
        int64_t x = test_random_int(&r, -5, level.width + 5), y = test_random_int(&r, -5, level.height + 5);
        tc_rect rect = {x, y, x + test_random_int(&r, 1, 40), y + test_random_int(&r, 1, 40)}, part;
        float z[40 * 40];
        tc_range range = tc_field_range(p, l, rect);
        part = tc_rect_intersect(rect, (tc_rect){0, 0, level.width, level.height});
        assert_int_equal(tc_field_read(p, l, part, z, NULL, 40), TC_OK);
        for (int64_t j = 0; j < part.y1 - part.y0; j++)
            for (int64_t i = 0; i < part.x1 - part.x0; i++)
                assert_true(z[40 * j + i] >= range.lo && z[40 * j + i] <= range.hi);
    }
    tc_field_destroy(p);
}

static void reading_outside_is_refused(void **state)
{
    (void)state;
    tc_field *p = terrain_field(TERRAIN_SMOOTH, 20, 10, 30, 0);
    int m = tc_field_info(p)->levels;
    float z[4] = {7, 7, 7, 7};
    const tc_rect bad[] = {{-1, 0, 1, 1}, {0, -1, 1, 1}, {19, 0, 21, 1}, {0, 9, 1, 11}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(tc_field_read(p, m, bad[i], z, NULL, 2), TC_ERR_USAGE);
    assert_int_equal(tc_field_read(p, 0, (tc_rect){0, 0, 1, 1}, z, NULL, 1), TC_ERR_USAGE);
    assert_int_equal(tc_field_read(p, m + 1, (tc_rect){0, 0, 1, 1}, z, NULL, 1), TC_ERR_USAGE);
    assert_true(z[0] == 7 && z[3] == 7);
    tc_field_destroy(p);
}

static void voids_travel_to_coarser_levels(void **state)
{
    (void)state;
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 65, 65, 30, 0);
    grid.voids = calloc(65 * 65, 1);
    for (int j = 20; j < 41; j++)
        for (int i = 8; i < 33; i++)
            grid.voids[j * 65 + i] = 1;
    grid.void_count = 21 * 25;
    tc_field *p;
    assert_int_equal(tc_field_build(&grid, 0, &p, NULL), TC_OK);
    int m = tc_field_info(p)->levels;
    float z[17 * 17];
    uint8_t voids[17 * 17];
    assert_int_equal(tc_field_read(p, m - 2, (tc_rect){0, 0, 17, 17}, z, voids, 17), TC_OK);
    for (int j = 0; j < 17; j++)
        for (int i = 0; i < 17; i++)
            assert_int_equal(voids[j * 17 + i], i >= 2 && i <= 8 && j >= 5 && j <= 10);
    tc_field_destroy(p);
}

/* A flat void is seen at its height and changes nothing else, on any level. */
static void flat_voids_do_not_leak(void **state)
{
    (void)state;
    enum { N = 129 };
    tc_field *p[2];
    for (int flat = 0; flat < 2; flat++) {
        tc_grid grid = terrain_grid(TERRAIN_CLIFF, N, N, 30, 2);
        grid.voids = calloc(N * N, 1);
        for (int i = 0; i < N * N; i++)
            grid.voids[i] = hypot(i % N - 60, i / N - 50) < 21;
        grid.void_count = 1;
        grid.voids_flat = flat != 0;
        grid.void_height = -300;
        assert_int_equal(tc_field_build(&grid, 0, &p[flat], NULL), TC_OK);
    }
    assert_true(tc_field_info(p[1])->z_min == -300 && tc_field_info(p[0])->z_min > -300);
    float a[N * N], b[N * N];
    uint8_t voids[N * N];
    int64_t flat = 0;
    for (int l = 1; l <= tc_field_info(p[0])->levels; l++) {
        tc_level level = tc_field_level(p[0], l);
        tc_rect all = {0, 0, level.width, level.height};
        assert_int_equal(tc_field_read(p[0], l, all, a, voids, N), TC_OK);
        assert_int_equal(tc_field_read(p[1], l, all, b, NULL, N), TC_OK);
        tc_range range = tc_field_range(p[1], l, all);
        for (int64_t k = 0; k < level.width * level.height; k++) {
            int64_t at = k / level.width * N + k % level.width;
            assert_true(b[at] == (voids[at] ? -300 : a[at]));
            assert_true(b[at] >= range.lo && b[at] <= range.hi);
            flat += voids[at];
        }
    }
    assert_true(flat > 1000);
    tc_field_destroy(p[0]), tc_field_destroy(p[1]);
}

/* A grid once around a globe: hills that join at the seam, and noise, turned east by `shift` columns. */
static tc_field *round_field(int64_t width, int64_t height, int64_t shift, bool voids)
{
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, width, height, 30, 0);
    grid.wraps_x = true;
    grid.voids = voids ? calloc((size_t)(width * height), 1) : NULL;
    grid.void_count = voids;
    for (int64_t j = 0; j < height; j++) {
        test_random r = {(uint64_t)j};
        for (int64_t k = 0; k < width; k++) {
            int64_t i = (k + shift) % width;
            double turn = 2 * M_PI * (double)k / (double)width;
            grid.z[j * width + i] = (float)(300 * sin(3 * turn) + test_random_range(&r, -50, 50));
            if (voids)
                grid.voids[j * width + i] = hypot((double)k - 5, (double)(j - height / 2)) < 9;
        }
    }
    grid.z_min = -350, grid.z_max = 350;
    tc_field *p;
    assert_int_equal(tc_field_build(&grid, 0, &p, NULL), TC_OK);
    return p;
}

static void turning_a_globe_turns_its_levels(void **state)
{
    (void)state;
    enum { WIDTH = 3 * 64, HEIGHT = 75, K = 6 };
    tc_field *a = round_field(WIDTH, HEIGHT, 0, true);
    int m = tc_field_info(a)->levels;
    float za[2 * WIDTH], zb[WIDTH];
    uint8_t va[2 * WIDTH], vb[WIDTH];
    for (int k = 0; k <= K; k++)
        for (int64_t shift = (int64_t)1 << k; shift < WIDTH; shift += 5 * ((int64_t)1 << k)) {
            tc_field *b = round_field(WIDTH, HEIGHT, shift, true);
            for (int l = m; l >= m - k; l--) {
                tc_level level = tc_field_level(a, l);
                int64_t w = level.width, s = shift >> (m - l);
                assert_true(tc_field_wraps(a, l));
                for (int64_t j = 0; j < level.height; j++) {
                    assert_int_equal(tc_field_read(a, l, (tc_rect){-s, j, w - s, j + 1}, za, va, w), TC_OK);
                    assert_int_equal(tc_field_read(b, l, (tc_rect){0, j, w, j + 1}, zb, vb, w), TC_OK);
                    assert_memory_equal(za, zb, (size_t)w * sizeof *za);
                    assert_memory_equal(va, vb, (size_t)w);
                }
            }
            tc_field_destroy(b);
        }
    assert_false(tc_field_wraps(a, m - K - 1));
    tc_field_destroy(a);
}

static void a_globe_is_read_across_its_seam(void **state)
{
    (void)state;
    enum { WIDTH = 80, HEIGHT = 33, MOST = 300 };
    tc_field *p = round_field(WIDTH, HEIGHT, 0, true);
    int m = tc_field_info(p)->levels;
    test_random r = {5};
    for (int k = 0; k < 2000; k++) {
        int l = (int)test_random_int(&r, 1, m);
        tc_level level = tc_field_level(p, l);
        int64_t w = level.width, y = test_random_int(&r, 0, level.height - 1), x = test_random_int(&r, -200, 200);
        int64_t count = test_random_int(&r, 1, MOST), rows = tc_min64(2, level.height - y);
        tc_rect rect = {x, y, x + count, y + rows};
        float z[2 * MOST], all[2 * WIDTH];
        uint8_t voids[2 * MOST], all_voids[2 * WIDTH];
        bool inside = x >= 0 && x + count <= w;
        assert_int_equal(tc_field_wraps(p, l), l >= m - 4);
        tc_status status = tc_field_read(p, l, rect, z, voids, MOST);
        assert_int_equal(status, inside || l >= m - 4 ? TC_OK : TC_ERR_USAGE);
        if (status != TC_OK)
            continue;
        assert_int_equal(tc_field_read(p, l, (tc_rect){0, y, w, y + rows}, all, all_voids, w), TC_OK);
        tc_range range = tc_field_range(p, l, rect);
        assert_int_equal(tc_field_ready(p, l, rect, TC_SOON), TC_READY);
        for (int64_t j = 0; j < rows; j++)
            for (int64_t i = 0; i < count; i++) {
                int64_t at = j * w + ((x + i) % w + w) % w;
                assert_true(z[j * MOST + i] == all[at] && voids[j * MOST + i] == all_voids[at]);
                assert_true(all[at] >= range.lo && all[at] <= range.hi);
            }
        rect.y1 = level.height + 1;
        assert_int_equal(tc_field_read(p, l, rect, z, NULL, MOST), TC_ERR_USAGE);
    }
    double a, b;
    for (int k = 0; k < 1000; k++) {
        double x = test_random_range(&r, 0, 30 * WIDTH), y = test_random_range(&r, 0, 30 * HEIGHT);
        assert_int_equal(tc_field_height(p, x, y, &a), TC_OK);
        assert_int_equal(tc_field_height(p, x - 30 * WIDTH, y, &b), TC_OK);
        assert_float_equal(a, b, 1e-6);
    }
    tc_field_destroy(p);
}

static void nonsense_grids_are_refused(void **state)
{
    (void)state;
    tc_field *p = NULL;
    tc_grid empty = {.width = 3, .height = 3, .spacing_x = 1, .spacing_y = 1};
    assert_int_equal(tc_field_build(&empty, 0, &p, NULL), TC_ERR_USAGE);
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 4, 4, 30, 0);
    grid.spacing_x = 0;
    assert_int_equal(tc_field_build(&grid, 0, &p, NULL), TC_ERR_USAGE);
    assert_null(p);
    assert_null(grid.z);
}

/* However large a rectangle is, four reads bound it: also across a seam. */
static void a_range_takes_four_reads(void **state)
{
    (void)state;
    for (int wraps = 0; wraps < 2; wraps++) {
        tc_grid grid = terrain_grid(TERRAIN_CLIFF, 1000, 700, 10, 5);
        grid.wraps_x = wraps;
        tc_field *p;
        assert_int_equal(tc_field_build(&grid, 1, &p, NULL), TC_OK);
        test_random r = {9};
        for (int n = 0; n < 3000; n++) {
            int l = (int)test_random_int(&r, 1, tc_field_info(p)->levels);
            tc_level level = tc_field_level(p, l);
            int64_t x = test_random_int(&r, -level.width, level.width), y = test_random_int(&r, -3, level.height - 1);
            tc_rect rect = {x, y, x + test_random_int(&r, 1, level.width + 2),
                            y + test_random_int(&r, 1, level.height + 2)};
            int64_t before = tc_field_tell(p).range_reads;
            tc_range range = tc_field_range(p, l, rect);
            assert_true(tc_field_tell(p).range_reads - before <= 4);
            assert_true(range.lo <= range.hi);
        }
        assert_true(tc_field_tell(p).ranges > 1000); /* some lie outside */
        tc_field_destroy(p);
    }
}

/* Height of a level's mesh at a place in samples. */
static double on_mesh(const float *z, int64_t w, int64_t h, bool wraps, double u, double v)
{
    int64_t i = wraps ? (int64_t)u : tc_max64(0, tc_min64((int64_t)u, w - 2));
    int64_t j = tc_max64(0, tc_min64((int64_t)v, h - 2)), e = wraps ? (i + 1) % w : tc_min64(i + 1, w - 1);
    int64_t n = tc_min64(j + 1, h - 1);
    double a = z[j * w + i], b = z[j * w + e], c = z[n * w + i], d = z[n * w + e], tx = u - (double)i,
           ty = v - (double)j;
    return tx + ty <= 1 ? a + tx * (b - a) + ty * (c - a) : d + (1 - tx) * (c - d) + (1 - ty) * (b - d);
}

static void steps_hold(void **state)
{
    (void)state;
    enum { W = 96, H = 75 };
    for (int wraps = 0; wraps < 2; wraps++) {
        tc_grid grid = terrain_grid(TERRAIN_CLIFF, W, H, 10, 8);
        grid.wraps_x = wraps;
        tc_field *p;
        assert_int_equal(tc_field_build(&grid, 1, &p, NULL), TC_OK);
        static float z[W * H], coarse[W * H];
        for (int l = tc_field_info(p)->levels; l > 1; l--) {
            tc_level a = tc_field_level(p, l), b = tc_field_level(p, l - 1);
            tc_field_read(p, l, (tc_rect){0, 0, a.width, a.height}, z, NULL, a.width);
            tc_field_read(p, l - 1, (tc_rect){0, 0, b.width, b.height}, coarse, NULL, b.width);
            bool round = tc_field_wraps(p, l - 1);
            for (int64_t y = 0; y < a.height; y += 16)
                for (int64_t x = 0; x < a.width; x += 16) {
                    tc_rect tile = {x, y, tc_min64(x + 16, a.width), tc_min64(y + 16, a.height)};
                    double most = 0;
                    for (int64_t j = tile.y0; j < tile.y1; j++)
                        for (int64_t i = tile.x0; i < tile.x1; i++)
                            if ((round || i < 2 * b.width - 1) && j < 2 * b.height - 1)
                                most = fmax(most, fabs(z[j * a.width + i] - on_mesh(coarse, b.width, b.height, round,
                                                                                    0.5 * (double)i, 0.5 * (double)j)));
                    float step = tc_field_range(p, l, tile).step;
                    bool whole = (round || tile.x1 < 2 * b.width) && tile.y1 < 2 * b.height;
                    assert_true(step >= most * (1 - 1e-5) - 1e-3);
                    assert_true(!whole || step <= most * (1 + 1e-5) + 1e-3);
                }
        }
        assert_true(isinf(tc_field_range(p, 1, (tc_rect){0, 0, 1, 1}).step));
        tc_field_destroy(p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(downsample_follows_its_definition),
        cmocka_unit_test(filters_reproduce_planes),
        cmocka_unit_test(upsample_undoes_downsample_of_smooth_data),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(bounds_hold),
        cmocka_unit_test(reading_outside_is_refused),
        cmocka_unit_test(voids_travel_to_coarser_levels),
        cmocka_unit_test(flat_voids_do_not_leak),
        cmocka_unit_test(turning_a_globe_turns_its_levels),
        cmocka_unit_test(a_globe_is_read_across_its_seam),
        cmocka_unit_test(nonsense_grids_are_refused),
        cmocka_unit_test(a_range_takes_four_reads),
        cmocka_unit_test(steps_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
