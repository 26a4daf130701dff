/* test_exact.c - exact levels and corrections come back as they were, whatever the terrain; damage does no harm. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/lifting/codec_correction.h"
#include "common/codec/exact/codec_exact.h"
#include "tests/support/packed.h"
#include "tests/support/terrains.h"

typedef enum kind { NOISE, CLIFFS, CONSTANT, RAMP, EXTREMES, HILLS, SPARSE, KINDS } kind;

/* Heights in steps. */
static int32_t height(kind what, int64_t x, int64_t y, int32_t most, test_random *r)
{
    switch (what) {
    case NOISE: return (int32_t)test_random_int(r, -most, most);
    case CLIFFS: return ((x / 7 + y / 5) & 1 ? most : -most) / 3 + (int32_t)test_random_int(r, -2, 2);
    case CONSTANT: return most / 5;
    case RAMP: return (int32_t)tc_clamp64(3 * x - 2 * y, -most, most);
    case EXTREMES: return test_random_int(r, 0, 1) ? most : -most;
    case SPARSE:
        return (int32_t)tc_clamp64(lrint(20 * sin(0.05 * (double)x)) * 37 + lrint(30 * cos(0.03 * (double)y)) * 37,
                                   -most, most);
    default:
        return (int32_t)lrint(0.001 * most * sin(0.05 * (double)x) * cos(0.07 * (double)y)) +
               (int32_t)test_random_int(r, -1, 1);
    }
}

/* A level and its coarser one, which is as true as `error` says. */
typedef struct example {
    tc_lifting_level level;
    tc_plane fine, coarse; /* coarse with the other side's columns where the level wraps */
} example;

static example make(kind what, int64_t w, int64_t h, int32_t step, bool wrap, int32_t error, uint64_t seed)
{
    test_random r = {seed};
    example e = {.level = {w, h, wrap}, .fine = packed_plane((tc_rect){0, 0, w, h})};
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++)
            *tc_plane_at(&e.fine, x, y) = step * height(what, x, y, TC_LIFTING_LIMIT / step, &r);
    int64_t cw = tc_coarse_size(w), ch = tc_coarse_size(h), side = wrap ? TC_TILE_MARGIN : 0;
    e.coarse = packed_plane((tc_rect){-side, 0, cw + side, ch});
    for (int64_t y = 0; y < ch; y++)
        for (int64_t x = -side; x < cw + side; x++)
            *tc_plane_at(&e.coarse, x, y) = *tc_plane_at(&e.fine, 2 * ((x + 5 * cw) % cw), 2 * y);
    for (int64_t y = 0; y < ch; y++)
        for (int64_t x = -side; x < cw + side && error; x++)
            *tc_plane_at(&e.coarse, x, y) += (int32_t)test_random_int(&r, -error, error);
    for (int64_t y = 0; y < ch && wrap; y++)
        for (int64_t x = -side; x < 0; x++) {
            *tc_plane_at(&e.coarse, x, y) = *tc_plane_at(&e.coarse, x + cw, y);
            *tc_plane_at(&e.coarse, cw - 1 - x, y) = *tc_plane_at(&e.coarse, -1 - x, y);
        }
    return e;
}

static void unmake(example *e)
{
    free(e->fine.z), free(e->coarse.z);
}

/* Trains on at most `count` tiles, and takes the model through its header. */
static tc_exact *trained(const example *e, int32_t step, int count, size_t *header_size)
{
    tc_exact *codec = malloc(sizeof *codec);
    tc_exact_model model = {.step = step};
    tc_exact_init(codec, &e->level, &model);
    tc_exact_tile tile[16];
    int tiles = (int)tc_min64(codec->tiles_x * codec->tiles_y, count);
    for (int i = 0; i < tiles; i++)
        tile[i] = (tc_exact_tile){i % codec->tiles_x, i / codec->tiles_x, e->coarse, e->fine};
    assert_int_equal(tc_exact_train(&e->level, tile, tiles, step, 2, &model), TC_OK);
    uint8_t *header = malloc(tc_exact_model_bound());
    size_t size = tc_exact_model_write(&model, header);
    assert_true(size <= tc_exact_model_bound());
    tc_exact_model back;
    assert_int_equal(tc_exact_model_read(header, size, &back), TC_OK);
    assert_memory_equal(&back, &model, sizeof model);
    if (header_size)
        *header_size = size;
    tc_exact_init(codec, &e->level, &back);
    free(header);
    return codec;
}

