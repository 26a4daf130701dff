/* clipmap_internal.h - a geometry clipmap: what the files that make it share.
 *
 *     clipmap.c          levels and their arrays, what is asked about them
 *     clipmap_update.c   the regions and their update within a budget
 *     clipmap_ahead.c    what the field is asked for, for now and for later */
#ifndef TC_CLIPMAP_INTERNAL_H
#define TC_CLIPMAP_INTERNAL_H

#include "clipmap.h"
#include "common/base/rect.h"

/* Where a region grows: beyond its four sides; where it begins. */
enum { SIDES = 4, BEGINNING = SIDES, PLACES };

/* What could not be read there: the other sides go on meanwhile. */
typedef struct pause {
    int failures;      /* in a row */
    double not_before; /* when to try again */
} pause;

typedef struct clip_state {
    tc_clip_level view;
    int field_level;
    int64_t width;                 /* samples that the field has at this level; vertices beyond lie on the edge */
    void *texels[TC_MAX_CONTENTS]; /* toroidal */
    tc_rect changes[TC_MAX_CHANGES];
    uint64_t changed; /* how often; the last ones are in changes[(k - 1) % TC_MAX_CHANGES] */
    pause pause[PLACES];
    tc_rect asked[PLACES]; /* samples that the field was asked for there; empty: none */
} clip_state;

/* What the field is asked for since windows will want it some time on. */
enum { AHEAD_CELLS = 32 };
typedef struct ahead_cell {
    int level; /* of the clipmap, for which it is; 0: none */
    bool kept; /* it was found wanted again */
    int field_level;
    tc_rect rect;
} ahead_cell;

typedef struct ahead {
    double speed_x, speed_y; /* of the windows, samples of the finest level a second */
    double last;             /* by the clock of updates, seconds */
    unsigned turn;           /* of levels, one an update */
    ahead_cell cell[AHEAD_CELLS];
} ahead;

struct tc_clipmap {
    const tc_field *field;
    int n, levels, contents;
    tc_content content[TC_MAX_CONTENTS];
    clip_state level[TC_MAX_LEVELS]; /* [l - 1] */
    void *scratch;
    ahead ahead;
    tc_status failed; /* of the last filling that failed, while any level waits to be read again */
};

/* Texels along a side of a content's arrays. */
int64_t tc_clipmap_side(const tc_clipmap *c, const tc_content_class *content);

/* Fills a rectangle with all contents; tc_clipmap_changed() is the caller's. late: NULL to wait for the field; else set
 * where that would have been needed, and nothing is filled. */
tc_status tc_clipmap_fill_contents(tc_clipmap *c, int level, tc_rect rect, bool *late);

static inline void tc_clipmap_changed(clip_state *s, tc_rect rect)
{
    s->changes[s->changed++ % TC_MAX_CHANGES] = rect;
}

/* The part of a level's rectangle that lies `distance` samples within, but up to the terrain's end where it reaches it.
 */
static inline tc_rect erode(tc_rect r, tc_rect extent, int64_t distance)
{
    if (tc_rect_empty(r))
        return r;
    r.x0 += r.x0 > extent.x0 ? distance : 0;
    r.y0 += r.y0 > extent.y0 ? distance : 0;
    r.x1 -= r.x1 < extent.x1 ? distance : 0;
    r.y1 -= r.y1 < extent.y1 ? distance : 0;
    return tc_rect_empty(r) ? (tc_rect){0, 0, 0, 0} : r;
}

/* The rectangle of a finer level's samples that spans r of the coarser one. */
static inline tc_rect refine(tc_rect r)
{
    return tc_rect_empty(r) ? r : (tc_rect){2 * r.x0, 2 * r.y0, 2 * r.x1 - 1, 2 * r.y1 - 1};
}

/* ---- What the field is asked for (clipmap_ahead.c) ----------------------------------------------------------------
 */

/* Whether filling rect need not wait for the field, which is asked for it in the name of a place of the level; what was
 * asked for there before is not wanted any more. */
tc_ready tc_clipmap_ask(tc_clipmap *c, int level, int place, tc_rect rect);

/* The level's windows have moved: what was asked for and is not wanted any more, or held, is not to be decoded. */
void tc_clipmap_review(tc_clipmap *c, int level);

/* The windows are about to move on to what is wanted, at a moment in seconds: how fast do they move? */
void tc_clipmap_measure_speed(tc_clipmap *c, const tc_rect *wanted, double now);

/* Asks, without urgency, for what windows will want so many seconds on as they move; of one level a call. */
void tc_clipmap_ask_ahead(tc_clipmap *c, double seconds);

/* Nothing of all that is wanted any more. */
void tc_clipmap_ask_nothing(tc_clipmap *c);

#endif
