/* test_imagery_bounds.c - blocks of colours ask only pictures that may be there where they are, and are the same for
 * it: pictures anywhere on a plane and on a planet, across 180 degrees and over poles. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "common/imagery/imagery_internal.h"
#include "tests/support/draped.h"
#include "tests/support/planet_scene.h"
#include "tests/support/terrains.h"

#define DEGREE (M_PI / 180)
enum { MOST = 64, SIDE = 40 /* pixels of a picture */ };

/* ---- Pictures with a place ----------------------------------------------------------------------------------------
 */

/* A picture around (x, y) in the map's units, pixels so large; or, polar, around a pole, as it is seen from above. */
typedef struct placed {
    tc_image *image;
    double x, y, pixel;
    int pole; /* 1, -1; 0: none */
} placed;

static placed pictures[MOST];
static int64_t asked; /* for so many places where they are in a picture */

static const placed *about(const tc_image *image)
{
    for (int k = 0; k < MOST; k++)
        if (pictures[k].image == image)
            return &pictures[k];
    abort();
}

static void find(tc_image *image, int count, double *x, double *y)
{
    const placed *p = about(image);
    asked += count;
    for (int i = 0; i < count; i++) {
        double r = 90 - p->pole * y[i], angle = x[i] * DEGREE;
        double east = p->pole ? r * cos(angle) : x[i] - p->x, north = p->pole ? r * sin(angle) : y[i] - p->y;
        x[i] = SIDE / 2.0 + east / p->pixel, y[i] = SIDE / 2.0 - north / p->pixel;
    }
}

static void locate(tc_image *image, int count, double *x, double *y)
{
    const placed *p = about(image);
    for (int i = 0; i < count; i++) {
        double east = (x[i] - SIDE / 2.0) * p->pixel, north = (SIDE / 2.0 - y[i]) * p->pixel;
        x[i] = p->pole ? atan2(north, east) / DEGREE : p->x + east;
        y[i] = p->pole ? p->pole * (90 - hypot(east, north)) : p->y + north;
        if (image->period > 0)
            x[i] -= 360 * rint(x[i] / 360);
    }
}

/* Their own imagery, with bounds or asked everywhere. */
static tc_imagery *over(const tc_map *map, int count, bool globe, bool bounds)
{
    tc_image *images[MOST] = {NULL};
    tc_imagery *imagery = NULL;
    tc_error error = {0};
    for (int k = 0; k < count; k++) {
        images[k] = pictures[k].image = draped_image(draped_noise, SIDE, SIDE);
        images[k]->find = find, images[k]->locate = locate;
        images[k]->period = globe && !pictures[k].pole ? 360 / pictures[k].pixel : 0;
    }
    if (tc_imagery_create(map, images, count, 1, &imagery, &error) != TC_OK)
        fail_msg("%s", error.text);
    for (int k = 0; k < count && !bounds; k++)
        for (int chart = 0; chart < map->charts; chart++)
            imagery->layer[k].bounds[chart].everywhere = true;
    return imagery;
}

/* ---- The same colours ---------------------------------------------------------------------------------------------
 */

typedef struct seen {
    uint64_t sum;         /* of all colours, by place */
    int64_t there, asked; /* texels that are not transparent; places that were asked for */
} seen;

/* Adds colours of a level, at most MOST_SIDE a side around a place that depends on nothing but the level. */
static void add_level(const tc_field *field, int level, seen *s)
{
    enum { MOST_SIDE = 500 };
    const tc_level size = tc_field_level(field, level);
    const int64_t w = size.width < MOST_SIDE ? size.width : MOST_SIDE,
                  h = size.height < MOST_SIDE ? size.height : MOST_SIDE;
    const int64_t x = (size.width - w) / 2, y = (size.height - h) / 2;
    uint8_t(*rgba)[4] = malloc((size_t)(w * h) * 4);
    assert_int_equal(tc_field_read_samples(field, level, (tc_rect){x, y, x + w, y + h}, rgba, NULL, w), TC_OK);
    for (int64_t k = 0; k < w * h; k++) {
        uint32_t bits;
        memcpy(&bits, rgba[k], 4);
        s->sum = (s->sum ^ bits) * UINT64_C(0x100000001b3);
        s->there += rgba[k][3] > 0;
    }
    free(rgba);
}

