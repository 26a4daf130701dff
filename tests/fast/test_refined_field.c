/* test_refined_field.c - levels finer than a field's own lie on its mesh: samples, voids, bounds; in parts as in one;
 * on the sides of faces the same bits from both. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/chart/joined.h"
#include "common/content/ground.h"
#include "common/field/point.h"
#include "common/field/refined_field.h"
#include "tests/support/planet_scene.h"
#include "tests/support/test.h"

enum { FINER = 3, TIMES = 300, SIDE = 150 };

static tc_field *field_with_voids(void)
{
    tc_grid grid = terrain_grid(TERRAIN_CLIFF, 140, 99, 10, 5);
    grid.voids = calloc(140 * 99, 1);
    test_random r = {3};
    for (int k = 0; k < 400; k++)
        grid.voids[test_random_int(&r, 0, 140 * 99 - 1)] = 1;
    tc_field *field;
    assert_int_equal(tc_field_build(&grid, 0, &field, NULL), TC_OK);
    return field;
}

/* Samples of a rectangle at random against the mesh of level `own`; by rectangles of all forms, so that they are the
 * same in parts. */
static void compare(const tc_field *base, const tc_field *fine)
{
    const int own = tc_field_info(base)->levels, voids = tc_field_info(base)->void_count > 0;
    static float z[SIDE * SIDE];
    static uint8_t v[SIDE * SIDE];
    test_random r = {7};
    int64_t seen = 0, none = 0;
    for (int n = 0; n < TIMES; n++) {
        const int k = (int)test_random_int(&r, 1, FINER);
        const tc_level size = tc_field_level(fine, own + k);
        const int64_t w = test_random_int(&r, 1, SIDE), h = test_random_int(&r, 1, n % 7 ? 9 : SIDE);
        const bool wraps = tc_field_info(base)->wraps_x;
        tc_rect rect = {test_random_int(&r, wraps ? -w : 0, size.width - 1), test_random_int(&r, 0, size.height - 1), 0,
                        0};
        rect.x1 = wraps ? rect.x0 + w : tc_min64(rect.x0 + w, size.width);
        rect.y1 = tc_min64(rect.y0 + h, size.height);
        assert_int_equal(tc_field_read(fine, own + k, rect, z, v, SIDE), TC_OK);
        const tc_range range = tc_field_range(fine, own + k, rect);
        for (int64_t y = rect.y0; y < rect.y1; y++)
            for (int64_t x = rect.x0; x < rect.x1; x++) {
                const float one = z[(y - rect.y0) * SIDE + (x - rect.x0)];
                tc_cell cell;
                const double u = tc_cell_turn(base, own, ldexp((double)x, -k));
                assert_int_equal(tc_field_cell(base, own, u, ldexp((double)y, -k), voids, &cell), TC_OK);
                assert_true(fabs((double)one - tc_cell_mesh(&cell)) <= 1e-3);
                assert_true(one >= range.lo && one <= range.hi);
                const bool hole = v[(y - rect.y0) * SIDE + (x - rect.x0)];
                assert_int_equal(hole, voids && tc_cell_void(&cell));
                seen++, none += hole;
            }
    }
    assert_true(seen > 100000 && (!voids || none > 1000));
}

static void samples_lie_on_the_mesh(void **state)
{
    (void)state;
    tc_field *base = field_with_voids(), *fine = tc_refined_field(base, FINER);
    compare(base, fine);
    const int own = tc_field_info(base)->levels;
    assert_int_equal(tc_field_info(fine)->levels, own + FINER);
    for (int l = 1; l <= own; l++) { /* its own levels */
        const tc_level a = tc_field_level(base, l), b = tc_field_level(fine, l);
        assert_memory_equal(&a, &b, sizeof a);
    }
    tc_field_destroy(fine), tc_field_destroy(base);
}

static void it_goes_round(void **state)
{
    (void)state;
    tc_map *planet = planet_made(PLANET_CLIFF, 128, 6371000, 2);
    tc_field *fine = tc_refined_field(planet->chart[0].field, FINER);
    assert_true(tc_field_info(fine)->wraps_x);
    compare(planet->chart[0].field, fine);
    tc_field_destroy(fine);
    tc_map_destroy(planet);
}

