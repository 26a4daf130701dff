/* turn.h - a window that goes once around a map which wraps holds all of it: what comes in on one side has left on the
 * other. */
#ifndef TC_TURN_H
#define TC_TURN_H

#include "common/terraclip.h"

/* Copies texels of a toroidal array, `size` a side (a power of two) and `bytes` each, to rect from the same rows, on
 * those turns of `period` texels on which they lie in first .. first + period - 1. row: room for a row of rect. */
void tc_turn_texels(void *texels, int64_t size, size_t bytes, tc_rect rect, int64_t first, int64_t period, void *row);

#endif
