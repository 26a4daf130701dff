/* test_atlas.c - charts of a planet: polar caps against functions on the sphere. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/map/map.h"
#include "common/chart/atlas_caps.h"
#include "common/base/rect.h"
#include "tests/support/terrains.h"

static const double pi = 3.141592653589793;

typedef double (*sphere_function)(double x, double y, double z);

static double polynomial(double x, double y, double z)
{
    return 1000 * (x * y + z);
}
static double slope(double x, double y, double z)
{
    return 1000 * (x - 0.5 * y) + 100 * z;
}
static double of_latitude(double x, double y, double z)
{
    (void)x, (void)y;
    return 1000 * z * z * z;
}
static double constant(double x, double y, double z)
{
    (void)x, (void)y, (void)z;
    return 8123.456;
}

static double on_sphere(sphere_function f, double longitude, double latitude)
{
    return f(cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude));
}

/* Where rows lie: half a row from the poles, on them, or otherwise. */
typedef enum rows { AREA, POINT, ODD_ROWS, ROWS } rows_kind;

/* A grid once around, from `west` degrees on (the first sample's). */
static tc_grid globe(sphere_function f, int64_t width, int64_t height, rows_kind rows, double west)
{
    double dx = 360. / (double)width;
    double dy = 180. / (double)(rows == AREA ? height : height - 1), north = rows == AREA ? 90 - 0.5 * dy : 90;
    if (rows == ODD_ROWS)
        dy = 180. / ((double)height - 0.5), north = 90 - 0.3 * dy;
    tc_grid grid = {.width = width, .height = height, .spacing_x = 1, .spacing_y = 1};
    grid.z = malloc((size_t)(width * height) * sizeof *grid.z);
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++) {
            double latitude = north - (double)(height - 1 - j) * dy, longitude = west + (double)i * dx;
            grid.z[j * width + i] = (float)on_sphere(f, longitude * pi / 180, latitude * pi / 180);
        }
    grid.z_min = -10000, grid.z_max = 10000;
    grid.georef = (tc_georef){.known = true, .geographic = true};
    const double t[6] = {west - 0.5 * dx, dx, 0, north + 0.5 * dy, 0, -dy};
    memcpy(grid.georef.transform, t, sizeof t);
    return grid;
}

static tc_map *atlas_of(tc_grid grid)
{
    tc_map *atlas;
    tc_error error = {0};
    if (tc_map_build(&grid, 6371000, 0, &atlas, &error) != TC_OK)
        fail_msg("%s", error.text);
    assert_null(grid.z);
    return atlas;
}

/* The finest level of a cap; the caller's to free. */
static float *cap_heights(const tc_map *atlas, int chart, int64_t *side_ret)
{
    const tc_field *p = atlas->chart[chart].field;
    int m = tc_field_info(p)->levels;
    tc_level level = tc_field_level(p, m);
    assert_int_equal(level.width, level.height);
    assert_int_equal(level.width % 2, 1);
    *side_ret = level.width;
    float *z = malloc((size_t)(level.width * level.height) * sizeof *z);
    tc_rect all = {0, 0, level.width, level.height};
    assert_int_equal(tc_field_read(p, m, all, z, NULL, level.width), TC_OK);
    return z;
}

/* Largest error of a cap, of all samples and of those within `rows` rows of the pole. */
static void cap_error(const tc_map *atlas, int chart, sphere_function f, double rows, double *all_ret, double *near_ret)
{
    const tc_chart *c = &atlas->chart[chart];
    int64_t side;
    float *z = cap_heights(atlas, chart, &side);
    *all_ret = *near_ret = 0;
    for (int64_t k = 0; k < side * side; k++) {
        double x = c->x0 + (double)(k % side) * c->dx, y = c->y0 + (double)(k / side) * c->dy, r = hypot(x, y);
        double latitude = pi / 2 - 2 * atan(r / 2), longitude = atan2(y, x);
        if (c->class == &tc_chart_south_cap)
            latitude = -latitude;
        double error = fabs(z[k] - on_sphere(f, longitude, latitude));
        *all_ret = fmax(*all_ret, error);
        if (r < rows * c->dx)
            *near_ret = fmax(*near_ret, error);
    }
    free(z);
}

