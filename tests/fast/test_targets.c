/* test_targets.c - frames in targets of others: what comes out, what is left alone, what is refused; several views. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/gl/program.h"
#include "planar/square.h"
#include "spherical/rings.h"
#include "common/imagery/imagery.h"
#include "tests/support/draped.h"
#include "tests/support/gl_refuse.h"
#include "tests/support/host_state.h"
#include "tests/support/planet_scene.h"
#include "tests/support/refused.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { WIDTH = 160, HEIGHT = 120, X = 24, Y = 17, WHOLE_WIDTH = 200, WHOLE_HEIGHT = 150 };

static tc_context *context;
static const tc_gl *gl;
static tc_field *flat;
static tc_map *planet, *ellipsoid;
static const tc_scene_options look = {.budget = -1};

static tc_camera flat_view(void)
{
    return (tc_camera){
        .x = 3000, .y = 2000, .z = 900, .heading = 0.7, .pitch = -0.25, .fov = 1.2, .width = WIDTH, .height = HEIGHT};
}

static tc_camera planet_view_of(double longitude)
{
    return (tc_camera){.x = longitude,
                       .y = 0.5,
                       .z = 4e5,
                       .heading = 0.3,
                       .pitch = -0.5,
                       .fov = 1.1,
                       .width = WIDTH,
                       .height = HEIGHT};
}

static scene flat_scene(void)
{
    return scene_create(context, flat, 63, &look);
}

static scene globe_scene_of(const tc_map *map)
{
    return planet_scene(context, map, &(tc_rings_options){.n_phi = 256, .n = 63}, &look);
}

/* ---- A host's framebuffer ---------------------------------------------------------------------------------------- */

/* A target of its own kind: two attachments, depth as OpenGL begins, more than the rectangle. */
typedef struct host {
    tc_target target;
    GLuint framebuffer, colour[2], depth;
    int begun, ended;
} host;

static tc_status host_begin(tc_target *target, const tc_gl *g, int width, int height, tc_error *error)
{
    (void)g, (void)error;
    host *h = (host *)target;
    h->target.place.width = width, h->target.place.height = height;
    h->begun++;
    return TC_OK;
}

static tc_status host_end(tc_target *target, const tc_gl *g, tc_error *error)
{
    (void)g, (void)error;
    ((host *)target)->ended++;
    return TC_OK;
}

static const tc_target_class host_class = {"host", host_begin, host_end};

static GLuint texture(GLenum format)
{
    GLuint t;
    gl->CreateTextures(GL_TEXTURE_2D, 1, &t);
    gl->TextureStorage2D(t, 1, format, WHOLE_WIDTH, WHOLE_HEIGHT);
    return t;
}

static host host_create(GLenum format, GLenum depth_format, tc_depth depth, tc_encoding encoding)
{
    host h = {.target.class = &host_class};
    gl->CreateFramebuffers(1, &h.framebuffer);
    for (int i = 0; i < 2; i++) {
        h.colour[i] = texture(i ? GL_RGBA8 : format);
        gl->NamedFramebufferTexture(h.framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)i, h.colour[i], 0);
    }
    h.depth = texture(depth_format);
    gl->NamedFramebufferTexture(h.framebuffer, GL_DEPTH_ATTACHMENT, h.depth, 0);
    gl->NamedFramebufferDrawBuffers(h.framebuffer, 2, (GLenum[]){GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1});
    const float red[] = {1, 0, 0, 1}, far = depth == TC_DEPTH_REVERSED ? 0 : 1;
    for (int i = 0; i < 2; i++)
        gl->ClearNamedFramebufferfv(h.framebuffer, GL_COLOR, i, red);
    gl->ClearNamedFramebufferfv(h.framebuffer, GL_DEPTH, 0, &far);
    h.target.place = (tc_target_place){.framebuffer = h.framebuffer,
                                       .x = X,
                                       .y = Y,
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .depth = depth,
                                       .encoding = encoding,
                                       .keep_state = true};
    return h;
}

