/* test_colours.c - ramps of heights: read from text as GDAL does, and drawn as they say. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/colour_file.h"
#include "tests/support/made_files.h"
#include "tests/support/scene.h"

static int remove_folder(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

static const char *ramp_file(const char *text)
{
    make_bytes(made_path("ramp.txt"), text, strlen(text));
    return made_path("ramp.txt");
}

static tc_colour_ramp ramp_of(const char *text)
{
    tc_colour_ramp ramp = {0};
    tc_error error = {0};
    if (tc_colour_file_read(ramp_file(text), &ramp, &error))
        fail_msg("%s", error.text);
    return ramp;
}

static void expect_at(const tc_colour_ramp *ramp, double height, double r, double g, double b)
{
    double found[4];
    tc_colour_ramp_at(ramp, height, -200, 1800, found);
    if (fabs(255 * found[0] - r) > 1e-9 || fabs(255 * found[1] - g) > 1e-9 || fabs(255 * found[2] - b) > 1e-9)
        fail_msg("at %g m: %g %g %g", height, 255 * found[0], 255 * found[1], 255 * found[2]);
}

static void files_are_read(void **state)
{
    (void)state;
    tc_colour_ramp ramp = ramp_of("# what QGIS writes\nINTERPOLATION:INTERPOLATED\nnv 0 0 0 0\n\n"
                                  "0, 0,100,200,255\n100:50:0:0\n1000\tRed\n1000 10 20 30 128\n100% white\n0% black\n");
    assert_int_equal(ramp.count, 6);
    assert_int_equal(ramp.stop[3].rgba[3], 128);
    expect_at(&ramp, -1e6, 0, 0, 0);
    expect_at(&ramp, -100, 0, 50, 100); /* half way from the lowest to 0 m */
    expect_at(&ramp, 50, 25, 50, 100);
    expect_at(&ramp, 1000 - 1e-12 * 1000, 255, 0, 0); /* a step: below it the first, */
    expect_at(&ramp, 1000, 10, 20, 30);               /* from it on the last */
    expect_at(&ramp, 1400, 132.5, 137.5, 142.5);
    expect_at(&ramp, 1e6, 255, 255, 255);
    free(ramp.stop);
    ramp = ramp_of("\xef\xbb\xbf"
                   "0 0 0 0\n10 0 0 0\n"); /* a byte order mark */
    assert_int_equal(ramp.count, 2);
    free(ramp.stop);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *word;
    } cases[] = {{"", "found none"},         {"# only\nnv 1 2 3\n", "found none"},
                 {"10 1 2\n", "line 1"},     {"10 1 2 3\nx 1 2 3\n", "line 2"},
                 {"10 1 2 256\n", "line 1"}, {"10 1 2 3 4 5\n", "line 1"},
                 {"10 puce\n", "'10 puce'"}, {"INTERPOLATION:DISCRETE\n", "interpolates"},
                 {"1e99 1 2 3\n", "line 1"}, {"\x89PNG\x1a\n", "'?PNG?'"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        tc_colour_ramp ramp = {0};
        tc_error error = {0};
        assert_int_equal(tc_colour_file_read(ramp_file(cases[k].text), &ramp, &error), TC_ERR_FORMAT);
        assert_null(ramp.stop);
        if (!strstr(error.text, cases[k].word) || strchr(error.text, '\n'))
            fail_msg("case %d: %s", (int)k, error.text);
    }
    tc_colour_ramp ramp = {0};
    tc_error error = {0};
    assert_int_equal(tc_colour_file_read(made_path("none.txt"), &ramp, &error), TC_ERR_IO);
}

/* A plane from -300 m in the west to 1,700 m in the east, seen from above: every pixel has its height's colour. */
static void heights_have_their_colours(void **state)
{
    (void)state;
    enum { SIDE = 257, WIDTH = 320, HEIGHT = 200 };
    tc_context *context = scene_context();
    if (!context)
        skip();
    const double spacing = 30, low = -300, rise = 2000.0 / ((SIDE - 1) * spacing);
    float *z = malloc((size_t)SIDE * SIDE * sizeof *z);
    assert_non_null(z);
    for (int i = 0; i < SIDE * SIDE; i++)
        z[i] = (float)(low + rise * spacing * (i % SIDE));
    tc_grid grid = {.width = SIDE,
                    .height = SIDE,
                    .spacing_x = spacing,
                    .spacing_y = spacing,
                    .z = z,
                    .z_min = -300,
                    .z_max = 1700};
    tc_field *field;
    assert_int_equal(tc_field_build(&grid, 1, &field, NULL), TC_OK);
    tc_colour_ramp ramp =
        ramp_of("0% 10 60 200\n-50 20 20 30\n0 250 240 200\n400 40 120 30\n401 200 30 10\n80% 90 90 90\n"
                "1500 255 255 255\n");
    const tc_scene_options options = {
        .unlit = true, .background_set = true, .background = {255, 0, 255}, .budget = -1, .colours = &ramp};
    scene s = scene_create(context, field, 127, &options);
    const tc_camera c = {.x = 0.5 * (SIDE - 1) * spacing,
                         .y = 0.5 * (SIDE - 1) * spacing,
                         .z = 5000,
                         .pitch = -1.5707963267948966,
                         .fov = 1.2,
                         .width = WIDTH,
                         .height = HEIGHT};
    scene_draw(&s, &c, true);
    uint8_t *rgb = scene_pixels(&s, &c);
    int looked_at = 0, off = 0;
    for (int y = 1; y < HEIGHT; y += 3)
        for (int x = 1; x < WIDTH; x += 3) {
            double dx = tan(0.5 * c.fov) * (2 * (x + 0.5) / WIDTH - 1), t = (c.z - low - rise * c.x) / (1 + rise * dx);
            double height = low + rise * (c.x + t * dx), colour[4], near[4];
            const uint8_t *found = rgb + 3 * (y * WIDTH + x);
            if (height < low + 20 || height > 1680 || fabs(height - 400.5) < 8) /* a step is as wide as a pixel */
                continue;
            tc_colour_ramp_at(&ramp, height, low, 1700, colour);
            tc_colour_ramp_at(&ramp, height + 1, low, 1700, near);
            looked_at++;
            for (int k = 0; k < 3; k++) {
                off += fabs(found[k] - 255 * colour[k]) > 2 + 255 * fabs(near[k] - colour[k]); /* and a metre */
            }
        }
    assert_true(looked_at > 1000);
    assert_int_equal(off, 0);
    free(rgb), free(ramp.stop);
    scene_destroy(&s);
    tc_field_destroy(field);
    tc_context_destroy(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_read),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(heights_have_their_colours),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
