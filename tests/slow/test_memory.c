/* test_memory.c - no allocation a frame, a resident set that stays flat, and memory by item that is what it should be.
 *
 * The Makefile links this test with --wrap for the functions below, so that what our own objects allocate is counted,
 * and what the driver allocates is not. */
#include "tests/support/test.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/content/ground.h"
#include "common/view/flight.h"
#include "common/view/flight_path.h"
#include "common/app/stats.h"
#include "tests/support/process.h"
#include "tests/support/scene.h"
#include "tests/support/sweep.h"
#include "tests/support/terrains.h"
#include "tests/wrapped/allocations.h"

#if defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

enum { SIZE = 1025, SPACING = 30, N = 63, WIDTH = 160, HEIGHT = 120, FINER = 5 };

/* Calls of any of the functions. */
static long long calls(void)
{
    return allocations.asked + allocations.freed;
}

/* ---- Flying ----------------------------------------------------------------------------------------------------- */

static tc_context *context;
static tc_field *terrain, *finer; /* than its data */

static int set_up(void **state)
{
    (void)state;
    mallopt(M_TRIM_THRESHOLD, 1 << 30); /* as the viewer does */
    context = scene_context();
    for (int k = 0; k < 2; k++) {
        tc_grid grid = terrain_grid(TERRAIN_DEFAULT, SIZE, SIZE, SPACING, 3);
        grid.voids = calloc((size_t)SIZE * SIZE, 1);
        assert_non_null(grid.voids);
        for (int64_t i = 0; i < SIZE; i++, grid.void_count++) /* for scenes with holes */
            grid.voids[i * SIZE + i] = 1;
        assert_int_equal(tc_field_build(&grid, 0, k ? &finer : &terrain, NULL), TC_OK);
    }
    finer = terrain_synthesised(finer, FINER);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_field_destroy(terrain), tc_field_destroy(finer);
    tc_context_destroy(context);
    return 0;
}

/* A flight that crosses the terrain and its edges, low and high, and never repeats itself; with a leap here and there.
 */
static tc_camera camera_at(int frame)
{
    double t = 0.01 * frame, extent = (SIZE - 1) * SPACING, ground = 0;
    double leap = frame % 500 == 499 ? 0.4 : 0;
    tc_camera c = {.x = extent * (0.5 + 0.6 * sin(t) + leap),
                   .y = extent * (0.5 + 0.6 * sin(1.618 * t + 1)),
                   .heading = 0.7 * t,
                   .pitch = -0.5 + 0.6 * sin(0.37 * t),
                   .fov = 1.3,
                   .width = WIDTH,
                   .height = HEIGHT};
    tc_field_height(terrain, c.x, c.y, &ground);
    c.z = ground + 2 + 3000 * pow(sin(0.23 * t), 4);
    return c;
}

/* Frames first to last, each as the viewer's loop does it. */
static void fly(scene *s, tc_stats *stats, int first, int last)
{
    for (int frame = first; frame < last; frame++) {
        tc_camera c = camera_at(frame);
        tc_frame_stats f = scene_draw(s, &c, false);
        tc_stats_frame(stats, f.update_ms + f.draw_ms, &f);
    }
}

static void frames_allocate_nothing(void **state)
{
    (void)state;
    static const struct {
        bool finer;
        tc_scene_options options;
    } scenes[] = {{false, {0}},
                  {false, {.budget = 1000}},
                  {false, {.budget = -1, .holes = true}},
                  {false, {.unlit = true, .background_set = true}},
                  {false, {.wireframe = true, .level_colours = true}},
                  {false, {.samples = 4, .frame.no_cull = true}},
                  {true, {.budget = 1000}},
                  {true, {.budget = -1, .holes = true}},
                  {false, {.frame.error = 1}},
                  {true, {.budget = 5000, .frame.error = 4}}};
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        scene s = scene_create(context, scenes[k].finer ? finer : terrain, scenes[k].options.frame.error > 0 ? 127 : N,
                               &scenes[k].options);
        tc_stats *stats;
        assert_int_equal(tc_stats_create(100, &stats, NULL), TC_OK);
        fly(&s, stats, 0, 20); /* warm-up */
        long long before = calls();
        int frames = SANITIZED ? 100 : k == 0 ? 1000 : 300;
        fly(&s, stats, 20, 20 + frames);
        long long made = calls() - before;
        printf("allocations: %lld in %d frames of scene %zu\n", made, frames, k);
        assert_int_equal(made, 0);
        tc_stats_destroy(stats);
        scene_destroy(&s);
    }
}

