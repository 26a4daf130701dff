/* bench_charts.c - maps of the octahedron and of the cube: how alike their triangles are, how far apart their samples,
 * and what is lost in floats between two places near each other. For the choice of common/chart/hex.c and cube.c.
 *
 * Triangles are those of the mesh of one chart, N cells a side, on the unit sphere. `shape` is that of the worst one:
 * its longest edge squared over that of an equilateral triangle of the same area. `density` is how many samples the map
 * takes for each of a grid whose samples are nowhere further apart along x or y, if all of them were as they are in the
 * middle of the equator: (longest spacing / spacing of 4 N samples around the equator)^2 times the samples. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/chart/chart.h"
#include "tests/support/measure.h"

typedef struct map {
    const char *name;
    int charts; /* of which one is looked at */
    void (*place)(double x, double y, double p[3]);
} map;

static void scaled(double p[3], double length)
{
    double s = length / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int i = 0; i < 3; i++)
        p[i] *= s;
}

/* ---- Octahedra --------------------------------------------------------------------------------------------------- */

/* Corners of the half that (x, y) is in, and its shares: of the pole, the first meridian's corner, the second's. */
static double shares(double x, double y, double w[3])
{
    bool north = x + y <= 1;
    w[0] = north ? 1 - x - y : x + y - 1;
    w[1] = north ? x : 1 - y;
    w[2] = north ? y : 1 - x;
    return north ? 1 : -1;
}

static void flat(double x, double y, double p[3])
{
    double w[3], sign = shares(x, y, w);
    p[0] = w[1], p[1] = w[2], p[2] = sign * w[0];
    scaled(p, 1);
}

/* Midpoints of edges along great circles, again and again (HTM), as BN08 has it. */
static void midpoints(double x, double y, double p[3])
{
    double w[3], sign = shares(x, y, w), c[3][3] = {{0, 0, sign}, {1, 0, 0}, {0, 1, 0}};
    for (int depth = 0; depth < 40; depth++) {
        double m[3][3]; /* opposite corner k */
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 3; i++)
                m[k][i] = c[(k + 1) % 3][i] + c[(k + 2) % 3][i];
            scaled(m[k], 1);
        }
        int corner = w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : -1;
        for (int k = 0; k < 3; k++) {
            if (corner < 0)
                w[k] = 1 - 2 * w[k], memcpy(c[k], m[k], sizeof c[k]);
            else if (k != corner)
                w[k] *= 2, memcpy(c[k], m[3 - k - corner], sizeof c[k]);
        }
        if (corner >= 0)
            w[corner] = 1 - w[(corner + 1) % 3] - w[(corner + 2) % 3];
    }
    for (int i = 0; i < 3; i++)
        p[i] = w[0] * c[0][i] + w[1] * c[1][i] + w[2] * c[2][i];
    scaled(p, 1);
}

static void parallels(double x, double y, bool equal_area, double p[3])
{
    double w[3], sign = shares(x, y, w), t = 1 - w[0];
    double theta = equal_area ? 2 * asin(t / M_SQRT2) : t * M_PI / 2, turn = t > 0 ? w[2] / t * M_PI / 2 : 0;
    p[0] = sin(theta) * cos(turn), p[1] = sin(theta) * sin(turn), p[2] = sign * cos(theta);
}

static void even_rows(double x, double y, double p[3])
{
    parallels(x, y, false, p);
}

static void even_areas(double x, double y, double p[3])
{
    parallels(x, y, true, p);
}

/* ---- Cubes ------------------------------------------------------------------------------------------------------- */

static void projected(double a, double b, double p[3])
{
    p[0] = 1, p[1] = a, p[2] = b;
    scaled(p, 1);
}

static void gnomonic(double x, double y, double p[3])
{
    projected(2 * x - 1, 2 * y - 1, p);
}

static void tan_quarter(double x, double y, double p[3])
{
    projected(tan(M_PI / 4 * (2 * x - 1)), tan(M_PI / 4 * (2 * y - 1)), p);
}

static void tan_wider(double x, double y, double p[3])
{
    projected(tan(0.8687 * (2 * x - 1)) / tan(0.8687), tan(0.8687 * (2 * y - 1)) / tan(0.8687), p);
}

static void nowell(double x, double y, double p[3])
{
    double a = 2 * x - 1, b = 2 * y - 1;
    p[0] = sqrt(1 - a * a / 2 - b * b / 2 + a * a * b * b / 3);
    p[1] = a * sqrt(0.5 - b * b / 6);
    p[2] = b * sqrt(0.5 - a * a / 6);
}

static const map maps[] = {{"octahedron, flat", 4, flat},
                           {"octahedron, midpoints (HTM)", 4, midpoints},
                           {"octahedron, parallels, even rows", 4, even_rows},
                           {"octahedron, parallels, equal area", 4, even_areas},
                           {"cube, gnomonic", 6, gnomonic},
                           {"cube, tan, pi/4", 6, tan_quarter},
                           {"cube, tan, 0.8687", 6, tan_wider},
                           {"cube, Nowell", 6, nowell}};

