/* clipmap_update.c - the regions of a geometry clipmap and their update within a budget (LH04 sections 3 to 5).
 *
 * Clip regions move coarse to fine. A region is a rectangle at all times: what leaves the wanted window is dropped,
 * then whole rows or columns are added at its sides until it is the wanted window or the budget is used up. The active
 * regions follow from the clip regions; LH04's four constraints hold after every update. Where the terrain ends both
 * levels end, so erosion stops there. */
#include <math.h>

#include "clipmap_internal.h"
#include "common/base/clock.h"
#include "turn.h"

/* Seconds until what could not be read is tried again: first, and at most. */
static const double FIRST_PAUSE = 0.25, LONGEST_PAUSE = 30;

/* The largest rectangle within r whose first and last samples are even; empty where it would cover no cell. */
static tc_rect even_perimeter(tc_rect r)
{
    r.x0 += r.x0 & 1;
    r.y0 += r.y0 & 1;
    r.x1 -= (r.x1 - 1) & 1;
    r.y1 -= (r.y1 - 1) & 1;
    return r.x1 - r.x0 < 3 || r.y1 - r.y0 < 3 ? (tc_rect){0, 0, 0, 0} : r;
}

/* A part of the level cannot be read: its pause begins. */
static void put_off(tc_clipmap *c, int level, int place, tc_status why, double now)
{
    pause *p = &c->level[level - 1].pause[place];
    c->failed = why;
    p->not_before = now + fmin(ldexp(FIRST_PAUSE, p->failures < 16 ? p->failures : 16), LONGEST_PAUSE);
    p->failures++;
}

/* How many rows (or columns) of `length` samples to add of `missing`: what the budget allows. */
static int64_t affordable(int64_t missing, int64_t length, int64_t budget)
{
    return budget < 0 ? missing : tc_min64(missing, budget / length);
}

/* The first rectangle of an empty region: as much as the budget allows, which may be nothing, around the middle of its
 * target. */
static tc_rect seed(tc_rect target, int64_t budget)
{
    if (budget < 0 || tc_rect_area(target) <= budget)
        return target;
    int64_t side = 0;
    while ((side + 1) * (side + 1) <= budget)
        side++;
    int64_t x = (target.x0 + target.x1 - side) / 2, y = (target.y0 + target.y1 - side) / 2;
    return tc_rect_intersect(target, (tc_rect){x, y, x + side, y + side});
}

/* What a field is asked for at once where it is not waited for: as many lines as have about PIECE_SAMPLES samples. With
 * normals four times as many are read. */
enum { PIECE_SAMPLES = 1 << 16, PIECE_LINES = 128 };

/* What is filled between two looks at the clock. */
enum { TIMED_SAMPLES = 1 << 13 };

static int64_t lines_a_piece(int64_t length)
{
    return tc_clamp64(PIECE_SAMPLES / tc_max64(length, 1), 1, PIECE_LINES);
}

/* How an update is to be made. */
typedef struct effort {
    int64_t budget; /* samples; below 0: no limit */
    double until;   /* 0: no limit */
    bool wait;      /* for what is not ready */
    bool at_once;   /* tries what could not be read, whatever its pause */
    double now;
    bool *begun; /* something was filled in this update */
} effort;

/* Whether no time is left; for one piece there always is. */
static bool is_over(const effort *e)
{
    return e->until > 0 && *e->begun && tc_clock_ms() >= e->until;
}

/* Lines first .. last - 1 beyond a side of r, counted outwards: columns in the west (0) and east (1), rows in the south
 * (2) and north (3). */
static tc_rect lines_beyond(tc_rect r, int side, int64_t first, int64_t last)
{
    switch (side) {
    case 0: return (tc_rect){r.x0 - last, r.y0, r.x0 - first, r.y1};
    case 1: return (tc_rect){r.x1 + first, r.y0, r.x1 + last, r.y1};
    case 2: return (tc_rect){r.x0, r.y0 - last, r.x1, r.y0 - first};
    default: return (tc_rect){r.x0, r.y1 + first, r.x1, r.y1 + last};
    }
}

/* How many of the lines beyond a side, from the innermost on, need not wait. The field is asked for them piece by piece
 * and no farther than the first that is not ready: a window comes as its parts do, those next to what is held first,
 * and no piece is too large for a cache to keep until it is used. *failed_ret: set where the next ones cannot be read.
 */
