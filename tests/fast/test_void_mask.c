/* test_void_mask.c - void masks come back as they were, tile by tile, and take little room. */
#include "tests/support/test.h"

#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/mask/void_mask.h"

static uint32_t next(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*seed >> 32);
}

typedef bool (*shape)(int64_t x, int64_t y, uint32_t random);

static bool valid(int64_t x, int64_t y, uint32_t random)
{
    return (void)x, (void)y, (void)random, false;
}
static bool nothing(int64_t x, int64_t y, uint32_t random)
{
    return (void)x, (void)y, (void)random, true;
}
static bool noise(int64_t x, int64_t y, uint32_t random)
{
    return (void)x, (void)y, random & 1;
}
static bool rare(int64_t x, int64_t y, uint32_t random)
{
    return (void)x, (void)y, random % 997 == 0;
}
static bool checkerboard(int64_t x, int64_t y, uint32_t random)
{
    return (void)random, (x + y) % 2;
}
static bool columns(int64_t x, int64_t y, uint32_t random)
{
    return (void)y, (void)random, x % 5 == 3;
}
static bool rows(int64_t x, int64_t y, uint32_t random)
{
    return (void)x, (void)random, y % 7 == 6;
}
static bool slant(int64_t x, int64_t y, uint32_t random)
{
    return (void)random, 10 * x + 3 * y > 1000;
}
static bool disc(int64_t x, int64_t y, uint32_t random)
{
    return (void)random, (x - 90) * (x - 90) + (y - 100) * (y - 100) < 70 * 70;
}
static bool ragged(int64_t x, int64_t y, uint32_t random)
{
    return (x - 90) * (x - 90) + (y - 100) * (y - 100) + (int64_t)(random % 1000) < 70 * 70;
}
static bool odd_only(int64_t x, int64_t y, uint32_t random)
{
    return (void)random, x % 2 || y % 2; /* the coarser level is valid throughout */
}
static const shape shapes[] = {valid, nothing, noise, rare, checkerboard, columns, rows, slant, disc, ragged, odd_only};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static tc_mask_plane new_plane(tc_rect rect)
{
    tc_mask_plane p = {NULL, rect.x1 - rect.x0, rect};
    p.v = malloc((size_t)tc_rect_area(rect));
    return p;
}

static tc_mask_plane make_mask(int64_t width, int64_t height, shape s)
{
    tc_mask_plane p = new_plane((tc_rect){0, 0, width, height});
    uint64_t seed = 5;
    for (int64_t i = 0; i < width * height; i++)
        p.v[i] = s(i % width, i / width, next(&seed));
    return p;
}

/* The part `rect` of a plane that is a whole level, in memory of its own, so that whoever looks beyond it is caught.
 * x wraps. */
static tc_mask_plane cut(const tc_mask_plane *p, tc_rect rect)
{
    tc_mask_plane c = new_plane(rect);
    int64_t width = p->rect.x1;
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++)
            c.v[(y - rect.y0) * c.stride + x - rect.x0] = p->v[y * p->stride + (x + 4 * width) % width];
    return c;
}

static tc_mask_plane coarser(const tc_mask_plane *fine)
{
    tc_mask_plane c = new_plane((tc_rect){0, 0, (fine->rect.x1 + 1) / 2, (fine->rect.y1 + 1) / 2});
    tc_mask_downsample(fine, &c);
    return c;
}

