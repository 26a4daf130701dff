/* bench_rings_error.c - what rings would draw if their steps were chosen by error, beside what hexagons and the cube
 * draw by the same tolerance; counts alone, rings_error.csv.
 *
 * A ring covers an octave of distance from the eye and has 2^q steps around. For each ring, in each of 32 sectors, q is
 * the least with which the mesh keeps to the tolerance by the bound that blocks go by: errors of leaves of 16 x 16
 * samples on longitude and latitude, and what flat triangles cut off, at the nearest place. Cells of a ring are taken
 * for those of the level next to them in size: that is too kind to them, since their vertices lie between samples.
 * Sectors are then joined, to one for all directions, to 8, 16 and 32; neighbours, around and outwards, differ by a
 * factor of 2 at most. Rings end at the horizon, and of a ring sectors of 32 are counted that are in view. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/field/measured_errors.h"
#include "common/map/map.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum { WIDTH = 640, HEIGHT = 480, PLACES = 4, TOLERANCES = 3, RINGS = 30, SECTORS = 32, LEAST_Q = 3, MOST_Q = 15 };
static const double tolerances[TOLERANCES] = {2, 1, 0.5};
enum { WAYS = 4 };
static const int joined[WAYS] = {1, 8, 16, 32};

/* What is known of the ground around the eye. */
typedef struct surroundings {
    double error[TC_MAX_FIELD_LEVELS][RINGS][SECTORS]; /* [l - 1]: of the mesh of level l */
    double highest[RINGS][SECTORS];                    /* metres above z_base */
} surroundings;

/* Adds a leaf of a level to all rings and sectors that it touches. */
static void add_leaf(surroundings *s, int level, const tc_range *r, double theta, double azimuth, double half)
{
    const double near = fmax(theta - half, 1e-12), far = fmin(theta + half, M_PI);
    const int last = (int)fmin(floor(log2(M_PI / near)), RINGS - 1), first = (int)fmax(floor(log2(M_PI / far)), 0);
    const double apart = theta > half ? asin(fmin(sin(half) / fmax(sin(theta), 1e-12), 1)) : M_PI;
    const int from = (int)floor((azimuth - apart) / (2 * M_PI) * SECTORS),
              to = (int)fmin(floor((azimuth + apart) / (2 * M_PI) * SECTORS), from + SECTORS - 1);
    for (int i = first; i <= last; i++)
        for (int k = from; k <= to; k++) {
            const int sector = (k % SECTORS + SECTORS) % SECTORS;
            double *error = &s->error[level - 2][i][sector], *highest = &s->highest[i][sector];
            *error = fmax(*error, (double)r->error), *highest = fmax(*highest, (double)r->hi);
        }
}

/* Leaves of chart 0, longitude and latitude; the finest level's mesh has no error. */
static void look_around(const tc_chart *chart, const tc_camera *c, surroundings *s)
{
    const int levels = tc_field_info(chart->field)->levels;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < SECTORS; k++) {
            s->highest[i][k] = -INFINITY;
            for (int l = 1; l <= levels; l++)
                s->error[l - 1][i][k] = 0;
        }
    for (int l = 2; l <= levels; l++) {
        const tc_level size = tc_field_level(chart->field, l);
        const double dx = ldexp(chart->dx, levels - l), dy = ldexp(chart->dy, levels - l);
        for (int64_t y = 0; y < size.height; y += TC_ERROR_TILE)
            for (int64_t x = 0; x < size.width; x += TC_ERROR_TILE) {
                const tc_rect leaf = {x, y, tc_min64(x + TC_ERROR_TILE, size.width),
                                      tc_min64(y + TC_ERROR_TILE, size.height)};
                const tc_range r = tc_field_range(chart->field, l, leaf);
                const double lambda = chart->x0 + 0.5 * (double)(leaf.x0 + leaf.x1) * dx - c->x,
                             phi = chart->y0 + 0.5 * (double)(leaf.y0 + leaf.y1) * dy;
                const double north = cos(c->y) * sin(phi) - sin(c->y) * cos(phi) * cos(lambda),
                             east = cos(phi) * sin(lambda),
                             up = sin(c->y) * sin(phi) + cos(c->y) * cos(phi) * cos(lambda);
                const double half =
                    0.5 * hypot((double)(leaf.x1 - leaf.x0) * dx * cos(phi), (double)(leaf.y1 - leaf.y0) * dy);
                add_leaf(s, l, &r, atan2(hypot(north, east), up), atan2(east, north), half);
            }
    }
}

