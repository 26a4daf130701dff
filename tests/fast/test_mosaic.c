/* test_mosaic.c - several files as one terrain. */
#include "tests/support/test.h"

#include "common/input/mosaic.h"
#include "tests/support/loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Height of the map that the files are parts of, by column and row from its north-west. */
static double map(int64_t column, int64_t row)
{
    return 100 + 3 * (double)column - 2 * (double)row + (double)(column * row % 7);
}

enum { MOST = 64 * 64 };

/* A part of it, `lift` higher, as a projected TIFF with 10 m between samples. */
static const char *make_part(const char *name, int column, int row, int width, int height, double lift,
                             made_tiff settings)
{
    static float samples[MOST];
    static int16_t integers[MOST];
    for (int i = 0; i < width * height; i++) {
        samples[i] = (float)(map(column + i % width, row + i / width) + lift);
        integers[i] = (int16_t)samples[i];
    }
    double transform[6] = {505000 + 10. * column, 10, 0, 9000 - 10. * row, 0, -10};
    made_tiff tiff = settings;
    tiff.width = width;
    tiff.height = height;
    tiff.bits = tiff.bits ? tiff.bits : 32;
    tiff.format = tiff.bits == 16 ? MADE_INT : MADE_FLOAT;
    tiff.samples = tiff.bits == 16 ? (const void *)integers : samples;
    tiff.transform = settings.transform ? settings.transform : transform;
    tiff.epsg = settings.epsg ? settings.epsg : 32632;
    tiff.point = !settings.point; /* here: true asks for areas */
    make_tiff(made_path(name), &tiff);
    return strdup(made_path(name));
}

/* What a reading gave. */
typedef struct collected {
    int64_t width, height;
    float *z; /* NaN where nothing was given */
    int64_t given, bands;
    int64_t fail_after; /* bands; 0 never */
} collected;

static tc_status collect(void *context, tc_rect rect, const float *z, const uint8_t *voids, tc_error *error)
{
    collected *c = context;
    assert_true(rect.x0 >= 0 && rect.y0 >= 0 && rect.x1 <= c->width && rect.y1 <= c->height);
    if (++c->bands == c->fail_after) {
        snprintf(error->text, sizeof error->text, "enough");
        return TC_ERR_FORMAT;
    }
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++) {
            int64_t i = (y - rect.y0) * (rect.x1 - rect.x0) + x - rect.x0;
            float *to = &c->z[y * c->width + x];
            c->given++;
            if (isnan(*to) && !voids[i])
                *to = z[i];
        }
    return TC_OK;
}

static collected room_for(const tc_pack_terrain *terrain)
{
    collected c = {.width = terrain->width, .height = terrain->height};
    size_t samples = (size_t)(c.width * c.height);
    c.z = malloc(samples * sizeof *c.z);
    assert_non_null(c.z);
    for (size_t i = 0; i < samples; i++)
        c.z[i] = NAN;
    return c;
}

static tc_mosaic *open_good(const char *const *paths, int count, const tc_source_options *options)
{
    tc_mosaic *mosaic = NULL;
    tc_error error = {.text = ""};
    if (tc_mosaic_open(paths, count, options, &mosaic, &error) != TC_OK)
        fail_msg("%s", error.text);
    return mosaic;
}

static void parts_make_a_whole(void **state)
{
    (void)state;
    /* Not in order; the first is neither the north-west nor the south-west one; one lies apart; edges are shared. */
    const made_tiff plain = {0};
    const char *paths[] = {make_part("e.tif", 19, 5, 21, 20, 0, plain), make_part("w.tif", 0, 5, 20, 20, 0, plain),
                           make_part("n.tif", 0, 0, 20, 6, 0, plain), make_part("far.tif", 50, 30, 4, 3, 0, plain)};
    tc_mosaic *mosaic = open_good(paths, 4, NULL);
    const tc_pack_terrain *t = tc_mosaic_terrain(mosaic);
    assert_int_equal(t->width, 54);
    assert_int_equal(t->height, 33);
    assert_true(t->spacing_x == 10 && t->spacing_y == 10 && t->sample_type == TC_SAMPLE_FLOAT32 && t->unit == 1);
    assert_true(t->georef.known && !t->georef.geographic && !t->area_registered && t->georef.crs_wkt);
    const double wanted[6] = {504995, 10, 0, 9005, 0, -10}; /* corners of point samples */
    for (int k = 0; k < 6; k++)
        assert_float_equal(t->georef.transform[k], wanted[k], 1e-9);
    int64_t sum = 21 * 20 + 20 * 20 + 20 * 6 + 4 * 3;
    assert_int_equal(tc_mosaic_shared(mosaic), 20 + 20);
    assert_int_equal(tc_mosaic_samples(mosaic), sum - 40);

    collected c = room_for(t);
    tc_error error = {.text = ""};
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_OK);
    assert_int_equal(c.given, sum);
    int64_t valid = 0;
    for (int64_t y = 0; y < c.height; y++)
        for (int64_t x = 0; x < c.width; x++) {
            float z = c.z[y * c.width + x];
            valid += !isnan(z);
            assert_true(isnan(z) || z == (float)map(x, c.height - 1 - y));
        }
    assert_int_equal(valid, tc_mosaic_samples(mosaic));

    /* A failure of the taker ends it, at whatever band; read again, all comes again. */
    for (int after = 1; after <= 4; after++) {
        c.bands = 0;
        c.fail_after = after;
        assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_ERR_FORMAT);
        assert_string_equal(error.text, "enough");
    }
    c.fail_after = 0;
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_OK);
    free(c.z);
    tc_mosaic_close(mosaic);
    for (int i = 0; i < 4; i++)
        free((char *)paths[i]);
}

