/* extreme_motion.c - viewers that move as no viewer should: the windows follow.
 *
 * After every update: LH04's four constraints (regions.h), windows around the viewer, no more samples than the budget.
 * After some, and at the end:
 * every height held is the pyramid's; at the end also morph targets and normals, and the picture is the one that a
 * scene which never was elsewhere draws. All of these are exact, so limits are 0. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "planar/square_internal.h"
#include "tests/support/computed.h"
#include "tests/support/extreme.h"
#include "tests/support/regions.h"
#include "tests/support/scene.h"

enum { WIDTH = 160, HEIGHT = 120 };

static tc_context *context;

/* A clipmap on its way, and what was found. */
typedef struct journey {
    const char *name;
    const tc_field *field;
    scene scene; /* whose clipmap it is where there is a context */
    tc_clipmap *clipmap;
    int64_t budget;
    tc_rect wanted[TC_MAX_LEVELS];
    int64_t updates, samples, most; /* samples: all; most: of one update */
    int64_t constraints, contents;  /* updates after which something was broken */
    int64_t astray;                 /* after which a window was wanted that is not around the viewer */
    char first[200];                /* what was broken first */
} journey;

static const tc_scene_options lit = {.background_set = true};

static journey journey_start(const char *name, const tc_field *p, int n, int64_t budget)
{
    journey j = {.name = name, .field = p, .budget = budget};
    if (context) {
        j.scene = scene_create(context, p, n, &lit);
        j.clipmap = j.scene.clipmap;
    } else if (tc_ground_create(p, &(tc_ground_options){.n = n, .normals = true}, &j.clipmap, NULL)) {
        exit(99);
    }
    return j;
}

static void broken(journey *j, const char *what, int64_t *count)
{
    if (!what)
        return;
    if (!j->constraints && !j->contents && !j->astray)
        snprintf(j->first, sizeof j->first, "first after update %lld: %s", (long long)j->updates, what);
    ++*count;
}

/* Whether a window is wanted that is not around the viewer: more than the snapping off, away from the terrain's ends.
 */
static const char *window_astray(const journey *j, const tc_camera *camera)
{
    static char said[100];
    double ground = 0;
    tc_field_height(j->field, camera->x, camera->y, &ground);
    double height = fabs(camera->z - tc_field_info(j->field)->z_base - ground);
    for (int l = 2; l <= tc_clipmap_levels(j->clipmap); l++) {
        const tc_clip_level *v = tc_clipmap_level(j->clipmap, l);
        double at[2] = {camera->x / v->spacing_x, camera->y / v->spacing_y}, n = tc_clipmap_n(j->clipmap);
        bool inside = at[0] > n && at[1] > n && at[0] < (double)v->extent.x1 - n && at[1] < (double)v->extent.y1 - n;
        tc_rect w = j->wanted[l - 1];
        if (!inside || (tc_rect_empty(w) && height > 0.4 * n * v->spacing_x))
            continue;
        double off_x = fabs(0.5 * (double)(w.x0 + w.x1 - 1) - at[0]);
        double off_y = fabs(0.5 * (double)(w.y0 + w.y1 - 1) - at[1]);
        snprintf(said, sizeof said, "window of level %d: %g x %g samples from the viewer", l, off_x, off_y);
        if (off_x > 2 || off_y > 2)
            return said;
    }
    return NULL;
}

static void move_to(journey *j, const tc_camera *camera, bool look_at_heights)
{
    square_viewer viewer = tc_square_viewer(j->clipmap, camera, true);
    tc_square_wanted(j->clipmap, tc_clipmap_n(j->clipmap), &viewer, j->wanted);
    int64_t samples = tc_clipmap_update(j->clipmap, j->wanted, j->budget, true, 0);
    j->updates++, j->samples += samples, j->most = tc_max64(j->most, samples);
    broken(j, window_astray(j, camera), &j->astray);
    broken(j, regions_broken(j->clipmap), &j->constraints);
    if (look_at_heights)
        broken(j, heights_broken(j->clipmap), &j->contents);
}

