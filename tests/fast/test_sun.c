/* test_sun.c - where the sun stands, by published figures; dates as they are written; and which sides of the ground it
 * lights, by day and at night, on a plane and on a globe. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/sun.h"
#include "tests/support/planet_scene.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

static const double DEGREE = M_PI / 180;

static double julian_of(const char *date)
{
    double julian = 0;
    if (!tc_sun_read_date(date, &julian))
        fail_msg("%s is not read", date);
    return julian;
}

/* ---- The sky ----------------------------------------------------------------------------------------------------- */

static void dates_are_counted(void **state)
{
    (void)state;
    /* Meeus, chapter 7. */
    assert_true(fabs(julian_of("2000-01-01T12:00Z") - 2451545.0) < 1e-9);
    assert_true(fabs(julian_of("1999-01-01T00:00Z") - 2451179.5) < 1e-9);
    assert_true(fabs(julian_of("1987-01-27T00:00Z") - 2446822.5) < 1e-9);
    assert_true(fabs(julian_of("1988-06-19T12:00Z") - 2447332.0) < 1e-9);
    assert_true(fabs(julian_of("1957-10-04T19:26Z") - 2436116.31) < 5e-4);
    assert_true(fabs(julian_of("2024-02-29T23:59Z") - julian_of("2024-03-01T00:00Z") + 1.0 / 1440) < 1e-9);
}

static void dates_that_are_none_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "2024",
                                      "2024-06-21",
                                      "2024-06-21T12:00",
                                      "2024-06-21T12:00z",
                                      "2024-06-21 12:00Z",
                                      "2024-06-21T12:00:00Z",
                                      "2024-06-21T12:00Z ",
                                      " 2024-06-21T12:00Z",
                                      "2024-06-21T12:00+01:00",
                                      "2024-13-01T12:00Z",
                                      "2024-00-01T12:00Z",
                                      "2024-06-00T12:00Z",
                                      "2024-06-31T12:00Z",
                                      "2024-02-30T12:00Z",
                                      "2023-02-29T12:00Z",
                                      "2024-06-21T24:00Z",
                                      "2024-06-21T12:60Z",
                                      "2024-6-21T12:00Z",
                                      "24-06-21T12:00Z",
                                      "-024-06-21T12:00Z",
                                      "+024-06-21T12:00Z",
                                      "1900-06-21T12:00Z",
                                      "2100-01-01T00:00Z"};
    double julian = 7;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (tc_sun_read_date(bad[i], &julian) || julian != 7)
            fail_msg("'%s' is read", bad[i]);
    julian_of("1901-01-01T00:00Z"), julian_of("2099-12-31T23:59Z"), julian_of("2000-02-29T00:00Z");
}

static void the_sun_stands_where_almanacs_say(void **state)
{
    (void)state;
    double ascension, declination;
    tc_sun_apparent(2448908.5, &ascension, &declination); /* Meeus, example 25.a */
    assert_true(fabs(ascension / DEGREE - 198.38083) < 2e-5);
    assert_true(fabs(declination / DEGREE + 7.78507) < 2e-5);
    /* Minutes of equinoxes and solstices: the almanac's. */
    tc_sun_apparent(julian_of("2024-03-20T03:06Z"), &ascension, &declination);
    assert_true(fabs(declination / DEGREE) < 0.01 && fabs(remainder(ascension, 2 * M_PI) / DEGREE) < 0.01);
    tc_sun_apparent(julian_of("2024-06-20T20:51Z"), &ascension, &declination);
    assert_true(fabs(declination / DEGREE - 23.437) < 0.01 && fabs(ascension / DEGREE - 90) < 0.01);
    tc_sun_apparent(julian_of("2024-09-22T12:44Z"), &ascension, &declination);
    assert_true(fabs(declination / DEGREE) < 0.01 && fabs(ascension / DEGREE - 180) < 0.01);
    tc_sun_apparent(julian_of("2024-12-21T09:21Z"), &ascension, &declination);
    assert_true(fabs(declination / DEGREE + 23.437) < 0.01 && fabs(ascension / DEGREE - 270) < 0.01);
}

