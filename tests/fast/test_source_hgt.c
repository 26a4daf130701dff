/* test_source_hgt.c - .hgt tiles: what their sizes and their names say. */
#include "tests/support/test.h"

#include "tests/support/loading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void tiles(void **state)
{
    (void)state;
    enum { SIDE = 1201 };
    int16_t *heights = malloc(SIDE * SIDE * sizeof *heights);
    for (int i = 0; i < SIDE * SIDE; i++)
        heights[i] = (int16_t)(i % SIDE - i / SIDE);
    heights[5 * SIDE + 7] = -32768;
    heights[9 * SIDE + 2] = -9999;
    make_hgt(made_path("N46E008.hgt"), SIDE, heights);
    make_hgt(made_path("s07w100.HGT"), SIDE, heights);
    make_hgt(made_path("renamed.hgt"), SIDE, heights);
    free(heights);

    sayings said;
    tc_grid g = load(made_path("N46E008.hgt"), (tc_source_options){0}, &said);
    assert_int_equal(g.width, SIDE);
    assert_int_equal(g.void_count, 1);
    assert_true(void_at(&g, 7, 5) && at(&g, 0, 0) == 0 && at(&g, SIDE - 1, 0) == SIDE - 1 && at(&g, 2, 9) == -9999);
    assert_true(fabsf(at(&g, 7, 5) - 2) < 0.1f); /* on a ramp */
    assert_true(g.georef.known && g.georef.geographic && g.georef.crs_wkt);
    assert_float_equal(g.georef.transform[0], 8 - 1. / 2400, 1e-9);
    assert_float_equal(g.georef.transform[3], 47 + 1. / 2400, 1e-9);
    assert_float_equal(g.spacing_x, 63.969, 0.001);
    assert_float_equal(g.spacing_y, 92.634, 0.001);
    assert_non_null(strstr(said.text, "mean latitude of 46.5000"));
    tc_grid_free(&g);

    g = load(made_path("N46E008.hgt"), (tc_source_options){.has_nodata = true, .nodata = -9999}, NULL);
    assert_true(g.void_count == 2 && void_at(&g, 2, 9));
    tc_grid_free(&g);
    g = load(made_path("s07w100.HGT"), (tc_source_options){0}, NULL);
    assert_float_equal(g.georef.transform[0], -100 - 1. / 2400, 1e-9);
    assert_float_equal(g.georef.transform[3], -6 + 1. / 2400, 1e-9);
    tc_grid_free(&g);
    g = load(made_path("renamed.hgt"), (tc_source_options){0}, &said);
    assert_true(!g.georef.known && g.void_count == 1);
    assert_float_equal(g.spacing_x, 92.766, 0.001);
    assert_float_equal(g.spacing_y, 92.766, 0.001);
    assert_non_null(strstr(said.text, "3 x 3 arc-s"));
    tc_grid_free(&g);

    cut_file(made_path("N46E008.hgt"), -1);
    refused(made_path("N46E008.hgt"), TC_ERR_FORMAT, "damaged or truncated");
    refused(made_path("N46E008.hgt"), TC_ERR_FORMAT, "2884801");
    cut_file(made_path("N46E008.hgt"), -1);
    refused(
        made_path("N46E008.hgt"), TC_ERR_FORMAT,
        "expected a square or known rectangular number of 16-bit samples, found 2884800 bytes; it may be truncated");
}

static void assert_near(double found, double expected) /* assert_float_equal is of floats */
{
    if (!(fabs(found - expected) < 1e-9))
        fail_msg("expected %.12g, found %.12g", expected, found);
}

/* A tile of zeros, which takes no room on a disk, opened and taken away. */
static tc_source *open_tile(const char *name, int64_t width, int64_t height, tc_source_options options, sayings *said)
{
    const char *path = made_path(name);
    make_bytes(path, "", 1);
    assert_int_equal(truncate(path, 2 * width * height), 0);
    tc_source *source = open_source(path, options, said);
    const tc_source_info *info = tc_source_get_info(source);
    assert_int_equal(info->width, width);
    assert_int_equal(info->height, height);
    unlink(path);
    return source;
}

