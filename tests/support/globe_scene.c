/* globe_scene.c - a planet of a function, seen through the rings: atlas, surface, renderer. */
#include "globe_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/status.h"
#include "planet_scene.h"

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "globe: %s\n", error->text);
        exit(99);
    }
}

double globe_rough(double longitude, double latitude)
{
    uint64_t h = (uint64_t)(int64_t)rint(longitude * 1e6) * 0x9e3779b97f4a7c15u ^
                 (uint64_t)(int64_t)rint(latitude * 1e6) * 0xc2b2ae3d27d4eb4fu;
    h ^= h >> 29, h *= 0xbf58476d1ce4e5b9u, h ^= h >> 32;
    return 1e-3 * ((double)(h >> 11) * 0x1p-52 - 1);
}

double globe_smooth(double longitude, double latitude)
{
    double x = cos(latitude) * cos(longitude), y = cos(latitude) * sin(longitude), z = sin(latitude);
    return 1e-3 * sin(5 * x + 1) * cos(4 * y - 3 * z) + 1e-4 * sin(17 * y * z);
}

double globe_fractal(double longitude, double latitude)
{
    double x = cos(latitude) * cos(longitude), y = cos(latitude) * sin(longitude), z = sin(latitude), sum = 0;
    for (int k = 0; k < 9; k++) {
        double f = ldexp(1, k);
        sum += pow(2.1, -k) * sin(f * (3 * x + y) + k) * cos(f * (2.3 * y - 2 * z) + 3 * k);
    }
    return 1e-3 * sum;
}

tc_map *globe_atlas(globe_function f, int64_t width, double radius)
{
    const double degree = M_PI / 180;
    int64_t height = width / 2;
    double d = 360. / (double)width;
    tc_grid g = {.width = width, .height = height, .spacing_x = 1, .spacing_y = 1};
    g.z = malloc((size_t)(width * height) * sizeof *g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; g.z && i < width * height; i++) {
        double longitude = -180 + (double)(i % width) * d, latitude = -90 + ((double)(i / width) + 0.5) * d;
        g.z[i] = (float)(radius * f(longitude * degree, latitude * degree));
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    g.georef = (tc_georef){.known = true, .geographic = true, .transform = {-180 - 0.5 * d, d, 0, 90, 0, -d}};
    tc_map *atlas;
    tc_error error;
    must(tc_map_build(&g, radius, 0, &atlas, &error), &error);
    return atlas;
}

globe_scene globe_scene_create(const tc_context *context, const tc_map *atlas, const tc_rings_options *options)
{
    const tc_scene_options look = {.unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1};
    scene s = planet_scene(context, atlas, options, &look);
    return (globe_scene){tc_context_gl(context), atlas, s.surface, s.renderer};
}

void globe_scene_destroy(globe_scene *s)
{
    scene_destroy(&(scene){.surface = s->surface, .renderer = s->renderer});
    *s = (globe_scene){0};
}

void globe_scene_frame(globe_scene *s, const tc_camera *camera, bool draw)
{
    tc_frame_stats stats;
    tc_error error;
    if (!draw)
        scene_leave_draws_out(s->surface);
    int frames = 0;
    do
        must(tc_renderer_frame(s->renderer, camera, true, &stats, &error), &error);
    while (!stats.resident && ++frames < 100);
    must(stats.resident ? TC_OK : tc_fail(&error, TC_ERR_IO, "what a view wants is never held"), &error);
    if (!draw)
        scene_put_draws_back(s->surface);
}
