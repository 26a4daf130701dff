/* row_resample.h - rows once around a globe, resampled to another number of columns. */
#ifndef TC_ROW_RESAMPLE_H
#define TC_ROW_RESAMPLE_H

#include "common/terraclip.h"

typedef struct tc_row_resampler tc_row_resampler;

/* From rows of `from` columns to rows of `to`, not fewer; column 0 stays where it is. NULL: not enough memory. */
tc_row_resampler *tc_row_resampler_create(int64_t from, int64_t to);
void tc_row_resampler_destroy(tc_row_resampler *resampler);

/* z: `from` heights, finite under voids too. out: `to` heights. Constants stay. Thread-safe. */
void tc_row_resample(const tc_row_resampler *resampler, const float *z, float *out);

/* The same for voids, by the nearest column. */
void tc_row_resample_voids(const tc_row_resampler *resampler, const uint8_t *voids, uint8_t *out);

#endif
