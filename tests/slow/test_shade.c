/* test_shade.c - what maps show: slopes and their directions against known ones, in the colours that shades give them;
 * hillshades; colours of heights alone. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/measure/view_error.h"
#include "common/map/map.h"
#include "tests/support/planet_scene.h"
#include "tests/support/scene.h"

#define DEGREE (M_PI / 180)
enum { SIDE = 257, WIDTH = 160, HEIGHT = 120 };
static const double spacing = 30;
static tc_context *context;

/* ---- What is expected -------------------------------------------------------------------------------------------- */

/* Of a fall to the east and to the north, metres a metre; as shown, 0 .. 255. */
static void expected_colour(const tc_shade *shade, double east, double north, double rgb[3])
{
    const bool aspect = strcmp(shade->name, "aspect") == 0;
    const double steep = hypot(east, north), clockwise = atan2(east, north) / DEGREE;
    double rgba[4];
    tc_colour_ramp_at(&shade->colours,
                      !aspect         ? atan(steep) / DEGREE
                      : clockwise < 0 ? clockwise + 360
                                      : clockwise,
                      0, shade->degrees, rgba);
    for (int k = 0; k < 3; k++) {
        /* Grey where it is flat; colours are mixed as light. */
        double directed = aspect ? fmin(steep / 0.05, 1) : 1;
        rgb[k] = 255 * sqrt(0.64 * 0.64 * (1 - directed) + rgba[k] * rgba[k] * directed);
    }
}

static double difference(const uint8_t *found, const double rgb[3])
{
    return fmax(fabs(found[0] - rgb[0]), fmax(fabs(found[1] - rgb[1]), fabs(found[2] - rgb[2])));
}

static const tc_shade *shade_of(const char *name)
{
    const tc_shade *shade = tc_shade_named(name);
    assert_non_null(shade);
    return shade;
}

static void shades_have_names(void **state)
{
    (void)state;
    static const char *const names[] = {"natural", "slope", "aspect", "height", "none"};
    char list[128] = "";
    for (int i = 0; i < 5; i++) {
        assert_string_equal(shade_of(names[i])->name, names[i]);
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s",
                 i == 0  ? ""
                 : i < 4 ? ", "
                         : " or ",
                 names[i]);
    }
    assert_string_equal(list, TC_SHADE_NAMES);
    assert_null(tc_shade_named("foo"));
    assert_null(tc_shade_named(""));
    /* A wheel has no beginning, and colours that are told apart. */
    const tc_colour_ramp *wheel = &shade_of("aspect")->colours;
    assert_memory_equal(wheel->stop[0].rgba, wheel->stop[wheel->count - 1].rgba, 4);
}

/* ---- Flat maps --------------------------------------------------------------------------------------------------- */

typedef double (*ground_function)(const void *context, double x, double y);

static tc_field *ground_of(ground_function height, const void *about)
{
    tc_grid g = {.width = SIDE, .height = SIDE, .spacing_x = spacing, .spacing_y = spacing};
    g.z = malloc((size_t)SIDE * SIDE * sizeof *g.z);
    assert_non_null(g.z);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int i = 0; i < SIDE * SIDE; i++) {
        g.z[i] = (float)height(about, i % SIDE * spacing, i / SIDE * spacing);
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    tc_field *field;
    assert_int_equal(tc_field_build(&g, 1, &field, NULL), TC_OK);
    return field;
}

/* A pyramid of eight sides that fall to the north, the north-east and so on, all as steep. */
static double pyramid(const void *steepness, double x, double y)
{
    const double middle = 0.5 * (SIDE - 1) * spacing;
    double out = 0;
    for (int k = 0; k < 8; k++)
        out = fmax(out, sin(45 * k * DEGREE) * (x - middle) + cos(45 * k * DEGREE) * (y - middle));
    return 4000 - tan(*(const double *)steepness * DEGREE) * out;
}

static tc_camera above(double height)
{
    const double middle = 0.5 * (SIDE - 1) * spacing;
    return (tc_camera){.x = middle,
                       .y = middle,
                       .z = 4000 + height,
                       .pitch = -M_PI / 2,
                       .fov = 60 * DEGREE,
                       .width = WIDTH,
                       .height = HEIGHT};
}

