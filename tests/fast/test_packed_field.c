/* test_packed_field.c - what a packed field promises to who draws: nothing waits that need not, ranges read no file,
 * what cannot be read is told and tried again with pauses, memory stays within what was asked for; and all of that
 * through a field that decorates it. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/slow_source.h"
#include "tests/support/terrains.h"

enum { SIZE = 1500 };

static tc_ready await(const tc_field *field, int level, tc_rect rect)
{
    tc_ready ready = TC_COMING;
    for (int n = 0; n < 20000 && (ready = tc_field_ready(field, level, rect, TC_SOON)) == TC_COMING; n++)
        usleep(1000);
    return ready;
}

/* Windows of any size, points and ranges without a wait, from a file that takes 20 ms a read; then the same bits. */
static void nothing_waits(void **state)
{
    slow_source *m = *state;
    static float z[SIZE * SIZE], truth[SIZE * SIZE];
    m->delay_ms = 20;
    tc_field *f = slow_field(m, &(tc_open_options){.cache_bytes = 1});
    int l = tc_field_info(f)->levels;
    tc_rect all = {0, 0, SIZE, SIZE};
    double height, longest = 0;
    int level;
    assert_true(tc_field_height_ready(f, 20000, 20000, &height, &level));
    assert_true(level < l);
    test_random random = {5};
    for (tc_ready ready = TC_COMING; ready != TC_READY;) {
        double start = tc_clock_ms();
        ready = tc_field_read_ready(f, l, all, z, NULL, SIZE, TC_URGENT);
        for (int n = 0; n < 20; n++) {
            int64_t x = test_random_int(&random, 0, SIZE - 1), y = test_random_int(&random, 0, SIZE - 1);
            tc_range range = tc_field_range(f, l, (tc_rect){x, y, tc_min64(x + 300, SIZE), tc_min64(y + 300, SIZE)});
            assert_true(range.lo <= range.hi);
            assert_true(tc_field_height_ready(f, (double)x * 30, (double)y * 30, &height, &level));
        }
        longest = fmax(longest, tc_clock_ms() - start);
        assert_true(ready != TC_FAILED);
        usleep(1000);
    }
    tc_field_stats told = tc_field_tell(f);
    assert_int_equal(told.waits, 0);
    assert_int_equal(m->own_reads, 0);
    assert_true(told.range_reads <= 4 * told.ranges);
    m->delay_ms = 0;
    assert_int_equal(tc_field_read(f, l, all, truth, NULL, SIZE), TC_OK);
    assert_memory_equal(z, truth, sizeof z);
    tc_field_destroy(f);
    f = slow_field(m, NULL);
    assert_int_equal(tc_field_read(f, l, all, truth, NULL, SIZE), TC_OK);
    assert_memory_equal(z, truth, sizeof z);
    assert_true(tc_field_tell(f).waits > 0); /* it would be found */
    tc_field_destroy(f);
}

/* Bounds that narrow as the index comes, and hold. */
static void ranges_narrow(void **state)
{
    slow_source *m = *state;
    tc_field *f = slow_field(m, NULL);
    int l = tc_field_info(f)->levels;
    tc_rect r = {700, 700, 760, 760};
    tc_range wide = tc_field_range(f, l, r), range = wide;
    for (int n = 0; n < 5000 && !(range.hi - range.lo < 0.9f * (wide.hi - wide.lo)); n++) {
        usleep(1000);
        range = tc_field_range(f, l, r);
    }
    assert_true(range.hi - range.lo < 0.9f * (wide.hi - wide.lo));
    assert_int_equal(m->own_reads, 0);
    float z[60 * 60];
    assert_int_equal(tc_field_read(f, l, r, z, NULL, 60), TC_OK);
    for (int k = 0; k < 60 * 60; k++)
        assert_true(z[k] >= range.lo && z[k] <= range.hi);
    tc_field_destroy(f);
}

/* What cannot be read fails, is counted, is not tried in each frame, and comes once it can be read. */
static void unreadable_tiles_are_told(void **state)
{
    slow_source *m = *state;
    tc_field *f = slow_field(m, NULL);
    int l = tc_field_info(f)->levels;
    tc_rect r = {1000, 1000, 1400, 1400};
    m->broken = (int64_t)m->size / 2;
    m->broken_end = (int64_t)m->size;
    assert_int_equal(await(f, l, r), TC_FAILED);
    assert_true(tc_field_tell(f).unreadable > 0);
    int before = m->reads;
    for (double start = tc_clock_ms(); tc_clock_ms() - start < 900; usleep(1000))
        tc_field_ready(f, l, r, TC_SOON);
    assert_in_range(m->reads - before, 1, 12); /* after 250 and 500 ms */
    m->broken_end = 0;
    double start = tc_clock_ms();
    while (tc_field_ready(f, l, r, TC_SOON) != TC_READY && tc_clock_ms() - start < 10000)
        usleep(1000);
    assert_true(tc_clock_ms() - start < 10000);
    assert_int_equal(tc_field_tell(f).unreadable, 0);
    assert_int_equal(tc_field_tell(f).waits, 0);
    tc_field_destroy(f);
}

