/* test_resample.c - planets on the faces of an octahedron and of a cube: heights come through, seams are one on all
 * levels, what is beyond a side is what the neighbour has there, and nothing depends on threads. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/base/rect.h"
#include "common/chart/joined.h"
#include "common/chart/resample.h"
#include "common/content/ground.h"
#include "common/map/map.h"
#include "tests/support/stripes.h"

static const tc_atlas *const atlases[] = {&tc_atlas_hex, &tc_atlas_cube};
enum { ATLASES = 2 };

typedef double formula(const double n[3]);

static double constant(const double n[3])
{
    (void)n;
    return 1234.5;
}

static double linear(const double n[3])
{
    return 1000 * n[0] - 700 * n[1] + 1300 * n[2];
}

static double rough(const double n[3])
{
    return 1000 * n[2] + 300 * sin(7 * n[0] + 2 * n[1]) + 200 * cos(9 * n[2] - 3 * n[0]) +
           100 * sin(11 * n[1] + 5 * n[0] * n[2]);
}

static void normal_of(double lon, double lat, double n[3])
{
    n[0] = cos(lat) * cos(lon), n[1] = cos(lat) * sin(lon), n[2] = sin(lat);
}

/* Rows from pole to pole, or half a row from them. */
static tc_grid grid_of(formula *f, int64_t width, int64_t height, bool half)
{
    tc_grid g = {.width = width, .height = height, .spacing_x = 1, .spacing_y = 1};
    double dy = 180.0 / (double)(half ? height : height - 1), dx = 360.0 / (double)width, south = half ? dy / 2 : 0;
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = 6371000};
    const double t[6] = {-180 - dx / 2, dx, 0, 90 - south + dy / 2, 0, -dy};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc((size_t)(width * height) * sizeof *g.z);
    assert_non_null(g.z);
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++) {
            double n[3];
            normal_of((-180 + dx * (double)i) * M_PI / 180, (-90 + south + dy * (double)j) * M_PI / 180, n);
            g.z[j * width + i] = (float)f(n);
        }
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t i = 0; i < width * height; i++)
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    return g;
}

static tc_map *planet(tc_grid *g)
{
    tc_map *map;
    tc_error error;
    if (tc_map_build(g, 6371000, 2, &map, &error))
        fail_msg("%s", error.text);
    return map;
}

static tc_map *resampled(const tc_map *from, const tc_atlas *atlas, int threads)
{
    tc_map *map;
    tc_error error;
    if (tc_map_resample(from, atlas, threads, &map, &error))
        fail_msg("%s", error.text);
    return map;
}

static int levels_of(const tc_map *map)
{
    return tc_field_info(map->chart[0].field)->levels;
}

/* The largest error of a level of a face against a formula, with `beyond` samples beyond its sides. */
static double worst(const tc_map *map, int level, formula *f, int beyond, bool poles)
{
    double most = 0;
    for (int k = 0; k < map->charts; k++) {
        const tc_chart *c = &map->chart[k];
        const tc_level size = tc_field_level(c->field, level);
        tc_rect r = tc_rect_grown((tc_rect){0, 0, size.width, size.height}, beyond);
        int64_t w = r.x1 - r.x0;
        float *z = malloc((size_t)tc_rect_area(r) * sizeof *z);
        assert_non_null(z);
        assert_int_equal(tc_field_read(c->field, level, r, z, NULL, w), TC_OK);
        double d = ldexp(c->dx, levels_of(map) - level);
        for (int64_t j = r.y0; j < r.y1; j++)
            for (int64_t i = r.x0; i < r.x1; i++) {
                double lon, lat, n[3], x = (double)i * d, y = (double)j * d;
                c->class->to_place(c, x, y, &lon, &lat);
                normal_of(lon, lat, n);
                double off = fabs((double)z[(j - r.y0) * w + i - r.x0] - f(n));
                if (poles || fabs(lat) < M_PI / 2 - 12 * d)
                    most = fmax(most, off);
            }
        free(z);
    }
    return most;
}

