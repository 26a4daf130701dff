/* resample.h - heights of a planet in longitude and latitude at the samples of another chart. */
#ifndef TC_RESAMPLE_H
#define TC_RESAMPLE_H

#include "map.h"

/* Samples of rect of a face of so many cells a side, from the finest levels of `from`, whose charts are a grid of
 * longitude and latitude and its caps. The kernel is a cubic that goes through the samples, as wide as the face's
 * samples are apart there where the source's are nearer to each other, in each of its directions. voids: where the
 * nearest sample is one (may be NULL). On sides all faces get the same. The same bits whatever rect. Thread-safe. */
tc_status tc_resample(const tc_map *from, const tc_chart_class *class, int face, int64_t cells, tc_rect rect, float *z,
                      uint8_t *voids, ptrdiff_t stride);

/* TC_ERR_UNSUPPORTED where `from` is no planet that can be resampled. */
tc_status tc_resample_check(const tc_map *from, const char *name, tc_error *error);

/* Cells a side that are, along the equator, at least as many as the source's samples. */
int64_t tc_resample_cells(const tc_map *from);

/* How far the source's samples are from what the map of faces has there, interpolated: metres, rms by area and largest;
 * of those that are void in neither. Of a large source rows are left out, evenly. */
typedef struct tc_round_trip {
    double rms, max;
    int64_t samples; /* looked at */
} tc_round_trip;
tc_status tc_resample_round_trip(const tc_map *from, const tc_map *to, int threads, tc_round_trip *result_ret);

#endif
