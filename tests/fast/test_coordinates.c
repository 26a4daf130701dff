/* test_coordinates.c - lengths on the ground, places and units by coordinate systems: projections away from their true
 * scale, feet, grads, other meridians, maps that have to be warped to lie on a globe. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/app/load.h"
#include "tests/support/loading.h"

static const double degree = 0.017453292519943295;

/* A text grid without a coordinate system, whose south-west corner is given; heights by a function of the sample's
 * middle. */
static const char *make_grid(const char *name, int width, int height, double x0, double y0, double step,
                             double (*z)(double x, double y))
{
    const char *path = made_path(name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner %.12g\nyllcorner %.12g\ncellsize %.15g\nNODATA_value -9999\n", width,
            height, x0, y0, step);
    for (int row = height - 1; row >= 0; row--)
        for (int column = 0; column < width; column++)
            fprintf(file, "%.9g%c", z(x0 + (column + 0.5) * step, y0 + (row + 0.5) * step),
                    column + 1 < width ? ' ' : '\n');
    fclose(file);
    return path;
}

static double plain(double x, double y)
{
    return 100 + 1e-3 * fmod(fabs(x), 1000) + 2e-3 * fmod(fabs(y), 1000);
}

static void assert_near(double found, double expected, double tolerance)
{
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("expected %.10g within %g, found %.10g", expected, tolerance, found);
}

/* Metres on the ground, WGS 84: a parallel's and a meridian's per radian. */
static void radii_at(double latitude, double *parallel, double *meridian)
{
    const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f), s = sin(latitude * degree), w2 = 1 - e2 * s * s;
    *parallel = a * cos(latitude * degree) / sqrt(w2);
    *meridian = a * (1 - e2) / (w2 * sqrt(w2));
}

/* ---- Lengths ---------------------------------------------------------------------------------------------------- */

static void projections_have_a_scale(void **state)
{
    (void)state;
    const double a = 6378137;
    for (double latitude = -70; latitude <= 70; latitude += 35) {
        double y = a * asinh(tan(latitude * degree)), parallel, meridian;
        radii_at(latitude, &parallel, &meridian);
        const char *path = make_grid("mercator.asc", 40, 30, 2e6, y - 1500, 100, plain);
        sayings said;
        tc_grid g = load(path, (tc_source_options){.crs = "EPSG:3857"}, &said);
        assert_near(g.spacing_x, 100 * parallel / a, 1e-3);
        assert_near(g.spacing_y, 100 * cos(latitude * degree) * meridian / a, 1e-2);
        assert_int_equal(said.warnings, 0);
        assert_int_equal(strstr(said.text, "on the ground in its middle") != NULL, latitude != 0 || g.spacing_y < 99.8);
        tc_grid_free(&g);
        /* What is asked for is what is shown. */
        g = load(path, (tc_source_options){.crs = "EPSG:3857", .spacing = 100}, NULL);
        assert_true(g.spacing_x == 100 && g.spacing_y == 100);
        tc_grid_free(&g);
    }
    /* A zone of UTM is true enough: its metres stay metres. */
    tc_grid g = load(make_grid("utm.asc", 40, 30, 5e5, 5e6, 30, plain), (tc_source_options){.crs = "EPSG:32633"}, NULL);
    assert_true(g.spacing_x == 30 && g.spacing_y == 30);
    tc_grid_free(&g);
    /* Equirectangular: one length of two is true. */
    sayings said;
    const char *path = make_grid("plate.asc", 40, 30, 0, 6673000, 100, plain);
    g = load(path, (tc_source_options){.crs = "+proj=eqc +a=6378137 +b=6378137 +units=m"}, &said);
    assert_near(g.spacing_x, 100 * cos((6673000 + 1500) / a), 1e-2);
    assert_near(g.spacing_y, 100, 1e-3);
    tc_grid_free(&g);
}

static void a_scale_that_varies_is_told(void **state)
{
    (void)state;
    sayings said;
    tc_grid g = load(make_grid("wide.asc", 40, 60, 0, 0, 1e5, plain), (tc_source_options){.crs = "EPSG:3857"}, &said);
    assert_int_equal(said.warnings, 1);
    assert_non_null(strstr(said.text, "its metre is"));
    tc_grid_free(&g);
}

/* ---- Heights ---------------------------------------------------------------------------------------------------- */

