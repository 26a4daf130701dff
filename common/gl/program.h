/* program.h - shader programs assembled from the parts that a scene needs. */
#ifndef TC_PROGRAM_H
#define TC_PROGRAM_H

#include "common/terraclip.h"
#include "gl.h"

/* The files of shaders/, built into the program; the list ends with a NULL name. */
struct tc_shader_file {
    const char *name, *text;
};
extern const struct tc_shader_file tc_shader_files[];

/* Text by name: of `own`, a list that ends with a NULL name (NULL: none), else of a file; NULL where there is none. */
const char *tc_shader_text(const struct tc_shader_file *own, const char *name);

/* Compiles and links. vertex and fragment name texts of `own` or files of shaders/, in order, NULL-terminated lists;
 * defines is text put after the #version line of both ("#define LIT\n..."). A compiler's complaint goes into *error,
 * cut to its first line, prefixed by the file's name. */
tc_status tc_program_build(const tc_gl *gl, const char *const *vertex, const char *const *fragment,
                           const struct tc_shader_file *own, const char *defines, GLuint *program_ret, tc_error *error);

#endif
