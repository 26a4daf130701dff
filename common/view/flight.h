/* flight.h - views in words, and what all ways of moving (navigation.h) have in common. No GL, no window, no clock:
 * time and ground come in from outside. Paths through several views: flight_path.h. */
#ifndef TC_FLIGHT_H
#define TC_FLIGHT_H

#include "navigation.h"

/* No coordinate of a view is farther out, metres: beyond it sample numbers would not fit 64 bits. */
#define TC_POSE_LIMIT 1e12

/* Reads a view as its navigation has it, "X,Y,Z,HEADING,PITCH" in metres and degrees or "LON,LAT,ALT,HEADING,PITCH"
 * (|Z| <= TC_POSE_LIMIT, |heading| <= 360, |pitch| <= 90). Strict: nothing before, between or after; no NaN, no
 * infinity. False where text is anything else. */
bool tc_pose_parse(const tc_navigation *navigation, const char *text, tc_pose *view_ret);

/* Writes the view as text that tc_pose_parse reads, rounded to millimetres (finer where spacing, metres, is below a
 * metre; degrees to 1e-9) and to 0.0001 degrees, and sets *view to what the text says, so that it is this very view
 * that comes back. heading comes out in 0 .. 360. */
enum { TC_POSE_TEXT = 160 };
void tc_pose_format(const tc_navigation *navigation, tc_pose *view, double spacing, char text[TC_POSE_TEXT]);

/* Sets the camera's eye and direction, and leaves the rest of it. */
void tc_pose_to_camera(const tc_pose *view, tc_camera *camera);

/* A clearance that suits a terrain of this spacing, metres: a standing person's eye, less for models of small things.
 */
double tc_flight_clearance(double spacing);

extern const double tc_flight_speed;

/* Sets the flight's speed by a wheel's notches: a quarter faster each. */
void tc_flight_faster(tc_flight *flight, double notches);

/* What all navigations' steps begin with: turns the view, and says by how many metres east, north and up it moves. The
 * way follows the eye's height above ground; close to the ground, where that comes to nothing, one still moves. */
void tc_flight_move(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground, double above,
                    double move_ret[3]);

/* Metres that an eye keeps above ground while it moves: the clearance; less where it was put lower, above it. */
double tc_flight_keeps(const tc_ground *ground, double above);

/* The ground as far as it matters to an eye at (x, y): also the clearance away to all sides, dx and dy in the map's
 * units, since a wall may be beside it. */
double tc_highest_ground(const tc_ground *ground, double x, double y, double dx, double dy);

#endif
