/* synthesis_field.c - a field with more levels than the one that it decorates.
 *
 * Heights of a rectangle come from the coarser level around half of it, and so on down to the data's finest level: a
 * chain of ever smaller rectangles, which is made anew each time, since that costs less than keeping it. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "synthesis_level.h"
#include "synthesis_noise.h"

enum { BLOCK = 256 }; /* samples along a side of what is made at once */

/* Memory of one reading, kept for the next one; all are as large as any reading needs. */
typedef struct arena {
    struct arena *next;
    float memory[];
} arena;

typedef struct synthesis_field {
    tc_field head;
    tc_field *base;
    int data; /* levels of it: m */
    tc_synthesis_fit fit;
    int chart;
    tc_synthesis_share share;
    float lowest, highest;
    size_t arena_bytes;
    pthread_mutex_t mutex; /* of idle */
    arena *idle;
    _Atomic size_t held; /* bytes of arenas */
} synthesis_field;

static arena *borrow(synthesis_field *p)
{
    pthread_mutex_lock(&p->mutex);
    arena *a = p->idle;
    if (a)
        p->idle = a->next;
    pthread_mutex_unlock(&p->mutex);
    if (!a && (a = malloc(p->arena_bytes)))
        p->held += p->arena_bytes;
    return a;
}

static void give_back(synthesis_field *p, arena *a)
{
    pthread_mutex_lock(&p->mutex);
    a->next = p->idle, p->idle = a;
    pthread_mutex_unlock(&p->mutex);
}

/* ---- What a rectangle takes -------------------------------------------------------------------------------------- */

/* A rectangle of level m + count, and what of the levels below it depends on; [k] of level m + k. */
typedef struct chain {
    int count;
    tc_rect made[TC_SYNTHESIS_MOST + 1];   /* within the level */
    tc_rect around[TC_SYNTHESIS_MOST + 1]; /* with what is beyond its sides */
    tc_rect amplitude;                     /* of level m: where A is needed */
    size_t largest;                        /* samples of one of `around` */
} chain;

static tc_rect within(const synthesis_field *p, int level, tc_rect rect)
{
    tc_level size = p->head.level[level - 1];
    tc_rect all = {0, 0, size.width, size.height};
    if (p->head.info.wraps_x)
        all.x0 = rect.x0, all.x1 = rect.x1;
    return tc_rect_intersect(rect, all);
}

static chain chain_of(const synthesis_field *p, int level, tc_rect rect)
{
    chain c = {.count = level - p->data};
    c.made[c.count] = rect;
    for (int k = c.count; k >= 1; k--) {
        tc_rect cells = tc_synthesis_needs(c.made[k], TC_AMPLITUDE_REACH);
        tc_rect at = {tc_floor_shift(cells.x0, k - 1), tc_floor_shift(cells.y0, k - 1),
                      tc_floor_shift(cells.x1 - 1, k - 1) + 2, tc_floor_shift(cells.y1 - 1, k - 1) + 2};
        c.amplitude = tc_rect_around(c.amplitude, at);
        c.around[k - 1] = tc_synthesis_needs(c.made[k], TC_COARSE_REACH);
        if (k == 1)
            c.around[0] = tc_rect_around(c.around[0], tc_rect_grown(c.amplitude, TC_ENERGY_REACH));
        c.made[k - 1] = within(p, p->data + k - 1, c.around[k - 1]);
        c.largest = (size_t)tc_max64((int64_t)c.largest, tc_rect_area(c.around[k - 1]));
    }
    return c;
}

/* Floats that making it takes. */
static size_t memory_for(const chain *c)
{
    size_t area = (size_t)tc_rect_area(c->amplitude), energy = 3 * (size_t)tc_rect_area(c->around[0]);
    size_t most = tc_synthesis_scratch(BLOCK + 4 * TC_COARSE_REACH, BLOCK + 4 * TC_COARSE_REACH);
    return 2 * c->largest + 4 * area + (energy > most ? energy : most);
}

/* The same for any rectangle of a block's size: of one somewhat larger, since what is rounded on the way to level m
 * depends on the place. */
static size_t memory_for_any(const synthesis_field *p)
{
    enum { LARGER = 32 };
    size_t most = 0;
    for (int level = p->data + 1; level <= p->head.info.levels; level++) {
        const chain c = chain_of(p, level, (tc_rect){-1, -1, BLOCK + LARGER, BLOCK + LARGER});
        size_t needed = memory_for(&c);
        most = needed > most ? needed : most;
    }
    return most;
}

/* ---- Making it --------------------------------------------------------------------------------------------------- */

