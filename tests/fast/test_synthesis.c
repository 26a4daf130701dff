/* test_synthesis.c - heights finer than the data: the same in whatever rectangle, order and thread they are read, and
 * by wide instructions or without; consistent with the data, within their bounds, and nothing where there is nothing to
 * tell. How well they match real terrain: tests/slow/test_synthesis_truth.c. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/load.h"
#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/field/filter.h"
#include "common/map/map.h"
#include "common/synthesis/synthesis.h"
#include "tests/support/terrains.h"

/* A second copy without wide instructions: the oracle of the first. */
#define TC_NO_AVX2
#define tc_synthesis_level narrow_level
#define tc_synthesis_needs narrow_needs
#define tc_synthesis_scratch narrow_scratch
#define tc_extend_beyond narrow_extend_beyond
#define tc_flats_begin narrow_flats_begin
#define tc_flats_pass narrow_flats_pass
#define tc_flats_keep narrow_flats_keep
#define tc_details_begin narrow_details_begin
#define tc_details_row narrow_details_row
#define tc_noise_begin narrow_noise_begin
#define tc_noise_smeared narrow_noise_smeared
#define tc_smear_of narrow_smear_of
#define tc_noise_seed narrow_noise_seed
#define tc_local_energy narrow_local_energy
#define tc_amplitudes narrow_amplitudes
#include "common/synthesis/synthesis_detail.c"
#include "common/synthesis/synthesis_energy.c"
#include "common/synthesis/synthesis_flat.c"
#include "common/synthesis/synthesis_level.c"
#include "common/synthesis/synthesis_noise.c"
#undef tc_synthesis_level
#undef tc_synthesis_needs
#undef tc_synthesis_scratch
#undef tc_extend_beyond
#undef tc_flats_begin
#undef tc_flats_pass
#undef tc_flats_keep
#undef tc_details_begin
#undef tc_details_row
#undef tc_noise_begin
#undef tc_noise_smeared
#undef tc_smear_of
#undef tc_noise_seed
#undef tc_local_energy
#undef tc_amplitudes
tc_rect tc_synthesis_needs(tc_rect fine, int reach);
size_t tc_synthesis_scratch(void);
void tc_synthesis_level(const tc_level_recipe *r, const tc_patch *coarse, tc_rect rect, float *z, ptrdiff_t stride,
                        float *scratch);
void tc_local_energy(const tc_patch *z, const tc_synthesis_fit *fit, float spacing_x, float spacing_y, tc_rect rect,
                     float *energy, float *slope, float *scratch);
void tc_amplitudes(const tc_synthesis_fit *fit, int k, const float *energy, const float *slope, int64_t count,
                   float *amplitude);

enum { LEVELS = 4 };

/* The south-west of a default terrain. */
static tc_grid default_grid(int64_t width, int64_t height)
{
    enum { SIDE = 300 };
    tc_grid g = terrain_grid(TERRAIN_DEFAULT, SIDE, SIDE, 30, 7);
    for (int64_t j = 0; j < height; j++)
        memmove(g.z + j * width, g.z + j * SIDE, (size_t)width * sizeof *g.z);
    g.width = width, g.height = height;
    tc_grid_measure(&g);
    return g;
}

static tc_field *default_terrain(int64_t width, int64_t height)
{
    tc_grid grid = default_grid(width, height);
    tc_field *f;
    assert_int_equal(tc_field_build(&grid, 0, &f, NULL), TC_OK);
    return f;
}

static tc_field *default_field(void)
{
    return terrain_synthesised(default_terrain(300, 257), LEVELS);
}

static float *read_rect(const tc_field *f, int level, tc_rect r)
{
    float *z = malloc((size_t)tc_rect_area(r) * sizeof *z);
    assert_non_null(z);
    assert_int_equal(tc_field_read(f, level, r, z, NULL, r.x1 - r.x0), TC_OK);
    return z;
}

/* ---- The same however it is read --------------------------------------------------------------------------------- */

typedef struct reading {
    const tc_field *field;
    int level;
    tc_rect all;
    const float *z; /* of all */
    _Atomic int wrong;
} reading;

