/* blocks.c - the tree of blocks: made coarse to fine, so that what a split needs of its neighbours is settled before.
 */
#include "blocks.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"

/* A block's state. In the high half: which of its children are wanted. */
enum { THERE = 1, OWN = 2, SPLIT = 4, FORCED = 8, CHILD = 16 };

bool tc_block_lattice_set(tc_block_lattice *l, const tc_chart *chart, int charts, int64_t cells, int64_t finest,
                          int levels, int most)
{
    *l = (tc_block_lattice){.charts = charts, .levels = levels};
    if (charts > TC_BLOCK_CHARTS || levels < 1 || levels > TC_BLOCK_LEVELS || finest < 2)
        return false;
    int64_t coarsest = finest >> (levels - 1);
    if (coarsest << (levels - 1) != finest || coarsest % 2 != 0)
        return false;
    int first = 2;
    while (2 * first <= most && coarsest % (2 * first) == 0)
        first *= 2;
    if (coarsest / first > TC_BLOCKS_ACROSS)
        return false;
    for (int k = 0; k < levels; k++) {
        l->side[k] = k == 0 ? first : 2 * l->side[k - 1] < most ? 2 * l->side[k - 1] : most;
        for (int axis = 0; axis < 2; axis++)
            l->cells[k][axis] = coarsest << k, l->blocks[k][axis] = (int32_t)((coarsest << k) / l->side[k]);
    }
    for (int c = 0; c < charts; c++)
        for (int side = 0; side < TC_SIDES; side++) {
            l->seam[c][side] = chart[c].side[side];
            l->seam[c][side].dx /= cells, l->seam[c][side].dy /= cells;
        }
    return true;
}

bool tc_block_lattice_cut(tc_block_lattice *l, int levels, const int64_t (*cells)[2], int side)
{
    *l = (tc_block_lattice){.charts = 1, .levels = levels};
    for (int s = 0; s < TC_SIDES; s++)
        l->seam[0][s].chart = -1;
    if (levels < 1 || levels > TC_BLOCK_LEVELS)
        return false;
    for (int k = 0; k < levels; k++) {
        l->side[k] = side;
        for (int axis = 0; axis < 2; axis++) {
            if (cells[k][axis] / side >= INT32_MAX / 2)
                return false;
            l->cells[k][axis] = cells[k][axis];
            l->blocks[k][axis] = (int32_t)((cells[k][axis] + side - 1) / side);
        }
    }
    return l->blocks[0][0] <= TC_BLOCKS_ACROSS && l->blocks[0][1] <= TC_BLOCKS_ACROSS;
}

static bool exists(const tc_block_lattice *l, tc_block b)
{
    return b.x >= 0 && b.y >= 0 && b.x < l->blocks[b.level - 1][0] && b.y < l->blocks[b.level - 1][1];
}

static uint8_t *state_of(tc_block_tree *t, tc_block b)
{
    int32_t x = b.x - t->level[b.chart][b.level - 1].x0, y = b.y - t->level[b.chart][b.level - 1].y0;
    if (!t->level[b.chart][b.level - 1].room || x < 0 || y < 0 || x >= TC_BLOCKS_ACROSS || y >= TC_BLOCKS_ACROSS)
        return NULL;
    return &t->level[b.chart][b.level - 1].state[y][x];
}

static int state(const tc_block_tree *t, tc_block b)
{
    const uint8_t *s = state_of((tc_block_tree *)t, b);
    return s ? *s : 0;
}

/* ---- Neighbours ------------------------------------------------------------------------------------------------- */

/* A corner of blocks of a level, counted in blocks from its chart's first. */
typedef struct corner {
    int chart;
    int32_t x, y;
} corner;

enum { MOST_ALIASES = 8 };

static corner beyond(const tc_block_lattice *l, int level, const tc_seam *seam, corner c)
{
    const int32_t b = l->blocks[level - 1][0];
    return (corner){seam->chart, seam->m[0] * c.x + seam->m[1] * c.y + (int32_t)seam->dx * b,
                    seam->m[2] * c.x + seam->m[3] * c.y + (int32_t)seam->dy * b};
}

