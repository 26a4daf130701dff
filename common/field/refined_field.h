/* refined_field.h - a field with levels finer than its own, whose samples lie on the mesh of its finest level.
 *
 * Nothing is made up: heights at places are those of the field itself. They are for surfaces on which a cell's flat
 * triangles stray from a globe. */
#ifndef TC_REFINED_FIELD_H
#define TC_REFINED_FIELD_H

#include "field.h"

/* `levels` more than field has, which must outlive it and stays its owner's. NULL: no memory, or more levels than there
 * can be. Along a row or column of the field's own heights are the same bits from either end. Reading is thread-safe.
 */
tc_field *tc_refined_field(const tc_field *field, int levels);

#endif
