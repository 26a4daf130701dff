/* test_pictures.c - what a picture may depend on, and what it must not. */
#include "common/measure/view_error.h"
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scene.h"
#include "tests/support/sweep.h"
#include "tests/support/terrains.h"

enum { WIDTH = 320, HEIGHT = 240, SIZE = 998, SPACING = 30, FINER = 5 };

static tc_context *context;
static tc_field *terrain, *finer; /* than its data; as far across, but for less than one of their samples */

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    terrain = terrain_field(TERRAIN_DEFAULT, SIZE, SIZE, SPACING, 7);
    finer = terrain_synthesised(terrain_field(TERRAIN_DEFAULT, SIZE / 2, SIZE / 2, 2 * SPACING, 7), FINER);
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_field_destroy(terrain), tc_field_destroy(finer);
    tc_context_destroy(context);
    return 0;
}

static tc_camera random_view(test_random *r, const tc_field *over)
{
    double extent = (SIZE - 1) * SPACING, ground;
    tc_camera c = {.x = test_random_range(r, -0.2, 1.2) * extent,
                   .y = test_random_range(r, -0.2, 1.2) * extent,
                   .heading = test_random_range(r, 0, 2 * M_PI),
                   .pitch = test_random_range(r, -1.5, 0.4),
                   .fov = test_random_range(r, 0.4, 1.9),
                   .width = WIDTH,
                   .height = HEIGHT};
    tc_field_height(over, c.x, c.y, &ground);
    c.z = ground + pow(10, test_random_range(r, 0, 4.5));
    return c;
}

static int64_t different_pixels(const uint8_t *a, const uint8_t *b)
{
    int64_t count = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        count += memcmp(a + 3 * i, b + 3 * i, 3) != 0;
    return count;
}

/* Two flights of different paths, speeds and budgets end in the same view. error: the tolerance; 0: none. */
static void same_view_same_picture(const tc_field *field, int samples, double error, int views)
{
    test_random r = {1};
    tc_scene_options options[2] = {{.budget = 0, .samples = samples, .frame.error = error},
                                   {.budget = error > 0 ? 4000 : 700, .samples = samples, .frame.error = error}};
    scene s[2];
    for (int k = 0; k < 2; k++)
        s[k] = scene_create(context, field, error > 0 ? 127 : 63, &options[k]);
    for (int view = 0; view < views; view++) {
        tc_camera end = random_view(&r, field);
        uint8_t *pixels[2];
        for (int k = 0; k < 2; k++) {
            for (int64_t leg = test_random_int(&r, 0, 12); leg > 0; leg--) {
                tc_camera c = random_view(&r, field);
                scene_draw(&s[k], &c, test_random_unit(&r) < 0.3);
            }
            scene_draw(&s[k], &end, true);
            pixels[k] = scene_pixels(&s[k], &end);
        }
        assert_int_equal(different_pixels(pixels[0], pixels[1]), 0);
        free(pixels[0]), free(pixels[1]);
    }
    scene_destroy(&s[0]), scene_destroy(&s[1]);
}

static void a_picture_depends_on_the_view_alone(void **state)
{
    (void)state;
    same_view_same_picture(terrain, 1, 0, sweep_of(60));
}

static void also_with_several_samples_a_pixel(void **state)
{
    (void)state;
    same_view_same_picture(terrain, 4, 0, sweep_of(60));
}

static void also_finer_than_the_data(void **state)
{
    (void)state;
    same_view_same_picture(finer, 1, 0, sweep_of(20));
}

static void also_by_a_tolerance(void **state)
{
    (void)state;
    same_view_same_picture(terrain, 1, 1, sweep_of(36));
    same_view_same_picture(finer, 1, 4, sweep_of(6));
}

/* error: the tolerance; 0: none. */
static void culling_removes_nothing(double error, int views)
{
    test_random r = {2};
    tc_scene_options all = {.frame = {.no_cull = true, .error = error}}, culled = {.frame.error = error};
    scene s = scene_create(context, terrain, error > 0 ? 127 : 63, &culled);
    int64_t drawn = 0, without = 0;
    for (int view = 0; view < views; view++) {
        tc_camera c = random_view(&r, terrain);
        tc_renderer_set_options(s.renderer, &culled);
        tc_frame_stats stats = scene_draw(&s, &c, true);
        drawn += stats.triangles, without += stats.triangles_unculled;
        uint8_t *a = scene_pixels(&s, &c);
        tc_renderer_set_options(s.renderer, &all);
        stats = scene_draw(&s, &c, true);
        assert_int_equal(stats.triangles, stats.triangles_unculled);
        uint8_t *b = scene_pixels(&s, &c);
        assert_int_equal(different_pixels(a, b), 0);
        free(a), free(b);
    }
    printf("culling, tolerance %g: %.3f of the triangles drawn over %d views\n", error, (double)drawn / (double)without,
           views);
    assert_true(drawn < without * 7 / 10);
    scene_destroy(&s);
}