static void host_destroy(host *h)
{
    gl->DeleteFramebuffers(1, &h->framebuffer);
    gl->DeleteTextures(2, h->colour);
    gl->DeleteTextures(1, &h->depth);
}

/* Pixels of an attachment, the whole, rows from the top. */
static uint8_t *host_pixels(const host *h, int attachment)
{
    uint8_t *rgb = malloc(3 * WHOLE_WIDTH * WHOLE_HEIGHT), *turned = malloc(3 * WHOLE_WIDTH * WHOLE_HEIGHT);
    assert_true(rgb && turned);
    gl->GetTextureImage(h->colour[attachment], 0, GL_RGB, GL_UNSIGNED_BYTE, 3 * WHOLE_WIDTH * WHOLE_HEIGHT, rgb);
    for (int j = 0; j < WHOLE_HEIGHT; j++)
        memcpy(turned + (size_t)j * 3 * WHOLE_WIDTH, rgb + (size_t)(WHOLE_HEIGHT - 1 - j) * 3 * WHOLE_WIDTH,
               3 * WHOLE_WIDTH);
    free(rgb);
    return turned;
}

static bool red(const uint8_t *p)
{
    return p[0] == 255 && p[1] == 0 && p[2] == 0;
}

/* OpenGL's own perspective, or the same to 0 .. 1, or reversed. */
static void perspective(const tc_camera *c, tc_depth depth, double near, double far, double m[16])
{
    double tx, ty;
    tc_camera_tangents(c, &tx, &ty);
    memset(m, 0, 16 * sizeof *m);
    m[0] = 1 / tx, m[5] = 1 / ty, m[11] = -1;
    m[10] = -(far + near) / (far - near), m[14] = -2 * far * near / (far - near);
    if (depth == TC_DEPTH_ZERO_TO_ONE)
        m[10] = -far / (far - near), m[14] = -far * near / (far - near);
    if (depth == TC_DEPTH_REVERSED)
        m[10] = near / (far - near), m[14] = far * near / (far - near);
}

static const tc_body flat_body = {&tc_plane_body, 0, 0}, large_body = {&tc_sphere_body, 1e7, 0};

/* The view matrix of a camera; over a planet in its body's axes. */
static void look_from(const tc_camera *c, const tc_body *body, double m[16])
{
    tc_basis b = tc_camera_basis(c);
    double eye[3] = {c->x, c->y, c->z}, rows[3][3];
    for (int i = 0; i < 3; i++)
        rows[0][i] = b.right[i], rows[1][i] = b.up[i], rows[2][i] = -b.forward[i];
    if (body->radius > 0) {
        double axes[3][3];
        const double place[3] = {c->x, c->y, c->z};
        body->class->axes(body, place, axes);
        body->class->position(body, place, eye);
        for (int k = 0; k < 3; k++) {
            double v[3] = {0, 0, 0};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    v[i] += rows[k][j] * axes[j][i];
            memcpy(rows[k], v, sizeof v);
        }
    }
    memset(m, 0, 16 * sizeof *m);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            m[4 * i + k] = rows[k][i];
            m[12 + k] -= rows[k][i] * eye[i];
        }
    m[15] = 1;
}

static tc_sight sight_of(const tc_camera *c, tc_depth depth, const tc_body *body, double near, double far)
{
    double view[16], projection[16];
    tc_sight sight;
    tc_error error;
    look_from(c, body, view);
    perspective(c, depth, near, far, projection);
    if (tc_sight_by(view, projection, depth, body, c->width, c->height, &sight, &error) != TC_OK)
        fail_msg("%s", error.text);
    return sight;
}

/* How many of the picture's pixels are another colour, by more than rounding, in the host's rectangle. */
static int differing(const uint8_t *whole, const uint8_t *picture)
{
    int count = 0;
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++) {
            const uint8_t *p = whole + 3 * ((j + WHOLE_HEIGHT - Y - HEIGHT) * WHOLE_WIDTH + i + X);
            const uint8_t *q = picture + 3 * (j * WIDTH + i);
            int worst = 0;
            for (int k = 0; k < 3; k++)
                worst = abs(p[k] - q[k]) > worst ? abs(p[k] - q[k]) : worst;
            count += worst > 4;
        }
    return count;
}

