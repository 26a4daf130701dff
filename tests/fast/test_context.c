/* test_context.c - offscreen contexts: OpenGL 4.5 core comes up, draws into a framebuffer and reads back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/gl/context.h"
#include "common/gl/program.h"

#include <stdio.h>
#include <string.h>

/* Creates the context or, where the backend is not to be had on this machine, skips the test and says why. */
static tc_context *create_or_skip(tc_backend backend)
{
    tc_context *context = NULL;
    tc_error error;
    if (tc_context_create(backend, &context, &error) != TC_OK) {
        print_message("skipped: %s\n", error.text);
        assert_int_equal(error.status, TC_ERR_CONTEXT);
        assert_null(context);
        skip();
    }
    return context;
}

/* Clears a framebuffer to a colour and a depth, and reads both back. */
static void check_clear(const tc_gl *gl)
{
    enum { W = 37, H = 5 };
    GLuint framebuffer, textures[2];
    gl->CreateFramebuffers(1, &framebuffer);
    gl->CreateTextures(GL_TEXTURE_2D, 2, textures);
    gl->TextureStorage2D(textures[0], 1, GL_RGBA8, W, H);
    gl->TextureStorage2D(textures[1], 1, GL_DEPTH_COMPONENT32F, W, H);
    gl->NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, textures[0], 0);
    gl->NamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, textures[1], 0);
    assert_int_equal(gl->CheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl->ClearColor(1, 0, 51 / 255.0f, 1);
    gl->ClearDepth(0.25);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    uint8_t pixels[H][W][4];
    float depth[H][W];
    gl->ReadPixels(0, 0, W, H, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    gl->ReadPixels(0, 0, W, H, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            static const uint8_t expected[4] = {255, 0, 51, 255};
            assert_memory_equal(pixels[y][x], expected, 4);
            assert_true(depth[y][x] == 0.25f);
        }
    gl->DeleteFramebuffers(1, &framebuffer);
    gl->DeleteTextures(2, textures);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

static void check_backend(tc_backend backend, const char *name_starts)
{
    /* Twice: the second context must not suffer from the first one's end. */
    for (int round = 0; round < 2; round++) {
        tc_context *context = create_or_skip(backend);
        const tc_gl *gl = tc_context_gl(context);
        GLint major = 0, minor = 0, profile = 0;
        gl->GetIntegerv(GL_MAJOR_VERSION, &major);
        gl->GetIntegerv(GL_MINOR_VERSION, &minor);
        gl->GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
        assert_true(major > 4 || (major == 4 && minor >= 5));
        assert_true(profile & GL_CONTEXT_CORE_PROFILE_BIT);
        assert_int_equal(strncmp(tc_context_backend(context), name_starts, strlen(name_starts)), 0);
        check_clear(gl);
        tc_context_destroy(context);
    }
}

static void egl_gives_4_5_and_reads_back(void **state)
{
    (void)state;
    check_backend(TC_BACKEND_EGL, "egl-");
}

static void osmesa_gives_4_5_and_reads_back(void **state)
{
    (void)state;
    check_backend(TC_BACKEND_OSMESA, "osmesa");
}

static void auto_takes_the_first_that_works(void **state)
{
    (void)state;
    check_backend(TC_BACKEND_AUTO, "");
}

static void window_is_not_offscreen(void **state)
{
    (void)state;
    tc_context *context = NULL;
    tc_error error;
    assert_int_equal(tc_context_create(TC_BACKEND_WINDOW, &context, &error), TC_ERR_USAGE);
    assert_null(context);
    tc_context_destroy(NULL);
}

/* Stand-ins for drivers that are too old or broken. */
static const char *fake_version;
static const GLubyte *fake_get_string(GLenum name)
{
    return (const GLubyte *)(name == GL_VERSION ? fake_version : "Old Renderer");
}
static void fake_get_integer(GLenum name, GLint *value)
{
    int major = 0, minor = 0;
    if (fake_version && sscanf(fake_version, "%d.%d", &major, &minor) == 2)
        *value = name == GL_MAJOR_VERSION ? major : minor;
}
static GLenum fake_get_error(void)
{
    return GL_NO_ERROR;
}

static void *fake_get_proc(const char *name)
{
    static const struct {
        const char *name;
        void (*function)(void);
    } fakes[] = {{"glGetString", (void (*)(void))fake_get_string},
                 {"glGetIntegerv", (void (*)(void))fake_get_integer},
                 {"glGetError", (void (*)(void))fake_get_error}};
    void *pointer = NULL;
    for (size_t i = 0; i < sizeof fakes / sizeof *fakes; i++)
        if (strcmp(fakes[i].name, name) == 0)
            memcpy(&pointer, &fakes[i].function, sizeof pointer);
    return pointer;
}

/* Stand-ins for drivers that tell how much memory is free, or do not. */
static const char *fake_extension;
static void fake_memory(GLenum name, GLint *values)
{
    if (name == GL_NUM_EXTENSIONS)
        *values = 2;
    else if (name == 0x9049)
        *values = 3 << 20; /* 3 GiB */
    else if (name == 0x87FC)
        values[0] = 2 << 20, values[1] = 1, values[2] = 4 << 20, values[3] = 1;
}
static const GLubyte *fake_extension_of(GLenum name, GLuint i)
{
    return (const GLubyte *)(name == GL_EXTENSIONS && i == 1 ? fake_extension : "GL_ARB_debug_output");
}

static void free_memory_is_what_the_driver_tells(void **state)
{
    (void)state;
    const tc_gl gl = {.GetIntegerv = fake_memory, .GetStringi = fake_extension_of};
    fake_extension = "GL_NVX_gpu_memory_info";
    assert_true(tc_gl_free_memory(&gl) == INT64_C(3) << 30);
    fake_extension = "GL_ATI_meminfo";
    assert_true(tc_gl_free_memory(&gl) == INT64_C(2) << 30);
    fake_extension = "GL_ATI_meminfo_of_another_kind";
    assert_true(tc_gl_free_memory(&gl) == 0);
}

static void *no_get_proc(const char *name)
{
    (void)name;
    return NULL;
}

static void load_says_what_it_found(void **state)
{
    (void)state;
    tc_gl gl;
    tc_error error;
    assert_int_equal(tc_gl_load(&gl, no_get_proc, &error), TC_ERR_CONTEXT);
    fake_version = NULL;
    assert_int_equal(tc_gl_load(&gl, fake_get_proc, &error), TC_ERR_CONTEXT);
    fake_version = "3.1 Mesa";
    assert_int_equal(tc_gl_load(&gl, fake_get_proc, &error), TC_ERR_CONTEXT);
    assert_string_equal(error.text, "OpenGL: expected 4.5 or newer, found 3.1 Mesa on Old Renderer");
    fake_version = "OpenGL ES 3.2 Mesa";
    assert_int_equal(tc_gl_load(&gl, fake_get_proc, &error), TC_ERR_CONTEXT);
    fake_version = "4.5 broken";
    assert_int_equal(tc_gl_load(&gl, fake_get_proc, &error), TC_ERR_CONTEXT);
    assert_non_null(strstr(error.text, "expected the function gl"));
}

static void program_names_a_missing_file(void **state)
{
    (void)state;
    tc_gl gl;
    memset(&gl, 0, sizeof gl);
    tc_error error;
    GLuint program = 77;
    assert_null(tc_shader_text(NULL, "no-such-file.glsl"));
    assert_int_equal(
        tc_program_build(&gl, (const char *const[]){"no-such-file.glsl", NULL}, NULL, NULL, "", &program, &error),
        TC_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "no-such-file.glsl: "));
    assert_int_equal(program, 77);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(egl_gives_4_5_and_reads_back),         cmocka_unit_test(osmesa_gives_4_5_and_reads_back),
        cmocka_unit_test(auto_takes_the_first_that_works),      cmocka_unit_test(window_is_not_offscreen),
        cmocka_unit_test(free_memory_is_what_the_driver_tells), cmocka_unit_test(load_says_what_it_found),
        cmocka_unit_test(program_names_a_missing_file),
    };
    return cmocka_run_group_tests_name("context", tests, NULL, NULL);
}
