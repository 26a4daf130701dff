/* picture.c - a canvas as a target: of the frame's size when it begins, resolved when it ends. */
#include "picture.h"

static tc_status begin(tc_target *target, const tc_gl *gl, int width, int height, tc_error *error)
{
    tc_picture *p = (tc_picture *)target;
    tc_status status = tc_canvas_resize(gl, &p->canvas, width, height, p->samples, error);
    p->target.whole = true;
    p->target.place = (tc_target_place){.framebuffer = p->canvas.framebuffer,
                                        .width = width,
                                        .height = height,
                                        .samples = p->canvas.samples,
                                        .clear = true};
    return status;
}

static tc_status end(tc_target *target, const tc_gl *gl, tc_error *error)
{
    (void)error;
    tc_canvas_resolve(gl, &((tc_picture *)target)->canvas);
    return TC_OK;
}

const tc_target_class tc_picture_class = {"picture", begin, end};
