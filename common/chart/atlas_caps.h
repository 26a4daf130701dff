/* atlas_caps.h - polar caps resampled from the rows of a grid of longitude and latitude, as they come in. */
#ifndef TC_ATLAS_CAPS_H
#define TC_ATLAS_CAPS_H

#include "lonlat.h"

/* The grid of a cap goes round and reaches both poles, is closed, and has at least TC_LEAST_CAP_ROWS rows. */

/* A cap is a square of so many samples a side, an odd number: spacing grid->dy, the pole in the middle, so that x0 = y0
 * = -(side - 1) / 2 * grid->dy. It reaches down to TC_CAP_EDGE or a little further. */
int64_t tc_caps_side(const tc_lonlat *grid);

/* Rows of the grid, counted from a pole, that its cap is made of. */
int64_t tc_caps_reach(const tc_lonlat *grid);

enum { TC_NORTH_CAP, TC_SOUTH_CAP, TC_CAPS };

/* Where a cap is to be written: side * side samples, row y = y0 first. They are the caller's, and need not be
 * initialised. */
typedef struct tc_cap_target {
    float *z;       /* metres, as the rows */
    uint8_t *voids; /* 1 where the nearest sample of the grid is void; NULL: not wanted */
} tc_cap_target;

typedef struct tc_cap_result {
    float z_min, z_max; /* of samples that are not void; 0 where all are */
    int64_t void_count;
} tc_cap_result;

typedef struct tc_caps tc_caps;

/* Starts both caps. Holds about 70 rows of the grid for each. threads: 0 as many as there are processors; the result
 * does not depend on it. TC_ERR_USAGE for a grid that is not as above, TC_ERR_MEMORY. */
tc_status tc_caps_create(const tc_lonlat *grid, const tc_cap_target target[TC_CAPS], int threads, tc_caps **caps_ret);

/* Gives rows j0 .. j0 + rows - 1 counted from the south: z[(j - j0) * width + i], finite under voids too (filled), and
 * voids in the same layout (may be NULL). Calls go from south to north or from north to south without a gap; rows
 * beyond the reach of both caps can be left out, and take no time if given. */
tc_status tc_caps_put(tc_caps *caps, int64_t j0, int64_t rows, const float *z, const uint8_t *voids);

/* After the last row. TC_ERR_USAGE where rows were missing. result may be NULL. */
tc_status tc_caps_finish(tc_caps *caps, tc_cap_result result[TC_CAPS]);
void tc_caps_destroy(tc_caps *caps);

/* Filters a row (of n columns once around) along its parallel at angle theta from the pole, by about `spacing`, an
 * angle, in every place: row_filter.c says how. At the pole itself all become the mean. out may be row. scratch:
 * tc_row_filter_scratch doubles. */
size_t tc_row_filter_scratch(int64_t n);
void tc_row_filter(const float *row, int64_t n, double theta, double spacing, float *out, double *scratch);

#endif
