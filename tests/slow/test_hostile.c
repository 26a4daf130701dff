/* test_hostile.c - heads whose checksum is right and whose values are not: sizes without end, levels on top of each
 * other, steps, models and floats of random bytes. What is refused is refused at once; what is not is read without harm
 * and within memory that a file of the size deserves.
 *
 * The Makefile links this test with --wrap for the functions that allocate. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/base/crc32c.h"
#include "tests/support/containers.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"
#include "tests/wrapped/allocations.h"

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

enum { MOST_PIECE = 40 << 20 };

/* ---- Trying ------------------------------------------------------------------------------------------------------ */

static int cases, opened;

/* Writes a head and what followed the intact one, opens, reads. The status of the opening. */
static tc_status try_bytes(const uint8_t *head, size_t head_size, const uint8_t *rest, size_t rest_size)
{
    enum { MOST_WHOLE = 600, PART = 60 };
    const char *path = made_path("hostile");
    uint8_t *bytes = malloc(head_size + rest_size + 1);
    assert_non_null(bytes);
    memcpy(bytes, head, head_size), memcpy(bytes + head_size, rest, rest_size);
    make_bytes(path, bytes, head_size + rest_size);
    free(bytes);
    tc_field *p = NULL;
    tc_error error = {TC_OK, ""};
    cases++;
    alarm(20);
    allocations.largest = 0;
    tc_status status = tc_field_open(path, NULL, &p, &error);
    assert_true(status ? !p && error.text[0] && !strchr(error.text, '\n') : p != NULL);
    opened += !status;
    for (int l = status ? 0 : tc_field_info(p)->levels; l >= 1; l--) {
        tc_level level = tc_field_level(p, l);
        tc_rect r = {0, 0, level.width, level.height};
        if (level.width > MOST_WHOLE || level.height > MOST_WHOLE)
            r = (tc_rect){level.width / 3, level.height / 3, tc_min64(level.width, level.width / 3 + PART),
                          tc_min64(level.height, level.height / 3 + PART)};
        float *z = __real_malloc((size_t)tc_rect_area(r) * sizeof *z);
        uint8_t *v = __real_malloc((size_t)tc_rect_area(r));
        tc_range range = tc_field_range(p, l, r);
        assert_true(isfinite(range.lo) && isfinite(range.hi) && range.lo <= range.hi);
        if (tc_field_read(p, l, r, z, v, r.x1 - r.x0) == TC_OK)
            for (int64_t i = 0; i < tc_rect_area(r); i++)
                assert_true(isfinite(z[i]) && v[i] <= 1);
        __real_free(z), __real_free(v);
        tc_field_packed_level(p, l);
    }
    assert_true(allocations.largest < MOST_PIECE);
    tc_field_destroy(p);
    alarm(0);
    return status;
}

/* ---- The intact files -------------------------------------------------------------------------------------------- */

enum { KINDS = 6 };
static const packing kinds[KINDS] = {
    {.width = 140, .height = 90, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 3, .type = TC_SAMPLE_FLOAT32},
    {.width = 90, .height = 60, .kind = PACKING_INTEGERS, .mode = TC_PACK_MAX_ERROR, .error = 12, .type = 3},
    {.width = 60, .height = 50, .kind = PACKING_INTEGERS, .voids = PACKING_LAKES, .mode = TC_PACK_LOSSLESS, .type = 3},
    {.width = 70, .height = 50, .kind = PACKING_HILLS, .error = 2, .codec = TC_CODEC_LH04, .type = TC_SAMPLE_FLOAT32},
    {.width = 136, .height = 60, .voids = PACKING_LAKES, .error = 3, .type = TC_SAMPLE_FLOAT32, .wraps = true},
    {.width = 64, .height = 50, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS, .type = 3, .wraps = true},
};

typedef struct intact {
    uint8_t *bytes;
    size_t size, head;
    tc_container c;
} intact;
static intact files[KINDS];

static int set_up(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        intact *f = &files[k];
        tc_pack_result result;
        tc_envelope *e;
        if (packing_write(&kinds[k], made_path("hostile"), &result, NULL) ||
            !(f->bytes = packing_bytes(made_path("hostile"), &f->size)) ||
            tc_envelope_read("intact", f->bytes, f->size, &e, &f->head, NULL))
            return -1;
        f->c = e->chart[0].container;
        e->chart[0].container = (tc_container){0};
        tc_envelope_free(e);
    }
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++)
        tc_container_free(&files[k].c), free(files[k].bytes);
    made_folder_remove();
    printf("%d hostile files, of which %d opened\n", cases, opened);
    return 0;
}