/* Once a tile is damaged, bounds still hold the constant at which voids are shown. */
static void damage_keeps_the_constant(void **state)
{
    slow_source *m = *state;
    const size_t at_tile = m->size - m->size / 4; /* errors are the last of the file */
    uint8_t kept = m->bytes[at_tile];
    m->bytes[at_tile] ^= 0x55;
    tc_open_options how = {.has_policy = true, .voids = TC_VOIDS_CONSTANT, .void_constant = -9000};
    tc_field *f = slow_field(m, &how);
    int l = tc_field_info(f)->levels;
    static float z[SIZE * SIZE];
    static uint8_t voids[SIZE * SIZE];
    assert_int_equal(tc_field_read(f, l, (tc_rect){0, 0, SIZE, SIZE}, z, voids, SIZE), TC_OK);
    assert_true(tc_field_tell(f).damaged > 0);
    int64_t at = 0;
    while (!voids[at])
        at++;
    assert_true(z[at] == -9000);
    int64_t x = at % SIZE, y = at / SIZE;
    assert_true(tc_field_range(f, l, (tc_rect){x, y, x + 1, y + 1}).lo <= -9000);
    tc_field_destroy(f);
    m->bytes[at_tile] = kept;
}

/* A large block, whose inner tiles are not kept, and small ones give the same bits, damage or none. */
static void large_blocks_are_the_same(void **state)
{
    enum { SIDE = 250 };
    slow_source *m = *state;
    static float large[SIZE * SIZE], small[SIZE * SIZE];
    tc_rect all = {0, 0, SIZE, SIZE};
    for (int damaged = 0; damaged < 2; damaged++) {
        size_t at = m->size - m->size / 3;
        m->bytes[at] ^= damaged ? 0x55 : 0;
        tc_field *f = slow_field(m, NULL), *g = slow_field(m, NULL);
        int l = tc_field_info(f)->levels;
        assert_int_equal(tc_field_read(f, l, all, large, NULL, SIZE), TC_OK);
        for (int64_t y = 0; y < SIZE; y += SIDE)
            for (int64_t x = 0; x < SIZE; x += SIDE) {
                tc_rect r = {x, y, tc_min64(x + SIDE, SIZE), tc_min64(y + SIDE, SIZE)};
                assert_int_equal(tc_field_read(g, l, r, small + y * SIZE + x, NULL, SIZE), TC_OK);
            }
        assert_memory_equal(large, small, sizeof large);
        assert_int_equal(tc_field_tell(f).damaged, damaged);
        assert_int_equal(tc_field_tell(g).damaged, damaged);
        /* However often it is read. */
        assert_int_equal(tc_field_read(f, l, all, large, NULL, SIZE), TC_OK);
        assert_int_equal(tc_field_tell(f).damaged, damaged);
        assert_true(tc_field_tell(f).cache_bytes < tc_field_tell(g).cache_bytes);
        tc_field_destroy(f), tc_field_destroy(g);
        m->bytes[at] ^= damaged ? 0x55 : 0;
    }
}

/* A window finds the coarser one's tiles, whether that was read as one large block or as small ones. */
static void finer_windows_find_coarser_tiles(void **state)
{
    enum { SIDE = 250, WINDOW = 1023 };
    static float z[WINDOW * WINDOW];
    int64_t decoded[2];
    for (int large = 0; large < 2; large++) {
        tc_field *f = slow_field(*state, NULL);
        const int l = tc_field_info(f)->levels, side = large ? SIZE / 2 : SIDE;
        for (int64_t y = 0; y < SIZE / 2; y += side)
            for (int64_t x = 0; x < SIZE / 2; x += side)
                assert_int_equal(tc_field_read(f, l - 1, (tc_rect){x, y, x + side, y + side}, z, NULL, side), TC_OK);
        const int64_t before = tc_field_tell(f).decoded;
        assert_int_equal(tc_field_read(f, l, (tc_rect){200, 200, 200 + WINDOW, 200 + WINDOW}, z, NULL, WINDOW), TC_OK);
        decoded[large] = tc_field_tell(f).decoded - before;
        tc_field_destroy(f);
    }
    assert_int_equal(decoded[0], decoded[1]);
}

/* Memory is what was asked for, once no window needs more. */
static void the_cache_keeps_its_promise(void **state)
{
    slow_source *m = *state;
    enum { BYTES = 4 << 20 };
    tc_field *f = slow_field(m, &(tc_open_options){.cache_bytes = BYTES});
    int l = tc_field_info(f)->levels;
    static float z[SIZE * SIZE];
    static uint8_t voids[SIZE * SIZE];
    assert_int_equal(tc_field_read(f, l, (tc_rect){0, 0, SIZE, SIZE}, z, voids, SIZE), TC_OK);
    assert_true(tc_field_tell(f).cache_bytes <= BYTES);
    assert_int_equal(await(f, l, (tc_rect){0, 0, SIZE, SIZE}), TC_READY);
    assert_true(tc_field_tell(f).cache_bytes > BYTES);
    for (int n = 0; n < 600; n++)
        await(f, l, (tc_rect){n, n, n + 30, n + 30});
    assert_int_equal(tc_field_read(f, l, (tc_rect){0, 0, SIZE, SIZE}, z, voids, SIZE), TC_OK);
    assert_true(tc_field_tell(f).cache_bytes <= BYTES);
    tc_field_destroy(f);
}

