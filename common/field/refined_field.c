/* refined_field.c - samples between those of a field's finest level, on its mesh. */
#include "refined_field.h"

#include <stdlib.h>
#include <string.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "fine_voids.h"

enum { CELLS = 64, PITCH = CELLS + 1 }; /* along a side of what is made at once, and their samples */

typedef struct refined {
    tc_field head;
    const tc_field *base;
    int own; /* levels of base */
} refined;

/* Samples of base from rect.x0, rect.y0 on: those there are of a patch's. Behind the last ones come those again. */
typedef struct patch {
    tc_rect rect;
    float z[PITCH * PITCH];
    uint8_t voids[PITCH * PITCH];
} patch;

/* Samples of base that a rectangle of the level k finer lies between; those that there are. */
static tc_rect between(const refined *p, int k, tc_rect rect)
{
    const tc_level size = p->base->level[p->own - 1];
    tc_rect r = {tc_floor_shift(rect.x0, k), tc_floor_shift(rect.y0, k), tc_floor_shift(rect.x1 - 1, k) + 2,
                 tc_floor_shift(rect.y1 - 1, k) + 2};
    r.y1 = tc_min64(r.y1, size.height + p->base->beyond);
    if (!p->base->info.wraps_x)
        r.x1 = tc_min64(r.x1, size.width + p->base->beyond);
    return r;
}

static tc_status read_patch(const refined *p, bool z, bool voids, bool wait, patch *a, tc_ready *how)
{
    float *heights = z ? a->z : NULL;
    uint8_t *holes = voids ? a->voids : NULL;
    tc_status status = TC_OK;
    if (wait)
        status = tc_field_read(p->base, p->own, a->rect, heights, holes, PITCH);
    else
        *how = tc_field_read_ready(p->base, p->own, a->rect, heights, holes, PITCH, TC_ONLY_ASK);
    if (status || *how != TC_READY)
        return status;
    const int64_t w = a->rect.x1 - a->rect.x0, h = a->rect.y1 - a->rect.y0;
    for (int64_t j = 0; j < h && w < PITCH; j++) {
        a->z[j * PITCH + w] = a->z[j * PITCH + w - 1];
        a->voids[j * PITCH + w] = a->voids[j * PITCH + w - 1];
    }
    if (h < PITCH) {
        memcpy(a->z + h * PITCH, a->z + (h - 1) * PITCH, PITCH * sizeof *a->z);
        memcpy(a->voids + h * PITCH, a->voids + (h - 1) * PITCH, PITCH);
    }
    return TC_OK;
}

/* On the triangles that cells are cut into (mesh.h). In double, in which products are exact: a sum of two is the same
 * from either end. */
static void make_heights(const patch *a, int k, tc_rect rect, float *z, ptrdiff_t stride)
{
    const int64_t mask = ((int64_t)1 << k) - 1;
    const double step = 1 / (double)(mask + 1);
    for (int64_t y = rect.y0; y < rect.y1; y++, z += stride) {
        const float *south = a->z + (tc_floor_shift(y, k) - a->rect.y0) * PITCH, *north = south + PITCH;
        const double v = (double)(y & mask) * step;
        for (int64_t x = rect.x0; x < rect.x1; x++) {
            const int64_t i = tc_floor_shift(x, k) - a->rect.x0;
            const double u = (double)(x & mask) * step;
            z[x - rect.x0] = (float)tc_triangle_height((double)south[i], (double)south[i + 1], (double)north[i],
                                                       (double)north[i + 1], u, v);
        }
    }
}

