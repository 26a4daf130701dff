/* test_globe_cost.c - what a walk costs near a pole, and that a planet's flat picture and its globe agree. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/map/map.h"
#include "planar/square.h"
#include "spherical/rings_internal.h"
#include "tests/support/made_files.h"
#include "tests/support/packed_map.h"
#include "tests/support/planet_scene.h"
#include "tests/support/sweep.h"

#define DEGREE (M_PI / 180)
static const double spacing = 2 * M_PI * 100e3 / 8192; /* 77 m, so that 10 km are 130 samples */
static int columns;                                    /* of a sweep that is not whole half as many */
static double radius;

static tc_context *context;
static tc_map *memory;
static const char *path;

/* Harmonics and finer hills, down to a few samples. */
static double hills(void *ctx, const double p[3])
{
    double z = planet_smooth(ctx, p), a = 60, f = 0.4e-3 * radius;
    for (int k = 0; k < 5; k++, a *= 0.5, f *= 2.1)
        z += a * sin(f * p[0] + k) * cos(f * p[1] - 2 * k) + a * sin(f * p[2] + f * 0.3 * p[1]);
    return z;
}

static int set_up(void **state)
{
    (void)state;
    double relief = 1000;
    context = scene_context();
    columns = sweep_whole() ? 8192 : 4096, radius = columns * spacing / (2 * M_PI);
    memory = planet_atlas(columns, radius, hills, &relief);
    path = made_path("planet.tclip");
    packed_map(memory, path);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_map_destroy(memory);
    tc_context_destroy(context);
    made_folder_remove();
    return 0;
}

/* ---- A walk ------------------------------------------------------------------------------------------------------ */

typedef struct cost {
    int64_t samples, uploaded, decoded;
} cost;

static int64_t bytes_decoded(const tc_map *atlas)
{
    int64_t sum = 0;
    for (int k = 0; k < atlas->charts; k++)
        sum += tc_field_tell(atlas->chart[k].field).decoded;
    return sum;
}

/* 10 km (of a sweep that is not whole, 5) in steps of 20 m, 2 m above ground: along the parallel, or along the meridian
 * (and over the pole). Counts what is updated after the first frame, and all that is decoded. */
static cost walk(const tc_map *atlas, double latitude, bool north)
{
    const tc_scene_options options = {.background_set = true, .budget = -1};
    const int steps = sweep_whole() ? 500 : 250;
    scene s = planet_scene(context, atlas, &(tc_rings_options){0}, &options);
    cost sum = {0};
    scene_leave_draws_out(s.surface);
    for (int i = 0; i <= steps; i++) {
        double way = 20.0 * i / radius, lat = latitude * DEGREE + (north ? way : 0), ground;
        tc_camera c = {.x = 0.3 + (north ? 0 : way / cos(lat)), .y = lat, .fov = M_PI / 2, .width = 32, .height = 24};
        if (lat > M_PI / 2)
            c.x += M_PI, c.y = M_PI - lat;
        c.x = remainder(c.x, 2 * M_PI);
        assert_int_equal(planet_atlas_height((void *)atlas, c.x, c.y, &ground), TC_OK);
        c.z = ground + 2, c.pitch = 1.2; /* up */
        tc_frame_stats stats = scene_draw(&s, &c, true);
        if (i > 0)
            sum.samples += stats.samples_updated, sum.uploaded += stats.bytes_uploaded;
    }
    scene_put_draws_back(s.surface);
    sum.decoded = bytes_decoded(atlas);
    scene_destroy(&s);
    return sum;
}

static void walks_near_a_pole_cost_no_more(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++)
        for (int north = 0; north < 2; north++) {
            cost at[3];
            const double latitude[3] = {0, 57.5, 89.9};
            for (int i = 0; i < 3; i++) {
                tc_map *packed; /* opened anew: nothing is decoded yet */
                if (k)
                    assert_int_equal(tc_map_open(path, NULL, &packed, NULL), TC_OK);
                at[i] = walk(k ? packed : memory, latitude[i], north);
                if (k)
                    tc_map_destroy(packed);
                printf("globe walk: %s, %s from %g: %lld samples updated, %lld bytes uploaded, %lld decoded: %.2f, "
                       "%.2f, %.2f times the equator's\n",
                       k ? "packed" : "in memory", north ? "north" : "east", latitude[i], (long long)at[i].samples,
                       (long long)at[i].uploaded, (long long)at[i].decoded,
                       (double)at[i].samples / (double)at[0].samples, (double)at[i].uploaded / (double)at[0].uploaded,
                       (double)at[i].decoded / fmax(1, (double)at[0].decoded));
            }
            assert_true(at[0].samples > 10000 && (k == 0 || at[0].decoded > 1000));
            assert_true(at[2].samples <= 4 * at[0].samples);
            assert_true(at[2].uploaded <= 4 * at[0].uploaded);
            assert_true(at[2].decoded <= 4 * at[0].decoded);
        }
}