static void caps_hold_smooth_functions(void **state)
{
    (void)state;
    static const double starts[] = {-179.75, 0, 0.1, 77};
    for (rows_kind rows = AREA; rows < ROWS; rows++)
        for (int s = 0; s < 4; s++)
            for (int f = 0; f < 2; f++) {
                sphere_function function = f ? slope : polynomial;
                tc_map *atlas = atlas_of(globe(function, 720, rows == POINT ? 361 : 360, rows, starts[s]));
                assert_int_equal(atlas->charts, 3);
                for (int c = 1; c < 3; c++) {
                    double all, near;
                    cap_error(atlas, c, function, 6, &all, &near);
                    assert_true(all < 0.005 && near < 0.005); /* a row is 8.7 m of a slope */
                }
                tc_map_destroy(atlas);
            }
}

static void constants_stay(void **state)
{
    (void)state;
    for (rows_kind rows = AREA; rows < ROWS; rows++) {
        tc_map *atlas = atlas_of(globe(constant, 500, 251, rows, -180));
        for (int c = 1; c < 3; c++) {
            int64_t side;
            float *z = cap_heights(atlas, c, &side);
            for (int64_t k = 0; k < side * side; k++)
                assert_true(z[k] == (float)8123.456);
            assert_true(tc_field_info(atlas->chart[c].field)->z_min == (float)8123.456);
            free(z);
        }
        tc_map_destroy(atlas);
    }
}

/* Heights that depend on latitude alone, and noise turned by a quarter: the lattice must not show. */
static void caps_have_no_direction(void **state)
{
    (void)state;
    enum { WIDTH = 400, HEIGHT = 201 };
    tc_map *atlas = atlas_of(globe(of_latitude, WIDTH, HEIGHT, AREA, 0));
    tc_grid noise[2] = {globe(constant, WIDTH, HEIGHT, AREA, 0), globe(constant, WIDTH, HEIGHT, AREA, 0)};
    test_random r = {7};
    for (int64_t j = 0; j < HEIGHT; j++)
        for (int64_t i = 0; i < WIDTH; i++)
            noise[0].z[j * WIDTH + i] = noise[1].z[j * WIDTH + (i + WIDTH / 4) % WIDTH] =
                (float)test_random_range(&r, -1000, 1000);
    tc_map *turned[2] = {atlas_of(noise[0]), atlas_of(noise[1])};
    for (int c = 1; c < 3; c++) {
        int64_t side, half;
        float *z = cap_heights(atlas, c, &side), *a = cap_heights(turned[0], c, &side);
        float *b = cap_heights(turned[1], c, &side);
        half = side / 2;
        for (int64_t y = -half; y <= half; y++)
            for (int64_t x = -half; x <= half; x++) {
                int64_t k = (y + half) * side + x + half;
                assert_float_equal(z[k], z[(x + half) * side + y + half], 1e-3);
                assert_float_equal(z[k], z[(half - y) * side + x + half], 1e-3);
                /* East by a quarter is (x, y) to (-y, x). */
                assert_float_equal(a[k], b[(x + half) * side + half - y], 2e-3);
            }
        free(z), free(a), free(b);
    }
    tc_map_destroy(atlas), tc_map_destroy(turned[0]), tc_map_destroy(turned[1]);
}

/* Waves of four rows' length in all directions must come out alike at the pole and away from it: neither a blur nor
 * spokes. */
static double waves(double x, double y, double z)
{
    enum { WAVES = 24 };
    static double k[WAVES][4];
    if (k[0][0] == 0) {
        test_random r = {3};
        for (int n = 0; n < WAVES; n++) {
            double up = test_random_range(&r, -1, 1), around = test_random_range(&r, 0, 2 * pi);
            double number = 720 / 2.; /* radians: 2 pi / (4 rows) */
            k[n][0] = number * sqrt(1 - up * up) * cos(around);
            k[n][1] = number * sqrt(1 - up * up) * sin(around);
            k[n][2] = number * up;
            k[n][3] = test_random_range(&r, 0, 2 * pi);
        }
    }
    double sum = 0;
    for (int n = 0; n < WAVES; n++)
        sum += 100 * cos(k[n][0] * x + k[n][1] * y + k[n][2] * z + k[n][3]);
    return sum;
}

