/* bench_hexagons.c - BN08's comparison: planar squares of n = 255 against a planet of hexagons, whose windows have n =
 * 255 here and 257 there: hexagons.csv.
 *
 * The plane has 4097 samples a side, each of the planet's four charts as many (the default planet with two levels finer
 * than its data; quick: 1025). 640 x 480, 90 degrees, lit, before a flat background, the eye so many samples'
 * spacings above ground. Frames of held windows, of both in turns; ratio is the median of those within a turn:
 * hexagons' frames a second over squares'. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/frame_clock.h"
#include "tests/support/measured.h"
#include "tests/support/scheme_planets.h"

enum { N = 255, TURNS = 21, WIDTH = 640, HEIGHT = 480 };
#define DEGREE (M_PI / 180)

typedef struct side {
    const char *scheme;
    scene scene;
    tc_camera camera;
    tc_frame_stats stats;
    double ms[TURNS];
} side;

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
} bench;

static void draw(void *context, bool finish)
{
    side *s = context;
    tc_error error;
    if (tc_renderer_frame(s->scene.renderer, &s->camera, finish, &s->stats, &error)) {
        fprintf(stderr, "hexagons: %s\n", error.text);
        exit(1);
    }
}

static void measure_height(const bench *b, side sides[2], double spacings)
{
    double ratio[TURNS];
    const int turns = b->options.quick ? 5 : TURNS;
    for (int k = 0; k < 2; k++)
        scene_draw(&sides[k].scene, &sides[k].camera, true);
    for (int turn = 0; turn < turns; turn++) {
        for (int k = 0; k < 2; k++)
            sides[k].ms[turn] = frame_clock_ms(&b->clock, draw, &sides[k]);
        ratio[turn] = sides[0].ms[turn] / sides[1].ms[turn];
    }
    const measure_spread times = measure_of(ratio, turns);
    for (int k = 0; k < 2; k++) {
        const double ms = measure_of(sides[k].ms, turns).median;
        printf("%-10s %4d, %4g spacings above ground: %9lld triangles, %.2f ms, %.1f frames a second\n",
               sides[k].scheme, N, spacings, (long long)sides[k].stats.triangles, ms, 1000 / ms);
        if (b->options.csv)
            fprintf(b->options.csv, "%s,%d,%g,%lld,%.3f,%.3f,%.4f,%.4f,%.4f\n", sides[k].scheme, N, spacings,
                    (long long)sides[k].stats.triangles, ms, 1000 / ms, k ? times.median : 1, k ? times.low : 1,
                    k ? times.high : 1);
    }
    printf("hexagons' rate over squares': %.3f (%.3f to %.3f); BN08: 0.825\n", times.median, times.low, times.high);
    fflush(stdout);
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    const bench *b = context;
    const int64_t size = b->options.quick ? 1025 : 4097;
    tc_field *plane = terrain_field(TERRAIN_DEFAULT, size, size, 30, 4);
    const tc_scene_options look = {.background_set = true, .budget = -1};
    const tc_scheme *hex = tc_scheme_named(tc_scheme_lists, &tc_sphere_body, "hex");
    const tc_map *map = scheme_map(planet, hex);
    const tc_scene_needs needs = tc_scene_needs_of(&look, tc_field_info(map->chart[0].field));
    const double cell = planet->source->body.radius * M_PI / 2 / (double)(size - 1);
    side sides[2] = {{.scheme = "square"}, {.scheme = hex->name}};
    tc_camera c = {.fov = 90 * DEGREE, .heading = 0.6, .pitch = -5 * DEGREE, .width = WIDTH, .height = HEIGHT};
    tc_surface *surface;
    tc_error error;
    if (hex->create(hex, map, &(tc_surface_request){.n = N, .needs = &needs, .camera = &c}, &surface, &error)) {
        fprintf(stderr, "hexagons: %s\n", error.text);
        exit(1);
    }
    sides[0].scene = scene_create(b->context, plane, N, &look);
    sides[1].scene = planet_scene_of(b->context, map, surface, &look);
    for (double spacings = 1; spacings <= 100; spacings *= 10) {
        for (int k = 0; k < 2; k++)
            sides[k].camera = c;
        sides[0].camera.x = sides[0].camera.y = 0.5 * 30 * (double)(size - 1);
        if (tc_field_height(plane, sides[0].camera.x, sides[0].camera.y, &sides[0].camera.z))
            exit(1);
        sides[0].camera.z += tc_field_info(plane)->z_base + 30 * spacings;
        sides[1].camera.x = 10.3 * DEGREE, sides[1].camera.y = 46.4 * DEGREE;
        sides[1].camera.z = cell * spacings - scheme_above(planet, &sides[1].camera);
        measure_height(b, sides, spacings);
    }
    for (int k = 0; k < 2; k++)
        scene_destroy(&sides[k].scene);
    tc_field_destroy(plane);
}

int main(int argc, char **argv)
{
    static bench b;
    b.options =
        measure_begin(argc, argv, "scheme,n,spacings,triangles,frame_ms,frames_per_s,ratio,ratio_low,ratio_high");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    scheme_default_planet(b.options.quick, 2, measure_planet, &b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
