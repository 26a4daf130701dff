/* test_measuring.c - what measurements stand on: clocks of frames, and the full-resolution mesh. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/clock.h"
#include "tests/support/frame_clock.h"
#include "tests/support/measured.h"
#include "tests/support/plain_mesh.h"

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

typedef struct mesh_view {
    const tc_gl *gl;
    const plain_mesh *mesh;
    const tc_camera *camera;
    int times;
} mesh_view;

static void draw(void *context_of, bool finish)
{
    const mesh_view *v = context_of;
    for (int i = 0; i < v->times; i++)
        plain_draw(v->gl, v->mesh, v->camera, 1e-4, false);
    if (finish)
        v->gl->Finish();
}

static tc_camera above(double x, double y, double z, double pitch)
{
    return (tc_camera){.x = x, .y = y, .z = z, .pitch = pitch, .fov = M_PI / 2, .width = 320, .height = 240};
}

/* A software renderer has timer queries too, and they tell the time on the wall, since nothing else is being drawn. */
static void timer_queries_tell_the_time(void **state)
{
    (void)state;
    const tc_gl *gl = tc_context_gl(context);
    tc_field *p = terrain_field(TERRAIN_SMOOTH, 129, 129, 30, 1);
    tc_camera c = above(1900, 1900, 2000, -M_PI / 2);
    plain_mesh mesh;
    assert_true(plain_brute_flat(gl, p, &c, &mesh));
    frame_clock by_query = frame_clock_of(gl, true), by_wall = frame_clock_of(gl, false);
    mesh_view once = {gl, &mesh, &c, 1}, more = {gl, &mesh, &c, 10};
    draw(&once, true);
    double start = tc_clock_ms(), ms = frame_clock_ms(&by_query, draw, &once), wall = tc_clock_ms() - start;
    assert_true(ms > 0 && ms <= wall); /* the mean of some frames, which took longer together */
    assert_true(wall > 3 * ms);
    double single[5], query[5], clock[5];
    frame_clock_repeat(&by_query, draw, &once, 5, single);
    frame_clock_repeat(&by_query, draw, &more, 5, query);
    frame_clock_repeat(&by_wall, draw, &more, 5, clock);
    double ratio = measure_of(query, 5).median / measure_of(clock, 5).median;
    print_message("frame clock: by query %.3f ms, by the wall %.3f ms\n", query[2], clock[2]);
    assert_true(ratio > 0.2 && ratio < 5);                    /* the machine may be busy */
    assert_true(query[2] > 2 * measure_of(single, 5).median); /* ten times the work */
    frame_clock_destroy(&by_query), frame_clock_destroy(&by_wall);
    plain_destroy(gl, &mesh);
    tc_field_destroy(p);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

static void a_device_is_a_gpu(void **state)
{
    (void)state;
    tc_context_destroy(context); /* one at a time is current */
    tc_context *fastest = scene_context_fastest();
    assert_non_null(fastest);
    frame_clock clock = frame_clock_create(fastest);
    const char *renderer = (const char *)tc_context_gl(fastest)->GetString(GL_RENDERER);
    print_message("fastest context: %s, %s\n", tc_context_backend(fastest), renderer);
    assert_int_equal(clock.gpu, !tc_gl_software(renderer));
    frame_clock_destroy(&clock);
    tc_context_destroy(fastest);
    context = scene_context();
    assert_non_null(context);
}

/* Pixels that one of two pictures of depths has and the other has not. */
static int differ(const float *a, const float *b, int count)
{
    int n = 0;
    for (int i = 0; i < count; i++)
        n += (a[i] > 0) != (b[i] > 0);
    return n;
}

static double error_of(const tc_camera *c, double near_plane, double radius, const float *depth, const tc_truth *truth)
{
    tc_error_stats e;
    const tc_body body = tc_body_of(radius);
    assert_int_equal(tc_error_stats_init(&e), TC_OK);
    assert_int_equal(tc_view_error_add(c, near_plane, &body, depth, truth, &e), TC_OK);
    assert_true(e.count > 1000);
    double p999 = tc_error_stats_percentile(&e, 0.999);
    tc_error_stats_free(&e);
    return p999;
}

/* Sizes that do not end with a tile. All of the terrain is there, and at the height of the finest level. */
static void the_full_mesh_is_the_terrain(void **state)
{
    (void)state;
    const tc_gl *gl = tc_context_gl(context);
    measured m = {.name = "hills", .field = terrain_field(TERRAIN_SMOOTH, 300, 170, 30, 1)};
    const tc_truth truth = measured_truth(&m);
    scene s = measured_scene(context, &m, 511, NULL, &(tc_scene_options){0});
    for (int look = 0; look < 2; look++) {
        tc_camera c = above(4400, look ? 500 : 2500, look ? 1300 : 6000, look ? -0.3 : -M_PI / 2);
        plain_mesh mesh;
        assert_true(plain_brute_flat(gl, m.field, &c, &mesh));
        assert_int_equal(mesh.triangles, 2 * 299 * 169);
        plain_draw(gl, &mesh, &c, 1e-4, false);
        float *brute = plain_depth(gl, &mesh);
        scene_draw(&s, &c, true);
        float *squares = planet_depth(&s, &c);
        int missing = differ(brute, squares, c.width * c.height);
        double p999 = error_of(&c, 1e-4, 0, brute, &truth);
        print_message("full mesh: %d pixels differ, 99.9 %% %.5f px\n", missing, p999);
        assert_true(missing <= 4 && p999 < 0.01);
        free(brute), free(squares);
        plain_destroy(gl, &mesh);
    }
    scene_destroy(&s);
    measured_close(&m);
}

/* On the whole sphere, poles and seam included. */
static void the_full_mesh_is_the_planet(void **state)
{
    (void)state;
    const tc_gl *gl = tc_context_gl(context);
    measured m = {.name = "planet", .round = true};
    m.planet = planet_made(PLANET_SMOOTH, 512, 1737400, 1);
    const tc_truth truth = measured_truth(&m);
    scene s = measured_scene(context, &m, 1024, &(tc_rings_options){.m = 40}, &(tc_scene_options){0});
    static const double place[4][2] = {{0.2, 0.4}, {M_PI, -0.1}, {1, 1.57}, {2, -1.5}};
    for (int k = 0; k < 4; k++) {
        tc_camera c = above(place[k][0], place[k][1], 3e6, -M_PI / 2);
        plain_mesh mesh;
        assert_true(plain_brute_globe(gl, m.planet, &c, &mesh));
        plain_draw(gl, &mesh, &c, 1e-3, false);
        float *brute = plain_depth(gl, &mesh);
        scene_draw(&s, &c, true);
        float *rings = planet_depth(&s, &c);
        int missing = differ(brute, rings, c.width * c.height);
        double p999 = error_of(&c, 1e-3, m.planet->body.radius, brute, &truth);
        print_message("full mesh of a planet: %d pixels differ, 99.9 %% %.5f px\n", missing, p999);
        assert_true(missing <= 40 && p999 < 0.02); /* its edges are chords, and so are the rings' */
        free(brute), free(rings);
        plain_destroy(gl, &mesh);
    }
    scene_destroy(&s);
    measured_close(&m);
}

static void spread_of_known_values(void **state)
{
    (void)state;
    double v[11] = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
    measure_spread s = measure_of(v, 11);
    assert_true(s.median == 5 && s.low == 1 && s.high == 9 && s.count == 11);
    assert_true(isnan(measure_of(v, 0).median));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(timer_queries_tell_the_time),  cmocka_unit_test(a_device_is_a_gpu),
        cmocka_unit_test(the_full_mesh_is_the_terrain), cmocka_unit_test(the_full_mesh_is_the_planet),
        cmocka_unit_test(spread_of_known_values),
    };
    return cmocka_run_group_tests_name("measuring", tests, set_up, tear_down);
}
