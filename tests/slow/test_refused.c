/* test_refused.c - windows where memory is refused at each point in turn: a clear error, nothing leaked, nothing held
 * that was not filled, and all as ever once there is memory again.
 *
 * The Makefile links this test with --wrap for the functions that allocate. */
#include "tests/support/test.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/content/ground.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/regions.h"
#include "tests/support/stripes.h"

/* ---- Refusing ---------------------------------------------------------------------------------------------------- */

static long long live_bytes;
static int calls, refused; /* the call that is refused, from 1 on; 0: none */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *p, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *p);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *p);

static bool refuses(void)
{
    return ++calls == refused;
}

static void *given(void *p)
{
    live_bytes += p ? (long long)malloc_usable_size(p) : 0;
    return p;
}

void *__wrap_malloc(size_t size)
{
    return refuses() ? NULL : given(__real_malloc(size));
}
void *__wrap_calloc(size_t count, size_t size)
{
    return refuses() ? NULL : given(__real_calloc(count, size));
}
void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return refuses() ? NULL : given(__real_aligned_alloc(alignment, size));
}
void *__wrap_realloc(void *p, size_t size)
{
    if (refuses())
        return NULL;
    live_bytes -= p ? (long long)malloc_usable_size(p) : 0;
    return given(__real_realloc(p, size));
}
void __wrap_free(void *p)
{
    live_bytes -= p ? (long long)malloc_usable_size(p) : 0;
    __real_free(p);
}

static void refuse(int call)
{
    calls = 0, refused = call;
}

/* Whether the call to be refused came. */
static bool was_refused(void)
{
    bool came = calls >= refused; /* or none was to be */
    refused = 0;
    return came;
}

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
        long long before = live_bytes;
        refuse(call);
        tc_status status = tc_ground_create(field, &all_contents, &c, &error);
        if (!was_refused()) {
            assert_int_equal(status, TC_OK);
            tc_clipmap_destroy(c);
            assert_true(live_bytes == before);
            assert_true(call > 3 * 5); /* three contents of several levels */
            printf("creating windows: %d allocations, each refused once\n", call - 1);
            break;
        }
        assert_int_equal(status, TC_ERR_MEMORY);
        assert_non_null(strstr(error.text, "memory"));
        assert_null(c);
        assert_true(live_bytes == before);
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
        long long before = live_bytes;
        tc_field *field;
        tc_clipmap *c = NULL;
        tc_rect wanted[TC_MAX_LEVELS];
        assert_int_equal(tc_field_open(path, NULL, &field, NULL), TC_OK);
        assert_int_equal(tc_ground_create(field, &all_contents, &c, NULL), TC_OK);
        stripes_want(c, 300, 200, wanted);
        refuse(call);
        tc_clipmap_update(c, wanted, -1, true, 0);
        bool came = was_refused();
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
        usual = call == 0 ? live_bytes - before : usual;
        assert_true(live_bytes - before == usual);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(creating),
        cmocka_unit_test(updating_from_a_file),
        cmocka_unit_test(updating_from_a_file_of_residuals),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    made_folder_remove();
    return failed;
}
