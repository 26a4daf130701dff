/* test_block_cache.c - the cache of blocks under one and many threads, and spools. */
#include "tests/support/test.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/packed/file/block_cache.h"
#include "common/packed/write/spool.h"
#include "tests/support/made_files.h"
#include "tests/support/terrains.h"

/* ---- Cache ------------------------------------------------------------------------------------------------------- */

enum { BYTES = 1000, KEYS = 60, BLOCK = (sizeof(tc_block) + BYTES + 63) / 64 * 64 };

static atomic_int made;
static bool slow; /* making takes so long that others come to wait for it */

static void fill(tc_block *b, uint64_t key)
{
    made++;
    if (slow)
        usleep(1000);
    memset(b->bytes, (int)(key * 31 % 251), BYTES);
}

static bool is_filled(const tc_block *b, uint64_t key)
{
    uint8_t v = (uint8_t)(key * 31 % 251);
    return b->key == key && b->bytes[0] == v && b->bytes[BYTES - 1] == v && !memcmp(b->bytes, b->bytes + 1, BYTES - 1);
}

/* Pins, fills where that is due, checks. */
static tc_block *pin(tc_block_cache *c, uint64_t key)
{
    tc_block *b = tc_block_pin(c, key, BYTES);
    if (!b)
        return NULL;
    if (!b->made) {
        fill(b, key);
        tc_block_made(c, b, true);
    }
    return b;
}

static void the_last_used_stay(void **state)
{
    (void)state;
    tc_block_cache c;
    enum { most = 12 };
    assert_int_equal(tc_block_cache_init(&c, most * BLOCK), TC_OK);
    made = 0;
    for (int k = 0; k < most; k++)
        tc_block_release(&c, pin(&c, (uint64_t)k << 56 | (uint64_t)k));
    for (int k = 0; k < most; k++) /* all are there */
        tc_block_release(&c, pin(&c, (uint64_t)k << 56 | (uint64_t)k));
    assert_int_equal(made, most);
    tc_block_release(&c, pin(&c, 0)); /* the oldest, new again */
    tc_block_release(&c, pin(&c, 999));
    assert_int_equal(made, most + 1);
    tc_block_release(&c, pin(&c, 0));
    assert_int_equal(made, most + 1);
    tc_block_release(&c, pin(&c, (uint64_t)1 << 56 | 1)); /* this one had to go */
    assert_int_equal(made, most + 2);
    assert_true(tc_block_cache_bytes(&c) <= most * BLOCK + 4096);
    tc_block_cache_free(&c);
}

/* Blocks in use are never taken, however many. */
static void pinned_blocks_stay(void **state)
{
    (void)state;
    tc_block_cache c;
    tc_block *held[KEYS];
    assert_int_equal(tc_block_cache_init(&c, 1), TC_OK);
    for (uint64_t k = 0; k < KEYS; k++)
        held[k] = pin(&c, k);
    for (uint64_t k = 0; k < KEYS; k++) {
        assert_true(held[k]->made && is_filled(held[k], k));
        assert_true(((uintptr_t)held[k]->bytes & 63) == 0);
    }
    for (uint64_t k = 0; k < KEYS; k++)
        assert_ptr_equal(pin(&c, k), held[k]); /* twice */
    for (uint64_t k = 0; k < KEYS; k++)
        tc_block_release(&c, held[k]), assert_true(is_filled(held[k], k));
    for (uint64_t k = 0; k < KEYS; k++)
        tc_block_release(&c, held[k]);
    tc_block_cache_free(&c);
}

typedef struct user {
    tc_block_cache *c;
    uint64_t seed;
    int wrong;
} user;

static void *use(void *context)
{
    user *u = context;
    test_random r = {u->seed};
    for (int n = 0; n < 4000; n++) {
        uint64_t a = (uint64_t)test_random_int(&r, 0, KEYS - 1), b = (uint64_t)test_random_int(&r, 0, KEYS - 1);
        if (a > b) { /* as levels do: the finer one waits for the coarser one */
            uint64_t kept = a;
            a = b, b = kept;
        }
        tc_block *first = tc_block_pin(u->c, b, BYTES), *second = NULL;
        bool mine = first && !first->made;
        if (a != b)
            second = pin(u->c, a);
        if (mine) {
            fill(first, b);
            tc_block_made(u->c, first, true);
        }
        u->wrong += !first || !is_filled(first, b) || (a != b && (!second || !is_filled(second, a)));
        if (second)
            tc_block_release(u->c, second);
        if (first)
            tc_block_release(u->c, first);
    }
    return NULL;
}