/* Codes a level there and back; its bytes. */
static size_t code_level(const tc_mask_plane *fine, bool wrap)
{
    tc_lifting_level level = {fine->rect.x1, fine->rect.y1, wrap};
    tc_mask_plane coarse = coarser(fine), back = new_plane(fine->rect);
    memset(back.v, 7, (size_t)tc_rect_area(back.rect));
    size_t bytes = 0;
    for (int64_t ty = 0; ty * 2 * TC_TILE < level.height; ty++) {
        for (int64_t tx = 0; tx * 2 * TC_TILE < level.width; tx++) {
            tc_rect tile = tc_mask_tile_rect(&level, tx, ty, 0);
            tc_mask_plane around = cut(&coarse, tc_mask_tile_needs(&level, tile)), own = cut(fine, tile);
            uint8_t coded[TC_MASK_BOUND];
            size_t size = tc_mask_encode(&level, tile, &around, &own, coded);
            assert_true(size <= TC_MASK_BOUND);
            uint8_t *exact = malloc(size ? size : 1);
            memcpy(exact, coded, size);
            tc_mask_class class = tc_mask_classify(tile, &own);
            bytes += class == TC_MASK_CODED ? size : 0;
            /* Whatever the class, the code holds. */
            assert_int_equal(tc_mask_decode(&level, tile, TC_MASK_CODED, &around, exact, size, &back), TC_OK);
            memset(own.v, 7, (size_t)tc_rect_area(tile));
            assert_int_equal(
                tc_mask_decode(&level, tile, class, &around, exact, class == TC_MASK_CODED ? size : 0, &own), TC_OK);
            tc_mask_plane truth = cut(fine, tile);
            assert_memory_equal(own.v, truth.v, (size_t)tc_rect_area(tile));
            if (wrap) { /* the tile as others see it from the far side, and with more of the coarser level at hand */
                int64_t shift = tx % 2 ? level.width : -level.width;
                tc_rect moved = tc_mask_tile_rect(&level, tx, ty, shift), needs = tc_mask_tile_needs(&level, moved);
                tc_mask_plane wide = cut(&coarse, (tc_rect){needs.x0 - 3, needs.y0, needs.x1 + 5, needs.y1});
                tc_mask_plane far = new_plane(moved);
                assert_int_equal(tc_mask_decode(&level, moved, TC_MASK_CODED, &wide, exact, size, &far), TC_OK);
                assert_memory_equal(far.v, truth.v, (size_t)tc_rect_area(tile));
                free(wide.v), free(far.v);
            }
            free(truth.v), free(around.v), free(own.v), free(exact);
        }
    }
    assert_memory_equal(back.v, fine->v, (size_t)tc_rect_area(back.rect));
    free(coarse.v), free(back.v);
    return bytes;
}

static void comes_back(void **state)
{
    (void)state;
    for (int s = 0; s < SHAPES; s++) {
        for (int64_t n = 1; n <= 300; n += n < 12 ? 1 : n / 3 + s) {
            for (int k = 0; k < 3; k++) {
                int64_t width = k == 0 ? n : k == 1 ? n % 17 + 1 : 301 - n, height = k == 1 ? n : n * 7 % 131 + 1;
                tc_mask_plane fine = make_mask(width, height, shapes[s]);
                code_level(&fine, false);
                free(fine.v);
            }
        }
    }
}

static void wraps(void **state)
{
    (void)state;
    const int64_t widths[] = {2, 4, 6, 126, 128, 130, 200, 256, 260};
    for (int s = 0; s < SHAPES; s++) {
        for (size_t k = 0; k < sizeof widths / sizeof *widths; k++) {
            tc_mask_plane fine = make_mask(widths[k], 131, shapes[s]);
            code_level(&fine, true);
            free(fine.v);
        }
    }
}

static void takes_little_room(void **state)
{
    (void)state;
    const struct {
        shape s;
        size_t most;
    } figures[] = {{valid, 0}, {nothing, 0}, {disc, 60}, {slant, 50}, {rows, 2500}, {columns, 2500}, {noise, 8 * 1536}};
    for (size_t k = 0; k < sizeof figures / sizeof *figures; k++) {
        tc_mask_plane fine = make_mask(256, 512, figures[k].s);
        size_t bytes = code_level(&fine, false);
        assert_true(bytes <= figures[k].most);
        free(fine.v);
    }
}

static void classes(void **state)
{
    (void)state;
    tc_mask_plane fine = make_mask(256, 200, valid);
    tc_lifting_level level = {256, 200, false};
    assert_int_equal(tc_mask_classify(tc_mask_tile_rect(&level, 1, 1, 0), &fine), TC_MASK_VALID);
    fine.v[199 * 256 + 255] = 1;
    assert_int_equal(tc_mask_classify(tc_mask_tile_rect(&level, 1, 1, 0), &fine), TC_MASK_CODED);
    assert_int_equal(tc_mask_classify(tc_mask_tile_rect(&level, 0, 1, 0), &fine), TC_MASK_VALID);
    memset(fine.v, 1, 256 * 200);
    assert_int_equal(tc_mask_classify(tc_mask_tile_rect(&level, 1, 1, 0), &fine), TC_MASK_VOID);
    free(fine.v);
}

