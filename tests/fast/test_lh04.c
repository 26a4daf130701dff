/* test_lh04.c - LH04's pyramid of residuals: the same heights from encoder and decoder, from any rectangle and any
 * processor; U is that of the lifting; an error that follows the step; no harm from damaged bytes. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/lh04_packed.h"
#include "tests/support/terrains.h"

enum { KINDS = PACKED_KINDS };

static int32_t *heights(test_random *r, int kind, int64_t w, int64_t h)
{
    return packed_heights(r, kind, w, h, TC_LIFTING_LIMIT);
}

static double rms_of(const tc_plane *p, const int32_t *z)
{
    double sum = 0;
    int64_t count = tc_rect_area(p->rect);
    for (int64_t i = 0; i < count; i++)
        sum += pow((double)p->z[i] - z[i], 2);
    return sqrt(sum / (double)count);
}

static void u_is_the_synthesis_of_nothing(void **state)
{
    (void)state;
    test_random r = {31};
    for (int k = 0; k < 300; k++) {
        int64_t w = test_random_int(&r, 1, k % 3 ? 40 : 700), h = test_random_int(&r, 1, 40);
        bool wrap = k % 4 == 0;
        w += wrap && w % 2;
        tc_lifting_level level = {w, h, wrap};
        int64_t cw = tc_coarse_size(w), ch = tc_coarse_size(h), out = wrap ? w : 0;
        tc_rect rect = {test_random_int(&r, -out, w - 1), test_random_int(&r, 0, h - 1), 0, 0};
        rect.x1 = test_random_int(&r, rect.x0 + 1, w + out), rect.y1 = test_random_int(&r, rect.y0 + 1, h);
        tc_rect need = tc_lifting_needs(&level, rect), less = tc_lh04_needs(&level, rect);
        assert_true(tc_rect_within(less, need));
        tc_plane coarse = packed_plane(need), exact = packed_plane(less), band[TC_BANDS], a = packed_plane(rect),
                 b = packed_plane(rect), residual = packed_plane(rect);
        int32_t *z = malloc((size_t)(cw * ch) * sizeof *z);
        assert_non_null(z);
        int64_t most = k % 2 ? TC_LIFTING_LIMIT : 1000;
        for (int64_t i = 0; i < cw * ch; i++)
            z[i] = (int32_t)test_random_int(&r, -most, most);
        for (int64_t y = need.y0; y < need.y1; y++)
            for (int64_t x = need.x0; x < need.x1; x++) {
                int32_t v = z[y * cw + ((x % cw) + cw) % cw];
                *tc_plane_at(&coarse, x, y) = v;
                if (tc_rect_contains(less, x, y))
                    *tc_plane_at(&exact, x, y) = v;
            }
        for (int n = 0; n < TC_BANDS; n++)
            band[n] = packed_plane(need);
        int32_t *scratch = malloc(tc_lifting_synthesise_scratch(&level, rect) * sizeof *scratch);
        tc_lifting_synthesise(&level, &coarse, band, &a, scratch, TC_SIMD_AUTO);
        tc_lh04_assemble(&level, &exact, NULL, &b);
        assert_memory_equal(a.z, b.z, (size_t)tc_rect_area(rect) * sizeof *a.z);
        for (int64_t i = 0; i < tc_rect_area(rect); i++)
            residual.z[i] = (int32_t)test_random_int(&r, -1000, 1000);
        tc_lh04_assemble(&level, &exact, &residual, &b);
        for (int64_t i = 0; i < tc_rect_area(rect); i++)
            assert_int_equal(b.z[i], a.z[i] + residual.z[i]);
        for (int n = 0; n < TC_BANDS; n++)
            free(band[n].z);
        free(scratch), free(z), free(coarse.z), free(exact.z), free(a.z), free(b.z), free(residual.z);
    }
}

static void any_rectangle_is_the_crop(void **state)
{
    (void)state;
    test_random r = {32};
    for (int k = 0; k < 28; k++) {
        int64_t w = test_random_int(&r, 1, k % 4 ? 90 : 420), h = test_random_int(&r, 1, k % 4 ? 90 : 420);
        bool wrap = k % 3 == 0;
        w += wrap && w % 2;
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed p = lh04_new(
            z, w, h, &(lh04_options){.q = exp(test_random_range(&r, 0, 9)), .training_tiles = 4, .wrap_x = wrap});
        for (int n = 0; n < p.levels; n++) {
            const packed_level *l = &p.level[n];
            for (int i = 0; i < 8; i++) {
                int64_t lw = l->lh04->level.width, lh = l->lh04->level.height, out = l->lh04->level.wrap_x ? lw : 0;
                tc_rect rect = {test_random_int(&r, -out, lw - 1), test_random_int(&r, 0, lh - 1), 0, 0};
                rect.x1 = test_random_int(&r, rect.x0 + 1, lw + out), rect.y1 = test_random_int(&r, rect.y0 + 1, lh);
                tc_plane part = packed_plane(rect);
                assert_int_equal(lh04_read(l, &part, i % 2 ? TC_SIMD_AUTO : TC_SIMD_NONE), TC_OK);
                for (int64_t y = rect.y0; y < rect.y1; y++)
                    for (int64_t x = rect.x0; x < rect.x1; x++)
                        assert_int_equal(*tc_plane_at(&part, x, y), *tc_plane_at(&l->fine, ((x % lw) + lw) % lw, y));
                free(part.z);
            }
        }
        packed_free(&p);
        free(z);
    }
}

/* The encoder's squared error is that of what the decoder makes: transform and quantisation agree. */
static void encoder_and_decoder_agree(void **state)
{
    (void)state;
    test_random r = {33};
    tc_lh04_work *work = malloc(tc_lh04_work_bytes());
    tc_lh04_codec *codec = malloc(sizeof *codec);
    uint8_t *bytes = malloc(tc_lh04_tile_bound());
    assert_true(work && codec && bytes);
    for (int k = 0; k < 24; k++) {
        tc_lifting_level level = {128, 128, false};
        int32_t *z = heights(&r, k % 3 * 2, 128, 128), *low = heights(&r, 1, 64, 64); /* noise, cliffs, relief */
        tc_plane fine = {z, 128, {0, 0, 128, 128}}, coarse = {low, 64, {0, 0, 64, 64}}, got = packed_plane(fine.rect);
        tc_lh04_model model;
        int32_t step = (int32_t)exp(test_random_range(&r, 3.5, 12));
        tc_lh04_model_builtin(step, &model);
        tc_lh04_init(codec, &level, &model);
        double bits = 0, error = 0;
        size_t size;
        tc_lh04_options o = {.bits = &bits, .error = &error};
        assert_int_equal(tc_lh04_encode_tile(codec, 0, 0, &coarse, &fine, &o, bytes, &size, work), TC_OK);
        assert_true(size <= tc_lh04_tile_bound());
        assert_int_equal(tc_lh04_decode_tile(codec, 0, 0, 0, bytes, size, &got, work, TC_SIMD_AUTO), TC_OK);
        tc_lh04_assemble(&level, &coarse, &got, &got);
        double rms = rms_of(&got, z) / step, expected = sqrt(error / (128 * 128));
        assert_true(fabs(rms - expected) < 0.01 * expected + 0.6 / step);
        if (size > 200) /* 96 bits stand for head, index entry and checksum */
            assert_true(fabs(bits - 8 * (double)size) < 0.01 * bits + 400);
        free(z), free(low), free(got.z);
    }
    free(work), free(codec), free(bytes);
}

