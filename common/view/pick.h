/* pick.h - between the pixels of a frame and places on the ground. No GL: the ground is a function of places. */
#ifndef TC_PICK_H
#define TC_PICK_H

#include "flight.h"

/* What is looked at, and through which lens. */
typedef struct tc_scenery {
    const tc_navigation *navigation;
    const tc_ground *ground;
    double highest;    /* metres absolute: no ground is higher */
    double far;        /* metres: as far as one goes away from the ground */
    double fov;        /* horizontal, radians */
    int width, height; /* of the frame, pixels */
} tc_scenery;

/* Direction in space (body.h), of length 1, in which a view sees a pixel's place; x and y as in tc_pointer_event. */
void tc_pixel_ray(const tc_scenery *scenery, const tc_pose *view, double x, double y, double ray_ret[3]);

/* How far a walk along a ray goes at a time: the larger of these shares of the height above ground and of the way so
 * far, within these metres; further where no ground is as high. */
typedef struct tc_ray_steps {
    double by_height, by_way, shortest, longest;
    int64_t most; /* steps */
} tc_ray_steps;

/* Where a ray from a place above the ground, in the direction `way` of length 1 in space, meets the ground first:
 * metres from there, and the point. Walks, then halves: what the ray meets for less than a step may be missed. highest:
 * metres absolute, no ground is higher; from, to: metres between which it is looked for. A ground of -INFINITY is none:
 * what goes below the ground there meets nothing. False where it meets none, or begins below it. */
bool tc_meet_ground(const tc_ground *ground, const double place[3], const double way[3], double highest, double from,
                    double to, const tc_ray_steps *steps, double *distance_ret, double p_ret[3]);

/* The pixel that shows a point of space, as if nothing were before it. False behind the eye. */
bool tc_pixel_of(const tc_scenery *scenery, const tc_pose *view, const double p[3], double *x_ret, double *y_ret);

/* The point of the ground that a pixel shows, in space. Steps follow the height above ground, so that ridges thinner
 * than a part in two hundred of the distance may be missed. False where the pixel shows none. */
bool tc_pick(const tc_scenery *scenery, const tc_pose *view, double x, double y, double p_ret[3]);

#endif