static void read_part(void *context, int64_t n)
{
    reading *r = context;
    test_random random = {(uint64_t)n + 1};
    int64_t w = r->all.x1 - r->all.x0, h = r->all.y1 - r->all.y0;
    int64_t x = test_random_int(&random, 0, w - 1), y = test_random_int(&random, 0, h - 1);
    int64_t pw = n % 3 ? test_random_int(&random, 1, 40) : 1, ph = n % 3 == 1 ? 1 : test_random_int(&random, 1, 40);
    tc_rect part = {r->all.x0 + x, r->all.y0 + y, r->all.x0 + tc_min64(x + pw, w), r->all.y0 + tc_min64(y + ph, h)};
    float z[40 * 40];
    int64_t part_w = part.x1 - part.x0;
    if (tc_field_read(r->field, r->level, part, z, NULL, part_w))
        r->wrong++;
    for (int64_t j = 0; j < part.y1 - part.y0; j++)
        r->wrong += memcmp(z + j * part_w, r->z + (y + j) * w + x, (size_t)part_w * sizeof *z) != 0;
}

static void parts_are_the_whole(void **state)
{
    (void)state;
    tc_field *f = default_field();
    int m = tc_field_info(f)->levels;
    for (int l = m - LEVELS + 1; l <= m; l++) {
        const tc_level size = tc_field_level(f, l);
        /* A corner, and a part across blocks. */
        tc_rect rects[] = {{0, 0, 90, 70}, {size.width - 300, size.height - 290, size.width, size.height}};
        for (int k = 0; k < 2; k++) {
            reading r = {.field = f, .level = l, .all = rects[k], .z = read_rect(f, l, rects[k])};
            tc_parallel_for(4, 150, read_part, &r);
            assert_int_equal(r.wrong, 0);
            free((void *)r.z);
        }
    }
    tc_field_destroy(f);
}

/* Around a globe: what lies across the seam is what lies there one turn on. */
static void columns_go_round(void **state)
{
    (void)state;
    tc_grid grid = default_grid(256, 129);
    tc_error error = {TC_OK, ""};
    tc_field *f;
    grid.wraps_x = true;
    assert_int_equal(tc_field_build(&grid, 0, &f, &error), TC_OK);
    f = terrain_synthesised(f, 2);
    int l = tc_field_info(f)->levels;
    int64_t width = tc_field_level(f, l).width;
    assert_int_equal(width, 1024);
    float *across = read_rect(f, l, (tc_rect){width - 30, 40, width + 30, 80});
    float *west = read_rect(f, l, (tc_rect){width - 30, 40, width, 80}),
          *east = read_rect(f, l, (tc_rect){0, 40, 30, 80});
    for (int64_t j = 0; j < 40; j++) {
        assert_memory_equal(across + 60 * j, west + 30 * j, 30 * sizeof *west);
        assert_memory_equal(across + 60 * j + 30, east + 30 * j, 30 * sizeof *east);
    }
    free(across), free(west), free(east);
    tc_field_destroy(f);
}

/* Heights at places of a map, asked for in some order. */
typedef struct asking {
    const tc_map *map;
    double *z;
} asking;
enum { PLACES = 400 };

static void ask_at(void *context, int64_t n)
{
    const asking *a = context;
    test_random random = {(uint64_t)n + 1};
    bool planet = tc_map_radius(a->map) > 0;
    double u = test_random_unit(&random), v = test_random_unit(&random);
    if (tc_map_height(a->map, planet ? 2 * M_PI * u - M_PI : 7000 * u, planet ? asin(2 * v - 1) : 3500 * v, &a->z[n]))
        abort();
}

