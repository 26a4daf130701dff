/* gl.c - fills in the table of OpenGL functions.
 *
 * The version is looked at first and through functions that every OpenGL has: loaders such as libglvnd hand out a
 * pointer for any name, so a function that is missing cannot be told from one that is there. */
#include "gl.h"
#include "common/base/status.h"

#include <string.h>

_Static_assert(sizeof(void *) == sizeof(void (*)(void)), "function pointers travel as void *");

/* Looks up one function and stores its pointer, whatever its type. */
static bool load(void *(*get_proc)(const char *name), const char *name, void *pointer_ret)
{
    void *pointer = get_proc(name);
    memcpy(pointer_ret, &pointer, sizeof pointer);
    return pointer != NULL;
}

static const char *text_of(const tc_gl *gl, GLenum name)
{
    const char *text = (const char *)gl->GetString(name);
    return text ? text : "unknown";
}

tc_status tc_gl_load(tc_gl *gl, void *(*get_proc)(const char *name), tc_error *error)
{
    tc_gl table;
    if (!load(get_proc, "glGetString", &table.GetString) || !load(get_proc, "glGetIntegerv", &table.GetIntegerv) ||
        !load(get_proc, "glGetError", &table.GetError))
        return tc_fail(error, TC_ERR_CONTEXT, "OpenGL: expected 4.5 or newer, found no functions at all");
    const char *version = (const char *)table.GetString(GL_VERSION);
    if (!version)
        return tc_fail(error, TC_ERR_CONTEXT, "OpenGL: expected 4.5 or newer, found no current context");
    /* Before OpenGL 3.0 the two queries are errors and leave the numbers alone. */
    GLint major = 0, minor = 0;
    table.GetIntegerv(GL_MAJOR_VERSION, &major);
    table.GetIntegerv(GL_MINOR_VERSION, &minor);
    bool embedded = strncmp(version, "OpenGL ES", 9) == 0;
    if (embedded || major < 4 || (major == 4 && minor < 5))
        return tc_fail(error, TC_ERR_CONTEXT, "OpenGL: expected 4.5 or newer, found %s on %s", version,
                       text_of(&table, GL_RENDERER));
    tc_gl_forget_errors(&table);
#define TC_GL_LOAD(type, name)                                                                                         \
    if (!load(get_proc, "gl" #name, &table.name))                                                                      \
        return tc_fail(error, TC_ERR_CONTEXT, "OpenGL %s on %s: expected the function gl" #name ", found none",        \
                       version, text_of(&table, GL_RENDERER));
    TC_GL_FUNCTIONS(TC_GL_LOAD)
#undef TC_GL_LOAD
    *gl = table;
    return TC_OK;
}

void tc_gl_forget_errors(const tc_gl *gl)
{
    enum { MOST = 64 };
    for (int i = 0; i < MOST && gl->GetError() != GL_NO_ERROR; i++)
        ;
}

tc_status tc_gl_allocated(const tc_gl *gl, const char *what, tc_error *error)
{
    GLenum wrong = gl->GetError();
    if (wrong == GL_NO_ERROR)
        return TC_OK;
    tc_gl_forget_errors(gl);
    if (wrong == GL_OUT_OF_MEMORY)
        return tc_fail(error, TC_ERR_MEMORY, "%s: the driver has no memory for them", what);
    return tc_fail(error, TC_ERR_CONTEXT, "%s: the driver does not take them (0x%x)", what, wrong);
}

static bool has_extension(const tc_gl *gl, const char *name)
{
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *found = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (found && strcmp(found, name) == 0)
            return true;
    }
    return false;
}

int64_t tc_gl_free_memory(const tc_gl *gl)
{
    enum { CURRENT_AVAILABLE_VIDMEM_NVX = 0x9049, TEXTURE_FREE_MEMORY_ATI = 0x87FC };
    GLint kibibytes[4] = {0}; /* of AMD's four numbers the first is what all pools together have free */
    if (has_extension(gl, "GL_NVX_gpu_memory_info"))
        gl->GetIntegerv(CURRENT_AVAILABLE_VIDMEM_NVX, kibibytes);
    else if (has_extension(gl, "GL_ATI_meminfo"))
        gl->GetIntegerv(TEXTURE_FREE_MEMORY_ATI, kibibytes);
    return (int64_t)kibibytes[0] * 1024;
}

float tc_gl_anisotropy(const tc_gl *gl)
{
    GLint most = 1;
    if (tc_gl_software((const char *)gl->GetString(GL_RENDERER)) ||
        (!has_extension(gl, "GL_ARB_texture_filter_anisotropic") &&
         !has_extension(gl, "GL_EXT_texture_filter_anisotropic")))
        return 1;
    gl->GetIntegerv(GL_MAX_TEXTURE_MAX_ANISOTROPY, &most);
    return (float)(most < 1 ? 1 : most > 16 ? 16 : most);
}

bool tc_gl_software(const char *renderer)
{
    return strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe") || strstr(renderer, "swrast");
}
