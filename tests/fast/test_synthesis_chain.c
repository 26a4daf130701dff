/* test_synthesis_chain.c - levels by way of the levels below them: the memory that is taken once is enough for any
 * rectangle and no more than the worst takes, single samples, and data that changes. */
#include "tests/support/test.h"

#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/synthesis/synthesis_chain.h"
#include "tests/support/terrains.h"

enum { BLOCK = 256, DATA = 64, LARGE = 1024 }; /* samples that are made at once; of data, a side */

static float *read_rect(const tc_field *f, int level, tc_rect r)
{
    float *z = malloc((size_t)tc_rect_area(r) * sizeof *z);
    assert_non_null(z);
    assert_int_equal(tc_field_read(f, level, r, z, NULL, r.x1 - r.x0), TC_OK);
    return z;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* A chain that nothing is made by, above data of LARGE x LARGE samples. */
static tc_chain measured(bool wraps, bool keeps, tc_level levels[TC_SYNTHESIS_MOST + 1])
{
    for (int k = 0; k <= TC_SYNTHESIS_MOST; k++) {
        int64_t side = ((int64_t)(LARGE - 1) << k) + 1;
        levels[k] = (tc_level){wraps ? (int64_t)LARGE << k : side, side, 1, 1};
    }
    return (tc_chain){.levels = levels, .data = 1, .wraps = wraps, .kept = keeps ? tc_kept_create() : NULL};
}

static size_t taken(const tc_chain *c, int k, int64_t x, int64_t y)
{
    const tc_level size = c->levels[k];
    tc_rect rect = {x, y, x + BLOCK, y + BLOCK},
            all = {c->wraps ? x : 0, 0, c->wraps ? x + BLOCK : size.width, size.height};
    rect = tc_rect_intersect(rect, all);
    return tc_rect_empty(rect) ? 0 : tc_chain_scratch(c, k, rect);
}

/* Around a sample of the data and around the level's corners, at all offsets along the diagonals and at some beside. */
static size_t most_taken(const tc_chain *c, int k)
{
    enum { FROM = -300, TO = 64 };
    const int64_t node = (int64_t)(LARGE / 2) << k;
    size_t most = 0;
    for (int64_t d = FROM; d <= TO; d++) {
        for (int64_t e = FROM; e <= TO; e += 13) {
            size_t n = taken(c, k, node + d, node + e);
            most = n > most ? n : most;
        }
        const size_t corners[] = {taken(c, k, node + d, node + d), taken(c, k, d, d),
                                  taken(c, k, c->levels[k].width + d, c->levels[k].height + d),
                                  taken(c, k, d, node + d)};
        for (int n = 0; n < 4; n++)
            most = corners[n] > most ? corners[n] : most;
    }
    return most;
}

static void there_is_room_for_any_rectangle(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        const bool keeps = kind & 1;
        tc_level levels[TC_SYNTHESIS_MOST + 1];
        tc_chain c = measured(kind >= 2, keeps, levels);
        size_t most = 0;
        for (int k = 1; k <= TC_SYNTHESIS_MOST; k++) {
            size_t n = most_taken(&c, k), room = tc_chain_room(k, BLOCK);
            most = n > most ? n : most;
            if (most > room)
                fail_msg("kind %d: level %d takes %zu floats, there is room for %zu", kind, k, most, room);
            if (keeps)
                assert_int_equal(most, room); /* that of the worst */
        }
        tc_kept_destroy(c.kept);
    }
}

/* With the most levels there are, where most is taken: as in parts, which take less. */
static void the_worst_place_is_read(void **state)
{
    (void)state;
    tc_field *f = terrain_synthesised(terrain_field(TERRAIN_DEFAULT, DATA, DATA, 30, 3), TC_SYNTHESIS_MOST);
    const int l = tc_field_info(f)->levels;
    const int64_t at = ((int64_t)8 << TC_SYNTHESIS_MOST) - 235;
    float *z = read_rect(f, l, (tc_rect){at, at, at + BLOCK, at + BLOCK});
    for (int n = 0; n < 4; n++) {
        int64_t x = n % 2 * 100, y = n / 2 * 90, w = n % 2 ? 156 : 100, h = n / 2 ? 166 : 90;
        float *part = read_rect(f, l, (tc_rect){at + x, at + y, at + x + w, at + y + h});
        for (int64_t j = 0; j < h; j++)
            assert_memory_equal(part + j * w, z + (y + j) * BLOCK + x, (size_t)w * sizeof *z);
        free(part);
    }
    free(z);
    tc_field_destroy(f);
}

