/* rings_oracle.h - vertices of the rings by the plainest of long double arithmetic: absolute directions, longitudes and
 * latitudes, nothing relative to the viewer but the last subtraction. */
#ifndef RINGS_ORACLE_H
#define RINGS_ORACLE_H

#include "spherical/rings_internal.h"

typedef struct oracle_vertex {
    long double height;                             /* metres above the sphere */
    long double position[3];                        /* east, north, up from the eye, metres */
    long double weight[TC_MAX_CHARTS];              /* shares of the charts */
    long double x[TC_MAX_CHARTS], y[TC_MAX_CHARTS]; /* finest samples of the charts, where their share is above 0 */
} oracle_vertex;

/* The vertex at angles theta~ and phi~ and ring coordinate w, from the clipmaps as they stand. */
oracle_vertex rings_oracle(const rings_surface *s, const rings_view *view, const tc_camera *camera, long double theta,
                           long double phi, long double w);

/* Pixels from the frame's lower left corner; false where the place is not in the frame. */
bool rings_oracle_pixel(const tc_camera *camera, const long double position[3], long double pixel_ret[2]);

#endif
