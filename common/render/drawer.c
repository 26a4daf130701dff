/* drawer.c - the public interface: what a host holds, over renderers that share their objects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"
#include "common/terraclip_draw.h"
#include "draw_state.h"
#include "renderer.h"
#include "scheme.h"

struct tc_drawer {
    int users; /* itself, until it is destroyed, and its eyes */
    tc_gl gl;
    tc_map *map;
    const tc_scheme *scheme;
    tc_draw_options options;
    tc_scene_options scene;
    tc_surface *surface;
    tc_scene_objects *objects;
};

struct tc_eye {
    tc_drawer *drawer;
    tc_renderer *renderer;
};

/* ---- Drawers ----------------------------------------------------------------------------------------------------- */

static const tc_scheme *find_scheme(const tc_map *map, const char *name)
{
    return name ? tc_scheme_named(tc_scheme_lists, map->body.class, name) : tc_scheme_for(tc_scheme_lists, map);
}

static tc_status make_surface(tc_drawer *d, tc_error *error)
{
    const int width = d->options.width > 0 ? d->options.width : 1920;
    const tc_camera camera = {.fov = M_PI / 2, .width = width, .height = width};
    const tc_scene_needs needs = tc_scene_needs_of(&d->scene, tc_field_info(tc_map_field(d->map, 0)));
    const tc_surface_request request = {
        .n = d->options.n, .levels = d->options.levels, .needs = &needs, .camera = &camera};
    return d->scheme->create(d->scheme, d->map, &request, &d->surface, error);
}

static void release(tc_drawer *d)
{
    if (!d || --d->users > 0)
        return;
    tc_scene_objects_release(&d->gl, d->objects);
    if (d->surface)
        d->surface->destroy(d->surface);
    tc_map_destroy(d->map);
    free(d);
}

static tc_status make_objects(tc_drawer *d, tc_error *error)
{
    tc_draw_state host;
    tc_draw_state_get(&d->gl, &host);
    tc_draw_state_for_uploads(&d->gl);
    tc_status status = tc_scene_objects_create(&d->gl, d->surface, &d->scene, &d->objects, error);
    tc_draw_state_give_back(&d->gl, &host);
    return status;
}

tc_status tc_drawer_create(tc_map *map, const tc_draw_options *options, void *(*get_proc)(const char *name),
                           tc_drawer **drawer_ret, tc_error *error)
{
    static const tc_draw_options defaults = {0};
    const tc_draw_options *o = options ? options : &defaults;
    if (!map || !get_proc)
        return tc_fail(error, TC_ERR_USAGE, "drawer: expected a map and a way to OpenGL's functions, found none");
    const tc_scheme *scheme = find_scheme(map, o->scheme);
    if (!scheme)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "drawer: expected a scheme for a %s, found %s", map->body.class->name,
                       o->scheme ? o->scheme : "none");
    tc_drawer *d = calloc(1, sizeof *d);
    if (!d)
        return tc_fail(error, TC_ERR_MEMORY, "drawer: not enough memory");
    *d = (tc_drawer){.users = 1, .map = tc_map_share(map), .scheme = scheme, .options = *o};
    d->scene = (tc_scene_options){.unlit = o->unlit,
                                  .background_set = o->no_sky,
                                  .holes = o->holes,
                                  .budget = o->budget,
                                  .budget_us = o->budget_us};
    memcpy(d->scene.background, o->background, sizeof d->scene.background);
    d->options.scheme = scheme->name;
    tc_status status = tc_gl_load(&d->gl, get_proc, error);
    if (status == TC_OK)
        status = make_surface(d, error);
    if (status == TC_OK)
        status = make_objects(d, error);
    if (status == TC_OK)
        *drawer_ret = d;
    else
        release(d);
    return status;
}

void tc_drawer_destroy(tc_drawer *drawer)
{
    release(drawer);
}

/* ---- Eyes -------------------------------------------------------------------------------------------------------- */

tc_status tc_eye_create(tc_drawer *drawer, tc_eye **eye_ret, tc_error *error)
{
    tc_eye *eye = calloc(1, sizeof *eye);
    if (!eye)
        return tc_fail(error, TC_ERR_MEMORY, "eye: not enough memory");
    eye->drawer = drawer;
    drawer->users++;
    tc_status status = tc_renderer_create_with(&drawer->gl, drawer->objects, &drawer->scene, &eye->renderer, error);
    if (status == TC_OK)
        *eye_ret = eye;
    else
        tc_eye_destroy(eye);
    return status;
}

void tc_eye_destroy(tc_eye *eye)
{
    if (!eye)
        return;
    tc_renderer_destroy(eye->renderer);
    release(eye->drawer);
    free(eye);
}

static tc_status draw(tc_eye *eye, const tc_target_place *place, const tc_sight *sight, bool wait,
                      tc_draw_stats *stats_ret, tc_error *error)
{
    tc_target target = {.place = *place};
    tc_frame_stats f;
    tc_status status = tc_renderer_draw(eye->renderer, &target, sight, wait, &f, error);
    if (status == TC_OK && stats_ret)
        *stats_ret = (tc_draw_stats){.triangles = f.triangles,
                                     .draws = f.draws,
                                     .levels = f.levels_active,
                                     .samples_updated = f.samples_updated,
                                     .bytes_uploaded = f.bytes_uploaded,
                                     .update_ms = f.update_ms,
                                     .draw_ms = f.draw_ms,
                                     .resident = f.resident,
                                     .failed = f.failed};
    return status;
}

static tc_status check_depth(const tc_target_place *place, tc_error *error)
{
    if ((unsigned)place->depth >= TC_DEPTHS)
        return tc_fail(error, TC_ERR_USAGE, "target: expected a known depth, found %d", (int)place->depth);
    return TC_OK;
}

tc_status tc_eye_draw(tc_eye *eye, const tc_target_place *target, const double view[16], const double projection[16],
                      bool wait, tc_draw_stats *stats_ret, tc_error *error)
{
    tc_sight sight;
    tc_status status = check_depth(target, error);
    if (status == TC_OK)
        status = tc_sight_by(view, projection, target->depth, &eye->drawer->map->body, target->width, target->height,
                             &sight, error);
    return status == TC_OK ? draw(eye, target, &sight, wait, stats_ret, error) : status;
}

tc_status tc_eye_draw_through(tc_eye *eye, const tc_target_place *target, const tc_camera *camera, bool wait,
                              tc_draw_stats *stats_ret, tc_error *error)
{
    tc_status status = check_depth(target, error);
    if (status == TC_OK)
        status = tc_sight_check(camera, error);
    if (status != TC_OK)
        return status;
    const tc_sight sight = tc_sight_through(camera, target->depth, eye->drawer->surface->near_plane);
    return draw(eye, target, &sight, wait, stats_ret, error);
}