/* Each sample on a side is read from both charts; those that are not the same bits. */
static int64_t differing(const tc_chart *chart, int charts, int level, int64_t *seen)
{
    const int64_t cells = tc_field_level(chart[0].field, level).width - 1;
    int64_t differ = 0;
    for (int face = 0; face < charts; face++)
        for (int side = 0; side < TC_SIDES; side++)
            for (int64_t n = 0; n <= cells; n++) {
                const tc_seam seam = chart[face].class->seam(face, side, cells);
                const int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
                const int64_t i = side < TC_SOUTH ? at : n, j = side < TC_SOUTH ? n : at;
                const int64_t p = seam.m[0] * i + seam.m[1] * j + seam.dx, q = seam.m[2] * i + seam.m[3] * j + seam.dy;
                float here, there;
                assert_int_equal(tc_field_read(chart[face].field, level, (tc_rect){i, j, i + 1, j + 1}, &here, NULL, 1),
                                 TC_OK);
                assert_int_equal(
                    tc_field_read(chart[seam.chart].field, level, (tc_rect){p, q, p + 1, q + 1}, &there, NULL, 1),
                    TC_OK);
                differ += here != there, ++*seen;
            }
    return differ;
}

static void sides_are_the_same(void **state)
{
    (void)state;
    static const tc_chart_class *const classes[] = {&tc_chart_hex, &tc_chart_cube};
    for (int c = 0; c < 2; c++) {
        tc_map *map = planet_of_faces(planet_made(PLANET_CLIFF, 128, 6371000, 2), classes[c]);
        tc_chart chart[TC_MAP_CHARTS];
        int64_t seen = 0;
        for (int k = 0; k < map->charts; k++)
            chart[k] = tc_chart_face(classes[c], tc_refined_field(map->chart[k].field, FINER), k);
        const int levels = tc_field_info(chart[0].field)->levels;
        assert_int_equal(differing(chart, map->charts, levels, &seen), 0); /* also before they are joined */
        assert_true(tc_charts_join(chart, map->charts, NULL));
        for (int l = levels - FINER; l <= levels; l++)
            assert_int_equal(differing(chart, map->charts, l, &seen), 0);
        assert_true(seen > 5000);
        for (int k = 0; k < map->charts; k++)
            tc_field_destroy(chart[k].field);
        tc_map_destroy(map);
    }
}

/* The field's finest level is shaded as if there were none finer. */
static void shading_is_that_of_the_field(void **state)
{
    (void)state;
    enum { N = 31 };
    tc_field *base = terrain_field(TERRAIN_SMOOTH, 129, 129, 10, 3), *fine = tc_refined_field(base, FINER);
    const int own = tc_field_info(base)->levels;
    const tc_slopes slopes = {.finest = own}, all = {0};
    const tc_ground_options plain = {.n = N, .normals = true}, by_own = {.n = N, .normals = true, .slopes = &slopes},
                            by_mesh = {.n = N, .normals = true, .slopes = &all};
    tc_clipmap *c[3];
    assert_int_equal(tc_ground_create(base, &plain, &c[0], NULL), TC_OK);
    assert_int_equal(tc_ground_create(fine, &by_own, &c[1], NULL), TC_OK);
    assert_int_equal(tc_ground_create(fine, &by_mesh, &c[2], NULL), TC_OK);
    const int levels = tc_clipmap_levels(c[0]);
    tc_rect wanted[TC_MAX_LEVELS] = {{0}};
    for (int l = 1; l <= levels; l++)
        wanted[l - 1] = (tc_rect){l == 1 ? 0 : 2, l == 1 ? 0 : 2, N, N};
    wanted[0] = tc_clipmap_level(c[0], 1)->extent;
    for (int k = 0; k < 3; k++)
        tc_clipmap_update(c[k], wanted, -1, true, 0);
    const size_t bytes = (size_t)4 * 2 * (N + 1) * 2 * (N + 1);
    for (int l = 1; l <= levels; l++)
        assert_memory_equal(tc_ground_normals(c[0], l), tc_ground_normals(c[1], l), bytes);
    assert_true(memcmp(tc_ground_normals(c[0], levels), tc_ground_normals(c[2], levels), bytes) != 0);
    for (int k = 0; k < 3; k++)
        tc_clipmap_destroy(c[k]);
    tc_field_destroy(fine), tc_field_destroy(base);
}

static void too_many_are_refused(void **state)
{
    (void)state;
    tc_field *base = terrain_field(TERRAIN_SMOOTH, 9, 9, 1, 1);
    assert_null(tc_refined_field(base, TC_MAX_FIELD_LEVELS));
    assert_null(tc_refined_field(base, -1));
    tc_field_destroy(base);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(samples_lie_on_the_mesh), cmocka_unit_test(it_goes_round),
                                       cmocka_unit_test(sides_are_the_same),
                                       cmocka_unit_test(shading_is_that_of_the_field),
                                       cmocka_unit_test(too_many_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
