/* lonlat.h - where a grid of longitude and latitude lies on a globe: what a georeference in degrees means, settled in
 * one place for sources, files and maps. */
#ifndef TC_LONLAT_H
#define TC_LONLAT_H

#include "common/terraclip.h"

/* Sample (i, j), rows from south to north, lies at (x0 + i dx, y0 + j dy) radians; dx and dy are above 0. */
typedef struct tc_lonlat {
    int64_t width, height;
    double x0, y0, dx, dy;
    double turn;  /* columns that would make 360 degrees */
    bool round;   /* it goes once around, to within half a column */
    bool within;  /* no column comes round again, and no row lies beyond a pole */
    double south; /* rows from its first one to the south pole, */
    double north; /* and from its last one to the north pole */
    bool poles;   /* it goes round and reaches both to within a row, so that there can be caps: of at least */
} tc_lonlat;
enum { TC_LEAST_CAP_ROWS = 4 };

/* False where the georeference has no such grid: it is not known, not in degrees, rotated or runs backwards. */
bool tc_lonlat_of(const tc_georef *georef, int64_t width, int64_t height, tc_lonlat *lonlat_ret);

/* Spreads the columns of a grid that goes round evenly, as levels that wrap have them. */
void tc_lonlat_close(tc_lonlat *lonlat);

/* Whether so many columns, of which `turn` would make 360 degrees, go once around the globe: to within half a one. */
bool tc_lonlat_round(int64_t columns, double turn);

/* A level that wraps must have an even width, and so on until it fits a window, which holds so many samples. Grids of
 * other widths are resampled to the next one that can be halved often enough. */
enum { TC_MOST_ODD = 250 };

/* The next width from `width` on that can be halved until neither it nor the height, halved along with it, is more than
 * TC_MOST_ODD: width itself where it can. */
int64_t tc_lonlat_width(int64_t width, int64_t height);

#endif
