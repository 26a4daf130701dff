/* offscreen.h - the ways to an OpenGL context without a display, behind one shape. Internal to context*.c.
 *
 * Each opens its library when asked to and not before, and never closes it: drivers leave threads and exit handlers
 * behind that must not lose their code. */
#ifndef TC_OFFSCREEN_H
#define TC_OFFSCREEN_H

#include "common/terraclip.h"

typedef struct tc_offscreen {
    const char *name; /* as tc_context_backend gives it */
    void *state;      /* owned */
    void *(*get_proc)(const char *name);
    void (*destroy)(void *state); /* frees state, too; the context must be current or none be */
} tc_offscreen;

/* Each creates a context that is at least asked to be OpenGL 4.5 core and makes it current. *error says in a few words
 * why it could not, without naming the backend. */
typedef tc_status (*tc_offscreen_function)(tc_offscreen *offscreen_ret, tc_error *error);

tc_status tc_offscreen_egl_device(tc_offscreen *offscreen_ret, tc_error *error);      /* a real GPU, else fails */
tc_status tc_offscreen_egl_surfaceless(tc_offscreen *offscreen_ret, tc_error *error); /* Mesa, mostly in software */
tc_status tc_offscreen_osmesa(tc_offscreen *offscreen_ret, tc_error *error);          /* Mesa up to 25.0, in software */

#endif