static void storage_is_told(void **state)
{
    (void)state;
    const made_tiff int16 = {.bits = 16, .nodata = "-32768"}, bare = {.bits = 16};
    const made_tiff scaled = {.bits = 16, .metadata = "<Item name=\"SCALE\" sample=\"0\" role=\"scale\">2</Item>"};
    const char *a = make_part("a.tif", 0, 0, 5, 5, 0, bare), *b = make_part("b.tif", 4, 0, 5, 5, 0, int16);
    const char *c = make_part("c.tif", 8, 0, 5, 5, 0, scaled), *d = make_part("d.tif", 12, 0, 5, 5, 0, (made_tiff){0});
    const struct {
        const char *paths[2];
        tc_sample_type type;
        bool nodata;
    } cases[] = {{{a, b}, TC_SAMPLE_INT16, true}, /* of the file that says one */
                 {{b, c}, TC_SAMPLE_FLOAT32, false},
                 {{b, d}, TC_SAMPLE_FLOAT32, false},
                 {{d, a}, TC_SAMPLE_FLOAT32, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tc_mosaic *mosaic = open_good(cases[i].paths, 2, NULL);
        const tc_pack_terrain *t = tc_mosaic_terrain(mosaic);
        assert_true(t->sample_type == cases[i].type && t->unit == 1 && t->offset == 0);
        assert_true(t->has_nodata == cases[i].nodata && (!t->has_nodata || t->nodata == -32768));
        tc_mosaic_close(mosaic);
    }
    tc_mosaic *one = open_good(&c, 1, NULL);
    assert_true(tc_mosaic_terrain(one)->unit == 2 && tc_mosaic_terrain(one)->sample_type == TC_SAMPLE_INT16);
    tc_mosaic_close(one);
    free((char *)a);
    free((char *)b);
    free((char *)c);
    free((char *)d);
}

/* Heights about 1e6 m keep their millimetres: all parts are above the first one's base. */
static void one_base_for_all(void **state)
{
    (void)state;
    static double high[2][16];
    const char *paths[2];
    for (int f = 0; f < 2; f++) {
        char name[32];
        for (int i = 0; i < 16; i++)
            high[f][i] = 1e6 + 500 * f + 0.001 * i;
        double transform[6] = {40. * f, 10, 0, 0, 0, -10};
        snprintf(name, sizeof name, "high%d.tif", f);
        make_tiff(made_path(name), &(made_tiff){.width = 4,
                                                .height = 4,
                                                .bits = 64,
                                                .format = MADE_FLOAT,
                                                .samples = high[f],
                                                .transform = transform,
                                                .epsg = 32632,
                                                .point = true});
        paths[f] = strdup(made_path(name));
    }
    tc_mosaic *mosaic = open_good(paths, 2, NULL);
    assert_true(tc_mosaic_terrain(mosaic)->z_base == 1e6);
    collected c = room_for(tc_mosaic_terrain(mosaic));
    tc_error error = {.text = ""};
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_OK);
    for (int i = 0; i < 32; i++) {
        int f = i % 8 / 4, sample = (3 - i / 8) * 4 + i % 4;
        assert_float_equal(c.z[i], 500 * f + 0.001 * sample, 4e-5);
    }
    free(c.z);
    tc_mosaic_close(mosaic);

    /* Without loss that is not to be had. */
    const tc_source_options exact = {.exact = true};
    mosaic = open_good(paths, 2, &exact);
    c = room_for(tc_mosaic_terrain(mosaic));
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "32-bit float"));
    free(c.z);
    tc_mosaic_close(mosaic);
    free((char *)paths[0]);
    free((char *)paths[1]);
}

