/* test_codec.c - the codec: the same heights from encoder and decoder, from any rectangle, any thread count and any
 * processor; every bit back where nothing is rounded; no harm from damaged bytes. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/lifting/codec_tile.h"
#include "tests/support/packed.h"
#include "tests/support/terrains.h"

enum { KINDS = PACKED_KINDS };

static int32_t *heights(test_random *r, int kind, int64_t w, int64_t h)
{
    return packed_heights(r, kind, w, h, 400000);
}

static void assert_plane_equal(const tc_plane *part, const tc_plane *all)
{
    int64_t width = all->rect.x1 - all->rect.x0;
    for (int64_t y = part->rect.y0; y < part->rect.y1; y++)
        for (int64_t x = part->rect.x0; x < part->rect.x1; x++)
            if (*tc_plane_at(part, x, y) != *tc_plane_at(all, ((x % width) + width) % width, y))
                fail_msg("(%d, %d): %d, expected %d", (int)x, (int)y, *tc_plane_at(part, x, y),
                         *tc_plane_at(all, ((x % width) + width) % width, y));
}

static void any_rectangle_is_the_crop(void **state)
{
    (void)state;
    test_random r = {5};
    for (int k = 0; k < 28; k++) {
        int64_t w = test_random_int(&r, 1, k % 4 ? 90 : 420), h = test_random_int(&r, 1, k % 4 ? 90 : 420);
        bool wrap = k % 3 == 0;
        w += wrap && w % 2;
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed_options o = {.q = exp(test_random_range(&r, 0, 9)), .threads = 1, .training_tiles = 4, .wrap_x = wrap};
        o.builtin = k % 2;
        packed p = packed_new(z, w, h, &o);
        for (int n = 0; n < p.levels; n++) {
            const packed_level *l = &p.level[n];
            for (int i = 0; i < 12; i++) {
                int64_t lw = l->codec->level.width, lh = l->codec->level.height, out = l->codec->level.wrap_x ? lw : 0;
                tc_rect rect = {test_random_int(&r, -out, lw - 1), test_random_int(&r, 0, lh - 1), 0, 0};
                rect.x1 = test_random_int(&r, rect.x0 + 1, lw + out), rect.y1 = test_random_int(&r, rect.y0 + 1, lh);
                tc_plane part = packed_plane(rect);
                int64_t damaged = 0;
                assert_int_equal(packed_read(l, &part, &damaged, i % 2 ? TC_SIMD_AUTO : TC_SIMD_NONE), TC_OK);
                assert_int_equal(damaged, 0);
                assert_plane_equal(&part, &l->fine);
                free(part.z);
            }
        }
        packed_free(&p);
        free(z);
    }
}

static void unit_steps_lose_nothing(void **state)
{
    (void)state;
    test_random r = {6};
    for (int k = 0; k < 2 * KINDS; k++) {
        int64_t w = test_random_int(&r, 17, 300), h = test_random_int(&r, 17, 300);
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed p = packed_new(z, w, h, &(packed_options){.q = 0.1, .threads = 1, .training_tiles = 4});
        assert_memory_equal(p.level[0].fine.z, z, (size_t)(w * h) * sizeof *z);
        packed_free(&p);
        free(z);
    }
}

static void the_error_follows_the_step(void **state)
{
    (void)state;
    test_random r = {7};
    int64_t w = 400, h = 300;
    int32_t *z = heights(&r, 4, w, h);
    double q[3] = {64, 256, 1024}, last = 0;
    size_t bytes = SIZE_MAX;
    for (int k = 0; k < 3; k++) {
        packed p = packed_new(z, w, h, &(packed_options){.q = q[k], .threads = 1, .training_tiles = 4});
        double sum = 0;
        for (int64_t i = 0; i < w * h; i++)
            sum += pow((double)p.level[0].fine.z[i] - z[i], 2);
        double rms = sqrt(sum / (double)(w * h));
        assert_true(rms > last && rms < 0.45 * q[k]); /* uniform error of plain rounding would be 0.29 */
        assert_true(packed_bytes(&p) < bytes);
        last = rms, bytes = packed_bytes(&p);
        packed_free(&p);
    }
    free(z);
}