static void the_error_follows_the_step(void **state)
{
    (void)state;
    test_random r = {34};
    int64_t w = 400, h = 300;
    int32_t *z = heights(&r, 4, w, h);
    double q[4] = {4, 64, 256, 1024}, last = 0;
    size_t bytes = SIZE_MAX;
    for (int k = 0; k < 4; k++) {
        packed p = lh04_new(z, w, h, &(lh04_options){.q = q[k], .training_tiles = 4});
        double rms = rms_of(&p.level[0].fine, z);
        assert_true(rms > last && rms < 0.45 * q[k]); /* uniform error of plain rounding would be 0.29 */
        assert_true(packed_bytes(&p) < bytes);
        last = rms, bytes = packed_bytes(&p);
        packed_free(&p);
    }
    free(z);
}

static void constants_and_ramps_take_no_tiles(void **state)
{
    (void)state;
    test_random r = {35};
    for (int k = 3; k < KINDS; k += 3) {
        int32_t *z = heights(&r, k, 700, 500);
        packed p = lh04_new(z, 700, 500, &(lh04_options){.q = 64, .training_tiles = 4});
        for (int n = 0; n < p.levels; n++)
            for (int64_t i = 0; i < p.level[n].tiles; i++)
                assert_true(p.level[n].tile_size[i] == 0 || k != 3);
        assert_true(packed_bytes(&p) < 2500);
        packed_free(&p);
        free(z);
    }
}