static void terrain_is_as_rough_at_the_pole(void **state)
{
    (void)state;
    tc_map *atlas = atlas_of(globe(waves, 1440, 720, AREA, 0));
    for (int c = 1; c < 3; c++) {
        int64_t side, count[2] = {0};
        float *z = cap_heights(atlas, c, &side);
        double sum[2] = {0}, error[2] = {0};
        for (int64_t y = -side / 2; y <= side / 2; y++)
            for (int64_t x = -side / 2; x <= side / 2; x++) {
                double r = hypot((double)x, (double)y);
                int where = r < 25 ? 0 : r > 90 && r < 110 ? 1 : -1;
                double theta = 2 * atan(0.5 * r * atlas->chart[c].dx), latitude = pi / 2 - theta;
                if (where < 0)
                    continue;
                double v = z[(y + side / 2) * side + x + side / 2];
                double true_v = on_sphere(waves, atan2((double)y, (double)x), c == 1 ? latitude : -latitude);
                sum[where] += v * v;
                error[where] += (v - true_v) * (v - true_v);
                count[where]++;
            }
        for (int where = 0; where < 2; where++) {
            sum[where] = sqrt(sum[where] / (double)count[where]);
            error[where] = sqrt(error[where] / (double)count[where]);
        }
        print_message("chart %d: rms %.1f at the pole, %.1f away from it; error %.1f and %.1f\n", c, sum[0], sum[1],
                      error[0], error[1]);
        assert_true(sum[0] > 0.8 * sum[1] && sum[0] < 1.25 * sum[1]);
        assert_true(error[0] < 1.2 * error[1] && error[0] < 0.15 * sum[0]);
        free(z);
    }
    tc_map_destroy(atlas);
}

/* In any direction and in blocks of any size, with any number of threads: the same bits. */
static void order_of_rows_does_not_matter(void **state)
{
    (void)state;
    enum { WIDTH = 300, HEIGHT = 500 };
    tc_grid grid = globe(polynomial, WIDTH, HEIGHT, AREA, 10);
    test_random r = {1};
    grid.voids = malloc(WIDTH * HEIGHT);
    for (int64_t k = 0; k < WIDTH * HEIGHT; k++) {
        grid.z[k] += (float)test_random_range(&r, -100, 100);
        grid.voids[k] = test_random_unit(&r) < 0.1;
    }
    tc_lonlat at;
    assert_true(tc_lonlat_of(&grid.georef, WIDTH, HEIGHT, &at) && at.round && at.poles && at.within);
    tc_lonlat_close(&at);
    size_t count = (size_t)(tc_caps_side(&at) * tc_caps_side(&at));
    assert_true(tc_caps_reach(&at) > 140 && tc_caps_reach(&at) < 160);
    float *z[2][TC_CAPS];
    uint8_t *voids[2][TC_CAPS];
    tc_cap_result result[2][TC_CAPS];
    for (int n = 0; n < 2; n++)
        for (int c = 0; c < TC_CAPS; c++)
            z[n][c] = malloc(count * sizeof *z[n][c]), voids[n][c] = malloc(count);
    static const int blocks[] = {500, 1, 3, 64, 200, 333};
    for (int b = 0; b < 6; b++)
        for (int up = 0; up < 2; up++) {
            int n = b + up > 0;
            tc_cap_target target[TC_CAPS] = {{z[n][0], voids[n][0]}, {z[n][1], voids[n][1]}};
            tc_caps *caps;
            assert_int_equal(tc_caps_create(&at, target, b == 0 ? 1 : 3, &caps), TC_OK);
            assert_int_equal(tc_caps_finish(caps, NULL), TC_ERR_USAGE);
            for (int64_t done = 0, rows; done < HEIGHT; done += rows) {
                rows = tc_min64(blocks[b], HEIGHT - done);
                int64_t j = up ? done : HEIGHT - done - rows;
                assert_int_equal(tc_caps_put(caps, j, rows, grid.z + j * WIDTH, grid.voids + j * WIDTH), TC_OK);
            }
            assert_int_equal(tc_caps_finish(caps, result[n]), TC_OK);
            tc_caps_destroy(caps);
            for (int c = 0; c < TC_CAPS && n > 0; c++) {
                assert_memory_equal(z[0][c], z[1][c], count * sizeof *z[0][c]);
                assert_memory_equal(voids[0][c], voids[1][c], count);
                assert_memory_equal(&result[0][c], &result[1][c], sizeof result[0][c]);
            }
        }
    double share = (double)result[0][0].void_count / (double)count;
    assert_true(share > 0.07 && share < 0.13);
    for (int n = 0; n < 2; n++)
        for (int c = 0; c < TC_CAPS; c++)
            free(z[n][c]), free(voids[n][c]);
    tc_grid_free(&grid);
}