/* A plane, and a planet with its caps: prepared and asked by one thread, and by four in any order. */
static void threads_do_not_matter(void **state)
{
    (void)state;
    const double radius[] = {0, 6371000}, step = 360.0 / 256;
    for (int k = 0; k < 2; k++) {
        static double z[2][PLACES];
        for (int n = 0; n < 2; n++) {
            tc_grid grid = default_grid(256, 128);
            grid.georef = (tc_georef){.known = k == 1,
                                      .geographic = true,
                                      .transform = {-180, step, 0, 90, 0, -step},
                                      .semi_major = radius[k]};
            tc_map *map;
            tc_error error = {TC_OK, ""};
            if (tc_map_build(&grid, radius[k], n ? 4 : 1, &map, &error) || tc_map_synthesise(map, 9, &error))
                fail_msg("%s", error.text);
            assert_int_equal(tc_map_charts(map), k ? 3 : 1);
            tc_parallel_for(n ? 4 : 1, PLACES, ask_at, &(asking){map, z[n]});
            tc_map_destroy(map);
        }
        assert_memory_equal(z[0], z[1], sizeof z[0]);
    }
}

static void wide_instructions_do_the_same(void **state)
{
    (void)state;
    /* Wider than what is made at once. */
    enum { WIDTH = 330, HEIGHT = 70, REACH = TC_COARSE_REACH, STRIDE = WIDTH / 2 + 2 * REACH };
    tc_field *f = default_terrain(300, 257);
    tc_synthesis_fit fit;
    tc_error error = {TC_OK, ""};
    assert_int_equal(tc_synthesis_learn(f, &fit, &error), TC_OK);
    const tc_rect rect = {60, 60, 60 + WIDTH, 60 + HEIGHT}, around = tc_synthesis_needs(rect, REACH);
    const tc_rect inner = tc_rect_grown(around, -TC_ENERGY_REACH);
    const tc_patch coarse = {read_rect(f, tc_field_info(f)->levels, around), STRIDE, around};
    for (int64_t j = 50; j < 60; j++) /* a lake */
        for (int64_t i = 90; i < 103; i++)
            *tc_patch_at(&coarse, i, j) = *tc_patch_at(&coarse, 90, 50);
    static float energy[2][STRIDE * STRIDE], slope[2][STRIDE * STRIDE], a[2][STRIDE * STRIDE], z[2][WIDTH * HEIGHT];
    float *scratch = malloc(tc_synthesis_scratch() * sizeof *scratch), part[3 * HEIGHT];
    for (int n = 0; n < 2; n++) {
        (n ? narrow_local_energy : tc_local_energy)(&coarse, &fit, 30, 29, inner, energy[n], slope[n], scratch);
        (n ? narrow_amplitudes : tc_amplitudes)(&fit, 1, energy[0], slope[0], tc_rect_area(inner), a[n]);
    }
    assert_memory_equal(energy[0], energy[1], sizeof energy[0]);
    assert_memory_equal(slope[0], slope[1], sizeof slope[0]);
    assert_memory_equal(a[0], a[1], sizeof a[0]);
    for (int i = 0; i < STRIDE * STRIDE; i++)
        a[0][i] = 1 + 0.01f * (float)(i % 100);
    const tc_patch amplitude = {a[0], STRIDE, around};
    for (int k = 0; k < 5;
         k++) { /* along the slope, across it, not at all; from a coarser grid of amplitudes; U alone */
        fit.smear = k == 0 ? 0.7f : k == 1 ? -0.4f : 0;
        fit.none = k == 4;
        const tc_level_recipe r = {.fit = &fit,
                                   .seed = 77,
                                   .width = 300,
                                   .height = 257,
                                   .spacing_x = 30,
                                   .spacing_y = 29,
                                   .lowest = -1e4f,
                                   .highest = 1e4f,
                                   .amplitude = &amplitude,
                                   .shift = 0};
        const tc_patch coarser = {a[0], STRIDE, {0, 0, STRIDE, STRIDE}};
        tc_level_recipe grained = r;
        grained.amplitude = &coarser, grained.shift = 2;
        for (int n = 0; n < 2; n++)
            (n ? narrow_level : tc_synthesis_level)(k == 3 ? &grained : &r, &coarse, rect, z[n], WIDTH, scratch);
        assert_memory_equal(z[0], z[1], sizeof z[0]);
        for (int64_t x = 0; x + 3 <= WIDTH; x += 29) { /* a few columns alone */
            tc_rect columns = {rect.x0 + x, rect.y0, rect.x0 + x + 3, rect.y1};
            tc_synthesis_level(k == 3 ? &grained : &r, &coarse, columns, part, 3, scratch);
            for (int64_t j = 0; j < HEIGHT; j++)
                assert_memory_equal(part + 3 * j, z[0] + j * WIDTH + x, 3 * sizeof *part);
        }
    }
    free(coarse.z), free(scratch);
    tc_field_destroy(f);
}

