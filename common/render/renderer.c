/* renderer.c - frames of a surface over a clipmap (AH05: heights as vertex textures; the design's section 6).
 *
 * A frame: move the windows within the budget, upload what changed, assemble the surface's draws, one multi-draw of
 * blocks and one of crack closers, then the sky where nothing was drawn. Positions are relative to the eye. What views
 * share is in scene_objects.c, the frame's numbers in frame_uniforms.c, where it is drawn in target.c. */
#include "renderer.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/clock.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/content/colours.h"
#include "draw_state.h"
#include "drape.h"
#include "frame_slots.h"
#include "frame_uniforms.h"
#include "picture.h"
#include "scene_objects.h"

struct tc_renderer {
    const tc_gl *gl;
    const tc_surface *surface;
    tc_windows windows;
    tc_scene_options options;
    tc_scene_needs needs; /* of the options as they are */
    tc_scene_objects *objects;
    tc_upload_ring ring; /* of both of the next */
    tc_level_textures textures;
    tc_drape drape; /* where the scene has imagery */
    tc_frame_slots slots;
    tc_picture picture; /* drawn into where no target is given */
    tc_frame_uniforms values;
    tc_frame_stats last; /* frame drawn */
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    tc_view *view; /* of that frame; without a surface: none yet */
    tc_frame frame;
};

/* ---- Creation ------------------------------------------------------------------------------------------------ */

static tc_status make_own(tc_renderer *r, tc_error *error)
{
    r->view = tc_view_allocate(r->surface);
    if (!r->view || !tc_frame_allocate(r->surface, &r->frame))
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    return r->surface->make_windows(r->surface, &r->windows, error);
}

static tc_status make_ring(tc_renderer *r, tc_error *error)
{
    const int asked = r->options.ring;
    if (asked < 0 || (asked == 0 && !tc_upload_ring_pays(r->gl)))
        return TC_OK;
    tc_status status = tc_upload_ring_create(r->gl, &r->ring, error);
    r->textures.ring = &r->ring;
    return status;
}

static tc_status make_drape(tc_renderer *r, tc_error *error)
{
    enum { TAPS = 4 };
    if (!r->needs.imagery)
        return TC_OK;
    tc_status status = tc_drape_create(r->gl, r->options.imagery, r->surface, &r->drape, error);
    r->drape.textures.ring = r->textures.ring;
    if (status == TC_OK) {
        r->needs.image_n = tc_clipmap_n(r->drape.windows.clipmap[0]);
        r->needs.image_taps = TAPS, r->needs.image_filter = (int)r->drape.textures.anisotropy;
    }
    return status;
}

static tc_status build_programs(tc_renderer *r, const tc_scene_needs *needs, tc_error *error)
{
    return tc_scene_programs_build(r->gl, r->surface, tc_scene_closers(r->surface, &r->windows), needs,
                                   &r->objects->programs, error);
}

static tc_status make_objects(tc_renderer *r, tc_error *error)
{
    tc_status status = tc_scene_objects_create(r->gl, r->surface, &r->options, &r->objects, error);
    return status == TC_OK ? build_programs(r, &r->needs, error) : status;
}

static tc_status create(const tc_gl *gl, const tc_surface *surface, const tc_scene_options *options,
                        tc_scene_objects *shared, tc_renderer **renderer_ret, tc_error *error)
{
    tc_renderer *r = calloc(1, sizeof *r);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "renderer: not enough memory");
    r->gl = gl;
    r->surface = surface;
    r->options = *options;
    r->picture = (tc_picture){.target.class = &tc_picture_class, .samples = options->samples};
    r->needs = tc_scene_needs_of(options, tc_field_info(surface->field));
    if (shared)
        r->objects = tc_scene_objects_share(shared);
    tc_status status = make_own(r, error);
    if (status == TC_OK)
        status = make_ring(r, error);
    if (status == TC_OK)
        status = make_drape(r, error);
    if (status == TC_OK && !shared)
        status = make_objects(r, error);
    if (status == TC_OK)
        status = tc_frame_slots_create(gl, surface, r->objects, &r->slots, error);
    if (status == TC_OK)
        *renderer_ret = r;
    else
        tc_renderer_destroy(r);
    return status;
}

