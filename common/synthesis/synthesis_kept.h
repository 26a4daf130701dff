/* synthesis_kept.h - blocks of heights that were made lately: a fixed amount of memory, taken once, for any number of
 * threads. */
#ifndef TC_SYNTHESIS_KEPT_H
#define TC_SYNTHESIS_KEPT_H

#include "common/terraclip.h"

enum { TC_KEPT_SIDE_LOG2 = 4, TC_KEPT_SIDE = 1 << TC_KEPT_SIDE_LOG2 }; /* samples along a side of a block */

typedef struct tc_kept tc_kept;

/* NULL: not enough memory. */
tc_kept *tc_kept_create(void);
void tc_kept_destroy(tc_kept *kept);
size_t tc_kept_bytes(void);

/* Copies a part of a block, columns and rows of it, where it is kept. key: not 0. */
bool tc_kept_find(tc_kept *kept, uint64_t key, tc_rect part, float *z, ptrdiff_t stride);

/* Keeps a block of at most TC_KEPT_SIDE columns and rows, in the place of one that was not asked for in the longest
 * time. */
void tc_kept_add(tc_kept *kept, uint64_t key, int64_t width, int64_t height, const float *z, ptrdiff_t stride);

#endif