/* Noon at Greenwich differs from 12 hours by the equation of time: its extremes, in minutes, and a place at a time. */
static void the_earth_turns_below_it(void **state)
{
    (void)state;
    static const struct {
        const char *date;
        double minutes;
    } extremes[] = {{"2024-02-11T12:00Z", -14.22},
                    {"2024-05-13T12:00Z", 3.65},
                    {"2024-07-26T12:00Z", -6.55},
                    {"2024-11-03T12:00Z", 16.45}};
    for (size_t i = 0; i < sizeof extremes / sizeof *extremes; i++) {
        const tc_sun sun = tc_sun_over_earth(julian_of(extremes[i].date));
        const double minutes = -sun.longitude / DEGREE * 4;
        if (fabs(minutes - extremes[i].minutes) > 0.1)
            fail_msg("%s: %.3f minutes", extremes[i].date, minutes);
    }
    const tc_body globe = tc_body_of(6371e3);
    const tc_sun sun = tc_sun_over_earth(julian_of("2024-03-20T12:00Z"));
    tc_sun seen = tc_sun_from(&sun, &globe, (const double[3]){sun.longitude, sun.latitude, 0});
    assert_true(fabs(seen.elevation - M_PI / 2) < 1e-6);
    seen = tc_sun_from(&sun, &globe, (const double[3]){sun.longitude + 60 * DEGREE, 0, 0}); /* in the afternoon */
    assert_true(fabs(seen.elevation - 30 * DEGREE) < 0.1 * DEGREE && fabs(seen.azimuth - 270 * DEGREE) < 0.2 * DEGREE);
    seen = tc_sun_from(&sun, &globe, (const double[3]){sun.longitude, 50 * DEGREE, 0});
    assert_true(fabs(seen.elevation - 40 * DEGREE) < 0.2 * DEGREE && fabs(seen.azimuth - 180 * DEGREE) < 1e-6);
    seen = tc_sun_from(&sun, &globe, (const double[3]){sun.longitude + M_PI, 0, 0});
    assert_true(seen.elevation < -89 * DEGREE && tc_sun_day(sin(seen.elevation)) == 0);
}

/* ---- What is lit ------------------------------------------------------------------------------------------------- */

enum { SIDE = 160, SAMPLES = 257 };
static const double SPACING = 30, RIDGE = 16 * 30, HIGH = 40;

static tc_context *context;

/* Ridges along both axes; the middle of the map is a top. */
static tc_field *ridges(void)
{
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, SAMPLES, SAMPLES, SPACING, 1);
    for (int64_t i = 0; i < SAMPLES * SAMPLES; i++)
        grid.z[i] = (float)(100 + HIGH * (cos(2 * M_PI * ((double)(i % SAMPLES) - SAMPLES / 2) * SPACING / RIDGE) +
                                          cos(2 * M_PI * ((double)(i / SAMPLES) - SAMPLES / 2) * SPACING / RIDGE)));
    grid.z_min = (float)(100 - 2 * HIGH), grid.z_max = (float)(100 + 2 * HIGH);
    tc_field *field;
    if (tc_field_build(&grid, 2, &field, NULL) != TC_OK)
        fail();
    return field;
}

typedef struct brightness {
    double east, west, north, south, all; /* of slopes that face there; means of 0 .. 255 */
} brightness;