tc_status tc_renderer_create(const tc_gl *gl, const tc_surface *surface, const tc_scene_options *options,
                             tc_renderer **renderer_ret, tc_error *error)
{
    return create(gl, surface, options, NULL, renderer_ret, error);
}

tc_status tc_renderer_create_with(const tc_gl *gl, tc_scene_objects *objects, const tc_scene_options *options,
                                  tc_renderer **renderer_ret, tc_error *error)
{
    return create(gl, objects->surface, options, objects, renderer_ret, error);
}

tc_scene_objects *tc_renderer_objects(const tc_renderer *renderer)
{
    return renderer->objects;
}

void tc_renderer_destroy(tc_renderer *renderer)
{
    if (!renderer)
        return;
    tc_renderer *r = renderer;
    tc_level_textures_destroy(r->gl, &r->textures);
    tc_drape_destroy(r->gl, &r->drape);
    tc_upload_ring_destroy(r->gl, &r->ring);
    tc_frame_slots_destroy(r->gl, &r->slots);
    tc_scene_objects_release(r->gl, r->objects);
    tc_canvas_destroy(r->gl, &r->picture.canvas);
    tc_windows_destroy(&r->windows);
    tc_frame_free(&r->frame);
    free(r->view);
    free(r);
}

void tc_renderer_set_samples(tc_renderer *renderer, int samples)
{
    renderer->picture.samples = samples;
}

void tc_renderer_set_options(tc_renderer *renderer, const tc_scene_options *options)
{
    renderer->options.level_colours = options->level_colours;
    renderer->options.wireframe = options->wireframe;
    renderer->options.sun = options->sun;
    renderer->options.frame = options->frame;
    renderer->options.budget = options->budget;
    renderer->options.budget_us = options->budget_us;
    renderer->options.ahead = options->ahead;
    const tc_scene_needs before = renderer->needs;
    renderer->needs = tc_scene_needs_of(&renderer->options, tc_field_info(renderer->surface->field));
    renderer->needs.image_n = before.image_n;
    renderer->needs.image_taps = before.image_taps, renderer->needs.image_filter = before.image_filter;
}

/* ---- Drawing ------------------------------------------------------------------------------------------------- */

/* A number as shown as the target holds it. */
static float encoded(uint8_t shown, tc_encoding encoding)
{
    double c = shown / 255.0;
    if (encoding != TC_ENCODING_SHOWN)
        return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
    return (float)shown / 255;
}

static void clear(const tc_renderer *r, const tc_target_place *place)
{
    const uint8_t *bg = r->options.background;
    const float colour[] = {encoded(bg[0], place->encoding), encoded(bg[1], place->encoding),
                            encoded(bg[2], place->encoding), 1};
    r->gl->ClearBufferfv(GL_DEPTH, 0, &tc_depth_convention_of(place->depth)->farthest);
    if (!r->needs.sky)
        r->gl->ClearBufferfv(GL_COLOR, 0, colour);
}

static tc_level_texture normals_of(const tc_renderer *r)
{
    return tc_level_texture_of(&r->textures, r->needs.fine_normals ? &tc_fine_normals_content : &tc_normals_content);
}

/* Textures by the binding points of the shaders. One that is not kept is not asked for: binding none to a unit would
 * take away all of a host's. */
static void bind_textures(const tc_renderer *r)
{
    const GLuint textures[] = {tc_level_texture_of(&r->textures, &tc_heights_content).texture, r->objects->ramp,
                               normals_of(r).texture, tc_level_texture_of(&r->textures, &tc_voids_content).texture,
                               tc_level_texture_of(&r->drape.textures, &tc_colours_content).texture};
    for (GLuint i = 0; i < sizeof textures / sizeof *textures; i++)
        if (textures[i])
            r->gl->BindTextureUnit(i, textures[i]);
}

