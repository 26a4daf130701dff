/* test_raw_tiles.c - white noise, which nothing can compress, takes the bits of its lattice and no more; what is kept
 * so comes back, part by part, and damage of it is seen. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/packed/file/packed_file.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

typedef struct noise {
    const char *name;
    int64_t width, height, values; /* 0 to values - 1, plus lift */
    double lift, error;            /* error: 0 lossless */
    tc_sample_type type;
    int bits; /* of one of as many values as steps of the lattice reach from the lowest to the highest one */
} noise;

static float *heights_of(const noise *n, double voids, uint8_t **voids_ret)
{
    int64_t count = n->width * n->height;
    float *z = malloc((size_t)count * sizeof *z);
    uint8_t *v = malloc((size_t)count);
    assert_true(z && v);
    test_random r = {3};
    for (int64_t i = 0; i < count; i++) {
        z[i] = (float)(n->lift + (double)test_random_int(&r, 0, n->values - 1));
        v[i] = test_random_range(&r, 0, 1) < voids;
    }
    *voids_ret = v;
    return z;
}

static tc_pack_result pack(const noise *n, const float *z, const uint8_t *voids, const char *path)
{
    tc_pack_terrain t = {.width = n->width, .height = n->height, .spacing_x = 1, .spacing_y = 1, .unit = 1};
    t.sample_type = n->type;
    tc_pack_options o = {.mode = n->error > 0 ? TC_PACK_MAX_ERROR : TC_PACK_LOSSLESS, .error = n->error};
    tc_packer *packer = NULL;
    tc_pack_result result = {0};
    tc_error error;
    if (tc_packer_create(path, &t, &o, &packer, &error) ||
        tc_packer_put(packer, (tc_rect){0, 0, n->width, n->height}, z, voids, n->width, &error) ||
        tc_packer_finish(packer, &result, &error))
        fail_msg("%s: %s", n->name, error.text);
    tc_packer_destroy(packer);
    return result;
}

/* A rectangle of the finest level is as it was given, off by no more than the error. */
static void check_rect(const noise *n, const tc_field *field, tc_rect r, const float *truth, const uint8_t *voids)
{
    int64_t w = r.x1 - r.x0;
    float *z = malloc((size_t)tc_rect_area(r) * sizeof *z);
    uint8_t *v = malloc((size_t)tc_rect_area(r));
    assert_true(z && v);
    assert_int_equal(tc_field_read(field, tc_field_info(field)->levels, r, z, v, w), TC_OK);
    for (int64_t y = r.y0; y < r.y1; y++)
        for (int64_t x = r.x0; x < r.x1; x++) {
            int64_t at = (y - r.y0) * w + x - r.x0, of = y * n->width + x;
            if (v[at] != voids[of] || (!voids[of] && !(fabs((double)z[at] - truth[of]) <= n->error)))
                fail_msg("%s: (%d, %d): %g instead of %g", n->name, (int)x, (int)y, z[at], truth[of]);
        }
    free(z), free(v);
}

/* Heads, base levels and indices are small, but so are the grids. */
enum { BESIDE = 2300 };

static void noise_takes_its_bits(void **state)
{
    (void)state;
    static const noise cases[] = {
        {"16 bits", 256, 200, 1 << 16, 0, 0, TC_SAMPLE_UINT16, 16},
        {"16 bits, odd", 131, 257, 1 << 16, 0, 0, TC_SAMPLE_UINT16, 16},
        {"8 bits", 256, 128, 1 << 8, 0, 0, TC_SAMPLE_UINT8, 8},
        {"12 bits, below 0", 256, 128, 1 << 12, -3000, 0, TC_SAMPLE_INT16, 12},
        {"one bit", 256, 128, 2, 0, 0, TC_SAMPLE_UINT8, 1},
        {"12 bits, high up", 256, 128, 1 << 12, 8e6, 0, TC_SAMPLE_INT32, 12},
        {"as many bits as heights have", 256, 128, (1 << 23) * 100 / 101 - 1, -4000000, 0, TC_SAMPLE_INT32, 23},
        {"floats", 256, 128, 1 << 16, -32768, 0, TC_SAMPLE_FLOAT32, 16},
        {"12 bits in steps of 3", 256, 128, 3 * (1 << 12) - 2, 0, 1, TC_SAMPLE_UINT16, 12},
        {"8 bits in steps of 201", 256, 128, 201 * (1 << 8) - 200, 0, 100, TC_SAMPLE_UINT16, 8},
        {"one tile of few samples", 17, 3, 1 << 16, 0, 0, TC_SAMPLE_UINT16, 16},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int lakes = 0; lakes < (k % 4 ? 1 : 2); lakes++) {
            const noise *n = &cases[k];
            const char *path = made_path("noise.tclip");
            uint8_t *voids;
            float *z = heights_of(n, lakes ? 0.02 : 0, &voids);
            tc_pack_result result = pack(n, z, voids, path);
            assert_true(result.max_error <= n->error);
            double raw = (double)(n->width * n->height) * n->bits / 8;
            if (!lakes && !(result.bytes <= raw * 1.0002 + BESIDE))
                fail_msg("%s: %d bytes instead of %d", n->name, (int)result.bytes, (int)raw);
            tc_field *field;
            assert_int_equal(tc_field_open(path, NULL, &field, NULL), TC_OK);
            int64_t w = n->width, h = n->height;
            check_rect(n, field, (tc_rect){w / 3, h / 2, w / 3 + 1, h / 2 + 1}, z, voids);
            check_rect(n, field, (tc_rect){w - w / 3, 0, w, h}, z, voids);
            check_rect(n, field, (tc_rect){0, 0, w, h}, z, voids);
            assert_int_equal(tc_field_tell(field).damaged, 0);
            tc_field_destroy(field);
            free(z), free(voids);
        }
}

