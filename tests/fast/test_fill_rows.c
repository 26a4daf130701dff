/* test_fill_rows.c - filling by rows: smooth, within range, nothing else touched, and the same however it is cut. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/fill.h"
#include "tests/support/memory_rows.h"

typedef bool (*shape)(int64_t x, int64_t y);

static float harmonic(int64_t x, int64_t y)
{
    return 500 * sinf(0.02f * (float)x) * coshf(0.02f * (float)y - 1.5f);
}
static float ramp(int64_t x, int64_t y)
{
    return 1000 + 2 * (float)x - (float)y;
}
static float rough(int64_t x, int64_t y)
{
    return (float)(((uint64_t)(x * 7919 + y * 104729) * 6364136223846793005u >> 40) % 100000) * 0.0371f - 1000;
}
static float constant(int64_t x, int64_t y)
{
    return (void)x, (void)y, 1234.567f;
}

static bool none(int64_t x, int64_t y)
{
    return (void)x, (void)y, false;
}
static bool all(int64_t x, int64_t y)
{
    return (void)x, (void)y, true;
}
static bool all_but_one(int64_t x, int64_t y)
{
    return x != 5 || y != 9;
}
static bool disc(int64_t x, int64_t y)
{
    return (x - 70) * (x - 70) + (y - 65) * (y - 65) < 50 * 50;
}
static bool checkerboard(int64_t x, int64_t y)
{
    return (x + y) % 2;
}
static bool whole_rows(int64_t x, int64_t y)
{
    return (void)x, (y >= 3 && y < 31) || y == 33 || y > 90;
}
static bool whole_columns(int64_t x, int64_t y)
{
    return (void)y, x < 7 || (x > 40 && x < 90) || x == 100;
}
static bool corner(int64_t x, int64_t y)
{
    return x + y < 60;
}
static bool maze(int64_t x, int64_t y)
{
    return (x % 4 == 0 && y % 64 != 1) || (y % 8 == 3 && x % 3 != 0);
}
static bool few(int64_t x, int64_t y)
{
    return x == 60 && (y == 0 || y == 50 || y == 52 || y == 53);
}
static bool even_only(int64_t x, int64_t y)
{
    return x % 2 == 0 || y % 2 == 0; /* no valid sample is at a coarser one's place */
}
static const shape shapes[] = {all_but_one, disc, checkerboard, whole_rows, whole_columns,
                               corner,      maze, few,          even_only};
enum { SHAPES = sizeof shapes / sizeof *shapes };

typedef struct field {
    int64_t width, height, voids;
    float *z, *given;
    uint8_t *is_void;
} field;

static field make_field(int64_t width, int64_t height, float (*surface)(int64_t, int64_t), shape s)
{
    size_t count = (size_t)(width * height);
    field f = {width, height, 0, malloc(count * sizeof(float)), malloc(count * sizeof(float)), malloc(count)};
    for (int64_t i = 0; i < width * height; i++) {
        bool last = i == width * height - 1 && s != all; /* one valid sample in any case */
        f.is_void[i] = !last && s(i % width, i / width);
        f.voids += f.is_void[i];
        f.given[i] = f.is_void[i] ? NAN : surface(i % width, i / width);
    }
    memcpy(f.z, f.given, count * sizeof(float));
    return f;
}

static void free_field(field *f)
{
    free(f->z), free(f->given), free(f->is_void);
}

/* Fills and checks what always holds; what was read and written is in *store. */
static void fill_and_check(field *f, tc_fill_options options, row_store *store)
{
    memcpy(f->z, f->given, (size_t)(f->width * f->height) * sizeof(float));
    tc_fill_rows rows = row_store_begin(store, f->z, f->width, f->height);
    assert_int_equal(tc_fill_void_rows(&rows, row_store_scratch, store, &options), TC_OK);
    row_store_end(store);
    float low = INFINITY, high = -INFINITY;
    int64_t void_rows = 0;
    for (int64_t y = 0; y < f->height; y++) {
        bool voids = false;
        for (int64_t i = y * f->width; i < (y + 1) * f->width; i++) {
            voids |= f->is_void[i];
            if (f->is_void[i])
                continue;
            assert_memory_equal(&f->z[i], &f->given[i], sizeof(float));
            low = fminf(low, f->z[i]);
            high = fmaxf(high, f->z[i]);
        }
        void_rows += voids;
    }
    for (int64_t i = 0; i < f->width * f->height; i++)
        assert_true(f->z[i] >= low && f->z[i] <= high);
    assert_int_equal(store->rows_written, void_rows);
    assert_true(store->rows_read <= f->height + 3 * void_rows);
    /* A third, but for the halves that odd sizes are rounded up by. */
    assert_true(3 * store->scratch_samples <= f->width * f->height + 4 * (f->width + f->height) + 64);
}

static void is_the_same_however_cut(void **state)
{
    (void)state;
    for (int s = 0; s < SHAPES; s++) {
        for (int64_t samples = 20000; samples > 0; samples /= 8) {
            field f = make_field(141, 128, rough, shapes[s]);
            size_t bytes = (size_t)(f.width * f.height) * sizeof(float);
            float *first = malloc(bytes);
            for (int64_t rows = 0; rows < 200; rows = 2 * rows + 1) {
                row_store store;
                fill_and_check(&f, (tc_fill_options){samples, rows}, &store);
                if (rows == 0)
                    memcpy(first, f.z, bytes);
                assert_memory_equal(first, f.z, bytes);
            }
            free(first);
            free_field(&f);
        }
    }
}