static void draw_terrain(const tc_renderer *r, const GLuint programs[TC_PROGRAM_KINDS], const tc_frame *frame)
{
    const tc_gl *gl = r->gl;
    const GLenum index = r->objects->index_type;
    gl->UseProgram(programs[TC_DRAWS_BLOCKS]);
    gl->PolygonMode(GL_FRONT_AND_BACK, r->options.wireframe ? GL_LINE : GL_FILL);
    if (frame->one_sided && !r->options.wireframe)
        gl->Enable(GL_CULL_FACE);
    if (frame->strip_draws)
        gl->MultiDrawElementsIndirect(GL_TRIANGLES, index, NULL, frame->strip_draws, 0);
    gl->Disable(GL_CULL_FACE);
    if (frame->list_draws && !r->options.wireframe) {
        gl->UseProgram(programs[TC_DRAWS_CLOSERS]);
        gl->MultiDrawElementsIndirect(GL_TRIANGLES, index, (const void *)((size_t)frame->strip_draws * sizeof(tc_draw)),
                                      frame->list_draws, 0);
    }
    if (frame->wall_draws) {
        const size_t first = (size_t)(frame->strip_draws + frame->list_draws);
        gl->UseProgram(programs[TC_DRAWS_WALLS]);
        gl->MultiDrawArraysIndirect(GL_TRIANGLE_STRIP, (const void *)(first * sizeof(tc_draw)), frame->wall_draws,
                                    sizeof(tc_draw));
    }
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

/* Around a flat terrain, to the horizon: shaders/sea.glsl. */
static void draw_sea(const tc_renderer *r, GLuint program)
{
    enum { VERTICES = 10 };
    r->gl->BindVertexArray(r->slots.sky_vertex_array);
    r->gl->UseProgram(program);
    r->gl->DrawArrays(GL_TRIANGLE_STRIP, 0, VERTICES);
}

static void draw(const tc_renderer *r, const tc_scene_needs *needs, const tc_target_place *place,
                 const tc_frame_slot *slot, const tc_frame *frame)
{
    const tc_gl *gl = r->gl;
    const tc_scene_programs *programs = &r->objects->programs;
    if (place->clear)
        clear(r, place);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, slot->uniforms);
    bind_textures(r);
    gl->BindVertexArray(slot->vertex_array);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, slot->draws);
    draw_terrain(r, programs->terrain[tc_program_variant(needs)], frame);
    if (needs->sea)
        draw_sea(r, programs->terrain[tc_program_variant(needs)][TC_DRAWS_SEA]);
    if (needs->sky) { /* where nothing was drawn */
        gl->DepthFunc(tc_depth_convention_of(place->depth)->not_beyond);
        gl->BindVertexArray(r->slots.sky_vertex_array);
        gl->UseProgram(programs->sky[needs->linear]);
        gl->DrawArrays(GL_TRIANGLES, 0, 3);
    }
}

/* ---- Frames -------------------------------------------------------------------------------------------------- */

/* Room for the levels that the view asks for; where nothing is to be culled, of all charts. */
static tc_status hold_levels(tc_renderer *r, tc_error *error)
{
    int levels[TC_MAX_CHARTS];
    for (int chart = 0; chart < r->windows.charts; chart++) {
        int l = tc_clipmap_levels(r->windows.clipmap[chart]), least = r->options.frame.no_cull ? 1 : 0;
        while (l > least && tc_rect_empty(r->wanted[chart][l - 1]))
            l--;
        levels[chart] = l;
    }
    return tc_level_textures_hold(r->gl, &r->textures, r->windows.clipmap, r->windows.charts, levels, error);
}

/* The time that a frame's update has, from its beginning; what it is used for, one after the other, ends at shares of
 * it. No limit: 0. */
typedef struct update_time {
    double start, limit; /* milliseconds */
} update_time;

