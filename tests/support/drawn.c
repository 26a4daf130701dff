/* drawn.c - a planar scene as the driver draws it, held against the same in double. */
#include "drawn.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "common/measure/view_error.h"
#include "feedback.h"
#include "planar/square_internal.h"
#include "watertight.h"

drawn drawn_create(const tc_context *context, scene *s)
{
    const tc_gl *gl = tc_context_gl(context);
    const char *const varyings[] = {"gl_Position", NULL};
    return (drawn){gl, s, feedback_program(gl, s->surface, "", "renderer.vert", "", varyings)};
}

void drawn_destroy(drawn *d)
{
    d->gl->DeleteProgram(d->program);
}

static void *get(size_t bytes)
{
    void *p = malloc(bytes);
    if (!p)
        exit(99);
    return p;
}

/* ---- Depths ----------------------------------------------------------------------------------------------------- */

/* Whether the surface at some place not more than `away` metres across from p is as high as p; up and down count as
 * well. */
static bool surface_near(scene *s, const tc_camera *camera, const tc_frame_options *options, const double p[3],
                         double away)
{
    double lo = INFINITY, hi = -INFINITY, z;
    const tc_view *view = scene_look(s, camera, options);
    for (int k = 0; k < 9; k++) {
        double turn = M_PI / 4 * k, out = k < 8 ? away : 0;
        if (!s->surface->height(view, p[0] + out * cos(turn), p[1] + out * sin(turn), &z))
            return true; /* on the very rim */
        lo = fmin(lo, z - away), hi = fmax(hi, z + away);
    }
    return p[2] >= lo && p[2] <= hi;
}

void drawn_depths(scene *s, const tc_camera *camera, const tc_frame_options *options, int step, drawn_figures *figures)
{
    enum { MOST_PIXELS = 64 };
    float *depth = get(sizeof *depth * (size_t)camera->width * (size_t)camera->height);
    double scale = tc_camera_pixel_scale(camera);
    tc_renderer_read(s->renderer, NULL, depth);
    for (int64_t i = 0; i < (int64_t)camera->width * camera->height; i += step) {
        double p[3], z, off = 0.01;
        if (!(depth[i] > 0)) {
            figures->not_finite += depth[i] != 0;
            continue;
        }
        double x = (double)(i % camera->width) + 0.5, y = (double)(i / camera->width) + 0.5;
        tc_view_unproject(camera, s->surface->near_plane, &(tc_body){&tc_plane_body, 0, 0}, x, y, depth[i], p);
        if (!scene_height(s, camera, options, p[0], p[1], &z))
            continue; /* on the very rim */
        double d = hypot(hypot(p[0] - camera->x, p[1] - camera->y), p[2] - camera->z);
        while (off < MOST_PIXELS && !surface_near(s, camera, options, p, off * d / scale))
            off *= 1.5;
        figures->depth_px = fmax(figures->depth_px, off);
        figures->depths++;
    }
    free(depth);
}

/* ---- Vertices --------------------------------------------------------------------------------------------------- */

static void count_number(double value, drawn_figures *f)
{
    f->numbers++;
    f->not_finite += !isfinite(value);
}

/* Of the uniform block (frame.glsl) what is a number. */
static void look_at_uniforms(const drawn *d, drawn_figures *f)
{
    enum { MATRIX = 16, LAYERS = MATRIX + 4 * TC_SURFACE_VECTORS };
    enum { WINDOWS = LAYERS + TC_MAX_LAYERS * TC_LAYER_VECTORS * 4 };
    enum { EYE = WINDOWS + 4 * TC_MAX_LAYERS, ALL = EYE + 4 * 9 };
    static float value[ALL];
    GLint buffer;
    d->gl->GetIntegerv(GL_UNIFORM_BUFFER_BINDING, &buffer);
    d->gl->GetNamedBufferSubData((GLuint)buffer, 0, sizeof value, value);
    for (int i = 0; i < ALL; i++)
        count_number(value[i], f);
}

static void look_at_heights(const tc_clipmap *clipmap, drawn_figures *f)
{
    int64_t mask = tc_clipmap_n(clipmap);
    for (int l = 1; l <= tc_clipmap_levels(clipmap); l++) {
        tc_rect c = tc_clipmap_level(clipmap, l)->clip;
        for (int64_t j = c.y0; j < c.y1; j++)
            for (int64_t i = c.x0; i < c.x1; i++)
                for (int k = 0; k < 2; k++)
                    count_number(tc_ground_heights(clipmap, l)[(j & mask) * (mask + 1) + (i & mask)][k], f);
    }
}

/* A block of a level: its first vertex and its size in cells. */
typedef struct block {
    int level;
    int64_t x, y;
    int w, h;
} block;

/* What a draw draws, from what the surface made of it. */
static block block_of(const tc_clipmap *clipmap, const square_viewer *viewer, const tc_draw *draw,
                      const tc_instance *instance, int side)
{
    const tc_clip_level *all = tc_clipmap_level(clipmap, 1);
    bool wide = tc_max64(all->edge_x, all->edge_y) >= (int64_t)1 << 30; /* square_wide.glsl */
    block b = {.level = (wide ? instance->v[3] >> 24 : instance->v[3]) + 1, .w = 1};
    int shift = tc_clipmap_level(clipmap, b.level)->shift;
    int64_t x = instance->v[0], y = instance->v[1];
    if (wide) {
        x = x * 65536 + (int16_t)(instance->v[2] & 0xffff);
        y = y * 65536 + (int16_t)(instance->v[2] >> 16 & 0xffff);
    }
    b.x = (x + viewer->snap_x) >> shift;
    b.y = (y + viewer->snap_y) >> shift;
    uint32_t first = 0;
    while (first < draw->first_index)
        first += tc_block_strip_count(b.w++, side);
    b.h = (int)draw->count / (6 * b.w);
    return b;
}