static int64_t ready_lines(tc_clipmap *c, int level, int place, tc_rect r, int side, int64_t lines, bool *failed_ret)
{
    int64_t piece = lines_a_piece(side < 2 ? r.y1 - r.y0 : r.x1 - r.x0), ready = 0;
    while (ready < lines) {
        int64_t next = tc_min64(lines, ready + piece);
        tc_ready answer = tc_clipmap_ask(c, level, place, lines_beyond(r, side, ready, next));
        *failed_ret |= answer == TC_FAILED;
        if (answer != TC_READY)
            break;
        ready = next;
    }
    return ready;
}

/* The part of an empty region's first rectangle that need not wait: all of it, else its middle, else nothing. */
static tc_rect ready_seed(tc_clipmap *c, int level, tc_rect first, bool *failed_ret)
{
    tc_rect none = {0, 0, 0, 0}, middle = seed(first, PIECE_SAMPLES / 4);
    tc_ready answer = tc_rect_empty(first) ? TC_COMING : tc_clipmap_ask(c, level, BEGINNING, middle);
    *failed_ret |= answer == TC_FAILED;
    if (answer != TC_READY)
        return none;
    tc_rect row = {first.x0, first.y0, first.x1, first.y0};
    int64_t lines = first.y1 - first.y0;
    return ready_lines(c, level, BEGINNING, row, 3, lines, failed_ret) == lines ? first : middle;
}

/* Adds a rectangle to what is held; returns its samples, none where it is empty, late, or cannot be read, which then is
 * put off. failed: its next part is known not to be read. */
static int64_t add_rect(tc_clipmap *c, int level, int place, tc_rect add, const effort *e, bool failed)
{
    tc_rect *clip = &c->level[level - 1].view.clip;
    bool late = false;
    tc_status status = tc_rect_empty(add) ? TC_OK : tc_clipmap_fill_contents(c, level, add, e->wait ? NULL : &late);
    if (late)
        return 0;
    if (status || failed)
        put_off(c, level, place, status ? status : TC_ERR_IO, e->now);
    else if (!tc_rect_empty(add))
        c->level[level - 1].pause[place].failures = 0;
    if (status || tc_rect_empty(add))
        return 0;
    *e->begun = true;
    *clip = tc_rect_empty(*clip) ? add
                                 : (tc_rect){tc_min64(clip->x0, add.x0), tc_min64(clip->y0, add.y0),
                                             tc_max64(clip->x1, add.x1), tc_max64(clip->y1, add.y1)};
    return tc_rect_area(add);
}

/* The same of lines beyond a side, piece by piece while there is time where that is limited. */
static int64_t add_lines(tc_clipmap *c, int level, int side, int64_t lines, const effort *e, bool failed)
{
    const tc_rect before = c->level[level - 1].view.clip;
    const int64_t length = side < 2 ? before.y1 - before.y0 : before.x1 - before.x0;
    const int64_t piece = e->until > 0 ? tc_max64(TIMED_SAMPLES / length, 1) : lines;
    int64_t done = 0, spent = 0, filled;
    do {
        int64_t next = tc_min64(lines, done + piece);
        filled = add_rect(c, level, side, lines_beyond(before, side, done, next), e, failed && next == lines);
        done = filled ? next : done;
        spent += filled;
    } while (filled && done < lines && !is_over(e));
    if (done)
        tc_clipmap_changed(&c->level[level - 1], lines_beyond(before, side, 0, done));
    return spent;
}

static bool pauses(const clip_state *s, int place, const effort *e)
{
    return !e->at_once && s->pause[place].failures && e->now < s->pause[place].not_before;
}

/* Adds rows and columns to what is held on its way to target; returns the samples filled. Without waiting, what the
 * field would have to decode first is left to a later call. */
