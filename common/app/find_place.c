/* find_place.c - places of a map by longitude and latitude. */
#include "find_place.h"

#include <inttypes.h>
#include <math.h>

#include "common/base/status.h"
#include "common/input/plugin.h"
#include "common/input/plugin_tables.h"

static const double DEGREE = M_PI / 180;

/* Of a sample, by which a place may be off the border: its decimals were rounded. */
static const double NEAR = 1e-6;

bool tc_find_georeferenced(const tc_map *map, double x, double y, double place[2])
{
    double u, v;
    const double edge = NEAR + (map->area_registered ? 0.5 : 0), w = (double)(map->width - 1),
                 h = (double)(map->height - 1);
    if (!map->georef.known)
        return false;
    tc_map_georef_samples(map, x, y, &u, &v);
    if (!(u >= -edge && u <= w + edge && v >= -edge && v <= h + edge))
        return false;
    place[0] = fmin(fmax(u, 0), w) * map->spacing_x;
    place[1] = fmin(fmax(v, 0), h) * map->spacing_y;
    return true;
}

/* In the map's own system; false where it has no such place. */
static bool project(const char *wkt, const double degrees[2], double xy_ret[2], tc_error *error, tc_status *status_ret)
{
    const void *gdal;
    *status_ret = tc_plugin_load("gdal", &gdal, error);
    return *status_ret == TC_OK && ((const struct tc_gdal_plugin *)gdal)->from_lonlat(wkt, degrees, xy_ret);
}

static tc_status find_flat(const tc_map *map, const char *name, const char *what, const double degrees[2],
                           bool *found_ret, double place[2], tc_error *error)
{
    const char *wkt = tc_field_georef(map->chart[0].field)->crs_wkt;
    const bool geographic = map->georef.geographic;
    *found_ret = false;
    if (!map->georef.known || (!geographic && !wkt))
        return tc_fail(
            error, TC_ERR_USAGE,
            "%s: expected a map that says where on a globe it lies, found %s without %s; --view takes metres", what,
            name, map->georef.known ? "a coordinate system" : "a georeference");
    double xy[2];
    tc_status status = TC_OK;
    for (int turn = -2; turn <= 2 && geographic && !*found_ret; turn++) /* longitudes come round again */
        *found_ret = tc_find_georeferenced(map, degrees[0] + 360 * turn, degrees[1], place);
    if (!geographic && project(wkt, degrees, xy, error, &status))
        *found_ret = tc_find_georeferenced(map, xy[0], xy[1], place);
    return status;
}

/* All of a planet is there where it has caps, or faces; else what its grid covers. */
static bool find_on_globe(const tc_map *map, const double degrees[2], double place[2])
{
    const tc_chart *c = &map->chart[0];
    const double edge_x = (NEAR + (map->area_registered ? 0.5 : 0)) * map->grid.dx,
                 edge_y = (NEAR + (map->area_registered ? 0.5 : 0)) * map->grid.dy;
    double lo[2], hi[2];
    place[0] = degrees[0] * DEGREE, place[1] = degrees[1] * DEGREE;
    if (map->charts > 1)
        return true;
    tc_map_extent(map, lo, hi);
    if (!(place[1] >= lo[1] - edge_y && place[1] <= hi[1] + edge_y))
        return false;
    place[1] = fmin(fmax(place[1], lo[1]), hi[1]);
    if (c->wraps)
        return true;
    const double from_west = place[0] - (lo[0] - edge_x), turn = 2 * M_PI;
    const double x = lo[0] - edge_x + from_west - turn * floor(from_west / turn);
    place[0] = fmin(fmax(x, lo[0]), hi[0]);
    return x <= hi[0] + edge_x;
}

tc_status tc_find_place(const tc_map *map, const char *name, const char *what, double longitude, double latitude,
                        double place[2], tc_error *error)
{
    const double degrees[2] = {longitude, latitude};
    bool found = false;
    tc_status status = TC_OK;
    if (map->body.radius > 0)
        found = find_on_globe(map, degrees, place);
    else
        status = find_flat(map, name, what, degrees, &found, place, error);
    if (status == TC_OK && !found)
        status = tc_fail(error, TC_ERR_IO, "%s: expected a place on %s, found one beside it, at %.9g,%.9g", what, name,
                         longitude, latitude);
    return status;
}
