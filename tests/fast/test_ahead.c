/* test_ahead.c - frames that never stutter, by counts: who reads ahead serves what is urgent and coarse first, several
 * threads at a time, and nothing that is not wanted any more; windows in motion ask for what they will want, so that
 * less comes late; and a limit of time is kept to within a piece. */
#include "tests/support/test.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/content/ground.h"
#include "common/packed/read/packed_internal.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/slow_source.h"
#include "tests/support/stripes.h"
#include "tests/support/terrains.h"

/* ---- Wishes ------------------------------------------------------------------------------------------------------ */

/* A field of wishes: how they are served is noted, and goes on only while the gate is open. */
typedef struct notes {
    pthread_mutex_t mutex;
    _Atomic bool open;
    _Atomic int within, most_within, count;
    int level[TC_WISHES];
} notes;

static tc_piece note(tc_wish *wish)
{
    notes *n = wish->field;
    int now = ++n->within;
    pthread_mutex_lock(&n->mutex);
    n->most_within = now > n->most_within ? now : n->most_within;
    n->level[n->count] = wish->level;
    n->count++;
    pthread_mutex_unlock(&n->mutex);
    while (!n->open)
        usleep(100);
    n->within--;
    return TC_PIECE_LAST;
}

static bool wait_for(const _Atomic int *number, int value)
{
    for (int tries = 0; *number != value && tries < 100000; tries++)
        usleep(100);
    return *number == value;
}

static tc_wish wish_of(notes *n, int level, tc_urgency urgency)
{
    return (tc_wish){.field = n, .level = level, .rect = {0, 0, 8, 8}, .urgency = urgency, .bytes = 1};
}

static void what_is_urgent_and_coarse_is_first(void **state)
{
    (void)state;
    notes n = {.mutex = PTHREAD_MUTEX_INITIALIZER};
    tc_prefetch p;
    tc_prefetch_init(&p, note, 1000, 1);
    const tc_wish wishes[] = {wish_of(&n, 1, TC_SOON), wish_of(&n, 3, TC_LATER),  wish_of(&n, 9, TC_SOON),
                              wish_of(&n, 5, TC_SOON), wish_of(&n, 7, TC_URGENT), wish_of(&n, 2, TC_LATER)};
    assert_true(tc_prefetch_ask(&p, &wishes[0]));
    assert_true(wait_for(&n.count, 1)); /* it is begun */
    for (int k = 1; k < 6; k++)
        assert_true(tc_prefetch_ask(&p, &wishes[k]));
    const tc_rect rect = wishes[2].rect;
    assert_true(tc_prefetch_cancel(&p, &n, 9, rect));
    assert_false(tc_prefetch_cancel(&p, &n, 9, rect)); /* no more */
    n.open = true;
    assert_true(wait_for(&n.count, 5));
    static const int order[] = {1, 7, 5, 2, 3};
    assert_memory_equal(n.level, order, sizeof order);
    tc_prefetch_forget(&p, &n);
    assert_int_equal(n.count, 5);
    assert_int_equal(n.most_within, 1);
    tc_prefetch_free(&p);
}

/* Pages before samples, those of the index first; each kind has places of its own. */
static void pages_of_the_index_are_first(void **state)
{
    (void)state;
    notes n = {.mutex = PTHREAD_MUTEX_INITIALIZER};
    tc_prefetch p;
    tc_prefetch_init(&p, note, 1000, 1);
    static const int kinds[] = {0, TC_WISH_ERRORS, TC_WISH_INDEX};
    const tc_wish first = wish_of(&n, 1, TC_SOON);
    assert_true(tc_prefetch_ask(&p, &first));
    assert_true(wait_for(&n.count, 1)); /* it is begun */
    for (int k = 0; k < 3; k++)
        for (int x = 0; x < (kinds[k] ? TC_WISHES : 1); x++) {
            tc_wish wish = wish_of(&n, 2 + k, TC_SOON);
            wish.index = kinds[k], wish.rect.x0 = x, wish.rect.x1 = x + 1;
            assert_true(tc_prefetch_ask(&p, &wish));
        }
    n.open = true;
    enum { SHARE = TC_WISHES / 4 };
    assert_true(wait_for(&n.count, 2 + 2 * SHARE));
    for (int k = 1; k < 2 + 2 * SHARE; k++)
        assert_int_equal(n.level[k], k <= SHARE ? 4 : k <= 2 * SHARE ? 3 : 2);
    tc_prefetch_forget(&p, &n);
    assert_int_equal(n.count, 2 + 2 * SHARE);
    tc_prefetch_free(&p);
}

