/* frame_timer.h - what frames in a window take, without what they wait for: neither the screen's turn nor a free place
 * in the driver's queue is work.
 *
 * On a GPU a frame takes as long as the slower of two who work at the same time: the processor time of the thread that
 * draws, and the GPU's own time between the frame's first and last command (GL_TIME_ELAPSED), which is known some
 * frames later and asked for without waiting. A software renderer works on the same processors, and its queries tell
 * but a part of it: there, as where a driver has no timer, the clock runs until all is drawn, before the window's
 * buffers are swapped. */
#ifndef TC_FRAME_TIMER_H
#define TC_FRAME_TIMER_H

#include "gl.h"

enum { TC_FRAME_TIMES = 6 }; /* frames that may be on their way; more are not measured */

typedef struct tc_frame_timer {
    bool waits;                   /* by the clock */
    GLuint query[TC_FRAME_TIMES]; /* a ring */
    double processor_ms[TC_FRAME_TIMES];
    int64_t begun, read; /* frames with a query */
    bool running;        /* one of them */
    double start;        /* milliseconds, of the clock or of the thread */
    double waited;       /* what the last frame took by the clock; negative: read already */
} tc_frame_timer;

/* gl must be current, and no timer query of anyone else's run meanwhile. */
tc_frame_timer tc_frame_timer_create(const tc_gl *gl);
void tc_frame_timer_destroy(const tc_gl *gl, tc_frame_timer *timer);

/* Before a frame's first command, and after its last one, before buffers are swapped. */
void tc_frame_timer_begin(const tc_gl *gl, tc_frame_timer *timer);
void tc_frame_timer_end(const tc_gl *gl, tc_frame_timer *timer);

/* The milliseconds of a frame that are known by now and were not told yet, the oldest first; false: there are none. */
bool tc_frame_timer_read(const tc_gl *gl, tc_frame_timer *timer, double *ms_ret);

#endif
