/* test_faces_watertight.c - no background shows through a planet drawn by hexagons or by a cube's chunks, from any
 * view.
 *
 * As test_globe_watertight.c has it; and holes are found where vertices on a seam are worked out by the formulas of
 * whichever chart draws them, where T-junctions are left open, and where a block is missing. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "spherical/faces_internal.h"
#include "spherical/globe.h"
#include "tests/support/globe_holes.h"
#include "tests/support/planet_scene.h"
#include "tests/support/sweep.h"

enum { PLANETS = 3, KINDS = 3 };
static const struct {
    planet_kind kind;
    int width;
    double radius, flattening;
} made[PLANETS] = {{PLANET_CLIFF, 1088, 400e3, 0},
                   {PLANET_SMOOTH, 2048, 1737400, 0},
                   {PLANET_DEFAULT, 1024, 6378137, 1 / 298.257223563}};
static const faces_kind *const kinds[KINDS] = {&tc_faces_hex, &tc_faces_cube, &tc_faces_cube_pt};

static tc_context *context;
static tc_map *planet[KINDS][PLANETS]; /* of the last kind the same as of the one before */

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int t = 0; t < 2; t++)
        for (int k = 0; k < PLANETS; k++) {
            planet[t][k] =
                planet_of_faces(planet_made(made[k].kind, made[k].width, made[k].radius, 5), kinds[t]->chart);
            planet[t][k]->body = tc_body_flattened(made[k].radius, made[k].flattening);
        }
    memcpy(planet[2], planet[1], sizeof planet[1]);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < 2 * PLANETS; k++)
        tc_map_destroy(planet[k / PLANETS][k % PLANETS]);
    tc_context_destroy(context);
    return 0;
}

/* What is left open, for the test to find. */
typedef enum fault { SOUND, EDGES_OPEN, DRAW_MISSING } fault;
static const char *const fault_name[] = {"sound", "edges of levels apart", "a draw left out"};

typedef struct totals {
    int views, below_surface, too_low, missing, holes, cracks, suspects, views_open;
    int64_t terrain_pixels, sure_pixels; /* sure: surely terrain */
} totals;

static void (*sound_draws)(const tc_view *, const tc_layers *, tc_frame *);

static void all_draws_but_one(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    sound_draws(view, layers, frame);
    if (frame->strip_draws > 0)
        frame->draws[frame->strip_draws / 2].count = 0;
}

static void break_surface(faces_surface *s, fault f)
{
    if (f == DRAW_MISSING) {
        sound_draws = s->head.draws;
        s->head.draws = all_draws_but_one;
    }
}

/* What frames are drawn by. */
enum { DISTANCE = 0, THROTTLED = 1, TOLERANCE = 2 };

static void look(scene *s, const tc_camera *c, const tc_frame_options *options, bool lagging, fault f, int view,
                 totals *t)
{
    double z;
    if (scene_height(s, c, options, c->x, c->y, &z) && z >= c->z) {
        t->below_surface++; /* a level that lags, or a coarser one, may stand higher than the eye */
        /* Far from triangles' corners the height of the map is not quite that of what is drawn through them. */
        const faces_surface *faces = (const faces_surface *)s->surface;
        const double relief = faces->z_hi - faces->z_lo, slack = relief * relief / (2 * faces->map->body.radius);
        t->too_low += !lagging && options->throttle <= 0 && z - c->z > slack;
        return;
    }
    /* A tolerance may draw any level anywhere. */
    const globe_mesh mesh = globe_mesh_of_faces(s->surface, c, options, lagging || options->error > 0);
    globe_holes h = globe_holes_of(s, &mesh, c, options, lagging ? 0 : f == SOUND ? INT64_MAX : 40);
    t->terrain_pixels += h.terrain, t->sure_pixels += h.sure, t->suspects += (int)h.suspects;
    if ((h.holes || h.cracks) && f == SOUND)
        printf("%s, view %d: %d holes, %d cracks: lon %.17g lat %.17g z %.17g heading %.17g pitch %.17g fov %.17g "
               "throttle %.17g error %.17g\n",
               s->surface->name, view, (int)h.holes, (int)h.cracks, c->x, c->y, c->z, c->heading, c->pitch, c->fov,
               options->throttle, options->error);
    t->views++, t->holes += (int)h.holes, t->cracks += (int)h.cracks, t->views_open += h.holes + h.cracks > 0;
}

