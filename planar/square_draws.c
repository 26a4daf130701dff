/* square_draws.c - square grids: blocks and crack closers of a frame.
 *
 * Blocks are culled against the view with the pyramid's height bounds. Where two fine edges meet one coarse edge, crack
 * closers are drawn (block_geometry.c). */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "square_internal.h"

/* Bounds of a level's vertices over cells x0 .. x1, y0 .. y1. A vertex on the terrain's edge beyond the last sample
 * goes on in the straight line of the last two samples, less than one step of it: on one axis by at most their range r;
 * on both by r and then by the range that has become 3 r, together 4 r. */
static void vertex_bounds(const square_draws *a, int field_level, tc_rect cells, double *lo_ret, double *hi_ret)
{
    tc_level size = tc_field_level(a->field, field_level);
    tc_rect samples = {cells.x0, cells.y0, cells.x1 + 1, cells.y1 + 1};
    int beyond = 0;
    if (samples.x1 > size.width) {
        samples.x0 = tc_max64(0, tc_min64(samples.x0, size.width - 2));
        beyond++;
    }
    if (samples.y1 > size.height) {
        samples.y0 = tc_max64(0, tc_min64(samples.y0, size.height - 2));
        beyond++;
    }
    tc_range range = tc_field_range(a->field, field_level, samples);
    double more = beyond == 0 ? 0 : beyond == 1 ? 1 : 4;
    *lo_ret = range.lo - more * ((double)range.hi - range.lo);
    *hi_ret = range.hi + more * ((double)range.hi - range.lo);
}

/* Bounds of everything drawn over the cells: the level's own heights and the morph's targets. */
static void height_bounds(const square_draws *a, int level, tc_rect cells, double *lo_ret, double *hi_ret)
{
    int pl = tc_clipmap_field_level(a->clipmap, level);
    vertex_bounds(a, pl, cells, lo_ret, hi_ret);
    if (level > 1) {
        double lo, hi;
        tc_rect coarse = {cells.x0 / 2, cells.y0 / 2, (cells.x1 + 1) / 2, (cells.y1 + 1) / 2};
        vertex_bounds(a, pl - 1, coarse, &lo, &hi);
        *lo_ret = fmin(*lo_ret, lo);
        *hi_ret = fmax(*hi_ret, hi);
    }
}

void tc_square_box(const square_draws *a, int level, tc_rect cells, double lo[3], double hi[3])
{
    double z_lo, z_hi;
    height_bounds(a, level, cells, &z_lo, &z_hi);
    int k = tc_clipmap_level(a->clipmap, level)->shift;
    double x0 = (double)((cells.x0 << k) - a->viewer.snap_x) * a->spacing[0];
    double x1 = (double)((cells.x1 << k) - a->viewer.snap_x) * a->spacing[0];
    double y0 = (double)((cells.y0 << k) - a->viewer.snap_y) * a->spacing[1];
    double y1 = (double)((cells.y1 << k) - a->viewer.snap_y) * a->spacing[1];
    lo[0] = x0 - a->eye[0], lo[1] = y0 - a->eye[1], lo[2] = z_lo - a->eye[2];
    hi[0] = x1 - a->eye[0], hi[1] = y1 - a->eye[1], hi[2] = z_hi - a->eye[2];
}

bool tc_square_in_view(const square_draws *a, const double box_lo[3], const double box_hi[3])
{
    double lo[3], hi[3];
    for (int i = 0; i < 3; i++) { /* what float makes of it */
        const double slack = 1e-5 * fmax(fabs(box_lo[i]), fabs(box_hi[i]));
        lo[i] = box_lo[i] - slack, hi[i] = box_hi[i] + slack;
    }
    return tc_frustum_sees(&a->frustum, lo, hi);
}

/* Of square_wide.glsl: high * 65536 + low. */
typedef struct wide_place {
    int32_t high;
    int32_t low; /* -32768 .. 32767 */
} wide_place;

static wide_place split(int64_t place)
{
    int64_t high = tc_floor_shift(place + 32768, 16);
    return (wide_place){(int32_t)high, (int32_t)(place - high * 65536)};
}

/* What map_vertex() of square.glsl reads: the block's first vertex in finest samples from the viewer's, its place in
 * the normal map, which is twice as large as the heights' window, and the level. */
tc_instance tc_square_instance(const square_draws *a, int level, int64_t x, int64_t y, const float corners[4])
{
    int k = tc_clipmap_level(a->clipmap, level)->shift, torus = 2 * (tc_clipmap_n(a->clipmap) + 1);
    int64_t rx = (x << k) - a->viewer.snap_x, ry = (y << k) - a->viewer.snap_y;
    tc_instance to = {.corner = {0}};
    if (corners)
        memcpy(to.corner, corners, sizeof to.corner);
    if (a->s->wide) {
        wide_place px = split(rx), py = split(ry);
        uint32_t low = (uint32_t)(px.low & 0xffff) | (uint32_t)(py.low & 0xffff) << 16;
        uint32_t at = (uint32_t)(x & (torus - 1)) | (uint32_t)(y & (torus - 1)) << 12 | (uint32_t)(level - 1) << 24;
        to.v[0] = px.high, to.v[1] = py.high, to.v[2] = (int32_t)low, to.v[3] = (int32_t)at;
        return to;
    }
    int32_t texel = (int32_t)(x & (torus - 1)) | (int32_t)(y & (torus - 1)) << 16;
    to.v[0] = (int32_t)rx, to.v[1] = (int32_t)ry, to.v[2] = texel, to.v[3] = level - 1;
    return to;
}

