/* frame_clock.h - how long frames take: by the clock on the wall until all is drawn or, on a GPU, by its own. */
#ifndef FRAME_CLOCK_H
#define FRAME_CLOCK_H

#include "common/gl/context.h"
#include "measure.h"

typedef struct frame_clock {
    const tc_gl *gl;
    bool gpu;
    GLuint query;
} frame_clock;

/* gpu: whether the context draws on one. */
frame_clock frame_clock_create(const tc_context *context);
frame_clock frame_clock_of(const tc_gl *gl, bool gpu);
void frame_clock_destroy(frame_clock *clock);

/* Draws a frame; finish: until it is done. */
typedef void (*frame_function)(void *context, bool finish);

/* Milliseconds of one frame. On a GPU some follow each other without a pause, as they would in a window, between the
 * ends of one timer query, and their mean is taken: what the processor does for a frame is then seen only where the GPU
 * waits for it. */
double frame_clock_ms(const frame_clock *clock, frame_function draw, void *context);

/* The same `count` times into ms. */
void frame_clock_repeat(const frame_clock *clock, frame_function draw, void *context, int count, double *ms);

#endif
