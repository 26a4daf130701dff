/* test_refused.c - windows and packed terrains where memory is refused at each point in turn: a clear error, nothing
 * leaked, nothing held that was not filled, and all as ever once there is memory again.
 *
 * The Makefile links this test with --wrap for the functions that allocate. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/content/ground.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/refused.h"
#include "tests/support/regions.h"
#include "tests/support/stripes.h"
#include "tests/wrapped/allocations.h"

/* ---- Windows ----------------------------------------------------------------------------------------------------- */

enum { N = 31, SIZE = 700 };

static const tc_ground_options all_contents = {.n = N, .normals = true, .holes = true};

static void creating(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, 10, 3);
    for (int call = 1;; call++) {
        tc_clipmap *c = NULL;
        tc_error error = {TC_OK, ""};
        long long before = allocations.live;
        allocations_refuse(call);
        tc_status status = tc_ground_create(field, &all_contents, &c, &error);
        if (!allocations_refused()) {
            assert_int_equal(status, TC_OK);
            tc_clipmap_destroy(c);
            assert_true(allocations.live == before);
            assert_true(call > 3 * 5); /* three contents of several levels */
            printf("creating windows: %d allocations, each refused once\n", call - 1);
            break;
        }
        assert_int_equal(status, TC_ERR_MEMORY);
        assert_non_null(strstr(error.text, "memory"));
        assert_null(c);
        assert_true(allocations.live == before);
    }
    tc_field_destroy(field);
}

/* One update that reads a packed terrain for the first time; then as often as it takes. */
static void updating(tc_pack_codec codec)
{
    const packing hills = {
        .width = SIZE, .height = SIZE, .voids = PACKING_LAKES, .mode = TC_PACK_RMS, .error = 1, .codec = codec};
    const char *path = made_path("refused.tclip");
    tc_pack_result result;
    assert_int_equal(packing_write(&hills, path, &result, NULL), TC_OK);
    int refusals = 0, unfilled = 0;
    long long usual = 0; /* difference of a run without refusals: what the C library itself has allocated and we free */
    for (int call = 0;; call++) {
        long long before = allocations.live;
        tc_field *field;
        tc_clipmap *c = NULL;
        tc_rect wanted[TC_MAX_LEVELS];
        assert_int_equal(tc_field_open(path, NULL, &field, NULL), TC_OK);
        assert_int_equal(tc_ground_create(field, &all_contents, &c, NULL), TC_OK);
        stripes_want(c, 300, 200, wanted);
        allocations_refuse(call);
        tc_clipmap_update(c, wanted, -1, true, 0);
        bool came = allocations_refused();
        assert_null(regions_broken(c));
        if (!tc_clipmap_resident(c)) {
            assert_true(came);
            assert_int_equal(tc_clipmap_failed(c), TC_ERR_MEMORY);
            unfilled++;
        }
        assert_null(heights_broken(c));
        tc_clipmap_update(c, wanted, -1, true, 0);
        assert_true(tc_clipmap_resident(c) && tc_clipmap_failed(c) == TC_OK);
        for (int level = 1; level <= tc_clipmap_levels(c); level++)
            assert_null(content_broken(c, level, 0, 10));
        tc_clipmap_destroy(c);
        tc_field_destroy(field);
        usual = call == 0 ? allocations.live - before : usual;
        assert_true(allocations.live - before == usual);
        if (!came)
            break;
        refusals += call > 0;
    }
    printf("updating windows: %d allocations, each refused once, %d times nothing could be filled\n", refusals,
           unfilled);
    assert_true(refusals > 5);
}

static void updating_from_a_file(void **state)
{
    (void)state;
    updating(TC_CODEC_LIFTING);
}

static void updating_from_a_file_of_residuals(void **state)
{
    (void)state;
    updating(TC_CODEC_LH04);
}

/* ---- Packed terrains --------------------------------------------------------------------------------------------- */

enum { SIDE = 500 };

static const char *pack_one(bool wraps)
{
    const packing p = {.width = SIDE, .height = SIDE / 2, .voids = PACKING_LAKES, .error = 1, .wraps = wraps};
    tc_pack_result result;
    assert_int_equal(packing_write(&p, made_path("refused.tclip"), &result, NULL), TC_OK);
    return made_path("refused.tclip");
}

