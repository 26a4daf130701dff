/* find_place.h - places of a map by longitude and latitude, and by coordinates of its own system. */
#ifndef TC_FIND_PLACE_H
#define TC_FIND_PLACE_H

#include "common/map/map.h"

/* The place (body.h: x and y) at degrees east and north, of the globe that the map's own system is on. `name` is what
 * errors call the map; what is looked for, `what`, comes first in them. TC_ERR_USAGE for a flat map that does not say
 * where on a globe it lies, TC_ERR_IO for places that are not on the map. */
tc_status tc_find_place(const tc_map *map, const char *name, const char *what, double longitude, double latitude,
                        double place_ret[2], tc_error *error);

/* Likewise the place at coordinates of the georeference of a flat map that has one; false where it is not on the map.
 */
bool tc_find_georeferenced(const tc_map *map, double x, double y, double place_ret[2]);

#endif
