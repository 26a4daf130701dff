/* gl_refuse.h - a driver that has no memory for the k-th thing it is asked to store, and counts what is alive. */
#ifndef GL_REFUSE_H
#define GL_REFUSE_H

#include "common/gl/gl.h"

/* One at a time: refuse is the number of the allocation to refuse, from 1 on (0: none); asked and alive count what was
 * asked for and the objects, programs, shaders and fences that there are. */
typedef struct gl_refuse {
    int refuse, asked, alive;
    bool maps_nothing; /* no buffer is mapped */
} gl_refuse;

/* A table that does what gl does, but for what is refused. *refuse stays in place while it is used. */
tc_gl gl_refuse_begin(const tc_gl *gl, gl_refuse *refuse);

#endif
