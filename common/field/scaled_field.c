/* scaled_field.c - heights times a factor. Samples and bounds are multiplied alike, by one float, so that bounds stay
 * bounds. */
#include "scaled_field.h"

#include <float.h>
#include <stdlib.h>

typedef struct scaled {
    tc_field head;
    tc_field *base;
    float factor;
} scaled;

static void scale(float factor, tc_rect rect, float *z, ptrdiff_t stride)
{
    for (int64_t j = 0; z && j < rect.y1 - rect.y0; j++)
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++)
            z[j * stride + i] *= factor;
}

static tc_status scaled_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride)
{
    const scaled *p = (const scaled *)field;
    tc_status status = p->base->class->read(p->base, level, rect, samples, voids, stride);
    if (status == TC_OK)
        scale(p->factor, rect, samples, stride);
    return status;
}

static bool scaled_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    const scaled *p = (const scaled *)field;
    const tc_field_class *class = p->base->class;
    bool ready = class->read_ready ? class->read_ready(p->base, level, rect, samples, voids, stride)
                                   : class->read(p->base, level, rect, samples, voids, stride) == TC_OK;
    if (ready)
        scale(p->factor, rect, samples, stride);
    return ready;
}

static tc_ready scaled_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const tc_field *base = ((const scaled *)field)->base;
    return base->class->ready ? base->class->ready(base, level, rect, urgency) : TC_READY;
}

static void scaled_overtaken(const tc_field *field, int level, tc_rect rect)
{
    const tc_field *base = ((const scaled *)field)->base;
    if (base->class->overtaken)
        base->class->overtaken(base, level, rect);
}

/* Products are rounded, and with them how far a sample is from a mesh of others. */
static tc_range scaled_range(const tc_field *field, int level, tc_rect rect)
{
    const scaled *p = (const scaled *)field;
    const tc_range r = p->base->class->range(p->base, level, rect);
    const float lo = p->factor * r.lo, hi = p->factor * r.hi, rounding = FLT_EPSILON * fmaxf(fabsf(lo), fabsf(hi));
    return (tc_range){lo, hi, p->factor * r.step + rounding, p->factor * r.error + rounding};
}

static void scaled_know_errors(const tc_field *field)
{
    tc_field_know_errors(((const scaled *)field)->base);
}

static bool scaled_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return tc_field_changed(((const scaled *)field)->base, since, finest_ret);
}

static void scaled_tell(const tc_field *field, tc_field_stats *stats)
{
    const tc_field *base = ((const scaled *)field)->base;
    base->class->tell(base, stats);
    stats->bytes += sizeof(scaled);
}

static const struct tc_container *scaled_container(const tc_field *field)
{
    return tc_field_container(((const scaled *)field)->base);
}

static void scaled_destroy(tc_field *field)
{
    tc_field_destroy(tc_scaled_field_release(field));
}

static const tc_field_class scaled_class = {.sample = TC_FIELD_HEIGHTS,
                                            .read = scaled_read,
                                            .read_ready = scaled_read_ready,
                                            .ready = scaled_ready,
                                            .overtaken = scaled_overtaken,
                                            .range = scaled_range,
                                            .know_errors = scaled_know_errors,
                                            .changed = scaled_changed,
                                            .tell = scaled_tell,
                                            .container = scaled_container,
                                            .destroy = scaled_destroy};

tc_field *tc_scaled_field_create(tc_field *base, double factor)
{
    scaled *p = malloc(sizeof *p);
    if (!p)
        return NULL;
    *p = (scaled){.head = *base, .base = base, .factor = (float)factor};
    p->head.class = &scaled_class;
    p->head.info.z_base *= (double)p->factor; /* by the very factor that samples have */
    p->head.info.z_min *= p->factor;
    p->head.info.z_max *= p->factor;
    return &p->head;
}

tc_field *tc_scaled_field_release(tc_field *field)
{
    scaled *p = (scaled *)field;
    tc_field *base = p->base;
    free(p);
    return base;
}
