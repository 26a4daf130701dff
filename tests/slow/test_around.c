/* test_around.c - what a flat terrain is shown with: its walls leave no gap below its edge, and the sea around it goes
 * to the horizon without one; nor has it one from below. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "common/measure/view_error.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { WIDTH = 240, HEIGHT = 320, COLUMNS = 401, ROWS = 401, SPACING = 30, VIEWS = 60 };
static const uint8_t background[3] = {255, 0, 255};

static tc_context *context;

/* A place around the terrain, or above it, from which some of it is seen. */
static tc_camera camera_of(test_random *r, bool beside)
{
    const double wide = (COLUMNS - 1) * SPACING, tall = (ROWS - 1) * SPACING;
    const double around = test_random_range(r, 0, 2 * M_PI), away = test_random_range(r, 0.75, 1.6);
    tc_camera c = {.width = WIDTH, .height = HEIGHT, .fov = test_random_range(r, 0.6, 1.4)};
    c.x = 0.5 * wide + (beside ? away * wide * cos(around) : 0.3 * wide * cos(around));
    c.y = 0.5 * tall + (beside ? away * wide * sin(around) : 0.3 * tall * sin(around));
    c.z = exp(test_random_range(r, log(beside ? 100 : 3000), log(9000)));
    c.heading = atan2(0.5 * wide - c.x, 0.5 * tall - c.y) + test_random_range(r, -0.2, 0.2);
    c.pitch = -atan2(c.z, hypot(c.x - 0.5 * wide, c.y - 0.5 * tall));
    return c;
}

static bool is_background(const uint8_t *p)
{
    return p[0] == background[0] && p[1] == background[1] && p[2] == background[2];
}

/* Pixels of the background with something drawn above and below them. Columns of a level camera are vertical planes,
 * in which a block without gaps is one piece. */
static int gaps(const uint8_t *rgb)
{
    int found = 0;
    for (int x = 0; x < WIDTH; x++) {
        int first = HEIGHT, last = -1;
        for (int y = 0; y < HEIGHT; y++)
            if (!is_background(rgb + 3 * (y * WIDTH + x)))
                first = y < first ? y : first, last = y;
        for (int y = first; y < last; y++)
            found += is_background(rgb + 3 * (y * WIDTH + x));
    }
    return found;
}

static tc_scene_options walled(double error, bool walls)
{
    tc_scene_options o = {.budget = -1, .background_set = true, .frame.error = error};
    for (int i = 0; i < 3; i++)
        o.background[i] = background[i];
    o.around = (tc_surroundings){.walls = walls, .foot = -2500};
    return o;
}

/* Gaps, and pixels that are drawn, in all views. */
static int look(const tc_field *field, const tc_scene_options *options, int *drawn_ret)
{
    scene s = scene_create(context, field, 127, options);
    test_random r = {11};
    int found = 0, worst = -1;
    *drawn_ret = 0;
    for (int k = 0; k < VIEWS; k++) {
        tc_camera c = camera_of(&r, true);
        c.pitch = 0, c.fov = 1.4;
        scene_draw(&s, &c, true);
        uint8_t *rgb = scene_pixels(&s, &c);
        const int here = gaps(rgb);
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            *drawn_ret += !is_background(rgb + 3 * i);
        worst = here > 0 && worst < 0 ? k : worst;
        found += here;
        free(rgb);
    }
    if (found > 0)
        print_message("%d gaps, first in view %d\n", found, worst);
    scene_destroy(&s);
    return found;
}

static void walls_leave_no_gap(void **state)
{
    (void)state;
    static const terrain_kind kinds[] = {TERRAIN_DEFAULT, TERRAIN_SMOOTH};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        tc_field *field = terrain_field(kinds[k], COLUMNS, ROWS, SPACING, 5);
        for (int by_error = 0; by_error < 2; by_error++) {
            const tc_scene_options with = walled(by_error, true), without = walled(by_error, false);
            int drawn, bare;
            assert_int_equal(look(field, &with, &drawn), 0);
            look(field, &without, &bare);
            print_message("%d pixels of terrain, %d with its walls\n", bare, drawn);
            assert_true(drawn > bare + bare / 20);
        }
        tc_field_destroy(field);
    }
}

/* From beside, and not from above. */
static void walls_are_drawn_where_they_can_be_seen(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_DEFAULT, COLUMNS, ROWS, SPACING, 5);
    const tc_scene_options options = walled(0, true);
    scene s = scene_create(context, field, 127, &options);
    test_random r = {3};
    for (int k = 0; k < 20; k++) {
        const tc_camera beside = camera_of(&r, true), above = camera_of(&r, false);
        assert_true(scene_draw(&s, &beside, true).wall_draws > 0);
        assert_int_equal(scene_draw(&s, &above, true).wall_draws, 0);
    }
    scene_destroy(&s);
    tc_field_destroy(field);
}

static bool over_ground(const tc_camera *c, const double ray[3], double t)
{
    const double margin = 10, east = c->x + t * ray[0], north = c->y + t * ray[1];
    return east > margin && north > margin && east < (COLUMNS - 1) * SPACING - margin &&
           north < (ROWS - 1) * SPACING - margin;
}

