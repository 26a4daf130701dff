/* test_pack_synthesis.c - the fit that a packed file stores for synthesis: it is that of the heights as they were
 * given, to the bit, on planes and planets, and what the map goes by; files without one are what they were. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "common/map/map.h"
#include "common/packed/file/container.h"
#include "common/synthesis/synthesis_store.h"
#include "tests/support/made_files.h"
#include "tests/support/packing.h"
#include "tests/support/terrains.h"

static int close_all(void **state)
{
    (void)state;
    made_folder_remove();
    return 0;
}

static bool same_fit(const tc_synthesis_fit *a, const tc_synthesis_fit *b)
{
    tc_byte_writer v = {0}, w = {0};
    tc_synthesis_put(a, &v), tc_synthesis_put(b, &w);
    bool same = v.size == w.size && !memcmp(v.bytes, w.bytes, v.size);
    assert_int_equal(v.size, TC_SYNTHESIS_BYTES);
    free(v.bytes), free(w.bytes);
    return same;
}

static tc_synthesis_fit learned(const tc_field *field)
{
    tc_synthesis_fit fit;
    assert_int_equal(tc_synthesis_learn(field, &fit, NULL), TC_OK);
    return fit;
}

static tc_map *opened(const char *path)
{
    tc_map *map;
    tc_error error = {TC_OK, ""};
    if (tc_map_open(path, &(tc_open_options){0}, &map, &error))
        fail_msg("%s", error.text);
    return map;
}

static void write_packing(const packing *p, const char *path)
{
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    if (packing_write(p, path, &result, &error))
        fail_msg("%s", error.text);
}

/* What is stored, and what this file's own heights would tell. */
static void check_stored(const packing *p, bool loses)
{
    const char *path = made_path("fit.tclip");
    write_packing(p, path);
    tc_map *map = opened(path);
    const tc_field *field = tc_map_field(map, 0);
    const tc_container *c = tc_field_container(field);
    tc_field *truth = packing_truth(p);
    tc_synthesis_fit want = learned(truth), own = learned(field);
    assert_false(want.none);
    assert_true(tc_field_packed_info(field)->synthesis_fit && c->synthesis);
    if (!same_fit(c->synthesis, &want))
        fail_msg("kind %d of %d x %d: another fit than the heights', rms %.17g, not %.17g", (int)p->kind, (int)p->width,
                 (int)p->height, c->synthesis->rms[2], want.rms[2]);
    if (loses) /* by more than what coarser levels are rounded to, as of a lossless file, too */
        assert_true(!same_fit(&own, &want) && fabs(own.rms[2] / want.rms[2] - 1) > 1e-4);
    tc_field_destroy(truth);
    tc_map_destroy(map);
}

static void the_fit_is_that_of_the_heights(void **state)
{
    (void)state;
    const packing whole[] = {
        {.width = 600, .height = 431, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS},
        {.width = 301, .height = 420, .kind = PACKING_INTEGERS, .voids = PACKING_LAKE, .mode = TC_PACK_LOSSLESS},
        {.width = 512, .height = 300, .kind = PACKING_INTEGERS, .wraps = true, .mode = TC_PACK_LOSSLESS},
        {.width = 448,
         .height = 256,
         .kind = PACKING_INTEGERS,
         .wraps = true,
         .voids = PACKING_LAKE,
         .mode = TC_PACK_LOSSLESS}};
    const packing lossy[] = {
        {.width = 600, .height = 431, .mode = TC_PACK_RMS, .error = 2},
        {.width = 600, .height = 431, .mode = TC_PACK_RMS, .codec = TC_CODEC_LH04, .error = 2},
        {.width = 331, .height = 500, .voids = PACKING_LAKE, .mode = TC_PACK_RMS, .error = 0.6, .max_error = 2.4},
        {.width = 500, .height = 333, .mode = TC_PACK_MAX_ERROR, .error = 3, .based = true, .offset = 1e5}};
    for (size_t n = 0; n < sizeof whole / sizeof *whole; n++) {
        packing p = whole[n];
        p.synthesis_fit = true;
        check_stored(&p, false);
    }
    for (size_t n = 0; n < sizeof lossy / sizeof *lossy; n++) {
        packing p = lossy[n];
        p.synthesis_fit = true;
        check_stored(&p, true);
    }
}

