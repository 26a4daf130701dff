/* test_terrain_files.c - crops of datasets, which codecs are compared on. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "tests/support/made_files.h"
#include "tests/support/terrain_files.h"

enum { WIDTH = 41, HEIGHT = 30, SIZE = 21, VOID = -999 };

static int16_t stored(int64_t column, int64_t row)
{
    return column == 15 && row == 12 ? VOID : (int16_t)(3000 + 7 * column - 11 * row);
}

/* The file says its scale and an offset that is no multiple of it: what comes back are multiples, of the middle. */
static void integers_come_back_as_multiples(void **state)
{
    (void)state;
    int16_t samples[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        samples[i] = stored(i % WIDTH, i / WIDTH);
    made_tiff tiff = {.width = WIDTH, .height = HEIGHT, .bits = 16, .format = MADE_INT, .samples = samples};
    tiff.nodata = "-999";
    tiff.metadata = "<Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.25</Item>"
                    "<Item name=\"OFFSET\" sample=\"0\" role=\"offset\">100.1</Item>";
    make_tiff(made_path("scaled.tif"), &tiff);
    setenv("TERRACLIP_DATA", made_folder(), 1);

    terrain_file about;
    tc_grid crop;
    const dataset set = {"scaled.tif", 30, 0};
    assert_true(terrain_file_crop(&set, SIZE, &about, &crop));
    assert_int_equal(about.type, TC_SAMPLE_INT16);
    assert_float_equal(about.unit, 0.25, 0);
    assert_true(crop.width == SIZE && crop.height == SIZE && !crop.voids);
    int x0 = (WIDTH - SIZE) / 2, y0 = (HEIGHT - SIZE) / 2, filled = 0;
    for (int64_t y = 0; y < SIZE; y++)
        for (int64_t x = 0; x < SIZE; x++) {
            int64_t column = x0 + x, row = y0 + SIZE - 1 - y;
            float z = crop.z[y * SIZE + x];
            assert_true(z >= crop.z_min && z <= crop.z_max && z / 0.25f == rintf(z / 0.25f));
            if (stored(column, row) == VOID)
                filled += z > 0;
            else
                assert_float_equal(z, 0.25 * stored(column, row), 0);
        }
    assert_int_equal(filled, 1);
    tc_grid_free(&crop);
}

static void floats_have_no_unit(void **state)
{
    (void)state;
    float samples[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        samples[i] = sinf((float)i);
    make_tiff(made_path("floats.tif"),
              &(made_tiff){.width = WIDTH, .height = HEIGHT, .bits = 32, .format = MADE_FLOAT, .samples = samples});
    setenv("TERRACLIP_DATA", made_folder(), 1);
    terrain_file about;
    tc_grid crop;
    assert_true(terrain_file_crop(&(dataset){"floats.tif", 30, 0}, 1000, &about, &crop));
    assert_true(about.type == TC_SAMPLE_FLOAT32 && about.unit == 0);
    assert_true(crop.width == WIDTH && crop.height == HEIGHT);
    assert_float_equal(crop.z[(HEIGHT - 1) * WIDTH + 3], samples[3], 0);
    tc_grid_free(&crop);
}

static void places_lie_within(void **state)
{
    (void)state;
    test_random random = {1};
    bool edges[4] = {false};
    for (int n = 0; n < 1000; n++) {
        tc_rect r = terrain_place(&random, 12, 10, 7);
        assert_true(r.x1 - r.x0 == 7 && r.y1 - r.y0 == 7 && r.x0 >= 0 && r.y0 >= 0 && r.x1 <= 12 && r.y1 <= 10);
        edges[0] |= r.x0 == 0, edges[1] |= r.y0 == 0, edges[2] |= r.x1 == 12, edges[3] |= r.y1 == 10;
    }
    assert_true(edges[0] && edges[1] && edges[2] && edges[3]);
}

/* Everywhere in levels of odd and even sizes: within the coarser level, and all of it that lies under the place. */
static void coarser_places_can_be_read(void **state)
{
    (void)state;
    enum { SIDE = 23, MOST = SIDE / 2 + 17 };
    for (int64_t size = 64; size < 70; size++) {
        tc_field *p = terrain_field(TERRAIN_SMOOTH, size, size + 1, 30, 1);
        int finest = tc_field_info(p)->levels;
        tc_level level = tc_field_level(p, finest), coarser = tc_field_level(p, finest - 1);
        float z[MOST * MOST];
        for (int64_t y = 0; y <= level.height - SIDE; y++)
            for (int64_t x = 0; x <= level.width - SIDE; x++) {
                tc_rect r = {x, y, x + SIDE, y + SIDE}, c = terrain_coarser_place(r, coarser);
                assert_int_equal(tc_field_read(p, finest - 1, c, z, NULL, c.x1 - c.x0), TC_OK);
                assert_true(c.x1 - c.x0 <= MOST && c.y1 - c.y0 <= MOST);
                assert_true(c.x0 <= x / 2 && c.y0 <= y / 2);
                assert_true(c.x1 > tc_min64((r.x1 - 1) / 2, coarser.width - 1));
                assert_true(c.y1 > tc_min64((r.y1 - 1) / 2, coarser.height - 1));
            }
        /* Such a place one sample farther out is refused. */
        tc_rect out = {coarser.width - 4, 0, coarser.width + 1, 4};
        assert_int_not_equal(tc_field_read(p, finest - 1, out, z, NULL, 5), TC_OK);
        tc_field_destroy(p);
    }
}

static int remove_files(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integers_come_back_as_multiples),
        cmocka_unit_test(floats_have_no_unit),
        cmocka_unit_test(places_lie_within),
        cmocka_unit_test(coarser_places_can_be_read),
    };
    return cmocka_run_group_tests(tests, NULL, remove_files);
}
