/* context.c - an offscreen OpenGL context from the first backend that works.
 *
 * A backend works when its context comes up and all of OpenGL 4.5 core is there; what was wrong with those before it
 * is only told when none does. Nothing here forks: llvmpipe's threads would not come along, and the child would hang.
 */
#include "context.h"
#include "debug.h"
#include "offscreen.h"
#include "common/base/status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct tc_context {
    tc_gl gl;
    tc_offscreen offscreen;
};

/* The candidates, best first. */
static const struct candidate {
    tc_backend backend;
    const char *name;
    tc_offscreen_function open;
} candidates[] = {
    {TC_BACKEND_EGL, "egl-device", tc_offscreen_egl_device},
    {TC_BACKEND_EGL, "egl-surfaceless", tc_offscreen_egl_surfaceless},
    {TC_BACKEND_OSMESA, "osmesa", tc_offscreen_osmesa},
};

tc_status tc_context_create(tc_backend backend, tc_context **context_ret, tc_error *error)
{
    if (backend == TC_BACKEND_WINDOW)
        return tc_fail(error, TC_ERR_USAGE, "context: expected an offscreen backend, found a window's");
    tc_context *context = calloc(1, sizeof *context);
    if (!context)
        return tc_fail(error, TC_ERR_MEMORY, "context: not enough memory");
    char reasons[sizeof error->text] = "";
    size_t used = 0;
    for (size_t i = 0; i < sizeof candidates / sizeof *candidates; i++) {
        const struct candidate *candidate = &candidates[i];
        if (backend != TC_BACKEND_AUTO && backend != candidate->backend)
            continue;
        tc_error reason = {.text = ""};
        tc_status status = candidate->open(&context->offscreen, &reason);
        if (status == TC_OK) {
            status = tc_gl_load(&context->gl, context->offscreen.get_proc, &reason);
            if (status == TC_OK) {
                tc_gl_watch(&context->gl);
                *context_ret = context;
                return TC_OK;
            }
            context->offscreen.destroy(context->offscreen.state);
        }
        if (used < sizeof reasons)
            used += (size_t)snprintf(reasons + used, sizeof reasons - used, "%s%s: %s", used ? "; " : "",
                                     candidate->name, reason.text);
    }
    free(context);
    return tc_fail(error, TC_ERR_CONTEXT, "OpenGL: no offscreen context: %s", reasons);
}

void tc_context_destroy(tc_context *context)
{
    if (!context)
        return;
    context->offscreen.destroy(context->offscreen.state);
    free(context);
}

const tc_gl *tc_context_gl(const tc_context *context)
{
    return &context->gl;
}

const char *tc_context_backend(const tc_context *context)
{
    return context->offscreen.name;
}
