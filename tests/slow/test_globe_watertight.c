/* test_globe_watertight.c - no background shows through a planet, from any view.
 *
 * A planet is drawn in flat colours on magenta; globe_holes.c says what is found, and how. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "spherical/rings_internal.h"
#include "tests/support/globe_holes.h"
#include "tests/support/planet_scene.h"
#include "tests/support/sweep.h"

enum { PLANETS = 6, DATA = 3, FLAT = 4 };

static const struct {
    planet_kind kind;
    int width;
    double radius;
    int synthesised;   /* levels finer than the data; the first DATA planets are that alone */
    double flattening; /* from planet FLAT on; they are looked at less often */
} made[PLANETS] = {{PLANET_CLIFF, 1024, 400e3, 0, 0},
                   {PLANET_SMOOTH, 512, 1737400, 0, 0},
                   {PLANET_DEFAULT, 512, 6371000, 0, 0},
                   {PLANET_DEFAULT, 512, 6371000, 8, 0},
                   {PLANET_CLIFF, 512, 6378137, 0, WGS84_FLATTENING},
                   {PLANET_CLIFF, 512, 400e3, 0, 0.1}};

static tc_context *context;
static tc_map *planet[PLANETS];

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < PLANETS; k++) {
        tc_map *round = planet_made(made[k].kind, made[k].width, made[k].radius, 5);
        planet[k] = planet_flattened(planet_synthesised(round, made[k].synthesised), made[k].flattening);
    }
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < PLANETS; k++)
        tc_map_destroy(planet[k]);
    tc_context_destroy(context);
    return 0;
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

/* What is left open, for the test to find. */
typedef enum fault { SOUND, DRAW_MISSING, TRIANGLE_MISSING, MERIDIAN_OPEN, DISC_SMALL } fault;
static const char *const fault_name[] = {"sound", "a draw left out", "a triangle of each sector left out",
                                         "columns 0 and n_phi apart", "the disc a tenth smaller than its hole"};

typedef struct totals {
    int views, below_surface, too_low, holes, cracks, suspects, views_open;
    int64_t terrain_pixels, sure_pixels; /* sure: surely terrain */
} totals;

static void (*sound_draws)(const tc_view *, const tc_layers *, tc_frame *);

static void all_draws_but_one(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    sound_draws(view, layers, frame);
    if (frame->strip_draws > 0)
        frame->draws[frame->strip_draws / 2].count = 0;
}

static void break_surface(rings_surface *s, fault f)
{
    rings_geometry *g = &s->geometry;
    float(*v)[4] = s->head.geometry.vertices;
    if (f == DRAW_MISSING) {
        sound_draws = s->head.draws;
        s->head.draws = all_draws_but_one;
    }
    for (int k = 0; f == TRIANGLE_MISSING && k < g->sectors; k++)
        tc_set_index(
            &s->head.geometry, g->ring_strips[0][0].first + (uint32_t)k * g->ring_strips[0][0].count + 4,
            tc_index(&s->head.geometry, g->ring_strips[0][0].first + (uint32_t)k * g->ring_strips[0][0].count + 3));
    for (int r = 0; f == MERIDIAN_OPEN && r <= g->levels * g->m; r++)
        v[r * g->stride + g->n_phi][1] -= 0.02f * v[r * g->stride + g->n_phi][0];
    for (int i = 0; f == DISC_SMALL && i < g->levels; i++)
        for (int k = 0; k <= g->n_phi; k++)
            for (int a = 0; a < 2; a++)
                v[tc_rings_fill_base(g, i) + k][a] *= 0.9f;
}

static void look(scene *s, const tc_camera *c, const tc_frame_options *options, bool lagging, fault f, int view,
                 totals *t)
{
    double z;
    if (scene_height(s, c, options, c->x, c->y, &z) && z >= c->z) {
        t->below_surface++; /* a level that lags, or a coarser one, may stand higher than the eye */
        t->too_low += !lagging && options->throttle <= 0;
        return;
    }
    const globe_mesh mesh = globe_mesh_of_rings(s->surface, options);
    globe_holes h = globe_holes_of(s, &mesh, c, options, f == SOUND ? INT64_MAX : 300);
    t->terrain_pixels += h.terrain, t->sure_pixels += h.sure, t->suspects += (int)h.suspects;
    if ((h.holes || h.cracks) && f == SOUND)
        printf("view %d: %d holes, %d cracks: lon %.17g lat %.17g z %.17g heading %.17g pitch %.17g fov %.17g throttle "
               "%.17g\n",
               view, (int)h.holes, (int)h.cracks, c->x, c->y, c->z, c->heading, c->pitch, c->fov, options->throttle);
    t->views++, t->holes += (int)h.holes, t->cracks += (int)h.cracks, t->views_open += h.holes + h.cracks > 0;
}

