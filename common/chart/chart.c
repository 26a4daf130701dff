/* chart.c - what charts have in common; a grid of longitude and latitude, and the caps laid over it. */
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
    c.face = class->seam ? self : 0;
    for (int side = 0; side < TC_SIDES; side++)
        c.side[side] = class->seam ? class->seam(self, side, width - 1) : (tc_seam){.chart = -1};
    if (c.wraps) {
        c.side[TC_WEST] = (tc_seam){.chart = self, .m = {1, 0, 0, 1}, .dx = width};
        c.side[TC_EAST] = (tc_seam){.chart = self, .m = {1, 0, 0, 1}, .dx = -width};
    }
    return c;
}

tc_chart tc_chart_face(const tc_chart_class *class, tc_field *field, int face)
{
    double cells = (double)(tc_field_level(field, tc_field_info(field)->levels).width - 1);
    return tc_chart_over(class, field, face, 0, 0, 1 / cells, 1 / cells);
}

void tc_chart_shares(const tc_chart *chart, int charts, const double normal[3], double *share_ret)
{
    share_ret[0] = 1;
    for (int k = 1; k < charts; k++) {
        const tc_chart *c = &chart[k];
        share_ret[0] -= share_ret[k] = c->class->share ? c->class->share(c, normal) : 0;
    }
}

double tc_chart_face_spacing(double radius, int64_t cells)
{
    return M_PI / 2 * radius / (double)cells;
}

int64_t tc_chart_cells(int64_t least)
{
    int halvings = 1;
    while (tc_ceil_shift(least, halvings) > TC_MOST_CELLS)
        halvings++;
    return tc_ceil_shift(least, halvings) << halvings;
}

tc_status tc_chart_mesh_height(const tc_chart *c, int level, double x, double y, bool *there_ret, double *z_ret)
{
    tc_level size = tc_field_level(c->field, level);
    double u, v;
    tc_chart_samples(c, level, x, y, &u, &v);
    *there_ret = u >= -1 && u <= (double)size.width && v >= -1 && v <= (double)size.height;
    return *there_ret ? tc_field_mesh_height(c->field, level, u, v, z_ret) : TC_OK;
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

static void same(const tc_chart *c, double x, double y, double *x_ret, double *y_ret)
{
    (void)c;
    *x_ret = x, *y_ret = y;
}

static double sine_of_latitude(const tc_chart *c, double x, double y)
{
    (void)c, (void)x;
    return tc_sine(y);
}

static void along_parallels(const tc_chart *c, double x, double y, double *along_x_ret, double *along_y_ret,
                            double *area_ret)
{
    (void)c, (void)x;
    *along_x_ret = *area_ret = cos(y), *along_y_ret = 1;
}

const tc_chart_class tc_chart_lonlat = {.name = "lonlat",
                                        .to_place = same,
                                        .from_place = same,
                                        .period = 2 * M_PI,
                                        .sine = sine_of_latitude,
                                        .spread = along_parallels,
                                        .height = bilinear_height};

/* ---- Caps -------------------------------------------------------------------------------------------------------- */

static void from_place(const tc_chart *c, double longitude, double latitude, double *x_ret, double *y_ret)
{
    (void)c;
    double r = 2 * tan((M_PI / 2 - latitude) / 2);
    *x_ret = r * cos(longitude), *y_ret = r * sin(longitude);
}

static void to_place(const tc_chart *c, double x, double y, double *longitude_ret, double *latitude_ret)
{
    (void)c;
    *longitude_ret = atan2(y, x);
    *latitude_ret = M_PI / 2 - 2 * atan(0.5 * hypot(x, y));
}

static void from_southern(const tc_chart *c, double longitude, double latitude, double *x_ret, double *y_ret)
{
    from_place(c, longitude, -latitude, x_ret, y_ret);
}

static void to_southern(const tc_chart *c, double x, double y, double *longitude_ret, double *latitude_ret)
{
    to_place(c, x, y, longitude_ret, latitude_ret);
    *latitude_ret = -*latitude_ret;
}

/* The radius is 2 tan of half the angle from the pole. */
static double sine(const tc_chart *c, double x, double y)
{
    (void)c;
    const double r2 = x * x + y * y;
    return (4 - r2) / (4 + r2);
}

static double southern_sine(const tc_chart *c, double x, double y)
{
    return -sine(c, x, y);
}

/* Conformal. */
static void spread(const tc_chart *c, double x, double y, double *along_x_ret, double *along_y_ret, double *area_ret)
{
    (void)c;
    *along_x_ret = *along_y_ret = 4 / (4 + x * x + y * y);
    *area_ret = *along_x_ret * *along_y_ret;
}

static double share_above(double height)
{
    const double lo = TC_CAP_BLEND_START_SINE, hi = TC_CAP_BLEND_END_SINE;
    return fmin(fmax((height - lo) / (hi - lo), 0), 1);
}

static double share(const tc_chart *c, const double normal[3])
{
    (void)c;
    return share_above(normal[2]);
}

static double southern_share(const tc_chart *c, const double normal[3])
{
    (void)c;
    return share_above(-normal[2]);
}

const tc_chart_class tc_chart_north_cap = {.name = "north cap",
                                           .to_place = to_place,
                                           .from_place = from_place,
                                           .sine = sine,
                                           .share = share,
                                           .spread = spread,
                                           .height = bilinear_height};
const tc_chart_class tc_chart_south_cap = {.name = "south cap",
                                           .to_place = to_southern,
                                           .from_place = from_southern,
                                           .sine = southern_sine,
                                           .share = southern_share,
                                           .spread = spread,
                                           .height = bilinear_height};
