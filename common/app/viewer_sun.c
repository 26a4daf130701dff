/* viewer_sun.c - where the sun of --date stands over what is shown. */
#include "viewer_internal.h"
#include "viewer_place.h"
#include "common/base/status.h"
#include "common/render/palette.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180)

/* Longitude and latitude of a flat map's middle, radians, and the direction of its columns there, clockwise from north:
 * maps that are projected do not have north upwards. */
static bool find_middle(const tc_places *places, const tc_map *map, double middle_ret[2], double *upwards_ret)
{
    double lo[2], hi[2], a[2], b[2];
    tc_map_extent(map, lo, hi);
    const double x = 0.5 * (lo[0] + hi[0]), y = 0.5 * (lo[1] + hi[1]), step = 0.5 * map->spacing_y;
    if (!tc_places_degrees(places, map, x, y - step, a) || !tc_places_degrees(places, map, x, y + step, b) ||
        !(fabs(a[0]) <= 720 && fabs(a[1]) <= 90.01 && fabs(b[0]) <= 720 && fabs(b[1]) <= 90.01))
        return false;
    const double east = remainder(b[0] - a[0], 360);
    middle_ret[0] = (a[0] + 0.5 * east) * DEGREE, middle_ret[1] = 0.5 * (a[1] + b[1]) * DEGREE;
    *upwards_ret = atan2(east * cos(middle_ret[1]), b[1] - a[1]);
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
