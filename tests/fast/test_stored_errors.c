/* test_stored_errors.c - errors of levels as packed files tell them: no less than those measured on what is read, and
 * no more than a step of their code above; read without a tile, a page at a time; and what damage to them does. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/crc32c.h"
#include "common/base/rect.h"
#include "common/packed/file/envelope.h"
#include "common/packed/file/error_store.h"
#include "common/packed/read/tile_store.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

/* ---- A file in memory, whose readings are looked at ------------------------------------------------------------- */

typedef struct memory {
    uint8_t *bytes;
    size_t size;
    int64_t from, to; /* readings that begin within are counted */
    int inside;
} memory;

static tc_status read_memory(void *context, int64_t offset, void *bytes, size_t size)
{
    memory *m = context;
    assert_true(offset >= 0 && (size_t)offset + size <= m->size);
    memcpy(bytes, m->bytes + offset, size);
    m->inside += offset >= m->from && offset < m->to;
    return TC_OK;
}

static memory memory_of(const char *path)
{
    memory m = {0};
    m.bytes = packing_bytes(path, &m.size);
    assert_non_null(m.bytes);
    return m;
}

static tc_field *open_chart(memory *m, int chart, const tc_open_options *options)
{
    const tc_byte_source source = {m, (int64_t)m->size, read_memory, NULL};
    tc_field *field;
    tc_error error;
    if (tc_packed_open_chart("memory", &source, chart, options, NULL, &field, &error))
        fail_msg("%s", error.text);
    return field;
}

/* ---- Against what is measured ----------------------------------------------------------------------------------- */

/* What is told of a leaf against what is measured of it. */
static void check_error(const char *name, int l, double told, double most, double measured)
{
    const double least = most * exp2(-254.0 / 16), step = exp2(1.0 / 16) * 1.001;
    if (!(told >= measured && (told <= measured * step || told <= least * 1.001)))
        fail_msg("%s, level %d: %.9g m told, %.9g m measured", name, l, told, measured);
}

static void check_field(const char *name, const tc_field *field)
{
    const tc_container *c = tc_field_container(field);
    const int levels = tc_field_info(field)->levels;
    tc_range_pyramid measured[TC_MAX_FIELD_LEVELS] = {{0}};
    assert_true(c->errors);
    assert_int_equal(tc_measure_errors(field, measured), TC_OK);
    tc_field_know_errors(field);
    for (int l = 2; l <= levels; l++) {
        const tc_level size = tc_field_level(field, l);
        const int shift = l > c->base ? c->error[l - 1].shift : TC_ERROR_TILE_SHIFT;
        assert_true(l == 2 || c->error[l - 1].most <= c->error[l - 2].most);
        int reads = 0;
        for (int64_t y = 0; y < tc_ceil_shift(size.height, shift); y++)
            for (int64_t x = 0; x < tc_ceil_shift(size.width, shift); x++) {
                const tc_rect leaf = {x << shift, y << shift, tc_min64((x + 1) << shift, size.width),
                                      tc_min64((y + 1) << shift, size.height)};
                double most = 0;
                for (int64_t j = leaf.y0; j < leaf.y1; j += TC_ERROR_TILE)
                    for (int64_t i = leaf.x0; i < leaf.x1; i += TC_ERROR_TILE)
                        most = fmax(most, (double)tc_measured_error(&measured[l - 1], (tc_rect){i, j, i + 1, j + 1}, 2,
                                                                    &reads));
                check_error(name, l, (double)tc_field_range(field, l, leaf).error, (double)c->error[l - 1].most, most);
            }
        /* Any rectangle. */
        test_random r = {(uint64_t)l};
        for (int k = 0; k < 20; k++) {
            const int64_t x = test_random_int(&r, 0, (int)size.width - 1),
                          y = test_random_int(&r, 0, (int)size.height - 1);
            const tc_rect rect = {x, y, test_random_int(&r, (int)x + 1, (int)size.width),
                                  test_random_int(&r, (int)y + 1, (int)size.height)};
            const float told = tc_field_range(field, l, rect).error;
            for (int64_t j = rect.y0; j < rect.y1; j += TC_ERROR_TILE)
                for (int64_t i = rect.x0; i < rect.x1; i += TC_ERROR_TILE)
                    assert_true(told >= tc_measured_error(&measured[l - 1], (tc_rect){i, j, i + 1, j + 1}, 2, &reads));
        }
    }
    assert_true(isinf(tc_field_range(field, 1, (tc_rect){0, 0, 1, 1}).error));
    tc_measured_errors_free(measured, levels);
}

