/* extreme_filters.c - the pyramid's filters repeated more often than any terrain has levels.
 *
 * U is LH04's four-point subdivision, linear interpolation to the fourth order (Dubuc 1986; Deslauriers, Dubuc 1989).
 * Repeated k times it is again a linear operator, whose sup norm, the largest sum of magnitudes of what a fine sample
 * takes of the coarse ones, is its Lebesgue constant: no noise grows by more, and one grows by just as much. It is
 * worked out here from the mask alone, borders included, and in two dimensions it is squared, since the operator is a
 * tensor product. D has a norm likewise, found from what each coarse sample takes of the fine ones. */
#include "tests/support/extreme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/codec/lifting/lifting.h"
#include "tests/support/packed.h"

enum { TIMES = 16, COARSE = 12, NOISES = 40 };

/* ---- What must come out, in double ------------------------------------------------------------------------------ */

/* Value of sample i of n: beyond a border the straight line of the last two goes on, or the other side. */
static double at(const double *x, int64_t n, int64_t i, bool wraps)
{
    if (wraps)
        return x[((i % n) + n) % n];
    return i < 0    ? x[0] + (double)i * (x[1] - x[0])
           : i >= n ? x[n - 1] + (double)(i - n + 1) * (x[n - 1] - x[n - 2])
                    : x[i];
}

/* U, `times` times: n samples become n << times, the caller's to free. */
static double *subdivided(const double *x, int64_t n, bool wraps, int times)
{
    double *from = packed_memory((size_t)n * sizeof *from);
    memcpy(from, x, (size_t)n * sizeof *from);
    for (; times > 0; times--, n *= 2) {
        double *to = packed_memory(2 * (size_t)n * sizeof *to);
        for (int64_t i = 0; i < n; i++) {
            to[2 * i] = from[i];
            to[2 * i + 1] =
                (9 * (from[i] + at(from, n, i + 1, wraps)) - at(from, n, i - 1, wraps) - at(from, n, i + 2, wraps)) /
                16;
        }
        free(from);
        from = to;
    }
    return from;
}

/* The norm of U repeated, and the coarse samples, each 1 or -1, that it makes so much of, and where. */
typedef struct worst {
    double norm, x[COARSE];
    int64_t where;
} worst;

static worst norm_of_subdivision(bool wraps)
{
    const int64_t fine = (int64_t)COARSE << TIMES;
    double *answer[COARSE];
    for (int k = 0; k < COARSE; k++) {
        double unit[COARSE] = {0};
        unit[k] = 1;
        answer[k] = subdivided(unit, COARSE, wraps, TIMES);
    }
    worst w = {0};
    for (int64_t i = 0; i < fine; i++) {
        double sum = 0;
        for (int k = 0; k < COARSE; k++)
            sum += fabs(answer[k][i]);
        if (sum > w.norm)
            w.norm = sum, w.where = i;
    }
    for (int k = 0; k < COARSE; k++) {
        w.x[k] = answer[k][w.where] < 0 ? -1 : 1;
        free(answer[k]);
    }
    return w;
}

/* Adds `weight` times even sample i of `evens` to what a coarse sample takes of the fine ones. */
static void take_even(double *fine, int64_t evens, int64_t i, bool wraps, double weight)
{
    if (wraps)
        fine[2 * (((i % evens) + evens) % evens)] += weight;
    else if (i < 0)
        fine[0] += weight * (double)(1 - i), fine[2] += weight * (double)i;
    else if (i >= evens)
        fine[2 * (evens - 1)] += weight * (double)(i - evens + 2),
            fine[2 * (evens - 2)] -= weight * (double)(i - evens + 1);
    else
        fine[2 * i] += weight;
}

