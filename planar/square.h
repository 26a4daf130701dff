/* square.h - the planar surface: LH04's square nested grids over a flat map. */
#ifndef TC_SQUARE_H
#define TC_SQUARE_H

#include "common/render/scheme.h"

/* A surface over the clipmap, which it takes over, also on failure. */
tc_status tc_square_create(tc_clipmap *clipmap, tc_surface **surface_ret, tc_error *error);

extern const tc_scheme tc_square_schemes[]; /* ended by a NULL name */

#endif
