/* test_globe_pictures.c - what a picture of a planet may depend on, and what it must not. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/measure/view_error.h"
#include "spherical/faces_internal.h"
#include "tests/support/planet_scene.h"
#include "tests/support/sweep.h"

enum { PLANETS = 10, DATA = 8 }; /* the first DATA of them are */
static const struct {
    const faces_kind *faces; /* NULL: drawn by rings */
    planet_kind kind;
    int width;
    double radius;
    int synthesised, views;   /* levels finer than the data; flights that end in one */
    int64_t budget;           /* of a slow flight */
    double flattening, error; /* error: the tolerance that blocks are chosen by; 0: none */
} made[PLANETS] = {{NULL, PLANET_DEFAULT, 1024, 6371000, 0, 30, 5000, 0, 0},
                   {NULL, PLANET_CLIFF, 1024, 400e3, 0, 30, 5000, 0, 0},
                   {NULL, PLANET_DEFAULT, 512, 6378137, 0, 10, 5000, WGS84_FLATTENING, 0},
                   {&tc_faces_hex, PLANET_CLIFF, 1024, 400e3, 0, 20, 5000, 0, 0},
                   {&tc_faces_cube, PLANET_CLIFF, 1024, 400e3, 0, 15, 5000, 0, 0},
                   {&tc_faces_hex, PLANET_DEFAULT, 2048, 6378137, 0, 10, 5000, WGS84_FLATTENING, 0},
                   {&tc_faces_hex, PLANET_CLIFF, 1024, 400e3, 0, 15, 5000, 0, 20},
                   {&tc_faces_cube, PLANET_DEFAULT, 2048, 6378137, 0, 15, 5000, WGS84_FLATTENING, 0.5},
                   {NULL, PLANET_DEFAULT, 512, 6371000, 10, 12, 40000, 0, 0},
                   {&tc_faces_hex, PLANET_DEFAULT, 512, 6371000, 6, 8, 40000, 0, 0}};
