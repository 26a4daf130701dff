/* test_part_of_globe.c - a map of a part of a globe ends where its samples do, in one line, whatever their number: not
 * in teeth as wide as the cells of the mesh that go beyond it. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/app/load.h"
#include "tests/support/made_files.h"
#include "tests/support/planet_scene.h"

static const double degree = 0.017453292519943295, west = 2.3, south = 48.3, wide = 0.06;
enum { WIDTH = 640, HEIGHT = 400 };

static int remove_folder(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

/* Hills from 200 to 400 m, n samples either way. */
static tc_map *part_of_globe(int n)
{
    const char *path = made_path("part.asc");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner %g\nyllcorner %g\ncellsize %.15g\n", n, n, west, south, wide / n);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            fprintf(file, "%.2f%c", 300 + 100 * sin(9. * i / n) * cos(7. * j / n), i < n - 1 ? ' ' : '\n');
    assert_int_equal(fclose(file), 0);
    tc_map *map = NULL;
    tc_error error = {0};
    const tc_load_options load = {.body = &tc_sphere_body, .globe.radius = 6371000, .threads = 2};
    if (tc_map_load(path, &(tc_source_options){.lonlat = true}, &load, &map, &error) != TC_OK)
        fail_msg("%s", error.text);
    return map;
}

/* Row of the map's lowest pixel in a column, by its colour: the globe beside it is grey. -1: none. */
static int lowest(const uint8_t *rgb, int x)
{
    for (int y = HEIGHT - 1; y >= 0; y--) {
        const uint8_t *p = rgb + 3 * (y * WIDTH + x);
        if (p[1] > p[2] + 16)
            return y;
    }
    return -1;
}

static void the_side_is_a_line(void **state)
{
    (void)state;
    tc_context *context = scene_context();
    if (!context)
        skip();
    static const int sizes[] = {201, 230, 247, 311};
    const tc_camera c = {.width = WIDTH,
                         .height = HEIGHT,
                         .x = 2.33 * degree,
                         .y = 48.28 * degree,
                         .z = 2500,
                         .heading = 10 * degree,
                         .pitch = -25 * degree,
                         .fov = 60 * degree};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        tc_map *map = part_of_globe(sizes[k]);
        scene s = planet_scene(context, map, &(tc_rings_options){.n_phi = 512}, &(tc_scene_options){.budget = -1});
        scene_draw(&s, &c, true);
        uint8_t *rgb = scene_pixels(&s, &c);
        int seen = 0, worst = 0;
        for (int x = 0; x + 1 < WIDTH; x++) {
            int here = lowest(rgb, x), next = lowest(rgb, x + 1);
            if (here < HEIGHT / 2 || next < HEIGHT / 2 || here == HEIGHT - 1 || next == HEIGHT - 1)
                continue;
            seen++, worst = abs(here - next) > worst ? abs(here - next) : worst;
        }
        print_message("%d samples: %d columns of the side, steps of at most %d pixels\n", sizes[k], seen, worst);
        assert_true(seen > WIDTH / 4 && worst <= 6);
        free(rgb);
        scene_destroy(&s);
        tc_map_destroy(map);
    }
    tc_context_destroy(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_side_is_a_line)};
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
