/* test_source.c - elevation files that load: formats, units, places, voids, sizes, real data. */
#include "tests/support/test.h"

#include "tests/support/loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void tiffs_of_all_types(void **state)
{
    (void)state;
    const struct {
        int bits;
        made_format format;
        const char *name;
    } types[] = {{8, MADE_UINT, "uint8"},    {16, MADE_UINT, "uint16"}, {16, MADE_INT, "int16"},
                 {32, MADE_UINT, "uint32"},  {32, MADE_INT, "int32"},   {32, MADE_FLOAT, "float32"},
                 {64, MADE_FLOAT, "float64"}};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        for (int tile = 0; tile <= 16; tile += 16) {
            const char *path = made_path("type.tif");
            make_tiff(path, &(made_tiff){.width = W,
                                         .height = H,
                                         .bits = types[t].bits,
                                         .format = types[t].format,
                                         .tile = tile,
                                         .samples = samples_of(types[t].bits, types[t].format, 1, 0)});
            sayings said;
            tc_grid g = load(path, (tc_source_options){0}, &said);
            assert_values(&g);
            assert_null(g.voids);
            assert_int_equal(g.void_count, 0);
            assert_true(g.spacing_x == 1 && g.spacing_y == 1 && g.z_base == 0);
            assert_false(g.georef.known);
            assert_int_equal(said.warnings, types[t].bits == 8);
            if (types[t].bits == 8)
                assert_non_null(strstr(said.text, "256 steps"));
            tc_grid_free(&g);

            tc_source *source = NULL;
            assert_int_equal(tc_source_open(path, NULL, &source, NULL), TC_OK);
            const tc_source_info *info = tc_source_get_info(source);
            assert_string_equal(info->sample_type, types[t].name);
            assert_int_equal(info->integer, types[t].format != MADE_FLOAT);
            tc_source_close(source);
        }
    }
}

static void pictures_and_other_formats(void **state)
{
    (void)state;
    make_png(made_path("16.png"), W, H, 16, 0, samples_of(16, MADE_UINT, 1, 0));
    make_png(made_path("8.png"), W, H, 8, 0, samples_of(8, MADE_UINT, 1, 0));
    make_pgm(made_path("16.pgm"), W, H, samples_of(16, MADE_UINT, 1, 0));
    make_exr(made_path("float.exr"), W, H, samples_of(32, MADE_FLOAT, 1, 0));
    make_png(made_path("png-by-content.hgt"), W, H, 16, 0, samples_of(16, MADE_UINT, 1, 0));
    make_exr(made_path("exr-by-content.png"), W, H, samples_of(32, MADE_FLOAT, 1, 0));
    const char *const names[] = {"16.png", "8.png", "16.pgm", "float.exr", "png-by-content.hgt", "exr-by-content.png"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        sayings said;
        tc_grid g = load(made_path(names[i]), (tc_source_options){0}, &said);
        assert_values(&g);
        assert_int_equal(said.warnings, strcmp(names[i], "8.png") == 0);
        tc_grid_free(&g);
    }

    make_jp2(made_path("a.jp2"));
    tc_grid g = load(made_path("a.jp2"), (tc_source_options){0}, NULL);
    assert_true(g.width == 16 && g.height == 12);
    for (int row = 0; row < 12; row++)
        for (int column = 0; column < 16; column++)
            assert_true(at(&g, column, row) == (float)(1000 + 10 * column + row));
    tc_grid_free(&g);

    const char grid[] = "ncols 3\nnrows 2\nxllcorner 1000\nyllcorner 2000\ncellsize 30\nNODATA_value -9999\n"
                        "1 2 3\n4 -9999 6\n";
    make_bytes(made_path("a.asc"), grid, strlen(grid));
    g = load(made_path("a.asc"), (tc_source_options){0}, NULL);
    assert_true(at(&g, 0, 0) == 1 && at(&g, 2, 1) == 6 && void_at(&g, 1, 1) && g.void_count == 1);
    assert_true(g.spacing_x == 30 && g.spacing_y == 30);
    tc_grid_free(&g);
}

