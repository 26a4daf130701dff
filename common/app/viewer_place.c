/* viewer_place.c - see viewer_place.h. */
#include "viewer_place.h"
#include "common/input/plugin.h"
#include "common/input/plugin_tables.h"

#include <math.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180)

/* ---- What is seen ------------------------------------------------------------------------------------------------ */

tc_scenery tc_viewer_scenery(const tc_viewer *v)
{
    const tc_flight_box box = tc_viewer_box(v);
    double far = box.radius > 0 ? 15 * box.radius : 20 * hypot(box.east - box.west, box.north - box.south);
    return (tc_scenery){.navigation = v->program->navigation,
                        .ground = &v->ground,
                        .highest = box.z_max,
                        .far = far,
                        .fov = v->camera.fov,
                        .width = v->camera.width,
                        .height = v->camera.height};
}

bool tc_viewer_point(const tc_viewer *v, double x, double y, double place_ret[3], double *distance_ret)
{
    const tc_scenery scenery = tc_viewer_scenery(v);
    const tc_camera *c = &v->camera;
    const tc_body *body = &v->map->body;
    const tc_pose view = {c->x, c->y, c->z, c->heading, c->pitch};
    const double eye[3] = {c->x, c->y, c->z};
    double p[3], q[3];
    if (!tc_pick(&scenery, &view, x, y, p) || !body->class->place(body, p, place_ret) ||
        (!body->class->solid && !tc_map_has_ground(v->map, place_ret[0], place_ret[1])))
        return false;
    body->class->position(body, eye, q);
    *distance_ret = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
    return true;
}

/* ---- What a place is called -------------------------------------------------------------------------------------- */

struct tc_places {
    const struct tc_gdal_plugin *gdal;
    void *projected; /* its places; NULL: none */
};

tc_places *tc_places_open(const tc_map *map)
{
    const tc_georef *georef = tc_field_georef(map->chart[0].field);
    const void *table;
    tc_error unused;
    if (map->body.radius > 0 || !map->georef.known || map->georef.geographic || !georef->crs_wkt)
        return NULL;
    if (tc_plugin_load("gdal", &table, &unused) != TC_OK)
        return NULL;
    tc_places *places = calloc(1, sizeof *places);
    if (places) {
        places->gdal = table;
        places->projected = places->gdal->places_open(georef->crs_wkt, map->georef.transform);
    }
    return places;
}

void tc_places_close(tc_places *places)
{
    if (places && places->projected)
        places->gdal->places_close(places->projected);
    free(places);
}

/* As above, or in the map's own coordinates, which are known. */
static bool find_degrees(const tc_places *places, const tc_map *map, double x, double y, double degrees[2])
{
    const tc_georef *georef = &map->georef;
    const tc_chart *grid = &map->grid;
    const double *t = georef->transform;
    if (map->body.radius > 0) {
        degrees[0] = x / DEGREE, degrees[1] = y / DEGREE;
        return true;
    }
    /* Columns and rows from the north-west corner. */
    const double column = (x - grid->x0) / grid->dx + 0.5, row = (double)map->height - 0.5 - (y - grid->y0) / grid->dy;
    degrees[0] = t[0] + column * t[1] + row * t[2], degrees[1] = t[3] + column * t[4] + row * t[5];
    const bool projected =
        places && places->projected && places->gdal->place_of(places->projected, column, row, degrees);
    return georef->geographic || projected;
}

bool tc_places_degrees(const tc_places *places, const tc_map *map, double x, double y, double degrees[2])
{
    return (map->body.radius > 0 || map->georef.known) && find_degrees(places, map, x, y, degrees);
}

void tc_places_words(const tc_places *places, const tc_map *map, double x, double y, int digits, char text[TC_WORDS])
{
    double degrees[2];
    if (!(map->body.radius > 0) && !map->georef.known)
        snprintf(text, TC_WORDS, "%.1f, %.1f m", x, y);
    else if (find_degrees(places, map, x, y, degrees) && fabs(degrees[1]) > 90)
        snprintf(text, TC_WORDS, "beyond the poles");
    else if (find_degrees(places, map, x, y, degrees))
        tc_words_degrees(degrees[0], degrees[1], digits, text);
    else
        snprintf(text, TC_WORDS, "%.1f E, %.1f N", degrees[0], degrees[1]);
}
