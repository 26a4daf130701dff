/* test_exaggeration.c - heights times a factor: every height and bound of a map, on plane and globe, with levels finer
 * than the data and with voids; other factors later; and a viewer that changes its. */
#include "tests/support/test.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/viewer_internal.h"
#include "common/field/field.h"
#include "common/map/map.h"
#include "common/render/palette.h"
#include "planar/square.h"
#include "spherical/faces.h"
#include "tests/support/planet_scene.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

static tc_map *flat_map(void)
{
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 300, 200, 30, 1);
    grid.voids = calloc((size_t)(grid.width * grid.height), 1);
    for (int64_t i = 0; i < grid.width * grid.height; i += 37)
        grid.voids[i] = 1, grid.void_count++;
    tc_map *map;
    assert_int_equal(tc_map_build(&grid, 0, 2, &map, NULL), TC_OK);
    assert_int_equal(tc_map_synthesise(map, 2, NULL), TC_OK);
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

/* Part of a level, as wide as SIDE at most; beyond its sides where it can be read there. */
static tc_rect part_of(const tc_field *field, int level, test_random *r)
{
    const tc_level size = tc_field_level(field, level);
    int64_t most_x = size.width > SIDE ? size.width - SIDE : 0, most_y = size.height > SIDE ? size.height - SIDE : 0;
    tc_rect rect = {test_random_int(r, 0, most_x), test_random_int(r, 0, most_y), 0, 0};
    rect.x1 = rect.x0 + (size.width < SIDE ? size.width : SIDE);
    rect.y1 = rect.y0 + (size.height < SIDE ? size.height : SIDE);
    rect.x0 -= field->beyond, rect.y1 += field->beyond;
    return rect;
}

static void assert_scaled(const tc_field *plain, const tc_field *scaled, float factor)
{
    test_random r = {7};
    enum { MOST = (SIDE + 16) * (SIDE + 16) };
    float a[MOST], b[MOST];
    uint8_t voids_a[MOST], voids_b[MOST];
    tc_field_know_errors(plain), tc_field_know_errors(scaled);
    for (int level = 1; level <= tc_field_info(plain)->levels; level++)
        for (int k = 0; k < 8; k++) {
            const tc_rect rect = part_of(plain, level, &r);
            const int64_t w = rect.x1 - rect.x0, count = w * (rect.y1 - rect.y0);
            assert_int_equal(tc_field_read(plain, level, rect, a, voids_a, w), TC_OK);
            if (k % 2 == 0)
                assert_int_equal(tc_field_read(scaled, level, rect, b, voids_b, w), TC_OK);
            else
                assert_int_equal(tc_field_read_ready(scaled, level, rect, b, voids_b, w, TC_SOON), TC_READY);
            assert_memory_equal(voids_a, voids_b, count);
            const tc_range one = tc_field_range(plain, level, rect), other = tc_field_range(scaled, level, rect);
            for (int64_t i = 0; i < count; i++)
                if (b[i] != factor * a[i])
                    fail_msg("level %d: %g times %g is %g", level, (double)factor, (double)a[i], (double)b[i]);
            assert_true(other.lo == factor * one.lo && other.hi == factor * one.hi);
            const float rounding = 2 * FLT_EPSILON * fmaxf(fabsf(other.lo), fabsf(other.hi));
            assert_true(isinf(one.step) ? isinf(other.step) : fabsf(other.step - factor * one.step) <= rounding);
            assert_true(isinf(one.error) ? isinf(other.error) : fabsf(other.error - factor * one.error) <= rounding);
            assert_true(other.step >= factor * one.step && other.error >= factor * one.error);
            assert_int_equal(tc_field_ready(scaled, level, rect, TC_ONLY_ASK), TC_READY);
        }
}

static void heights_and_bounds_are_scaled(void **state)
{
    (void)state;
    static const double factors[] = {2, 0.3, 17, 0.01};
    for (int m = 0; m < MAKERS; m++) {
        tc_map *plain = makers[m](), *map = makers[m]();
        for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) { /* one after the other, not on top of it */
            assert_int_equal(tc_map_exaggerate(map, factors[i], NULL), TC_OK);
            const float factor = (float)factors[i];
            for (int chart = 0; chart < tc_map_charts(map); chart++)
                assert_scaled(tc_map_field(plain, chart), tc_map_field(map, chart), factor);
            double z, scaled;
            assert_int_equal(tc_map_height(plain, 0.3, 0.2, &z), TC_OK);
            assert_int_equal(tc_map_height(map, 0.3, 0.2, &scaled), TC_OK);
            assert_true(fabs(scaled - (double)factor * z) <= 1e-6 * fabs(scaled) + 1e-6);
        }
        tc_map_destroy(plain), tc_map_destroy(map);
    }
}

