/* context_egl.c - EGL contexts without a display: on a GPU (EGL_EXT_platform_device) or on whatever Mesa has
 * (EGL_MESA_platform_surfaceless). libEGL is loaded at run time, nothing is linked.
 *
 * An EGL display is one per process and device, and eglTerminate would end every context on it, so displays stay
 * initialised until the process ends; only the context goes. */
#include "gl.h"
#include "offscreen.h"
#include "common/base/status.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EGL_FUNCTIONS(X)                                                                                               \
    X(PFNEGLQUERYSTRINGPROC, QueryString)                                                                              \
    X(PFNEGLGETERRORPROC, GetError)                                                                                    \
    X(PFNEGLINITIALIZEPROC, Initialize)                                                                                \
    X(PFNEGLBINDAPIPROC, BindAPI)                                                                                      \
    X(PFNEGLCHOOSECONFIGPROC, ChooseConfig)                                                                            \
    X(PFNEGLCREATECONTEXTPROC, CreateContext)                                                                          \
    X(PFNEGLDESTROYCONTEXTPROC, DestroyContext)                                                                        \
    X(PFNEGLCREATEPBUFFERSURFACEPROC, CreatePbufferSurface)                                                            \
    X(PFNEGLDESTROYSURFACEPROC, DestroySurface)                                                                        \
    X(PFNEGLMAKECURRENTPROC, MakeCurrent)                                                                              \
    X(PFNEGLGETCURRENTCONTEXTPROC, GetCurrentContext)

/* The one way to a context on one display. */
typedef struct egl_state {
#define EGL_MEMBER(type, name) type name;
    EGL_FUNCTIONS(EGL_MEMBER)
#undef EGL_MEMBER
    void *(*get_proc)(const char *name);
    EGLDisplay display;
    EGLContext context;
    EGLSurface surface; /* none where the display can do without */
} egl_state;

static bool load(void *library, const char *name, void *pointer_ret)
{
    void *pointer = dlsym(library, name);
    memcpy(pointer_ret, &pointer, sizeof pointer);
    return pointer != NULL;
}

/* An extension's function, which dlsym does not know. */
static bool load_extension(const egl_state *egl, const char *name, void *pointer_ret)
{
    void *pointer = egl->get_proc(name);
    memcpy(pointer_ret, &pointer, sizeof pointer);
    return pointer != NULL;
}