static void assert_drawn(scene *s, const tc_camera *c, const tc_body *body, tc_depth depth, GLenum depth_format)
{
    tc_error error;
    tc_frame_stats stats;
    scene_draw(s, c, true);
    uint8_t *picture = scene_pixels(s, c);
    host h = host_create(GL_RGBA8, depth_format, depth, TC_ENCODING_SHOWN);
    const tc_sight sight = sight_of(c, depth, body, body->radius > 0 ? 1000 : 1, 4 * s->surface->extent);
    if (tc_renderer_draw(s->renderer, &h.target, &sight, false, &stats, &error) != TC_OK)
        fail_msg("%s", error.text);
    assert_int_equal(h.begun, 1);
    assert_int_equal(h.ended, 1);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
    uint8_t *whole = host_pixels(&h, 0), *other = host_pixels(&h, 1);
    int off = differing(whole, picture), outside = 0, touched = 0;
    for (int i = 0; i < WHOLE_WIDTH * WHOLE_HEIGHT; i++) {
        int x = i % WHOLE_WIDTH, y = WHOLE_HEIGHT - 1 - i / WHOLE_WIDTH;
        bool in = x >= X && x < X + WIDTH && y >= Y && y < Y + HEIGHT;
        outside += !in && !red(whole + 3 * i);
        touched += !red(other + 3 * i);
    }
    if (off > WIDTH * HEIGHT / 200 || outside || touched)
        fail_msg("depth %d: %d pixels differ, %d outside the rectangle are drawn, %d of the other attachment", depth,
                 off, outside, touched);
    free(whole), free(other), free(picture);
    host_destroy(&h);
}

static void a_hosts_target_is_drawn_into(void **state)
{
    (void)state;
    const tc_camera c = flat_view(), p = planet_view_of(0.4);
    scene f = flat_scene(), g = globe_scene_of(planet), e = globe_scene_of(ellipsoid);
    for (tc_depth d = 0; d < TC_DEPTHS; d++) {
        assert_drawn(&f, &c, &flat_body, d, GL_DEPTH_COMPONENT32F);
        assert_drawn(&g, &p, &planet->body, d, GL_DEPTH_COMPONENT32F);
        assert_drawn(&e, &p, &ellipsoid->body, d, GL_DEPTH_COMPONENT32F);
    }
    assert_drawn(&f, &c, &flat_body, TC_DEPTH_CONVENTIONAL, GL_DEPTH_COMPONENT24);
    scene_destroy(&f);
    scene_destroy(&g);
    scene_destroy(&e);
}

/* What an sRGB format and one of floats hold is, shown, the picture. */
static void light_is_written_as_the_target_says(void **state)
{
    (void)state;
    const tc_camera c = flat_view();
    scene s = flat_scene();
    tc_error error;
    tc_frame_stats stats;
    scene_draw(&s, &c, true);
    uint8_t *picture = scene_pixels(&s, &c);
    const tc_sight sight = tc_sight_through(&c, TC_DEPTH_REVERSED, s.surface->near_plane);
    host h = host_create(GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT32F, TC_DEPTH_REVERSED, TC_ENCODING_SRGB);
    assert_int_equal(tc_renderer_draw(s.renderer, &h.target, &sight, false, &stats, &error), TC_OK);
    uint8_t *whole = host_pixels(&h, 0);
    assert_int_equal(differing(whole, picture), 0);
    free(whole);
    host_destroy(&h);
    h = host_create(GL_RGBA32F, GL_DEPTH_COMPONENT32F, TC_DEPTH_REVERSED, TC_ENCODING_LINEAR);
    assert_int_equal(tc_renderer_draw(s.renderer, &h.target, &sight, false, &stats, &error), TC_OK);
    float(*light)[4] = malloc(sizeof *light * WHOLE_WIDTH * WHOLE_HEIGHT);
    assert_non_null(light);
    gl->GetTextureImage(h.colour[0], 0, GL_RGBA, GL_FLOAT, (GLsizei)(sizeof *light * WHOLE_WIDTH * WHOLE_HEIGHT),
                        light);
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < 3 * WIDTH; i++) {
            double l = light[(Y + HEIGHT - 1 - j) * WHOLE_WIDTH + X + i / 3][i % 3];
            l = fmin(fmax(l, 0), 1); /* as a picture is cut */
            double shown = l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
            assert_true(fabs(255 * shown - picture[3 * j * WIDTH + i]) < 1.5);
        }
    free(light), free(picture);
    host_destroy(&h);
    scene_destroy(&s);
}

