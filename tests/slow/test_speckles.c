/* test_speckles.c - several samples a pixel smooth edges and add nothing: what is interpolated stays within the
 * triangle.
 *
 * A pixel that is covered in part is shaded once, and where that is done at its middle, outside the triangle, heights,
 * places in the normal map and depths are those of no ground. Seen from near the ground it shows as dotted lines along
 * edges of triangles, and as single bright pixels that crawl. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/gl/context.h"
#include "tests/support/datasets.h"
#include "tests/support/planet_scene.h"
#include "tests/support/scene.h"
#include "tests/support/sweep.h"
#include "tests/support/terrains.h"
#include "tests/support/test.h"

enum { WIDTH = 640, HEIGHT = 400, OFF = 8, N = 255 };

static tc_context *context;

static int grey(const uint8_t *p)
{
    return (299 * p[0] + 587 * p[1] + 114 * p[2] + 500) / 1000;
}

static int compare(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* Pixels that are more than OFF grey levels off the median of the 3 x 3 around them, and brighter or darker than all of
 * its others: what lies between ground and sky on a smooth skyline is not. */
static int isolated(const uint8_t *rgb)
{
    int count = 0;
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            int around[9], own = grey(rgb + 3 * (y * WIDTH + x)), darker = 0, brighter = 0;
            for (int k = 0; k < 9; k++) {
                around[k] = grey(rgb + 3 * ((y + k / 3 - 1) * WIDTH + x + k % 3 - 1));
                darker += around[k]<own, brighter += around[k]> own;
            }
            if (darker < 8 && brighter < 8)
                continue;
            qsort(around, 9, sizeof *around, compare);
            count += abs(own - around[4]) > OFF;
        }
    return count;
}

static int speckles(scene *s, const tc_camera *camera)
{
    static uint8_t rgb[3 * WIDTH * HEIGHT];
    scene_draw(s, camera, true);
    tc_renderer_read(s->renderer, rgb, NULL);
    return isolated(rgb);
}

/* Views over the ground to all sides. */
static void look_around(const char *name, const tc_field *field)
{
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    int of_one = 0, of_four = 0;
    scene one = scene_create(context, field, N, &(tc_scene_options){.samples = 1, .budget = -1});
    scene four = scene_create(context, field, N, &(tc_scene_options){.samples = 4, .budget = -1});
    for (int view = 0; view < 6; view++) {
        double x = (0.3 + 0.08 * view) * (double)(finest.width - 1) * finest.spacing_x, z;
        double y = (0.6 - 0.05 * view) * (double)(finest.height - 1) * finest.spacing_y;
        assert_int_equal(tc_field_height(field, x, y, &z), TC_OK);
        tc_camera c = {.x = x,
                       .y = y,
                       .z = z + tc_field_info(field)->z_base + (view % 2 ? 1500 : 60),
                       .heading = view,
                       .pitch = -0.4,
                       .fov = 1.3,
                       .width = WIDTH,
                       .height = HEIGHT};
        of_one += speckles(&one, &c), of_four += speckles(&four, &c);
    }
    scene_destroy(&one), scene_destroy(&four);
    printf("%s: pixels alone that are more than %d grey levels off: %d with one sample a pixel, %d with four\n", name,
           OFF, of_one, of_four);
    assert_true(of_four <= of_one);
}

static void made_up(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_DEFAULT, 1025, 1025, 30, 1);
    look_around("default terrain", field);
    tc_field_destroy(field);
}

static void real(void **state)
{
    (void)state;
    static const char *const names[] = {"N46E008.tif", "srtm3_tatra_poland_4801.tif",
                                        "srtm3_canyonlands_voids_2401x3601.tif"};
    int seen = 0;
    for (int i = 0; i < 3; i++) {
        dataset d = {.name = names[i]};
        tc_grid grid;
        tc_field *field;
        if (!dataset_load(&d, &grid))
            continue;
        assert_int_equal(tc_field_build(&grid, 0, &field, NULL), TC_OK);
        look_around(names[i], field);
        tc_field_destroy(field);
        seen++;
    }
    if (!seen)
        skip();
}

/* Pixels in the midst of even ones, with one sample a pixel, that several samples show otherwise. */
static int unlike(const uint8_t *one, const uint8_t *four)
{
    enum { EVEN = 4, UNLIKE = 4 };
    int count = 0;
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            int least = 255, most = 0;
            for (int k = 0; k < 9; k++) {
                int there = grey(one + 3 * ((y + k / 3 - 1) * WIDTH + x + k % 3 - 1));
                least = there < least ? there : least, most = there > most ? there : most;
            }
            int own = grey(four + 3 * (y * WIDTH + x));
            count += most - least <= EVEN && (own > most + UNLIKE || own < least - UNLIKE);
        }
    return count;
}

/* A foot above ground that lies high above the datum a pixel next to a skyline is as wide as cells: a height or place
 * that is a share of itself off, and not of the way to the eye, is seen there. */