static void vrt_mosaics(void **state)
{
    (void)state;
    made_tiff tiff = plain_tiff();
    make_tiff(made_path("part.tif"), &tiff);
    char text[2048];
    snprintf(text, sizeof text,
             "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><GeoTransform>0, 5, 0, 0, 0, -5</GeoTransform>"
             "<VRTRasterBand dataType=\"Int16\" band=\"1\"><NoDataValue>-1</NoDataValue>"
             "<SimpleSource><SourceFilename relativeToVRT=\"1\">part.tif</SourceFilename><SourceBand>1</SourceBand>"
             "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/><DstRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" "
             "ySize=\"%d\"/>"
             "</SimpleSource></VRTRasterBand></VRTDataset>",
             W + 2, H, W, H, W, H);
    make_bytes(made_path("mosaic.vrt"), text, strlen(text));
    tc_grid g = load(made_path("mosaic.vrt"), (tc_source_options){0}, NULL);
    assert_int_equal(g.void_count, 2 * H);
    assert_true(at(&g, 3, 4) == value(3, 4) && void_at(&g, W, 0) && !void_at(&g, W - 1, 0));
    assert_true(g.spacing_x == 5);
    tc_grid_free(&g);

    cut_file(made_path("part.tif"), -200); /* a part that is damaged, then missing, then on the network */
    refused(made_path("mosaic.vrt"), TC_ERR_FORMAT, "");
    unlink(made_path("part.tif"));
    refused(made_path("mosaic.vrt"), TC_ERR_FORMAT, "part.tif");
    char *name = strstr(text, "part.tif");
    memcpy(name - strlen("relativeToVRT=\"1\">"), "relativeToVRT=\"0\">", strlen("relativeToVRT=\"0\">"));
    char remote[2048];
    snprintf(remote, sizeof remote, "%.*s/vsicurl/http://example.com/%s", (int)(name - text), text, name);
    make_bytes(made_path("remote.vrt"), remote, strlen(remote));
    refused(made_path("remote.vrt"), TC_ERR_UNSUPPORTED, "network");
}

static void places(void **state)
{
    (void)state;
    const char *path = made_path("place.tif");
    made_tiff tiff = plain_tiff();
    tiff.epsg = 32633;
    tiff.transform = (const double[]){500000, 10, 0, 4000000, 0, -20};
    make_tiff(path, &tiff);
    tc_grid g = load(path, (tc_source_options){0}, NULL);
    assert_values(&g);
    assert_true(g.spacing_x == 10 && g.spacing_y == 20 && g.georef.known && !g.georef.geographic);
    assert_true(g.georef.transform[0] == 500000 && g.georef.semi_major == 6378137);
    tc_grid_free(&g);
    g = load(path, (tc_source_options){.spacing = 2.5}, NULL);
    assert_true(g.spacing_x == 2.5 && g.spacing_y == 2.5 && g.georef.known);
    tc_grid_free(&g);

    tiff.point = true; /* the same numbers now place the sample, not the corner */
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, NULL);
    assert_true(g.georef.transform[0] == 499995 && g.georef.transform[3] == 4000010);
    tc_grid_free(&g);
    tiff.point = false;

    tiff.epsg = 2227; /* in US survey feet */
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, NULL);
    assert_float_equal(g.spacing_x, 10 * 1200. / 3937, 1e-9);
    tc_grid_free(&g);
    tiff.epsg = 32633;

    /* Rows south to north, columns east to west. */
    tiff.transform = (const double[]){500000, 10, 0, 4000000, 0, 20};
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, NULL);
    assert_true(g.z[0] == value(0, 0) && g.z[(H - 1) * W + 2] == value(2, H - 1));
    assert_true(g.georef.transform[3] == 4000000 + 20 * H && g.georef.transform[5] == -20);
    tc_grid_free(&g);
    tiff.transform = (const double[]){500000, -10, 0, 4000000, 0, -20};
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, NULL);
    assert_true(at(&g, 0, 0) == value(W - 1, 0) && at(&g, W - 1, 3) == value(0, 3));
    assert_true(g.georef.transform[0] == 500000 - 10 * W && g.georef.transform[1] == 10);
    tc_grid_free(&g);

    tiff.transform = (const double[]){500000, 3, 4, 4000000, 4, -3};
    make_tiff(path, &tiff);
    sayings said;
    g = load(path, (tc_source_options){0}, &said);
    assert_values(&g);
    assert_true(g.spacing_x == 5 && g.spacing_y == 5 && said.warnings == 1 && strstr(said.text, "rotated"));
    tc_grid_free(&g);

    /* Around the whole globe: the mean latitude is 0. */
    tiff.epsg = 4326;
    tiff.transform = (const double[]){-180, 360. / W, 0, 90, 0, -180. / H};
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, NULL);
    assert_float_equal(g.spacing_x, 2 * acos(-1) * 6378137 / W, 1e-3);
    assert_true(g.georef.geographic);
    tc_grid_free(&g);

    /* Degrees that do not say so. */
    tiff.epsg = 0;
    tiff.transform = (const double[]){8, 1. / 1200, 0, 46.5 + H / 2400., 0, -1. / 1200};
    make_tiff(path, &tiff);
    g = load(path, (tc_source_options){0}, &said);
    assert_float_equal(g.spacing_x, 63.969, 0.001);
    assert_int_equal(said.warnings, 1);
    tc_grid_free(&g);
}

