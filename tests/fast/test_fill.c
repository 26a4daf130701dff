/* test_fill.c - voids: smooth, within range, and nothing else touched. */
#include "tests/support/test.h"

#include "common/field/fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct field {
    int64_t width, height;
    float *z, *original;
    uint8_t *voids;
} field;

static field make_field(int64_t width, int64_t height, float (*surface)(int64_t, int64_t),
                        bool (*is_void)(int64_t, int64_t))
{
    size_t count = (size_t)(width * height);
    field f = {width, height, malloc(count * sizeof(float)), malloc(count * sizeof(float)), malloc(count)};
    for (int64_t y = 0; y < height; y++) {
        for (int64_t x = 0; x < width; x++) {
            int64_t i = y * width + x;
            f.original[i] = surface(x, y);
            f.voids[i] = is_void(x, y);
            f.z[i] = f.voids[i] ? NAN : f.original[i];
        }
    }
    return f;
}

static void free_field(field *f)
{
    free(f->z);
    free(f->original);
    free(f->voids);
}

/* Fills and checks what always holds: valid samples as they were, filled ones within the range of valid ones. The
 * largest distance from the surface that the voids were cut from. */
static float fill_and_check(field *f)
{
    assert_int_equal(tc_fill_voids(f->z, f->voids, f->width, f->height), TC_OK);
    float low = INFINITY, high = -INFINITY, largest = 0;
    for (int64_t i = 0; i < f->width * f->height; i++) {
        if (f->voids[i])
            continue;
        assert_memory_equal(&f->z[i], &f->original[i], sizeof(float));
        low = fminf(low, f->z[i]);
        high = fmaxf(high, f->z[i]);
    }
    for (int64_t i = 0; i < f->width * f->height; i++) {
        assert_true(f->z[i] >= low && f->z[i] <= high);
        largest = fmaxf(largest, fabsf(f->z[i] - f->original[i]));
    }
    return largest;
}

/* Largest distance of a filled sample from the mean of its neighbours: 0 for a membrane. */
static double roughness(const field *f)
{
    double largest = 0;
    for (int64_t y = 0; y < f->height; y++) {
        for (int64_t x = 0; x < f->width; x++) {
            int64_t i = y * f->width + x;
            if (!f->voids[i])
                continue;
            double sum = 0;
            int sides = 0;
            if (x > 0)
                sum += f->z[i - 1], sides++;
            if (x + 1 < f->width)
                sum += f->z[i + 1], sides++;
            if (y > 0)
                sum += f->z[i - f->width], sides++;
            if (y + 1 < f->height)
                sum += f->z[i + f->width], sides++;
            largest = fmax(largest, fabs(f->z[i] - sum / fmax(sides, 1)));
        }
    }
    return largest;
}

static float ramp(int64_t x, int64_t y)
{
    return 1000 + 2 * (float)x - (float)y;
}
static float constant(int64_t x, int64_t y)
{
    return (void)x, (void)y, 1234.567f;
}
static float cliff(int64_t x, int64_t y)
{
    return (void)y, x < 32 ? 0.f : 1000.f;
}
/* Harmonic, so that a membrane over a hole of any shape is the surface itself. */
static float harmonic(int64_t x, int64_t y)
{
    return 500 * sinf(0.02f * (float)x) * coshf(0.02f * (float)y - 1.5f);
}

static bool disc(int64_t x, int64_t y)
{
    return (x - 70) * (x - 70) + (y - 65) * (y - 65) < 50 * 50;
}
static bool checkerboard(int64_t x, int64_t y)
{
    return (x + y) % 2;
}
static bool all_but_one(int64_t x, int64_t y)
{
    return x != 5 || y != 9;
}
static bool all(int64_t x, int64_t y)
{
    return (void)x, (void)y, true;
}
static bool corner(int64_t x, int64_t y)
{
    return x + y < 60;
}
static bool band(int64_t x, int64_t y)
{
    return (void)y, x >= 20 && x < 44;
}
static bool maze(int64_t x, int64_t y)
{
    return (x % 4 == 0 && y % 64 != 1) || (y % 8 == 3 && x % 3 != 0);
}
static bool few(int64_t x, int64_t y)
{
    return (x * 7919 + y * 104729) % 4801 == 0;
}
static bool some(int64_t x, int64_t y)
{
    return (x % 24 == 3 && y % 17 < 5) || (x > 30 && x < 90 && y > 40 && y < 95);
}