static void several_threads_read(void **state)
{
    (void)state;
    enum { THREADS = 4 };
    notes n = {.mutex = PTHREAD_MUTEX_INITIALIZER};
    tc_prefetch p;
    tc_prefetch_init(&p, note, 1000, THREADS);
    for (int k = 0; k < 2 * THREADS; k++) {
        const tc_wish wish = wish_of(&n, k + 1, TC_SOON);
        assert_true(tc_prefetch_ask(&p, &wish));
    }
    assert_true(wait_for(&n.within, THREADS)); /* none of which comes to an end */
    assert_int_equal(p.threads, THREADS);
    n.open = true;
    assert_true(wait_for(&n.count, 2 * THREADS));
    tc_prefetch_forget(&p, &n);
    assert_int_equal(n.most_within, THREADS);
    tc_prefetch_free(&p);
}

/* However much may be wanted later, what is wanted now finds its place. */
static void later_is_never_much(void **state)
{
    (void)state;
    notes n = {.mutex = PTHREAD_MUTEX_INITIALIZER};
    tc_prefetch p;
    tc_prefetch_init(&p, note, 1000, 1);
    for (int k = 0; k < 10 * TC_WISHES; k++) {
        const tc_wish later = wish_of(&n, k + 1, TC_LATER);
        assert_true(tc_prefetch_ask(&p, &later));
    }
    assert_true(p.wishes <= TC_WISHES / 4);
    n.open = true;
    tc_prefetch_forget(&p, &n);
    tc_prefetch_free(&p);
}

/* ---- Windows in motion ------------------------------------------------------------------------------------------- */

static slow_source packed(int64_t width, int64_t height)
{
    slow_source s = {0};
    tc_pack_result result;
    const packing p = {.width = width, .height = height, .error = 1};
    assert_int_equal(packing_write(&p, made_path("ahead.tclip"), &result, NULL), TC_OK);
    s.bytes = packing_bytes(made_path("ahead.tclip"), &s.size);
    made_folder_remove();
    return s;
}

/* Until all is decoded that was asked for: frames are as long as that takes, on any machine. */
static void settle(const tc_field *field)
{
    tc_prefetch *p = &((const packed_field *)field)->store->prefetch;
    for (bool idle = false; !idle; usleep(100)) {
        pthread_mutex_lock(&p->mutex);
        idle = true;
        for (int k = 0; k < TC_WISHES; k++)
            idle &= !p->wish[k].field || p->wish[k].fetched;
        for (int k = 0; k < p->threads; k++)
            idle &= p->thread[k].serves == NULL;
        pthread_mutex_unlock(&p->mutex);
    }
}

typedef struct flown {
    int late;        /* frames that lacked something */
    int64_t lacking; /* samples, of all frames together */
    tc_field_stats stats;
} flown;

static const tc_ground_options small = {.n = 63, .normals = true};