/* Pixels that a scene which was nowhere else draws otherwise. */
static int64_t pixels_differ(journey *j, const tc_camera *camera)
{
    scene fresh = scene_create(context, j->field, tc_clipmap_n(j->clipmap), &lit);
    scene_draw(&j->scene, camera, true);
    scene_draw(&fresh, camera, true);
    uint8_t *a = scene_pixels(&j->scene, camera), *b = scene_pixels(&fresh, camera);
    int64_t differ = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        differ += memcmp(a + 3 * i, b + 3 * i, 3) != 0;
    free(a), free(b);
    scene_destroy(&fresh);
    return differ;
}

/* Stands still until all is there, and tells. step: rows of each level whose whole content is looked at. */
static void journey_end(journey *j, const tc_camera *camera, int step)
{
    int more = 0;
    for (; !tc_clipmap_resident(j->clipmap) && more < 10000; more++)
        move_to(j, camera, false);
    for (int level = 1; level <= tc_clipmap_levels(j->clipmap); level++)
        broken(j, content_broken(j->clipmap, level, 0, step), &j->contents);
    broken(j, heights_broken(j->clipmap), &j->contents);
    extreme_at_most(j->name, "constraints broken, updates", (double)j->constraints, 0, "of %lld; %lld samples%s%s",
                    (long long)j->updates, (long long)j->samples, *j->first ? "; " : "", j->first);
    extreme_at_most(j->name, "windows not around the viewer, updates", (double)j->astray, 0, "of %lld",
                    (long long)j->updates);
    extreme_at_most(j->name, "windows that differ from the pyramid", (double)j->contents, 0, "%d levels, n %d",
                    tc_clipmap_levels(j->clipmap), tc_clipmap_n(j->clipmap));
    if (j->budget >= 0)
        extreme_at_most(j->name, "samples an update", (double)j->most, (double)j->budget, "its budget");
    /* Each update fills what the budget allows, but for a row's rest on each side of each level. */
    double whole = (double)tc_clipmap_levels(j->clipmap) * tc_clipmap_n(j->clipmap) * tc_clipmap_n(j->clipmap);
    if (j->budget >= 0)
        extreme_at_most(j->name, "updates until all is there", more, 2 * whole / (double)j->budget + 2,
                        "standing still");
    if (context) {
        extreme_at_most(j->name, "pixels unlike those of a new scene", (double)pixels_differ(j, camera), 0, "of %d",
                        WIDTH * HEIGHT);
        scene_destroy(&j->scene);
    } else {
        extreme_skipped(j->name, "picture: no OpenGL context");
        tc_clipmap_destroy(j->clipmap);
    }
}

static tc_camera standing(const tc_field *p, double x, double y, double above)
{
    tc_camera c = {.x = x, .y = y, .heading = 0.5, .pitch = -0.3, .fov = 1.2, .width = WIDTH, .height = HEIGHT};
    tc_field_height(p, x, y, &c.z);
    c.z += above;
    return c;
}

/* ---- Journeys --------------------------------------------------------------------------------------------------- */

static void teleports(void)
{
    enum { JUMPS = 400, N = 63 };
    /* seen: of how many updates each all heights are looked at, which takes long where they are made anew for that. */
    static const struct {
        const char *name;
        terrain_kind kind;
        int size, spacing, synthesised;
        int64_t budget;
        int seen;
    } way[] = {{"teleports", TERRAIN_CLIFF, 1025, 30, 0, N * N, 1},
               {"teleports, a budget of n", TERRAIN_CLIFF, 1025, 30, 0, N, 1},
               {"teleports, synthesised", TERRAIN_DEFAULT, 129, 240, 8, N * N, 10}};
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        tc_field *p = terrain_synthesised(terrain_field(way[k].kind, way[k].size, way[k].size, way[k].spacing, 5),
                                          way[k].synthesised);
        journey j = journey_start(way[k].name, p, N, way[k].budget);
        test_random r = {41};
        double extent = (way[k].size - 1) * way[k].spacing;
        tc_camera c = standing(p, 0, 0, 20);
        for (int i = 0; i < JUMPS; i++) {
            double far = i % 10 == 9 ? pow(10, test_random_range(&r, 3, 12)) : extent; /* now and then out of sight */
            c = standing(p, test_random_unit(&r) * far, test_random_unit(&r) * far,
                         pow(10, test_random_range(&r, 0, 5)));
            for (int64_t stay = test_random_int(&r, 1, 4); stay > 0; stay--)
                move_to(&j, &c, j.updates % way[k].seen == 0);
        }
        c = standing(p, 0.37 * extent, 0.61 * extent, 20);
        journey_end(&j, &c, 7);
        tc_field_destroy(p);
    }
}

