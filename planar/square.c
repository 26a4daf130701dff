/* square.c - square nested grids: which blocks of which level a frame draws.
 *
 * A level's render region is its active region (LH04 section 3), or what a throttled frame leaves of it, without the
 * finer level's. It is cut into blocks along lines fixed in the map, which are culled against the view with the
 * pyramid's height bounds. Along the perimeter of each region, where two fine edges meet one coarse edge, crack closers
 * are drawn (block_geometry.c). */
#include "square.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/camera.h"
#include "common/field/field.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "square_internal.h"

typedef struct square_surface {
    tc_surface head;
    tc_block_geometry index;
    bool wide;         /* places relative to the viewer do not fit 32 bits (square_wide.glsl) */
    int strips, lists; /* the most draws of either kind */
    tc_ground_options windows;
} square_surface;

typedef struct square_view {
    tc_view head;
    square_viewer viewer;
} square_view;

/* All that is looked at while a frame is put together. */
typedef struct assembly {
    const square_surface *s;
    const tc_clipmap *clipmap;
    const tc_field *field;
    tc_frame *frame;
    square_viewer viewer; /* of the camera drawn */
    tc_frustum frustum;   /* of the camera culled for */
    double eye[3];        /* of the camera culled for; x, y relative to viewer's snapped sample, z above z_base */
    double spacing[2];    /* of the finest level */
    bool no_cull;
    int levels; /* that may be drawn */
    int level;
    const tc_clip_level *l;
    tc_rect region, finer; /* drawn of the level, and of the finer one */
    int strip_count, list_count, blocks;
    int64_t triangles, triangles_unculled;
} assembly;

/* Bounds of a level's vertices over cells x0 .. x1, y0 .. y1. A vertex on the terrain's edge beyond the last sample
 * goes on in the straight line of the last two samples, less than one step of it: on one axis by at most their range r;
 * on both by r and then by the range that has become 3 r, together 4 r. */
static void vertex_bounds(const assembly *a, int field_level, tc_rect cells, double *lo_ret, double *hi_ret)
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
static void height_bounds(const assembly *a, tc_rect cells, double *lo_ret, double *hi_ret)
{
    int pl = tc_clipmap_field_level(a->clipmap, a->level);
    vertex_bounds(a, pl, cells, lo_ret, hi_ret);
    if (a->level > 1) {
        double lo, hi;
        tc_rect coarse = {cells.x0 / 2, cells.y0 / 2, (cells.x1 + 1) / 2, (cells.y1 + 1) / 2};
        vertex_bounds(a, pl - 1, coarse, &lo, &hi);
        *lo_ret = fmin(*lo_ret, lo);
        *hi_ret = fmax(*hi_ret, hi);
    }
}