/* Turned about the axis of sight, mirrored, seen off the middle: the middle of what is seen is the same place. */
static void any_perspective_is_drawn(void **state)
{
    (void)state;
    tc_camera c = flat_view();
    scene s = flat_scene();
    tc_error error;
    tc_frame_stats stats;
    scene_draw(&s, &c, true);
    uint8_t *picture = scene_pixels(&s, &c);
    double view[16], projection[16];
    look_from(&c, &flat_body, view);
    perspective(&c, TC_DEPTH_CONVENTIONAL, 1, 1e6, projection);
    for (int kind = 0; kind < 3; kind++) {
        double v[16], p[16];
        memcpy(v, view, sizeof v), memcpy(p, projection, sizeof p);
        if (kind == 0) /* upside down */
            for (int i = 0; i < 4; i++)
                v[4 * i] = -v[4 * i], v[4 * i + 1] = -v[4 * i + 1];
        if (kind == 1) /* left and right exchanged */
            p[0] = -p[0];
        if (kind == 2) /* the right half, twice as wide */
            p[0] *= 2, p[8] = 1;
        tc_sight sight;
        if (tc_sight_by(v, p, TC_DEPTH_CONVENTIONAL, &flat_body, WIDTH, HEIGHT, &sight, &error) != TC_OK)
            fail_msg("%s", error.text);
        host h = host_create(GL_RGBA8, GL_DEPTH_COMPONENT32F, TC_DEPTH_CONVENTIONAL, TC_ENCODING_SHOWN);
        do
            assert_int_equal(tc_renderer_draw(s.renderer, &h.target, &sight, true, &stats, &error), TC_OK);
        while (!stats.resident);
        uint8_t *whole = host_pixels(&h, 0), *expected = malloc(3 * WIDTH * HEIGHT);
        assert_non_null(expected);
        for (int j = 0; j < HEIGHT; j++)
            for (int i = 0; i < WIDTH; i++) {
                int x = kind == 2 ? WIDTH / 2 + i / 2 : WIDTH - 1 - i, y = kind == 0 ? HEIGHT - 1 - j : j;
                memcpy(expected + 3 * (j * WIDTH + i), picture + 3 * (y * WIDTH + x), 3);
            }
        int off = differing(whole, expected);
        /* Twice as wide is another picture: pixels between. */
        if (off > WIDTH * HEIGHT / (kind == 2 ? 4 : 100))
            fail_msg("perspective %d: %d pixels differ", kind, off);
        free(whole), free(expected);
        host_destroy(&h);
    }
    free(picture);
    scene_destroy(&s);
}

/* ---- State ------------------------------------------------------------------------------------------------------- */

