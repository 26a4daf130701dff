/* clipmap_ahead.c - what a clipmap asks its field for: what it is about to fill, what it may want some time on, and
 * that neither is wanted any more.
 *
 * What windows will want is told from how they move alone, so that it is the same for all schemes. It is asked for in
 * cells as large as a packed terrain's tiles, less what its filters reach beyond them: a question is then about one
 * tile of its level, and stays the same while the windows move. */
#include <math.h>
#include <stdlib.h>

#include "clipmap_internal.h"
#include "common/field/field.h"

enum { CELL = 128, CELL_EDGE = 8 };

/* Seconds over which the speed is the mean; of a pause after which it begins anew. */
static const double SPEED_MEAN = 0.25, LONGEST_STEP = 0.5;

static const tc_rect NOTHING = {0, 0, 0, 0};

/* ---- For now ----------------------------------------------------------------------------------------------------- */

/* How far contents read beyond a rectangle: of its level, and of the next finer one, where that is read at all; else
 * below 0. */
static void reaches(const tc_clipmap *c, int level, int *own_ret, int *finer_ret)
{
    *own_ret = 0, *finer_ret = -1;
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        *own_ret = content->reach > *own_ret ? content->reach : *own_ret;
        *finer_ret = content->reach_finer > *finer_ret ? content->reach_finer : *finer_ret;
    }
    if (c->level[level - 1].field_level == tc_field_info(c->field)->levels)
        *finer_ret = -1;
}

/* What filling a rectangle reads, [0] of its level and [1] of the next finer one. */
static void reads(const tc_clipmap *c, int level, tc_rect rect, tc_rect read[2])
{
    int own, finer;
    reaches(c, level, &own, &finer);
    read[0] = tc_rect_empty(rect) ? NOTHING : tc_rect_grown(rect, own);
    read[1] = tc_rect_empty(rect) || finer < 0 ? NOTHING : tc_rect_grown(refine(rect), finer);
}

/* What was asked for at a place is not wanted any more. */
static void ask_no_more(tc_clipmap *c, int level, int place)
{
    clip_state *s = &c->level[level - 1];
    tc_rect read[2];
    reads(c, level, s->asked[place], read);
    for (int k = 0; k < 2; k++)
        if (!tc_rect_empty(read[k]))
            tc_field_overtaken(c->field, s->field_level + k, read[k]);
    s->asked[place] = NOTHING;
}

tc_ready tc_clipmap_ask(tc_clipmap *c, int level, int place, tc_rect rect)
{
    clip_state *s = &c->level[level - 1];
    tc_rect read[2];
    reads(c, level, rect, read);
    tc_ready ready = tc_field_ready(c->field, s->field_level, read[0], TC_SOON), more = TC_READY;
    if (!tc_rect_empty(read[1]))
        more = tc_field_ready(c->field, s->field_level + 1, read[1], TC_SOON);
    ready = ready == TC_FAILED || more == TC_FAILED ? TC_FAILED : ready == TC_READY ? more : ready;
    const bool before = tc_rect_equal(s->asked[place], rect);
    if (ready == TC_READY && before)
        s->asked[place] = NOTHING;
    if (ready != TC_READY && !before) {
        ask_no_more(c, level, place);
        s->asked[place] = rect;
    }
    return ready;
}

void tc_clipmap_review(tc_clipmap *c, int level)
{
    const clip_state *s = &c->level[level - 1];
    for (int place = 0; place < PLACES; place++)
        if (!tc_rect_empty(s->asked[place]) &&
            (!tc_rect_within(s->asked[place], s->view.wanted) || tc_rect_within(s->asked[place], s->view.clip)))
            ask_no_more(c, level, place);
}

/* ---- For later --------------------------------------------------------------------------------------------------- */

void tc_clipmap_measure_speed(tc_clipmap *c, const tc_rect *wanted, double now)
{
    ahead *a = &c->ahead;
    const double step = now - a->last, share = 1 - exp(-step / SPEED_MEAN);
    int l = c->levels;
    while (l > 1 && (tc_rect_empty(wanted[l - 1]) || tc_rect_empty(c->level[l - 1].view.wanted)))
        l--;
    if (step == 0)
        return;
    a->last = now;
    const tc_clip_level *v = &c->level[l - 1].view;
    const tc_rect from = v->wanted, to = wanted[l - 1];
    const int64_t x = to.x0 + to.x1 - from.x0 - from.x1, y = to.y0 + to.y1 - from.y0 - from.y1;
    if (l == 1 || step < 0 || step > LONGEST_STEP || llabs(x) > 2 * c->n || llabs(y) > 2 * c->n) { /* or it has leapt */
        a->speed_x = a->speed_y = 0;
        return;
    }
    a->speed_x += share * (ldexp(0.5 * (double)x, v->shift) / step - a->speed_x);
    a->speed_y += share * (ldexp(0.5 * (double)y, v->shift) / step - a->speed_y);
}

