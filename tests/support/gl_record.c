/* gl_record.c - a table of OpenGL functions that notes what is asked for. */
#include "gl_record.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Functions of OpenGL have no context argument: what is recorded now, and what does the work. */
static tc_gl real;
static gl_record *now;

static gl_object *find(gl_object *objects, GLuint name)
{
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (objects[i].name == name)
            return &objects[i];
    fprintf(stderr, "gl_record: an object too many, or unknown\n");
    exit(99);
}

static void made(gl_object *objects, GLsizei n, const GLuint *names)
{
    for (GLsizei i = 0; i < n; i++)
        *find(objects, 0) = (gl_object){.name = names[i]};
}

static void deleted(gl_object *objects, GLsizei n, const GLuint *names)
{
    for (GLsizei i = 0; i < n; i++)
        if (names[i])
            *find(objects, names[i]) = (gl_object){0};
}

static int64_t texel_bytes(GLenum format)
{
    switch (format) {
    case GL_RG32F:
    case GL_RGBA16:
    case GL_RGBA16_SNORM: return 8;
    case GL_R8: return 1;
    default: return 4; /* RGBA8, RGBA8_SNORM, DEPTH_COMPONENT32F */
    }
}

static void stored(gl_object *object, GLenum format, int width, int height, int depth, int samples)
{
    *object = (gl_object){object->name, format, width, height, depth, samples, 0};
    object->bytes = texel_bytes(format) * width * height * depth * (samples > 1 ? samples : 1);
}

/* ---- Textures --------------------------------------------------------------------------------------------------- */

static void APIENTRY create_textures(GLenum target, GLsizei n, GLuint *names)
{
    real.CreateTextures(target, n, names);
    made(now->textures, n, names);
    now->textures_made += n;
}

static void APIENTRY delete_textures(GLsizei n, const GLuint *names)
{
    real.DeleteTextures(n, names);
    deleted(now->textures, n, names);
}

static void APIENTRY texture_storage_1d(GLuint name, GLsizei levels, GLenum format, GLsizei width)
{
    real.TextureStorage1D(name, levels, format, width);
    stored(find(now->textures, name), format, width, 1, 1, 1);
}

static void APIENTRY texture_storage_2d(GLuint name, GLsizei levels, GLenum format, GLsizei width, GLsizei height)
{
    real.TextureStorage2D(name, levels, format, width, height);
    stored(find(now->textures, name), format, width, height, 1, 1);
}

static void APIENTRY texture_storage_samples(GLuint name, GLsizei samples, GLenum format, GLsizei width, GLsizei height,
                                             GLboolean fixed)
{
    real.TextureStorage2DMultisample(name, samples, format, width, height, fixed);
    stored(find(now->textures, name), format, width, height, 1, samples);
}

static void APIENTRY texture_storage_3d(GLuint name, GLsizei levels, GLenum format, GLsizei width, GLsizei height,
                                        GLsizei depth)
{
    real.TextureStorage3D(name, levels, format, width, height, depth);
    stored(find(now->textures, name), format, width, height, depth, 1);
}

/* ---- Buffers ---------------------------------------------------------------------------------------------------- */

static void APIENTRY create_buffers(GLsizei n, GLuint *names)
{
    real.CreateBuffers(n, names);
    made(now->buffers, n, names);
}

static void APIENTRY delete_buffers(GLsizei n, const GLuint *names)
{
    real.DeleteBuffers(n, names);
    deleted(now->buffers, n, names);
}

static void APIENTRY buffer_storage(GLuint name, GLsizeiptr size, const void *data, GLbitfield flags)
{
    real.NamedBufferStorage(name, size, data, flags);
    find(now->buffers, name)->bytes = size;
}

static void APIENTRY buffer_data(GLuint name, GLsizeiptr size, const void *data, GLenum usage)
{
    real.NamedBufferData(name, size, data, usage);
    find(now->buffers, name)->bytes = size;
}

static void APIENTRY create_renderbuffers(GLsizei n, GLuint *names)
{
    real.CreateRenderbuffers(n, names);
    made(now->renderbuffers, n, names);
}

static void APIENTRY delete_renderbuffers(GLsizei n, const GLuint *names)
{
    real.DeleteRenderbuffers(n, names);
    deleted(now->renderbuffers, n, names);
}

static void APIENTRY renderbuffer_storage(GLuint name, GLsizei samples, GLenum format, GLsizei width, GLsizei height)
{
    real.NamedRenderbufferStorageMultisample(name, samples, format, width, height);
    stored(find(now->renderbuffers, name), format, width, height, 1, samples);
}

/* ---- Programs --------------------------------------------------------------------------------------------------- */

