/* synthesis_chain.c - heights of a synthesised level by way of the levels below it.
 *
 * A rectangle comes from the coarser level around half of it, and so on down to the data: a ladder of ever smaller
 * rectangles. What of levels between was made lately is kept in blocks: so each window of a view costs what its own
 * level does, whatever lies below. Heights are the same with or without. */
#include "synthesis_chain.h"

#include <assert.h>

#include "common/base/rect.h"
#include "synthesis_noise.h"

enum { SIDE = TC_KEPT_SIDE };

tc_rect tc_chain_within(const tc_chain *c, int k, tc_rect rect)
{
    tc_level size = c->levels[c->data + k - 1];
    tc_rect all = {0, 0, size.width, size.height};
    if (c->wraps)
        all.x0 = rect.x0, all.x1 = rect.x1;
    return tc_rect_intersect(rect, all);
}

/* ---- Blocks ------------------------------------------------------------------------------------------------------ */

/* Blocks' numbers. */
static tc_rect blocks_of(tc_rect rect)
{
    return (tc_rect){tc_floor_shift(rect.x0, TC_KEPT_SIDE_LOG2), tc_floor_shift(rect.y0, TC_KEPT_SIDE_LOG2),
                     tc_ceil_shift(rect.x1, TC_KEPT_SIDE_LOG2), tc_ceil_shift(rect.y1, TC_KEPT_SIDE_LOG2)};
}

/* The samples of blocks. */
static tc_rect samples_of(const tc_chain *c, int k, tc_rect blocks)
{
    if (tc_rect_empty(blocks))
        return (tc_rect){0, 0, 0, 0};
    return tc_chain_within(c, k, (tc_rect){blocks.x0 * SIDE, blocks.y0 * SIDE, blocks.x1 * SIDE, blocks.y1 * SIDE});
}

/* False where there are too many to be told apart. */
static bool key_of(int k, int64_t x, int64_t y, uint64_t *key_ret)
{
    const int bits = 28;
    const int64_t half = (int64_t)1 << (bits - 1);
    *key_ret = (uint64_t)k << 2 * bits | (uint64_t)(y + half) << bits | (uint64_t)(x + half);
    return x >= -half && x < half && y >= -half && y < half;
}

/* Copies what is kept of a level's rectangle; the smallest rectangle of blocks around what is not. */
static tc_rect find_blocks(const tc_chain *c, int k, tc_rect rect, const tc_patch *patch)
{
    tc_rect all = blocks_of(rect), missing = {0, 0, 0, 0};
    for (int64_t y = all.y0; y < all.y1; y++)
        for (int64_t x = all.x0; x < all.x1; x++) {
            tc_rect one = {x, y, x + 1, y + 1}, part = tc_rect_intersect(samples_of(c, k, one), patch->rect);
            tc_rect within = {part.x0 - x * SIDE, part.y0 - y * SIDE, part.x1 - x * SIDE, part.y1 - y * SIDE};
            uint64_t key;
            if (!c->kept || !key_of(k, x, y, &key) ||
                !tc_kept_find(c->kept, key, within, tc_patch_at(patch, part.x0, part.y0), patch->stride))
                missing = tc_rect_around(missing, one);
        }
    return missing;
}

static void keep_blocks(const tc_chain *c, int k, tc_rect blocks, const tc_patch *patch)
{
    for (int64_t y = blocks.y0; y < blocks.y1; y++)
        for (int64_t x = blocks.x0; x < blocks.x1; x++) {
            tc_rect samples = samples_of(c, k, (tc_rect){x, y, x + 1, y + 1});
            uint64_t key;
            if (key_of(k, x, y, &key))
                tc_kept_add(c->kept, key, samples.x1 - samples.x0, samples.y1 - samples.y0,
                            tc_patch_at(patch, samples.x0, samples.y0), patch->stride);
        }
}

/* ---- What a rectangle takes -------------------------------------------------------------------------------------- */

/* What of a level between is needed. */
typedef struct rung {
    tc_rect around; /* also beyond the level's sides */
    tc_rect made;   /* what must be made */
    tc_patch patch; /* of both */
} rung;

typedef struct ladder {
    int lowest; /* the first level that is needed is m + lowest */
    rung rung[TC_SYNTHESIS_MOST];
    bool keeps;        /* what is made is made in blocks, and kept */
    tc_rect amplitude; /* of level m: where A is needed, */
    tc_rect base;      /* and heights */
    float *scratch;    /* what is left of it */
    size_t floats;     /* that are taken */
} ladder;

/* What a ladder is for: to know all that heights of a rectangle depend on; what making them takes where nothing of it
 * is kept; to make them. */
typedef enum purpose { DEPENDS, MOST, MAKE } purpose;

