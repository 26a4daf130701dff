/* test_windows.c - windows of a field that cannot always be read, and a content that is only known here. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/content/ground.h"
#include "tests/support/moody.h"
#include "tests/support/stripes.h"
#include "tests/support/test.h"

enum { N = 31, SIZE = 257 };

static void assert_same(const tc_clipmap *a, const tc_clipmap *b)
{
    for (int l = 1; l <= tc_clipmap_levels(a); l++) {
        tc_rect r = tc_clipmap_level(a, l)->clip;
        assert_true(tc_rect_equal(r, tc_clipmap_level(b, l)->clip));
        for (int64_t j = r.y0; j < r.y1; j++)
            for (int64_t i = r.x0; i < r.x1; i++) {
                int64_t at = (j & N) * (N + 1) + (i & N);
                assert_memory_equal(tc_ground_heights(a, l)[at], tc_ground_heights(b, l)[at], 8);
                int64_t texel = (2 * j & (2 * N + 1)) * 2 * (N + 1) + (2 * i & (2 * N + 1));
                assert_memory_equal(tc_ground_normals(a, l)[texel], tc_ground_normals(b, l)[texel], 4);
            }
    }
}

/* Nothing is held that was not filled, whether heights fail or only normals, which read the next finer level; what
 * failed is tried again, ever more seldom, and comes once it can be read. */
static void failing(bool only_normals, bool says_so)
{
    tc_field *good = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, 10, 3);
    moody_field *broken = moody_create(good, 1);
    broken->on = true, broken->says_so = says_so;
    tc_clipmap *c, *clean;
    tc_rect wanted[TC_MAX_LEVELS];
    const tc_ground_options options = {.n = N, .normals = true};
    assert_int_equal(tc_ground_create(&broken->head, &options, &c, NULL), TC_OK);
    assert_int_equal(tc_ground_create(good, &options, &clean, NULL), TC_OK);
    int m = tc_clipmap_levels(c), top = tc_field_info(good)->levels;
    assert_true(m >= 4);
    stripes_want(c, 100, 100, wanted);
    tc_clipmap_update(c, wanted, -1, false, 0);
    assert_true(tc_clipmap_resident(c) && tc_clipmap_failed(c) == TC_OK);

    /* Heights of the last but one level can be read in the second case, but not what its normals come from. */
    broken->failing_level = only_normals ? top : top - 1;
    stripes_want(c, 140, 120, wanted);
    double now = 1;
    for (int frame = 0; frame < 1000; frame++, now += 0.02) {
        tc_clipmap_update(c, wanted, -1, false, now);
        const tc_clip_level *l = tc_clipmap_level(c, m - 1);
        assert_true(tc_rect_within(l->clip, l->wanted) && !tc_rect_equal(l->clip, l->wanted));
    }
    assert_true(!tc_clipmap_resident(c) && tc_clipmap_failed(c) == TC_ERR_IO);
    /* 20 seconds: after 0.25, 0.5, 1, ... on two levels at most, up to four sides a try. */
    assert_in_range(broken->tries, 6, 2 * 4 * 8);

    broken->failing_level = 0;
    for (int frame = 0; frame < 40 && !tc_clipmap_resident(c); frame++, now += 1)
        tc_clipmap_update(c, wanted, -1, false, now);
    assert_true(tc_clipmap_resident(c) && tc_clipmap_failed(c) == TC_OK);
    tc_clipmap_update(clean, wanted, -1, true, 0);
    assert_same(c, clean);

    /* Who waits tries at once and each time. */
    broken->failing_level = top, broken->tries = 0;
    stripes_want(c, 20, 30, wanted);
    for (int frame = 0; frame < 5; frame++)
        tc_clipmap_update(c, wanted, -1, true, now);
    assert_true(broken->tries >= 5 && tc_clipmap_failed(c) == TC_ERR_IO);
    tc_clipmap_destroy(c);
    tc_clipmap_destroy(clean);
    moody_destroy(broken);
    tc_field_destroy(good);
}

static void heights_that_fail_are_not_held(void **state)
{
    (void)state;
    failing(false, false);
    failing(false, true);
}

static void normals_that_fail_are_not_held(void **state)
{
    (void)state;
    failing(true, false);
    failing(true, true);
}

/* ---- A content of one byte a texel, two texels a sample ---------------------------------------------------------- */

/* A reader's own copy of an array, brought up to date by what has changed. */
typedef struct reader {
    uint64_t cursor[TC_MAX_LEVELS];
    uint8_t texels[TC_MAX_LEVELS][4 * (N + 1) * (N + 1)];
    int64_t rectangles;
} reader;

