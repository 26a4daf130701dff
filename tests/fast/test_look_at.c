/* test_look_at.c - views of a place: from its distance, towards it, over every body; and places of maps by longitude
 * and latitude. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/find_place.h"
#include "common/view/camera.h"
#include "common/view/look_at.h"
#include "tests/support/planet_scene.h"
#include "tests/support/terrains.h"

static const double DEGREE = M_PI / 180;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Metres from one place to another, along the axes at the first. */
static void way_between(const tc_body *body, const double from[3], const double to[3], double way_ret[3])
{
    double a[3], b[3], axes[3][3];
    body->class->position(body, from, a);
    body->class->position(body, to, b);
    body->class->axes(body, from, axes);
    const double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    for (int i = 0; i < 3; i++)
        way_ret[i] = dot(way, axes[i]);
}

static void assert_looks_at(const tc_body *body, const double place[3], const tc_pose *view, double distance)
{
    const double eye[3] = {view->x, view->y, view->z};
    double way[3];
    way_between(body, eye, place, way);
    const double length = sqrt(dot(way, way));
    const tc_basis axes = tc_camera_basis(&(tc_camera){.heading = view->heading, .pitch = view->pitch});
    if (!(fabs(length / distance - 1) < 1e-7) || !(dot(way, axes.forward) / length > 1 - 1e-10))
        fail_msg("%s: from %g m: %.12g m away, %.12g of it straight ahead", body->class->name, distance, length,
                 dot(way, axes.forward) / length);
}

static void the_eye_looks_at_the_place(void **state)
{
    (void)state;
    test_random r = {11};
    const tc_body bodies[] = {tc_body_of(0), tc_body_of(6371000), tc_body_flattened(6378137, WGS84_FLATTENING),
                              tc_body_flattened(1737400, 0.1)};
    for (int n = 0; n < 4000; n++) {
        const tc_body *body = &bodies[n % 4];
        const bool globe = body->radius > 0;
        const double place[3] = {globe ? test_random_range(&r, -M_PI, M_PI) : test_random_range(&r, -1e5, 1e5),
                                 globe ? test_random_range(&r, -1.57, 1.57) : test_random_range(&r, -1e5, 1e5),
                                 test_random_range(&r, -3000, 9000)};
        const double heading = test_random_range(&r, -6, 6), pitch = test_random_range(&r, -1.57, -0.05),
                     distance = pow(10, test_random_range(&r, 0.5, 7.5));
        const tc_pose view = tc_look_at(body, place, heading, pitch, distance);
        assert_looks_at(body, place, &view, distance);
        /* The eye stands as high over the place's horizon as it looks down, in the direction opposite to the heading.
         */
        double way[3];
        way_between(body, place, (const double[3]){view.x, view.y, view.z}, way);
        const double up = asin(way[2] / sqrt(dot(way, way)));
        assert_true(fabs(up + pitch) < 1e-6);
        if (pitch > -1.5)
            assert_true(fabs(remainder(atan2(-way[0], -way[1]) - heading, 2 * M_PI)) < 1e-5);
    }
}

/* Straight down any heading is right: the one that was asked for. */
static void straight_down_keeps_the_heading(void **state)
{
    (void)state;
    const tc_body bodies[] = {tc_body_of(0), tc_body_of(6371000), tc_body_flattened(6378137, WGS84_FLATTENING)};
    for (int k = 0; k < 3; k++)
        for (double distance = 0.1; distance < 1e8; distance *= 10) {
            const double place[3] = {0.3, 0.7, 100};
            const tc_pose view = tc_look_at(&bodies[k], place, 2, -M_PI / 2, distance);
            assert_true(fabs(view.heading - 2) < 1e-6 && fabs(view.pitch + M_PI / 2) < 1e-6);
            assert_true(fabs(view.z - 100 - distance) < 1e-6 * (distance + 100));
        }
}

static void a_lifted_eye_still_looks_there(void **state)
{
    (void)state;
    const tc_body body = tc_body_of(6371000);
    const double place[3] = {0.3, 0.7, 100};
    tc_pose view = tc_look_at(&body, place, 0.4, -0.1, 9000);
    view.z += 2500;
    tc_look_towards(&body, place, &view);
    double way[3];
    way_between(&body, (const double[3]){view.x, view.y, view.z}, place, way);
    assert_looks_at(&body, place, &view, sqrt(dot(way, way)));
    const tc_pose before = view;
    tc_look_towards(&body, (const double[3]){view.x, view.y, view.z}, &view); /* no direction at all */
    assert_memory_equal(&before, &view, sizeof view);
}

/* ---- Places of maps ---------------------------------------------------------------------------------------------- */

/* 41 x 21 samples half a degree apart, from 350 degrees east and 40 degrees north on. */
static tc_map *degrees_map(double radius, bool areas)
{
    tc_grid grid = terrain_grid(TERRAIN_SLOPE, 41, 21, 50000, 1);
    grid.area_registered = areas;
    grid.georef = (tc_georef){.known = true, .geographic = true, .transform = {350 - 0.25, 0.5, 0, 50 + 0.25, 0, -0.5}};
    tc_map *map;
    assert_int_equal(tc_map_build(&grid, radius, 1, &map, NULL), TC_OK);
    return map;
}

