/* debug.c - OpenGL's debug output. */
#include "debug.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void APIENTRY complain(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                              const GLchar *message, const void *context)
{
    (void)severity, (void)length, (void)context;
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER || strstr(message, "OUT_OF_MEMORY") ||
        (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR))
        return;
    fprintf(stderr, "OpenGL: %s (0x%x)\n", message, id);
    abort();
}

static bool wanted(void)
{
#ifdef NDEBUG
    return getenv("TERRACLIP_GL_DEBUG") != NULL;
#else
    return true;
#endif
}

void tc_gl_watch(const tc_gl *gl)
{
    if (!wanted())
        return;
    gl->Enable(GL_DEBUG_OUTPUT);
    gl->Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS); /* so that a debugger stands where the fault is */
    gl->DebugMessageCallback(complain, NULL);
}