/* n: small ones show several levels. */
static uint8_t *picture(const tc_field *field, int n, const tc_camera *c, const tc_scene_options *options)
{
    scene s = scene_create(context, field, n, options);
    scene_draw(&s, c, true);
    uint8_t *rgb = scene_pixels(&s, c);
    scene_destroy(&s);
    return rgb;
}

static const double steepness[] = {0, 0.4, 3, 12, 29, 33.5, 38, 44, 52, 63, 71};
enum { STEEP = sizeof steepness / sizeof *steepness };

/* A pixel in the middle of a pyramid's side, seen from above its top. */
static const uint8_t *on_side(const uint8_t *rgb, int side)
{
    int x = WIDTH / 2 + (int)lrint(30 * sin(45 * side * DEGREE)),
        y = HEIGHT / 2 - (int)lrint(30 * cos(45 * side * DEGREE));
    return rgb + 3 * (y * WIDTH + x);
}

/* In eight directions, from so high that several levels are drawn. */
static void sides_have_their_slopes_and_aspects(void **state)
{
    (void)state;
    static const char *const names[] = {"slope", "aspect"};
    for (int i = 0; i < STEEP; i++) {
        tc_field *field = ground_of(pyramid, &steepness[i]);
        for (int n = 0; n < 2; n++) {
            const tc_shade *shade = shade_of(names[n]);
            const tc_camera c = above(2500);
            uint8_t *rgb =
                picture(field, 31, &c,
                        &(tc_scene_options){
                            .shade = shade, .background_set = true, .samples = i % 3 == 1 ? 4 : 1, .budget = -1});
            for (int k = 0; k < 8; k++) {
                const double along = tan(steepness[i] * DEGREE);
                const uint8_t *found = on_side(rgb, k);
                double expected[3];
                expected_colour(shade, along * sin(45 * k * DEGREE), along * cos(45 * k * DEGREE), expected);
                if (difference(found, expected) > 2)
                    fail_msg("%s of %g degrees towards %d: %d %d %d instead of %g %g %g", names[n], steepness[i],
                             45 * k, found[0], found[1], found[2], expected[0], expected[1], expected[2]);
            }
            free(rgb);
        }
        tc_field_destroy(field);
    }
}

static double cone(const void *along, double x, double y)
{
    const double middle = 0.5 * (SIDE - 1) * spacing;
    return 4000 - *(const double *)along * hypot(x - middle, y - middle);
}

/* A cone falls away from its top, everywhere as much. */
static void a_cone_falls_from_its_top(void **state)
{
    (void)state;
    static const char *const names[] = {"slope", "aspect"};
    const double along = tan(36 * DEGREE);
    tc_field *field = ground_of(cone, &along);
    const tc_camera c = above(1500);
    for (int n = 0; n < 2; n++) {
        const tc_shade *shade = shade_of(names[n]);
        uint8_t *rgb =
            picture(field, 127, &c, &(tc_scene_options){.shade = shade, .background_set = true, .budget = -1});
        int looked_at = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                double ray[3], expected[3];
                tc_view_ray(&c, x + 0.5, y + 0.5, ray);
                /* Rays from above the top: the direction is the ray's. */
                double out = hypot(ray[0], ray[1]), r = 1500 * out / (-ray[2] - along * out);
                if (r < 12 * spacing || r > 50 * spacing)
                    continue;
                looked_at++;
                expected_colour(shade, along * ray[0] / out, along * ray[1] / out, expected);
                /* Interpolated between samples, a cone is not quite round. */
                double curved = n ? 2 + 255 * 0.12 * spacing / r : 2 + 200 * spacing * spacing / (r * r);
                if (difference(rgb + 3 * (y * WIDTH + x), expected) > curved)
                    fail_msg("%s at %d, %d, %g m from the top: %d %d %d instead of %g %g %g", names[n], x, y, r,
                             rgb[3 * (y * WIDTH + x)], rgb[3 * (y * WIDTH + x) + 1], rgb[3 * (y * WIDTH + x) + 2],
                             expected[0], expected[1], expected[2]);
            }
        assert_true(looked_at > 3000);
        free(rgb);
    }
    tc_field_destroy(field);
}