static tc_status read_levels(const refined *p, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                             bool wait, tc_ready *how)
{
    *how = TC_READY;
    if (level <= p->own) {
        if (wait)
            return tc_field_read(p->base, level, rect, z, voids, stride);
        *how = tc_field_read_ready(p->base, level, rect, z, voids, stride, TC_ONLY_ASK);
        return TC_OK;
    }
    const int k = level - p->own;
    const int64_t one = (int64_t)1 << k;
    tc_status status = TC_OK;
    patch a;
    for (int64_t y = rect.y0, y1; y < rect.y1 && !status && *how == TC_READY; y = y1) {
        y1 = tc_min64((tc_floor_shift(y, k) + CELLS) * one, rect.y1);
        for (int64_t x = rect.x0, x1; x < rect.x1 && !status && *how == TC_READY; x = x1) {
            x1 = tc_min64((tc_floor_shift(x, k) + CELLS) * one, rect.x1);
            const tc_rect part = {x, y, x1, y1};
            const ptrdiff_t at = (y - rect.y0) * stride + (x - rect.x0);
            a.rect = between(p, k, part);
            status = read_patch(p, z, voids && p->head.info.void_count > 0, wait, &a, how);
            if (status || *how != TC_READY)
                break;
            if (z)
                make_heights(&a, k, part, z + at, stride);
            if (voids && p->head.info.void_count > 0)
                tc_fine_voids(a.voids, (tc_rect){a.rect.x0, a.rect.y0, a.rect.x0 + PITCH, a.rect.y0 + PITCH}, k, part,
                              voids + at, stride);
            for (int64_t j = 0; voids && p->head.info.void_count == 0 && j < y1 - y; j++)
                memset(voids + at + j * stride, 0, (size_t)(x1 - x));
        }
    }
    return status;
}

static tc_status refined_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    tc_ready how;
    return read_levels((const refined *)field, level, rect, samples, voids, stride, true, &how);
}

static bool refined_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                               ptrdiff_t stride)
{
    tc_ready how;
    return !read_levels((const refined *)field, level, rect, samples, voids, stride, false, &how) && how == TC_READY;
}

static tc_ready refined_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const refined *p = (const refined *)field;
    return level <= p->own ? tc_field_ready(p->base, level, rect, urgency)
                           : tc_field_ready(p->base, p->own, between(p, level - p->own, rect), urgency);
}

static tc_range refined_range(const tc_field *field, int level, tc_rect rect)
{
    const refined *p = (const refined *)field;
    if (level <= p->own)
        return tc_field_range(p->base, level, rect);
    const tc_range r = tc_field_range(p->base, p->own, between(p, level - p->own, rect));
    return (tc_range){r.lo, r.hi, r.hi - r.lo};
}

static bool refined_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    const refined *p = (const refined *)field;
    if (!tc_field_changed(p->base, since, finest_ret))
        return false;
    const int64_t fine = (int64_t)1 << (p->head.info.levels - p->own);
    const tc_rect r = tc_rect_grown(*finest_ret, 1);
    *finest_ret = (tc_rect){r.x0 * fine, r.y0 * fine, r.x1 * fine, r.y1 * fine};
    return true;
}

static void refined_tell(const tc_field *field, tc_field_stats *stats)
{
    const refined *p = (const refined *)field;
    p->base->class->tell(p->base, stats);
    stats->bytes += sizeof *p;
}

static const struct tc_container *refined_container(const tc_field *field)
{
    return tc_field_container(((const refined *)field)->base);
}

static void refined_destroy(tc_field *field)
{
    free(field);
}

static const tc_field_class refined_class = {.sample = TC_FIELD_HEIGHTS,
                                             .read = refined_read,
                                             .read_ready = refined_read_ready,
                                             .ready = refined_ready,
                                             .range = refined_range,
                                             .changed = refined_changed,
                                             .tell = refined_tell,
                                             .container = refined_container,
                                             .destroy = refined_destroy};

tc_field *tc_refined_field(const tc_field *field, int levels)
{
    const int own = field->info.levels;
    refined *p = levels >= 0 && own + levels <= TC_MAX_FIELD_LEVELS ? malloc(sizeof *p) : NULL;
    if (!p)
        return NULL;
    *p = (refined){.head = *field, .base = field, .own = own};
    p->head.class = &refined_class;
    tc_level size = field->level[own - 1];
    const bool wraps = field->info.wraps_x;
    for (int k = 0; k < levels; k++)
        size = (tc_level){wraps ? 2 * size.width : 2 * size.width - 1, 2 * size.height - 1, size.spacing_x / 2,
                          size.spacing_y / 2};
    tc_field_set_levels(&p->head, size);
    return &p->head;
}
