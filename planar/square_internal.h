/* square_internal.h - what the files of the planar surface share. */
#ifndef TC_SQUARE_INTERNAL_H
#define TC_SQUARE_INTERNAL_H

#include "common/render/block_geometry.h"
#include "square.h"

/* How heights of a level pass over into the coarser level's: alpha is the largest of four ramps, one a side, of
 * `from` + ..., and of `least`. In cells of the level, relative to the snapped viewer. Sides: west, east, south,
 * north; alpha rises from 0 at `start` to 1 outwards with `rate` a cell. */
typedef struct square_morph {
    double start[4], rate[4], least;
} square_morph;

/* Where the viewer is: the sample of the pyramid's finest level next to it, and the offset from it. Of another one the
 * offset could be a whole cell less a millimetre, which as a float loses a part of that millimetre; a vertex so
 * near would be seen some pixels off. */
typedef struct square_viewer {
    int64_t snap_x, snap_y; /* finest samples, within the terrain */
    double rest_x, rest_y;  /* metres, eye minus snapped sample */
    double x, y;            /* metres */
    double height;          /* metres above ground */
} square_viewer;

/* wait: the ground is the finest level's, read from the field; else that of the finest level which is held there and
 * wanted. */
square_viewer tc_square_viewer(const tc_clipmap *clipmap, const tc_camera *camera, bool wait);
square_morph tc_square_morph(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                             const tc_frame_options *options);
/* What is drawn of a level's active region, or is a finer level's hole in it: all, or less in a throttled frame. */
tc_rect tc_square_region(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                         const tc_frame_options *options);
/* The most that frames over windows of n samples a side can be throttled. */
double tc_square_most_throttle(int n);
double tc_square_alpha(const square_morph *morph, double x, double y);

void tc_square_wanted(const tc_clipmap *clipmap, const square_viewer *viewer, tc_rect *wanted);
/* Height drawn at a place, metres; false where nothing is. */
bool tc_square_height(const tc_clipmap *clipmap, const square_viewer *viewer, const tc_frame_options *options, double x,
                      double y, double *z_ret);

#endif
