/* test_pack.c - what is packed comes back: as near as asked for, with the errors that the file declares, whatever part
 * of it is read. How it is put and what must not depend on it: test_pack_put.c. */
#include "tests/support/test.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

static const char *describe(const packing *p)
{
    static char text[160];
    snprintf(text, sizeof text, "%d x %d, kind %d, voids %d, mode %d, codec %d, error %g, at most %g, type %d",
             (int)p->width, (int)p->height, p->kind, p->voids, p->mode, p->codec, p->error, p->max_error, p->type);
    return text;
}

#define CHECK(condition, ...)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            print_error("%s:\n", describe(p));                                                                         \
            fail_msg(__VA_ARGS__);                                                                                     \
        }                                                                                                              \
    } while (0)

/* ---- Checks of an open file -------------------------------------------------------------------------------------- */

static tc_rect random_rect(test_random *r, tc_level level, bool wraps)
{
    tc_rect rect = {test_random_int(r, 0, level.width - 1), test_random_int(r, 0, level.height - 1), 0, 0};
    rect.x1 = test_random_int(r, rect.x0 + 1, level.width), rect.y1 = test_random_int(r, rect.y0 + 1, level.height);
    if (wraps) { /* across the seam, and more than once around */
        rect.x0 = test_random_int(r, -level.width, level.width);
        rect.x1 = rect.x0 + test_random_int(r, 1, level.width * 5 / 4);
    }
    return rect;
}

/* Parts are parts of the whole, and lie within their bounds. */
static void check_parts(const packing *p, const tc_field *file, int l, const float *z, const uint8_t *v, int count)
{
    tc_level level = tc_field_level(file, l);
    test_random r = {(uint64_t)l};
    for (int n = 0; n < count; n++) {
        tc_rect rect = random_rect(&r, level, tc_field_wraps(file, l));
        int64_t w = rect.x1 - rect.x0, stride = w + n % 3;
        float *some = malloc((size_t)(stride * (rect.y1 - rect.y0)) * sizeof *some);
        uint8_t *voids = malloc((size_t)(stride * (rect.y1 - rect.y0)));
        assert_true(some && voids);
        tc_range range = tc_field_range(file, l, rect);
        CHECK(tc_field_read(file, l, rect, some, n % 4 ? voids : NULL, stride) == TC_OK, "a part cannot be read");
        for (int64_t y = rect.y0; y < rect.y1; y++)
            for (int64_t x = rect.x0; x < rect.x1; x++) {
                int64_t at = (y - rect.y0) * stride + x - rect.x0;
                int64_t of = y * level.width + x - tc_turn(x, level.width);
                CHECK(some[at] == z[of] && (n % 4 == 0 || voids[at] == v[of]),
                      "level %d: (%d, %d) of a part is %g, of the whole %g", l, (int)x, (int)y, some[at], z[of]);
                CHECK(z[of] >= range.lo && z[of] <= range.hi, "level %d: %g is not within the bounds %g .. %g", l,
                      z[of], range.lo, range.hi);
            }
        free(some), free(voids);
    }
}

/* Whether x is what is declared, but for rounding. */
static bool about(double x, double declared, double slack)
{
    return fabs(x - declared) <= 1e-5 * fabs(declared) + slack;
}