/* Scratch is passed on at odd places, too. */
static void single_samples_are_those_of_the_whole(void **state)
{
    (void)state;
    enum { LEVELS = 5, SIDE = 40 };
    tc_field *f = terrain_synthesised(terrain_field(TERRAIN_DEFAULT, DATA, DATA, 30, 3), LEVELS);
    for (int k = 0; k < LEVELS; k++) {
        const int l = tc_field_info(f)->levels - k;
        float *z = read_rect(f, l, (tc_rect){3, 5, 3 + SIDE, 5 + SIDE});
        for (int n = 0; n < SIDE * SIDE; n += 7) {
            int64_t x = 3 + n % SIDE, y = 5 + n / SIDE;
            float *one = read_rect(f, l, (tc_rect){x, y, x + 1, y + 1});
            assert_memory_equal(one, z + n, sizeof *one);
            free(one);
        }
        free(z);
    }
    tc_field_destroy(f);
}

/* ---- Data that changes ------------------------------------------------------------------------------------------- */

/* Another field, raised in a place, and once more with every change. */
typedef struct changing {
    tc_field head;
    tc_field *base;
    uint64_t changes;
    tc_rect where;
} changing;

static tc_status changing_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                               ptrdiff_t stride)
{
    const changing *c = (const changing *)field;
    tc_status status = tc_field_read(c->base, level, rect, samples, voids, stride);
    tc_rect here = level == c->head.info.levels ? tc_rect_intersect(rect, c->where) : (tc_rect){0, 0, 0, 0};
    for (int64_t j = here.y0; j < here.y1 && samples; j++)
        for (int64_t i = here.x0; i < here.x1; i++)
            ((float *)samples)[(j - rect.y0) * stride + (i - rect.x0)] += 7 * (float)c->changes;
    return status;
}

static bool changing_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    const changing *c = (const changing *)field;
    bool changed = *since != c->changes;
    *since = c->changes, *finest_ret = c->where;
    return changed;
}

static tc_range changing_range(const tc_field *field, int level, tc_rect rect)
{
    tc_range r = tc_field_range(((const changing *)field)->base, level, rect);
    return (tc_range){r.lo, r.hi + 100, INFINITY, INFINITY};
}

static void changing_tell(const tc_field *field, tc_field_stats *stats)
{
    stats->bytes += tc_field_tell(((const changing *)field)->base).bytes;
}

static void changing_destroy(tc_field *field)
{
    tc_field_destroy(((changing *)field)->base);
    free(field);
}

static changing *changing_field(uint64_t changes)
{
    static const tc_field_class class = {.sample = TC_FIELD_HEIGHTS,
                                         .read = changing_read,
                                         .range = changing_range,
                                         .changed = changing_changed,
                                         .tell = changing_tell,
                                         .destroy = changing_destroy};
    changing *c = calloc(1, sizeof *c);
    assert_non_null(c);
    tc_field *base = terrain_field(TERRAIN_DEFAULT, DATA, DATA, 30, 3);
    c->head = *base, c->head.class = &class, c->base = base;
    c->head.info.z_max += 100; /* heights are cut to the range */
    c->where = (tc_rect){30, 31, 33, 33}, c->changes = changes;
    return c;
}

/* Synthesised by the fit of the unchanged one. */
static tc_field *made_of(changing *c, int levels)
{
    tc_synthesis_fit fit;
    tc_field *f;
    assert_int_equal(tc_synthesis_learn(c->base, &fit, NULL), TC_OK);
    assert_int_equal(tc_synthesis_create(&c->head, levels, &fit, 0, (tc_synthesis_share){NULL, NULL}, &f, NULL), TC_OK);
    return f;
}

static void heights_follow_what_changes(void **state)
{
    (void)state;
    enum { LEVELS = 3 };
    changing *c = changing_field(0);
    tc_field *f = made_of(c, LEVELS), *fresh = made_of(changing_field(1), LEVELS);
    const int l = tc_field_info(f)->levels;
    const tc_level size = tc_field_level(f, l);
    const tc_rect all = {0, 0, size.width, size.height};
    uint64_t since = 0, other = 0;
    tc_rect where;
    assert_false(tc_field_changed(f, &since, &where));
    float *before = read_rect(f, l, all);
    c->changes = 1;
    float *after = read_rect(f, l, all), *want = read_rect(fresh, l, all);
    assert_memory_equal(after, want, (size_t)tc_rect_area(all) * sizeof *after);
    assert_true(tc_field_changed(f, &since, &where));
    assert_false(tc_field_changed(f, &since, &where));
    assert_true(tc_field_changed(f, &other, &where));
    int64_t changed = 0;
    for (int64_t n = 0; n < tc_rect_area(all); n++)
        if (before[n] != after[n]) {
            assert_true(tc_rect_contains(where, n % size.width, n / size.width));
            changed++;
        }
    assert_true(changed > 100 && tc_rect_area(where) < tc_rect_area(all));
    free(before), free(after), free(want);
    tc_field_destroy(f), tc_field_destroy(fresh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_is_room_for_any_rectangle),
        cmocka_unit_test(the_worst_place_is_read),
        cmocka_unit_test(single_samples_are_those_of_the_whole),
        cmocka_unit_test(heights_follow_what_changes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
