/* extreme_planet.c - planets no traveller would choose: a metre and a hundred thousand kilometres wide, seen from the
 * poles themselves and 1e-12 rad beside them, from the antimeridian, from a millimetre and a million kilometres above
 * the ground, with relief as large as the radius. Vertices as the driver computes them are held against long double
 * (rings_oracle.h), background through the planet is counted (globe_holes.h), and no number may be other than finite.
 */
#include "tests/support/containers.h"
#include "tests/support/extreme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/map/map.h"
#include "common/base/byte_order.h"
#include "common/packed/file/container.h"
#include "common/base/crc32c.h"
#include "common/app/load.h"
#include "tests/support/globe_holes.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/planet_scene.h"
#include "tests/support/rings_capture.h"
#include "tests/support/rings_views.h"

/* Of a frame 1280 pixels wide, as tests/slow/test_rings_precision.c has it. */
#define PIXELS 0.01
static const double EARTH = 6371000, BESIDE = 1e-12;
enum { WIDTH = 512, DEEP = 24 };

static tc_context *context;

/* ---- Views ------------------------------------------------------------------------------------------------------- */

typedef struct place {
    double longitude, latitude;
} place;

enum { PLACES = 12 };
static void places_of(place p[PLACES])
{
    const place all[PLACES] = {{0.3, M_PI / 2},
                               {-2, -M_PI / 2},
                               {1, M_PI / 2 - BESIDE},
                               {M_PI, M_PI / 2 - BESIDE},
                               {0, -M_PI / 2 + BESIDE},
                               {-2.5, -M_PI / 2 + BESIDE},
                               {M_PI, 0},
                               {-M_PI, 0.5},
                               {M_PI - BESIDE, -0.7},
                               {-M_PI + BESIDE, 1},
                               {0, TC_CAP_BLEND_START * M_PI / 180},
                               {1.234, 0.2}};
    memcpy(p, all, sizeof all);
}

/* What views of a planet came to. */
typedef struct sight {
    rings_error error, deep; /* deep: of levels from DEEP on */
    int views, finest;
    int64_t not_finite, terrain, sure, holes, suspects, cracks; /* pixels as globe_holes.h has them */
} sight;

static void add(rings_error *to, const rings_error *e)
{
    to->pixels = isnan(e->pixels) ? INFINITY : fmax(to->pixels, e->pixels);
    to->vertices += e->vertices, to->seen += e->seen;
}

/* The same view in few pixels, drawn. */
static void look_for_holes(globe_scene *globe, const tc_camera *camera, sight *s)
{
    tc_camera c = *camera;
    c.width = 160, c.height = 120;
    scene drawn = {.surface = globe->surface, .renderer = globe->renderer};
    globe_scene_frame(globe, &c, true);
    const globe_mesh mesh = globe_mesh_of_rings(drawn.surface, NULL);
    globe_holes h = globe_holes_of(&drawn, &mesh, &c, NULL, 200);
    s->terrain += h.terrain, s->sure += h.sure, s->holes += h.holes;
    s->suspects += h.suspects, s->cracks += h.cracks;
    float *depth = planet_depth(&drawn, &c);
    for (int i = 0; i < c.width * c.height; i++)
        s->not_finite += !isfinite(depth[i]) || depth[i] < 0 || depth[i] > 1;
    free(depth);
    free(drawn.view);
}

static void view(rings_capture *capture, const tc_camera *c, sight *s)
{
    rings_error level[RINGS_MAX_LEVELS] = {{0}};
    rings_capture_compare(capture, c, 32, level);
    for (int i = 0; i < RINGS_MAX_LEVELS; i++) {
        add(&s->error, &level[i]);
        if (i >= DEEP)
            add(&s->deep, &level[i]);
        if (level[i].vertices && i > s->finest)
            s->finest = i;
    }
    s->not_finite += rings_capture_not_finite(capture, c);
    look_for_holes(capture->globe, c, s);
    s->views++;
}