static void a_host_gets_its_state_back(void **state)
{
    (void)state;
    const tc_camera c = flat_view(), p = planet_view_of(0.4);
    tc_map *map = tc_map_flat(terrain_field(TERRAIN_SMOOTH, 300, 200, 30, 1));
    tc_image *image = draped_image(draped_waves, 300, 200);
    tc_imagery *imagery;
    assert_int_equal(tc_imagery_create(map, &image, 1, 1, &imagery, NULL), TC_OK);
    tc_scene_options with_imagery = look;
    with_imagery.imagery = imagery;
    scene scenes[3] = {flat_scene(), globe_scene_of(planet),
                       scene_create(context, tc_map_field(map, 0), 63, &with_imagery)};
    for (int k = 0; k < 3; k++) {
        tc_error error;
        tc_frame_stats stats;
        const bool sphere = k == 1;
        const tc_camera *camera = sphere ? &p : &c;
        host h = host_create(GL_RGBA8, GL_DEPTH_COMPONENT32F, TC_DEPTH_CONVENTIONAL, TC_ENCODING_SHOWN);
        host plain = host_create(GL_RGBA8, GL_DEPTH_COMPONENT32F, TC_DEPTH_CONVENTIONAL, TC_ENCODING_SHOWN);
        const tc_sight sight = sight_of(camera, TC_DEPTH_CONVENTIONAL, sphere ? &planet->body : &flat_body,
                                        sphere ? 1000 : 1, 4 * scenes[k].surface->extent);
        do
            assert_int_equal(tc_renderer_draw(scenes[k].renderer, &plain.target, &sight, true, &stats, &error), TC_OK);
        while (!stats.resident);
        host_odd odd = host_odd_begin(gl);
        host_state before = host_state_now(gl);
        if (tc_renderer_draw(scenes[k].renderer, &h.target, &sight, false, &stats, &error) != TC_OK)
            fail_msg("%s", error.text);
        host_state after = host_state_now(gl);
        host_state_assert_same(&before, &after);
        h.target.place.samples = 4, h.target.class = NULL; /* and where nothing comes of it */
        assert_int_equal(tc_renderer_draw(scenes[k].renderer, &h.target, &sight, false, &stats, &error), TC_ERR_USAGE);
        after = host_state_now(gl);
        host_state_assert_same(&before, &after);
        host_odd_end(gl, &odd);
        /* What the host had set has changed nothing of the picture. */
        uint8_t *a = host_pixels(&h, 0), *b = host_pixels(&plain, 0);
        assert_memory_equal(a, b, 3 * WHOLE_WIDTH * WHOLE_HEIGHT);
        free(a), free(b);
        host_destroy(&h);
        host_destroy(&plain);
        scene_destroy(&scenes[k]);
    }
    tc_imagery_destroy(imagery);
    tc_map_destroy(map);
}

/* ---- Several views ----------------------------------------------------------------------------------------------- */

static tc_surface *another_surface(bool sphere)
{
    tc_surface *surface;
    tc_error error;
    if (sphere)
        return planet_rings(planet, &(tc_rings_options){.n_phi = 256, .n = 63}, &look);
    const tc_ground_options options = {.n = 63, .normals = true};
    assert_int_equal(tc_square_create(flat, &options, NULL, &surface, &error), TC_OK);
    return surface;
}

static uint8_t *drawn_apart(bool sphere, const tc_camera *c)
{
    scene s = sphere ? globe_scene_of(planet) : flat_scene();
    scene_draw(&s, c, true);
    uint8_t *rgb = scene_pixels(&s, c);
    scene_destroy(&s);
    return rgb;
}

static void two_views_in_a_frame_are_the_two_apart(void **state)
{
    (void)state;
    for (int sphere = 0; sphere < 2; sphere++) {
        tc_camera camera[2] = {sphere ? planet_view_of(0.4) : flat_view(), sphere ? planet_view_of(-2) : flat_view()};
        camera[1].heading += 2, camera[1].z += 300;
        tc_surface *surface = another_surface(sphere != 0);
        scene first = {0}, second = {0};
        tc_error error;
        tc_frame_stats stats[2];
        assert_int_equal(tc_renderer_create(gl, surface, &look, &first.renderer, &error), TC_OK);
        assert_int_equal(
            tc_renderer_create_with(gl, tc_renderer_objects(first.renderer), &look, &second.renderer, &error), TC_OK);
        scene *scenes[2] = {&first, &second};
        do
            for (int k = 0; k < 2; k++)
                assert_int_equal(tc_renderer_frame(scenes[k]->renderer, &camera[k], k == 1, &stats[k], &error), TC_OK);
        while (!stats[0].resident || !stats[1].resident);
        for (int k = 0; k < 2; k++) {
            uint8_t *both = scene_pixels(scenes[k], &camera[k]), *apart = drawn_apart(sphere != 0, &camera[k]);
            assert_memory_equal(both, apart, 3 * WIDTH * HEIGHT);
            free(both), free(apart);
        }
        scene_destroy(&first); /* what they share stays with the other */
        assert_int_equal(tc_renderer_frame(second.renderer, &camera[1], true, &stats[1], &error), TC_OK);
        uint8_t *left = scene_pixels(&second, &camera[1]), *apart = drawn_apart(sphere != 0, &camera[1]);
        assert_memory_equal(left, apart, 3 * WIDTH * HEIGHT);
        free(left), free(apart);
        scene_destroy(&second);
        surface->destroy(surface);
    }
}

