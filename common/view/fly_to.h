/* fly_to.h - from one view to another in one sweep, as a person would want it: out as far as the way is long, over, and
 * in again (van Wijk and Nuij, "Smooth and efficient zooming and panning", InfoVis 2003). No clock, no window. */
#ifndef TC_FLY_TO_H
#define TC_FLY_TO_H

#include "flight.h"

typedef struct tc_fly_to {
    const tc_navigation *navigation;
    tc_ground ground;
    tc_pose from, to;
    double seconds, at;     /* that it takes, and have passed */
    double apart;           /* metres along the ground */
    double low[2], high[2]; /* metres: the ground below both ends, and the eye above that */
    double s, r0, length;   /* the paper's r0, and S; s = 1 or -1 where both ends are above one place */
    bool straight;          /* they are */
} tc_fly_to;

/* Plans a flight. The ground's heights are asked for below both ends alone. */
tc_fly_to tc_fly_to_begin(const tc_navigation *navigation, const tc_ground *ground, const tc_pose *from,
                          const tc_pose *to);

/* dt seconds on: sets *view; at the end exactly to what was flown to. False where that is reached. */
bool tc_fly_to_step(tc_fly_to *flight, double dt, tc_pose *view);

#endif
