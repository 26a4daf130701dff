/* synthesis_detail.h - details of cells of a level, row after row: what the inverse lifting decodes. */
#ifndef TC_SYNTHESIS_DETAIL_H
#define TC_SYNTHESIS_DETAIL_H

#include "synthesis_level.h"
#include "synthesis_noise.h"

/* Details of a rectangle of cells. */
typedef struct tc_details {
    const tc_level_recipe *recipe;
    tc_rect rect;
    tc_noise_rows noise;
    tc_directions directions;
    int16_t smeared[TC_DETAIL_BANDS][TC_ROW_PITCH];
    float line[2][TC_ROW_PITCH];
} tc_details;

void tc_details_begin(tc_details *d, const tc_level_recipe *r, tc_rect rect);

/* What a row of cells has its details of. */
typedef struct tc_detail_sources {
    const float *z[6]; /* samples of rows j - 2 .. j + 3, from two before the first cell to three behind the last */
    bool any_flat;
    const uint8_t *flat[2]; /* 1 where a sample of row j and of the next one is flat */
} tc_detail_sources;

/* Row j of rect, from the first to the last: three details a cell, and A, which is 0 where it is flat. */
void tc_details_row(tc_details *d, int64_t j, const tc_detail_sources *from, float *const band[TC_DETAIL_BANDS],
                    float *amplitude);

#endif
