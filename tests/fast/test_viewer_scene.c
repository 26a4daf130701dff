/* test_viewer_scene.c - how large a viewer's windows are: as the frame calls for, while it runs, and no larger than the
 * GPU has room for. */
#include "tests/support/test.h"

#include "common/app/viewer_internal.h"
#include "common/gl/context.h"
#include "planar/square.h"
#include "tests/support/gl_refuse.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

static tc_context *context;
static tc_gl gl;
static GLint free_kibibytes; /* 0: not told */

static void told(GLenum name, GLint *values)
{
    enum { CURRENT_AVAILABLE_VIDMEM_NVX = 0x9049 };
    if (name == CURRENT_AVAILABLE_VIDMEM_NVX)
        *values = free_kibibytes;
    else
        tc_context_gl(context)->GetIntegerv(name, values);
}

static const GLubyte *extension(GLenum name, GLuint i)
{
    return i == 0 && free_kibibytes ? (const GLubyte *)"GL_NVX_gpu_memory_info"
                                    : tc_context_gl(context)->GetStringi(name, i);
}

static tc_viewer viewer(void)
{
    static const tc_scheme *const lists[] = {tc_square_schemes, NULL};
    static const tc_viewer_program program = {
        .name = "test", .body = &tc_plane_body, .schemes = lists};
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 3000, 2000, 30, 1);
    tc_viewer v = {.program = &program, .gl = &gl, .options.output = "picture.png", .scene.budget = -1};
    tc_error error;
    if (tc_map_build(&grid, 0, 2, &v.map, &error) != TC_OK)
        fail_msg("%s", error.text);
    v.camera = (tc_camera){.x = 40e3, .y = 30e3, .z = 900, .pitch = -0.4, .fov = 1.2, .width = 320, .height = 200};
    return v;
}

static void leave(tc_viewer *v)
{
    tc_renderer_destroy(v->renderer);
    if (v->surface)
        v->surface->destroy(v->surface);
    tc_map_destroy(v->map);
}

static int n_of(tc_viewer *v, int width)
{
    tc_frame_stats stats;
    tc_error error;
    v->camera.width = width;
    if (tc_viewer_frame(v, false, &stats, &error) != TC_OK)
        fail_msg("%s", error.text);
    return v->surface->n;
}

static void windows_follow_the_frame(void **state)
{
    (void)state;
    tc_viewer v = viewer();
    free_kibibytes = 0;
    int small = n_of(&v, 320), large = n_of(&v, 1600);
    assert_true(large > small);
    assert_int_equal(n_of(&v, 1600), large);
    assert_int_equal(n_of(&v, 320), small);
    leave(&v);
}

/* Textures of all windows fit into three quarters of what is free, and are no smaller than that needs. */
static void windows_fit_the_gpu(void **state)
{
    (void)state;
    tc_viewer v = viewer();
    free_kibibytes = 0;
    const int called_for = n_of(&v, 1600);
    tc_memory_stats whole, fitting;
    leave(&v);
    v = viewer();
    free_kibibytes = 4 << 20;
    assert_int_equal(n_of(&v, 1600), called_for);
    leave(&v);
    free_kibibytes = 0;
    v = viewer();
    v.camera.width = 1600;
    assert_int_equal(tc_viewer_make_surface(&v, NULL), TC_OK);
    tc_renderer_memory(v.renderer, &whole);
    free_kibibytes = (GLint)((whole.heights + whole.normals) / 2048);
    assert_int_equal(tc_viewer_make_surface(&v, NULL), TC_OK);
    tc_renderer_memory(v.renderer, &fitting);
    assert_true(v.surface->n < called_for && v.surface->n >= called_for / 4);
    assert_true(fitting.heights + fitting.normals <= (size_t)free_kibibytes * 1024 / 4 * 3);
    leave(&v);
}

/* A driver that refuses what is asked of it gets less, down to a least size; then it is said. */
static void less_is_asked_for_where_a_driver_refuses(void **state)
{
    (void)state;
    free_kibibytes = 0;
    tc_viewer v = viewer();
    const int called_for = n_of(&v, 1600);
    leave(&v);
    int smaller = 0, asked = 1;
    for (int k = 1; k <= asked; k++) {
        gl_refuse refuse = {.refuse = k};
        tc_gl refusing = gl_refuse_begin(&gl, &refuse);
        tc_frame_stats stats;
        tc_error error = {.text = ""};
        v = viewer();
        v.gl = &refusing, v.camera.width = 1600;
        tc_status status = tc_viewer_frame(&v, false, &stats, &error);
        if (status != TC_OK)
            fail_msg("%s", error.text);
        smaller += v.surface->n < called_for;
        asked = refuse.asked < 64 && k == 1 ? refuse.asked : asked;
        leave(&v);
        assert_int_equal(refuse.alive, 0);
    }
    assert_true(smaller > 0);
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 1;
    gl = *tc_context_gl(context);
    gl.GetIntegerv = told, gl.GetStringi = extension;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows_follow_the_frame),
        cmocka_unit_test(windows_fit_the_gpu),
        cmocka_unit_test(less_is_asked_for_where_a_driver_refuses),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