static void check_levels(const packing *p, const tc_field *file, double unit, const tc_pack_result *result)
{
    tc_field *truth = packing_truth(p);
    uint8_t *mask;
    float *given = packing_heights(p, &mask);
    int levels = tc_field_info(truth)->levels;
    CHECK(tc_field_info(file)->levels == levels, "another number of levels");
    double height = fmax(fabs((double)tc_field_info(file)->z_min), fabs((double)tc_field_info(file)->z_max));
    for (int l = levels; l >= 1; l--) {
        tc_level level = tc_field_level(file, l);
        int64_t count = level.width * level.height;
        uint8_t *v;
        float *z = packing_read(file, l, &v), *true_z = packing_read(truth, l, NULL);
        CHECK(z, "level %d cannot be read", l);
        for (int64_t y = 0; y < level.height; y++)
            for (int64_t x = 0; x < level.width; x++)
                CHECK(v[y * level.width + x] == mask[(y << (levels - l)) * p->width + (x << (levels - l))],
                      "level %d: wrong mask at (%d, %d)", l, (int)x, (int)y);
        tc_packed_level declared = tc_field_packed_level(file, l);
        double rms, most, ulp = ldexp(height, -23);
        packing_error(z, true_z, v, count, &rms, &most);
        if (l == levels) {
            CHECK(about(rms, result->rms, 0) || declared.bytes == 0, "rms %g, declared %g", rms, result->rms);
            CHECK(most <= result->max_error + ulp, "max %g, declared %g", most, result->max_error);
            CHECK(declared.bytes == 0 || (about(result->rms, declared.rms, 0) && most <= declared.max_error),
                  "the file declares an rms of %g, at most %g", declared.rms, declared.max_error);
            if (p->mode == TC_PACK_RMS)
                CHECK(rms <= p->error * (1 + 1e-6), "rms %g", rms);
            if (p->mode == TC_PACK_MAX_ERROR)
                CHECK(most <= p->error + ulp, "off by %g", most);
            if (p->max_error > 0)
                CHECK(most <= p->max_error + ulp, "off by %g", most);
            for (int64_t i = 0; i < count && p->mode == TC_PACK_LOSSLESS; i++)
                CHECK(v[i] || z[i] == given[i], "%.9g is not %.9g", z[i], given[i]);
        } else {
            /* Declared against heights rounded to units, which the filters round again. */
            double slack = 2 * unit + 4 * ulp;
            CHECK(about(rms, declared.rms, slack), "level %d: rms %g, declared %g, unit %g", l, rms, declared.rms,
                  unit);
            CHECK(about(most, declared.max_error, 2 * slack), "level %d: max %g, declared %g", l, most,
                  declared.max_error);
        }
        check_parts(p, file, l, z, v, l > levels - 3 ? 12 : 3);
        free(z), free(v), free(true_z);
    }
    free(given), free(mask);
    tc_field_destroy(truth);
}

static void check_info(const packing *p, const tc_field *file, const tc_pack_result *result, size_t size)
{
    const tc_packed_info *i = tc_field_packed_info(file);
    const tc_terrain_info *t = tc_field_info(file);
    tc_pack_terrain terrain = packing_terrain(p);
    double sum = 0, square = 0, low = INFINITY, high = -INFINITY;
    int64_t valid = 0;
    uint8_t *v;
    float *z = packing_heights(p, &v);
    for (int64_t k = 0; k < p->width * p->height; k++)
        if (!v[k])
            sum += z[k], low = fmin(low, z[k]), high = fmax(high, z[k]), valid++;
    for (int64_t k = 0; k < p->width * p->height; k++)
        if (!v[k])
            square += (z[k] - sum / (double)valid) * (z[k] - sum / (double)valid);
    free(z), free(v);
    double deviation = sqrt(square / (double)valid), mean = sum / (double)valid + terrain.z_base;
    CHECK(i->bytes == (int64_t)size && result->bytes == i->bytes, "another size");
    CHECK(i->mode == p->mode && i->codec == p->codec && i->error == (p->mode == TC_PACK_LOSSLESS ? 0 : p->error),
          "another mode");
    CHECK(i->levels_missing == 0 && i->version == 3, "levels are missing");
    CHECK(i->terrain.wraps_x == p->wraps && i->terrain.width == p->width && i->terrain.height == p->height &&
              i->terrain.unit == terrain.unit && i->terrain.offset == terrain.offset &&
              i->terrain.z_base == terrain.z_base && i->terrain.nodata == -9999 && i->terrain.sample_type == p->type &&
              !strcmp(i->terrain.georef.crs_wkt, "LOCAL") &&
              !memcmp(i->terrain.georef.transform, terrain.georef.transform, sizeof terrain.georef.transform),
          "another terrain");
    CHECK(t->void_count == p->width * p->height - valid && result->voids == t->void_count &&
              result->samples == p->width * p->height && result->disagreeing == 0,
          "another number of voids");
    CHECK(t->z_min == (float)low && t->z_max == (float)high, "lowest %g, highest %g", t->z_min, t->z_max);
    CHECK(about(i->deviation, deviation, 1e-6 * fabs(sum / (double)valid)) && about(i->mean, mean, 1e-6 * fabs(mean)),
          "mean %g, deviation %g instead of %g, %g", i->mean, i->deviation, mean, deviation);
}