/* The same for what a window does beside drawing: the eye's flight over the ground, and a recorded one. */
static double ground_height(void *unused, double x, double y)
{
    (void)unused;
    double z = 0;
    tc_field_height(terrain, x, y, &z);
    return z;
}

static void flying_allocates_nothing(void **state)
{
    (void)state;
    tc_flight_path path;
    assert_int_equal(tc_flight_path_parse(&tc_plane_navigation, "test",
                                          "0,0,900,0,0\n20000,9000,1500,200,-20\n5000,30000,900,10,5\n", &path, NULL),
                     TC_OK);
    tc_flight flight = {.view = tc_flight_path_view(&path, 0, 2), .speed = tc_flight_speed};
    const tc_ground ground = {.height = ground_height, .clearance = tc_flight_clearance(SPACING)};
    const tc_flight_input input = {.forward = 1, .turn = 0.01, .dt = 0.016, .fast = true};
    long long before = calls();
    for (int i = 0; i < 1000; i++) {
        tc_plane_navigation.step(&flight, &input, &ground);
        tc_pose view = tc_flight_path_view(&path, i, 1000);
        tc_camera c;
        tc_pose_to_camera(&view, &c);
    }
    assert_int_equal(calls() - before, 0);
    tc_flight_path_free(&path);
}

static void resident_set_stays_flat(void **state)
{
    (void)state;
    if (SANITIZED) {
        printf("resident set: not measured under a sanitizer, which holds back what is freed\n");
        skip();
    }
    /* Thousands of frames; fewer may bring less growth. */
    static const int whole[2] = {10, 5}, part[2] = {4, 3};
    const int *thousands = sweep_whole() ? whole : part;
    for (int k = 0; k < 2; k++) {
        scene s = scene_create(context, k ? finer : terrain, N, &(tc_scene_options){0});
        tc_stats *stats;
        assert_int_equal(tc_stats_create(1000, &stats, NULL), TC_OK);
        long long after[11] = {0};
        for (int thousand = 1; thousand <= thousands[k]; thousand++) {
            fly(&s, stats, 1000 * (thousand - 1), 1000 * thousand);
            after[thousand] = (long long)process_resident();
        }
        const int half = (thousands[k] + 1) / 2;
        printf("resident set%s: %.2f MiB after 1000 frames, %.2f after %d, %.2f after %d\n", k ? ", synthesised" : "",
               (double)after[1] / (1 << 20), (double)after[half] / (1 << 20), 1000 * half,
               (double)after[thousands[k]] / (1 << 20), 1000 * thousands[k]);
        assert_true((after[thousands[k]] - after[1]) * (whole[k] - 1) < (thousands[k] - 1) * (1LL << 20));
        tc_stats_destroy(stats);
        scene_destroy(&s);
    }
}

/* ---- By item ---------------------------------------------------------------------------------------------------- */

/* a and b, in bytes, differ by no more than a few per cent and a few pages. */
static void assert_about(const char *what, double found, double expected)
{
    printf("memory: %s: %.1f KiB, expected about %.1f\n", what, found / 1024, expected / 1024);
    assert_true(fabs(found - expected) < 0.03 * expected + 32768);
}

