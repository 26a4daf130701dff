/* square.c - square nested grids: which blocks of which level a frame draws.
 *
 * A level's render region is its active region without the finer level's (LH04 section 3). It is cut into blocks along
 * lines fixed in the map, which are culled against the view with the pyramid's height bounds. Along the perimeter of
 * each active region, where two fine edges meet one coarse edge, crack closers are drawn (square_geometry.c). */
#include "square.h"

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
    square_geometry index;
    bool wide;               /* places relative to the viewer do not fit 32 bits (square_wide.glsl) */
    int capacity;            /* draws of either kind */
    tc_draw *strips, *lists; /* strips has room for both */
    tc_instance *strip_data, *list_data;
    float layer_uniforms[TC_MAX_LAYERS][TC_LAYER_UNIFORMS];
    float surface_uniforms[TC_SURFACE_UNIFORMS];
} square_surface;

/* All that is looked at while a frame is put together. */
typedef struct assembly {
    square_surface *s;
    const tc_clipmap *clipmap;
    const tc_field *field;
    square_viewer viewer; /* of the camera drawn */
    tc_frustum frustum;   /* of the camera culled for */
    double eye[3];        /* of the camera culled for; x, y relative to viewer's snapped sample, z above z_base */
    double spacing[2];    /* of the finest level */
    bool no_cull;
    int levels; /* that may be drawn */
    int level;
    const tc_clip_level *l;
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
    if (!visible(a, cells) || a->strip_count == a->s->capacity)
        return;
    a->triangles += 2 * w * h;
    a->s->strip_data[a->strip_count] = instance(a, cells.x0, cells.y0);
    a->s->strips[a->strip_count++] =
        (tc_draw){.count = tc_square_strip_count(w, h), 1, .first_index = a->s->index.strip_first[w - 1]};
}