static void share_noise(const synthesis_field *p, tc_rect rect, float *share)
{
    for (int64_t j = rect.y0; j < rect.y1; j++)
        for (int64_t i = rect.x0; i < rect.x1; i++)
            *share++ = p->share.of(p->share.context, (double)i, (double)j);
}

/* From the finest heights of the data, which patch has over c->around[0]. */
static void make_levels(const synthesis_field *p, const chain *c, tc_patch patch, tc_patch spare, float *z,
                        ptrdiff_t stride, float *scratch)
{
    tc_level size = p->head.level[p->data - 1];
    int64_t area = tc_rect_area(c->amplitude);
    float *energy = scratch, *slope = energy + area, *amplitude = slope + area, *share = amplitude + area;
    scratch = share + area;
    if (!p->fit.none) {
        tc_local_energy(&patch, &p->fit, (float)size.spacing_x, (float)size.spacing_y, c->amplitude, energy, slope,
                        scratch);
        if (p->share.of)
            share_noise(p, c->amplitude, share);
    }
    for (int k = 1; k <= c->count; k++) {
        tc_level coarse = p->head.level[p->data + k - 2];
        if (!p->fit.none)
            tc_amplitudes(&p->fit, k, energy, slope, area, amplitude);
        for (int64_t i = 0; i < area && p->share.of && !p->fit.none; i++)
            amplitude[i] *= share[i];
        tc_patch a = {amplitude, c->amplitude.x1 - c->amplitude.x0, c->amplitude};
        tc_level_recipe recipe = {.fit = &p->fit,
                                  .seed = tc_noise_seed(p->chart, k),
                                  .width = coarse.width,
                                  .height = coarse.height,
                                  .wraps = p->head.info.wraps_x,
                                  .spacing_x = (float)coarse.spacing_x,
                                  .spacing_y = (float)coarse.spacing_y,
                                  .lowest = p->lowest,
                                  .highest = p->highest,
                                  .amplitude = &a,
                                  .shift = k - 1};
        if (k == c->count) {
            tc_synthesis_level(&recipe, &patch, c->made[k], z, stride, scratch);
            break;
        }
        spare.rect = c->around[k], spare.stride = spare.rect.x1 - spare.rect.x0;
        tc_synthesis_level(&recipe, &patch, c->made[k], tc_patch_at(&spare, c->made[k].x0, c->made[k].y0), spare.stride,
                           scratch);
        tc_level fine = p->head.level[p->data + k - 1];
        tc_extend_beyond(&spare, fine.width, fine.height, p->head.info.wraps_x);
        tc_patch made = spare;
        spare = patch, patch = made;
    }
}

/* ---- Voids ------------------------------------------------------------------------------------------------------- */

/* A sample is void where the mesh of the data's finest level is: outlines of holes stay. */
static void spread_voids(const uint8_t *data, tc_rect around, int k, tc_rect rect, uint8_t *voids, ptrdiff_t stride)
{
    int64_t w = around.x1 - around.x0, one = (int64_t)1 << k;
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++) {
            int64_t i = tc_floor_shift(x, k), j = tc_floor_shift(y, k), tx = x - i * one, ty = y - j * one;
            const uint8_t *c = data + (j - around.y0) * w + (i - around.x0);
            bool lower = tx + ty <= one;
            int v = lower ? (tx + ty < one && c[0]) : (tx + ty > one && c[w + 1]);
            v |= (lower ? tx : one - ty) > 0 && c[1];
            v |= (lower ? ty : one - tx) > 0 && c[w];
            voids[(y - rect.y0) * stride + (x - rect.x0)] = (uint8_t)v;
        }
}

static void repeat_beyond(uint8_t *v, tc_rect around, tc_rect have)
{
    int64_t w = around.x1 - around.x0;
    for (int64_t j = around.y0; j < around.y1; j++)
        for (int64_t i = around.x0; i < around.x1; i++) {
            int64_t x = tc_clamp64(i, have.x0, have.x1 - 1), y = tc_clamp64(j, have.y0, have.y1 - 1);
            if (x != i || y != j)
                v[(j - around.y0) * w + (i - around.x0)] = v[(y - around.y0) * w + (x - around.x0)];
        }
}

/* ---- Reading ----------------------------------------------------------------------------------------------------- */

/* What of level m the voids of a rectangle are told by. */
static tc_rect void_rect(int k, tc_rect rect)
{
    return (tc_rect){tc_floor_shift(rect.x0, k), tc_floor_shift(rect.y0, k), tc_floor_shift(rect.x1 - 1, k) + 2,
                     tc_floor_shift(rect.y1 - 1, k) + 2};
}

