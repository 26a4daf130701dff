/* computed.h - pyramids whose heights are computed when they are asked for: terrains of any size that take no memory.
 */
#ifndef COMPUTED_H
#define COMPUTED_H

#include "common/terraclip.h"

/* Waves of all lengths from 41 samples to 2e9, a fiftieth as high as long but at most `highest` samples' spacing, and
 * none a power of two long: a sample whose number was cut to 32 bits, or taken modulo a window, has another height. A
 * sample of a coarser level has the height of the finest sample on its spot. Ends the program where there is no memory.
 */
tc_field *computed_field(int64_t width, int64_t height, double spacing, double highest);

/* The height of a sample of the finest level, metres. */
float computed_height(const tc_field *field, int64_t x, int64_t y);

/* Samples read so far. */
int64_t computed_reads(const tc_field *field);

#endif
