/* synthesis_field.c - a field with more levels than the one that it decorates. Heights: synthesis_chain.c. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "synthesis_chain.h"

enum { BLOCK = 256 }; /* samples along a side of what is made at once */

/* Memory of one reading, kept for the next one; all are as large as any reading needs. */
typedef struct arena {
    struct arena *next;
    float memory[];
} arena;

typedef struct synthesis_field {
    tc_field head;
    tc_field *base;
    tc_chain chain;
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

static tc_status read_block(synthesis_field *p, int k, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                            bool wait, tc_ready *how)
{
    tc_rect hole = void_rect(k, rect), hole_have = tc_chain_within(&p->chain, 0, hole);
    arena *a = borrow(p);
    if (!a)
        return TC_ERR_MEMORY;
    tc_status status = TC_OK;
    *how = z ? tc_chain_make(&p->chain, k, rect, z, stride, wait, a->memory, &status) : TC_READY;
    if (voids && *how == TC_READY) {
        uint8_t *v = (uint8_t *)a->memory;
        int64_t w = hole.x1 - hole.x0;
        if (p->head.info.void_count > 0)
            *how = tc_chain_read(&p->chain, hole_have, NULL,
                                 v + (hole_have.y0 - hole.y0) * w + (hole_have.x0 - hole.x0), w, wait, &status);
        if (p->head.info.void_count > 0 && *how == TC_READY) {
            repeat_beyond(v, hole, hole_have);
            spread_voids(v, hole, k, rect, voids, stride);
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
    const int data = p->chain.data;
    if (level <= data) {
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
            status =
                read_block(p, level - data, block, z ? z + at : NULL, voids ? voids + at : NULL, stride, wait, how);
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

/* What of the data a rectangle of any level takes; the data's level. */
static int data_for(const synthesis_field *p, int level, tc_rect *rect)
{
    const int data = p->chain.data;
    if (level > data)
        *rect = tc_chain_reads(&p->chain, level - data, *rect);
    return level > data ? data : level;
}

static tc_ready synthesis_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const synthesis_field *p = (const synthesis_field *)field;
    level = data_for(p, level, &rect);
    return tc_field_ready(p->base, level, rect, urgency);
}

static void synthesis_overtaken(const tc_field *field, int level, tc_rect rect)
{
    const synthesis_field *p = (const synthesis_field *)field;
    level = data_for(p, level, &rect);
    tc_field_overtaken(p->base, level, rect);
}

/* ---- Bounds ------------------------------------------------------------------------------------------------------ */

/* Largest A of level m + k where the data's heights around are within `relief` and their details within `detail`. */
static float largest_amplitude(const tc_chain *p, int k, float detail, float relief)
{
    tc_level size = p->levels[p->data - 1];
    float gx = relief / (float)size.spacing_x, gy = relief / (float)size.spacing_y;
    float e = log2f(detail * detail + p->fit.energy_floor), s = log2f(gx * gx + gy * gy + p->fit.slope_floor);
    float a = exp2f(0.5f * (p->fit.level[k - 1].a + p->fit.level[k - 1].b * e + p->fit.level[k - 1].c * s));
    float shared = p->share.of ? 1.42f : 1.01f; /* powers there are off by less than 1e-3 */
    return shared * fminf(a, p->fit.level[k - 1].cap);
}

/* How far the finest level's mesh is from that of level m + k, by the fit: an estimate. Levels of the same terrain bend
 * as their data's finest one does, by `step`, so that U is off the mesh by half of that, and a quarter on each further
 * level; beside it there is what is added. */
static float synthesised_error(const synthesis_field *p, int k, float step, float relief)
{
    float error = 0;
    for (int finer = k + 1; finer <= p->head.info.synthesised && isfinite(step); finer++) {
        error += ldexpf(step, 1 - 2 * finer);
        if (relief > 0 && !p->chain.fit.none)
            error += TC_ADDED_MOST * largest_amplitude(&p->chain, finer, step, relief);
    }
    return isfinite(step) ? error : INFINITY;
}

static tc_range synthesis_range(const tc_field *field, int level, tc_rect rect)
{
    const synthesis_field *p = (const synthesis_field *)field;
    const tc_chain *c = &p->chain;
    if (level <= c->data) {
        tc_range r = tc_field_range(p->base, level, rect);
        const int64_t finer = (int64_t)1 << (c->data - level);
        const tc_rect there = {rect.x0 * finer, rect.y0 * finer, rect.x1 * finer, rect.y1 * finer};
        if (isfinite(r.error)) {
            const tc_range data = tc_field_range(p->base, c->data, there);
            r.error += synthesised_error(p, 0, data.step, data.hi - data.lo);
        }
        return r;
    }
    tc_range r = tc_field_range(p->base, c->data, tc_chain_depends(c, level - c->data, rect));
    /* However often U is applied, it swings by no more than 0.45 of the range beyond it, and makes no more than 1.9 of
     * a sample's height (the sums of its limit's magnitudes, 1.37 an axis). Beyond a side heights go on in a straight
     * line, up to five times as far. */
    const float swing = 0.45f, gain = 1.9f;
    float relief = r.hi - r.lo, pad = swing * relief;
    for (int k = 1; k <= level - c->data && relief > 0 && !c->fit.none; k++)
        pad += gain * TC_ADDED_MOST * largest_amplitude(c, k, 5 * relief, relief);
    return (tc_range){fmaxf(r.lo - pad, fminf(c->lowest, r.lo)), fminf(r.hi + pad, fmaxf(c->highest, r.hi)), INFINITY,
                      synthesised_error(p, level - 1 - c->data, r.step, relief)};
}

/* ---- The rest of a field ------------------------------------------------------------------------------------------
 */

static void synthesis_know_errors(const tc_field *field)
{
    tc_field_know_errors(((const synthesis_field *)field)->base);
}

static bool synthesis_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    const synthesis_field *p = (const synthesis_field *)field;
    if (!tc_field_changed(p->base, since, finest_ret))
        return false;
    enum { REACH = 2 * TC_COARSE_REACH + TC_ENERGY_REACH };
    int64_t fine = (int64_t)1 << (p->head.info.levels - p->chain.data);
    tc_rect r = tc_rect_grown(*finest_ret, REACH);
    *finest_ret = (tc_rect){r.x0 * fine, r.y0 * fine, r.x1 * fine, r.y1 * fine};
    return true;
}

static void synthesis_tell(const tc_field *field, tc_field_stats *stats)
{
    const synthesis_field *p = (const synthesis_field *)field;
    p->base->class->tell(p->base, stats);
    stats->bytes += sizeof *p + p->held + (p->chain.kept ? tc_kept_bytes() : 0);
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
    tc_kept_destroy(p->chain.kept);
    tc_field_destroy(p->base);
    free(p);
}

static const tc_field_class synthesis_class = {.sample = TC_FIELD_HEIGHTS,
                                               .read = synthesis_read,
                                               .read_ready = synthesis_read_ready,
                                               .ready = synthesis_ready,
                                               .overtaken = synthesis_overtaken,
                                               .range = synthesis_range,
                                               .know_errors = synthesis_know_errors,
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
    /* What was made of heights that have changed would be wrong. */
    bool keeps = p && !field->class->changed;
    if (keeps)
        p->chain.kept = tc_kept_create();
    if (!p || (keeps && !p->chain.kept)) {
        free(p);
        tc_field_destroy(field);
        return possible ? tc_fail(error, TC_ERR_MEMORY, "synthesis: not enough memory")
                        : tc_fail(error, TC_ERR_USAGE, "synthesis: expected 1 to %d levels beyond 2 samples or more",
                                  (int)TC_SYNTHESIS_MOST);
    }
    p->head = *field;
    p->head.class = &synthesis_class;
    p->head.beyond = 0;
    p->base = field;
    tc_chain *c = &p->chain;
    c->base = field, c->levels = p->head.level, c->data = data, c->wraps = field->info.wraps_x;
    c->fit = *fit, c->chart = chart, c->share = share;
    c->lowest = field->info.z_min, c->highest = field->info.z_max;
    pthread_mutex_init(&p->mutex, NULL);
    for (int k = 0; k < levels; k++)
        size = (tc_level){field->info.wraps_x ? 2 * size.width : 2 * size.width - 1, 2 * size.height - 1,
                          size.spacing_x / 2, size.spacing_y / 2};
    tc_field_set_levels(&p->head, size);
    p->head.info.synthesised = levels;
    c->room = tc_chain_room(levels, BLOCK);
    p->arena_bytes = sizeof(arena) + c->room * sizeof(float);
    *field_ret = &p->head;
    return TC_OK;
}
