/* computed.c - pyramids whose heights are computed when they are asked for. */
#include "computed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"

enum { WAVES = 8 };
static const int64_t lengths[WAVES] = {41, 523, 7919, 104729, 1299709, 15485863, 179424673, 2038074743};

typedef struct computed {
    tc_field head;
    double amplitude[WAVES]; /* metres */
    _Atomic int64_t reads;
} computed;

/* Metres above z_base. */
static double height_at(const computed *c, int64_t x, int64_t y)
{
    double z = 0;
    for (int k = 0; k < WAVES; k++) {
        int64_t along = (k & 1 ? x - 3 * y : 2 * x + y) % lengths[k];
        double at = (double)(along < 0 ? along + lengths[k] : along) / (double)lengths[k];
        z += c->amplitude[k] * (1 - fabs(2 * at - 1)); /* a triangle wave: exact slopes, no library's sine */
    }
    return z;
}

float computed_height(const tc_field *field, int64_t x, int64_t y)
{
    return (float)height_at((const computed *)field, x, y);
}

static tc_status read_samples(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    float *z = samples;
    computed *c = (computed *)field;
    int shift = field->info.levels - level;
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        for (int64_t i = rect.x0; i < rect.x1; i++)
            z[(j - rect.y0) * stride + i - rect.x0] = (float)height_at(c, i << shift, j << shift);
        if (voids)
            memset(voids + (j - rect.y0) * stride, 0, (size_t)(rect.x1 - rect.x0));
    }
    c->reads += (rect.x1 - rect.x0) * (rect.y1 - rect.y0);
    return TC_OK;
}

static tc_range range(const tc_field *field, int level, tc_rect rect)
{
    (void)level, (void)rect;
    return (tc_range){field->info.z_min, field->info.z_max, INFINITY, INFINITY};
}

static void tell(const tc_field *field, tc_field_stats *stats)
{
    (void)field;
    stats->bytes += sizeof(computed);
}

static void destroy(tc_field *field)
{
    free(field);
}

tc_field *computed_field(int64_t width, int64_t height, double spacing, double highest)
{
    static const tc_field_class class = {.read = read_samples, .range = range, .tell = tell, .destroy = destroy};
    computed *c = calloc(1, sizeof *c);
    if (!c)
        exit(99);
    c->head.class = &class;
    tc_field_set_levels(&c->head, (tc_level){width, height, spacing, spacing});
    for (int k = 0; k < WAVES; k++) {
        c->amplitude[k] = fmin(0.02 * (double)lengths[k], highest) * spacing;
        c->head.info.z_max += (float)c->amplitude[k] * (1 + 1e-6f);
    }
    return &c->head;
}

int64_t computed_reads(const tc_field *field)
{
    return ((const computed *)field)->reads;
}
