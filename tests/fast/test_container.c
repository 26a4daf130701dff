/* test_container.c - heads and index pages: what is written comes back; the checksum and the parts of a file. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/packed/file/container.h"
#include "common/base/crc32c.h"
#include "tests/support/containers.h"
#include "tests/support/terrains.h"

/* ---- Checksum ---------------------------------------------------------------------------------------------------- */

static void checksum_is_crc32c(void **state)
{
    (void)state;
    uint8_t bytes[100];
    assert_true(tc_crc32c(0, "123456789", 9) == 0xe3069283); /* the catalogue's check value */
    memset(bytes, 0, sizeof bytes);
    assert_true(tc_crc32c(0, bytes, 32) == 0x8a9136aa); /* RFC 3720, B.4 */
    memset(bytes, 0xff, sizeof bytes);
    assert_true(tc_crc32c(0, bytes, 32) == 0x62a8ab43);
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)(7 * i);
    for (size_t cut = 0; cut <= sizeof bytes; cut++)
        for (size_t from = 0; from < 9; from++) {
            size_t at = cut < from ? from : cut;
            uint32_t whole = tc_crc32c(0, bytes + from, sizeof bytes - from);
            uint32_t first = tc_crc32c(0, bytes + from, at - from);
            assert_true(tc_crc32c(first, bytes + at, sizeof bytes - at) == whole);
        }
}

/* ---- Heads ------------------------------------------------------------------------------------------------------- */

static void heads_come_back(void **state)
{
    (void)state;
    test_random r = {3};
    for (int n = 0; n < 300; n++) {
        tc_container c = container_make(&r), back;
        tc_byte_writer w = {0};
        size_t needed = 0;
        tc_error error = {TC_OK, ""};
        assert_int_equal(tc_container_write(&c, &w), TC_OK);
        if (tc_container_read("test", w.bytes, w.size, &back, &needed, &error))
            fail_msg("%s", error.text);
        assert_true(needed == w.size && tc_head_is(w.bytes, w.size) && back.info.version == 1 + c.info.terrain.wraps_x);
        assert_true(back.info.terrain.radius == c.info.terrain.radius && back.wraps_from == c.wraps_from);
        for (int k = 0; k < TC_CAP_CHARTS; k++)
            assert_int_equal(tc_container_cap_begin(&back, k), tc_container_cap_begin(&c, k));
        /* Bytes say all: what is read is written again as it was. */
        tc_byte_writer again = {0};
        assert_int_equal(tc_container_write(&back, &again), TC_OK);
        assert_true(again.size == w.size && !memcmp(again.bytes, w.bytes, w.size));
        size_t base = (size_t)(c.level[c.base - 1].width * c.level[c.base - 1].height);
        assert_true(back.levels == c.levels && back.base == c.base && back.voids == c.voids);
        assert_memory_equal(back.base_z, c.base_z, base * sizeof *c.base_z);
        assert_true(c.voids == 0 || !memcmp(back.base_void, c.base_void, base));
        assert_true(back.info.terrain.width == c.info.terrain.width && back.z_unit == c.z_unit);
        tc_container_free(&back);
        /* Cut, at the end or elsewhere: how much is needed is told where it is known. */
        size_t cut = (size_t)test_random_int(&r, 0, (int64_t)w.size - 1);
        assert_int_equal(tc_container_read("test", w.bytes, cut, &back, &needed, &error), TC_ERR_FORMAT);
        assert_true(needed == (cut < 20 ? 0 : w.size));
        /* Every kind of other file. */
        uint8_t version = w.bytes[8];
        w.bytes[8] = 3;
        assert_int_equal(tc_container_read("test", w.bytes, w.size, &back, &needed, &error), TC_ERR_UNSUPPORTED);
        w.bytes[8] = version, w.bytes[(size_t)n % 8] ^= 1;
        assert_int_equal(tc_container_read("test", w.bytes, w.size, &back, &needed, &error), TC_ERR_FORMAT);
        assert_true(!tc_head_is(w.bytes, w.size) && strstr(error.text, "something else"));
        free(w.bytes), free(again.bytes);
        tc_container_free(&c);
    }
}

