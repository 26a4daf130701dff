/* test_reading_ahead.c - a packed terrain that is asked whether it is ready gets ready, whatever its coder and cache;
 * and bytes that cannot be had for a while leave nothing wrong behind. */
#include "tests/support/test.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/field/field.h"
#include "tests/support/terrains.h"

enum { WIDTH = 900, HEIGHT = 700 };

/* Hills in whole metres, packed; the file's bytes. */
static uint8_t *pack(const tc_pack_options *how, bool wraps, size_t *size_ret)
{
    char path[] = "/tmp/terraclip-ahead-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    float *z = malloc(sizeof *z * WIDTH * HEIGHT);
    test_random random = {7};
    for (int64_t j = 0; j < HEIGHT; j++)
        for (int64_t i = 0; i < WIDTH; i++)
            z[j * WIDTH + i] =
                (float)rint(900 * sin((double)i / 90) * cos((double)j / 70) + (double)test_random_int(&random, 0, 9));
    tc_pack_terrain about = {
        .width = WIDTH, .height = HEIGHT, .spacing_x = 30, .spacing_y = 30, .sample_type = TC_SAMPLE_INT16, .unit = 1};
    about.wraps_x = wraps;
    tc_packer *packer;
    tc_pack_result result;
    assert_int_equal(tc_packer_create(path, &about, how, &packer, NULL), TC_OK);
    assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, z, NULL, WIDTH, NULL), TC_OK);
    assert_int_equal(tc_packer_finish(packer, &result, NULL), TC_OK);
    tc_packer_destroy(packer);
    free(z);
    close(file);
    file = open(path, O_RDONLY);
    unlink(path);
    uint8_t *bytes = malloc((size_t)result.bytes);
    assert_int_equal(read(file, bytes, (size_t)result.bytes), result.bytes);
    close(file);
    *size_ret = (size_t)result.bytes;
    return bytes;
}

/* Bytes in memory that fail to be read while `broken`. */
typedef struct memory {
    const uint8_t *bytes;
    _Atomic bool broken;
} memory;

static tc_status read_memory(void *context, int64_t offset, void *to, size_t size)
{
    memory *m = context;
    if (m->broken)
        return TC_ERR_IO;
    memcpy(to, m->bytes + offset, size);
    return TC_OK;
}

static tc_field *open_memory(memory *m, size_t size, size_t cache)
{
    tc_byte_source source = {m, (int64_t)size, read_memory, NULL};
    tc_open_options options = {.cache_bytes = cache};
    tc_field *field;
    assert_int_equal(tc_field_open_bytes("memory", &source, &options, &field, NULL), TC_OK);
    return field;
}

static const tc_pack_options ways[] = {
    {.mode = TC_PACK_RMS, .error = 1},
    {.mode = TC_PACK_MAX_ERROR, .error = 3},
    {.mode = TC_PACK_LOSSLESS},
    {.mode = TC_PACK_RMS, .codec = TC_CODEC_LH04, .error = 1},
};
enum { WAYS = sizeof ways / sizeof *ways };

/* Files are packed once. */
typedef struct packed {
    uint8_t *bytes;
    size_t size;
} packed;
static packed files[2][WAYS];

static const packed *packed_file(int way, bool wraps)
{
    packed *f = &files[wraps][way];
    if (!f->bytes)
        f->bytes = pack(&ways[way], wraps, &f->size);
    return f;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < 2 * WAYS; k++)
        free(files[k / WAYS][k % WAYS].bytes);
    return 0;
}

static void gets_ready(void **state)
{
    (void)state;
    test_random random = {3};
    for (int way = 0; way < 4 * WAYS; way++) {
        bool wraps = way >= 2 * WAYS;
        const packed *file = packed_file(way / 2 % WAYS, wraps);
        memory m = {file->bytes, false};
        tc_field *p = open_memory(&m, file->size, way % 2 ? 1 : 0);
        int levels = tc_field_info(p)->levels;
        for (int n = 0; n < (wraps ? 6 : 24); n++) {
            int l = (int)test_random_int(&random, levels - 2, levels);
            tc_level level = tc_field_level(p, l);
            tc_rect r = {0, 0, level.width, level.height};
            if (n > 0) { /* else the whole level */
                r.x0 = test_random_int(&random, 0, level.width - 1),
                r.y0 = test_random_int(&random, 0, level.height - 1);
                r.x1 = test_random_int(&random, r.x0, level.width - 1) + 1;
                r.y1 = test_random_int(&random, r.y0, level.height - 1) + 1;
            }
            if (wraps) /* mostly across the seam */
                r.x0 -= level.width / 2, r.x1 -= level.width / 2;
            int polls = 0;
            while (tc_field_ready(p, l, r, TC_SOON) != TC_READY && polls++ < 5000)
                usleep(1000);
            if (polls >= 5000)
                printf("way %d: level %d, %lld..%lld x %lld..%lld is never ready\n", way, l, (long long)r.x0,
                       (long long)r.x1, (long long)r.y0, (long long)r.y1);
            assert_true(polls < 5000);
        }
        assert_int_equal(tc_field_tell(p).damaged, 0);
        tc_field_destroy(p);
    }
}

static void what_fails_may_come_later(void **state)
{
    (void)state;
    static float truth[WIDTH * HEIGHT], z[WIDTH * HEIGHT];
    for (int way = 0; way < WAYS; way++) {
        const packed *file = packed_file(way, false);
        memory m = {file->bytes, false};
        tc_field *p = open_memory(&m, file->size, 0);
        int l = tc_field_info(p)->levels;
        tc_rect all = {0, 0, WIDTH, HEIGHT};
        assert_int_equal(tc_field_read(p, l, all, truth, NULL, WIDTH), TC_OK);
        tc_field_destroy(p);
        p = open_memory(&m, file->size, 0);
        m.broken = true;
        assert_int_equal(tc_field_read(p, l, (tc_rect){0, 0, 300, 300}, z, NULL, WIDTH), TC_ERR_IO);
        m.broken = false;
        assert_int_equal(tc_field_read(p, l, (tc_rect){0, 0, 300, 300}, z, NULL, WIDTH), TC_OK);
        m.broken = true;
        assert_int_equal(tc_field_read(p, l, all, z, NULL, WIDTH), TC_ERR_IO);
        m.broken = false;
        assert_int_equal(tc_field_read(p, l, all, z, NULL, WIDTH), TC_OK);
        assert_memory_equal(z, truth, sizeof z);
        assert_int_equal(tc_field_tell(p).damaged, 0);
        tc_field_destroy(p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(gets_ready), cmocka_unit_test(what_fails_may_come_later)};
    return cmocka_run_group_tests(tests, NULL, tear_down);
}
