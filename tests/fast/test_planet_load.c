/* test_planet_load.c - planets from files: where their samples lie, and what is refused. */
#include "tests/support/test.h"

#include "common/content/ground.h"
#include "common/app/load.h"
#include "common/app/planet_place.h"
#include "tests/support/loading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* A function on the sphere that has no symmetry. */
static double relief(double longitude, double latitude)
{
    double x = cos(latitude * degree) * cos(longitude * degree), y = cos(latitude * degree) * sin(longitude * degree);
    double z = sin(latitude * degree);
    return 2000 * x * y + 1500 * z + 1000 * x + 700 * y * z;
}

/* A map of it. The first sample, north-west, lies at (west, north). */
typedef struct map {
    int width, height;
    double west, north, step; /* degrees */
    bool point;
    int epsg;
    double hole;   /* degrees of longitude around which 30 degrees are void; 0 none */
    double step_y; /* degrees; 0: step */
} map;

static const char *make_map(const char *name, const map *m)
{
    float *z = malloc((size_t)(m->width * m->height) * sizeof *z);
    double step_y = m->step_y > 0 ? m->step_y : m->step;
    for (int row = 0; row < m->height; row++)
        for (int column = 0; column < m->width; column++) {
            double longitude = m->west + column * m->step, latitude = m->north - row * step_y;
            bool hole = m->hole != 0 && cos((longitude - m->hole) * degree) > cos(15 * degree) && fabs(latitude) < 20;
            z[row * m->width + column] = hole ? -9999 : (float)relief(longitude, latitude);
        }
    double corner = m->point ? 0 : 0.5; /* of point registration the file names the first sample */
    const double t[6] = {m->west - corner * m->step, m->step, 0, m->north + corner * step_y, 0, -step_y};
    made_tiff tiff = {.width = m->width,
                      .height = m->height,
                      .bits = 32,
                      .format = MADE_FLOAT,
                      .samples = z,
                      .transform = t,
                      .epsg = m->epsg,
                      .point = m->point,
                      .nodata = "-9999"};
    const char *path = made_path(name);
    make_tiff(path, &tiff);
    free(z);
    return path;
}

static void hear(void *context, bool warning, const char *line)
{
    sayings *s = context;
    *(warning ? &s->warnings : &s->notes) += 1;
    size_t used = strlen(s->text);
    snprintf(s->text + used, sizeof s->text - used, "%s\n", line);
}

static tc_map *planet_of(const char *path, double radius, bool whole, sayings *said)
{
    static sayings unheard;
    said = said ? said : &unheard;
    *said = (sayings){0};
    const tc_source_options options = {.say = hear, .say_context = said};
    tc_map *planet;
    const tc_load_options load = {.body = &tc_sphere_body, .globe.radius = radius, .whole = whole, .threads = 2};
    tc_error error = {0};
    if (tc_map_load(path, &options, &load, &planet, &error) != TC_OK)
        fail_msg("%s", error.text);
    return planet;
}

static void planet_refused(const char *path, double radius, bool whole, tc_status status, const char *word)
{
    tc_map *planet = NULL;
    const tc_load_options load = {.body = &tc_sphere_body, .globe.radius = radius, .whole = whole, .threads = 1};
    tc_error error = {0};
    tc_status found = tc_map_load(path, NULL, &load, &planet, &error);
    if (found != status || !strstr(error.text, word) || strchr(error.text, '\n'))
        fail_msg("expected status %d and \"%s\", found %d: %s", (int)status, word, (int)found, error.text);
    assert_null(planet);
}

/* Largest difference between a chart's finest level and the function. */
static double chart_error(const tc_chart *c)
{
    const int m = tc_field_info(c->field)->levels;
    tc_level level = tc_field_level(c->field, m);
    double largest = 0;
    for (int64_t j = 0; j < level.height; j++)
        for (int64_t i = 0; i < level.width; i++) {
            double x = c->x0 + (double)i * c->dx, y = c->y0 + (double)j * c->dy, longitude = x, latitude = y;
            if (c->class != &tc_chart_lonlat) {
                longitude = atan2(y, x);
                latitude = 90 * degree - 2 * atan(0.5 * hypot(x, y));
                latitude *= c->class == &tc_chart_south_cap ? -1 : 1;
            }
            float z;
            assert_int_equal(tc_field_read(c->field, m, (tc_rect){i, j, i + 1, j + 1}, &z, NULL, 1), TC_OK);
            largest = fmax(largest, fabs(z - relief(longitude / degree, latitude / degree)));
        }
    return largest;
}

