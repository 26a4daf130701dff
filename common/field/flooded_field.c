/* flooded_field.c - heights, or the sea where they are below it. Samples and bounds are cut by the same float, so that
 * bounds stay bounds. */
#include "flooded_field.h"

#include <math.h>
#include <stdlib.h>

typedef struct flooded {
    tc_field head;
    tc_field *base;
    float sea; /* above z_base */
} flooded;

static void flood(float sea, tc_rect rect, float *z, ptrdiff_t stride)
{
    for (int64_t j = 0; z && j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
            z[j * stride + i] = z[j * stride + i] < sea ? sea : z[j * stride + i];
}

static tc_status flooded_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    const flooded *p = (const flooded *)field;
    tc_status status = p->base->class->read(p->base, level, rect, samples, voids, stride);
    if (status == TC_OK)
        flood(p->sea, rect, samples, stride);
    return status;
}

static bool flooded_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                               ptrdiff_t stride)
{
    const flooded *p = (const flooded *)field;
    const tc_field_class *class = p->base->class;
    bool ready = class->read_ready ? class->read_ready(p->base, level, rect, samples, voids, stride)
                                   : class->read(p->base, level, rect, samples, voids, stride) == TC_OK;
    if (ready)
        flood(p->sea, rect, samples, stride);
    return ready;
}

static tc_ready flooded_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const tc_field *base = ((const flooded *)field)->base;
    return base->class->ready ? base->class->ready(base, level, rect, urgency) : TC_READY;
}

static void flooded_overtaken(const tc_field *field, int level, tc_rect rect)
{
    const tc_field *base = ((const flooded *)field)->base;
    if (base->class->overtaken)
        base->class->overtaken(base, level, rect);
}

/* How far a mesh of heights that are cut may be from a mesh that is cut, where heights are within lo and hi: in a
 * triangle across the shore by no more than it has above the sea, nor than it has below it. */
static float kink(float lo, float hi, float sea)
{
    return fmaxf(fminf(hi - sea, sea - lo), 0);
}

/* Places keep their distance or come nearer as they are cut; the rest is kinks of the two meshes that a bound is of.
 * The other one's samples are as far off as it says, those of a coarser cell next to the rectangle, too. */
static tc_range flooded_range(const tc_field *field, int level, tc_rect rect)
{
    const flooded *p = (const flooded *)field;
    const float sea = p->sea;
    tc_range r = p->base->class->range(p->base, level, rect);
    const tc_range next = tc_field_range(p->base, level, (tc_rect){rect.x0 - 1, rect.y0 - 1, rect.x1 + 1, rect.y1 + 1});
    r.step += kink(next.lo - next.step, next.hi + next.step, sea);
    r.error += kink(r.lo, r.hi, sea) + kink(r.lo - r.error, r.hi + r.error, sea);
    r.lo = fmaxf(r.lo, sea), r.hi = fmaxf(r.hi, sea);
    return r;
}

static void flooded_know_errors(const tc_field *field)
{
    tc_field_know_errors(((const flooded *)field)->base);
}

static bool flooded_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return tc_field_changed(((const flooded *)field)->base, since, finest_ret);
}

static void flooded_tell(const tc_field *field, tc_field_stats *stats)
{
    const tc_field *base = ((const flooded *)field)->base;
    base->class->tell(base, stats);
    stats->bytes += sizeof(flooded);
}

static const struct tc_container *flooded_container(const tc_field *field)
{
    return tc_field_container(((const flooded *)field)->base);
}

static void flooded_destroy(tc_field *field)
{
    tc_field_destroy(tc_flooded_field_release(field));
}

static const tc_field_class flooded_class = {.sample = TC_FIELD_HEIGHTS,
                                             .read = flooded_read,
                                             .read_ready = flooded_read_ready,
                                             .ready = flooded_ready,
                                             .overtaken = flooded_overtaken,
                                             .range = flooded_range,
                                             .know_errors = flooded_know_errors,
                                             .changed = flooded_changed,
                                             .tell = flooded_tell,
                                             .container = flooded_container,
                                             .destroy = flooded_destroy};

tc_field *tc_flooded_field_create(tc_field *base, double sea)
{
    flooded *p = malloc(sizeof *p);
    if (!p)
        return NULL;
    *p = (flooded){.head = *base, .base = base, .sea = (float)(sea - base->info.z_base)};
    p->head.class = &flooded_class;
    p->head.info.z_max = fmaxf(p->head.info.z_max, p->sea);
    return &p->head;
}

tc_field *tc_flooded_field_release(tc_field *field)
{
    flooded *p = (flooded *)field;
    tc_field *base = p->base;
    free(p);
    return base;
}