static bool finds(const tc_map *map, double longitude, double latitude, double place[2])
{
    tc_error error;
    tc_status status = tc_find_place(map, "map", "--lookat", longitude, latitude, place, &error);
    assert_true(status == TC_OK || status == TC_ERR_IO);
    return status == TC_OK;
}

static void places_of_flat_maps(void **state)
{
    (void)state;
    double at[2];
    for (int areas = 0; areas < 2; areas++) {
        tc_map *map = degrees_map(0, areas);
        for (int turn = -1; turn <= 0; turn++) { /* all longitudes that are one */
            assert_true(finds(map, 350 + 360 * turn, 40, at) && fabs(at[0]) < 1e-6 && fabs(at[1]) < 1e-6);
            assert_true(finds(map, 360 + 360 * turn, 45.25, at));
            assert_true(fabs(at[0] - 20 * 50000) < 1e-6 && fabs(at[1] - 10.5 * 50000) < 1e-6);
        }
        assert_true(finds(map, 10, 50, at) && fabs(at[0] - 40 * 50000) < 1e-6 && fabs(at[1] - 20 * 50000) < 1e-6);
        assert_int_equal(finds(map, 10.2, 50.2, at), areas); /* beside the middle of the last one, which is an area */
        assert_true(!areas || (fabs(at[0] - 40 * 50000) < 1e-6 && fabs(at[1] - 20 * 50000) < 1e-6));
        assert_false(finds(map, 10.3, 45, at) || finds(map, 0, 39.7, at) || finds(map, 180, 45, at));
        tc_map_destroy(map);
    }
}

static void places_of_planets(void **state)
{
    (void)state;
    double at[2];
    for (int areas = 0; areas < 2; areas++) {
        tc_map *map = degrees_map(6371000, areas);
        for (int turn = -1; turn <= 0; turn++) {
            double z;
            assert_true(finds(map, 350 + 360 * turn, 40, at) && fabs(at[1] - 40 * DEGREE) < 1e-9);
            assert_true(finds(map, 360 + 360 * turn, 45.25, at));
            assert_true(fabs(remainder(at[0], 2 * M_PI)) < 1e-9 && fabs(at[1] - 45.25 * DEGREE) < 1e-9);
            assert_int_equal(tc_map_height(map, at[0], at[1], &z), TC_OK);
            assert_true(fabs(z - (0.25 * 20 + 0.5 * 10.5) * 50000) < 5000);
        }
        assert_int_equal(finds(map, 10.2, 50.2, at), areas);
        assert_false(finds(map, 10.3, 45, at) || finds(map, 0, 39.7, at) || finds(map, 180, 45, at));
        tc_map_destroy(map);
    }
    tc_map *whole[] = {planet_made(PLANET_SMOOTH, 64, 1e6, 3), NULL};
    whole[1] = planet_of_faces(planet_made(PLANET_SMOOTH, 64, 1e6, 3), &tc_chart_cube);
    for (int k = 0; k < 2; k++) {
        for (double longitude = -360; longitude <= 360; longitude += 45)
            for (double latitude = -90; latitude <= 90; latitude += 45)
                assert_true(finds(whole[k], longitude, latitude, at));
        tc_map_destroy(whole[k]);
    }
}

static void what_has_no_place_is_said(void **state)
{
    (void)state;
    tc_grid grid = terrain_grid(TERRAIN_SLOPE, 41, 21, 30, 1);
    tc_map *map;
    tc_error error;
    double at[2];
    assert_int_equal(tc_map_build(&grid, 0, 1, &map, NULL), TC_OK);
    assert_int_equal(tc_find_place(map, "map.png", "--lookat", 1, 2, at, &error), TC_ERR_USAGE);
    assert_non_null(strstr(error.text, "--lookat: expected a map that says where on a globe it lies, found map.png"));
    assert_false(tc_find_georeferenced(map, 1, 2, at));
    map->georef.known = true; /* but not in which system */
    assert_int_equal(tc_find_place(map, "map.png", "--lookat", 1, 2, at, &error), TC_ERR_USAGE);
    assert_non_null(strstr(error.text, "without a coordinate system"));
    tc_map_destroy(map);
    map = degrees_map(0, false);
    assert_int_equal(tc_find_place(map, "map.tif", "--lookat", 1, 20, at, &error), TC_ERR_IO);
    assert_string_equal(error.text, "--lookat: expected a place on map.tif, found one beside it, at 1,20");
    tc_map_destroy(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_eye_looks_at_the_place),
        cmocka_unit_test(straight_down_keeps_the_heading),
        cmocka_unit_test(a_lifted_eye_still_looks_there),
        cmocka_unit_test(places_of_flat_maps),
        cmocka_unit_test(places_of_planets),
        cmocka_unit_test(what_has_no_place_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