/* Blocks of levels between are kept, and go again when there are too many: heights are the same ones, and memory. */
static void what_is_kept_changes_nothing(void **state)
{
    (void)state;
    enum { SIDE = 256, READINGS = 90 };
    tc_field *f = default_field();
    const int finest = tc_field_info(f)->levels;
    const tc_rect here = {200, 300, 200 + SIDE, 300 + SIDE};
    float *first = read_rect(f, finest, here);
    const size_t bytes = tc_field_tell(f).bytes;
    for (int n = 0; n < READINGS; n++) {
        const int l = finest - n % 3;
        const tc_level size = tc_field_level(f, l);
        int64_t x = (int64_t)n * 977 % (size.width - SIDE), y = (int64_t)n * 619 % (size.height - SIDE);
        const tc_rect there = {x, y, x + SIDE, y + SIDE};
        float *z = read_rect(f, l, there);
        if (n % 20 == 0) {
            tc_field *other = default_field();
            float *fresh = read_rect(other, l, there);
            assert_memory_equal(z, fresh, SIDE * SIDE * sizeof *z);
            free(fresh);
            tc_field_destroy(other);
        }
        free(z);
    }
    assert_int_equal(tc_field_tell(f).bytes, bytes);
    float *again = read_rect(f, finest, here);
    assert_memory_equal(first, again, SIDE * SIDE * sizeof *first);
    free(first), free(again);
    tc_field_destroy(f);
}

/* ---- Consistent with the data ------------------------------------------------------------------------------------ */

static double rms_of(const float *a, const float *b, int64_t count)
{
    double sum = 0;
    for (int64_t i = 0; i < count; i++)
        sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
    return sqrt(sum / (double)count);
}

/* D of a synthesised level is the level that it was made from; the data's own levels are untouched. */
static void filtering_gives_the_coarser_level(void **state)
{
    (void)state;
    tc_field *plain = default_terrain(300, 257), *f = default_field();
    int m = tc_field_info(plain)->levels;
    assert_int_equal(tc_field_info(f)->levels, m + LEVELS);
    for (int l = 1; l <= m + LEVELS - 1; l++) {
        const tc_level size = tc_field_level(f, l), fine = tc_field_level(f, l + 1);
        tc_rect all = {0, 0, size.width, size.height};
        float *z = read_rect(f, l, all);
        if (l <= m) {
            float *data = read_rect(plain, l, all);
            assert_memory_equal(z, data, (size_t)tc_rect_area(all) * sizeof *z);
            free(data);
        }
        if (l >= m && l < m + 2) {
            float *finer = read_rect(f, l + 1, (tc_rect){0, 0, fine.width, fine.height});
            float *low = malloc((size_t)tc_rect_area(all) * sizeof *low);
            float *scratch = malloc(tc_downsample_scratch(fine.width, size.height) * sizeof *scratch);
            tc_downsample(finer, fine.width, fine.height, false, 0, size.height, low, scratch);
            double off = rms_of(low, z, tc_rect_area(all)), detail = 0;
            for (int64_t j = 0; j < size.height; j++) /* what was added, on the coarser level's samples */
                for (int64_t i = 0; i < size.width; i++)
                    detail += pow((double)finer[2 * j * fine.width + 2 * i] - z[j * size.width + i], 2);
            detail = sqrt(detail / (double)tc_rect_area(all));
            if (!(detail > 0.05 && off < 0.1 * detail))
                fail_msg("level %d: %g m beside it, %g m of detail", l, off, detail);
            free(finer), free(low), free(scratch);
        }
        free(z);
    }
    tc_field_destroy(f), tc_field_destroy(plain);
}

