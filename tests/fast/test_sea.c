/* test_sea.c - a sea that is given: heights and bounds of a map that is flooded, on plane and globe; colours of what is
 * wet and what is dry; and a viewer that changes where it is. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/viewer_internal.h"
#include "common/field/field.h"
#include "common/map/map.h"
#include "planar/square.h"
#include "tests/support/planet_scene.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

static tc_map *flat_map(void)
{
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 300, 200, 30, 1);
    tc_map *map;
    if (tc_map_build(&grid, 0, 2, &map, NULL) != TC_OK)
        fail();
    return map;
}

static tc_map *planet(void)
{
    return planet_made(PLANET_SMOOTH, 128, 1e6, 3);
}

static tc_map *faces(void)
{
    return planet_of_faces(planet(), &tc_chart_cube);
}

static tc_map *(*const makers[])(void) = {flat_map, planet, faces};
enum { MAKERS = sizeof makers / sizeof *makers, SIDE = 24 };

static tc_sea sea_at(double level)
{
    return (tc_sea){.kind = TC_SEA_GIVEN, .level = level};
}

static double middle_of(const tc_map *map)
{
    const tc_terrain_info *info = tc_field_info(tc_map_field(map, 0));
    return info->z_base + 0.5 * ((double)info->z_min + (double)info->z_max);
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

static int below, above; /* samples that were seen */

static void assert_flooded(const tc_field *plain, const tc_field *flooded, float sea, float factor)
{
    test_random r = {7};
    float a[SIDE * SIDE], b[SIDE * SIDE];
    uint8_t voids[SIDE * SIDE];
    for (int level = 1; level <= tc_field_info(plain)->levels; level++)
        for (int k = 0; k < 8; k++) {
            const tc_level size = tc_field_level(plain, level);
            const int64_t w = size.width < SIDE ? size.width : SIDE, h = size.height < SIDE ? size.height : SIDE;
            tc_rect rect = {test_random_int(&r, 0, size.width - w), test_random_int(&r, 0, size.height - h), 0, 0};
            rect.x1 = rect.x0 + w, rect.y1 = rect.y0 + h;
            assert_int_equal(tc_field_read(plain, level, rect, a, voids, w), TC_OK);
            if (k % 2)
                assert_int_equal(tc_field_read(flooded, level, rect, b, voids, w), TC_OK);
            else
                assert_int_equal(tc_field_read_ready(flooded, level, rect, b, voids, w, TC_SOON), TC_READY);
            const tc_range range = tc_field_range(flooded, level, rect);
            for (int64_t i = 0; i < w * h; i++) {
                if (b[i] != factor * fmaxf(a[i], sea))
                    fail_msg("level %d: %g became %g", level, (double)a[i], (double)b[i]);
                assert_true(b[i] >= range.lo && b[i] <= range.hi);
                below += a[i]<sea, above += a[i]> sea;
            }
        }
}

static void heights_are_nowhere_below_it(void **state)
{
    (void)state;
    for (int m = 0; m < MAKERS; m++) {
        tc_map *plain = makers[m](), *map = makers[m]();
        const tc_field *own = tc_map_field(map, 0);
        const double level = middle_of(plain);
        double z;
        assert_int_equal(tc_map_flood(map, sea_at(level), NULL), TC_OK);
        for (int c = 0; c < plain->charts; c++)
            assert_flooded(tc_map_field(plain, c), tc_map_field(map, c), (float)level, 1);
        /* With a factor, whichever comes first. */
        assert_int_equal(tc_map_exaggerate(map, 3, NULL), TC_OK);
        assert_flooded(tc_map_field(plain, 0), tc_map_field(map, 0), (float)level, 3);
        assert_int_equal(tc_map_flood(map, sea_at(level / 2), NULL), TC_OK);
        assert_true(map->exaggeration == 3 && map->sea.level == level / 2);
        assert_flooded(tc_map_field(plain, 0), tc_map_field(map, 0), (float)(level / 2), 3);
        /* Over all of it; none of it. */
        const tc_terrain_info *info = tc_field_info(tc_map_field(plain, 0));
        assert_int_equal(tc_map_flood(map, sea_at((double)info->z_max + 100), NULL), TC_OK);
        assert_int_equal(tc_map_height(map, 0.2, 0.1, &z), TC_OK);
        assert_float_equal(z, 3 * ((double)info->z_max + 100), 1e-3);
        assert_true(tc_field_info(tc_map_field(map, 0))->z_max == 3 * (float)((double)info->z_max + 100));
        assert_int_equal(tc_map_exaggerate(map, 1, NULL), TC_OK);
        assert_int_equal(tc_map_flood(map, (tc_sea){.kind = TC_SEA_NONE}, NULL), TC_OK);
        assert_ptr_equal(tc_map_field(map, 0), own);
        assert_int_equal(tc_map_flood(map, (tc_sea){0}, NULL), TC_OK);
        assert_ptr_equal(tc_map_field(map, 0), own);
        assert_true(below > 1000 && above > 1000);
        below = above = 0;
        tc_map_destroy(plain), tc_map_destroy(map);
    }
}

