/* test_globe_error.c - what is drawn of a planet is where it should be: no ring, meridian, pole or passage between
 * charts can be seen.
 *
 * Planets whose heights are functions of the direction in space, so that nothing on them marks a pole or a meridian.
 * Each pixel's depth, unprojected, is compared with the function (view_error.h); where the planet ends against the
 * background, with rays through it. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/view/camera.h"
#include "common/measure/view_error.h"
#include "spherical/faces_internal.h"
#include "tests/support/planet_scene.h"
#include "tests/support/sweep.h"

#define DEGREE (M_PI / 180)
enum { PLANETS = 6, COLUMNS = 2048 };
static const double radius = 1737400;
static double relief = 4000;

static tc_context *context;
static tc_map *planet[PLANETS];
static planet_truth truth[PLANETS] = {{planet_slope, &relief},  {planet_smooth, &relief}, {planet_smooth, &relief},
                                      {planet_smooth, &relief}, {planet_smooth, &relief}, {planet_slope, &relief}};
static const double flattening[PLANETS] = {0, 0, 0.02, 0, 0, 0.02};
static const faces_kind *const faces[PLANETS] = {[3] = &tc_faces_hex, [4] = &tc_faces_cube, [5] = &tc_faces_hex};
static const char *const kind[PLANETS] = {"constant gradient",         "harmonics",
                                          "harmonics on an ellipsoid", "harmonics by hex",
                                          "harmonics by cube",         "constant gradient on an ellipsoid by hex"};

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < PLANETS; k++) {
        planet[k] = planet_flattened(planet_atlas(COLUMNS, radius, truth[k].height, truth[k].context), flattening[k]);
        if (faces[k])
            planet[k] = planet_of_faces(planet[k], faces[k]->chart);
    }
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < PLANETS; k++)
        tc_map_destroy(planet[k]);
    tc_context_destroy(context);
    return 0;
}

static const double altitudes[] = {2, 30, 1000, 10e3, 100e3, 1e6, 5};
static const double places[][2] = {{20, 0.3},    {-130, 33},  {180, 12},     {-179.99, -48}, {77, 57.5},
                                   {-60, -57.5}, {10, 89.95}, {-100, -89.9}, {0, 90},        {45, -90}};
enum { ALTITUDES = sizeof altitudes / sizeof *altitudes, PLACES = sizeof places / sizeof *places };

static tc_camera camera_at(int k, int a, int p, int look)
{
    tc_camera c = {
        .x = places[p][0] * DEGREE, .y = places[p][1] * DEGREE, .fov = M_PI / 3, .width = 200, .height = 150};
    double ground;
    planet_truth_height(&truth[k], c.x, c.y, &ground);
    c.z = ground + (a == ALTITUDES - 1 ? 5 * radius : altitudes[a]);
    double dip = acos(radius / (radius + fmax(c.z, 1)));
    c.heading = 0.7 + 2.1 * look + p;
    c.pitch = look == 0 ? fmax(-dip - 0.15, -M_PI / 2) : look == 1 ? -M_PI / 2 : fmax(-dip - 0.6, -M_PI / 2);
    return c;
}

/* The least height of a ray above the terrain, in pixels of its distance. */
static double clearance(const planet_truth *t, const tc_body *body, const tc_camera *c, const double d[3])
{
    double scale = tc_camera_pixel_scale(c), least = INFINITY, far = 2 * (radius + c->z), step = 0.02, at = 0;
    for (double s = 0.1; s < far; s *= 1 + step) {
        double p[3], z, e[3] = {s * d[0], s * d[1], s * d[2]};
        tc_view_place(c, body, e, p);
        if (p[2] > relief && (least < 0 || d[2] > 0))
            break;
        planet_truth_height((void *)t, p[0], p[1], &z);
        if ((p[2] - z) / s * scale < least)
            least = (p[2] - z) / s * scale, at = s;
    }
    for (double s = at * (1 - step); s < at * (1 + step); s += at * step / 50) {
        double p[3], z, e[3] = {s * d[0], s * d[1], s * d[2]};
        tc_view_place(c, body, e, p);
        planet_truth_height((void *)t, p[0], p[1], &z);
        least = fmin(least, (p[2] - z) / s * scale);
    }
    return least;
}

typedef struct silhouette {
    int64_t rays, missing, extra;
} silhouette;

/* Rays that clear the terrain by a pixel, or pass a pixel below its top, where the picture changes. */
static void compare_silhouette(const planet_truth *t, const tc_body *body, const tc_camera *c, const float *depth,
                               silhouette *out)
{
    for (int y = 1; y < c->height - 1; y++)
        for (int x = 1; x < c->width - 1; x++) {
            const float *q = depth + y * c->width + x;
            bool here = *q > 0, edge = false;
            for (int i = -3; i <= 3; i++) {
                int v = y + i < 0 ? 0 : y + i >= c->height ? c->height - 1 : y + i;
                int u = x + i < 0 ? 0 : x + i >= c->width ? c->width - 1 : x + i;
                edge |= (depth[v * c->width + x] > 0) != here || (depth[y * c->width + u] > 0) != here;
            }
            if (!edge && (x % 16 || y % 16))
                continue;
            double d[3];
            tc_view_ray(c, x + 0.5, y + 0.5, d);
            double least = clearance(t, body, c, d);
            out->rays++;
            out->missing += least < -1 && !here;
            out->extra += least > 1 && here;
        }
}

