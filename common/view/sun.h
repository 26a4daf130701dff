/* sun.h - where light comes from, and where the sun stands at a time. No GL.
 *
 * The sun's place is that of J. Meeus, Astronomical Algorithms (2nd edition, 1998): chapter 25, lower accuracy (0.01
 * degrees), and sidereal time by (12.4); as NOAA's solar calculator has it. */
#ifndef TC_SUN_H
#define TC_SUN_H

#include "common/chart/body.h"

#include <stdbool.h>

typedef enum tc_sun_kind {
    TC_SUN_USUAL, /* the cartographer's light, from the north-west of whoever looks */
    TC_SUN_LOCAL, /* in a direction from the ground below the eye, which it follows */
    TC_SUN_OVER   /* upright over a place of a globe, wherever the eye is */
} tc_sun_kind;

/* Zero is the usual light. */
typedef struct tc_sun {
    tc_sun_kind kind;
    double azimuth, elevation;  /* of TC_SUN_LOCAL: radians, clockwise from north, above the horizon */
    double longitude, latitude; /* of TC_SUN_OVER: radians */
} tc_sun;

/* Of the usual light, radians. */
#define TC_SUN_AZIMUTH (310 * M_PI / 180)
#define TC_SUN_ELEVATION (38 * M_PI / 180)

/* The direction to it from a place of a body, of length 1: east, north, up. */
void tc_sun_direction(const tc_sun *sun, const tc_body *body, const double place[3], double direction_ret[3]);

/* The same as a sun that follows the eye. */
tc_sun tc_sun_from(const tc_sun *sun, const tc_body *body, const double place[3]);

/* Share of daylight where the sun stands at such a height, the sine of its elevation: 1 by day, 0 at night, between
 * while it sets. As in shaders/ground.glsl. */
double tc_sun_day(double height);

/* The Julian date of "YYYY-MM-DDTHH:MMZ", a minute of UTC of the years 1901 to 2099; false: it is none. */
bool tc_sun_read_date(const char *text, double *julian_ret);

/* The sun's apparent right ascension and declination at a Julian date, radians. */
void tc_sun_apparent(double julian, double *ascension_ret, double *declination_ret);

/* The sun over the Earth then. */
tc_sun tc_sun_over_earth(double julian);

#endif