/* Little or nothing to learn from, and heights of every kind. */
static void odd_terrains_have_one(void **state)
{
    (void)state;
    const int64_t sides[][2] = {{1, 1}, {2, 2}, {1, 300}, {17, 16}, {40, 41}, {130, 120}};
    for (int kind = 0; kind < PACKING_KINDS; kind++)
        for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
            const packing p = {.width = sides[s][0],
                               .height = sides[s][1],
                               .kind = (packing_kind)kind,
                               .mode = TC_PACK_RMS,
                               .error = kind == PACKING_DUST ? 1e-5 : 0.5,
                               .synthesis_fit = true};
            const char *path = made_path("odd.tclip");
            write_packing(&p, path);
            tc_map *map = opened(path);
            tc_field *truth = packing_truth(&p);
            tc_synthesis_fit want = learned(truth);
            assert_true(same_fit(tc_field_container(tc_map_field(map, 0))->synthesis, &want));
            assert_int_equal(tc_map_synthesise(map, 2, NULL), TC_OK);
            tc_field_destroy(truth);
            tc_map_destroy(map);
        }
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

/* But for the section a file is what it is without; threads do not matter. */
static void files_are_the_same_otherwise(void **state)
{
    (void)state;
    packing p = {.width = 700, .height = 300, .voids = PACKING_LAKE, .mode = TC_PACK_RMS, .error = 1, .threads = 1};
    const char *path[3] = {made_path("none.tclip"), made_path("one.tclip"), made_path("four.tclip")};
    uint8_t *bytes[3];
    size_t size[3], section = 8 + TC_SYNTHESIS_BYTES;
    for (int n = 0; n < 3; n++) {
        p.synthesis_fit = n > 0, p.threads = n == 2 ? 4 : 1;
        write_packing(&p, path[n]);
        bytes[n] = packing_bytes(path[n], &size[n]);
    }
    assert_true(size[1] == size[2] && !memcmp(bytes[1], bytes[2], size[1]));
    assert_int_equal(size[1], size[0] + section);
    assert_true(bytes[0][29] == 1 && bytes[1][29] == 2);
    size_t head = (size_t)tc_load(bytes[0] + TC_HEAD_SIZE_AT, 4);
    assert_int_equal(tc_load(bytes[1] + TC_HEAD_SIZE_AT, 4), head + section);
    assert_memory_equal(bytes[0] + head, bytes[1] + head + section, size[0] - head);
    tc_map *map = opened(path[0]);
    assert_false(tc_field_packed_info(tc_map_field(map, 0))->synthesis_fit);
    tc_map_destroy(map);
    for (int n = 0; n < 3; n++)
        free(bytes[n]);
}

static bool tell_done(void *context, double done)
{
    *(double *)context = done;
    return true;
}

/* Heights that a file holds, but whose fit it does not: that is found before levels are made, and said by name. */
static void a_fit_beyond_all_is_refused_early(void **state)
{
    (void)state;
    packing p = {.width = 300, .height = 257, .mode = TC_PACK_RMS, .error = 1e10};
    const float raised = 1e12F;
    double done[2] = {0, 0};
    for (int n = 0; n < 2; n++) {
        tc_pack_terrain terrain = packing_terrain(&p);
        tc_pack_options options = packing_options(&p);
        options.synthesis_fit = n == 0, options.progress = tell_done, options.progress_context = &done[n];
        uint8_t *voids;
        float *z = packing_heights(&p, &voids);
        for (int64_t i = 0; i < p.width * p.height; i++)
            z[i] *= raised;
        tc_packer *packer;
        tc_pack_result result;
        tc_error error = {TC_OK, ""};
        assert_int_equal(tc_packer_create(made_path("beyond.tclip"), &terrain, &options, &packer, NULL), TC_OK);
        assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, p.width, p.height}, z, NULL, p.width, NULL), TC_OK);
        const double put = done[n];
        assert_int_equal(tc_packer_finish(packer, &result, &error), n == 0 ? TC_ERR_UNSUPPORTED : TC_OK);
        assert_true(n == 0 ? done[n] == put && strstr(error.text, ": fit for synthesis: energy floor: expected 1e-30 "
                                                                  "to 1e+20, found ")
                           : done[n] > put);
        tc_packer_destroy(packer);
        free(z), free(voids);
    }
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