/* Both ways to pack must write the same tiles. */
static void compare(const int32_t *z, int64_t w, int64_t h, const packed_options *a, const packed_options *b)
{
    packed p = packed_new(z, w, h, a), q = packed_new(z, w, h, b);
    for (int n = 0; n < p.levels; n++)
        for (int64_t i = 0; i < p.level[n].tiles; i++) {
            assert_int_equal(p.level[n].tile_size[i], q.level[n].tile_size[i]);
            if (p.level[n].tile_size[i])
                assert_memory_equal(p.level[n].tile[i], q.level[n].tile[i], p.level[n].tile_size[i]);
        }
    packed_free(&p), packed_free(&q);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    test_random r = {8};
    int64_t w = 500, h = 333;
    int32_t *z = heights(&r, 4, w, h);
    packed_options one = {.q = 64, .threads = 1, .training_tiles = 4}, many = one;
    many.threads = 5;
    compare(z, w, h, &one, &many);
    free(z);
}

static void any_processor_writes_the_same_bytes(void **state)
{
    (void)state;
    test_random r = {14};
    for (int k = 0; k < 3 * KINDS; k++) {
        int64_t w = test_random_int(&r, 17, 300), h = test_random_int(&r, 17, 300);
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed_options one = {.q = exp(test_random_range(&r, -3, 9)), .threads = 1, .training_tiles = 2}, other = one;
        one.simd = TC_SIMD_AUTO, other.simd = TC_SIMD_NONE;
        compare(z, w, h, &one, &other);
        free(z);
    }
}

static void constants_and_ramps_take_no_tiles(void **state)
{
    (void)state;
    test_random r = {9};
    for (int k = 3; k < KINDS; k += 3) {
        int32_t *z = heights(&r, k, 700, 500);
        packed p = packed_new(z, 700, 500, &(packed_options){.q = 64, .threads = 1, .training_tiles = 4});
        for (int n = 0; n < p.levels; n++)
            for (int64_t i = 0; i < p.level[n].tiles; i++)
                assert_true(p.level[n].tile_size[i] == 0 || k != 3);
        assert_true(packed_bytes(&p) < 2500);
        packed_free(&p);
        free(z);
    }
}

static void training_tiles_are_distinct_and_hold_what_they_must(void **state)
{
    (void)state;
    test_random r = {12};
    for (int k = 0; k < 400; k++) {
        tc_lifting_level level = {test_random_int(&r, 1, 3000), test_random_int(&r, 1, 3000), false};
        level.wrap_x = level.width % 2 == 0 && k % 2;
        tc_training_tile t[40];
        int wanted = (int)test_random_int(&r, 0, 40), count = tc_codec_sample(&level, wanted, t);
        tc_codec c = {.level = level, .cw = (level.width + 1) / 2, .ch = (level.height + 1) / 2};
        int64_t all = ((c.cw + TC_TILE - 1) / TC_TILE) * ((c.ch + TC_TILE - 1) / TC_TILE);
        assert_int_equal(count, tc_min64(wanted, all));
        for (int i = 0; i < count; i++) {
            tc_rect tile = tc_codec_tile_rect(&c, t[i].tx, t[i].ty, 0), need = tc_codec_tile_needs(&c, tile);
            assert_false(tc_rect_empty(tile));
            assert_memory_equal(&t[i].coarse.rect, &need, sizeof need);
            assert_memory_equal(&t[i].band[TC_HH].rect, &tile, sizeof tile);
            for (int n = 0; n < i; n++)
                assert_true(t[n].tx != t[i].tx || t[n].ty != t[i].ty);
        }
    }
}

