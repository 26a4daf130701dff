/* extreme_depth.c - two surfaces close to each other and far away: the farther never shows.
 *
 * A terrain and a copy of it that lies lower by a hundred-thousandth of the distance, 0.5 m at 50 km and 50 m at
 * 5,000 km, are drawn into one frame buffer, the lower one first, so that a tie counts as lost. From above the lower
 * one lies behind the other on every ray. Draws, programs, uniforms and the depth's format are the renderer's, whose
 * state stays bound after a frame. A pixel is wrong where the lower terrain's colours show and the upper one is drawn
 * as well: none may be. The same draws with a conventional 24-bit buffer, and with as many bits reversed, must be found
 * wrong: there at most half of the pixels may be right without it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/camera.h"
#include "tests/support/extreme.h"
#include "tests/support/scene.h"
#include "tests/support/terrains.h"

enum { SIZE = 1025, N = 255, WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

/* How depth is kept. */
typedef enum keeping {
    AS_RENDERED,  /* near / distance in a float */
    REVERSED_24,  /* the same from a near plane of 1 m, in 24 bits of an integer */
    CONVENTIONAL, /* 24 bits, from 0 at a near plane of 1 m to 1 at twice the distance */
    KEEPINGS
} keeping;

typedef struct target {
    GLuint framebuffer, colour, depth;
} target;

static target target_create(const tc_gl *gl, GLenum depth_format)
{
    target t;
    gl->CreateRenderbuffers(1, &t.colour);
    gl->NamedRenderbufferStorage(t.colour, GL_RGBA8, WIDTH, HEIGHT);
    gl->CreateRenderbuffers(1, &t.depth);
    gl->NamedRenderbufferStorage(t.depth, depth_format, WIDTH, HEIGHT);
    gl->CreateFramebuffers(1, &t.framebuffer);
    gl->NamedFramebufferRenderbuffer(t.framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, t.colour);
    gl->NamedFramebufferRenderbuffer(t.framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t.depth);
    return t;
}

static void target_destroy(const tc_gl *gl, target *t)
{
    gl->DeleteFramebuffers(1, &t->framebuffer);
    gl->DeleteRenderbuffers(2, (GLuint[]){t->colour, t->depth});
}

/* Another projection into the uniforms that are bound: a near plane that is kind to 24 bits, and for a conventional
 * buffer depths that grow with the distance. */
static void set_projection(const tc_gl *gl, const tc_camera *camera, double distance, bool conventional)
{
    const double near_plane = 1, far = 2 * distance;
    float matrix[16];
    tc_basis b = tc_camera_basis(camera);
    tc_camera_matrix(camera, near_plane, matrix);
    for (int i = 0; i < 3 && conventional; i++)
        matrix[4 * i + 2] = (float)(b.forward[i] * far / (far - near_plane));
    if (conventional)
        matrix[14] = (float)(-far * near_plane / (far - near_plane));
    GLint uniforms;
    gl->GetIntegerv(GL_UNIFORM_BUFFER_BINDING, &uniforms);
    gl->NamedBufferSubData((GLuint)uniforms, 0, sizeof matrix, matrix);
}

static const tc_scene_options options = {
    .unlit = true, .background_set = true, .background = {255, 0, 255}, .frame.no_closers = true};

/* Draws a scene as its renderer does, and then once more on top of what is in the target. */
static void draw_into(const tc_gl *gl, scene *s, const tc_camera *camera, double distance, keeping how, const target *t)
{
    scene_draw(s, camera, true);
    int strips = tc_renderer_used(s->renderer).frame->blocks;
    if (how != AS_RENDERED)
        set_projection(gl, camera, distance, how == CONVENTIONAL);
    gl->BindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    gl->DepthFunc(how == CONVENTIONAL ? GL_LESS : GL_GREATER);
    gl->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT, NULL, strips, 0);
    gl->DepthFunc(GL_GREATER);
}

static void clear(const tc_gl *gl, const target *t, keeping how)
{
    gl->ClearNamedFramebufferfv(t->framebuffer, GL_DEPTH, 0, (float[]){how == CONVENTIONAL ? 1 : 0});
    gl->ClearNamedFramebufferfv(t->framebuffer, GL_COLOR, 0, (float[]){1, 0, 1, 1});
}

/* What a target holds. */
typedef struct picture {
    uint8_t rgb[PIXELS][3];
    float depth[PIXELS];
} picture;

static void read_picture(const tc_gl *gl, const target *t, picture *p)
{
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, t->framebuffer);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl->ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, p->rgb);
    gl->ReadPixels(0, 0, WIDTH, HEIGHT, GL_DEPTH_COMPONENT, GL_FLOAT, p->depth);
}

static bool same(const picture *a, const picture *b, int i)
{
    return memcmp(a->rgb[i], b->rgb[i], 3) == 0;
}

typedef struct count {
    int64_t both, wrong; /* pixels */
    int64_t undecided;   /* wrong ones where the two depths are equal, or next to each other as floats */
} count;