/* ---- Nonsense ---------------------------------------------------------------------------------------------------- */

static void nonsense_matrices_are_refused(void **state)
{
    (void)state;
    const tc_camera c = flat_view();
    double view[16], projection[16];
    look_from(&c, &flat_body, view);
    perspective(&c, TC_DEPTH_CONVENTIONAL, 1, 1e6, projection);
    static const struct nonsense {
        int of_view, element;
        double value;
        const char *word;
    } all[] = {{1, 5, NAN, "finite"},  {1, 13, INFINITY, "finite"}, {0, 0, NAN, "finite"},      {1, 0, 7, "rotation"},
               {1, 15, 0, "rotation"}, {0, 0, 0, "inverted"},       {0, 14, 0, "inverted"},     {0, 11, 1, "inverted"},
               {0, 11, 0, "inverted"}, {0, 15, 1, "perspective"},   {0, 4, 0.5, "perspective"}, {0, 14, 2, "depth"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        double m[2][16];
        tc_sight sight;
        tc_error error;
        memcpy(m[0], projection, sizeof m[0]), memcpy(m[1], view, sizeof m[1]);
        m[all[i].of_view][all[i].element] = all[i].value;
        assert_refused(tc_sight_by(m[1], m[0], TC_DEPTH_CONVENTIONAL, &flat_body, WIDTH, HEIGHT, &sight, &error),
                       TC_ERR_USAGE, &error, all[i].word);
    }
    tc_sight sight;
    tc_error error;
    assert_refused(tc_sight_by(view, projection, TC_DEPTH_REVERSED, &flat_body, WIDTH, HEIGHT, &sight, &error),
                   TC_ERR_USAGE, &error, "falls");
    assert_refused(tc_sight_by(view, projection, TC_DEPTH_CONVENTIONAL, &large_body, WIDTH, HEIGHT, &sight, &error),
                   TC_ERR_USAGE, &error, "eye");
}

static void targets_that_are_not_as_they_say_are_refused(void **state)
{
    (void)state;
    const tc_camera c = flat_view();
    scene s = flat_scene();
    host h = host_create(GL_RGBA8, GL_DEPTH_COMPONENT32F, TC_DEPTH_REVERSED, TC_ENCODING_SHOWN);
    h.target.class = NULL;
    const tc_target_place good = h.target.place;
    GLuint bare;
    gl->CreateFramebuffers(1, &bare);
    gl->NamedFramebufferTexture(bare, GL_COLOR_ATTACHMENT0, h.colour[0], 0);
    struct wrong {
        tc_target_place place;
        const char *word;
    } all[12] = {{good, NULL}};
    int count = 1;
#define WRONG(field, value_, word_) all[count].place = good, all[count].place.field = value_, all[count++].word = word_
    WRONG(framebuffer, 4711, "framebuffer of this context");
    WRONG(framebuffer, bare, "depth attachment");
    WRONG(x, WHOLE_WIDTH - WIDTH + 1, "within");
    WRONG(y, -1, "within");
    WRONG(width, 0, "at least 1 x 1");
    WRONG(width, WIDTH - 1, "as the camera has");
    WRONG(samples, 4, "samples");
    WRONG(encoding, TC_ENCODING_SRGB, "sRGB");
    WRONG(encoding, TC_ENCODING_LINEAR, "float");
    WRONG(depth, (tc_depth)17, "known depth");
#undef WRONG
    const tc_sight sight = tc_sight_through(&c, TC_DEPTH_REVERSED, s.surface->near_plane);
    for (int i = 0; i < count; i++) {
        tc_error error = {.text = ""};
        tc_frame_stats stats;
        h.target.place = all[i].place;
        tc_status status = tc_renderer_draw(s.renderer, &h.target, &sight, false, &stats, &error);
        if (all[i].word)
            assert_refused(status, TC_ERR_USAGE, &error, all[i].word);
        else
            assert_int_equal(status, TC_OK);
        assert_int_equal(gl->GetError(), GL_NO_ERROR);
    }
    gl->DeleteFramebuffers(1, &bare);
    host_destroy(&h);
    scene_destroy(&s);
}

/* ---- A driver without memory ------------------------------------------------------------------------------------- */

/* Draws a frame and more of another size, and destroys all; what was refused is said, and nothing stays behind. */
static void draw_with(const tc_gl *table, gl_refuse *refuse, tc_surface *surface, const tc_scene_options *options,
                      const uint8_t *picture)
{
    const tc_camera c = flat_view();
    tc_renderer *r = NULL;
    tc_frame_stats stats = {0};
    tc_error error = {.text = ""};
    tc_status status = tc_renderer_create(table, surface, options, &r, &error);
    if (status == TC_OK)
        status = tc_renderer_frame(r, &c, true, &stats, &error);
    bool was_refused = refuse->refuse && refuse->asked >= refuse->refuse;
    if (status != (was_refused ? TC_ERR_MEMORY : TC_OK) || (status && (!error.text[0] || strchr(error.text, '\n'))))
        fail_msg("allocation %d refused: %d, \"%s\"", refuse->refuse, status, error.text);
    if (r) { /* and once there is memory again it goes on */
        uint8_t *rgb = malloc(3 * WIDTH * HEIGHT);
        assert_non_null(rgb);
        do {
            bool before = refuse->asked < refuse->refuse;
            status = tc_renderer_frame(r, &c, true, &stats, &error);
            bool again = before && refuse->asked >= refuse->refuse; /* it was in a later frame */
            assert_int_equal(status, again ? TC_ERR_MEMORY : TC_OK);
        } while (status != TC_OK || !stats.resident);
        tc_renderer_read(r, rgb, NULL);
        if (picture)
            assert_memory_equal(rgb, picture, 3 * WIDTH * HEIGHT);
        free(rgb);
    }
    tc_renderer_destroy(r);
    if (refuse->alive)
        fail_msg("allocation %d refused: %d objects are left", refuse->refuse, refuse->alive);
    assert_int_equal(gl->GetError(), GL_NO_ERROR);
}

static void a_driver_without_memory_is_said(void **state)
{
    (void)state;
    const tc_camera c = flat_view();
    for (int samples = 1; samples <= 4; samples += 3) {
        tc_scene_options options = look;
        options.samples = samples;
        scene s = scene_create(context, flat, 63, &options);
        scene_draw(&s, &c, true);
        uint8_t *picture = scene_pixels(&s, &c);
        tc_surface *surface = another_surface(false);
        gl_refuse refuse = {0};
        tc_gl table = gl_refuse_begin(gl, &refuse);
        draw_with(&table, &refuse, surface, &options, picture);
        int all = refuse.asked;
        assert_true(all > 8);
        for (int k = 1; k <= all; k++) {
            refuse = (gl_refuse){.refuse = k};
            table = gl_refuse_begin(gl, &refuse);
            draw_with(&table, &refuse, surface, &options, picture);
        }
        surface->destroy(surface);
        free(picture);
        scene_destroy(&s);
    }
}

/* ---- A scheme's own text ----------------------------------------------------------------------------------------- */

/* Parts of programs need not be files of shaders/: in this one's all heights are on the shore. */
#define ALL_SHORE                                                                                                      \
    "INTERPOLATED in float v_height;\n"                                                                                \
    "Ground surface_ground()\n"                                                                                        \
    "{\n"                                                                                                              \
    "    Ground g;\n"                                                                                                  \
    "    g.height = heights.x, g.colour = vec4(0.0);\n"                                                                \
    "    return g;\n"                                                                                                  \
    "}\n"

static const tc_camera down = {
    .x = 3000, .y = 2000, .z = 3000, .pitch = -1.57, .fov = 1, .width = WIDTH, .height = HEIGHT};

/* The picture of a scheme whose fragment part is `text`; the caller frees it. NULL where it is refused. */
static uint8_t *drawn_by(const char *text, const tc_scene_options *options, tc_error *error)
{
    static const char *const parts[] = {"own.frag", NULL};
    const struct tc_shader_file texts[] = {{"own.frag", text}, {NULL, NULL}};
    scene s = {.surface = another_surface(false)};
    s.surface->fragment_parts = parts;
    s.surface->texts = texts;
    if (tc_renderer_create(gl, s.surface, options, &s.renderer, error) != TC_OK) {
        s.surface->destroy(s.surface);
        return NULL;
    }
    scene_draw(&s, &down, true);
    uint8_t *rgb = scene_pixels(&s, &down);
    scene_destroy(&s);
    return rgb;
}

static void a_scheme_brings_its_own_text(void **state)
{
    (void)state;
    const tc_scene_options plain = {.unlit = true, .background_set = true, .budget = -1};
    tc_error error = {.text = ""};
    uint8_t *rgb = drawn_by(ALL_SHORE, &plain, &error);
    assert_non_null(rgb);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        assert_memory_equal(rgb + 3 * i, rgb, 3);
    assert_true(rgb[0] > 0);
    free(rgb);
    assert_null(drawn_by("Ground surface_ground()\n{\n    return nothing;\n}\n", &plain, &error));
    assert_non_null(strstr(error.text, "own.frag:3: "));
}

/* Air of any depth is all that one sees, also where that has no end: a sample's depth may be extrapolated to 0. */
static void air_without_end_is_air(void **state)
{
    (void)state;
    static const char *const airs[] = {ALL_SHORE "float surface_haze() { return 1e20; }\n",
                                       ALL_SHORE "float surface_haze() { return 1.0 / max(-gl_FragCoord.x, 0.0); }\n"};
    for (int samples = 1; samples <= 4; samples += 3) {
        const tc_scene_options plain = {.unlit = true, .budget = -1, .samples = samples};
        tc_error error = {.text = ""};
        uint8_t *rgb[2];
        for (int i = 0; i < 2; i++)
            if (!(rgb[i] = drawn_by(airs[i], &plain, &error)))
                fail_msg("%s", error.text);
        assert_true(rgb[0][0] > 0);
        assert_memory_equal(rgb[0], rgb[1], (size_t)3 * WIDTH * HEIGHT);
        free(rgb[0]);
        free(rgb[1]);
    }
}

int main(void)
{
    context = scene_context();
    if (!context)
        return 0;
    gl = tc_context_gl(context);
    flat = terrain_field(TERRAIN_SMOOTH, 300, 200, 30, 1);
    planet = planet_made(PLANET_SMOOTH, 512, 6371000, 1);
    ellipsoid = planet_flattened(planet_made(PLANET_SMOOTH, 512, 6371000, 1), 0.1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hosts_target_is_drawn_into),
        cmocka_unit_test(light_is_written_as_the_target_says),
        cmocka_unit_test(any_perspective_is_drawn),
        cmocka_unit_test(a_host_gets_its_state_back),
        cmocka_unit_test(two_views_in_a_frame_are_the_two_apart),
        cmocka_unit_test(nonsense_matrices_are_refused),
        cmocka_unit_test(a_driver_without_memory_is_said),
        cmocka_unit_test(a_scheme_brings_its_own_text),
        cmocka_unit_test(air_without_end_is_air),
        cmocka_unit_test(targets_that_are_not_as_they_say_are_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    tc_field_destroy(flat);
    tc_map_destroy(planet);
    tc_map_destroy(ellipsoid);
    tc_context_destroy(context);
    return failed;
}