/* Light over that on flat ground; squares of what is shown add up. */
static void hillshades_are_lit_from_the_north_west(void **state)
{
    (void)state;
    const tc_camera c = above(2500);
    static tc_colour_stop grey[] = {{0, false, {120, 120, 120, 255}}};
    const tc_colour_ramp colours = {1, grey};
    for (int i = 0; i < STEEP; i++) {
        const double along = tan(steepness[i] * DEGREE);
        tc_field *field = ground_of(pyramid, &steepness[i]);
        uint8_t *rgb =
            picture(field, 31, &c,
                    &(tc_scene_options){
                        .shade = shade_of("height"), .colours = &colours, .background_set = true, .budget = -1});
        for (int k = 0; k < 8; k++) {
            const double towards = (45 * k + 45) * DEGREE; /* from the north-west on */
            double lit = (along * cos(towards) / M_SQRT2 + M_SQRT1_2) / sqrt(1 + along * along) / M_SQRT1_2;
            double shown = fmin(120 * sqrt(0.15 + 0.85 * fmax(lit, 0)), 255);
            const uint8_t *found = on_side(rgb, k);
            if (difference(found, (double[3]){shown, shown, shown}) > 2)
                fail_msg("%g degrees towards %d: %d instead of %g", steepness[i], 45 * k, found[0], shown);
        }
        free(rgb);
        tc_field_destroy(field);
    }
}

static double hills(const void *unused, double x, double y)
{
    (void)unused;
    return 900 * sin(x / 900) * cos(y / 700) + 200;
}

static void assert_same(const tc_field *field, const tc_camera *c, const tc_scene_options *a, const tc_scene_options *b,
                        bool same)
{
    uint8_t *one = picture(field, 63, c, a), *other = picture(field, 63, c, b);
    assert_int_equal(memcmp(one, other, (size_t)WIDTH * HEIGHT * 3) == 0, same);
    free(one), free(other);
}

/* Shades are what they say: none is colours without light and air; natural is what there is without; angles have no
 * colours of heights and no light; and holes are left out of all of them. */
static void shades_are_what_they_say(void **state)
{
    (void)state;
    tc_field *field = ground_of(hills, NULL);
    static tc_colour_stop stops[] = {{-700, false, {10, 20, 200, 255}}, {1100, false, {250, 240, 10, 255}}};
    const tc_colour_ramp colours = {2, stops};
    tc_camera c = above(600);
    c.z = 1500, c.pitch = -0.5;
    const tc_scene_options natural = {.budget = -1}, flat = {.unlit = true, .background_set = true, .budget = -1};
    tc_scene_options o = natural;
    o.shade = shade_of("natural");
    assert_same(field, &c, &natural, &o, true);
    o = flat, o.unlit = false, o.shade = shade_of("none");
    assert_same(field, &c, &flat, &o, true);
    static const char *const names[] = {"slope", "aspect", "height", "none"};
    for (int i = 0; i < 4; i++) {
        tc_scene_options with = {.shade = shade_of(names[i]), .budget = -1}, without = with;
        assert_same(field, &c, &natural, &with, false);
        with.colours = &colours;
        assert_same(field, &c, &without, &with, i < 2); /* of heights */
        with = without, with.unlit = true;
        assert_same(field, &c, &without, &with, i != 2);
        with = without, with.level_colours = true;
        assert_same(field, &c, &without, &with, false);
    }
    tc_field_destroy(field);
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

static const double earth = 6371000;

/* Waves along an axis that is none of the charts': their slope is known everywhere. */
typedef struct waves {
    double steepest; /* metres a metre, on the sphere */
    double number;   /* of waves around */
} waves;
static const double axis[3] = {0.48, -0.6, 0.64};

static double wave_height(void *about, const double p[3])
{
    const waves *w = about;
    double along = axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
    return earth * w->steepest / w->number * sin(w->number * along);
}

/* The fall to the east and to the north. */
static void wave_fall(const waves *w, const tc_body *body, double longitude, double latitude, double fall[2])
{
    double p[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)};
    double east[3] = {-sin(longitude), cos(longitude), 0};
    double north[3] = {-sin(latitude) * cos(longitude), -sin(latitude) * sin(longitude), cos(latitude)};
    double along = axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
    double rise = w->steepest * cos(w->number * along), z = wave_height((void *)w, p);
    fall[0] = fall[1] = 0;
    for (int k = 0; k < 3; k++)
        fall[0] -= rise * axis[k] * east[k], fall[1] -= rise * axis[k] * north[k];
    double meridian, parallel;
    body->class->curvature(body, latitude, &meridian, &parallel);
    fall[0] *= earth / (parallel + z), fall[1] *= earth / (meridian + z);
}