static void background_row(const char *name, const sight *s)
{
    extreme_at_most(name, "background through it and numbers not finite",
                    extreme_of(s->terrain, (double)(s->holes + s->cracks + s->not_finite)), 0,
                    "%lld pixels of the planet, of %lld surely its %lld are holes, of %lld suspects %lld are cracks, "
                    "%lld numbers",
                    (long long)s->terrain, (long long)s->sure, (long long)s->holes, (long long)s->suspects,
                    (long long)s->cracks, (long long)s->not_finite);
}

static void rows(const char *name, const sight *s, double pixels)
{
    extreme_at_most(name, "vertices off by, pixels", s->error.seen ? s->error.pixels : NAN, pixels,
                    "%d views, %lld of %lld vertices in frames, levels of rings up to %d", s->views,
                    (long long)s->error.seen, (long long)s->error.vertices, s->finest);
    background_row(name, s);
}

typedef struct planet {
    tc_map *atlas;
    globe_scene globe;
    rings_capture capture;
} planet;

/* In place, since its parts point at one another. */
static void planet_make(planet *p, globe_function f, double radius, double flattening)
{
    p->atlas = planet_flattened(globe_atlas(f, WIDTH, radius), flattening);
    p->globe = globe_scene_create(context, p->atlas, &(tc_rings_options){.n_phi = 256});
    p->capture = rings_capture_create(&p->globe);
}

static void planet_drop(planet *p)
{
    rings_capture_destroy(&p->capture);
    globe_scene_destroy(&p->globe);
    tc_map_destroy(p->atlas);
}

/* ---- Radii, altitudes ------------------------------------------------------------------------------------------- */

static void radii(void)
{
    place p[PLACES];
    sight deep = {0};
    places_of(p);
    for (int decade = 0; decade <= 8; decade++) {
        double radius = pow(10, decade);
        planet body;
        planet_make(&body, globe_rough, radius, 0);
        test_random r = {(uint64_t)decade + 1};
        sight s = {0};
        for (int k = decade % 2; k < PLACES; k += 2) {
            tc_camera c = rings_view_at(body.atlas, p[k].longitude, p[k].latitude,
                                        rings_altitude((5 * k + decade) % RINGS_ALTITUDES, radius), &r);
            view(&body.capture, &c, &s);
        }
        char name[60];
        snprintf(name, sizeof name, "radius 1e%d m", decade);
        rows(name, &s, PIXELS);
        add(&deep.deep, &s.deep);
        deep.finest = s.finest > deep.finest ? s.finest : deep.finest;
        planet_drop(&body);
    }
    extreme_at_most("levels of rings from 24 on", "vertices off by, pixels", deep.deep.seen ? deep.deep.pixels : NAN,
                    PIXELS, "%lld vertices in frames, up to level %d", (long long)deep.deep.seen, deep.finest);
}

/* From the Earth's flattening to that of a disc, whose normals turn a hundred times as fast at its rim as a sphere's.
 */
static void flattenings(void)
{
    static const double flattening[] = {1e-9, WGS84_FLATTENING, 0.1, 0.5, 0.9};
    place p[PLACES];
    places_of(p);
    for (int i = 0; i < 5; i++) {
        planet body;
        planet_make(&body, globe_rough, EARTH, flattening[i]);
        test_random r = {(uint64_t)i + 50};
        sight s = {0};
        for (int k = i % 2; k < PLACES; k += 2) {
            tc_camera c = rings_view_at(body.atlas, p[k].longitude, p[k].latitude,
                                        rings_altitude((5 * k + i) % RINGS_ALTITUDES, EARTH), &r);
            view(&body.capture, &c, &s);
        }
        char name[60];
        snprintf(name, sizeof name, "flattening %.2g", flattening[i]);
        rows(name, &s, PIXELS);
        planet_drop(&body);
    }
}

static void altitudes(void)
{
    enum { VIEWS = 3 };
    place p[PLACES];
    planet body;
    places_of(p);
    planet_make(&body, globe_rough, EARTH, 0);
    test_random r = {77};
    for (int decade = -3; decade <= 9; decade++) {
        sight s = {0};
        for (int k = 0; k < VIEWS; k++) {
            const place *at = &p[(3 * k + decade + 3) % PLACES];
            tc_camera c = rings_view_at(body.atlas, at->longitude, at->latitude, pow(10, decade), &r);
            view(&body.capture, &c, &s);
        }
        char name[60];
        snprintf(name, sizeof name, "1e%d m above the ground", decade);
        rows(name, &s, PIXELS);
    }
    planet_drop(&body);
}