static tc_context *context;
static tc_map *planet[PLANETS];

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    for (int k = 0; k < PLANETS; k++) {
        planet[k] = planet_flattened(planet_made(made[k].kind, made[k].width, made[k].radius, 7), made[k].flattening);
        if (made[k].faces)
            planet[k] = planet_of_faces(planet[k], made[k].faces->chart);
        planet[k] = planet_synthesised(planet[k], made[k].synthesised);
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

static scene scene_of(int k, int m, const tc_scene_options *options)
{
    return planet_scene_of(context, planet[k],
                           made[k].faces ? planet_faces(planet[k], made[k].faces, 127, options)
                                         : planet_rings(planet[k], &(tc_rings_options){.n_phi = 128, .m = m}, options),
                           options);
}

static int64_t different_pixels(const uint8_t *a, const uint8_t *b, const tc_camera *c)
{
    int64_t count = 0;
    for (int i = 0; i < c->width * c->height; i++)
        count += memcmp(a + 3 * i, b + 3 * i, 3) != 0;
    return count;
}

static uint8_t *picture(scene *s, const tc_camera *c, const tc_scene_options *options, tc_frame_stats *stats)
{
    tc_renderer_set_options(s->renderer, options);
    *stats = scene_draw(s, c, true);
    return scene_pixels(s, c);
}

static void culling_removes_nothing_visible(void **state)
{
    (void)state;
    int64_t drawn = 0, without = 0, views = 0;
    for (int k = 0; k < DATA; k++) {
        const tc_scene_options culled = {.budget = -1, .frame.error = made[k].error},
                               all = {.budget = -1, .frame = {.no_cull = true, .error = made[k].error}};
        test_random r = {2 + (uint64_t)k};
        scene s = scene_of(k, 10, &culled);
        for (int view = 0; view < sweep_of(made[k].faces ? 30 : 50); view++, views++) {
            tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
            tc_frame_stats stats;
            uint8_t *a = picture(&s, &c, &culled, &stats);
            drawn += stats.triangles, without += stats.triangles_unculled;
            uint8_t *b = picture(&s, &c, &all, &stats);
            assert_int_equal(stats.triangles, stats.triangles_unculled);
            int64_t different = different_pixels(a, b, &c);
            if (different)
                printf("view %d of planet %d: %lld pixels: %.17g %.17g %.17g %.17g %.17g %.17g\n", view, k,
                       (long long)different, c.x, c.y, c.z, c.heading, c.pitch, c.fov);
            assert_int_equal(different, 0);
            free(a), free(b);
        }
        scene_destroy(&s);
    }
    printf("globe culling: %.3f of the triangles drawn over %lld views\n", (double)drawn / (double)without,
           (long long)views);
    assert_true(drawn < without * 7 / 10);
}

/* A view culled for another direction misses what it shows. */
static void the_test_finds_what_is_missing(void **state)
{
    (void)state;
    test_random r = {2};
    tc_scene_options culled = {.budget = -1};
    scene s = scene_of(0, 10, &culled);
    int found = 0;
    for (int view = 0; view < 20; view++) {
        tc_camera c = planet_view(&r, planet[0], 0.5, 5 * planet[0]->body.radius), other = c;
        tc_frame_stats stats;
        other.heading += 0.3, other.fov *= 0.8;
        culled.frame.cull_camera = NULL;
        uint8_t *a = picture(&s, &c, &culled, &stats);
        culled.frame.cull_camera = &other;
        uint8_t *b = picture(&s, &c, &culled, &stats);
        found += different_pixels(a, b, &c) > 0;
        free(a), free(b);
    }
    printf("globe culling: for a direction that is 0.3 off: %d of 20 views differ\n", found);
    assert_true(found > 5);
    scene_destroy(&s);
}

/* Backs of triangles may show in single pixels of a ridge line, where corners are rounded to the raster. */
static void backs_are_not_missed(void **state)
{
    (void)state;
    int64_t different = 0, views = 0, pixels = 0;
    for (int k = 0; k < DATA; k++) {
        const tc_scene_options front = {.budget = -1, .frame.error = made[k].error},
                               both = {.budget = -1, .frame = {.two_sided = true, .error = made[k].error}};
        test_random r = {4 + (uint64_t)k};
        scene s = scene_of(k, 10, &front);
        for (int view = 0; view < sweep_of(made[k].faces ? 30 : 50); view++, views++) {
            tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
            tc_frame_stats stats;
            uint8_t *a = picture(&s, &c, &front, &stats), *b = picture(&s, &c, &both, &stats);
            different += different_pixels(a, b, &c), pixels += c.width * c.height;
            free(a), free(b);
        }
        scene_destroy(&s);
    }
    printf("globe, backs left out: %lld of %lld pixels differ\n", (long long)different, (long long)pixels);
    assert_true(different <= views / 10);
}

/* Flights of other paths, speeds and budgets, and a fresh surface, end in the same picture. */
static void a_picture_depends_on_the_view_alone(void **state)
{
    (void)state;
    int64_t differing = 0, views = 0;
    for (int k = 0; k < PLANETS; k++) {
        test_random r = {1 + (uint64_t)k};
        const tc_scene_options options[2] = {{.budget = 0, .frame.error = made[k].error},
                                             {.budget = made[k].budget, .frame.error = made[k].error}};
        scene s[2];
        for (int i = 0; i < 2; i++)
            s[i] = scene_of(k, 8, &options[i]);
        for (int view = 0; view < sweep_of(made[k].views); view++, views++) {
            tc_camera end = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
            uint8_t *pixels[3];
            tc_frame_stats stats;
            for (int i = 0; i < 2; i++) {
                for (int64_t leg = test_random_int(&r, 0, 8); leg > 0; leg--) {
                    tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
                    scene_draw(&s[i], &c, test_random_unit(&r) < 0.3);
                }
                pixels[i] = picture(&s[i], &end, &options[i], &stats);
            }
            int count = 2;
            if (view % 5 == 0) { /* making one takes long */
                scene fresh = scene_of(k, 8, &options[0]);
                pixels[count++] = picture(&fresh, &end, &options[0], &stats);
                scene_destroy(&fresh);
            }
            for (int i = 1; i < count; i++) {
                int64_t different = different_pixels(pixels[0], pixels[i], &end);
                if (different)
                    printf("view %d of planet %d: %lld pixels: %.17g %.17g %.17g %.17g %.17g %.17g\n", view, k,
                           (long long)different, end.x, end.y, end.z, end.heading, end.pitch, end.fov);
                differing += different > 0;
            }
            for (int i = 0; i < count; i++)
                free(pixels[i]);
        }
        scene_destroy(&s[0]), scene_destroy(&s[1]);
    }
    printf("globe: %lld of %lld views depend on the way there\n", (long long)differing, (long long)views);
    assert_int_equal(differing, 0);
}

/* Depth of a frame, unprojected, lies on the surface in double. */
static void drawn_depth_is_the_surface(void **state)
{
    (void)state;
    double worst = 0;
    int64_t pixels = 0, edge_on = 0;
    for (int k = 0; k < DATA; k++) {
        if (!made[k].faces)
            continue;
        const tc_scene_options options = {
            .unlit = true, .background_set = true, .budget = -1, .frame.error = made[k].error};
        test_random r = {3 + (uint64_t)k};
        scene s = scene_of(k, 8, &options);
        for (int view = 0; view < sweep_of(40); view++) {
            const tc_camera c = planet_view(&r, planet[k], 0.5, 5 * planet[k]->body.radius);
            scene_draw(&s, &c, true);
            float *depth = planet_depth(&s, &c);
            const tc_view *seen = scene_look(&s, &c, &options.frame);
            const double eye[3] = {c.x, c.y, c.z};
            double at[3];
            planet[k]->body.class->position(&planet[k]->body, eye, at);
            for (int i = 0; i < c.width * c.height; i += 7) {
                double p[3], z, q[3];
                if (depth[i] == 0)
                    continue;
                tc_view_unproject(&c, s.surface->near_plane, &planet[k]->body, i % c.width + 0.5, i / c.width + 0.5,
                                  depth[i], p);
                if (!s.surface->height(seen, p[0], p[1], &z))
                    continue;
                planet[k]->body.class->position(&planet[k]->body, p, q);
                const double off = fabs(p[2] - z) /
                                   sqrt(pow(q[0] - at[0], 2) + pow(q[1] - at[1], 2) + pow(q[2] - at[2], 2)) *
                                   tc_camera_pixel_scale(&c);
                pixels++, edge_on += off > 0.5;
                if (off <= 0.5)
                    worst = fmax(worst, off);
                else
                    printf("planet %d view %d: %g\n", k, view, off);
            }
            free(depth);
        }
        scene_destroy(&s);
    }
    printf("globe, depth: %lld pixels unprojected, at most %.4f pixels from the surface in double, %lld more\n",
           (long long)pixels, worst, (long long)edge_on);
    assert_true(pixels > 10000 && edge_on == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(culling_removes_nothing_visible),
        cmocka_unit_test(the_test_finds_what_is_missing),
        cmocka_unit_test(backs_are_not_missed),
        cmocka_unit_test(drawn_depth_is_the_surface),
        cmocka_unit_test(a_picture_depends_on_the_view_alone),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
