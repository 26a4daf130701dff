/* renderer.c - frames of a surface over a clipmap (AH05: heights as vertex textures; the design's section 6).
 *
 * A frame: move the windows within the budget, upload what changed, assemble the surface's draws, one multi-draw of
 * strips and one of crack closers, then the sky where nothing was drawn. Depth is reversed (near / distance in a
 * 32-bit float), positions are relative to the eye. Programs are assembled from the parts that the scene needs and
 * kept for as long as the renderer. */
#include "renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "common/base/status.h"
#include "canvas.h"
#include "level_textures.h"
#include "palette.h"
#include "common/base/clock.h"
#include "scene_programs.h"

enum { SLOTS = 3 }; /* frames whose buffers may be in flight */

/* The uniform block of shaders/frame.glsl. */
typedef struct frame_uniforms {
    float view_projection[16];
    float surface[TC_SURFACE_UNIFORMS];
    float layer[TC_MAX_LAYERS][TC_LAYER_UNIFORMS];
    float window[TC_MAX_LAYERS][4];
    float eye[4];
    float ray[3][4];
    float sun[4];
    float heights[4];
    float haze[4];
    float zenith[4];
    float lens[4];
} frame_uniforms;

struct tc_renderer {
    const tc_gl *gl;
    const tc_field *field;
    tc_surface *surface;
    tc_scene_options options;
    tc_scene_needs needs; /* of the options as they are */
    tc_palette palette;
    tc_level_textures textures;
    GLuint ramp;
    tc_scene_programs programs;
    GLuint vao, vertices, indices;
    GLuint sky_vao; /* of no vertex data at all; 0: no sky */
    GLuint uniforms[SLOTS], draws[SLOTS];
    size_t draw_capacity[SLOTS]; /* draws that draws[] has room for */
    int slot;
    tc_canvas canvas;
    frame_uniforms values;
    tc_frame_stats last; /* frame drawn */
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
};

/* ---- Creation ------------------------------------------------------------------------------------------------ */

static size_t vertex_size(const tc_geometry *g)
{
    return g->format == TC_VERTEX_FLOAT_4 ? 4 * sizeof(float) : 2 * sizeof(uint16_t);
}

static void create_geometry(tc_renderer *r)
{
    const tc_gl *gl = r->gl;
    const tc_geometry *g = &r->surface->geometry;
    gl->CreateBuffers(1, &r->vertices);
    gl->NamedBufferStorage(r->vertices, (GLsizeiptr)((size_t)g->vertex_count * vertex_size(g)), g->vertices, 0);
    gl->CreateBuffers(1, &r->indices);
    gl->NamedBufferStorage(r->indices, (GLsizeiptr)((size_t)g->index_count * sizeof *g->indices), g->indices, 0);
    gl->CreateVertexArrays(1, &r->vao);
    gl->VertexArrayElementBuffer(r->vao, r->indices);
    gl->VertexArrayVertexBuffer(r->vao, 0, r->vertices, 0, (GLsizei)vertex_size(g));
    gl->EnableVertexArrayAttrib(r->vao, 0);
    if (g->format == TC_VERTEX_FLOAT_4)
        gl->VertexArrayAttribFormat(r->vao, 0, 4, GL_FLOAT, GL_FALSE, 0);
    else
        gl->VertexArrayAttribIFormat(r->vao, 0, 2, GL_UNSIGNED_SHORT, 0);
    gl->VertexArrayAttribBinding(r->vao, 0, 0);
    if (r->surface->instances) {
        gl->EnableVertexArrayAttrib(r->vao, 1);
        gl->VertexArrayAttribIFormat(r->vao, 1, 4, GL_INT, 0);
        gl->VertexArrayAttribBinding(r->vao, 1, 1);
        gl->VertexArrayBindingDivisor(r->vao, 1, 1);
    }
    if (r->needs.sky)
        gl->CreateVertexArrays(1, &r->sky_vao);
    gl->CreateBuffers(SLOTS, r->uniforms);
    gl->CreateBuffers(SLOTS, r->draws);
    for (int i = 0; i < SLOTS; i++)
        gl->NamedBufferStorage(r->uniforms[i], sizeof(frame_uniforms), NULL, GL_DYNAMIC_STORAGE_BIT);
}

