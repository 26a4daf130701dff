/* throttle.c - from times of frames to how coarse they are drawn. */
#include "throttle.h"

#include <math.h>
#include <string.h>

/* In shares of the target. */
static const double TOO_LONG = 1;  /* from here on it coarsens, */
static const double ENOUGH = 0.92; /* until here; */
static const double ROOM = 0.7;    /* below this it regrows, */
static const double GROWN = 0.82;  /* until here; */
static const double AIM = 0.88;    /* both on their way to this. Of what leaps, no leap is as large as from here to */
static const double PLENTY = 0.35; /* that: no need to be patient */

/* Octaves a frame for each octave that frames take too long. Halving what is drawn along a side saves up to two of
 * those, and that shows some frames later, of which the median takes two and timers of GPUs two: no larger, or it
 * swings. */
static const double GAIN = 0.035;
static const double REGROWTH = 0.5; /* of the largest step: more haste to be in time than to be fine */

enum { IN_A_ROW = 5, PATIENCE = 20, LONGEST_PATIENCE = 1280, AT_ONCE = 4 /* patiences */, LONG_AGO = 1 << 20 };

tc_throttle tc_throttle_of(double target_ms)
{
    return (tc_throttle){.target_ms = target_ms, .regrown = LONG_AGO, .patience = PATIENCE};
}

/* Of the frames heard last. */
static double median(const tc_throttle *t)
{
    double sorted[TC_THROTTLE_RECENT];
    memcpy(sorted, t->recent, sizeof sorted);
    for (int i = 1; i < TC_THROTTLE_RECENT; i++)
        for (int k = i; k > 0 && sorted[k] < sorted[k - 1]; k--) {
            double swapped = sorted[k];
            sorted[k] = sorted[k - 1], sorted[k - 1] = swapped;
        }
    return sorted[TC_THROTTLE_RECENT / 2];
}

/* Once several in a row were too long. */
static void coarsen(tc_throttle *t)
{
    bool at_once = t->regrown < AT_ONCE * t->patience;
    t->patience = !at_once ? PATIENCE : t->patience < LONGEST_PATIENCE ? 2 * t->patience : t->patience;
    t->way = 1;
}

static void rest(tc_throttle *t)
{
    t->way = 0;
    t->rested = 0;
}

static void choose_way(tc_throttle *t, double load, double most)
{
    int patience = load < PLENTY ? PATIENCE : t->patience;
    t->too_long = load > TOO_LONG ? t->too_long + (t->too_long < IN_A_ROW) : 0;
    if (t->too_long == IN_A_ROW && t->way <= 0 && t->value < most)
        coarsen(t);
    else if (load < ROOM && t->way == 0 && t->value > 0 && t->rested >= patience)
        t->way = -1;
    else if ((t->way > 0 && (load <= ENOUGH || t->value >= most)) || (t->way < 0 && (load >= GROWN || t->value <= 0)))
        rest(t);
}

double tc_throttle_step(tc_throttle *t, double frame_ms, double most)
{
    if (!(frame_ms >= 0 && frame_ms <= 1e9))
        return t->value = fmin(t->value, most);
    t->recent[t->next] = fmax(frame_ms, 1e-6);
    t->next = (t->next + 1) % TC_THROTTLE_RECENT;
    t->frames += t->frames < TC_THROTTLE_RECENT;
    t->rested += t->rested < LONG_AGO;
    t->regrown += t->regrown < LONG_AGO;
    if (t->frames == TC_THROTTLE_RECENT) {
        double load = median(t) / t->target_ms;
        choose_way(t, load, most);
        double step = t->way ? GAIN * log2(load / AIM) : 0;
        t->value += fmin(fmax(step, -REGROWTH * TC_THROTTLE_STEP), TC_THROTTLE_STEP);
        if (t->way < 0)
            t->regrown = 0;
    }
    return t->value = fmin(fmax(t->value, 0), most);
}