static void charts_are_where_the_grid_is(void **state)
{
    (void)state;
    tc_map *a = atlas_of(globe(polynomial, 360, 180, AREA, 0.5));
    const tc_chart *c = &a->chart[0];
    assert_true(c->wraps && tc_field_info(c->field)->wraps_x && c->class == &tc_chart_lonlat);
    assert_true(fabs(c->x0 - (0.5 * pi / 180)) < 1e-12);
    assert_true(fabs(c->y0 - (-89.5 * pi / 180)) < 1e-12);
    assert_true(fabs(c->dx - (pi / 180)) < 1e-15);
    assert_true(fabs(c->dy - (pi / 180)) < 1e-15);
    assert_float_equal(tc_field_level(c->field, tc_field_info(c->field)->levels).spacing_x, 6371000 * pi / 180, 1e-6);
    for (int k = 1; k < 3; k++) {
        int64_t side = tc_field_level(a->chart[k].field, tc_field_info(a->chart[k].field)->levels).width;
        assert_true(a->chart[k].class == (k == 1 ? &tc_chart_north_cap : &tc_chart_south_cap));
        assert_true(a->chart[k].x0 + (double)(side / 2) * a->chart[k].dx == 0);
        assert_true(-a->chart[k].x0 >= 2 * tan(19 * pi / 180) && !a->chart[k].wraps);
    }
    tc_map_destroy(a);

    /* Around the globe without its poles; and a part of it. */
    tc_grid belt = globe(polynomial, 360, 180, AREA, 0.5);
    belt.height = 140;
    a = atlas_of(belt);
    assert_true(a->charts == 1 && a->chart[0].wraps);
    tc_map_destroy(a);
    tc_grid part = globe(polynomial, 367, 180, AREA, 0.5);
    part.georef.transform[1] = 0.01;
    a = atlas_of(part);
    assert_true(a->charts == 1 && !a->chart[0].wraps);
    assert_false(tc_field_info(a->chart[0].field)->wraps_x);
    tc_map_destroy(a);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    tc_map *a;
    tc_error error;
    for (int k = 0; k < 6; k++) {
        tc_grid grid = globe(polynomial, k == 0 ? 367 : 360, k == 1 ? 3 : 180, AREA, 0);
        grid.georef.geographic = k != 2;
        grid.georef.transform[2] = k == 3 ? 0.1 : 0;
        double radius = k == 4 ? -1 : k == 5 ? NAN : 1e6;
        assert_int_equal(tc_map_build(&grid, radius, 1, &a, &error), TC_ERR_USAGE);
        assert_non_null(strstr(error.text, "planet: "));
        assert_null(grid.z);
    }
    /* Heights to 10 km below a sphere of that radius, or above it. */
    for (int k = 0; k < 4; k++) {
        tc_grid grid = globe(polynomial, 360, 180, AREA, 0);
        double radius = k == 0 ? 10000 : k == 1 ? 10020 : k == 2 ? 5e5 : 1e6;
        if (k >= 2)
            grid.voids_flat = true, grid.void_count = 1, grid.void_height = k == 2 ? 5e5 : -999e3f;
        tc_status status = tc_map_build(&grid, radius, 1, &a, &error);
        assert_int_equal(status, k == 1 ? TC_OK : TC_ERR_FORMAT);
        assert_true(status ? strstr(error.text, "small beside the radius") != NULL : a->charts == 3);
        if (!status)
            tc_map_destroy(a);
    }
    assert_int_equal(tc_lonlat_width(1, 1), 1);
    assert_int_equal(tc_lonlat_width(250, 250), 250);
    assert_int_equal(tc_lonlat_width(251, 126), 252);
    assert_int_equal(tc_lonlat_width(5760, 2880), 5760);
    assert_int_equal(tc_lonlat_width(21601, 10801), 21632);
    assert_int_equal(tc_lonlat_width(249, 300), 250); /* the height needs more halvings */
    assert_int_equal(tc_lonlat_width(100, 2000), 104);
    assert_int_equal(tc_lonlat_width(100, 2001), 112);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(caps_hold_smooth_functions),    cmocka_unit_test(constants_stay),
        cmocka_unit_test(caps_have_no_direction),        cmocka_unit_test(terrain_is_as_rough_at_the_pole),
        cmocka_unit_test(order_of_rows_does_not_matter), cmocka_unit_test(charts_are_where_the_grid_is),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