/* TC_READY; TC_COMING only where waiting is not allowed. */
static tc_ready read_base(const synthesis_field *p, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride, bool wait,
                          tc_status *status_ret)
{
    if (!wait)
        return tc_field_read_ready(p->base, p->data, rect, z, voids, stride, TC_ONLY_ASK);
    *status_ret = tc_field_read(p->base, p->data, rect, z, voids, stride);
    return *status_ret ? TC_FAILED : TC_READY;
}

static tc_status read_block(synthesis_field *p, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                            bool wait, tc_ready *how)
{
    const chain c = chain_of(p, level, rect);
    tc_rect hole = void_rect(c.count, rect), hole_have = within(p, p->data, hole);
    arena *a = borrow(p);
    if (!a)
        return TC_ERR_MEMORY;
    tc_status status = TC_OK;
    *how = TC_READY;
    if (z) {
        tc_patch patch = {a->memory, c.around[0].x1 - c.around[0].x0, c.around[0]},
                 spare = {.z = a->memory + c.largest};
        *how =
            read_base(p, c.made[0], tc_patch_at(&patch, c.made[0].x0, c.made[0].y0), NULL, patch.stride, wait, &status);
        if (*how == TC_READY) {
            tc_level size = p->head.level[p->data - 1];
            tc_extend_beyond(&patch, size.width, size.height, p->head.info.wraps_x);
            make_levels(p, &c, patch, spare, z, stride, a->memory + 2 * c.largest);
        }
    }
    if (voids && *how == TC_READY) {
        uint8_t *v = (uint8_t *)a->memory;
        int64_t w = hole.x1 - hole.x0;
        if (p->head.info.void_count > 0)
            *how = read_base(p, hole_have, NULL, v + (hole_have.y0 - hole.y0) * w + (hole_have.x0 - hole.x0), w, wait,
                             &status);
        if (p->head.info.void_count > 0 && *how == TC_READY) {
            repeat_beyond(v, hole, hole_have);
            spread_voids(v, hole, c.count, rect, voids, stride);
        } else if (*how == TC_READY) {
            for (int64_t j = 0; j < rect.y1 - rect.y0; j++)
                memset(voids + j * stride, 0, (size_t)(rect.x1 - rect.x0));
        }
    }
    give_back(p, a);
    return status;
}

static tc_status read_levels(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                             bool wait, tc_ready *how)
{
    synthesis_field *p = (synthesis_field *)field;
    *how = TC_READY;
    if (level <= p->data) {
        if (wait)
            return tc_field_read(p->base, level, rect, z, voids, stride);
        *how = tc_field_read_ready(p->base, level, rect, z, voids, stride, TC_ONLY_ASK);
        return TC_OK;
    }
    tc_status status = TC_OK;
    for (int64_t y = rect.y0; y < rect.y1 && !status && *how == TC_READY; y += BLOCK)
        for (int64_t x = rect.x0; x < rect.x1 && !status && *how == TC_READY; x += BLOCK) {
            tc_rect block = {x, y, tc_min64(x + BLOCK, rect.x1), tc_min64(y + BLOCK, rect.y1)};
            ptrdiff_t at = (y - rect.y0) * stride + (x - rect.x0);
            status = read_block(p, level, block, z ? z + at : NULL, voids ? voids + at : NULL, stride, wait, how);
        }
    return status;
}

static tc_status synthesis_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                ptrdiff_t stride)
{
    tc_ready how;
    return read_levels(field, level, rect, samples, voids, stride, true, &how);
}

static bool synthesis_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                 ptrdiff_t stride)
{
    tc_ready how;
    return !read_levels(field, level, rect, samples, voids, stride, false, &how) && how == TC_READY;
}

static tc_ready synthesis_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const synthesis_field *p = (const synthesis_field *)field;
    if (level <= p->data)
        return tc_field_ready(p->base, level, rect, urgency);
    return tc_field_ready(p->base, p->data, chain_of(p, level, rect).around[0], urgency);
}

/* ---- Bounds ------------------------------------------------------------------------------------------------------ */

/* Largest A of level m + k where the data's heights around are within `relief`; beyond a side they go on in a straight
 * line, up to five times as far. */
static float largest_amplitude(const synthesis_field *p, int k, float relief)
{
    tc_level size = p->head.level[p->data - 1];
    float detail = 5 * relief, gx = relief / (float)size.spacing_x, gy = relief / (float)size.spacing_y;
    float e = log2f(detail * detail + p->fit.energy_floor), s = log2f(gx * gx + gy * gy + p->fit.slope_floor);
    float a = exp2f(0.5f * (p->fit.level[k - 1].a + p->fit.level[k - 1].b * e + p->fit.level[k - 1].c * s));
    float shared = p->share.of ? 1.42f : 1.01f; /* powers there are off by less than 1e-3 */
    return shared * fminf(a, p->fit.level[k - 1].cap);
}

