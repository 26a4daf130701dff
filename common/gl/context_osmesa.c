/* context_osmesa.c - Mesa's software renderer as a library of its own (libOSMesa), which needs no display, no driver
 * and no device. It is the reference of the picture tests. Mesa dropped it after 25.0.
 *
 * Its header is not installed everywhere, so the few declarations needed are here. */
#include "offscreen.h"
#include "common/base/status.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

typedef struct osmesa_context *OSMesaContext;

enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_STENCIL_BITS = 0x31,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37,
    FORMAT_RGBA = 0x1908,
    TYPE_UNSIGNED_BYTE = 0x1401,
    BUFFER_SIZE = 16 /* pixels a side of the default framebuffer, which is never drawn to */
};

typedef struct osmesa_state {
    OSMesaContext context;
    OSMesaContext (*create)(const int *attributes, OSMesaContext share);
    unsigned char (*make_current)(OSMesaContext context, void *buffer, unsigned type, int width, int height);
    void (*destroy)(OSMesaContext context);
    void *(*get_proc)(const char *name);
    unsigned char buffer[BUFFER_SIZE * BUFFER_SIZE * 4];
} osmesa_state;

static void osmesa_destroy(void *state)
{
    osmesa_state *osmesa = state;
    if (osmesa->context) {
        osmesa->make_current(NULL, NULL, 0, 0, 0);
        osmesa->destroy(osmesa->context);
    }
    free(osmesa);
}

static bool load(void *library, const char *name, void *pointer_ret)
{
    void *pointer = dlsym(library, name);
    memcpy(pointer_ret, &pointer, sizeof pointer);
    return pointer != NULL;
}

static tc_status start(osmesa_state *osmesa, tc_error *error)
{
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
    void *library = NULL;
    for (size_t i = 0; i < sizeof names / sizeof *names && !library; i++)
        library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    if (!library)
        return tc_fail(error, TC_ERR_CONTEXT, "libOSMesa.so.8 (or .6) cannot be loaded");
    if (!load(library, "OSMesaCreateContextAttribs", &osmesa->create) ||
        !load(library, "OSMesaMakeCurrent", &osmesa->make_current) ||
        !load(library, "OSMesaDestroyContext", &osmesa->destroy) ||
        !load(library, "OSMesaGetProcAddress", &osmesa->get_proc))
        return tc_fail(error, TC_ERR_CONTEXT, "libOSMesa is too old to make core contexts");
    static const int attributes[] = {OSMESA_FORMAT,
                                     FORMAT_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     0,
                                     OSMESA_STENCIL_BITS,
                                     0,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     5,
                                     0};
    osmesa->context = osmesa->create(attributes, NULL);
    if (!osmesa->context)
        return tc_fail(error, TC_ERR_CONTEXT, "no OpenGL 4.5 core context");
    if (!osmesa->make_current(osmesa->context, osmesa->buffer, TYPE_UNSIGNED_BYTE, BUFFER_SIZE, BUFFER_SIZE))
        return tc_fail(error, TC_ERR_CONTEXT, "the context cannot be made current");
    return TC_OK;
}

tc_status tc_offscreen_osmesa(tc_offscreen *offscreen_ret, tc_error *error)
{
    osmesa_state *osmesa = calloc(1, sizeof *osmesa);
    if (!osmesa)
        return tc_fail(error, TC_ERR_MEMORY, "not enough memory");
    tc_status status = start(osmesa, error);
    if (status != TC_OK) {
        osmesa_destroy(osmesa);
        return status;
    }
    *offscreen_ret =
        (tc_offscreen){.name = "osmesa", .state = osmesa, .get_proc = osmesa->get_proc, .destroy = osmesa_destroy};
    return TC_OK;
}