/* Bytes of all tiles; every one decodes from a copy of exactly its bytes. */
static size_t round_trip(const tc_exact *c, const example *e)
{
    tc_exact_work *work = malloc(tc_exact_work_bytes());
    uint8_t *bytes = malloc(tc_exact_tile_bound());
    size_t all = 0;
    for (int64_t t = 0; t < c->tiles_x * c->tiles_y; t++) {
        int64_t tx = t % c->tiles_x, ty = t / c->tiles_x;
        tc_rect r = tc_exact_tile_rect(c, tx, ty);
        size_t size;
        assert_int_equal(tc_exact_encode_tile(c, tx, ty, &e->coarse, &e->fine, bytes, &size, work), TC_OK);
        assert_true(size <= tc_exact_tile_bound());
        uint8_t *copy = malloc(size + 1);
        memcpy(copy, bytes, size);
        tc_plane out = packed_plane(r);
        memset(work, 0xa5, tc_exact_work_bytes());
        assert_int_equal(tc_exact_decode_tile(c, tx, ty, copy, size, &e->coarse, &out, work), TC_OK);
        for (int64_t y = r.y0; y < r.y1; y++)
            assert_memory_equal(tc_plane_at(&out, r.x0, y), tc_plane_at(&e->fine, r.x0, y),
                                (size_t)(r.x1 - r.x0) * sizeof(int32_t));
        free(copy), free(out.z);
        all += size;
    }
    free(work), free(bytes);
    return all;
}

static void every_kind_of_terrain(void **state)
{
    (void)state;
    static const int32_t steps[] = {1, 3, 64, 1000, TC_MAX_STEP / 4};
    for (int what = 0; what < KINDS; what++)
        for (size_t s = 0; s < sizeof steps / sizeof *steps; s++) {
            example e = make((kind)what, 150, 140, steps[s], false, steps[s] / 2, 1);
            tc_exact *c = trained(&e, steps[s], 4, NULL);
            round_trip(c, &e);
            free(c), unmake(&e);
        }
}

static void every_size(void **state)
{
    (void)state;
    static const int64_t sizes[] = {1, 2, 3, 4, 5, 7, 8, 63, 64, 65, 127, 128, 129, 130, 131, 255, 256, 257, 300};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int n = 0; n < 3; n++) {
            int64_t w = sizes[i], h = n == 0 ? 1 : n == 1 ? 37 : sizes[(i * 7 + 3) % 19];
            example e = make(HILLS, n == 2 ? h : w, n == 2 ? w : h, 4, false, 5, i);
            tc_exact *c = trained(&e, 4, (int)(i % 3), NULL);
            round_trip(c, &e);
            free(c), unmake(&e);
        }
}

static void levels_that_wrap(void **state)
{
    (void)state;
    static const int64_t widths[] = {10, 64, 128, 130, 254, 258, 300};
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        example e = make(HILLS, widths[i], 70, 2, true, 3, i);
        tc_exact *c = trained(&e, 2, 4, NULL);
        round_trip(c, &e);
        free(c), unmake(&e);
    }
}

static void a_coarser_level_that_is_nonsense(void **state)
{
    (void)state;
    example e = make(HILLS, 130, 60, 1, false, 0, 5);
    test_random r = {7};
    tc_exact *c = trained(&e, 1, 1, NULL);
    for (int64_t i = 0; i < tc_rect_area(e.coarse.rect); i++)
        e.coarse.z[i] = (int32_t)test_random_bits(&r);
    round_trip(c, &e);
    free(c), unmake(&e);
}