/* What of the level below that of made depends on. */
static void step_down(int k, tc_rect made, ladder *l)
{
    const int64_t next = k > 1; /* interpolated */
    tc_rect cells = tc_synthesis_needs(made, TC_AMPLITUDE_REACH);
    tc_rect at = {tc_floor_shift(cells.x0, k - 1), tc_floor_shift(cells.y0, k - 1),
                  tc_floor_shift(cells.x1 - 1, k - 1) + 1 + next, tc_floor_shift(cells.y1 - 1, k - 1) + 1 + next};
    l->amplitude = tc_rect_around(l->amplitude, at);
    l->rung[k - 1].around = tc_synthesis_needs(made, TC_COARSE_REACH);
}

/* What rung k takes: all that is needed of its level is made, in whole blocks where these are kept. */
static void take_rung(const tc_chain *c, int k, ladder *l)
{
    rung *r = &l->rung[k];
    tc_rect have = tc_chain_within(c, k, r->around);
    r->made = l->keeps ? samples_of(c, k, blocks_of(have)) : have;
    r->patch.rect = tc_rect_around(r->around, r->made);
    r->patch.stride = r->patch.rect.x1 - r->patch.rect.x0;
    l->floats += (size_t)tc_rect_area(r->patch.rect);
}

/* Gives it its place in scratch and copies what is kept there: only the rest is made then. False where there is none,
 * so that nothing is needed of the levels below. */
static bool place_rung(const tc_chain *c, int k, ladder *l)
{
    rung *r = &l->rung[k];
    r->patch.z = l->scratch, l->scratch += tc_rect_area(r->patch.rect);
    tc_rect missing = find_blocks(c, k, tc_chain_within(c, k, r->around), &r->patch);
    if (l->keeps)
        r->made = samples_of(c, k, missing);
    return !tc_rect_empty(missing);
}

/* From level m + count down as far as is needed: to the data, unless all that a level between must give is kept. */
static void descend(const tc_chain *c, int count, tc_rect rect, purpose what_for, ladder *l)
{
    const int64_t few = SIDE * SIDE; /* of single places less is made, since others may be far away */
    l->keeps = what_for != DEPENDS && c->kept && tc_rect_area(rect) >= few;
    step_down(count, rect, l);
    for (l->lowest = count - 1; l->lowest > 0; l->lowest--) {
        take_rung(c, l->lowest, l);
        if (what_for == MAKE && !place_rung(c, l->lowest, l))
            break;
        step_down(l->lowest, l->rung[l->lowest].made, l);
    }
    l->base = l->lowest > 0 ? (tc_rect){0, 0, 0, 0} : l->rung[0].around;
    if (!c->fit.none)
        l->base = tc_rect_around(l->base, tc_rect_grown(l->amplitude, TC_ENERGY_REACH));
    l->floats += (size_t)(tc_rect_area(l->base) + 4 * tc_rect_area(l->amplitude)) + tc_synthesis_scratch();
}

tc_rect tc_chain_depends(const tc_chain *c, int k, tc_rect rect)
{
    ladder l = {0};
    descend(c, k, rect, DEPENDS, &l);
    return l.base;
}

tc_rect tc_chain_reads(const tc_chain *c, int k, tc_rect rect)
{
    ladder l = {0};
    descend(c, k, rect, MOST, &l);
    return l.base;
}

size_t tc_chain_scratch(const tc_chain *c, int k, tc_rect rect)
{
    ladder l = {0};
    descend(c, k, rect, MOST, &l);
    return l.floats;
}

/* The same of a rectangle that lies worst, without those that are cut by sides, or made without blocks: theirs are
 * smaller. Rectangles of level m that come from upper levels lie within those of the lowest one. */
size_t tc_chain_room(int levels, int64_t side)
{
    _Static_assert(TC_COARSE_REACH <= SIDE / 2, "where what is needed for blocks begins");
    const int64_t reach = tc_max64(TC_COARSE_REACH, TC_AMPLITUDE_REACH + TC_ENERGY_REACH);
    size_t most = 0;
    for (int count = 1; count <= levels; count++) {
        /* Anything begins at any sample, of any block, */
        int64_t cells = side / 2 + 1, first = SIDE - 1, floats = 0;
        for (int k = count - 1; k > 0; k--) {
            int64_t made = (first + cells + 2 * TC_COARSE_REACH + SIDE - 1) / SIDE * SIDE;
            floats += made * made;
            /* and blocks at even ones: their cells where blocks of the coarser level do or half way between. */
            cells = made / 2, first = SIDE - TC_COARSE_REACH;
        }
        const int64_t base = cells + 2 * reach, amplitude = cells + 2 * TC_AMPLITUDE_REACH;
        floats += base * base + 4 * amplitude * amplitude;
        most = (size_t)tc_max64((int64_t)most, floats);
    }
    return most + tc_synthesis_scratch();
}