/* The defines are the second of the strings (program.c); the terrain's say WINDOW_MASK. */
static char *changed_defines(const char *defines)
{
    char *text = calloc(strlen(defines) + 64, 1);
    if (!text)
        exit(99);
    strcpy(text, defines);
    if (!strstr(defines, "WINDOW_MASK"))
        return text;
    if (now->add)
        sprintf(text + strlen(text), "#define %s\n", now->add);
    if (now->drop) {
        char line[64];
        snprintf(line, sizeof line, "#define %s\n", now->drop);
        char *at = strstr(text, line);
        if (at)
            memmove(at, at + strlen(line), strlen(at + strlen(line)) + 1);
    }
    return text;
}

static void keep_text(GLsizei count, const GLchar *const *strings)
{
    size_t size = 1;
    for (GLsizei i = 0; i < count; i++)
        size += strlen(strings[i]);
    char *whole = calloc(size, 1);
    for (GLsizei i = 0; whole && i < count; i++)
        strcat(whole, strings[i]);
    char *kept = whole ? glsl_kept(whole) : NULL;
    char *text = kept ? realloc(now->text, now->text_bytes + strlen(kept) + 1) : NULL;
    if (!text)
        exit(99);
    strcpy(text + now->text_bytes, kept);
    now->text = text;
    now->text_bytes += strlen(kept);
    free(whole);
    free(kept);
}

static void APIENTRY shader_source(GLuint shader, GLsizei count, const GLchar *const *strings, const GLint *lengths)
{
    const GLchar *copies[64];
    if (count > 64 || count < 2 || lengths)
        exit(99);
    memcpy(copies, strings, (size_t)count * sizeof *copies);
    char *defines = changed_defines(strings[1]);
    copies[1] = defines;
    real.ShaderSource(shader, count, copies, NULL);
    keep_text(count, copies);
    free(defines);
}

static void APIENTRY link_program(GLuint program)
{
    real.LinkProgram(program);
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (!now->programs[i]) {
            now->programs[i] = program;
            break;
        }
    now->programs_made++;
}

static void APIENTRY delete_program(GLuint program)
{
    real.DeleteProgram(program);
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (now->programs[i] == program)
            now->programs[i] = 0;
}

static void APIENTRY multi_draw(GLenum mode, GLenum type, const void *indirect, GLsizei count, GLsizei stride)
{
    real.MultiDrawElementsIndirect(mode, type, indirect, count, stride);
    now->draws += count;
}

/* ---- Recording -------------------------------------------------------------------------------------------------- */

tc_gl gl_record_begin(const tc_gl *gl, gl_record *record)
{
    real = *gl;
    *record = (gl_record){.add = record->add, .drop = record->drop};
    now = record;
    tc_gl t = *gl;
    t.CreateTextures = create_textures;
    t.DeleteTextures = delete_textures;
    t.TextureStorage1D = texture_storage_1d;
    t.TextureStorage2D = texture_storage_2d;
    t.TextureStorage3D = texture_storage_3d;
    t.TextureStorage2DMultisample = texture_storage_samples;
    t.CreateBuffers = create_buffers;
    t.DeleteBuffers = delete_buffers;
    t.NamedBufferStorage = buffer_storage;
    t.NamedBufferData = buffer_data;
    t.CreateRenderbuffers = create_renderbuffers;
    t.DeleteRenderbuffers = delete_renderbuffers;
    t.NamedRenderbufferStorageMultisample = renderbuffer_storage;
    t.ShaderSource = shader_source;
    t.LinkProgram = link_program;
    t.DeleteProgram = delete_program;
    t.MultiDrawElementsIndirect = multi_draw;
    return t;
}

void gl_record_on(gl_record *record)
{
    now = record;
}

void gl_record_end(gl_record *record)
{
    free(record->text);
    *record = (gl_record){0};
}

int64_t gl_record_bytes(const gl_record *record)
{
    int64_t bytes = 0;
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        bytes += record->textures[i].bytes + record->buffers[i].bytes + record->renderbuffers[i].bytes;
    return bytes;
}

const gl_object *gl_record_texture(const gl_record *record, GLenum format)
{
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (record->textures[i].name && record->textures[i].format == format)
            return &record->textures[i];
    return NULL;
}

bool gl_record_has_text(const gl_record *record, const char *word)
{
    return record->text && strstr(record->text, word) != NULL;
}

bool gl_record_has_uniform(const tc_gl *gl, const gl_record *record, const char *name)
{
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (record->programs[i] && gl->GetUniformLocation(record->programs[i], name) >= 0)
            return true;
    return false;
}
