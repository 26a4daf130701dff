/* gl_refuse.c - refusals are errors that wait to be asked for, as a driver's are. */
#include "gl_refuse.h"

static tc_gl real;
static gl_refuse *now;
static bool pending; /* GL_OUT_OF_MEMORY */

static bool refused(void)
{
    bool no = ++now->asked == now->refuse;
    pending |= no;
    return no;
}

static GLenum APIENTRY get_error(void)
{
    if (!pending)
        return real.GetError();
    pending = false;
    return GL_OUT_OF_MEMORY;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static void APIENTRY buffer_storage(GLuint buffer, GLsizeiptr size, const void *data, GLbitfield flags)
{
    if (!refused())
        real.NamedBufferStorage(buffer, size, data, flags);
}

static void *APIENTRY map(GLuint buffer, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
    if (!now->maps_nothing)
        return real.MapNamedBufferRange(buffer, offset, length, access);
    pending = true;
    return NULL;
}

static void APIENTRY buffer_data(GLuint buffer, GLsizeiptr size, const void *data, GLenum usage)
{
    if (!refused())
        real.NamedBufferData(buffer, size, data, usage);
}

static void APIENTRY storage_1d(GLuint texture, GLsizei levels, GLenum format, GLsizei width)
{
    if (!refused())
        real.TextureStorage1D(texture, levels, format, width);
}

static void APIENTRY storage_3d(GLuint texture, GLsizei levels, GLenum format, GLsizei w, GLsizei h, GLsizei d)
{
    if (!refused())
        real.TextureStorage3D(texture, levels, format, w, h, d);
}

static void APIENTRY storage_samples(GLuint texture, GLsizei samples, GLenum format, GLsizei w, GLsizei h,
                                     GLboolean fixed)
{
    if (!refused())
        real.TextureStorage2DMultisample(texture, samples, format, w, h, fixed);
}

static void APIENTRY renderbuffer(GLuint buffer, GLsizei samples, GLenum format, GLsizei w, GLsizei h)
{
    if (!refused())
        real.NamedRenderbufferStorageMultisample(buffer, samples, format, w, h);
}

/* ---- Objects ----------------------------------------------------------------------------------------------------- */

static void gone(GLsizei n, const GLuint *names)
{
    for (GLsizei i = 0; i < n; i++)
        now->alive -= names[i] != 0;
}

#define OBJECTS(name)                                                                                                  \
    static void APIENTRY create_##name(GLsizei n, GLuint *names)                                                       \
    {                                                                                                                  \
        real.Create##name(n, names);                                                                                   \
        now->alive += n;                                                                                               \
    }                                                                                                                  \
    static void APIENTRY delete_##name(GLsizei n, const GLuint *names)                                                 \
    {                                                                                                                  \
        real.Delete##name(n, names);                                                                                   \
        gone(n, names);                                                                                                \
    }
OBJECTS(Buffers)
OBJECTS(VertexArrays)
OBJECTS(Framebuffers)
OBJECTS(Renderbuffers)

static void APIENTRY create_textures(GLenum target, GLsizei n, GLuint *names)
{
    real.CreateTextures(target, n, names);
    now->alive += n;
}

static void APIENTRY delete_textures(GLsizei n, const GLuint *names)
{
    real.DeleteTextures(n, names);
    gone(n, names);
}

static GLuint APIENTRY create_program(void)
{
    now->alive++;
    return real.CreateProgram();
}

static void APIENTRY delete_program(GLuint program)
{
    real.DeleteProgram(program);
    gone(1, &program);
}

static GLuint APIENTRY create_shader(GLenum type)
{
    now->alive++;
    return real.CreateShader(type);
}

static void APIENTRY delete_shader(GLuint shader)
{
    real.DeleteShader(shader);
    gone(1, &shader);
}

static GLsync APIENTRY fence(GLenum condition, GLbitfield flags)
{
    now->alive++;
    return real.FenceSync(condition, flags);
}

static void APIENTRY delete_sync(GLsync sync)
{
    real.DeleteSync(sync);
    now->alive -= sync != NULL;
}

tc_gl gl_refuse_begin(const tc_gl *gl, gl_refuse *refuse)
{
    real = *gl;
    now = refuse;
    pending = false;
    tc_gl t = *gl;
    t.GetError = get_error;
    t.NamedBufferStorage = buffer_storage;
    t.NamedBufferData = buffer_data;
    t.MapNamedBufferRange = map;
    t.TextureStorage1D = storage_1d;
    t.TextureStorage3D = storage_3d;
    t.TextureStorage2DMultisample = storage_samples;
    t.NamedRenderbufferStorageMultisample = renderbuffer;
    t.CreateBuffers = create_Buffers, t.DeleteBuffers = delete_Buffers;
    t.CreateVertexArrays = create_VertexArrays, t.DeleteVertexArrays = delete_VertexArrays;
    t.CreateFramebuffers = create_Framebuffers, t.DeleteFramebuffers = delete_Framebuffers;
    t.CreateRenderbuffers = create_Renderbuffers, t.DeleteRenderbuffers = delete_Renderbuffers;
    t.CreateTextures = create_textures, t.DeleteTextures = delete_textures;
    t.CreateProgram = create_program, t.DeleteProgram = delete_program;
    t.CreateShader = create_shader, t.DeleteShader = delete_shader;
    t.FenceSync = fence, t.DeleteSync = delete_sync;
    return t;
}
