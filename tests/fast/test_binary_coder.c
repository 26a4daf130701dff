/* test_binary_coder.c - what the adaptive range coder writes, it reads back; lengths are near the entropy. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/codec/entropy/binary_coder.h"

static uint32_t next(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*seed >> 32);
}

enum { ROOM = 1 << 16 };

/* One random script of bits, raw bits and numbers; returns the bytes. */
static size_t script(uint64_t seed, int length, uint8_t *bytes, size_t room, bool write, size_t size)
{
    tc_bit_encoder e;
    tc_bit_decoder d;
    tc_bit_model model[3];
    tc_number_model number;
    tc_bit_models_reset(model, 3), tc_number_reset(&number);
    if (write)
        tc_bit_encode_begin(&e, bytes, room);
    else
        tc_bit_decode_begin(&d, bytes, size);
    for (int i = 0; i < length; i++) {
        uint32_t what = next(&seed) % 4, r = next(&seed);
        if (what < 2) {
            int m = (int)(r % 3), bit = (r >> 8) % 64 < (m == 0 ? 1u : m == 1 ? 32u : 63u);
            if (write)
                tc_bit_encode(&e, &model[m], bit);
            else
                assert_int_equal(tc_bit_decode(&d, &model[m]), bit);
        } else if (what == 2) {
            int count = (int)(r % 33);
            uint32_t value = count == 32 ? r : r & (uint32_t)(((uint64_t)1 << count) - 1);
            if (write)
                tc_bit_encode_raw(&e, value, count);
            else
                assert_int_equal(tc_bit_decode_raw(&d, count), value);
        } else {
            uint32_t value = (uint32_t)(((uint64_t)r * 2654435761u & UINT32_MAX) >> r % 32);
            value = value == UINT32_MAX ? 0 : value;
            if (write)
                tc_number_encode(&e, &number, value);
            else
                assert_int_equal(tc_number_decode(&d, &number), value);
        }
    }
    if (write)
        return tc_bit_encode_end(&e);
    assert_true(tc_bit_decode_end(&d));
    return size;
}

static void reads_back(void **state)
{
    (void)state;
    uint8_t *bytes = malloc(ROOM);
    for (int n = 0; n < 3000; n++) {
        int length = n % 400;
        memset(bytes, 0xaa, ROOM);
        size_t size = script((uint64_t)n, length, bytes, ROOM, true, 0);
        script((uint64_t)n, length, bytes, ROOM, false, size);
        if (size > 0) { /* exactly enough room; then too little */
            assert_int_equal(script((uint64_t)n, length, bytes, size + 5, true, 0), size);
            uint8_t *tight = malloc(size);
            tc_bit_encoder e;
            tc_bit_encode_begin(&e, tight, size - 1);
            for (size_t i = 0; i < size + 8; i++)
                tc_bit_encode_raw(&e, 0xa5, 8);
            assert_int_equal(tc_bit_encode_end(&e), 0);
            assert_true(e.full);
            free(tight);
        }
    }
    free(bytes);
}

static void carries_run_through(void **state)
{
    (void)state;
    uint8_t bytes[4096];
    tc_bit_encoder e;
    tc_bit_encode_begin(&e, bytes, sizeof bytes);
    /* A long run of 0xff that a carry at the end turns over. */
    for (int i = 0; i < 1000; i++)
        tc_bit_encode_raw(&e, 0xff, 8);
    tc_bit_model model = 31;
    for (int i = 0; i < 200; i++)
        tc_bit_encode(&e, &model, 1);
    size_t size = tc_bit_encode_end(&e);
    tc_bit_decoder d;
    tc_bit_decode_begin(&d, bytes, size);
    for (int i = 0; i < 1000; i++)
        assert_int_equal(tc_bit_decode_raw(&d, 8), 0xff);
    model = 31;
    for (int i = 0; i < 200; i++)
        assert_int_equal(tc_bit_decode(&d, &model), 1);
}

static void is_near_the_entropy(void **state)
{
    (void)state;
    static uint8_t bytes[ROOM];
    uint64_t seed = 1;
    double entropy = 0;
    tc_bit_model model = TC_BIT_EVEN;
    tc_bit_encoder e;
    tc_bit_encode_begin(&e, bytes, sizeof bytes);
    for (int i = 0; i < 100000; i++) {
        int bit = next(&seed) % 16 == 0;
        entropy += bit ? 4 : log2(16. / 15);
        tc_bit_encode(&e, &model, bit);
    }
    double bits = 8. * (double)tc_bit_encode_end(&e);
    assert_true(bits < 1.06 * entropy);
    assert_true(bits > 0.98 * entropy);
}

static void damage_is_harmless(void **state)
{
    (void)state;
    uint64_t seed = 7;
    uint8_t bytes[64];
    for (int n = 0; n < 2000; n++) {
        size_t size = next(&seed) % sizeof bytes;
        for (size_t i = 0; i < size; i++)
            bytes[i] = (uint8_t)next(&seed);
        tc_bit_decoder d;
        tc_number_model number;
        tc_number_reset(&number);
        tc_bit_decode_begin(&d, bytes, size);
        for (int i = 0; i < 300; i++)
            (void)tc_number_decode(&d, &number);
        assert_true(d.at <= d.end);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_back),
        cmocka_unit_test(carries_run_through),
        cmocka_unit_test(is_near_the_entropy),
        cmocka_unit_test(damage_is_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
