/* test_watertight.c - no background shows through the terrain, from any view (tests/support/watertight.h). */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/scene.h"
#include "tests/support/sweep.h"
#include "tests/support/terrains.h"
#include "tests/support/watertight.h"

enum { WIDTH = 320, HEIGHT = 240, SPACING = 30, TERRAINS = 5, DATA = 4 };

/* Sizes of 2^k + 1 end on a sample of every level; others on edges between samples. The first DATA of them are. */
static const struct {
    terrain_kind kind;
    int width, height;
    int synthesised; /* levels finer than the data */
} made[TERRAINS] = {{TERRAIN_CLIFF, 1025, 1025, 0},
                    {TERRAIN_SMOOTH, 1025, 700, 0},
                    {TERRAIN_DEFAULT, 1000, 1000, 0},
                    {TERRAIN_CLIFF, 770, 765, 0},
                    {TERRAIN_DEFAULT, 190, 190, 6}};

typedef struct totals {
    int views, cracks, below_surface;
    int64_t terrain_pixels;
} totals;

/* What is left open, for the test to find. */
typedef enum fault { SOUND, NO_CLOSERS, NO_STITCH } fault;

/* What frames are drawn by. */
typedef enum drawing { DISTANCE = 0, THROTTLED = 1, TOLERANCE = 2 } drawing;

static void run_drawn(const tc_context *context, const tc_field *p, int n, int views, bool lagging, unsigned how,
                      fault f, uint64_t seed, totals *t)
{
    tc_scene_options options = watertight_options();
    options.frame = (tc_frame_options){.no_closers = f == NO_CLOSERS,
                                       .no_stitch = f == NO_STITCH,
                                       .no_morph = f == SOUND && (seed & 3) == 3,
                                       .error = how & TOLERANCE ? 1 : 0};
    scene s = scene_create(context, p, n, &options);
    test_random r = {seed};
    for (int v = 0; v < views; v++) {
        tc_camera camera = watertight_view(&r, p, 50e3, WIDTH, HEIGHT);
        if (how & THROTTLED)
            options.frame.throttle = test_random_range(&r, 0, s.surface->most_throttle);
        if (how & TOLERANCE)
            options.frame.error = 0.1 * pow(200, test_random_unit(&r));
        tc_renderer_set_options(s.renderer, &options);
        if (lagging) {
            options.budget = test_random_int(&r, n, (int64_t)n * n);
            tc_renderer_set_options(s.renderer, &options);
            for (int64_t frames = test_random_int(&r, 0, 3); frames > 0; frames--)
                scene_draw(&s, &camera, false);
        }
        scene_draw(&s, &camera, !lagging);
        double z;
        if (watertight_over(p, &camera) && scene_height(&s, &camera, &options.frame, camera.x, camera.y, &z) &&
            z >=
                camera.z) { /* a level that lags may stand higher than the eye: it looks up at the surface from below */
            t->below_surface++;
            continue;
        }
        uint8_t *rgb = scene_pixels(&s, &camera);
        int64_t terrain_pixels;
        int cracks = watertight_cracks(&s, rgb, &camera, &options.frame, &terrain_pixels);
        t->terrain_pixels += terrain_pixels;
        if (cracks && f == SOUND)
            printf("view %d: %d cracks: x %.17g y %.17g z %.17g heading %.17g pitch %.17g fov %.17g lagging %d "
                   "throttle %.17g error %.17g\n",
                   v, cracks, camera.x, camera.y, camera.z, camera.heading, camera.pitch, camera.fov, lagging,
                   options.frame.throttle, options.frame.error);
        free(rgb);
        t->views++;
        t->cracks += cracks;
    }
    scene_destroy(&s);
}

static void run(const tc_context *context, const tc_field *p, int n, int views, bool lagging, fault f, uint64_t seed,
                totals *t)
{
    run_drawn(context, p, n, views, lagging, DISTANCE, f, seed, t);
}

static void tell(const char *what, const totals *t)
{
    printf(
        "watertight%s: %d views (%d more from below a lagging surface not counted), %lld terrain pixels, %d cracks\n",
        what, t->views, t->below_surface, (long long)t->terrain_pixels, t->cracks);
}

static tc_context *context;
static tc_field *terrain[TERRAINS];

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < TERRAINS; k++)
        terrain[k] = terrain_synthesised(terrain_field(made[k].kind, made[k].width, made[k].height, SPACING, 7),
                                         made[k].synthesised);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < TERRAINS; k++)
        tc_field_destroy(terrain[k]);
    tc_context_destroy(context);
    return 0;
}

