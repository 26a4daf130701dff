/* test_write.c - files written and read back, plugins, and nothing written on reading. */
#include "tests/support/test.h"

#include "common/input/plugin.h"
#include "tests/support/loading.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct asked {
    int64_t width, next; /* rows are asked for from the north */
    int64_t fail_at;
    float factor;
} asked;

static tc_status give_row(void *context, int64_t y, double *z)
{
    asked *a = context;
    assert_int_equal(y, a->next--);
    if (y == a->fail_at)
        return TC_ERR_MEMORY;
    for (int64_t x = 0; x < a->width; x++)
        z[x] = a->factor * (float)(x - 2 * y) + 0.25;
    return TC_OK;
}

static void tiffs_come_back(void **state)
{
    (void)state;
    const int64_t sizes[][2] = {{1, 1}, {300, 270}, {5, 600}, {513, 3}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        for (int int16 = 0; int16 < 2; int16++) {
            int64_t w = sizes[s][0], h = sizes[s][1];
            tc_error error = {0};
            asked a = {w, h - 1, -1, 1};
            int before = made_folder_count();
            const char *path = made_path("written.tif");
            unlink(path);
            tc_tiff_options options = {
                .width = w, .height = h, .type = int16 ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32, .spacing = 12.5};
            if (tc_write_tiff(path, &options, give_row, &a, &error) != TC_OK)
                fail_msg("%s", error.text);
            assert_true(made_folder_count() <= before + 1);
            sayings said;
            tc_grid g = load(path, (tc_source_options){0}, &said);
            assert_true(g.width == w && g.height == h && g.spacing_x == 12.5 && g.spacing_y == 12.5);
            assert_true(said.warnings == 0 && !g.voids);
            for (int64_t i = 0; i < w * h; i++)
                assert_true(g.z[i] == (float)(i % w - 2 * (i / w)) + (int16 ? 0 : 0.25f));
            /* The south-west sample is the origin. */
            assert_true(g.georef.transform[0] == -6.25 && g.georef.transform[3] == 12.5 * (double)h - 6.25);
            tc_grid_free(&g);
        }
    }
}

static void failed_writing_leaves_no_trace(void **state)
{
    (void)state;
    const char *path = made_path("kept.tif");
    make_bytes(path, "old", 3);
    int before = made_folder_count();
    tc_error error = {0};
    asked a = {300, 299, 10, 1};
    tc_tiff_options options = {.width = 300, .height = 300, .type = TC_SAMPLE_FLOAT32, .spacing = 1};
    assert_int_equal(tc_write_tiff(path, &options, give_row, &a, &error), TC_ERR_MEMORY);
    a = (asked){300, 299, -1, 1000};
    options.type = TC_SAMPLE_INT16;
    assert_int_equal(tc_write_tiff(path, &options, give_row, &a, &error), TC_ERR_USAGE);
    assert_non_null(strstr(error.text, "int16"));
    options.spacing = 0;
    assert_int_equal(tc_write_tiff(path, &options, give_row, &a, &error), TC_ERR_USAGE);
    assert_int_equal(made_folder_count(), before);
    FILE *file = fopen(path, "rb");
    char old[4] = "";
    assert_int_equal(fread(old, 1, 4, file), 3);
    fclose(file);
    assert_string_equal(old, "old");

    options.spacing = 1;
    assert_int_equal(tc_write_tiff(made_path("no/such/folder.tif"), &options, give_row, &a, &error), TC_ERR_IO);
    assert_int_equal(tc_write_tiff(made_folder(), &options, give_row, &a, &error), TC_ERR_IO);
    assert_int_equal(tc_write_tiff("/dev/full", &options, give_row, &a, &error), TC_ERR_IO);
}

static void pictures_are_written(void **state)
{
    (void)state;
    uint8_t rgb[4 * 3 * 3];
    for (int i = 0; i < 36; i++)
        rgb[i] = (uint8_t)(7 * i);
    tc_error error = {0};
    int before = made_folder_count();
    if (tc_write_picture(made_path("frame.png"), 4, 3, rgb, &error) != TC_OK)
        fail_msg("%s", error.text);
    assert_int_equal(made_folder_count(), before + 1);
    refused(made_path("frame.png"), TC_ERR_UNSUPPORTED, "three channels"); /* so it is there, and RGB */
    assert_int_equal(tc_write_picture(made_path("frame.unknown"), 4, 3, rgb, &error), TC_ERR_USAGE);
    assert_non_null(strstr(error.text, "extension"));
    assert_int_equal(tc_write_picture(made_path("frame"), 4, 3, rgb, &error), TC_ERR_USAGE);
    assert_int_equal(tc_write_picture(made_path("no/such/folder.png"), 4, 3, rgb, &error), TC_ERR_IO);
    assert_int_equal(tc_write_picture(made_path("frame.png"), 0, 3, rgb, &error), TC_ERR_USAGE);
    assert_int_equal(made_folder_count(), before + 1);
}

static void *load_plugin(void *unused)
{
    (void)unused;
    const void *table = NULL;
    return tc_plugin_load("gdal", &table, NULL) == TC_OK ? (void *)(uintptr_t)table : NULL;
}

static void plugins_load_once(void **state)
{
    (void)state;
    pthread_t threads[4];
    void *tables[4];
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, load_plugin, NULL), 0);
    for (int i = 0; i < 4; i++)
        pthread_join(threads[i], &tables[i]);
    for (int i = 0; i < 4; i++)
        assert_true(tables[i] && tables[i] == tables[0]);
    const void *table = NULL;
    tc_error error = {0};
    assert_int_equal(tc_plugin_load("none", &table, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "terraclip-none.so"));
    assert_int_equal(tc_plugin_load("a-name-that-is-far-too-long", &table, &error), TC_ERR_USAGE);
    assert_null(table);
}

/* Reading writes nothing beside what it reads. */
static void reading_leaves_no_trace(void **state)
{
    (void)state;
    made_folder_remove();
    made_tiff tiff = plain_tiff();
    make_tiff(made_path("a.tif"), &tiff);
    make_png(made_path("a.png"), W, H, 16, 0, samples_of(16, MADE_UINT, 1, 0));
    make_pgm(made_path("a.pgm"), W, H, samples_of(16, MADE_UINT, 1, 0));
    make_exr(made_path("a.exr"), W, H, samples_of(32, MADE_FLOAT, 1, 0));
    make_jp2(made_path("a.jp2"));
    const char *const names[] = {"a.tif", "a.png", "a.pgm", "a.exr", "a.jp2"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        tc_grid g = load(made_path(names[i]), (tc_source_options){0}, NULL);
        tc_grid_free(&g);
    }
    assert_int_equal(made_folder_count(), 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiffs_come_back),         cmocka_unit_test(failed_writing_leaves_no_trace),
        cmocka_unit_test(pictures_are_written),    cmocka_unit_test(plugins_load_once),
        cmocka_unit_test(reading_leaves_no_trace),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