/* ---- Relief ------------------------------------------------------------------------------------------------------ */

static double share; /* of the radius, of what follows */

static double needles(double longitude, double latitude)
{
    return share * 1e3 * globe_rough(longitude, latitude);
}

static double hills(double longitude, double latitude)
{
    return share * (0.5 * sin(3 * longitude) * cos(latitude) - 0.4999 * sin(5 * latitude));
}

/* As much relief as there may be. Nothing is said of pixels: where a step of the mesh is a turn of the view, no rule of
 * detail holds; but nothing may be torn or lost. */
static void tall(globe_function f, double part, const char *name)
{
    place p[PLACES];
    planet body;
    places_of(p);
    share = part;
    planet_make(&body, f, EARTH, 0);
    test_random r = {9};
    sight s = {0};
    for (int k = 0; k < PLACES; k++) {
        tc_camera c = rings_view_at(body.atlas, p[k].longitude, p[k].latitude, EARTH * pow(10, 0.5 - k % 5), &r);
        s.not_finite += rings_capture_not_finite(&body.capture, &c);
        look_for_holes(&body.globe, &c, &s);
    }
    background_row(name, &s);
    planet_drop(&body);
}

/* A tenth of the disc too small: from above it must be seen, as holes where relief is small and as cracks where it is
 * so large that next to nothing of what is seen is surely the planet. */
static void open_disc(globe_function f, double radius, const char *name, bool as_cracks)
{
    place p[PLACES];
    planet body;
    places_of(p);
    planet_make(&body, f, radius, 0);
    const rings_geometry *g = &((const rings_surface *)body.globe.surface)->geometry;
    tc_renderer_destroy(body.globe.renderer);
    for (int i = 0; i < g->levels; i++) {
        float(*v)[4] = (float(*)[4])body.globe.surface->geometry.vertices + tc_rings_fill_base(g, i);
        for (int k = 0; k <= g->n_phi; k++)
            v[k][0] *= 0.9f, v[k][1] *= 0.9f;
    }
    tc_scene_options look = {.unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1};
    tc_error error;
    if (tc_renderer_create(body.globe.gl, body.globe.surface, &look, &body.globe.renderer, &error))
        exit(99);
    test_random r = {5};
    sight s = {0};
    for (int k = 0; k < PLACES; k++) {
        tc_camera c = rings_view_at(body.atlas, p[k].longitude, p[k].latitude,
                                    as_cracks ? radius * pow(10, 0.5 - k % 5) : rings_altitude(k, radius), &r);
        c.pitch = -M_PI / 2;
        look_for_holes(&body.globe, &c, &s);
    }
    extreme_at_most(name, as_cracks ? "cracks not found" : "holes not found", (as_cracks ? s.cracks : s.holes) < 20, 0,
                    "%lld holes, %lld cracks of %lld suspects in %d views", (long long)s.holes, (long long)s.cracks,
                    (long long)s.suspects, PLACES);
    planet_drop(&body);
}

/* A globe whose heights go from low to high radii. */
static tc_grid grid_of(double radius, double low, double high)
{
    tc_grid g = {.width = 256, .height = 128, .spacing_x = 1, .spacing_y = 1};
    const double d = 360. / 256, t[6] = {-180, d, 0, 90, 0, -d};
    g.z = malloc(256 * 128 * sizeof *g.z);
    for (int i = 0; i < 256 * 128; i++)
        g.z[i] = (float)(radius * (low + (high - low) * (i % 256) / 255));
    g.z_min = g.z[0], g.z_max = g.z[255];
    g.georef = (tc_georef){.known = true, .geographic = true};
    memcpy(g.georef.transform, t, sizeof t);
    return g;
}