static void they_bound_what_is_measured(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        packing p;
    } cases[] = {
        {"even", {.width = 300, .height = 270, .kind = PACKING_HILLS, .error = 2}},
        {"small file", {.width = 400, .height = 400, .kind = PACKING_HILLS, .error = 50}},
        {"odd", {.width = 257, .height = 131, .kind = PACKING_HILLS, .error = 0.5}},
        {"narrow", {.width = 1, .height = 200, .kind = PACKING_HILLS, .error = 0.5}},
        {"in the head", {.width = 15, .height = 9, .kind = PACKING_HILLS, .error = 0.5}},
        {"one sample", {.width = 1, .height = 1, .kind = PACKING_CONSTANT, .error = 0.5}},
        {"flat", {.width = 140, .height = 135, .kind = PACKING_CONSTANT, .error = 1}},
        {"walls", {.width = 160, .height = 150, .kind = PACKING_WALLS, .error = 100}},
        {"dust", {.width = 129, .height = 128, .kind = PACKING_DUST, .error = 1e-5, .based = true}},
        {"needle", {.width = 200, .height = 333, .kind = PACKING_NEEDLE, .error = 1}},
        {"pages", {.width = 4200, .height = 1060, .kind = PACKING_HILLS, .error = 4}},
        {"voids", {.width = 290, .height = 170, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 2}},
        {"bound", {.width = 200, .height = 141, .kind = PACKING_INTEGERS, .mode = TC_PACK_MAX_ERROR, .error = 12}},
        {"lossless", {.width = 150, .height = 135, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS}},
        {"LH04", {.width = 270, .height = 150, .kind = PACKING_HILLS, .error = 2, .codec = TC_CODEC_LH04}},
        {"round", {.width = 288, .height = 150, .voids = PACKING_LAKES, .error = 2, .wraps = true}},
        {"round, odd", {.width = 161, .height = 80, .error = 2, .wraps = true}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        packing p = cases[k].p;
        p.type = p.kind == PACKING_INTEGERS ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32;
        tc_pack_result result;
        tc_error error;
        if (packing_write(&p, made_path("errors.tclip"), &result, &error))
            fail_msg("%s: %s", cases[k].name, error.text);
        memory m = memory_of(made_path("errors.tclip"));
        assert_int_equal(result.bytes, m.size);
        tc_field *field = open_chart(&m, 0, NULL);
        check_field(cases[k].name, field);
        tc_field_destroy(field);
        free(m.bytes);
    }
}

static void pack_planet(const char *path, const char *atlas)
{
    enum { WIDTH = 576, HEIGHT = 289 };
    const double step = 180.0 / (HEIGHT - 1), radius = 1737400;
    tc_pack_terrain t = {.width = WIDTH, .height = HEIGHT, .wraps_x = true, .radius = radius, .unit = 1};
    t.spacing_x = t.spacing_y = radius * M_PI / 180 * step, t.sample_type = TC_SAMPLE_FLOAT32;
    t.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    memcpy(t.georef.transform, (double[]){-0.5 * step, step, 0, 90 + 0.5 * step, 0, -step}, sizeof t.georef.transform);
    float *z = malloc(sizeof *z * WIDTH * HEIGHT);
    assert_non_null(z);
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            const double phi = (step * j - 90) * M_PI / 180, lambda = step * i * M_PI / 180, s = sin(phi);
            const double x = cos(phi) * cos(lambda), y = cos(phi) * sin(lambda);
            z[j * WIDTH + i] = (float)(900 * sin(5 * x + 3 * s) + 2500 * s * s * sin(30 * y) * cos(40 * x + s));
        }
    const tc_pack_options how = {.error = 5, .atlas = atlas};
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error error;
    if (tc_packer_create(path, &t, &how, &packer, &error) ||
        tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, z, NULL, WIDTH, &error) ||
        tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    free(z);
}

