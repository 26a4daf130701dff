/* feedback.h - what a vertex stage puts out, read back from the driver by transform feedback. */
#ifndef FEEDBACK_H
#define FEEDBACK_H

#include <stddef.h>

#include "common/gl/gl.h"

/* A program of a vertex stage alone: the shader files `parts` (NULL-terminated) and then the text `own`; `varyings`,
 * NULL-terminated, are captured one after the other. Ends the program with the compiler's complaint on failure. */
GLuint feedback_program(const tc_gl *gl, const char *defines, const char *const *parts, const char *own,
                        const char *const *varyings);

/* Runs it over vertices first .. first + count - 1 of what is bound, each `floats` floats in out. */
void feedback_run(const tc_gl *gl, GLuint program, int first, int count, int floats, float *out);

#endif