static void globes_of_every_kind(void **state)
{
    (void)state;
    static const struct {
        map map;
        int64_t width, height;
    } kinds[] = {
        {{360, 180, -179.5, 89.5, 1, false, 4326, 0, 0}, 360, 180},
        {{360, 180, 0.5, 89.5, 1, false, 4326, 0, 0}, 360, 180},
        {{360, 180, 0, 89.5, 1, false, 4326, 0, 0}, 360, 180},
        {{360, 180, 100.25, 89.5, 1, true, 4326, 0, 0}, 360, 180},
        {{361, 181, -180, 90, 1, true, 4326, 0, 0}, 360, 181},
        {{361, 181, 0, 90, 1, false, 4326, 0, 0}, 360, 181},
        {{360, 182, -180, 90.5, 1, true, 4326, 0, 0}, 360, 180}, /* first and last row beyond the poles */
        {{362, 181, -180, 90, 1, true, 4326, 0, 0}, 360, 181},
        {{360, 179, -180, 89, 1, true, 4326, 0, 0}, 360, 179},
        {{720, 361, -180, 90, 0.5, true, 0, 0, 0}, 720, 361}, /* no coordinate system */
        {{301, 151, 0, 90, 1.2, true, 4326, 0, 0}, 300, 151},
        {{511, 256, -180, 90, 360. / 511, true, 4326, 0, 0}, 512, 256}, /* resampled */
        {{257, 129, -180, 90, 360. / 257, true, 4326, 0, 0}, 258, 129},
    };
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        tc_map *p = planet_of(make_map("globe.tif", &kinds[k].map), 0, true, NULL);
        if (p->width != kinds[k].width || p->height != kinds[k].height)
            fail_msg("kind %zu: found %d x %d", k, (int)p->width, (int)p->height);
        assert_int_equal(p->charts, 3);
        assert_true(p->chart[0].wraps && p->body.radius == (kinds[k].map.epsg ? 6378137 : 6371000));
        assert_true(fabs(p->georef.transform[1] * (double)p->width - 360) < 1e-9 && p->georef.known &&
                    p->georef.geographic);
        for (int c = 0; c < 3; c++) {
            double error = chart_error(&p->chart[c]);
            if (error > 0.05)
                fail_msg("kind %zu, chart %d: off by %g", k, c, error);
        }
        tc_map_destroy(p);
    }
}

/* Their columns must be halved as often as their rows, to fit a window. */
static void globes_higher_than_wide(void **state)
{
    (void)state;
    static const struct {
        int width, height;
        int64_t resampled;
    } kinds[] = {{100, 2000, 104}, {249, 300, 250}, {249, 250, 249}, {4, 4, 4}, {4, 1000, 4}, {96, 1500, 96}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        const int w = kinds[k].width, h = kinds[k].height;
        const map m = {w, h, -180 + 180. / w, 90 - 90. / h, 360. / w, false, 4326, 0, 180. / h};
        tc_map *p = planet_of(make_map("tall.tif", &m), 0, true, NULL);
        assert_true(p->width == kinds[k].resampled && p->height == h && p->charts == 3);
        const tc_ground_options options = {.n = 255, .wraps = true};
        tc_clipmap *clipmap;
        tc_error error;
        if (tc_ground_create(p->chart[0].field, &options, &clipmap, &error) != TC_OK)
            fail_msg("%d x %d: %s", w, h, error.text);
        tc_clipmap_destroy(clipmap);
        tc_map_destroy(p);
    }
}

/* Refused with their name, before anything is made of them. */
static void grids_of_a_few_samples(void **state)
{
    (void)state;
    static const struct {
        int width, height;
        const char *found;
    } kinds[] = {{1, 1, "found 1 x 1"}, {2, 1, "found 2 x 1"}, {3, 2, "found 3 x 2"}, {3, 5, "found 3 x 5"},
                 {4, 2, "found 4 x 2"}, {8, 3, "found 8 x 3"}, {4, 9000, "few.tif"}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        const int w = kinds[k].width, h = kinds[k].height;
        const map m = {w, h, -180 + 180. / w, 90 - 90. / h, 360. / w, false, 4326, 0, 180. / h};
        const char *path = make_map("few.tif", &m);
        planet_refused(path, 0, true, TC_ERR_FORMAT, kinds[k].found);
        planet_refused(path, 0, false, TC_ERR_FORMAT, "few.tif: expected");
    }
    const map strip = {40, 1, 10, 20, 0.1, true, 4326, 0, 0};
    planet_refused(make_map("strip.tif", &strip), 0, false, TC_ERR_FORMAT, "strip.tif: expected at least 2 x 2");
}

static void maps_without_caps(void **state)
{
    (void)state;
    const map belt = {360, 120, -180, 59.5, 1, true, 4326, 0, 0}, part = {200, 90, 170, 45, 0.1, true, 4326, 0, 0};
    tc_map *p = planet_of(make_map("belt.tif", &belt), 1e6, true, NULL);
    assert_true(p->charts == 1 && p->chart[0].wraps && p->body.radius == 1e6);
    assert_true(chart_error(&p->chart[0]) < 1e-3);
    tc_map_destroy(p);
    p = planet_of(make_map("part.tif", &part), 0, false, NULL);
    assert_true(p->charts == 1 && !p->chart[0].wraps && p->width == 200);
    assert_true(chart_error(&p->chart[0]) < 1e-3);
    tc_map_destroy(p);
    planet_refused(made_path("part.tif"), 0, true, TC_ERR_USAGE, "found 20");
}

