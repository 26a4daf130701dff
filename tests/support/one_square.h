/* one_square.h - a scheme that nothing but tests knows: a flat map as one square of so many cells of its coarsest level
 * that a window holds as a whole, without morph, closers or culling, by a shader text of its own. */
#ifndef ONE_SQUARE_H
#define ONE_SQUARE_H

#include "common/render/scheme.h"

extern const tc_scheme one_square_schemes[]; /* ended by a NULL name */

#endif