static void those_of_planets_too(void **state)
{
    (void)state;
    static const struct {
        const char *atlas;
        int charts;
    } cases[] = {{NULL, 3}, {"hex", 4}, {"cube", 6}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        pack_planet(made_path("planet.tclip"), cases[k].atlas);
        memory m = memory_of(made_path("planet.tclip"));
        int64_t tiles = (int64_t)tc_load(m.bytes + 12, 4), errors = 0; /* where they end and begin */
        for (int n = 0; n < cases[k].charts; n++) {
            tc_field *field = open_chart(&m, n, NULL);
            const tc_container *c = tc_field_container(field);
            check_field(cases[k].atlas ? cases[k].atlas : "planet", field);
            tiles += tc_packed_chart_bytes(field);
            errors = n == 0 ? c->error[c->base].begin : errors;
            tc_field_destroy(field);
        }
        assert_int_equal(tiles, errors); /* which no chart counts as its own */
        free(m.bytes);
        tc_map *map;
        assert_int_equal(tc_map_open(made_path("planet.tclip"), NULL, &map, NULL), TC_OK);
        for (int n = 0; n < cases[k].charts; n++) {
            const tc_field *field = tc_map_field(map, n);
            const tc_level size = tc_field_level(field, 4);
            tc_field_know_errors(field);
            assert_true(isfinite(tc_field_range(field, 4, (tc_rect){0, 0, size.width, size.height}).error));
            assert_int_equal(tc_field_tell(field).decoded, 0);
        }
        tc_map_destroy(map);
    }
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

static memory packed_hills(int width, int height, double error)
{
    tc_pack_result result;
    tc_error why;
    const packing p = {.width = width, .height = height, .kind = PACKING_HILLS, .error = error};
    if (packing_write(&p, made_path("hills.tclip"), &result, &why))
        fail_msg("%s", why.text);
    return memory_of(made_path("hills.tclip"));
}

/* Begin and end of what a field's file has of errors. */
static void errors_extent(const tc_field *field, int64_t *begin_ret, int64_t *end_ret)
{
    const tc_container *c = tc_field_container(field);
    const tc_error_place *last = &c->error[c->levels - 1];
    *begin_ret = c->error[c->base].begin, *end_ret = last->begin + last->bytes;
    assert_int_equal(*end_ret, c->info.bytes);
}

static void no_tile_is_read_for_them(void **state)
{
    (void)state;
    memory m = packed_hills(1500, 1100, 1);
    tc_field *field = open_chart(&m, 0, NULL);
    int64_t begin, end;
    errors_extent(field, &begin, &end);
    m.from = 1, m.to = begin; /* behind the head's first part, which is read in one */
    m.inside = 0;
    tc_field_know_errors(field);
    assert_int_equal(m.inside, 0);
    m.from = begin, m.to = end;
    const tc_container *c = tc_field_container(field);
    for (int l = 2; l <= c->levels; l++)
        assert_true(isfinite(tc_field_range(field, l, (tc_rect){0, 0, 1, 1}).error));
    assert_int_equal(m.inside, 0); /* they are at hand */
    assert_int_equal(tc_field_tell(field).decoded, 0);
    print_message("%lld of %zu bytes are of errors\n", (long long)(end - begin), m.size);
    assert_true(end - begin < (int64_t)m.size / 20);
    tc_field_destroy(field);
    free(m.bytes);
}

/* A page at a time: what has not been read is missing, and is told. */
static void pages_are_read_one_by_one(void **state)
{
    (void)state;
    memory m = packed_hills(4200, 1060, 4);
    const tc_byte_source source = {&m, (int64_t)m.size, read_memory, NULL};
    tc_packed_file file;
    tc_missing_pages missing;
    int reads = 0;
    assert_int_equal(tc_packed_file_open_bytes("hills", &source, 0, &file, NULL), TC_OK);
    const int l = file.container.levels;
    const tc_rect rect = {4090, 1010, 4102, 1030}; /* in four pages */
    assert_true(isinf(tc_packed_file_error(&file, l, rect, 2, &reads, &missing)));
    assert_int_equal(missing.count, 4);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(missing.count, 4 - k);
        m.from = 0, m.to = INT64_MAX, m.inside = 0;
        assert_int_equal(tc_packed_file_error_page(&file, l, missing.page[0][0], missing.page[0][1]), TC_OK);
        assert_int_equal(m.inside, 2); /* of the directory, and of the page */
        reads = 0;
        const float error = tc_packed_file_error(&file, l, rect, 2, &reads, &missing);
        assert_true(isfinite(error) == (k == 3) && reads <= 4);
    }
    assert_true(tc_packed_file_error(&file, l, rect, 2, &reads, &missing) <=
                tc_packed_file_error(&file, l, (tc_rect){0, 0, 4200, 1060}, 2, &reads, &missing));
    assert_int_equal(missing.count, 0);
    tc_packed_file_close(&file);
    free(m.bytes);
}

/* ---- Damage, and files without ---------------------------------------------------------------------------------- */