/* ---- A field that adds a constant ------------------------------------------------------------------------------- */

typedef struct raised {
    tc_field head;
    const tc_field *base;
    float by;
} raised;

static void raise_samples(const raised *r, tc_rect rect, float *z, ptrdiff_t stride)
{
    for (int64_t j = 0; z && j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
            z[j * stride + i] += r->by;
}

static tc_status raised_read(const tc_field *f, int level, tc_rect rect, void *z, uint8_t *voids, ptrdiff_t stride)
{
    const raised *r = (const raised *)f;
    tc_status status = tc_field_read(r->base, level, rect, z, voids, stride);
    if (status == TC_OK)
        raise_samples(r, rect, z, stride);
    return status;
}

static bool raised_read_ready(const tc_field *f, int level, tc_rect rect, void *z, uint8_t *voids, ptrdiff_t stride)
{
    const raised *r = (const raised *)f;
    if (tc_field_read_ready(r->base, level, rect, z, voids, stride, TC_ONLY_ASK) != TC_READY)
        return false;
    raise_samples(r, rect, z, stride);
    return true;
}

static tc_ready raised_ready(const tc_field *f, int level, tc_rect rect, tc_urgency urgency)
{
    return tc_field_ready(((const raised *)f)->base, level, rect, urgency);
}

static tc_range raised_range(const tc_field *f, int level, tc_rect rect)
{
    const raised *r = (const raised *)f;
    tc_range range = tc_field_range(r->base, level, rect);
    return (tc_range){range.lo + r->by, range.hi + r->by, range.step, range.error};
}

static void raised_tell(const tc_field *f, tc_field_stats *stats)
{
    const tc_field *base = ((const raised *)f)->base;
    base->class->tell(base, stats);
}

static const tc_container *raised_container(const tc_field *f)
{
    return tc_field_container(((const raised *)f)->base);
}

static void a_decorated_field_passes_all_on(void **state)
{
    static const tc_field_class class = {.read = raised_read,
                                         .read_ready = raised_read_ready,
                                         .ready = raised_ready,
                                         .range = raised_range,
                                         .tell = raised_tell,
                                         .container = raised_container};
    tc_field *base = slow_field(*state, NULL);
    raised up = {.head = *base, .base = base, .by = 64};
    up.head.class = &class;
    const tc_field *f = &up.head;
    int l = tc_field_info(f)->levels;
    tc_rect r = {100, 100, 300, 260};
    static float low[200 * 160], high[200 * 160];
    assert_int_equal(await(f, l, r), TC_READY);
    assert_int_equal(tc_field_read_ready(f, l, r, high, NULL, 200, TC_SOON), TC_READY);
    assert_int_equal(tc_field_read(base, l, r, low, NULL, 200), TC_OK);
    tc_range range = tc_field_range(f, l, r);
    for (int k = 0; k < 200 * 160; k++)
        assert_true(high[k] == low[k] + 64 && high[k] >= range.lo && high[k] <= range.hi);
    double a, b;
    assert_int_equal(tc_field_height(base, 4000, 5000, &a), TC_OK);
    assert_true(tc_field_height_ready(f, 4000, 5000, &b, NULL));
    assert_float_equal(a + 64, b, 1e-3);
    assert_ptr_equal(tc_field_packed_info(f), tc_field_packed_info(base));
    tc_field_stats told = tc_field_tell(f);
    assert_true(told.decoded > 0 && told.bytes > 0 && told.decoded == tc_field_tell(base).decoded);
    tc_field_destroy(base);
}

static int set_up(void **state)
{
    static slow_source m;
    const packing hills = {.width = SIZE, .height = SIZE, .voids = PACKING_LAKES, .error = 1};
    tc_pack_result result;
    assert_int_equal(packing_write(&hills, made_path("field.tclip"), &result, NULL), TC_OK);
    m.bytes = packing_bytes(made_path("field.tclip"), &m.size);
    made_folder_remove();
    *state = &m;
    return 0;
}

static int tear_down(void **state)
{
    free(((slow_source *)*state)->bytes);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_waits),
        cmocka_unit_test(ranges_narrow),
        cmocka_unit_test(unreadable_tiles_are_told),
        cmocka_unit_test(damage_keeps_the_constant),
        cmocka_unit_test(large_blocks_are_the_same),
        cmocka_unit_test(finer_windows_find_coarser_tiles),
        cmocka_unit_test(the_cache_keeps_its_promise),
        cmocka_unit_test(a_decorated_field_passes_all_on),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
