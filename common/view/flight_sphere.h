/* flight_sphere.h - curves through views on a globe. No GL. */
#ifndef TC_FLIGHT_SPHERE_H
#define TC_FLIGHT_SPHERE_H

#include "navigation.h"

/* The curve's value at t in 0 .. 1 between p1 and p2. */
double tc_catmull_rom(double p0, double p1, double p2, double p3, double t);

/* Longitude, latitude and heading between key[1] and key[2], at 0 < t < 1 of the way. begins: there is no key[0];
 * ends: no key[3]; they are not used then. The rest of *view stays. */
void tc_flight_on_sphere(const tc_pose key[4], bool begins, bool ends, double t, tc_pose *view);

#endif
