/* lean_scenes.c - scenes that need little, and ones that need everything. */
#include "lean_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draped.h"
#include "made_files.h"
#include "planar/square.h"

#define DEGREE (M_PI / 180)
#define LIT (LEAN_LIGHT | LEAN_NORMALS)
#define ANGLES (LEAN_ANGLES | LEAN_NORMALS | LEAN_FINE_NORMALS)
#define LIT_LAND (LIT | LEAN_SKY | LEAN_HAZE | LEAN_LAND)
enum { SIZE = 1025, POND = 65, N = 127, GLOBE = 1024, FINER = 5 };

const lean_scene lean_scenes[LEAN_SCENES] = {
    {"flat-unlit",
     LEAN_HILLS,
     {.unlit = true, .background_set = true, .frame.no_morph = true},
     .5,
     .5,
     900,
     30,
     -30,
     LEAN_LAND | LEAN_CLOSERS},
    {"ground", LEAN_COAST, {0}, .4, .6, 2, 120, -4, LIT_LAND | LEAN_WATER | LEAN_CLOSERS},
    {"high", LEAN_COAST, {0}, .5, .5, 40000, 0, -85, LIT_LAND | LEAN_WATER | LEAN_CLOSERS},
    {"pond", LEAN_POND, {0}, .5, .5, 300, 0, -40, LIT_LAND},
    {"no-holes", LEAN_COAST, {.holes = true}, .4, .6, 200, 120, -10, LIT_LAND | LEAN_WATER | LEAN_CLOSERS},
    {"holes", LEAN_VOIDS, {.holes = true}, .4, .6, 200, 120, -10, LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_HOLES},
    {"packed", LEAN_PACKED, {0}, .4, .6, 200, 120, -10, LIT_LAND | LEAN_WATER | LEAN_CLOSERS},
    {"detail", LEAN_FINER, {0}, .4, .6, 2, 120, -10, LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_DETAIL},
    {"everything",
     LEAN_VOIDS,
     {.holes = true, .level_colours = true, .samples = 4},
     .4,
     .6,
     2,
     120,
     -4,
     LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_HOLES | LEAN_LEVEL_COLOURS | LEAN_SAMPLES | LEAN_IMAGERY},
    {"planet-space", LEAN_EARTH, {0}, 10, 20, 1.5e7, 0, -90, LIT_LAND | LEAN_WATER | LEAN_SPHERE},
    {"planet-ground", LEAN_EARTH, {0}, 10, 5, 300, 60, -5, LIT_LAND | LEAN_WATER | LEAN_SPHERE},
    {"planet-pole", LEAN_EARTH, {0}, 10, 89.5, 3000, 60, -8, LIT_LAND | LEAN_WATER | LEAN_SPHERE},
    {"planet-detail", LEAN_EARTH_FINER, {0}, 10, 58, 300, 60, -5, LIT_LAND | LEAN_WATER | LEAN_SPHERE | LEAN_DETAIL},
    {"moon", LEAN_MOON, {0}, 10, 5, 20000, 60, -20, LIT | LEAN_SKY | LEAN_SPHERE},
    {"planet-everything",
     LEAN_EARTH_VOIDS,
     {.holes = true, .level_colours = true, .samples = 4, .frame.no_cull = true},
     10,
     60,
     300,
     60,
     -5,
     LIT_LAND | LEAN_WATER | LEAN_SPHERE | LEAN_HOLES | LEAN_LEVEL_COLOURS | LEAN_SAMPLES | LEAN_IMAGERY},
    {"slope-contours",
     LEAN_COAST,
     {.shade = &tc_shades[TC_SHADE_SLOPE], .contours = 20},
     .4,
     .6,
     200,
     120,
     -10,
     ANGLES | LEAN_SKY | LEAN_CONTOURS | LEAN_CLOSERS},
    {"height-map",
     LEAN_COAST,
     {.shade = &tc_shades[TC_SHADE_HEIGHT], .background_set = true},
     .4,
     .6,
     200,
     120,
     -10,
     LEAN_NORMALS | LEAN_FINE_NORMALS | LEAN_HILLSHADE | LEAN_WATER | LEAN_CLOSERS},
    {"planet-aspect",
     LEAN_EARTH,
     {.shade = &tc_shades[TC_SHADE_ASPECT], .background_set = true},
     10,
     5,
     20000,
     60,
     -20,
     ANGLES | LEAN_SPHERE},
    {"tolerance",
     LEAN_COAST,
     {.frame.error = 1},
     .4,
     .6,
     200,
     120,
     -10,
     LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_TOLERANCE},
    {"exaggerated",
     LEAN_COAST,
     {.exaggeration = 2},
     .4,
     .6,
     200,
     120,
     -10,
     LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_EXAGGERATION},
    {"around",
     LEAN_COAST,
     {.around = {.walls = true, .sea = true, .climate = true, .foot = -2000, .depth = 50, .south = .6, .north = .61}},
     -.2,
     .4,
     900,
     70,
     -10,
     LIT_LAND | LEAN_WATER | LEAN_CLOSERS | LEAN_WALLS | LEAN_SEA | LEAN_CLIMATE},
    {"moon-stars", LEAN_MOON, {.around.stars = true}, 10, 5, 20000, 60, -20, LIT | LEAN_SKY | LEAN_SPHERE | LEAN_STARS},
};