static void formulas_come_through(void **state)
{
    (void)state;
    for (int half = 0; half < 2; half++)
        for (int a = 0; a < ATLASES; a++) {
            tc_grid g = grid_of(constant, 512, half ? 256 : 257, half);
            tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
            for (int l = 1; l <= levels_of(map); l++)
                assert_true(worst(map, l, constant, TC_BEYOND, true) == 0);
            tc_map_destroy(from), tc_map_destroy(map);
            g = grid_of(linear, 512, half ? 256 : 257, half);
            from = planet(&g), map = resampled(from, atlases[a], 2);
            int m = levels_of(map);
            /* 2,000 m from one side to the other; samples 78 km apart, 15 to 30 m of it. */
            double finest = worst(map, m, linear, 0, true), beyond = worst(map, m, linear, TC_BEYOND, true),
                   coarser = worst(map, m - 1, linear, 0, false), poles = worst(map, m - 1, linear, 0, true),
                   third = worst(map, m - 2, linear, 0, true);
            printf("%s%s: linear, off by %.4f m, beyond sides %.4f; next level %.4f, at poles %.4f; third %.4f\n",
                   atlases[a]->name, half ? ", areas" : "", finest, beyond, coarser, poles, third);
            /* Rows of hex turn at the equator, and run together at the poles: there filters see what is no straight
             * line. */
            bool turns = atlases[a] == &tc_atlas_hex;
            assert_true(finest < 0.05 && beyond < 0.05 && coarser < (turns ? 1 : 0.1) && poles < (turns ? 5 : 0.1));
            tc_map_destroy(from), tc_map_destroy(map);
        }
}

/* ---- Seams ------------------------------------------------------------------------------------------------------- */

static float sample(const tc_map *map, int chart, int level, int64_t i, int64_t j)
{
    float z;
    assert_int_equal(tc_field_read(map->chart[chart].field, level, (tc_rect){i, j, i + 1, j + 1}, &z, NULL, 1), TC_OK);
    return z;
}