static void heights_have_the_unit_of_their_system(void **state)
{
    (void)state;
    const double foot = 1200. / 3937;
    sayings said;
    const char *path = make_grid("feet.asc", 20, 20, 5e5, 5e6, 30, plain);
    tc_grid metres = load(path, (tc_source_options){.crs = "EPSG:32633"}, NULL);
    tc_grid feet = load(path, (tc_source_options){.crs = "EPSG:32633+6360"}, &said);
    assert_near(feet.z_max, metres.z_max * foot, 1e-4);
    assert_int_equal(said.warnings, 0);
    tc_grid_free(&feet);
    feet = load(path, (tc_source_options){.crs = "EPSG:32633+5703"}, NULL);
    assert_true(feet.z_max == metres.z_max);
    tc_grid_free(&feet);
    /* A map in feet says nothing of heights. */
    path = make_grid("new-york.asc", 20, 20, 9.8e5, 2e5, 30, plain);
    tc_grid_free(&metres);
    metres = load(path, (tc_source_options){.spacing = 1}, NULL);
    feet = load(path, (tc_source_options){.crs = "EPSG:2263"}, &said);
    assert_true(feet.z_max == metres.z_max);
    assert_int_equal(said.warnings, 1);
    assert_non_null(strstr(said.text, "--unit 0.3048006"));
    assert_near(feet.spacing_x, 30 * foot, 0.03);
    tc_grid_free(&feet);
    feet = load(path, (tc_source_options){.crs = "EPSG:2263", .unit = 0.3048006}, &said);
    assert_int_equal(said.warnings, 0);
    assert_near(feet.z_max, metres.z_max * foot, 1e-4);
    tc_grid_free(&feet);
    /* Depths, and another zero. */
    feet = load(path, (tc_source_options){.crs = "EPSG:32633", .unit = -1, .has_offset = true, .offset = 7}, NULL);
    assert_near(feet.z_max + feet.z_base, 7 - metres.z_min, 1e-4);
    tc_grid_free(&feet);
    tc_grid_free(&metres);
}

static double far_out(double x, double y)
{
    return 1737400 + 500 + 0.01 * x + 0.02 * y;
}

static void radii_are_heights_above_the_body(void **state)
{
    (void)state;
    static const char moon[] = "+proj=longlat +R=1737400 +no_defs";
    const char *path = make_grid("radii.asc", 90, 45, -180, -90, 4, far_out);
    sayings said;
    tc_grid g = load(path, (tc_source_options){.crs = moon}, &said);
    assert_near(g.z_base + g.z_max, 500 + 1.78 + 1.76, 0.13);
    assert_int_equal(said.warnings, 1);
    assert_non_null(strstr(said.text, "--offset 0"));
    tc_grid_free(&g);
    g = load(path, (tc_source_options){.crs = moon, .has_offset = true}, &said);
    assert_near(g.z_base + g.z_max, 1737900, 5);
    assert_int_equal(said.warnings, 0);
    tc_grid_free(&g);
    /* Less one radius they are above a sphere, whatever the body; else above its ellipsoid. */
    static const char flattened[] = "+proj=longlat +a=1737400 +rf=200 +no_defs";
    for (int above = 0; above < 2; above++) {
        path = make_grid("planet.asc", 90, 45, -180, -90, 4, above ? plain : far_out);
        tc_map *map;
        tc_error error = {0};
        const tc_load_options how = {.body = &tc_sphere_body, .threads = 1};
        if (tc_map_load(path, &(tc_source_options){.crs = flattened}, &how, &map, &error) != TC_OK)
            fail_msg("%s", error.text);
        assert_near(tc_map_radius(map), 1737400, 1e-6);
        assert_near(tc_map_flattening(map), above ? 0.005 : 0, 1e-15);
        tc_map_destroy(map);
    }
}

/* ---- Angles ----------------------------------------------------------------------------------------------------- */

static void degrees_are_told_from_metres(void **state)
{
    (void)state;
    static const struct {
        int width, height;
        double x0, y0, step;
        bool degrees, warned;
    } grids[] = {
        {40, 30, 8, 46, 1. / 3600, true, true}, {120, 60, -10, 45, 1. / 6, true, true},
        {180, 90, -180, -90, 2, true, true},    {360, 180, 0, -90, 1, true, true},
        {720, 60, -180, -15, 0.5, true, true},  {40, 30, 8, 46, 0.5, false, true},
        {30, 30, 0, 0, 1, false, false},        {40, 30, 5e5, 5e6, 1. / 6, false, false},
        {40, 30, 340, 46, 1, false, false},
    };
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
        sayings said;
        const char *path =
            make_grid("bare.asc", grids[i].width, grids[i].height, grids[i].x0, grids[i].y0, grids[i].step, plain);
        tc_grid g = load(path, (tc_source_options){0}, &said);
        if (g.georef.geographic != grids[i].degrees || (said.warnings > 0) != grids[i].warned)
            fail_msg("grid %zu: degrees %d, said: %s", i, g.georef.geographic, said.text);
        if (!grids[i].degrees) {
            assert_near(g.spacing_x, grids[i].step, 1e-9);
            assert_int_equal(strstr(said.text, "--crs EPSG:4326") != NULL, grids[i].warned);
        }
        tc_grid_free(&g);
    }
    tc_grid g = load(make_grid("ten.asc", 120, 60, -10, 45, 1. / 6, plain), (tc_source_options){0}, NULL);
    assert_near(g.spacing_y, 18530, 30);
    tc_grid_free(&g);
    g = load(make_grid("half.asc", 40, 30, 8, 46, 0.5, plain), (tc_source_options){.crs = "EPSG:4326"}, NULL);
    assert_true(g.georef.geographic && g.spacing_y > 55000);
    tc_grid_free(&g);
}