static tc_range synthesis_range(const tc_field *field, int level, tc_rect rect)
{
    const synthesis_field *p = (const synthesis_field *)field;
    if (level <= p->data)
        return tc_field_range(p->base, level, rect);
    chain c = chain_of(p, level, rect);
    tc_range r = tc_field_range(p->base, p->data, c.around[0]);
    /* However often U is applied, it swings by no more than 0.45 of the range beyond it, and makes no more than 1.9 of
     * a sample's height (the sums of its limit's magnitudes, 1.37 an axis). */
    const float swing = 0.45f, gain = 1.9f;
    float relief = r.hi - r.lo, pad = swing * relief;
    for (int k = 1; k <= c.count && relief > 0 && !p->fit.none; k++)
        pad += gain * TC_ADDED_MOST * largest_amplitude(p, k, relief);
    return (tc_range){fmaxf(r.lo - pad, fminf(p->lowest, r.lo)), fminf(r.hi + pad, fmaxf(p->highest, r.hi)), INFINITY};
}

/* ---- The rest of a field ------------------------------------------------------------------------------------------
 */

static bool synthesis_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    const synthesis_field *p = (const synthesis_field *)field;
    if (!tc_field_changed(p->base, since, finest_ret))
        return false;
    enum { REACH = 2 * TC_COARSE_REACH + TC_ENERGY_REACH };
    int64_t fine = (int64_t)1 << (p->head.info.levels - p->data);
    tc_rect r = tc_rect_grown(*finest_ret, REACH);
    *finest_ret = (tc_rect){r.x0 * fine, r.y0 * fine, r.x1 * fine, r.y1 * fine};
    return true;
}

static void synthesis_tell(const tc_field *field, tc_field_stats *stats)
{
    const synthesis_field *p = (const synthesis_field *)field;
    p->base->class->tell(p->base, stats);
    stats->bytes += sizeof *p + p->held;
}

static const struct tc_container *synthesis_container(const tc_field *field)
{
    return tc_field_container(((const synthesis_field *)field)->base);
}

static void synthesis_destroy(tc_field *field)
{
    synthesis_field *p = (synthesis_field *)field;
    while (p->idle) {
        arena *a = p->idle;
        p->idle = a->next;
        free(a);
    }
    pthread_mutex_destroy(&p->mutex);
    tc_field_destroy(p->base);
    free(p);
}

static const tc_field_class synthesis_class = {.sample = TC_FIELD_HEIGHTS,
                                               .read = synthesis_read,
                                               .read_ready = synthesis_read_ready,
                                               .ready = synthesis_ready,
                                               .range = synthesis_range,
                                               .changed = synthesis_changed,
                                               .tell = synthesis_tell,
                                               .container = synthesis_container,
                                               .destroy = synthesis_destroy};

tc_status tc_synthesis_create(tc_field *field, int levels, const tc_synthesis_fit *fit, int chart,
                              tc_synthesis_share share, tc_field **field_ret, tc_error *error)
{
    int data = field->info.levels;
    tc_level size = field->level[data - 1];
    bool possible = levels >= 1 && levels <= TC_SYNTHESIS_MOST && data + levels <= TC_MAX_FIELD_LEVELS &&
                    tc_max64(size.width, size.height) > 1;
    synthesis_field *p = possible ? calloc(1, sizeof *p) : NULL;
    if (!p) {
        tc_field_destroy(field);
        return possible ? tc_fail(error, TC_ERR_MEMORY, "synthesis: not enough memory")
                        : tc_fail(error, TC_ERR_USAGE, "synthesis: expected 1 to %d levels beyond 2 samples or more",
                                  (int)TC_SYNTHESIS_MOST);
    }
    p->head = *field;
    p->head.class = &synthesis_class;
    p->base = field, p->data = data, p->fit = *fit, p->chart = chart, p->share = share;
    p->lowest = field->info.z_min, p->highest = field->info.z_max;
    pthread_mutex_init(&p->mutex, NULL);
    for (int k = 0; k < levels; k++)
        size = (tc_level){field->info.wraps_x ? 2 * size.width : 2 * size.width - 1, 2 * size.height - 1,
                          size.spacing_x / 2, size.spacing_y / 2};
    tc_field_set_levels(&p->head, size);
    p->head.info.synthesised = levels;
    p->arena_bytes = sizeof(arena) + memory_for_any(p) * sizeof(float);
    *field_ret = &p->head;
    return TC_OK;
}