/* A flight straight on, then a turn and back. */
static flown fly(slow_source *s, double ahead)
{
    tc_field *field = slow_field(s, NULL);
    tc_clipmap *c;
    tc_rect wanted[TC_MAX_LEVELS];
    flown f = {0};
    ((packed_field *)field)->store->prefetch.most = 4; /* whatever processors there are */
    assert_int_equal(tc_ground_create(field, &small, &c, NULL), TC_OK);
    const int64_t waits = tc_field_tell(field).waits; /* for the coarsest level, before any frame */
    s->own_reads = 0;
    tc_update how = {.budget = -1, .now = 1, .ahead = ahead};
    stripes_want(c, 300, 600, wanted);
    for (int frame = 0; frame < 200; frame++, settle(field))
        tc_clipmap_update_as(c, wanted, &how);
    assert_true(tc_clipmap_resident(c));
    for (int frame = 0; frame < 600; frame++, settle(field)) {
        how.now += 1. / 60;
        stripes_want(c, 300 + 3 * (frame < 400 ? frame : 800 - frame), 600 + (frame < 400 ? frame : 400), wanted);
        tc_clipmap_update_as(c, wanted, &how);
        f.late += !tc_clipmap_resident(c);
        for (int l = 2; l <= tc_clipmap_levels(c); l++)
            f.lacking += tc_rect_area(tc_clipmap_level(c, l)->wanted) - tc_rect_area(tc_clipmap_level(c, l)->clip);
    }
    f.stats = tc_field_tell(field);
    assert_int_equal(f.stats.waits, waits);
    assert_int_equal(s->own_reads, 0);
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
    return f;
}

static void what_is_asked_for_ahead_does_not_come_late(void **state)
{
    (void)state;
    slow_source s = packed(2000, 1500);
    const flown without = fly(&s, 0), with = fly(&s, 1);
    print_message("late frames of 600: %d, %d where tiles were asked for ahead; samples lacking %lld, %lld; "
                  "kB decoded %lld, %lld; wishes given up %lld, %lld\n",
                  without.late, with.late, (long long)without.lacking, (long long)with.lacking,
                  (long long)without.stats.decoded / 1000, (long long)with.stats.decoded / 1000,
                  (long long)without.stats.cancelled, (long long)with.stats.cancelled);
    assert_true(without.late >= 10);
    assert_true(with.late * 4 <= without.late && with.lacking * 4 <= without.lacking);
    assert_true(with.stats.decoded < without.stats.decoded * 3 / 2); /* it asks for little that is not wanted then */
    free(s.bytes);
}

/* ---- What is overtaken ------------------------------------------------------------------------------------------- */

/* Bytes decoded by windows that want place b, where they wanted place a before (a >= 0) and nothing could be read yet.
 */
static int64_t leap(slow_source *s, int64_t a, int64_t b, int64_t *cancelled_ret)
{
    tc_field *field = slow_field(s, NULL);
    tc_prefetch *p = &((const packed_field *)field)->store->prefetch;
    tc_clipmap *c;
    tc_rect wanted[TC_MAX_LEVELS];
    p->most = 1;
    assert_int_equal(tc_ground_create(field, &small, &c, NULL), TC_OK);
    /* The thread is kept busy by something else. */
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    const tc_rect corner = {finest.width - 8, finest.height - 8, finest.width, finest.height};
    const int64_t before = tc_field_tell(field).decoded;
    const int reads = s->reads;
    s->delay_ms = 200;
    assert_int_equal(tc_field_ready(field, tc_field_info(field)->levels, corner, TC_URGENT), TC_COMING);
    while (s->reads == reads)
        usleep(100);
    double now = 1;
    for (int k = 0; k < 2; k++) {
        const int64_t place = k ? b : a;
        stripes_want(c, place, place, wanted);
        if (place >= 0)
            tc_clipmap_update_as(c, wanted, &(tc_update){.budget = -1, .now = now});
        now += 1;
    }
    s->delay_ms = 0;
    for (int frame = 0; frame < 1000 && !tc_clipmap_resident(c); frame++) {
        settle(field);
        tc_clipmap_update_as(c, wanted, &(tc_update){.budget = -1, .now = now});
    }
    assert_true(tc_clipmap_resident(c));
    settle(field);
    const tc_field_stats stats = tc_field_tell(field);
    *cancelled_ret = stats.cancelled;
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
    return stats.decoded - before;
}

