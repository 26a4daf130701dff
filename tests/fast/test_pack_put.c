/* test_pack_put.c - how a terrain is put must not matter: any number of threads and any order give the same file, bytes
 * and all; overlaps, samples that are no heights, interruptions and failures do what terraclip.h says. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* ---- Orders ------------------------------------------------------------------------------------------------------ */

typedef enum order {
    AT_ONCE,
    ROWS_UP,
    ROWS_DOWN,
    COLUMNS,
    TILES,
    SCATTERED,   /* tiles in any order */
    OVERLAPPING, /* tiles with wide margins, in any order */
    ORDERS
} order;

static void put(tc_packer *packer, tc_rect r, const float *z, const uint8_t *v, int64_t width)
{
    tc_error error = {TC_OK, ""};
    if (tc_packer_put(packer, r, z + r.y0 * width + r.x0, v ? v + r.y0 * width + r.x0 : NULL, width, &error))
        fail_msg("%s", error.text);
}

static void put_all(tc_packer *packer, order how, const float *z, const uint8_t *v, int64_t w, int64_t h)
{
    static const int64_t steps[ORDERS][2] = {{0, 0}, {0, 1}, {0, 7}, {3, 0}, {37, 41}, {37, 41}, {50, 60}};
    int64_t across = steps[how][0] ? steps[how][0] : w, rows = steps[how][1] ? steps[how][1] : h;
    int64_t nx = (w + across - 1) / across, ny = (h + rows - 1) / rows, count = nx * ny;
    test_random r = {11};
    int64_t *turn = malloc((size_t)count * sizeof *turn);
    assert_non_null(turn);
    for (int64_t n = 0; n < count; n++)
        turn[n] = how == ROWS_DOWN ? count - 1 - n : n;
    for (int64_t n = count - 1; n > 0 && how >= SCATTERED; n--) {
        int64_t other = test_random_int(&r, 0, n), kept = turn[n];
        turn[n] = turn[other], turn[other] = kept;
    }
    int64_t margin = how == OVERLAPPING ? 23 : 0;
    for (int64_t n = 0; n < count; n++) {
        int64_t x = turn[n] % nx * across, y = turn[n] / nx * rows;
        tc_rect part = {tc_max64(x - margin, 0), tc_max64(y - margin, 0), tc_min64(x + across + margin, w),
                        tc_min64(y + rows + margin, h)};
        put(packer, part, z, v, w);
    }
    free(turn);
}

