/* test_level_textures.c - windows in textures: of heights and of a content that only this test knows, read back and
 * compared; by readers that come late, within a budget; and where the driver has no room. */
#include "tests/support/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/render/level_textures.h"
#include "tests/support/gl_refuse.h"
#include "tests/support/scene.h"
#include "tests/support/stripes.h"
#include "tests/support/terrains.h"

enum { N = 31, SIDE = 2 * (N + 1), CHARTS = 2 };

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

/* ---- Two charts of heights and stripes --------------------------------------------------------------------------- */

static const int64_t size[CHARTS][2] = {{900, 700}, {300, 1025}};
static const tc_content striped = {.class = &stripes, .parameter = 5};

typedef struct charts {
    tc_field *field[CHARTS];
    tc_clipmap *clipmap[CHARTS];
    int levels[TC_MAX_CHARTS]; /* that are wanted */
    int64_t at[CHARTS][2];     /* the finest samples around which they are */
    test_random random;
} charts;

static charts make_charts(uint64_t seed)
{
    charts c = {.random = {seed}};
    const tc_clipmap_options options = {.n = N, .contents = 2, .content = {{.class = &tc_heights_content}, striped}};
    for (int k = 0; k < CHARTS; k++) {
        c.field[k] = terrain_field(TERRAIN_SMOOTH, size[k][0], size[k][1], 10, seed);
        assert_int_equal(tc_clipmap_create(c.field[k], &options, &c.clipmap[k], NULL), TC_OK);
        c.levels[k] = 1;
        c.at[k][0] = size[k][0] / 2, c.at[k][1] = size[k][1] / 2;
    }
    return c;
}

static void free_charts(charts *c)
{
    for (int k = 0; k < CHARTS; k++) {
        tc_clipmap_destroy(c->clipmap[k]);
        tc_field_destroy(c->field[k]);
    }
}

/* Moves the windows of the wanted levels at most so far; returns the samples filled. */
static int64_t move(charts *c, int64_t far, int64_t budget)
{
    int64_t samples = 0;
    for (int k = 0; k < CHARTS; k++) {
        tc_rect wanted[TC_MAX_LEVELS];
        for (int i = 0; i < 2; i++)
            c->at[k][i] = tc_clamp64(c->at[k][i] + test_random_int(&c->random, -far, far), 0, size[k][i] - 1);
        stripes_want(c->clipmap[k], c->at[k][0], c->at[k][1], wanted);
        for (int l = c->levels[k] + 1; l <= tc_clipmap_levels(c->clipmap[k]); l++)
            wanted[l - 1] = (tc_rect){0, 0, 0, 0};
        samples += tc_clipmap_update(c->clipmap[k], wanted, budget, true, 0);
    }
    return samples;
}

static void want_all(charts *c)
{
    for (int k = 0; k < CHARTS; k++)
        c->levels[k] = tc_clipmap_levels(c->clipmap[k]);
}

