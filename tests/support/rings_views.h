/* rings_views.h - where the precision of the rings is looked at. */
#ifndef RINGS_VIEWS_H
#define RINGS_VIEWS_H

#include "common/map/map.h"
#include "terrains.h"

enum { RINGS_PLACES = 100, RINGS_ALTITUDES = 12 };

/* Longitude and latitude of place i: the poles and 1e-9 rad beside them, the antimeridian and longitude 0, where caps
 * take over, on samples of a grid of this width and next to them; then random ones. */
void rings_place_of(int i, int64_t width, double *longitude_ret, double *latitude_ret);

/* Altitude k above the ground: from 0.1 m (less for small radii) to 10 radii. */
double rings_altitude(int k, double radius);

/* A camera there, 1280 x 960, that looks at the planet somehow. */
tc_camera rings_view_at(const tc_map *atlas, double longitude, double latitude, double altitude, test_random *r);
tc_camera rings_view_of(const tc_map *atlas, int place, int64_t width, double altitude, test_random *r);

#endif
