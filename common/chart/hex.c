/* hex.c - four sheared charts of an octahedron (BN08: Bhattacharjee, Narayanan, "Hexagonal Geometry Clipmaps for
 * Spherical Terrain Rendering", 2008): chart k has the triangles north and south between the meridians 90 k and
 * 90 (k + 1) degrees, joined along the equator.
 *
 * Corner (0, 0) is the north pole, (1, 1) the south pole; (1, 0) and (0, 1) are on the equator at longitudes 90 k and
 * 90 (k + 1) degrees. Rows x + y lie along parallels:
 *
 *     north, x + y <= 1    t = x + y,        z = 1 - t^2,      longitude = pi/2 (k + y / t)
 *     south                t = 2 - x - y,    z = -(1 - t^2),   longitude = pi/2 (k + (1 - x) / t)
 *
 * with z the sine of latitude: so all cells have the same area, to within what chords leave out. BN08 halves edges
 * along great circles (HTM), whose triangles differ by a factor of two, and whose inverse is a search; this one's takes
 * a root and an arctangent. Neither has a singular sample: a pole is one vertex of each chart.
 *
 * Beyond the sides the formulas go on: across a meridian to the neighbour's own samples in the same row, and past a
 * pole with t < 0 to the meridian on its other side. */
#include <math.h>

#include "chart.h"

enum { CHARTS = 4 };

/* The colatitude of t from its pole: sin(theta / 2) = t / sqrt 2, of the sign of t. */
static double colatitude(double t)
{
    return 2 * asin(fmin(fmax(t / M_SQRT2, -1), 1));
}

static void to_place(const tc_chart *c, double x, double y, double *longitude_ret, double *latitude_ret)
{
    bool north = x + y <= 1;
    double t = north ? x + y : (1 - x) + (1 - y), turn = north ? y : 1 - x;
    double theta = colatitude(t), longitude = M_PI / 2 * (c->face + (t != 0 ? turn / t : 0.5));
    if (theta < 0) /* through the pole */
        theta = -theta, longitude += M_PI;
    *longitude_ret = longitude;
    *latitude_ret = north ? M_PI / 2 - theta : theta - M_PI / 2;
}

static void normal(const tc_chart *c, double x, double y, double n[3])
{
    const bool north = x + y <= 1;
    const double t = north ? x + y : (1 - x) + (1 - y), turn = north ? y : 1 - x;
    const double longitude = M_PI / 2 * (c->face + (t != 0 ? turn / t : 0.5)), rho = t * sqrt(fmax(2 - t * t, 0));
    n[0] = rho * cos(longitude), n[1] = rho * sin(longitude), n[2] = north ? 1 - t * t : t * t - 1;
}

static void from_place(const tc_chart *c, double longitude, double latitude, double *x_ret, double *y_ret)
{
    double t = M_SQRT2 * sin((M_PI / 2 - fabs(latitude)) / 2), turn = longitude / (M_PI / 2) - c->face;
    turn -= CHARTS * floor((turn + 1.5) / CHARTS); /* the way round on which it is nearer: -1.5 to 2.5 */
    *x_ret = latitude >= 0 ? t * (1 - turn) : 1 - t * turn;
    *y_ret = latitude >= 0 ? t * turn : 1 - t * (1 - turn);
}

/* East by rho of the longitude, south by theta; the area is the same everywhere, a quarter of the sphere. */
static void spread(const tc_chart *c, double x, double y, double *along_x_ret, double *along_y_ret, double *area_ret)
{
    (void)c;
    bool north = x + y <= 1;
    double t = north ? x + y : (1 - x) + (1 - y), u = north ? x : 1 - x, v = north ? y : 1 - y, root = sqrt(2 - t * t);
    double east = M_PI / 2 * root / (t != 0 ? t : 1), south = 2 / root; /* next to the pole u and v are as t */
    *along_x_ret = hypot(east * v, south), *along_y_ret = hypot(east * u, south);
    *area_ret = M_PI;
}

/* Between its two meridians; on one of them that of the lower number has all of it, at the poles chart 0. */
static double share(const tc_chart *c, const double n[3])
{
    int k = n[1] >= 0 ? (n[0] >= 0 ? 0 : 1) : n[0] <= 0 ? 2 : 3;
    return k == c->face;
}

/* Rows of the northern half go on across x < 0 and y < 0, those of the southern one across x > 1 and y > 1. */
static tc_seam seam(int face, int side, int64_t cells)
{
    int next = (face + 1) % CHARTS, previous = (face + CHARTS - 1) % CHARTS;
    const tc_seam seams[TC_SIDES] = {[TC_WEST] = {next, {2, 1, -1, 0}, 0, 0},
                                     [TC_EAST] = {previous, {2, 1, -1, 0}, -2 * cells, 2 * cells},
                                     [TC_SOUTH] = {previous, {0, -1, 1, 2}, 0, 0},
                                     [TC_NORTH] = {next, {0, -1, 1, 2}, 2 * cells, -2 * cells}};
    return seams[side];
}

/* Along the meridian; y - x is along the parallel. */
static double turn(double x, double y)
{
    const bool north = x + y <= 1;
    const double t = north ? x + y : 2 - x - y;
    return t > 0 ? fmin(fmax((north ? y : 1 - x) / t, 0), 1) : 0.5;
}

const tc_chart_class tc_chart_hex = {.name = "hex",
                                     .glsl = "chart_hex.glsl",
                                     .to_place = to_place,
                                     .from_place = from_place,
                                     .normal = normal,
                                     .share = share,
                                     .spread = spread,
                                     .turn = turn,
                                     .seam = seam,
                                     .height = tc_chart_mesh_height};
