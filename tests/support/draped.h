/* draped.h - pictures of a function, to be laid over maps, and their colours in double precision. */
#ifndef DRAPED_H
#define DRAPED_H

#include "common/base/image.h"

/* Colour at column and row of a picture, 0 .. 1 as shown; rgba[3] alpha. */
typedef void (*draped_function)(double column, double row, double width, double height, double rgba[4]);

/* Waves of some pixels over slow changes, opaque. */
void draped_waves(double column, double row, double width, double height, double rgba[4]);
/* The same of a globe in longitude and latitude: waves in space, so that nothing is finer at the poles. */
void draped_globe(double column, double row, double width, double height, double rgba[4]);
/* Like a photograph of land: patches of all sizes from some hundreds of pixels down to one, the smaller the fainter. */
void draped_land(double column, double row, double width, double height, double rgba[4]);
/* Every pixel anything, opaque. */
void draped_noise(double column, double row, double width, double height, double rgba[4]);
/* Red in the left half, nothing in the right. */
void draped_half(double column, double row, double width, double height, double rgba[4]);

/* A picture held in memory, without a place of its own. Ends the program on failure. */
tc_image *draped_image(draped_function f, int64_t width, int64_t height);

/* The picture's eight bits at a place of it, pixels with centres at halves, between pixels in linear light, as shown:
 * 0 .. 255. around: columns go round. */
void draped_colour(tc_image *image, double px, double py, bool around, double rgb[3]);

/* The least and the most of that within half a pixel of it: around, half of one of the equator's, on the ground. */
void draped_bounds(tc_image *image, double px, double py, bool around, double lo[3], double hi[3]);

#endif
