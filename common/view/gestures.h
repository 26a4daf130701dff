/* gestures.h - moving a view by the mouse, the same over a plane and over a globe. No GL, no window, no clock.
 *
 * Left button: the ground where it was pressed stays under the pointer; let go in motion, it runs on until it comes to
 * rest or anything is clicked. Far ground that is seen at a grazing angle turns the view instead of being pulled over
 * kilometres. Wheel: nearer to the ground under the pointer, by a share of the distance to it. Right or middle button:
 * about the ground in the middle of the frame, around and from above to the side. Twice left: flies there.
 *
 * North stays where it is on the frame while a globe is pulled, but close to a pole. */
#ifndef TC_GESTURES_H
#define TC_GESTURES_H

#include "fly_to.h"
#include "pick.h"
#include "pointer.h"

typedef enum tc_gesture {
    TC_GESTURE_NONE,
    TC_GESTURE_PULL,  /* the ground under the pointer follows it: the eye moves at its height */
    TC_GESTURE_TURN,  /* the same by turning the view on the spot */
    TC_GESTURE_ORBIT, /* about the point in the middle */
    TC_GESTURE_LOOK,  /* where there is none: about the eye */
    TC_GESTURE_NORTH, /* about it until north is up */
    TC_GESTURE_FLY
} tc_gesture;

enum { TC_GESTURE_TRACK = 8 };

/* Zero at start. */
typedef struct tc_gestures {
    tc_gesture gesture;
    bool coasting;         /* the pull or turn goes on without a button */
    double held[3];        /* the ground that is held, or turned about: in space (body.h) */
    double x, y;           /* the pointer; while coasting the one that is thought of */
    double vx, vy;         /* its speed then, pixels a second */
    double distance;       /* from the point turned about, metres */
    double heading, pitch; /* as seen from there */
    struct tc_gesture_sample {
        double x, y, seconds;
    } track[TC_GESTURE_TRACK]; /* where the pointer was while pulling; the last one at `tracked` - 1 */
    int tracked;
    double frame;                     /* seconds that the last frame took */
    double zoom;                      /* of the distance still to be gone: ln of the factor; 0: no zoom */
    double zoom_x, zoom_y;            /* the pixel that stays, */
    double zoom_at[3];                /* and the ground there */
    bool zoom_grounded;               /* there is some */
    double clicked, click_x, click_y; /* seconds and place of the last left press */
    tc_fly_to flight;
} tc_gestures;

/* What the mouse did changes the view. The view's eye stays above ground by the clearance. */
void tc_gestures_event(tc_gestures *gestures, const tc_scenery *scenery, const tc_pointer_event *event, tc_pose *view);

/* dt seconds pass: what runs on, runs on. */
void tc_gestures_step(tc_gestures *gestures, const tc_scenery *scenery, double dt, tc_pose *view);

/* Flies to a view; turns north up about the point in the middle; ends whatever runs on. */
void tc_gestures_fly(tc_gestures *gestures, const tc_scenery *scenery, const tc_pose *from, const tc_pose *to);
void tc_gestures_north(tc_gestures *gestures, const tc_scenery *scenery, const tc_pose *view);
void tc_gestures_rest(tc_gestures *gestures);

/* Whether the view moves, or will move, without anything being done. */
bool tc_gestures_moving(const tc_gestures *gestures);

#endif