/* Straight below the eye, at places of all latitudes, next to the poles, where charts meet, on the antimeridian; from
 * near, and from so high that normals are kept many times as steep as the ground is. */
static void planets_have_their_slopes_and_aspects(void **state)
{
    (void)state;
    static const struct {
        waves waves;
        double height, tolerance, flattening;
    } cases[] = {
        {{tan(42 * DEGREE), 60}, 500, 2, 0},
        {{tan(8 * DEGREE), 40}, 3000, 2, 0},
        {{0.02, 30}, 2000, 2, 0},
        {{tan(31 * DEGREE), 12}, 300e3, 2.5, 0},
        {{tan(4 * DEGREE), 8}, 1000e3, 2.5, 0},
        /* So flat that a degree of latitude is 1.7 times as long at the poles as at the equator. */
        {{tan(8 * DEGREE), 60}, 3000, 2, 0.15},
        {{tan(20 * DEGREE), 60}, 2000, 2, 0.15},
    };
    int wrong = 0;
    static const double places[][2] = {
        {0, 0},         {100, 10},     {-70, -33},  {179.9999, 40}, {-180, -57},   {20, 57.5},    {135, 58.5},
        {-45, -58},     {10, 75},      {-120, -88}, {30, 89.9},     {-150, 89.99}, {77, 89.9999}, {-5, -89.99999},
        {60, 89.99999}, {0.01, 56.01}, {-100, 64},  {45, -71},      {170, 3},      {-33, 84},
    };
    static const char *const names[] = {"slope", "aspect"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        waves w = cases[i].waves;
        tc_map *map = planet_flattened(planet_atlas(2048, earth, wave_height, &w), cases[i].flattening);
        for (int n = 0; n < 2; n++) {
            const tc_shade *shade = shade_of(names[n]);
            const tc_scene_options options = {.shade = shade, .background_set = true, .budget = -1};
            scene s = planet_scene(context, map, &(tc_rings_options){.n_phi = 512}, &options);
            for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
                tc_camera c = {.x = places[k][0] * DEGREE,
                               .y = places[k][1] * DEGREE,
                               .pitch = -M_PI / 2,
                               .fov = 10 * DEGREE,
                               .width = 65,
                               .height = 65};
                assert_int_equal(tc_map_height(map, c.x, c.y, &c.z), TC_OK);
                c.z += cases[i].height;
                scene_draw(&s, &c, true);
                uint8_t *rgb = scene_pixels(&s, &c), *middle = rgb + 3 * (32 * 65 + 32);
                double fall[2], expected[3];
                wave_fall(&w, &map->body, c.x, c.y, fall);
                expected_colour(shade, fall[0], fall[1], expected);
                bool off = difference(middle, expected) > cases[i].tolerance;
                wrong += off;
                if (off)
                    print_message("%s at %g, %g, case %d: %g degrees towards %g: %d %d %d instead of %.1f %.1f %.1f\n",
                                  names[n], places[k][0], places[k][1], (int)i, atan(hypot(fall[0], fall[1])) / DEGREE,
                                  atan2(fall[0], fall[1]) / DEGREE, middle[0], middle[1], middle[2], expected[0],
                                  expected[1], expected[2]);
                free(rgb);
            }
            scene_destroy(&s);
        }
        tc_map_destroy(map);
    }
    assert_int_equal(wrong, 0);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shades_have_names),         cmocka_unit_test(sides_have_their_slopes_and_aspects),
        cmocka_unit_test(a_cone_falls_from_its_top), cmocka_unit_test(hillshades_are_lit_from_the_north_west),
        cmocka_unit_test(shades_are_what_they_say),  cmocka_unit_test(planets_have_their_slopes_and_aspects),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
