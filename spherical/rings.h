/* rings.h - the spherical surface: CH06's concentric rings around the viewer's foot point.
 *
 * CH06: Clasen, Hege, "Terrain Rendering using Spherical Clipmaps", EuroVis 2006. Level i of the rings covers the
 * angles theta~ from pi 2^(-i-1) to pi 2^-i around the viewer's foot point, in n_phi steps of phi~ around it and m
 * steps of theta~. The geometry never changes; the map transform turns it to where the viewer is, and heights come from
 * the charts of a map. For this surface a camera's x and y are longitude and latitude, radians, its z the height
 * above sphere or ellipsoid, and heading and pitch are those of a local observer.
 *
 * Beside the exact transform there is the paper's own (TC_RINGS_CH06), to compare. */
#ifndef TC_RINGS_H
#define TC_RINGS_H

#include "common/render/scheme.h"

typedef enum tc_rings_scheme {
    TC_RINGS_EXACT,
    TC_RINGS_CH06 /* equations 3 and 4, from level 10 on 11 to 14, as printed but for the sign in 3 and the factor in 14
                   */
} tc_rings_scheme;

enum { TC_RINGS_LEAST_N_PHI = 64, TC_RINGS_MOST_N_PHI = 4096, TC_RINGS_LEAST_STEPS = 4, TC_RINGS_MOST_STEPS = 128 };

typedef struct tc_rings_options {
    tc_rings_scheme scheme;
    int n_phi; /* steps around, a multiple of 32 from 64 to 4096; 0: 512 */
    int m;     /* steps outwards in a level, even, 4 to 128; 0: as long as those around, tc_rings_steps(n_phi) */
    int n;     /* samples a side of the windows, 2^k - 1, at least; what is more than geometry needs, shading uses */
    int max_levels;                    /* of each chart; 0: all */
    bool normals, fine_normals, holes; /* as in tc_ground_options */
    bool throttle;                     /* frames may be throttled */
    double outside;                    /* metres above the body: its height where no chart is */
} tc_rings_options;

/* Steps outwards that at a level's outer edge are about as long as those around, n_phi / (4 pi): 40 for 512; 58 for
 * 1024, whose rings then do with 16-bit indices, and at most 128. */
int tc_rings_steps(int n_phi);

/* Steps around for a frame: as many as a window of squares has samples a side (tc_clipmap_n_for(), and one more), but
 * at least 512, and 4096 for frames twice as wide as the widest that windows follow. */
int tc_rings_n_phi_for(const tc_camera *camera);

/* A surface over a planet, which must outlive it. TC_ERR_UNSUPPORTED for a map of other charts than longitude and
 * latitude, alone or with both caps. */
tc_status tc_rings_create(const tc_map *map, const tc_rings_options *options, tc_surface **surface_ret,
                          tc_error *error);

extern const tc_scheme tc_rings_schemes[]; /* ended by a NULL name */

#endif