static void seams_are_one(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(rough, 256, 129, false);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        int64_t finest = tc_field_level(map->chart[0].field, levels_of(map)).width - 1;
        int looked = 0;
        for (int l = levels_of(map), coarser = 0; (finest >> coarser) << coarser == finest && l >= 1; l--, coarser++) {
            int64_t cells = finest >> coarser;
            for (int k = 0; k < map->charts; k++)
                for (int side = 0; side < TC_SIDES; side++) {
                    const tc_seam s = map->chart[k].class->seam(k, side, cells);
                    for (int64_t t = 0; t <= cells; t++) {
                        int64_t at = side == TC_EAST || side == TC_NORTH ? cells : 0;
                        bool along_y = side == TC_WEST || side == TC_EAST;
                        int64_t i = along_y ? at : t, j = along_y ? t : at;
                        float z = sample(map, k, l, i, j), its = sample(map, s.chart, l, s.m[0] * i + s.m[1] * j + s.dx,
                                                                        s.m[2] * i + s.m[3] * j + s.dy);
                        assert_memory_equal(&z, &its, sizeof z);
                        looked++;
                    }
                }
        }
        assert_true(looked > 2 * map->charts * (int)finest);
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

/* Parts of a rectangle read alone are those of the whole. */
static void parts_are_the_whole(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(rough, 256, 129, false);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        for (int n = 0; n < 600; n++) {
            int k = n % map->charts, l = levels_of(map) - n % 3;
            const tc_level size = tc_field_level(map->chart[k].field, l);
            int64_t side = size.width + 2 * TC_BEYOND, w = 1 + (int64_t)(tc_hash64(3, (uint64_t)n) % 30);
            int64_t h = 1 + (int64_t)(tc_hash64(4, (uint64_t)n) % 30);
            tc_rect r = {.x0 = (int64_t)(tc_hash64(5, (uint64_t)n) % (uint64_t)(side - w)) - TC_BEYOND,
                         .y0 = (int64_t)(tc_hash64(6, (uint64_t)n) % (uint64_t)(side - h)) - TC_BEYOND};
            r.x1 = r.x0 + w, r.y1 = r.y0 + h;
            float whole[900], one;
            assert_int_equal(tc_field_read(map->chart[k].field, l, r, whole, NULL, w), TC_OK);
            for (int t = 0; t < 20; t++) {
                int64_t i = (int64_t)(tc_hash64(7, (uint64_t)(20 * n + t)) % (uint64_t)w);
                int64_t j = (int64_t)(tc_hash64(8, (uint64_t)(20 * n + t)) % (uint64_t)h);
                one = sample(map, k, l, r.x0 + i, r.y0 + j);
                assert_memory_equal(&one, &whole[j * w + i], sizeof one);
            }
        }
        float z;
        assert_int_equal(
            tc_field_read(map->chart[0].field, 1 + levels_of(map) / 2, (tc_rect){-9, 0, -8, 1}, &z, NULL, 1),
            TC_ERR_USAGE);
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    tc_grid g = grid_of(rough, 256, 129, false);
    tc_map *from = planet(&g);
    for (int a = 0; a < ATLASES; a++) {
        tc_map *one = resampled(from, atlases[a], 1), *four = resampled(from, atlases[a], 4);
        for (int k = 0; k < one->charts; k++)
            for (int l = 1; l <= levels_of(one); l++) {
                const tc_level size = tc_field_level(one->chart[k].field, l);
                size_t count = (size_t)(size.width * size.height);
                tc_rect r = {0, 0, size.width, size.height};
                float *p = malloc(2 * count * sizeof *p);
                assert_non_null(p);
                assert_int_equal(tc_field_read(one->chart[k].field, l, r, p, NULL, size.width), TC_OK);
                assert_int_equal(tc_field_read(four->chart[k].field, l, r, p + count, NULL, size.width), TC_OK);
                assert_memory_equal(p, p + count, count * sizeof *p);
                free(p);
            }
        tc_map_destroy(one), tc_map_destroy(four);
    }
    tc_map_destroy(from);
}

/* Every sample of every chart lies within the ranges told of it. */
static void ranges_hold(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(rough, 256, 129, false);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        for (int k = 0; k < map->charts; k++)
            for (int l = 1; l <= levels_of(map); l++) {
                const tc_level size = tc_field_level(map->chart[k].field, l);
                for (int64_t j = 0; j < size.height; j += 3)
                    for (int64_t i = 0; i < size.width; i += 3) {
                        float z = sample(map, k, l, i, j);
                        tc_range r = tc_field_range(map->chart[k].field, l, (tc_rect){i, j, i + 1, j + 1});
                        assert_true(z >= r.lo && z <= r.hi);
                    }
            }
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

/* ---- Windows ----------------------------------------------------------------------------------------------------- */

enum { N = 63 };

static double steep(const double n[3])
{
    return 60 * rough(n);
}

static double formula_at(const tc_chart *c, formula *f, double x, double y)
{
    double lon, lat, n[3];
    c->class->to_place(c, x, y, &lon, &lat);
    normal_of(lon, lat, n);
    return f(n);
}

/* How far a level's normals on column i of a window are from those of the formula, in steps of a texel. */
static double normals_off(const tc_chart *c, const tc_clipmap *windows, int level, int64_t i, int64_t from, int64_t to)
{
    const int8_t(*texel)[4] = tc_ground_normals(windows, level);
    double apart = ldexp(c->dx, tc_clipmap_level(windows, level)->shift), most = 0;
    double spacing = tc_field_level(c->field, tc_clipmap_field_level(windows, level)).spacing_x;
    for (int64_t j = from; j < to; j++) {
        double x = (double)i * apart, y = (double)j * apart, half = apart / 2;
        double dx = (formula_at(c, steep, x + half, y) - formula_at(c, steep, x - half, y)) / spacing,
               dy = (formula_at(c, steep, x, y + half) - formula_at(c, steep, x, y - half)) / spacing,
               scale = -127 / sqrt(1 + dx * dx + dy * dy);
        const int8_t *t = texel[(2 * j & (2 * N + 1)) * 2 * (N + 1) + (2 * i & (2 * N + 1))];
        most = fmax(most, fmax(fabs(dx * scale - t[0]), fabs(dy * scale - t[1])));
    }
    return most;
}

/* Heights and morph targets of a seam are the same from both charts, and normals there are as good as elsewhere: what
 * is beyond the side is known. */
static void windows_meet(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(steep, 256, 129, false);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        tc_clipmap *windows[6];
        tc_rect wanted[TC_MAX_LEVELS];
        for (int k = 0; k < map->charts; k++) {
            const tc_ground_options options = {.n = N, .normals = true};
            assert_int_equal(tc_ground_create(map->chart[k].field, &options, &windows[k], NULL), TC_OK);
        }
        int levels = tc_clipmap_levels(windows[0]);
        int64_t looked = 0;
        assert_true(levels >= 2);
        for (int k = 0; k < map->charts; k++)
            for (int side = 0; side < TC_SIDES; side++) {
                const tc_seam *seam = &map->chart[k].side[side];
                int64_t cells = (int64_t)rint(1 / map->chart[k].dx),
                        at = side == TC_EAST || side == TC_NORTH ? cells : 0;
                bool along_y = side == TC_WEST || side == TC_EAST;
                int64_t p[2] = {along_y ? at : cells / 2, along_y ? cells / 2 : at};
                int64_t q[2] = {seam->m[0] * p[0] + seam->m[1] * p[1] + seam->dx,
                                seam->m[2] * p[0] + seam->m[3] * p[1] + seam->dy};
                stripes_want(windows[k], p[0], p[1], wanted);
                tc_clipmap_update(windows[k], wanted, -1, true, 0);
                stripes_want(windows[seam->chart], q[0], q[1], wanted);
                tc_clipmap_update(windows[seam->chart], wanted, -1, true, 0);
                for (int l = 1; l <= levels; l++) {
                    const tc_clip_level *one = tc_clipmap_level(windows[k], l),
                                        *two = tc_clipmap_level(windows[seam->chart], l);
                    const tc_seam s = map->chart[k].class->seam(k, side, cells >> one->shift);
                    for (int64_t t = 0; t <= cells >> one->shift; t++) {
                        int64_t i = along_y ? at >> one->shift : t, j = along_y ? t : at >> one->shift;
                        int64_t u = s.m[0] * i + s.m[1] * j + s.dx, v = s.m[2] * i + s.m[3] * j + s.dy;
                        if (!tc_rect_contains(one->clip, i, j) || !tc_rect_contains(two->clip, u, v))
                            continue;
                        assert_memory_equal(tc_ground_heights(windows[k], l)[(j & N) * (N + 1) + (i & N)],
                                            tc_ground_heights(windows[seam->chart], l)[(v & N) * (N + 1) + (u & N)], 8);
                        looked++;
                    }
                }
            }
        assert_true(looked > 500);
        for (int k = 0; k < map->charts; k++) {
            int64_t cells = (int64_t)rint(1 / map->chart[k].dx);
            for (int l = levels; l >= levels - 1; l--) {
                int64_t apart = (int64_t)1 << (levels - l), half = cells / apart / 4; /* away from where rows turn */
                stripes_want(windows[k], 0, half * apart, wanted);
                tc_clipmap_update(windows[k], wanted, -1, true, 0);
                double seam = normals_off(&map->chart[k], windows[k], l, 0, half - 6, half + 6);
                double inside = normals_off(&map->chart[k], windows[k], l, 5, half - 6, half + 6);
                assert_true(seam < 0.6 && inside < 0.6);
            }
            tc_clipmap_destroy(windows[k]);
        }
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

/* ---- There and back ---------------------------------------------------------------------------------------------- */

static void there_and_back(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        double before = INFINITY;
        for (int64_t width = 128; width <= 512; width *= 2) {
            tc_grid g = grid_of(rough, width, width / 2 + 1, false);
            tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
            tc_round_trip trip;
            assert_int_equal(tc_resample_round_trip(&(tc_resample_source){from->chart, from->charts, false}, map->chart,
                                                    map->charts, 2, &trip),
                             TC_OK);
            printf("%s, %d columns: rms %.4f m, largest %.4f m\n", atlases[a]->name, (int)width, trip.rms, trip.max);
            assert_true(trip.samples == width * (width / 2 + 1) && trip.rms < before / 2.8);
            before = trip.rms;
            tc_map_destroy(from), tc_map_destroy(map);
        }
        assert_true(before < 0.06); /* of 3,000 */
    }
}

/* A place's height is that of the formula whichever chart has it. */
static void places_have_heights(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(rough, 1024, 513, false);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        for (int n = 0; n < 2000; n++) {
            double lon = 2 * M_PI * (double)(tc_hash64(1, (uint64_t)n) >> 11) / 9007199254740992.0,
                   lat = asin(2 * (double)(tc_hash64(2, (uint64_t)n) >> 11) / 9007199254740992.0 - 1), z, p[3];
            if (n < 12)
                lon = n % 4 * M_PI / 2, lat = (n / 4 - 1) * M_PI / 2;
            normal_of(lon, lat, p);
            assert_int_equal(tc_map_height(map, lon, lat, &z), TC_OK);
            assert_true(fabs(z - rough(p)) < 2); /* triangles 40 km wide */
        }
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

/* ---- Voids ------------------------------------------------------------------------------------------------------- */

static void voids_are_carried(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++)
        for (int a = 0; a < ATLASES; a++) {
            tc_grid g = grid_of(linear, 256, 129, false);
            g.voids = calloc((size_t)(g.width * g.height), 1);
            assert_non_null(g.voids);
            for (int64_t j = 0; j < g.height; j++)
                for (int64_t i = 0; i < g.width;
                     i++) /* around a pole, across two seams, and next to the antimeridian */
                    if (j > 122 || (j > 40 && j < 60 && i > 120 && i < 140) || (j < 70 && j > 60 && (i < 9 || i > 250)))
                        g.voids[j * g.width + i] = 1, g.void_count++;
            g.voids_flat = flat, g.void_height = -5000;
            uint8_t *voids = malloc((size_t)(g.width * g.height));
            assert_non_null(voids);
            memcpy(voids, g.voids, (size_t)(g.width * g.height));
            tc_map *from = planet(&g);
            from->voids = flat ? TC_VOIDS_CONSTANT : TC_VOIDS_FILL;
            tc_map *map = resampled(from, atlases[a], 2);
            int m = levels_of(map), seen = 0;
            for (int k = 0; k < map->charts; k++) {
                const tc_chart *c = &map->chart[k];
                const tc_level size = tc_field_level(c->field, m);
                for (int64_t j = 0; j < size.height; j++)
                    for (int64_t i = 0; i < size.width; i++) {
                        double lon, lat, n[3];
                        float z;
                        uint8_t hole;
                        assert_int_equal(tc_field_read(c->field, m, (tc_rect){i, j, i + 1, j + 1}, &z, &hole, 1),
                                         TC_OK);
                        c->class->to_place(c, (double)i * c->dx, (double)j * c->dx, &lon, &lat);
                        normal_of(lon, lat, n);
                        int64_t column = (int64_t)floor((lon / M_PI + 1) * 128 + 0.5) % 256,
                                row = (int64_t)floor((lat / M_PI + 0.5) * 128 + 0.5);
                        if (fabs(lat) < 0.9) /* where caps have no share */
                            assert_int_equal(hole, voids[row * 256 + (column + 256) % 256]);
                        seen += hole;
                        if (hole && flat)
                            assert_true(z == -5000);
                        if (!hole) /* nothing of -5000 has run into it */
                            assert_true(fabs((double)z - linear(n)) < 60);
                    }
            }
            assert_true(seen > 100);
            free(voids);
            tc_map_destroy(from), tc_map_destroy(map);
        }
}

/* ---- Synthesis --------------------------------------------------------------------------------------------------- */

/* Root mean square of what is no straight line across column i of a chart. */
static double bend_across(const tc_map *map, int k, int level, int64_t i)
{
    const tc_level size = tc_field_level(map->chart[k].field, level);
    double sum = 0;
    int count = 0;
    for (int64_t j = size.height / 4; j < 3 * size.height / 4; j++, count++) {
        double bend =
            sample(map, k, level, i - 1, j) - 2 * (double)sample(map, k, level, i, j) + sample(map, k, level, i + 1, j);
        sum += bend * bend;
    }
    return sqrt(sum / count);
}

static void synthesis_joins(void **state)
{
    (void)state;
    for (int a = 0; a < ATLASES; a++) {
        tc_grid g = grid_of(rough, 512, 257, false);
        for (int64_t n = 0; n < g.width * g.height; n++)
            g.z[n] += 40 * ((float)(tc_hash64(17, (uint64_t)n) >> 40) / 16777216 - 0.5f);
        tc_map *from = planet(&g), *map = resampled(from, atlases[a], 2);
        tc_error error;
        int data = levels_of(map);
        if (tc_map_synthesise(map, 3, &error))
            fail_msg("%s", error.text);
        assert_true(map->synthesised == 3 && levels_of(map) == data + 3);
        for (int l = data; l <= data + 3; l++) {
            int64_t cells = tc_field_level(map->chart[0].field, l).width - 1;
            for (int k = 0; k < map->charts; k++) {
                const tc_seam s = map->chart[k].side[TC_WEST], at = map->chart[k].class->seam(k, TC_WEST, cells);
                assert_true(s.chart == at.chart && (l < data + 3 || (s.dx == at.dx && s.dy == at.dy)));
                for (int64_t j = 0; j <= cells; j += 5) {
                    float z = sample(map, k, l, 0, j),
                          its = sample(map, at.chart, l, at.m[1] * j + at.dx, at.m[3] * j + at.dy);
                    assert_memory_equal(&z, &its, sizeof z);
                }
                double seam = bend_across(map, k, l, 0), inside = bend_across(map, k, l, cells / 3);
                /* Noise that went on to the side would be 2 to 3 times as much on the third level. */
                if (l == data + 3 && !(seam < 1.5 * inside && inside > 0.1))
                    fail_msg("%s, face %d, level %d of %d: %g m across the seam, %g inside", atlases[a]->name, k, l,
                             data, seam, inside);
            }
        }
        tc_map_destroy(from), tc_map_destroy(map);
    }
}

static void others_are_refused(void **state)
{
    (void)state;
    tc_error error;
    tc_map *map = NULL;
    tc_grid g = grid_of(linear, 128, 65, false);
    g.height = 60; /* not to a pole */
    tc_map *part = planet(&g);
    assert_int_equal(tc_map_resample(part, &tc_atlas_hex, 1, &map, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "expected a planet as a whole"));
    tc_map_destroy(part);
    g = grid_of(linear, 128, 65, false);
    tc_map *whole = planet(&g), *hex = resampled(whole, &tc_atlas_hex, 1);
    assert_int_equal(tc_map_resample(hex, &tc_atlas_cube, 1, &map, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "found hex"));
    tc_map_destroy(whole), tc_map_destroy(hex);
    assert_null(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formulas_come_through), cmocka_unit_test(seams_are_one),
        cmocka_unit_test(parts_are_the_whole),   cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(ranges_hold),           cmocka_unit_test(there_and_back),
        cmocka_unit_test(places_have_heights),   cmocka_unit_test(voids_are_carried),
        cmocka_unit_test(windows_meet),          cmocka_unit_test(synthesis_joins),
        cmocka_unit_test(others_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
