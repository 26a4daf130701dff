/* test_faces_precision.c - vertices of hexagons and of a cube's chunks as the driver computes them, read back, against
 * long double: from every octahedron vertex, edge middle and cube corner, both exact poles, the antimeridian. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "spherical/faces.h"
#include "tests/support/faces_capture.h"
#include "tests/support/globe_scene.h"
#include "tests/support/planet_scene.h"
#include "tests/support/rings_views.h"
#include "tests/support/sweep.h"

/* Bounds: pixels of a frame 1280 wide, samples of the level read. */
#define PIXELS 0.01
#define SAMPLES 1e-3
#define DEGREE (M_PI / 180)

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

enum { SIZE = 1024, PLACES = 100 };

/* Vertices and edge middles of the octahedron, middles of faces, edges and corners of the cube, each also a bit
 * beside; then places that are looked at for rings, random ones among them. */
static void place_of(int i, double *longitude_ret, double *latitude_ret)
{
    static const double special[][2] = {{0, 0},
                                        {90, 0},
                                        {180, 0},
                                        {-90, 0},
                                        {45, 0},
                                        {135, 0},
                                        {0, 45},
                                        {90, 45},
                                        {180, -45},
                                        {-90, -45},
                                        {45, 35.26438968},
                                        {-135, 35.26438968},
                                        {135, -35.26438968},
                                        {-45, -35.26438968},
                                        {45, 20},
                                        {0, 90},
                                        {77, -90}};
    enum { SPECIALS = sizeof special / sizeof *special };
    const double beside = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-9 : -3e-5;
    if (i < 2 * SPECIALS) {
        *longitude_ret = special[i % SPECIALS][0] * DEGREE + (i < SPECIALS ? 0 : beside);
        *latitude_ret = special[i % SPECIALS][1] * DEGREE;
        if (i >= SPECIALS)
            *latitude_ret += special[i % SPECIALS][1] == 90    ? -fabs(beside)
                             : special[i % SPECIALS][1] == -90 ? fabs(beside)
                                                               : beside;
        return;
    }
    rings_place_of(i - 2 * SPECIALS, SIZE, longitude_ret, latitude_ret);
}

/* By distance, or by tolerances of a tenth of a pixel to twenty. */
static faces_error planet(const faces_kind *kind, globe_function height, tc_body body, int places, int altitudes,
                          bool by_error)
{
    tc_map *atlas = planet_of_faces(globe_atlas(height, SIZE, body.radius), kind->chart);
    atlas->body = body;
    tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .frame.error = by_error};
    scene s = planet_scene_of(context, atlas, planet_faces(atlas, kind, 255, &options), &options);
    faces_capture capture = faces_capture_create(tc_context_gl(context), &s, "");
    faces_error all = {0};
    test_random r = {(uint64_t)body.radius};
    for (int place = 0; place < places; place++)
        for (int a = 0; a < altitudes; a++) {
            double longitude, latitude;
            place_of(place, &longitude, &latitude);
            int k = (place + a * RINGS_ALTITUDES / altitudes) % RINGS_ALTITUDES;
            tc_camera c = rings_view_at(atlas, longitude, latitude, rings_altitude(k, body.radius), &r);
            faces_error here = {0};
            if (by_error) {
                options.frame.error = 0.1 * pow(200, test_random_unit(&r));
                tc_renderer_set_options(s.renderer, &options);
            }
            faces_capture_compare(&capture, &c, &options.frame, &here);
            if (getenv("VERBOSE") && (here.pixels > PIXELS || here.samples > SAMPLES))
                fflush(stdout), printf("  place %d (%.17g, %.17g), altitude %g: %.3g pixels, %.3g samples\n", place,
                                       c.x, c.y, rings_altitude(k, body.radius), here.pixels, here.samples);
            all.pixels = fmax(all.pixels, here.pixels), all.samples = fmax(all.samples, here.samples);
            all.vertices += here.vertices, all.seen += here.seen, all.between += here.between;
            all.not_finite += here.not_finite;
        }
    printf(
        "%s, %s of %g m%s: %lld vertices, %lld in frames, %lld of them on their way; worst %.2e pixels, %.2e samples\n",
        kind->name, body.class->name, body.radius, by_error ? ", by tolerances" : "", (long long)all.vertices,
        (long long)all.seen, (long long)all.between, all.pixels, all.samples);
    faces_capture_destroy(&capture);
    scene_destroy(&s);
    tc_map_destroy(atlas);
    return all;
}

static const faces_kind *const kinds[] = {&tc_faces_hex, &tc_faces_cube};
enum { KINDS = 2 };

static void within_bounds(const faces_kind *kind, globe_function height, tc_body body, int places, bool by_error)
{
    faces_error e = planet(kind, height, body, places, sweep_whole() ? 3 : 1, by_error);
    assert_int_equal(e.not_finite, 0);
    assert_true(e.seen > (by_error ? 200 : 2000) * places && e.between > (by_error ? 10 : 100) * places);
    assert_true(e.pixels < PIXELS);
    assert_true(e.samples < SAMPLES);
}

