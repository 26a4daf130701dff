/* plane.c - the plane as a body, and its one chart. */
#include <string.h>

#include "chart.h"
#include "common/field/point.h"

/* ---- The body ---------------------------------------------------------------------------------------------------- */

static void position(const tc_body *body, const double place[3], double p_ret[3])
{
    (void)body;
    memcpy(p_ret, place, 3 * sizeof *place);
}

static void normal(const tc_body *body, const double place[3], double n_ret[3])
{
    (void)body, (void)place;
    n_ret[0] = n_ret[1] = 0, n_ret[2] = 1;
}

static bool place_of(const tc_body *body, const double p[3], double place_ret[3])
{
    position(body, p, place_ret);
    return true;
}

static void axes(const tc_body *body, const double place[3], double axes_ret[3][3])
{
    static const double own[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    (void)body, (void)place;
    memcpy(axes_ret, own, sizeof own);
}

static void beside(const tc_body *body, const double from[3], const double way[3], double place_ret[3])
{
    (void)body;
    for (int i = 0; i < 3; i++)
        place_ret[i] = from[i] + way[i];
}

static tc_status check_relief(const tc_body *body, const char *name, double z_min, double z_max, tc_error *error)
{
    (void)body, (void)name, (void)z_min, (void)z_max, (void)error;
    return TC_OK;
}

const tc_body_class tc_plane_body = {.name = "plane",
                                     .position = position,
                                     .normal = normal,
                                     .place = place_of,
                                     .axes = axes,
                                     .beside = beside,
                                     .check_relief = check_relief};

/* ---- The chart --------------------------------------------------------------------------------------------------- */

static void same(const tc_chart *c, double x, double y, double *x_ret, double *y_ret)
{
    (void)c;
    *x_ret = x, *y_ret = y;
}

/* Beside the terrain that of its nearest point. */
static tc_status height(const tc_chart *c, int level, double x, double y, bool *there_ret, double *z_ret)
{
    double u, v;
    tc_chart_samples(c, level, x, y, &u, &v);
    *there_ret = true;
    return tc_field_mesh_height(c->field, level, u, v, z_ret);
}

const tc_chart_class tc_chart_plane = {.name = "flat", .to_place = same, .from_place = same, .height = height};
