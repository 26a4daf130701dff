/* square.c - the planar surface: windows, geometry and shaders of square grids, whichever way their blocks are chosen.
 */
#include "square.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/field.h"
#include "square_internal.h"

static bool square_stand(const tc_view *view, int chart, const double texel[2], tc_standing *at)
{
    const square_view *v = (const square_view *)view;
    (void)chart; /* there is one */
    *at = (tc_standing){.x = view->camera.x / texel[0],
                        .y = view->camera.y / texel[1],
                        .per_place = {1 / texel[0], 1 / texel[1]}, /* places are metres */
                        .lo = {-INFINITY, -INFINITY},
                        .hi = {INFINITY, INFINITY},
                        .texel = fmax(texel[0], texel[1]),
                        .distance = v->viewer.height};
    return true;
}

static tc_status square_windows(const tc_surface *surface, tc_windows *windows_ret, tc_error *error)
{
    *windows_ret = (tc_windows){.charts = 1};
    return tc_ground_create(surface->field, &((const square_surface *)surface)->windows, &windows_ret->clipmap[0],
                            error);
}

static void square_destroy(tc_surface *surface)
{
    square_surface *s = (square_surface *)surface;
    free(s->head.geometry.vertices);
    free(s->head.geometry.indices);
    free(s->index.strip_first);
    free(s);
}

tc_status tc_square_create(const tc_field *field, const tc_ground_options *options, const tc_square_blocks *blocks,
                           tc_surface **surface_ret, tc_error *error)
{
    static const tc_surface_words words = {.levels = "levels",
                                           .blocks = "blocks",
                                           .fine = "too fine for the height above ground, or not where the terrain is",
                                           .outside = "outside the view or behind nearer ground"};
    static const char *const vertex_parts[] = {"square_wide.glsl", "square.glsl", NULL};
    static const char *const fragment_parts[] = {"shown.glsl", "square.frag", NULL};
    static const char *const wall_parts[] = {"square_walls.frag", NULL};
    static const char *const sky_parts[] = {"sky.frag", NULL};
    if (options->n && tc_clipmap_check_n(options->n, error) != TC_OK)
        return TC_ERR_USAGE;
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    const int64_t edge = tc_max64(finest.width, finest.height) - 1;
    if (edge >= (int64_t)1 << 40) /* the high part of a place is exact as a float */
        return tc_fail(error, TC_ERR_UNSUPPORTED, "terrain: expected at most 2^40 samples a side, found %lldx%lld",
                       (long long)finest.width, (long long)finest.height);
    square_surface *s = calloc(1, sizeof *s);
    if (!s)
        return tc_fail(error, TC_ERR_MEMORY, "square grids: not enough memory");
    s->wide = edge >= (int64_t)1 << 30;
    s->windows = *options;
    if (blocks)
        s->blocks = *blocks;
    if (!s->windows.n)
        s->windows.n = 255;
    const square_way *way = blocks ? &tc_square_tree : &tc_square_nests;
    s->head =
        (tc_surface){.name = "square",
                     .words = &words,
                     .vertex_parts = s->wide ? vertex_parts : vertex_parts + 1,
                     .fragment_parts = blocks ? fragment_parts : fragment_parts + 1,
                     .wall_parts = wall_parts,
                     .sky_parts = sky_parts,
                     .closers = true,
                     .instances = true,
                     .near_plane = 1e-4 * fmin(1, fmin(finest.spacing_x, finest.spacing_y)),
                     .extent = hypot((double)finest.width * finest.spacing_x, (double)finest.height * finest.spacing_y),
                     .field = field,
                     .n = s->windows.n,
                     .shaded_n = s->blocks.shaded_n,
                     .defines = way->vertex_defines,
                     .view_bytes = way->view_bytes,
                     .make_windows = square_windows,
                     .look = way->look,
                     .wanted = way->wanted,
                     .stand = square_stand,
                     .draws = way->draws,
                     .height = way->height,
                     .destroy = square_destroy};
    tc_status status = way->prepare(s, error);
    s->head.draw_capacity = s->strips + s->lists;
    if (!status)
        status = tc_block_geometry_make(way->block(s), &s->head.geometry, &s->index, error);
    if (status) {
        square_destroy(&s->head);
        return status;
    }
    *surface_ret = &s->head;
    return TC_OK;
}