/* The same corner as all charts have it; returns how many. */
static int aliases(const tc_block_lattice *l, int level, corner c, corner all[MOST_ALIASES])
{
    int count = 0;
    all[count++] = c;
    for (int k = 0; k < count; k++) {
        const int32_t *last = l->blocks[level - 1];
        const bool on[TC_SIDES] = {[TC_WEST] = all[k].x == 0,
                                   [TC_EAST] = all[k].x == last[0],
                                   [TC_SOUTH] = all[k].y == 0,
                                   [TC_NORTH] = all[k].y == last[1]};
        for (int side = 0; side < TC_SIDES; side++) {
            const tc_seam *seam = &l->seam[all[k].chart][side];
            if (!on[side] || seam->chart < 0)
                continue;
            corner other = beyond(l, level, seam, all[k]);
            bool known = false;
            for (int i = 0; i < count && !known; i++)
                known = all[i].chart == other.chart && all[i].x == other.x && all[i].y == other.y;
            if (!known && count < MOST_ALIASES)
                all[count++] = other;
        }
    }
    return count;
}

/* Blocks that touch a corner. */
static int touching(const tc_block_lattice *l, int level, corner c, tc_block all[TC_BLOCKS_TOUCHING])
{
    corner as[MOST_ALIASES];
    const int32_t *last = l->blocks[level - 1];
    const bool inside = c.x > 0 && c.y > 0 && c.x < last[0] && c.y < last[1];
    int count = 0, charts = inside ? 1 : aliases(l, level, c, as);
    if (inside)
        as[0] = c;
    for (int k = 0; k < charts; k++)
        for (int i = 0; i < 4; i++) {
            const tc_block b = {as[k].chart, level, as[k].x - (i & 1), as[k].y - (i >> 1)};
            if (exists(l, b) && count < TC_BLOCKS_TOUCHING)
                all[count++] = b;
        }
    return count;
}

int tc_block_touching(const tc_block_lattice *l, int chart, int level, int32_t x, int32_t y,
                      tc_block all[TC_BLOCKS_TOUCHING])
{
    return touching(l, level, (corner){chart, x, y}, all);
}

void tc_block_settle(const tc_block_lattice *l, int level, int *chart, int32_t *x, int32_t *y)
{
    corner all[MOST_ALIASES];
    const int32_t *last = l->blocks[level - 1];
    if (*x > 0 && *y > 0 && *x < last[0] && *y < last[1])
        return;
    for (int k = aliases(l, level, (corner){*chart, *x, *y}, all) - 1; k >= 0; k--)
        if (all[k].chart < *chart)
            *chart = all[k].chart, *x = all[k].x, *y = all[k].y;
}

/* The block beyond a side; false: the map ends there. */
static bool across(const tc_block_lattice *l, tc_block b, int side, tc_block *other)
{
    const int step[TC_SIDES][2] = {[TC_WEST] = {-1, 0}, [TC_EAST] = {1, 0}, [TC_SOUTH] = {0, -1}, [TC_NORTH] = {0, 1}};
    *other = (tc_block){b.chart, b.level, b.x + step[side][0], b.y + step[side][1]};
    if (exists(l, *other))
        return true;
    const int32_t last = l->blocks[b.level - 1][0];
    const tc_seam *seam = &l->seam[b.chart][side];
    if (seam->chart < 0)
        return false;
    /* The edge's ends, as the other chart has them. */
    corner from = {b.chart, b.x + (side == TC_EAST), b.y + (side == TC_NORTH)}, to = from;
    if (side == TC_WEST || side == TC_EAST)
        to.y++;
    else
        to.x++;
    from = beyond(l, b.level, seam, from), to = beyond(l, b.level, seam, to);
    *other = (tc_block){seam->chart, b.level, from.x < to.x ? from.x : to.x, from.y < to.y ? from.y : to.y};
    if (from.x == to.x && from.x == last)
        other->x--;
    if (from.y == to.y && from.y == last)
        other->y--;
    return true;
}

static corner corner_of(tc_block b, int k)
{
    return (corner){b.chart, b.x + (k & 1), b.y + (k >> 1)};
}

/* ---- The tree --------------------------------------------------------------------------------------------------- */

static void add(tc_block_tree *t, tc_block b, int as)
{
    *state_of(t, b) |= (uint8_t)as;
    int32_t *lo = t->level[b.chart][b.level - 1].lo, *hi = t->level[b.chart][b.level - 1].hi;
    lo[0] = b.x < lo[0] ? b.x : lo[0], hi[0] = b.x >= hi[0] ? b.x + 1 : hi[0];
    lo[1] = b.y < lo[1] ? b.y : lo[1], hi[1] = b.y >= hi[1] ? b.y + 1 : hi[1];
}