enum { USUAL_BUDGET_US = 4000 };

static const double FILLING = 0.7; /* the rest is for uploading */

static update_time time_of(const tc_scene_options *o, bool finish)
{
    const int64_t us = o->budget_us ? o->budget_us : o->budget ? -1 : USUAL_BUDGET_US;
    return (update_time){tc_clock_ms(), finish || us < 0 ? 0 : 1e-3 * (double)us};
}

static double until(const update_time *t, double share)
{
    return t->limit > 0 ? t->start + share * t->limit : 0;
}

/* Moves the windows towards what the view wants and uploads what is new. */
static tc_status update(tc_renderer *r, const tc_sight *sight, bool finish, tc_frame_stats *stats, tc_error *error)
{
    const update_time time = time_of(&r->options, finish);
    const tc_surface *surface = r->surface;
    int64_t n = surface->n, budget = r->options.budget ? r->options.budget : n * n;
    const double own = r->needs.imagery ? 0.5 : 1; /* share of the surface's windows */
    tc_update move = {.wait = finish,
                      .now = 1e-3 * time.start,
                      .ahead = r->options.ahead == 0 ? 1 : fmax(r->options.ahead, 0),
                      .until = until(&time, FILLING * own)};
    tc_frame_options options = r->options.frame;
    options.two_sided |= r->options.wireframe;
    options.walls = r->needs.walls;
    options.foot = r->needs.around.foot, options.shore = r->needs.sea ? r->needs.around.level : -INFINITY;
    if (!options.cull_camera && !sight->through)
        options.cull_camera = &sight->around;
    surface->look(surface, &r->windows, &sight->camera, &options, finish, r->view);
    surface->wanted(r->view, r->wanted);
    for (int chart = 0; chart < r->windows.charts; chart++) { /* each gets at least what makes progress */
        move.budget = budget < 0 ? -1 : tc_max64(n, budget - stats->samples_updated);
        stats->samples_updated += tc_clipmap_update_as(r->windows.clipmap[chart], r->wanted[chart], &move);
        stats->resident &= tc_clipmap_resident(r->windows.clipmap[chart]);
        stats->failed |= tc_clipmap_failed(r->windows.clipmap[chart]) != TC_OK;
    }
    tc_draw_state_for_uploads(r->gl);
    tc_upload_ring_begin(r->gl, &r->ring);
    tc_status status = hold_levels(r, error);
    if (status == TC_OK) {
        /* All of what was filled now, and as much again of what a frame before could not be given; for a picture, all.
         */
        stats->bytes_uploaded =
            tc_level_textures_upload(r->gl, &r->textures, r->windows.clipmap, r->windows.charts,
                                     finish || budget < 0 ? -1 : stats->samples_updated + budget, until(&time, own));
        for (int chart = 0; chart < r->windows.charts; chart++)
            stats->resident &= r->textures.layers.ready[chart] == r->textures.layers.held[chart];
    }
    if (status == TC_OK && r->needs.imagery) {
        /* As many texels to a sample as windows have. */
        move.budget = budget < 0 ? -1 : budget * (r->needs.image_n + 1) / (n + 1);
        move.until = until(&time, own + FILLING * (1 - own));
        tc_drape_update u;
        status = tc_drape_move(r->gl, &r->drape, r->view, &move, until(&time, 1), &u, error);
        if (status == TC_OK) {
            stats->bytes_uploaded += u.bytes;
            stats->texels_updated = u.texels;
            stats->resident &= u.resident;
            stats->imagery_failed = u.failed;
        }
    }
    tc_upload_ring_end(r->gl, &r->ring);
    stats->update_ms = tc_clock_ms() - time.start;
    return status;
}

/* What a frame in this place needs beyond what the scene does. */
static tc_scene_needs frame_needs(const tc_renderer *r, const tc_target_place *place, const tc_sight *sight)
{
    tc_scene_needs needs = r->needs;
    needs.multisampled = place->samples > 1;
    needs.linear = place->encoding != TC_ENCODING_SHOWN;
    needs.by_w = !sight->inverse;
    needs.throttled = r->surface->throttled_stage && r->options.frame.throttle > 0;
    return needs;
}