static bool visible(const assembly *a, tc_rect cells)
{
    if (a->no_cull)
        return true;
    double z_lo, z_hi;
    height_bounds(a, cells, &z_lo, &z_hi);
    int k = a->l->shift;
    double x0 = (double)((cells.x0 << k) - a->viewer.snap_x) * a->spacing[0];
    double x1 = (double)((cells.x1 << k) - a->viewer.snap_x) * a->spacing[0];
    double y0 = (double)((cells.y0 << k) - a->viewer.snap_y) * a->spacing[1];
    double y1 = (double)((cells.y1 << k) - a->viewer.snap_y) * a->spacing[1];
    double lo[3] = {x0 - a->eye[0], y0 - a->eye[1], z_lo - a->eye[2]};
    double hi[3] = {x1 - a->eye[0], y1 - a->eye[1], z_hi - a->eye[2]};
    for (int i = 0; i < 3; i++) { /* what float makes of it */
        double slack = 1e-5 * fmax(fabs(lo[i]), fabs(hi[i]));
        lo[i] -= slack;
        hi[i] += slack;
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
static tc_instance instance(const assembly *a, int64_t x, int64_t y)
{
    int k = a->l->shift, torus = 2 * (tc_clipmap_n(a->clipmap) + 1);
    int64_t rx = (x << k) - a->viewer.snap_x, ry = (y << k) - a->viewer.snap_y;
    if (a->s->wide) {
        wide_place px = split(rx), py = split(ry);
        uint32_t low = (uint32_t)(px.low & 0xffff) | (uint32_t)(py.low & 0xffff) << 16;
        uint32_t at = (uint32_t)(x & (torus - 1)) | (uint32_t)(y & (torus - 1)) << 12 | (uint32_t)(a->level - 1) << 24;
        return (tc_instance){{px.high, py.high, (int32_t)low, (int32_t)at}};
    }
    int32_t texel = (int32_t)(x & (torus - 1)) | (int32_t)(y & (torus - 1)) << 16;
    return (tc_instance){{(int32_t)rx, (int32_t)ry, texel, a->level - 1}};
}

static void add_block(assembly *a, tc_rect cells)
{
    if (tc_rect_empty(cells))
        return;
    int64_t w = cells.x1 - cells.x0, h = cells.y1 - cells.y0;
    a->triangles_unculled += 2 * w * h;
    a->blocks++;
    if (!visible(a, cells))
        return;
    a->triangles += 2 * w * h;
    assert(a->strip_count < a->s->strips);
    a->frame->instances[a->strip_count] = instance(a, cells.x0, cells.y0);
    a->frame->draws[a->strip_count++] =
        (tc_draw){.count = tc_block_strip_count(w, h), 1, .first_index = a->s->index.strip_first[w - 1]};
}

/* Closers along a side of the perimeter: from (x, y) `cells` cells east or north. */
static void add_closers(assembly *a, int64_t x, int64_t y, int64_t cells, bool row)
{
    for (int64_t done = 0; done < cells; done += a->s->index.block) {
        int64_t run = tc_min64(cells - done, a->s->index.block), sx = row ? x + done : x, sy = row ? y : y + done;
        if (!visible(a, (tc_rect){sx, sy, row ? sx + run : sx, row ? sy : sy + run}))
            continue;
        /* From the end of the room on backwards, until all strips are known. */
        int at = a->s->head.draw_capacity - 1 - a->list_count++;
        assert(a->list_count <= a->s->lists);
        a->frame->instances[at] = instance(a, sx, sy);
        a->frame->draws[at] = (tc_draw){.count = (uint32_t)(3 * (run / 2)),
                                        1,
                                        .first_index = row ? a->s->index.row_first : a->s->index.column_first};
    }
}

/* A tile without the hole's part of it, in at most four blocks. */
static void add_tile(assembly *a, tc_rect tile, tc_rect hole)
{
    tc_rect h = tc_rect_intersect(tile, hole);
    if (tc_rect_empty(h)) {
        add_block(a, tile);
        return;
    }
    add_block(a, (tc_rect){tile.x0, tile.y0, tile.x1, h.y0});
    add_block(a, (tc_rect){tile.x0, h.y0, h.x0, h.y1});
    add_block(a, (tc_rect){h.x1, h.y0, tile.x1, h.y1});
    add_block(a, (tc_rect){tile.x0, h.y1, tile.x1, tile.y1});
}

/* The k-th of lo .. hi - 1 in the order of distance from `middle`. */
static int64_t nearest_first(int64_t k, int64_t lo, int64_t hi, int64_t middle)
{
    middle = tc_clamp64(middle, lo, hi - 1);
    int64_t below = middle - lo, above = hi - 1 - middle, both = 2 * tc_min64(below, above);
    if (k <= both)
        return k & 1 ? middle + (k + 1) / 2 : middle - k / 2;
    return above > below ? lo + k : hi - 1 - k;
}

static void add_level(assembly *a, bool closers)
{
    const tc_rect r = a->region, f = a->finer;
    tc_rect cells = {r.x0, r.y0, r.x1 - 1, r.y1 - 1}, hole = {0, 0, 0, 0};
    if (!tc_rect_empty(f))
        hole = (tc_rect){f.x0 / 2, f.y0 / 2, (f.x1 - 1) / 2, (f.y1 - 1) / 2};
    /* Rows and columns of tiles nearest first, so that what is hidden is seldom shaded. */
    int64_t b = a->s->index.block;
    tc_rect tiles = {cells.x0 / b, cells.y0 / b, (cells.x1 + b - 1) / b, (cells.y1 + b - 1) / b};
    int64_t eye_x = (a->viewer.snap_x >> a->l->shift) / b, eye_y = (a->viewer.snap_y >> a->l->shift) / b;
    for (int64_t v = 0; v < tiles.y1 - tiles.y0; v++) {
        int64_t y = b * nearest_first(v, tiles.y0, tiles.y1, eye_y);
        for (int64_t u = 0; u < tiles.x1 - tiles.x0; u++) {
            int64_t x = b * nearest_first(u, tiles.x0, tiles.x1, eye_x);
            add_tile(a, tc_rect_intersect(cells, (tc_rect){x, y, x + b, y + b}), hole);
        }
    }
    if (!closers)
        return;
    if (cells.y0 > a->l->extent.y0)
        add_closers(a, cells.x0, cells.y0, cells.x1 - cells.x0, true);
    if (cells.y1 < a->l->extent.y1 - 1)
        add_closers(a, cells.x0, cells.y1, cells.x1 - cells.x0, true);
    if (cells.x0 > a->l->extent.x0)
        add_closers(a, cells.x0, cells.y0, cells.y1 - cells.y0, false);
    if (cells.x1 < a->l->extent.x1 - 1)
        add_closers(a, cells.x1, cells.y0, cells.y1 - cells.y0, false);
}

static void set_uniforms(assembly *a, const tc_frame_options *options)
{
    tc_frame *f = a->frame;
    const tc_clip_level *l = tc_clipmap_level(a->clipmap, 1);
    int64_t edge_x = l->edge_x - a->viewer.snap_x, edge_y = l->edge_y - a->viewer.snap_y;
    wide_place x = split(edge_x), y = split(edge_y);
    const float surface[] = {(float)a->spacing[0], (float)a->spacing[1], (float)a->viewer.rest_x,
                             (float)a->viewer.rest_y};
    const int32_t integers[2][4] = {
        {a->s->wide ? x.high : (int32_t)edge_x, a->s->wide ? y.high : (int32_t)edge_y, x.low, y.low}, {l->shift}};
    memcpy(f->surface, surface, sizeof surface);
    memcpy(f->integers, integers, sizeof integers);
    for (int level = 1; level <= tc_clipmap_levels(a->clipmap); level++) {
        square_morph m = tc_square_morph(a->clipmap, level, &a->viewer, options);
        float(*u)[4] = f->layer[level - 1];
        for (int i = 0; i < 4; i++) {
            u[0][i] = (float)m.start[i];
            u[1][i] = (float)m.rate[i];
        }
        u[2][0] = (float)m.least;
        u[2][1] = (float)ldexp(1, -tc_clipmap_level(a->clipmap, level)->shift);
    }
}

/* Whether the eye is over the terrain and above the surface as drawn: then the first hit of any ray is from above, and
 * backs of triangles need not be drawn (nearly half of them near the ground). Through holes one sees backs. all:
 * whether what is held is drawn. */
static bool seen_from_above(const square_view *v, bool all)
{
    const tc_camera *camera = &v->head.camera;
    const tc_clipmap *clipmap = v->head.windows->clipmap[0];
    double z;
    return all && !tc_ground_voids(clipmap, 1) && !v->head.options.two_sided &&
           tc_square_height(clipmap, &v->viewer, &v->head.options, camera->x, camera->y, &z) &&
           camera->z > z + 1e-6 * fabs(z);
}

static void square_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                        const tc_frame_options *options, bool wait, tc_view *view)
{
    *view = tc_view_of(surface, windows, camera, options);
    ((square_view *)view)->viewer = tc_square_viewer(windows->clipmap[0], camera, wait);
}

static void square_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    tc_square_wanted(view->windows->clipmap[0], &((const square_view *)view)->viewer, wanted[0]);
}

