/* test_contours.c - lines of equal height: where they must be, within a pixel, as wide near as far; none on flat
 * ground, none where they would run into each other. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/measure/view_error.h"
#include "tests/support/planet_scene.h"
#include "tests/support/ray_cast.h"
#include "tests/support/scene.h"

#define DEGREE (M_PI / 180)
enum { SIDE = 513, WIDTH = 240, HEIGHT = 180, PIXELS = WIDTH * HEIGHT };
static const double spacing = 30;
static tc_context *context;

/* ---- Ground ------------------------------------------------------------------------------------------------------ */

typedef double (*ground_function)(const void *about, double x, double y);

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

static const double middle = 0.5 * (SIDE - 1) * 30;

/* Metres a metre to the east and to the north, from 1000.3 m in the middle. */
static double plane(const void *rise, double x, double y)
{
    const double *r = rise;
    return 1000.3 + r[0] * (x - middle) + r[1] * (y - middle);
}

/* ---- Ink --------------------------------------------------------------------------------------------------------- */

/* Of white ground: how much darker each pixel is, 0 .. 1 of the darkest line. */
static double *ink(scene *s, const tc_camera *c)
{
    double *dark = malloc(PIXELS * sizeof *dark);
    assert_non_null(dark);
    scene_draw(s, c, true);
    uint8_t *rgb = scene_pixels(s, c);
    for (int i = 0; i < PIXELS; i++) {
        double g = rgb[3 * i + 1] / 255.0;
        dark[i] = (1 - g * g) / (1 - 0.13); /* squares of what is shown are mixed */
    }
    free(rgb);
    return dark;
}

static const tc_colour_ramp *white(void)
{
    static tc_colour_stop stop[] = {{0, false, {255, 255, 255, 255}}};
    static const tc_colour_ramp ramp = {1, stop};
    return &ramp;
}

static tc_scene_options lines_every(double metres)
{
    return (tc_scene_options){.unlit = true,
                              .background_set = true,
                              .background = {255, 255, 255},
                              .colours = white(),
                              .contours = metres,
                              .budget = -1};
}

/* The number of lines up to the height that each pixel's middle shows; NAN: no ground. */
static double number[PIXELS];
static void number_plane(const double rise[2], const tc_camera *c, double metres)
{
    const double here = plane(rise, c->x, c->y);
    for (int i = 0; i < PIXELS; i++) {
        double ray[3];
        tc_view_ray(c, i % WIDTH + 0.5, i / WIDTH + 0.5, ray);
        double t = (here - c->z) / (ray[2] - rise[0] * ray[0] - rise[1] * ray[1]);
        double x = c->x + t * ray[0], y = c->y + t * ray[1];
        bool on = t > 0 && fmin(x, y) > 0 && fmax(x, y) < 2 * middle;
        number[i] = on ? plane(rise, x, y) / metres : NAN;
    }
}

typedef struct found {
    int on, off, crowded;     /* pixels on a line, far from any, where even heavy lines would run into each other */
    int missing, stray, grey; /* of the first without ink, of the others with it */
    double ink[2], length[2]; /* of thin and heavy lines, pixels */
} found;

/* Looks at all pixels around which numbers go up evenly and lines are apart. */
static found look(const double *dark)
{
    found f = {0};
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            const double *n = number + y * WIDTH + x;
            double dx = 0.5 * (n[1] - n[-1]), dy = 0.5 * (n[WIDTH] - n[-WIDTH]), a_pixel = hypot(dx, dy);
            if (fabs(n[1] + n[-1] - 2 * *n) + fabs(n[WIDTH] + n[-WIDTH] - 2 * *n) > 0.1 * a_pixel)
                continue; /* a crest, where there is no width */
            if (a_pixel > 5 / 2.)
                f.crowded++, f.grey += dark[y * WIDTH + x] > 0.02;
            if (!(a_pixel * 8 < 1)) /* too near, or no ground */
                continue;
            double nearest = rint(*n), away = fabs(*n - nearest) / a_pixel, here = dark[y * WIDTH + x];
            bool heavy = fmod(fabs(nearest), 5) == 0;
            if (away < 0.15) {
                f.on++, f.missing += here < 0.5;
            } else if (away > (heavy ? 1.0 : 0.6) + 1) {
                f.off++, f.stray += here > 0.02;
            }
            if (away < 4) { /* ink on the way across a line, by how much of the way each pixel is */
                f.ink[heavy] += here;
                f.length[heavy] += 1 / 8.0;
            }
        }
    return f;
}

/* Ink of a line a pixel long, thin and heavy; and how far a width may be off. */
static const double INK[2] = {0.8 * 1.2, 2}, OFF[2] = {0.15, 0.25};

