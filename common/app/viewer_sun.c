/* viewer_sun.c - where the sun of --date stands over what is shown. */
#include "viewer_internal.h"
#include "viewer_place.h"
#include "common/base/status.h"
#include "common/render/palette.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180)

/* Longitude and latitude, radians, of a place of a flat map. */
static bool find_place(const tc_places *places, const tc_map *map, double x, double y, double place_ret[2])
{
    double degrees[2];
    if (!tc_places_degrees(places, map, x, y, degrees) || !(fabs(degrees[0]) <= 720 && fabs(degrees[1]) <= 90.01))
        return false;
    place_ret[0] = degrees[0] * DEGREE, place_ret[1] = degrees[1] * DEGREE;
    return true;
}

/* Longitude and latitude of a flat map's middle, radians, and the direction of its columns there, clockwise from north:
 * maps that are projected do not have north upwards. */
static bool find_middle(const tc_places *places, const tc_map *map, double middle_ret[2], double *upwards_ret)
{
    double lo[2], hi[2], a[2], b[2], from[3], to[3], axes[3][3], east = 0, north = 0;
    tc_map_extent(map, lo, hi);
    const double x = 0.5 * (lo[0] + hi[0]), y = 0.5 * (lo[1] + hi[1]), step = 0.5 * map->spacing_y;
    if (!find_place(places, map, x, y, middle_ret) || !find_place(places, map, x, y - step, a) ||
        !find_place(places, map, x, y + step, b))
        return false;
    /* Through space: the pole may lie between. */
    const tc_body globe = tc_body_of(1);
    globe.class->position(&globe, (const double[3]){a[0], a[1], 0}, from);
    globe.class->position(&globe, (const double[3]){b[0], b[1], 0}, to);
    globe.class->axes(&globe, (const double[3]){middle_ret[0], middle_ret[1], 0}, axes);
    for (int i = 0; i < 3; i++)
        east += (to[i] - from[i]) * axes[0][i], north += (to[i] - from[i]) * axes[1][i];
    *upwards_ret = atan2(east, north);
    return true;
}

tc_status tc_viewer_settle_sun(tc_viewer *v, tc_error *error)
{
    const tc_map *map = v->map;
    double middle[2], upwards;
    tc_terrain_info info = *tc_field_info(tc_map_field(map, 0));
    if (!v->options.date)
        return TC_OK;
    if (map->body.class->solid)
        info.semi_major = map->body.radius; /* whatever the file says */
    if (!tc_palette_make(&info).natural)
        return tc_fail(error, TC_ERR_USAGE,
                       "--date: expected a map of the Earth, whose days are known, found %s of another body; --sun has "
                       "a light for it",
                       v->options.terrain);
    v->scene.sun = tc_sun_over_earth(v->options.julian);
    if (map->body.class->solid)
        return TC_OK;
    tc_places *places = tc_places_open(map);
    const bool found = find_middle(places, map, middle, &upwards);
    tc_places_close(places);
    if (!found)
        return tc_fail(error, TC_ERR_USAGE,
                       "--date: expected a map that says where on a globe it lies, found %s without %s; --sun has a "
                       "light for it",
                       v->options.terrain, map->georef.known ? "a coordinate system" : "a georeference");
    const tc_body globe = tc_body_of(1);
    v->scene.sun = tc_sun_from(&v->scene.sun, &globe, (const double[3]){middle[0], middle[1], 0});
    v->scene.sun.azimuth = fmod(v->scene.sun.azimuth - upwards + 4 * M_PI, 2 * M_PI);
    return TC_OK;
}

tc_sun tc_viewer_sun(const tc_viewer *v)
{
    const double place[3] = {v->camera.x, v->camera.y, v->camera.z};
    return tc_sun_from(&v->scene.sun, &v->map->body, place);
}