static void spheres_within_a_hundredth_of_a_pixel(void **state)
{
    (void)state;
    static const double radii[] = {1, 1e3, 1737400, 6371000, 1e8};
    for (int k = 0; k < KINDS; k++)
        for (int i = 0; i < 5; i++)
            within_bounds(kinds[k], i % 2 ? globe_smooth : globe_rough, tc_body_of(radii[i]),
                          sweep_whole() ? PLACES
                          : i == 3      ? 40
                                        : 12,
                          false);
}

static void ellipsoids_within_a_hundredth_of_a_pixel(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        within_bounds(kinds[k], globe_rough, tc_body_flattened(6378137, 1 / 298.257223563), sweep_whole() ? PLACES : 36,
                      false);
        within_bounds(kinds[k], globe_smooth, tc_body_flattened(1e5, 0.3), sweep_whole() ? PLACES : 12, false);
    }
}

static void by_tolerances_too(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        within_bounds(kinds[k], globe_fractal, tc_body_of(6371000), sweep_whole() ? PLACES : 14, true);
        within_bounds(kinds[k], globe_smooth, tc_body_of(1e3), sweep_whole() ? PLACES : 6, true);
        within_bounds(kinds[k], globe_rough, tc_body_flattened(6378137, WGS84_FLATTENING), sweep_whole() ? PLACES : 6,
                      true);
    }
}

/* A walk of a metre in steps of a millimetre, 2 m above ground with samples 10 km apart, over a side of a chart: points
 * move on the screen as they do in long double. */
static void nothing_jitters(void **state)
{
    (void)state;
    const double radius = 6371000;
    const int steps = sweep_of(1000);
    for (int k = 0; k < KINDS; k++) {
        tc_map *atlas = planet_of_faces(globe_atlas(globe_rough, 4096, radius), kinds[k]->chart);
        const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1};
        scene s = planet_scene_of(context, atlas, planet_faces(atlas, kinds[k], 255, &options), &options);
        faces_capture capture = faces_capture_create(tc_context_gl(context), &s, "");
        tc_camera c = {.x = 90 * DEGREE, .y = 0.3, .fov = 75 * DEGREE, .width = 1280, .height = 960};
        c.heading = 1.1, c.pitch = -0.3;
        double ground, worst = 0;
        assert_int_equal(tc_map_height(atlas, c.x, c.y, &ground), TC_OK);
        for (int step = 0; step < steps; step++) {
            c.x = 90 * DEGREE + (step - steps / 2) * 1e-3 / (radius * cos(0.3));
            assert_int_equal(tc_map_height(atlas, c.x, c.y, &c.z), TC_OK);
            c.z += 2;
            faces_error here = {0};
            faces_capture_compare(&capture, &c, NULL, &here);
            assert_true(here.seen > 0);
            worst = fmax(worst, here.pixels);
        }
        printf("%s: a walk of %d mm: vertices are at most %.2e pixels off\n", kinds[k]->name, steps, worst);
        assert_true(worst < PIXELS);
        faces_capture_destroy(&capture);
        scene_destroy(&s);
        tc_map_destroy(atlas);
    }
}

/* Vertices that several blocks draw are the same bits in all of them, also across charts; and they are not where each
 * chart goes by its own formulas. */
static void shared_by(double error)
{
    for (int k = 0; k < KINDS; k++) {
        tc_map *atlas =
            planet_of_faces(globe_atlas(error > 0 ? globe_fractal : globe_rough, SIZE, 6371000), kinds[k]->chart);
        const tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .frame.error = error};
        scene s = planet_scene_of(context, atlas, planet_faces(atlas, kinds[k], 127, &options), &options);
        faces_shared found[2] = {{0}};
        for (int own = 0; own < 2; own++) {
            faces_capture capture = faces_capture_create(tc_context_gl(context), &s, own ? "#define UNSETTLED\n" : "");
            test_random r = {3};
            for (int place = 0; place < 34; place++) {
                double longitude, latitude;
                place_of(place, &longitude, &latitude);
                tc_camera c =
                    rings_view_at(atlas, longitude, latitude, rings_altitude(place % RINGS_ALTITUDES, 6371000), &r);
                faces_capture_shared(&capture, &c, &options.frame, &found[own]);
            }
            faces_capture_destroy(&capture);
        }
        printf("%s, tolerance %g: %lld vertices in several blocks, %lld of them in several charts: %lld not the same "
               "bits; by each "
               "chart's own formulas %lld\n",
               kinds[k]->name, error, (long long)found[0].shared, (long long)found[0].across,
               (long long)found[0].different, (long long)found[1].different);
        assert_true(found[0].across > 1000);
        assert_int_equal(found[0].different, 0);
        assert_true(found[1].different > 100);
        scene_destroy(&s);
        tc_map_destroy(atlas);
    }
}

static void vertices_are_shared(void **state)
{
    (void)state;
    shared_by(0);
    shared_by(0.5);
    if (sweep_whole())
        shared_by(3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_within_a_hundredth_of_a_pixel),
        cmocka_unit_test(ellipsoids_within_a_hundredth_of_a_pixel),
        cmocka_unit_test(by_tolerances_too),
        cmocka_unit_test(vertices_are_shared),
        cmocka_unit_test(nothing_jitters),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