/* Whether a list of words has this word. */
static bool has_word(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = words; at && (at = strstr(at, word)); at += length)
        if ((at == words || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return true;
    return false;
}

static tc_status egl_load(egl_state *egl, tc_error *error)
{
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return tc_fail(error, TC_ERR_CONTEXT, "libEGL.so.1 cannot be loaded");
#define EGL_LOAD(type, name)                                                                                           \
    if (!load(library, "egl" #name, &egl->name))                                                                       \
        return tc_fail(error, TC_ERR_CONTEXT, "libEGL.so.1 has no egl" #name);
    EGL_FUNCTIONS(EGL_LOAD)
#undef EGL_LOAD
    if (!load(library, "eglGetProcAddress", &egl->get_proc))
        return tc_fail(error, TC_ERR_CONTEXT, "libEGL.so.1 has no eglGetProcAddress");
    return TC_OK;
}

/* Ends the context and what belongs to it. */
static void egl_drop(egl_state *egl)
{
    if (egl->context != EGL_NO_CONTEXT) {
        if (egl->GetCurrentContext() == egl->context)
            egl->MakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        egl->DestroyContext(egl->display, egl->context);
    }
    if (egl->surface != EGL_NO_SURFACE)
        egl->DestroySurface(egl->display, egl->surface);
    egl->context = EGL_NO_CONTEXT;
    egl->surface = EGL_NO_SURFACE;
}

static void egl_destroy(void *state)
{
    egl_state *egl = state;
    egl_drop(egl);
    free(egl);
}

/* Initialises the display, creates a context on it and makes it current. */
static tc_status egl_start(egl_state *egl, EGLDisplay display, tc_error *error)
{
    EGLint major, minor;
    if (display == EGL_NO_DISPLAY || !egl->Initialize(display, &major, &minor))
        return tc_fail(error, TC_ERR_CONTEXT, "the EGL display cannot be initialised (0x%x)", egl->GetError());
    egl->display = display;
    const char *extensions = egl->QueryString(display, EGL_EXTENSIONS);
    if (!egl->BindAPI(EGL_OPENGL_API))
        return tc_fail(error, TC_ERR_CONTEXT, "EGL %d.%d has no desktop OpenGL", major, minor);
    bool surfaceless = has_word(extensions, "EGL_KHR_surfaceless_context");
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, surfaceless ? 0 : EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                        EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (!egl->ChooseConfig(display, config_attributes, &config, 1, &count) || count < 1)
        return tc_fail(error, TC_ERR_CONTEXT, "EGL has no configuration for OpenGL");
    static const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    egl->context = egl->CreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    if (egl->context == EGL_NO_CONTEXT)
        return tc_fail(error, TC_ERR_CONTEXT, "no OpenGL 4.5 core context (0x%x)", egl->GetError());
    if (!surfaceless) {
        static const EGLint surface_attributes[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
        egl->surface = egl->CreatePbufferSurface(display, config, surface_attributes);
    }
    if (!egl->MakeCurrent(display, egl->surface, egl->surface, egl->context))
        return tc_fail(error, TC_ERR_CONTEXT, "the context cannot be made current (0x%x)", egl->GetError());
    return TC_OK;
}

/* Whether the current context draws in software after all, as it does where a device has no driver. */
static bool draws_in_software(const egl_state *egl)
{
    enum { RENDERER = 0x1F01 };
    const unsigned char *(*get_string)(unsigned name);
    if (!load_extension(egl, "glGetString", &get_string))
        return true;
    const char *renderer = (const char *)get_string(RENDERER);
    return !renderer || tc_gl_software(renderer);
}

static tc_status start_surfaceless(egl_state *egl, tc_error *error)
{
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display;
    const char *extensions = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_MESA_platform_surfaceless") ||
        !load_extension(egl, "eglGetPlatformDisplayEXT", &get_platform_display))
        return tc_fail(error, TC_ERR_CONTEXT, "EGL has no EGL_MESA_platform_surfaceless");
    return egl_start(egl, get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), error);
}

/* The first device that is hardware and works. */
static tc_status start_device(egl_state *egl, tc_error *error)
{
    enum { MAX_DEVICES = 16 };
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display;
    PFNEGLQUERYDEVICESEXTPROC query_devices;
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string;
    const char *extensions = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    bool enumerates =
        has_word(extensions, "EGL_EXT_device_base") ||
        (has_word(extensions, "EGL_EXT_device_enumeration") && has_word(extensions, "EGL_EXT_device_query"));
    if (!enumerates || !has_word(extensions, "EGL_EXT_platform_device") ||
        !load_extension(egl, "eglGetPlatformDisplayEXT", &get_platform_display) ||
        !load_extension(egl, "eglQueryDevicesEXT", &query_devices) ||
        !load_extension(egl, "eglQueryDeviceStringEXT", &query_device_string))
        return tc_fail(error, TC_ERR_CONTEXT, "EGL has no EGL_EXT_platform_device");
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint count = 0;
    if (!query_devices(MAX_DEVICES, devices, &count))
        count = 0;
    tc_error last = {.text = "no hardware device"};
    for (EGLint i = 0; i < count; i++) {
        if (has_word(query_device_string(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software"))
            continue;
        EGLDisplay display = get_platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
        if (egl_start(egl, display, &last) == TC_OK) {
            if (!draws_in_software(egl))
                return TC_OK;
            tc_fail(&last, TC_ERR_CONTEXT, "the device has no hardware driver");
        }
        egl_drop(egl);
    }
    return tc_fail(error, TC_ERR_CONTEXT, "%s", last.text);
}

static tc_status open_egl(const char *name, tc_status (*start)(egl_state *egl, tc_error *error),
                          tc_offscreen *offscreen_ret, tc_error *error)
{
    egl_state *egl = calloc(1, sizeof *egl);
    if (!egl)
        return tc_fail(error, TC_ERR_MEMORY, "not enough memory");
    tc_status status = egl_load(egl, error);
    if (status == TC_OK)
        status = start(egl, error);
    if (status != TC_OK) {
        egl_destroy(egl);
        return status;
    }
    *offscreen_ret = (tc_offscreen){.name = name, .state = egl, .get_proc = egl->get_proc, .destroy = egl_destroy};
    return TC_OK;
}

tc_status tc_offscreen_egl_device(tc_offscreen *offscreen_ret, tc_error *error)
{
    return open_egl("egl-device", start_device, offscreen_ret, error);
}

tc_status tc_offscreen_egl_surfaceless(tc_offscreen *offscreen_ret, tc_error *error)
{
    return open_egl("egl-surfaceless", start_surfaceless, offscreen_ret, error);
}
