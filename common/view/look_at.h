/* look_at.h - views of a place: the eye at a distance from it, towards it. No GL. */
#ifndef TC_LOOK_AT_H
#define TC_LOOK_AT_H

#include "navigation.h"

/* The view of a place of a body (body.h) from `distance` metres, above 0. heading and pitch, radians: of the way from
 * the eye to the place, at the place's own horizon. Far away on a globe the eye's is another one. */
tc_pose tc_look_at(const tc_body *body, const double place[3], double heading, double pitch, double distance);

/* Turns the view to the place, where that is in any direction from it. */
void tc_look_towards(const tc_body *body, const double place[3], tc_pose *view);

#endif