/* Of damaged pages the level's largest error is told; heights are as they were. */
static void damage_is_bounded(void **state)
{
    (void)state;
    memory m = packed_hills(500, 400, 1);
    tc_field *whole = open_chart(&m, 0, NULL);
    tc_field_know_errors(whole);
    const tc_container *c = tc_field_container(whole);
    const int levels = c->levels;
    int64_t begin, end;
    errors_extent(whole, &begin, &end);
    for (int64_t at = begin; at < end; at += 1 + (end - begin) / 60) {
        m.bytes[at] ^= 0x10;
        tc_field *field = open_chart(&m, 0, NULL);
        tc_field_know_errors(field);
        int larger = 0;
        for (int l = 2; l <= levels; l++) {
            const tc_level size = tc_field_level(field, l);
            for (int k = 0; k < 9; k++) {
                const int64_t x = k % 3 * (size.width - 1) / 2, y = (int)(k / 3) * (size.height - 1) / 2;
                const tc_rect r = {x, y, x + 1, y + 1};
                const float told = tc_field_range(field, l, r).error, is = tc_field_range(whole, l, r).error;
                assert_true(told == is || told == c->error[l - 1].most);
                larger += told != is;
            }
        }
        assert_true(larger > 0);
        assert_int_equal(tc_field_tell(field).damaged, 0);
        tc_field_destroy(field);
        m.bytes[at] ^= 0x10;
    }
    tc_field_destroy(whole);
    free(m.bytes);
}

/* The place of the section of a kind in the head. */
static uint8_t *find_section(uint8_t *bytes, unsigned kind)
{
    uint8_t *at = bytes + 31 + 154 * bytes[28];
    for (int n = 0; n < (int)tc_load(bytes + 29, 2); n++, at += 8 + tc_load(at + 4, 4))
        if (tc_load(at, 4) == kind)
            return at;
    fail_msg("no section %u", kind);
    return NULL;
}

static void sign_head(uint8_t *bytes)
{
    memset(bytes + 16, 0, 4);
    tc_store(bytes + 16, tc_crc32c(0, bytes, (size_t)tc_load(bytes + 12, 4)), 4);
}

enum { ERRORS = 4 };

/* As files of before, of later forms and cut short: they are measured then. */
static void files_without_are_measured(void **state)
{
    (void)state;
    enum { OTHER_KIND, OTHER_FORM, CUT_ERRORS, CUT_LEVEL, WAYS };
    for (int way = 0; way < WAYS; way++) {
        memory m = packed_hills(300, 200, 1);
        uint8_t *section = find_section(m.bytes, ERRORS);
        if (way == OTHER_KIND)
            tc_store(section, 0x7f01, 4);
        if (way == OTHER_FORM)
            tc_store(section + 8, 2, 2);
        if (way >= CUT_ERRORS) {
            int64_t begin, end;
            tc_field *whole = open_chart(&m, 0, NULL);
            errors_extent(whole, &begin, &end);
            tc_field_destroy(whole);
            m.size = (size_t)begin - (way == CUT_LEVEL);
        }
        sign_head(m.bytes);
        tc_field *field = open_chart(&m, 0, NULL);
        const int levels = tc_field_info(field)->levels;
        assert_int_equal(tc_field_packed_info(field)->levels_missing, way == CUT_LEVEL);
        tc_range_pyramid measured[TC_MAX_FIELD_LEVELS] = {{0}};
        assert_int_equal(tc_measure_errors(field, measured), TC_OK);
        tc_field_know_errors(field);
        int reads = 0;
        for (int l = 2; l <= levels; l++)
            assert_true(tc_field_range(field, l, (tc_rect){0, 0, 5, 5}).error ==
                        tc_measured_error(&measured[l - 1], (tc_rect){0, 0, 5, 5}, 2, &reads));
        tc_measured_errors_free(measured, levels);
        tc_field_destroy(field);
        free(m.bytes);
    }
}

/* Where voids are to show at another height than they were packed with. */
static void other_voids_are_measured(void **state)
{
    (void)state;
    tc_pack_result result;
    const packing p = {.width = 290, .height = 170, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 2};
    assert_int_equal(packing_write(&p, made_path("voids.tclip"), &result, NULL), TC_OK);
    memory m = memory_of(made_path("voids.tclip"));
    for (int k = 0; k < 3; k++) {
        static const tc_void_policy policies[3] = {TC_VOIDS_FILL, TC_VOIDS_HOLE, TC_VOIDS_CONSTANT};
        tc_field *field =
            open_chart(&m, 0, &(tc_open_options){.has_policy = true, .voids = policies[k], .void_constant = 9000});
        tc_field_know_errors(field);
        const tc_level size = tc_field_level(field, 6);
        const float error = tc_field_range(field, 6, (tc_rect){0, 0, size.width, size.height}).error;
        assert_true((tc_field_tell(field).decoded > 0) == (policies[k] == TC_VOIDS_CONSTANT));
        assert_true((error > 1000) == (policies[k] == TC_VOIDS_CONSTANT));
        tc_field_destroy(field);
    }
    free(m.bytes);
}

