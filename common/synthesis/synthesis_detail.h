/* synthesis_detail.h - details of cells of a level: what the inverse lifting decodes. */
#ifndef TC_SYNTHESIS_DETAIL_H
#define TC_SYNTHESIS_DETAIL_H

#include "synthesis_level.h"

/* Over a rectangle of cells; A of what is flat is 0. */
typedef struct tc_details {
    tc_rect rect;
    int64_t stride;
    float *band[TC_DETAIL_BANDS], *amplitude;
} tc_details;

/* Floats of scratch for so many cells. */
size_t tc_details_scratch(int64_t width, int64_t height);

/* Fills in d's planes. coarse reaches 3 samples further both ways. flat: 1 where a sample is (of rect, and one more
 * column and row); NULL: none is. */
void tc_details_make(const tc_level_recipe *r, const tc_patch *coarse, const uint8_t *flat, const tc_details *d,
                     float *scratch);

#endif