static bool square_height(const tc_view *view, double x, double y, double *z_ret)
{
    const square_view *v = (const square_view *)view;
    return tc_square_height(view->windows->clipmap[0], &v->viewer, &view->options, x, y, z_ret);
}

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

static void square_draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    const square_view *v = (const square_view *)view;
    const tc_frame_options *options = &view->options;
    const tc_clipmap *clipmap = view->windows->clipmap[0];
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    assembly a = {.s = (const square_surface *)view->surface,
                  .clipmap = clipmap,
                  .field = field,
                  .frame = frame,
                  .viewer = v->viewer,
                  .frustum = tc_camera_frustum(&view->culled),
                  .spacing = {finest.spacing_x, finest.spacing_y},
                  .levels = layers->ready[0],
                  .no_cull = options->no_cull};
    a.eye[0] = view->culled.x - (double)a.viewer.snap_x * finest.spacing_x;
    a.eye[1] = view->culled.y - (double)a.viewer.snap_y * finest.spacing_y;
    a.eye[2] = view->culled.z - tc_field_info(field)->z_base;

    int active = 0;
    bool skipped = false;
    for (int level = a.levels + 1; level <= tc_clipmap_levels(clipmap); level++)
        skipped |= !tc_rect_empty(tc_square_region(clipmap, level, &a.viewer, options));
    for (int level = a.levels; level >= 1; level--) { /* nearest first */
        a.level = level;
        a.l = tc_clipmap_level(clipmap, level);
        a.finer = a.region;
        a.region = tc_square_region(clipmap, level, &a.viewer, options);
        if (tc_rect_empty(a.region))
            continue;
        active++;
        add_level(&a, !options->no_closers && !options->no_stitch);
    }
    for (int i = 0, end = a.s->head.draw_capacity - 1; i < a.list_count; i++) {
        frame->draws[a.strip_count + i] = frame->draws[end - i];
        frame->instances[a.strip_count + i] = frame->instances[end - i];
    }
    for (int i = 0; i < a.strip_count + a.list_count; i++)
        frame->draws[i].base_instance = (uint32_t)i;
    set_uniforms(&a, options);
    frame->strip_draws = a.strip_count, frame->list_draws = a.list_count;
    frame->triangles = a.triangles, frame->triangles_unculled = a.triangles_unculled;
    frame->one_sided = seen_from_above(v, !skipped);
    frame->draws_unculled = a.blocks;
    frame->levels_active = active;
    frame->levels_fine = tc_clipmap_levels(clipmap) - active;
    frame->levels_beyond = 0;
}

