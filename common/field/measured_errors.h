/* measured_errors.h - how far the finest level's mesh is from those of the others, by a look at all samples. */
#ifndef TC_MEASURED_ERRORS_H
#define TC_MEASURED_ERRORS_H

#include "range_pyramid.h"

enum { TC_ERROR_TILE_SHIFT = 4, TC_ERROR_TILE = 1 << TC_ERROR_TILE_SHIFT }; /* samples of a leaf along a side */

/* Fills in pyramids, one a level, whose leaves are tiles of its samples: of their nodes error is how far the finest
 * level's mesh is from the next coarser level's there, at least that of the next finer level; INFINITY at level 1.
 * nodes: freed by the caller, also after a failure. Reads the finest level once and the others about so, from several
 * threads. */
tc_status tc_measure_errors(const tc_field *field, tc_range_pyramid *errors);

/* The same for any memory. raise() is called by one thread at a time, with errors of leaves of a level, 2 or finer:
 * what is kept of each is the largest of all calls, and then no less than the next finer level's where it lies. go_on()
 * may be NULL; false stops with TC_ERR_IO. share: of the work, since the last call. */
typedef struct tc_error_sink {
    void *context;
    void (*raise)(void *context, int level, tc_rect leaves, const float *error, ptrdiff_t stride);
    bool (*go_on)(void *context, double share);
} tc_error_sink;
tc_status tc_measure_errors_to(const tc_field *field, const tc_error_sink *sink, int threads);

/* The error over a rectangle, within the level's samples, that such a pyramid tells. */
float tc_measured_error(const tc_range_pyramid *errors, tc_rect rect, int64_t most_x, int *reads);

void tc_measured_errors_free(tc_range_pyramid *errors, int levels);

#endif