static void pictures_of_a_globe(void **state)
{
    (void)state;
    uint16_t samples[32 * 16];
    for (int i = 0; i < 32 * 16; i++)
        samples[i] = (uint16_t)(100 + i);
    const char *path = made_path("picture.png");
    make_png(path, 32, 16, 16, 0, samples);
    sayings said;
    tc_map *p = planet_of(path, 1737400, true, &said);
    assert_true(said.warnings == 1 && strstr(said.text, "whole globe") && !strstr(said.text, "1 m apart"));
    assert_int_equal(p->charts, 3);
    assert_true(p->georef.transform[0] == -180 && p->georef.transform[3] == 90);
    assert_true(tc_field_info(p->chart[0].field)->other_body);
    assert_true(tc_field_info(p->chart[1].field)->other_body);
    tc_map_destroy(p);
    make_png(path, 16, 16, 16, 0, samples);
    planet_refused(path, 0, false, TC_ERR_UNSUPPORTED, "16 x 16");
}

/* A hole on the map's edge is filled as one inside. */
static void voids_across_the_seam(void **state)
{
    (void)state;
    const map inside = {360, 180, -179.5, 89.5, 1, false, 4326, 0.5, 0},
              edge = {360, 180, 0.5, 89.5, 1, false, 4326, 0.5, 0};
    tc_map *p[2] = {planet_of(make_map("inside.tif", &inside), 0, true, NULL),
                    planet_of(make_map("edge.tif", &edge), 0, true, NULL)};
    int m = tc_field_info(p[0]->chart[0].field)->levels;
    int64_t voids = 0;
    for (int64_t j = 0; j < 180; j++) {
        float a[360], b[360];
        uint8_t va[360], vb[360];
        assert_int_equal(tc_field_read(p[0]->chart[0].field, m, (tc_rect){180, j, 540, j + 1}, a, va, 360), 0);
        assert_int_equal(tc_field_read(p[1]->chart[0].field, m, (tc_rect){0, j, 360, j + 1}, b, vb, 360), 0);
        assert_memory_equal(va, vb, 360);
        for (int i = 0; i < 360; i++) {
            voids += va[i];
            assert_true(fabsf(a[i] - b[i]) < 0.5f);
        }
    }
    assert_true(voids > 1000 && voids == tc_field_info(p[1]->chart[0].field)->void_count);
    tc_map_destroy(p[0]), tc_map_destroy(p[1]);
}

static void what_is_no_planet_is_refused(void **state)
{
    (void)state;
    const map good = {36, 18, -175, 85, 10, false, 4326, 0, 0}, beyond = {360, 180, -179.5, 100, 1, false, 4326, 0, 0};
    const map projected = {36, 18, 500000, 5e6, 30, false, 32632, 0, 0};
    const map nothing = {36, 18, 500000, 5e6, 30, false, 0, 0, 0};
    const char *path = make_map("good.tif", &good);
    tc_map *p = planet_of(path, 0, true, NULL);
    tc_map_destroy(p);
    planet_refused(path, -1, false, TC_ERR_USAGE, "radius");
    planet_refused(path, NAN, false, TC_ERR_USAGE, "radius");
    planet_refused(path, INFINITY, false, TC_ERR_USAGE, "radius");
    planet_refused(path, 1000, false, TC_ERR_FORMAT, "radius of 1000 m");
    planet_refused(make_map("beyond.tif", &beyond), 0, false, TC_ERR_FORMAT, "found -79 to 100");
    p = planet_of(make_map("projected.tif", &projected), 0, false, NULL); /* warped */
    assert_true(fabs(p->georef.transform[0] - 9) < 0.01 && fabs(p->georef.transform[3] - 45.15) < 0.01);
    tc_map_destroy(p);
    planet_refused(make_map("projected.tif", &projected), 0, true, TC_ERR_USAGE, "all 360 degrees");
    planet_refused(make_map("nothing.tif", &nothing), 0, false, TC_ERR_UNSUPPORTED, "gdalwarp -t_srs");
    planet_refused(made_path("missing.tif"), 0, false, TC_ERR_IO, "missing.tif");
    const tc_source_options options = {.spacing = 30};
    assert_int_equal(tc_map_load(path, &options, &(tc_load_options){.body = &tc_sphere_body}, &p, NULL), TC_ERR_USAGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(globes_of_every_kind),         cmocka_unit_test(maps_without_caps),
        cmocka_unit_test(globes_higher_than_wide),      cmocka_unit_test(grids_of_a_few_samples),
        cmocka_unit_test(pictures_of_a_globe),          cmocka_unit_test(voids_across_the_seam),
        cmocka_unit_test(what_is_no_planet_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