static void no_background_shows_through(void **state)
{
    (void)state;
    totals t = {0};
    for (int k = 0; k < TERRAINS; k++) {
        run(context, terrain[k], 63, sweep_of(220), false, SOUND, 10 + (uint64_t)k, &t);
        run(context, terrain[k], 63, sweep_of(220), true, SOUND, 20 + (uint64_t)k, &t);
        run(context, terrain[k], 31, sweep_of(100), true, SOUND, 30 + (uint64_t)k, &t);
        run(context, terrain[k], 255, sweep_of(40), (k & 1) != 0, SOUND, 40 + (uint64_t)k, &t);
    }
    tell("", &t);
    assert_true(t.views >= sweep_of(2000));
    assert_int_equal(t.cracks, 0);
}

static void nor_where_frames_are_throttled(void **state)
{
    (void)state;
    totals t = {0};
    for (int k = 0; k < TERRAINS; k++) {
        run_drawn(context, terrain[k], 63, sweep_of(120), (k & 1) != 0, THROTTLED, SOUND, 70 + (uint64_t)k, &t);
        run_drawn(context, terrain[k], 127, sweep_of(80), (k & 1) == 0, THROTTLED, SOUND, 80 + (uint64_t)k, &t);
        run_drawn(context, terrain[k], 255, sweep_of(20), false, THROTTLED, SOUND, 90 + (uint64_t)k, &t);
    }
    tell(": throttled", &t);
    assert_true(t.views >= sweep_of(800));
    assert_int_equal(t.cracks, 0);
    totals open = {0};
    for (int k = 0; k < TERRAINS; k++)
        run_drawn(context, terrain[k], 63, sweep_whole() ? 40 : 20, false, THROTTLED, NO_STITCH, 95 + (uint64_t)k,
                  &open);
    printf("watertight: throttled, no stitching: %d cracks in %d views\n", open.cracks, open.views);
    assert_true(open.cracks > 100);
}

/* Blocks chosen by their error; by tolerances of a tenth of a pixel to twenty. */
static void nor_where_a_tolerance_is_set(void **state)
{
    (void)state;
    totals t = {0}, open = {0}, lists = {0};
    for (int k = 0; k < TERRAINS; k++) {
        run_drawn(context, terrain[k], 127, sweep_of(100), false, TOLERANCE, SOUND, 100 + (uint64_t)k, &t);
        run_drawn(context, terrain[k], 127, sweep_of(100), true, TOLERANCE, SOUND, 110 + (uint64_t)k, &t);
        run_drawn(context, terrain[k], 255, sweep_of(40), (k & 1) != 0, TOLERANCE, SOUND, 120 + (uint64_t)k, &t);
        run_drawn(context, terrain[k], 127, sweep_of(40), (k & 1) == 0, TOLERANCE | THROTTLED, SOUND, 130 + (uint64_t)k,
                  &t);
    }
    tell(": by tolerances", &t);
    assert_true(t.views >= sweep_of(1200));
    assert_int_equal(t.cracks, 0);
    for (int k = 0; k < TERRAINS; k++) {
        run_drawn(context, terrain[k], 127, sweep_whole() ? 40 : 12, k & 1, TOLERANCE, NO_STITCH, 140 + (uint64_t)k,
                  &open);
        run_drawn(context, terrain[k], 127, sweep_whole() ? 60 : 20, false, TOLERANCE, NO_CLOSERS, 150 + (uint64_t)k,
                  &lists);
    }
    printf("watertight: by tolerances, no stitching: %d cracks in %d views; open T-junctions alone: %d in %d\n",
           open.cracks, open.views, lists.cracks, lists.views);
    assert_true(open.cracks > 100);
}

/* Open T-junctions are as wide as rounding makes them: now and then a pixel. Edges of levels that are not brought
 * together are open wide. */
static void the_test_finds_cracks(void **state)
{
    (void)state;
    for (int k = 0; k < DATA; k++) {
        totals t = {0};
        run(context, terrain[k], 63, 60, k & 1, NO_STITCH, 50 + (uint64_t)k, &t);
        printf("watertight: no stitching: %d cracks in %d views of %s\n", t.cracks, t.views,
               made[k].kind == TERRAIN_CLIFF    ? "cliffs"
               : made[k].kind == TERRAIN_SMOOTH ? "smooth hills"
                                                : "the default terrain");
        assert_true(t.cracks > (made[k].kind == TERRAIN_SMOOTH ? 0 : 100));
    }
    totals t = {0};
    for (int k = 0; k < DATA; k++)
        run(context, terrain[k], 63, sweep_whole() ? 150 : 75, false, NO_CLOSERS, 60 + (uint64_t)k, &t);
    printf("watertight: open T-junctions alone: %d cracks in %d views\n", t.cracks, t.views);
    assert_true(t.cracks > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_background_shows_through),
        cmocka_unit_test(nor_where_frames_are_throttled),
        cmocka_unit_test(nor_where_a_tolerance_is_set),
        cmocka_unit_test(the_test_finds_cracks),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
