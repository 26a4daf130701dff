/* test_fidelity.c - pictures cast ray by ray, and the measures that hold others against them. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fidelity.h"
#include "tests/support/plain_mesh.h"
#include "tests/support/ray_cast.h"

/* ---- Measures of nearness ---------------------------------------------------------------------------------------- */

enum { W = 40, H = 31 };

static void fill(uint8_t *rgb, int level)
{
    memset(rgb, level, 3 * W * H);
}

static void equal_pictures_are_alike(void **state)
{
    (void)state;
    uint8_t a[3 * W * H];
    test_random r = {1};
    for (int i = 0; i < 3 * W * H; i++)
        a[i] = (uint8_t)test_random_int(&r, 0, 255);
    assert_float_equal(picture_ssim(a, a, W, H), 1, 1e-12);
    assert_true(picture_rmse(a, a, W, H) == 0);
    assert_true(isnan(picture_ssim(a, a, 10, 40)));
}

/* Of two flat pictures only the term of luminance is left; of one and its negative around the middle it is negative. */
static void known_values(void **state)
{
    (void)state;
    uint8_t a[3 * W * H], b[3 * W * H];
    fill(a, 100), fill(b, 140);
    double c1 = 6.5025;
    assert_float_equal(picture_ssim(a, b, W, H), (2 * 100. * 140 + c1) / (100. * 100 + 140. * 140 + c1), 1e-9);
    assert_float_equal(picture_rmse(a, b, W, H), 40, 1e-12);
    for (int i = 0; i < 3 * W * H; i++)
        a[i] = (uint8_t)(i / 3 % 2 ? 228 : 28), b[i] = (uint8_t)(256 - a[i]);
    assert_true(picture_ssim(a, b, W, H) < -0.9);
}

