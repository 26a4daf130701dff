/* fine_voids.h - which samples of levels finer than the data are void. */
#ifndef TC_FINE_VOIDS_H
#define TC_FINE_VOIDS_H

#include "common/terraclip.h"

/* A sample is void where the mesh of the data's finest level is: outlines of holes stay. data: of that level, 1 a void,
 * over around, which has all cells that rect lies in, and one sample more; rect: of the level k finer. */
void tc_fine_voids(const uint8_t *data, tc_rect around, int k, tc_rect rect, uint8_t *voids, ptrdiff_t stride);

#endif