/* ---- Making it --------------------------------------------------------------------------------------------------- */

tc_ready tc_chain_read(const tc_chain *c, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride, bool wait,
                       tc_status *status_ret)
{
    if (!wait)
        return tc_field_read_ready(c->base, c->data, rect, z, voids, stride, TC_ONLY_ASK);
    *status_ret = tc_field_read(c->base, c->data, rect, z, voids, stride);
    return *status_ret ? TC_FAILED : TC_READY;
}

/* What amplitudes of all levels are made of, over a rectangle of level m. */
typedef struct grounds {
    float *energy, *slope, *share, *amplitude;
} grounds;

static grounds prepare_grounds(const tc_chain *c, const ladder *l, const tc_patch *base, float *scratch)
{
    tc_level size = c->levels[c->data - 1];
    int64_t area = tc_rect_area(l->amplitude);
    grounds g = {scratch, scratch + area, scratch + 2 * area, scratch + 3 * area};
    tc_rect a = l->amplitude;
    if (c->fit.none)
        return g;
    tc_local_energy(base, &c->fit, (float)size.spacing_x, (float)size.spacing_y, a, g.energy, g.slope,
                    scratch + 4 * area);
    for (int64_t i = 0; i < area && c->share.of; i++)
        g.share[i] =
            c->share.of(c->share.context, (double)(a.x0 + i % (a.x1 - a.x0)), (double)(a.y0 + i / (a.x1 - a.x0)));
    return g;
}

/* Level m + k from the coarser one. */
static void make_level(const tc_chain *c, const ladder *l, const grounds *g, int k, const tc_patch *coarse,
                       tc_rect rect, float *z, ptrdiff_t stride, float *scratch)
{
    tc_level size = c->levels[c->data + k - 2];
    int64_t area = tc_rect_area(l->amplitude);
    if (!c->fit.none)
        tc_amplitudes(&c->fit, k, g->energy, g->slope, area, g->amplitude);
    for (int64_t i = 0; i < area && c->share.of && !c->fit.none; i++)
        g->amplitude[i] *= g->share[i];
    tc_patch amplitude = {g->amplitude, l->amplitude.x1 - l->amplitude.x0, l->amplitude};
    const tc_level_recipe recipe = {.fit = &c->fit,
                                    .seed = tc_noise_seed(c->chart, k),
                                    .width = size.width,
                                    .height = size.height,
                                    .wraps = c->wraps,
                                    .spacing_x = (float)size.spacing_x,
                                    .spacing_y = (float)size.spacing_y,
                                    .lowest = c->lowest,
                                    .highest = c->highest,
                                    .amplitude = &amplitude,
                                    .shift = k - 1};
    tc_synthesis_level(&recipe, coarse, rect, z, stride, scratch);
}

tc_ready tc_chain_make(const tc_chain *c, int count, tc_rect rect, float *z, ptrdiff_t stride, bool wait,
                       float *scratch, tc_status *status_ret)
{
    ladder l = {.scratch = scratch};
    descend(c, count, rect, MAKE, &l);
    assert(l.floats <= c->room);
    tc_patch base = {l.scratch, l.base.x1 - l.base.x0, l.base};
    l.scratch += tc_rect_area(l.base);
    if (!tc_rect_empty(l.base)) {
        tc_level size = c->levels[c->data - 1];
        tc_rect have = tc_chain_within(c, 0, l.base);
        tc_ready how =
            tc_chain_read(c, have, tc_patch_at(&base, have.x0, have.y0), NULL, base.stride, wait, status_ret);
        if (how != TC_READY)
            return how;
        tc_extend_beyond(&base, size.width, size.height, c->wraps);
    }
    const grounds g = prepare_grounds(c, &l, &base, l.scratch);
    l.scratch += 4 * tc_rect_area(l.amplitude);
    for (int k = l.lowest + 1; k <= count; k++) {
        tc_patch coarse = base;
        if (k > 1) {
            const rung *below = &l.rung[k - 1];
            tc_level size = c->levels[c->data + k - 2];
            coarse = (tc_patch){tc_patch_at(&below->patch, below->around.x0, below->around.y0), below->patch.stride,
                                below->around};
            tc_extend_beyond(&coarse, size.width, size.height, c->wraps);
        }
        if (k == count) {
            make_level(c, &l, &g, k, &coarse, rect, z, stride, l.scratch);
        } else {
            const rung *r = &l.rung[k];
            make_level(c, &l, &g, k, &coarse, r->made, tc_patch_at(&r->patch, r->made.x0, r->made.y0), r->patch.stride,
                       l.scratch);
            if (l.keeps)
                keep_blocks(c, k, blocks_of(r->made), &r->patch);
        }
    }
    return TC_READY;
}