static void bounds_hold(void **state)
{
    (void)state;
    /* Too small to learn from: U alone, which swings beyond its samples. */
    tc_grid step = terrain_grid(TERRAIN_SLOPE, 5, 5, 30, 7);
    tc_error error = {TC_OK, ""};
    for (int i = 0; i < 25; i++)
        step.z[i] = (i == 6 || i == 7 || i == 11 || i == 12) ? 1 : 0;
    step.z_min = 0, step.z_max = 1;
    tc_field *small;
    assert_int_equal(tc_field_build(&step, 0, &small, &error), TC_OK);
    small = terrain_synthesised(small, 1);
    float *swung = read_rect(small, tc_field_info(small)->levels, (tc_rect){0, 0, 9, 9});
    for (int i = 0; i < 81; i++)
        assert_true(swung[i] >= 0 && swung[i] <= 1);
    free(swung);
    tc_field_destroy(small);

    for (int kind = 0; kind < 3; kind++) {
        static const terrain_kind kinds[] = {TERRAIN_DEFAULT, TERRAIN_CLIFF, TERRAIN_SMOOTH};
        tc_field *f =
            terrain_synthesised(kind ? terrain_field(kinds[kind], 300, 257, 30, 7) : default_terrain(300, 257), LEVELS);
        const tc_terrain_info *info = tc_field_info(f);
        test_random random = {5};
        for (int n = 0; n < 200; n++) {
            int l = info->levels - (int)test_random_int(&random, 0, LEVELS - 1);
            const tc_level size = tc_field_level(f, l);
            int64_t x = test_random_int(&random, 0, size.width - 33), y = test_random_int(&random, 0, size.height - 33);
            tc_rect r = {x, y, x + test_random_int(&random, 1, 32), y + test_random_int(&random, 1, 32)};
            float *z = read_rect(f, l, r);
            tc_range range = tc_field_range(f, l, r);
            for (int64_t i = 0; i < tc_rect_area(r); i++)
                if (!(z[i] >= range.lo && z[i] <= range.hi && z[i] >= info->z_min && z[i] <= info->z_max))
                    fail_msg("%g m beside %g to %g m", (double)z[i], (double)range.lo, (double)range.hi);
            free(z);
        }
        tc_field_destroy(f);
    }
}

/* ---- Nothing where there is nothing ------------------------------------------------------------------------------ */

/* A lake in hills keeps its height from shore to shore, and holes their outline. */
static void lakes_and_holes_stay(void **state)
{
    (void)state;
    enum { W = 200, H = 180, X0 = 60, X1 = 110, Y0 = 50, Y1 = 95, HOLE = 20 };
    tc_grid grid = default_grid(W, H);
    grid.voids = calloc(W * H, 1);
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            if (i >= X0 && i <= X1 && j >= Y0 && j <= Y1)
                grid.z[j * W + i] = grid.z_min;
            grid.void_count += grid.voids[j * W + i] = i >= 150 && i < 150 + HOLE && j >= 20 && j < 20 + HOLE;
        }
    float level = grid.z_min;
    tc_field *f;
    tc_error error = {TC_OK, ""};
    assert_int_equal(tc_field_build(&grid, 0, &f, &error), TC_OK);
    f = terrain_synthesised(f, LEVELS);
    int m = tc_field_info(f)->levels - LEVELS;
    for (int k = 1; k <= LEVELS; k++) {
        int64_t s = (int64_t)1 << k;
        tc_rect lake = {X0 * s, Y0 * s, X1 * s + 1, Y1 * s + 1}, hole = {148 * s, 18 * s, 173 * s, 43 * s};
        float *z = read_rect(f, m + k, lake);
        for (int64_t i = 0; i < tc_rect_area(lake); i++)
            assert_true(z[i] == level);
        free(z);
        uint8_t *v = malloc((size_t)tc_rect_area(hole));
        assert_int_equal(tc_field_read(f, m + k, hole, NULL, v, hole.x1 - hole.x0), TC_OK);
        for (int64_t y = hole.y0; y < hole.y1; y++)
            for (int64_t x = hole.x0; x < hole.x1; x++) {
                bool is = v[(y - hole.y0) * (hole.x1 - hole.x0) + x - hole.x0];
                /* Triangles with a void corner, which reach a sample out but on two corners. */
                if (x >= 150 * s && x <= 169 * s && y >= 20 * s && y <= 39 * s)
                    assert_true(is);
                if (x <= 149 * s || x >= 170 * s || y <= 19 * s || y >= 40 * s)
                    assert_false(is);
            }
        free(v);
    }
    tc_field_destroy(f);
}