/* How flat the body of a georeference is follows from its words; heights that were radii are above a sphere. */
static void words_tell_the_ellipsoid(void **state)
{
    (void)state;
    static const char words[] = "GEOGCS[\"x\",DATUM[\"y\",SPHEROID[\"z\",3396190,169.894]]]";
    test_random r = {3};
    for (int radii = 0; radii < 2; radii++) {
        tc_container c = container_make(&r), back;
        tc_pack_terrain *t = &c.info.terrain;
        tc_byte_writer w = {0};
        size_t needed;
        tc_error error;
        free(t->georef.crs_wkt);
        assert_non_null(t->georef.crs_wkt = strdup(words));
        t->georef.semi_major = 3396190, t->offset = radii ? -3396190 : 0;
        assert_int_equal(tc_container_write(&c, &w), TC_OK);
        assert_int_equal(tc_container_read_placed("test", w.bytes, w.size, &back, &needed, &error), TC_OK);
        assert_true(back.info.terrain.georef.inverse_flattening == (radii ? 0 : 169.894));
        free(w.bytes);
        tc_container_free(&back), tc_container_free(&c);
    }
}

/* Tiles are in exactly one page each, and the directory has room for all. */
static void pages_cover_a_level(void **state)
{
    (void)state;
    test_random r = {5};
    for (int n = 0; n < 200; n++) {
        tc_level level = {test_random_int(&r, 1, 30000), test_random_int(&r, 1, 30000), 1, 1};
        tc_pages p = tc_level_pages(&level);
        assert_true(p.tiles_x == (level.width + 127) / 128 && p.tiles_y == (level.height + 127) / 128);
        int64_t tiles = 0;
        for (int64_t py = 0; py < p.pages_y; py++)
            for (int64_t px = 0; px < p.pages_x; px++) {
                tc_rect t = tc_page_tiles(&p, px, py);
                assert_true(!tc_rect_empty(t) && tc_rect_area(t) <= TC_PAGE_TILES);
                assert_true(t.x0 == px * TC_PAGE_COLUMNS && t.y0 == py * TC_PAGE_ROWS);
                tiles += tc_rect_area(t);
            }
        assert_true(tiles == p.tiles_x * p.tiles_y);
        int64_t pages = p.pages_x * p.pages_y, last = pages - 1;
        int64_t end = tc_directory_chunk_offset(last / TC_DIRECTORY_CHUNK) +
                      (last % TC_DIRECTORY_CHUNK + 1) * TC_DIRECTORY_ENTRY + 4;
        assert_true(end == tc_directory_bytes(&p));
    }
}

/* ---- Index pages ------------------------------------------------------------------------------------------------- */

static tc_tile_entry make_entry(test_random *r, tc_page_form form, int32_t range)
{
    tc_tile_entry e = {.mask_class = TC_MASK_VALID};
    if (test_random_int(r, 0, 3))
        e.size[0] = (uint32_t)test_random_int(r, 1, test_random_int(r, 0, 1) ? 200 : 100000);
    if (form.corrections && test_random_int(r, 0, 1))
        e.size[1] = (uint32_t)test_random_int(r, 0, 5000);
    if (form.mask)
        e.mask_class = (uint8_t)test_random_int(r, 0, 2);
    if (e.mask_class == TC_MASK_CODED)
        e.size[2] = (uint32_t)test_random_int(r, 0, TC_MASK_BOUND);
    e.step = form.step ? (uint32_t)test_random_bits(r) >> test_random_int(r, 1, 31) : TC_STEP_UNKNOWN;
    if (form.step && test_random_int(r, 0, 9) == 0)
        e.step = UINT32_MAX / 2;
    e.low = (int32_t)test_random_int(r, -range, range), e.high = (int32_t)test_random_int(r, e.low, range);
    return e;
}

