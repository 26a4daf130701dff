/* test_several.c - files that hold several rasters, archives, folders, and tiles that lie on both sides of 180 degrees.
 */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/input/mosaic.h"
#include "tests/support/loading.h"

enum { SIDE = 20 };

/* A tile of SIDE x SIDE heights base + column + 100 row. */
static const char *make_tile(const char *name, double x, double y, double step, int epsg, bool point, int base)
{
    static int16_t z[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++)
        z[i] = (int16_t)(base + i % SIDE + 100 * (i / SIDE));
    const double t[6] = {x, step, 0, y, 0, -step};
    const char *path = made_path(name);
    make_tiff(path, &(made_tiff){.width = SIDE,
                                 .height = SIDE,
                                 .bits = 16,
                                 .format = MADE_INT,
                                 .samples = z,
                                 .transform = t,
                                 .epsg = epsg,
                                 .point = point});
    return path;
}

/* ---- Bands and layers ------------------------------------------------------------------------------------------- */

static void one_of_several_bands(void **state)
{
    (void)state;
    static float z[2 * COUNT];
    for (int i = 0; i < COUNT; i++)
        z[2 * i] = (float)value(i % W, i / W), z[2 * i + 1] = 7;
    made_tiff tiff = {.width = W, .height = H, .bits = 32, .format = MADE_FLOAT, .channels = 2, .samples = z};
    make_tiff(made_path("two.tif"), &tiff);
    sayings said;
    tc_grid g = load(made_path("two.tif"), (tc_source_options){0}, &said);
    assert_values(&g);
    assert_int_equal(said.warnings, 1);
    assert_non_null(strstr(said.text, "--band N"));
    tc_grid_free(&g);
    g = load(made_path("two.tif"), (tc_source_options){.band = 2}, &said);
    assert_true(g.z_min == 7 && g.z_max == 7);
    assert_int_equal(said.warnings, 0);
    tc_grid_free(&g);
    refused_with(made_path("two.tif"), (tc_source_options){.band = 3}, TC_ERR_USAGE, "--band: expected 1..2");
    refused_with(made_path("two.tif"), (tc_source_options){.layer = "x"}, TC_ERR_USAGE, "--layer");
}

/* ---- Archives --------------------------------------------------------------------------------------------------- */

static void put(unsigned char **to, uint32_t n, int bytes)
{
    for (int i = 0; i < bytes; i++)
        *(*to)++ = (unsigned char)(n >> (8 * i));
}

