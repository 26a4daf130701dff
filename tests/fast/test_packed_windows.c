/* test_packed_windows.c - windows of packed terrains whose files take their time or cannot all be read: who draws never
 * waits, a part that cannot be read is told and holds up no other, and what comes in the end is what waiting gives. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/content/ground.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/slow_source.h"
#include "tests/support/terrains.h"
#include "tests/support/test.h"

static slow_source packed(const packing *p)
{
    slow_source s = {0};
    tc_pack_result result;
    assert_int_equal(packing_write(p, made_path("windows.tclip"), &result, NULL), TC_OK);
    s.bytes = packing_bytes(made_path("windows.tclip"), &s.size);
    made_folder_remove();
    return s;
}

/* Windows around a sample of the finest level, the coarsest once around where the map goes round. */
static void want(const tc_clipmap *c, int64_t x, int64_t y, tc_rect wanted[TC_MAX_LEVELS])
{
    int n = tc_clipmap_n(c);
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        const tc_clip_level *v = tc_clipmap_level(c, l);
        int64_t i = (tc_floor_shift(x, v->shift) - n / 2) & ~(int64_t)1, j = ((y >> v->shift) - n / 2) & ~(int64_t)1;
        wanted[l - 1] = tc_rect_intersect((tc_rect){i, j, i + n, j + n}, v->extent);
        if (l == 1 && v->wraps)
            wanted[0] = (tc_rect){i, v->extent.y0, i + v->clip.x1 - v->clip.x0, v->extent.y1};
    }
}

static void assert_same(const tc_clipmap *a, const tc_clipmap *b)
{
    for (int l = 1; l <= tc_clipmap_levels(a); l++) {
        assert_true(tc_rect_equal(tc_clipmap_level(a, l)->clip, tc_clipmap_level(b, l)->clip));
        for (int k = 0; k < tc_clipmap_contents(a); k++) {
            const tc_content_class *content = tc_clipmap_content(a, k);
            const char *ta = tc_clipmap_texels(a, content, l), *tb = tc_clipmap_texels(b, content, l);
            int64_t size = content->scale * (tc_clipmap_n(a) + 1), bytes = (int64_t)tc_texel_bytes(content->format);
            tc_rect r = tc_content_rect(content, tc_clipmap_level(a, l)->clip);
            for (int64_t y = r.y0; y < r.y1; y++)
                for (int64_t x = r.x0; x < r.x1; x++) {
                    int64_t at = ((y & (size - 1)) * size + (x & (size - 1))) * bytes;
                    if (memcmp(ta + at, tb + at, (size_t)bytes) != 0)
                        fail_msg("level %d, %s: texel (%d, %d) differs", l, content->name, (int)x, (int)y);
                }
        }
    }
}

static const tc_ground_options small = {.n = 63, .normals = true, .holes = true};
static const tc_ground_options round_windows = {.n = 511, .normals = true, .holes = true, .wraps = true};

/* Flies over the terrain, then stands still until all is there. Returns the longest update, in milliseconds. */
static double fly(slow_source *s, const tc_ground_options *options, int delay_ms)
{
    tc_field *field = slow_field(s, &(tc_open_options){.cache_bytes = 1});
    tc_clipmap *c, *clean;
    tc_rect wanted[TC_MAX_LEVELS];
    assert_int_equal(tc_ground_create(field, options, &c, NULL), TC_OK);
    tc_level size = tc_field_level(field, tc_field_info(field)->levels);
    int64_t waits = tc_field_tell(field).waits, x = 300, y = 250;
    test_random random = {9};
    double longest = 0;
    s->own_reads = 0;
    s->delay_ms = delay_ms;
    for (int frame = 0; frame < 20000; frame++) {
        bool moves = frame < 400;
        if (moves) {
            x += frame / 40 % 3 == 2 ? -37 : 11, y = 250 + frame % 100;
            if (frame % 97 == 96) /* somewhere else, also around and around */
                x = test_random_int(&random, options->wraps ? -2 * size.width : 0, 2 * size.width);
            x = options->wraps ? x : tc_clamp64(x, 0, size.width - 1);
            want(c, x, y, wanted);
        }
        double start = tc_clock_ms();
        tc_clipmap_update(c, wanted, 20 * tc_clipmap_n(c), false, 1e-3 * start);
        longest = fmax(longest, tc_clock_ms() - start);
        assert_int_equal(tc_clipmap_failed(c), TC_OK);
        if (!moves && tc_clipmap_resident(c))
            break;
        usleep(1000);
    }
    assert_true(tc_clipmap_resident(c));
    assert_int_equal(tc_field_tell(field).waits, waits);
    assert_int_equal(s->own_reads, 0);
    s->delay_ms = 0;
    tc_field *other = slow_field(s, NULL);
    assert_int_equal(tc_ground_create(other, options, &clean, NULL), TC_OK);
    tc_clipmap_update(clean, wanted, -1, true, 0);
    assert_true(tc_field_tell(other).waits > 0 && s->own_reads > 0); /* it would be found */
    assert_same(c, clean);
    tc_clipmap_destroy(c);
    tc_clipmap_destroy(clean);
    tc_field_destroy(field);
    tc_field_destroy(other);
    return longest;
}