/* Next to seams and corners of charts, every other view. */
static void move_to_seams(tc_camera *c, test_random *r)
{
    const double quarter = M_PI / 4, beside = test_random_range(r, -1, 1) * exp(-test_random_range(r, 0, 20));
    c->x = quarter * (double)test_random_int(r, -4, 4) + beside;
    if (test_random_bits(r) & 1)
        c->y = (test_random_bits(r) & 1 ? atan(sqrt(0.5)) : 0) * (test_random_bits(r) & 1 ? 1 : -1) + beside;
}

static void run(int kind, int k, int n, int views, bool lagging, unsigned how, fault f, uint64_t seed, totals *t)
{
    const bool throttled = how & THROTTLED;
    tc_scene_options options = {.unlit = true,
                                .background_set = true,
                                .background = {255, 0, 255},
                                .budget = -1,
                                .throttle = throttled,
                                .frame.error = how & TOLERANCE ? 1 : 0};
    const tc_map *map = planet[kind][k];
    tc_surface *surface = planet_faces(map, kinds[kind], n, &options);
    break_surface((faces_surface *)surface, f);
    options.frame.no_stitch = f == EDGES_OPEN;
    scene s = planet_scene_of(context, map, surface, &options);
    test_random r = {seed};
    for (int v = 0; v < views; v++) {
        tc_camera c = planet_view(&r, map, 0.5, 5 * map->body.radius);
        if (v % 2) {
            double above = c.z, ground = 0;
            tc_map_height(map, c.x, c.y, &ground);
            above -= ground;
            move_to_seams(&c, &r);
            tc_map_height(map, c.x, c.y, &ground);
            c.z = ground + above;
        }
        if (throttled) {
            options.frame.throttle = test_random_range(&r, 0, s.surface->most_throttle);
            options.frame.no_morph = v % 8 == 7;
        }
        if (how & TOLERANCE)
            options.frame.error = 0.1 * pow(200, test_random_unit(&r));
        tc_renderer_set_options(s.renderer, &options);
        if (lagging) {
            options.budget = test_random_int(&r, n, (int64_t)n * n);
            tc_renderer_set_options(s.renderer, &options);
            for (int64_t frames = test_random_int(&r, 0, 2); frames > 0; frames--)
                scene_draw(&s, &c, false);
        }
        scene_draw(&s, &c, !lagging);
        t->missing += !lagging && !((const faces_view *)scene_look(&s, &c, &options.frame))->all;
        look(&s, &c, &options.frame, lagging, f, v, t);
    }
    scene_destroy(&s);
}

static void tell(const char *what, const totals *t)
{
    printf("%s: %d views (%d more from below the surface not counted), %lld terrain pixels, %.2f of them surely so, %d "
           "suspects, %d holes, %d cracks\n",
           what, t->views, t->below_surface, (long long)t->terrain_pixels,
           (double)t->sure_pixels / (double)t->terrain_pixels, t->suspects, t->holes, t->cracks);
}

static void no_background_shows_through(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        totals t = {0};
        const int share = kind == 2 ? 4 : 1; /* the same geometry as of the cube */
        for (int k = 0; k < PLANETS; k++) {
            run(kind, k, 127, sweep_of(320 / share), false, DISTANCE, SOUND, 10 + (uint64_t)k, &t);
            run(kind, k, 127, sweep_of(200 / share), true, DISTANCE, SOUND, 20 + (uint64_t)k, &t);
            run(kind, k, 255, sweep_of(100 / share), (k & 1) != 0, DISTANCE, SOUND, 30 + (uint64_t)k, &t);
            run(kind, k, 127, sweep_of(120 / share), (k & 1) == 0, THROTTLED, SOUND, 40 + (uint64_t)k, &t);
        }
        tell(kinds[kind]->name, &t);
        assert_true(t.views >= sweep_of(2000 / share));
        assert_int_equal(t.too_low + t.missing, 0);
        assert_int_equal(t.holes + t.cracks, 0);
        assert_true((double)t.sure_pixels > 0.6 * (double)t.terrain_pixels);
    }
}

