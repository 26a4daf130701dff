/* cube.c - the six faces of a cube, projected from its middle after a warp that makes samples as far apart as can be:
 * faces 0 to 3 lie around the equator with their middles at longitude 90 k degrees, 4 is north, 5 south.
 *
 *     q = c + A e_x + B e_y,    A = tan(kappa (2 x - 1)) / tan kappa,    B = tan(kappa (2 y - 1)) / tan kappa
 *
 * with the axes of the table below: x east and y north on faces 0 to 3; all are right-handed, seen from outside. The
 * warp is odd, so that neighbours' samples on a side are the same places. */
#include <math.h>

#include "chart.h"

/* The largest cell has 1.4 times the area of the smallest, 5.2 times without a warp. A larger angle, 0.8687, makes
 * it 1.3, but samples along an edge then are further apart in its middle than they are in the middle of the face: for
 * nowhere more than a given spacing it takes a quarter more of them (bench_charts). */
static const double kappa = M_PI / 4, tangent = 1; /* and its tangent; shaders/chart_cube.glsl has the same built in */

enum { FACES = 6 };
typedef struct axes {
    int8_t c[3], x[3], y[3];
} axes;
static const axes face_axes[FACES] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
                                      {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                      {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},  {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}};

static double along(const int8_t axis[3], const double q[3])
{
    return axis[0] * q[0] + axis[1] * q[1] + axis[2] * q[2];
}

static int dot(const int8_t a[3], const int8_t b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double warp(double x)
{
    return tan(kappa * (2 * x - 1)) / tangent;
}

/* On the face's plane. */
static void on_plane(const tc_chart *chart, double x, double y, double q[3])
{
    const axes *f = &face_axes[chart->face];
    const double a = warp(x), b = warp(y);
    for (int i = 0; i < 3; i++)
        q[i] = f->c[i] + a * f->x[i] + b * f->y[i];
}

static void normal(const tc_chart *chart, double x, double y, double n[3])
{
    double q[3];
    on_plane(chart, x, y, q);
    const double l = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    for (int i = 0; i < 3; i++)
        n[i] = q[i] / l;
}

static void to_place(const tc_chart *chart, double x, double y, double *longitude_ret, double *latitude_ret)
{
    double q[3];
    on_plane(chart, x, y, q);
    *longitude_ret = atan2(q[1], q[0]);
    *latitude_ret = atan2(q[2], hypot(q[0], q[1]));
}

/* Behind the face's middle plane the angle goes on, too. */
static void from_place(const tc_chart *chart, double longitude, double latitude, double *x_ret, double *y_ret)
{
    const axes *f = &face_axes[chart->face];
    double q[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)}, c = along(f->c, q);
    *x_ret = 0.5 + atan2(tangent * along(f->x, q), c) / (2 * kappa);
    *y_ret = 0.5 + atan2(tangent * along(f->y, q), c) / (2 * kappa);
}

static void spread(const tc_chart *chart, double x, double y, double *along_x_ret, double *along_y_ret,
                   double *area_ret)
{
    (void)chart;
    double a = warp(x), b = warp(y), l2 = 1 + a * a + b * b;
    double da = 2 * kappa / tangent * (1 + a * a * tangent * tangent),
           db = 2 * kappa / tangent * (1 + b * b * tangent * tangent);
    *along_x_ret = da * sqrt(1 + b * b) / l2, *along_y_ret = db * sqrt(1 + a * a) / l2;
    *area_ret = da * db / (l2 * sqrt(l2));
}

/* The face whose axis is nearest has all of it; of several the first. */
static double share(const tc_chart *chart, const double n[3])
{
    int nearest = 0;
    for (int k = 1; k < FACES; k++)
        if (along(face_axes[k].c, n) > along(face_axes[nearest].c, n))
            nearest = k;
    return nearest == chart->face;
}

/* Across a side, whose outward axis is the neighbour's middle: there a point of this face's plane, `beyond` cells
 * further, is the middle less so much of this face's own axis. */
static tc_seam seam(int face, int side, int64_t cells)
{
    const axes *f = &face_axes[face], *g = NULL;
    bool along_x = side == TC_WEST || side == TC_EAST;
    int sign = side == TC_WEST || side == TC_SOUTH ? -1 : 1, k = 0;
    const int8_t *out = along_x ? f->x : f->y, *edge = along_x ? f->y : f->x;
    while (dot(face_axes[k].c, out) != sign)
        k++;
    g = &face_axes[k];
    tc_seam s = {.chart = k};
    int64_t *shift[2] = {&s.dx, &s.dy};
    for (int axis = 0; axis < 2; axis++) {
        const int8_t *own = axis == 0 ? g->x : g->y;
        int middle = dot(f->c, own), across = dot(edge, own);
        /* cells / 2 (1 + middle - across), less middle times the cells beyond, and across times those along the edge */
        s.m[2 * axis + (along_x ? 0 : 1)] = (int8_t)(-sign * middle);
        s.m[2 * axis + (along_x ? 1 : 0)] = (int8_t)across;
        *shift[axis] = cells * (1 + middle - across) / 2 + (sign > 0 ? middle * cells : 0);
    }
    return s;
}

const tc_chart_class tc_chart_cube = {.name = "cube",
                                      .glsl = "chart_cube.glsl",
                                      .to_place = to_place,
                                      .from_place = from_place,
                                      .normal = normal,
                                      .share = share,
                                      .spread = spread,
                                      .seam = seam,
                                      .height = tc_chart_mesh_height};