static void tiles_share_an_edge(void **state)
{
    (void)state;
    static int16_t samples[1201 * 1201];
    const char *paths[2];
    for (int f = 0; f < 2; f++) {
        for (int i = 0; i < 1201 * 1201; i++)
            samples[i] = (int16_t)(i % 1201 + 1200 * f);
        make_hgt(made_path(f ? "N46E008.hgt" : "N46E007.hgt"), 1201, samples);
        paths[f] = strdup(made_path(f ? "N46E008.hgt" : "N46E007.hgt"));
    }
    tc_mosaic *mosaic = open_good(paths, 2, NULL);
    const tc_pack_terrain *t = tc_mosaic_terrain(mosaic);
    assert_true(t->width == 2401 && t->height == 1201 && t->georef.geographic);
    assert_int_equal(tc_mosaic_shared(mosaic), 1201);
    assert_float_equal(t->georef.transform[0], 7 - 0.5 / 1200, 1e-12);
    assert_float_equal(t->spacing_x, 63.9688, 1e-4);
    collected c = room_for(t);
    tc_error error = {.text = ""};
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_OK);
    for (int64_t i = 0; i < c.width * c.height; i++)
        assert_true(c.z[i] == (float)(i % c.width));
    free(c.z);
    tc_mosaic_close(mosaic);
    free((char *)paths[0]);
    free((char *)paths[1]);
}

static void disagreement_is_refused(void **state)
{
    (void)state;
    const made_tiff plain = {0};
    double half[6] = {505005, 10, 0, 9000, 0, -10}, wide[6] = {505100, 10.001, 0, 9000, 0, -10};
    double turned[6] = {505100, 10, 1, 9000, 1, -10};
    const char *first = make_part("first.tif", 0, 0, 10, 10, 0, plain);
    const struct {
        const char *path, *word;
    } cases[] = {
        {make_part("zone.tif", 10, 0, 10, 10, 0, (made_tiff){.epsg = 32633}), "coordinate system: expected that of "},
        {make_part("area.tif", 10, 0, 10, 10, 0, (made_tiff){.point = true}), "position: expected whole samples"},
        {make_part("half.tif", 10, 0, 10, 10, 0, (made_tiff){.transform = half}), "position: expected whole samples"},
        {make_part("wide.tif", 10, 0, 10, 10, 0, (made_tiff){.transform = wide}), "pixel size: expected 10 x 10"},
        {make_part("turned.tif", 10, 0, 10, 10, 0, (made_tiff){.transform = turned}), "pixel size: "},
        {strdup(made_path("missing.tif")), "No such file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *paths[2] = {first, cases[i].path};
        tc_mosaic *mosaic = NULL;
        tc_error error = {.text = ""};
        assert_true(tc_mosaic_open(paths, 2, NULL, &mosaic, &error) != TC_OK);
        assert_null(mosaic);
        if (!strstr(error.text, cases[i].word) || !strstr(error.text, cases[i].path))
            fail_msg("expected '%s', found '%s'", cases[i].word, error.text);
        free((char *)cases[i].path);
    }
    make_pgm(made_path("nowhere.pgm"), W, H, samples_of(16, MADE_UINT, 1, 0));
    const char *paths[2] = {first, made_path("nowhere.pgm")};
    tc_mosaic *mosaic = NULL;
    tc_error error = {.text = ""};
    assert_int_equal(tc_mosaic_open(paths, 2, NULL, &mosaic, &error), TC_ERR_FORMAT);
    assert_non_null(strstr(error.text, "nowhere.pgm: georeference: expected one"));
    mosaic = open_good(paths + 1, 1, NULL); /* alone it may lie anywhere */
    assert_true(tc_mosaic_terrain(mosaic)->width == W && !tc_mosaic_terrain(mosaic)->georef.known);
    tc_mosaic_close(mosaic);
    free((char *)first);
}

/* A file that is damaged in the middle, or gone by the time it is read. */
static void failures_of_reading_arrive(void **state)
{
    (void)state;
    const made_tiff plain = {0};
    const char *paths[2] = {make_part("kept.tif", 0, 0, 10, 10, 0, plain),
                            make_part("lost.tif", 10, 0, 10, 10, 0, plain)};
    tc_mosaic *mosaic = open_good(paths, 2, NULL);
    collected c = room_for(tc_mosaic_terrain(mosaic));
    tc_error error = {.text = ""};
    remove(paths[1]);
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_ERR_IO);
    assert_non_null(strstr(error.text, "lost.tif"));
    assert_int_equal(c.given, 100);
    free((char *)make_part("lost.tif", 10, 0, 10, 11, 0, plain));
    assert_int_equal(tc_mosaic_read(mosaic, collect, &c, &error), TC_ERR_IO);
    assert_non_null(strstr(error.text, "changed meanwhile"));
    free(c.z);
    tc_mosaic_close(mosaic);
    free((char *)paths[0]);
    free((char *)paths[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_make_a_whole),      cmocka_unit_test(storage_is_told),
        cmocka_unit_test(one_base_for_all),        cmocka_unit_test(tiles_share_an_edge),
        cmocka_unit_test(disagreement_is_refused), cmocka_unit_test(failures_of_reading_arrive),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