/* ---- Triangles --------------------------------------------------------------------------------------------------- */

typedef struct figures {
    double area, spread, edge, shape, density;
} figures;

static double length(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static figures look(const map *m, int cells)
{
    double(*p)[3] = malloc((size_t)(cells + 1) * (size_t)(cells + 1) * sizeof *p);
    double least = INFINITY, most = 0, sum = 0, squares = 0, shortest = INFINITY, longest = 0, worst = 0, apart = 0;
    if (!p)
        exit(1);
    for (int j = 0; j <= cells; j++)
        for (int i = 0; i <= cells; i++)
            m->place((double)i / cells, (double)j / cells, p[j * (cells + 1) + i]);
    for (int j = 0; j < cells; j++)
        for (int i = 0; i < cells; i++) {
            int at = j * (cells + 1) + i;
            const int corner[2][3] = {{at, at + 1, at + cells + 1}, {at + cells + 2, at + cells + 1, at + 1}};
            for (int k = 0; k < 2; k++) {
                double x = length(p[corner[k][0]], p[corner[k][1]]), y = length(p[corner[k][0]], p[corner[k][2]]),
                       z = length(p[corner[k][1]], p[corner[k][2]]), s = (x + y + z) / 2, e = fmax(fmax(x, y), z),
                       area = sqrt(fmax(s * (s - x) * (s - y) * (s - z), 0));
                least = fmin(least, area), most = fmax(most, area), sum += area, squares += area * area;
                shortest = fmin(shortest, fmin(fmin(x, y), z)), longest = fmax(longest, e);
                worst = fmax(worst, e * e * sqrt(3) / 4 / area), apart = fmax(apart, fmax(x, y));
            }
        }
    free(p);
    double count = 2.0 * cells * cells, mean = sum / count, equator = M_PI / 2 / cells;
    return (figures){most / least, sqrt(fmax(squares / count - mean * mean, 0)) / mean, longest / shortest, worst,
                     apart * apart / (equator * equator) * m->charts / 8};
}

/* ---- There and back, and without cancellation ---------------------------------------------------------------------
 */

static double uniform(int n)
{
    return (double)(tc_hash64(5, (uint64_t)n) >> 11) / 9007199254740992.0;
}

/* The furthest that from_place(to_place()) is off, in samples of a chart of 2^22 a side: also next to its corners. */
static double inverse(const tc_chart_class *class, int pairs)
{
    const tc_chart c = {.class = class};
    double off = 0, lon, lat, u, v;
    for (int n = 0; n < pairs; n++) {
        double near = n % 2 ? exp2(-30 * uniform(3 * n + 2)) : 1, x = near * uniform(3 * n),
               y = near * uniform(3 * n + 1);
        class->to_place(&c, x, y, &lon, &lat);
        class->from_place(&c, lon, lat, &u, &v);
        off = fmax(off, fmax(fabs(u - x), fabs(v - y)));
    }
    return ldexp(off, 22);
}

enum { SIDE = 1 << 22 }; /* samples of a chart */

/* From vertex v to vertex v + d of a sheared chart, in the frame of v's meridian (east, south, up), in floats but for
 * the numerator, which is whole numbers; unit sphere. */
static void sheared_way(const int64_t v[2], const int64_t d[2], float way[3])
{
    int64_t s_v = v[0] + v[1], s = s_v + d[0] + d[1];
    double theta_v = 2 * asin((double)s_v / SIDE / M_SQRT2); /* the viewer's, once a frame */
    float sin_v = (float)sin(theta_v), cos_v = (float)cos(theta_v), t_v = (float)((double)s_v / SIDE),
          dt = (float)(d[0] + d[1]) / SIDE, t = t_v + dt;
    float turn = (float)M_PI / 2 * ((float)(d[1] * s_v - v[1] * (d[0] + d[1])) / ((float)s * (float)s_v));
    /* z = 1 - t^2, rho = t sqrt(2 - t^2): their changes are products with dt. */
    float rho = t * sqrtf(2 - t * t), dz = -dt * (t + t_v), half = sinf(turn / 2);
    float drho = dt * (t + t_v) * (2 - t * t - t_v * t_v) / (rho + sin_v);
    float inward = 2 * rho * half * half; /* towards the axis, by turning */
    way[0] = rho * sinf(turn);
    way[1] = cos_v * (drho - inward) - sin_v * dz;
    way[2] = sin_v * (drho - inward) + cos_v * dz;
}

/* The same on a face of the cube, in the face's own axes. */
static void face_way(const int64_t v[2], const int64_t d[2], float way[3])
{
    float q[2], dq[2];
    for (int i = 0; i < 2; i++) {
        double at = M_PI / 4 * (2 * (double)v[i] / SIDE - 1);
        float step = (float)(M_PI / 2) * ((float)d[i] / SIDE), tv = (float)tan(at);
        /* tan(a + b) - tan(a) = sin b / (cos a (cos a cos b - sin a sin b)) */
        float ca = (float)cos(at), sa = (float)sin(at), sb = sinf(step), half = sinf(step / 2),
              cb = 1 - 2 * half * half;
        dq[i] = sb / (ca * (ca * cb - sa * sb)), q[i] = tv;
    }
    float l_v = sqrtf(1 + q[0] * q[0] + q[1] * q[1]);
    float a = q[0] + dq[0], b = q[1] + dq[1], l = sqrtf(1 + a * a + b * b);
    float change = -(dq[0] * (a + q[0]) + dq[1] * (b + q[1])) / (l * l_v * (l + l_v)); /* of 1 / length */
    way[0] = change, way[1] = dq[0] / l + q[0] * change, way[2] = dq[1] / l + q[1] * change;
}

typedef void way_function(const int64_t v[2], const int64_t d[2], float way[3]);

static void exact_sheared(const int64_t v[2], long double p[3])
{
    long double s = (long double)(v[0] + v[1]) / SIDE, rho = s * sqrtl(2 - s * s),
                turn = 1.57079632679489661923L * ((long double)v[1] / (v[0] + v[1]));
    p[0] = rho * cosl(turn), p[1] = rho * sinl(turn), p[2] = 1 - s * s;
}

static void exact_face(const int64_t v[2], long double p[3])
{
    long double a = tanl(0.785398163397448309616L * (2 * (long double)v[0] / SIDE - 1)),
                b = tanl(0.785398163397448309616L * (2 * (long double)v[1] / SIDE - 1)), l = sqrtl(1 + a * a + b * b);
    p[0] = 1 / l, p[1] = a / l, p[2] = b / l;
}

/* The largest error of a length between random pairs, over the length: pairs from a sample to half a chart apart. */
static double cancellation(way_function *way, void (*exact)(const int64_t v[2], long double p[3]), bool pole, int pairs)
{
    double most = 0;
    for (int n = 0; n < pairs; n++) {
        double reach = exp2(22 * uniform(5 * n)) / 2, at = pole ? SIDE / 2 * exp2(-20 * uniform(5 * n + 1)) : SIDE / 2;
        int64_t v[2] = {(int64_t)(at * uniform(5 * n + 2)), (int64_t)(at * uniform(5 * n + 3)) + 1};
        double angle = 2 * M_PI * uniform(5 * n + 4);
        int64_t d[2] = {(int64_t)(reach * cos(angle)), (int64_t)(reach * sin(angle))};
        int64_t w[2] = {v[0] + d[0], v[1] + d[1]};
        if ((d[0] == 0 && d[1] == 0) || w[0] < 0 || w[1] < 0 || w[0] > SIDE || w[1] > SIDE ||
            (pole && w[0] + w[1] > SIDE))
            continue;
        float found[3];
        long double p[3], q[3], length2 = 0, found2 = 0;
        exact(v, p), exact(w, q), way(v, d, found);
        for (int i = 0; i < 3; i++)
            length2 += (q[i] - p[i]) * (q[i] - p[i]), found2 += (long double)found[i] * found[i];
        most = fmax(most, (double)fabsl(sqrtl(found2 / length2) - 1));
    }
    return most;
}

int main(int argc, char **argv)
{
    measure_options options =
        measure_begin(argc, argv, "map,charts,cells,area_ratio,area_spread,edge_ratio,worst_shape,density");
    int cells = options.quick ? 64 : 256, pairs = options.quick ? 20000 : 1000000;
    printf("%-36s %7s %7s %7s %7s %8s\n", "map", "area", "spread", "edges", "shape", "density");
    for (size_t k = 0; k < sizeof maps / sizeof *maps; k++) {
        figures f = look(&maps[k], cells);
        printf("%-36s %7.2f %7.3f %7.2f %7.2f %8.2f\n", maps[k].name, f.area, f.spread, f.edge, f.shape, f.density);
        if (options.csv) {
            measure_put_text(options.csv, maps[k].name);
            fprintf(options.csv, ",%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f\n", maps[k].charts, cells, f.area, f.spread, f.edge,
                    f.shape, f.density);
        }
    }
    printf("there and back, samples of 2^22 a side: hex %.1e, cube %.1e\n", inverse(&tc_chart_hex, pairs),
           inverse(&tc_chart_cube, pairs));
    printf("between two vertices in floats, of their distance: hex %.1e, cube %.1e\n",
           cancellation(sheared_way, exact_sheared, true, pairs), cancellation(face_way, exact_face, false, pairs));
    return measure_end(&options);
}
