/* pointer.h - what a mouse or a touchpad did, as a window reports it and gestures.h understands it. */
#ifndef TC_POINTER_H
#define TC_POINTER_H

typedef enum tc_pointer_kind {
    TC_POINTER_MOVE,
    TC_POINTER_PRESS,
    TC_POINTER_RELEASE,
    TC_POINTER_WHEEL
} tc_pointer_kind;

typedef enum tc_pointer_button { TC_POINTER_LEFT, TC_POINTER_RIGHT, TC_POINTER_MIDDLE } tc_pointer_button;

typedef struct tc_pointer_event {
    tc_pointer_kind kind;
    tc_pointer_button button; /* of a press and a release */
    double x, y;              /* where the pointer is: pixels of the frame, from its left and upper edge */
    double wheel;             /* notches away from the user; touchpads send parts of them */
    double seconds;           /* when, on a clock that runs evenly */
} tc_pointer_event;

#endif
