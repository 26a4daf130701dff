/* beyond.h - samples of a field's level and how they go on beyond its sides: what contents are filled from. */
#ifndef TC_BEYOND_H
#define TC_BEYOND_H

#include "common/window/clipmap.h"

/* How heights go on beyond the level's last samples. */
typedef struct tc_beyond {
    bool wraps;    /* in x */
    bool straight; /* in a straight line, or as a field that goes on beyond its sides has it; else on the edge: */
    float x, y;    /* the edge lies this far beyond the last sample, 0 <= x < 1 */
} tc_beyond;

/* Reads heights of rect for a fill, which may go beyond the level, into buffer; *z_ret points at its first sample, rows
 * are *stride_ret apart. buffer: (width + 2) * (height + 2) floats. */
tc_status tc_read_beyond(const tc_fill *fill, int level, tc_rect rect, tc_beyond how, float *buffer, float **z_ret,
                         ptrdiff_t *stride_ret);

/* Rows of a level's samples, or of its voids, that go on beyond its sides as at the border. */
typedef struct tc_clamped {
    tc_rect part; /* of the level: what is read */
    int64_t width, height;
    bool wraps; /* in x */
} tc_clamped;
tc_clamped tc_clamped_rows(const tc_fill *fill);

/* Samples of `bytes` each of row y of the fill's rectangle, from what was read of the part, into row. */
void tc_clamped_row(const tc_clamped *clamped, const void *read, size_t bytes, int64_t y, tc_rect rect, void *row);

/* The sample of 0 .. size - 1 that is nearest to i. */
static inline int64_t tc_nearest_sample(int64_t i, int64_t size)
{
    return i < 0 ? 0 : i < size ? i : size - 1;
}

#endif
