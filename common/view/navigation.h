/* navigation.h - how a camera is placed and moved on a kind of map: flat (flight.c), or a globe (spherical/globe.c). */
#ifndef TC_NAVIGATION_H
#define TC_NAVIGATION_H

#include "common/terraclip.h"

/* Where the eye is and where it looks. */
typedef struct tc_pose {
    double x, y, z;        /* metres, z absolute; on a globe longitude and latitude, radians, and metres above it */
    double heading, pitch; /* radians; heading clockwise from north, pitch up from the horizon */
} tc_pose;

/* What the eye must stay above. */
typedef struct tc_ground {
    double (*height)(void *context, double x, double y); /* metres absolute, at any x, y */
    void *context;
    double clearance; /* metres that the eye keeps above it */
    double radius;    /* metres, of the globe; else 0 */
} tc_ground;

typedef struct tc_flight {
    tc_pose view;
    double speed; /* heights above ground a second; tc_flight_speed at start */
} tc_flight;

/* What the user wants during one frame. */
typedef struct tc_flight_input {
    double right, forward, up; /* -1 .. 1; forward is where the eye looks, up is up */
    double turn, tilt;         /* radians by which to turn right and look up */
    double drag_x, drag_y;     /* radians of view by which the ground was pulled right and down */
    double wheel;              /* notches */
    bool fast;                 /* eight times as fast */
    double dt;                 /* seconds; more than a tenth counts as a tenth */
} tc_flight_input;

/* The terrain as a whole, metres; of a globe the radius instead of x_max and y_max, where not all of it is there the
 * part that is. */
typedef struct tc_flight_box {
    double x_max, y_max;             /* the terrain is 0 .. x_max by 0 .. y_max */
    double z_min, z_max;             /* absolute */
    double radius;                   /* of a globe; else 0 */
    double west, south, east, north; /* of a globe's part that has heights, radians */
} tc_flight_box;

typedef struct tc_navigation {
    const char *form;   /* of a view on the command line: "X,Y,Z,HEADING,PITCH" */
    const char *bounds; /* and its bounds, in words */
    const char *help;
    double unit;             /* of the first two numbers on the command line: 1, or radians a degree */
    double x_limit, y_limit; /* there */
    double x_period;         /* x comes round again, in the view's units; 0: never */
    /* Brings a view that was moved or computed within bounds. */
    void (*settle)(tc_pose *view);
    /* The view whose frame of fov (horizontal, radians) and width x height shows the whole well. */
    tc_pose (*whole)(const tc_flight_box *box, double fov, int width, int height);
    /* Turns and moves the view. The speed follows the height above ground; the eye stays above ground by the clearance.
     */
    void (*step)(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground);
} tc_navigation;

#endif