/* From below its foot the block is closed: what rays through the floor meet is the floor, and above it no gap is. */
static void a_block_has_a_floor(void **state)
{
    (void)state;
    const double foot = -2500, most = 3; /* that the floor is above it */
    tc_field *field = terrain_field(TERRAIN_DEFAULT, COLUMNS, ROWS, SPACING, 5);
    float *depth = malloc(sizeof *depth * WIDTH * HEIGHT);
    uint8_t *rgb = malloc((size_t)3 * WIDTH * HEIGHT);
    assert_non_null(depth);
    assert_non_null(rgb);
    for (int by_error = 0; by_error < 2; by_error++) {
        const tc_scene_options options = walled(by_error, true);
        scene s = scene_create(context, field, 127, &options);
        test_random r = {19};
        int through = 0, others = 0, open = 0;
        for (int k = 0; k < VIEWS; k++) {
            tc_camera c = camera_of(&r, k % 4 != 0);
            c.z = foot - exp(test_random_range(&r, log(0.5), log(12000)));
            c.pitch = 0, c.fov = 1.4;
            scene_draw(&s, &c, true);
            tc_renderer_read(s.renderer, rgb, depth);
            open += gaps(rgb);
            double tx, ty;
            tc_camera_tangents(&c, &tx, &ty);
            const tc_basis b = tc_camera_basis(&c);
            for (int y = 0; y < HEIGHT; y++)
                for (int x = 0; x < WIDTH; x++) {
                    const double u = tx * ((x + 0.5) / WIDTH * 2 - 1), v = ty * (1 - (y + 0.5) / HEIGHT * 2);
                    double ray[3];
                    for (int i = 0; i < 3; i++)
                        ray[i] = b.forward[i] + u * b.right[i] + v * b.up[i];
                    const double t = (foot - c.z) / ray[2], raised = (foot + most - c.z) / ray[2];
                    if (!(ray[2] > 1e-3) || !over_ground(&c, ray, t) || !over_ground(&c, ray, raised))
                        continue;
                    double place[3];
                    tc_view_unproject(&c, s.surface->near_plane, &(tc_body){&tc_plane_body, 0, 0}, x + 0.5, y + 0.5,
                                      depth[y * WIDTH + x], place);
                    through++, others += !(depth[y * WIDTH + x] > 0) || place[2] < foot - 1e-4 * t - 0.1 ||
                                         place[2] > foot + most;
                }
        }
        print_message("%d pixels of the floor, %d of them show something else, %d gaps\n", through, others, open);
        assert_true(through > VIEWS * WIDTH * HEIGHT / 20);
        assert_int_equal(others, 0);
        assert_int_equal(open, 0);
        scene_destroy(&s);
    }
    free(depth);
    free(rgb);
    tc_field_destroy(field);
}

/* All that lies below the horizon is drawn, and nothing is above it where no terrain is. */
static void the_sea_reaches_the_horizon(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_DEFAULT, COLUMNS, ROWS, SPACING, 5);
    tc_scene_options options = {.budget = -1};
    options.around = (tc_surroundings){.walls = true, .sea = true, .foot = -2500, .depth = 40};
    assert_true(tc_scene_needs_of(&options, tc_field_info(field)).sea);
    scene s = scene_create(context, field, 127, &options);
    float *depth = malloc(sizeof *depth * WIDTH * HEIGHT);
    uint8_t *rgb = malloc((size_t)3 * WIDTH * HEIGHT);
    assert_non_null(depth);
    assert_non_null(rgb);
    test_random r = {7};
    int below = 0, missing = 0;
    for (int k = 0; k < VIEWS; k++) {
        tc_camera c = camera_of(&r, k % 3 != 0);
        c.pitch = k % 2 ? c.pitch : -0.02;
        scene_draw(&s, &c, true);
        tc_renderer_read(s.renderer, rgb, depth);
        double tx, ty;
        tc_camera_tangents(&c, &tx, &ty);
        const tc_basis b = tc_camera_basis(&c);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const double u = tx * ((x + 0.5) / WIDTH * 2 - 1), v = ty * (1 - (y + 0.5) / HEIGHT * 2);
                const double up = b.forward[2] + u * b.right[2] + v * b.up[2];
                if (up < -1e-3)
                    below++, missing += depth[y * WIDTH + x] <= 0;
            }
    }
    print_message("%d pixels below the horizon, %d of them empty\n", below, missing);
    assert_true(below > VIEWS * WIDTH * HEIGHT / 4);
    assert_int_equal(missing, 0);
    free(depth);
    free(rgb);
    scene_destroy(&s);
    tc_field_destroy(field);
}

int main(void)
{
    if (!(context = scene_context()))
        return 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_leave_no_gap),
        cmocka_unit_test(walls_are_drawn_where_they_can_be_seen),
        cmocka_unit_test(a_block_has_a_floor),
        cmocka_unit_test(the_sea_reaches_the_horizon),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