/* Closers along a side of the perimeter: from (x, y) `cells` cells east or north. */
static void add_closers(assembly *a, int64_t x, int64_t y, int64_t cells, bool row)
{
    for (int64_t done = 0; done < cells; done += a->s->index.block) {
        int64_t run = tc_min64(cells - done, a->s->index.block), sx = row ? x + done : x, sy = row ? y : y + done;
        if (!visible(a, (tc_rect){sx, sy, row ? sx + run : sx, row ? sy : sy + run}) || a->list_count == a->s->capacity)
            continue;
        a->s->list_data[a->list_count] = instance(a, sx, sy);
        a->s->lists[a->list_count++] = (tc_draw){.count = (uint32_t)(3 * (run / 2)),
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
    const tc_rect r = a->l->active;
    tc_rect cells = {r.x0, r.y0, r.x1 - 1, r.y1 - 1}, hole = {0, 0, 0, 0};
    if (a->level < a->levels) {
        tc_rect f = tc_clipmap_level(a->clipmap, a->level + 1)->active;
        if (!tc_rect_empty(f))
            hole = (tc_rect){f.x0 / 2, f.y0 / 2, (f.x1 - 1) / 2, (f.y1 - 1) / 2};
    }
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

static float int_bits(int64_t value)
{
    int32_t i = (int32_t)value;
    float f;
    memcpy(&f, &i, sizeof f);
    return f;
}

static void set_uniforms(assembly *a, const tc_frame_options *options)
{
    square_surface *s = a->s;
    const tc_clip_level *l = tc_clipmap_level(a->clipmap, 1);
    int64_t edge_x = l->edge_x - a->viewer.snap_x, edge_y = l->edge_y - a->viewer.snap_y;
    wide_place x = split(edge_x), y = split(edge_y);
    const float surface[] = {(float)a->spacing[0],
                             (float)a->spacing[1],
                             (float)a->viewer.rest_x,
                             (float)a->viewer.rest_y,
                             int_bits(s->wide ? x.high : edge_x),
                             int_bits(s->wide ? y.high : edge_y),
                             int_bits(x.low),
                             int_bits(y.low)};
    memcpy(s->surface_uniforms, surface, sizeof surface);
    for (int level = 1; level <= tc_clipmap_levels(a->clipmap); level++) {
        square_morph m = tc_square_morph(a->clipmap, level, &a->viewer, options);
        float *u = s->layer_uniforms[level - 1];
        for (int i = 0; i < 4; i++) {
            u[i] = (float)m.start[i];
            u[4 + i] = (float)m.rate[i];
        }
        u[8] = (float)m.least;
        u[9] = (float)ldexp(1, -tc_clipmap_level(a->clipmap, level)->shift);
        u[10] = int_bits(tc_clipmap_level(a->clipmap, level)->shift);
    }
}

/* Whether the eye is over the terrain and above the surface as drawn: then the first hit of any ray is from above, and
 * backs of triangles need not be drawn (nearly half of them near the ground). Through holes one sees backs. all:
 * whether what is held is drawn. */
static bool seen_from_above(const tc_clipmap *clipmap, const tc_camera *camera, const tc_frame_options *options,
                            bool all)
{
    double z;
    return all && !tc_ground_voids(clipmap, 1) && !options->two_sided &&
           tc_square_drawn_height(clipmap, camera, options, camera->x, camera->y, &z) && camera->z > z + 1e-6 * fabs(z);
}

static void square_wanted(tc_surface *surface, const tc_camera *camera, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    tc_square_wanted(surface->clipmap[0], camera, wanted[0]);
}

static bool square_drawn_height(tc_surface *surface, const tc_camera *camera, const tc_frame_options *options, double x,
                                double y, double *z_ret)
{
    return tc_square_drawn_height(surface->clipmap[0], camera, options, x, y, z_ret);
}

static void square_frame(tc_surface *surface, const tc_camera *camera, const tc_frame_options *options,
                         const tc_layers *layers, tc_frame *frame_ret)
{
    square_surface *s = (square_surface *)surface;
    const tc_clipmap *clipmap = surface->clipmap[0];
    const tc_field *field = tc_clipmap_field(clipmap);
    const tc_camera *cull = options->cull_camera ? options->cull_camera : camera;
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    assembly a = {.s = s,
                  .clipmap = clipmap,
                  .field = field,
                  .viewer = tc_square_viewer(clipmap, camera),
                  .frustum = tc_camera_frustum(cull),
                  .spacing = {finest.spacing_x, finest.spacing_y},
                  .levels = layers->ready[0],
                  .no_cull = options->no_cull};
    a.eye[0] = cull->x - (double)a.viewer.snap_x * finest.spacing_x;
    a.eye[1] = cull->y - (double)a.viewer.snap_y * finest.spacing_y;
    a.eye[2] = cull->z - tc_field_info(field)->z_base;

    int active = 0;
    bool skipped = false;
    for (int level = a.levels + 1; level <= tc_clipmap_levels(clipmap); level++)
        skipped |= !tc_rect_empty(tc_clipmap_level(clipmap, level)->active);
    for (int level = a.levels; level >= 1; level--) { /* nearest first */
        a.level = level;
        a.l = tc_clipmap_level(clipmap, level);
        if (tc_rect_empty(a.l->active))
            continue;
        active++;
        add_level(&a, !options->no_closers && !options->no_stitch);
    }
    memcpy(s->strips + a.strip_count, s->lists, (size_t)a.list_count * sizeof *s->lists);
    memcpy(s->strip_data + a.strip_count, s->list_data, (size_t)a.list_count * sizeof *s->list_data);
    for (int i = 0; i < a.strip_count + a.list_count; i++)
        s->strips[i].base_instance = (uint32_t)i;
    set_uniforms(&a, options);
    *frame_ret = (tc_frame){.draws = s->strips,
                            .instances = s->strip_data,
                            .strip_draws = a.strip_count,
                            .list_draws = a.list_count,
                            .triangles = a.triangles,
                            .one_sided = seen_from_above(clipmap, camera, options, !skipped),
                            .triangles_unculled = a.triangles_unculled,
                            .draws_unculled = a.blocks,
                            .levels_active = active,
                            .levels_fine = tc_clipmap_levels(clipmap) - active,
                            .layer_uniforms = (const float(*)[TC_LAYER_UNIFORMS])s->layer_uniforms,
                            .surface_uniforms = s->surface_uniforms};
}

static void square_destroy(tc_surface *surface)
{
    square_surface *s = (square_surface *)surface;
    tc_clipmap_destroy(surface->clipmap[0]);
    free(s->head.geometry.vertices);
    free(s->head.geometry.indices);
    free(s->index.strip_first);
    free(s->strips);
    free(s->lists);
    free(s->strip_data);
    free(s->list_data);
    free(s);
}

tc_status tc_square_create(tc_clipmap *clipmap, tc_surface **surface_ret, tc_error *error)
{
    static const tc_surface_words words = {.levels = "levels",
                                           .blocks = "blocks",
                                           .fine = "too fine for the height above ground, or not where the terrain is",
                                           .outside = "outside the view"};
    static const char *const vertex_parts[] = {"square_wide.glsl", "square.glsl", NULL};
    static const char *const fragment_parts[] = {"square.frag", NULL};
    const tc_clip_level *l = tc_clipmap_level(clipmap, 1);
    const int64_t edge = tc_max64(l->edge_x, l->edge_y);
    square_surface *s = calloc(1, sizeof *s);
    tc_status status = TC_OK;
    if (edge >= (int64_t)1 << 40) /* the high part of a place is exact as a float */
        status = tc_fail(error, TC_ERR_UNSUPPORTED, "terrain: expected at most 2^40 samples a side, found %lldx%lld",
                         (long long)l->edge_x + 1, (long long)l->edge_y + 1);
    else if (!s)
        status = tc_fail(error, TC_ERR_MEMORY, "square grids: not enough memory");
    if (status) {
        free(s);
        tc_clipmap_destroy(clipmap);
        return status;
    }
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    s->wide = edge >= (int64_t)1 << 30;
    s->head =
        (tc_surface){.name = "square",
                     .words = &words,
                     .vertex_parts = s->wide ? vertex_parts : vertex_parts + 1,
                     .fragment_parts = fragment_parts,
                     .sky = "sky.frag",
                     .closers = true,
                     .instances = true,
                     .near_plane = 1e-4 * fmin(1, fmin(finest.spacing_x, finest.spacing_y)),
                     .extent = hypot((double)finest.width * finest.spacing_x, (double)finest.height * finest.spacing_y),
                     .charts = 1,
                     .clipmap = {clipmap},
                     .wanted = square_wanted,
                     .frame = square_frame,
                     .drawn_height = square_drawn_height,
                     .destroy = square_destroy};
    int n = tc_clipmap_n(clipmap), block = n + 1 >= 128 ? (n + 1) / 16 : 8, across = (n + 1) / block + 1;
    /* Blocks of a level: every tile, those around the hole cut in up to four; closers: four sides. */
    s->capacity = tc_clipmap_levels(clipmap) * (across * across + 12 * across + 16);
    status = tc_square_geometry(block, &s->head.geometry, &s->index, error);
    s->strips = calloc(2 * (size_t)s->capacity, sizeof *s->strips);
    s->lists = calloc((size_t)s->capacity, sizeof *s->lists);
    s->strip_data = calloc(2 * (size_t)s->capacity, sizeof *s->strip_data);
    s->list_data = calloc((size_t)s->capacity, sizeof *s->list_data);
    if (status || !s->strips || !s->lists || !s->strip_data || !s->list_data) {
        square_destroy(&s->head);
        return status ? status : tc_fail(error, TC_ERR_MEMORY, "square grids: not enough memory");
    }
    *surface_ret = &s->head;
    return TC_OK;
}