/* 100 km/s at 60 frames a second, 20 m above the ground. */
static void speed(void)
{
    enum { FRAMES = 1800, SPACING = 30 };
    tc_field *p = computed_field(INT64_C(1) << 20, INT64_C(1) << 20, SPACING, 100);
    journey j = journey_start("100,000 m/s", p, 63, 63 * 63);
    tc_camera c = standing(p, 1e6, 2e6, 20);
    for (int i = 0; i < FRAMES; i++) {
        c = standing(p, c.x + 1e5 / 60 * cos(0.3), c.y + 1e5 / 60 * sin(0.3), 20);
        move_to(&j, &c, i % 20 == 0);
    }
    journey_end(&j, &c, 9);
    tc_field_destroy(p);
}

/* Slowly across 2^31, 2^32 and 2^33 samples, and with leaps of all sizes in between. */
static void far(void)
{
    const double spacing = 0.5;
    tc_field *p = computed_field(INT64_C(3) << 32, INT64_C(3) << 32, spacing, 100);
    journey j = journey_start("2^33 samples in one direction", p, 63, 63 * 63);
    double x = 1000, y = 1000;
    tc_camera c = standing(p, x * spacing, y * spacing, 5);
    for (int k = 10; k <= 33; k++) {
        double boundary = ldexp(1, k), from = x;
        for (int i = 0; i <= 40; i++) { /* up to 60 samples before it, each step with another stride */
            x = from + (boundary - 60 - from) * (i / 40.0) * (i / 40.0), y = 0.9 * x;
            c = standing(p, x * spacing, y * spacing, 5);
            move_to(&j, &c, i % 10 == 0);
        }
        for (; x < boundary + 60; x += 0.7, y += 0.3) {
            c = standing(p, x * spacing, y * spacing, 5);
            move_to(&j, &c, k >= 30 && fabs(x - boundary) < 4);
        }
    }
    extreme_at_most(j.name, "samples short of 2^33", ldexp(1, 33) - x, 0, "%.0f samples of the finest level", x);
    journey_end(&j, &c, 9);
    tc_field_destroy(p);
}

/* A random walk of steps below a sample, with its direction kept for a while: 1e6 updates. */
static void long_walk(void)
{
    enum { SIZE = 1025, SPACING = 30, UPDATES = 1000000, N = 15 };
    tc_field *p = terrain_field(TERRAIN_CLIFF, SIZE, SIZE, SPACING, 6);
    journey j = journey_start("1,000,000 small moves", p, N, N * N);
    test_random r = {51};
    double extent = (SIZE - 1) * SPACING, heading = 0;
    tc_camera c = standing(p, 0.5 * extent, 0.5 * extent, 5);
    for (int i = 0; i < UPDATES; i++) {
        if (i % 64 == 0)
            heading = test_random_range(&r, 0, 2 * M_PI);
        double step = 0.7 * SPACING;
        c.x = fmin(fmax(c.x + step * cos(heading), -3 * SPACING), extent + 3 * SPACING);
        c.y = fmin(fmax(c.y + step * sin(heading), -3 * SPACING), extent + 3 * SPACING);
        if (i % 64 == 0) {
            tc_field_height(p, c.x, c.y, &c.z);
            c.z += 5;
        }
        move_to(&j, &c, i % 5000 == 0);
    }
    journey_end(&j, &c, 1);
    tc_field_destroy(p);
}

/* ---- Oscillation ------------------------------------------------------------------------------------------------ */

