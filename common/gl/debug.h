/* debug.h - what the driver has to say about how it is used (KHR_debug, OpenGL 4.3). */
#ifndef TC_GL_DEBUG_H
#define TC_GL_DEBUG_H

#include "gl.h"

/* Has errors and undefined behaviour printed and the program aborted at once, in the call that is at fault, in builds
 * with assertions (config=debug, sanitize) and where TERRACLIP_GL_DEBUG is set, as tests have it. Of a context of our
 * own only: a host's messages are the host's. Not meant are what a shader's source lacks, which its compiler's log
 * tells, and memory that there is not, which tc_gl_allocated() tells. */
void tc_gl_watch(const tc_gl *gl);

#endif
