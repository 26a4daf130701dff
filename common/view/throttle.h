/* throttle.h - how much coarser frames are drawn, so that they take no longer than asked for (LH04 section 1).
 *
 * A controller without a clock: it is told what frames took and answers how coarse the next one is to be, in octaves:
 * each halves what is drawn along a side. It changes evenly, by at most TC_THROTTLE_STEP a frame, since it moves what
 * is seen. It coarsens once frames take longer than the target and until they take a bit less, regrows only where there
 * is room for much more, and rests in between; single long frames do not count. Where regrowing was followed by
 * coarsening at once, it is tried ever more seldom: what is drawn goes in leaps at times, and the target may lie within
 * one. */
#ifndef TC_THROTTLE_H
#define TC_THROTTLE_H

#include <stdbool.h>

/* The largest change in a frame, octaves. */
#define TC_THROTTLE_STEP (1.0 / 48)

enum { TC_THROTTLE_RECENT = 5 };

typedef struct tc_throttle {
    double target_ms;
    double value;                      /* octaves, 0: all is drawn */
    double recent[TC_THROTTLE_RECENT]; /* milliseconds; a ring */
    int frames;                        /* there were in it so far, at most its size; and where the next one goes: */
    int next;
    int way;      /* 1: coarsens, -1: regrows, 0: rests */
    int too_long; /* frames in a row that took longer than the target */
    int rested;   /* frames since it began to rest, */
    int regrown;  /* since it regrew last */
    int patience; /* frames that it rests before it regrows */
} tc_throttle;

/* target_ms > 0: what a frame may take. */
tc_throttle tc_throttle_of(double target_ms);

/* Hears that the last frame took so many milliseconds (what is no number or negative is not heard); value, at most
 * `most`, is then what the next frame is drawn with. Returned as well. */
double tc_throttle_step(tc_throttle *throttle, double frame_ms, double most);

#endif
