/* atlas.h - a planet's heights as charts: rectangles of samples, each with a pyramid of its own.
 *
 *   chart 0          longitude and latitude, the source's own grid; once around the globe it wraps
 *   charts 1 and 2   stereographic caps around the north and the south pole, made from chart 0
 *
 * Towards a pole a grid of longitude and latitude has ever more samples a metre along its parallels, and ends at a
 * point. Within a cap samples are a square lattice, equally far apart in all directions to within 12 %: nothing happens
 * at the pole. Caps have no sample of their own; the file and the flat map are chart 0. A part of a globe, or one whose
 * caps are missing, is chart 0 alone.
 *
 * Chart coordinates, radians or lengths on the unit sphere, of longitude lambda and latitude phi:
 *   TC_LONLAT        x = lambda, y = phi
 *   TC_CAP_NORTH     x = 2 tan(theta/2) cos(lambda), y = 2 tan(theta/2) sin(lambda), theta = pi/2 - phi
 *   TC_CAP_SOUTH     the same with theta = pi/2 + phi
 * Sample (i, j) of the finest level lies at (x0 + i dx, y0 + j dy). */
#ifndef TC_ATLAS_H
#define TC_ATLAS_H

#include "common/terraclip.h"

typedef enum tc_projection { TC_LONLAT, TC_CAP_NORTH, TC_CAP_SOUTH } tc_projection;

enum { TC_MAX_CHARTS = 3 };

typedef struct tc_chart {
    tc_field *field;
    tc_projection projection;
    double x0, y0; /* of the finest level's first sample */
    double dx, dy; /* between the finest level's samples */
    bool wraps;    /* column `width` is column 0; the width is then as tc_atlas_width() says */
} tc_chart;

typedef struct tc_atlas {
    double radius; /* metres, of the sphere that heights are above */
    int charts;    /* 1, or 3 with caps */
    tc_chart chart[TC_MAX_CHARTS];
} tc_atlas;

/* A level that wraps must have an even width, and so on until it fits a window, which holds so many samples. Grids of
 * other widths are resampled to the next one that can be halved often enough. */
enum { TC_MOST_ODD = 250 };

/* Caps take over from chart 0 between these latitudes, degrees, and reach down to TC_CAP_EDGE. */
#define TC_CAP_BLEND_START 56.0
#define TC_CAP_BLEND_END 59.0
#define TC_CAP_EDGE 52.0

/* The next width from `width` on that can be halved until neither it nor the height, halved along with it, is more than
 * TC_MOST_ODD: width itself where it can. */
int64_t tc_atlas_width(int64_t width, int64_t height);

/* Whether so many columns, of which `turn` would make 360 degrees, go once around the globe: to within half a one. */
bool tc_atlas_around(int64_t columns, double turn);

/* TC_ERR_FORMAT for heights (metres above the sphere) that reach its centre, or a radius beyond it, or are none. */
tc_status tc_atlas_check_relief(const char *name, double z_min, double z_max, double radius, tc_error *error);
/* The same of a grid's, with the height at which its voids are shown. */
tc_status tc_atlas_check_grid(const char *name, const tc_grid *grid, double radius, tc_error *error);

/* Builds the pyramids of *grid and takes the grid over (it is zeroed, also on failure freed). Its georeference must be
 * known and geographic (degrees, not rotated). Where it covers 360 degrees, to within half a sample, chart 0 wraps and
 * its width must be as tc_atlas_width() says; where it reaches both poles too, to within a row, there are caps. Heights
 * under voids must be filled. Spacings of the pyramids are lengths on the equator of a sphere of that radius, metres.
 * threads: 0 as many as there are processors. The result does not depend on it. *atlas_ret is freed with
 * tc_atlas_free(). TC_ERR_USAGE for a grid or a radius that is not as above, TC_ERR_FORMAT for heights that the radius
 * is too small for. */
tc_status tc_atlas_build(tc_grid *grid, double radius, int threads, tc_atlas *atlas_ret, tc_error *error);

/* Shares of the charts in the height at a place whose direction has this z, the sine of its latitude: chart 0 alone up
 * to TC_CAP_BLEND_START, the cap alone from TC_CAP_BLEND_END on. charts: 1, or 3 with caps. */
void tc_atlas_weights(int charts, double z, double weight_ret[TC_MAX_CHARTS]);

/* Height at a place, radians, of the finest levels, bilinear, in metres above z_base; where there is none that of the
 * sphere. Thread-safe. */
tc_status tc_atlas_height(const tc_atlas *atlas, double longitude, double latitude, double *z_ret);

/* Destroys the pyramids and zeroes *atlas. */
void tc_atlas_free(tc_atlas *atlas);

#endif
