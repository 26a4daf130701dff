/* navigation.h - how a camera is placed and moved on a body: over a plane (navigation_plane.c), over a globe
 * (navigation_sphere.c). */
#ifndef TC_NAVIGATION_H
#define TC_NAVIGATION_H

#include "common/chart/body.h"
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
    tc_body body;     /* of a globe */
} tc_ground;

typedef struct tc_flight {
    tc_pose view;
    double speed; /* heights above ground a second; tc_flight_speed at start */
} tc_flight;

/* What the user wants during one frame. */
typedef struct tc_flight_input {
    double right, forward, up; /* -1 .. 1; forward is where the eye looks, up is up */
    double turn, tilt;         /* radians by which to turn right and look up */
    bool fast;                 /* eight times as fast */
    double dt;                 /* seconds; more than a tenth counts as a tenth */
} tc_flight_input;

/* The terrain as a whole, in a pose's units: what is there of the body. */
typedef struct tc_flight_box {
    double west, south, east, north;
    double z_min, z_max; /* metres, absolute */
    double radius;       /* metres, of a globe; else 0 */
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
    /* The view whose frame of fov (horizontal, radians) and width x height shows the whole well: of a plane from the
     * south, beside a corner, as large as can be. From above its highest point. */
    tc_pose (*whole)(const tc_flight_box *box, double fov, int width, int height);
    /* Turns and moves the view. The speed follows the height above ground; the eye stays above ground by the clearance.
     */
    void (*step)(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground);
    /* Moves the eye by so many metres east and north, as long at its height, along a straight line or a great circle on
     * which the heading is carried along. */
    void (*go)(const tc_body *body, tc_pose *view, double east, double north);
    /* Metres from foot point to foot point, and the foot point of a share of that way; height and direction are a's. */
    double (*apart)(const tc_body *body, const tc_pose *a, const tc_pose *b);
    tc_pose (*between)(const tc_pose *a, const tc_pose *b, double share);
    /* The highest ground that the eye must stay above: also a clearance away to all sides. */
    double (*highest)(const tc_ground *ground, const tc_pose *view);
} tc_navigation;

extern const tc_navigation tc_plane_navigation, tc_sphere_navigation;

#endif