static void create_ramp(tc_renderer *r)
{
    const tc_gl *gl = r->gl;
    gl->CreateTextures(GL_TEXTURE_1D, 1, &r->ramp);
    gl->TextureStorage1D(r->ramp, 1, GL_RGBA8, TC_RAMP_SIZE);
    gl->TextureParameteri(r->ramp, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl->TextureParameteri(r->ramp, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl->TextureParameteri(r->ramp, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureSubImage1D(r->ramp, 0, 0, TC_RAMP_SIZE, GL_RGBA, GL_UNSIGNED_BYTE, r->palette.ramp);
}

tc_status tc_renderer_create(const tc_gl *gl, tc_surface *surface, const tc_scene_options *options,
                             tc_renderer **renderer_ret, tc_error *error)
{
    tc_renderer *r = calloc(1, sizeof *r);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    r->gl = gl;
    r->field = tc_clipmap_field(surface->clipmap[0]);
    r->surface = surface;
    r->options = *options;
    r->needs = tc_scene_needs_of(options, tc_field_info(r->field), surface->sphere);
    r->palette = tc_palette_make(tc_field_info(r->field));
    tc_status status = tc_scene_programs_build(gl, surface, &r->needs, &r->programs, error);
    if (status) {
        tc_renderer_destroy(r);
        return status;
    }
    create_geometry(r);
    create_ramp(r);
    *renderer_ret = r;
    return TC_OK;
}

void tc_renderer_destroy(tc_renderer *renderer)
{
    if (!renderer)
        return;
    tc_renderer *r = renderer;
    const tc_gl *gl = r->gl;
    tc_level_textures_destroy(gl, &r->textures);
    gl->DeleteTextures(1, &r->ramp);
    tc_scene_programs_destroy(gl, &r->programs);
    gl->DeleteVertexArrays(2, (GLuint[]){r->vao, r->sky_vao});
    gl->DeleteBuffers(2, (GLuint[]){r->vertices, r->indices});
    gl->DeleteBuffers(SLOTS, r->uniforms);
    gl->DeleteBuffers(SLOTS, r->draws);
    tc_canvas_destroy(gl, &r->canvas);
    free(r);
}

void tc_renderer_set_options(tc_renderer *renderer, const tc_scene_options *options)
{
    renderer->options.level_colours = options->level_colours;
    renderer->options.wireframe = options->wireframe;
    renderer->options.frame = options->frame;
    renderer->options.budget = options->budget;
    renderer->needs = tc_scene_needs_of(&renderer->options, tc_field_info(renderer->field), renderer->surface->sphere);
}

/* ---- Frames -------------------------------------------------------------------------------------------------- */

/* Light, air and camera; nothing in it depends on anything but the view. */
static void set_uniforms(tc_renderer *r, const tc_camera *camera, const tc_frame *frame)
{
    frame_uniforms *u = &r->values;
    double z_base = tc_field_info(r->field)->z_base, eye = camera->z - z_base;
    tc_camera_matrix(camera, r->surface->near_plane, u->view_projection);
    memcpy(u->surface, frame->surface_uniforms, sizeof u->surface);
    memcpy(u->layer, frame->layer_uniforms, sizeof u->layer);
    int64_t torus = 2 * (tc_clipmap_n(r->surface->clipmap[0]) + 1);
    int layer = 0;
    for (int chart = 0; chart < r->surface->charts; chart++)
        for (int l = 1; l <= r->textures.layers.held[chart]; l++) {
            tc_rect c = tc_clipmap_level(r->surface->clipmap[chart], l)->clip;
            float window[4] = {(float)(c.x0 & (torus - 1)), (float)(c.y0 & (torus - 1)), (float)(c.x1 - 1 - c.x0),
                               (float)(c.y1 - 1 - c.y0)};
            memcpy(u->window[layer++], window, sizeof window);
        }
    u->eye[0] = (float)eye;
    u->eye[1] = (float)(eye - (double)(float)eye);
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    for (int i = 0; i < 3; i++) {
        u->ray[0][i] = (float)(b.right[i] * tx);
        u->ray[1][i] = (float)(b.up[i] * ty);
        u->ray[2][i] = (float)b.forward[i];
    }
    memcpy(u->heights, r->palette.heights, sizeof u->heights);
    const double azimuth = 310 * M_PI / 180, elevation = 38 * M_PI / 180; /* the cartographer's light, a bit softer */
    float sun[4] = {(float)(sin(azimuth) * cos(elevation)), (float)(cos(azimuth) * cos(elevation)),
                    (float)sin(elevation), 1.1f};
    memcpy(u->sun, sun, sizeof sun);
    double height = fmax(0, eye - tc_field_info(r->field)->z_min);
    double distance = 0.65 * r->surface->extent + 4 * height; /* half of what one sees there is haze */
    memcpy(u->haze, r->palette.horizon, sizeof r->palette.horizon);
    u->haze[3] = (float)(r->surface->near_plane / distance);
    if (r->surface->sphere) /* whose own part knows how far one sees */
        u->haze[3] = (float)r->surface->near_plane;
    memcpy(u->zenith, r->palette.zenith, sizeof r->palette.zenith);
    float lens[4] = {(float)(2 * tx / camera->width), (float)(2 * ty / camera->height), (float)tx, (float)ty};
    memcpy(u->lens, lens, sizeof lens);
}

/* Bytes of a draw in the buffer. */
static size_t draw_size(const tc_renderer *r)
{
    return sizeof(tc_draw) + (r->surface->instances ? sizeof(tc_instance) : 0);
}

/* The frame's draws and instances in one buffer: [draws][instances]. */
static void upload_draws(tc_renderer *r, const tc_frame *frame)
{
    const tc_gl *gl = r->gl;
    size_t count = (size_t)(frame->strip_draws + frame->list_draws), *capacity = &r->draw_capacity[r->slot];
    GLuint buffer = r->draws[r->slot];
    if (count > *capacity) {
        *capacity = count + count / 2;
        gl->NamedBufferData(buffer, (GLsizeiptr)(*capacity * draw_size(r)), NULL, GL_DYNAMIC_DRAW);
    }
    if (!count)
        return;
    gl->NamedBufferSubData(buffer, 0, (GLsizeiptr)(count * sizeof(tc_draw)), frame->draws);
    if (r->surface->instances) {
        GLintptr instances = (GLintptr)(*capacity * sizeof(tc_draw));
        gl->NamedBufferSubData(buffer, instances, (GLsizeiptr)(count * sizeof(tc_instance)), frame->instances);
        gl->VertexArrayVertexBuffer(r->vao, 1, buffer, instances, sizeof(tc_instance));
    }
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffer);
}

static void draw(tc_renderer *r, const tc_frame *frame)
{
    const tc_gl *gl = r->gl;
    const uint8_t *bg = r->options.background;
    gl->BindFramebuffer(GL_FRAMEBUFFER, r->canvas.framebuffer);
    gl->Viewport(0, 0, r->canvas.width, r->canvas.height);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->ClearNamedFramebufferfv(r->canvas.framebuffer, GL_DEPTH, 0, (float[]){0});
    if (!r->needs.sky)
        gl->ClearNamedFramebufferfv(r->canvas.framebuffer, GL_COLOR, 0,
                                    (float[]){(float)bg[0] / 255, (float)bg[1] / 255, (float)bg[2] / 255, 1});
    gl->NamedBufferSubData(r->uniforms[r->slot], 0, sizeof r->values, &r->values);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, r->uniforms[r->slot]);
    gl->BindTextureUnit(0, tc_level_texture_of(&r->textures, &tc_heights_content).texture);
    gl->BindTextureUnit(1, r->ramp);
    gl->BindTextureUnit(2, tc_level_texture_of(&r->textures, &tc_normals_content).texture);
    gl->BindTextureUnit(3, tc_level_texture_of(&r->textures, &tc_voids_content).texture);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_GREATER);
    gl->BindVertexArray(r->vao);
    const GLuint *terrain = r->programs.terrain[r->needs.level_colours];
    gl->UseProgram(terrain[0]);
    gl->PolygonMode(GL_FRONT_AND_BACK, r->options.wireframe ? GL_LINE : GL_FILL);
    gl->Enable(GL_PRIMITIVE_RESTART_FIXED_INDEX); /* TC_RESTART */
    gl->FrontFace(GL_CW);
    if (frame->one_sided && !r->options.wireframe)
        gl->Enable(GL_CULL_FACE);
    if (frame->strip_draws)
        gl->MultiDrawElementsIndirect(GL_TRIANGLE_STRIP, GL_UNSIGNED_SHORT, NULL, frame->strip_draws, 0);
    gl->Disable(GL_CULL_FACE);
    if (frame->list_draws && !r->options.wireframe) {
        gl->UseProgram(terrain[1]);
        gl->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                      (const void *)((size_t)frame->strip_draws * sizeof(tc_draw)), frame->list_draws,
                                      0);
    }
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    if (r->needs.sky) {
        gl->DepthFunc(GL_GEQUAL); /* depth 0 is infinity: where nothing was drawn */
        gl->BindVertexArray(r->sky_vao);
        gl->UseProgram(r->programs.sky);
        gl->DrawArrays(GL_TRIANGLES, 0, 3);
    }
    tc_canvas_resolve(gl, &r->canvas);
}

