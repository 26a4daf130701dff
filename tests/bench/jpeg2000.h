/* jpeg2000.h - JPEG 2000 by OpenJPEG, to compare with: 9/7, one tile, one layer, code blocks of 64 x 64, nothing in the
 * file but the code stream. */
#ifndef JPEG2000_H
#define JPEG2000_H

#include <stdbool.h>
#include <stdint.h>

#include "common/terraclip.h"

/* Heights as OpenJPEG takes them: multiples of 1/16 m above the lowest one, which costs no more than 0.02 m of rms. */
typedef struct j2k_image {
    int64_t width, height;
    int32_t *v; /* owned */
    int precision;
    double base;
} j2k_image;

enum { J2K_SCALE = 16 };

j2k_image j2k_image_of(const tc_grid *grid);
void j2k_image_free(j2k_image *image);

/* How many make sense: 8, or fewer where the smaller side has not as many halvings. */
int j2k_resolutions(const j2k_image *image);

/* Writes path at `bits` a sample at most, which does not depend on the threads; bytes of the file, 0 on failure, with a
 * line on stderr. */
int64_t j2k_encode(const j2k_image *image, double bits, int threads, const char *path);

/* Decodes a rectangle (rows as in image) by one thread into v, stored densely; opening the file and reading its header
 * included. False on failure, with a line on stderr. */
bool j2k_decode(const char *path, tc_rect rect, int32_t *v);

/* The same rms as ours. */
typedef struct j2k_match {
    double bits; /* interpolated between the nearest */
    double rms;  /* of the nearest, whose file is in path */
    int encodings;
} j2k_match;

/* Seeks the rate at which valid samples are off by rms; seed: bits a sample to start from. Ends the program on failure.
 */
j2k_match j2k_at_rms(const j2k_image *image, const tc_grid *grid, double rms, double seed, const char *path);

#endif