static double unit_of_file(const char *path)
{
    tc_packed_file file;
    assert_int_equal(tc_packed_file_open(path, &file, NULL), TC_OK);
    double unit = file.container.z_unit;
    tc_packed_file_close(&file);
    return unit;
}

static tc_pack_result check_packing(const packing *p)
{
    const char *path = made_path("a.tclip");
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    tc_field *file;
    size_t size = 0;
    CHECK(packing_write(p, path, &result, &error) == TC_OK, "not packed: %s", error.text);
    CHECK(made_folder_count() == 1, "something was left beside it");
    free(packing_bytes(path, &size));
    const tc_open_options small = {.cache_bytes = 1};
    for (int k = 0; k < 2; k++) {
        CHECK(tc_field_open(path, k ? &small : NULL, &file, &error) == TC_OK, "not opened: %s", error.text);
        check_info(p, file, &result, size);
        check_levels(p, file, unit_of_file(path), &result);
        CHECK(tc_field_tell(file).damaged == 0, "damaged");
        CHECK(tc_field_tell(file).bytes < (size_t)48 << 20, "%zu bytes of memory", tc_field_tell(file).bytes);
        tc_field_destroy(file);
    }
    return result;
}

/* ---- Terrains ---------------------------------------------------------------------------------------------------- */

static const int64_t sizes[][2] = {{1, 1},   {1, 7},   {40, 1},  {1, 130}, {2, 2},     {17, 16},
                                   {16, 16}, {33, 17}, {31, 62}, {91, 45}, {129, 257}, {300, 200}};
enum { SIZES = sizeof sizes / sizeof *sizes };

static void every_mode_and_size_comes_back(void **state)
{
    (void)state;
    for (int s = 0; s < SIZES; s++)
        for (int mode = 0; mode < 5; mode++) {
            packing p = {.width = sizes[s][0], .height = sizes[s][1], .error = mode == 1 ? 6 : 2};
            p.mode = mode < 3 ? (tc_pack_mode)mode : TC_PACK_RMS;
            p.codec = mode != 3 ? TC_CODEC_LIFTING : TC_CODEC_LH04;
            p.max_error = mode == 4 ? 4 * p.error : 0;
            p.kind = mode == 2 || s % 2 ? PACKING_INTEGERS : PACKING_HILLS;
            p.type = p.kind == PACKING_HILLS ? TC_SAMPLE_FLOAT32 : s % 3 ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT64;
            p.voids = s % 3 == 1 && p.width > 8 && p.height > 8 ? PACKING_LAKES : PACKING_WHOLE;
            tc_pack_result result = check_packing(&p);
            /* Small ones cannot hit the target so closely: a tile more or less makes the difference. */
            if (p.mode == TC_PACK_RMS && p.width > 90)
                assert_true(result.rms >= 0.97 * p.error);
        }
}