/* Most that drawn heights change, between frames, at places in and around a level's window. */
static double largest_jump(const tc_clipmap *clipmap, const tc_camera *before, const tc_camera *after,
                           const tc_frame_options *options, double spacing, double *heights, bool first)
{
    enum { ACROSS = 24 };
    square_viewer viewer = tc_square_viewer(clipmap, after, true);
    double most = 0, side = 1.3 * tc_clipmap_n(clipmap) * spacing;
    for (int k = 0; k < ACROSS * ACROSS; k++) {
        double x = before->x + side * ((k % ACROSS + 0.37) / ACROSS - 0.5), z;
        double y = before->y + side * ((k / ACROSS + 0.41) / ACROSS - 0.5);
        if (!tc_square_height(clipmap, &viewer, options, x, y, &z))
            z = NAN;
        if (!first && !(isnan(z) && isnan(heights[k])))
            most = fmax(most, isnan(z) || isnan(heights[k]) ? INFINITY : fabs(z - heights[k]));
        heights[k] = z;
    }
    return most;
}

/* To and fro across the lines where windows snap, a millionth of a sample either way: on each level, where it alone
 * snaps and all finer ones with it. */
static double oscillate(journey *j, const tc_frame_options *options, double extent, double spacing)
{
    enum { TIMES = 12 };
    double jump = 0, heights[600];
    int64_t crossing = 0;
    tc_camera c = {0};
    for (int level = 2; level <= tc_clipmap_levels(j->clipmap); level++) {
        const tc_clip_level *l = tc_clipmap_level(j->clipmap, level);
        int64_t n = tc_clipmap_n(j->clipmap);
        /* window_start() in square_morph.c leaps where the viewer is (n - 1) / 2 - 1 beyond an even sample. */
        double line = ((double)((n - 1) / 2 - 1) + 2 * floor(0.5 * extent / l->spacing_x / 2)) * l->spacing_x;
        line -= line > 0.9 * extent ? 2 * l->spacing_x : 0;
        for (int axes = 1; axes <= 3; axes++) {
            tc_camera before =
                standing(j->field, axes & 1 ? line : line + 0.3 * spacing, axes & 2 ? line : line + 0.3 * spacing, 5);
            for (int i = 0; i < TIMES; i++) {
                double off = (i & 1 ? 1e-6 : -1e-6) * spacing;
                c = before;
                c.x += axes & 1 ? off : 0, c.y += axes & 2 ? off : 0;
                if (i == 1) /* what came before was the way there */
                    j->most = crossing;
                move_to(j, &c, true);
                jump = fmax(jump, largest_jump(j->clipmap, &before, &c, options, l->spacing_x, heights, i == 0));
            }
            crossing = j->most;
        }
    }
    return jump;
}

static void oscillation(void)
{
    enum { SIZE = 1025, SPACING = 30, N = 63 };
    tc_field *p = terrain_field(TERRAIN_CLIFF, SIZE, SIZE, SPACING, 8);
    double extent = (SIZE - 1) * SPACING;
    const tc_frame_options morphing = {0}, abrupt = {.no_morph = true};
    journey j = journey_start("to and fro across snapping lines", p, N, -1);
    double jump = oscillate(&j, &morphing, extent, SPACING);
    /* Walls of 4,000 m pass into each other over n / 10 cells: 4000 m / (6 cells) x 2e-6 cells. */
    extreme_at_most(j.name, "largest leap of drawn heights, m", jump, 0.01, "walls of 4,000 m");
    double found = oscillate(&j, &abrupt, extent, SPACING);
    extreme_at_most(j.name, "1 m over the leap without morph", 1 / found, 1, "so leaps are found: %.0f m", found);
    /* Two rows and two columns of each level but the first. */
    extreme_at_most(j.name, "samples a crossing", (double)j.most, (tc_clipmap_levels(j.clipmap) - 1) * 4.0 * N,
                    "nothing else is read again");
    tc_camera c = standing(p, 0.5 * extent, 0.5 * extent, 5);
    move_to(&j, &c, true);
    journey_end(&j, &c, 7);
    tc_field_destroy(p);
}

int main(void)
{
    extreme_begin("motion");
    context = scene_context();
    teleports();
    speed();
    far();
    oscillation();
    long_walk();
    tc_context_destroy(context);
    return extreme_end();
}
