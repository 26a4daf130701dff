/* flight.h - moving the camera: views in words, free flight over ground, the view that shows a whole terrain.
 * No GL, no window, no clock: time and ground come in from outside. Paths through several views: flight_path.h. */
#ifndef TC_FLIGHT_H
#define TC_FLIGHT_H

#include "common/terraclip.h"

/* Where the eye is and where it looks. */
typedef struct tc_view {
    double x, y, z;        /* metres, z absolute */
    double heading, pitch; /* radians; heading clockwise from north, pitch up from the horizon */
} tc_view;

/* No coordinate of a view is farther out, metres: beyond it sample numbers would not fit 64 bits. */
#define TC_VIEW_LIMIT 1e12

/* Reads "X,Y,Z,HEADING,PITCH" (metres, degrees; |coordinates| <= TC_VIEW_LIMIT, |heading| <= 360, |pitch| <= 90).
 * Strict: nothing before, between or after; no NaN, no infinity. False where text is anything else. */
bool tc_view_parse(const char *text, tc_view *view_ret);

/* Writes the view as text that tc_view_parse reads, rounded to millimetres (finer where spacing, metres, is below a
 * metre) and to 0.0001 degrees, and sets *view to what the text says, so that it is this very view that comes back.
 * heading comes out in 0 .. 360. */
enum { TC_VIEW_TEXT = 160 };
void tc_view_format(tc_view *view, double spacing, char text[TC_VIEW_TEXT]);

/* Sets the camera's eye and direction, and leaves the rest of it. */
void tc_view_to_camera(const tc_view *view, tc_camera *camera);

/* A box of terrain, metres. */
typedef struct tc_flight_box {
    double x_max, y_max; /* the terrain is 0 .. x_max by 0 .. y_max */
    double z_min, z_max; /* absolute */
} tc_flight_box;

/* The view from the south, down to the north, whose frame of fov (horizontal, radians) and width x height holds all of
 * the box as large as can be. From above its highest point. */
tc_view tc_view_whole(const tc_flight_box *box, double fov, int width, int height);

/* What the eye must stay above. */
typedef struct tc_ground {
    double (*height)(void *context, double x, double y); /* metres absolute, at any x, y */
    void *context;
    double clearance; /* metres that the eye keeps above it */
} tc_ground;

/* A clearance that suits a terrain of this spacing, metres: a standing person's eye, less for models of small things.
 */
double tc_flight_clearance(double spacing);

typedef struct tc_flight {
    tc_view view;
    double speed; /* heights above ground a second; tc_flight_speed at start */
} tc_flight;

extern const double tc_flight_speed;

/* What the user wants during one frame. */
typedef struct tc_flight_input {
    double right, forward, up; /* -1 .. 1; forward is where the eye looks, up is up */
    double turn, tilt;         /* radians by which to turn right and look up */
    double wheel;              /* notches; each changes the speed */
    bool fast;                 /* eight times as fast */
    double dt;                 /* seconds; more than a tenth counts as a tenth */
} tc_flight_input;

/* Turns and moves the view. The speed follows the height above ground; the eye stays above ground by the clearance. */
void tc_flight_step(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground);

#endif