static void expect_lines(const char *of, int k, const found *f)
{
    bool wide = false;
    for (int heavy = 0; heavy < 2; heavy++)
        wide |= f->length[heavy] > 50 && fabs(f->ink[heavy] / f->length[heavy] - INK[heavy]) > OFF[heavy];
    if (f->on < 100 || f->off < 2000 || f->missing || f->stray || f->grey || wide || f->length[0] < 50)
        fail_msg(
            "%s, case %d: of %d pixels on lines %d have no ink, of %d off them %d have some, of %d crowded ones %d; "
            "%.0f of thin ink on %.0f pixels, %.0f of heavy on %.0f",
            of, k, f->on, f->missing, f->off, f->stray, f->crowded, f->grey, f->ink[0], f->length[0], f->ink[1],
            f->length[1]);
}

/* ---- Flat maps --------------------------------------------------------------------------------------------------- */

/* Planes of several slopes, from above and along them, from far and from eye height, lines of 1 m to 100 m, with one
 * and four samples a pixel. Windows are small, so that level boundaries go through all pictures: none breaks a line. */
static void lines_are_where_they_must_be(void **state)
{
    (void)state;
    static const struct {
        double rise[2], metres, above, pitch, heading;
        int samples;
    } cases[] = {
        {{0.1, 0}, 10, 1500, -90, 0, 1},      {{0.03, 0.02}, 5, 900, -60, 30, 1}, {{0.5, -0.3}, 100, 3000, -70, 200, 1},
        {{0.02, 0.05}, 1, 150, -40, 70, 4},   {{0.1, 0.1}, 1, 30, -35, 140, 1},   {{-0.2, 0.1}, 1, 2, -30, 40, 1},
        {{-0.05, 0.3}, 0.1, 2, -50, 290, 4},  {{1.5, 0.4}, 50, 2500, -80, 0, 1},  {{0.01, 0}, 2, 3000, -90, 45, 1},
        {{0.004, 0.003}, 1, 400, -25, 10, 1},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        tc_field *field = ground_of(plane, cases[k].rise);
        tc_scene_options options = lines_every(cases[k].metres);
        options.samples = cases[k].samples;
        const tc_camera c = {.x = middle + 11.3,
                             .y = middle - 47.1,
                             .z = plane(cases[k].rise, middle + 11.3, middle - 47.1) + cases[k].above,
                             .heading = cases[k].heading * DEGREE,
                             .pitch = cases[k].pitch * DEGREE,
                             .fov = 60 * DEGREE,
                             .width = WIDTH,
                             .height = HEIGHT};
        scene s = scene_create(context, field, 31, &options);
        double *dark = ink(&s, &c);
        number_plane(cases[k].rise, &c, cases[k].metres);
        const found f = look(dark);
        expect_lines("plane", (int)k, &f);
        scene_destroy(&s);
        free(dark);
        tc_field_destroy(field);
    }
}

/* Two lakes and a sea exactly as high as lines are, a plateau, and slopes between. */
static double lakes(const void *unused, double x, double y)
{
    (void)unused;
    double first = hypot(x - middle, y - middle), second = hypot(x - 0.6 * middle, y - 1.3 * middle);
    double z = 800 + 250 * sin(x / 1100) * cos(y / 900) + 0.08 * (x - middle);
    z = 500 + (z - 500) * fmin(1, fmax(0, (first - 2400) / 1500));
    z = 700 + (z - 700) * fmin(1, fmax(0, (second - 1500) / 900));
    return x > 1.3 * middle ? z * fmin(1, fmax(0, (1.5 * middle - x) / 900)) : z;
}

/* Whether all samples around a place are as high. */
static bool flat_around(const tc_field *field, double x, double y)
{
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    int64_t i = (int64_t)floor(x / spacing), j = (int64_t)floor(y / spacing);
    enum { AROUND = 32 }; /* what coarser levels make of a shore */
    float z[(2 * AROUND + 2) * (2 * AROUND + 2)];
    tc_rect r = {i - AROUND, j - AROUND, i + AROUND + 2, j + AROUND + 2};
    r.x0 = r.x0 < 0 ? 0 : r.x0, r.y0 = r.y0 < 0 ? 0 : r.y0;
    r.x1 = r.x1 > finest.width ? finest.width : r.x1, r.y1 = r.y1 > finest.height ? finest.height : r.y1;
    tc_field_read(field, tc_field_info(field)->levels, r, z, NULL, 2 * AROUND + 2);
    for (int64_t v = 0; v < r.y1 - r.y0; v++)
        for (int64_t u = 0; u < r.x1 - r.x0; u++)
            if (z[v * (2 * AROUND + 2) + u] != z[0])
                return false;
    return true;
}