static void who_draws_never_waits(void **state)
{
    (void)state;
    slow_source s = packed(&(packing){.width = 1500, .height = 900, .voids = PACKING_LAKES, .error = 1});
    double quick = fly(&s, &small, 0), slow = fly(&s, &small, 20);
    print_message("updates: at most %.1f ms, %.1f ms where each read takes 20\n", quick, slow);
    free(s.bytes);
}

/* The coarsest level is too large here to be held by the field as a whole. */
static void nor_on_the_way_around(void **state)
{
    (void)state;
    slow_source s = packed(&(packing){.width = 1000, .height = 500, .voids = PACKING_LAKES, .error = 1, .wraps = true});
    double quick = fly(&s, &round_windows, 0), slow = fly(&s, &round_windows, 20);
    print_message("updates: at most %.1f ms, %.1f ms where each read takes 20\n", quick, slow);
    free(s.bytes);
}

/* Where the tile is that holds a sample of the finest level. */
static void find_tile(const slow_source *s, int64_t x, int64_t y, int64_t *begin_ret, int64_t *end_ret)
{
    tc_packed_file file;
    tc_tile_entry entry;
    make_bytes(made_path("whole.tclip"), s->bytes, s->size);
    assert_int_equal(tc_packed_file_open(made_path("whole.tclip"), &file, NULL), TC_OK);
    assert_int_equal(tc_packed_file_entry(&file, file.container.levels, x / 128, y / 128, &entry), TC_OK);
    *begin_ret = (int64_t)entry.offset, *end_ret = *begin_ret + tc_tile_bytes(&entry);
    tc_packed_file_close(&file);
    made_folder_remove();
}

/* In the west of the window a tile cannot be read, and the window goes on to the east. */
static void one_side_holds_up_no_other(void **state)
{
    (void)state;
    slow_source s = packed(&(packing){.width = 1500, .height = 900, .error = 1});
    int64_t begin, end;
    find_tile(&s, 300, 450, &begin, &end);
    tc_field *field = slow_field(&s, NULL);
    tc_clipmap *c;
    tc_rect wanted[TC_MAX_LEVELS];
    assert_int_equal(tc_ground_create(field, &(tc_ground_options){.n = 255}, &c, NULL), TC_OK);
    s.own_reads = 0;
    s.broken = begin;
    s.broken_end = end;
    int64_t x = 460;
    double now = 0;
    const tc_clip_level *v = tc_clipmap_level(c, tc_clipmap_levels(c));
    for (int frame = 0; frame < 3000; frame++, now += 1e-2, usleep(1000)) {
        want(c, x, 450, wanted);
        tc_clipmap_update(c, wanted, -1, false, now);
    }
    assert_int_equal(tc_clipmap_failed(c), TC_ERR_IO); /* and its next try is far away: */
    assert_true(!tc_rect_empty(v->clip) && v->clip.x0 > v->wanted.x0 && v->clip.x1 == v->wanted.x1);
    assert_int_equal(tc_field_tell(field).unreadable, 1);
    for (int frame = 0; frame < 400 && x < 500; frame++, now += 1e-3, usleep(1000)) {
        x += v->clip.x1 == v->wanted.x1 ? 4 : 0;
        want(c, x, 450, wanted);
        tc_clipmap_update(c, wanted, -1, false, now);
    }
    assert_true(x >= 500);
    s.broken_end = 0;
    for (int frame = 0; frame < 20000 && !tc_clipmap_resident(c); frame++, now += 1e-2, usleep(1000))
        tc_clipmap_update(c, wanted, -1, false, now);
    assert_true(tc_clipmap_resident(c) && tc_clipmap_failed(c) == TC_OK);
    assert_int_equal(tc_field_tell(field).unreadable, 0);
    assert_int_equal(s.own_reads, 0);
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
    free(s.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_draws_never_waits),
        cmocka_unit_test(nor_on_the_way_around),
        cmocka_unit_test(one_side_holds_up_no_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
