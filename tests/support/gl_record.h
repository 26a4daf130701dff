/* gl_record.h - what a scene asks OpenGL for: textures, buffers, programs and the shader text that is left of them once
 * the preprocessor has been over it. One recording at a time. */
#ifndef GL_RECORD_H
#define GL_RECORD_H

#include "common/gl/gl.h"

enum { GL_RECORD_OBJECTS = 64 };

typedef struct gl_object {
    GLuint name;
    GLenum format; /* of a texture or a renderbuffer; 0: a buffer */
    int width, height, depth, samples;
    int64_t bytes;
} gl_object;

typedef struct gl_record {
    gl_object textures[GL_RECORD_OBJECTS], buffers[GL_RECORD_OBJECTS], renderbuffers[GL_RECORD_OBJECTS]; /* alive */
    GLuint programs[GL_RECORD_OBJECTS];                                                                  /* likewise */
    int textures_made, programs_made, draws; /* since it began, alive or not */
    char *text;                              /* kept by conditions, without comments; of all stages */
    size_t text_bytes;
    const char *add, *drop; /* changes the sources: a define to add to the terrain's, one to take away; NULL: none */
} gl_record;

/* A table that does what gl does and notes it in *record, which is cleared but for add and drop. Both stay in place
 * until gl_record_end(). Another recording may begin meanwhile: gl_record_on() goes on with an earlier one. */
tc_gl gl_record_begin(const tc_gl *gl, gl_record *record);
void gl_record_on(gl_record *record);
void gl_record_end(gl_record *record);

/* Of all that is alive. */
int64_t gl_record_bytes(const gl_record *record);
/* The texture of a format; NULL: none. */
const gl_object *gl_record_texture(const gl_record *record, GLenum format);
/* Whether a word stands in the kept text; whether a program has a uniform. */
bool gl_record_has_text(const gl_record *record, const char *word);
bool gl_record_has_uniform(const tc_gl *gl, const gl_record *record, const char *name);

/* GLSL as its preprocessor's conditions leave it, without comments; the caller's to free. Ends the program on a
 * condition that is more than defined(), !, && and ||. */
char *glsl_kept(const char *text);

#endif