static tc_block child_of(tc_block b, int k, int across_it)
{
    return (tc_block){b.chart, b.level + 1, b.x * across_it + (k & 1), b.y * across_it + (k >> 1)};
}

static bool has_child(const tc_block_lattice *l, tc_block b, int k, int across_it)
{
    return (k & 1) < across_it && k >> 1 < across_it && exists(l, child_of(b, k, across_it));
}

/* Goes through the blocks of a level and chart that are there. */
#define FOR_EACH_BLOCK(t, c, l, b)                                                                                     \
    for (tc_block b = {c, l, 0, (t)->level[c][l - 1].lo[1]}; b.y < (t)->level[c][l - 1].hi[1]; b.y++)                  \
        for (b.x = (t)->level[c][l - 1].lo[0]; b.x < (t)->level[c][l - 1].hi[0]; b.x++)                                \
            if (state(t, b) & THERE)

static void make_room(tc_block_tree *t, int chart, int level, int32_t x0, int32_t y0)
{
    t->level[chart][level - 1].room = true;
    t->level[chart][level - 1].x0 = x0, t->level[chart][level - 1].y0 = y0;
    memset(t->level[chart][level - 1].state, 0, sizeof t->level[chart][level - 1].state);
}

/* Which children are wanted; room for all of them, as far as there may be. */
static void ask(tc_block_tree *t, int chart, int level, const tc_block_rule *rule)
{
    const int n = tc_block_parts(t->lattice, level);
    int32_t lo[2] = {INT32_MAX, INT32_MAX}, hi[2] = {INT32_MIN, INT32_MIN};
    FOR_EACH_BLOCK(t, chart, level, b)
    {
        if (!(state(t, b) & OWN))
            continue;
        for (int k = 0; k < 4; k++)
            if (has_child(t->lattice, b, k, n) && rule->wanted(rule->context, child_of(b, k, n))) {
                *state_of(t, b) |= (uint8_t)(CHILD << k);
                lo[0] = b.x < lo[0] ? b.x : lo[0], hi[0] = b.x > hi[0] ? b.x : hi[0];
                lo[1] = b.y < lo[1] ? b.y : lo[1], hi[1] = b.y > hi[1] ? b.y : hi[1];
            }
    }
    if (lo[0] > hi[0])
        return;
    /* In the middle of what is wanted, should it be more. */
    int32_t first[2];
    for (int a = 0; a < 2; a++) {
        int32_t many = (hi[a] - lo[a] + 1) * n;
        first[a] = lo[a] * n + (many > TC_BLOCKS_ACROSS ? (many - TC_BLOCKS_ACROSS) / 2 / n * n : 0);
    }
    make_room(t, chart, level + 1, first[0], first[1]);
}

/* Whether the blocks that touch it allow a split: they are there, and drawn by their own level or could be. */
static bool closed_around(const tc_block_tree *t, tc_block b, const tc_block_rule *rule)
{
    for (int k = 0; k < 4; k++) {
        tc_block near[TC_BLOCKS_TOUCHING];
        for (int i = touching(t->lattice, b.level, corner_of(b, k), near) - 1; i >= 0; i--) {
            int s = state(t, near[i]);
            if (!(s & THERE) || (!(s & OWN) && !rule->held(rule->context, near[i])))
                return false;
        }
    }
    return true;
}

static bool children_held(tc_block_tree *t, tc_block b, const tc_block_rule *rule)
{
    const int n = tc_block_parts(t->lattice, b.level);
    for (int k = 0; k < 4; k++) {
        tc_block child = child_of(b, k, n);
        if (!has_child(t->lattice, b, k, n))
            continue;
        if (!state_of(t, child) || ((state(t, b) & CHILD << k) && !rule->held(rule->context, child)))
            return false;
    }
    return true;
}

static void split(tc_block_tree *t, tc_block b)
{
    const int n = tc_block_parts(t->lattice, b.level);
    *state_of(t, b) |= SPLIT;
    for (int k = 0; k < 4; k++)
        if (has_child(t->lattice, b, k, n))
            add(t, child_of(b, k, n), state(t, b) & CHILD << k ? THERE | OWN : THERE);
    for (int k = 0; k < 4; k++) {
        tc_block near[TC_BLOCKS_TOUCHING];
        for (int i = touching(t->lattice, b.level, corner_of(b, k), near) - 1; i >= 0; i--)
            *state_of(t, near[i]) |= OWN;
    }
}