/* A plane, a constant, one sample, noise: upsampled or drawn sensibly, and never an error. */
static void odd_terrains_are_fine(void **state)
{
    (void)state;
    tc_error error = {TC_OK, ""};
    for (int k = 0; k < 5; k++) {
        static const int64_t sizes[5][2] = {{120, 90}, {1, 1}, {2, 1}, {5, 3}, {130, 130}};
        int64_t w = sizes[k][0], h = sizes[k][1];
        tc_grid grid = terrain_grid(TERRAIN_SLOPE, w, h, 30, 7);
        test_random random = {9};
        for (int64_t i = 0; i < w * h && k == 4; i++)
            grid.z[i] = (float)test_random_range(&random, 0, 100), grid.z_min = 0, grid.z_max = 100;
        tc_map *map;
        assert_int_equal(tc_map_build(&grid, 0, 0, &map, &error), TC_OK);
        int before = tc_field_info(tc_map_field(map, 0))->levels;
        assert_int_equal(tc_map_synthesise(map, 3, &error), TC_OK);
        const tc_field *f = tc_map_field(map, 0);
        int l = tc_field_info(f)->levels;
        assert_int_equal(l, k == 1 ? before : before + 3);
        const tc_level size = tc_field_level(f, l);
        float *z = read_rect(f, l, (tc_rect){0, 0, size.width, size.height});
        for (int64_t j = 0; j < size.height; j++)
            for (int64_t i = 0; i < size.width; i++) {
                double plane = 0.25 * (double)i * size.spacing_x + 0.5 * (double)j * size.spacing_y;
                assert_true(isfinite(z[j * size.width + i]));
                if (k < 4)
                    assert_float_equal(z[j * size.width + i], plane, 1e-2);
            }
        free(z);
        tc_map_destroy(map);
    }
}

/* Half as far apart each, in the same places. */
static void maps_keep_their_places(void **state)
{
    (void)state;
    tc_grid grid = default_grid(300, 257);
    tc_map *map;
    tc_error error = {TC_OK, ""};
    assert_int_equal(tc_map_build(&grid, 0, 0, &map, &error), TC_OK);
    double before[50], after;
    for (int n = 0; n < 50; n++)
        assert_int_equal(tc_map_height(map, 150.0 * n + 400, 140.0 * n + 300, &before[n]), TC_OK);
    assert_int_equal(tc_map_synthesise(map, TC_SYNTHESIS_AUTO, &error), TC_OK);
    const tc_level finest = tc_field_level(tc_map_field(map, 0), tc_field_info(tc_map_field(map, 0))->levels);
    assert_true(finest.spacing_x <= 0.1 && finest.spacing_x > 0.05);
    double sum = 0;
    for (int n = 0; n < 50; n++) {
        assert_int_equal(tc_map_height(map, 150.0 * n + 400, 140.0 * n + 300, &after), TC_OK);
        sum += fabs(after - before[n]);
    }
    assert_true(sum > 0 && sum / 50 < 6);
    tc_map_destroy(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_the_whole),
        cmocka_unit_test(columns_go_round),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(wide_instructions_do_the_same),
        cmocka_unit_test(what_is_kept_changes_nothing),
        cmocka_unit_test(filtering_gives_the_coarser_level),
        cmocka_unit_test(bounds_hold),
        cmocka_unit_test(lakes_and_holes_stay),
        cmocka_unit_test(odd_terrains_are_fine),
        cmocka_unit_test(maps_keep_their_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
