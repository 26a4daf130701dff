/* resample.h - heights of a planet in longitude and latitude at the samples of the faces of another atlas. */
#ifndef TC_RESAMPLE_H
#define TC_RESAMPLE_H

#include "chart.h"

/* Where heights come from: the finest levels of a grid of longitude and latitude that goes around, and of its caps. */
typedef struct tc_resample_source {
    const tc_chart *chart; /* three */
    int charts;
    bool flat; /* voids stand at a height of their own, which is to have no share in others */
} tc_resample_source;

/* Samples of rect of a face of so many cells a side. The kernel is a cubic that goes through the source's samples, as
 * wide as the face's are apart there where the source's are nearer to each other, in each of its directions. voids:
 * where the nearest sample is one (may be NULL). On sides all faces get the same. The same bits whatever rect.
 * Thread-safe. */
tc_status tc_resample(const tc_resample_source *from, const tc_chart_class *class, int face, int64_t cells,
                      tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride);

/* Cells a side of the faces of an atlas that are, along the equator, at least as many as the source's columns. */
int64_t tc_resample_cells(int64_t columns);

/* How far the source's samples are from what the faces have there, interpolated: metres, rms by area and largest; of
 * those that are void in neither. Of a large source rows are left out, evenly. */
typedef struct tc_round_trip {
    double rms, max;
    int64_t samples; /* looked at */
} tc_round_trip;
tc_status tc_resample_round_trip(const tc_resample_source *from, const tc_chart *face, int faces, int threads,
                                 tc_round_trip *result_ret);

#endif