static void culling_removes_nothing_visible(void **state)
{
    (void)state;
    culling_removes_nothing(0, sweep_of(100));
    culling_removes_nothing(1, sweep_of(60));
}

static tc_camera view_near_the_ground(test_random *r, const tc_field *over)
{
    tc_camera c = random_view(r, over);
    double extent = (SIZE - 1) * SPACING, ground;
    c.x = test_random_unit(r) * extent, c.y = test_random_unit(r) * extent;
    c.pitch = test_random_range(r, -0.7, 0.4);
    tc_field_height(over, c.x, c.y, &ground);
    c.z = ground + pow(10, test_random_range(r, 0, 2.7));
    return c;
}

/* Blocks behind nearer ground are left out where no backs of triangles are drawn: the pictures are those of all blocks,
 * which no view leaves out. */
static void hidden_blocks_are_not_missed(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        terrain_kind kind;
        bool some; /* of its triangles in the view are hidden, to a pixel */
    } grounds[] = {
        {"cliffs", TERRAIN_CLIFF, false}, {"hills", TERRAIN_SMOOTH, true}, {"default", TERRAIN_DEFAULT, true}};
    test_random r = {5};
    const int views = sweep_of(60);
    for (int ground = 0; ground < 3; ground++)
        for (int tolerance = 0; tolerance < 2; tolerance++) {
            tc_field *over = terrain_field(grounds[ground].kind, SIZE, SIZE, SPACING, 7);
            tc_scene_options culled = {.frame.error = tolerance}, all = culled, backs = culled;
            all.frame.no_cull = true, backs.frame.two_sided = true;
            scene s = scene_create(context, over, tolerance ? 511 : 63, &culled);
            int64_t drawn = 0, in_view = 0;
            for (int view = 0; view < views; view++) {
                const tc_camera c = view_near_the_ground(&r, over);
                tc_renderer_set_options(s.renderer, &backs);
                in_view += scene_draw(&s, &c, true).triangles;
                tc_renderer_set_options(s.renderer, &all);
                const tc_frame_stats stats = scene_draw(&s, &c, true);
                assert_int_equal(stats.triangles, stats.triangles_unculled);
                uint8_t *a = scene_pixels(&s, &c);
                tc_renderer_set_options(s.renderer, &culled);
                drawn += scene_draw(&s, &c, true).triangles;
                uint8_t *b = scene_pixels(&s, &c);
                assert_int_equal(different_pixels(a, b), 0);
                free(a), free(b);
            }
            printf("behind nearer ground: %s%s: %.3f of the triangles in the view drawn over %d views\n",
                   grounds[ground].name, tolerance ? ", to a pixel" : "", (double)drawn / (double)in_view, views);
            assert_true(drawn < in_view || !(tolerance && grounds[ground].some));
            scene_destroy(&s);
            tc_field_destroy(over);
        }
}

/* Backs of triangles are left out where the eye is above the surface. Drawn as well they may show in single pixels of a
 * ridge line, where corners are rounded to the raster, and nowhere else. */
static void backs_missed(double error, int64_t views)
{
    test_random r = {4};
    tc_scene_options both = {.frame = {.two_sided = true, .error = error}}, front = {.frame.error = error};
    scene s = scene_create(context, terrain, error > 0 ? 127 : 63, &front);
    int64_t different = 0;
    for (int64_t view = 0; view < views; view++) {
        tc_camera c = random_view(&r, terrain);
        tc_renderer_set_options(s.renderer, &front);
        scene_draw(&s, &c, true);
        uint8_t *a = scene_pixels(&s, &c);
        tc_renderer_set_options(s.renderer, &both);
        scene_draw(&s, &c, true);
        uint8_t *b = scene_pixels(&s, &c);
        different += different_pixels(a, b);
        free(a), free(b);
    }
    printf("backs left out, tolerance %g: %lld of %lld pixels differ\n", error, (long long)different,
           (long long)views * WIDTH * HEIGHT);
    assert_true(different < (views + 9) / 10);
    scene_destroy(&s);
}