void tc_block_tree_make(tc_block_tree *t, const tc_block_lattice *l, const tc_block_rule *rule)
{
    t->lattice = l;
    for (int c = 0; c < l->charts; c++)
        for (int k = 0; k < l->levels; k++) {
            t->level[c][k].room = false;
            t->level[c][k].lo[0] = t->level[c][k].lo[1] = INT32_MAX;
            t->level[c][k].hi[0] = t->level[c][k].hi[1] = INT32_MIN;
        }
    for (int c = 0; c < l->charts; c++)
        make_room(t, c, 1, 0, 0);
    for (int c = 0; c < l->charts; c++)
        for (int32_t y = 0; y < l->blocks[0][1]; y++)
            for (int32_t x = 0; x < l->blocks[0][0]; x++)
                add(t, (tc_block){c, 1, x, y}, THERE | OWN);
    for (int level = 1; level < l->levels; level++) {
        for (int c = 0; c < l->charts; c++)
            ask(t, c, level, rule);
        for (int c = 0; c < l->charts; c++)
            FOR_EACH_BLOCK(t, c, level, b)
            {
                if (state(t, b) < CHILD)
                    continue;
                if (children_held(t, b, rule) && closed_around(t, b, rule))
                    split(t, b);
                else
                    *state_of(t, b) |= FORCED;
            }
    }
}

bool tc_block_asked(const tc_block_tree *t, tc_block b)
{
    const int n = tc_block_parts(t->lattice, b.level - 1);
    const tc_block parent = {b.chart, b.level - 1, b.x / n, b.y / n};
    return state(t, parent) & CHILD << ((b.x - parent.x * n) + 2 * (b.y - parent.y * n));
}

/* ---- Leaves ----------------------------------------------------------------------------------------------------- */

/* Whether a block that is not there is not, because what is in its place could not be split. */
static bool missed(const tc_block_tree *t, tc_block b)
{
    const int n = tc_block_parts(t->lattice, b.level - 1);
    return state(t, (tc_block){b.chart, b.level - 1, b.x / n, b.y / n}) & FORCED;
}

/* Corners at the ends of a side. */
static const int ends[TC_SIDES][2] = {[TC_WEST] = {0, 2}, [TC_EAST] = {1, 3}, [TC_SOUTH] = {0, 1}, [TC_NORTH] = {2, 3}};

/* The child of a split block that touches a corner, which is one of the block's. */
static tc_block child_at(const tc_block_lattice *l, tc_block b, corner at)
{
    corner all[MOST_ALIASES];
    const int n = tc_block_parts(l, b.level);
    for (int i = aliases(l, b.level, at, all) - 1; i >= 0; i--)
        for (int k = 0; k < 4 && all[i].chart == b.chart; k++) {
            const corner own = corner_of(b, k);
            if (own.x == all[i].x && own.y == all[i].y)
                return child_of(b, n == 1 ? 0 : k, n);
        }
    return b;
}

/* Whether a block is drawn, at a corner of its own, by a finer mesh than its level's. */
static bool finer_at(const tc_block_tree *t, tc_block b, corner at)
{
    return state(t, b) & SPLIT && state(t, child_at(t->lattice, b, at)) & OWN;
}

static void meet_coarser(const tc_block_tree *t, tc_leaf *leaf)
{
    const tc_block b = leaf->block;
    for (int k = 0; k < 4; k++) {
        tc_block near[TC_BLOCKS_TOUCHING];
        for (int i = touching(t->lattice, b.level, corner_of(b, k), near) - 1; i >= 0; i--) {
            int s = state(t, near[i]);
            if (!(s & OWN))
                leaf->corners |= (uint8_t)(1 << k);
            if (!(s & THERE) && missed(t, near[i]))
                leaf->forced |= (uint8_t)(1 << k);
        }
    }
    for (int side = 0; side < TC_SIDES && leaf->corners; side++) {
        tc_block other;
        if (across(t->lattice, b, side, &other) && !(state(t, other) & OWN))
            leaf->sides |= (uint8_t)(1 << side);
    }
}

