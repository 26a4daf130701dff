/* synthesis_flat.h - what of a level is flat, row after row: it stays as it is. */
#ifndef TC_SYNTHESIS_FLAT_H
#define TC_SYNTHESIS_FLAT_H

#include <stdbool.h>

#include "synthesis_rows.h"

/* What was seen of the last rows. */
typedef struct tc_flats {
    int64_t cells;
    struct {
        bool along, middle, flat; /* whether there is any in the row */
    } any[TC_ROWS_KEPT];
    uint8_t along[TC_ROWS_KEPT][TC_ROW_PITCH]; /* 1: as high as both samples beside it; from sample -1 on */
    uint8_t same[TC_ROWS_KEPT][TC_ROW_PITCH];  /* 1: as high as the sample of the row before; likewise */
    uint8_t near[TC_ROWS_KEPT][TC_ROW_PITCH];  /* 1: the middle of 3 x 3 equal samples, or beside one */
    uint8_t flat[TC_ROWS_KEPT][TC_ROW_PITCH];  /* 1: that, or next to one in another row */
    uint8_t nothing[TC_ROW_PITCH];
} tc_flats;

void tc_flats_begin(tc_flats *f, int64_t cells);

/* Looks at samples of row j, after those of the row before: from two before the first cell to three behind the last; z
 * and south point to the first one of both. What is flat of row j - 2 is then known, once five rows were seen. */
void tc_flats_pass(tc_flats *f, int64_t j, const float *south, const float *z);

/* What is flat of the row, 1 a sample. */
static inline const uint8_t *tc_flats_row(const tc_flats *f, int64_t j)
{
    return f->any[tc_row_slot(j)].flat ? f->flat[tc_row_slot(j)] : f->nothing;
}

static inline bool tc_flats_any(const tc_flats *f, int64_t j)
{
    return f->any[tc_row_slot(j)].flat;
}

/* Between equal samples of what is flat lie those themselves, where U would swing: evens and odds of the finer row
 * 2 j + half, from cell `first` on. z, north: samples there of rows j and j + 1. */
void tc_flats_keep(const tc_flats *f, int64_t j, int half, int64_t first, int64_t count, const float *z,
                   const float *north, float *even, float *odd);

#endif