static void nothing_is_left_of_a_factor_of_one(void **state)
{
    (void)state;
    for (int m = 0; m < MAKERS; m++) {
        tc_map *map = makers[m]();
        const tc_field *own = tc_map_field(map, 0);
        assert_int_equal(tc_map_exaggerate(map, 1, NULL), TC_OK);
        assert_ptr_equal(tc_map_field(map, 0), own);
        assert_int_equal(tc_map_exaggerate(map, 3, NULL), TC_OK);
        assert_ptr_not_equal(tc_map_field(map, 0), own);
        assert_int_equal(tc_map_exaggerate(map, 1, NULL), TC_OK);
        assert_ptr_equal(tc_map_field(map, 0), own);
        tc_map_destroy(map);
    }
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    static const double bad[] = {0, -1, 0.009, 1001, INFINITY, -INFINITY, NAN};
    tc_map *map = planet();
    tc_error error;
    assert_int_equal(tc_map_exaggerate(map, 5, NULL), TC_OK);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(tc_map_exaggerate(map, bad[i], &error), TC_ERR_USAGE);
    assert_int_equal(tc_map_exaggerate(map, 1000, &error), TC_ERR_FORMAT); /* down to the middle of its sphere */
    assert_non_null(strstr(error.text, "small beside the radius"));
    assert_true(map->exaggeration == 5);
    tc_map *plain = planet();
    assert_scaled(tc_map_field(plain, 0), tc_map_field(map, 0), 5);
    tc_map_destroy(plain), tc_map_destroy(map);
}

/* A height drawn twice as high has the colour of the height that it has. */
static void palettes_tell_true_heights(void **state)
{
    (void)state;
    const tc_terrain_info info = {.z_min = -400, .z_max = 3100}, twice = {.z_min = -800, .z_max = 6200};
    const tc_terrain_info told = tc_palette_heights(&twice, 2);
    assert_true(told.z_min == info.z_min && told.z_max == info.z_max && told.z_base == 0);
    const tc_palette plain = tc_palette_make(&info);
    tc_palette p = tc_palette_make(&told);
    tc_palette_exaggerate(&p, 2, false);
    assert_memory_equal(p.ramp, plain.ramp, sizeof p.ramp);
    assert_true(p.heights[0] == 2 * plain.heights[0] && p.heights[3] == 2 * plain.heights[3]);
    assert_true(p.heights[1] == plain.heights[1] / 2 && p.heights[2] == plain.heights[2] / 2);
}

/* ---- A viewer ---------------------------------------------------------------------------------------------------- */

static tc_context *context;

static tc_viewer viewer(double unit)
{
    static tc_colour_stop stops[] = {{0, true, {20, 40, 200, 255}}, {1, true, {250, 220, 40, 255}}};
    static const tc_colour_ramp colours = {2, stops}; /* of shares: alike for both */
    static const tc_scheme *const lists[] = {tc_square_schemes, NULL};
    static const tc_viewer_program program = {.name = "test", .body = &tc_plane_body, .schemes = lists};
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 500, 400, 30, 1);
    for (int64_t i = 0; i < grid.width * grid.height; i++)
        grid.z[i] *= (float)unit;
    grid.z_min *= (float)unit, grid.z_max *= (float)unit;
    tc_viewer v = {
        .program = &program,
        .gl = tc_context_gl(context),
        .options = {.output = "picture.png", .exaggeration = 1, .quiet = true},
        .least_height = 0.01,
        .scene = {.budget = -1, .shade = tc_shade_named("height"), .colours = &colours, .contours = 50 * unit}};
    if (tc_map_build(&grid, 0, 2, &v.map, NULL) != TC_OK)
        fail();
    v.camera = (tc_camera){
        .x = 4e3, .y = 3e3, .z = 4e3, .heading = 0.4, .pitch = -0.4, .fov = 1.2, .width = 160, .height = 100};
    return v;
}

static void leave(tc_viewer *v)
{
    tc_renderer_destroy(v->renderer);
    if (v->surface)
        v->surface->destroy(v->surface);
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

/* There and back, and as heights drawn so from the beginning: twice as high is what a file of twice the heights
 * shows, with lines of equal height at twice the distance. */
static void it_changes_while_a_viewer_runs(void **state)
{
    (void)state;
    tc_viewer v = viewer(1), twice = viewer(2);
    const size_t size = (size_t)v.camera.width * (size_t)v.camera.height * 3;
    uint8_t *plain = picture(&v), *file = picture(&twice);
    assert_int_equal(tc_viewer_exaggerate(&v, 2, NULL), TC_OK);
    uint8_t *drawn = picture(&v);
    assert_memory_equal(drawn, file, size);
    assert_memory_not_equal(drawn, plain, size);
    free(drawn);
    tc_error error;
    assert_int_equal(tc_viewer_exaggerate(&v, -2, &error), TC_ERR_USAGE); /* then all is as it was */
    drawn = picture(&v);
    assert_memory_equal(drawn, file, size);
    free(drawn);
    assert_int_equal(tc_viewer_exaggerate(&v, 1, NULL), TC_OK);
    drawn = picture(&v);
    assert_memory_equal(drawn, plain, size);
    free(drawn), free(plain), free(file);
    leave(&v), leave(&twice);
}

/* An eye that the ground has grown over is lifted. */
static void the_eye_stays_above_the_ground(void **state)
{
    (void)state;
    tc_viewer v = viewer(1);
    double ground;
    free(picture(&v));
    assert_int_equal(tc_map_height(v.map, v.camera.x, v.camera.y, &ground), TC_OK);
    assert_true(ground > 1);
    v.camera.z = ground + 2;
    assert_int_equal(tc_viewer_exaggerate(&v, 10, NULL), TC_OK);
    assert_true(fabs(v.camera.z - 10 * ground) < 0.1);
    assert_true(v.lifted);
    leave(&v);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_and_bounds_are_scaled),  cmocka_unit_test(nothing_is_left_of_a_factor_of_one),
        cmocka_unit_test(what_cannot_be_is_refused),      cmocka_unit_test(palettes_tell_true_heights),
        cmocka_unit_test(it_changes_while_a_viewer_runs), cmocka_unit_test(the_eye_stays_above_the_ground),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
