/* test_old_versions.c - files that programs of format versions 1 and 2 wrote (tests/fast/old) read as they did there:
 * the table has the checksums of what the last program that wrote those versions read from them. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>

#include "common/base/crc32c.h"
#include "common/base/rect.h"
#include "common/map/map.h"

typedef struct old_chart {
    const char *name;
    int version, chart, levels;
    uint32_t sum[10]; /* CRC-32C of a level's heights, then of its voids; [l - 1] */
} old_chart;

static const old_chart old[] = {
    {"v1-lh04.tclip",
     1,
     0,
     9,
     {0x9db2fb72, 0x0ee5774e, 0x4a2c0420, 0x71bd7d16, 0xdd0c959a, 0x8c8becac, 0x490b0d15, 0xd321d682, 0xdcc75af2}},
    {"v1-lossless-voids.tclip",
     1,
     0,
     9,
     {0x3764185f, 0xa3d687f7, 0xcea964e5, 0xccf395e6, 0x9296d2bf, 0xf71e9eec, 0x16e77c62, 0x53dab0a1, 0x43cf40be}},
    {"v1-max-error.tclip",
     1,
     0,
     9,
     {0x9db2fb72, 0x0ee5774e, 0x4a2c0420, 0x71bd7d16, 0xdd0c959a, 0x4f1db111, 0xb2b74dea, 0x12eb0372, 0xeda67493}},
    {"v1-rms.tclip",
     1,
     0,
     9,
     {0x9db2fb72, 0x0ee5774e, 0x4a2c0420, 0x71bd7d16, 0xdd0c959a, 0xe2254b22, 0x2a446c58, 0x0ad02e85, 0x447ba42d}},
    {"v2-planet.tclip", 2, 0, 7, {0x51cc9657, 0x6f3faa96, 0xe6ab05ef, 0x3ce338d5, 0x1b27c4e9, 0xd223382f, 0xc4b9a4fb}},
    {"v2-planet.tclip", 2, 1, 6, {0xfc7cc480, 0xd753b13e, 0xf225cad7, 0x74215537, 0x1a482a9d, 0x3d85a223}},
    {"v2-planet.tclip", 2, 2, 6, {0xfda32b9d, 0xf225093c, 0x56faf063, 0x59ebe419, 0xcec21818, 0x004c193a}},
};
enum { CHARTS = sizeof old / sizeof *old };

static void check_levels(const old_chart *o, const tc_field *field)
{
    assert_int_equal(tc_field_info(field)->levels, o->levels);
    for (int l = 1; l <= o->levels; l++) {
        tc_level level = tc_field_level(field, l);
        tc_rect all = {0, 0, level.width, level.height};
        size_t count = (size_t)tc_rect_area(all);
        float *z = malloc(count * sizeof *z);
        uint8_t *voids = malloc(count);
        assert_true(z && voids);
        assert_int_equal(tc_field_read(field, l, all, z, voids, level.width), TC_OK);
        uint32_t sum = tc_crc32c(tc_crc32c(0, z, count * sizeof *z), voids, count);
        if (sum != o->sum[l - 1])
            fail_msg("%s, chart %d, level %d: 0x%08x", o->name, o->chart, l, sum);
        free(z), free(voids);
    }
}

/* Bounds hold; how far a level is off the coarser one was not told then. */
static void check_ranges(const tc_field *field)
{
    for (int l = 1; l <= tc_field_info(field)->levels; l++) {
        tc_level level = tc_field_level(field, l);
        tc_rect all = {0, 0, level.width, level.height};
        float *z = malloc((size_t)(level.width * level.height) * sizeof *z);
        assert_int_equal(tc_field_read(field, l, all, z, NULL, level.width), TC_OK);
        tc_range range = tc_field_range(field, l, all);
        for (int64_t k = 0; k < level.width * level.height; k++)
            assert_true(z[k] >= range.lo && z[k] <= range.hi);
        assert_true(isinf(range.step));
        free(z);
    }
}

static void old_files_read_as_they_did(void **state)
{
    (void)state;
    for (int k = 0; k < CHARTS; k++) {
        const old_chart *o = &old[k];
        char path[200];
        tc_error error = {TC_OK, ""};
        tc_field *field;
        snprintf(path, sizeof path, "tests/fast/old/%s", o->name);
        if (tc_field_open(path, NULL, &field, &error))
            fail_msg("%s", error.text);
        const tc_packed_info *info = tc_field_packed_info(field);
        assert_true(info->version == o->version && !info->cut_short);
        if (o->chart == 0)
            check_levels(o, field);
        check_ranges(field);
        assert_int_equal(tc_field_tell(field).damaged, 0);
        if (info->terrain.radius > 0) {
            tc_map *atlas;
            if (tc_map_open(path, NULL, &atlas, &error))
                fail_msg("%s", error.text);
            assert_int_equal(atlas->charts, 3);
            check_levels(o, atlas->chart[o->chart].field);
            tc_map_destroy(atlas);
        }
        tc_field_destroy(field);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(old_files_read_as_they_did),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
