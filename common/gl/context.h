/* context.h - an OpenGL 4.5 core context: a window's, or one without a display. */
#ifndef TC_CONTEXT_H
#define TC_CONTEXT_H

#include "common/terraclip.h"
#include "gl.h"

typedef enum tc_backend {
    TC_BACKEND_AUTO = 0, /* offscreen: EGL device (a real GPU), EGL surfaceless, OSMesa, the first that works;
                            with a window: GLFW */
    TC_BACKEND_WINDOW,
    TC_BACKEND_EGL,
    TC_BACKEND_OSMESA
} tc_backend;

typedef struct tc_context tc_context;

/* Creates an offscreen context and makes it current. Where several were tried, *error says why each failed. */
tc_status tc_context_create(tc_backend backend, tc_context **context_ret, tc_error *error);
void tc_context_destroy(tc_context *context);

const tc_gl *tc_context_gl(const tc_context *context);

/* "egl-device", "egl-surfaceless", "osmesa"; what --stats calls the backend. */
const char *tc_context_backend(const tc_context *context);

#endif
