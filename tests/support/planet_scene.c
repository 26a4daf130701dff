/* planet_scene.c - planets made in memory, and scenes of rings over them. */
#include "planet_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/chart/atlas.h"
#include "data/synth_planet.h"
#include "kept.h"

#define DEGREE (M_PI / 180)

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "planet: %s\n", error->text);
        exit(99);
    }
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

static tc_grid empty_grid(int64_t width, double radius)
{
    tc_grid g = {.width = width, .height = width / 2, .spacing_x = 1, .spacing_y = 1, .wraps_x = true};
    double step = 360.0 / (double)width;
    const double t[6] = {-180, step, 0, 90, 0, -step};
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc((size_t)(g.width * g.height) * sizeof *g.z);
    if (!g.z)
        exit(99);
    return g;
}

static tc_map *build(tc_grid *g, double radius)
{
    tc_map *atlas;
    tc_error error;
    g->z_min = INFINITY, g->z_max = -INFINITY;
    for (int64_t i = 0; i < g->width * g->height; i++)
        g->z_min = fminf(g->z_min, g->z[i]), g->z_max = fmaxf(g->z_max, g->z[i]);
    must(tc_map_build(g, radius, 0, &atlas, &error), &error);
    return atlas;
}

static void towards(double longitude, double latitude, double p[3])
{
    p[0] = cos(latitude) * cos(longitude), p[1] = cos(latitude) * sin(longitude), p[2] = sin(latitude);
}

tc_map *planet_atlas(int64_t width, double radius, planet_function height, void *context)
{
    tc_grid g = empty_grid(width, radius);
    double step = 2 * M_PI / (double)width, p[3];
    for (int64_t j = 0; j < g.height; j++)
        for (int64_t i = 0; i < width; i++) {
            towards(-M_PI + ((double)i + 0.5) * step, -M_PI / 2 + ((double)j + 0.5) * step, p);
            g.z[j * width + i] = (float)height(context, p);
        }
    return build(&g, radius);
}

/* What makes a default planet. */
typedef struct body {
    int64_t width;
    uint64_t seed;
} body;

static void make_default(void *context, float *z)
{
    const body *b = context;
    tc_synth_planet *planet;
    tc_error error;
    must(tc_synth_planet_open(b->width, b->seed, 0, &planet, &error), &error);
    tc_synth_planet_rows(planet, 0, b->width / 2, z);
    tc_synth_planet_close(planet);
}

tc_map *planet_made(planet_kind kind, int64_t width, double radius, uint64_t seed)
{
    double relief = 3000;
    if (kind == PLANET_SMOOTH)
        return planet_atlas(width, radius, planet_smooth, &relief);
    tc_grid g = empty_grid(width, radius);
    test_random r = {seed};
    if (kind == PLANET_DEFAULT) {
        char name[128];
        snprintf(name, sizeof name, "planet-%lld-%llu", (long long)width, (unsigned long long)seed);
        kept_heights(name, (size_t)(width * g.height), make_default, &(body){width, seed}, g.z);
    } else
        for (int64_t j = 0; j < g.height; j++)
            for (int64_t i = 0; i < width; i++) {
                int64_t block = (i / 6 * 7919 + j / 6 * 104729) >> 3;
                bool alone = ((i / 40 + j / 40) & 1) != 0;
                g.z[j * width + i] =
                    (alone ? test_random_bits(&r) & 1 : (uint64_t)(block * block >> 2) & 1) ? 5000 : -3000;
            }
    return build(&g, radius);
}

tc_map *planet_synthesised(tc_map *planet, int levels)
{
    tc_error error;
    must(tc_map_synthesise(planet, levels, &error), &error);
    return planet;
}

tc_map *planet_flattened(tc_map *planet, double flattening)
{
    planet->body = tc_body_flattened(planet->body.radius, flattening);
    return planet;
}

double planet_slope(void *context, const double p[3])
{
    return *(double *)context * (0.48 * p[0] - 0.6 * p[1] + 0.64 * p[2]);
}

double planet_smooth(void *context, const double p[3])
{
    return *(double *)context * (0.5 * (0.48 * p[0] - 0.6 * p[1] + 0.64 * p[2]) + 0.3 * sin(4 * p[0] + 3 * p[2]) +
                                 0.2 * sin(9 * p[1] - 8 * p[2] + 2 * p[0]));
}

tc_status planet_truth_height(void *truth, double longitude, double latitude, double *z_ret)
{
    const planet_truth *t = truth;
    double p[3];
    towards(longitude, latitude, p);
    *z_ret = t->height(t->context, p);
    return TC_OK;
}

