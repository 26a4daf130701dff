/* canvas.h - what a renderer draws on when nobody gives it a target: colour and depth of its own, with several samples
 * a pixel where asked for, and the picture that comes of them. */
#ifndef TC_CANVAS_H
#define TC_CANVAS_H

#include "common/gl/gl.h"

/* Zero is none yet. */
typedef struct tc_canvas {
    int width, height, samples; /* pixels; samples a pixel, 1 or more */
    GLuint framebuffer;         /* to draw into */
    GLuint colour, depth; /* RGBA8, roots of colours (renderer.frag); 32-bit float. Textures of several samples, or
                             renderbuffers of one */
    GLuint picture;       /* a framebuffer of one sample a pixel, to read from: the same, or what is resolved into */
    GLuint resolved, program, vertices;
} tc_canvas;

/* Makes it anew where size or samples differ from what it is. samples: as many as the driver has, at most.
 * TC_ERR_MEMORY or TC_ERR_CONTEXT where the driver cannot; it is none then. */
tc_status tc_canvas_resize(const tc_gl *gl, tc_canvas *canvas, int width, int height, int samples, tc_error *error);
void tc_canvas_destroy(const tc_gl *gl, tc_canvas *canvas);

/* Samples a pixel that the driver can draw where so many are asked for. */
int tc_canvas_samples(const tc_gl *gl, int samples);

/* Makes the picture of what was drawn: the mean of a pixel's samples as light, not as numbers. */
void tc_canvas_resolve(const tc_gl *gl, const tc_canvas *canvas);

/* The picture: rgb 3 bytes a pixel, rows top to bottom. depth, where not NULL: as drawn; of canvases of one sample. */
void tc_canvas_read(const tc_gl *gl, const tc_canvas *canvas, uint8_t *rgb, float *depth);

#endif
