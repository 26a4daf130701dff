/* measured.c - what errors are measured on. */
#include "measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/planet_place.h"

#define DEGREE (M_PI / 180)
enum { MOST_FLAT = 1, MOST_ROUND = 1, DEFAULT_PLANET = 2048 };

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "measured: %s\n", error->text);
        exit(1);
    }
}

/* The file's name without what a CSV file minds. With its end: a folder may hold one terrain in two formats. */
static void set_name(measured *m, const char *file)
{
    snprintf(m->name, sizeof m->name, "%s", file);
    for (char *c = m->name; *c; c++)
        if (*c == ',' || *c == '"' || *c == ' ' || (unsigned char)*c < ' ')
            *c = '_';
}

static bool is_globe(const dataset *d, const tc_grid *g)
{
    tc_planet_place place;
    tc_error error;
    return d->spacing == 0 &&
           tc_planet_place_raster(d->name, NULL, g->width, g->height, &g->georef, true, &place, &error) == TC_OK;
}

static void open_globe(const dataset *d, measured *m)
{
    char path[4096];
    tc_error error;
    snprintf(path, sizeof path, "%s/%s", getenv("TERRACLIP_DATA"), d->name);
    const tc_load_options load = {.body = &tc_sphere_body, .whole = true};
    must(tc_map_load(path, &(tc_source_options){.unit = d->unit}, &load, &m->planet, &error), &error);
    m->round = true;
}

void measured_close(measured *m)
{
    if (m->round)
        tc_map_destroy(m->planet);
    else
        tc_field_destroy(m->field);
}

measured measured_default_planet(void)
{
    measured m = {.name = "default-planet", .round = true};
    m.planet = planet_made(PLANET_DEFAULT, DEFAULT_PLANET, 6371000, 4);
    return m;
}

void measured_all(bool quick, void (*measure)(void *context, const measured *m), void *context)
{
    dataset list[DATASETS_MAX];
    int count = dataset_list(list, DATASETS_MAX), flat = 0, round = 0;
    measured planet = measured_default_planet();
    measure(context, &planet);
    measured_close(&planet);
    for (int i = 0; i < count; i++) {
        measured m = {0};
        tc_grid grid;
        tc_error error;
        bool ours = i == 0;
        if (quick && flat >= MOST_FLAT && round >= MOST_ROUND)
            break;
        if (!dataset_load(&list[i], &grid))
            continue;
        set_name(&m, list[i].name);
        bool globe = !ours && is_globe(&list[i], &grid);
        if (quick && !ours && (globe ? round >= MOST_ROUND : flat >= MOST_FLAT)) {
            tc_grid_free(&grid);
            continue;
        }
        if (globe)
            tc_grid_free(&grid), open_globe(&list[i], &m);
        else
            must(tc_field_build(&grid, 0, &m.field, &error), &error);
        round += globe, flat += !globe && !ours;
        measure(context, &m);
        measured_close(&m);
    }
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

static tc_level finest_of(const measured *m)
{
    return tc_field_level(m->field, tc_field_info(m->field)->levels);
}

double measured_height(const measured *m, int height)
{
    if (m->round) {
        static const double situation[MEASURED_HEIGHTS] = {2, 10e3, 1e6, 1e7};
        double r = m->planet->body.radius;
        return height && r < 1.5e6 ? situation[height] * r / 6371e3 : situation[height];
    }
    static const double ladder[] = {0.002, 0.02, 0.2, 2, 30, 300, 3e3, 3e4, 3e5, 3e6, 3e7};
    enum { RUNGS = sizeof ladder / sizeof *ladder };
    tc_level l = finest_of(m);
    double extent = fmin((double)l.width * l.spacing_x, (double)l.height * l.spacing_y);
    int top = MEASURED_HEIGHTS - 1;
    while (top + 1 < RUNGS && ladder[top + 1] <= 0.4 * extent)
        top++;
    return ladder[top - (MEASURED_HEIGHTS - 1) + height];
}

void measured_scene_name(const measured *m, int height, char *text, size_t size)
{
    double metres = measured_height(m, height);
    snprintf(text, size, "%s-%g%s", m->name, metres >= 1000 ? metres / 1000 : metres, metres >= 1000 ? "km" : "m");
}

static tc_status flat_height(void *field, double x, double y, double *z_ret)
{
    tc_status status = tc_field_height(field, x, y, z_ret);
    *z_ret += tc_field_info(field)->z_base;
    return status;
}

tc_truth measured_truth(const measured *m)
{
    return m->round ? (tc_truth){planet_atlas_height, m->planet} : (tc_truth){flat_height, m->field};
}

tc_body measured_body(const measured *m)
{
    return tc_body_of(m->round ? m->planet->body.radius : 0);
}

tc_camera measured_camera(const measured *m, int height, int place, int width, int height_px)
{
    static const double flat_place[MEASURED_PLACES][2] = {{0.5, 0.5}, {0.36, 0.61}};
    static const double flat_pitch[MEASURED_HEIGHTS] = {-5, -10, -25, -50};
    static const double round_place[MEASURED_PLACES][2] = {{10.3, 46.4}, {-75.2, -20.5}};
    static const double round_pitch[MEASURED_HEIGHTS] = {-5, -25, -50, -90};
    static const double heading[MEASURED_PLACES] = {0.6, 2.5};
    tc_camera c = {.heading = heading[place], .width = width, .height = height_px};
    if (m->round) {
        c.x = round_place[place][0] * DEGREE, c.y = round_place[place][1] * DEGREE;
        c.pitch = round_pitch[height] * DEGREE, c.fov = 60 * DEGREE;
    } else {
        tc_level l = finest_of(m);
        c.x = flat_place[place][0] * (double)(l.width - 1) * l.spacing_x;
        c.y = flat_place[place][1] * (double)(l.height - 1) * l.spacing_y;
        c.pitch = flat_pitch[height] * DEGREE, c.fov = 90 * DEGREE;
    }
    tc_truth truth = measured_truth(m);
    if (truth.height(truth.context, c.x, c.y, &c.z))
        exit(1);
    c.z += measured_height(m, height);
    return c;
}

scene measured_scene(const tc_context *context, const measured *m, int n, const tc_rings_options *rings,
                     const tc_scene_options *options)
{
    tc_scene_options o = *options;
    o.unlit = true, o.background_set = true, o.budget = -1;
    if (!m->round)
        return scene_create(context, m->field, n, &o);
    tc_rings_options r = *rings;
    r.n_phi = n;
    return planet_scene(context, m->planet, &r, &o);
}