static void odd_terrains_come_back(void **state)
{
    (void)state;
    const packing cases[] = {
        {.kind = PACKING_CONSTANT, .error = 1, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_CONSTANT, .error = 1, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_CONSTANT, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_CONSTANT, .error = 1, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_SLOPE, .error = 0.5, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_SLOPE, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NEEDLE, .error = 1, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NEEDLE, .error = 1, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NEEDLE, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_INT16},
        {.kind = PACKING_NEEDLE, .error = 2, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_INT16},
        {.kind = PACKING_WALLS, .error = 1000, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_WALLS, .error = 5000, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_INT32},
        {.kind = PACKING_WALLS, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_INT32},
        {.kind = PACKING_WALLS, .error = 2000, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_INT32},
        {.kind = PACKING_NOISE, .error = 5, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NOISE, .error = 20, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NOISE, .error = 0.01, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_DUST, .error = 1e-4, .type = TC_SAMPLE_FLOAT64, .offset = 1e6, .based = true},
        {.kind = PACKING_DUST, .error = 3e-4, .mode = TC_PACK_MAX_ERROR, .offset = 1e6, .based = true, .type = 7},
        {.kind = PACKING_DUST, .error = 0.25, .type = TC_SAMPLE_FLOAT32, .offset = 1e6},
        {.kind = PACKING_HILLS, .error = 0.5, .type = TC_SAMPLE_FLOAT32, .offset = 1e6},
        {.kind = PACKING_HILLS, .error = 0.5, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_FLOAT32, .offset = 1e6},
        {.kind = PACKING_SPIKES, .error = 2, .max_error = 8, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_SPIKES, .error = 2, .max_error = 2.5, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NEEDLE, .error = 1, .max_error = 4, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_CONSTANT, .error = 1, .max_error = 4, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_SLOPE, .error = 0.5, .max_error = 2, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_WALLS, .error = 1000, .max_error = 4000, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_NOISE, .error = 5, .max_error = 1e6, .type = TC_SAMPLE_FLOAT32},
        {.kind = PACKING_DUST, .error = 1e-4, .max_error = 3e-4, .offset = 1e6, .based = true, .type = 7},
        {.kind = PACKING_HILLS, .error = 0.5, .max_error = 1, .type = TC_SAMPLE_FLOAT32, .offset = 1e6},
        {.kind = PACKING_INTEGERS, .error = 3, .max_error = 0.1, .type = TC_SAMPLE_INT16},
        {.kind = PACKING_INTEGERS, .error = 0.3, .max_error = 0.4, .type = TC_SAMPLE_INT16, .unit = 0.1},
        {.kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_INT16, .unit = 0.1},
        {.kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_FLOAT32, .unit = 0.01},
        {.kind = PACKING_INTEGERS, .error = 0.3, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_INT16, .unit = 0.1},
        {.kind = PACKING_INTEGERS, .error = 3, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_UINT16},
        {.kind = PACKING_INTEGERS, .error = 0.4, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_INT16},
        {.kind = PACKING_INTEGERS, .error = 3, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_UINT32, .offset = -5000},
        {.kind = PACKING_INTEGERS, .error = 500, .mode = TC_PACK_MAX_ERROR, .type = TC_SAMPLE_INT8},
        {.kind = PACKING_HILLS, .error = 1000, .type = TC_SAMPLE_UINT8},
        {.kind = PACKING_HILLS, .error = 1000, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_UINT8},
        {.kind = PACKING_HILLS, .error = 0.02, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_FLOAT32},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int k = 0; k < 2; k++) {
            packing p = cases[n];
            p.width = k ? 61 : 150, p.height = k ? 90 : 47;
            p.voids = k ? PACKING_LAKES : PACKING_WHOLE;
            check_packing(&p);
        }
}

static void nearly_all_void_comes_back(void **state)
{
    (void)state;
    for (int s = 0; s < SIZES; s++)
        for (int mode = 0; mode < 3; mode++) {
            packing p = {.width = sizes[s][0], .height = sizes[s][1], .error = 1, .voids = PACKING_ONE_LEFT};
            p.kind = PACKING_INTEGERS, p.mode = (tc_pack_mode)mode, p.type = TC_SAMPLE_INT16;
            check_packing(&p);
        }
}

/* Widths that can be halved often, seldom and never; of 666, the last level that wraps is not held whole. */
static void terrains_that_wrap_come_back(void **state)
{
    (void)state;
    static const int64_t widths[][2] = {{2, 40}, {64, 33}, {384, 192}, {600, 150}, {666, 140}, {777, 50}};
    for (int s = 0; s < (int)(sizeof widths / sizeof *widths); s++)
        for (int mode = 0; mode < 5; mode++) {
            packing p = {.width = widths[s][0], .height = widths[s][1], .error = mode == 1 ? 6 : 2, .wraps = true};
            p.mode = mode < 3 ? (tc_pack_mode)mode : TC_PACK_RMS;
            p.codec = mode != 3 ? TC_CODEC_LIFTING : TC_CODEC_LH04;
            p.max_error = mode == 4 ? 3 * p.error : 0;
            p.kind = mode == 2 ? PACKING_INTEGERS : PACKING_HILLS;
            p.type = p.kind == PACKING_HILLS ? TC_SAMPLE_FLOAT32 : TC_SAMPLE_INT16;
            p.voids = (s + mode) % 2 ? PACKING_LAKES : PACKING_WHOLE;
            tc_pack_result result = check_packing(&p);
            if (p.mode == TC_PACK_RMS && p.height > 100)
                assert_true(result.rms >= 0.97 * p.error);
        }
}

