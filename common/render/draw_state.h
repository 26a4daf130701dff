/* draw_state.h - the OpenGL state that a frame needs, and a host's own, which it gets back. */
#ifndef TC_DRAW_STATE_H
#define TC_DRAW_STATE_H

#include "target.h"

enum { TC_DRAW_SWITCHES = 32, TC_DRAW_UNPACKS = 8, TC_DRAW_UNITS = 5, TC_DRAW_BUFFERS = 8 };

/* All that a frame touches, as it was. */
typedef struct tc_draw_state {
    GLboolean on[TC_DRAW_SWITCHES];
    GLint unpack[TC_DRAW_UNPACKS];
    GLint framebuffer[2]; /* drawn to, read from */
    GLfloat viewport[4];
    GLint scissor[4];
    GLdouble depth_range[2];
    GLint clip_control[2], depth_func, cull_face, front_face, polygon_mode, provoking;
    GLboolean depth_mask, colour_mask[TC_DRAW_BUFFERS][4];
    GLint colour_buffers; /* that the driver has, at most TC_DRAW_BUFFERS */
    GLint program, vertex_array, indirect, unpack_buffer, uniform_buffer, uniforms;
    GLint64 uniforms_start, uniforms_size;
    GLint active_unit, texture[TC_DRAW_UNITS], sampler[TC_DRAW_UNITS];
} tc_draw_state;

void tc_draw_state_get(const tc_gl *gl, tc_draw_state *state);
void tc_draw_state_give_back(const tc_gl *gl, const tc_draw_state *state);

/* As uploads need it, whatever it was. */
void tc_draw_state_for_uploads(const tc_gl *gl);

/* As a frame in this place needs it, whatever it was, but for what a draw itself binds. */
void tc_draw_state_for_frame(const tc_gl *gl, const tc_target_place *place, bool whole, bool mirrored);

#endif
