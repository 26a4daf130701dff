/* test_draw.c - the public header of libterraclip-draw: a host draws maps in its frame, several views of one, and gets
 * a clear line where anything is refused.
 *
 * The Makefile links this test with --wrap for the functions that allocate. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/terraclip_draw.h"
#include "tests/support/gl_refuse.h"
#include "tests/support/planet_scene.h"
#include "tests/support/refused.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"
#include "tests/wrapped/allocations.h"

enum { WIDTH = 120, HEIGHT = 90 };

static tc_context *context;
static tc_gl table; /* what maps are drawn by */

/* ---- A host ------------------------------------------------------------------------------------------------------ */

/* As a context's own function that finds functions. */
static void *get_proc(const char *name)
{
    void *p = NULL;
#define FIND(type, function)                                                                                           \
    if (strcmp(name, "gl" #function) == 0)                                                                             \
        memcpy(&p, &table.function, sizeof p);
    TC_GL_FUNCTIONS(FIND)
#undef FIND
    return p;
}

static GLuint framebuffer, colour, depth;

static void make_framebuffer(void)
{
    const tc_gl *gl = tc_context_gl(context);
    gl->CreateFramebuffers(1, &framebuffer);
    gl->CreateTextures(GL_TEXTURE_2D, 1, &colour);
    gl->CreateTextures(GL_TEXTURE_2D, 1, &depth);
    gl->TextureStorage2D(colour, 1, GL_RGBA8, 2 * WIDTH, HEIGHT);
    gl->TextureStorage2D(depth, 1, GL_DEPTH_COMPONENT32F, 2 * WIDTH, HEIGHT);
    gl->NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, colour, 0);
    gl->NamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
}

static tc_target_place half(int right)
{
    return (tc_target_place){.framebuffer = framebuffer,
                             .x = right ? WIDTH : 0,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .clear = true,
                             .keep_state = true};
}

/* Pixels of the framebuffer; the caller's to free. */
static uint8_t *pixels(void)
{
    uint8_t *rgb = malloc(3 * 2 * WIDTH * HEIGHT);
    assert_non_null(rgb);
    tc_context_gl(context)->GetTextureImage(colour, 0, GL_RGB, GL_UNSIGNED_BYTE, 3 * 2 * WIDTH * HEIGHT, rgb);
    return rgb;
}

static tc_map *flat_map(void)
{
    tc_grid grid = terrain_grid(TERRAIN_SMOOTH, 300, 200, 30, 1);
    tc_map *map;
    tc_error error;
    if (tc_map_build(&grid, 0, 1, &map, &error) != TC_OK)
        fail_msg("%s", error.text);
    return map;
}

static tc_camera flat_view(void)
{
    return (tc_camera){
        .x = 3000, .y = 2000, .z = 900, .heading = 0.7, .pitch = -0.25, .fov = 1.2, .width = WIDTH, .height = HEIGHT};
}

static tc_camera planet_view_here(void)
{
    return (tc_camera){
        .x = 0.4, .y = 0.5, .z = 4e5, .heading = 0.3, .pitch = -0.5, .fov = 1.1, .width = WIDTH, .height = HEIGHT};
}

static void draw_all(tc_eye *eye, const tc_target_place *place, const tc_camera *camera, tc_draw_stats *stats)
{
    tc_error error = {.text = ""};
    do
        if (tc_eye_draw_through(eye, place, camera, true, stats, &error) != TC_OK)
            fail_msg("%s", error.text);
    while (!stats->resident);
}

/* ---- Drawing ----------------------------------------------------------------------------------------------------- */

static void a_map_is_drawn_in_a_frame(void **state)
{
    (void)state;
    for (int sphere = 0; sphere < 2; sphere++) {
        tc_map *map = sphere ? planet_made(PLANET_SMOOTH, 512, 6371000, 1) : flat_map();
        tc_camera camera[2] = {sphere ? planet_view_here() : flat_view(), sphere ? planet_view_here() : flat_view()};
        camera[1].heading += 2;
        const tc_draw_options options = {.width = 256, .budget = -1};
        tc_drawer *drawer;
        tc_eye *eye[2];
        tc_draw_stats stats;
        tc_error error = {.text = ""};
        if (tc_drawer_create(map, &options, get_proc, &drawer, &error) != TC_OK)
            fail_msg("%s", error.text);
        uint8_t *apart[2], *both;
        for (int k = 0; k < 2; k++) {
            assert_int_equal(tc_eye_create(drawer, &eye[k], &error), TC_OK);
            const tc_target_place place = half(k);
            draw_all(eye[k], &place, &camera[k], &stats);
            assert_true(stats.triangles > 0 && stats.draws > 0 && stats.levels > 0 && !stats.failed);
            apart[k] = pixels();
        }
        /* What was first may go first: all that is needed is kept. */
        tc_map_destroy(map);
        tc_drawer_destroy(drawer);
        for (int k = 0; k < 2; k++) {
            const tc_target_place place = half(k);
            draw_all(eye[k], &place, &camera[k], &stats);
        }
        both = pixels();
        int different = 0;
        for (int j = 0; j < HEIGHT; j++)
            for (int i = 0; i < 2 * WIDTH; i++) {
                int at = 3 * (j * 2 * WIDTH + i);
                assert_memory_equal(both + at, apart[i >= WIDTH] + at, 3);
                different += i < WIDTH && memcmp(both + at, both + at + 3 * WIDTH, 3) != 0;
            }
        assert_true(different > WIDTH * HEIGHT / 4); /* the two see something else */
        tc_eye_destroy(eye[0]);
        tc_eye_destroy(eye[1]);
        free(apart[0]), free(apart[1]), free(both);
    }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    tc_map *map = flat_map();
    tc_drawer *drawer;
    tc_eye *eye;
    tc_error error = {.text = ""};
    assert_refused(tc_drawer_create(NULL, NULL, get_proc, &drawer, &error), TC_ERR_USAGE, &error, "map");
    assert_refused(tc_drawer_create(map, NULL, NULL, &drawer, &error), TC_ERR_USAGE, &error, "OpenGL");
    assert_refused(tc_drawer_create(map, &(tc_draw_options){.scheme = "rings"}, get_proc, &drawer, &error),
                   TC_ERR_UNSUPPORTED, &error, "rings");
    assert_refused(tc_drawer_create(map, &(tc_draw_options){.n = 100}, get_proc, &drawer, &error), TC_ERR_USAGE, &error,
                   "100");
    assert_int_equal(tc_drawer_create(map, &(tc_draw_options){.n = 63}, get_proc, &drawer, &error), TC_OK);
    assert_int_equal(tc_eye_create(drawer, &eye, &error), TC_OK);
    tc_target_place place = half(0);
    tc_camera camera = flat_view();
    camera.fov = NAN;
    assert_refused(tc_eye_draw_through(eye, &place, &camera, true, NULL, &error), TC_ERR_USAGE, &error, "finite");
    camera.fov = 4;
    assert_refused(tc_eye_draw_through(eye, &place, &camera, true, NULL, &error), TC_ERR_USAGE, &error, "angle");
    const double zero[16] = {0};
    assert_refused(tc_eye_draw(eye, &place, zero, zero, true, NULL, &error), TC_ERR_USAGE, &error, "rotation");
    camera = flat_view();
    place.depth = (tc_depth)-1;
    assert_refused(tc_eye_draw_through(eye, &place, &camera, true, NULL, &error), TC_ERR_USAGE, &error, "depth");
    tc_eye_destroy(eye);
    tc_drawer_destroy(drawer);
    tc_map_destroy(map);
}

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

/* From nothing to a frame and back; TC_OK, or what was refused. */
static tc_status whole_life(tc_map *map, const tc_camera *camera, tc_error *error)
{
    const tc_draw_options options = {.width = 64, .budget = -1};
    tc_drawer *drawer = NULL;
    tc_eye *eye = NULL;
    const tc_target_place place = half(0);
    tc_status status = tc_drawer_create(map, &options, get_proc, &drawer, error);
    if (status == TC_OK)
        status = tc_eye_create(drawer, &eye, error);
    if (status == TC_OK)
        status = tc_eye_draw_through(eye, &place, camera, true, NULL, error);
    tc_eye_destroy(eye);
    tc_drawer_destroy(drawer);
    return status;
}

static void each_refusal_is_a_line_and_leaves_nothing(void **state)
{
    (void)state;
    for (int sphere = 0; sphere < 2; sphere++) {
        tc_map *map = sphere ? planet_made(PLANET_SMOOTH, 512, 6371000, 1) : flat_map();
        const tc_camera camera = sphere ? planet_view_here() : flat_view();
        gl_refuse driver = {0};
        tc_error error = {.text = ""};
        table = gl_refuse_begin(tc_context_gl(context), &driver);
        int most[2] = {0, 0};
        for (int kind = 0; kind < 2; kind++)
            for (int k = 0; k <= most[kind]; k++) { /* 0: nothing is refused, but counted */
                driver = (gl_refuse){.refuse = kind ? k : 0};
                table = gl_refuse_begin(tc_context_gl(context), &driver);
                long long before = allocations.live;
                allocations_refuse(kind ? 0 : k);
                tc_status status = whole_life(map, &camera, &error);
                long long left = allocations.live - before;
                if (k == 0)
                    most[kind] = kind ? driver.asked : (int)allocations.asked;
                allocations_refuse(0);
                if (status != (k ? TC_ERR_MEMORY : TC_OK) || left != 0 || driver.alive != 0)
                    fail_msg("%s %d of %d refused: %d \"%s\", %lld bytes and %d objects are left",
                             kind ? "the driver's" : "allocation", k, most[kind], status, error.text, left,
                             driver.alive);
            }
        assert_true(most[0] > 5 && most[1] > 5);
        table = *tc_context_gl(context);
        tc_map_destroy(map);
    }
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 0;
    table = *tc_context_gl(context);
    make_framebuffer();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_is_drawn_in_a_frame),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(each_refusal_is_a_line_and_leaves_nothing),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_context_destroy(context);
    return failed;
}