/* At the border of the raster a membrane is free, here it must be held to be the surface. */
static void hold_border(field *f)
{
    for (int64_t i = 0; i < f->width * f->height; i++) {
        int64_t x = i % f->width, y = i / f->width;
        if (x > 0 && y > 0 && x < f->width - 1 && y < f->height - 1)
            continue;
        f->voids[i] = 0;
        f->z[i] = f->original[i];
    }
}

static void smooth_over_holes(void **state)
{
    (void)state;
    bool (*const shapes[])(int64_t, int64_t) = {disc, checkerboard, band, maze, some, few, all};
    const float relief = 2 * 500 * 2.9f;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        field f = make_field(141, 128, harmonic, shapes[s]);
        hold_border(&f);
        assert_true(fill_and_check(&f) < 2e-3f * relief);
        assert_true(roughness(&f) < 1e-4 * relief);
        free_field(&f);
    }
}

static void ramps_stay_ramps(void **state)
{
    (void)state;
    field f = make_field(141, 128, ramp, disc);
    assert_true(fill_and_check(&f) < 0.1f);
    free_field(&f);
}

static void constants_stay_exact(void **state)
{
    (void)state;
    bool (*const shapes[])(int64_t, int64_t) = {disc, checkerboard, all_but_one, corner, maze};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        field f = make_field(130, 97, constant, shapes[s]);
        assert_true(fill_and_check(&f) == 0);
        free_field(&f);
    }
}

/* Between two heights the fill climbs steadily: no wall, no step, no overshoot. */
static void cliffs_become_slopes(void **state)
{
    (void)state;
    field f = make_field(64, 50, cliff, band);
    fill_and_check(&f);
    for (int64_t y = 0; y < f.height; y++)
        for (int64_t x = 20; x <= 44; x++)
            assert_float_equal(f.z[y * f.width + x] - f.z[y * f.width + x - 1], 1000. / 25, 1);
    free_field(&f);
}

static void odd_sizes(void **state)
{
    (void)state;
    const int64_t sizes[][2] = {{1, 2}, {2, 1}, {1, 40}, {40, 1}, {2, 2}, {3, 3}, {7, 2}, {33, 65}, {70000, 3}};
    bool (*const shapes[])(int64_t, int64_t) = {checkerboard, corner, maze, some};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
            field f = make_field(sizes[s][0], sizes[s][1], ramp, shapes[k]);
            int64_t last = f.width * f.height - 1; /* one valid sample in any case */
            f.voids[last] = 0;
            f.z[last] = f.original[last];
            fill_and_check(&f);
            free_field(&f);
        }
    }
    field f = make_field(30, 20, ramp, all);
    assert_int_equal(tc_fill_voids(f.z, f.voids, 30, 20), TC_ERR_USAGE);
    assert_int_equal(tc_fill_voids(f.z, f.voids, 1, 1), TC_ERR_USAGE);
    free_field(&f);
}

static void few_voids_cost_next_to_nothing(void **state)
{
    (void)state;
    field f = make_field(4801, 4801, ramp, few);
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    assert_int_equal(tc_fill_voids(f.z, f.voids, f.width, f.height), TC_OK);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    double seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    print_message("4801 voids in 4801 x 4801: %.3f s\n", seconds);
    assert_true(seconds < 0.5); /* 0.02 s measured; room for sanitizers */
    free_field(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_over_holes),
        cmocka_unit_test(ramps_stay_ramps),
        cmocka_unit_test(constants_stay_exact),
        cmocka_unit_test(cliffs_become_slopes),
        cmocka_unit_test(odd_sizes),
        cmocka_unit_test(few_voids_cost_next_to_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