/* ---- Flat and round ---------------------------------------------------------------------------------------------- */

/* The same pyramid drawn by square grids, on triangles, and by rings, on a bilinear surface sampled by their own mesh:
 * next to the viewer, where both have the finest level, they differ by what a cell is not flat. */
static void flat_map_and_globe_agree(void **state)
{
    (void)state;
    tc_chart *chart = &memory->chart[0];
    int m = tc_field_info(chart->field)->levels;
    tc_level size = tc_field_level(chart->field, m);
    const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1};
    scene flat = scene_create(context, chart->field, 255, &options);
    scene round = planet_scene(context, memory, &(tc_rings_options){0}, &options);
    test_random r = {3};
    double worst = 0, sum = 0, most = 0, curved = 0, count = 0;
    for (int view = 0; view < 40; view++) {
        double i0 = test_random_range(&r, 1000, columns - 1000),
               j0 = (double)(size.height - 1) * test_random_range(&r, 0.25, 0.75);
        tc_camera f = {.x = i0 * size.spacing_x, .y = j0 * size.spacing_y, .fov = 1, .width = 64, .height = 48}, g = f;
        g.x = chart->x0 + i0 * chart->dx, g.y = chart->y0 + j0 * chart->dy;
        double ground;
        assert_int_equal(planet_atlas_height(memory, g.x, g.y, &ground), TC_OK);
        f.z = g.z = ground + 2;
        scene_draw(&flat, &f, true), scene_draw(&round, &g, true);
        for (int k = 0; k < 300; k++) {
            double a = test_random_range(&r, 0, 2 * M_PI), d = 20 * sqrt(test_random_unit(&r)), i = i0 + d * cos(a),
                   j = j0 + d * sin(a), z0, z1;
            float z[16];
            int64_t x = (int64_t)floor(i), y = (int64_t)floor(j);
            assert_true(scene_height(&flat, &f, &options.frame, i * size.spacing_x, j * size.spacing_y, &z0));
            assert_true(
                scene_height(&round, &g, &options.frame, chart->x0 + i * chart->dx, chart->y0 + j * chart->dy, &z1));
            assert_int_equal(tc_field_read(chart->field, m, (tc_rect){x - 1, y - 1, x + 3, y + 3}, z, NULL, 4), TC_OK);
            /* What the mesh, of triangles up to a cell or so wide, can make of the samples around. */
            double bend = 0;
            for (int q = 0; q < 3; q++)
                for (int p = 0; p < 3; p++)
                    bend = fmax(
                        bend, fabs((double)z[4 * q + p] - z[4 * q + p + 1] - z[4 * q + p + 4] + z[4 * q + p + 5]) / 4);
            for (int q = 0; q < 4; q++)
                for (int p = 0; p < 2; p++) {
                    bend = fmax(bend, fabs((double)z[4 * q + p] - 2.0 * z[4 * q + p + 1] + z[4 * q + p + 2]) / 2);
                    bend = fmax(bend, fabs((double)z[4 * p + q] - 2.0 * z[4 * p + q + 4] + z[4 * p + q + 8]) / 2);
                }
            double e = fabs(z0 - z1);
            worst = fmax(worst, e), sum += e * e, count++, curved = fmax(curved, bend), most = fmax(most, e - 2 * bend);
        }
    }
    printf(
        "flat and round: %g places within 20 samples: rms %.4f m, max %.3f m; cells are bent by up to %.3f m; at most "
        "%.4f m more than twice their own bend\n",
        count, sqrt(sum / count), worst, curved, most);
    assert_true(most < 0.05);
    assert_true(curved > 0.1 && worst > 0);
    scene_destroy(&flat), scene_destroy(&round);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walks_near_a_pole_cost_no_more),
        cmocka_unit_test(flat_map_and_globe_agree),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