void tc_square_add_block(square_draws *a, int level, tc_rect cells, const float corners[4])
{
    if (tc_rect_empty(cells))
        return;
    if (a->view->options.walls)
        tc_square_add_walls(a, level, cells, corners);
    int64_t w = cells.x1 - cells.x0, h = cells.y1 - cells.y0;
    a->triangles_unculled += 2 * w * h;
    a->blocks++;
    if (!a->view->options.no_cull) {
        double lo[3], hi[3];
        tc_square_box(a, level, cells, lo, hi);
        if (!tc_square_in_view(a, lo, hi))
            return;
        tc_square_horizon_add(a, level, cells, lo, hi);
    }
    a->triangles += 2 * w * h;
    a->frame->blocks[level - 1]++;
    assert(a->strips < a->s->strips);
    a->frame->instances[a->strips] = tc_square_instance(a, level, cells.x0, cells.y0, corners);
    a->frame->draws[a->strips++] =
        (tc_draw){.count = tc_block_strip_count(w, h), 1, .first_index = a->s->index.strip_first[w - 1]};
}

void tc_square_add_closers(square_draws *a, int level, int64_t x, int64_t y, int64_t cells, bool row)
{
    static const float coarse[4] = {1, 1, 1, 1};
    for (int64_t done = 0; done < cells; done += a->s->index.block) {
        int64_t run = tc_min64(cells - done, a->s->index.block), sx = row ? x + done : x, sy = row ? y : y + done;
        if (!a->view->options.no_cull) {
            double lo[3], hi[3];
            tc_square_box(a, level, (tc_rect){sx, sy, row ? sx + run : sx, row ? sy : sy + run}, lo, hi);
            if (!tc_square_in_view(a, lo, hi))
                continue;
        }
        if (a->lists == a->s->lists)
            return;
        /* From the end of the room on backwards, until all strips are known. */
        int at = a->s->head.draw_capacity - 1 - a->lists++;
        a->frame->instances[at] = tc_square_instance(a, level, sx, sy, coarse);
        a->frame->draws[at] = (tc_draw){.count = (uint32_t)(3 * (run / 2)),
                                        1,
                                        .first_index = row ? a->s->index.row_first : a->s->index.column_first};
    }
}

static void set_uniforms(square_draws *a)
{
    tc_frame *f = a->frame;
    const tc_clip_level *l = tc_clipmap_level(a->clipmap, 1);
    int64_t edge_x = l->edge_x - a->viewer.snap_x, edge_y = l->edge_y - a->viewer.snap_y;
    wide_place x = split(edge_x), y = split(edge_y);
    const int32_t edge[4] = {a->s->wide ? x.high : (int32_t)edge_x, a->s->wide ? y.high : (int32_t)edge_y, x.low,
                             y.low};
    tc_set4(f->surface[0], a->spacing[0], a->spacing[1], a->viewer.rest_x, a->viewer.rest_y);
    memcpy(f->integers[0], edge, sizeof edge);
    f->integers[1][0] = l->shift;
    for (int level = 1; level <= tc_clipmap_levels(a->clipmap); level++)
        f->layer[level - 1][2][1] = (float)ldexp(1, -tc_clipmap_level(a->clipmap, level)->shift);
}

/* Whether the eye is over the terrain and above the surface as drawn: then the first hit of any ray is from above, and
 * backs of triangles need not be drawn (nearly half of them near the ground). Through holes one sees backs. all:
 * whether what is held is drawn. */
static bool seen_from_above(const square_view *v, const tc_camera *camera, bool all)
{
    const tc_clipmap *clipmap = v->head.windows->clipmap[0];
    double z;
    return all && !tc_ground_voids(clipmap, 1) && !v->head.options.two_sided &&
           v->head.surface->height(&v->head, camera->x, camera->y, &z) && camera->z > z + 1e-6 * fabs(z);
}

square_draws tc_square_begin_draws(const square_view *v, tc_frame *frame)
{
    const tc_view *view = &v->head;
    const tc_field *field = tc_clipmap_field(view->windows->clipmap[0]);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    square_draws a = {.s = (const square_surface *)view->surface,
                      .view = view,
                      .clipmap = view->windows->clipmap[0],
                      .field = field,
                      .frame = frame,
                      .viewer = v->viewer,
                      .frustum = tc_camera_frustum(&view->culled),
                      .horizon = (square_horizon *)&v->horizon, /* room, as frames are */
                      .spacing = {finest.spacing_x, finest.spacing_y}};
    a.eye[0] = view->culled.x - (double)a.viewer.snap_x * finest.spacing_x;
    a.eye[1] = view->culled.y - (double)a.viewer.snap_y * finest.spacing_y;
    a.eye[2] = view->culled.z - tc_field_info(field)->z_base;
    return a;
}

void tc_square_end_draws(square_draws *a, const square_view *v, bool all)
{
    tc_frame *frame = a->frame;
    const tc_frame_options *options = &v->head.options;
    frame->one_sided = seen_from_above(v, &v->head.camera, all);
    if (frame->one_sided && !options->no_cull && !options->no_stitch && !options->no_closers &&
        seen_from_above(v, &v->head.culled, all))
        tc_square_horizon_cut(a);
    for (int i = 0, end = a->s->head.draw_capacity - 1; i < a->lists; i++) {
        frame->draws[a->strips + i] = frame->draws[end - i];
        frame->instances[a->strips + i] = frame->instances[end - i];
    }
    for (int i = 0; i < a->strips + a->lists; i++)
        frame->draws[i].base_instance = (uint32_t)i;
    tc_square_end_walls(a);
    set_uniforms(a);
    frame->strip_draws = a->strips, frame->list_draws = a->lists;
    frame->triangles = a->triangles, frame->triangles_unculled = a->triangles_unculled;
    frame->draws_unculled = a->blocks;
    frame->levels_beyond = 0;
}
