/* test_largest_step.c - the largest step that a packed file tells of each tile: what its samples are off the mesh of
 * the coarser level, found here by looking at all of them. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

typedef struct plane {
    const float *z;
    int64_t width, height;
    bool wraps;
} plane;

/* A sample of the coarser level; beyond its last ones heights go on in a straight line or from the other side. */
static double sample(const plane *p, int64_t x, int64_t y)
{
    if (x == p->width && p->wraps)
        return sample(p, 0, y);
    if (x == p->width)
        return x > 1 ? 2 * sample(p, x - 1, y) - sample(p, x - 2, y) : sample(p, x - 1, y);
    if (y == p->height)
        return y > 1 ? 2 * sample(p, x, y - 1) - sample(p, x, y - 2) : sample(p, x, y - 1);
    return p->z[y * p->width + x];
}

static double mesh_at(const plane *p, int64_t x, int64_t y)
{
    int64_t i = x / 2, j = y / 2;
    double tx = 0.5 * (double)(x % 2), ty = 0.5 * (double)(y % 2), z00 = sample(p, i, j);
    double z10 = tx > 0 ? sample(p, i + 1, j) : z00, z01 = ty > 0 ? sample(p, i, j + 1) : z00;
    return tc_triangle_height(z00, z10, z01, 0, tx, ty); /* the far corner is never asked for: tx + ty <= 1 */
}

static void check_level(tc_packed_file *file, const tc_field *field, int l, const char *name)
{
    tc_level level = tc_field_level(field, l), coarser = tc_field_level(field, l - 1);
    uint8_t *v, *u;
    float *z = packing_read(field, l, &v), *below = packing_read(field, l - 1, &u);
    plane mesh = {below, coarser.width, coarser.height, tc_field_wraps(field, l)};
    const tc_container *c = &file->container;
    tc_pages pages = tc_level_pages(&level);
    double largest = fabs(c->z_origin) + fmax(fabs(c->z_min), fabs(c->z_max)), rounding = 4 * ldexp(largest, -23);
    for (int64_t ty = 0; ty < pages.tiles_y; ty++)
        for (int64_t tx = 0; tx < pages.tiles_x; tx++) {
            double most = 0;
            for (int64_t y = 128 * ty; y < tc_min64(128 * ty + 128, level.height); y++)
                for (int64_t x = 128 * tx; x < tc_min64(128 * tx + 128, level.width); x++)
                    most = fmax(most, fabs(z[y * level.width + x] - mesh_at(&mesh, x, y)));
            tc_tile_entry entry;
            assert_int_equal(tc_packed_file_entry(file, l, tx, ty, &entry), TC_OK);
            assert_true(entry.step != TC_STEP_UNKNOWN);
            double told = entry.step * c->z_unit;
            if (!(told >= most - rounding && told <= 1.3 * most + 2 * c->z_unit + rounding))
                fail_msg("%s, level %d, tile (%d, %d): %g m instead of %g m", name, l, (int)tx, (int)ty, told, most);
            tc_rect tile = {128 * tx, 128 * ty, tc_min64(128 * tx + 128, level.width),
                            tc_min64(128 * ty + 128, level.height)};
            double step = tc_field_range(field, l, tile).step;
            assert_true(step >= most && step >= told && step <= told * (1 + 1e-6) + rounding);
        }
    free(z), free(v), free(below), free(u);
}

