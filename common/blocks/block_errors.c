/* block_errors.c - alpha of corners of blocks by a tolerance; see block_errors.h. */
#include "block_errors.h"

#include <math.h>

/* Ramps are at least so wide: in M, and in E of the coarser level. */
static const double WIDTH = 0.5, SHARE = 0.25;

enum { MASK = TC_ERROR_ROOM - 1 };

void tc_block_errors_begin(tc_block_errors *e, const tc_block_ground *ground, double tolerance)
{
    e->ground = *ground;
    e->tolerance = tolerance;
    e->view++;
}

/* ---- Blocks ----------------------------------------------------------------------------------------------------- */

/* Samples of a block by a level that is so much finer: those on its far sides are its neighbours', where it has any. */
static tc_rect samples_of(const tc_block_lattice *l, tc_block b, int finer)
{
    tc_rect r = tc_block_rect(l, b);
    const int64_t *cells = l->cells[b.level - 1];
    const bool last[2] = {r.x1 == cells[0], r.y1 == cells[1]};
    r = (tc_rect){r.x0 << finer, r.y0 << finer, r.x1 << finer, r.y1 << finer};
    return (tc_rect){r.x0, r.y0, r.x1 + last[0], r.y1 + last[1]};
}

/* E of the level before a block's next coarser one, or of the finest one before that is known. */
static float coarser_error(const tc_block_errors *e, tc_block b)
{
    tc_rect r = samples_of(e->ground.lattice, b, 0);
    for (int level = b.level - 1; level > 1; level--) {
        r = (tc_rect){r.x0 >> 1, r.y0 >> 1, ((r.x1 - 1) >> 1) + 1, ((r.y1 - 1) >> 1) + 1};
        const float error = e->ground.range(e->ground.context, b.chart, level, r).error;
        if (isfinite(error))
            return error;
    }
    return INFINITY;
}

/* Looks up a block. E of a level is known from the next finer one's samples (tc_range.error); what is not known yet is
 * no more than that of a coarser level. */
static void look_up(tc_block_errors *e, tc_block b)
{
    tc_level_errors *l = &e->level[b.chart][b.level - 1];
    const int32_t x = b.x & MASK, y = b.y & MASK;
    if (l->block[y][x].x == b.x + 1 && l->block[y][x].y == b.y + 1 &&
        (l->block[y][x].view == 0 || l->block[y][x].view == e->view))
        return;
    l->block[y][x].x = b.x + 1, l->block[y][x].y = b.y + 1, l->block[y][x].view = 0;
    for (int finer = 0; finer < 3; finer++) {
        float error = 0;
        if (b.level + finer <= e->ground.data) {
            const tc_range r =
                e->ground.range(e->ground.context, b.chart, b.level + finer, samples_of(e->ground.lattice, b, finer));
            error = r.error;
            if (finer == 0)
                l->block[y][x].lo = r.lo, l->block[y][x].hi = r.hi;
        }
        if (!isfinite(error)) {
            l->block[y][x].view = e->view;
            error = finer > 0 ? l->block[y][x].error[finer - 1] : coarser_error(e, b);
        }
        l->block[y][x].error[finer] = error;
    }
}

/* What blocks around have at most, and at least. */
typedef struct around {
    float error[3], lo, hi;
} around;

static void add_block(tc_block_errors *e, tc_block b, around *a)
{
    look_up(e, b);
    const tc_level_errors *l = &e->level[b.chart][b.level - 1];
    const int32_t x = b.x & MASK, y = b.y & MASK;
    for (int k = 0; k < 3; k++)
        a->error[k] = l->block[y][x].error[k] > a->error[k] ? l->block[y][x].error[k] : a->error[k];
    a->lo = l->block[y][x].lo < a->lo ? l->block[y][x].lo : a->lo;
    a->hi = l->block[y][x].hi > a->hi ? l->block[y][x].hi : a->hi;
}

/* Blocks that touch a corner; and those that touch them. */
static around touching(tc_block_errors *e, int chart, int level, int32_t x, int32_t y)
{
    around a = {{0, 0, 0}, INFINITY, -INFINITY};
    tc_block all[TC_BLOCKS_TOUCHING];
    for (int k = tc_block_touching(e->ground.lattice, chart, level, x, y, all) - 1; k >= 0; k--)
        add_block(e, all[k], &a);
    return a;
}

static around further(tc_block_errors *e, int chart, int level, int32_t x, int32_t y)
{
    around a = {{0, 0, 0}, INFINITY, -INFINITY};
    const int32_t *blocks = e->ground.lattice->blocks[level - 1];
    if (x >= 2 && y >= 2 && x + 2 <= blocks[0] && y + 2 <= blocks[1]) {
        for (int32_t j = y - 2; j < y + 2; j++)
            for (int32_t i = x - 2; i < x + 2; i++)
                add_block(e, (tc_block){chart, level, i, j}, &a);
        return a;
    }
    tc_block all[TC_BLOCKS_TOUCHING], more[TC_BLOCKS_TOUCHING];
    for (int k = tc_block_touching(e->ground.lattice, chart, level, x, y, all) - 1; k >= 0; k--)
        for (int corner = 0; corner < 4; corner++) {
            const tc_block b = all[k];
            for (int i = tc_block_touching(e->ground.lattice, b.chart, level, b.x + (corner & 1), b.y + (corner >> 1),
                                           more) -
                         1;
                 i >= 0; i--)
                add_block(e, more[i], &a);
        }
    return a;
}

/* ---- Corners ---------------------------------------------------------------------------------------------------- */