static int64_t grow(tc_clipmap *c, int level, tc_rect target, effort e)
{
    clip_state *s = &c->level[level - 1];
    const tc_rect *clip = &s->view.clip;
    int64_t spent = 0;
    if (tc_rect_empty(target) || is_over(&e))
        return 0;
    if (tc_rect_empty(*clip) && !pauses(s, BEGINNING, &e)) {
        const bool small = e.until > 0 && (e.budget < 0 || e.budget > TIMED_SAMPLES);
        tc_rect first = seed(target, small ? TIMED_SAMPLES : e.budget);
        bool failed = false;
        if (!e.wait)
            first = ready_seed(c, level, first, &failed);
        spent = add_rect(c, level, BEGINNING, first, &e, failed);
        if (spent)
            tc_clipmap_changed(s, first);
    }
    for (int side = 0; side < SIDES && !tc_rect_empty(*clip) && !is_over(&e); side++) {
        int64_t missing[] = {clip->x0 - target.x0, target.x1 - clip->x1, clip->y0 - target.y0, target.y1 - clip->y1};
        int64_t length = side < 2 ? clip->y1 - clip->y0 : clip->x1 - clip->x0;
        int64_t lines = affordable(missing[side], length, e.budget < 0 ? -1 : tc_max64(0, e.budget - spent));
        bool failed = false;
        if (missing[side] == 0)
            s->pause[side].failures = 0;
        if (missing[side] == 0 || pauses(s, side, &e))
            continue;
        if (!e.wait)
            lines = ready_lines(c, level, side, *clip, side, lines, &failed);
        spent += add_lines(c, level, side, lines, &e, failed);
    }
    return spent;
}

/* Moves a level that holds all of a map which wraps: what comes in it has already. */
static int64_t move_round(tc_clipmap *c, int level, tc_rect target)
{
    clip_state *s = &c->level[level - 1];
    const tc_rect clip = s->view.clip, kept = tc_rect_intersect(clip, target);
    tc_rect add = target;
    if (!tc_rect_empty(kept) && kept.x0 > target.x0)
        add.x1 = kept.x0;
    else if (!tc_rect_empty(kept))
        add.x0 = kept.x1;
    if (tc_rect_empty(add))
        return 0;
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        tc_turn_texels(s->texels[k], tc_clipmap_side(c, content), tc_texel_bytes(content->format),
                       tc_content_rect(content, add), content->scale * clip.x0, content->scale * s->width, c->scratch);
    }
    tc_clipmap_changed(s, add);
    s->view.clip = target;
    return tc_rect_area(add);
}

/* The active region: what is held, cropped so that the coarser level can surround it. */
static void set_active(tc_clipmap *c, int level)
{
    tc_clip_level *v = &c->level[level - 1].view;
    if (level == 1) {
        v->active = v->clip;
        return;
    }
    const tc_clip_level *coarse = &c->level[level - 2].view;
    tc_rect around = refine(erode(coarse->active, coarse->extent, 2));
    v->active = even_perimeter(tc_rect_intersect(v->clip, around));
}

int64_t tc_clipmap_update_as(tc_clipmap *clipmap, const tc_rect *wanted, const tc_update *how)
{
    int64_t samples = 0, budget = how->budget;
    bool begun = false;
    tc_clipmap_measure_speed(clipmap, wanted, how->now);
    for (int l = 1; l <= clipmap->levels; l++) {
        tc_clip_level *v = &clipmap->level[l - 1].view;
        if (l == 1 && v->wraps && !tc_rect_empty(wanted[0])) {
            int64_t width = v->clip.x1 - v->clip.x0; /* always whole */
            v->wanted = (tc_rect){wanted[0].x0, v->clip.y0, wanted[0].x0 + width, v->clip.y1};
            samples += move_round(clipmap, 1, v->wanted);
        } else if (l > 1) {
            const tc_clip_level *coarse = &clipmap->level[l - 2].view;
            tc_rect allowed = refine(erode(coarse->clip, coarse->extent, 1));
            /* No more than there will be room for within the coarser level, or it would be waited for for ever. */
            tc_rect room = refine(erode(coarse->wanted, coarse->extent, 1));
            v->wanted = tc_rect_intersect(tc_rect_intersect(wanted[l - 1], v->extent), room);
            tc_rect target = tc_rect_intersect(v->wanted, allowed);
            v->clip = tc_rect_intersect(v->clip, target);
            int64_t spent = grow(clipmap, l, target,
                                 (effort){budget, how->wait ? 0 : how->until, how->wait, how->wait, how->now, &begun});
            tc_clipmap_review(clipmap, l);
            samples += spent;
            if (budget >= 0)
                budget = tc_max64(0, budget - spent);
        }
        set_active(clipmap, l);
    }
    if (how->ahead > 0 && !how->wait)
        tc_clipmap_ask_ahead(clipmap, how->ahead);
    return samples;
}

int64_t tc_clipmap_update(tc_clipmap *clipmap, const tc_rect *wanted, int64_t budget, bool wait, double now)
{
    return tc_clipmap_update_as(clipmap, wanted, &(tc_update){.budget = budget, .wait = wait, .now = now});
}