/* What a mixture of n coarse samples takes of 2n fine ones by D (filter.c: two weights on four details). */
static double *taken(const double *coarse, int64_t n, bool wraps)
{
    static const double update[4] = {-3. / 64, 19. / 64, 19. / 64, -3. / 64};
    double *fine = packed_memory(2 * (size_t)n * sizeof *fine);
    for (int64_t i = 0; i < n; i++) {
        if (coarse[i] == 0)
            continue;
        take_even(fine, n, i, wraps, coarse[i]);
        for (int k = 0; k < 4; k++) {
            int64_t d = i - 2 + k;
            double weight = coarse[i] * update[k];
            if (!wraps && (d < 0 || d >= n))
                continue;
            d = ((d % n) + n) % n;
            fine[2 * d + 1] += weight;
            take_even(fine, n, d, wraps, -9. / 16 * weight), take_even(fine, n, d + 1, wraps, -9. / 16 * weight);
            take_even(fine, n, d - 1, wraps, weight / 16), take_even(fine, n, d + 2, wraps, weight / 16);
        }
    }
    return fine;
}

/* The norm of D repeated, and the fine samples that it makes so much of, the caller's to free. */
static double norm_of_filtering(bool wraps, float **worst_ret)
{
    const int64_t fine = (int64_t)COARSE << TIMES;
    double norm = 0;
    *worst_ret = packed_memory((size_t)fine * sizeof **worst_ret);
    for (int k = 0; k < COARSE; k++) {
        double *row = packed_memory(COARSE * sizeof *row), sum = 0;
        row[k] = 1;
        for (int64_t n = COARSE; n < fine; n *= 2) {
            double *next = taken(row, n, wraps);
            free(row);
            row = next;
        }
        for (int64_t i = 0; i < fine; i++)
            sum += fabs(row[i]);
        for (int64_t i = 0; sum > norm && i < fine; i++)
            (*worst_ret)[i] = row[i] < 0 ? -1 : 1;
        norm = fmax(norm, sum);
        free(row);
    }
    return norm;
}

/* ---- U in float (filter.h) along one axis ----------------------------------------------------------------------- */

/* Repeats the product's U on the coarse samples, with borders as the pyramid has them; the caller's to free. */
static float *float_subdivided(const float *x, int64_t n, bool wraps, int times)
{
    float *from = packed_memory((size_t)(n + 3) * sizeof *from);
    memcpy(from + 1, x, (size_t)n * sizeof *x);
    for (; times > 0; times--, n *= 2) {
        float *to = packed_memory((size_t)(2 * n + 3) * sizeof *to), *c = from + 1;
        c[-1] = wraps ? c[n - 1] : c[0] - (c[1] - c[0]);
        c[n] = wraps ? c[0] : c[n - 1] + (c[n - 1] - c[n - 2]);
        c[n + 1] = wraps ? c[1] : c[n - 1] + 2 * (c[n - 1] - c[n - 2]);
        tc_upsample_1d(c, 1, n, to + 1, 1);
        free(from);
        from = to;
    }
    memmove(from, from + 1, (size_t)n * sizeof *from);
    return from;
}

static double largest(const float *x, int64_t n)
{
    double most = 0;
    for (int64_t i = 0; i < n; i++)
        most = isfinite(x[i]) ? fmax(most, fabs((double)x[i])) : INFINITY;
    return most;
}

static void one_axis(const worst *w, bool wraps)
{
    const int64_t fine = (int64_t)COARSE << TIMES;
    double most = 0, rough = 0;
    test_random r = {1};
    for (int k = 0; k < NOISES; k++) {
        float x[COARSE];
        for (int i = 0; i < COARSE; i++)
            x[i] = k == 0                     ? (float)w->x[i]
                   : k % 2                    ? (float)test_random_range(&r, -1, 1)
                   : test_random_bits(&r) & 1 ? 1
                                              : -1;
        float *z = float_subdivided(x, COARSE, wraps, TIMES);
        double growth = largest(z, fine) / largest(x, COARSE);
        free(z);
        if (k == 0)
            rough = growth;
        else
            most = fmax(most, growth);
    }
    extreme_at_most(wraps ? "U 16 times on noise, round a globe" : "U 16 times on noise, with borders", "growth, times",
                    most, w->norm * (1 + 1e-5), "%d noises; the Lebesgue constant is %.6f", NOISES - 1, w->norm);
    extreme_at_most(
        wraps ? "U 16 times on the worst noise, round a globe" : "U 16 times on the worst noise, with borders",
        "growth less the Lebesgue constant", fabs(rough - w->norm), 1e-5, "the bound is attained: %.6f", rough);
}

