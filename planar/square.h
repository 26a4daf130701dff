/* square.h - the planar surface: LH04's square nested grids over a flat map. */
#ifndef TC_SQUARE_H
#define TC_SQUARE_H

#include "common/render/scheme.h"

enum { TC_SQUARE_LEAST_N = 127 }; /* with a tolerance */

/* How blocks are chosen by a frame's tolerance (tc_frame_options.error). */
typedef struct tc_square_blocks {
    int shaded_n; /* normals and colours are those that windows of so many samples, at most n, would show by distance
                     alone */
    int side;     /* cells of a block, 8 or 16; 0: by n */
} tc_square_blocks;

/* A surface over a field, which must outlive it, whose windows are made as the options say. blocks: NULL: levels are
 * drawn by distance alone; else windows are of at least 127 samples. */
tc_status tc_square_create(const tc_field *field, const tc_ground_options *options, const tc_square_blocks *blocks,
                           tc_surface **surface_ret, tc_error *error);

/* Window size for a tolerance, pixels, at a camera's width and field of view: by which levels may be drawn as far out
 * as their coarser one is seen to be off by more; 2^k - 1 of 127 to four times what the frame alone calls for, of no
 * more than a GiB. *side_ret, unless NULL: of blocks: small ones where most of the terrain calls for little. */
int tc_square_n_for(const tc_field *field, double error, const tc_camera *camera, int *side_ret);

extern const tc_scheme tc_square_schemes[]; /* ended by a NULL name */

#endif