/* At the seam the error is about as it is at the other sides of tiles. */
static void the_seam_does_not_show(void **state)
{
    (void)state;
    for (int codec = 0; codec < 2; codec++) {
        packing p = {.width = 1024, .height = 512, .error = 3, .codec = codec, .type = TC_SAMPLE_FLOAT32};
        tc_pack_result result;
        tc_field *file;
        const char *path = made_path("a.tclip");
        double error[2] = {0}, count[2] = {0};
        uint8_t *mask;
        p.wraps = true;
        assert_int_equal(packing_write(&p, path, &result, NULL), TC_OK);
        assert_int_equal(tc_field_open(path, NULL, &file, NULL), TC_OK);
        float *given = packing_heights(&p, &mask), *z = packing_read(file, tc_field_info(file)->levels, NULL);
        for (int64_t i = 0; i < p.width * p.height; i++) {
            int64_t x = i % p.width;
            bool near = x < 6 || x >= p.width - 6;
            if (x % 128 >= 6 && x % 128 < 122)
                continue;
            error[near] += (z[i] - given[i]) * (z[i] - given[i]), count[near]++;
        }
        assert_true(error[1] / count[1] < 1.3 * error[0] / count[0]);
        free(given), free(mask), free(z);
        tc_field_destroy(file);
    }
}

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static void what_cannot_be_packed_is_refused(void **state)
{
    (void)state;
    const struct {
        packing p;
        tc_status status;
        const char *says;
    } cases[] = {
        {{.voids = PACKING_ALL_VOID, .error = 1}, TC_ERR_FORMAT, "void"},
        {{.kind = PACKING_HILLS, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_FLOAT32}, TC_ERR_UNSUPPORTED, "lossless"},
        {{.kind = PACKING_WALLS, .mode = TC_PACK_MAX_ERROR, .error = 1e-3, .type = TC_SAMPLE_FLOAT32, .offset = 0.3},
         TC_ERR_UNSUPPORTED,
         "too small"},
        {{.kind = PACKING_WALLS, .error = 1e-3, .type = TC_SAMPLE_FLOAT32, .offset = 0.3},
         TC_ERR_UNSUPPORTED,
         "too small"},
        {{.error = 0}, TC_ERR_USAGE, "error"},
        {{.error = NAN}, TC_ERR_USAGE, "error"},
        {{.error = INFINITY, .mode = TC_PACK_MAX_ERROR}, TC_ERR_USAGE, "error"},
        {{.error = 1, .codec = TC_CODEC_LH04, .mode = TC_PACK_MAX_ERROR}, TC_ERR_USAGE, "lh04"},
        {{.error = 1, .codec = TC_CODEC_LH04, .max_error = 4}, TC_ERR_USAGE, "lh04"},
        {{.error = 1, .max_error = -1}, TC_ERR_USAGE, "largest error"},
        {{.error = 1, .max_error = NAN}, TC_ERR_USAGE, "largest error"},
        {{.error = 1, .max_error = INFINITY}, TC_ERR_USAGE, "largest error"},
        {{.kind = PACKING_HILLS, .error = 1, .max_error = 1e-6, .type = TC_SAMPLE_FLOAT32, .offset = 0.3},
         TC_ERR_UNSUPPORTED,
         "too small"},
        {{.error = 1, .unit = NAN}, TC_ERR_USAGE, "unit"},
    };
    const char *path = made_path("a.tclip");
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        packing copy = cases[n].p, *p = &copy;
        tc_pack_result result;
        tc_error error = {TC_OK, ""};
        size_t size = 0;
        copy.width = 50, copy.height = 40;
        make_bytes(path, "old", 3);
        if (isnan(copy.unit)) {
            tc_pack_terrain t = packing_terrain(p);
            tc_pack_options o = packing_options(p);
            tc_packer *packer = NULL;
            t.unit = NAN;
            CHECK(tc_packer_create(path, &t, &o, &packer, &error) == cases[n].status && !packer, "created");
        } else {
            CHECK(packing_write(p, path, &result, &error) == cases[n].status, "case %d: not refused", (int)n);
        }
        CHECK(strstr(error.text, cases[n].says) && strstr(error.text, path) && !strchr(error.text, '\n'),
              "case %d says '%s'", (int)n, error.text);
        uint8_t *bytes = packing_bytes(path, &size);
        assert_true(size == 3 && !memcmp(bytes, "old", 3) && made_folder_count() == 1);
        free(bytes);
    }
}