/* A tile of noise among smooth ones is kept raw, and no other. */
static void raw_tiles_stand_beside_others(void **state)
{
    (void)state;
    noise n = {"one tile of noise", 512, 256, 1 << 16, 0, 0, TC_SAMPLE_UINT16, 16};
    uint8_t *voids;
    float *z = heights_of(&n, 0, &voids);
    for (int64_t y = 0; y < n.height; y++)
        for (int64_t x = 0; x < n.width; x++)
            if (x / 128 != 2 || y / 128 != 1)
                z[y * n.width + x] = (float)(x + y);
    const char *path = made_path("beside.tclip");
    pack(&n, z, voids, path);
    tc_packed_file file;
    tc_tile_entry entry[2];
    assert_int_equal(tc_packed_file_open(path, &file, NULL), TC_OK);
    for (int k = 0; k < 2; k++)
        assert_int_equal(tc_packed_file_entry(&file, file.container.levels, 2 * k, k, &entry[k]), TC_OK);
    tc_packed_file_close(&file);
    assert_in_range(entry[0].size[0], 1, 400);
    assert_in_range(entry[1].size[0], 128 * 128 * 2, 128 * 128 * 2 + 5);
    tc_field *field;
    assert_int_equal(tc_field_open(path, NULL, &field, NULL), TC_OK);
    check_rect(&n, field, (tc_rect){0, 0, n.width, n.height}, z, voids);
    tc_field_destroy(field);
    free(z), free(voids);
}

static void damage_is_seen(void **state)
{
    (void)state;
    noise n = {"damaged", 300, 200, 1 << 16, 0, 0, TC_SAMPLE_UINT16, 16};
    uint8_t *voids;
    float *z = heights_of(&n, 0, &voids);
    const char *path = made_path("damaged.tclip");
    pack(&n, z, voids, path);
    tc_packed_file file;
    tc_tile_entry entry;
    assert_int_equal(tc_packed_file_open(path, &file, NULL), TC_OK);
    assert_int_equal(tc_packed_file_entry(&file, file.container.levels, 1, 0, &entry), TC_OK);
    tc_packed_file_close(&file);
    assert_in_range(entry.size[0], 128 * 128 * 2, 128 * 128 * 2 + 5);
    static const uint32_t places[] = {0, 1, 5, 7000, 128 * 128 * 2};
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        FILE *f = fopen(path, "r+b");
        assert_non_null(f);
        for (int restore = 0; restore < 2; restore++) {
            assert_int_equal(fseek(f, (long)(entry.offset + places[k]), SEEK_SET), 0);
            int byte = fgetc(f);
            assert_int_equal(fseek(f, (long)(entry.offset + places[k]), SEEK_SET), 0);
            assert_true(fputc(byte ^ 0x10, f) != EOF && fflush(f) == 0);
            if (restore)
                continue;
            tc_field *field;
            assert_int_equal(tc_field_open(path, NULL, &field, NULL), TC_OK);
            check_rect(&n, field, (tc_rect){0, 0, 128, 128}, z, voids);
            check_rect(&n, field, (tc_rect){256, 0, 300, 128}, z, voids);
            check_rect(&n, field, (tc_rect){0, 128, 300, 200}, z, voids);
            assert_int_equal(tc_field_tell(field).damaged, 0);
            float part[4];
            uint8_t none[4];
            int finest = tc_field_info(field)->levels;
            assert_int_equal(tc_field_read(field, finest, (tc_rect){130, 9, 132, 11}, part, none, 2), TC_OK);
            assert_int_equal(tc_field_tell(field).damaged, 1);
            for (int i = 0; i < 4; i++)
                assert_true(isfinite(part[i]));
            tc_field_destroy(field);
        }
        fclose(f);
    }
    free(z), free(voids);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_takes_its_bits),
        cmocka_unit_test(raw_tiles_stand_beside_others),
        cmocka_unit_test(damage_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