/* One window, straight from the definition. */
static void one_window_by_the_definition(void **state)
{
    (void)state;
    uint8_t a[3 * 121], b[3 * 121];
    test_random r = {2};
    for (int i = 0; i < 3 * 121; i++)
        a[i] = (uint8_t)test_random_int(&r, 0, 255), b[i] = (uint8_t)((a[i] + test_random_int(&r, 0, 90)) / 2);
    double sum = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0, w[121], la[121], lb[121];
    for (int i = 0; i < 121; i++) {
        double x = i % 11 - 5, y = i / 11 - 5;
        sum += w[i] = exp(-(x * x + y * y) / 4.5);
        la[i] = 0.299 * a[3 * i] + 0.587 * a[3 * i + 1] + 0.114 * a[3 * i + 2];
        lb[i] = 0.299 * b[3 * i] + 0.587 * b[3 * i + 1] + 0.114 * b[3 * i + 2];
    }
    for (int i = 0; i < 121; i++)
        w[i] /= sum, ma += w[i] * la[i], mb += w[i] * lb[i];
    for (int i = 0; i < 121; i++) {
        va += w[i] * (la[i] - ma) * (la[i] - ma), vb += w[i] * (lb[i] - mb) * (lb[i] - mb);
        cov += w[i] * (la[i] - ma) * (lb[i] - mb);
    }
    double c1 = 6.5025, c2 = 58.5225;
    double want = (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    assert_float_equal(picture_ssim(a, b, 11, 11), want, 1e-9);
}

/* ---- Rays -------------------------------------------------------------------------------------------------------- */

static void unit(test_random *r, double d[3])
{
    double l = 0;
    while (l < 0.1 || l > 1) {
        for (int i = 0; i < 3; i++)
            d[i] = test_random_range(r, -1, 1);
        l = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    for (int i = 0; i < 3; i++)
        d[i] /= l;
}

/* z = 0.25 x + 0.5 y. */
static void a_plane_is_met_where_it_is(void **state)
{
    (void)state;
    enum { SIZE = 301 };
    const double extent = (SIZE - 1) * 30.;
    tc_field *p = terrain_field(TERRAIN_SLOPE, SIZE, SIZE, 30, 1);
    ray_flat *f = ray_flat_create(p);
    test_random r = {3};
    int hits = 0, misses = 0;
    for (int i = 0; i < 20000; i++) {
        tc_camera c = {.x = test_random_range(&r, -2000, extent + 2000),
                       .y = test_random_range(&r, -2000, extent + 2000)};
        c.z = 0.25 * c.x + 0.5 * c.y + test_random_range(&r, 1, 5000);
        double d[3], got, fall;
        unit(&r, d);
        if (i % 50 == 0)
            d[0] = d[1] = 0, d[2] = -1;
        fall = 0.25 * d[0] + 0.5 * d[1] - d[2];
        double want = (c.z - 0.25 * c.x - 0.5 * c.y) / fall, x = c.x + want * d[0], y = c.y + want * d[1];
        double edge = 0; /* where the ray comes in from outside it must be above */
        for (int k = 0; k < 2; k++) {
            double o = k ? c.y : c.x, t = o < 0 ? -o / d[k] : o > extent ? (extent - o) / d[k] : 0;
            edge = fmax(edge, t);
        }
        bool there = fall > 0 && edge <= want && x >= 0 && y >= 0 && x <= extent && y <= extent;
        if (fall > 0 && fmin(fmin(fabs(x), fabs(y)), fmin(fabs(x - extent), fabs(y - extent))) < 0.01)
            continue; /* on the edge */
        assert_int_equal(ray_flat_hit(f, &c, d, &got), there);
        if (there)
            assert_float_equal(got, want, 1e-6 * want);
        hits += there, misses += !there;
    }
    assert_true(hits > 3000 && misses > 3000);
    ray_flat_destroy(f), tc_field_destroy(p);
}

/* Cliffs: each ray ends on the ground, and nothing is in its way before. */
static void rays_end_at_the_first_ground(void **state)
{
    (void)state;
    enum { SIZE = 150, STEPS = 4000 };
    tc_field *p = terrain_field(TERRAIN_CLIFF, SIZE, SIZE, 300, 1);
    ray_flat *f = ray_flat_create(p);
    test_random r = {4};
    int hits = 0;
    for (int i = 0; i < 2000; i++) {
        tc_camera c = {.x = test_random_range(&r, 3000, 40000), .y = test_random_range(&r, 3000, 40000)};
        double d[3], got, ground;
        assert_int_equal(tc_field_height(p, c.x, c.y, &ground), TC_OK);
        c.z = ground + test_random_range(&r, 1, 3000);
        unit(&r, d);
        bool hit = ray_flat_hit(f, &c, d, &got);
        hits += hit;
        for (int k = 1; k <= STEPS; k++) {
            double s = hit ? got * (1 - 1e-7) * k / STEPS : 60000. * k / STEPS, x = c.x + s * d[0], y = c.y + s * d[1];
            if (x < 0 || y < 0 || x > (SIZE - 1) * 300. || y > (SIZE - 1) * 300.)
                break;
            assert_int_equal(tc_field_height(p, x, y, &ground), TC_OK);
            assert_true(c.z + s * d[2] - ground > -1e-3);
        }
        if (hit) {
            assert_int_equal(tc_field_height(p, c.x + got * d[0], c.y + got * d[1], &ground), TC_OK);
            assert_float_equal(c.z + got * d[2], ground, 1e-2); /* walls: metres a millimetre aside */
        }
    }
    assert_true(hits > 1000);
    ray_flat_destroy(f), tc_field_destroy(p);
}

/* A planet of one height is a sphere. */
static double level_ground(void *context, const double p[3])
{
    (void)p;
    return *(double *)context;
}

static void a_sphere_is_met_where_it_is(void **state)
{
    (void)state;
    double z = 1500, radius = 1e6 + z;
    tc_map *a = planet_atlas(256, 1e6, level_ground, &z);
    ray_globe *g = ray_globe_create(a);
    test_random r = {5};
    int hits = 0, misses = 0;
    for (int i = 0; i < 3000; i++) {
        tc_camera c = {.x = test_random_range(&r, -4, 4), .y = asin(test_random_range(&r, -1, 1))};
        c.z = z + pow(10, test_random_range(&r, 0, 6.5));
        double d[3], got, up = 1e6 + c.z;
        unit(&r, d);
        double b = up * d[2], q = b * b - (up - radius) * (up + radius);
        if (fabs(q) < 1e-5 * up * up) /* grazing */
            continue;
        bool there = q > 0 && b < 0;
        assert_int_equal(ray_globe_hit(g, &c, d, &got), there);
        if (there)
            assert_float_equal(got, (up - radius) * (up + radius) / (-b + sqrt(q)), 1e-5 + 1e-9 * got);
        hits += there, misses += !there;
    }
    assert_true(hits > 500 && misses > 500);
    ray_globe_destroy(g), tc_map_destroy(a);
}

/* And one of height 0 an ellipsoid, which is a sphere where it is stretched along its axis. */
static void an_ellipsoid_is_met_where_it_is(void **state)
{
    (void)state;
    const double flattening = 0.05, stretch = 1 / (1 - flattening), radius = 1e6;
    double z = 0;
    tc_map *a = planet_flattened(planet_atlas(256, radius, level_ground, &z), flattening);
    ray_globe *g = ray_globe_create(a);
    test_random r = {5};
    int hits = 0, misses = 0;
    for (int i = 0; i < 3000; i++) {
        tc_camera c = {.x = test_random_range(&r, -4, 4), .y = asin(test_random_range(&r, -1, 1))};
        c.z = z + pow(10, test_random_range(&r, 0, 6.5));
        double d[3], got, eye[3], axes[3][3], e2 = 0, w2 = 0, ew = 0;
        const double place[3] = {c.x, c.y, c.z};
        unit(&r, d);
        a->body.class->position(&a->body, place, eye);
        a->body.class->axes(&a->body, place, axes);
        for (int k = 0; k < 3; k++) {
            double s = k == 2 ? stretch : 1, e = s * eye[k];
            double w = s * (d[0] * axes[0][k] + d[1] * axes[1][k] + d[2] * axes[2][k]);
            e2 += e * e, w2 += w * w, ew += e * w;
        }
        double c2 = e2 - radius * radius, q = ew * ew - w2 * c2;
        if (fabs(q) < 1e-5 * w2 * e2) /* grazing */
            continue;
        bool there = q > 0 && ew < 0;
        assert_int_equal(ray_globe_hit(g, &c, d, &got), there);
        if (there)
            assert_float_equal(got, c2 / (-ew + sqrt(q)), 1e-4 + 1e-9 * got);
        hits += there, misses += !there;
    }
    assert_true(hits > 500 && misses > 500);
    ray_globe_destroy(g), tc_map_destroy(a);
}

/* Rough planet, all latitudes. Beyond what steps may miss of a crest nothing is in the way. */
static void planets_first_ground(double flattening)
{
    enum { STEPS = 3000 };
    tc_map *a = planet_flattened(planet_made(PLANET_CLIFF, 256, 1737400, 1), flattening);
    ray_globe *g = ray_globe_create(a);
    test_random r = {6};
    int hits = 0;
    double worst = -INFINITY;
    for (int i = 0; i < 600; i++) {
        tc_camera c = {.x = test_random_range(&r, -4, 4), .y = asin(test_random_range(&r, -1, 1)), .width = 640};
        double d[3], got, ground;
        assert_int_equal(planet_atlas_height(a, c.x, c.y, &ground), TC_OK);
        c.z = ground + pow(10, test_random_range(&r, 1, 6));
        unit(&r, d);
        if (!ray_globe_hit(g, &c, d, &got))
            continue;
        hits++;
        for (int k = 1; k <= STEPS; k++) {
            double s = got * k / STEPS, p[3];
            const double e[3] = {s * d[0], s * d[1], s * d[2]};
            tc_view_place(&c, &a->body, e, p);
            assert_int_equal(planet_atlas_height(a, p[0], p[1], &ground), TC_OK);
            if (k == STEPS)
                assert_float_equal(p[2], ground, 1e-3 + 1e-9 * s);
            else
                worst = fmax(worst, (ground - p[2]) / s * 554);
        }
    }
    print_message("rays of a planet of cliffs: %d meet it, at most %.4f pixels through a crest\n", hits, worst);
    assert_true(hits > 200 && worst < 0.5);
    ray_globe_destroy(g), tc_map_destroy(a);
}

static void rays_end_at_a_planets_first_ground(void **state)
{
    (void)state;
    planets_first_ground(0);
    planets_first_ground(WGS84_FLATTENING);
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

/* The finest level drawn as one mesh, or by squares as large as the terrain, is what rays see, colours included; with a
 * moved eye it is not. */
static void drawn_and_cast_pictures_agree(void **state)
{
    (void)state;
    tc_context *context = scene_context();
    if (!context)
        skip();
    measured m = {.name = "default", .field = terrain_field(TERRAIN_DEFAULT, 257, 257, 30, 4)};
    const uint8_t background[3] = {10, 20, 200};
    caster *cast = caster_create(&m);
    tc_camera c = measured_camera(&m, 2, 0, 320, 240);
    cast_picture truth = caster_picture(cast, &c, background);
    scene s = measured_scene(context, &m, 511, NULL, &(tc_scene_options){.background = {10, 20, 200}});
    scene_draw(&s, &c, true);
    uint8_t *drawn = scene_pixels(&s, &c);
    float *depth = planet_depth(&s, &c);
    int64_t pixels = 0;
    for (int i = 0; i < c.width * c.height; i++)
        pixels += (depth[i] > 0) != (truth.distance[i] > 0);
    double ssim = picture_ssim(drawn, truth.rgb, c.width, c.height),
           rmse = picture_rmse(drawn, truth.rgb, c.width, c.height);
    print_message("drawn and cast: SSIM %.5f, RMSE %.3f levels, %lld of %lld pixels on the other side of an edge\n",
                  ssim, rmse, (long long)pixels, (long long)truth.covered);
    assert_true(truth.covered > 10000 && pixels < 30 && ssim > 0.995 && rmse < 1.5);
    c.x += 30;
    cast_picture moved = caster_picture(cast, &c, background);
    assert_true(picture_ssim(drawn, moved.rgb, c.width, c.height) < ssim - 0.005);
    cast_picture_free(&truth), cast_picture_free(&moved);
    free(drawn), free(depth);
    scene_destroy(&s), caster_destroy(cast), measured_close(&m);
    tc_context_destroy(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_are_alike),        cmocka_unit_test(known_values),
        cmocka_unit_test(one_window_by_the_definition),    cmocka_unit_test(a_plane_is_met_where_it_is),
        cmocka_unit_test(rays_end_at_the_first_ground),    cmocka_unit_test(a_sphere_is_met_where_it_is),
        cmocka_unit_test(an_ellipsoid_is_met_where_it_is), cmocka_unit_test(rays_end_at_a_planets_first_ground),
        cmocka_unit_test(drawn_and_cast_pictures_agree),
    };
    return cmocka_run_group_tests_name("fidelity", tests, NULL, NULL);
}
