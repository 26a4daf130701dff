/* synthesis_rows.h - the last rows of something that passes through, row after row: of one size whatever is made, so
 * that offsets are constants, with room to do some cells more than there are, which nobody uses. */
#ifndef TC_SYNTHESIS_ROWS_H
#define TC_SYNTHESIS_ROWS_H

#include <stdint.h>

enum {
    TC_ROW_CELLS = 140, /* of a row, at most */
    TC_ROW_PITCH = 192, /* what there is room for: cells, those around, and what is done more than there is */
    TC_ROWS_KEPT = 8    /* a power of two */
};

typedef float tc_rows[TC_ROWS_KEPT][TC_ROW_PITCH];

/* Where of what is kept row j is. */
static inline int tc_row_slot(int64_t j)
{
    return (int)(j & (TC_ROWS_KEPT - 1));
}

/* Cells, and so many more that all are done by wide instructions: of floats, of bytes. */
static inline int64_t tc_eights(int64_t cells)
{
    return (cells + 7) & ~(int64_t)7;
}
static inline int64_t tc_thirty_twos(int64_t cells)
{
    return (cells + 31) & ~(int64_t)31;
}

#endif