static void heights_that_are_no_multiples(void **state)
{
    (void)state;
    example e = make(CONSTANT, 20, 20, 4, false, 0, 5);
    tc_exact *c = trained(&e, 4, 1, NULL);
    tc_exact_work *work = malloc(tc_exact_work_bytes());
    uint8_t *bytes = malloc(tc_exact_tile_bound());
    size_t size;
    e.fine.z[33]++;
    assert_int_equal(tc_exact_encode_tile(c, 0, 0, &e.coarse, &e.fine, bytes, &size, work), TC_ERR_USAGE);
    e.fine.z[33] = 2 * TC_LIFTING_LIMIT;
    assert_int_equal(tc_exact_encode_tile(c, 0, 0, &e.coarse, &e.fine, bytes, &size, work), TC_ERR_USAGE);
    free(work), free(bytes), free(c), unmake(&e);
}

/* Smooth terrain takes next to nothing; noise takes what it must. */
static void sizes_of_streams(void **state)
{
    (void)state;
    example e = make(CONSTANT, 256, 256, 1, false, 0, 1);
    size_t header;
    tc_exact *c = trained(&e, 1, 4, &header);
    assert_in_range(round_trip(c, &e), 0, 64);
    assert_in_range(header, 1, 600);
    free(c), unmake(&e);
    e = make(RAMP, 256, 256, 1, false, 0, 1);
    c = trained(&e, 1, 4, NULL);
    assert_in_range(round_trip(c, &e), 0, 400);
    free(c), unmake(&e);
    /* Few values, far apart: little more than if their distance were the step. */
    e = make(SPARSE, 256, 256, 1, false, 0, 1);
    c = trained(&e, 1, 4, NULL);
    size_t sparse = round_trip(c, &e);
    free(c);
    for (int64_t i = 0; i < tc_rect_area(e.fine.rect); i++)
        e.fine.z[i] /= 37;
    for (int64_t i = 0; i < tc_rect_area(e.coarse.rect); i++)
        e.coarse.z[i] /= 37;
    c = trained(&e, 1, 4, NULL);
    assert_in_range(sparse, 1, round_trip(c, &e) * 3 / 2 + 400);
    free(c), unmake(&e);
    e = make(NOISE, 256, 256, TC_LIFTING_LIMIT / 100, false, 0, 1);
    c = trained(&e, TC_LIFTING_LIMIT / 100, 4, NULL);
    size_t entropy = (size_t)(256 * 256 * log2(201) / 8);
    assert_in_range(round_trip(c, &e), entropy / 2, entropy * 21 / 20);
    free(c), unmake(&e);
}

/* Noise is kept as it is, in as many bits as its range takes; what no writer makes is refused. */
static void raw_tiles(void **state)
{
    (void)state;
    static const int32_t steps[] = {1, 4, 257};
    static const int bits[] = {24, 22, 16};
    for (int n = 0; n < 3; n++) {
        example e = make(NOISE, 130, 128, steps[n], false, TC_LIFTING_LIMIT, 1);
        tc_exact *c = trained(&e, steps[n], 1, NULL);
        tc_exact_work *work = malloc(tc_exact_work_bytes());
        uint8_t *bytes = malloc(tc_exact_tile_bound());
        tc_plane out = packed_plane(e.fine.rect);
        size_t size;
        assert_true(round_trip(c, &e) <= (size_t)(130 * 128 * bits[n] / 8 + 2 * 5));
        assert_int_equal(tc_exact_encode_tile(c, 0, 0, &e.coarse, &e.fine, bytes, &size, work), TC_OK);
        assert_true(tc_exact_is_raw(bytes, size));
        uint8_t *copy = malloc(size + 128 * 128);
        for (size_t length = 0; length < size + 128 * 128; length += length < 9 || length + 9 > size ? 1 : 997) {
            memset(copy, 0, size + 128 * 128);
            memcpy(copy, bytes, length < size ? length : size);
            tc_status status = tc_exact_decode_tile(c, 0, 0, copy, length, &e.coarse, &out, work);
            if (length == size || (length + 128 * 2048 - size) % 2048) /* else samples of another width */
                assert_int_equal(status, length == size ? TC_OK : TC_ERR_FORMAT);
        }
        for (int mark = 0; mark < 256; mark++) { /* all but its own are other tiles', or nobody's */
            memcpy(copy, bytes, size);
            copy[0] = (uint8_t)mark;
            tc_status status = tc_exact_decode_tile(c, 0, 0, copy, size, &e.coarse, &out, work);
            assert_true(status == TC_ERR_FORMAT || mark == bytes[0] || mark > 7);
        }
        /* A lowest sample beyond the limits, whose others are too. */
        memcpy(copy, bytes, size);
        copy[bytes[0]] = 0x7f;
        assert_int_equal(tc_exact_decode_tile(c, 0, 0, copy, size, &e.coarse, &out, work), TC_ERR_FORMAT);
        free(copy), free(out.z), free(bytes), free(work), free(c), unmake(&e);
    }
}