/* Room for the levels that the view asks for; where nothing is to be culled, of all charts. */
static tc_status hold_levels(tc_renderer *r, tc_error *error)
{
    int levels[TC_MAX_CHARTS];
    for (int chart = 0; chart < r->surface->charts; chart++) {
        int l = tc_clipmap_levels(r->surface->clipmap[chart]), least = r->options.frame.no_cull ? 1 : 0;
        while (l > least && tc_rect_empty(r->wanted[chart][l - 1]))
            l--;
        levels[chart] = l;
    }
    return tc_level_textures_hold(r->gl, &r->textures, r->surface->clipmap, r->surface->charts, levels, error);
}

tc_status tc_renderer_frame(tc_renderer *renderer, const tc_camera *camera, bool finish, tc_frame_stats *stats_ret,
                            tc_error *error)
{
    tc_renderer *r = renderer;
    tc_status status = tc_canvas_resize(r->gl, &r->canvas, camera->width, camera->height, r->options.samples, error);
    if (!status)
        status = tc_scene_programs_build(r->gl, r->surface, &r->needs, &r->programs, error);
    if (status)
        return status;
    double start = tc_clock_ms();
    tc_surface *surface = r->surface;
    int64_t n = tc_clipmap_n(surface->clipmap[0]), budget = r->options.budget ? r->options.budget : n * n;
    tc_frame_stats stats = {.resident = true};
    surface->wanted(surface, camera, r->wanted);
    for (int chart = 0; chart < surface->charts; chart++) { /* each gets at least what makes progress */
        int64_t share = budget < 0 ? -1 : tc_max64(n, budget - stats.samples_updated);
        stats.samples_updated +=
            tc_clipmap_update(surface->clipmap[chart], r->wanted[chart], share, finish, 1e-3 * start);
        stats.resident &= tc_clipmap_resident(surface->clipmap[chart]);
        stats.failed |= tc_clipmap_failed(surface->clipmap[chart]) != TC_OK;
    }
    status = hold_levels(r, error);
    if (status)
        return status;
    /* All of what was filled now, and as much again of what another reader had filled before; for a picture, all. */
    stats.bytes_uploaded = tc_level_textures_upload(r->gl, &r->textures, surface->clipmap, surface->charts,
                                                    finish || budget < 0 ? -1 : stats.samples_updated + budget);
    for (int chart = 0; chart < surface->charts; chart++)
        stats.resident &= r->textures.layers.ready[chart] == r->textures.layers.held[chart];
    double updated = tc_clock_ms();

    tc_frame frame;
    surface->frame(surface, camera, &r->options.frame, &r->textures.layers, &frame);
    r->slot = (r->slot + 1) % SLOTS;
    set_uniforms(r, camera, &frame);
    upload_draws(r, &frame);
    draw(r, &frame);
    if (finish)
        r->gl->Finish();
    stats.update_ms = updated - start;
    stats.draw_ms = tc_clock_ms() - updated;
    stats.triangles = frame.triangles;
    stats.triangles_unculled = frame.triangles_unculled;
    stats.draws = frame.strip_draws + frame.list_draws;
    stats.blocks = frame.strip_draws;
    stats.blocks_unculled = frame.draws_unculled;
    stats.levels_active = frame.levels_active;
    stats.levels_fine = frame.levels_fine;
    stats.levels_beyond = frame.levels_beyond;
    *stats_ret = r->last = stats;
    return finish && stats.failed ? tc_fail(error, TC_ERR_IO, "terrain: a part of it cannot be read") : TC_OK;
}