/* Position of vertex (i, j) of a level relative to the eye. */
static void vertex(const tc_clipmap *clipmap, const tc_camera *camera, const square_viewer *viewer,
                   const square_morph *morph, int level, int64_t i, int64_t j, long double p[3])
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    int64_t mask = tc_clipmap_n(clipmap), x = tc_min64(i << l->shift, l->edge_x),
            y = tc_min64(j << l->shift, l->edge_y);
    const float *z = tc_ground_heights(clipmap, level)[(j & mask) * (mask + 1) + (i & mask)];
    double cell = ldexp(1, l->shift);
    double a = tc_square_alpha(morph, (double)(x - viewer->snap_x) / cell, (double)(y - viewer->snap_y) / cell);
    p[0] = (long double)x * finest.spacing_x - camera->x;
    p[1] = (long double)y * finest.spacing_y - camera->y;
    p[2] = (1 - a) * z[0] + a * z[1] + (long double)tc_field_info(field)->z_base - camera->z;
}

/* How many pixels the driver's clip coordinates are off p; negative: not within the frame. */
static double off_by(const tc_camera *camera, double near_plane, const long double p[3], const float clip[4])
{
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    long double right = 0, up = 0, forward = 0;
    for (int i = 0; i < 3; i++)
        right += b.right[i] * p[i], up += b.up[i] * p[i], forward += b.forward[i] * p[i];
    long double x = right / forward / tx, y = up / forward / ty;
    if (!(forward > near_plane && fabsl(x) <= 1.1L && fabsl(y) <= 1.1L))
        return -1;
    return hypot((double)(clip[0] / (long double)clip[3] - x) * camera->width / 2,
                 (double)(clip[1] / (long double)clip[3] - y) * camera->height / 2);
}

void drawn_vertices(drawn *d, const tc_camera *camera, const tc_frame_options *options, drawn_figures *figures)
{
    scene *s = d->scene;
    const tc_clipmap *clipmap = s->clipmap;
    look_at_uniforms(d, figures);
    look_at_heights(clipmap, figures);
    tc_frame frame;
    if (!tc_frame_allocate(s->surface, &frame))
        exit(99);
    s->surface->draws(scene_look(s, camera, options), &tc_renderer_used(s->renderer).textures->layers, &frame);
    square_viewer viewer = tc_square_viewer(clipmap, camera, true);
    int count = s->surface->geometry.vertex_count, side = (int)lrint(sqrt(count)) - 1;
    float(*clip)[4] = get((size_t)count * sizeof *clip);
    GLint vao;
    GLuint instances;
    d->gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vao);
    d->gl->CreateBuffers(1, &instances);
    d->gl->NamedBufferStorage(instances, (GLsizeiptr)((size_t)(frame.strip_draws + 1) * sizeof(tc_instance)),
                              frame.instances, 0);
    for (int n = 0; n < frame.strip_draws; n++) {
        block b = block_of(clipmap, &viewer, &frame.draws[n], &frame.instances[n], side);
        square_morph morph = tc_square_morph(clipmap, b.level, &viewer, options);
        d->gl->VertexArrayVertexBuffer((GLuint)vao, 1, instances, (GLintptr)((size_t)n * sizeof(tc_instance)),
                                       sizeof(tc_instance));
        feedback_run(d->gl, d->program, 0, count, 4, clip[0]);
        for (int j = 0; j <= b.h; j++)
            for (int i = 0; i <= b.w; i++) {
                const float *c = clip[j * (side + 1) + i];
                long double p[3];
                for (int k = 0; k < 4; k++)
                    count_number(c[k], figures);
                vertex(clipmap, camera, &viewer, &morph, b.level, b.x + i, b.y + j, p);
                double off = off_by(camera, s->surface->near_plane, p, c);
                if (off < 0)
                    continue;
                figures->vertex_px = fmax(figures->vertex_px, isnan(off) ? INFINITY : off);
                figures->vertices++;
            }
    }
    d->gl->DeleteBuffers(1, &instances);
    tc_frame_free(&frame);
    free(clip);
}

/* ---- Both ------------------------------------------------------------------------------------------------------- */

void drawn_look(drawn *d, const tc_camera *camera, const tc_scene_options *options, drawn_figures *figures)
{
    scene_draw(d->scene, camera, true);
    uint8_t *rgb = scene_pixels(d->scene, camera);
    int64_t terrain;
    figures->cracks += watertight_cracks(d->scene, rgb, camera, &options->frame, &terrain);
    figures->terrain += terrain;
    free(rgb);
    int64_t pixels = (int64_t)camera->width * camera->height;
    drawn_depths(d->scene, camera, &options->frame, (int)tc_max64(1, pixels / 4001), figures);
    drawn_vertices(d, camera, &options->frame, figures);
    figures->views++;
}