static void steps_are_those_of_the_heights(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        packing p;
    } cases[] = {
        {"even", {.width = 300, .height = 270, .kind = PACKING_HILLS, .error = 2}},
        {"odd", {.width = 257, .height = 131, .kind = PACKING_HILLS, .error = 0.5}},
        {"narrow", {.width = 1, .height = 200, .kind = PACKING_HILLS, .error = 0.5}},
        {"flat", {.width = 140, .height = 135, .kind = PACKING_CONSTANT, .error = 1}},
        {"slope", {.width = 300, .height = 140, .kind = PACKING_SLOPE, .error = 1}},
        {"walls", {.width = 160, .height = 150, .kind = PACKING_WALLS, .error = 100}},
        {"noise", {.width = 129, .height = 128, .kind = PACKING_NOISE, .error = 1}},
        {"dust", {.width = 129, .height = 128, .kind = PACKING_DUST, .error = 1e-5, .based = true}},
        {"needle", {.width = 200, .height = 333, .kind = PACKING_NEEDLE, .error = 1}},
        {"voids", {.width = 290, .height = 170, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 2}},
        {"bound", {.width = 200, .height = 141, .kind = PACKING_INTEGERS, .mode = TC_PACK_MAX_ERROR, .error = 12}},
        {"lossless", {.width = 150, .height = 135, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS}},
        {"LH04", {.width = 270, .height = 150, .kind = PACKING_HILLS, .error = 2, .codec = TC_CODEC_LH04}},
        {"round", {.width = 288, .height = 150, .voids = PACKING_LAKES, .error = 2, .wraps = true}},
        {"round, odd", {.width = 161, .height = 80, .error = 2, .wraps = true}},
        {"round, lossless", {.width = 160, .height = 135, .mode = TC_PACK_LOSSLESS, .kind = 1, .wraps = true}},
        {"round, LH04", {.width = 272, .height = 150, .error = 2, .codec = TC_CODEC_LH04, .wraps = true}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        packing p = cases[k].p;
        const char *path = made_path("steps.tclip");
        p.type = p.kind == PACKING_INTEGERS ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32;
        tc_pack_result result;
        tc_error error;
        tc_packed_file file;
        tc_field *field;
        if (packing_write(&p, path, &result, &error) || tc_packed_file_open(path, &file, &error) ||
            tc_field_open(path, NULL, &field, &error))
            fail_msg("%s: %s", cases[k].name, error.text);
        for (int l = file.container.base + 1; l <= file.container.levels; l++)
            check_level(&file, field, l, cases[k].name);
        tc_field_destroy(field);
        tc_packed_file_close(&file);
    }
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

/* Rows from pole to pole; rougher towards the poles, where the caps are. */
static void pack_planet(const char *path, const tc_pack_options *how)
{
    enum { WIDTH = 576, HEIGHT = 289 };
    double step = 180.0 / (HEIGHT - 1), radius = 1737400, metres = radius * M_PI / 180 * step;
    tc_pack_terrain t = {.width = WIDTH, .height = HEIGHT, .wraps_x = true, .radius = radius, .unit = 1};
    t.spacing_x = t.spacing_y = metres, t.sample_type = TC_SAMPLE_INT16;
    t.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    memcpy(t.georef.transform, (double[]){-0.5 * step, step, 0, 90 + 0.5 * step, 0, -step}, sizeof t.georef.transform);
    float *z = malloc(sizeof *z * WIDTH * HEIGHT);
    assert_non_null(z);
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            double phi = (step * j - 90) * M_PI / 180, lambda = step * i * M_PI / 180, s = sin(phi);
            double x = cos(phi) * cos(lambda), y = cos(phi) * sin(lambda);
            z[j * WIDTH + i] = (float)rint(900 * sin(5 * x + 3 * s) + 2500 * s * s * sin(30 * y) * cos(40 * x + s));
        }
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error error;
    if (tc_packer_create(path, &t, how, &packer, &error) ||
        tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, z, NULL, WIDTH, &error) ||
        tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    free(z);
}

static void those_of_caps_are_their_own(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        tc_pack_options how;
    } cases[] = {
        {"rms", {.error = 5}},
        {"lossless", {.mode = TC_PACK_LOSSLESS}}, /* of caps a bound */
        {"LH04", {.error = 20, .codec = TC_CODEC_LH04}},
    };
    const char *path = made_path("planet.tclip");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        pack_planet(path, &cases[k].how);
        tc_map *map;
        assert_int_equal(tc_map_open(path, NULL, &map, NULL), TC_OK);
        assert_int_equal(tc_map_charts(map), 3);
        for (int n = 0; n < 3; n++) {
            const tc_field *field = tc_map_field(map, n);
            tc_byte_source source;
            tc_packed_file file;
            char name[40];
            snprintf(name, sizeof name, "%s, chart %d", cases[k].name, n);
            assert_int_equal(tc_file_source(path, &source, NULL), TC_OK);
            assert_int_equal(tc_packed_file_open_bytes(path, &source, n, &file, NULL), TC_OK);
            assert_true(file.container.level[file.container.levels - 1].width > 128); /* more than a tile */
            for (int l = file.container.base + 1; l <= file.container.levels; l++)
                check_level(&file, field, l, name);
            tc_packed_file_close(&file);
        }
        tc_map_destroy(map);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_are_those_of_the_heights),
        cmocka_unit_test(those_of_caps_are_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
