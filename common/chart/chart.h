/* chart.h - charts: rectangles of samples, each with a field of its own, that a map is made of.
 *
 *   flat                   metres east and north on a plane
 *   lonlat                 longitude and latitude, radians: the source's own grid; once around the globe it wraps
 *   north cap, south cap   stereographic, around a pole, made from a grid of longitude and latitude
 *   hex                    one of four sheared charts, two triangles of an octahedron each (hex.c)
 *   cube                   one of the six faces of a cube (cube.c)
 *
 * Towards a pole a grid of longitude and latitude has ever more samples a metre along its parallels, and ends at a
 * point. Within a cap samples are a square lattice, equally far apart in all directions to within 12 %: nothing happens
 * at the pole.
 *
 * Chart coordinates, radians or lengths on the unit sphere, of longitude lambda and latitude phi:
 *   lonlat       x = lambda, y = phi
 *   north cap    x = 2 tan(theta/2) cos(lambda), y = 2 tan(theta/2) sin(lambda), theta = pi/2 - phi
 *   south cap    the same with theta = pi/2 + phi
 *   hex, cube    x, y from 0 to 1 within the chart's sides; beyond them the same formulas go on
 * Sample (i, j) of the finest level lies at (x0 + i dx, y0 + j dy). */
#ifndef TC_CHART_H
#define TC_CHART_H

#include <math.h>

#include "body.h"

typedef struct tc_chart tc_chart;

/* What is beyond a side: sample (i, j) is sample m (i, j) + (dx, dy) of another chart, or of the same. On the side
 * itself both are one sample of both charts; further on it is so to within how the maps differ (exact for hex within
 * its halves, of a cube only on the side). */
typedef struct tc_seam {
    int chart;   /* of the map; negative: nothing, heights end */
    int8_t m[4]; /* row by row */
    int64_t dx, dy;
} tc_seam;

typedef struct tc_chart_class {
    const char *name;
    const char *glsl; /* file of shaders/ that says the same to a shader; NULL: none */
    /* From chart coordinates to the body's place (body.h), and back; of a place that is not on the chart those where
     * its formulas go on, as far as they do. */
    void (*to_place)(const tc_chart *chart, double x, double y, double *place_x_ret, double *place_y_ret);
    void (*from_place)(const tc_chart *chart, double place_x, double place_y, double *x_ret, double *y_ret);
    /* The unit normal of the place, by fewer functions of angles than by to_place; NULL: nobody needs it. */
    void (*normal)(const tc_chart *chart, double x, double y, double normal_ret[3]);
    double period; /* x comes round again; 0: never */
    /* Sine of the latitude at chart coordinates, of the same bits on every machine; NULL: nobody needs it, since charts
     * of this kind share no place but their sides. */
    double (*sine)(const tc_chart *chart, double x, double y);
    /* Share of the height at a place, by the unit normal there; of those laid over others (caps) its z alone, the sine
     * of the latitude, is looked at. NULL: it has what is left. */
    double (*share)(const tc_chart *chart, const double normal[3]);
    /* On the unit sphere: how long a unit of x and one of y are there, and the area of a unit of both. NULL: a plane's.
     */
    void (*spread)(const tc_chart *chart, double x, double y, double *along_x_ret, double *along_y_ret,
                   double *area_ret);
    /* Of charts whose axes meet at an angle across a seam: the share f of y at chart coordinates with which
     * (1 - f) x + f y is a direction that both sides have, as y - x is; 0 and 1 on sides. NULL: there are none. */
    double (*turn)(double x, double y);
    /* What is beyond a side of chart `face` of so many cells a side. NULL: nothing, or the other end of what wraps. */
    tc_seam (*seam)(int face, int side, int64_t cells);
    /* Height of a level at chart coordinates, metres above z_base; *there_ret: there is one. */
    tc_status (*height)(const tc_chart *chart, int level, double x, double y, bool *there_ret, double *z_ret);
} tc_chart_class;

extern const tc_chart_class tc_chart_plane, tc_chart_lonlat, tc_chart_north_cap, tc_chart_south_cap, tc_chart_hex,
    tc_chart_cube;

/* Sides, where i is 0, where it is largest; and j likewise. */
enum { TC_WEST, TC_EAST, TC_SOUTH, TC_NORTH, TC_SIDES };

struct tc_chart {
    const tc_chart_class *class;
    tc_field *field; /* the map's own */
    double x0, y0;   /* of the finest level's first sample */
    double dx, dy;   /* between the finest level's samples */
    bool wraps;      /* column `width` is column 0 */
    int face;        /* which one of its class */
    tc_seam side[TC_SIDES];
};

/* Chart coordinates in samples of a level. */
static inline void tc_chart_samples(const tc_chart *chart, int level, double x, double y, double *u_ret, double *v_ret)
{
    int coarser = tc_field_info(chart->field)->levels - level;
    *u_ret = (x - chart->x0) / ldexp(chart->dx, coarser);
    *v_ret = (y - chart->y0) / ldexp(chart->dy, coarser);
}

/* Chart number `self` of a map, over a field that knows whether it wraps, with the seams that follow from that; of
 * classes with several faces the face of that number. */
tc_chart tc_chart_over(const tc_chart_class *class, tc_field *field, int self, double x0, double y0, double dx,
                       double dy);

/* Where a chart's finest samples lie, without its field. */
static inline tc_chart tc_chart_grid(const tc_chart *chart)
{
    return (tc_chart){.class = chart->class,
                      .x0 = chart->x0,
                      .y0 = chart->y0,
                      .dx = chart->dx,
                      .dy = chart->dy,
                      .wraps = chart->wraps};
}

/* Face number `face` of a class over a field of N + 1 samples a side: sample (i, j) at (i / N, j / N). */
tc_chart tc_chart_face(const tc_chart_class *class, tc_field *field, int face);

/* Metres that samples of such a chart are said to be apart: a quarter of the equator has N cells. */
double tc_chart_face_spacing(double radius, int64_t cells);

/* A tc_chart_class.height: that of the mesh of the level's triangles; none outside, by more than a sample. */
tc_status tc_chart_mesh_height(const tc_chart *chart, int level, double x, double y, bool *there_ret, double *z_ret);

/* Cells of a face at least as many as `least`, even: q 2^h with q of at most TC_MOST_CELLS, so that levels halve evenly
 * and blocks of cells fit them. */
enum { TC_MOST_CELLS = 31 };
int64_t tc_chart_cells(int64_t least);

/* Shares of charts, one each, in the height at a place, by its unit normal: what lies under all others, the first, has
 * what they leave. */
void tc_chart_shares(const tc_chart *chart, int charts, const double normal[3], double *share_ret);

/* Caps take over from lonlat between these latitudes, degrees, and reach down to TC_CAP_EDGE. */
#define TC_CAP_BLEND_START 56.0
#define TC_CAP_BLEND_END 59.0
#define TC_CAP_BLEND_START_SINE 0.8290375725550417
#define TC_CAP_BLEND_END_SINE 0.8571673007021123
#define TC_CAP_EDGE 52.0

#endif