/* A plane that holds only a part of the tile gets that part, and nothing beside it is touched. */
static void parts(void **state)
{
    (void)state;
    tc_mask_plane fine = make_mask(300, 200, ragged), coarse = coarser(&fine);
    tc_lifting_level level = {300, 200, false};
    tc_rect tile = tc_mask_tile_rect(&level, 0, 0, 0);
    uint8_t bytes[TC_MASK_BOUND];
    size_t size = tc_mask_encode(&level, tile, &coarse, &fine, bytes);
    tc_mask_plane part = new_plane((tc_rect){33, 100, 150, 140});
    memset(part.v, 7, (size_t)tc_rect_area(part.rect));
    assert_int_equal(tc_mask_decode(&level, tile, TC_MASK_CODED, &coarse, bytes, size, &part), TC_OK);
    for (int64_t y = 100; y < 140; y++)
        for (int64_t x = 33; x < 150; x++)
            assert_int_equal(part.v[(y - 100) * part.stride + x - 33],
                             x < tile.x1 && y < tile.y1 ? fine.v[y * 300 + x] : 7);
    assert_int_equal(tc_mask_decode(&level, tile, TC_MASK_VOID, &coarse, NULL, 0, &part), TC_OK);
    assert_int_equal(part.v[0], 1);
    assert_int_equal(tc_mask_decode(&level, tile, TC_MASK_VALID, &coarse, bytes, 1, &part), TC_ERR_FORMAT);
    free(fine.v), free(coarse.v), free(part.v);
}

/* Damaged bytes give some mask or other, that of the coarser level in its places. */
static void damage_is_harmless(void **state)
{
    (void)state;
    tc_mask_plane fine = make_mask(150, 141, ragged), coarse = coarser(&fine), back = new_plane(fine.rect);
    tc_lifting_level level = {150, 141, false};
    tc_rect tile = tc_mask_tile_rect(&level, 0, 0, 0);
    uint8_t bytes[TC_MASK_BOUND];
    size_t size = tc_mask_encode(&level, tile, &coarse, &fine, bytes);
    uint64_t seed = 3;
    int noticed = 0;
    enum { TRIALS = 3000 };
    for (int n = 0; n < TRIALS; n++) {
        size_t length = n % 4 == 0 ? size : next(&seed) % (n % 4 == 1 ? 3000 : n % 4 == 2 ? 100 : size + 20);
        uint8_t *damaged = malloc(length ? length : 1);
        for (size_t i = 0; i < length; i++)
            damaged[i] = n % 4 == 0 ? bytes[i] : (uint8_t)next(&seed);
        if (length > 0)
            damaged[next(&seed) % length] ^= (uint8_t)(1 << next(&seed) % 8);
        memset(back.v, 0, (size_t)tc_rect_area(back.rect));
        tc_status status = tc_mask_decode(&level, tile, TC_MASK_CODED, &coarse, damaged, length, &back);
        assert_true(status == TC_OK || status == TC_ERR_FORMAT);
        assert_true(status == TC_ERR_FORMAT || length <= TC_MASK_BOUND);
        noticed += status == TC_ERR_FORMAT;
        for (int64_t y = 0; y < tile.y1; y++)
            for (int64_t x = 0; x < tile.x1; x++)
                assert_true(back.v[y * 150 + x] == (x % 2 || y % 2 ? back.v[y * 150 + x] & 1 : fine.v[y * 150 + x]));
        free(damaged);
    }
    print_message("%d of %d damages noticed\n", noticed, TRIALS);
    free(fine.v), free(coarse.v), free(back.v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_back), cmocka_unit_test(wraps), cmocka_unit_test(takes_little_room),
        cmocka_unit_test(classes),    cmocka_unit_test(parts), cmocka_unit_test(damage_is_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