static void nothing_marks_a_place(void **state)
{
    (void)state;
    const tc_scene_options options = {.unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1};
    silhouette s = {0};
    for (int k = 0; k < PLANETS; k++) {
        scene at = faces[k]
                       ? planet_scene_of(context, planet[k], planet_faces(planet[k], faces[k], 511, &options), &options)
                       : planet_scene(context, planet[k], &(tc_rings_options){0}, &options);
        for (int a = 0; a < ALTITUDES; a++) {
            tc_error_stats all, finest;
            assert_int_equal(tc_error_stats_init(&all) || tc_error_stats_init(&finest), 0);
            double worst = 0;
            int worst_place = 0;
            for (int p = 0; p < PLACES; p++) {
                tc_error_stats one;
                assert_int_equal(tc_error_stats_init(&one), 0);
                for (int look = 0; look < 3; look++) {
                    if (!sweep_whole() && (look != (p + a) % 3 || (p + a + k) % 2))
                        continue; /* a sixth: every place from every other altitude */
                    tc_camera c = camera_at(k, a, p, look);
                    scene_draw(&at, &c, true);
                    float *depth = planet_depth(&at, &c);
                    const tc_truth function = {planet_truth_height, &truth[k]}, data = {planet_atlas_height, planet[k]};
                    double near = at.surface->near_plane;
                    assert_int_equal(tc_view_error_add(&c, near, &planet[k]->body, depth, &function, &one), TC_OK);
                    assert_int_equal(tc_view_error_add(&c, near, &planet[k]->body, depth, &data, &finest), TC_OK);
                    compare_silhouette(&truth[k], &planet[k]->body, &c, depth, &s);
                    free(depth);
                }
                double p999 = tc_error_stats_percentile(&one, 0.999);
                if (p999 > worst)
                    worst = p999, worst_place = p;
                tc_error_stats_merge(&all, &one);
                tc_error_stats_free(&one);
            }
            printf(
                "globe error: %s, %g m: %lld pixels, to the function rms %.4f, 99.9 %% %.4f (at worst %.4f, at %g %g), "
                "max %.3f px; to the finest samples 99.9 %% %.4f, max %.3f px\n",
                kind[k], a == ALTITUDES - 1 ? 5 * radius : altitudes[a], (long long)all.count, tc_error_stats_rms(&all),
                tc_error_stats_percentile(&all, 0.999), worst, places[worst_place][0], places[worst_place][1], all.max,
                tc_error_stats_percentile(&finest, 0.999), finest.max);
            /* From near the ground the samples, kilometres apart, do not say how the function is between them; by the
             * triangles of faces, which are bent around a pole, less than by rings' bilinear cells. */
            assert_true(tc_error_stats_percentile(&finest, 0.999) < 0.5);
            assert_true(worst < 1 || altitudes[a] < (faces[k] ? 1000 : 30));
            tc_error_stats_free(&all), tc_error_stats_free(&finest);
        }
        scene_destroy(&at);
    }
    printf("globe silhouettes: %lld rays, %lld of them through terrain that is missing, %lld past it\n",
           (long long)s.rays, (long long)s.missing, (long long)s.extra);
    assert_true(s.rays > 10000);
    assert_true(s.missing + s.extra <= s.rays / 10000);
}

/* Held against a planet that is turned by a hundredth of a degree or has another pole, errors are large. */
static tc_status turned(void *t, double longitude, double latitude, double *z_ret)
{
    return planet_truth_height(t, longitude + 0.02 * DEGREE, latitude, z_ret);
}

static void the_test_finds_errors(void **state)
{
    (void)state;
    const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1};
    scene at = planet_scene(context, planet[1], &(tc_rings_options){0}, &options);
    tc_camera c = camera_at(1, 1, 1, 2);
    scene_draw(&at, &c, true);
    float *depth = planet_depth(&at, &c);
    tc_error_stats stats;
    assert_int_equal(tc_error_stats_init(&stats), TC_OK);
    assert_int_equal(
        tc_view_error_add(&c, at.surface->near_plane, &planet[1]->body, depth, &(tc_truth){turned, &truth[1]}, &stats),
        TC_OK);
    printf("globe error: against one turned by 0.02 degrees: 99.9 %% %.2f px\n",
           tc_error_stats_percentile(&stats, 0.999));
    assert_true(tc_error_stats_percentile(&stats, 0.999) > 1);
    planet_truth lower = {planet_slope, &relief};
    silhouette s = {0};
    c = camera_at(1, 2, 1, 0);
    scene_draw(&at, &c, true);
    free(depth), depth = planet_depth(&at, &c);
    compare_silhouette(&lower, &planet[1]->body, &c, depth, &s);
    printf("globe silhouettes: of another planet: %lld of %lld rays differ\n", (long long)(s.missing + s.extra),
           (long long)s.rays);
    assert_true(s.missing + s.extra > s.rays / 100);
    free(depth), tc_error_stats_free(&stats), scene_destroy(&at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_marks_a_place),
        cmocka_unit_test(the_test_finds_errors),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
