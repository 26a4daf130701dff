/* test_source_refusals.c - elevation files that must be refused, and why. */
#include "tests/support/test.h"

#include "tests/support/loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void refuses_what_is_no_file(void **state)
{
    (void)state;
    refused(made_path("missing.tif"), TC_ERR_IO, "No such file");
    refused(made_folder(), TC_ERR_UNSUPPORTED, "expected a folder of elevation files");
    refused("/dev/null", TC_ERR_IO, "device");
    make_bytes(made_path("empty.tif"), "", 0);
    refused(made_path("empty.tif"), TC_ERR_FORMAT, "empty");
    make_bytes(made_path("one.byte"), "I", 1);
    refused(made_path("one.byte"), TC_ERR_UNSUPPORTED, "neither GDAL nor OpenImageIO");
    make_bytes(made_path("unknown.xyzzy"), "what is this?", 13);
    refused(made_path("unknown.xyzzy"), TC_ERR_UNSUPPORTED, "neither GDAL nor OpenImageIO");
    make_bytes(made_path("short.hgt"), "abcd", 4);
    refused(made_path("short.hgt"), TC_ERR_FORMAT, "expected a square or known rectangular number");
    refused(made_path("short.hgt"), TC_ERR_FORMAT, "found 4 bytes; it may be truncated");
    make_bytes(made_path("odd.hgt"), "abc", 3);
    refused(made_path("odd.hgt"), TC_ERR_FORMAT, "damaged or truncated: expected a square");
    make_bytes(made_path("one.hgt"), "ab", 2);
    refused(made_path("one.hgt"), TC_ERR_FORMAT, "found 2 bytes");
    make_bytes(made_path("text.pgm"), "P2\n2 2\n9\n1 2 3 4\n", 17);
    refused(made_path("text.pgm"), TC_ERR_UNSUPPORTED, "P5");
}

static void refuses_colours(void **state)
{
    (void)state;
    unsigned char *bytes = calloc(COUNT, 3);
    make_png(made_path("rgb.png"), W, H, 8, 2, bytes);
    refused(made_path("rgb.png"), TC_ERR_UNSUPPORTED, "Terrarium");
    refused(made_path("rgb.png"), TC_ERR_UNSUPPORTED, "Mapbox");
    make_png(made_path("palette.png"), W, H, 8, 3, bytes);
    refused(made_path("palette.png"), TC_ERR_UNSUPPORTED, "palette");
    make_tiff(made_path("rgb.tif"),
              &(made_tiff){.width = W, .height = H, .bits = 8, .format = MADE_UINT, .channels = 3, .samples = bytes});
    refused(made_path("rgb.tif"), TC_ERR_UNSUPPORTED, "three channels");
    make_tiff(made_path("palette.tif"),
              &(made_tiff){.width = W, .height = H, .bits = 8, .format = MADE_UINT, .palette = true, .samples = bytes});
    refused(made_path("palette.tif"), TC_ERR_UNSUPPORTED, "palette");
    free(bytes);
}

static void refuses_what_is_no_height(void **state)
{
    (void)state;
    made_tiff tiff = plain_tiff();
    int16_t nothing[COUNT];
    for (int i = 0; i < COUNT; i++)
        nothing[i] = -5;
    tiff.samples = nothing;
    tiff.nodata = "-5";
    make_tiff(made_path("void.tif"), &tiff);
    refused(made_path("void.tif"), TC_ERR_FORMAT, "all void");
    refused_with(made_path("void.tif"), (tc_source_options){.voids = TC_VOIDS_CONSTANT}, TC_ERR_FORMAT, "all void");

    make_tiff(
        made_path("high.tif"),
        &(made_tiff){
            .width = W, .height = H, .bits = 32, .format = MADE_FLOAT, .samples = samples_of(32, MADE_FLOAT, 1e9, 0)});
    refused(made_path("high.tif"), TC_ERR_FORMAT, "1e9");

    const char huge[] = "<VRTDataset rasterXSize=\"2000000\" rasterYSize=\"2000000\"><VRTRasterBand dataType=\"Int16\" "
                        "band=\"1\"></VRTRasterBand></VRTDataset>";
    make_bytes(made_path("huge.vrt"), huge, strlen(huge));
    refused(made_path("huge.vrt"), TC_ERR_MEMORY, "GiB");
}