/* ---- U in integers (lifting.h) in two dimensions ---------------------------------------------------------------- */

/* A part of a level. */
typedef struct window {
    tc_lifting_level level;
    tc_plane z;
} window;

static window whole(const int32_t *z, int64_t width, int64_t height, bool wraps)
{
    window w = {{width, height, wraps}, packed_plane((tc_rect){0, 0, width, height})};
    memcpy(w.z.z, z, (size_t)(width * height) * sizeof *z);
    return w;
}

/* From `from`, which is freed, to the part of the next finer level that holds as much as can be had of `want`. */
static window finer(window from, tc_rect want)
{
    window to = {.level = {2 * from.level.width, 2 * from.level.height, from.level.wrap_x}};
    tc_rect all = {0, 0, to.level.width, to.level.height};
    if (to.level.wrap_x)
        all.x0 = want.x0, all.x1 = want.x1;
    want = tc_rect_intersect(want, all);
    tc_rect need = tc_lifting_needs(&to.level, want);
    tc_plane ll = from.z, band[TC_BANDS];
    if (!tc_rect_within(need, ll.rect)) /* only where all of a level that wraps is held */
        ll = packed_wrapped(&from.z, need);
    for (int b = 0; b < TC_BANDS; b++)
        band[b] = packed_plane(need);
    to.z = packed_plane(want);
    int32_t *scratch = packed_memory(tc_lifting_synthesise_scratch(&to.level, want) * sizeof *scratch);
    tc_lifting_synthesise(&to.level, &ll, band, &to.z, scratch, TC_SIMD_AUTO);
    free(scratch);
    for (int b = 0; b < TC_BANDS; b++)
        free(band[b].z);
    if (ll.z != from.z.z)
        free(ll.z);
    free(from.z.z);
    return to;
}

enum { WHOLE_LEVELS = 4, HALF = 40 };

/* The largest magnitude met on the way down 16 levels to the place (x, y) of the finest: all of the first few levels,
 * a window of the others. */
static double descend(const int32_t *z, bool wraps, int64_t x, int64_t y)
{
    window w = whole(z, COARSE, COARSE, wraps);
    double most = 0;
    for (int k = 1; k <= TIMES; k++) {
        tc_rect want = {0, 0, (int64_t)COARSE << k, (int64_t)COARSE << k};
        int64_t px = x >> (TIMES - k), py = y >> (TIMES - k);
        if (k > WHOLE_LEVELS)
            want = (tc_rect){px - HALF, py - HALF, px + HALF, py + HALF};
        w = finer(w, want);
        for (int64_t i = 0; i < tc_rect_area(w.z.rect); i++)
            most = fmax(most, fabs((double)w.z.z[i]));
    }
    free(w.z.z);
    return most;
}