/* A section that no writer makes makes the head wrong. */
static void wrong_sections_are_refused(void **state)
{
    (void)state;
    memory m = packed_hills(300, 200, 1);
    uint8_t *section = find_section(m.bytes, ERRORS), kept[512];
    const size_t size = (size_t)tc_load(section + 4, 4);
    const uint64_t file = m.size;
    assert_true(size < sizeof kept);
    memcpy(kept, section + 8, size);
    const uint64_t begin = tc_load(kept + 2, 8), last = tc_load(kept + size - 8, 8);
    const tc_byte_source source = {&m, (int64_t)m.size, read_memory, NULL};
    const struct {
        size_t at; /* from the end where a coded level's last row is: most, shift, bytes */
        uint64_t value;
        int bytes;
    } wrong[] = {
        {2, file + 1, 8}, {2, file - 3, 8},  {10, 0x7f800000, 4}, {10, 0x7fc00000, 4},     {10, 0xbf800000, 4},
        {size - 9, 3, 1}, {size - 9, 11, 1}, {size - 8, 19, 8},   {size - 8, file, 8},     {size - 8, UINT64_MAX, 8},
        {2, 0, 8},        {2, begin - 1, 8}, {2, begin + 1, 8},   {size - 8, last - 1, 8}, {size - 8, last + 1, 8},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        tc_packed_file f;
        tc_error error;
        tc_store(section + 8 + wrong[k].at, wrong[k].value, wrong[k].bytes);
        sign_head(m.bytes);
        if (tc_packed_file_open_bytes("memory", &source, 0, &f, &error) != TC_ERR_FORMAT)
            fail_msg("case %zu", k);
        memcpy(section + 8, kept, size);
    }
    free(m.bytes);
}

/* ---- Codes ------------------------------------------------------------------------------------------------------ */

static void codes_bound_errors(void **state)
{
    (void)state;
    static const float mosts[] = {0, 1e-30f, 0.37f, 1, 8848.86f, 3e38f};
    for (size_t k = 0; k < sizeof mosts / sizeof *mosts; k++) {
        const float most = mosts[k];
        assert_true(tc_error_metres(most, 0) == 0 && tc_error_metres(most, 255) == most);
        for (int code = 2; code < 256 && k > 1; code++) {
            const double ratio = (double)tc_error_metres(most, code) / (double)tc_error_metres(most, code - 1);
            assert_true(ratio > 1.043 && ratio < 1.046);
        }
        test_random r = {k};
        for (int n = 0; n < 1000; n++) {
            const float error = most * (float)pow(test_random_unit(&r), 9);
            const uint8_t code = tc_error_code(most, error);
            assert_true(tc_error_metres(most, code) >= error && (code == 0 || tc_error_metres(most, code - 1) < error));
        }
    }
}

static void pages_come_back(void **state)
{
    (void)state;
    test_random r = {8};
    uint8_t *codes = malloc(TC_ERROR_PAGE_LEAVES), *back = malloc(TC_ERROR_PAGE_LEAVES),
            *bytes = malloc(tc_error_page_bound());
    for (int n = 0; n < 60; n++) {
        const int w = test_random_int(&r, 1, 256), h = test_random_int(&r, 1, 64), kind = n % 3;
        for (int k = 0; k < w * h; k++)
            codes[k] = kind == 0 ? (uint8_t)test_random_bits(&r) : kind == 1 ? (uint8_t)(k % w + k / w) : 7;
        const size_t size = tc_error_page_write(codes, w, h, bytes);
        assert_true(size <= 1 << 16);
        assert_int_equal(tc_error_page_read(bytes, size, w, h, back), TC_OK);
        assert_memory_equal(codes, back, (size_t)(w * h));
        for (size_t k = 0; k < size; k++) /* whatever comes out */
            bytes[k] ^= (uint8_t)(1 << test_random_int(&r, 0, 7));
        tc_error_page_read(bytes, size, w, h, back);
    }
    free(codes), free(back), free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_bound_what_is_measured), cmocka_unit_test(those_of_planets_too),
        cmocka_unit_test(no_tile_is_read_for_them),    cmocka_unit_test(pages_are_read_one_by_one),
        cmocka_unit_test(damage_is_bounded),           cmocka_unit_test(files_without_are_measured),
        cmocka_unit_test(other_voids_are_measured),    cmocka_unit_test(wrong_sections_are_refused),
        cmocka_unit_test(codes_bound_errors),          cmocka_unit_test(pages_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
