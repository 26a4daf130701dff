/* feedback.h - what a vertex stage puts out, read back from the driver by transform feedback. */
#ifndef FEEDBACK_H
#define FEEDBACK_H

#include <stddef.h>

#include "common/gl/gl.h"
#include "common/render/surface.h"

/* A program of a surface's vertex stage alone: its parts, the file `last` where not NULL, and then the text `own`;
 * `varyings`, NULL-terminated, are captured one after the other. Ends the program with the compiler's complaint on
 * failure. */
GLuint feedback_program(const tc_gl *gl, const tc_surface *surface, const char *scene, const char *last,
                        const char *own, const char *const *varyings);

/* Runs it over vertices first .. first + count - 1 of what is bound, each `floats` floats in out. */
void feedback_run(const tc_gl *gl, GLuint program, int first, int count, int floats, float *out);

/* The same over vertices element[0 .. count - 1], one after the other in out. */
void feedback_elements(const tc_gl *gl, GLuint program, const uint32_t *element, int count, int floats, float *out);

#endif