/* ---- Creation ---------------------------------------------------------------------------------------------------- */

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

tc_status tc_square_create(const tc_field *field, const tc_ground_options *options, tc_surface **surface_ret,
                           tc_error *error)
{
    static const tc_surface_words words = {.levels = "levels",
                                           .blocks = "blocks",
                                           .fine = "too fine for the height above ground, or not where the terrain is",
                                           .outside = "outside the view"};
    static const char *const vertex_parts[] = {"square_wide.glsl", "square.glsl", NULL};
    static const char *const fragment_parts[] = {"square.frag", NULL};
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
    if (!s->windows.n)
        s->windows.n = 255;
    int n = s->windows.n, block = n + 1 >= 128 ? (n + 1) / 16 : 8, across = (n + 1) / block + 1;
    /* A level of at most n - 1 cells meets `across` tiles a side; those that the hole's perimeter goes through, at most
     * across on each of its sides, are cut in up to four. */
    int most = 1; /* levels that no window holds as a whole, and the one that it does */
    for (int64_t size = edge; size > n / 2 && most < TC_MAX_LEVELS; size /= 2)
        most++;
    s->strips = most * (across * across + 4 * across * 3);
    s->lists = most * 4 * across;
    s->head =
        (tc_surface){.name = "square",
                     .words = &words,
                     .vertex_parts = s->wide ? vertex_parts : vertex_parts + 1,
                     .fragment_parts = fragment_parts,
                     .sky_parts = sky_parts,
                     .closers = true,
                     .instances = true,
                     .near_plane = 1e-4 * fmin(1, fmin(finest.spacing_x, finest.spacing_y)),
                     .extent = hypot((double)finest.width * finest.spacing_x, (double)finest.height * finest.spacing_y),
                     .field = field,
                     .n = n,
                     .draw_capacity = s->strips + s->lists,
                     .most_throttle = tc_square_most_throttle(n),
                     .view_bytes = sizeof(square_view),
                     .make_windows = square_windows,
                     .look = square_look,
                     .wanted = square_wanted,
                     .stand = square_stand,
                     .draws = square_draws,
                     .height = square_height,
                     .destroy = square_destroy};
    tc_status status = tc_block_geometry_make(block, &s->head.geometry, &s->index, error);
    if (status) {
        square_destroy(&s->head);
        return status;
    }
    *surface_ret = &s->head;
    return TC_OK;
}