static tc_status packed(const char *path, double radius, double low, double high, tc_error *error)
{
    tc_grid g = grid_of(radius, low, high);
    tc_pack_terrain terrain = {.width = g.width,
                               .height = g.height,
                               .wraps_x = true,
                               .radius = radius,
                               .spacing_x = 1,
                               .spacing_y = 1,
                               .georef = g.georef,
                               .sample_type = TC_SAMPLE_FLOAT32,
                               .unit = 1};
    tc_pack_options options = {.mode = TC_PACK_RMS, .error = 1e-3 * radius};
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_rect all = {0, 0, g.width, g.height};
    tc_status status = tc_packer_create(path, &terrain, &options, &packer, error);
    if (!status)
        status = tc_packer_put(packer, all, g.z, NULL, g.width, error);
    if (!status)
        status = tc_packer_finish(packer, &result, error);
    tc_packer_destroy(packer);
    tc_grid_free(&g);
    return status;
}

/* Another radius into a packed planet's head, with its checksums. */
static void shrink(const char *path, double radius)
{
    size_t size;
    uint8_t *bytes = packing_bytes(path, &size);
    size_t after = envelope_head_at(bytes, 1); /* the radius is the last of its container's head */
    uint64_t bits;
    memcpy(&bits, &radius, 8);
    tc_store(bytes + after - 8, bits, 8);
    envelope_sign(bytes);
    make_bytes(path, bytes, size);
    free(bytes);
}

static void refusals(void)
{
    static const struct {
        double low, high;
        const char *name;
    } relief[] = {{-1.5, 0.2, "1.5 radii down"},
                  {-1, 0, "down to the centre"},
                  {-0.1, 1.2, "1.2 radii up"},
                  {-1000, 1000, "1000 radii up and down"}};
    char name[100];
    tc_error error = {0};
    tc_map *atlas;
    for (size_t k = 0; k < sizeof relief / sizeof *relief; k++) {
        tc_grid g = grid_of(EARTH, relief[k].low, relief[k].high);
        snprintf(name, sizeof name, "relief %s, heights in memory", relief[k].name);
        error = (tc_error){0};
        tc_status status = tc_map_build(&g, EARTH, 1, &atlas, &error);
        extreme_refused(name, status, TC_ERR_FORMAT, error.text);
        snprintf(name, sizeof name, "relief %s, packed", relief[k].name);
        error = (tc_error){0};
        status = packed(made_path("tall.tclip"), EARTH, relief[k].low, relief[k].high, &error);
        extreme_refused(name, status, TC_ERR_FORMAT, error.text);
    }
    const char *path = made_path("planet.tclip");
    if (packed(path, EARTH, -0.001, 0.001, &error))
        exit(99);
    shrink(path, 1000);
    error = (tc_error){0};
    extreme_refused("a packed planet whose head has a radius of 1 km", tc_map_open(path, NULL, &atlas, &error),
                    TC_ERR_FORMAT, error.text);
    error = (tc_error){0};
    extreme_refused("the same, as the viewer opens it",
                    tc_map_load(path, NULL, &(tc_load_options){.body = &tc_sphere_body}, &atlas, &error), TC_ERR_FORMAT,
                    error.text);
    static const double none[] = {-1, NAN, INFINITY};
    for (int k = 0; k < 3; k++) {
        tc_grid g = grid_of(EARTH, 0, 0.001);
        error = (tc_error){0};
        snprintf(name, sizeof name, "a radius of %g m", none[k]);
        extreme_refused(name, tc_map_build(&g, none[k], 1, &atlas, &error), TC_ERR_USAGE, error.text);
    }
}

int main(void)
{
    extreme_begin("planet");
    refusals();
    context = scene_context();
    if (context) {
        radii();
        flattenings();
        altitudes();
        open_disc(globe_rough, 1e6, "a disc smaller than its hole", false);
        tall(hills, 0.99, "hills and valleys of 0.99 radii");
        open_disc(hills, EARTH, "a disc smaller than its hole on such hills", true);
        tall(needles, 0.5, "needles of half a radius");
        tc_context_destroy(context);
    } else {
        extreme_skipped("views of planets", "no OpenGL context");
    }
    made_folder_remove();
    return extreme_end();
}
