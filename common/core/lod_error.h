/* lod_error.h - how far the levels of a pyramid are from its finest one (LH04 section 9, table 2). */
#ifndef TC_LOD_ERROR_H
#define TC_LOD_ERROR_H

#include "../terraclip.h"

/* Errors of a level's mesh against the finest level's samples, without voids. */
typedef struct tc_lod_error {
    double spacing_m;                /* g_l */
    double rms_m, p999_m, max_m;
    double rms_px, p999_px, max_px;  /* on the screen, where the level comes closest to the viewer */
} tc_lod_error;

/* e_l(x, y) = |f_l - f_m|, f_l the piecewise linear mesh of level l, over all finest samples; projected as
 * W / (2 tan(fov / 2)) e_l / d with d = 0.4 n g_(l+1), the distance at which level l + 1 begins to pass into level l
 * for a viewer on the ground. voids, where the pyramid has them, are left out. threads: 0 all. */
tc_status tc_lod_error_measure(const tc_pyramid *pyramid, int level, int n, int width_px, double fov, int threads,
                               tc_lod_error *error_ret);

#endif
