/* viewer_scene.c - a viewer's surface, whose size follows the frame's and what the driver has room for. */
#include "viewer_internal.h"

const tc_scheme *tc_viewer_scheme(const tc_viewer *v)
{
    return v->options.scheme ? v->options.scheme : tc_scheme_at(v->program->schemes, NULL, 0);
}

static tc_surface_request request_of(const tc_viewer *v)
{
    return (tc_surface_request){.n = v->options.n,
                                .levels = v->options.levels,
                                .error = v->options.scene.frame.error,
                                .map = v->map,
                                .steps = v->options.steps,
                                .halvings = v->halvings,
                                .camera = &v->camera};
}

/* One halving more; whether that makes the surface smaller. */
static bool halve(tc_viewer *v)
{
    const tc_surface_request before = request_of(v);
    v->halvings++;
    const tc_surface_request after = request_of(v);
    return tc_viewer_scheme(v)->size(&after) < tc_viewer_scheme(v)->size(&before);
}

void tc_viewer_destroy_scene(tc_viewer *v)
{
    tc_renderer_destroy(v->renderer);
    v->renderer = NULL;
    if (v->surface)
        v->surface->destroy(v->surface);
    v->surface = NULL;
}

static tc_status make(tc_viewer *v, tc_error *error)
{
    const tc_scene_needs needs = tc_scene_needs_of(&v->scene, tc_field_info(tc_map_field(v->map, 0)));
    tc_surface_request request = request_of(v);
    request.needs = &needs;
    tc_viewer_destroy_scene(v);      /* there may not be room for both */
    v->shown = (struct tc_shown){0}; /* the next renderer may lie where this one lay */
    v->surface_size = tc_viewer_scheme(v)->size(&request);
    const tc_scheme *scheme = tc_viewer_scheme(v);
    tc_status status = scheme->create(scheme, v->map, &request, &v->surface, error);
    if (status == TC_OK)
        status = tc_renderer_create(v->gl, v->surface, &v->scene, &v->renderer, error);
    return status;
}

/* Whether the textures of all windows, which are as large as the windows, would leave a GPU that tells how much memory
 * it has free less than a quarter of that. */
static bool fills_the_gpu(const tc_viewer *v)
{
    int64_t free = tc_gl_free_memory(v->gl);
    tc_memory_stats windows;
    tc_renderer_memory(v->renderer, &windows);
    return free > 0 && (int64_t)(windows.heights + windows.normals + windows.imagery) > free / 4 * 3;
}

tc_status tc_viewer_make_surface(tc_viewer *v, tc_error *error)
{
    tc_status status = make(v, error);
    while ((status == TC_ERR_MEMORY || (status == TC_OK && fills_the_gpu(v))) && halve(v))
        status = make(v, error);
    return status;
}

/* Draws the heights that the map has now, after what changed them; the error is that of the first failure. */
static tc_status draw_heights(tc_viewer *v, tc_status status, tc_error *error)
{
    tc_error unused;
    v->options.exaggeration = v->scene.exaggeration = v->map->exaggeration;
    v->options.sea = v->scene.sea = v->map->sea;
    if (status == TC_OK)
        status = tc_viewer_look_around(v, error);
    v->scene.around = v->around;
    v->halvings = 0;
    tc_status made = tc_viewer_make_surface(v, status == TC_OK ? error : &unused);
    if (status == TC_OK && made == TC_OK) {
        const tc_camera *c = &v->camera;
        tc_viewer_place(v, &(tc_pose){c->x, c->y, c->z, c->heading, c->pitch});
    }
    return status == TC_OK ? made : status;
}

tc_status tc_viewer_exaggerate(tc_viewer *v, double factor, tc_error *error)
{
    if (factor == v->map->exaggeration)
        return TC_OK;
    tc_viewer_destroy_scene(v); /* which looks at the fields that there are */
    return draw_heights(v, tc_map_exaggerate(v->map, factor, error), error);
}

tc_status tc_viewer_flood(tc_viewer *v, tc_sea sea, tc_error *error)
{
    if (sea.kind == v->map->sea.kind && sea.level == v->map->sea.level)
        return TC_OK;
    tc_viewer_destroy_scene(v); /* as above */
    return draw_heights(v, tc_map_flood(v->map, sea, error), error);
}

void tc_viewer_throttle(tc_viewer *v, double frame_ms)
{
    if (v->options.target_ms <= 0)
        return;
    const double before = v->scene.frame.throttle;
    v->scene.frame.throttle = tc_throttle_step(&v->throttle, frame_ms, v->surface->most_throttle);
    if (v->scene.frame.throttle != before) /* or each frame would settle anew what its scene needs */
        tc_renderer_set_options(v->renderer, &v->scene);
}

/* Whether the frame's size and angle have changed, and with them the surface's size: which is not asked for every
 * frame, since it may take a look at the whole terrain. */
static bool outgrown(tc_viewer *v)
{
    const tc_camera *now = &v->camera, *before = &v->sized_for;
    if (now->width == before->width && now->height == before->height && now->fov == before->fov)
        return false;
    const tc_surface_request request = request_of(v);
    v->sized_for = *now;
    return tc_viewer_scheme(v)->size(&request) != v->surface_size;
}

tc_status tc_viewer_frame(tc_viewer *v, bool finish, tc_frame_stats *frame_ret, tc_error *error)
{
    tc_status status = TC_OK;
    if (outgrown(v)) {
        v->halvings = 0;
        status = tc_viewer_make_surface(v, error);
    }
    if (status == TC_OK)
        status = tc_renderer_frame(v->renderer, &v->camera, finish, frame_ret, error);
    while (status == TC_ERR_MEMORY && halve(v)) { /* textures come with the frame */
        status = tc_viewer_make_surface(v, error);
        if (status == TC_OK)
            status = tc_renderer_frame(v->renderer, &v->camera, finish, frame_ret, error);
    }
    return status;
}