static void damaged_tiles(void **state)
{
    (void)state;
    for (int n = 0; n < 4; n++) {
        kind what = n == 0 ? HILLS : n == 1 ? CLIFFS : n == 2 ? NOISE : SPARSE;
        example e = make(what, 140, 50, n == 1 ? 1 : 1 + 100 * n, false, 2, 3);
        tc_exact *c = trained(&e, n == 1 ? 1 : 1 + 100 * n, 1, NULL);
        tc_exact_work *work = malloc(tc_exact_work_bytes());
        uint8_t *bytes = malloc(tc_exact_tile_bound());
        tc_plane out = packed_plane(e.fine.rect);
        size_t size;
        test_random r = {n + 1};
        assert_int_equal(tc_exact_encode_tile(c, 0, 0, &e.coarse, &e.fine, bytes, &size, work), TC_OK);
        for (int round = 0; round < 150; round++) {
            size_t length = round % 3 == 0 ? (size_t)test_random_int(&r, 0, (int64_t)size) : size;
            uint8_t *copy = malloc(length + 1);
            memcpy(copy, bytes, length);
            for (int64_t k = test_random_int(&r, 1, round % 5 ? 3 : 200); k > 0 && length && round % 3; k--)
                copy[test_random_int(&r, 0, (int64_t)length - 1)] = (uint8_t)test_random_bits(&r);
            tc_status status = tc_exact_decode_tile(c, 0, 0, copy, length, &e.coarse, &out, work);
            assert_true(status == TC_OK || status == TC_ERR_FORMAT);
            free(copy);
        }
        /* Bytes too many are seen. */
        bytes[size] = 0;
        assert_int_equal(tc_exact_decode_tile(c, 0, 0, bytes, size + 1, &e.coarse, &out, work), TC_ERR_FORMAT);
        memset(bytes + size, 1, 8);
        assert_int_equal(tc_exact_decode_tile(c, 0, 0, bytes, size + 8, &e.coarse, &out, work), TC_ERR_FORMAT);
        free(out.z), free(bytes), free(work), free(c), unmake(&e);
    }
}

/* Whatever header is taken, tiles decode to something. */
static void damaged_headers(void **state)
{
    (void)state;
    example e = make(HILLS, 130, 40, 3, false, 2, 3);
    tc_exact *c = trained(&e, 3, 2, NULL);
    tc_exact_work *work = malloc(tc_exact_work_bytes());
    uint8_t *header = malloc(tc_exact_model_bound()), noise[3000];
    tc_plane out = packed_plane(e.fine.rect);
    size_t size = tc_exact_model_write(&c->model, header);
    test_random r = {9};
    int taken = 0;
    for (size_t i = 0; i < sizeof noise; i++)
        noise[i] = (uint8_t)test_random_bits(&r);
    for (int round = 0; round < 400; round++) {
        size_t length = round % 2 ? size : (size_t)test_random_int(&r, 0, (int64_t)size);
        uint8_t *copy = malloc(length + 1);
        memcpy(copy, header, length);
        for (int64_t k = test_random_int(&r, 0, 4); k > 0 && length; k--)
            copy[test_random_int(&r, 0, (int64_t)length - 1)] = (uint8_t)test_random_bits(&r);
        tc_exact_model model;
        tc_status status = tc_exact_model_read(copy, length, &model);
        assert_true(status == TC_OK || status == TC_ERR_FORMAT);
        if (!status) {
            assert_in_range(model.step, 1, TC_MAX_STEP);
            tc_exact_init(c, &e.level, &model);
            status = tc_exact_decode_tile(c, 0, 0, noise, sizeof noise, &e.coarse, &out, work);
            assert_true(status == TC_OK || status == TC_ERR_FORMAT);
            taken++;
        }
        free(copy);
    }
    assert_true(taken > 0);
    memset(header + size, 1, 8);
    tc_exact_model model;
    assert_int_equal(tc_exact_model_read(header, size + 8, &model), TC_ERR_FORMAT);
    free(out.z), free(header), free(work), free(c), unmake(&e);
}

