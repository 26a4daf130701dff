/* scheme_planets.c - planets beside each other in all schemes that there are. */
#include "scheme_planets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/app/load.h"
#include "common/chart/atlas.h"

#define DEGREE (M_PI / 180)
#define EARTH 6371000.0

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "schemes: %s\n", error->text);
        exit(1);
    }
}

const tc_scheme *scheme_of(int k)
{
    return tc_scheme_at(tc_scheme_lists, &tc_sphere_body, k);
}

int scheme_count(void)
{
    int count = 0;
    while (scheme_of(count))
        count++;
    return count < SCHEMES_MOST ? count : SCHEMES_MOST;
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

static tc_map *opened(const char *file)
{
    const char *folder = getenv("TERRACLIP_DATA");
    char path[4096];
    tc_error error;
    tc_map *map;
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "", file);
    if (!folder || !*folder || access(path, R_OK) != 0) {
        printf("%s: skipped: not in TERRACLIP_DATA\n", file);
        return NULL;
    }
    const tc_load_options load = {.body = &tc_sphere_body, .whole = true, .globe = {.unflattened = true}};
    must(tc_map_load(path, &(tc_source_options){0}, &load, &map, &error), &error);
    return map;
}

tc_map *scheme_map(const scheme_planet *p, const tc_scheme *scheme)
{
    for (int k = 0; k < p->atlases; k++)
        if (p->own[k].atlas == scheme->atlas)
            return p->own[k].map;
    return NULL;
}

/* `open` again gives the same planet: synthesis cannot be taken off a map. */
static void measure_planet(const char *name, tc_map *(*open)(const void *what), const void *what, int synthesis,
                           void (*measure)(void *context, const scheme_planet *p), void *context)
{
    scheme_planet p = {.source = open(what), .detail = synthesis != 0};
    tc_error error;
    if (!p.source)
        return;
    snprintf(p.name, sizeof p.name, "%s", name);
    for (int k = 0; k < scheme_count(); k++) {
        const tc_atlas *atlas = scheme_of(k)->atlas;
        if (scheme_map(&p, scheme_of(k)))
            continue;
        tc_map *map = p.source;
        if (p.source->chart[0].class != atlas->class)
            must(tc_map_resample(p.source, atlas, 0, &map, &error), &error);
        else if (synthesis)
            map = open(what);
        must(synthesis ? tc_map_synthesise(map, synthesis, &error) : TC_OK, &error);
        if (p.atlases == SCHEME_ATLASES)
            exit(99);
        p.own[p.atlases].atlas = atlas, p.own[p.atlases++].map = map;
    }
    p.spacing = p.own[0].map->chart[0].dx * p.source->body.radius;
    measure(context, &p);
    for (int k = 0; k < p.atlases; k++)
        if (p.own[k].map != p.source)
            tc_map_destroy(p.own[k].map);
    tc_map_destroy(p.source);
}

static tc_map *open_default(const void *width)
{
    return planet_made(PLANET_DEFAULT, *(const int64_t *)width, EARTH, 4);
}

static tc_map *open_file(const void *name)
{
    return opened(name);
}

void scheme_default_planet(bool quick, int synthesis, void (*measure)(void *context, const scheme_planet *p),
                           void *context)
{
    const int64_t width = quick ? 1024 : 4096;
    measure_planet(synthesis ? "default-planet-detail" : "default-planet", open_default, &width, synthesis, measure,
                   context);
}