static void sizes_of_tiles(void **state)
{
    (void)state;
    static const struct {
        int width, height;
        double arc_seconds; /* between rows where the name says no place; 0: a metre */
    } sizes[] = {
        {2, 2, 0},       {3, 3, 0},       {1000, 1000, 0}, {1200, 1200, 0},       {3600, 3600, 0},   {121, 121, 30},
        {1201, 1201, 3}, {1801, 1801, 2}, {3601, 3601, 1}, {6001, 6001, 0.6},     {7201, 7201, 0.5}, {801, 1201, 3},
        {601, 1201, 3},  {401, 1201, 3},  {241, 1201, 3},  {121, 1201, 3},        {2401, 3601, 1},   {1801, 3601, 1},
        {1201, 3601, 1}, {721, 3601, 1},  {361, 3601, 1},  {10801, 10801, 1 / 3.}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        sayings said;
        int width = sizes[i].width, height = sizes[i].height;
        tc_source *source = open_tile("N60E008.hgt", width, height, (tc_source_options){0}, &said);
        const tc_source_info *info = tc_source_get_info(source);
        const double *t = info->georef.transform;
        assert_true(info->georef.known && info->georef.geographic);
        assert_near(t[0] + t[1] / 2, 8); /* the border samples lie on the degree lines */
        assert_near(t[0] + t[1] * (width - 0.5), 9);
        assert_near(t[3] + t[5] / 2, 61);
        assert_near(t[3] + t[5] * (height - 0.5), 60);
        /* What may be a part of a tile is placed too, but not in silence. */
        assert_int_equal(said.warnings, sizes[i].arc_seconds == 0);
        assert_true(said.warnings == 0 || strstr(said.text, "may be truncated"));
        tc_source_close(source);

        source = open_tile("hill.hgt", width, height, (tc_source_options){0}, &said);
        info = tc_source_get_info(source);
        assert_false(info->georef.known);
        assert_int_equal(said.warnings, 1);
        assert_non_null(strstr(said.text, "says no place (as N46E008.hgt would)"));
        assert_non_null(strstr(said.text, "--spacing"));
        assert_non_null(strstr(said.text, sizes[i].arc_seconds > 0 ? "arc-s" : "1 m apart"));
        double second = 6378137 * 3.14159265358979 / 180 / 3600;
        assert_near(info->spacing_y, sizes[i].arc_seconds > 0 ? second * sizes[i].arc_seconds : 1);
        tc_source_close(source);
    }
}

static void names_of_tiles(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int side;
        double south, west, extent; /* degrees; extent 0: no place */
    } names[] = {
        {"N47E011_7201.hgt", 7201, 47, 11, 1},
        {"N47E011_3601.hgt", 7201, 0, 0, 0}, /* at odds with its size */
        {"N47E011-1201.HGT", 1201, 47, 11, 1},
        {"N46E008.SRTMGL1.hgt", 3601, 46, 8, 1},
        {"N46E008.SRTMGL3.hgt", 1201, 46, 8, 1},
        {"N46E008.SRTMGL1.hgt", 1201, 0, 0, 0},
        {"n46_e008_1arc_v3.hgt", 3601, 46, 8, 1},
        {"s07_w100_3arc_v2.hgt", 1201, -7, -100, 1},
        {"N46E008_DSM.hgt", 3601, 46, 8, 1},
        {"S90W180.hgt", 1201, -90, -180, 1},
        {"N90E000.hgt", 1201, 0, 0, 0},
        {"N46E180.hgt", 1201, 0, 0, 0},
        {"N45W074T11.hgt", 1201, 45, -74, 1 / 9.},
        {"N45W074T86.hgt", 1201, 45 + 7 / 9., -74 + 5 / 9., 1 / 9.},
        {"n38w093t97.hgt", 1201, 38 + 8 / 9., -93 + 6 / 9., 1 / 9.},
        {"N45W074T86.hgt", 3601, 0, 0, 0},
        {"N45W074T80.hgt", 1201, 0, 0, 0},
        {"N45W074T861.hgt", 1201, 0, 0, 0},
        {"N45W074T8.hgt", 1201, 0, 0, 0},
        {"N45W0745.hgt", 1201, 0, 0, 0},
        {"N45W074b.hgt", 1201, 0, 0, 0},
        {"N45W074 north half.hgt", 1201, 0, 0, 0},
        {"N45W074_.hgt", 1201, 0, 0, 0},
        {"N45W074.part.hgt", 1201, 0, 0, 0},
        {"N45W74.hgt", 1201, 0, 0, 0},
        {"copy of N45W074.hgt", 1201, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        sayings said;
        int side = names[i].side;
        tc_source *source = open_tile(names[i].name, side, side, (tc_source_options){0}, &said);
        const tc_source_info *info = tc_source_get_info(source);
        const double *t = info->georef.transform;
        bool placed = names[i].extent > 0;
        if (info->georef.known != placed || said.warnings != !placed)
            fail_msg("%s: placed %d, %s", names[i].name, info->georef.known, said.text);
        if (placed) {
            assert_near(t[0] + t[1] / 2, names[i].west);
            assert_near(t[3] + t[5] * (side - 0.5), names[i].south);
            assert_near(t[1] * (side - 1), names[i].extent);
            assert_near(t[5] * (side - 1), -names[i].extent);
        } else {
            assert_non_null(strstr(said.text, "the file's name says no place"));
        }
        tc_source_close(source);
    }

    sayings said;
    tc_source_close(open_tile("N45W074T80.hgt", 1201, 1201, (tc_source_options){0}, &said));
    assert_non_null(strstr(said.text, "no place that is understood"));
    tc_source *source = open_tile("N45W074T80.hgt", 1201, 1201, (tc_source_options){.spacing = 10}, &said);
    assert_true(said.warnings == 0 && tc_source_get_info(source)->spacing_x == 10);
    tc_source_close(source);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles),
        cmocka_unit_test(sizes_of_tiles),
        cmocka_unit_test(names_of_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
