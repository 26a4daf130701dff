/* one_square.c - the least that a scheme is. */
#include "one_square.h"

#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"
#include "common/field/point.h"
#include "common/gl/program.h"

enum { CELLS = 16 }; /* along a side of a draw */

static int size(const tc_surface_request *request)
{
    return request->n ? request->n : 63;
}

static tc_status make_windows(const tc_surface *surface, tc_windows *windows_ret, tc_error *error)
{
    *windows_ret = (tc_windows){.charts = 1};
    return tc_ground_create(surface->field, &(tc_ground_options){.n = surface->n, .max_levels = 1},
                            &windows_ret->clipmap[0], error);
}

static void look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                 const tc_frame_options *options, bool wait, tc_view *view_ret)
{
    (void)wait;
    *view_ret = tc_view_of(surface, windows, camera, options);
}

static void wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    wanted[0][0] = tc_clipmap_level(view->windows->clipmap[0], 1)->extent;
}

static void draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    (void)layers;
    const tc_clip_level *l = tc_clipmap_level(view->windows->clipmap[0], 1);
    tc_draw *d = frame->draws;
    memset(frame->surface, 0, sizeof frame->surface);
    memset(frame->integers, 0, sizeof frame->integers);
    for (int64_t y = 0; y < l->extent.y1 - 1; y += CELLS)
        for (int64_t x = 0; x < l->extent.x1 - 1; x += CELLS) {
            int i = (int)(d - frame->draws);
            frame->instances[i] = (tc_instance){.v = {(int32_t)x, (int32_t)y, 0, 0}};
            *d++ = (tc_draw){(uint32_t)view->surface->geometry.index_count, 1, 0, 0, (uint32_t)i};
        }
    frame->surface[0][0] = (float)l->spacing_x, frame->surface[0][1] = (float)l->spacing_y;
    frame->surface[0][2] = (float)view->camera.x, frame->surface[0][3] = (float)view->camera.y;
    frame->integers[0][0] = (int32_t)l->extent.x1 - 1, frame->integers[0][1] = (int32_t)l->extent.y1 - 1;
    frame->strip_draws = frame->draws_unculled = (int)(d - frame->draws), frame->list_draws = 0;
    frame->triangles = frame->triangles_unculled = 2 * (l->extent.x1 - 1) * (l->extent.y1 - 1);
    frame->one_sided = false;
    frame->levels_active = 1, frame->levels_fine = frame->levels_beyond = 0;
}

static bool height(const tc_view *view, double x, double y, double *z_ret)
{
    const tc_clipmap *clipmap = view->windows->clipmap[0];
    const tc_clip_level *l = tc_clipmap_level(clipmap, 1);
    bool there = !tc_field_mesh_height(view->surface->field, tc_clipmap_field_level(clipmap, 1), x / l->spacing_x,
                                       y / l->spacing_y, z_ret);
    *z_ret += tc_field_info(view->surface->field)->z_base;
    return there;
}

static void destroy(tc_surface *surface)
{
    free(surface->geometry.vertices);
    free(surface->geometry.indices);
    free(surface);
}

static bool make_geometry(tc_geometry *g)
{
    enum { SIDE = CELLS + 1 };
    uint16_t(*v)[2] = malloc(SIDE * SIDE * sizeof *v);
    *g = (tc_geometry){.format = TC_VERTEX_UINT16_2, .vertices = v, .vertex_count = SIDE * SIDE, .index_bytes = 4};
    g->index_count = 6 * CELLS * CELLS;
    g->indices = malloc((size_t)g->index_count * sizeof(uint32_t));
    if (!v || !g->indices)
        return false;
    size_t at = 0;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            v[j * SIDE + i][0] = (uint16_t)i, v[j * SIDE + i][1] = (uint16_t)j;
            if (j == CELLS || i == CELLS)
                continue;
            const int sw = j * SIDE + i, nw = sw + SIDE, of[6] = {sw, nw, sw + 1, sw + 1, nw, nw + 1};
            for (int k = 0; k < 6; k++)
                tc_set_index(g, at++, (uint32_t)of[k]);
        }
    return true;
}

static tc_status create(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    static const tc_surface_words words = {"levels", "squares", "never", NULL, "never", false};
    static const char *const vertex[] = {"one_square.vert", NULL}, *const fragment[] = {"one_square.frag", NULL},
                             *const sky[] = {"sky.frag", NULL};
    static const struct tc_shader_file texts[] = {
        {"one_square.vert", "layout(location = 0) in ivec2 corner;\n"
                            "layout(location = 1) in ivec4 first;\n"
                            "layout(binding = 0) uniform sampler2DArray heights_map;\n"
                            "INTERPOLATED out float v_height;\n"
                            "vec3 surface_vertex()\n"
                            "{\n"
                            "    ivec2 at = min(first.xy + corner, whole[0].xy);\n"
                            "    v_height = texelFetch(heights_map, ivec3(at & WINDOW_MASK, 0), 0).x;\n"
                            "    return vec3(vec2(at) * surface[0].xy - surface[0].zw, v_height - eye.x - eye.y);\n"
                            "}\n"},
        {"one_square.frag", "INTERPOLATED in float v_height;\n"
                            "Ground surface_ground()\n"
                            "{\n"
                            "    Ground g;\n"
                            "    g.height = v_height, g.colour = vec4(0.0);\n"
                            "    return g;\n"
                            "}\n"},
        {NULL, NULL}};
    (void)scheme;
    tc_surface *s = calloc(1, sizeof *s);
    if (!s)
        return tc_fail(error, TC_ERR_MEMORY, "one square: not enough memory");
    const int n = size(request), across = n / CELLS + 1;
    *s = (tc_surface){.name = "one-square",
                      .words = &words,
                      .vertex_parts = vertex,
                      .fragment_parts = fragment,
                      .texts = texts,
                      .sky_parts = sky,
                      .instances = true,
                      .near_plane = 1e-3,
                      .extent = 1e5,
                      .field = map->chart[0].field,
                      .n = n,
                      .draw_capacity = across * across,
                      .view_bytes = sizeof(tc_view),
                      .make_windows = make_windows,
                      .look = look,
                      .wanted = wanted,
                      .draws = draws,
                      .height = height,
                      .destroy = destroy};
    if (!make_geometry(&s->geometry)) {
        destroy(s);
        return tc_fail(error, TC_ERR_MEMORY, "one square: not enough memory");
    }
    *surface_ret = s;
    return TC_OK;
}

const tc_scheme one_square_schemes[] = {{"one-square", NULL, &tc_plane_body, size, create, NULL, NULL, false}, {0}};