static void threads_share_blocks(void **state)
{
    (void)state;
    enum { THREADS = 6 };
    for (int k = 0; k < 2; k++) {
        tc_block_cache c;
        assert_int_equal(tc_block_cache_init(&c, k ? 1 : 100 * BLOCK), TC_OK);
        pthread_t thread[THREADS];
        user users[THREADS];
        made = 0;
        slow = !k;
        for (int n = 0; n < THREADS; n++) {
            users[n] = (user){&c, (uint64_t)n + 10, 0};
            assert_int_equal(pthread_create(&thread[n], NULL, use, &users[n]), 0);
        }
        for (int n = 0; n < THREADS; n++) {
            pthread_join(thread[n], NULL);
            assert_int_equal(users[n].wrong, 0);
        }
        if (!k)
            assert_int_equal(made, KEYS); /* room for all: each is made once */
        int64_t blocks = 0;
        for (const tc_block *b = c.newest; b; b = b->older, blocks++)
            assert_true(b->users == 0 && b->made);
        assert_true(c.bytes == (size_t)blocks * BLOCK && blocks <= 2 * THREADS + 100 * !k);
        tc_block_cache_free(&c);
    }
}

/* ---- Spool ------------------------------------------------------------------------------------------------------- */

static void spools_hold_rectangles(void **state)
{
    (void)state;
    enum { W = 53, H = 37 };
    for (size_t size = 1; size <= 4; size *= 4) {
        tc_spool s;
        tc_error error = {TC_OK, ""};
        assert_int_equal(tc_spool_create(made_path("a"), W, H, size, &s, &error), TC_OK);
        assert_int_equal(made_folder_count(), 0); /* it has no name */
        uint8_t *all = calloc(W * H, size), *part = malloc((size_t)W * (H + 9) * 2 * size);
        assert_non_null(part);
        test_random r = {size};
        for (int n = 0; n < 300; n++) {
            tc_rect rect = {test_random_int(&r, 0, W), test_random_int(&r, 0, H), 0, 0};
            rect.x1 = test_random_int(&r, rect.x0, W), rect.y1 = test_random_int(&r, rect.y0, H);
            if (n % 5 == 0)
                rect.x0 = 0, rect.x1 = W;
            ptrdiff_t stride = n % 5 == 0 && n % 2 ? W : rect.x1 - rect.x0 + n % 7;
            size_t row = (size_t)(rect.x1 - rect.x0) * size;
            if (n % 2) {
                for (size_t i = 0; i < (size_t)W * (H + 9) * 2 * size; i++)
                    part[i] = (uint8_t)test_random_bits(&r);
                assert_int_equal(tc_spool_write(&s, rect, part, stride, &error), TC_OK);
                for (int64_t y = rect.y0; y < rect.y1; y++)
                    memcpy(all + (size_t)(y * W + rect.x0) * size, part + (size_t)((y - rect.y0) * stride) * size, row);
            } else {
                assert_int_equal(tc_spool_read(&s, rect, part, stride, &error), TC_OK);
                for (int64_t y = rect.y0; y < rect.y1; y++)
                    assert_memory_equal(all + (size_t)(y * W + rect.x0) * size,
                                        part + (size_t)((y - rect.y0) * stride) * size, row);
            }
        }
        free(all), free(part);
        tc_spool_close(&s);
        assert_int_equal(s.file, -1);
        tc_spool_close(&s); /* does nothing */
    }
    tc_spool s = TC_SPOOL_NONE;
    tc_error error = {TC_OK, ""};
    assert_int_equal(tc_spool_create("/no/such/folder/a", 3, 3, 4, &s, &error), TC_ERR_IO);
    assert_true(s.file == -1 && error.text[0]);
    made_folder_remove();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_used_stay),
        cmocka_unit_test(pinned_blocks_stay),
        cmocka_unit_test(threads_share_blocks),
        cmocka_unit_test(spools_hold_rectangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
