/* viewer_place.h - places that a viewer's window tells of: what is under a pixel, and what a place is called. */
#ifndef TC_VIEWER_PLACE_H
#define TC_VIEWER_PLACE_H

#include "display.h"
#include "viewer_internal.h"

/* The place of the ground that is seen at (x, y) of the frame, pixels from its top left corner, and how many metres it
 * is from the eye; false: none is. */
bool tc_viewer_point(const tc_viewer *viewer, double x, double y, double place_ret[3], double *distance_ret);

/* How a map's places are told: as longitude and latitude where it says where on a globe it lies, else as its own
 * coordinates. NULL, also where there is no memory: likewise, but for maps that are projected. */
typedef struct tc_places tc_places;
tc_places *tc_places_open(const tc_map *map);
void tc_places_close(tc_places *places);

/* Longitude and latitude of a place of a map, degrees; false: they are not known. places may be NULL. */
bool tc_places_degrees(const tc_places *places, const tc_map *map, double x, double y, double degrees_ret[2]);

/* The words for a place, in the map's units; degrees to so many digits. */
void tc_places_words(const tc_places *places, const tc_map *map, double x, double y, int digits, char text[TC_WORDS]);

#endif