static void angles_become_degrees_of_greenwich(void **state)
{
    (void)state;
    /* Grads from Paris, which is 2.5969213 grads east of Greenwich; and degrees from Ferro. */
    tc_grid g =
        load(make_grid("paris.asc", 40, 30, 0.1, 53, 0.01, plain), (tc_source_options){.crs = "EPSG:4807"}, NULL);
    assert_true(g.georef.geographic);
    assert_near(g.georef.transform[0], 0.9 * (2.5969213 + 0.1), 1e-6);
    assert_near(g.georef.transform[3], 0.9 * 53.3, 1e-6);
    assert_near(g.georef.transform[1], 0.009, 1e-9);
    assert_near(g.spacing_y, 1000.5, 1.5);
    assert_null(strstr(g.georef.crs_wkt, "grad"));
    tc_grid_free(&g);
    g = load(make_grid("ferro.asc", 40, 30, 34, 48, 0.01, plain), (tc_source_options){.crs = "EPSG:4805"}, NULL);
    assert_near(g.georef.transform[0], 34 - 17 - 2. / 3, 1e-6);
    tc_grid_free(&g);
}

static void systems_that_are_none_are_refused(void **state)
{
    (void)state;
    const char *path = make_grid("any.asc", 40, 30, 8, 46, 0.01, plain);
    refused_with(path, (tc_source_options){.crs = "EPSG:1"}, TC_ERR_USAGE, "--crs");
    refused_with(path, (tc_source_options){.crs = "https://example.org/a.prj"}, TC_ERR_USAGE, "--crs");
    static const char rotated[] =
        "GEOGCRS[\"rotated\",BASEGEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\",ELLIPSOID[\"WGS "
        "84\",6378137,298.257223563,LENGTHUNIT[\"metre\",1]]],PRIMEM[\"Greenwich\",0,ANGLEUNIT[\"degree\",0."
        "0174532925199433]]],DERIVINGCONVERSION[\"Pole rotation (GRIB convention)\",METHOD[\"Pole rotation (GRIB "
        "convention)\"],PARAMETER[\"Latitude of the southern pole (GRIB convention)\",-40,ANGLEUNIT[\"degree\",0."
        "0174532925199433]],PARAMETER[\"Longitude of the southern pole (GRIB "
        "convention)\",10,ANGLEUNIT[\"degree\",0.0174532925199433]],PARAMETER[\"Axis rotation (GRIB "
        "convention)\",0,ANGLEUNIT[\"degree\",0.0174532925199433]]],CS[ellipsoidal,2],AXIS[\"latitude\",north,ORDER[1],"
        "ANGLEUNIT[\"degree\",0.0174532925199433]],AXIS[\"longitude\",east,ORDER[2],ANGLEUNIT[\"degree\",0."
        "0174532925199433]]]";
    refused_with(path, (tc_source_options){.crs = rotated}, TC_ERR_UNSUPPORTED, "rotated");
}

/* ---- Globes ----------------------------------------------------------------------------------------------------- */

static const double mars = 3396190;

/* A function on the sphere without symmetry, and smooth. */
static double relief(double longitude, double latitude)
{
    double x = cos(latitude * degree) * cos(longitude * degree), y = cos(latitude * degree) * sin(longitude * degree);
    return 2000 * x * y + 1500 * sin(latitude * degree) + 1000 * x;
}

static double equirectangular(double x, double y)
{
    return relief(x / mars / degree, y / mars / degree);
}

static double polar(double x, double y)
{
    double latitude = 90 - 2 * atan(hypot(x, y) / (2 * mars)) / degree, longitude = atan2(x, -y) / degree;
    return relief(longitude, latitude);
}

static double mercator(double x, double y)
{
    return relief(x / mars / degree, (2 * atan(exp(y / mars)) - 90 * degree) / degree);
}

static double sinusoidal(double x, double y)
{
    double latitude = y / mars, longitude = x / mars / cos(latitude);
    return fabs(longitude) <= 180 * degree ? relief(longitude / degree, latitude / degree) : -9999;
}

