/* colours.h - the content of windows over a field of colours. */
#ifndef TC_COLOURS_H
#define TC_COLOURS_H

#include "common/window/clipmap.h"

extern const tc_content_class tc_colours_content; /* RGBA: sRGB of the colour times alpha, and alpha */

#endif