static void forget_cell(tc_clipmap *c, ahead_cell *cell)
{
    tc_field_overtaken(c->field, cell->field_level, cell->rect);
    cell->level = 0;
}

/* Asks for a cell for a level; false where no more can be asked for. */
static bool ask_cell(tc_clipmap *c, int level, int field_level, tc_rect rect)
{
    ahead_cell *free_cell = NULL, *found = NULL;
    for (ahead_cell *cell = c->ahead.cell; cell < c->ahead.cell + AHEAD_CELLS && !found; cell++)
        if (cell->level == 0)
            free_cell = cell;
        else if (cell->level == level && cell->field_level == field_level && tc_rect_equal(cell->rect, rect))
            found = cell;
    if (!found && !free_cell)
        return false;
    if (tc_field_ready(c->field, field_level, rect, TC_LATER) != TC_COMING) {
        if (found)
            found->level = 0;
        return true;
    }
    *(found ? found : free_cell) = (ahead_cell){level, true, field_level, rect};
    return true;
}

/* Asks for the cells of one of the field's levels that touch what will be wanted and not what is wanted now. */
static void ask_cells(tc_clipmap *c, int level, int field_level, tc_rect wanted, tc_rect later)
{
    for (int64_t y = tc_floor_shift(later.y0, 7) * CELL; y < later.y1; y += CELL)
        for (int64_t x = tc_floor_shift(later.x0, 7) * CELL; x < later.x1; x += CELL) {
            const tc_rect cell = {x, y, x + CELL, y + CELL};
            const bool is_wanted = !tc_rect_empty(tc_rect_intersect(cell, wanted));
            if (!is_wanted && !ask_cell(c, level, field_level, tc_rect_grown(cell, -CELL_EDGE)))
                return;
        }
}

/* A way in whole samples: no more than half a window, and no less than a cell's filters reach, twice, since windows
 * that crawl come to the next cell all at once, too. */
static int64_t steps_ahead(double way, int n)
{
    const double least = 2 * CELL_EDGE, most = fmax(0.5 * n, least);
    return fabs(way) < 1e-3 ? 0 : (int64_t)copysign(fmin(rint(fabs(way)) + least, most), way);
}

void tc_clipmap_ask_ahead(tc_clipmap *c, double seconds)
{
    ahead *a = &c->ahead;
    if (c->levels < 2)
        return;
    const int level = 2 + (int)(a->turn++ % (unsigned)(c->levels - 1));
    const clip_state *s = &c->level[level - 1];
    const int64_t dx = steps_ahead(ldexp(seconds * a->speed_x, -s->view.shift), c->n),
                  dy = steps_ahead(ldexp(seconds * a->speed_y, -s->view.shift), c->n);
    for (ahead_cell *cell = a->cell; cell < a->cell + AHEAD_CELLS; cell++)
        cell->kept = cell->level != level;
    const tc_rect wanted = s->view.wanted;
    /* Also what the window passes over on its way. */
    const tc_rect there = {wanted.x0 + dx, wanted.y0 + dy, wanted.x1 + dx, wanted.y1 + dy};
    const tc_rect later = tc_rect_intersect(tc_rect_around(wanted, there), s->view.extent);
    if (!tc_rect_empty(wanted) && !tc_rect_empty(later) && (dx || dy)) {
        tc_rect now_read[2], later_read[2];
        reads(c, level, wanted, now_read), reads(c, level, later, later_read);
        for (int k = 0; k < 2; k++)
            if (!tc_rect_empty(later_read[k]))
                ask_cells(c, level, s->field_level + k, now_read[k], later_read[k]);
    }
    for (ahead_cell *cell = a->cell; cell < a->cell + AHEAD_CELLS; cell++)
        if (cell->level && !cell->kept)
            forget_cell(c, cell);
}

void tc_clipmap_ask_nothing(tc_clipmap *c)
{
    for (int level = 1; level <= c->levels; level++)
        for (int place = 0; place < PLACES; place++)
            if (!tc_rect_empty(c->level[level - 1].asked[place]))
                ask_no_more(c, level, place);
    for (ahead_cell *cell = c->ahead.cell; cell < c->ahead.cell + AHEAD_CELLS; cell++)
        if (cell->level)
            forget_cell(c, cell);
}
