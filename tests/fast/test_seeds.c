/* test_seeds.c - the fuzzers' seeds (tests/fuzz/corpus) as they are, cut short and with bytes changed, given to the
 * fuzzers: what they expect holds, whether or not there is a compiler here that comes with libFuzzer. */
#include "tests/support/test.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/packing.h"
#include "tests/support/terrains.h"

/* LLVMFuzzerTestOneInput() of either (Makefile). */
int fuzz_reader(const uint8_t *data, size_t size);
int fuzz_tile_decoders(const uint8_t *data, size_t size);

/* From memory of exactly that size. */
static void give(int (*fuzzer)(const uint8_t *, size_t), const uint8_t *bytes, size_t size)
{
    uint8_t *copy = malloc(size);
    assert_true(copy || size == 0);
    if (size > 0)
        memcpy(copy, bytes, size);
    fuzzer(copy, size);
    free(copy);
}

static void replay(const char *folder, int (*fuzzer)(const uint8_t *, size_t), int least)
{
    enum { ROUNDS = 6 };
    DIR *d = opendir(folder);
    assert_non_null(d);
    test_random r = {11};
    int seeds = 0;
    for (const struct dirent *entry; (entry = readdir(d));) {
        char path[512];
        size_t size;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        uint8_t *bytes = packing_bytes(path, &size);
        assert_non_null(bytes);
        give(fuzzer, bytes, size);
        for (int round = 0; round < ROUNDS; round++) {
            give(fuzzer, bytes, (size_t)test_random_int(&r, 0, (int64_t)size - 1));
            bytes[test_random_int(&r, 0, (int64_t)size - 1)] ^= (uint8_t)test_random_int(&r, 1, 255);
            give(fuzzer, bytes, size);
        }
        free(bytes);
        seeds++;
    }
    closedir(d);
    assert_true(seeds >= least);
}

static void files(void **state)
{
    (void)state;
    replay("tests/fuzz/corpus/reader", fuzz_reader, 30);
}

static void parts(void **state)
{
    (void)state;
    replay("tests/fuzz/corpus/tile", fuzz_tile_decoders, 45);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files),
        cmocka_unit_test(parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