/* Without rounding there is no error, and with coarser steps there is more of it and fewer bits. */
static void prices_follow_the_step(void **state)
{
    (void)state;
    test_random r = {13};
    int64_t w = 300, h = 260;
    tc_lifting_level level = {w, h, false};
    int32_t *z = heights(&r, 4, w, h), *scratch = malloc(sizeof *scratch * tc_lifting_analyse_scratch(&level, h / 2));
    assert_non_null(scratch);
    tc_plane fine = {z, w, {0, 0, w, h}}, low = packed_plane((tc_rect){0, 0, w / 2, h / 2}), band[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        band[b] = packed_plane(low.rect);
    tc_lifting_analyse(&level, &fine, 0, h / 2, &low, band, scratch);
    tc_training_tile t[4];
    int count = tc_codec_sample(&level, 4, t);
    for (int k = 0; k < count; k++) {
        t[k].coarse = low;
        memcpy(t[k].band, band, sizeof band);
    }
    double last_bits = INFINITY, last_error = -1;
    for (int k = 0; k < 4; k++) {
        tc_detail_model m;
        double bits[TC_BANDS], error[TC_BANDS];
        tc_detail_model_builtin(0, &m);
        for (int b = 0; b < TC_BANDS; b++)
            m.step[b] = k ? 16 << 2 * k : 1;
        assert_int_equal(tc_codec_price(&level, t, count, 0, &m, bits, error), TC_OK);
        double all_bits = bits[0] + bits[1] + bits[2], all_error = error[0] + error[1] + error[2];
        assert_true(all_bits < last_bits && all_error > last_error);
        assert_true(all_error < 0.25 * (double)m.step[0] * m.step[0] * (double)(w * h));
        if (k == 0)
            assert_true(all_error == 0);
        last_bits = all_bits, last_error = all_error;
    }
    for (int b = 0; b < TC_BANDS; b++)
        free(band[b].z);
    free(low.z), free(scratch), free(z);
}

/* Decodes damaged bytes on both paths, which must agree, from memory of exactly their size. */
static tc_status decode_damaged(const packed_level *l, const uint8_t *bytes, size_t size, tc_plane *band,
                                tc_plane *also, tc_tile_work *work)
{
    uint8_t *exact = malloc(size + !size);
    assert_non_null(exact);
    memcpy(exact, bytes, size);
    tc_status a = tc_codec_decode_tile(l->codec, 0, 0, 0, exact, size, &l->coarse, band, work, TC_SIMD_AUTO);
    tc_status b = tc_codec_decode_tile(l->codec, 0, 0, 0, exact, size, &l->coarse, also, work, TC_SIMD_NONE);
    assert_int_equal(a, b);
    for (int n = 0; n < TC_BANDS; n++)
        assert_memory_equal(band[n].z, also[n].z, (size_t)tc_rect_area(band[n].rect) * sizeof *band[n].z);
    free(exact);
    return a;
}

/* Tiles a few at a time, of any sizes and lane counts, some of them damaged, come out as one after the other. */
static void few_are_like_single_tiles(void **state)
{
    (void)state;
    test_random r = {15};
    tc_tile_work *work[TC_TOGETHER];
    for (int i = 0; i < TC_TOGETHER; i++)
        assert_non_null(work[i] = malloc(tc_tile_work_bytes()));
    for (int k = 0; k < 2 * KINDS; k++) {
        int64_t w = test_random_int(&r, 200, 420), h = test_random_int(&r, 200, 420);
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed p = packed_new(
            z, w, h, &(packed_options){.q = exp(test_random_range(&r, 0, 8)), .threads = 1, .training_tiles = 2});
        const packed_level *l = &p.level[0];
        int64_t tiles = l->codec->tiles_x * l->codec->tiles_y;
        for (int n = 0; n < 60; n++) {
            tc_plane band[TC_TOGETHER][TC_BANDS], also[TC_BANDS];
            tc_tile_job job[TC_TOGETHER];
            uint8_t *bytes[TC_TOGETHER];
            int count = n % TC_TOGETHER + 1;
            for (int i = 0; i < count; i++) {
                int64_t at = test_random_int(&r, 0, tiles - 1), tx = at % l->codec->tiles_x;
                size_t size = l->tile_size[at];
                bytes[i] = malloc(size + !size);
                assert_non_null(bytes[i]);
                if (size)
                    memcpy(bytes[i], l->tile[at], size);
                if (size && n % 5 == 0)
                    bytes[i][test_random_int(&r, 0, (int64_t)size - 1)] ^= (uint8_t)(1 << test_random_int(&r, 0, 7));
                for (int b = 0; b < TC_BANDS; b++)
                    band[i][b] = packed_plane(tc_codec_tile_rect(l->codec, tx, at / l->codec->tiles_x, 0));
                job[i] = (tc_tile_job){tx, at / l->codec->tiles_x, 0, bytes[i], size, band[i], work[i], TC_ERR_IO};
            }
            tc_codec_decode_tiles(l->codec, job, count, &l->coarse, n % 9 == 8 ? TC_SIMD_NONE : TC_SIMD_AUTO);
            for (int i = 0; i < count; i++) {
                for (int b = 0; b < TC_BANDS; b++)
                    also[b] = packed_plane(band[i][b].rect);
                tc_status status = tc_codec_decode_tile(l->codec, job[i].tx, job[i].ty, 0, bytes[i], job[i].size,
                                                        &l->coarse, also, work[0], TC_SIMD_NONE);
                assert_int_equal(job[i].status, status);
                for (int b = 0; b < TC_BANDS; b++) {
                    assert_memory_equal(band[i][b].z, also[b].z, (size_t)tc_rect_area(also[b].rect) * sizeof(int32_t));
                    free(band[i][b].z), free(also[b].z);
                }
                free(bytes[i]);
            }
        }
        packed_free(&p);
        free(z);
    }
    for (int i = 0; i < TC_TOGETHER; i++)
        free(work[i]);
}

/* What predicts a detail, as detail_model.h and codec_tile.h tell it: sums of the coarser level times the kernel. */
static int32_t predicted(const tc_codec *c, tc_tile_work *w, int band, int i, int j)
{
    uint32_t t[TC_PREDICT], sum = PREDICT_ROUND;
    if (band == TC_HL)
        tc_terms_hl(w, i, j, t);
    else
        tc_terms_lh(w, i, j, t), tc_terms_cross(w, i, j, t + TC_PREDICT_KERNEL);
    for (int k = 0; k < (band == TC_HL ? TC_PREDICT_KERNEL : TC_PREDICT); k++)
        sum += t[k] * (uint32_t)(int32_t)c->model.predict[band][k];
    return (int32_t)sum >> TC_PREDICT_BITS;
}

/* Details of empty tiles are what the kernels make of the coarser level, over any part, with AVX2 and without. */
static void any_part_of_an_empty_tile_is_predicted(void **state)
{
    (void)state;
    test_random r = {21};
    tc_tile_work *work = malloc(tc_tile_work_bytes()), *oracle = malloc(tc_tile_work_bytes());
    assert_true(work && oracle);
    for (int k = 0; k < 2 * KINDS; k++) {
        int64_t w = test_random_int(&r, 150, 420), h = test_random_int(&r, 150, 420);
        int32_t *z = heights(&r, k % KINDS, w, h);
        packed p = packed_new(
            z, w, h, &(packed_options){.q = exp(test_random_range(&r, 0, 8)), .threads = 1, .training_tiles = 2});
        const tc_codec *c = p.level[0].codec;
        const tc_plane *coarse = &p.level[0].coarse;
        for (int n = 0; n < 24; n++) {
            int64_t tx = test_random_int(&r, 0, c->tiles_x - 1), ty = test_random_int(&r, 0, c->tiles_y - 1);
            tc_rect tile = tc_codec_tile_rect(c, tx, ty, 0), part = tile;
            part.x0 = test_random_int(&r, tile.x0, tile.x1 - 1), part.x1 = test_random_int(&r, part.x0 + 1, tile.x1);
            part.y0 = test_random_int(&r, tile.y0, tile.y1 - 1), part.y1 = test_random_int(&r, part.y0 + 1, tile.y1);
            tc_plane all[TC_BANDS], some[TC_BANDS];
            for (int b = 0; b < TC_BANDS; b++)
                all[b] = packed_plane(tile), some[b] = packed_plane(part);
            assert_int_equal(tc_codec_decode_tile(c, tx, ty, 0, NULL, 0, coarse, all, work, TC_SIMD_AUTO), TC_OK);
            tc_codec_predict(c, part, coarse, some, work, n % 4 ? TC_SIMD_AUTO : TC_SIMD_NONE);
            tc_tile_load(c, tile, TC_TILE, coarse, oracle);
            for (int j = -1; j < TC_TILE + 2; j++)
                for (int i = -2; i < TC_TILE + 1; i++)
                    oracle->hl[j + 1][i + HL_X] = predicted(c, oracle, TC_HL, i, j);
            for (int64_t y = part.y0; y < part.y1; y++)
                for (int64_t x = part.x0; x < part.x1; x++) {
                    int i = (int)(x - tile.x0), j = (int)(y - tile.y0);
                    int32_t wanted[TC_BANDS] = {oracle->hl[j + 1][i + HL_X], predicted(c, oracle, TC_LH, i, j), 0};
                    for (int b = 0; b < TC_BANDS; b++) {
                        assert_int_equal(*tc_plane_at(&all[b], x, y), wanted[b]);
                        assert_int_equal(*tc_plane_at(&some[b], x, y), wanted[b]);
                    }
                }
            for (int b = 0; b < TC_BANDS; b++)
                free(all[b].z), free(some[b].z);
        }
        packed_free(&p);
        free(z);
    }
    free(work), free(oracle);
}

static void damaged_tiles_do_no_harm(void **state)
{
    (void)state;
    test_random r = {10};
    tc_tile_work *work = malloc(tc_tile_work_bytes());
    uint8_t *bytes = malloc(tc_codec_tile_bound());
    assert_true(work && bytes);
    int64_t refused = 0, all = 0;
    for (int k = 0; k < 8; k++) {
        int64_t w = test_random_int(&r, 60, 140), h = test_random_int(&r, 60, 140);
        int32_t *z = heights(&r, k % 2 ? 4 : 0, w, h);
        packed p = packed_new(z, w, h,
                              &(packed_options){.q = k < 4 ? 3 : 300 * (k % 4) + 1, .threads = 1, .training_tiles = 1});
        const packed_level *l = &p.level[0];
        tc_rect tile = tc_codec_tile_rect(l->codec, 0, 0, 0);
        tc_plane band[TC_BANDS], also[TC_BANDS];
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = packed_plane(tile), also[b] = packed_plane(tile);
        for (int n = 0; n < 400 && l->tile_size[0]; n++, all++) {
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
            refused += decode_damaged(l, bytes, size, band, also, work) == TC_ERR_FORMAT;
        }
        for (int n = 0; n < 100; n++, all++) {
            size_t size = (size_t)test_random_int(&r, 1, 3000);
            for (size_t i = 0; i < size; i++)
                bytes[i] = (uint8_t)test_random_bits(&r);
            bytes[0] &= 31;
            refused += decode_damaged(l, bytes, size, band, also, work) == TC_ERR_FORMAT;
        }
        for (int b = 0; b < TC_BANDS; b++)
            free(band[b].z), free(also[b].z);
        packed_free(&p);
        free(z);
    }
    assert_true((double)refused > 0.8 * (double)all); /* flips of signs cannot be seen here: checksums see them */
    free(bytes), free(work);
}

static void headers_come_back(void **state)
{
    (void)state;
    test_random r = {11};
    uint8_t *bytes = malloc(tc_detail_model_bound() + 64);
    assert_non_null(bytes);
    for (int k = 0; k < 3000; k++) {
        tc_detail_model m, read;
        tc_detail_parts parts, back;
        tc_detail_model_builtin((int)test_random_int(&r, 0, TC_BUILTIN_MODELS - 1), &m);
        int *part[3] = {&parts.predict, &parts.scale, &parts.symbols};
        for (int i = 0; i < 3; i++) {
            int own = (int)test_random_int(&r, 0, TC_BUILTIN_MODELS);
            *part[i] = own == TC_BUILTIN_MODELS ? TC_MODEL_OWN : own;
        }
        for (int b = 0; b < TC_BANDS; b++) {
            m.step[b] = (int32_t)test_random_int(&r, 1, k % 2 ? 300 : TC_MAX_STEP);
            for (int p = 0; p < TC_PHASES; p++)
                for (int i = 0; i < TC_SCALE; i++)
                    m.scale[b][p][i] = (uint16_t)(test_random_bits(&r) >> test_random_int(&r, 48, 63));
        }
        for (int b = 0; b < 2; b++)
            for (int i = 0; i < (b ? TC_PREDICT : TC_PREDICT_KERNEL); i++)
                m.predict[b][i] = (int16_t)test_random_int(&r, INT16_MIN, INT16_MAX);
        for (int b = 0; b < TC_BINS; b++) {
            uint64_t w[TC_RANS_SYMBOLS];
            for (int s = 0; s < TC_RANS_SYMBOLS; s++)
                w[s] = test_random_bits(&r) >> test_random_int(&r, 30, 63);
            m.symbols[b] = tc_rans_normalise(w);
        }
        size_t size = tc_detail_model_write(&m, parts, bytes);
        assert_true(size <= tc_detail_model_bound());
        assert_int_equal(tc_detail_model_read(bytes, size, &read, &back), TC_OK);
        assert_memory_equal(&back, &parts, sizeof parts);
        assert_memory_equal(read.step, m.step, sizeof m.step);
        if (parts.predict == TC_MODEL_OWN)
            assert_memory_equal(read.predict, m.predict, sizeof m.predict);
        for (int b = 0; b < TC_BINS; b++)
            assert_true(tc_rans_valid(&read.symbols[b]));
        /* Damage is refused, or gives a model that is fit for decoding. */
        bytes[test_random_int(&r, 0, (int64_t)size - 1)] ^= (uint8_t)(1 << test_random_int(&r, 0, 7));
        size_t cut = k % 2 ? size : (size_t)test_random_int(&r, 0, (int64_t)size - 1);
        uint8_t *exact = malloc(cut + !cut);
        assert_non_null(exact);
        memcpy(exact, bytes, cut);
        if (tc_detail_model_read(exact, cut, &read, &back) == TC_OK)
            for (int b = 0; b < TC_BINS; b++)
                assert_true(tc_rans_valid(&read.symbols[b]) && read.step[b % TC_BANDS] > 0);
        free(exact);
    }
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(headers_come_back),
        cmocka_unit_test(any_rectangle_is_the_crop),
        cmocka_unit_test(unit_steps_lose_nothing),
        cmocka_unit_test(the_error_follows_the_step),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(constants_and_ramps_take_no_tiles),
        cmocka_unit_test(training_tiles_are_distinct_and_hold_what_they_must),
        cmocka_unit_test(prices_follow_the_step),
        cmocka_unit_test(any_processor_writes_the_same_bytes),
        cmocka_unit_test(few_are_like_single_tiles),
        cmocka_unit_test(any_part_of_an_empty_tile_is_predicted),
        cmocka_unit_test(damaged_tiles_do_no_harm),
    };
    return cmocka_run_group_tests_name("codec", tests, NULL, NULL);
}
