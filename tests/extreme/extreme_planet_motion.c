/* extreme_planet_motion.c - 100,000 and more moves over a planet that no traveller would make: to and fro between
 * antipodes, at 100 km/s, over a pole again and again, across the antimeridian with every step and a thousand times
 * around. Whatever the way, windows hold what the pyramids hold, and what is drawn depends on where the viewer is, not
 * on how often the viewer has been around. */
#include "tests/support/extreme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/flight.h"
#include "common/view/navigation.h"
#include "spherical/rings_internal.h"
#include "tests/support/planet_scene.h"
#include "tests/support/regions.h"

static const double RADIUS = 6371000;
enum { WIDTH = 2048, FINER = 10 };

/* A planet's surface, and what has been seen of it. */
typedef struct journey {
    tc_surface *surface;
    tc_windows windows;
    tc_view *view;
    int checked; /* of so many updates one */
    int64_t updates, checks, samples, broken, not_finite;
    char first[240]; /* that was broken */
} journey;

static tc_surface *surface_of(const tc_map *atlas)
{
    return planet_rings(atlas, &(tc_rings_options){.n_phi = 128, .m = 8}, &(tc_scene_options){.unlit = true});
}

static journey journey_start(const tc_map *atlas)
{
    bool made = tc_field_info(atlas->chart[0].field)->synthesised > 0; /* and made anew for looking: that takes long */
    journey j = {.surface = surface_of(atlas), .checked = made ? 60 : 400};
    tc_error error;
    j.view = tc_view_allocate(j.surface);
    if (!j.view || j.surface->make_windows(j.surface, &j.windows, &error))
        exit(99);
    return j;
}

static void journey_end(journey *j)
{
    tc_windows_destroy(&j->windows);
    free(j->view);
    j->surface->destroy(j->surface);
}

static const rings_view *look_at(journey *j, const tc_camera *c)
{
    j->surface->look(j->surface, &j->windows, c, &(tc_frame_options){0}, true, j->view);
    return (const rings_view *)j->view;
}

static void look(journey *j, const char *broken)
{
    j->checks++;
    if (!broken)
        return;
    if (!j->broken)
        snprintf(j->first, sizeof j->first, "; update %lld: %s", (long long)j->updates, broken);
    j->broken++;
}

/* One frame's update, as the renderer makes it; now and then all that is held is looked at. */
static void move(journey *j, const tc_camera *c, int64_t budget)
{
    static tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    tc_surface *s = j->surface;
    look_at(j, c);
    s->wanted(j->view, wanted);
    for (int chart = 0; chart < j->windows.charts; chart++) {
        j->samples += tc_clipmap_update(j->windows.clipmap[chart], wanted[chart], budget, true, 0);
        const char *broken = regions_broken(j->windows.clipmap[chart]);
        look(j, broken);
        if (j->updates % j->checked == j->checked - 1)
            look(j, heights_broken(j->windows.clipmap[chart]));
    }
    j->updates++;
    double z;
    if (j->updates % j->checked == 0)
        j->not_finite += !s->height(j->view, c->x, c->y, &z) || !isfinite(z);
}

static void row(const char *name, const journey *j)
{
    extreme_at_most(name, "regions or heights not the pyramid's, updates", (double)(j->broken + j->not_finite), 0,
                    "%lld updates, %lld samples, all %lld heights and regions looked at%s", (long long)j->updates,
                    (long long)j->samples, (long long)j->checks, j->first);
}

static tc_camera camera_at(double longitude, double latitude, double z)
{
    return (tc_camera){.x = longitude, .y = latitude, .z = z, .pitch = -1, .fov = 1.3, .width = 1280, .height = 720};
}

/* ---- Ways -------------------------------------------------------------------------------------------------------- */

static void antipodes(const tc_map *atlas, int64_t budget, int times, const char *name)
{
    journey j = journey_start(atlas);
    test_random r = {11};
    for (int k = 0; k < times; k++) {
        double x = test_random_range(&r, -M_PI, M_PI), y = asin(test_random_range(&r, -1, 1)), z = 6000;
        z = k % 3 ? 6000 * pow(10, test_random_range(&r, 0, 4)) : z;
        tc_camera here = camera_at(x, y, z), there = camera_at(remainder(x + M_PI, 2 * M_PI), -y, z);
        for (int stay = k % 4; stay >= 0; stay--)
            move(&j, &here, budget);
        move(&j, &there, budget);
    }
    row(name, &j);
    journey_end(&j);
}

