/* test_globe.c - moving over a globe, the view of a whole one, and culling for another camera than is drawn. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/flight.h"
#include "common/view/navigation.h"
#include "tests/support/planet_scene.h"

#define DEGREE (M_PI / 180)
static const double RADIUS = 1e6;

static double level_ground(void *context, double x, double y)
{
    (void)x, (void)y;
    return *(double *)context;
}

static double turn(double angle)
{
    return fabs(remainder(angle, 2 * M_PI));
}

/* Straight on over a pole: the meridian opposite, and the view goes on in the same direction in space. */
static void over_the_pole(void **state)
{
    (void)state;
    double ground_at = 0;
    const tc_ground ground = {
        .height = level_ground, .context = &ground_at, .clearance = 2, .body = {&tc_sphere_body, RADIUS, 0}};
    for (int side = -1; side <= 1; side += 2) {
        tc_flight f = {.view = {.x = 30 * DEGREE, .y = side * 89.9 * DEGREE, .z = 3000}, .speed = 1};
        f.view.heading = side > 0 ? 0 : M_PI;
        for (int i = 0; i < 50; i++)
            tc_sphere_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &ground);
        assert_true(turn(f.view.x - (30 - 180) * DEGREE) < 1e-6);
        assert_true(turn(f.view.heading - (side > 0 ? M_PI : 0)) < 1e-6);
        assert_true(fabs(f.view.y) < 89.5 * DEGREE);
        assert_float_equal(f.view.z, 3000, 1e-6);
    }
}

static void never_lower_than_it_is_or_the_clearance(void **state)
{
    (void)state;
    double ground_at = 500;
    const tc_ground ground = {
        .height = level_ground, .context = &ground_at, .clearance = 2, .body = {&tc_sphere_body, RADIUS, 0}};
    tc_flight f = {.view = {.x = 3.1, .y = 0.2, .z = 501, .pitch = -1}, .speed = 1};
    for (int i = 0; i < 100; i++)
        tc_sphere_navigation.step(&f, &(tc_flight_input){.forward = 1, .right = 1, .dt = 0.1}, &ground);
    assert_true(f.view.z >= 501 && fabs(f.view.x) <= M_PI);
    f.view.z = 499;
    tc_sphere_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &ground);
    assert_true(f.view.z >= 502);
}

/* As many metres a step in whatever direction and wherever: also on an ellipsoid, where a degree of latitude is longer
 * the nearer a pole is. */
static void ways_are_metres(void **state)
{
    (void)state;
    static const double flattening[] = {0, 1 / 298.257223563, 0.1}, latitude[] = {0, 10, -45, 80};
    double ground_at = 0;
    for (int k = 0; k < 3 * 4 * 8; k++) {
        const tc_body body = tc_body_flattened(RADIUS, flattening[k % 3]);
        const tc_ground ground = {.height = level_ground, .context = &ground_at, .clearance = 2, .body = body};
        tc_flight f = {.view = {.x = 3.14, .y = latitude[k / 3 % 4] * DEGREE, .z = 3000}, .speed = 0.1};
        f.view.heading = k / 12 * M_PI / 4;
        double from[3], to[3], way = 3000 * 0.1 * 0.1;
        body.class->position(&body, (double[3]){f.view.x, f.view.y, f.view.z}, from);
        tc_sphere_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &ground);
        body.class->position(&body, (double[3]){f.view.x, f.view.y, f.view.z}, to);
        double moved = hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
        assert_float_equal(moved, way, 1e-5 * way); /* on the way curvature changes */
        assert_float_equal(f.view.z, 3000, 1e-9);
    }
}

/* What there is lies in front of the eye and above its horizon. */
static void whole_views(void **state)
{
    (void)state;
    static const double boxes[][4] = {{-180, -90, 180, 90},  {-170, -60, -100, 60}, {-180, -60, 180, 60},
                                      {-180, -90, 180, -60}, {8, 46, 9, 47},        {179, -1, 181, 1}};
    for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
        const tc_flight_box box = {.z_min = -100,
                                   .z_max = 3000,
                                   .radius = 6371000,
                                   .west = boxes[i][0] * DEGREE,
                                   .south = boxes[i][1] * DEGREE,
                                   .east = boxes[i][2] * DEGREE,
                                   .north = boxes[i][3] * DEGREE};
        tc_pose v = tc_sphere_navigation.whole(&box, 75 * DEGREE, 1280, 720);
        bool around = boxes[i][2] - boxes[i][0] > 359;
        double x = around ? v.x : 0.5 * (box.west + box.east);
        double y = around ? fmin(fmax(v.y, box.south), box.north) : 0.5 * (box.south + box.north);
        double angle = acos(fmin(1, sin(y) * sin(v.y) + cos(y) * cos(v.y) * cos(x - v.x)));
        assert_true(v.z > box.z_max && angle < acos(box.radius / (box.radius + v.z)) * 0.95);
    }
}

static int64_t drawn(tc_surface *s, const tc_camera *camera, const tc_camera *culled)
{
    tc_frame_options options = {.cull_camera = culled};
    tc_windows windows;
    tc_frame frame;
    tc_view *view = tc_view_allocate(s);
    assert_true(view && tc_frame_allocate(s, &frame));
    assert_int_equal(s->make_windows(s, &windows, NULL), TC_OK);
    s->look(s, &windows, camera, &options, true, view);
    s->draws(view, &(tc_layers){0}, &frame); /* nothing is held; for counting that is all one */
    tc_windows_destroy(&windows);
    tc_frame_free(&frame);
    free(view);
    return frame.triangles;
}

static void frozen_culling(void **state)
{
    (void)state;
    tc_map *atlas = planet_made(PLANET_DEFAULT, 256, 6371000, 3);
    tc_scene_options look = {.unlit = true};
    tc_surface *s = planet_rings(atlas, &(tc_rings_options){.n_phi = 128}, &look);
    tc_camera a = {.x = 1, .y = 0.5, .z = 20000, .pitch = -0.3, .fov = 1, .width = 64, .height = 48};
    tc_camera same = a, back = a, moved = a;
    back.heading = M_PI;
    moved.x += 0.002;
    int64_t own = drawn(s, &a, NULL);
    assert_true(own > 0 && drawn(s, &a, &same) == own);
    /* Looking back, what is drawn is still what was in front; a little further on it is nearly the same. */
    assert_true(drawn(s, &back, &a) == own);
    assert_true(fabs((double)(drawn(s, &moved, &a) - own)) < 0.5 * (double)own);
    s->destroy(s);
    tc_map_destroy(atlas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(ways_are_metres), cmocka_unit_test(over_the_pole),
                                       cmocka_unit_test(never_lower_than_it_is_or_the_clearance),
                                       cmocka_unit_test(whole_views), cmocka_unit_test(frozen_culling)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