static void units(void **state)
{
    (void)state;
    const char *path = made_path("unit.tif");
    made_tiff tiff = plain_tiff();
    tiff.metadata = "<Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.5</Item>"
                    "<Item name=\"OFFSET\" sample=\"0\" role=\"offset\">-100</Item>"
                    "<Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">ft</Item>";
    make_tiff(path, &tiff);
    tc_grid g = load(path, (tc_source_options){0}, NULL);
    assert_float_equal(at(&g, 4, 5), (value(4, 5) * 0.5 - 100) * 0.3048, 1e-5);
    tc_grid_free(&g);
    g = load(path, (tc_source_options){.unit = 2}, NULL);
    assert_float_equal(at(&g, 4, 5), value(4, 5) * 2 - 100 * 0.3048, 1e-4);
    tc_grid_free(&g);

    tiff.metadata = "<Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">fathom</Item>";
    make_tiff(path, &tiff);
    sayings said;
    g = load(path, (tc_source_options){0}, &said);
    assert_values(&g);
    assert_true(said.warnings == 1 && strstr(said.text, "fathom"));
    tc_grid_free(&g);
}

/* Relief of millimetres on a million metres does not drown in a float. */
static void small_relief_far_up(void **state)
{
    (void)state;
    const char *path = made_path("base.tif");
    const struct {
        int bits;
        made_format format;
        double factor, offset, unit;
    } kinds[] = {{64, MADE_FLOAT, 1e-3, 1e6, 1}, {32, MADE_INT, 1, 1e9, 1e-3}, {32, MADE_UINT, 1, 1e9, 1e-3}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        make_tiff(path, &(made_tiff){.width = W,
                                     .height = H,
                                     .bits = kinds[k].bits,
                                     .format = kinds[k].format,
                                     .samples =
                                         samples_of(kinds[k].bits, kinds[k].format, kinds[k].factor, kinds[k].offset)});
        tc_grid g = load(path, (tc_source_options){.unit = kinds[k].unit}, NULL);
        assert_true(g.z_base == 1e6);
        for (int i = 0; i < COUNT; i++)
            assert_float_equal(at(&g, i % W, i / W), 1e-3 * value(i % W, i / W), 1e-7);
        tc_grid_free(&g);
    }
}