void tc_renderer_present(tc_renderer *renderer, int window_width, int window_height)
{
    const tc_gl *gl = renderer->gl;
    const tc_canvas *c = &renderer->canvas;
    /* A driver looks how large the window has become when its framebuffer is bound, and some when the viewport is set.
     */
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl->Viewport(0, 0, window_width, window_height);
    gl->BlitNamedFramebuffer(c->picture, 0, 0, 0, c->width, c->height, 0, 0, window_width, window_height,
                             GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void tc_renderer_read(tc_renderer *renderer, uint8_t *rgb, float *depth)
{
    tc_canvas_read(renderer->gl, &renderer->canvas, rgb, depth);
}

void tc_renderer_memory(const tc_renderer *renderer, tc_memory_stats *stats_ret)
{
    const tc_geometry *g = &renderer->surface->geometry;
    const tc_level_textures *t = &renderer->textures;
    size_t draws = 0, heights = 0, normals = 0, fields = 0;
    for (int chart = 0; chart < renderer->surface->charts; chart++) {
        size_t h, n;
        tc_ground_bytes(renderer->surface->clipmap[chart], &h, &n);
        heights += h, normals += n;
        fields += tc_field_bytes(tc_clipmap_field(renderer->surface->clipmap[chart]));
    }
    for (int i = 0; i < SLOTS; i++)
        draws += renderer->draw_capacity[i] * draw_size(renderer) + sizeof(frame_uniforms);
    *stats_ret = (tc_memory_stats){.geometry = (size_t)g->vertex_count * vertex_size(g) +
                                               (size_t)g->index_count * sizeof *g->indices + draws,
                                   .heights = tc_level_texture_of(t, &tc_heights_content).bytes +
                                              tc_level_texture_of(t, &tc_voids_content).bytes + heights,
                                   .normals = tc_level_texture_of(t, &tc_normals_content).bytes + normals,
                                   .field = fields};
}

tc_renderer_use tc_renderer_used(const tc_renderer *renderer)
{
    return (tc_renderer_use){.surface = renderer->surface,
                             .needs = &renderer->needs,
                             .programs = &renderer->programs,
                             .textures = &renderer->textures,
                             .frame = &renderer->last};
}