/* ---- Cases ------------------------------------------------------------------------------------------------------- */

/* Writes the head of a file of one container as it is, but for the checks that only reading makes; laid out: with its
 * levels one behind the other. */
static tc_status try_head(const intact *f, const tc_container *c, bool lay_out)
{
    tc_byte_writer w = envelope_of_one(c, lay_out);
    tc_status status = try_bytes(w.bytes, w.size, f->bytes + f->head, f->size - f->head);
    free(w.bytes);
    return status;
}

static void sign(uint8_t *head, size_t size)
{
    memset(head + 16, 0, 4);
    tc_store(head + 16, tc_crc32c(0, head, size), 4);
}

/* Random bytes over every part of the head, and its checksum made good. */
static void random_heads_do_no_harm(void **state)
{
    (void)state;
    test_random r = {4};
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        uint8_t *head = malloc(f->head);
        assert_non_null(head);
        for (size_t at = 20; at < f->head; at += k ? 2 : 1)
            for (int n = 0; n < 2; n++) {
                memcpy(head, f->bytes, f->head);
                size_t count = (size_t)test_random_int(&r, 1, n ? 8 : 1);
                for (size_t i = at; i < at + count && i < f->head; i++)
                    head[i] = (uint8_t)test_random_bits(&r);
                if (at >= envelope_head_at(f->bytes, 0)) /* the container's own checksum too */
                    sign(head + envelope_head_at(f->bytes, 0), f->head - envelope_head_at(f->bytes, 0));
                sign(head, f->head);
                try_bytes(head, f->head, f->bytes + f->head, f->size - f->head);
            }
        free(head);
    }
}

/* Values of fields that must be refused, one at a time. */
static void impossible_values_are_refused(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY, -INFINITY, 0, -1, 1e300, 5e-324};
    for (int k = 0; k < KINDS; k++) {
        const intact *f = &files[k];
        tc_container c = f->c;
        assert_int_equal(try_head(f, &c, false), TC_OK);
#define REFUSED(field, value)                                                                                          \
    do {                                                                                                               \
        c = f->c;                                                                                                      \
        (field) = (value);                                                                                             \
        if (try_head(f, &c, false) != TC_ERR_FORMAT)                                                                   \
            fail_msg("kind %d: %s = %s is not refused", k, #field, #value);                                            \
    } while (0)
        for (int n = 0; n < 5; n++) { /* NaN, infinities, 0, -1 */
            double v = bad[n];
            REFUSED(c.info.terrain.spacing_x, v);
            REFUSED(c.info.terrain.spacing_y, v);
            REFUSED(c.info.terrain.unit, v);
            REFUSED(c.z_unit, v);
            if (n < 3) {
                REFUSED(c.info.terrain.z_base, v);
                REFUSED(c.info.terrain.offset, v);
                REFUSED(c.info.terrain.void_constant, v);
                REFUSED(c.info.terrain.georef.transform[3], v);
                REFUSED(c.info.terrain.georef.semi_major, v);
                REFUSED(c.z_origin, v);
                REFUSED(c.z_min, v);
                REFUSED(c.z_max, v);
                REFUSED(c.info.mean, v);
                REFUSED(c.info.deviation, v);
                REFUSED(c.info.error, v);
                REFUSED(c.record[c.levels - 1].rms, (float)v);
                REFUSED(c.record[c.levels - 1].max_error, (float)v);
                REFUSED(c.record[c.levels - 1].residual_variance, (float)v);
            }
        }
        REFUSED(c.z_unit, 1e300);
        REFUSED(c.z_unit, 1e30);
        REFUSED(c.z_origin, 1e300);
        REFUSED(c.z_max, 1e39);
        REFUSED(c.info.terrain.void_constant, -1e39);
        REFUSED(c.z_min, c.z_max + 1);
        REFUSED(c.voids, -1);
        REFUSED(c.voids, c.info.terrain.width * c.info.terrain.height);
        REFUSED(c.info.terrain.width, 0);
        REFUSED(c.info.terrain.width, -5);
        REFUSED(c.info.terrain.height, ((int64_t)1 << 40) + 1);
        REFUSED(c.info.terrain.height, INT64_MIN);
        REFUSED(c.info.terrain.height, INT64_MAX);
        REFUSED(c.info.terrain.sample_type, 8);
        REFUSED(c.info.terrain.voids, 3);
        REFUSED(c.info.mode, 3);
        REFUSED(c.info.codec, 2);
        REFUSED(c.info.bytes, c.info.bytes + 1);
        REFUSED(c.info.bytes, INT64_MAX);
        REFUSED(c.base_z[0], TC_LIFTING_LIMIT + 1);
        REFUSED(c.base_z[1], -TC_LIFTING_LIMIT - 1);
        for (int l = c.base; l < c.levels; l++) {
            tc_level_record *r = &c.record[l];
            REFUSED(r->begin, r->begin + 1);
            REFUSED(r->begin, 0);
            REFUSED(r->begin, INT64_MIN);
            REFUSED(r->end, r->begin);
            REFUSED(r->end, r->begin - 1);
            REFUSED(r->end, r->end + 1);
            REFUSED(r->end, INT64_MAX);
            REFUSED(r->coder, TC_CODERS);
            REFUSED(r->lowest, r->highest + 1);
            REFUSED(r->lowest, INT32_MIN);
            REFUSED(r->highest, INT32_MAX);
            REFUSED(r->correction_step, -1);
            REFUSED(r->correction_step, INT32_MAX);
            REFUSED(r->correction_snap, -1);
            REFUSED(r->correction_snap, INT32_MAX);
        }
    }
}