static void flats_have_no_lines(void **state)
{
    (void)state;
    tc_field *field = ground_of(lakes, NULL);
    ray_flat *rays = ray_flat_create(field);
    test_random r = {7};
    int flats = 0, inked = 0, slopes = 0;
    for (int k = 0; k < 24; k++) {
        static const double metres[] = {100, 10, 1, 0.5};
        tc_scene_options options = lines_every(metres[k % 4]);
        options.samples = k % 3 == 0 ? 4 : 1;
        scene s = scene_create(context, field, 127, &options);
        tc_camera c = {.x = test_random_range(&r, 0.2, 1.9) * middle,
                       .y = test_random_range(&r, 0.2, 1.9) * middle,
                       .heading = test_random_range(&r, 0, 2 * M_PI),
                       .pitch = -test_random_range(&r, 5, 90) * DEGREE,
                       .fov = 70 * DEGREE,
                       .width = WIDTH,
                       .height = HEIGHT};
        c.z = lakes(NULL, c.x, c.y) + pow(10, test_random_range(&r, 0.3, 3.7));
        double *dark = ink(&s, &c);
        for (int i = 0; i < PIXELS; i += 7) {
            double ray[3], t;
            tc_view_ray(&c, i % WIDTH + 0.5, i / WIDTH + 0.5, ray);
            if (!ray_flat_hit(rays, &c, ray, &t))
                continue;
            bool flat = flat_around(field, c.x + t * ray[0], c.y + t * ray[1]);
            flats += flat;
            inked += flat && dark[i] > 0.02;
            slopes += !flat && dark[i] > 0.5;
        }
        free(dark);
        scene_destroy(&s);
    }
    assert_true(flats > 10000 && slopes > 1000);
    assert_int_equal(inked, 0);
    ray_flat_destroy(rays);
    tc_field_destroy(field);
}

/* ---- Planets ----------------------------------------------------------------------------------------------------- */

static const double earth = 6371000;

/* Waves along an axis that is none of the charts'. */
typedef struct waves {
    double steepest; /* metres a metre */
    double number;   /* of waves around */
} waves;

static double wave_height(void *about, const double p[3])
{
    const waves *w = about;
    return earth * w->steepest / w->number * sin(w->number * (0.48 * p[0] - 0.6 * p[1] + 0.64 * p[2]));
}

static int number_globe(const tc_map *map, const ray_globe *rays, const tc_camera *c, double metres)
{
    const tc_lens lens = tc_view_lens(c);
    int ground = 0;
    for (int i = 0; i < PIXELS; i++) {
        double ray[3], t, place[3];
        tc_lens_ray(&lens, i % WIDTH + 0.5, i / WIDTH + 0.5, ray);
        number[i] = NAN;
        if (!ray_globe_hit(rays, c, ray, &t))
            continue;
        for (int k = 0; k < 3; k++)
            ray[k] *= t;
        tc_view_place(c, &map->body, ray, place);
        number[i] = place[2] / metres;
        ground++;
    }
    return ground;
}

/* From space to eye height, at the equator, where charts meet, and next to a pole. */
static void lines_of_planets_are_where_they_must_be(void **state)
{
    (void)state;
    enum { MAPS = 3 };
    static const waves kinds[MAPS] = {{0.003, 6}, {0.02, 25}, {0.1, 40}};
    static const struct {
        int waves;
        double metres, x, y, above, pitch, heading;
        int samples;
    } cases[] = {
        {0, 500, -75, 25, 1.2e7, -90, 0, 1},  {1, 500, 40, 57, 1e6, -90, 10, 4},
        {1, 500, 150, -84, 3e5, -70, 200, 1}, {2, 10, 30, 10, 800, -60, 30, 1},
        {2, 0.1, -96, 45.5, 2, -35, 80, 1},   {2, 0.1, 60, 89.9999, 2, -40, 250, 1},
        {2, 1, 12, 58.3, 30, -45, 120, 4},    {2, 20, 179.99, -6, 3e3, -50, 300, 1},
    };
    tc_map *map[MAPS];
    ray_globe *rays[MAPS];
    for (int k = 0; k < MAPS; k++) {
        map[k] = planet_atlas(2048, earth, wave_height, &(waves){kinds[k].steepest, kinds[k].number});
        rays[k] = ray_globe_create(map[k]);
    }
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const int w = cases[k].waves;
        tc_scene_options options = lines_every(cases[k].metres);
        options.samples = cases[k].samples;
        scene s = planet_scene(context, map[w], &(tc_rings_options){.n_phi = 512}, &options);
        tc_camera c = {.x = cases[k].x * DEGREE,
                       .y = cases[k].y * DEGREE,
                       .heading = cases[k].heading * DEGREE,
                       .pitch = cases[k].pitch * DEGREE,
                       .fov = 60 * DEGREE,
                       .width = WIDTH,
                       .height = HEIGHT};
        assert_int_equal(tc_map_height(map[w], c.x, c.y, &c.z), TC_OK);
        c.z += cases[k].above;
        double *dark = ink(&s, &c);
        assert_true(number_globe(map[w], rays[w], &c, cases[k].metres) > PIXELS / 3);
        const found f = look(dark);
        expect_lines("planet", (int)k, &f);
        free(dark);
        scene_destroy(&s);
    }
    for (int k = 0; k < MAPS; k++) {
        ray_globe_destroy(rays[k]);
        tc_map_destroy(map[k]);
    }
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_where_they_must_be),
        cmocka_unit_test(flats_have_no_lines),
        cmocka_unit_test(lines_of_planets_are_where_they_must_be),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
