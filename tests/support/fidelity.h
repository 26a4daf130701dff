/* fidelity.h - pictures as they should be, and how near others are to them. */
#ifndef FIDELITY_H
#define FIDELITY_H

#include "common/render/palette.h"
#include "draped.h"
#include "measured.h"

/* The colour of ground at metres above z_base, unlit: what renderer.frag shows, 8-bit levels without rounding. */
void palette_colour(const tc_palette *palette, double z, double rgb[3]);

/* Casts a ray through the middle of each pixel against the finest level of *m and colours what it meets. */
typedef struct cast_picture {
    int width, height;
    uint8_t *rgb;     /* rows top to bottom, owned */
    double *distance; /* metres from the eye; 0: background. Owned */
    int64_t covered;  /* pixels that show terrain */
} cast_picture;
typedef struct caster caster;
caster *caster_create(const measured *m);
/* Colours from now on by a picture over all of a flat terrain, which outlives it. */
void caster_drape(caster *c, tc_image *image);
void caster_destroy(caster *c);
cast_picture caster_picture(const caster *c, const tc_camera *camera, const uint8_t background[3]);
void cast_picture_free(cast_picture *p);

/* Structural similarity of two pictures' luminance (Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From
 * Error Visibility to Structural Similarity", 2004): windows of 11 x 11 with Gaussian weights of deviation 1.5 that lie
 * within the picture, K1 = 0.01, K2 = 0.03, L = 255; their mean. NAN for pictures smaller than a window. */
double picture_ssim(const uint8_t *a, const uint8_t *b, int width, int height);

/* Root mean square difference over all pixels and channels, in levels of 8 bits. */
double picture_rmse(const uint8_t *a, const uint8_t *b, int width, int height);

#endif