tc_status planet_atlas_height(void *atlas, double longitude, double latitude, double *z_ret)
{
    return tc_map_height(atlas, longitude, latitude, z_ret);
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

tc_surface *planet_rings(const tc_map *atlas, const tc_rings_options *rings, const tc_scene_options *options)
{
    tc_rings_options o = *rings;
    const tc_scene_needs needs = tc_scene_needs_of(options, tc_field_info(atlas->chart[0].field));
    o.normals = needs.normals, o.fine_normals = needs.fine_normals, o.holes = needs.holes;
    o.throttle = needs.throttle;
    tc_surface *surface;
    tc_error error;
    must(tc_rings_create(atlas, &o, &surface, &error), &error);
    return surface;
}

tc_map *planet_of_faces(tc_map *planet, const tc_chart_class *class)
{
    tc_map *faces;
    tc_error error;
    must(tc_map_resample(planet, tc_atlas_of(class), 0, &faces, &error), &error);
    tc_map_destroy(planet);
    return faces;
}

tc_surface *planet_faces(const tc_map *map, const faces_kind *kind, int n, const tc_scene_options *options)
{
    const tc_scene_needs needs = tc_scene_needs_of(options, tc_field_info(map->chart[0].field));
    const tc_faces_options o = {.kind = kind,
                                .n = n,
                                .shaded_n = options->frame.error > 0 ? (n && n < 255 ? n : 255) : 0,
                                .normals = needs.normals,
                                .fine_normals = needs.fine_normals,
                                .holes = needs.holes};
    tc_surface *surface;
    tc_error error;
    must(tc_faces_create(map, &o, &surface, &error), &error);
    return surface;
}

scene planet_scene_of(const tc_context *context, const tc_map *atlas, tc_surface *surface,
                      const tc_scene_options *options)
{
    scene s = {.field = atlas->chart[0].field, .surface = surface};
    tc_error error;
    must(tc_renderer_create(tc_context_gl(context), surface, options, &s.renderer, &error), &error);
    s.clipmap = tc_renderer_used(s.renderer).windows->clipmap[0];
    return s;
}

scene planet_scene(const tc_context *context, const tc_map *atlas, const tc_rings_options *rings,
                   const tc_scene_options *options)
{
    return planet_scene_of(context, atlas, planet_rings(atlas, rings, options), options);
}

float *planet_depth(scene *s, const tc_camera *camera)
{
    float *depth = malloc(sizeof *depth * (size_t)camera->width * (size_t)camera->height);
    if (!depth)
        exit(99);
    tc_renderer_read(s->renderer, NULL, depth);
    return depth;
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

static double sign(test_random *r)
{
    return test_random_bits(r) & 1 ? 1 : -1;
}

tc_camera planet_view(test_random *r, const tc_map *atlas, double low, double high)
{
    tc_camera c = {.width = 160, .height = 120};
    double where = test_random_unit(r), ground;
    c.x = test_random_range(r, -M_PI, M_PI);
    c.y = asin(test_random_range(r, -1, 1));
    if (where < 0.3) /* by a pole, */
        c.y = sign(r) * (M_PI / 2 - pow(10, test_random_range(r, -8, -0.5)));
    else if (where < 0.36) /* on it, */
        c.y = sign(r) * M_PI / 2;
    else if (where < 0.5) /* on the antimeridian, */
        c.x = sign(r) * M_PI + (test_random_bits(r) & 1 ? sign(r) * pow(10, test_random_range(r, -9, -1)) : 0);
    else if (where < 0.6) /* where caps take over */
        c.y = sign(r) * test_random_range(r, TC_CAP_EDGE, TC_CAP_BLEND_END + 1) * DEGREE;
    must(planet_atlas_height((void *)atlas, c.x, c.y, &ground), &(tc_error){.text = "height"});
    double above = low * pow(high / low, test_random_unit(r));
    c.z = ground + above;
    double dip = acos(fmin(1, atlas->body.radius / (atlas->body.radius + fmax(c.z, 0)))), way = test_random_unit(r);
    c.heading = test_random_range(r, 0, 2 * M_PI);
    c.pitch = way < 0.5   ? fmax(-dip + test_random_range(r, -0.5, 0.3), -M_PI / 2)
              : way < 0.6 ? -M_PI / 2
                          : test_random_range(r, -M_PI / 2, M_PI / 6 - dip);
    c.fov = test_random_range(r, 20, 110) * DEGREE;
    return c;
}