/* ---- Grounds ---------------------------------------------------------------------------------------------------- */

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "lean scene: %s\n", error->text);
        exit(99);
    }
}

/* Discs without heights. */
static void pierce(tc_grid *g)
{
    g->voids = calloc((size_t)(g->width * g->height), 1);
    if (!g->voids)
        exit(99);
    for (int64_t j = 0; j < g->height; j++)
        for (int64_t i = 0; i < g->width; i++) {
            bool inside = hypot((double)(i % 97 - 48), (double)(j % 97 - 48)) < 9;
            g->voids[j * g->width + i] = inside;
            g->void_count += inside;
        }
}

static tc_field *build(tc_grid *g)
{
    tc_field *p;
    tc_error error;
    must(tc_field_build(g, 0, &p, &error), &error);
    return p;
}

static tc_field *packed(void)
{
    tc_grid g = terrain_grid(TERRAIN_DEFAULT, SIZE, SIZE, 30, 4);
    const tc_pack_terrain about = {
        .width = SIZE, .height = SIZE, .spacing_x = 30, .spacing_y = 30, .sample_type = TC_SAMPLE_FLOAT32, .unit = 1};
    const tc_pack_options how = {.mode = TC_PACK_RMS, .error = 1};
    const char *path = made_path("lean.tclip");
    tc_packer *packer;
    tc_pack_result result;
    tc_error error;
    tc_field *p;
    must(tc_packer_create(path, &about, &how, &packer, &error), &error);
    must(tc_packer_put(packer, (tc_rect){0, 0, SIZE, SIZE}, g.z, NULL, SIZE, &error), &error);
    must(tc_packer_finish(packer, &result, &error), &error);
    tc_packer_destroy(packer);
    tc_grid_free(&g);
    must(tc_field_open(path, NULL, &p, &error), &error);
    return p;
}