static uint8_t *pack_in_order(const packing *p, order how, size_t *size_ret)
{
    const char *path = made_path("order.tclip");
    tc_pack_terrain terrain = packing_terrain(p);
    tc_pack_options options = packing_options(p);
    tc_packer *packer;
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    uint8_t *v;
    float *z = packing_heights(p, &v);
    assert_int_equal(tc_packer_create(path, &terrain, &options, &packer, &error), TC_OK);
    put_all(packer, how, z, v, p->width, p->height);
    if (tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    assert_int_equal(result.disagreeing, 0);
    tc_packer_destroy(packer);
    free(z), free(v);
    return packing_bytes(path, size_ret);
}

static void order_and_threads_do_not_matter(void **state)
{
    (void)state;
    for (int k = 0; k < 5; k++) {
        packing p = {
            .width = 301, .height = 200, .kind = k ? PACKING_INTEGERS : PACKING_HILLS, .error = k == 1 ? 7 : 2};
        p.max_error = k == 4 ? 6 : 0;
        p.type = k ? TC_SAMPLE_INT16 : TC_SAMPLE_FLOAT32, p.offset = k == 2 ? 100000 : 0;
        p.voids = k % 2 ? PACKING_LAKES : PACKING_WHOLE;
        p.mode = k < 3 ? (tc_pack_mode)k : TC_PACK_RMS, p.codec = k == 3 ? TC_CODEC_LH04 : TC_CODEC_LIFTING;
        p.threads = 1;
        size_t size, other_size;
        uint8_t *first = pack_in_order(&p, AT_ONCE, &size);
        static const int threads[] = {2, 5, 0};
        for (int n = 1; n < ORDERS + 3; n += k ? 3 : 1) {
            p.threads = n < ORDERS ? 1 : threads[n - ORDERS];
            uint8_t *other = pack_in_order(&p, n < ORDERS ? (order)n : AT_ONCE, &other_size);
            if (size != other_size || memcmp(first, other, size))
                fail_msg("terrain %d, order or threads %d: another file", k, n);
            free(other);
        }
        free(first);
    }
}

/* ---- Samples ----------------------------------------------------------------------------------------------------- */

static tc_packer *begin(const packing *p, const char *path, const tc_pack_options *options)
{
    tc_pack_terrain terrain = packing_terrain(p);
    tc_packer *packer = NULL;
    tc_error error = {TC_OK, ""};
    if (tc_packer_create(path, &terrain, options, &packer, &error))
        fail_msg("%s", error.text);
    return packer;
}

static void first_heights_hold(void **state)
{
    (void)state;
    packing p = {.width = 70, .height = 50, .mode = TC_PACK_LOSSLESS, .type = TC_SAMPLE_FLOAT32};
    const char *path = made_path("overlap.tclip");
    tc_pack_options options = packing_options(&p);
    tc_packer *packer = begin(&p, path, &options);
    float *a = malloc(70 * 50 * sizeof *a), *b = malloc(70 * 50 * sizeof *b);
    uint8_t *v = calloc(70, 50);
    for (int i = 0; i < 70 * 50; i++)
        a[i] = (float)(i % 70), b[i] = i % 7 ? a[i] : a[i] + 3;
    v[5] = 1, a[6] = NAN, a[8] = INFINITY, a[9] = -INFINITY, a[10] = 0;
    tc_rect left = {0, 0, 40, 50}, right = {30, 0, 70, 49};
    put(packer, left, a, v, 70);
    put(packer, right, b, NULL, 70);
    put(packer, (tc_rect){0, 0, 40, 1}, b, NULL, 70); /* fills the voids of the first put */
    put(packer, (tc_rect){7, 7, 7, 9}, b, NULL, 70);  /* nothing */
    tc_error error = {TC_OK, ""};
    const tc_rect outside[] = {{-1, 0, 4, 4}, {0, 0, 71, 1}, {0, 49, 1, 51}, {0, INT64_MIN, 70, INT64_MAX}};
    for (size_t k = 0; k < 4; k++)
        assert_int_equal(tc_packer_put(packer, outside[k], a, NULL, 70, &error), TC_ERR_USAGE);
    tc_pack_result result;
    if (tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    int64_t disagreeing = 0;
    double largest = 0;
    for (int i = 0; i < 70 * 49; i++) {
        bool twice = i % 70 >= 30 && i % 70 < 40 && a[i] != b[i], again = i < 40 && !v[i] && a[i] != b[i];
        disagreeing += twice + (again && isfinite(a[i]));
        largest = fmax(largest, twice || (again && isfinite(a[i])) ? fabs((double)a[i] - b[i]) : 0);
    }
    assert_int_equal(result.disagreeing, disagreeing);
    assert_true(result.largest_disagreement == largest && largest == 10);
    assert_int_equal(result.voids, 30); /* the last row's right part was never given */
    assert_true(result.rms == 0 && result.max_error == 0);
    tc_field *file;
    assert_int_equal(tc_field_open(path, NULL, &file, NULL), TC_OK);
    uint8_t *mask;
    float *z = packing_read(file, tc_field_info(file)->levels, &mask);
    for (int i = 0; i < 70 * 50; i++) {
        bool was_left = i % 70 < 40 && isfinite(a[i]) && !v[i];
        assert_int_equal(mask[i], i / 70 == 49 && i % 70 >= 40);
        if (!mask[i] && z[i] != (was_left ? a[i] : b[i]))
            fail_msg("sample %d is %g", i, z[i]);
    }
    tc_field_destroy(file);
    free(a), free(b), free(v), free(z), free(mask);
}

/* ---- Stopping and failing ---------------------------------------------------------------------------------------- */

typedef struct patience {
    int calls, last;
    double done;
    bool backwards;
} patience;

static bool on_progress(void *context, double done)
{
    patience *p = context;
    p->backwards |= done < p->done || done < 0 || done > 1;
    p->done = done;
    return ++p->calls != p->last;
}

static void assert_old_file(const char *path)
{
    size_t size = 0;
    uint8_t *bytes = packing_bytes(path, &size);
    assert_true(bytes && size == 3 && !memcmp(bytes, "old", 3));
    free(bytes);
}

/* Stopped at every call of the progress function in turn. */
static void stopping_leaves_nothing(void **state)
{
    (void)state;
    for (int k = 0; k < 5; k++) {
        packing p = {.width = 140, .height = 60, .kind = PACKING_HILLS, .voids = PACKING_LAKES, .error = 2};
        p.max_error = k == 4 ? 8 : 0;
        p.type = TC_SAMPLE_FLOAT32, p.mode = k == 1 ? TC_PACK_MAX_ERROR : k == 2 ? TC_PACK_LOSSLESS : TC_PACK_RMS;
        p.codec = k == 3 ? TC_CODEC_LH04 : TC_CODEC_LIFTING, p.kind = k == 2 ? PACKING_INTEGERS : PACKING_HILLS;
        uint8_t *v;
        float *z = packing_heights(&p, &v);
        const char *path = made_path("stopped.tclip");
        made_folder_remove();
        path = made_path("stopped.tclip");
        bool finished = false;
        for (int last = 1; !finished; last += last < 8 ? 1 : 5) {
            patience patient = {.last = last};
            tc_pack_options options = packing_options(&p);
            options.progress = on_progress, options.progress_context = &patient;
            bool old = last % 2;
            unlink(path);
            if (old)
                make_bytes(path, "old", 3);
            tc_packer *packer = begin(&p, path, &options);
            tc_pack_result result = {.bytes = -1};
            tc_error error = {TC_OK, ""};
            tc_status status = TC_OK;
            for (int64_t y = 0; y < p.height && !status; y += 50)
                status = tc_packer_put(packer, (tc_rect){0, y, p.width, tc_min64(y + 50, p.height)}, z + y * p.width,
                                       v + y * p.width, p.width, &error);
            if (!status)
                status = tc_packer_finish(packer, &result, &error);
            assert_true(made_folder_count() == (old || !status));
            tc_packer_destroy(packer);
            finished = !status;
            assert_int_equal(patient.backwards, false);
            if (finished) {
                assert_true(patient.calls < last && last > 6 && patient.done > 0.5);
                break;
            }
            assert_true(status == TC_ERR_IO && patient.calls == last && result.bytes == -1 && error.text[0]);
            assert_int_equal(made_folder_count(), old);
            if (old)
                assert_old_file(path);
        }
        free(z), free(v);
    }
}

static void what_cannot_be_written_is_refused(void **state)
{
    (void)state;
    packing p = {.width = 60, .height = 60, .kind = PACKING_HILLS, .error = 1, .type = TC_SAMPLE_FLOAT32};
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    made_folder_remove();
    char path[600];
    snprintf(path, sizeof path, "%s/no/such.tclip", made_folder());
    assert_int_equal(packing_write(&p, path, &result, &error), TC_ERR_IO);
    assert_int_equal(packing_write(&p, made_folder(), &result, &error), TC_ERR_IO);
    assert_int_equal(packing_write(&p, "/dev/null", &result, &error), TC_ERR_IO);
    assert_int_equal(packing_write(&p, "", &result, &error), TC_ERR_IO);
    assert_int_equal(made_folder_count(), 0);

    /* More than any disk holds, and more than 64 bits can count. */
    const int64_t sizes[][2] = {{INT64_C(1) << 31, INT64_C(1) << 31},
                                {INT64_C(1) << 31, 1 << 30},
                                {1 << 30, 1 << 29},
                                {INT64_C(1) << 32, 1},
                                {0, 5},
                                {5, -1}};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        p.width = sizes[n][0], p.height = sizes[n][1];
        tc_pack_terrain terrain = packing_terrain(&p);
        tc_pack_options options = packing_options(&p);
        tc_packer *packer = NULL;
        error = (tc_error){TC_OK, ""};
        tc_status status = tc_packer_create(made_path("large.tclip"), &terrain, &options, &packer, &error);
        if (status != (n < 3 ? TC_ERR_IO : TC_ERR_USAGE) || packer || !error.text[0])
            fail_msg("%d: status %d, '%s'", (int)n, status, error.text);
        assert_int_equal(made_folder_count(), 0);
    }
    /* A name that is a link is written through. */
    p.width = 60, p.height = 60;
    char target[600];
    snprintf(target, sizeof target, "%s", made_path("target.tclip"));
    make_bytes(target, "old", 3);
    assert_int_equal(symlink("target.tclip", made_path("link.tclip")), 0);
    assert_int_equal(packing_write(&p, made_path("link.tclip"), &result, &error), TC_OK);
    struct stat about;
    assert_true(!lstat(made_path("link.tclip"), &about) && S_ISLNK(about.st_mode));
    assert_true(!stat(target, &about) && about.st_size == result.bytes && made_folder_count() == 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_and_threads_do_not_matter),
        cmocka_unit_test(first_heights_hold),
        cmocka_unit_test(stopping_leaves_nothing),
        cmocka_unit_test(what_cannot_be_written_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