/* Of a leaf drawn by the coarser mesh its own neighbours are finer, of another one the children of split ones. */
static void meet_finer(const tc_block_tree *t, tc_leaf *leaf)
{
    const tc_block b = leaf->block;
    for (int k = 0; k < 4; k++) {
        tc_block near[TC_BLOCKS_TOUCHING];
        const corner at = corner_of(b, k);
        for (int i = touching(t->lattice, b.level, at, near) - 1; i >= 0; i--)
            if (leaf->coarse ? state(t, near[i]) & OWN : finer_at(t, near[i], at))
                leaf->finer_corners |= (uint8_t)(1 << k);
    }
    for (int side = 0; side < TC_SIDES && leaf->finer_corners; side++) {
        tc_block other;
        if (!across(t->lattice, b, side, &other))
            continue;
        for (int half = 0; half < 2; half++)
            if (leaf->coarse ? state(t, other) & OWN : finer_at(t, other, corner_of(b, ends[side][half])))
                leaf->finer_halves |= (uint8_t)(1 << (2 * side + half));
    }
}

static tc_leaf leaf_of(const tc_block_tree *t, tc_block b)
{
    tc_leaf leaf = {.block = b, .coarse = !(state(t, b) & OWN)};
    if (!leaf.coarse && b.level > 1)
        meet_coarser(t, &leaf);
    meet_finer(t, &leaf);
    return leaf;
}

int tc_leaf_alpha(const tc_leaf *leaf, int64_t i, int64_t j, int64_t cells)
{
    const bool on[TC_SIDES] = {
        [TC_WEST] = i == 0, [TC_EAST] = i == cells, [TC_SOUTH] = j == 0, [TC_NORTH] = j == cells};
    if ((on[TC_WEST] || on[TC_EAST]) && (on[TC_SOUTH] || on[TC_NORTH])) {
        const int k = 1 << (on[TC_EAST] + 2 * on[TC_NORTH]);
        return leaf->corners & k ? 1 : leaf->finer_corners & k ? 0 : -1;
    }
    for (int side = 0; side < TC_SIDES; side++) {
        const int64_t along = 2 * (side == TC_WEST || side == TC_EAST ? j : i);
        const int halves = (along <= cells) | (along >= cells) << 1;
        if (on[side] && leaf->sides & 1 << side)
            return 1;
        if (on[side] && leaf->finer_halves >> 2 * side & halves)
            return 0;
    }
    return -1;
}

void tc_block_leaves(const tc_block_tree *t, void (*leaf)(void *context, const tc_leaf *leaf), void *context)
{
    for (int level = t->lattice->levels; level >= 1; level--)
        for (int c = 0; c < t->lattice->charts; c++)
            FOR_EACH_BLOCK(t, c, level, b)
            {
                if (state(t, b) & SPLIT)
                    continue;
                const tc_leaf one = leaf_of(t, b);
                leaf(context, &one);
            }
}

tc_leaf tc_block_leaf_at(const tc_block_tree *t, int chart, double x, double y)
{
    const tc_block_lattice *l = t->lattice;
    tc_block b = {chart, 0, 0, 0};
    do {
        b.level++;
        const double block = ldexp(l->side[b.level - 1], l->levels - b.level); /* finest cells */
        b.x = (int32_t)tc_clamp64((int64_t)(x / block), 0, l->blocks[b.level - 1][0] - 1);
        b.y = (int32_t)tc_clamp64((int64_t)(y / block), 0, l->blocks[b.level - 1][1] - 1);
    } while (state(t, b) & SPLIT);
    return leaf_of(t, b);
}

tc_leaf tc_block_leaf_above(const tc_block_lattice *l, const tc_leaf *leaf)
{
    const tc_block b = leaf->block;
    const int n = tc_block_parts(l, b.level - 1);
    return (tc_leaf){.block = {b.chart, b.level - 1, b.x / n, b.y / n}};
}

bool tc_block_bounds(const tc_block_tree *t, int chart, int level, tc_rect *blocks_ret)
{
    tc_rect r = {INT64_MAX, INT64_MAX, INT64_MIN, INT64_MIN};
    FOR_EACH_BLOCK(t, chart, level, b)
    {
        if (!(state(t, b) & OWN))
            continue;
        r.x0 = tc_min64(r.x0, b.x), r.x1 = tc_max64(r.x1, b.x + 1);
        r.y0 = tc_min64(r.y0, b.y), r.y1 = tc_max64(r.y1, b.y + 1);
    }
    *blocks_ret = r.x0 < r.x1 ? r : (tc_rect){0, 0, 0, 0};
    return r.x0 < r.x1;
}
