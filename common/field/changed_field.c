/* changed_field.c - another field's samples, changed; see changed_field.h. */
#include "changed_field.h"

#include <stdlib.h>

typedef struct changed {
    tc_field head;
    tc_field *base;
    const tc_change *change;
    float by;
} changed;

/* samples: NULL where none are asked for. */
static void change(const changed *p, tc_rect rect, float *samples, ptrdiff_t stride)
{
    if (samples)
        p->change->samples(p->by, rect, samples, stride);
}

static tc_status changed_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    const changed *p = (const changed *)field;
    tc_status status = p->base->class->read(p->base, level, rect, samples, voids, stride);
    if (status == TC_OK)
        change(p, rect, samples, stride);
    return status;
}

static bool changed_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                               ptrdiff_t stride)
{
    const changed *p = (const changed *)field;
    const tc_field_class *class = p->base->class;
    bool ready = class->read_ready ? class->read_ready(p->base, level, rect, samples, voids, stride)
                                   : class->read(p->base, level, rect, samples, voids, stride) == TC_OK;
    if (ready)
        change(p, rect, samples, stride);
    return ready;
}

static tc_ready changed_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    const tc_field *base = ((const changed *)field)->base;
    return base->class->ready ? base->class->ready(base, level, rect, urgency) : TC_READY;
}

static void changed_overtaken(const tc_field *field, int level, tc_rect rect)
{
    const tc_field *base = ((const changed *)field)->base;
    if (base->class->overtaken)
        base->class->overtaken(base, level, rect);
}

static tc_range changed_range(const tc_field *field, int level, tc_rect rect)
{
    const changed *p = (const changed *)field;
    return p->change->range(p->by, p->base, level, rect);
}

static void changed_know_errors(const tc_field *field)
{
    tc_field_know_errors(((const changed *)field)->base);
}

static bool changed_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return tc_field_changed(((const changed *)field)->base, since, finest_ret);
}

static void changed_tell(const tc_field *field, tc_field_stats *stats)
{
    const tc_field *base = ((const changed *)field)->base;
    base->class->tell(base, stats);
    stats->bytes += sizeof(changed);
}

static const struct tc_container *changed_container(const tc_field *field)
{
    return tc_field_container(((const changed *)field)->base);
}

static void changed_destroy(tc_field *field)
{
    tc_field_destroy(tc_changed_field_release(field));
}

static const tc_field_class changed_class = {.sample = TC_FIELD_HEIGHTS,
                                             .read = changed_read,
                                             .read_ready = changed_read_ready,
                                             .ready = changed_ready,
                                             .overtaken = changed_overtaken,
                                             .range = changed_range,
                                             .know_errors = changed_know_errors,
                                             .changed = changed_changed,
                                             .tell = changed_tell,
                                             .container = changed_container,
                                             .destroy = changed_destroy};

tc_field *tc_changed_field_create(tc_field *base, const tc_change *change, float by)
{
    changed *p = malloc(sizeof *p);
    if (!p)
        return NULL;
    *p = (changed){.head = *base, .base = base, .change = change, .by = by};
    p->head.class = &changed_class;
    return &p->head;
}

tc_field *tc_changed_field_release(tc_field *field)
{
    changed *p = (changed *)field;
    tc_field *base = p->base;
    free(p);
    return base;
}
