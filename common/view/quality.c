/* quality.c - how well a window draws; see quality.h. */
#include "quality.h"

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
    q->unchanged = changed ? 0 : q->unchanged + dt;
    q->stands &= !changed;
    draw_moving(q);
    if (!q->rests || q->unchanged < REST)
        return;
    q->draws = !q->stands;
    q->samples = q->full, q->octaves = 0;
}

void tc_quality_after(tc_quality *q, double frame_ms, bool whole, double most_octaves)
{
    /* A frame of four samples costs up to four of one: so that it does not go to and fro. */
    static const double SMOOTH = 0.3, ROOM = 5;
    if (q->rests && q->unchanged >= REST) {
        q->stands = whole;
        return;
    }
    q->recent = q->recent > 0 ? q->recent + SMOOTH * (frame_ms - q->recent) : frame_ms;
    const double target = q->throttle.target_ms;
    if (q->rests && q->full > 1 && (q->rough ? q->recent < target / ROOM : q->recent > target)) {
        q->rough = !q->rough;
        q->recent = 0;
    } else if (q->coarsens && (q->rough || q->full == 1 || !q->rests)) {
        tc_throttle_step(&q->throttle, frame_ms, most_octaves);
    }
}
