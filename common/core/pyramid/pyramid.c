/* pyramid.c - what is the same for every kind of pyramid. */
#include "pyramid.h"

#include <math.h>

#include "filter.h"
#include "common/core/base/mesh.h"
#include "common/core/base/rect.h"

void tc_pyramid_set_levels(tc_pyramid *pyramid, tc_level finest)
{
    int levels = 1;
    for (int64_t size = tc_max64(finest.width, finest.height); size > 1; size = tc_coarse_size(size))
        levels++;
    pyramid->info.levels = levels;
    pyramid->level[levels - 1] = finest;
    for (int l = levels - 1; l >= 1; l--) {
        tc_level f = pyramid->level[l];
        pyramid->level[l - 1] =
            (tc_level){tc_coarse_size(f.width), tc_coarse_size(f.height), 2 * f.spacing_x, 2 * f.spacing_y};
    }
}

void tc_pyramid_destroy(tc_pyramid *pyramid)
{
    if (pyramid)
        pyramid->class->destroy(pyramid);
}

const tc_terrain_info *tc_pyramid_info(const tc_pyramid *pyramid)
{
    return &pyramid->info;
}

tc_level tc_pyramid_level(const tc_pyramid *pyramid, int level)
{
    return pyramid->level[level - 1];
}

static tc_rect level_rect(const tc_pyramid *pyramid, int level)
{
    const tc_level *l = &pyramid->level[level - 1];
    return (tc_rect){0, 0, l->width, l->height};
}

tc_status tc_pyramid_read(const tc_pyramid *pyramid, int level, tc_rect rect, float *z, uint8_t *voids,
                          ptrdiff_t stride)
{
    if (level < 1 || level > pyramid->info.levels || !tc_rect_within(rect, level_rect(pyramid, level)))
        return TC_ERR_USAGE;
    return tc_rect_empty(rect) ? TC_OK : pyramid->class->read(pyramid, level, rect, z, voids, stride);
}

bool tc_pyramid_ready(const tc_pyramid *pyramid, int level, tc_rect rect)
{
    rect = tc_rect_intersect(rect, level_rect(pyramid, level));
    return !pyramid->class->ready || tc_rect_empty(rect) || pyramid->class->ready(pyramid, level, rect);
}

void tc_pyramid_bounds(const tc_pyramid *pyramid, int level, tc_rect rect, float *z_min_ret, float *z_max_ret)
{
    rect = tc_rect_intersect(rect, level_rect(pyramid, level));
    if (tc_rect_empty(rect))
        *z_min_ret = pyramid->info.z_min, *z_max_ret = pyramid->info.z_max;
    else
        pyramid->class->bounds(pyramid, level, rect, z_min_ret, z_max_ret);
}

size_t tc_pyramid_bytes(const tc_pyramid *pyramid)
{
    return pyramid->class->bytes(pyramid);
}

tc_status tc_pyramid_height(const tc_pyramid *pyramid, double x, double y, double *z_ret)
{
    int m = pyramid->info.levels;
    const tc_level *l = &pyramid->level[m - 1];
    double u = fmin(fmax(x / l->spacing_x, 0), (double)(l->width - 1));
    double v = fmin(fmax(y / l->spacing_y, 0), (double)(l->height - 1));
    int64_t i = tc_max64(0, tc_min64((int64_t)u, l->width - 2)), j = tc_max64(0, tc_min64((int64_t)v, l->height - 2));
    tc_rect cell = {i, j, tc_min64(i + 2, l->width), tc_min64(j + 2, l->height)};
    float z[4];
    tc_status status = tc_pyramid_read(pyramid, m, cell, z, NULL, 2);
    if (status)
        return status;
    if (cell.x1 - cell.x0 < 2)
        z[1] = z[0], z[3] = z[2];
    if (cell.y1 - cell.y0 < 2)
        z[2] = z[0], z[3] = z[1];
    *z_ret = tc_triangle_height(z[0], z[1], z[2], z[3], u - (double)i, v - (double)j);
    return TC_OK;
}
