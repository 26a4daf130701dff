/* atlas_height.c - the height of a planet at a place: the charts' finest levels, mixed where caps take over. */
#include "atlas.h"

#include <math.h>

#include "common/base/rect.h"
#include "common/field/field.h"

#define DEGREE (M_PI / 180)

/* Bilinear; at the sides that of the nearest sample. False outside, by more than a sample. */
static tc_status chart_height(const tc_chart *c, double x, double y, bool *there_ret, double *z_ret)
{
    int m = tc_field_info(c->field)->levels;
    tc_level size = tc_field_level(c->field, m);
    double u = (x - c->x0) / c->dx, v = (y - c->y0) / c->dy, w = (double)size.width, h = (double)size.height;
    if (c->projection == TC_LONLAT && !(u >= -1 && u <= w)) /* once more around */
        u -= 2 * M_PI / c->dx * floor((u + 0.5) / (2 * M_PI / c->dx));
    *there_ret = (c->wraps || (u >= -1 && u <= w)) && v >= -1 && v <= h;
    if (!*there_ret)
        return TC_OK;
    if (!c->wraps)
        u = fmin(fmax(u, 0), w - 1);
    v = fmin(fmax(v, 0), h - 1);
    int64_t i = (int64_t)floor(u), j = tc_min64((int64_t)floor(v), tc_max64(size.height - 2, 0));
    if (!c->wraps)
        i = tc_min64(i, tc_max64(size.width - 2, 0));
    tc_rect cell = {i, j, i + 2, tc_min64(j + 2, size.height)};
    if (!c->wraps)
        cell.x1 = tc_min64(cell.x1, size.width);
    float z[4];
    tc_status status = tc_field_read(c->field, m, cell, z, NULL, 2);
    if (status)
        return status;
    if (cell.x1 - cell.x0 < 2)
        z[1] = z[0], z[3] = z[2];
    if (cell.y1 - cell.y0 < 2)
        z[2] = z[0], z[3] = z[1];
    double tx = u - (double)i, ty = v - (double)j, south = z[0] + tx * ((double)z[1] - z[0]);
    *z_ret = south + ty * (z[2] + tx * ((double)z[3] - z[2]) - south);
    return TC_OK;
}

void tc_atlas_weights(int charts, double z, double weight_ret[TC_MAX_CHARTS])
{
    const double lo = sin(TC_CAP_BLEND_START * DEGREE), hi = sin(TC_CAP_BLEND_END * DEGREE);
    weight_ret[0] = 1, weight_ret[1] = weight_ret[2] = 0;
    if (charts < TC_MAX_CHARTS)
        return;
    weight_ret[1] = fmin(fmax((z - lo) / (hi - lo), 0), 1);
    weight_ret[2] = fmin(fmax((-z - lo) / (hi - lo), 0), 1);
    weight_ret[0] = 1 - weight_ret[1] - weight_ret[2];
}

tc_status tc_atlas_height(const tc_atlas *atlas, double longitude, double latitude, double *z_ret)
{
    double weight[TC_MAX_CHARTS], z = 0;
    tc_atlas_weights(atlas->charts, sin(latitude), weight);
    for (int k = 0; k < atlas->charts; k++) {
        const tc_chart *c = &atlas->chart[k];
        double x = longitude, y = latitude, part = -tc_field_info(c->field)->z_base;
        bool there = false;
        if (weight[k] <= 0)
            continue;
        if (c->projection != TC_LONLAT) {
            double r = 2 * tan((M_PI / 2 - (c->projection == TC_CAP_NORTH ? latitude : -latitude)) / 2);
            x = r * cos(longitude), y = r * sin(longitude);
        }
        tc_status status = chart_height(c, x, y, &there, &part);
        if (status)
            return status;
        z += weight[k] * part;
    }
    *z_ret = z;
    return TC_OK;
}
