/* field.c - what is the same for every kind of field. */
#include "field.h"

#include <math.h>

#include "filter.h"
#include "common/base/rect.h"
#include "point.h"

void tc_field_set_levels(tc_field *field, tc_level finest)
{
    int levels = 1;
    for (int64_t size = tc_max64(finest.width, finest.height); size > 1; size = tc_coarse_size(size))
        levels++;
    field->info.levels = levels;
    field->level[levels - 1] = finest;
    for (int l = levels - 1; l >= 1; l--) {
        tc_level f = field->level[l];
        field->level[l - 1] =
            (tc_level){tc_coarse_size(f.width), tc_coarse_size(f.height), 2 * f.spacing_x, 2 * f.spacing_y};
    }
}

void tc_field_destroy(tc_field *field)
{
    if (field)
        field->class->destroy(field);
}

const tc_terrain_info *tc_field_info(const tc_field *field)
{
    return &field->info;
}

tc_level tc_field_level(const tc_field *field, int level)
{
    return field->level[level - 1];
}

static tc_rect level_rect(const tc_field *field, int level)
{
    const tc_level *l = &field->level[level - 1];
    return (tc_rect){0, 0, l->width, l->height};
}

bool tc_field_wraps(const tc_field *field, int level)
{
    int m = field->info.levels, halvings = m - level;
    int64_t width = field->level[m - 1].width;
    return field->info.wraps_x && (width >> halvings) << halvings == width;
}

/* The first piece of rect, which lies within the rows of a level that wraps, on the level itself. */
static tc_rect piece_at(const tc_field *field, int level, tc_rect rect)
{
    int64_t width = field->level[level - 1].width, x = rect.x0 % width;
    x += x < 0 ? width : 0;
    return (tc_rect){x, rect.y0, x + tc_min64(width - x, rect.x1 - rect.x0), rect.y1};
}

/* rect cut to what there is of the level, and so many samples beyond. */
static tc_rect cut(const tc_field *field, int level, tc_rect rect, int beyond)
{
    tc_rect all = tc_rect_grown(level_rect(field, level), beyond);
    if (tc_field_wraps(field, level) && rect.x1 > rect.x0) {
        all.x0 = rect.x0;
        all.x1 = rect.x1 = tc_min64(rect.x1, rect.x0 + all.x1); /* once around is all */
    }
    return tc_rect_intersect(rect, all);
}

/* Reads piece by piece: without waiting, where how is given, which then is TC_COMING where that cannot be. */
static tc_status read_pieces(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride, tc_ready *how)
{
    enum { SAMPLE_BYTES = 4 }; /* of either kind */
    char *z = samples;
    if (level < 1 || level > field->info.levels)
        return TC_ERR_USAGE;
    bool within = tc_rect_within(rect, tc_rect_grown(level_rect(field, level), field->beyond));
    if (!within && (!tc_field_wraps(field, level) || rect.y0 < 0 || rect.y1 > field->level[level - 1].height))
        return TC_ERR_USAGE;
    tc_status status = TC_OK;
    while (status == TC_OK && !tc_rect_empty(rect)) {
        tc_rect piece = within ? rect : piece_at(field, level, rect);
        int64_t width = piece.x1 - piece.x0;
        if (!how || !field->class->read_ready)
            status = field->class->read(field, level, piece, z, voids, stride);
        else if (!field->class->read_ready(field, level, piece, z, voids, stride)) {
            *how = TC_COMING;
            return TC_OK;
        }
        rect.x0 += width;
        z = z ? z + width * SAMPLE_BYTES : NULL;
        voids = voids ? voids + width : NULL;
    }
    return status;
}

tc_status tc_field_read_samples(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                ptrdiff_t stride)
{
    return read_pieces(field, level, rect, samples, voids, stride, NULL);
}

