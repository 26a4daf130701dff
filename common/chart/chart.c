/* chart.c - the charts of a globe: a grid of longitude and latitude, and the caps laid over it. */
#include "chart.h"

#include <math.h>

#include "common/base/rect.h"
#include "common/base/same_math.h"
#include "common/field/point.h"

tc_chart tc_chart_over(const tc_chart_class *class, tc_field *field, int self, double x0, double y0, double dx,
                       double dy)
{
    const tc_terrain_info *info = tc_field_info(field);
    int64_t width = tc_field_level(field, info->levels).width;
    tc_chart c = {.class = class, .field = field, .x0 = x0, .y0 = y0, .dx = dx, .dy = dy, .wraps = info->wraps_x};
    for (int side = 0; side < TC_SIDES; side++)
        c.side[side] = (tc_seam){.chart = -1};
    if (c.wraps) {
        c.side[TC_WEST] = (tc_seam){.chart = self, .m = {1, 0, 0, 1}, .dx = width};
        c.side[TC_EAST] = (tc_seam){.chart = self, .m = {1, 0, 0, 1}, .dx = -width};
    }
    return c;
}

/* Bilinear; at the sides that of the nearest sample. There is none outside, by more than a sample. */
static tc_status bilinear_height(const tc_chart *c, int level, double x, double y, bool *there_ret, double *z_ret)
{
    tc_level size = tc_field_level(c->field, level);
    double u, v, w = (double)size.width, h = (double)size.height;
    tc_chart_samples(c, level, x, y, &u, &v);
    if (c->class->period > 0 && !(u >= -1 && u <= w)) { /* once more around */
        double turn = c->class->period / ldexp(c->dx, tc_field_info(c->field)->levels - level);
        u -= turn * floor((u + 0.5) / turn);
    }
    *there_ret = (tc_field_wraps(c->field, level) || (u >= -1 && u <= w)) && v >= -1 && v <= h;
    if (!*there_ret)
        return TC_OK;
    tc_cell cell;
    tc_status status = tc_field_cell(c->field, level, u, v, false, &cell);
    if (status == TC_OK)
        *z_ret = tc_cell_bilinear(&cell);
    return status;
}

/* ---- Longitude and latitude -------------------------------------------------------------------------------------- */

static void same(double x, double y, double *x_ret, double *y_ret)
{
    *x_ret = x, *y_ret = y;
}

static double sine_of_latitude(double x, double y)
{
    (void)x;
    return tc_sine(y);
}

const tc_chart_class tc_chart_lonlat = {.name = "lonlat",
                                        .to_place = same,
                                        .from_place = same,
                                        .period = 2 * M_PI,
                                        .sine = sine_of_latitude,
                                        .height = bilinear_height};

/* ---- Caps -------------------------------------------------------------------------------------------------------- */

static void from_place(double longitude, double latitude, double *x_ret, double *y_ret)
{
    double r = 2 * tan((M_PI / 2 - latitude) / 2);
    *x_ret = r * cos(longitude), *y_ret = r * sin(longitude);
}

static void to_place(double x, double y, double *longitude_ret, double *latitude_ret)
{
    *longitude_ret = atan2(y, x);
    *latitude_ret = M_PI / 2 - 2 * atan(0.5 * hypot(x, y));
}

static void from_southern(double longitude, double latitude, double *x_ret, double *y_ret)
{
    from_place(longitude, -latitude, x_ret, y_ret);
}

static void to_southern(double x, double y, double *longitude_ret, double *latitude_ret)
{
    to_place(x, y, longitude_ret, latitude_ret);
    *latitude_ret = -*latitude_ret;
}

/* The radius is 2 tan of half the angle from the pole. */
static double sine(double x, double y)
{
    const double r2 = x * x + y * y;
    return (4 - r2) / (4 + r2);
}

static double southern_sine(double x, double y)
{
    return -sine(x, y);
}

static double share(double sine)
{
    const double lo = TC_CAP_BLEND_START_SINE, hi = TC_CAP_BLEND_END_SINE;
    return fmin(fmax((sine - lo) / (hi - lo), 0), 1);
}

static double southern_share(double sine)
{
    return share(-sine);
}

const tc_chart_class tc_chart_north_cap = {.name = "north cap",
                                           .to_place = to_place,
                                           .from_place = from_place,
                                           .sine = sine,
                                           .share = share,
                                           .height = bilinear_height};
const tc_chart_class tc_chart_south_cap = {.name = "south cap",
                                           .to_place = to_southern,
                                           .from_place = from_southern,
                                           .sine = southern_sine,
                                           .share = southern_share,
                                           .height = bilinear_height};