/* How far a cell of a level's mesh is from the next finer level's samples, or from the finest ones: all but those on
 * its far sides, which are other cells'. */
static double farthest(const tc_field *field, int level, int64_t i, int64_t j, int finer)
{
    enum { MOST = 16 };
    const int64_t stride = (int64_t)1 << (finer - level);
    float z[4], fine[MOST * MOST];
    double far = 0;
    assert_int_equal(tc_field_read(field, level, (tc_rect){i, j, i + 2, j + 2}, z, NULL, 2), TC_OK);
    const tc_rect inside = {i * stride, j * stride, (i + 1) * stride, (j + 1) * stride};
    assert_int_equal(tc_field_read(field, finer, inside, fine, NULL, stride), TC_OK);
    for (int64_t y = 0; y < stride; y++)
        for (int64_t x = 0; x < stride; x++) {
            const double u = (double)x / (double)stride, v = (double)y / (double)stride;
            const double mesh = u + v <= 1 ? (1 - u - v) * z[0] + u * z[1] + v * z[2]
                                           : (u + v - 1) * z[3] + (1 - u) * z[2] + (1 - v) * z[1];
            far = fmax(far, fabs(mesh - (double)fine[y * stride + x]));
        }
    return far;
}

/* Of parts of a level's mesh; what lies under the sea has none. By what the ground's errors tell, and measured anew. */
static void errors_are_still_bounds(void **state)
{
    (void)state;
    enum { CELLS = 5 };
    for (int measured = 0; measured < 2; measured++) {
        tc_map *map = flat_map();
        const double sea = middle_of(map);
        int under = 0;
        tc_field_know_errors(tc_map_field(map, 0)); /* the ground's */
        assert_int_equal(tc_map_flood(map, sea_at(sea), NULL), TC_OK);
        const tc_field *field = tc_map_field(map, 0);
        const int m = tc_field_info(field)->levels;
        if (measured)
            tc_field_know_errors(field);
        for (int level = m - 1; level >= m - 4; level--) {
            const tc_level size = tc_field_level(field, level);
            for (int64_t j = 0; j + CELLS < size.height; j += 3)
                for (int64_t i = 0; i + CELLS < size.width; i += 3)
                    for (int cells = 1; cells <= CELLS; cells += CELLS - 1) {
                        const tc_rect next = {2 * i, 2 * j, 2 * (i + cells), 2 * (j + cells)};
                        const tc_range range = tc_field_range(field, level + 1, next);
                        double off = 0, step = 0;
                        for (int c = 0; c < cells * cells; c++) {
                            off = fmax(off, farthest(field, level, i + c % cells, j + c / cells, m));
                            step = fmax(step, farthest(field, level, i + c % cells, j + c / cells, level + 1));
                        }
                        if (!(off <= (double)range.error + 1e-3 && step <= (double)range.step + 1e-3))
                            fail_msg("level %d: off by %g and %g, said to be %g and %g", level, off, step,
                                     (double)range.error, (double)range.step);
                        under += range.hi <= (float)sea && range.error <= 0 && range.step <= 0;
                    }
        }
        assert_true(under > 50);
        tc_map_destroy(map);
    }
}