static void a_foot_above_the_ground(void **state)
{
    (void)state;
    static uint8_t one[3 * WIDTH * HEIGHT], four[3 * WIDTH * HEIGHT];
    tc_grid grid = terrain_grid(TERRAIN_DEFAULT, 513, 513, 30, 1);
    const float least = grid.z_min, relief = 0.2F * (grid.z_max - least);
    tc_field *field;
    for (int i = 0; i < 513 * 513; i++)
        grid.z[i] = 3000 + 0.2F * (grid.z[i] - least);
    grid.z[0] = 0, grid.z_min = 0, grid.z_max = 3000 + relief;
    assert_int_equal(tc_field_build(&grid, 0, &field, NULL), TC_OK);
    scene plain = scene_create(context, field, N, &(tc_scene_options){.unlit = true, .samples = 1, .budget = -1});
    scene smooth = scene_create(context, field, N, &(tc_scene_options){.unlit = true, .samples = 4, .budget = -1});
    int found = 0;
    for (int view = 0; view < 24; view++) {
        tc_camera c = {.x = 1000 + 570.3 * view,
                       .y = 14000 - 510.7 * view,
                       .heading = 0.7 * view,
                       .pitch = -0.05,
                       .fov = 1.3,
                       .width = WIDTH,
                       .height = HEIGHT};
        assert_int_equal(tc_field_height(field, c.x, c.y, &c.z), TC_OK);
        c.z += tc_field_info(field)->z_base + 0.3;
        scene_draw(&plain, &c, true), scene_draw(&smooth, &c, true);
        tc_renderer_read(plain.renderer, one, NULL), tc_renderer_read(smooth.renderer, four, NULL);
        found += unlike(one, four);
    }
    printf("a foot above the ground: %d pixels that several samples show otherwise\n", found);
    assert_true(found < 10);
    scene_destroy(&plain), scene_destroy(&smooth);
    tc_field_destroy(field);
}

/* A sea at 0 around an island, and ground without any, from afar and aslant: a height that is a share of the eye's off
 * is another colour, of a sea that of land. */
static void from_afar(void **state)
{
    (void)state;
    enum { SIDE = 513 };
    static uint8_t one[3 * WIDTH * HEIGHT], four[3 * WIDTH * HEIGHT];
    static const float lowest[] = {0, 500}; /* metres */
    for (int sea = 0; sea < 2; sea++) {
        tc_grid grid = terrain_grid(TERRAIN_DEFAULT, SIDE, SIDE, 300, 1);
        const float shore = grid.z_min + 0.6F * (grid.z_max - grid.z_min), highest = grid.z_max;
        tc_field *field;
        for (int i = 0; i < SIDE * SIDE; i++)
            grid.z[i] = lowest[sea] + 0.3F * (grid.z[i] > shore ? grid.z[i] - shore : 0);
        grid.z_min = lowest[sea], grid.z_max = lowest[sea] + 0.3F * (highest - shore);
        assert_int_equal(tc_field_build(&grid, 0, &field, NULL), TC_OK);
        scene plain = scene_create(context, field, N, &(tc_scene_options){.unlit = true, .samples = 1, .budget = -1});
        scene smooth = scene_create(context, field, N, &(tc_scene_options){.unlit = true, .samples = 4, .budget = -1});
        int found = 0;
        for (int view = 0; view < 4; view++) {
            const double away = 2e5 * (1 << view);
            const tc_camera c = {.x = 77e3 - 0.6 * away,
                                 .y = 77e3 - 0.8 * away,
                                 .z = tc_field_info(field)->z_base + 0.3 * away,
                                 .heading = atan2(0.6, 0.8),
                                 .pitch = -atan(0.3),
                                 .fov = 2 * atan(120e3 / away),
                                 .width = WIDTH,
                                 .height = HEIGHT};
            scene_draw(&plain, &c, true), scene_draw(&smooth, &c, true);
            tc_renderer_read(plain.renderer, one, NULL), tc_renderer_read(smooth.renderer, four, NULL);
            found += unlike(one, four);
        }
        printf("from afar, lowest ground at %g m: %d pixels that several samples show otherwise\n", (double)lowest[sea],
               found);
        assert_true(found < 100);
        scene_destroy(&plain), scene_destroy(&smooth);
        tc_field_destroy(field);
    }
}

/* Pixels that are bright while all around them lies in the dark. */
static int lone_lights(const uint8_t *rgb)
{
    enum { DARK = 40 };
    int count = 0;
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            int most = 0;
            for (int k = 0; k < 9; k++) {
                int there = grey(rgb + 3 * ((y + k / 3 - 1) * WIDTH + x + k % 3 - 1));
                most = k != 4 && there > most ? there : most;
            }
            count += most < DARK && grey(rgb + 3 * (y * WIDTH + x)) > most + 20;
        }
    return count;
}

/* At a globe's limb faces are edge on, and what is interpolated a rounding beside them is from far away, where it may
 * be day. */
static void limb_at_night(void **state)
{
    (void)state;
    static uint8_t rgb[3 * WIDTH * HEIGHT];
    const double radius = 6371000;
    tc_map *planet = planet_made(PLANET_DEFAULT, 1024, radius, 1);
    int found = 0, views = sweep_of(60);
    scene s = planet_scene(context, planet, &(tc_rings_options){.n_phi = 512},
                           &(tc_scene_options){.samples = 4, .budget = -1});
    for (int k = 0; k < views; k++) {
        int view = k * 60 / views;
        tc_camera c = {.x = -3 + 0.1 * view,
                       .y = 1.2 - 0.04 * view,
                       .z = (1 + 0.02 * view) * radius,
                       .heading = view,
                       .pitch = -1.5707,
                       .fov = 1.3,
                       .width = WIDTH,
                       .height = HEIGHT};
        scene_draw(&s, &c, true);
        tc_renderer_read(s.renderer, rgb, NULL);
        found += lone_lights(rgb);
    }
    scene_destroy(&s);
    printf("a globe's limb: %d lone lights in the dark\n", found);
    assert_int_equal(found, 0);
    tc_map_destroy(planet);
}

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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(made_up), cmocka_unit_test(real),
                                       cmocka_unit_test(a_foot_above_the_ground), cmocka_unit_test(from_afar),
                                       cmocka_unit_test(limb_at_night)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