static void voids_of_all_kinds(void **state)
{
    (void)state;
    const char *path = made_path("void.tif");
    float heights[COUNT];
    memcpy(heights, samples_of(32, MADE_FLOAT, 1, 0), sizeof heights);
    heights[3] = NAN;
    heights[W + 5] = INFINITY;
    heights[2 * W + 7] = -INFINITY;
    heights[4 * W + 4] = -3.4028234663852886e38f;
    heights[6 * W + 6] = -9999;
    made_tiff tiff = {.width = W, .height = H, .bits = 32, .format = MADE_FLOAT, .samples = heights, .nodata = "-9999"};
    make_tiff(path, &tiff);
    for (tc_void_policy policy = TC_VOIDS_FILL; policy <= TC_VOIDS_CONSTANT; policy++) {
        sayings said;
        tc_grid g = load(path, (tc_source_options){.voids = policy, .void_constant = -77}, &said);
        assert_int_equal(g.void_count, 5);
        assert_int_equal(said.warnings, 1); /* of the fill value */
        assert_true(void_at(&g, 3, 0) && void_at(&g, 5, 1) && void_at(&g, 7, 2) && void_at(&g, 4, 4) &&
                    void_at(&g, 6, 6));
        assert_true(g.z_min == (float)value(0, 0) && g.z_max == (float)value(W - 1, H - 1));
        for (int i = 0; i < COUNT; i++)
            assert_float_equal(at(&g, i % W, i / W), value(i % W, i / W), 2);
        assert_true(g.voids_flat == (policy == TC_VOIDS_CONSTANT));
        assert_true(!g.voids_flat || g.void_height == -77);
        tc_grid_free(&g);
    }

    /* A nodata tag with the digits that a float has as text. */
    tiff.nodata = "-3.40282346638529e+38";
    make_tiff(path, &tiff);
    sayings said;
    tc_grid g = load(path, (tc_source_options){.has_nodata = true, .nodata = -9999}, &said);
    assert_true(g.void_count == 5 && said.warnings == 0);
    tc_grid_free(&g);

    /* In row order and in any other, the source gives the same. */
    tc_source *source = NULL;
    assert_int_equal(tc_source_open(path, NULL, &source, NULL), TC_OK);
    float row[W], all[COUNT];
    uint8_t mask[W], masks[COUNT];
    assert_int_equal(tc_source_read(source, 0, H, all, masks, NULL), TC_OK);
    for (int64_t y = 0; y < H; y++) {
        assert_int_equal(tc_source_read(source, y, 1, row, mask, NULL), TC_OK);
        assert_memory_equal(row, all + y * W, sizeof row);
        assert_memory_equal(mask, masks + y * W, sizeof mask);
    }
    assert_true(masks[(H - 1) * W + 3] == 1 && all[(H - 1) * W + 3] == 0);
    assert_int_equal(tc_source_read(source, 0, H + 1, all, masks, NULL), TC_ERR_USAGE);
    assert_int_equal(tc_source_read(source, -1, 1, all, masks, NULL), TC_ERR_USAGE);
    tc_source_close(source);
}

/* Values that mostly mean none are told where nothing declares them, and heights like them are not. */
static void suspicious_values(void **state)
{
    (void)state;
    enum { SIDE = 40 };
    static const struct {
        int fill, first, step; /* around heights from `first` on */
        const char *said;      /* NULL: nothing */
    } cases[] = {
        {-9999, 300, 3, "--nodata -9999 says so"},
        {-32768, 5, 1, "--nodata -32768 says so"},
        {-9998, 300, 3, NULL},
        {0, 300, 3, "--nodata 0 says so"},
        {0, 1, 3, NULL} /* a coast */,
        {0, -70, 3, NULL},
        {0, 0, 0, NULL} /* sea */,
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        int16_t heights[SIDE * SIDE];
        for (int i = 0; i < SIDE * SIDE; i++) {
            int x = i % SIDE, y = i / SIDE, inside = x > 3 && x < SIDE - 2 && y > 0;
            heights[i] = (int16_t)(inside ? cases[k].first + cases[k].step * (x - 4) + y % 3 : cases[k].fill);
        }
        made_tiff tiff = {.width = SIDE, .height = SIDE, .bits = 16, .format = MADE_INT, .samples = heights};
        sayings said;
        const char *path = made_path("suspect.tif");
        make_tiff(path, &tiff);
        tc_grid g = load(path, (tc_source_options){.spacing = 10}, &said);
        assert_int_equal(said.warnings, cases[k].said != NULL);
        assert_true(!cases[k].said || strstr(said.text, cases[k].said));
        assert_int_equal(g.void_count, 0);
        tc_grid_free(&g);
        if (!cases[k].said)
            continue;
        g = load(path, (tc_source_options){.spacing = 10, .has_nodata = true, .nodata = cases[k].fill}, &said);
        assert_true(said.warnings == 0 && g.void_count == SIDE * SIDE - (SIDE - 6) * (SIDE - 1));
        tc_grid_free(&g);
    }
}

