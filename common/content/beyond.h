/* beyond.h - samples of a field's level and how they go on beyond its sides: what contents are filled from. */
#ifndef TC_BEYOND_H
#define TC_BEYOND_H

#include "common/window/clipmap.h"

/* How heights go on beyond the level's last samples. */
typedef struct tc_beyond {
    bool wraps;    /* in x */
    bool straight; /* in a straight line; else all on the terrain's edge: */
    float x, y;    /* the edge lies this far beyond the last sample, 0 <= x < 1 */
} tc_beyond;

/* Reads heights of rect for a fill, which may go beyond the level, into buffer; *z_ret points at its first sample, rows
 * are *stride_ret apart. buffer: (width + 2) * (height + 2) floats. */
tc_status tc_read_beyond(const tc_fill *fill, int level, tc_rect rect, tc_beyond how, float *buffer, float **z_ret,
                         ptrdiff_t *stride_ret);

/* The sample of 0 .. size - 1 that is nearest to i. */
static inline int64_t tc_nearest_sample(int64_t i, int64_t size)
{
    return i < 0 ? 0 : i < size ? i : size - 1;
}

#endif