/* A great circle, `step` metres at a time, from the point where it is farthest north. */
static void great_circle(const tc_map *atlas, double north, double step, double z, int updates, const char *name)
{
    journey j = journey_start(atlas);
    int64_t n = j.surface->n;
    for (int k = 0; k < updates; k++) {
        double t = fmod(k * (step / RADIUS), 2 * M_PI), s = sin(t), c = cos(t);
        double p[3] = {c * cos(north), s, c * sin(north)};
        tc_camera at = camera_at(atan2(p[1], p[0]), atan2(p[2], hypot(p[0], p[1])), z);
        move(&j, &at, n * n);
    }
    row(name, &j);
    journey_end(&j);
}

static void over_a_pole(const tc_map *atlas, int updates, const char *name)
{
    journey j = journey_start(atlas);
    int64_t n = j.surface->n;
    test_random r = {12};
    for (int k = 0; k < updates;
         k++) { /* from one side to the other, on another meridian each time, often exactly on it */
        double way = 1e-3 * sin(0.37 * k) * pow(10, -(k % 12)), meridian = 0.001 * k;
        if (k % 97 == 0)
            way = 0;
        tc_camera c = camera_at(remainder(way < 0 ? meridian + M_PI : meridian, 2 * M_PI), M_PI / 2 - fabs(way), 6000);
        c.y = k / (updates / 5) % 2 ? -c.y : c.y;
        move(&j, &c, k % 5 ? n * n : test_random_int(&r, n, n * n));
    }
    row(name, &j);
    journey_end(&j);
}

static void antimeridian(const tc_map *atlas)
{
    journey j = journey_start(atlas);
    int64_t n = j.surface->n;
    for (int k = 0; k < 25000; k++) {
        double off = pow(10, -1 - k % 12), side = k & 1 ? 1 : -1;
        tc_camera c = camera_at(side * (M_PI - (k % 7 ? off : 0)), 0.9 * sin(0.001 * k), 6000 + 100 * (k % 50));
        move(&j, &c, n * n);
    }
    row("across the antimeridian with every step", &j);
    journey_end(&j);
}

/* ---- Around and around ------------------------------------------------------------------------------------------- */

/* What the viewer's column is on chart 0, and what is drawn around the viewer, of a surface that has been around and of
 * one that has not. */
static void compare(journey *been, const tc_map *atlas, const tc_camera *c, double *columns_ret, double *metres_ret)
{
    journey fresh = journey_start(atlas);
    move(&fresh, c, -1);
    const rings_view *a = look_at(been, c), *b = look_at(&fresh, c);
    *columns_ret = fmax(*columns_ret, fabs(remainder(a->place[0].x, WIDTH) - remainder(b->place[0].x, WIDTH)));
    for (int k = 0; k < 200; k++) {
        double x = c->x + 0.01 * cos(k), y = fmax(-M_PI / 2, fmin(M_PI / 2, c->y + 0.01 * sin(k))), za, zb;
        bool both = been->surface->height(been->view, x, y, &za) && fresh.surface->height(fresh.view, x, y, &zb);
        *metres_ret = fmax(*metres_ret, both ? fabs(za - zb) : INFINITY);
    }
    journey_end(&fresh);
}

static void thousand_turns(const tc_map *atlas, int direction)
{
    enum { TURNS = 1000, STEPS = 24, MOST = 18 };
    journey j = journey_start(atlas);
    double columns = 0, metres = 0, farthest = 0;
    for (int k = 0; k <= TURNS * STEPS; k++) {
        tc_camera c = camera_at(remainder(direction * 2 * M_PI * (k + 0.123) / STEPS, 2 * M_PI), 0.3, 60000);
        move(&j, &c, -1);
        farthest = fmax(farthest, fabs(look_at(&j, &c)->place[0].x) / WIDTH);
        if (k % (TURNS * STEPS / 40 - 1) == 0)
            compare(&j, atlas, &c, &columns, &metres);
    }
    const char *way = direction > 0 ? "east" : "west";
    char name[80];
    snprintf(name, sizeof name, "1000 times around to the %s: windows", way);
    row(name, &j);
    snprintf(name, sizeof name, "1000 times around to the %s: the column's number", way);
    extreme_at_most(name, "turns", farthest, MOST, "windows begin anew before it loses digits");
    snprintf(name, sizeof name, "1000 times around to the %s: drift", way);
    extreme_at_most(name, "columns off those of a viewer who has not been around", columns, 0, "in 41 places");
    snprintf(name, sizeof name, "1000 times around to the %s: heights", way);
    extreme_at_most(name, "drawn heights off those of a viewer who has not been around, metres", metres, 1e-6,
                    "200 in each of 41 places, in double");
    journey_end(&j);
}