static void sizes_at_the_edge(void **state)
{
    (void)state;
    const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {2, 2}, {70000, 3}, {3, 1000}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        int w = sizes[s][0], h = sizes[s][1];
        uint16_t *heights = malloc((size_t)(w * h) * sizeof *heights);
        for (int i = 0; i < w * h; i++)
            heights[i] = (uint16_t)(i % 60000);
        const char *path = made_path("size.tif");
        make_tiff(path, &(made_tiff){.width = w, .height = h, .bits = 16, .format = MADE_UINT, .samples = heights});
        tc_grid g = load(path, (tc_source_options){0}, NULL);
        assert_true(g.width == w && g.height == h);
        for (int i = 0; i < w * h; i++)
            assert_true(at(&g, i % w, i / w) == heights[i]);
        tc_grid_free(&g);
        free(heights);
    }
}

/* Real elevation models, where they are. Figures as in their description. */
static void real_data(void **state)
{
    (void)state;
    const char *place = getenv("TERRACLIP_DATA");
    if (!place) {
        print_message("TERRACLIP_DATA is not set: real elevation models not tried\n");
        skip();
    }
    const struct {
        const char *name;
        int64_t width, height, voids;
        double low, high, spacing_x, spacing_y, semi_major;
        int column, row;
        double value; /* of that sample, by gdallocationinfo */
    } files[] = {
        {"N37W119.hgt", 1201, 1201, 5756, 1167, 4320, 73.688, 92.489, 6378137, 600, 600, 1542},
        {"N37W120.hgt", 1201, 1201, 6457, 90, 3971, 73.688, 92.489, 6378137, 400, 960, 735},
        {"N46E008.tif", 1201, 1201, 103743, 187, 4173, 63.969, 92.634, 6378137, 400, 960, 1100},
        {"srtm3_tatra_poland_4801.tif", 4801, 4801, 64, -2, 2636, 58.498, 92.707, 6378137, 1600, 3840, 594},
        {"srtm3_canyonlands_voids_2401x3601.tif", 2401, 3601, 104445, 1092, 3862, 73.688, 92.489, 6378137, 800, 2880,
         2226},
        {"moon_gld100_256ppd_ne_4097.png", 4097, 4097, 0, 5367, 12592, 1, 1, 0, 1365, 3277, 10527},
        {"moon_gld100_256ppd_ne_8193.tif", 8193, 8193, 0, -6310, 3581, 107.354, 118.451, 1737400, 2731, 6554, -158},
        {"moon_gld100_global_5760x2880.tif", 5760, 2880, 0, -9052, 10745, 1895.209, 1895.209, 1737400, 1920, 2303,
         -1748},
        {"earth_etopo20_1080x540_f32.tif", 1080, 540, 0, -9026.625, 6228.8125, 37106.497, 36858.092, 6378137, 540, 269,
         -4859.625},
        {"ps_height_1k.png", 1025, 1025, 0, 0, 43798, 1, 1, 0, 341, 819, 941},
    };
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", place, files[f].name);
        if (access(path, R_OK) != 0) {
            print_message("%s: not there, not tried\n", path);
            continue;
        }
        tc_grid g = load(path, (tc_source_options){0}, NULL);
        assert_int_equal(g.width, files[f].width);
        assert_int_equal(g.height, files[f].height);
        assert_int_equal(g.void_count, files[f].voids);
        assert_true(g.z_min == files[f].low && g.z_max == files[f].high);
        assert_float_equal(g.spacing_x, files[f].spacing_x, 0.001);
        assert_float_equal(g.spacing_y, files[f].spacing_y, 0.001);
        assert_true(g.georef.semi_major == files[f].semi_major);
        assert_float_equal(at(&g, files[f].column, files[f].row), files[f].value, 1e-3);
        for (int64_t i = 0; i < g.width * g.height; i++)
            assert_true(g.z[i] >= g.z_min && g.z[i] <= g.z_max);
        tc_grid_free(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiffs_of_all_types),
        cmocka_unit_test(pictures_and_other_formats),
        cmocka_unit_test(vrt_mosaics),
        cmocka_unit_test(places),
        cmocka_unit_test(units),
        cmocka_unit_test(small_relief_far_up),
        cmocka_unit_test(voids_of_all_kinds),
        cmocka_unit_test(suspicious_values),
        cmocka_unit_test(sizes_at_the_edge),
        cmocka_unit_test(real_data),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