/* Cells of a ring all around, about square. */
static double steps_outwards(int q)
{
    return fmax(rint((1 << q) / (4 * M_PI)), 1);
}

static double triangles_of(int q)
{
    return (1 << q) * steps_outwards(q);
}

/* The least q with which a ring keeps to the tolerance, metres of error a metre of distance. */
static int steps_for(const tc_map *map, const surroundings *s, const tc_camera *c, int ring, int sector,
                     double tolerance)
{
    const tc_field *field = map->chart[0].field;
    const double radius = map->body.radius, outer = ldexp(M_PI, -ring), inner = 0.5 * outer;
    const double above = fmax(c->z - tc_field_info(field)->z_base - s->highest[ring][sector], 0);
    const double allowed = tolerance * hypot(2 * radius * sin(0.5 * inner), above);
    const int levels = tc_field_info(field)->levels;
    for (int q = LEAST_Q; q < MOST_Q; q++) {
        const int steps = 1 << q;
        const double around = 2 * M_PI *
                              sin(outer < 0.5 * M_PI   ? outer
                                  : inner > 0.5 * M_PI ? inner
                                                       : 0.5 * M_PI) *
                              radius / steps,
                     outwards = inner * radius / steps_outwards(q), edge = fmax(around, outwards);
        /* The level whose spacing is nearest; finer ones have no error. */
        const int level = levels - (int)rint(log2(edge / map->spacing_y));
        const double off = level > levels ? 0 : level < 1 ? INFINITY : s->error[level - 1][ring][sector];
        if (off + 2 * edge * edge / (8 * radius) <= allowed)
            return q;
    }
    return MOST_Q;
}

/* Whether some place of a ring's sector is in view, on the sphere. */
static bool in_view(const tc_map *map, const tc_camera *c, int ring, int sector)
{
    enum { PLACES_A_SIDE = 9 };
    const double radius = map->body.radius, wide = tan(0.5 * c->fov), high = wide * c->height / c->width;
    for (int n = 0; n < PLACES_A_SIDE * PLACES_A_SIDE; n++) {
        const double part = (double)(n / PLACES_A_SIDE) / (PLACES_A_SIDE - 1),
                     theta = ldexp(M_PI, -ring - 1) * (1 + part),
                     azimuth = 2 * M_PI / SECTORS * (sector + (double)(n % PLACES_A_SIDE) / (PLACES_A_SIDE - 1));
        const double from = azimuth - c->heading, way = radius * sin(theta), up = radius * cos(theta) - radius - c->z,
                     on = way * cos(from), ahead = on * cos(c->pitch) + up * sin(c->pitch);
        if (ahead > 0 && fabs(way * sin(from)) <= ahead * wide &&
            fabs(up * cos(c->pitch) - on * sin(c->pitch)) <= ahead * high)
            return true;
    }
    return false;
}

/* Triangles of rings whose sectors are joined to so many. */
static int64_t count(const int q[RINGS][SECTORS], const bool seen[RINGS][SECTORS], int rings, int sectors)
{
    int own[RINGS][SECTORS];
    for (int i = 0; i < rings; i++)
        for (int k = 0; k < sectors; k++) {
            own[i][k] = LEAST_Q;
            for (int n = k * SECTORS / sectors; n < (k + 1) * SECTORS / sectors; n++)
                own[i][k] = q[i][n] > own[i][k] ? q[i][n] : own[i][k];
        }
    for (bool again = true; again;) {
        again = false;
        for (int i = 0; i < rings; i++)
            for (int k = 0; k < sectors; k++) {
                const int beside[] = {own[i][(k + 1) % sectors], own[i][(k + sectors - 1) % sectors],
                                      own[i > 0 ? i - 1 : i][k], own[i + 1 < rings ? i + 1 : i][k]};
                for (int n = 0; n < 4; n++)
                    if (beside[n] - 1 > own[i][k])
                        own[i][k] = beside[n] - 1, again = true;
            }
    }
    double sum = 0;
    for (int i = 0; i < rings; i++)
        for (int n = 0; n < SECTORS; n++)
            sum += seen[i][n] * 2.0 / SECTORS * triangles_of(own[i][n * sectors / SECTORS]);
    return llrint(sum);
}