/* Allocations of opening, each refused once. */
static int refuse_opening(const char *path)
{
    for (int call = 1;; call++) {
        tc_map *map = NULL;
        tc_error error = {TC_OK, ""};
        long long before = allocations.live;
        allocations_refuse(call);
        tc_status status = tc_map_open(path, NULL, &map, &error);
        bool came = allocations_refused();
        if (status == TC_OK)
            tc_map_destroy(map);
        else
            assert_refused(status, TC_ERR_MEMORY, &error, "memory");
        assert_true(allocations.live == before);
        if (!came) {
            assert_int_equal(status, TC_OK);
            return call - 1;
        }
        assert_int_equal(status, TC_ERR_MEMORY);
    }
}

static void opening(void **state)
{
    (void)state;
    int flat = refuse_opening(pack_one(false)), planet = refuse_opening("tests/fast/old/v2-planet.tclip");
    printf("opening packed maps: %d and %d allocations, each refused once\n", flat, planet);
    assert_true(flat > 10 && planet > 2 * flat);
}

/* Reading and bounds: what is refused is not half held, and the next reading has the same bits. */
static void reading(void **state)
{
    (void)state;
    static float truth[SIDE * SIDE], z[SIDE * SIDE];
    static uint8_t voids[SIDE * SIDE];
    const char *path = pack_one(true);
    tc_rect all = {0, 0, SIDE, SIDE / 2};
    long long usual = 0;
    int refusals = 0;
    for (int call = 0;; call++) {
        long long before = allocations.live;
        tc_field *f;
        assert_int_equal(tc_field_open(path, NULL, &f, NULL), TC_OK);
        int l = tc_field_info(f)->levels;
        allocations_refuse(call);
        tc_status status = tc_field_read(f, l, all, call ? z : truth, voids, SIDE);
        bool came = allocations_refused();
        assert_true(status == TC_OK || (came && status == TC_ERR_MEMORY));
        assert_int_equal(tc_field_read(f, l, all, z, voids, SIDE), TC_OK);
        assert_memory_equal(z, truth, sizeof *z * SIDE * (SIDE / 2));
        tc_range range = tc_field_range(f, l, all);
        for (int k = 0; k < SIDE * (SIDE / 2); k++)
            assert_true(z[k] >= range.lo && z[k] <= range.hi);
        tc_field_stats told = tc_field_tell(f);
        assert_true(told.unreadable == 0 && told.damaged == 0);
        tc_field_destroy(f);
        usual = call == 0 ? allocations.live - before : usual;
        assert_true(allocations.live - before == usual);
        if (call > 0 && !came)
            break;
        refusals += call > 0;
    }
    printf("reading a packed terrain: %d allocations, each refused once\n", refusals);
    assert_true(refusals > 10);
}

/* The thread that reads ahead tries again, and what it was asked for comes. */
static void reading_ahead(void **state)
{
    (void)state;
    const char *path = pack_one(false);
    tc_rect part = {100, 20, 400, 240};
    long long usual = 0;
    int refusals = 0;
    for (int call = 0;; call++) {
        long long before = allocations.live;
        tc_field *f;
        assert_int_equal(tc_field_open(path, NULL, &f, NULL), TC_OK);
        int l = tc_field_info(f)->levels, polls = 0;
        allocations_refuse(call);
        while (tc_field_ready(f, l, part, TC_SOON) != TC_READY && polls++ < 5000)
            usleep(1000);
        assert_true(polls < 5000);
        bool came = allocations_refused();
        tc_field_stats told = tc_field_tell(f);
        assert_true(told.unreadable == 0 && told.damaged == 0 && told.waits == 0);
        tc_field_destroy(f);
        usual = call == 0 ? allocations.live - before : usual;
        assert_true(allocations.live - before == usual);
        if (call > 0 && !came)
            break;
        refusals += call > 0;
    }
    printf("reading ahead: %d allocations, each refused once\n", refusals);
    assert_true(refusals > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(creating),
        cmocka_unit_test(updating_from_a_file),
        cmocka_unit_test(updating_from_a_file_of_residuals),
        cmocka_unit_test(opening),
        cmocka_unit_test(reading),
        cmocka_unit_test(reading_ahead),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    made_folder_remove();
    return failed;
}
