/* changed_field.c - another field's samples, changed; see changed_field.h. */
#include "changed_field.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "measured_errors.h"

typedef struct changed {
    tc_field head;
    tc_field *base;
    const tc_change *change;
    float by;
    pthread_mutex_t mutex; /* of measuring */
    atomic_bool measured;
    tc_range_pyramid error[TC_MAX_FIELD_LEVELS]; /* [l - 1]; once measured */
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
    tc_range r = p->change->range(p->by, p->base, level, rect);
    if (!p->measured || r.error == INFINITY) /* also of what is damaged */
        return r;
    tc_rect piece[2];
    int pieces = tc_rect_round(rect, field->level[level - 1].width, piece), reads = 0;
    r.error = 0;
    for (int n = 0; n < pieces; n++)
        r.error = fmaxf(r.error, tc_measured_error(&p->error[level - 1], piece[n], pieces == 1 ? 2 : 1, &reads));
    return r;
}

/* What is made up below the data is not looked at: it would be made for it. */
static bool is_measured(const changed *p)
{
    const int64_t most = (int64_t)1 << 27; /* samples */
    const tc_level *finest = &p->head.level[p->head.info.levels - 1];
    return p->change->measures && p->head.info.synthesised == 0 && finest->height <= most / finest->width;
}

static void changed_know_errors(const tc_field *field)
{
    changed *p = (changed *)field;
    tc_field_know_errors(p->base);
    if (p->measured || !is_measured(p))
        return;
    pthread_mutex_lock(&p->mutex);
    if (!p->measured) {
        p->measured = tc_measure_errors(field, p->error) == TC_OK;
        if (!p->measured)
            tc_measured_errors_free(p->error, field->info.levels);
    }
    pthread_mutex_unlock(&p->mutex);
}

static bool changed_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return tc_field_changed(((const changed *)field)->base, since, finest_ret);
}

static void changed_tell(const tc_field *field, tc_field_stats *stats)
{
    const changed *p = (const changed *)field;
    p->base->class->tell(p->base, stats);
    stats->bytes += sizeof *p;
    for (int l = 0; p->measured && l < field->info.levels; l++)
        stats->bytes += (size_t)tc_range_nodes(p->error[l].nx, p->error[l].ny) * sizeof(tc_range);
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
    pthread_mutex_init(&p->mutex, NULL);
    return &p->head;
}

tc_field *tc_changed_field_release(tc_field *field)
{
    changed *p = (changed *)field;
    tc_field *base = p->base;
    tc_measured_errors_free(p->error, field->info.levels);
    pthread_mutex_destroy(&p->mutex);
    free(p);
    return base;
}
