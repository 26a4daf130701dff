/* synthesis_noise.h - white noise by place. */
#ifndef TC_SYNTHESIS_NOISE_H
#define TC_SYNTHESIS_NOISE_H

#include "synthesis.h"

/* Four independent values a cell of rect, of mean 0 and variance 1, one after the other: hashes of seed, column (modulo
 * `period`, where that is not 0), row and number. out: 4 x area of rect. */
void tc_white_noise(uint64_t seed, int64_t period, tc_rect rect, float *out);

/* A seed of chart and level. */
uint64_t tc_noise_seed(int chart, int level);

#endif
