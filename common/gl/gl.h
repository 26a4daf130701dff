/* gl.h - OpenGL 4.5 core entry points, loaded through a callback; nothing is linked.
 *
 * The table belongs to one context. Calls read gl->Clear(...) for glClear(...). */
#ifndef TC_GL_H
#define TC_GL_H

#include "common/terraclip.h"

#define GL_GLEXT_PROTOTYPES 0
#include <GL/glcorearb.h>

#include "gl_functions.h" /* TC_GL_FUNCTIONS(X): X(PFNGLCLEARPROC, Clear) ... */

typedef struct tc_gl {
#define TC_GL_MEMBER(type, name) type name;
    TC_GL_FUNCTIONS(TC_GL_MEMBER)
#undef TC_GL_MEMBER
} tc_gl;

/* Whether a GL_RENDERER string names one of Mesa's drivers that draw on the processor. */
bool tc_gl_software(const char *renderer);

/* Takes up to some errors that wait to be asked for. A lost context has them without end. */
void tc_gl_forget_errors(const tc_gl *gl);

/* Whether what was just allocated has its memory: looks at the errors since tc_gl_forget_errors(). TC_ERR_MEMORY where
 * the driver had none, TC_ERR_CONTEXT for any other error; what: for the message. */
tc_status tc_gl_allocated(const tc_gl *gl, const char *what, tc_error *error);

/* Bytes of its own memory that a GPU has free at the moment, where its driver tells (GL_NVX_gpu_memory_info,
 * GL_ATI_meminfo); else 0. Such drivers seldom say that there is none left: they begin to use the machine's instead,
 * and frames take many times as long. */
int64_t tc_gl_free_memory(const tc_gl *gl);

/* How many times as long as wide a pixel's area on a texture may be for its filter; 1: not at all, or by a driver that
 * draws in software, where it would cost what it costs. */
float tc_gl_anisotropy(const tc_gl *gl);

/* Fills in the table and checks that the current context is OpenGL 4.5 or newer. */
tc_status tc_gl_load(tc_gl *gl, void *(*get_proc)(const char *name), tc_error *error);

#endif