static void refuses_options_out_of_range(void **state)
{
    (void)state;
    const char *path = made_path("fine.tif");
    made_tiff tiff = plain_tiff();
    make_tiff(path, &tiff);
    const double bad[] = {NAN, INFINITY, 1e-300, 1e300};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        refused_with(path, (tc_source_options){.spacing = bad[i]}, TC_ERR_USAGE, "spacing");
        refused_with(path, (tc_source_options){.unit = bad[i]}, TC_ERR_USAGE, "unit");
    }
    refused_with(path, (tc_source_options){.spacing = -1}, TC_ERR_USAGE, "spacing");
    refused_with(path, (tc_source_options){.has_offset = true, .offset = NAN}, TC_ERR_USAGE, "offset");
    refused_with(path, (tc_source_options){.voids = TC_VOIDS_CONSTANT, .void_constant = NAN}, TC_ERR_USAGE, "voids");
    refused_with(path, (tc_source_options){.voids = TC_VOIDS_CONSTANT, .void_constant = 1e30}, TC_ERR_USAGE, "voids");
}

/* Every format, cut at many lengths: never a crash, never taken for whole. */
static void refuses_truncated_files(void **state)
{
    (void)state;
    made_tiff tiff = plain_tiff();
    const char *const names[] = {"strips.tif", "tiles.tif", "whole.png", "whole.pgm", "whole.exr", "whole.jp2"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        const char *path = made_path(names[n]);
        long size = 0;
        for (int cut = 0; cut < 24; cut++) {
            tiff.tile = n == 1 ? 16 : 0;
            switch (n) {
            case 0:
            case 1: make_tiff(path, &tiff); break;
            case 2: make_png(path, W, H, 16, 0, samples_of(16, MADE_UINT, 1, 0)); break;
            case 3: make_pgm(path, W, H, samples_of(16, MADE_UINT, 1, 0)); break;
            case 4: make_exr(path, W, H, samples_of(32, MADE_FLOAT, 1, 0)); break;
            case 5: make_jp2(path); break;
            }
            struct stat about;
            stat(path, &about);
            size = (long)about.st_size;
            cut_file(path, cut < 4 ? -1 - 3 * cut : size * (cut - 3) / 21);
            if (size * (cut - 3) / 21 == size)
                continue;
            tc_grid grid = {0};
            tc_error error = {0};
            tc_status status = tc_grid_load(path, NULL, &grid, &error);
            if (status == TC_OK)
                fail_msg("%s: taken for whole after cut %d", path, cut);
            assert_true(strlen(error.text) > 0 && !strchr(error.text, '\n'));
            assert_int_equal(tc_exit_code(status), 1);
        }
    }
}

/* The samples of a TIFF whose directory comes first, cut in the middle: libtiff has all it needs to open it. */
static void refuses_missing_samples(void **state)
{
    (void)state;
    for (int tile = 0; tile <= 16; tile += 16) {
        const char *path = made_path("late.tif");
        made_tiff tiff = plain_tiff();
        tiff.tile = tile;
        make_tiff(path, &tiff);
        /* Offsets of the blocks moved beyond the end say the same as an end cut off. */
        FILE *file = fopen(path, "r+b");
        unsigned char bytes[65536];
        size_t size = fread(bytes, 1, sizeof bytes, file);
        uint32_t directory;
        memcpy(&directory, bytes + 4, 4);
        for (unsigned char *e = bytes + directory + 2; e < bytes + size; e += 12) {
            uint16_t tag;
            memcpy(&tag, e, 2);
            if (tag != 273 && tag != 324)
                continue;
            uint32_t count, where, late = (uint32_t)size - 10;
            memcpy(&count, e + 4, 4);
            memcpy(&where, e + 8, 4);
            fseek(file, (long)(where + 4 * (count / 2)), SEEK_SET);
            fwrite(&late, 4, 1, file);
            break;
        }
        fclose(file);
        refused(path, TC_ERR_FORMAT, "damaged or truncated");
    }
}

static const char *make_text(const char *name, const char *head, const char *values)
{
    char text[1024];
    const int length = snprintf(text, sizeof text, "%s%s", head, values);
    make_bytes(made_path(name), text, (size_t)length);
    return made_path(name);
}