static uint32_t crc32_of(const unsigned char *bytes, size_t count)
{
    uint32_t crc = ~0u;
    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

/* A .zip of files that are stored as they are. */
static const char *make_zip(const char *name, const char *const *inside, const char *const *names, int count)
{
    static unsigned char bytes[1 << 16];
    unsigned char *at = bytes, *central;
    uint32_t offset[8], size[8], crc[8];
    for (int i = 0; i < count; i++) {
        FILE *file = fopen(inside[i], "rb");
        assert_non_null(file);
        offset[i] = (uint32_t)(at - bytes);
        unsigned char *content = at + 30 + strlen(names[i]);
        size[i] = (uint32_t)fread(content, 1, sizeof bytes / 4, file);
        fclose(file);
        crc[i] = crc32_of(content, size[i]);
        put(&at, 0x04034b50, 4), put(&at, 20, 2), put(&at, 0, 4), put(&at, 0, 4);
        put(&at, crc[i], 4), put(&at, size[i], 4), put(&at, size[i], 4);
        put(&at, (uint32_t)strlen(names[i]), 2), put(&at, 0, 2);
        memcpy(at, names[i], strlen(names[i]));
        at = content + size[i];
    }
    central = at;
    for (int i = 0; i < count; i++) {
        put(&at, 0x02014b50, 4), put(&at, 20, 2), put(&at, 20, 2), put(&at, 0, 4), put(&at, 0, 4);
        put(&at, crc[i], 4), put(&at, size[i], 4), put(&at, size[i], 4);
        put(&at, (uint32_t)strlen(names[i]), 2), put(&at, 0, 4), put(&at, 0, 4), put(&at, 0, 4);
        put(&at, offset[i], 4);
        memcpy(at, names[i], strlen(names[i]));
        at += strlen(names[i]);
    }
    uint32_t length = (uint32_t)(at - central);
    put(&at, 0x06054b50, 4), put(&at, 0, 4), put(&at, (uint32_t)count, 2), put(&at, (uint32_t)count, 2);
    put(&at, length, 4), put(&at, (uint32_t)(central - bytes), 4), put(&at, 0, 2);
    make_bytes(made_path(name), bytes, (size_t)(at - bytes));
    return made_path(name);
}

/* A .gz of a file of up to 64 kB that is stored as it is. */
static const char *make_gzip(const char *name, const char *inside)
{
    static unsigned char bytes[1 << 16];
    static const unsigned char head[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3};
    unsigned char *at = bytes + 15;
    FILE *file = fopen(inside, "rb");
    assert_non_null(file);
    uint32_t size = (uint32_t)fread(at, 1, sizeof bytes - 32, file), crc = crc32_of(at, size);
    fclose(file);
    memcpy(bytes, head, sizeof head);
    at = bytes + 10;
    put(&at, 1, 1), put(&at, size, 2), put(&at, ~size & 0xffff, 2);
    at += size;
    put(&at, crc, 4), put(&at, size, 4);
    make_bytes(made_path(name), bytes, (size_t)(at - bytes));
    return made_path(name);
}

static void archives_of_one_file(void **state)
{
    (void)state;
    char a[4096], b[4096], notes[4096];
    snprintf(a, sizeof a, "%s", make_tile("a.tif", 5e5, 5e6, 30, 32633, false, 1000));
    snprintf(b, sizeof b, "%s", make_tile("b.tif", 6e5, 5e6, 30, 32633, false, 2000));
    snprintf(notes, sizeof notes, "%s", made_path("notes.txt"));
    make_bytes(notes, "hello", 5);
    tc_grid g = load(make_zip("one.zip", (const char *[]){notes, a}, (const char *[]){"notes.txt", "in/a.tif"}, 2),
                     (tc_source_options){0}, NULL);
    assert_true(g.width == SIDE && g.z_min == 1000 && g.georef.transform[0] == 5e5);
    tc_grid_free(&g);

    const char *two = make_zip("two.zip", (const char *[]){a, b}, (const char *[]){"in/a.tif", "b.tif"}, 2);
    refused(two, TC_ERR_UNSUPPORTED, "--layer NAME takes one of");
    g = load(two, (tc_source_options){.layer = "b.tif"}, NULL);
    assert_true(g.z_min == 2000);
    tc_grid_free(&g);
    g = load(two, (tc_source_options){.layer = "a.tif"}, NULL);
    assert_true(g.z_min == 1000);
    tc_grid_free(&g);
    refused_with(two, (tc_source_options){.layer = "c.tif"}, TC_ERR_USAGE, "--layer: expected one of");
    /* An .hgt, which GDAL knows by fewer names and sizes, is read as it is outside. */
    static int16_t heights[41 * 41];
    for (int i = 0; i < 41 * 41; i++)
        heights[i] = (int16_t)(i % 41);
    char hgt[4096];
    snprintf(hgt, sizeof hgt, "%s", made_path("tile.hgt"));
    make_hgt(hgt, 41, heights);
    g = load(make_zip("hgt.zip", (const char *[]){hgt}, (const char *[]){"N46E008.hgt"}, 1), (tc_source_options){0},
             NULL);
    refused_with(hgt, (tc_source_options){.crs = "EPSG:4326"}, TC_ERR_USAGE, "--crs: expected none");
    refused_with(hgt, (tc_source_options){.layer = "x"}, TC_ERR_USAGE, "--layer: expected none");
    assert_true(g.width == 41 && g.z_max == 40 && fabs(g.georef.transform[0] - (8 - 1. / 80)) < 1e-12);
    tc_grid_free(&g);
    g = load(make_gzip("N46E008.hgt.gz", hgt), (tc_source_options){0}, NULL);
    assert_true(g.width == 41 && g.z_max == 40 && fabs(g.georef.transform[0] - (8 - 1. / 80)) < 1e-12);
    tc_grid_free(&g);
    refused_with(made_path("N46E008.hgt.gz"), (tc_source_options){.layer = "N46E008.hgt"}, TC_ERR_USAGE,
                 "--layer: expected none");
    refused(make_zip("none.zip", (const char *[]){notes}, (const char *[]){"notes.txt"}, 1), TC_ERR_UNSUPPORTED,
            "none in it");
    cut_file(two, 700);
    tc_grid none = {0};
    tc_error error = {0};
    assert_int_not_equal(tc_grid_load(two, NULL, &none, &error), TC_OK);
    assert_null(strchr(error.text, '\n'));
}

/* ---- Tiles ------------------------------------------------------------------------------------------------------ */

static tc_mosaic *mosaic_of(const char *const *paths, int count)
{
    tc_mosaic *m = NULL;
    tc_error error = {0};
    if (tc_mosaic_open(paths, count, NULL, &m, &error) != TC_OK)
        fail_msg("%s", error.text);
    return m;
}

static void tiles_join_across_180_degrees(void **state)
{
    (void)state;
    const double step = 0.05; /* a degree each */
    char east[4096], west[4096], next[4096];
    snprintf(east, sizeof east, "%s", make_tile("e179.tif", 179, -17, step, 4326, false, 0));
    snprintf(west, sizeof west, "%s", make_tile("w180.tif", -180, -17, step, 4326, false, 5000));
    snprintf(next, sizeof next, "%s", make_tile("w179.tif", -179, -17, step, 4326, false, 9000));
    const char *const orders[][3] = {{east, west, next}, {west, next, east}, {next, east, west}};
    for (int k = 0; k < 3; k++) {
        tc_mosaic *m = mosaic_of(orders[k], 3);
        const tc_pack_terrain *t = tc_mosaic_terrain(m);
        assert_int_equal(t->width, 3 * SIDE);
        assert_int_equal(t->height, SIDE);
        assert_int_equal(tc_mosaic_samples(m), 3 * SIDE * SIDE);
        double first = t->georef.transform[0];
        assert_true(fabs(first - 179) < 1e-9 || fabs(first + 181) < 1e-9);
        tc_mosaic_close(m);
    }
}

static void tiles_far_apart_are_refused_at_once(void **state)
{
    (void)state;
    char near[4096], far[4096];
    snprintf(near, sizeof near, "%s", make_tile("near.tif", 5e5, 5e6, 30, 32633, false, 0));
    snprintf(far, sizeof far, "%s", make_tile("far.tif", 5e5 + 30e7, 5e6, 30, 32633, false, 0));
    tc_mosaic *m = NULL;
    tc_error error = {0};
    assert_int_equal(tc_mosaic_open((const char *[]){near, far}, 2, NULL, &m, &error), TC_ERR_FORMAT);
    assert_non_null(strstr(error.text, "near.tif"));
    assert_non_null(strstr(error.text, "far.tif"));
    assert_non_null(strstr(error.text, "3.005e+08"));
}

static void points_and_areas_of_one_lattice_join(void **state)
{
    (void)state;
    char areas[4096], points[4096];
    snprintf(areas, sizeof areas, "%s", make_tile("areas.tif", 8, 47, 0.05, 4326, false, 0));
    snprintf(points, sizeof points, "%s", make_tile("points.tif", 9.025, 46.975, 0.05, 4326, true, 500));
    tc_mosaic *m = mosaic_of((const char *[]){areas, points}, 2);
    assert_int_equal(tc_mosaic_terrain(m)->width, 2 * SIDE);
    assert_int_equal(tc_mosaic_terrain(m)->height, SIDE);
    tc_mosaic_close(m);
}

static void a_folder_is_its_files(void **state)
{
    (void)state;
    mkdir(made_path("tiles"), 0777);
    make_tile("tiles/a.tif", 8, 47, 0.05, 4326, false, 0);
    make_tile("tiles/b.tif", 9, 47, 0.05, 4326, false, 5000);
    make_bytes(made_path("tiles/readme.md"), "words", 5);
    make_bytes(made_path("tiles/strange"), "words and words", 15);
    tc_grid g = load(made_path("tiles"), (tc_source_options){0}, NULL);
    assert_true(g.width == 2 * SIDE && g.height == SIDE && !g.voids && g.z_min == 0 && g.z_max == 5000 + 19 + 1900);
    assert_true(at(&g, SIDE, 0) == 5000);
    tc_grid_free(&g);
    mkdir(made_path("strangers"), 0777);
    make_bytes(made_path("strangers/readme"), "words", 5);
    refused(made_path("strangers"), TC_ERR_UNSUPPORTED, "none in it");
    unlink(made_path("strangers/readme")), rmdir(made_path("strangers"));
    static const char *const files[] = {"tiles/a.tif", "tiles/b.tif", "tiles/readme.md", "tiles/strange"};
    for (int i = 0; i < 4; i++)
        unlink(made_path(files[i]));
    rmdir(made_path("tiles"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_of_several_bands),
        cmocka_unit_test(archives_of_one_file),
        cmocka_unit_test(tiles_join_across_180_degrees),
        cmocka_unit_test(tiles_far_apart_are_refused_at_once),
        cmocka_unit_test(points_and_areas_of_one_lattice_join),
        cmocka_unit_test(a_folder_is_its_files),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
