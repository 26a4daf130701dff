/* scaled_field.h - a field whose heights are those of another one times a factor: terrain drawn steeper than it is. */
#ifndef TC_SCALED_FIELD_H
#define TC_SCALED_FIELD_H

#include "field.h"

/* Heights, z_base, ranges, steps and errors of `base` times the factor, which is above 0; all else is passed on. It
 * takes the base over, which tc_changed_field_release() gives back. NULL: no memory, and the base stays the caller's.
 */
tc_field *tc_scaled_field_create(tc_field *base, double factor);

#endif