static void items_add_up(void **state)
{
    (void)state;
    /* The pyramid: a third more than the grid, and two floats for each 16 x 16 samples. */
    long long start = allocations.live;
    tc_field *own = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, SPACING, 1);
    double samples = 0;
    for (int l = 1; l <= tc_field_info(own)->levels; l++) {
        tc_level level = tc_field_level(own, l);
        samples += (double)level.width * (double)level.height;
    }
    double field_bytes = samples * (4 + 8. / 256);
    assert_about("pyramid", (double)tc_field_tell(own).bytes, field_bytes);
    assert_about("pyramid, as allocated", (double)(allocations.live - start), field_bytes);

    for (int lit = 0; lit < 2; lit++) {
        start = allocations.live;
        scene s = scene_create(context, own, N, &(tc_scene_options){.unlit = !lit});
        tc_camera c = camera_at(0);
        scene_draw(&s, &c, true);
        long long held = allocations.live - start;
        tc_memory_stats m;
        tc_renderer_memory(s.renderer, &m);

        /* A level's window is (n + 1)^2 pairs of floats, in a texture and beside it; with light 2 x 2 normals for each,
         * the level's own and the coarser one's, of two bytes. Beside it there is room to read a window into. */
        int levels = tc_clipmap_levels(s.clipmap);
        double window = (double)levels * (N + 1) * (N + 1), scratch = (double)tc_clipmap_bytes(s.clipmap, NULL);
        assert_about(lit ? "heights and normals, lit" : "heights and normals, unlit", (double)(m.heights + m.normals),
                     2 * window * (8 + lit * 16) + scratch);
        assert_true((double)m.heights >= 2 * window * 8);
        assert_true(lit ? (double)m.normals >= window * 16 : m.normals == 0);
        assert_true(m.field == tc_field_tell(own).bytes);
        assert_true(m.imagery == 0);
        const tc_geometry *g = &s.surface->geometry;
        size_t mesh = 4 * (size_t)g->vertex_count + (size_t)g->index_bytes * (size_t)g->index_count;
        printf("memory: geometry: %zu vertices and indices, %zu with the draws\n", mesh, m.geometry);
        assert_true(m.geometry >= mesh && m.geometry < mesh + (1 << 18));
        /* What our code holds is in the items, but for a view and lists of draws and of changes, which no terrain makes
         * longer. */
        double walls = (double)s.surface->wall_capacity * (double)(sizeof(tc_draw) + sizeof(tc_instance));
        double listed = window * (8 + lit * 16) + scratch + (double)mesh + (double)s.surface->view_bytes + walls,
               rest = (double)held - listed;
        printf("memory: held by our own code: %.1f KiB, of it not in the items %.1f\n", (double)held / 1024,
               rest / 1024);
        assert_true(rest >= 0 && rest < 1 << 18);
        scene_destroy(&s);
        assert_int_equal(allocations.live, start);
    }
    tc_field_destroy(own);
}

/* Levels finer than the data take what making them takes, from the first reading on, and are told. */
static void making_heights_is_counted(void **state)
{
    (void)state;
    static float z[300 * 300];
    long long start = allocations.live;
    tc_field *data = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, SPACING, 1);
    size_t told = tc_field_tell(data).bytes;
    tc_field *own = terrain_synthesised(data, FINER);
    size_t bare = tc_field_tell(own).bytes - told, most = 0;
    for (int l = tc_field_info(own)->levels; l > tc_field_info(own)->levels - FINER; l--)
        for (int side = 300; side > 0; side /= 7) {
            assert_int_equal(tc_field_read(own, l, (tc_rect){101, 3, 101 + side, 3 + side}, z, NULL, side), TC_OK);
            size_t held = tc_field_tell(own).bytes - told;
            assert_true(held > bare && (most == 0 || held == most));
            most = held;
        }
    printf("memory: synthesis: %.1f KiB, %.1f of it to make heights in\n", (double)most / 1024,
           (double)(most - bare) / 1024);
    assert_about("field, synthesised", (double)tc_field_tell(own).bytes, (double)(allocations.live - start));
    tc_field_destroy(own);
    assert_int_equal(allocations.live, start);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_allocate_nothing),
        cmocka_unit_test(flying_allocates_nothing),
        cmocka_unit_test(items_add_up),
        cmocka_unit_test(making_heights_is_counted),
        cmocka_unit_test(resident_set_stays_flat),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