static void index_pages_come_back(void **state)
{
    (void)state;
    test_random r = {9};
    uint8_t *bytes = malloc(tc_page_bound());
    assert_non_null(bytes);
    for (int n = 0; n < 600; n++) {
        static const int32_t ranges[] = {0, 1, 100, 1 << 20, 2 * TC_LIFTING_LIMIT};
        tc_page_form form = {n & 1, n & 2, n & 4, n & 8};
        tc_tile_entry entry[TC_PAGE_TILES], back[TC_PAGE_TILES];
        int count = (int)test_random_int(&r, 1, n % 3 ? 12 : TC_PAGE_TILES);
        int32_t range = ranges[n % 5], lowest = INT32_MAX, highest = INT32_MIN;
        for (int i = 0; i < count; i++) {
            entry[i] = make_entry(&r, form, range);
            if (i > 0 && test_random_int(&r, 0, 3) == 0)
                entry[i].size[0] = entry[i - 1].size[0];
            entry[i].crc = tc_tile_bytes(&entry[i]) ? (uint32_t)test_random_bits(&r) : 0;
            lowest = entry[i].low < lowest ? entry[i].low : lowest;
            highest = entry[i].high > highest ? entry[i].high : highest;
        }
        size_t size = tc_page_write(form, entry, count, bytes);
        assert_true(size <= tc_page_bound());
        assert_int_equal(tc_page_read(form, bytes, size, back, count), TC_OK);
        int64_t step = ((int64_t)highest - lowest) / TC_BOUND_STEPS + 1;
        for (int i = 0; i < count; i++) {
            assert_memory_equal(back[i].size, entry[i].size, sizeof entry[i].size);
            assert_true(back[i].crc == entry[i].crc && back[i].mask_class == entry[i].mask_class);
            if (form.step) /* as much or at most a quarter more */
                assert_true(back[i].step >= entry[i].step && back[i].step <= entry[i].step + entry[i].step / 4);
            else
                assert_true(back[i].step == TC_STEP_UNKNOWN);
            assert_true(back[i].low <= entry[i].low && back[i].low > entry[i].low - step && back[i].low >= lowest);
            assert_true(back[i].high >= entry[i].high && back[i].high < entry[i].high + step &&
                        back[i].high <= highest);
        }
        /* Missing bytes are zeros to the decoder: to see that is the checksum's affair. */
        tc_page_read(form, bytes, (size_t)test_random_int(&r, 0, (int64_t)size), back, count);
    }
    free(bytes);
}

/* Classes of largest steps: every step up to a few octaves, and those around powers of two. */
static void steps_are_told_by_their_class(void **state)
{
    (void)state;
    uint8_t *bytes = malloc(tc_page_bound());
    assert_non_null(bytes);
    for (int64_t k = 0; k < 4096 + 32 * 16; k++) {
        int64_t step = k < 4096 ? k : (INT64_C(1) << (k - 4096) / 16) + (k - 4096) % 16 - 8;
        if (step < 0 || step >= TC_STEP_UNKNOWN)
            continue;
        tc_tile_entry entry = {.mask_class = TC_MASK_VALID, .step = (uint32_t)step}, back;
        size_t size = tc_page_write((tc_page_form){.step = true}, &entry, 1, bytes);
        assert_int_equal(tc_page_read((tc_page_form){.step = true}, bytes, size, &back, 1), TC_OK);
        assert_true(back.step >= step && back.step <= step + step / 4 && (step >= 8 || back.step == step));
        entry.step = back.step; /* the end of its class is its own */
        size = tc_page_write((tc_page_form){.step = true}, &entry, 1, bytes);
        assert_int_equal(tc_page_read((tc_page_form){.step = true}, bytes, size, &back, 1), TC_OK);
        assert_int_equal(back.step, entry.step);
    }
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checksum_is_crc32c),       cmocka_unit_test(heads_come_back),
        cmocka_unit_test(words_tell_the_ellipsoid), cmocka_unit_test(pages_cover_a_level),
        cmocka_unit_test(index_pages_come_back),    cmocka_unit_test(steps_are_told_by_their_class),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