/* Terrains of any size, with levels of as many bytes as their directories need, or of more; the file is as short as
 * ever. */
static void endless_sizes_take_no_memory(void **state)
{
    (void)state;
    static const int64_t sizes[] = {1, 2, 16, 17, 1000, 1 << 20, INT64_C(1) << 32, INT64_C(1) << 40};
    for (int k = 0; k < KINDS; k++)
        for (int i = 0; i < 8; i++)
            for (int j = 0; j < 8; j++)
                for (int more = 0; more < 2; more++) {
                    const intact *f = &files[k];
                    tc_container c = f->c;
                    c.info.terrain.width = sizes[i], c.info.terrain.height = sizes[j];
                    c.voids = 0;
                    tc_container_set_levels(&c);
                    for (int l = c.base; l < c.levels; l++) {
                        tc_pages pages = tc_level_pages(&c.level[l]);
                        c.record[l] = f->c.record[f->c.levels - 1];
                        c.record[l].begin = 0, c.record[l].end = tc_directory_bytes(&pages) + more * 3000;
                    }
                    assert_int_equal(try_head(f, &c, true), TC_OK);
                }
}

/* Models of random bytes, of any length; coders exchanged. */
static void random_models_do_no_harm(void **state)
{
    (void)state;
    test_random r = {8};
    for (int n = 0; n < 400; n++) {
        const intact *f = &files[n % KINDS];
        tc_container c = f->c;
        int l = (int)test_random_int(&r, c.base, c.levels - 1);
        tc_level_record *record = &c.record[l];
        uint8_t model[700];
        size_t size = record->model_size < sizeof model ? record->model_size : sizeof model;
        memcpy(model, record->model, size);
        if (n % 3 == 0) /* all random */
            size = (size_t)test_random_int(&r, 0, sizeof model);
        for (size_t i = 0; i < size && n % 3 != 2; i++)
            if (n % 3 == 0 || i == (size_t)n % size)
                model[i] = (uint8_t)test_random_bits(&r);
        if (n % 3 == 2)
            record->coder = (tc_coder)(((int)record->coder + 1 + n / 3 % 3) % TC_CODERS);
        if (n % 7 == 0)
            record->mask = !record->mask;
        record->correction_step = (int32_t)test_random_int(&r, 1, TC_MAX_STEP);
        record->correction_snap = (int32_t)test_random_int(&r, 1, 20);
        record->model = model, record->model_size = size;
        assert_int_equal(try_head(f, &c, true), TC_OK);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(impossible_values_are_refused),
        cmocka_unit_test(endless_sizes_take_no_memory),
        cmocka_unit_test(random_models_do_no_harm),
        cmocka_unit_test(random_heads_do_no_harm),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
