/* square.h - the planar surface: LH04's square nested grids over a flat map. */
#ifndef TC_SQUARE_H
#define TC_SQUARE_H

#include "common/render/scheme.h"

/* A surface over a field, which must outlive it, whose windows are made as the options say. */
tc_status tc_square_create(const tc_field *field, const tc_ground_options *options, tc_surface **surface_ret,
                           tc_error *error);

extern const tc_scheme tc_square_schemes[]; /* ended by a NULL name */

#endif