tc_ready tc_field_samples_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                                ptrdiff_t stride, tc_urgency urgency)
{
    tc_ready how = TC_READY;
    if (read_pieces(field, level, rect, samples, voids, stride, &how))
        return TC_FAILED;
    if (how == TC_READY)
        return TC_READY;
    /* What has come in between is had by asking again. */
    return tc_field_ready(field, level, rect, urgency) == TC_FAILED ? TC_FAILED : TC_COMING;
}

tc_status tc_field_read(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride)
{
    return field->class->sample == TC_FIELD_HEIGHTS ? tc_field_read_samples(field, level, rect, z, voids, stride)
                                                    : TC_ERR_USAGE;
}

tc_ready tc_field_read_ready(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride,
                             tc_urgency urgency)
{
    return field->class->sample == TC_FIELD_HEIGHTS
               ? tc_field_samples_ready(field, level, rect, z, voids, stride, urgency)
               : TC_FAILED;
}

tc_ready tc_field_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    if (level < 1 || level > field->info.levels)
        return TC_FAILED;
    rect = cut(field, level, rect, field->beyond);
    return !field->class->ready || tc_rect_empty(rect) ? TC_READY : field->class->ready(field, level, rect, urgency);
}

void tc_field_overtaken(const tc_field *field, int level, tc_rect rect)
{
    rect = level < 1 || level > field->info.levels ? (tc_rect){0, 0, 0, 0} : cut(field, level, rect, field->beyond);
    if (field->class->overtaken && !tc_rect_empty(rect))
        field->class->overtaken(field, level, rect);
}

tc_range tc_field_range(const tc_field *field, int level, tc_rect rect)
{
    rect = level < 1 || level > field->info.levels ? (tc_rect){0, 0, 0, 0} : cut(field, level, rect, 0);
    if (tc_rect_empty(rect))
        return (tc_range){field->info.z_min, field->info.z_max, INFINITY, INFINITY};
    return field->class->range(field, level, rect);
}

void tc_field_know_errors(const tc_field *field)
{
    if (field->class->know_errors)
        field->class->know_errors(field);
}

bool tc_field_changed(const tc_field *field, uint64_t *since, tc_rect *finest_ret)
{
    return field->class->changed && field->class->changed(field, since, finest_ret);
}

tc_field_stats tc_field_tell(const tc_field *field)
{
    tc_field_stats stats = {0};
    field->class->tell(field, &stats);
    return stats;
}

const struct tc_container *tc_field_container(const tc_field *field)
{
    return field->class->container ? field->class->container(field) : NULL;
}

const tc_georef *tc_field_georef(const tc_field *field)
{
    return &field->georef;
}

bool tc_is_other_body(const tc_georef *georef)
{
    return georef->semi_major > 0 && (georef->semi_major < 6.3e6 || georef->semi_major > 6.45e6);
}

/* ---- Height at a point ------------------------------------------------------------------------------------------ */

static void to_samples(const tc_field *field, int level, double x, double y, double *u_ret, double *v_ret)
{
    const tc_level *l = &field->level[level - 1];
    *u_ret = x / l->spacing_x, *v_ret = y / l->spacing_y;
}

tc_status tc_field_height(const tc_field *field, double x, double y, double *z_ret)
{
    double u, v;
    to_samples(field, field->info.levels, x, y, &u, &v);
    return tc_field_mesh_height(field, field->info.levels, u, v, z_ret);
}

bool tc_field_height_ready(const tc_field *field, double x, double y, double *z_ret, int *level_ret)
{
    for (int l = field->info.levels; l >= 1; l--) {
        double u, v;
        to_samples(field, l, x, y, &u, &v);
        tc_cell c = tc_cell_at(field, l, tc_cell_turn(field, l, u), v);
        tc_urgency urgency = l == field->info.levels ? TC_SOON : TC_ONLY_ASK;
        if (tc_field_read_ready(field, l, c.rect, c.z, NULL, 2, urgency) != TC_READY)
            continue;
        tc_cell_complete(&c);
        *z_ret = tc_cell_mesh(&c);
        if (level_ret)
            *level_ret = l;
        return true;
    }
    return false;
}