static void read_changes(reader *r, const tc_clipmap *c)
{
    enum { SIDE = 2 * (N + 1) };
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        tc_rect changes[TC_MAX_CHANGES];
        int count = tc_clipmap_changes(c, l, &r->cursor[l - 1], changes);
        const uint8_t *from = tc_clipmap_texels(c, &stripes, l);
        for (int k = 0; k < count; k++) {
            tc_rect t = tc_content_rect(&stripes, changes[k]);
            for (int64_t y = t.y0; y < t.y1; y++)
                for (int64_t x = t.x0; x < t.x1; x++) {
                    int64_t at = (y & (SIDE - 1)) * SIDE + (x & (SIDE - 1));
                    r->texels[l - 1][at] = from[at];
                }
        }
        r->rectangles += count;
    }
}

static void a_content_of_our_own(void **state)
{
    (void)state;
    enum { SIDE = 2 * (N + 1) };
    tc_field *field = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, 10, 3);
    tc_clipmap_options options = {.n = N, .contents = 1, .content = {{.class = &stripes, .parameter = 5}}};
    tc_clipmap *c;
    assert_int_equal(tc_clipmap_create(field, &options, &c, NULL), TC_OK);
    assert_null(tc_ground_heights(c, 1)); /* a clipmap need not know heights */
    reader *often = calloc(1, sizeof *often), *seldom = calloc(1, sizeof *seldom);
    tc_rect wanted[TC_MAX_LEVELS];
    test_random random = {7};
    for (int move = 0; move < 3000; move++) {
        stripes_want(c, test_random_int(&random, 0, SIZE - 1), test_random_int(&random, 0, SIZE - 1), wanted);
        tc_clipmap_update(c, wanted, test_random_int(&random, N, N * N), false, 0);
        read_changes(often, c);
        if (move % 40 == 0 || move == 2999) /* sometimes so late that it has missed some */
            read_changes(seldom, c);
        const reader *up_to_date[] = {often, move % 40 == 0 || move == 2999 ? seldom : often};
        for (int l = 1; l <= tc_clipmap_levels(c); l++) {
            tc_rect r = tc_clipmap_level(c, l)->clip;
            for (int k = 0; k < 40 && !tc_rect_empty(r); k++) {
                int64_t x = 2 * r.x0 + test_random_int(&random, 0, 2 * (r.x1 - r.x0) - 2);
                int64_t y = 2 * r.y0 + test_random_int(&random, 0, 2 * (r.y1 - r.y0) - 2);
                for (int who = 0; who < 2; who++)
                    assert_int_equal(up_to_date[who]->texels[l - 1][(y & (SIDE - 1)) * SIDE + (x & (SIDE - 1))],
                                     stripe(&options.content[0], l, x, y));
            }
        }
    }
    assert_true(seldom->rectangles < often->rectangles);
    free(often), free(seldom);
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
}

/* ---- Another n --------------------------------------------------------------------------------------------------- */

/* A terrain's windows are given up and made anew in another size while the field stays: no trace of the size before. */
static void windows_of_another_size(void **state)
{
    (void)state;
    tc_field *field = terrain_field(TERRAIN_SMOOTH, SIZE, SIZE, 10, 3);
    const tc_ground_options small = {.n = N, .normals = true}, large = {.n = 4 * N + 3, .normals = true};
    tc_clipmap *c, *clean;
    tc_rect wanted[TC_MAX_LEVELS];
    assert_int_equal(tc_ground_create(field, &small, &clean, NULL), TC_OK);
    stripes_want(clean, 120, 130, wanted);
    tc_clipmap_update(clean, wanted, -1, true, 0);
    size_t bytes = tc_field_tell(field).bytes;
    for (int k = 0; k < 5; k++) {
        assert_int_equal(tc_ground_create(field, k % 2 ? &large : &small, &c, NULL), TC_OK);
        stripes_want(c, 120, 130, wanted);
        do
            tc_clipmap_update(c, wanted, 1000, false, 0);
        while (!tc_clipmap_resident(c));
        if (k < 4)
            tc_clipmap_destroy(c);
    }
    assert_same(c, clean);
    assert_true(tc_field_tell(field).bytes == bytes);
    tc_clipmap_destroy(c);
    tc_clipmap_destroy(clean);
    tc_field_destroy(field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_that_fail_are_not_held),
        cmocka_unit_test(normals_that_fail_are_not_held),
        cmocka_unit_test(a_content_of_our_own),
        cmocka_unit_test(windows_of_another_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