/* All heights of all levels from `from` on; the caller's to free. */
static float *heights_of(const tc_map *map, int level)
{
    float *z = packing_read(tc_map_field(map, 0), level, NULL);
    assert_non_null(z);
    return z;
}

/* Whether two maps have the same heights, to the bit, on the levels that synthesis adds. */
static bool same_heights(tc_map *a, tc_map *b, int levels)
{
    bool same = true;
    assert_int_equal(tc_map_synthesise(a, levels, NULL), TC_OK);
    assert_int_equal(tc_map_synthesise(b, levels, NULL), TC_OK);
    int m = tc_field_info(tc_map_field(a, 0))->levels;
    assert_int_equal(m, tc_field_info(tc_map_field(b, 0))->levels);
    for (int l = m - levels + 1; l <= m; l++) {
        const tc_level size = tc_field_level(tc_map_field(a, 0), l);
        float *z = heights_of(a, l), *y = heights_of(b, l);
        same &= !memcmp(z, y, (size_t)(size.width * size.height) * sizeof *z);
        free(z), free(y);
    }
    tc_map_destroy(a), tc_map_destroy(b);
    return same;
}

static tc_map *true_map(const packing *p)
{
    tc_map *map = tc_map_flat(packing_truth(p));
    assert_non_null(map);
    return map;
}

static void heights_are_those_of_the_source(void **state)
{
    (void)state;
    const char *path = made_path("heights.tclip");
    packing p = {
        .width = 300, .height = 257, .kind = PACKING_INTEGERS, .mode = TC_PACK_LOSSLESS, .synthesis_fit = true};
    write_packing(&p, path);
    assert_true(same_heights(opened(path), true_map(&p), 2));
    /* It is the stored fit that makes them: with another one they are others. */
    tc_map *map = opened(path);
    tc_field_container(tc_map_field(map, 0))->synthesis->level[0].a += 1;
    assert_false(same_heights(map, opened(path), 2));
    /* A lossy file: those of its data by the source's fit, and not by its own. */
    p.mode = TC_PACK_RMS, p.error = 3;
    write_packing(&p, path);
    p.synthesis_fit = false;
    write_packing(&p, made_path("own.tclip"));
    assert_false(same_heights(opened(path), opened(made_path("own.tclip")), 2));
    map = opened(made_path("own.tclip"));
    tc_field *truth = packing_truth(&p);
    tc_synthesis_fit *fit = malloc(sizeof *fit);
    *fit = learned(truth);
    ((tc_container *)tc_field_container(tc_map_field(map, 0)))->synthesis = fit; /* its own from now on */
    assert_true(same_heights(map, opened(path), 2));
    tc_field_destroy(truth);
}

