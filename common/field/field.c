/* pyramid.c - what is the same for every kind of pyramid. */
#include "field.h"

#include <math.h>

#include "filter.h"
#include "common/base/mesh.h"
#include "common/base/rect.h"

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

/* rect cut to what there is of the level. */
static tc_rect cut(const tc_field *field, int level, tc_rect rect)
{
    tc_rect all = level_rect(field, level);
    if (tc_field_wraps(field, level) && rect.x1 > rect.x0) {
        all.x0 = rect.x0;
        all.x1 = rect.x1 = tc_min64(rect.x1, rect.x0 + all.x1); /* once around is all */
    }
    return tc_rect_intersect(rect, all);
}

tc_status tc_field_read(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride)
{
    if (level < 1 || level > field->info.levels)
        return TC_ERR_USAGE;
    if (tc_rect_within(rect, level_rect(field, level)))
        return tc_rect_empty(rect) ? TC_OK : field->class->read(field, level, rect, z, voids, stride);
    if (!tc_field_wraps(field, level) || rect.y0 < 0 || rect.y1 > field->level[level - 1].height)
        return TC_ERR_USAGE;
    tc_status status = TC_OK;
    while (status == TC_OK && !tc_rect_empty(rect)) {
        tc_rect piece = piece_at(field, level, rect);
        int64_t width = piece.x1 - piece.x0;
        status = field->class->read(field, level, piece, z, voids, stride);
        rect.x0 += width;
        z = z ? z + width : NULL;
        voids = voids ? voids + width : NULL;
    }
    return status;
}

bool tc_field_ready(const tc_field *field, int level, tc_rect rect)
{
    rect = cut(field, level, rect);
    return !field->class->ready || tc_rect_empty(rect) || field->class->ready(field, level, rect);
}

void tc_field_range(const tc_field *field, int level, tc_rect rect, float *z_min_ret, float *z_max_ret)
{
    rect = cut(field, level, rect);
    if (tc_rect_empty(rect)) {
        *z_min_ret = field->info.z_min, *z_max_ret = field->info.z_max;
        return;
    }
    *z_min_ret = INFINITY, *z_max_ret = -INFINITY;
    while (!tc_rect_empty(rect)) {
        tc_rect piece = piece_at(field, level, rect);
        float low, high;
        field->class->bounds(field, level, piece, &low, &high);
        *z_min_ret = fminf(*z_min_ret, low), *z_max_ret = fmaxf(*z_max_ret, high);
        rect.x0 += piece.x1 - piece.x0;
    }
}

size_t tc_field_bytes(const tc_field *field)
{
    return field->class->bytes(field);
}

tc_status tc_field_height(const tc_field *field, double x, double y, double *z_ret)
{
    int m = field->info.levels;
    const tc_level *l = &field->level[m - 1];
    bool wraps = tc_field_wraps(field, m);
    double u = x / l->spacing_x;
    u = wraps ? u - floor(u / (double)l->width) * (double)l->width : fmin(fmax(u, 0), (double)(l->width - 1));
    double v = fmin(fmax(y / l->spacing_y, 0), (double)(l->height - 1));
    int64_t i = wraps ? (int64_t)u : tc_clamp64((int64_t)u, 0, tc_max64(l->width - 2, 0));
    int64_t j = tc_max64(0, tc_min64((int64_t)v, l->height - 2));
    tc_rect cell = {i, j, wraps ? i + 2 : tc_min64(i + 2, l->width), tc_min64(j + 2, l->height)};
    float z[4];
    tc_status status = tc_field_read(field, m, cell, z, NULL, 2);
    if (status)
        return status;
    if (cell.x1 - cell.x0 < 2)
        z[1] = z[0], z[3] = z[2];
    if (cell.y1 - cell.y0 < 2)
        z[2] = z[0], z[3] = z[1];
    *z_ret = tc_triangle_height(z[0], z[1], z[2], z[3], u - (double)i, v - (double)j);
    return TC_OK;
}