/* GDAL reads 0 for a last value that is missing, and for words. */
static void refuses_grids_of_text_without_all_numbers(void **state)
{
    (void)state;
    static const char *const heads[] = {
        "ncols 3\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 30\n",
        "NCOLS 3\r\nNROWS 2\r\nXLLCORNER 0\r\nYLLCORNER 0\r\nDX 30\r\nDY 20\r\nNODATA_VALUE -9999\r\n",
        "north: 60\nsouth: 0\neast: 90\nwest: 0\nrows: 2\ncols: 3\n"};
    static const struct {
        const char *values, *reason; /* NULL: it is read */
    } cases[] = {
        {"1 2 3\n4 5 6\n", NULL},
        {"1 2 3\n4 5 6", NULL},
        {"\t1\n2 3 4\r\n\r\n5 \f6\n\n7 8", NULL},
        {"1.5 2. .25\n-4 +5 6e-1\n", NULL},
        {"1,5 2 ,25\n-4 1e3 0006\n", NULL},
        {"1.5 NaN 1.#QNAN 4 -1.#IND nan", NULL},
        {"1.5 null 3 4 5 6", NULL},
        {"1 2 3\n4 5", "expected 6 values, found 5"},
        {"1 2 3\n4 5\n", "expected 6 values, found 5"},
        {"1 2 3\n4 5 \r\n \n", "expected 6 values, found 5"},
        {"1.5 2 3\n4\n", "expected 6 values, found 4"},
        {"1 2 3\n4 abc 6\n", "row 2, column 2: expected a whole number, found 'abc'"},
        {"1.5 2 3\n4 abc 6\n", "row 2, column 2: expected a number, found 'abc'"},
        {"1.5 2 3 4 5 -", "row 2, column 3: expected a number, found '-'"},
        {"1 * 3\n4 5 6\n", "row 1, column 2: expected a whole number, found '*'"},
        {"1 nan 3\n4 5 6\n", "row 1, column 2: expected a whole number, found 'nan'"},
        {"1 null 3\n4 5 6\n", "expected a whole number, found 'null'"},
        {"1.5 2m 3\n4 5 6\n", "expected a number, found '2m'"},
        {"1.5 1.5d2 3\n4 5 6\n", "expected a number, found '1.5d2'"},
        {"1.5 1,000.5 3\n4 5 6\n", "expected a number, found '1,000.5'"},
        {"1.5 \xff\x01 3\n4 5 6\n", "expected a number, found '\?\?'"},
    };
    for (size_t h = 0; h < sizeof heads / sizeof *heads; h++)
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            const char *path = make_text("grid.asc", heads[h], cases[k].values);
            tc_grid grid = {0};
            tc_error error = {.text = ""};
            if (cases[k].reason)
                refused(path, TC_ERR_FORMAT, cases[k].reason);
            else if (tc_grid_load(path, NULL, &grid, &error) != TC_OK)
                fail_msg("%d, %d: %s", (int)h, (int)k, error.text);
            tc_grid_free(&grid);
        }
}

/* Its text is looked over in pieces, whose ends cut values. */
static void looks_over_large_grids_of_text(void **state)
{
    (void)state;
    enum { SIDE = 300, ROOM = SIDE * SIDE * 9 + 256 };
    char *text = malloc(ROOM);
    int length = snprintf(text, ROOM, "ncols %d\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize 30\n", SIDE, SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        length += snprintf(text + length, ROOM - (size_t)length, "%s%d",
                           i == 0        ? ""
                           : i % 17 == 0 ? "  \n"
                                         : " ",
                           10000 + i * 7 % 9000);
    make_bytes(made_path("large.asc"), text, (size_t)length);
    tc_grid grid = load(made_path("large.asc"), (tc_source_options){0}, NULL);
    for (int i = 0; i < SIDE * SIDE; i += 101)
        assert_true(at(&grid, i % SIDE, i / SIDE) == 10000 + i * 7 % 9000);
    tc_grid_free(&grid);
    make_bytes(made_path("large.asc"), text, (size_t)length - 6);
    refused(made_path("large.asc"), TC_ERR_FORMAT, "expected 90000 values, found 89999");
    memset(text + 200000, 'x', 600); /* longer than any number */
    make_bytes(made_path("large.asc"), text, (size_t)length);
    refused(made_path("large.asc"), TC_ERR_FORMAT, "expected a whole number, found '");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_what_is_no_file),
        cmocka_unit_test(refuses_colours),
        cmocka_unit_test(refuses_what_is_no_height),
        cmocka_unit_test(refuses_options_out_of_range),
        cmocka_unit_test(refuses_truncated_files),
        cmocka_unit_test(refuses_missing_samples),
        cmocka_unit_test(refuses_grids_of_text_without_all_numbers),
        cmocka_unit_test(looks_over_large_grids_of_text),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