static void what_leaves_no_surface_is_refused(void **state)
{
    (void)state;
    tc_map *map = planet();
    tc_error error;
    assert_int_equal(tc_map_flood(map, sea_at(100), NULL), TC_OK);
    const tc_field *field = tc_map_field(map, 0);
    static const double bad[] = {-1e6, -1e9, 1e9, 2e9, -INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(tc_map_flood(map, sea_at(bad[i]), &error), TC_ERR_USAGE);
        assert_non_null(strstr(error.text, "--sea: expected a level that is small beside the radius"));
        assert_true(map->sea.level == 100 && tc_map_field(map, 0) == field);
    }
    tc_map_destroy(map);
    map = flat_map();
    assert_int_equal(tc_map_flood(map, sea_at(-1e9), NULL), TC_OK);
    assert_int_equal(tc_map_exaggerate(map, 2, &error), TC_ERR_FORMAT);
    assert_true(map->exaggeration == 1);
    tc_map_destroy(map);
}

/* ---- A viewer ---------------------------------------------------------------------------------------------------- */

static tc_context *context;

static tc_viewer viewer(tc_sea sea)
{
    static const tc_scheme *const lists[] = {tc_square_schemes, NULL};
    static const tc_viewer_program program = {.name = "test", .body = &tc_plane_body, .schemes = lists};
    tc_viewer v = {.program = &program,
                   .gl = tc_context_gl(context),
                   .options = {.output = "picture.png", .exaggeration = 1, .quiet = true},
                   .least_height = 0.01,
                   .scene = {.budget = -1, .unlit = true, .background_set = true},
                   .map = flat_map()};
    if (tc_map_flood(v.map, sea, NULL) != TC_OK || tc_viewer_look_around(&v, NULL) != TC_OK)
        fail();
    v.options.sea = v.scene.sea = v.map->sea;
    v.scene.around = v.around;
    v.camera =
        (tc_camera){.x = 4500, .y = 3000, .z = 20e3, .pitch = -M_PI / 2, .fov = 0.25, .width = 150, .height = 100};
    return v;
}

static void leave(tc_viewer *v)
{
    tc_viewer_destroy_scene(v);
    tc_map_destroy(v->map);
}

static uint8_t *picture(tc_viewer *v)
{
    tc_frame_stats stats;
    uint8_t *rgb = malloc((size_t)v->camera.width * (size_t)v->camera.height * 3);
    assert_non_null(rgb);
    assert_int_equal(tc_viewer_frame(v, true, &stats, NULL), TC_OK);
    tc_renderer_read(v->renderer, rgb, NULL);
    return rgb;
}

static bool blue(const uint8_t *p)
{
    return abs(p[0] - 40) <= 1 && abs(p[1] - 84) <= 1 && abs(p[2] - 122) <= 1;
}

/* Ground below it is water, and no other: from straight above, but for a share by the shore, with and without smooth
 * edges. */
static void water_is_where_ground_is_lower(void **state)
{
    (void)state;
    for (int samples = 1; samples <= 4; samples += 3) {
        tc_map *map = flat_map();
        const double level = middle_of(map);
        tc_viewer v = viewer(sea_at(level));
        v.scene.samples = samples;
        uint8_t *rgb = picture(&v);
        int wet = 0, dry = 0, wrong = 0;
        const double metres = 2 * 20e3 * tan(0.125) / 150; /* about: a pixel at height 0 */
        for (int j = 0; j < 100; j++)
            for (int i = 0; i < 150; i++) {
                double z;
                const double x = 4500 + (i + 0.5 - 75) * metres * (1 - level / 20e3),
                             y = 3000 - (j + 0.5 - 50) * metres * (1 - level / 20e3);
                assert_int_equal(tc_map_height(map, x, y, &z), TC_OK);
                const bool water = blue(rgb + 3 * (j * 150 + i));
                wet += water, dry += !water;
                wrong += water != (z <= level);
            }
        if (wet < 1000 || dry < 1000 || wrong > 150) /* of a hundred times as many */
            fail_msg("%d samples: %d wet, %d dry, %d of them wrong", samples, wet, dry, wrong);
        free(rgb);
        leave(&v);
        tc_map_destroy(map);
    }
}