/* ---- Corrections --------------------------------------------------------------------------------------------- */

static void corrections_come_back(bool by_squares)
{
    tc_correction *c = malloc(sizeof *c);
    tc_correction_init(c, by_squares);
    uint8_t *bytes = malloc(tc_correction_bound());
    const int32_t step[TC_BANDS] = {10, 20, 1};
    for (int round = 0; round < 60; round++) {
        test_random r = {(uint64_t)round + 1};
        int64_t w = round == 0 ? 128 : test_random_int(&r, 1, 128), h = round == 0 ? 128 : test_random_int(&r, 1, 128);
        tc_rect rect = {128, 256, 128 + w, 256 + h}, positions = {64, 128, 64 + (w + 1) / 2, 128 + (h + 1) / 2};
        tc_plane band[TC_BANDS], k = packed_plane(rect), out = packed_plane(rect);
        int32_t most = round % 4 == 0 ? TC_CORRECTION_MOST : 1 + round % 4;
        double share = round < 2 ? 0 : pow(10, -(double)(round % 5));
        size_t some = 0, size;
        for (int b = 0; b < TC_BANDS; b++) {
            band[b] = packed_plane(positions);
            for (int64_t i = 0; i < tc_rect_area(positions); i++)
                band[b].z[i] = (int32_t)test_random_int(&r, round % 7 ? -30 : INT32_MIN, round % 7 ? 30 : INT32_MAX);
        }
        for (int64_t i = 0; i < w * h; i++)
            if (test_random_unit(&r) < share)
                k.z[i] = (int32_t)test_random_int(&r, -most, most), some += k.z[i] != 0;
        assert_int_equal(tc_correction_encode(c, band, step, &k, bytes, tc_correction_bound(), &size), TC_OK);
        assert_true((size == 0) == (some == 0));
        uint8_t *copy = malloc(size + 1);
        memcpy(copy, bytes, size);
        memset(out.z, 0x55, (size_t)(w * h) * sizeof *out.z);
        assert_int_equal(tc_correction_decode(c, band, step, copy, size, &out), TC_OK);
        assert_memory_equal(out.z, k.z, (size_t)(w * h) * sizeof *k.z);
        for (int n = 0; n < 20 && size; n++) {
            memcpy(copy, bytes, size);
            copy[test_random_int(&r, 0, (int64_t)size - 1)] = (uint8_t)test_random_bits(&r);
            size_t length = n % 2 ? size : (size_t)test_random_int(&r, 0, (int64_t)size);
            tc_status status = tc_correction_decode(c, band, step, copy, length, &out);
            assert_true(status == TC_OK || status == TC_ERR_FORMAT);
        }
        k.z[0] = TC_CORRECTION_MOST + 1;
        assert_int_equal(tc_correction_encode(c, band, step, &k, bytes, tc_correction_bound(), &size), TC_ERR_USAGE);
        for (int b = 0; b < TC_BANDS; b++)
            free(band[b].z);
        free(copy), free(k.z), free(out.z);
    }
    free(bytes), free(c);
}

static void corrections(void **state)
{
    (void)state;
    corrections_come_back(false);
}

static void corrections_by_squares(void **state)
{
    (void)state;
    corrections_come_back(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_terrain),
        cmocka_unit_test(every_size),
        cmocka_unit_test(levels_that_wrap),
        cmocka_unit_test(a_coarser_level_that_is_nonsense),
        cmocka_unit_test(heights_that_are_no_multiples),
        cmocka_unit_test(sizes_of_streams),
        cmocka_unit_test(raw_tiles),
        cmocka_unit_test(damaged_tiles),
        cmocka_unit_test(damaged_headers),
        cmocka_unit_test(corrections),
        cmocka_unit_test(corrections_by_squares),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
