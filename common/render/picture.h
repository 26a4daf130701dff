/* picture.h - the target of pictures and of windows: a canvas of the renderer's own. */
#ifndef TC_PICTURE_H
#define TC_PICTURE_H

#include "canvas.h"
#include "target.h"

/* Of no size yet where all but `target.class` and `samples` is zero; freed by tc_canvas_destroy(). */
typedef struct tc_picture {
    tc_target target;
    int samples; /* a pixel, asked for */
    tc_canvas canvas;
} tc_picture;

extern const tc_target_class tc_picture_class;

#endif