static void it_changes_while_a_viewer_runs(void **state)
{
    (void)state;
    tc_viewer v = viewer((tc_sea){0});
    const double level = middle_of(v.map);
    tc_viewer flooded = viewer(sea_at(level));
    const size_t size = (size_t)v.camera.width * (size_t)v.camera.height * 3;
    uint8_t *plain = picture(&v), *wet = picture(&flooded);
    tc_viewer_wish wish = tc_viewer_wish_now(&v);
    wish.options.sea = sea_at(level);
    assert_int_equal(tc_viewer_adopt(&v, &wish, NULL), TC_OK);
    uint8_t *drawn = picture(&v);
    assert_memory_equal(drawn, wet, size);
    assert_memory_not_equal(drawn, plain, size);
    free(drawn);
    assert_true(v.around.sea && v.around.level == level);
    tc_error error;
    assert_int_equal(tc_viewer_flood(&v, sea_at(3e9), &error), TC_ERR_USAGE); /* then all is as it was */
    drawn = picture(&v);
    assert_memory_equal(drawn, wet, size);
    free(drawn);
    assert_int_equal(tc_viewer_flood(&v, (tc_sea){0}, NULL), TC_OK);
    drawn = picture(&v);
    assert_memory_equal(drawn, plain, size);
    free(drawn), free(plain), free(wet);
    leave(&v), leave(&flooded);
}

/* An eye that the sea has risen over is lifted above it. */
static void the_eye_stays_above_the_sea(void **state)
{
    (void)state;
    tc_viewer v = viewer((tc_sea){0});
    const double level = (double)tc_field_info(tc_map_field(v.map, 0))->z_max + 500;
    v.camera.z = level - 100;
    free(picture(&v));
    assert_int_equal(tc_viewer_flood(&v, sea_at(level), NULL), TC_OK);
    assert_true(fabs(v.camera.z - level) < 0.1 && v.lifted);
    leave(&v);
}

/* What is around a map: a sea that is given, none, or what its edge says. */
static void it_is_around_the_map(void **state)
{
    (void)state;
    tc_map *map = flat_map();
    tc_surroundings s;
    assert_int_equal(tc_map_flood(map, sea_at(-250), NULL), TC_OK);
    assert_int_equal(tc_map_exaggerate(map, 2, NULL), TC_OK);
    assert_int_equal(tc_surroundings_of(map, &s, NULL), TC_OK);
    assert_true(s.walls && s.sea && s.level == -500 && s.depth == 0);
    assert_int_equal(tc_map_flood(map, (tc_sea){.kind = TC_SEA_NONE}, NULL), TC_OK);
    assert_int_equal(tc_surroundings_of(map, &s, NULL), TC_OK);
    assert_true(s.walls && !s.sea);
    tc_map_destroy(map);
    /* Of what is the sea's bottom alone there is a block. */
    for (int deep = 0; deep < 2; deep++) {
        tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 300, 200, 30, 1);
        grid.z_base -= (double)grid.z_min + (deep ? 20000 : 1);
        assert_int_equal(tc_map_build(&grid, 0, 2, &map, NULL), TC_OK);
        assert_int_equal(tc_surroundings_of(map, &s, NULL), TC_OK);
        if (deep)
            assert_true(s.walls && !s.sea);
        tc_map_destroy(map);
    }
    const tc_terrain_info coast = {.z_min = -100, .z_max = 900};
    tc_scene_options o = {.around = {.walls = true, .sea = true}};
    assert_true(tc_scene_needs_of(&o, &coast).water && !tc_scene_needs_of(&o, &coast).flood);
    o.sea.kind = TC_SEA_NONE;
    assert_true(!tc_scene_needs_of(&o, &coast).water && !tc_scene_needs_of(&o, &coast).sea);
    o.sea = sea_at(30), o.exaggeration = 3;
    const tc_scene_needs needs = tc_scene_needs_of(&o, &coast);
    assert_true(needs.flood && needs.sea && !needs.water && needs.sea_level == 90);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_nowhere_below_it),
        cmocka_unit_test(errors_are_still_bounds),
        cmocka_unit_test(what_leaves_no_surface_is_refused),
        cmocka_unit_test(water_is_where_ground_is_lower),
        cmocka_unit_test(it_changes_while_a_viewer_runs),
        cmocka_unit_test(the_eye_stays_above_the_sea),
        cmocka_unit_test(it_is_around_the_map),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