/* The frame's programs. Where frames may be throttled, those of both kinds at once, or one would be late some day. */
static tc_status build_frame_programs(tc_renderer *r, const tc_scene_needs *needs, tc_error *error)
{
    tc_status status = build_programs(r, needs, error);
    tc_scene_needs other = *needs;
    other.throttled = !needs->throttled;
    if (status == TC_OK && needs->throttle && r->surface->throttled_stage)
        status = build_programs(r, &other, error);
    return status;
}

/* The target is as it says and of the size that it is seen by. */
static tc_status begin(const tc_gl *gl, tc_target *target, const tc_sight *sight, tc_error *error)
{
    const tc_camera *c = &sight->camera;
    tc_status status = TC_OK;
    if (!target->class || !target->class->begin)
        status = tc_target_check(gl, &target->place, error);
    else
        status = target->class->begin(target, gl, c->width, c->height, error);
    if (status == TC_OK && (c->width != target->place.width || c->height != target->place.height))
        status = tc_fail(error, TC_ERR_USAGE, "target: expected %d x %d pixels as the camera has, found %d x %d",
                         c->width, c->height, target->place.width, target->place.height);
    return status;
}

static void count(const tc_frame *frame, tc_frame_stats *stats)
{
    stats->triangles = frame->triangles;
    stats->triangles_unculled = frame->triangles_unculled;
    stats->draws = frame->strip_draws + frame->list_draws;
    stats->wall_draws = frame->wall_draws, stats->wall_triangles = frame->wall_triangles;
    stats->blocks = frame->strip_draws;
    stats->blocks_unculled = frame->draws_unculled;
    memcpy(stats->blocks_of, frame->blocks, sizeof stats->blocks_of);
    stats->error_bound = frame->error_bound;
    stats->levels_active = frame->levels_active;
    stats->levels_fine = frame->levels_fine;
    stats->levels_beyond = frame->levels_beyond;
}

static tc_status draw_into(tc_renderer *r, tc_target *target, const tc_sight *sight, bool finish, tc_frame_stats *stats,
                           tc_error *error)
{
    const tc_gl *gl = r->gl;
    tc_status status = begin(gl, target, sight, error);
    if (status)
        return status;
    const tc_scene_needs needs = frame_needs(r, &target->place, sight);
    status = build_frame_programs(r, &needs, error);
    if (status == TC_OK)
        status = update(r, sight, finish, stats, error);
    if (status == TC_OK && finish && stats->failed)
        status = tc_fail(error, TC_ERR_IO, "terrain: a part of it cannot be read");
    if (status == TC_OK && finish && stats->imagery_failed && !(status = tc_imagery_failed(r->options.imagery, error)))
        status = tc_fail(error, TC_ERR_IO, "imagery: a part of it cannot be read");
    if (status)
        return status;
    double updated = tc_clock_ms();
    const tc_frame_slot *slot;
    memset(r->frame.blocks, 0, sizeof r->frame.blocks);
    r->frame.error_bound = INFINITY;
    r->frame.wall_draws = 0, r->frame.wall_triangles = 0;
    r->surface->draws(r->view, &r->textures.layers, &r->frame);
    tc_frame_uniforms_set(&r->values, r->view, &r->objects->palette, sight, &target->place, &r->frame,
                          &r->textures.layers, &needs, r->options.contours, tc_scene_exaggeration(&r->options),
                          &r->options.sun);
    if (needs.imagery)
        tc_drape_uniforms(&r->drape, r->view, &r->values);
    status = tc_frame_slots_fill(gl, &r->slots, &r->values, &r->frame, &slot, error);
    if (status)
        return status;
    tc_draw_state_for_frame(gl, &target->place, target->whole, sight->mirrored);
    draw(r, &needs, &target->place, slot, &r->frame);
    tc_frame_slots_drawn(gl, &r->slots);
    if (target->class && target->class->end)
        status = target->class->end(target, gl, error);
    if (finish)
        gl->Finish();
    stats->draw_ms = tc_clock_ms() - updated;
    count(&r->frame, stats);
    stats->tolerance = r->surface->by_error ? r->view->options.error : 0;
    stats->throttle = fmin(fmax(r->view->options.throttle, 0), r->surface->most_throttle);
    return status;
}

