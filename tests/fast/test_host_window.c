/* test_host_window.c - a host's own window, framebuffer 0, with one sample a pixel and with several: maps are drawn
 * into it as into a framebuffer object, and what it is not is refused. The window is EGL's, without a display. */
#include "tests/support/test.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/gl/debug.h"
#include "common/terraclip_draw.h"
#include "tests/support/refused.h"
#include "tests/support/terrains.h"

enum { X = 24, Y = 17, WIDTH = 160, HEIGHT = 120, WHOLE_WIDTH = 200, WHOLE_HEIGHT = 150, SAMPLES = 4 };

typedef struct window {
    EGLDisplay display;
    EGLSurface surface;
    EGLContext context;
    tc_gl gl;
} window;

static void *get_proc(const char *name)
{
    void (*function)(void) = eglGetProcAddress(name);
    void *p;
    memcpy(&p, &function, sizeof p);
    return p;
}

static bool window_open(int samples, window *w)
{
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_DEPTH_SIZE,
                             24,
                             EGL_SAMPLES,
                             samples,
                             EGL_NONE};
    static const EGLint size[] = {EGL_WIDTH, WHOLE_WIDTH, EGL_HEIGHT, WHOLE_HEIGHT, EGL_NONE};
    static const EGLint version[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLConfig config;
    EGLint count = 0;
    tc_error error;
    w->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (w->display == EGL_NO_DISPLAY || !eglInitialize(w->display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API) ||
        !eglChooseConfig(w->display, wanted, &config, 1, &count) || count < 1)
        return false;
    w->surface = eglCreatePbufferSurface(w->display, config, size);
    w->context = eglCreateContext(w->display, config, EGL_NO_CONTEXT, version);
    if (!eglMakeCurrent(w->display, w->surface, w->surface, w->context) ||
        tc_gl_load(&w->gl, get_proc, &error) != TC_OK)
        return false;
    tc_gl_watch(&w->gl);
    return true;
}

static void window_close(window *w)
{
    eglMakeCurrent(w->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(w->display, w->context);
    eglDestroySurface(w->display, w->surface);
}

/* A framebuffer object like the window. */
static GLuint object_like(const window *w, int samples)
{
    GLuint framebuffer, buffer[2];
    w->gl.CreateFramebuffers(1, &framebuffer);
    w->gl.CreateRenderbuffers(2, buffer);
    for (int i = 0; i < 2; i++) {
        w->gl.NamedRenderbufferStorageMultisample(buffer[i], samples, i ? GL_DEPTH_COMPONENT24 : GL_RGBA8, WHOLE_WIDTH,
                                                  WHOLE_HEIGHT);
        w->gl.NamedFramebufferRenderbuffer(framebuffer, i ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                           buffer[i]);
    }
    return framebuffer;
}

/* The target's pixels, samples averaged as the driver does, over what was red before. */
static uint8_t *drawn(const window *w, tc_eye *eye, const tc_target_place *place)
{
    const tc_gl *gl = &w->gl;
    const tc_camera camera = {
        .x = 3000, .y = 2000, .z = 900, .heading = 0.7, .pitch = -0.25, .fov = 1.2, .width = WIDTH, .height = HEIGHT};
    uint8_t *rgb = malloc(3 * WHOLE_WIDTH * WHOLE_HEIGHT);
    GLuint plain = object_like(w, 0);
    tc_draw_stats stats;
    tc_error error;
    assert_non_null(rgb);
    gl->BindFramebuffer(GL_FRAMEBUFFER, place->framebuffer);
    gl->ClearColor(1, 0, 0, 1);
    gl->ClearDepth(1);
    do {
        gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        if (tc_eye_draw_through(eye, place, &camera, true, &stats, &error) != TC_OK)
            fail_msg("%s", error.text);
    } while (!stats.resident);
    assert_true(stats.triangles > 0);
    gl->BlitNamedFramebuffer(place->framebuffer, plain, 0, 0, WHOLE_WIDTH, WHOLE_HEIGHT, 0, 0, WHOLE_WIDTH,
                             WHOLE_HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl->BindFramebuffer(GL_FRAMEBUFFER, plain);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl->ReadPixels(0, 0, WHOLE_WIDTH, WHOLE_HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, rgb);
    return rgb;
}

static void drawn_like_an_object(int samples)
{
    window w;
    if (!window_open(samples, &w)) {
        print_message("skipped: no EGL window of %d samples a pixel here\n", samples);
        skip();
    }
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 300, 200, 30, 1);
    tc_map *map;
    tc_drawer *drawer;
    tc_eye *eye;
    tc_error error;
    assert_int_equal(tc_map_build(&grid, 0, 1, &map, &error), TC_OK);
    if (tc_drawer_create(map, &(tc_draw_options){.n = 63}, get_proc, &drawer, &error) != TC_OK ||
        tc_eye_create(drawer, &eye, &error) != TC_OK)
        fail_msg("%s", error.text);
    tc_target_place place = {.x = X,
                             .y = Y,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .samples = samples,
                             .depth = TC_DEPTH_CONVENTIONAL,
                             .encoding = TC_ENCODING_SHOWN,
                             .keep_state = true};
    uint8_t *in_window = drawn(&w, eye, &place);
    place.framebuffer = object_like(&w, samples);
    uint8_t *in_object = drawn(&w, eye, &place);
    /* Rows may lie the other way round in a window: rounding, dithering and edges of triangles differ. */
    int red = 0, other = 0;
    for (int i = 0; i < WHOLE_WIDTH * WHOLE_HEIGHT; i++) {
        red += in_window[3 * i] == 255 && in_window[3 * i + 1] == 0;
        for (int k = 0; k < 3; k++)
            other += abs(in_window[3 * i + k] - in_object[3 * i + k]) > 4;
    }
    assert_int_equal(red, WHOLE_WIDTH * WHOLE_HEIGHT - WIDTH * HEIGHT);
    printf("%d samples: %d of %d values differ\n", samples, other, 3 * WIDTH * HEIGHT);
    assert_true(other <= 3 * WIDTH * HEIGHT / 100);
    /* What the window is not. */
    place.framebuffer = 0;
    place.samples = samples ? 0 : SAMPLES;
    const tc_camera camera = {.fov = 1, .width = WIDTH, .height = HEIGHT};
    tc_status status = tc_eye_draw_through(eye, &place, &camera, false, NULL, &error);
    assert_refused(status, TC_ERR_USAGE, &error, "samples a pixel");
    place.samples = samples, place.encoding = TC_ENCODING_LINEAR;
    status = tc_eye_draw_through(eye, &place, &camera, false, NULL, &error);
    assert_refused(status, TC_ERR_USAGE, &error, "float");
    assert_int_equal(w.gl.GetError(), GL_NO_ERROR);
    free(in_window), free(in_object);
    tc_eye_destroy(eye);
    tc_drawer_destroy(drawer);
    tc_map_destroy(map);
    window_close(&w);
}

static void one_sample(void **state)
{
    (void)state;
    drawn_like_an_object(0);
}

static void several_samples(void **state)
{
    (void)state;
    drawn_like_an_object(SAMPLES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_sample), cmocka_unit_test(several_samples)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