/* The textures have all that the levels hold which they say are ready. */
static void assert_right(const tc_gl *gl, const tc_level_textures *t, const charts *c)
{
    static float heights[N + 1][N + 1][2];
    static uint8_t bytes[SIDE][SIDE];
    for (int k = 0; k < CHARTS; k++)
        for (int l = 1; l <= t->layers.ready[k]; l++) {
            int layer = tc_first_layer(&t->layers, k) + l - 1;
            tc_rect r = tc_clipmap_level(c->clipmap[k], l)->clip;
            if (tc_rect_empty(r))
                continue;
            gl->GetTextureSubImage(tc_level_texture_of(t, &tc_heights_content).texture, 0, 0, 0, layer, N + 1, N + 1, 1,
                                   GL_RG, GL_FLOAT, sizeof heights, heights);
            gl->GetTextureSubImage(tc_level_texture_of(t, &stripes).texture, 0, 0, 0, layer, SIDE, SIDE, 1, GL_RED,
                                   GL_UNSIGNED_BYTE, sizeof bytes, bytes);
            for (int64_t j = r.y0; j < r.y1; j++)
                for (int64_t i = r.x0; i < r.x1; i++)
                    assert_memory_equal(heights[j & N][i & N],
                                        tc_ground_heights(c->clipmap[k], l)[(j & N) * (N + 1) + (i & N)],
                                        sizeof heights[0][0]);
            tc_rect texels = tc_content_rect(&stripes, r);
            for (int64_t y = texels.y0; y < texels.y1; y++)
                for (int64_t x = texels.x0; x < texels.x1; x++)
                    assert_int_equal(bytes[y & (SIDE - 1)][x & (SIDE - 1)], stripe(&striped, l, x, y));
        }
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

/* Bytes that uploading all that changed since a cursor takes. */
static int64_t due(const charts *c, uint64_t cursor[CHARTS][TC_MAX_LEVELS])
{
    int64_t bytes = 0;
    tc_rect changes[TC_MAX_CHANGES];
    for (int k = 0; k < CHARTS; k++)
        for (int l = 1; l <= tc_clipmap_levels(c->clipmap[k]); l++) {
            int count = tc_clipmap_changes(c->clipmap[k], l, &cursor[k][l - 1], changes);
            for (int i = 0; i < count; i++) {
                tc_rect texels = tc_content_rect(&stripes, changes[i]);
                bytes += 8 * tc_rect_area(changes[i]) +
                         tc_min64(texels.x1 - texels.x0, SIDE) * tc_min64(texels.y1 - texels.y0, SIDE);
            }
        }
    return bytes;
}

/* ---- What is tested ---------------------------------------------------------------------------------------------- */

/* Also where a chart comes into sight or levels get finer, so that the textures grow: no byte is uploaded twice. */
static void a_content_of_our_own_is_uploaded(void **state)
{
    (void)state;
    const tc_gl *gl = tc_context_gl(context);
    charts c = make_charts(3);
    tc_level_textures t = {0};
    uint64_t cursor[CHARTS][TC_MAX_LEVELS] = {{0}};
    int64_t bytes_all = 0, expected_all = 0;
    int grown = 0;
    for (int step = 0; step < 400; step++) {
        if (step == 50) /* into sight, or finer */
            c.levels[0] = 2;
        if (step == 100)
            want_all(&c);
        move(&c, step % 10 ? 6 : 1000, test_random_int(&c.random, N, N * N));
        const int levels[TC_MAX_CHARTS] = {c.levels[0], step < 30 ? 0 : c.levels[1]};
        int depth = t.depth;
        assert_int_equal(tc_level_textures_hold(gl, &t, c.clipmap, CHARTS, levels, NULL), TC_OK);
        grown += t.depth > depth;
        int64_t bytes = tc_level_textures_upload(gl, &t, c.clipmap, CHARTS, -1, 0), expected = due(&c, cursor);
        if (step != 30) /* when the second chart came into sight: all that its coarsest level held since long */
            assert_true(bytes <= expected);
        bytes_all += bytes, expected_all += expected;
        for (int k = 0; k < CHARTS; k++)
            assert_int_equal(t.layers.ready[k], t.layers.held[k]);
        assert_right(gl, &t, &c);
    }
    assert_true(grown >= 3 && bytes_all > expected_all / 2);
    tc_level_textures_destroy(gl, &t);
    free_charts(&c);
}

/* A reader that comes when all is there gets it piece by piece, while the windows move on. */
static void late_readers_keep_to_their_budget(void **state)
{
    (void)state;
    const tc_gl *gl = tc_context_gl(context);
    charts c = make_charts(4);
    want_all(&c);
    move(&c, 100, -1);
    tc_level_textures t = {0};
    int frames = 0, all = c.levels[0] + c.levels[1];
    assert_int_equal(tc_level_textures_hold(gl, &t, c.clipmap, CHARTS, c.levels, NULL), TC_OK);
    for (;; frames++) {
        int64_t filled = frames > 0 ? move(&c, 2, N) : 0, budget = filled + N;
        int64_t most = 8 * (budget + N * N) + 4 * (budget + N * N) + CHARTS * SIDE * SIDE * 3 + 64 * SIDE;
        assert_true(tc_level_textures_upload(gl, &t, c.clipmap, CHARTS, budget, 0) <= most);
        assert_right(gl, &t, &c);
        assert_true(t.layers.ready[0] >= 1 && t.layers.ready[1] >= 1);
        if (t.layers.ready[0] + t.layers.ready[1] == all)
            break;
        assert_true(frames < 20 * all);
    }
    printf("late reader: %d levels in %d frames\n", all, frames);
    assert_true(frames > all / 4);
    tc_level_textures_destroy(gl, &t);
    free_charts(&c);
}

/* Time is always over: a piece a call, and in the end all that there is. */
static void no_time_is_a_piece_a_call(void **state)
{
    (void)state;
    enum { WIDE = 255, PIECE = 1 << 13 };
    const tc_gl *gl = tc_context_gl(context);
    tc_field *field = terrain_field(TERRAIN_SMOOTH, 2049, 2049, 10, 7);
    const tc_clipmap_options options = {.n = WIDE, .contents = 1, .content = {{.class = &tc_heights_content}}};
    tc_clipmap *c;
    tc_rect wanted[TC_MAX_LEVELS];
    assert_int_equal(tc_clipmap_create(field, &options, &c, NULL), TC_OK);
    stripes_want(c, 900, 1000, wanted);
    tc_clipmap_update(c, wanted, -1, true, 0);
    tc_level_textures t = {0};
    int levels[TC_MAX_CHARTS] = {tc_clipmap_levels(c)}, calls = 0;
    assert_int_equal(tc_level_textures_hold(gl, &t, &c, 1, levels, NULL), TC_OK);
    for (; t.layers.ready[0] < levels[0]; calls++) {
        const int64_t coarsest = calls ? 0 : tc_rect_area(tc_clipmap_level(c, 1)->clip);
        const int64_t samples = tc_level_textures_upload(gl, &t, &c, 1, -1, 1e-3) / 8 - coarsest;
        assert_true(samples > 0 && samples <= PIECE);
        assert_true(calls < 1000);
        if (calls % 5 == 4 && t.layers.ready[0] < levels[0]) { /* meanwhile the windows move on */
            stripes_want(c, 900 + calls, 1000 - calls, wanted);
            tc_clipmap_update(c, wanted, -1, true, 0);
        }
    }
    assert_true(calls > (levels[0] - 1) * WIDE * WIDE / PIECE);
    static float heights[WIDE + 1][WIDE + 1][2];
    for (int l = 1; l <= levels[0]; l++) {
        tc_rect r = tc_clipmap_level(c, l)->clip;
        gl->GetTextureSubImage(tc_level_texture_of(&t, &tc_heights_content).texture, 0, 0, 0, l - 1, WIDE + 1, WIDE + 1,
                               1, GL_RG, GL_FLOAT, sizeof heights, heights);
        for (int64_t j = r.y0; j < r.y1; j++)
            for (int64_t i = r.x0; i < r.x1; i++)
                assert_memory_equal(heights[j & WIDE][i & WIDE],
                                    tc_ground_heights(c, l)[(j & WIDE) * (WIDE + 1) + (i & WIDE)],
                                    sizeof heights[0][0]);
    }
    printf("a piece a call: %d levels in %d calls\n", levels[0], calls);
    tc_level_textures_destroy(gl, &t);
    tc_clipmap_destroy(c);
    tc_field_destroy(field);
}

/* Uploads through a ring, with a driver that never comes to an end with an earlier frame, and with one that maps no
 * buffer. Returns the times that the ring had no room. */
static int upload_through_a_ring(const tc_gl *gl, bool mapped)
{
    charts c = make_charts(6);
    tc_upload_ring ring;
    tc_level_textures t = {.ring = &ring};
    int full = 0;
    assert_int_equal(tc_upload_ring_create(gl, &ring, NULL), TC_OK);
    assert_true(mapped == (tc_upload_ring_bytes(&ring) > 0));
    want_all(&c);
    assert_int_equal(tc_level_textures_hold(gl, &t, c.clipmap, CHARTS, c.levels, NULL), TC_OK);
    for (int step = 0; step < 200; step++) {
        size_t unused;
        move(&c, step % 9 ? 3 : 400, -1);
        tc_upload_ring_begin(gl, &ring);
        if (step % 7 == 3) /* most of a part is used up */
            tc_upload_ring_take(&ring, TC_UPLOAD_PART_BYTES - 5000, &unused);
        tc_level_textures_upload(gl, &t, c.clipmap, CHARTS, -1, 0);
        full += tc_upload_ring_take(&ring, TC_UPLOAD_PART_BYTES / 2, &unused) == NULL;
        tc_upload_ring_end(gl, &ring);
        assert_right(gl, &t, &c);
    }
    tc_level_textures_destroy(gl, &t);
    tc_upload_ring_destroy(gl, &ring);
    free_charts(&c);
    return full;
}

static GLenum APIENTRY never_done(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
    (void)sync, (void)flags;
    assert_int_equal(timeout, 0); /* nothing is waited for */
    return GL_TIMEOUT_EXPIRED;
}

static void what_goes_through_a_ring_is_the_same(void **state)
{
    (void)state;
    tc_gl gl = *tc_context_gl(context);
    assert_in_range(upload_through_a_ring(&gl, true), 1, 100); /* a part that is full */
    gl.ClientWaitSync = never_done;
    assert_in_range(upload_through_a_ring(&gl, true), 200 - TC_UPLOAD_PARTS, 199);
    gl_refuse driver = {.maps_nothing = true};
    gl = gl_refuse_begin(tc_context_gl(context), &driver);
    assert_int_equal(upload_through_a_ring(&gl, false), 200);
    assert_int_equal(driver.alive, 0);
}

/* And pictures, by any way and a little at a time. */
static void pictures_are_the_same_by_any_way(void **state)
{
    (void)state;
    enum { W = 160, H = 120 };
    static const tc_scene_options ways[] = {
        {.ring = -1}, {.ring = 1}, {.ring = 1, .budget_us = 1}, {.ring = -1, .budget_us = 1, .ahead = -1}};
    tc_field *field = terrain_field(TERRAIN_SMOOTH, 1025, 1025, 30, 5);
    uint8_t *first = NULL, *other;
    for (int way = 0; way < 5; way++) { /* the last one is a driver that maps no buffer */
        scene s = scene_create(context, field, N, &ways[way % 4]);
        gl_refuse driver = {.maps_nothing = true};
        tc_gl gl = gl_refuse_begin(tc_context_gl(context), &driver);
        tc_renderer *r;
        tc_frame_stats stats = {0};
        tc_camera camera = {.x = 15000, .y = 15000, .z = 3000, .pitch = -1.4, .fov = 1, .width = W, .height = H};
        const tc_scene_options with_ring = {.ring = 1};
        assert_int_equal(tc_renderer_create(way < 4 ? tc_context_gl(context) : &gl, s.surface,
                                            way < 4 ? &ways[way] : &with_ring, &r, NULL),
                         TC_OK);
        for (int frame = 0; frame < 10 || !stats.resident; frame++) {
            assert_true(frame < 5000);
            camera.x += frame < 10 ? 100 : 0;
            assert_int_equal(tc_renderer_frame(r, &camera, false, &stats, NULL), TC_OK);
        }
        other = malloc(3 * W * H);
        tc_renderer_read(r, other, NULL);
        if (first)
            assert_memory_equal(first, other, 3 * W * H);
        free(first);
        first = other;
        tc_renderer_destroy(r);
        scene_destroy(&s);
    }
    free(first);
    tc_field_destroy(field);
}

/* The same as it is drawn: no hole, and at last the picture that the first reader has. */
static void what_is_not_there_yet_is_drawn_coarser(void **state)
{
    (void)state;
    enum { W = 160, H = 120 };
    tc_field *field = terrain_field(TERRAIN_SMOOTH, 1025, 1025, 30, 5);
    tc_scene_options options = {.background_set = true, .background = {255, 0, 255}, .budget = N};
    scene s = scene_create(context, field, N, &options);
    tc_camera camera = {.x = 15000, .y = 15000, .z = 3000, .pitch = -1.4, .fov = 1, .width = W, .height = H};
    scene_draw(&s, &camera, true);
    uint8_t *first = scene_pixels(&s, &camera), *late = malloc(3 * W * H);
    tc_renderer *second;
    tc_frame_stats stats = {0};
    assert_int_equal(tc_renderer_create(tc_context_gl(context), s.surface, &options, &second, NULL), TC_OK);
    int frames = 0, different = 0;
    for (; !stats.resident; frames++) {
        assert_true(frames < 20 * N); /* some levels, whose windows fill by N samples a frame */
        assert_int_equal(tc_renderer_frame(second, &camera, false, &stats, NULL), TC_OK);
        assert_true(stats.bytes_uploaded <= 2 * 24 * (N + 3) * (N + 3));
        tc_renderer_read(second, late, NULL);
        different += memcmp(first, late, 3 * W * H) != 0;
        for (int i = 0; i < W * H; i++)
            assert_false(late[3 * i] == 255 && late[3 * i + 1] == 0 && late[3 * i + 2] == 255);
    }
    printf("late view: like the first one after %d frames, %d of them coarser\n", frames, different);
    assert_memory_equal(first, late, 3 * W * H);
    assert_true(different > 0);
    free(first), free(late);
    tc_renderer_destroy(second);
    scene_destroy(&s);
    tc_field_destroy(field);
}

/* ---- A driver without room --------------------------------------------------------------------------------------- */

static const tc_gl *real;
static int refused;    /* allocations that are still to be refused; below 0: the context is lost */
static bool complains; /* an error waits */

static void APIENTRY storage(GLuint texture, GLsizei levels, GLenum format, GLsizei w, GLsizei h, GLsizei depth)
{
    if (refused != 0)
        complains = true, refused -= refused > 0;
    else
        real->TextureStorage3D(texture, levels, format, w, h, depth);
}

static GLenum APIENTRY get_error(void)
{
    if (refused < 0)
        return GL_CONTEXT_LOST;
    bool waits = complains;
    complains = false;
    return waits ? GL_OUT_OF_MEMORY : real->GetError();
}

static void no_room_is_said_and_harmless(void **state)
{
    (void)state;
    real = tc_context_gl(context);
    tc_gl gl = *real;
    gl.TextureStorage3D = storage, gl.GetError = get_error;
    charts c = make_charts(5);
    tc_level_textures t = {0};
    tc_error error;
    const int coarse[TC_MAX_CHARTS] = {2, 1};
    refused = 1;
    assert_int_equal(tc_level_textures_hold(&gl, &t, c.clipmap, CHARTS, coarse, &error), TC_ERR_MEMORY);
    assert_non_null(strstr(error.text, "no memory"));
    assert_int_equal(t.contents, 0);
    c.levels[0] = 2;
    move(&c, 100, -1);
    assert_int_equal(tc_level_textures_hold(&gl, &t, c.clipmap, CHARTS, coarse, &error), TC_OK);
    tc_level_textures_upload(&gl, &t, c.clipmap, CHARTS, -1, 0);
    assert_right(&gl, &t, &c);
    /* A texture of the grown set, or all; or no context any more. What there was stays, whole. */
    want_all(&c);
    for (int k = 1; k < 4; k++) {
        const tc_level_textures before = t;
        refused = k < 3 ? k : -1;
        assert_int_equal(tc_level_textures_hold(&gl, &t, c.clipmap, CHARTS, c.levels, &error),
                         k < 3 ? TC_ERR_MEMORY : TC_ERR_CONTEXT);
        assert_memory_equal(&t, &before, sizeof t);
        refused = 0, complains = false;
        move(&c, 100, -1);
        tc_level_textures_upload(&gl, &t, c.clipmap, CHARTS, -1, 0);
        assert_right(&gl, &t, &c);
    }
    assert_int_equal(tc_level_textures_hold(&gl, &t, c.clipmap, CHARTS, c.levels, &error), TC_OK);
    tc_level_textures_upload(&gl, &t, c.clipmap, CHARTS, -1, 0);
    assert_right(&gl, &t, &c);
    tc_level_textures_destroy(&gl, &t);
    free_charts(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_content_of_our_own_is_uploaded), cmocka_unit_test(late_readers_keep_to_their_budget),
        cmocka_unit_test(no_time_is_a_piece_a_call),        cmocka_unit_test(what_goes_through_a_ring_is_the_same),
        cmocka_unit_test(pictures_are_the_same_by_any_way), cmocka_unit_test(what_is_not_there_yet_is_drawn_coarser),
        cmocka_unit_test(no_room_is_said_and_harmless),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
