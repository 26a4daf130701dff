/* quality.c - how well a window draws; see quality.h. */
#include "quality.h"

#include <math.h>

static const double REST = 0.2; /* seconds without a change */

tc_quality tc_quality_of(int full, bool rests, bool coarsens, double target_ms, bool slow)
{
    tc_quality q = {.full = full, .rests = rests, .coarsens = coarsens, .throttle = tc_throttle_of(target_ms)};
    q.rough = rests && slow && full > 1;
    tc_quality_before(&q, true, 0);
    return q;
}

static void draw_moving(tc_quality *q)
{
    q->draws = true;
    q->samples = q->rough ? 1 : q->full;
    q->octaves = q->coarsens ? q->throttle.value : 0;
}

void tc_quality_before(tc_quality *q, bool changed, double dt)
{
    static const double LONGEST = 0.05; /* seconds of a frame that count: a slow one alone is no rest */
    q->unchanged = changed ? 0 : q->unchanged + fmin(dt, LONGEST);
    q->stands &= !changed;
    q->whole &= !changed;
    draw_moving(q);
    if (!q->rests || q->unchanged < REST)
        return;
    q->draws = !q->stands;
    q->octaves = 0;
    if (q->whole) /* before, frames that load are drawn as fast as may be */
        q->samples = q->full;
}

void tc_quality_drawn(tc_quality *q, bool whole)
{
    if (!q->rests || q->unchanged < REST)
        return;
    q->stands = whole && q->samples == q->full;
    q->whole = whole;
}

void tc_quality_took(tc_quality *q, double frame_ms, double most_octaves)
{
    /* A frame of four samples costs up to four of one: so that it does not go to and fro. */
    static const double SMOOTH = 0.3, ROOM = 5;
    enum { FIRST = 3 }; /* frames make what they need */
    if (q->heard < FIRST)
        q->heard++;
    if ((q->rests && q->unchanged >= REST) || q->heard < FIRST)
        return;
    q->recent = q->recent > 0 ? q->recent + SMOOTH * (frame_ms - q->recent) : frame_ms;
    const double target = q->throttle.target_ms;
    const bool slow = q->recent > target, room = q->recent < target / ROOM && !(q->throttle.value > 0);
    if (q->rests && q->full > 1 && (q->rough ? room : slow)) {
        q->rough = !q->rough;
        q->recent = 0;
    } else if (q->coarsens && (q->rough || q->full == 1 || !q->rests)) {
        tc_throttle_step(&q->throttle, frame_ms, most_octaves);
    }
}
