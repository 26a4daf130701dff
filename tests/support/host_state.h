/* host_state.h - OpenGL state as a host might have it: set to what nobody else would, and asked for. */
#ifndef HOST_STATE_H
#define HOST_STATE_H

#include "common/gl/gl.h"

/* What odd state is made of. */
typedef struct host_odd {
    GLuint texture[3], sampler, buffer, vertex_array, program, framebuffer;
} host_odd;

/* Sets all that a frame could touch to something odd that must not show. */
host_odd host_odd_begin(const tc_gl *gl);
/* As a context begins, more or less. */
void host_odd_end(const tc_gl *gl, host_odd *odd);

enum { HOST_STATE_VALUES = 400 };
typedef struct host_state {
    int count;
    double value[HOST_STATE_VALUES];
    char name[HOST_STATE_VALUES][48];
} host_state;
host_state host_state_now(const tc_gl *gl);

/* Fails the test by the first value that differs. */
void host_state_assert_same(const host_state *before, const host_state *after);

#endif