static seen look(const tc_map *map, int count, bool globe, bool bounds)
{
    seen s = {.sum = UINT64_C(0xcbf29ce484222325)};
    tc_imagery *imagery = over(map, count, globe, bounds);
    asked = 0;
    for (int chart = 0; chart < map->charts; chart++) {
        const tc_field *field = tc_imagery_field(imagery, chart);
        for (int level = 1; level <= tc_field_info(field)->levels; level++)
            add_level(field, level, &s);
    }
    s.asked = asked;
    tc_imagery_destroy(imagery);
    return s;
}

/* Returns how many times fewer places were asked for than without bounds. */
static double compare(const char *name, const tc_map *map, int count, bool globe)
{
    const seen with = look(map, count, globe, true), without = look(map, count, globe, false);
    printf("%s: %lld places instead of %lld, for %lld texels\n", name, (long long)with.asked, (long long)without.asked,
           (long long)with.there);
    assert_true(with.sum == without.sum);
    assert_true(with.there > 0 && with.there == without.there);
    return (double)without.asked / (double)with.asked;
}

static void a_plane_asks_those_that_are_there(void **state)
{
    (void)state;
    enum { SAMPLES = 257 };
    tc_field *field = terrain_field(TERRAIN_SMOOTH, SAMPLES, SAMPLES, 30, 3);
    tc_map *map = tc_map_flat(field);
    test_random r = {5};
    map->georef.known = true;
    memcpy(map->georef.transform, (const double[6]){0, 30, 0, 30.0 * SAMPLES, 0, -30}, sizeof map->georef.transform);
    for (int k = 0; k < MOST; k++)
        pictures[k] = (placed){NULL, 30 * test_random_range(&r, 0, SAMPLES), 30 * test_random_range(&r, 0, SAMPLES),
                               test_random_range(&r, 8, 25), 0};
    assert_true(compare("64 pictures over a plane", map, MOST, false) > 10);
    assert_true(compare("one picture over a plane", map, 1, false) > 1);
    tc_map_destroy(map);
}

static void a_planet_asks_those_that_are_there(void **state)
{
    (void)state;
    tc_map *map = planet_made(PLANET_SMOOTH, 256, 6371e3, 1);
    static const placed edges[] = {{NULL, 180, 0, 0.5, 0},  {NULL, -179, 50, 0.3, 0}, {NULL, 178, -60, 0.25, 0},
                                   {NULL, 0, 0, 0.7, 1},    {NULL, 0, 0, 0.4, -1},    {NULL, 3, 80, 0.4, 0},
                                   {NULL, 170, 86, 0.2, 0}, {NULL, 0, 0, 9, 0},       {NULL, -90, 0, 4.4, 0}};
    enum { EDGES = sizeof edges / sizeof *edges, SOME = 16 };
    for (int k = 0; k < EDGES; k++) {
        char name[80];
        pictures[0] = edges[k];
        snprintf(name, sizeof name, "around %g, %g%s, %g degrees", edges[k].x, edges[k].y,
                 edges[k].pole ? ", a pole" : "", SIDE * edges[k].pixel);
        assert_true(compare(name, map, 1, true) >= 1);
    }
    test_random r = {6};
    for (int k = 0; k < SOME; k++)
        pictures[k] = k < EDGES - 2 ? edges[k]
                                    : (placed){NULL, test_random_range(&r, -180, 180), test_random_range(&r, -80, 80),
                                               test_random_range(&r, 0.2, 0.5), 0};
    assert_true(compare("16 pictures over a planet", map, SOME, true) > 3);
    tc_map_destroy(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_plane_asks_those_that_are_there),
                                       cmocka_unit_test(a_planet_asks_those_that_are_there)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