/* What fits memory is filled there. */
static void is_the_membrane_where_all_fits(void **state)
{
    (void)state;
    for (int s = 0; s < SHAPES; s++) {
        field f = make_field(141, 128, rough, shapes[s]);
        row_store store;
        fill_and_check(&f, (tc_fill_options){141 * 128, 0}, &store);
        assert_int_equal(store.scratch_samples, 0);
        assert_int_equal(tc_fill_voids(f.given, f.is_void, f.width, f.height), TC_OK);
        assert_memory_equal(f.z, f.given, (size_t)(f.width * f.height) * sizeof(float));
        free_field(&f);
    }
}

static float largest_difference(const field *f, float (*surface)(int64_t, int64_t))
{
    float largest = 0;
    for (int64_t i = 0; i < f->width * f->height; i++)
        largest = fmaxf(largest, fabsf(f->z[i] - surface(i % f->width, i / f->width)));
    return largest;
}

static void is_smooth_over_holes(void **state)
{
    (void)state;
    const float relief = 2 * 500 * 2.9f;
    for (int64_t samples = 10000; samples >= 100; samples /= 10) {
        field f = make_field(141, 128, harmonic, disc);
        row_store store;
        fill_and_check(&f, (tc_fill_options){samples, 0}, &store);
        float difference = largest_difference(&f, harmonic);
        /* Second differences across the border and within, against the surface's own, at most 1.2. */
        float bend = 0;
        for (int64_t i = f.width; i < f.width * (f.height - 1); i++)
            if (i % f.width > 0 && i % f.width < f.width - 1)
                bend = fmaxf(bend, fmaxf(fabsf(f.z[i - 1] + f.z[i + 1] - 2 * f.z[i]),
                                         fabsf(f.z[i - f.width] + f.z[i + f.width] - 2 * f.z[i])));
        print_message("%lld samples in memory: off by %.1f of %.0f m, bent by %.1f m\n", (long long)samples,
                      (double)difference, (double)relief, (double)bend);
        assert_true(difference < 0.15f * relief);
        assert_true(bend < 20);
        free_field(&f);
    }
}

static void constants_stay_exact(void **state)
{
    (void)state;
    for (int s = 0; s < SHAPES; s++) {
        field f = make_field(130, 97, constant, shapes[s]);
        row_store store;
        fill_and_check(&f, (tc_fill_options){50, 0}, &store);
        assert_true(largest_difference(&f, constant) == 0);
        free_field(&f);
    }
}

static void odd_sizes(void **state)
{
    (void)state;
    const int64_t sizes[][2] = {{1, 1}, {1, 2},  {2, 1},   {1, 40},   {40, 1},   {2, 2},   {3, 3},
                                {7, 2}, {2, 19}, {33, 65}, {3000, 3}, {3, 3000}, {301, 17}};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        for (int s = 0; s < SHAPES; s++) {
            field f = make_field(sizes[n][0], sizes[n][1], ramp, shapes[s]);
            row_store store;
            fill_and_check(&f, (tc_fill_options){1, 0}, &store);
            fill_and_check(&f, (tc_fill_options){7, 1}, &store);
            free_field(&f);
        }
    }
}

static void nothing_to_fill(void **state)
{
    (void)state;
    field f = make_field(200, 100, ramp, none);
    row_store store;
    fill_and_check(&f, (tc_fill_options){1000, 0}, &store);
    assert_int_equal(store.rows_read, 100);
    free_field(&f);
}

static void nothing_to_fill_from(void **state)
{
    (void)state;
    for (int64_t samples = 1; samples < 100000; samples *= 10) {
        field f = make_field(141, 128, ramp, all);
        row_store store;
        tc_fill_rows rows = row_store_begin(&store, f.z, f.width, f.height);
        tc_fill_options options = {samples, 0};
        assert_int_equal(tc_fill_void_rows(&rows, row_store_scratch, &store, &options), TC_ERR_USAGE);
        assert_int_equal(store.rows_written, 0);
        row_store_end(&store);
        free_field(&f);
    }
    float z = 0;
    row_store store;
    tc_fill_rows rows = row_store_begin(&store, &z, 1, 1);
    rows.width = 0;
    assert_int_equal(tc_fill_void_rows(&rows, row_store_scratch, &store, NULL), TC_ERR_USAGE);
}

/* Every call that can fail does, once; the status is passed on and nothing goes on after it. */
static void failures_are_passed_on(void **state)
{
    (void)state;
    field f = make_field(141, 128, ramp, disc);
    tc_fill_options options = {600, 20};
    row_store store;
    fill_and_check(&f, options, &store);
    int64_t calls = store.calls;
    assert_true(calls > 30);
    for (int64_t n = 1; n <= calls; n++) {
        memcpy(f.z, f.given, (size_t)(f.width * f.height) * sizeof(float));
        tc_fill_rows rows = row_store_begin(&store, f.z, f.width, f.height);
        store.fail_at = n, store.failure = n % 2 ? TC_ERR_IO : TC_ERR_MEMORY;
        assert_int_equal(tc_fill_void_rows(&rows, row_store_scratch, &store, &options), store.failure);
        assert_int_equal(store.calls, n);
        row_store_end(&store);
    }
    free_field(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_same_however_cut),
        cmocka_unit_test(is_the_membrane_where_all_fits),
        cmocka_unit_test(is_smooth_over_holes),
        cmocka_unit_test(constants_stay_exact),
        cmocka_unit_test(odd_sizes),
        cmocka_unit_test(nothing_to_fill),
        cmocka_unit_test(nothing_to_fill_from),
        cmocka_unit_test(failures_are_passed_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