/* A file cut short lacks the levels that the fit goes on from: its heights are those of one without, cut likewise. */
static void cut_files_fit_anew(void **state)
{
    (void)state;
    packing p = {.width = 640, .height = 512, .mode = TC_PACK_RMS, .error = 1};
    const char *path[2] = {made_path("cut-none.tclip"), made_path("cut-fit.tclip")};
    tc_map *map[2];
    for (int n = 0; n < 2; n++) {
        p.synthesis_fit = n > 0;
        write_packing(&p, path[n]);
        const tc_packed_info *whole = tc_field_packed_info(tc_map_field(map[n] = opened(path[n]), 0));
        const long keep = (long)(whole->bytes / 2); /* errors at the end are none of a level's */
        tc_map_destroy(map[n]);
        cut_file(path[n], keep);
        map[n] = opened(path[n]);
        assert_int_equal(tc_field_packed_info(tc_map_field(map[n], 0))->levels_missing, 1);
    }
    assert_true(same_heights(map[0], map[1], 2));
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

enum { WIDTH = 512, HEIGHT = 257 };
static const double radius = 1737400;

static tc_grid planet_grid(void)
{
    tc_grid g = {.width = WIDTH, .height = HEIGHT, .wraps_x = true, .z_min = INFINITY, .z_max = -INFINITY};
    const double step = 180.0 / (HEIGHT - 1), across = 360.0 / WIDTH;
    const double t[6] = {-0.5 * across, across, 0, 90 + 0.5 * step, 0, -step};
    g.spacing_x = radius * M_PI / 180 * across, g.spacing_y = radius * M_PI / 180 * step;
    g.georef = (tc_georef){.known = true, .geographic = true, .semi_major = radius};
    memcpy(g.georef.transform, t, sizeof t);
    g.z = malloc(sizeof *g.z * WIDTH * HEIGHT);
    assert_non_null(g.z);
    for (int64_t i = 0; i < WIDTH * HEIGHT; i++) {
        double lambda = across * (double)(i % WIDTH) * M_PI / 180, phi = (step * (double)(i / WIDTH) - 90) * M_PI / 180;
        double x = cos(phi) * cos(lambda), y = cos(phi) * sin(lambda), z = sin(phi);
        g.z[i] = (float)rint(2000 * sin(3 * x + 2 * y) + 900 * sin(9 * z + 4 * x) +
                             170 * sin(60 * y) * cos(50 * x + 30 * z) + 40 * sin(190 * x + 3) * cos(170 * y + 60 * z));
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    return g;
}

static void planets_have_one(void **state)
{
    (void)state;
    const char *path = made_path("planet.tclip");
    tc_grid g = planet_grid();
    const tc_pack_terrain terrain = {.width = WIDTH,
                                     .height = HEIGHT,
                                     .wraps_x = true,
                                     .radius = radius,
                                     .spacing_x = g.spacing_x,
                                     .spacing_y = g.spacing_y,
                                     .georef = g.georef,
                                     .sample_type = TC_SAMPLE_INT16,
                                     .unit = 1};
    const tc_pack_options options = {.mode = TC_PACK_LOSSLESS, .synthesis_fit = true};
    tc_packer *packer;
    tc_pack_result result;
    assert_int_equal(tc_packer_create(path, &terrain, &options, &packer, NULL), TC_OK);
    assert_int_equal(tc_packer_put(packer, (tc_rect){0, 0, WIDTH, HEIGHT}, g.z, NULL, WIDTH, NULL), TC_OK);
    assert_int_equal(tc_packer_finish(packer, &result, NULL), TC_OK);
    tc_packer_destroy(packer);
    tc_map *direct, *packed = opened(path);
    tc_error error = {TC_OK, ""};
    if (tc_map_build(&g, radius, 1, &direct, &error))
        fail_msg("%s", error.text);
    assert_int_equal(tc_map_charts(packed), 3);
    tc_synthesis_fit want = learned(tc_map_field(direct, 0));
    assert_false(want.none);
    assert_true(same_fit(tc_field_container(tc_map_field(packed, 0))->synthesis, &want));
    assert_null(tc_field_container(tc_map_field(packed, 1))->synthesis); /* caps go by the main chart's */
    assert_true(same_heights(direct, packed, 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_fit_is_that_of_the_heights),
        cmocka_unit_test(odd_terrains_have_one),
        cmocka_unit_test(files_are_the_same_otherwise),
        cmocka_unit_test(a_fit_beyond_all_is_refused_early),
        cmocka_unit_test(heights_are_those_of_the_source),
        cmocka_unit_test(cut_files_fit_anew),
        cmocka_unit_test(planets_have_one),
    };
    return cmocka_run_group_tests(tests, NULL, close_all);
}
