/* fill.h - smooth surfaces over the voids of a height field. */
#ifndef TC_FILL_H
#define TC_FILL_H

#include "common/terraclip.h"

/* Replaces z where voids is not 0 by a membrane stretched between the valid samples around: each filled sample is close
 * to the mean of its four neighbours, so that no pit, wall or peak can arise. Layout [j * width + i]; border sides are
 * free. Valid samples stay as they are, bit for bit; filled ones lie within the range of the valid ones, which must be
 * finite. What z holds in voids before does not matter.
 *
 * Takes time and memory by the number of voids, not of samples (but for one pass over voids): at most about 3 bytes a
 * sample of scratch memory for large voids. TC_ERR_USAGE where all are void. */
tc_status tc_fill_voids(float *z, const uint8_t *voids, int64_t width, int64_t height);

#endif