static void count_rings(const tc_map *map, const surroundings *s, const tc_camera *c, double tolerance,
                        int64_t triangles[WAYS])
{
    const tc_terrain_info *info = tc_field_info(map->chart[0].field);
    const double low = map->body.radius + info->z_base + (double)info->z_min,
                 horizon = acos(fmin(low / (map->body.radius + c->z), 1)) +
                           acos(low / (map->body.radius + info->z_base + (double)info->z_max));
    int q[RINGS][SECTORS], rings = 0, first = 0;
    bool seen[RINGS][SECTORS];
    while (ldexp(M_PI, -first - 1) > horizon)
        first++;
    /* Down to the ring that its disc could be as coarse as. */
    for (int ring = first; ring < RINGS; ring++, rings++) {
        int most = LEAST_Q;
        for (int k = 0; k < SECTORS; k++) {
            q[rings][k] = steps_for(map, s, c, ring, k, tolerance);
            most = q[rings][k] > most ? q[rings][k] : most;
            seen[rings][k] = in_view(map, c, ring, k);
        }
        if (most == LEAST_Q && ring > first) {
            rings++;
            break;
        }
    }
    for (int w = 0; w < WAYS; w++)
        triangles[w] += count((const int(*)[SECTORS])q, (const bool(*)[SECTORS])seen, rings, joined[w]);
}

typedef struct bench {
    measure_options options;
    tc_context *context;
    surroundings around;
} bench;

static int64_t count_scheme(const bench *b, const scheme_planet *planet, const tc_scheme *scheme,
                            const tc_camera *camera, double tolerance)
{
    scene s = scheme_scene_within(b->context, planet, scheme, scheme_size(scheme, 3), tolerance);
    int64_t sum = 0;
    for (int k = 0; k < PLACES; k++)
        sum += scene_draw(&s, &camera[k], true).triangles;
    scene_destroy(&s);
    return sum;
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    bench *b = context;
    test_random r = {15};
    tc_field_know_errors(planet->source->chart[0].field);
    for (int kind = VIEW_GROUND; kind <= VIEW_SPACE; kind++) {
        tc_camera camera[PLACES];
        int64_t rings[TOLERANCES][WAYS] = {{0}};
        for (int k = 0; k < PLACES; k++) {
            camera[k] = scheme_camera(&r, planet, (scheme_view)kind, WIDTH, HEIGHT);
            look_around(&planet->source->chart[0], &camera[k], &b->around);
            for (int t = 0; t < TOLERANCES; t++)
                count_rings(planet->source, &b->around, &camera[k], tolerances[t] / tc_camera_pixel_scale(&camera[k]),
                            rings[t]);
        }
        for (int t = 0; t < TOLERANCES; t++) {
            printf("%s-%s, %.1f px: rings", planet->name, scheme_view_name[kind], tolerances[t]);
            for (int w = 0; w < WAYS; w++)
                printf(" %lld by %d sectors,", (long long)rings[t][w], joined[w]);
            for (int k = 0; k < scheme_count(); k++)
                if (scheme_of(k)->by_error) {
                    const int64_t own = count_scheme(b, planet, scheme_of(k), camera, tolerances[t]);
                    printf(" %s %lld", scheme_of(k)->name, (long long)own);
                    if (b->options.csv)
                        fprintf(b->options.csv, "%s,%s,%.3g,%s,%lld,%lld,%lld,%lld,%lld\n", planet->name,
                                scheme_view_name[kind], tolerances[t], scheme_of(k)->name, (long long)own,
                                (long long)rings[t][0], (long long)rings[t][1], (long long)rings[t][2],
                                (long long)rings[t][3]);
                }
            printf("\n");
            fflush(stdout);
        }
    }
}

int main(int argc, char **argv)
{
    static bench b;
    b.options =
        measure_begin(argc, argv, "planet,view,tolerance_px,scheme,triangles,rings_1,rings_8,rings_16,rings_32");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    scheme_planets(b.options.quick, measure_planet, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