/* The upper terrain, the lower one, and both in one target. */
static count fight(const tc_gl *gl, scene *upper, scene *lower, const tc_camera *camera, double distance, keeping how)
{
    static const GLenum format[KEEPINGS] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT24};
    static const uint8_t background[3] = {255, 0, 255};
    static picture seen[3];
    target t = target_create(gl, format[how]);
    for (int k = 0; k < 3; k++) {
        clear(gl, &t, how);
        if (k != 0)
            draw_into(gl, lower, camera, distance, how, &t);
        if (k != 1)
            draw_into(gl, upper, camera, distance, how, &t);
        read_picture(gl, &t, &seen[k]);
    }
    count c = {0};
    for (int i = 0; i < PIXELS; i++) {
        if (memcmp(seen[0].rgb[i], background, 3) == 0 || memcmp(seen[1].rgb[i], background, 3) == 0 ||
            same(&seen[0], &seen[1], i))
            continue;
        c.both++;
        if (same(&seen[2], &seen[0], i))
            continue;
        float d = seen[0].depth[i], e = seen[1].depth[i];
        c.wrong++;
        c.undecided += d == e || nextafterf(d, e) == e;
    }
    target_destroy(gl, &t);
    return c;
}

/* Hills of a tenth of their length, lower by `down` metres. Colours of the lower one are those of another body. */
static tc_field *hills(double spacing, double down, bool other_body)
{
    tc_grid g = terrain_grid(TERRAIN_SMOOTH, SIZE, SIZE, spacing, 0);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int i = 0; i < SIZE * SIZE; i++) {
        g.z[i] = (float)((double)g.z[i] * spacing / 60 - down);
        g.z_min = fminf(g.z_min, g.z[i]), g.z_max = fmaxf(g.z_max, g.z[i]);
    }
    g.georef.semi_major = other_body ? 1737400 : 0;
    tc_field *p;
    if (tc_field_build(&g, 0, &p, NULL))
        exit(99);
    return p;
}

/* The middle of the frame sees the terrain's middle from that far, looking down by `pitch` degrees. */
static tc_camera view(const tc_field *p, double spacing, double distance, double pitch, double fov)
{
    double middle = 0.5 * (SIZE - 1) * spacing, down = pitch * M_PI / 180, z;
    tc_field_height(p, middle, middle, &z);
    return (tc_camera){.x = middle,
                       .y = middle - distance * cos(down),
                       .z = z + distance * sin(down),
                       .pitch = -down,
                       .fov = fov * M_PI / 180,
                       .width = WIDTH,
                       .height = HEIGHT};
}

static void run(const tc_context *context, double distance, double apart)
{
    const double spacing = distance * 60 / 50e3;
    const tc_gl *gl = tc_context_gl(context);
    tc_field *p = hills(spacing, 0, false), *q = hills(spacing, apart, true);
    scene upper = scene_create(context, p, N, &options), lower = scene_create(context, q, N, &options);
    static const double pitches[] = {90, 60, 30, 15, 5};
    char name[100];
    for (size_t k = 0; k < sizeof pitches / sizeof *pitches; k++)
        for (double fov = 5; fov <= 60; fov += 55) {
            snprintf(name, sizeof name, "%g m apart at %g km, %g degrees down, field of %g", apart, distance / 1000,
                     pitches[k], fov);
            tc_camera c = view(p, spacing, distance, pitches[k], fov);
            count seen = fight(gl, &upper, &lower, &c, distance, AS_RENDERED);
            extreme_at_most(name, "pixels of the farther surface", extreme_of(seen.both, (double)seen.wrong), 0,
                            "of %lld", (long long)seen.both);
        }
    /* Seen edge on, half a metre at 50 km is seven tenths of the 1/256 pixel that a rasteriser rounds corners to, and a
     * pixel spans 5 km of ground: which surface is in front is then settled there. Depths still tell them apart. */
    tc_camera grazing = view(p, spacing, distance, 2, 60);
    count n = fight(gl, &upper, &lower, &grazing, distance, AS_RENDERED);
    snprintf(name, sizeof name, "%g m apart at %g km, 2 degrees down, field of 60", apart, distance / 1000);
    extreme_at_most(name, "pixels that depth does not decide", extreme_of(n.both, (double)n.undecided), 0,
                    "%lld of %lld show the farther surface, corners being rounded to 1/256 pixel", (long long)n.wrong,
                    (long long)n.both);
    static const char *const found[KEEPINGS] = {NULL, "24 bits, reversed", "24 bits, conventional"};
    for (keeping how = REVERSED_24; how < KEEPINGS; how++) {
        tc_camera c = view(p, spacing, distance, 60, 60);
        n = fight(gl, &upper, &lower, &c, distance, how);
        snprintf(name, sizeof name, "%g m apart at %g km, %s", apart, distance / 1000, found[how]);
        extreme_at_most(name, "share of pixels that are right, to be found wrong",
                        extreme_of(n.both, 1 - (double)n.wrong / (double)n.both), 0.5, "%lld of %lld pixels fight",
                        (long long)n.wrong, (long long)n.both);
    }
    scene_destroy(&upper), scene_destroy(&lower);
    tc_field_destroy(p), tc_field_destroy(q);
}

int main(void)
{
    extreme_begin("depth");
    tc_context *context = scene_context();
    if (context) {
        run(context, 50e3, 0.5);
        run(context, 5000e3, 50);
    } else {
        extreme_skipped("two surfaces", "no OpenGL context");
    }
    tc_context_destroy(context);
    return extreme_end();
}