/* Of a picture from straight above a top, `across` metres wide, of ridges in metres. */
static brightness look(const uint8_t *rgb, double across)
{
    double sum[5] = {0}, count[5] = {0};
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            const double x = (i + 0.5 - SIDE / 2) * across / SIDE, y = -(j + 0.5 - SIDE / 2) * across / SIDE;
            const double east = sin(2 * M_PI * x / RIDGE), north = sin(2 * M_PI * y / RIDGE); /* where it falls to */
            const uint8_t *p = rgb + 3 * (j * SIDE + i);
            const double bright = (p[0] + p[1] + p[2]) / 3.0;
            const bool is[5] = {east > 0.5 && fabs(north) < 0.5, east < -0.5 && fabs(north) < 0.5,
                                north > 0.5 && fabs(east) < 0.5, north < -0.5 && fabs(east) < 0.5, true};
            for (int k = 0; k < 5; k++)
                sum[k] += is[k] ? bright : 0, count[k] += is[k];
        }
    return (brightness){sum[0] / count[0], sum[1] / count[1], sum[2] / count[2], sum[3] / count[3], sum[4] / count[4]};
}

static brightness of_scene(const tc_scene_options *options)
{
    tc_field *field = ridges();
    const double middle = SAMPLES / 2 * SPACING, up = 6000, across = 1600;
    const tc_camera camera = {.x = middle,
                              .y = middle,
                              .z = up,
                              .pitch = -M_PI / 2,
                              .fov = 2 * atan(0.5 * across / up),
                              .width = SIDE,
                              .height = SIDE};
    scene s = scene_create(context, field, 0, options);
    scene_draw(&s, &camera, true);
    uint8_t *rgb = scene_pixels(&s, &camera);
    const brightness b = look(rgb, across);
    free(rgb);
    scene_destroy(&s);
    tc_field_destroy(field);
    return b;
}

static brightness of_plane(tc_sun sun)
{
    return of_scene(&(tc_scene_options){.sun = sun, .budget = -1});
}

static tc_sun at(double azimuth, double elevation)
{
    return (tc_sun){.kind = TC_SUN_LOCAL, .azimuth = azimuth * DEGREE, .elevation = elevation * DEGREE};
}

static void slopes_that_face_it_are_lit(void **state)
{
    (void)state;
    brightness b = of_plane(at(90, 25));
    assert_true(b.east > 1.3 * b.west && fabs(b.north - b.south) < 0.05 * b.north);
    b = of_plane(at(270, 25));
    assert_true(b.west > 1.3 * b.east && fabs(b.north - b.south) < 0.05 * b.north);
    b = of_plane(at(0, 25));
    assert_true(b.north > 1.3 * b.south && fabs(b.east - b.west) < 0.05 * b.east);
    b = of_plane(at(180, 25));
    assert_true(b.south > 1.3 * b.north && fabs(b.east - b.west) < 0.05 * b.east);
    b = of_plane(at(0, 90));
    assert_true(fabs(b.east - b.west) < 0.02 * b.east && fabs(b.north - b.south) < 0.02 * b.north);
    b = of_plane(at(135, 30));
    assert_true(b.east > 1.2 * b.west && b.south > 1.2 * b.north);
}

static void nights_are_dark_and_not_black(void **state)
{
    (void)state;
    const brightness noon = of_plane(at(180, 60)), low = of_plane(at(270, 5)), night = of_plane(at(270, -30));
    assert_true(low.all < noon.all && night.all < 0.4 * noon.all);
    assert_true(night.all > 8);
    /* It is as dark wherever the sun is that has set. */
    const brightness other = of_plane(at(90, -50));
    assert_true(fabs(other.all - night.all) < 0.2 * night.all);
    assert_true(fabs(night.east - night.west) < 0.25 * night.all);
}

/* The light that there is without it is one of these. */
static void the_usual_light_is_one_of_them(void **state)
{
    (void)state;
    const brightness usual = of_plane((tc_sun){0}), same = of_plane(at(310, 38));
    assert_memory_equal(&usual, &same, sizeof same);
    assert_true(usual.west > usual.east && usual.north > usual.south);
}