static void backs_are_not_missed(void **state)
{
    (void)state;
    backs_missed(0, sweep_of(150));
    backs_missed(1, sweep_of(60));
}

/* North is up the picture, east to its right: a hill in the north-east of a plain, seen from above. */
static void maps_are_not_mirrored(void **state)
{
    (void)state;
    enum { N = 257 };
    tc_grid g = terrain_grid(TERRAIN_SMOOTH, N, N, SPACING, 0);
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++)
            g.z[j * N + i] = hypot(i - 200, j - 180) < 20 ? 3000 : 100;
    g.z_min = 100, g.z_max = 3000;
    tc_field *p;
    assert_int_equal(tc_field_build(&g, 0, &p, NULL), TC_OK);
    tc_scene_options options = {.unlit = true, .background_set = true};
    scene s = scene_create(context, p, 63, &options);
    tc_camera c = {.x = 128 * SPACING,
                   .y = 128 * SPACING,
                   .z = 20000,
                   .heading = 0,
                   .pitch = -M_PI / 2,
                   .fov = 0.6,
                   .width = WIDTH,
                   .height = HEIGHT};
    scene_draw(&s, &c, true);
    uint8_t *rgb = scene_pixels(&s, &c);
    double x = 0, y = 0, count = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (rgb[3 * i] > 200 && rgb[3 * i + 2] > 200) /* snow on the hill */
            x += i % WIDTH, y += i / WIDTH, count++;
    assert_true(count > 20);
    /* The hill's top is 17 km below the eye. */
    double scale = WIDTH / (2 * tan(0.3)) * SPACING / 17000;
    assert_float_equal(x / count, WIDTH / 2.0 + (200 - 128) * scale, 2);
    assert_float_equal(y / count, HEIGHT / 2.0 - (180 - 128) * scale, 2);
    free(rgb);
    scene_destroy(&s);
    tc_field_destroy(p);
}

/* Pixels and depth of a frame agree with the surface in double: unprojected depth lies on it. */
static void depth_is_the_surface(double error)
{
    test_random r = {3};
    tc_scene_options options = {.unlit = true, .background_set = true, .frame.error = error};
    scene s = scene_create(context, terrain, error > 0 ? 127 : 63, &options);
    float *depth = malloc(sizeof *depth * WIDTH * HEIGHT);
    double worst = 0;
    int64_t pixels = 0;
    for (int view = 0; view < 20; view++) {
        tc_camera c = random_view(&r, terrain);
        scene_draw(&s, &c, true);
        tc_renderer_read(s.renderer, NULL, depth);
        const tc_view *seen = scene_look(&s, &c, &options.frame);
        for (int i = 0; i < WIDTH * HEIGHT; i += 7) {
            double p[3], z;
            if (depth[i] == 0)
                continue;
            tc_view_unproject(&c, s.surface->near_plane, &(tc_body){&tc_plane_body, 0, 0}, i % WIDTH + 0.5,
                              i / WIDTH + 0.5, depth[i], p);
            if (!s.surface->height(seen, p[0], p[1], &z))
                continue; /* a pixel on the very rim */
            double d = sqrt(pow(p[0] - c.x, 2) + pow(p[1] - c.y, 2) + pow(p[2] - c.z, 2));
            worst = fmax(worst, fabs(p[2] - z) / d * WIDTH / (2 * tan(c.fov / 2)));
            pixels++;
        }
    }
    printf("depth, tolerance %g: %lld pixels unprojected, at most %.4f pixels from the surface in double\n", error,
           (long long)pixels, worst);
    assert_true(pixels > 50000);
    assert_true(worst < 0.5);
    free(depth);
    scene_destroy(&s);
}

static void drawn_depth_is_the_surface(void **state)
{
    (void)state;
    depth_is_the_surface(0);
    depth_is_the_surface(0.5);
    depth_is_the_surface(5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_depends_on_the_view_alone),
        cmocka_unit_test(also_with_several_samples_a_pixel),
        cmocka_unit_test(also_finer_than_the_data),
        cmocka_unit_test(also_by_a_tolerance),
        cmocka_unit_test(culling_removes_nothing_visible),
        cmocka_unit_test(hidden_blocks_are_not_missed),
        cmocka_unit_test(backs_are_not_missed),
        cmocka_unit_test(maps_are_not_mirrored),
        cmocka_unit_test(drawn_depth_is_the_surface),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
