/* extreme_cameras.c - views from places and with frames that nobody would choose: drawn, or refused in words.
 *
 * Limits. Cracks: none in what is seen. Numbers handed to OpenGL and put out by the vertex stage: all finite. Vertices
 * within the frame are held against long double; what they may be off is the rounding of positions to floats relative
 * to the eye, 6e-8 of the distance, which a field of view of a radian makes 1e-4 pixels of, and narrow fields and wide
 * frames more: a fiftieth of a pixel on ordinary frames. Depths: half a pixel (extreme_heights.c).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/options.h"
#include "tests/support/computed.h"
#include "tests/support/drawn.h"
#include "tests/support/extreme.h"
#include "tests/support/watertight.h"

enum { SIZE = 770, SPACING = 30, N = 63, WIDTH = 320, HEIGHT = 240 };
#define DEGREE (M_PI / 180)

/* A terrain's scene, and what is compared of it. */
typedef struct stage {
    tc_field *field;
    tc_scene_options options;
    scene scene;
    drawn drawn;
} stage;

static void stage_create(stage *s, const tc_context *context, tc_field *field, int n)
{
    s->field = field;
    s->options = watertight_options();
    s->scene = scene_create(context, field, n, &s->options);
    s->drawn = drawn_create(context, &s->scene);
}

static void stage_destroy(stage *s)
{
    drawn_destroy(&s->drawn);
    scene_destroy(&s->scene);
    tc_field_destroy(s->field);
}

/* What of the terrain a view is meant to see. */
typedef enum sight {
    FULL,
    NARROW, /* terrain in a frame too narrow to have terrain on all sides of a pixel, which cracks are told by */
    SPECK,  /* less than a pixel */
    NONE
} sight;

/* Pixels that a picture may be off: far away through a narrow field floats are nearly as far apart as pixels, places
 * by half of it and depths, which are off along the line of sight, by more. */
typedef struct limits {
    double vertices, depths;
    sight sees;
} limits;
static const limits ordinary = {0.02, 0.5, FULL}, telescope = {0.5, 2, FULL}, narrow = {0.02, 0.5, NARROW},
                    speck = {0.02, 0.5, SPECK}, none = {0.02, 0.5, NONE};

static void rows(const char *name, const drawn_figures *f, limits limit)
{
    bool seen = limit.sees == FULL || limit.sees == NARROW;
    bool corners = limit.sees == FULL || f->vertices; /* between the corners of a triangle a line of pixels may lie */
    if (limit.sees == FULL)
        extreme_at_most(name, "cracks, pixels", extreme_of(f->terrain, (double)f->cracks), 0,
                        "%lld pixels of terrain in %d views", (long long)f->terrain, f->views);
    else if (limit.sees == NARROW)
        extreme_at_most(name, "no terrain to be seen", f->terrain == 0, 0,
                        "%lld pixels of terrain; cracks are not looked for in so narrow a frame",
                        (long long)f->terrain);
    else
        extreme_at_most(name, "pixels of terrain a view, where less than one is to be seen",
                        (double)f->terrain / f->views, limit.sees == SPECK ? 1 : 0,
                        "nothing but numbers is looked at in what else there is of %d views", f->views);
    if (corners)
        extreme_at_most(name, "vertices off, pixels", extreme_of(f->vertices, f->vertex_px), limit.vertices, "of %lld",
                        (long long)f->vertices);
    if (seen || f->depths)
        extreme_at_most(name, "depth off the surface, pixels", extreme_of(f->depths, f->depth_px), limit.depths,
                        "of %lld pixels", (long long)f->depths);
    extreme_at_most(name, "numbers not finite", extreme_of(f->numbers, (double)f->not_finite), 0, "of %lld",
                    (long long)f->numbers);
}

static double ground(const stage *s, double x, double y)
{
    double z = 0;
    tc_field_height(s->field, x, y, &z);
    return z + tc_field_info(s->field)->z_base;
}