/* Colours that take no light of it are seen as by day, sky and haze with them. */
static void what_it_does_not_light_has_no_night(void **state)
{
    (void)state;
    static const int shades[] = {TC_SHADE_NATURAL, TC_SHADE_HEIGHT, TC_SHADE_SLOPE, TC_SHADE_NONE};
    for (size_t i = 0; i < sizeof shades / sizeof *shades; i++) {
        tc_scene_options o = {.shade = &tc_shades[shades[i]],
                              .unlit = i == 0,
                              .around = {.walls = true, .night_stars = true},
                              .budget = -1};
        const brightness day = of_scene(&o);
        o.sun = at(270, -30);
        const brightness night = of_scene(&o);
        assert_memory_equal(&day, &night, sizeof day);
        const tc_terrain_info info = {.z_max = 100};
        assert_false(tc_scene_needs_of(&o, &info).stars);
        o.shade = NULL, o.unlit = false;
        assert_true(tc_scene_needs_of(&o, &info).stars);
    }
}

static double ridged(void *unused, const double p[3])
{
    (void)unused;
    return 5000 * cos(40 * atan2(p[1], p[0]));
}

/* The middle of a planet's ridge along longitude 0, from above: brightness west and east of it. The eye is at
 * `longitude`. */
static void of_planet(tc_sun sun, double longitude, double *west_ret, double *east_ret)
{
    const double radius = 1e6, up = 1e5, across = 2 * M_PI / 40 * radius;
    tc_map *map = planet_atlas(512, radius, ridged, NULL);
    const tc_scene_options options = {.sun = sun, .budget = -1, .background_set = true};
    const tc_camera camera = {
        .x = longitude, .z = up, .pitch = -M_PI / 2, .fov = 2 * atan(0.5 * across / up), .width = SIDE, .height = SIDE};
    scene s = planet_scene(context, map, &(tc_rings_options){0}, &options);
    scene_draw(&s, &camera, true);
    uint8_t *rgb = scene_pixels(&s, &camera);
    double sum[2] = {0};
    for (int j = SIDE / 4; j < SIDE * 3 / 4; j++)
        for (int i = SIDE / 8; i < SIDE * 7 / 8; i++)
            sum[i >= SIDE / 2] += rgb[3 * (j * SIDE + i) + 1];
    *west_ret = sum[0] / (SIDE / 2 * SIDE * 3 / 8), *east_ret = sum[1] / (SIDE / 2 * SIDE * 3 / 8);
    free(rgb);
    scene_destroy(&s);
    tc_map_destroy(map);
}

static void a_globe_has_day_and_night(void **state)
{
    (void)state;
    double west, east, noon;
    of_planet(at(90, 20), 0, &west, &east);
    assert_true(east > 1.2 * west);
    of_planet(at(270, 20), 0, &west, &east);
    assert_true(west > 1.2 * east);
    const tc_sun over = {.kind = TC_SUN_OVER, .longitude = 60 * DEGREE, .latitude = 0};
    of_planet(over, 0, &west, &east); /* in the east it is 60 degrees on: 30 degrees high */
    assert_true(east > 1.1 * west);
    of_planet(over, 120 * 2 * M_PI / 360, &west, &east); /* and in the west here; 120 degrees is a ridge, too */
    assert_true(west > 1.1 * east);
    of_planet(over, 60 * DEGREE + M_PI / 180 * 3, &west, &noon);
    of_planet(over, M_PI + 60 * DEGREE, &west, &east);
    assert_true(east < 0.45 * noon && east > 8);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dates_are_counted),
        cmocka_unit_test(dates_that_are_none_are_refused),
        cmocka_unit_test(the_sun_stands_where_almanacs_say),
        cmocka_unit_test(the_earth_turns_below_it),
        cmocka_unit_test(slopes_that_face_it_are_lit),
        cmocka_unit_test(nights_are_dark_and_not_black),
        cmocka_unit_test(the_usual_light_is_one_of_them),
        cmocka_unit_test(what_it_does_not_light_has_no_night),
        cmocka_unit_test(a_globe_has_day_and_night),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