static void what_is_overtaken_is_not_decoded(void **state)
{
    (void)state;
    slow_source s = packed(2000, 1500);
    int64_t none, some, unused;
    const int64_t straight = leap(&s, -1, 1200, &none), by_way_of = leap(&s, 250, 1200, &some),
                  other = leap(&s, -1, 250, &unused);
    print_message("kB decoded at one place %lld, at another %lld; there where the first was given up %lld, "
                  "with %lld wishes\n",
                  (long long)other / 1000, (long long)straight / 1000, (long long)by_way_of / 1000, (long long)some);
    assert_true(some > 0);
    assert_int_equal(by_way_of, straight);
    free(s.bytes);
}

/* ---- A limit of time --------------------------------------------------------------------------------------------- */

enum { PIECE_MS = 2, PIECE = 1 << 13, LIMIT_MS = 10 };
static int fills;
static int64_t largest;

static tc_status fill_slowly(const tc_fill *f)
{
    fills++;
    largest = tc_max64(largest, tc_rect_area(f->rect));
    usleep(1000 * PIECE_MS);
    return stripes.fill(f);
}

static void time_is_kept_to_a_piece(void **state)
{
    (void)state;
    enum { N = 255, SIDE = 2 * (N + 1) };
    tc_content_class slow = stripes;
    slow.fill = fill_slowly;
    tc_field *field = terrain_field(TERRAIN_SMOOTH, 1500, 1500, 10, 3);
    const tc_clipmap_options options = {.n = N, .contents = 1, .content = {{.class = &slow, .parameter = 5}}};
    tc_clipmap *c;
    tc_rect wanted[TC_MAX_LEVELS];
    assert_int_equal(tc_clipmap_create(field, &options, &c, NULL), TC_OK);
    int updates = 0, most = 0;
    for (int place = 0; place < 4; place++) {
        stripes_want(c, 200 + 300 * place, 900 - 200 * place, wanted);
        do {
            fills = 0, largest = 0;
            /* The second time it is late before it begins. */
            const double until = tc_clock_ms() + (place == 1 ? -1 : LIMIT_MS);
            tc_clipmap_update_as(c, wanted, &(tc_update){.budget = -1, .until = until});
            assert_true(fills <= (place == 1 ? 1 : (LIMIT_MS + PIECE_MS - 1) / PIECE_MS + 1));
            assert_true(largest <= PIECE);
            most = fills > most ? fills : most;
            assert_true(++updates < 2000);
        } while (!tc_clipmap_resident(c));
    }
    print_message("%d updates of %d ms, at most %d pieces of %d ms each\n", updates, LIMIT_MS, most, PIECE_MS);
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        const uint8_t *texels = tc_clipmap_texels(c, &slow, l);
        const tc_rect r = tc_content_rect(&slow, tc_clipmap_level(c, l)->clip);
        for (int64_t y = r.y0; y < r.y1; y++)
            for (int64_t x = r.x0; x < r.x1; x++)
                if (texels[(y & (SIDE - 1)) * SIDE + (x & (SIDE - 1))] != stripe(&options.content[0], l, x, y))
                    fail_msg("level %d: texel (%d, %d) differs", l, (int)x, (int)y);
    }
    /* Who waits gets all, however late it is. */
    stripes_want(c, 200, 900, wanted);
    tc_clipmap_update_as(c, wanted, &(tc_update){.budget = -1, .wait = true, .until = 1});
    assert_true(tc_clipmap_resident(c));
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_urgent_and_coarse_is_first),
        cmocka_unit_test(pages_of_the_index_are_first),
        cmocka_unit_test(several_threads_read),
        cmocka_unit_test(later_is_never_much),
        cmocka_unit_test(what_is_asked_for_ahead_does_not_come_late),
        cmocka_unit_test(what_is_overtaken_is_not_decoded),
        cmocka_unit_test(time_is_kept_to_a_piece),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
