/* flooded_field.h - a field whose heights are those of another one, but nowhere below a sea: its surface is level. */
#ifndef TC_FLOODED_FIELD_H
#define TC_FLOODED_FIELD_H

#include "field.h"

/* The heights of `base` that are above `sea`, metres absolute, and that height elsewhere; all else is passed on, also
 * the lowest height of all, which colours go by. It takes the base over, which tc_changed_field_release() gives
 * back. NULL: no memory, and the base stays the caller's. */
tc_field *tc_flooded_field_create(tc_field *base, double sea);

#endif