void scheme_planets(bool quick, void (*measure)(void *context, const scheme_planet *p), void *context)
{
    scheme_default_planet(quick, 0, measure, context);
    if (quick)
        return;
    measure_planet("ETOPO", open_file, "earth_etopo20_1080x540_f32.tif", 0, measure, context);
    measure_planet("Moon", open_file, "moon_gld100_global_5760x2880.tif", 0, measure, context);
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

int scheme_size(const tc_scheme *scheme, int rung)
{
    return (128 << rung) - (scheme->atlas != &tc_atlas_lonlat);
}

scene scheme_scene(const tc_context *context, const scheme_planet *p, const tc_scheme *scheme, int n)
{
    return scheme_scene_within(context, p, scheme, n, 0);
}

scene scheme_scene_within(const tc_context *context, const scheme_planet *p, const tc_scheme *scheme, int n,
                          double tolerance)
{
    const tc_scene_options o = {.unlit = true, .background_set = true, .budget = -1, .frame = {.error = tolerance}};
    const tc_map *map = scheme_map(p, scheme);
    const tc_scene_needs needs = tc_scene_needs_of(&o, tc_field_info(map->chart[0].field));
    const tc_camera frame = {.fov = 60 * DEGREE, .width = 640, .height = 480};
    const tc_surface_request request = {.n = n, .error = tolerance, .map = map, .needs = &needs, .camera = &frame};
    tc_surface *surface;
    tc_error error;
    must(scheme->create(scheme, map, &request, &surface, &error), &error);
    return planet_scene_of(context, map, surface, &o);
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

const char *const scheme_view_name[SCHEME_VIEWS] = {
    [VIEW_GROUND] = "ground", [VIEW_AIRCRAFT] = "aircraft", [VIEW_SPACE] = "space", [VIEW_POLE] = "pole"};

/* The highest of all schemes' own. */
static double ground(const scheme_planet *p, double longitude, double latitude)
{
    double highest = -INFINITY, z;
    for (int k = 0; k < p->atlases; k++) {
        if (tc_map_height(p->own[k].map, longitude, latitude, &z))
            exit(1);
        highest = fmax(highest, z);
    }
    return highest;
}

double scheme_above(const scheme_planet *p, const tc_camera *c)
{
    return c->z - ground(p, c->x, c->y);
}

tc_camera scheme_camera(test_random *r, const scheme_planet *p, scheme_view kind, int width, int height)
{
    static const struct {
        double low, high; /* metres over an Earth */
        bool steep;
    } of[SCHEME_VIEWS] = {[VIEW_GROUND] = {2, 100, false},
                          [VIEW_AIRCRAFT] = {5e3, 50e3, false},
                          [VIEW_SPACE] = {300e3, 20e6, true},
                          [VIEW_POLE] = {5e3, 2e6, true}};
    tc_camera c = {.width = width, .height = height, .fov = 60 * DEGREE};
    const double radius = p->source->body.radius, share = of[kind].low < 5e3 ? 1 : radius / EARTH;
    c.x = test_random_range(r, -M_PI, M_PI);
    c.y = asin(test_random_range(r, -1, 1));
    if (kind == VIEW_POLE)
        c.y = copysign(M_PI / 2 - (test_random_unit(r) < 0.1 ? 0 : test_random_unit(r) * DEGREE), c.y);
    const double above = share * of[kind].low * pow(of[kind].high / of[kind].low, test_random_unit(r));
    c.z = ground(p, c.x, c.y) + above;
    const double dip = acos(fmin(1, radius / (radius + fmax(c.z, 0))));
    c.heading = test_random_range(r, 0, 2 * M_PI);
    c.pitch = of[kind].steep ? test_random_range(r, -M_PI / 2, -dip) : -dip - test_random_range(r, 0, 20) * DEGREE;
    return c;
}

tc_camera scheme_onward(const scheme_planet *p, const tc_camera *from, double above, double metres)
{
    const double sx = sin(from->x), cx = cos(from->x), sy = sin(from->y), cy = cos(from->y), se = sin(from->heading),
                 no = cos(from->heading), angle = metres / p->source->body.radius, s = sin(angle), c = cos(angle);
    const double up[3] = {cy * cx, cy * sx, sy}, east[3] = {-sx, cx, 0}, north[3] = {-sy * cx, -sy * sx, cy};
    double at[3], way[3];
    for (int k = 0; k < 3; k++) {
        const double ahead = se * east[k] + no * north[k];
        at[k] = c * up[k] + s * ahead, way[k] = c * ahead - s * up[k];
    }
    tc_camera to = *from;
    const double rho = hypot(at[0], at[1]);
    to.x = rho > 0 ? atan2(at[1], at[0]) : from->x;
    to.y = atan2(at[2], rho);
    to.heading = atan2(way[1] * cos(to.x) - way[0] * sin(to.x),
                       way[2] * cos(to.y) - sin(to.y) * (way[0] * cos(to.x) + way[1] * sin(to.x)));
    to.z = ground(p, to.x, to.y) + above;
    return to;
}