/* Metres above the ground as drawn, somewhere over the terrain and beside its samples. */
static void heights(stage *s, const char *name, double above, double fov, limits limit)
{
    test_random r = {21};
    drawn_figures f = {0};
    double extent = (SIZE - 1) * SPACING;
    for (int v = 0; v < 5; v++) {
        tc_camera c = {.x = test_random_range(&r, 0.1, 0.9) * extent,
                       .y = test_random_range(&r, 0.1, 0.9) * extent,
                       .heading = test_random_range(&r, 0, 2 * M_PI),
                       .pitch = above > 1e5 ? -M_PI / 2 : test_random_range(&r, -1.2, 0.1),
                       .fov = fov,
                       .width = WIDTH,
                       .height = HEIGHT};
        if (v == 1) /* beside a sample, as far as the eye is above it, which it looks down at */
            c.x = 300 * SPACING - fmin(0.1 * above, 9), c.y = 411 * SPACING + fmin(0.1 * above, 9), c.pitch = -M_PI / 2;
        if (v == 2)
            c.x = 300 * SPACING, c.y = 412 * SPACING, c.pitch = -1.5;
        c.z = ground(s, c.x, c.y) + above;
        drawn_look(&s->drawn, &c, &s->options, &f);
    }
    rows(name, &f, limit);
}

/* Below the ground: what is seen there are backs, or nothing. Nothing is asked of the picture but that it is made of
 * numbers and shows its vertices where they are. */
static void below(stage *s)
{
    drawn_figures f = {0};
    for (int v = 0; v < 4; v++) {
        tc_camera c = {
            .x = 9000, .y = 8000, .heading = v, .pitch = 0.4 * v, .fov = 1, .width = WIDTH, .height = HEIGHT};
        c.z = ground(s, c.x, c.y) - pow(10, 2 * v - 2);
        scene_draw(&s->scene, &c, true);
        drawn_vertices(&s->drawn, &c, &s->options.frame, &f);
    }
    extreme_at_most("below the ground", "vertices off, pixels", extreme_of(f.vertices, f.vertex_px), 0.02, "of %lld",
                    (long long)f.vertices);
    extreme_at_most("below the ground", "numbers not finite", extreme_of(f.numbers, (double)f.not_finite), 0, "of %lld",
                    (long long)f.numbers);
}

/* Outside the terrain, looking back at its middle. */
static void outside(stage *s, const char *name, double away, double fov, limits limit)
{
    drawn_figures f = {0};
    double middle = 0.5 * (SIZE - 1) * SPACING;
    for (int v = 0; v < 4; v++) {
        double heading = 1.6 * v + 0.3, up = v & 1 ? 0.2 * away : 3000;
        tc_camera c = {.x = middle - away * sin(heading),
                       .y = middle - away * cos(heading),
                       .z = up,
                       .heading = heading,
                       .pitch = -atan2(up, away),
                       .fov = fov,
                       .width = WIDTH,
                       .height = HEIGHT};
        drawn_look(&s->drawn, &c, &s->options, &f);
    }
    rows(name, &f, limit);
}

/* One view of the usual place, with the direction, field and frame given. */
static void one(stage *s, const char *name, double pitch, double fov, int width, int height, limits limit)
{
    drawn_figures f = {0};
    tc_camera c = {
        .x = 11000, .y = 12000, .heading = 0.7, .pitch = pitch, .fov = fov, .width = width, .height = height};
    c.z = ground(s, c.x, c.y) + 300;
    drawn_look(&s->drawn, &c, &s->options, &f);
    rows(name, &f, limit);
}

static void directions_and_fields(stage *s)
{
    one(s, "straight down", -M_PI / 2, 1.2, WIDTH, HEIGHT, ordinary);
    one(s, "straight up, where there is no terrain", M_PI / 2, 1.2, WIDTH, HEIGHT, none);
    one(s, "field of 1 degree", -0.3, 1 * DEGREE, WIDTH, HEIGHT, ordinary);
    one(s, "field of 170 degrees", -0.3, 170 * DEGREE, WIDTH, HEIGHT, ordinary);
    one(s, "field of 170 degrees, straight down", -M_PI / 2, 170 * DEGREE, WIDTH, HEIGHT, ordinary);
    one(s, "frame of 1x1 pixel", -0.6, 1.2, 1, 1, narrow);
    one(s, "frame of 1x16384 pixels", -0.6, 1e-3, 1, 16384, narrow);
    one(s, "frame of 16384x1 pixels", -0.6, 1.2, 16384, 1, narrow);
}