tc_status tc_renderer_draw(tc_renderer *renderer, tc_target *target, const tc_sight *sight, bool finish,
                           tc_frame_stats *stats_ret, tc_error *error)
{
    tc_draw_state host;
    tc_frame_stats stats = {.resident = true};
    bool keep = target->place.keep_state;
    if (keep)
        tc_draw_state_get(renderer->gl, &host);
    tc_status status = draw_into(renderer, target, sight, finish, &stats, error);
    if (keep)
        tc_draw_state_give_back(renderer->gl, &host);
    if (status == TC_OK)
        *stats_ret = renderer->last = stats;
    return status;
}

tc_status tc_renderer_frame(tc_renderer *renderer, const tc_camera *camera, bool finish, tc_frame_stats *stats_ret,
                            tc_error *error)
{
    const tc_sight sight = tc_sight_through(camera, TC_DEPTH_REVERSED, renderer->surface->near_plane);
    return tc_renderer_draw(renderer, &renderer->picture.target, &sight, finish, stats_ret, error);
}

void tc_renderer_present(tc_renderer *renderer, int window_width, int window_height)
{
    const tc_gl *gl = renderer->gl;
    const tc_canvas *c = &renderer->picture.canvas;
    /* A driver looks how large the window has become when its framebuffer is bound, and some when the viewport is set.
     */
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl->Viewport(0, 0, window_width, window_height);
    gl->BlitNamedFramebuffer(c->picture, 0, 0, 0, c->width, c->height, 0, 0, window_width, window_height,
                             GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void tc_renderer_read(tc_renderer *renderer, uint8_t *rgb, float *depth)
{
    tc_canvas_read(renderer->gl, &renderer->picture.canvas, rgb, depth);
}

void tc_renderer_memory(const tc_renderer *renderer, tc_memory_stats *stats_ret)
{
    const tc_scene_objects *o = renderer->objects;
    const tc_level_textures *t = &renderer->textures;
    size_t heights = 0, normals = 0, fields = 0;
    for (int chart = 0; chart < renderer->windows.charts; chart++) {
        size_t h, n;
        tc_ground_bytes(renderer->windows.clipmap[chart], &h, &n);
        heights += h, normals += n;
        fields += tc_field_tell(tc_clipmap_field(renderer->windows.clipmap[chart])).bytes;
    }
    *stats_ret = (tc_memory_stats){.geometry = o->bytes + tc_frame_slots_bytes(&renderer->slots) +
                                               tc_upload_ring_bytes(&renderer->ring),
                                   .heights = tc_level_texture_of(t, &tc_heights_content).bytes +
                                              tc_level_texture_of(t, &tc_voids_content).bytes + heights,
                                   .normals = normals_of(renderer).bytes + normals,
                                   .imagery = renderer->needs.imagery ? tc_drape_bytes(&renderer->drape) : 0,
                                   .field = fields};
}

tc_renderer_use tc_renderer_used(const tc_renderer *renderer)
{
    return (tc_renderer_use){.surface = renderer->surface,
                             .needs = &renderer->needs,
                             .programs = &renderer->objects->programs,
                             .textures = &renderer->textures,
                             .windows = &renderer->windows,
                             .drape = renderer->needs.imagery ? &renderer->drape : NULL,
                             .frame = &renderer->last};
}

const tc_view *tc_renderer_view(const tc_renderer *renderer)
{
    return renderer->view->surface ? renderer->view : NULL;
}