/* One height of a window changed by a metre is found. */
static void spoiled(const tc_map *atlas)
{
    journey j = journey_start(atlas);
    tc_camera c = camera_at(3.1, -0.4, 6000);
    move(&j, &c, -1);
    const tc_clipmap *clipmap = j.windows.clipmap[0];
    int level = tc_clipmap_levels(clipmap), n = tc_clipmap_n(clipmap);
    tc_rect r = tc_clipmap_level(clipmap, level)->clip;
    float *z = (float *)tc_ground_heights(clipmap, level)[((r.y0 + r.y1) / 2 & n) * (n + 1) + ((r.x0 + r.x1) / 2 & n)];
    bool sound = !heights_broken(clipmap);
    *z += 1;
    extreme_at_most("a height of a window spoiled", "not found", !(sound && heights_broken(clipmap)), 0,
                    "%lld x %lld held", (long long)(r.x1 - r.x0), (long long)(r.y1 - r.y0));
    journey_end(&j);
}

static double flat_ground(void *context, double x, double y)
{
    (void)context, (void)x, (void)y;
    return 0;
}

/* A great circle flown with the keys, a thousand times around: back where it began. */
static void flown_around(double latitude, double heading, const char *name)
{
    enum { TURNS = 1000, STEPS = 64 };
    const double z = 1e6, angle = 2 * M_PI / STEPS;
    const tc_ground ground = {.height = flat_ground, .clearance = 2, .body = {&tc_sphere_body, RADIUS, 0}};
    tc_flight f = {.view = {.x = 0.5, .y = latitude, .z = z, .heading = heading},
                   .speed = angle * (RADIUS + z) / (0.1 * z)};
    double most = 0;
    for (int k = 0; k < TURNS * STEPS; k++) {
        tc_sphere_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &ground);
        most = fmax(most, isfinite(f.view.x) ? fabs(f.view.x) : INFINITY);
    }
    double across = remainder(f.view.x - 0.5, 2 * M_PI) * cos(latitude), along = f.view.y - latitude;
    extreme_at_most(name, "metres from where it began", hypot(across, along) * RADIUS, 1e-3,
                    "%d steps; heading turned by %.2g rad, longitude within %.6f", TURNS * STEPS,
                    remainder(f.view.heading - heading, 2 * M_PI), most);
}

int main(void)
{
    extreme_begin("planet_motion");
    tc_map *atlas = planet_made(PLANET_CLIFF, WIDTH, RADIUS, 7);

    antipodes(atlas, -1, 1500, "between antipodes, all at once");

    antipodes(atlas, 2000, 1500, "between antipodes, 2,000 samples a frame");

    great_circle(atlas, 1.0, 1e5 / 60, 6000, 24000, "100 km/s, 60 frames a second, near the ground");

    great_circle(atlas, M_PI / 2, 1e5 / 60, 6000, 24000, "100 km/s from pole to pole");

    over_a_pole(atlas, 25000, "over the poles and exactly on them");

    antimeridian(atlas);
    thousand_turns(atlas, 1);
    thousand_turns(atlas, -1);
    spoiled(atlas);
    flown_around(0, M_PI / 2, "flown 1000 times along the equator");
    flown_around(0.7, 0, "flown 1000 times over both poles");
    flown_around(0.7, 0.8, "flown 1000 times on a slanting circle");
    tc_map_destroy(atlas);

    atlas = planet_synthesised(planet_made(PLANET_DEFAULT, 1024, RADIUS, 7), FINER);
    antipodes(atlas, -1, 40, "between antipodes, synthesised");
    great_circle(atlas, 1.0, 1e5 / 60, 6000, 360, "100 km/s near the ground, synthesised");
    over_a_pole(atlas, 360, "over the poles and exactly on them, synthesised");
    tc_map_destroy(atlas);
    return extreme_end();
}
