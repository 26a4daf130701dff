/* test_rans.c - tables and streams of the entropy coder. */
#include "tests/support/test.h"

#include "common/codec/entropy/rans.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/terrains.h"

static void frequencies_follow_weights(void **state)
{
    (void)state;
    test_random r = {1};
    for (int k = 0; k < 2000; k++) {
        uint64_t w[TC_RANS_SYMBOLS];
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            w[s] = test_random_bits(&r) >> test_random_int(&r, 0, 63) >> (k % 2 ? 0 : 20);
        if (k == 0)
            memset(w, 0, sizeof w);
        if (k == 1)
            memset(w, 0, sizeof w), w[3] = UINT64_MAX;
        tc_rans_frequencies f = tc_rans_normalise(w);
        assert_true(tc_rans_valid(&f));
        for (int s = 0; s + 1 < TC_RANS_SYMBOLS; s++)
            if (w[s] / 2 > w[s + 1] && f.of[s] < f.of[s + 1])
                fail_msg("weights %llu and %llu gave %d and %d", (unsigned long long)w[s], (unsigned long long)w[s + 1],
                         f.of[s], f.of[s + 1]);
    }
    tc_rans_frequencies f = {{0}};
    assert_false(tc_rans_valid(&f));
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        f.of[s] = 256;
    assert_true(tc_rans_valid(&f));
    f.of[5]++;
    assert_false(tc_rans_valid(&f));
}

enum { MOST = 5000 };

/* A stream of random symbols under two tables; returns its size. */
static size_t make_stream(test_random *r, int lanes, int count, uint8_t *symbols, tc_rans_frequencies f[2],
                          uint8_t *bytes, const uint8_t payload[TC_RANS_PAYLOAD])
{
    for (int t = 0; t < 2; t++) {
        uint64_t w[TC_RANS_SYMBOLS];
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            w[s] = (uint64_t)1 << test_random_int(r, 0, 20);
        f[t] = tc_rans_normalise(w);
    }
    for (int k = 0; k < count; k++) {
        int64_t slot = test_random_int(r, 0, TC_RANS_SLOTS - 1);
        symbols[k] = 0;
        while (slot >= f[k % 2].of[symbols[k]])
            slot -= f[k % 2].of[symbols[k]++];
    }
    uint8_t *end = bytes + tc_rans_bound(MOST);
    tc_rans_encoder e;
    tc_rans_encode_begin(&e, lanes, bytes, end, payload);
    tc_rans_symbol put[2][TC_RANS_SYMBOLS];
    tc_rans_symbols_build(&f[0], put[0]), tc_rans_symbols_build(&f[1], put[1]);
    for (int k = count - 1; k >= 0; k--)
        tc_rans_put(&put[k % 2][symbols[k]], &e.state[k % lanes], &e.at);
    tc_rans_encode_end(&e);
    size_t size = (size_t)(end - e.at);
    assert_true(size <= tc_rans_bound((size_t)count));
    memmove(bytes, e.at, size);
    return size;
}

/* The reciprocals divide exactly, up to the largest states. */
static void reciprocals_divide(void **state)
{
    (void)state;
    test_random r = {4};
    for (uint32_t f = 1; f <= TC_RANS_SLOTS - TC_RANS_SYMBOLS + 1; f++) {
        tc_rans_frequencies all = {{(uint16_t)f}};
        for (int s = 1; s < TC_RANS_SYMBOLS; s++)
            all.of[s] = 1;
        tc_rans_symbol put[TC_RANS_SYMBOLS];
        tc_rans_symbols_build(&all, put);
        for (int k = 0; k < 40; k++) {
            uint32_t most = (uint32_t)(((uint64_t)f << 20) - 1), near = most / f - (uint32_t)(k / 4);
            uint32_t x = k < 8 ? near * f + (k % 4 ? (uint32_t)k % 4 - 2 : 0) : (uint32_t)(test_random_bits(&r) % most);
            if (x > most)
                x = most;
            uint8_t bytes[8], *at = bytes + 4;
            uint32_t after = x;
            tc_rans_put(&put[0], &after, &at);
            assert_true(at == bytes + 4 && after == (x / f << TC_RANS_BITS) + x % f);
        }
    }
}

static void streams_come_back(void **state)
{
    (void)state;
    test_random r = {2};
    uint8_t *bytes = malloc(tc_rans_bound(MOST)), symbols[MOST], payload[TC_RANS_PAYLOAD], back[TC_RANS_PAYLOAD];
    tc_rans_table *table = malloc(2 * sizeof *table);
    assert_true(bytes && table);
    for (int k = 0; k < 300; k++) {
        int count = (int)test_random_int(&r, 0, k % 3 ? 40 : MOST), lanes = 4 << k % 3;
        for (int i = 0; i < TC_RANS_PAYLOAD; i++)
            payload[i] = (uint8_t)test_random_bits(&r);
        tc_rans_frequencies f[2];
        size_t size = make_stream(&r, lanes, count, symbols, f, bytes, payload);
        tc_rans_table_build(&f[0], &table[0]), tc_rans_table_build(&f[1], &table[1]);
        tc_rans_decoder d;
        assert_true(tc_rans_decode_begin(&d, lanes, bytes, size));
        double bits = 0;
        for (int i = 0; i < count; i++) {
            assert_int_equal(tc_rans_decode(&d, i % lanes, &table[i % 2]), symbols[i]);
            bits -= log2(f[i % 2].of[symbols[i]] / (double)TC_RANS_SLOTS);
        }
        assert_true(d.at == bytes + size);
        assert_true(tc_rans_decode_end(&d, back));
        assert_memory_equal(back, payload, 2 * (size_t)lanes);
        assert_true((double)size * 8 <= bits * 1.001 + 8 * TC_RANS_HEAD);
        /* Cut and flipped streams end somewhere, and are mostly seen to be damaged. */
        size_t cut = (size_t)test_random_int(&r, 0, (int64_t)size - 1);
        if (tc_rans_decode_begin(&d, lanes, bytes, cut)) {
            for (int i = 0; i < count; i++)
                tc_rans_decode(&d, i % lanes, &table[i % 2]);
            assert_false(tc_rans_decode_end(&d, back));
        }
        bytes[cut] ^= (uint8_t)(1 << k % 8);
        if (tc_rans_decode_begin(&d, lanes, bytes, size))
            for (int i = 0; i < count; i++)
                tc_rans_decode(&d, i % lanes, &table[i % 2]);
    }
    free(bytes), free(table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(frequencies_follow_weights),
                                       cmocka_unit_test(reciprocals_divide), cmocka_unit_test(streams_come_back)};
    return cmocka_run_group_tests_name("rans", tests, NULL, NULL);
}