/* Decodes damaged bytes on both paths, which must agree, from memory of exactly their size. */
static tc_status decode_damaged(const tc_lh04_codec *c, const uint8_t *bytes, size_t size, const tc_plane *a,
                                const tc_plane *b, tc_lh04_work *work)
{
    uint8_t *exact = malloc(size + !size);
    assert_non_null(exact);
    memcpy(exact, bytes, size);
    tc_status x = tc_lh04_decode_tile(c, 0, 0, 0, exact, size, a, work, TC_SIMD_AUTO);
    tc_status y = tc_lh04_decode_tile(c, 0, 0, 0, exact, size, b, work, TC_SIMD_NONE);
    assert_int_equal(x, y);
    assert_memory_equal(a->z, b->z, (size_t)tc_rect_area(a->rect) * sizeof *a->z);
    free(exact);
    return x;
}

static void damaged_tiles_do_no_harm(void **state)
{
    (void)state;
    test_random r = {36};
    tc_lh04_work *work = malloc(tc_lh04_work_bytes());
    uint8_t *bytes = malloc(tc_lh04_tile_bound());
    assert_true(work && bytes);
    int64_t refused = 0, all = 0;
    for (int k = 0; k < 8; k++) {
        int64_t w = test_random_int(&r, 60, 140), h = test_random_int(&r, 60, 140);
        int32_t *z = heights(&r, k % 2 ? 4 : 0, w, h);
        packed p = lh04_new(z, w, h, &(lh04_options){.q = k < 4 ? 3 : 300 * (k % 4) + 1, .training_tiles = 1});
        const packed_level *l = &p.level[0];
        tc_rect tile = tc_lh04_tile_rect(l->lh04, 0, 0, 0);
        tc_plane a = packed_plane(tile), b = packed_plane(tile);
        for (int n = 0; n < 300 && l->tile_size[0]; n++, all++) {
            size_t size = l->tile_size[0];
            memcpy(bytes, l->tile[0], size);
            if (n % 4 == 0)
                size = (size_t)test_random_int(&r, 1, (int64_t)size - 1);
            else if (n % 4 == 1)
                for (size_t i = size / 2; i < size; i++)
                    bytes[i] = (uint8_t)test_random_bits(&r);
            else if (n % 4 == 2)
                bytes[size++] = (uint8_t)test_random_bits(&r);
            else
                bytes[test_random_int(&r, 0, (int64_t)size - 1)] ^= (uint8_t)(1 << test_random_int(&r, 0, 7));
            refused += decode_damaged(l->lh04, bytes, size, &a, &b, work) == TC_ERR_FORMAT;
        }
        for (int n = 0; n < 100; n++, all++) {
            size_t size = (size_t)test_random_int(&r, 1, 3000);
            for (size_t i = 0; i < size; i++)
                bytes[i] = (uint8_t)test_random_bits(&r);
            bytes[0] &= 1;
            refused += decode_damaged(l->lh04, bytes, size, &a, &b, work) == TC_ERR_FORMAT;
        }
        free(a.z), free(b.z);
        packed_free(&p);
        free(z);
    }
    assert_true((double)refused > 0.8 * (double)all); /* flips of signs cannot be seen here: checksums see them */
    free(bytes), free(work);
}