/* ---- Threads ----------------------------------------------------------------------------------------------------- */

typedef struct reader {
    const tc_field *file;
    float **z;
    uint8_t **v;
    uint64_t seed;
    int wrong;
} reader;

static void *read_at_random(void *context)
{
    reader *t = context;
    test_random r = {t->seed};
    int levels = tc_field_info(t->file)->levels;
    for (int n = 0; n < 60; n++) {
        int l = (int)test_random_int(&r, levels > 3 ? levels - 3 : 1, levels);
        tc_level level = tc_field_level(t->file, l);
        tc_rect rect = random_rect(&r, level, false);
        int64_t w = rect.x1 - rect.x0, h = rect.y1 - rect.y0;
        float *z = malloc((size_t)(w * h) * sizeof *z);
        uint8_t *v = malloc((size_t)(w * h));
        (void)tc_field_range(t->file, l, rect);
        t->wrong += !z || !v || tc_field_read(t->file, l, rect, z, v, w) != TC_OK;
        for (int64_t y = 0; y < h; y++)
            t->wrong += memcmp(z + y * w, t->z[l - 1] + (rect.y0 + y) * level.width + rect.x0, (size_t)w * sizeof *z) ||
                        memcmp(v + y * w, t->v[l - 1] + (rect.y0 + y) * level.width + rect.x0, (size_t)w);
        free(z), free(v);
    }
    return NULL;
}

static void threads_read_the_same(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        packing p = {.width = 400, .height = 300, .kind = PACKING_INTEGERS, .voids = PACKING_LAKES, .error = k ? 9 : 1};
        p.type = TC_SAMPLE_INT16;
        p.mode = k < 3 ? (tc_pack_mode)k : TC_PACK_RMS, p.codec = k < 3 ? TC_CODEC_LIFTING : TC_CODEC_LH04;
        const char *path = made_path("a.tclip");
        tc_pack_result result;
        assert_int_equal(packing_write(&p, path, &result, NULL), TC_OK);
        tc_field *file;
        assert_int_equal(tc_field_open(path, NULL, &file, NULL), TC_OK);
        int levels = tc_field_info(file)->levels;
        float *z[TC_MAX_FIELD_LEVELS];
        uint8_t *v[TC_MAX_FIELD_LEVELS];
        for (int l = 1; l <= levels; l++)
            z[l - 1] = packing_read(file, l, &v[l - 1]);
        tc_field_destroy(file);
        const tc_open_options options = {.cache_bytes = k % 2};
        assert_int_equal(tc_field_open(path, &options, &file, NULL), TC_OK);
        enum { THREADS = 4 };
        pthread_t thread[THREADS];
        reader readers[THREADS];
        for (int n = 0; n < THREADS; n++) {
            readers[n] = (reader){file, z, v, (uint64_t)n, 0};
            assert_int_equal(pthread_create(&thread[n], NULL, read_at_random, &readers[n]), 0);
        }
        for (int n = 0; n < THREADS; n++) {
            pthread_join(thread[n], NULL);
            assert_int_equal(readers[n].wrong, 0);
        }
        tc_field_destroy(file);
        for (int l = 1; l <= levels; l++)
            free(z[l - 1]), free(v[l - 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mode_and_size_comes_back), cmocka_unit_test(odd_terrains_come_back),
        cmocka_unit_test(nearly_all_void_comes_back),     cmocka_unit_test(what_cannot_be_packed_is_refused),
        cmocka_unit_test(threads_read_the_same),          cmocka_unit_test(terrains_that_wrap_come_back),
        cmocka_unit_test(the_seam_does_not_show),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