/* Largest difference between the finest level of a map's grid and the function, away from voids. */
static double error_of(const tc_map *map)
{
    const tc_chart *c = &map->chart[0];
    const int m = tc_field_info(c->field)->levels;
    const tc_level level = tc_field_level(c->field, m);
    double largest = 0;
    for (int64_t j = 1; j < level.height - 1; j++)
        for (int64_t i = 1; i < level.width - 1; i++) {
            float z[9];
            uint8_t voids[9] = {0};
            assert_int_equal(tc_field_read(c->field, m, (tc_rect){i - 1, j - 1, i + 2, j + 2}, z, voids, 3), TC_OK);
            if (memchr(voids, 1, 9))
                continue;
            double longitude = (c->x0 + (double)i * c->dx) / degree, latitude = (c->y0 + (double)j * c->dy) / degree;
            largest = fmax(largest, fabs(z[4] + tc_field_info(c->field)->z_base - relief(longitude, latitude)));
        }
    return largest;
}

static void any_map_lies_on_its_globe(void **state)
{
    (void)state;
    const double turn = 2 * 3.141592653589793 * mars;
    static const char body[] = " +R=3396190 +units=m +no_defs";
    const struct {
        const char *name, *projection;
        int width, height;
        double x0, y0, step;
        double (*z)(double x, double y);
        double tolerance; /* metres, of a relief of 3 km: samples are 100 to 200 km apart */
        bool around, same;
    } maps[] = {
        {"eqc.asc", "+proj=eqc", 180, 90, -turn / 2, -turn / 4, turn / 180, equirectangular, 0.01, true, true},
        {"part.asc", "+proj=eqc", 60, 40, turn / 8, turn / 20, turn / 500, equirectangular, 0.01, false, true},
        {"polar.asc", "+proj=stere +lat_0=90", 100, 100, -2.5e6, -2.5e6, 5e4, polar, 8, true, false},
        {"mercator.asc", "+proj=merc", 180, 140, -turn / 2, -turn / 180 * 70, turn / 180, mercator, 8, true, false},
        {"sinu.asc", "+proj=sinu", 180, 90, -turn / 2, -turn / 4, turn / 180, sinusoidal, 25, true, false},
        {"antimeridian.asc", "+proj=stere +lon_0=180 +lat_0=20", 60, 60, -1.5e6, -1.5e6, 5e4, NULL, 0, false, false},
    };
    for (size_t k = 0; k < sizeof maps / sizeof *maps; k++) {
        char crs[200];
        snprintf(crs, sizeof crs, "%s%s", maps[k].projection, body);
        const char *path = make_grid(maps[k].name, maps[k].width, maps[k].height, maps[k].x0, maps[k].y0, maps[k].step,
                                     maps[k].z ? maps[k].z : plain);
        const tc_source_options source = {.crs = crs, .has_voids = true, .voids = TC_VOIDS_HOLE};
        const tc_load_options how = {.body = &tc_sphere_body, .threads = 2};
        tc_map *map;
        tc_error error = {0};
        if (tc_map_load(path, &source, &how, &map, &error) != TC_OK)
            fail_msg("%s: %s", maps[k].name, error.text);
        assert_near(tc_map_radius(map), mars, 1e-3);
        if (tc_field_info(map->chart[0].field)->wraps_x != maps[k].around)
            fail_msg("%s: expected %d around the globe", maps[k].name, maps[k].around);
        if (maps[k].same)
            assert_int_equal(map->height, maps[k].height);
        double off = maps[k].z ? error_of(map) : 0;
        if (off > maps[k].tolerance)
            fail_msg("%s: off by %g m", maps[k].name, off);
        if (!maps[k].z) /* on both sides of 180 degrees, and nowhere else */
            assert_true(map->georef.transform[0] > 140 && (double)map->width * map->georef.transform[1] < 80);
        tc_map_destroy(map);
    }
}

static void what_is_on_no_globe_is_refused(void **state)
{
    (void)state;
    const tc_load_options how = {.body = &tc_sphere_body, .threads = 1};
    const char *path = make_grid("nowhere.asc", 40, 30, 1e9, 1e9, 1000, plain);
    const tc_source_options source = {.crs = "+proj=ortho +R=3396190 +units=m"};
    tc_map *map = NULL;
    tc_error error = {0};
    assert_int_equal(tc_map_load(path, &source, &how, &map, &error), TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "nowhere.asc: "));
    assert_null(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(projections_have_a_scale),
        cmocka_unit_test(a_scale_that_varies_is_told),
        cmocka_unit_test(heights_have_the_unit_of_their_system),
        cmocka_unit_test(radii_are_heights_above_the_body),
        cmocka_unit_test(degrees_are_told_from_metres),
        cmocka_unit_test(angles_become_degrees_of_greenwich),
        cmocka_unit_test(systems_that_are_none_are_refused),
        cmocka_unit_test(any_map_lies_on_its_globe),
        cmocka_unit_test(what_is_on_no_globe_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