/* As large a window as such a frame calls for; the view is full of terrain. */
static void large_frame(const tc_context *context)
{
    const tc_camera c = {.fov = 75 * DEGREE, .width = 7680, .height = 4320};
    stage s;
    stage_create(&s, context, terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, SPACING, 7), tc_clipmap_n_for(&c));
    one(&s, "frame of 7680x4320 pixels", -0.9, c.fov, c.width, c.height, ordinary);
    stage_destroy(&s);
}

/* 10,000 km from the map's origin on a terrain with a sample to the millimetre. */
static void far_and_fine(const tc_context *context)
{
    const double spacing = 1e-3, at = 1e7;
    tc_field *p = computed_field((int64_t)(1.2 * at / spacing), (int64_t)(1.2 * at / spacing), spacing, 1000);
    stage s;
    stage_create(&s, context, p, N);
    drawn_figures f = {0};
    for (int v = 0; v < 6; v++) {
        tc_camera c = {.x = at + 0.0123 * v,
                       .y = at - 0.0317 * v,
                       .heading = v,
                       .pitch = -0.2 * v,
                       .fov = 1,
                       .width = WIDTH,
                       .height = HEIGHT};
        c.z = ground(&s, c.x, c.y) + 1e-3 * pow(10, v);
        drawn_look(&s.drawn, &c, &s.options, &f);
    }
    rows("coordinates of 10,000,000 m, samples of 0.001 m", &f, ordinary);
    stage_destroy(&s);
}

/* What the command line does not take. */
static void refused(const char *name, const char *option, const char *value)
{
    char *argv[] = {(char *)"planar-viewer", (char *)option, (char *)value, (char *)"terrain.tif", NULL};
    tc_options options;
    tc_error error = {.text = ""};
    const tc_viewer_program program = {.name = argv[0], .navigation = &tc_plane_navigation};
    extreme_refused(name, tc_options_parse(&program, 4, argv, &options, &error), TC_ERR_USAGE, error.text);
}

static void refusals(void)
{
    refused("field below 1 degree", "--fov", "0.999");
    refused("field above 170 degrees", "--fov", "170.001");
    refused("field that is no number", "--fov", "nan");
    refused("frame without pixels", "--size", "0x240");
    refused("frame of negative size", "--size", "-320x240");
    refused("frame wider than 16384 pixels", "--size", "16385x240");
    refused("frame of 2^32 pixels and one more", "--size", "4294967297x1");
    refused("eye farther than 1e12 m", "--view", "1.1e12,0,0,0,0");
    refused("eye at infinity", "--view", "1e400,0,0,0,0");
    refused("eye at no place", "--view", "nan,0,0,0,0");
    refused("pitch beyond straight up", "--view", "0,0,100,0,90.1");
}

int main(void)
{
    extreme_begin("cameras");
    refusals();
    tc_context *context = scene_context();
    if (!context) {
        extreme_skipped("all views", "no OpenGL context");
        return extreme_end();
    }
    stage s;
    stage_create(&s, context, terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, SPACING, 7), N);
    heights(&s, "0.001 m above the ground", 1e-3, 1, ordinary);
    heights(&s, "1 m above the ground", 1, 1, ordinary);
    heights(&s, "100 m above the ground", 100, 1, ordinary);
    heights(&s, "1,000,000 m above the ground", 1e6, 2 * DEGREE, ordinary);
    heights(&s, "1,000,000,000 m above the ground", 1e9, 1 * DEGREE, speck);
    /* A field that the programs do not offer: at 1e9 m floats are 64 m apart, and a pixel is 200 m wide. */
    heights(&s, "1,000,000,000 m above the ground, through a telescope", 1e9, 6.4e-5, telescope);
    below(&s);
    outside(&s, "100 km outside", 1e5, 20 * DEGREE, ordinary);
    outside(&s, "1,000 km outside", 1e6, 2 * DEGREE, ordinary);
    outside(&s, "1,000,000 km outside", 1e9, 60 * DEGREE, speck);
    outside(&s, "1,000,000 km outside, through a telescope", 1e9, 6.4e-5, telescope);
    directions_and_fields(&s);
    stage_destroy(&s);
    large_frame(context);
    far_and_fine(context);
    tc_context_destroy(context);
    return extreme_end();
}
