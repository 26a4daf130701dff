/* changed_field.h - a field whose samples are those of another one, each changed by itself: what scaled_field.c and
 * flooded_field.c share. All that is not about heights is passed on. */
#ifndef TC_CHANGED_FIELD_H
#define TC_CHANGED_FIELD_H

#include "field.h"

/* How samples are changed, and what bounds them then: `by` is the kind's own number. */
typedef struct tc_change {
    void (*samples)(float by, tc_rect rect, float *z, ptrdiff_t stride);
    tc_range (*range)(float by, const tc_field *base, int level, tc_rect rect);
    bool measures; /* its bounds of errors are wide ones: those of few samples are measured anew */
} tc_change;

/* Takes the base over; its info is the base's, for the caller to change. NULL: no memory, and the base stays the
 * caller's. */
tc_field *tc_changed_field_create(tc_field *base, const tc_change *change, float by);

/* The base, which is the caller's again; the changed field is gone. */
tc_field *tc_changed_field_release(tc_field *changed);

#endif
