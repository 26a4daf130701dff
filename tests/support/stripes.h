/* stripes.h - a content that only tests know: one byte a texel, two texels a sample, told by its place alone. */
#ifndef STRIPES_H
#define STRIPES_H

#include "common/window/clipmap.h"

extern const tc_content_class stripes; /* its parameter: a whole number */

/* Texel (x, y) of a level of a clipmap. */
uint8_t stripe(const tc_content *content, int level, int64_t x, int64_t y);

/* Windows of all levels around place (x, y) of the finest. */
void stripes_want(const tc_clipmap *c, int64_t x, int64_t y, tc_rect wanted[TC_MAX_LEVELS]);

#endif