/* A distance for corners that interpolated over a block of such a diagonal is nowhere more than the distance itself:
 * that is convex, so that it would be by up to diagonal^2 / (8 d), and below the eye by more. */
static double least_distance(double across, double apart, double diagonal)
{
    const double flat = across > diagonal ? across - diagonal * diagonal / across : 0;
    return sqrt(flat * flat + apart * apart);
}

/* The same of a place, counted in blocks, where heights are within lo .. hi. */
static double distance_at(const tc_block_errors *e, int chart, int level, double x, double y, float lo, float hi,
                          double diagonal)
{
    const tc_block_ground *g = &e->ground;
    const int side = g->lattice->side[level - 1];
    const int64_t *cells = g->lattice->cells[level - 1];
    double across, apart;
    g->distance(g->context, chart, level, fmin(x * side, (double)cells[0]), fmin(y * side, (double)cells[1]),
                (double)lo, (double)hi, &across, &apart);
    return least_distance(across, apart, diagonal);
}

static double corner_alpha(tc_block_errors *e, int chart, int level, int32_t x, int32_t y)
{
    enum { COARSER, OWN, FINER };
    const tc_block_ground *g = &e->ground;
    const around wide = further(e, chart, level, x, y);
    if (wide.error[COARSER] <= 0)
        return 1;
    const around near = touching(e, chart, level, x, y);
    const double diagonal = g->diagonal[level - 1], m = e->tolerance * diagonal;
    const int levels = g->lattice->levels;
    double start = level < g->data ? (double)near.error[OWN] : 0, end = (double)near.error[COARSER];
    if (level < levels && wide.error[OWN] > 0) {
        /* e_(l+1) of all corners around. */
        double finer = fmax((double)wide.error[OWN], 0.5 * WIDTH * m);
        if (level + 1 < levels && wide.error[FINER] > 0)
            finer = fmax(finer, 1.25 * (double)wide.error[FINER] + (1 + 0.5 * WIDTH) * m +
                                    fmax(0.5 * WIDTH * m, SHARE * (double)wide.error[OWN]));
        start = finer + m;
        end = fmax(end, start + fmax(WIDTH * m, SHARE * end));
    } else
        end = fmax(end, start + SHARE * end);
    if (!isfinite(end))
        return 0;
    const double allowed = e->tolerance * distance_at(e, chart, level, x, y, near.lo, near.hi, diagonal);
    return allowed >= end ? 1 : fmax((allowed - start) / (end - start), 0);
}

double tc_block_errors_alpha(tc_block_errors *e, int chart, int level, int32_t x, int32_t y)
{
    tc_block_settle(e->ground.lattice, level, &chart, &x, &y); /* the same number, however it is rounded */
    tc_level_errors *l = &e->level[chart][level - 1];
    const int32_t i = x & MASK, j = y & MASK;
    if (l->corner[j][i].view != e->view || l->corner[j][i].x != x + 1 || l->corner[j][i].y != y + 1) {
        l->corner[j][i].alpha = (float)corner_alpha(e, chart, level, x, y);
        l->corner[j][i].view = e->view, l->corner[j][i].x = x + 1, l->corner[j][i].y = y + 1;
    }
    return (double)l->corner[j][i].alpha;
}

bool tc_block_errors_want(tc_block_errors *e, tc_block b)
{
    for (int k = 0; k < 4; k++)
        if (tc_block_errors_alpha(e, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1)) < 1)
            return true;
    return false;
}

/* Whether a leaf is drawn as its errors ask for, not coarser: for the sake of windows, or since something is missing.
 */
static bool as_asked(tc_block_errors *e, const tc_leaf *leaf, const float alpha[4])
{
    const tc_block b = leaf->block;
    const tc_block_lattice *l = e->ground.lattice;
    if (leaf->coarse)
        return !tc_block_errors_want(e, b);
    for (int k = 0; k < 4 && b.level > 1; k++)
        if ((double)alpha[k] > tc_block_errors_alpha(e, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1)))
            return false;
    if (b.level == l->levels)
        return e->ground.data == l->levels; /* else there were finer ones */
    const int across = tc_block_parts(l, b.level);
    for (int k = 0; k < across * across; k++) {
        const tc_block part = {b.chart, b.level + 1, b.x * across + k % across, b.y * across + k / across};
        if (part.x < l->blocks[b.level][0] && part.y < l->blocks[b.level][1] && tc_block_errors_want(e, part))
            return false;
    }
    return true;
}

double tc_block_errors_bound(tc_block_errors *e, const tc_leaf *leaf, const float alpha[4])
{
    const tc_block b = leaf->block;
    around a = {{0, 0, 0}, INFINITY, -INFINITY};
    add_block(e, b, &a);
    const double own = (double)a.error[leaf->coarse ? 0 : 1], coarser = (double)a.error[0];
    double most = 0;
    /* At its corners and between them, as its parts would be asked. */
    for (int k = 0; k < 9; k++) {
        const double x = 0.5 * (k % 3), y = 0.5 * (int)(k / 3), share = tc_block_alpha_at(alpha, x, y),
                     off = share <= 0          ? own
                           : isfinite(coarser) ? own + share * (coarser - own)
                                               : INFINITY;
        if (off > 0)
            most = fmax(most, off / distance_at(e, b.chart, b.level, b.x + x, b.y + y, a.lo, a.hi,
                                                0.5 * e->ground.diagonal[b.level - 1]));
    }
    return most > e->tolerance && as_asked(e, leaf, alpha) ? e->tolerance : most;
}
