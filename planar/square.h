/* square.h - the planar surface: LH04's square nested grids over a flat map. */
#ifndef TC_SQUARE_H
#define TC_SQUARE_H

#include "common/render/scheme.h"

/* A surface over a field, which must outlive it, whose windows are made as the options say. shaded_n: 0: levels are
 * drawn by distance alone; else blocks are chosen by a frame's tolerance (tc_frame_options.error), in windows of at
 * least 127 samples, and normals are those that windows of shaded_n samples, at most as many, would show by distance
 * alone. */
tc_status tc_square_create(const tc_field *field, const tc_ground_options *options, int shaded_n,
                           tc_surface **surface_ret, tc_error *error);

enum { TC_SQUARE_LEAST_N = 127 }; /* with a tolerance */

/* Window size for a tolerance, pixels, at a camera's width and field of view: by which levels may be drawn as far out
 * as their coarser one is seen to be off by more; 2^k - 1 of 127 to four times what the frame alone calls for. */
int tc_square_n_for(const tc_field *field, double error, const tc_camera *camera);

extern const tc_scheme tc_square_schemes[]; /* ended by a NULL name */

#endif
