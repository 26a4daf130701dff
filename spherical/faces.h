/* faces.h - surfaces over a planet whose charts are faces: hexagonal geometry clipmaps and cube-sphere chunks.
 *
 * BN08: Bhattacharjee, Narayanan, "Hexagonal Geometry Clipmaps for Spherical Terrain Rendering", 2008.
 * PT: the article "Planetary Terrain".
 *
 * Both draw blocks of cells whose corners are samples of a chart (common/blocks), over a window for each level and
 * chart. What they differ by is in a table: the charts, the distance by which a block's level is chosen, and whether
 * vertices pass over into the coarser level before it is. For these surfaces a camera's x and y are longitude and
 * latitude, radians, its z the height above the body, and heading and pitch are those of a local observer. */
#ifndef TC_FACES_H
#define TC_FACES_H

#include "common/render/scheme.h"

typedef struct faces_kind faces_kind;
extern const faces_kind tc_faces_hex, tc_faces_cube, tc_faces_cube_pt;

enum { TC_FACES_LEAST_N = 127 };

typedef struct tc_faces_options {
    const faces_kind *kind;
    int n;          /* samples a side of the windows, 2^k - 1, at least 127; 0: 255 */
    int max_levels; /* of each chart; 0: all */
    int shaded_n;   /* 0: levels by distance alone; else blocks by a frame's tolerance (tc_frame_options.error), and
                     * normals   those that windows of so many samples, at most n, would show by distance alone */
    bool normals, fine_normals, holes; /* as in tc_ground_options */
} tc_faces_options;

/* A surface over a planet, which must outlive it. TC_ERR_UNSUPPORTED for a map of other charts. */
tc_status tc_faces_create(const tc_map *map, const tc_faces_options *options, tc_surface **surface_ret,
                          tc_error *error);

extern const tc_scheme tc_faces_schemes[]; /* ended by a NULL name */

#endif
