/* chart.h - charts: rectangles of samples, each with a field of its own, that a map is made of.
 *
 *   flat                   metres east and north on a plane
 *   lonlat                 longitude and latitude, radians: the source's own grid; once around the globe it wraps
 *   north cap, south cap   stereographic, around a pole, made from a grid of longitude and latitude
 *
 * Towards a pole a grid of longitude and latitude has ever more samples a metre along its parallels, and ends at a
 * point. Within a cap samples are a square lattice, equally far apart in all directions to within 12 %: nothing happens
 * at the pole.
 *
 * Chart coordinates, radians or lengths on the unit sphere, of longitude lambda and latitude phi:
 *   lonlat       x = lambda, y = phi
 *   north cap    x = 2 tan(theta/2) cos(lambda), y = 2 tan(theta/2) sin(lambda), theta = pi/2 - phi
 *   south cap    the same with theta = pi/2 + phi
 * Sample (i, j) of the finest level lies at (x0 + i dx, y0 + j dy). */
#ifndef TC_CHART_H
#define TC_CHART_H

#include <math.h>

#include "body.h"

typedef struct tc_chart tc_chart;

typedef struct tc_chart_class {
    const char *name;
    /* From chart coordinates to the body's place (body.h), and back. */
    void (*to_place)(double x, double y, double *place_x_ret, double *place_y_ret);
    void (*from_place)(double place_x, double place_y, double *x_ret, double *y_ret);
    double period; /* x comes round again; 0: never */
    /* Sine of the latitude at chart coordinates, of the same bits on every machine; NULL: there is no latitude. */
    double (*sine)(double x, double y);
    /* Share of the height at a place of a chart that is laid over others, by the sine of the latitude there; NULL: it
     * has what is left. */
    double (*share)(double sine);
    /* Height of a level at chart coordinates, metres above z_base; *there_ret: there is one. */
    tc_status (*height)(const tc_chart *chart, int level, double x, double y, bool *there_ret, double *z_ret);
} tc_chart_class;

extern const tc_chart_class tc_chart_plane, tc_chart_lonlat, tc_chart_north_cap, tc_chart_south_cap;

/* What is beyond a side: sample (i, j) is sample m (i, j) + (dx, dy) of another chart, or of the same. */
typedef struct tc_seam {
    int chart;   /* of the map; negative: nothing, heights end */
    int8_t m[4]; /* row by row */
    int64_t dx, dy;
} tc_seam;

enum { TC_WEST, TC_EAST, TC_SOUTH, TC_NORTH, TC_SIDES };

struct tc_chart {
    const tc_chart_class *class;
    tc_field *field; /* the map's own */
    double x0, y0;   /* of the finest level's first sample */
    double dx, dy;   /* between the finest level's samples */
    bool wraps;      /* column `width` is column 0 */
    tc_seam side[TC_SIDES];
};

/* Chart coordinates in samples of a level. */
static inline void tc_chart_samples(const tc_chart *chart, int level, double x, double y, double *u_ret, double *v_ret)
{
    int coarser = tc_field_info(chart->field)->levels - level;
    *u_ret = (x - chart->x0) / ldexp(chart->dx, coarser);
    *v_ret = (y - chart->y0) / ldexp(chart->dy, coarser);
}

/* Chart number `self` of a map, over a field that knows whether it wraps, with the seams that follow from that. */
tc_chart tc_chart_over(const tc_chart_class *class, tc_field *field, int self, double x0, double y0, double dx,
                       double dy);

/* Caps take over from lonlat between these latitudes, degrees, and reach down to TC_CAP_EDGE. */
#define TC_CAP_BLEND_START 56.0
#define TC_CAP_BLEND_END 59.0
#define TC_CAP_BLEND_START_SINE 0.8290375725550417
#define TC_CAP_BLEND_END_SINE 0.8571673007021123
#define TC_CAP_EDGE 52.0

#endif
