/* hold.h - a point of the ground is held at a pixel: by the eye's place, or by where it looks. */
#ifndef TC_HOLD_H
#define TC_HOLD_H

#include "pick.h"

/* Metres along the ground and up there, from a point of space to the eye: how far, and the sine of the angle at which
 * the eye stands above its horizon. */
double tc_hold_distance(const tc_scenery *scenery, const tc_pose *view, const double p[3], double *sine_ret);

/* Moves the eye at its height so that a pixel shows p; the view does not turn but with the meridians close to a pole.
 * Keeps so many metres above ground. Where p would be seen more grazing than by this sine, or not at all, goes as far
 * as it can. Whether it is there, to
 * a tenth of a pixel. */
bool tc_hold_by_moving(const tc_scenery *scenery, const double p[3], double x, double y, double sine, double keeps,
                       tc_pose *view);

/* Turns the view so that a pixel shows p. */
bool tc_hold_by_turning(const tc_scenery *scenery, const double p[3], double x, double y, tc_pose *view);

/* Lifts the eye to so many metres above ground (tc_flight_keeps). Whether it had to be. */
bool tc_keep_above(const tc_scenery *scenery, double keeps, tc_pose *view);

#endif