static tc_map *globe(double radius, bool voids)
{
    tc_grid g = {.width = GLOBE, .height = GLOBE / 2, .spacing_x = 1, .spacing_y = 1, .wraps_x = true};
    double step = 360.0 / GLOBE, relief = 3000;
    const double t[6] = {-180, step, 0, 90, 0, -step};
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc((size_t)(g.width * g.height) * sizeof *g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; g.z && i < g.width * g.height; i++) {
        double lon = (-180 + ((double)(i % g.width) + 0.5) * step) * DEGREE,
               lat = (-90 + ((double)(i / g.width) + 0.5) * step) * DEGREE;
        const double p[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
        g.z[i] = (float)planet_smooth(&relief, p);
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    if (voids)
        pierce(&g);
    tc_map *atlas;
    tc_error error;
    must(tc_map_build(&g, radius, 0, &atlas, &error), &error);
    return atlas;
}

static struct {
    bool made;
    tc_map *atlas;
    tc_imagery *imagery; /* NULL: not asked for */
    int levels;          /* of its data */
} grounds[LEAN_GROUNDS];

bool lean_sphere(lean_ground ground)
{
    return ground >= LEAN_EARTH;
}

static tc_map *make(lean_ground ground)
{
    if (lean_sphere(ground))
        return globe(ground == LEAN_MOON ? 1737400 : 6371000, ground == LEAN_EARTH_VOIDS);
    tc_field *p;
    if (ground == LEAN_PACKED || ground == LEAN_FINER) {
        p = packed();
    } else {
        int size = ground == LEAN_POND ? POND : SIZE;
        bool hills = ground == LEAN_HILLS || ground == LEAN_POND;
        tc_grid g = terrain_grid(hills ? TERRAIN_SMOOTH : TERRAIN_DEFAULT, size, size, 30, 4);
        if (ground == LEAN_VOIDS)
            pierce(&g);
        p = build(&g);
    }
    tc_map *map = tc_map_flat(p);
    if (!map)
        exit(99);
    return map;
}

const tc_map *lean_atlas(lean_ground ground)
{
    if (!grounds[ground].made) {
        tc_map *atlas = make(ground);
        grounds[ground].levels = tc_field_info(tc_map_field(atlas, 0))->levels;
        grounds[ground].atlas =
            planet_synthesised(atlas, ground == LEAN_FINER || ground == LEAN_EARTH_FINER ? FINER : 0);
        grounds[ground].made = true;
    }
    return grounds[ground].atlas;
}

int lean_data_levels(lean_ground ground)
{
    lean_atlas(ground);
    return grounds[ground].levels;
}

void lean_free_all(void)
{
    for (int i = 0; i < LEAN_GROUNDS; i++) {
        if (!grounds[i].made)
            continue;
        tc_imagery_destroy(grounds[i].imagery);
        grounds[i].imagery = NULL;
        tc_map_destroy(grounds[i].atlas);
        grounds[i].made = false;
    }
    made_folder_remove();
}

static const tc_imagery *imagery_over(lean_ground ground)
{
    if (!grounds[ground].imagery) {
        tc_image *image = draped_image(draped_waves, 600, 300);
        tc_error error;
        must(tc_imagery_create(lean_atlas(ground), &image, 1, 0, &grounds[ground].imagery, &error), &error);
    }
    return grounds[ground].imagery;
}

/* ---- Scenes ----------------------------------------------------------------------------------------------------- */

tc_camera lean_camera(const lean_scene *s, int width, int height)
{
    const tc_map *atlas = lean_atlas(s->ground);
    const tc_field *p = atlas->chart[0].field;
    tc_camera c = {.heading = s->heading * DEGREE,
                   .pitch = s->pitch * DEGREE,
                   .fov = 75 * DEGREE,
                   .width = width,
                   .height = height};
    double ground = 0;
    if (lean_sphere(s->ground)) {
        c.x = s->x * DEGREE, c.y = s->y * DEGREE;
    } else {
        const tc_level finest = tc_field_level(p, tc_field_info(p)->levels);
        c.x = s->x * (double)(finest.width - 1) * finest.spacing_x;
        c.y = s->y * (double)(finest.height - 1) * finest.spacing_y;
    }
    tc_map_height(atlas, c.x, c.y, &ground);
    c.z = ground + s->above;
    return c;
}

scene lean_create(const tc_gl *gl, const lean_scene *s, const tc_scene_options *options, const tc_scene_needs *needs)
{
    const tc_map *atlas = lean_atlas(s->ground);
    const tc_field *field = atlas->chart[0].field;
    bool sphere = lean_sphere(s->ground);
    tc_scene_options with = *options;
    if (s->needs & LEAN_IMAGERY)
        with.imagery = imagery_over(s->ground);
    options = &with;
    const tc_scene_needs own = tc_scene_needs_of(options, tc_field_info(field));
    needs = needs ? needs : &own;
    tc_surface *surface;
    tc_error error;
    if (sphere) {
        const tc_rings_options rings = {.n_phi = 256,
                                        .m = 20,
                                        .normals = needs->normals,
                                        .fine_normals = needs->fine_normals,
                                        .holes = needs->holes};
        must(tc_rings_create(atlas, &rings, &surface, &error), &error);
    } else {
        const tc_ground_options clip = {
            .n = N, .normals = needs->normals, .fine_normals = needs->fine_normals, .holes = needs->holes};
        const tc_square_blocks blocks = {.shaded_n = N};
        must(tc_square_create(field, &clip, options->frame.error > 0 ? &blocks : NULL, &surface, &error), &error);
    }
    scene made = {.field = field, .surface = surface};
    must(tc_renderer_create(gl, surface, options, &made.renderer, &error), &error);
    made.clipmap = tc_renderer_used(made.renderer).windows->clipmap[0];
    return made;
}