static void run_throttled(int k, const tc_rings_options *rings, int views, bool lagging, bool throttled, fault f,
                          uint64_t seed, totals *t)
{
    tc_scene_options options = {
        .unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1, .throttle = throttled};
    tc_surface *surface = planet_rings(planet[k], rings, &options);
    break_surface((rings_surface *)surface, f);
    scene s = planet_scene_of(context, planet[k], surface, &options);
    int64_t n = tc_clipmap_n(s.clipmap);
    test_random r = {seed};
    for (int v = 0; v < views; v++) {
        tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
        if (throttled) {
            options.frame.throttle = test_random_range(&r, 0, s.surface->most_throttle);
            options.frame.no_morph = v % 8 == 7;
            tc_renderer_set_options(s.renderer, &options);
        }
        if (lagging) {
            options.budget = test_random_int(&r, n, n * n);
            tc_renderer_set_options(s.renderer, &options);
            for (int64_t frames = test_random_int(&r, 0, 2); frames > 0; frames--)
                scene_draw(&s, &c, false);
        }
        scene_draw(&s, &c, !lagging);
        look(&s, &c, &options.frame, lagging, f, v, t);
    }
    scene_destroy(&s);
}

static void run(int k, const tc_rings_options *rings, int views, bool lagging, fault f, uint64_t seed, totals *t)
{
    run_throttled(k, rings, views, lagging, false, f, seed, t);
}

static const tc_rings_options sizes[3] = {{.n_phi = 128, .m = 8}, {.n_phi = 64, .m = 4}, {.n_phi = 512, .m = 20}};

static void no_background_shows_through(void **state)
{
    (void)state;
    totals t = {0};
    for (int k = 0; k < PLANETS; k++) {
        const int part = k < FLAT ? 1 : 3;
        run(k, &sizes[0], sweep_of(300) / part, false, SOUND, 10 + (uint64_t)k, &t);
        run(k, &sizes[0], sweep_of(220) / part, true, SOUND, 20 + (uint64_t)k, &t);
        run(k, &sizes[1], sweep_of(120) / part, (k & 1) != 0, SOUND, 30 + (uint64_t)k, &t);
        run(k, &sizes[2], sweep_of(60) / part, (k & 1) == 0, SOUND, 40 + (uint64_t)k, &t);
    }
    printf(
        "globe watertight: %d views (%d more from below a lagging surface not counted), %lld terrain pixels, %.2f of "
        "them surely so, %d suspects, %d holes, %d cracks\n",
        t.views, t.below_surface, (long long)t.terrain_pixels, (double)t.sure_pixels / (double)t.terrain_pixels,
        t.suspects, t.holes, t.cracks);
    assert_true(t.views >= sweep_of(2000));
    assert_int_equal(t.too_low, 0);
    assert_int_equal(t.holes + t.cracks, 0);
    assert_true((double)t.sure_pixels > 0.85 * (double)t.terrain_pixels);
}

static void nor_where_frames_are_throttled(void **state)
{
    (void)state;
    static const tc_rings_options odd = {.n_phi = 96, .m = 6}; /* six columns a sector, discs of three rows */
    totals t = {0};
    for (int k = 0; k < PLANETS; k++) {
        const int part = k < FLAT ? 1 : 3;
        run_throttled(k, &sizes[0], sweep_of(150) / part, (k & 1) != 0, true, SOUND, 70 + (uint64_t)k, &t);
        run_throttled(k, &odd, sweep_of(100) / part, (k & 1) == 0, true, SOUND, 80 + (uint64_t)k, &t);
        run_throttled(k, &sizes[2], sweep_of(50) / part, false, true, SOUND, 90 + (uint64_t)k, &t);
    }
    printf(
        "globe watertight: throttled: %d views (%d more from below the surface not counted), %lld terrain pixels, %.2f "
        "of them surely so, %d suspects, %d holes, %d cracks\n",
        t.views, t.below_surface, (long long)t.terrain_pixels, (double)t.sure_pixels / (double)t.terrain_pixels,
        t.suspects, t.holes, t.cracks);
    assert_true(t.views >= sweep_of(800));
    assert_int_equal(t.too_low, 0);
    assert_int_equal(t.holes + t.cracks, 0);
    assert_true((double)t.sure_pixels > 0.6 * (double)t.terrain_pixels);
}

static void the_test_finds_holes(void **state)
{
    (void)state;
    const int views = sweep_whole() ? 60 : 20;
    for (int f = DRAW_MISSING; f <= DISC_SMALL; f++) {
        totals t = {0};
        for (int k = 0; k < DATA; k++)
            run(k, &sizes[0], views, false, (fault)f, 50 + (uint64_t)k, &t);
        const int round_open = t.views_open;
        run(FLAT, &sizes[0], views / 2, false, (fault)f, 50, &t);
        assert_true(t.views_open > round_open);
        printf("globe watertight: %s: %d holes and %d cracks in %d of %d views\n", fault_name[f], t.holes, t.cracks,
               t.views_open, t.views);
        assert_true(t.holes > 20);
        /* What is open next to the horizon, where no pixel is surely the planet's. */
        assert_true(t.cracks > 20 || (f != DRAW_MISSING && f != TRIANGLE_MISSING));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_background_shows_through),
        cmocka_unit_test(nor_where_frames_are_throttled),
        cmocka_unit_test(the_test_finds_holes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