static void headers_come_back(void **state)
{
    (void)state;
    test_random r = {37};
    tc_lifting_level level = {100, 100, false};
    tc_lh04_codec *codec = malloc(sizeof *codec);
    uint8_t *bytes = malloc(tc_lh04_model_bound() + 64);
    assert_true(bytes && codec);
    for (int k = 0; k < 1000; k++) {
        tc_lh04_model m, read, again;
        tc_lh04_model_builtin((int32_t)test_random_int(&r, 1, k % 2 ? 300 : TC_MAX_STEP), &m);
        m.own_weights = k & 1, m.own_symbols = k >> 1 & 1;
        for (int b = 0; b < TC_LH04_BANDS; b++)
            m.mean[b] = (uint8_t)test_random_int(&r, 0, TC_LH04_MEANS - 1);
        for (int n = 0; n < TC_LH04_FLAGS; n++)
            m.empty[n] = (uint8_t)test_random_int(&r, 1, 255);
        for (int c = 0; c < TC_LH04_CLASSES && m.own_weights; c++)
            for (int p = 0; p < TC_PHASES; p++)
                for (int n = 0; n < TC_LH04_SCALE; n++)
                    m.weight[c][p][n] = (uint16_t)(test_random_bits(&r) >> test_random_int(&r, 50, 63));
        for (int b = 0; b < TC_BINS && m.own_symbols; b++) {
            uint64_t w[TC_RANS_SYMBOLS];
            for (int s = 0; s < TC_RANS_SYMBOLS; s++)
                w[s] = test_random_bits(&r) >> test_random_int(&r, 30, 63);
            if (b % 4)
                m.symbols[b] = tc_rans_normalise(w);
        }
        size_t size = tc_lh04_model_write(&m, bytes);
        assert_true(size <= tc_lh04_model_bound());
        assert_int_equal(tc_lh04_model_read(bytes, size, &read), TC_OK);
        assert_true(read.step == m.step && read.own_weights == m.own_weights && read.own_symbols == m.own_symbols);
        assert_memory_equal(read.mean, m.mean, sizeof m.mean);
        assert_memory_equal(read.empty, m.empty, sizeof m.empty);
        if (!m.own_weights)
            assert_memory_equal(read.weight, m.weight, sizeof m.weight);
        if (!m.own_symbols)
            assert_memory_equal(read.symbols, m.symbols, sizeof m.symbols);
        size_t second = tc_lh04_model_write(&read, bytes); /* what was rounded once stays */
        assert_int_equal(tc_lh04_model_read(bytes, second, &again), TC_OK);
        assert_memory_equal(again.weight, read.weight, sizeof read.weight);
        /* Damage is refused, or gives a model that is fit for decoding. */
        bytes[test_random_int(&r, 0, (int64_t)second - 1)] ^= (uint8_t)(1 << test_random_int(&r, 0, 7));
        size_t cut = k % 2 ? second : (size_t)test_random_int(&r, 0, (int64_t)second - 1);
        uint8_t *exact = malloc(cut + !cut);
        assert_non_null(exact);
        memcpy(exact, bytes, cut);
        if (tc_lh04_model_read(exact, cut, &read) == TC_OK) {
            for (int b = 0; b < TC_BINS; b++)
                assert_true(tc_rans_valid(&read.symbols[b]));
            assert_in_range(read.step, 1, TC_MAX_STEP);
            tc_lh04_init(codec, &level, &read);
        }
        free(exact);
    }
    free(bytes), free(codec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(u_is_the_synthesis_of_nothing), cmocka_unit_test(headers_come_back),
        cmocka_unit_test(encoder_and_decoder_agree),     cmocka_unit_test(any_rectangle_is_the_crop),
        cmocka_unit_test(the_error_follows_the_step),    cmocka_unit_test(constants_and_ramps_take_no_tiles),
        cmocka_unit_test(damaged_tiles_do_no_harm),
    };
    return cmocka_run_group_tests_name("lh04", tests, NULL, NULL);
}
