/* test_same_everywhere.c - synthesised heights do not depend on the C library: they are the same over one whose
 * functions are all wrong, also where charts of a planet share a place, and the same as on the machine where the hash
 * was taken. The functions that are used in their place are as good. */
#include "tests/support/test.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/base/same_math.h"
#include "common/field/field.h"
#include "common/map/map.h"
#include "common/synthesis/synthesis.h"

/* ---- A C library that is wrong ----------------------------------------------------------------------------------- */

/* By so much that floats show it: the last bit of a double would seldom get that far. */
static double wrong; /* 0: right */
static int asked;

typedef double one_number(double);
typedef double two_numbers(double, double);

static double one(const char *name, double x)
{
    void *symbol = dlsym(RTLD_NEXT, name);
    one_number *f;
    *(void **)&f = symbol;
    asked++;
    return f(x) * (1 + wrong);
}

static double two(const char *name, double x, double y)
{
    void *symbol = dlsym(RTLD_NEXT, name);
    two_numbers *f;
    *(void **)&f = symbol;
    asked++;
    return f(x, y) * (1 + wrong);
}

/* They stand before the library's own for all that is linked into this program. */
#define ONE(name)                                                                                                      \
    double name(double x)                                                                                              \
    {                                                                                                                  \
        return one(#name, x);                                                                                          \
    }
#define TWO(name)                                                                                                      \
    double name(double x, double y)                                                                                    \
    {                                                                                                                  \
        return two(#name, x, y);                                                                                       \
    }
ONE(sin)
ONE(cos)
ONE(tan)
ONE(atan)
ONE(exp)
ONE(exp2)
ONE(log)
ONE(log2)
TWO(atan2)
TWO(hypot)
TWO(pow)

/* ---- A planet ---------------------------------------------------------------------------------------------------- */

enum { WIDTH = 512, HEIGHT = 257, CAP = 117 };

/* Octaves of values by hash, between which it is linear, and slopes that differ from place to place. */
static float made_up(uint64_t seed, int64_t i, int64_t j, int64_t width)
{
    double z = 0, high = 900;
    for (int64_t cell = 64; cell >= 1; cell /= 2, high *= 0.45) {
        int64_t u = i / cell, v = j / cell, round = width > 0 ? width / cell : INT64_MAX;
        double s = (double)(i % cell) / (double)cell, t = (double)(j % cell) / (double)cell, corner[4];
        for (int k = 0; k < 4; k++) {
            uint64_t place = (uint64_t)((u + k % 2) % round + 4096 * (v + k / 2));
            corner[k] = (double)(tc_hash64(seed + (uint64_t)cell, place) >> 40) / (1 << 24) - 0.5;
        }
        double rough = cell < 16 ? fmax(0, z / 300 + 0.7) : 1; /* mountains are rougher than plains */
        z += high * rough *
             ((1 - t) * ((1 - s) * corner[0] + s * corner[1]) + t * ((1 - s) * corner[2] + s * corner[3]));
    }
    return (float)z;
}

static tc_field *made_field(uint64_t seed, int64_t width, int64_t height, bool wraps, double spacing)
{
    tc_grid g = {.width = width, .height = height, .wraps_x = wraps, .spacing_x = spacing, .spacing_y = spacing};
    tc_field *field;
    g.z = malloc((size_t)(width * height) * sizeof *g.z);
    assert_non_null(g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; i < width * height; i++) {
        g.z[i] = made_up(seed, i % width, i / width, wraps ? width : 0);
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    assert_int_equal(tc_field_build(&g, 1, &field, NULL), TC_OK);
    return field;
}

static tc_map *made_planet(void)
{
    const double radius = 1e6, step = M_PI / (HEIGHT - 1), half = 0.5 * (CAP - 1) * step;
    tc_map *map = tc_map_create(tc_body_of(radius), 3);
    assert_non_null(map);
    const tc_chart_class *class[] = {&tc_chart_lonlat, &tc_chart_north_cap, &tc_chart_south_cap};
    for (int k = 0; k < 3; k++, map->charts++)
        map->chart[k] = k == 0 ? tc_chart_over(class[k], made_field(7, WIDTH, HEIGHT, true, radius * step), k, -M_PI,
                                               -M_PI / 2, step, step)
                               : tc_chart_over(class[k], made_field(7 + (uint64_t)k, CAP, CAP, false, radius * step), k,
                                               -half, -half, step, step);
    return map;
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

/* Of the two levels that synthesis adds to each chart; chart 0 where the north cap takes over. */
static uint64_t hash_of_heights(void)
{
    tc_map *map = made_planet();
    uint64_t hash = 0;
    asked = 0;
    assert_int_equal(tc_map_synthesise(map, 2, NULL), TC_OK);
    for (int k = 0; k < map->charts; k++) {
        const tc_chart *c = &map->chart[k];
        int finest = tc_field_info(c->field)->levels;
        for (int l = finest - 1; l <= finest; l++) {
            const tc_level size = tc_field_level(c->field, l);
            tc_rect r = {0, 0, size.width, size.height};
            if (k == 0) /* 55 to 60 degrees */
                r.y0 = 145 * size.height / 180, r.y1 = 150 * size.height / 180;
            float *z = malloc((size_t)((r.x1 - r.x0) * (r.y1 - r.y0)) * sizeof *z);
            assert_non_null(z);
            assert_int_equal(tc_field_read(c->field, l, r, z, NULL, r.x1 - r.x0), TC_OK);
            for (int64_t i = 0; i < (r.x1 - r.x0) * (r.y1 - r.y0); i++) {
                uint32_t bits;
                memcpy(&bits, &z[i], sizeof bits);
                hash = tc_hash64(hash, bits);
            }
            free(z);
        }
    }
    tc_map_destroy(map);
    return hash;
}

static void heights_are_the_same_on_every_machine(void **state)
{
    (void)state;
    assert_true(log2((double)rand() + 2) > 0 && asked > 0); /* it is ours that are called */
    uint64_t right = hash_of_heights();
    wrong = 1e-4;
    uint64_t as_well = hash_of_heights();
    wrong = 0;
    assert_true(right == as_well);
    if (right != 0x56F6455E405DCF9Bu)
        fail_msg("the heights' hash is 0x%016llX", (unsigned long long)right);
}

/* Where charts meet detail is that of both: without the factor it would be too little by up to the root of two. */
static void shares_are_in_it(void **state)
{
    (void)state;
    tc_map *map = made_planet(), *alone = tc_map_create(tc_body_of(1e6), 1);
    const double step = M_PI / (HEIGHT - 1);
    alone->chart[alone->charts++] = tc_chart_over(&tc_chart_lonlat, made_field(7, WIDTH, HEIGHT, true, 1e6 * step), 0,
                                                  -M_PI, -M_PI / 2, step, step);
    assert_int_equal(tc_map_synthesise(map, 1, NULL), TC_OK);
    assert_int_equal(tc_map_synthesise(alone, 1, NULL), TC_OK);
    const tc_field *field[] = {tc_map_field(map, 0), tc_map_field(alone, 0)};
    int l = tc_field_info(field[0])->levels;
    double sum[2] = {0, 0};
    const int64_t y = 2 * (int64_t)rint((90 + 57.5) / 180 * (HEIGHT - 1)) + 1; /* the middle; between the data's rows */
    for (int n = 0; n < 2; n++) {
        float *z = malloc(2 * WIDTH * 3 * sizeof *z);
        assert_non_null(z);
        assert_int_equal(tc_field_read(field[n], l, (tc_rect){0, y - 1, 2 * WIDTH, y + 2}, z, NULL, 2 * WIDTH), TC_OK);
        for (int i = 0; i < 2 * WIDTH; i++) {
            double d = z[2 * WIDTH + i] - 0.5 * ((double)z[i] + z[4 * WIDTH + i]);
            sum[n] += d * d;
        }
        free(z);
    }
    assert_true(sum[0] > 1.2 * sum[1] && sum[0] < 2 * sum[1]);
    tc_map_destroy(map), tc_map_destroy(alone);
}

/* ---- Functions --------------------------------------------------------------------------------------------------- */

static void check(const char *name, double x, double is, double shall, double scale)
{
    if (!(fabs(is - shall) <= 8e-16 * fmax(fabs(shall), scale)))
        fail_msg("%s of %.17g is %.17g, not %.17g", name, x, is, shall);
}

static void functions_are_as_good(void **state)
{
    (void)state;
    for (int n = 0; n < 100000; n++) {
        double u = (double)(tc_hash64(3, (uint64_t)n) >> 11) / 9007199254740992.0;
        double x = ldexp(1 + u, n % 200 - 100), y = 200 * u - 100, a = M_PI * (u - 0.5);
        check("log2", x, tc_log2(x), log2(x), 0.5);
        check("exp2", y, tc_exp2(y), exp2(y), 0);
        check("sine", a, tc_sine(a), sin(a), 0);
    }
    for (int n = -1074; n <= 1023; n++)
        assert_true(tc_log2(ldexp(1, n)) == n && tc_exp2(n) == ldexp(1, n));
    assert_true(tc_log2(0) == -INFINITY && tc_log2(INFINITY) == INFINITY && isnan(tc_log2(-1)) && isnan(tc_log2(NAN)));
    assert_true(tc_exp2(-INFINITY) == 0 && tc_exp2(INFINITY) == INFINITY && isnan(tc_exp2(NAN)));
    assert_true(tc_exp2(2000) == INFINITY && tc_exp2(1024) == INFINITY && tc_exp2(-2000) == 0 && tc_exp2(-1090) == 0);
    assert_true(tc_sine(0) == 0 && tc_sine(M_PI / 2) == 1 && tc_sine(-M_PI / 2) == -1);
    assert_true(fabs(TC_CAP_BLEND_START_SINE - tc_sine(TC_CAP_BLEND_START * M_PI / 180)) < 2e-16);
    assert_true(fabs(TC_CAP_BLEND_END_SINE - tc_sine(TC_CAP_BLEND_END * M_PI / 180)) < 2e-16);
}

/* A chart's sine is that of the latitude that it says. */
static void charts_tell_sines(void **state)
{
    (void)state;
    const tc_chart chart[] = {
        {.class = &tc_chart_lonlat}, {.class = &tc_chart_north_cap}, {.class = &tc_chart_south_cap}};
    for (int k = 0; k < 3; k++)
        for (int n = 0; n < 1000; n++) {
            double x = 0.0013 * n - 0.6, y = 0.7 - 0.0014 * n, longitude, latitude;
            chart[k].class->to_place(&chart[k], x, y, &longitude, &latitude);
            assert_true(fabs(chart[k].class->sine(&chart[k], x, y) - sin(latitude)) < 1e-15);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_the_same_on_every_machine),
        cmocka_unit_test(shares_are_in_it),
        cmocka_unit_test(functions_are_as_good),
        cmocka_unit_test(charts_tell_sines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