static void two_axes(const worst *across, const worst *along, bool wraps)
{
    const double amplitude = 1 << 20;
    const int64_t last = ((int64_t)COARSE << TIMES) - 1;
    /* A level rounds twice, half a unit each, once before the other axis' pass. */
    double norm = across->norm * along->norm, rounding = TIMES * (0.5 + 0.5 * 1.25) * norm / amplitude, most = 0,
           rough = 0;
    test_random r = {2};
    for (int k = 0; k < 12 * NOISES; k++) {
        int32_t z[COARSE * COARSE];
        for (int i = 0; i < COARSE * COARSE; i++) {
            double v = k == 0                     ? across->x[i % COARSE] * along->x[i / COARSE]
                       : k % 2                    ? test_random_range(&r, -1, 1)
                       : test_random_bits(&r) & 1 ? 1
                                                  : -1;
            z[i] = (int32_t)lrint(amplitude * v);
        }
        int64_t x = k % 3 ? test_random_int(&r, 0, last) : k / 3 & 1 ? last : 0; /* every third into a corner, */
        int64_t y = k % 3 ? test_random_int(&r, 0, last) : k / 6 & 1 ? last : 0;
        if (k % 3 == 1) /* or along a side */
            y = k & 1 ? last : 0;
        if (k == 0)
            x = across->where, y = along->where;
        double growth = descend(z, wraps, x, y) / amplitude;
        if (k == 0)
            rough = growth;
        else
            most = fmax(most, growth);
    }
    extreme_at_most(wraps ? "U 16 times on noise, two dimensions, round a globe"
                          : "U 16 times on noise, two dimensions",
                    "growth, times", most, norm + rounding, "%d noises; the Lebesgue constant squared is %.6f",
                    12 * NOISES - 1, norm);
    extreme_at_most(wraps ? "U 16 times on the worst noise, two dimensions, round a globe"
                          : "U 16 times on the worst noise, two dimensions",
                    "growth less the Lebesgue constant squared", fabs(rough - norm), rounding,
                    "the bound is attained: %.6f", rough);
}

/* ---- D, and D with U -------------------------------------------------------------------------------------------- */

/* D, 16 times, along one axis of a grid as long as that takes, rows or columns: how much `z` has grown, and how much
 * once U has been applied as often. */
static double filtered_down(const float *noise, bool columns, bool wraps, double *back_ret)
{
    int64_t n = (int64_t)COARSE << TIMES;
    float *z = packed_memory((size_t)n * sizeof *z);
    memcpy(z, noise, (size_t)n * sizeof *z);
    for (int k = 0; k < TIMES; k++, n /= 2) {
        int64_t width = columns ? 1 : n, height = columns ? n : 1, rows = tc_coarse_size(height);
        float *scratch = packed_memory(tc_downsample_scratch(width, rows) * sizeof *scratch);
        float *coarse = packed_memory((size_t)(n / 2) * sizeof *coarse);
        tc_downsample(z, width, height, wraps, 0, rows, coarse, scratch);
        free(scratch), free(z);
        z = coarse;
    }
    double most = largest(z, n);
    float *back = float_subdivided(z, n, wraps, TIMES);
    *back_ret = largest(back, n << TIMES);
    free(z), free(back);
    return most;
}

static void down_norms(const worst *up, bool wraps)
{
    const char *where = wraps ? "round a globe" : "with borders";
    float *noise;
    char name[100];
    double norm = norm_of_filtering(wraps, &noise), back, most = 0, most_back = 0;
    double down = filtered_down(noise, false, wraps, &back);
    snprintf(name, sizeof name, "D 16 times on the worst noise, %s", where);
    extreme_at_most(name, "growth less the norm", fabs(down - norm), 1e-3 * norm, "the norm is %.6f", norm);
    snprintf(name, sizeof name, "D 16 times on the worst noise, then U 16 times, %s", where);
    extreme_at_most(name, "growth, times", back, norm * up->norm * (1 + 1e-3), "norm of D repeated times that of U");
    test_random r = {3};
    for (int k = 0; k < 6; k++) {
        for (int64_t i = 0; i < (int64_t)COARSE << TIMES; i++)
            noise[i] = k / 2 == 0 ? (test_random_bits(&r) & 1 ? 1 : -1) : (float)test_random_range(&r, -1, 1);
        most = fmax(most, filtered_down(noise, !wraps && k % 2, wraps, &back)), most_back = fmax(most_back, back);
    }
    snprintf(name, sizeof name, "D 16 times on noise, then U 16 times, %s", where);
    extreme_at_most(name, "growth, times", fmax(most, most_back), norm * up->norm, "rows and columns, 6 noises");
    free(noise);
}

