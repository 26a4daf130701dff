/* quality.h - how well a window draws: as pictures do while it can keep up, and always once the view has come to rest.
 * No GL, no clock.
 *
 * While the view moves and frames take too long, pixels have one sample, and what is drawn becomes coarser where that
 * may be (throttle.h). At rest one frame is drawn at its best, and then none until something changes. */
#ifndef TC_QUALITY_H
#define TC_QUALITY_H

#include <stdbool.h>

#include "throttle.h"

typedef struct tc_quality {
    int full;      /* samples a pixel at its best */
    bool rests;    /* the view may come to rest; else each frame is drawn, at its best but for the throttle */
    bool coarsens; /* it may be throttled */
    tc_throttle throttle;
    bool rough;       /* one sample while moving */
    double recent;    /* milliseconds a frame, smoothed; 0: none heard */
    int heard;        /* of the first frames */
    double unchanged; /* seconds */
    bool whole;       /* at rest, a frame had all that it needs */
    bool stands;      /* the best frame is drawn */
    /* The next frame: whether there is to be one, and of how many samples a pixel and how many octaves coarser. */
    bool draws;
    int samples;
    double octaves;
} tc_quality;

/* target_ms: what a frame may take while the view moves, > 0. slow: the machine is known to be: begins roughly. */
tc_quality tc_quality_of(int full, bool rests, bool coarsens, double target_ms, bool slow);

/* Before a frame: dt seconds after the last one, of which something has changed or not. */
void tc_quality_before(tc_quality *quality, bool changed, double dt);

/* After it: whether it had all that it needs. */
void tc_quality_drawn(tc_quality *quality, bool whole);

/* Once that is known: what one took, milliseconds, without waiting for the screen; and how coarse frames may become. */
void tc_quality_took(tc_quality *quality, double frame_ms, double most_octaves);

#endif