/* Blocks chosen by their error; by tolerances of a tenth of a pixel to twenty; and what is left open is found. */
static void nor_where_a_tolerance_is_set(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        totals t = {0}, open = {0};
        for (int k = 0; k < PLANETS; k++) {
            run(kind, k, 127, sweep_of(100), false, TOLERANCE, SOUND, 60 + (uint64_t)k, &t);
            run(kind, k, 127, sweep_of(60), true, TOLERANCE, SOUND, 70 + (uint64_t)k, &t);
            run(kind, k, 255, sweep_of(40), (k & 1) != 0, TOLERANCE, SOUND, 80 + (uint64_t)k, &t);
            run(kind, k, 127, sweep_of(40), (k & 1) == 0, TOLERANCE | THROTTLED, SOUND, 90 + (uint64_t)k, &t);
        }
        printf("by tolerances: ");
        tell(kinds[kind]->name, &t);
        assert_true(t.views >= sweep_of(600));
        assert_int_equal(t.too_low + t.missing, 0);
        assert_int_equal(t.holes + t.cracks, 0);
        for (int k = 0; k < 2; k++)
            run(kind, k, 127, sweep_whole() ? 60 : 20, false, TOLERANCE, EDGES_OPEN, 100 + (uint64_t)k, &open);
        printf("%s, by tolerances: %s: %d holes and %d cracks in %d of %d views\n", kinds[kind]->name,
               fault_name[EDGES_OPEN], open.holes, open.cracks, open.views_open, open.views);
        assert_true(open.holes + open.cracks > 20);
    }
}

static void the_test_finds_holes(void **state)
{
    (void)state;
    const int views = sweep_whole() ? 60 : 30;
    for (int kind = 0; kind < 2; kind++)
        for (int f = EDGES_OPEN; f <= DRAW_MISSING; f++) {
            totals t = {0};
            for (int k = 0; k < 2; k++)
                run(kind, k, 127, views, false, DISTANCE, (fault)f, 50 + (uint64_t)k, &t);
            printf("%s: %s: %d holes and %d cracks in %d of %d views\n", kinds[kind]->name, fault_name[f], t.holes,
                   t.cracks, t.views_open, t.views);
            assert_true(t.holes + t.cracks > 20);
        }
}

/* Pixels of background in views through a telescope, from afar onto a seam, where there is none. settled: vertices
 * there are worked out by one chart's formulas. */
static int64_t background_at_seams(int kind, bool settled, int views)
{
    static const char *const open_seams[] = {"CLIMATE", TC_GLOBE_RELIEF_DEFINE, "UNSETTLED", NULL};
    const tc_scene_options options = {.unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1};
    const tc_map *map = planet[kind][0];
    tc_surface *surface = planet_faces(map, kinds[kind], 255, &options);
    if (!settled)
        surface->defines = open_seams;
    scene s = planet_scene_of(context, map, surface, &options);
    test_random r = {7};
    int64_t open = 0;
    for (int v = 0; v < views; v++) {
        /* Meridians at 90 k degrees are seams of hexagons, at 45 + 90 k of the cube's faces around the equator. */
        const double seam = (kind ? M_PI / 4 : 0) + M_PI / 2 * (double)test_random_int(&r, 0, 3),
                     radius = map->body.radius, away = test_random_range(&r, 0.1, 0.3);
        tc_camera c = {.x = seam - away, .fov = 4e-3, .width = 320, .height = 240, .heading = M_PI / 2};
        c.y = test_random_range(&r, -0.3, 0.3);
        c.z = radius * test_random_range(&r, 0.2, 1);
        double across = cos(c.y) * sin(away), up = 1 - cos(away) * cos(c.y) * cos(c.y) - sin(c.y) * sin(c.y);
        double north = sin(c.y) * cos(c.y) * (1 - cos(away));
        c.heading = atan2(across, north);
        c.pitch = -atan2(c.z + radius * up, radius * hypot(across, north));
        scene_draw(&s, &c, true);
        uint8_t *rgb = scene_pixels(&s, &c);
        for (int i = 0; i < c.width * c.height; i++)
            open += rgb[3 * i] == 255 && rgb[3 * i + 1] == 0 && rgb[3 * i + 2] == 255;
        free(rgb);
    }
    scene_destroy(&s);
    return open;
}

static void seams_are_closed_by_one_charts_formulas(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const int views = sweep_of(600);
        const int64_t closed = background_at_seams(kind, true, views), open = background_at_seams(kind, false, views);
        printf("%s: %d views of seams: %lld pixels of background; by either chart's formulas %lld\n", kinds[kind]->name,
               views, (long long)closed, (long long)open);
        assert_int_equal(closed, 0);
        assert_true(open > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_background_shows_through),
        cmocka_unit_test(nor_where_a_tolerance_is_set),
        cmocka_unit_test(the_test_finds_holes),
        cmocka_unit_test(seams_are_closed_by_one_charts_formulas),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