/* One D and one U in two dimensions, in integers; z is replaced. */
static void down_and_up(int32_t *z, const tc_lifting_level *level)
{
    tc_rect r = {0, 0, level->width, level->height}, c = {0, 0, tc_coarse_size(r.x1), tc_coarse_size(r.y1)};
    tc_plane fine = {z, r.x1, r}, ll = packed_plane(c), band[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        band[b] = packed_plane(c);
    int32_t *scratch = packed_memory(tc_lifting_analyse_scratch(level, c.y1) * sizeof *scratch);
    tc_lifting_analyse(level, &fine, 0, c.y1, &ll, band, scratch);
    free(scratch);
    for (int b = 0; b < TC_BANDS; b++)
        memset(band[b].z, 0, (size_t)tc_rect_area(c) * sizeof(int32_t));
    tc_rect need = tc_lifting_needs(level, r);
    tc_plane from = ll, zero = packed_plane(need);
    if (!tc_rect_within(need, c))
        from = packed_wrapped(&ll, need);
    scratch = packed_memory(tc_lifting_synthesise_scratch(level, r) * sizeof *scratch);
    tc_lifting_synthesise(level, &from, (tc_plane[]){zero, zero, zero}, &fine, scratch, TC_SIMD_AUTO);
    free(scratch), free(zero.z);
    if (from.z != ll.z)
        free(from.z);
    free(ll.z);
    for (int b = 0; b < TC_BANDS; b++)
        free(band[b].z);
}

/* U after D is a projection: what it leaves it leaves again, to the last bit in integers. */
static void projected(int64_t width, int64_t height, bool wraps, const char *name)
{
    const tc_lifting_level level = {width, height, wraps};
    int64_t count = width * height, differ = 0;
    int32_t *z = packed_memory((size_t)count * sizeof *z), *once = packed_memory((size_t)count * sizeof *once);
    test_random r = {4};
    for (int64_t i = 0; i < count; i++)
        z[i] = (int32_t)test_random_int(&r, -1000000, 1000000);
    down_and_up(z, &level);
    memcpy(once, z, (size_t)count * sizeof *z);
    for (int k = 1; k < TIMES; k++)
        down_and_up(z, &level);
    for (int64_t i = 0; i < count; i++)
        differ += z[i] != once[i];
    extreme_at_most(name, "heights that the last 15 changed", (double)differ, 0, "%lld x %lld heights of noise",
                    (long long)width, (long long)height);
    free(z), free(once);
}

/* ---- Constants and ramps ---------------------------------------------------------------------------------------- */

/* A ramp of `slope` from sample to sample of the finest level, 16 levels down or up. */
static double ramp_lost(double origin, double slope, bool wraps, bool down)
{
    const int64_t fine = (int64_t)COARSE << TIMES;
    double step = ldexp(slope, TIMES), most = 0;
    if (!down) {
        float x[COARSE];
        for (int i = 0; i < COARSE; i++)
            x[i] = (float)(origin + step * i);
        float *z = float_subdivided(x, COARSE, wraps, TIMES);
        for (int64_t i = 0; i < fine; i++)
            most = fmax(most, fabs((double)z[i] - (float)(origin + slope * (double)i)));
        free(z);
        return most;
    }
    float *z = packed_memory((size_t)fine * sizeof *z);
    for (int64_t i = 0; i < fine; i++)
        z[i] = (float)(origin + slope * (double)i);
    for (int64_t n = fine; n > COARSE; n /= 2) {
        float *scratch = packed_memory(tc_downsample_scratch(n, 1) * sizeof *scratch);
        float *coarse = packed_memory((size_t)(n / 2) * sizeof *coarse);
        tc_downsample(z, n, 1, wraps, 0, 1, coarse, scratch);
        free(z), free(scratch);
        z = coarse;
    }
    for (int i = 0; i < COARSE; i++)
        most = fmax(most, fabs((double)z[i] - (float)(origin + step * i)));
    free(z);
    return most;
}

/* A plane of integers from COARSE samples a side on, 16 levels down its corners and middle. */
static int64_t plane_lost(int32_t slope_x, int32_t slope_y, bool wraps)
{
    int64_t last = ((int64_t)COARSE << TIMES) - 1, lost = 0;
    for (int place = 0; place < 5; place++) {
        int32_t z[COARSE * COARSE];
        for (int i = 0; i < COARSE * COARSE; i++)
            z[i] = 777 + (slope_x * (i % COARSE) + slope_y * (i / COARSE)) * (1 << TIMES);
        window w = whole(z, COARSE, COARSE, wraps);
        int64_t x = place == 4 ? last / 3 : place & 1 ? last : 0, y = place == 4 ? last / 3 : place & 2 ? last : 0;
        for (int k = 1; k <= TIMES; k++) {
            int64_t px = x >> (TIMES - k), py = y >> (TIMES - k);
            w = finer(w, k > WHOLE_LEVELS ? (tc_rect){px - HALF, py - HALF, px + HALF, py + HALF}
                                          : (tc_rect){0, 0, (int64_t)COARSE << k, (int64_t)COARSE << k});
        }
        for (int64_t j = w.z.rect.y0; j < w.z.rect.y1; j++)
            for (int64_t i = w.z.rect.x0; i < w.z.rect.x1; i++)
                lost += *tc_plane_at(&w.z, i, j) != 777 + slope_x * i + slope_y * j;
        free(w.z.z);
    }
    return lost;
}

static void polynomials(void)
{
    const double third = 1 / 3.0;
    extreme_at_most("constant, U 16 times", "off by, metres", ramp_lost(1234.5, 0, false, false), 0, "bit for bit");
    extreme_at_most("constant, D 16 times", "off by, metres", ramp_lost(1234.5, 0, false, true), 0, "bit for bit");
    extreme_at_most("constant, U 16 times, round a globe", "off by, metres", ramp_lost(1234.5, 0, true, false), 0,
                    "bit for bit");
    extreme_at_most("constant, D 16 times, round a globe", "off by, metres", ramp_lost(1234.5, 0, true, true), 0,
                    "bit for bit");
    extreme_at_most("ramp of 1/4, U 16 times, with borders", "off by, metres", ramp_lost(-4096, 0.25, false, false), 0,
                    "heights that floats hold with the filter's four bits more");
    extreme_at_most("ramp of 1/4, D 16 times, with borders", "off by, metres", ramp_lost(-4096, 0.25, false, true), 0,
                    "bit for bit");
    extreme_at_most("constant that no float holds, U 16 times", "off by, steps of a float",
                    ramp_lost(8848 + third, 0, false, false) / ldexp(1, -10), TIMES, "a step is 1/1024 m there");
    extreme_at_most("constant that no float holds, D 16 times", "off by, steps of a float",
                    ramp_lost(8848 + third, 0, false, true) / ldexp(1, -10), TIMES, "a step is 1/1024 m there");
    extreme_at_most("planes in integers, U 16 times", "heights that differ",
                    (double)(plane_lost(0, 0, false) + plane_lost(3, -2, false) + plane_lost(-1, 0, false)), 0,
                    "at the corners and inside");
    extreme_at_most("constants and slopes across in integers, round a globe", "heights that differ",
                    (double)(plane_lost(0, 0, true) + plane_lost(0, 5, true)), 0, "bit for bit");
}

int main(void)
{
    extreme_begin("filters");
    worst borders = norm_of_subdivision(false), around = norm_of_subdivision(true);
    one_axis(&borders, false);
    one_axis(&around, true);
    two_axes(&borders, &borders, false);
    two_axes(&around, &borders, true);
    down_norms(&borders, false);
    down_norms(&around, true);
    projected(513, 384, false, "D then U, 16 times, with borders");
    projected(512, 385, true, "D then U, 16 times, round a globe");
    polynomials();
    return extreme_end();
}
