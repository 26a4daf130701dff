/* lod_error.h - how far the levels of a pyramid are from its finest one (LH04 section 9, table 2). */
#ifndef TC_LOD_ERROR_H
#define TC_LOD_ERROR_H

#include "common/terraclip.h"

/* Errors of a level's mesh against the finest level's samples, without voids. */
typedef struct tc_lod_error {
    double spacing_m; /* g_l */
    double rms_m, p999_m, max_m;
    double rms_px, p999_px, max_px; /* on the screen, at the distance 0.4 n g_l */
} tc_lod_error;

/* e_l(x, y) = |f_l - f_m|, f_l the piecewise linear mesh of level l, over all finest samples; projected as
 * W / (2 tan(fov / 2)) e_l / d with d = 0.4 n g_l, the distance from which LH04 takes the size of a level's triangles
 * (s = 1.25 W / (n tan(fov / 2)) pixels, so the error is s e_l / g_l). A viewer on the ground meets level l alone from
 * 0.25 n g_l on and mixed with the finer one from 0.2 n g_l on: there the figures are up to twice as large. Voids are
 * left out. threads: 0 all. */
tc_status tc_lod_error_measure(const tc_field *field, int level, int n, int width_px, double fov, int threads,
                               tc_lod_error *error_ret);

#endif
