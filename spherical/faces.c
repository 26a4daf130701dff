/* faces.c - surfaces over faces: what a frame draws of the blocks that it calls for.
 *
 * Each leaf of the tree of blocks is a draw, culled by a ball around it against the view and the horizon; crack closers
 * follow along its sides where the mesh beyond is coarser. */
#include "faces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/field.h"
#include "common/view/camera.h"
#include "globe.h"
#include "faces_internal.h"

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* All that is looked at while a frame is put together. */
typedef struct assembly {
    const faces_view *v;
    const faces_surface *s;
    const tc_layers *layers;
    tc_frame *frame;
    tc_frustum frustum; /* of the camera culled for, */
    double eye[3];      /* where it is in space, */
    double axes[3][3];  /* its axes, */
    double horizon;     /* and how far it sees, as faces_view has it */
    double most;        /* radius of curvature of what heights are above, metres */
    int strips, lists, blocks;
    int levels[TC_BLOCK_LEVELS]; /* leaves drawn of each */
    int finest;                  /* of all leaves' */
    int64_t triangles, triangles_unculled;
    double off; /* metres a metre of distance that any leaf is off at most, with a tolerance */
} assembly;

/* A leaf's heights: those of the level that it is drawn by, and of the coarser one into which that passes over. */
static void height_bounds(const assembly *a, const tc_leaf *leaf, double *lo_ret, double *hi_ret)
{
    const tc_clipmap *clipmap = a->v->head.windows->clipmap[leaf->block.chart];
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_rect r = tc_faces_samples(&a->s->lattice, leaf->block);
    *lo_ret = INFINITY, *hi_ret = -INFINITY;
    for (int level = leaf->block.level, least = level - leaf->coarse - 1; level >= least && level >= 1; level--) {
        tc_rect held = r;
        const int own = tc_faces_window(a->s, level, &held);
        const tc_range range = tc_field_range(field, tc_clipmap_field_level(clipmap, own), held);
        *lo_ret = fmin(*lo_ret, range.lo), *hi_ret = fmax(*hi_ret, range.hi);
        r = (tc_rect){r.x0 / 2, r.y0 / 2, r.x1 / 2 + 1, r.y1 / 2 + 1};
    }
}

static double apart(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Whether a block may be seen: by a ball that holds all of its vertices. */
static bool visible(const assembly *a, const tc_leaf *leaf)
{
    const tc_block b = leaf->block;
    if (a->v->head.options.no_cull)
        return true;
    const double block = (double)a->s->cells / a->s->lattice.blocks[b.level - 1][0];
    const tc_body *body = &a->s->map->body;
    double middle[3], n[3], place[3], around = 0, lo, hi;
    tc_faces_normal(a->s, b.chart, (b.x + 0.5) * block, (b.y + 0.5) * block, middle);
    for (int k = 0; k < 9; k++) {
        tc_faces_normal(a->s, b.chart, (b.x + 0.5 * (k % 3)) * block, (b.y + 0.5 * (int)(k / 3)) * block, n);
        around = fmax(around, apart(middle, n));
    }
    around *= 1.1;
    if (2 * asin(fmin(0.5 * apart(middle, a->axes[2]), 1)) - 2 * asin(fmin(0.5 * around, 1)) > a->horizon)
        return false;
    height_bounds(a, leaf, &lo, &hi);
    const double z_base = tc_field_info(a->s->head.field)->z_base;
    place[0] = atan2(middle[1], middle[0]), place[1] = atan2(middle[2], hypot(middle[0], middle[1]));
    place[2] = z_base + 0.5 * (lo + hi);
    double p[3], way[3] = {0}, radius = around * (a->most + hi) + 0.5 * (hi - lo);
    body->class->position(body, place, p);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            way[i] += a->axes[i][k] * (p[k] - a->eye[k]);
    radius += 1e-5 * (radius + fabs(way[0]) + fabs(way[1]) + fabs(way[2])); /* what float makes of it */
    return tc_frustum_sees_ball(&a->frustum, way, radius);
}

/* What faces.vert reads: the first sample in cells of the finest level; levels by which it is finer than its layer, and
 * cells along a side; layer, what the leaf says of its edges. */
static tc_instance instance(const assembly *a, const tc_leaf *leaf, int level, int64_t x, int64_t y, int cells)
{
    const int shift = a->s->lattice.levels - level, own = level < a->s->own ? level : a->s->own;
    const uint32_t layer = (uint32_t)(tc_first_layer(a->layers, leaf->block.chart) + own - 1);
    uint32_t how = (uint32_t)(level - own);
    while (cells >>= 1)
        how += 1u << 26;
    const uint32_t edges = (uint32_t)leaf->sides << 7 | (uint32_t)leaf->corners << 11 | (uint32_t)leaf->forced << 15 |
                           (uint32_t)leaf->finer_corners << 19 | (uint32_t)leaf->finer_halves << 23;
    tc_instance to = {.v = {(int32_t)(x << shift), (int32_t)(y << shift), (int32_t)how, (int32_t)(layer | edges)}};
    for (int k = 0; k < 4 && !a->v->head.options.no_morph; k++)
        to.corner[k] = tc_faces_corner(a->v, leaf, k);
    return to;
}

/* Closers along a leaf's sides: rows and columns of vertices, all of which are the coarser level's. */
static void add_closers(assembly *a, const tc_leaf *leaf, tc_rect samples, int cells)
{
    for (int side = 0; side < TC_SIDES; side++) {
        if (!(leaf->sides & 1 << side))
            continue;
        const bool column = side == TC_WEST || side == TC_EAST;
        const int64_t x = side == TC_EAST ? samples.x1 - 1 : samples.x0,
                      y = side == TC_NORTH ? samples.y1 - 1 : samples.y0;
        const tc_leaf along = {.block = leaf->block, .sides = 15, .corners = 15};
        /* From the end of the room on backwards, until all strips are known. */
        if (a->lists == a->s->lists)
            return;
        const int at = a->s->head.draw_capacity - 1 - a->lists++;
        a->frame->instances[at] = instance(a, &along, leaf->block.level, x, y, cells);
        a->frame->draws[at] = (tc_draw){.count = (uint32_t)(3 * (cells / 2)),
                                        .instance_count = 1,
                                        .first_index = column ? a->s->index.column_first : a->s->index.row_first};
    }
}

static void add_leaf(void *context, const tc_leaf *leaf)
{
    assembly *a = context;
    const tc_block b = leaf->block;
    const int level = b.level - leaf->coarse, side = a->s->lattice.side[b.level - 1], cells = side >> leaf->coarse;
    if (a->layers->ready[b.chart] < tc_min64(level, a->s->own))
        return; /* none of the chart is in sight */
    a->triangles_unculled += 2 * cells * cells;
    a->finest = level > a->finest ? level : a->finest;
    a->blocks++;
    if (!visible(a, leaf))
        return;
    const tc_rect r = tc_faces_samples(&a->s->lattice, b);
    a->triangles += 2 * cells * cells;
    a->levels[level - 1]++;
    a->frame->blocks[level - 1]++;
    if (tc_faces_by_error(a->v)) {
        float corner[4];
        for (int k = 0; k < 4; k++) { /* with what distance and missing blocks add */
            const double cell = ldexp(1, a->s->lattice.levels - level);
            const int64_t i = k & 1 ? cells : 0, j = k >> 1 ? cells : 0;
            double d[3];
            tc_faces_roughly(a->v, b.chart, (double)((r.x0 >> leaf->coarse) + i) * cell,
                             (double)((r.y0 >> leaf->coarse) + j) * cell, d);
            corner[k] = (float)tc_faces_alpha(a->v, leaf, level, cells, i, j, d);
        }
        a->off = fmax(a->off, tc_block_errors_bound(a->v->error, leaf, corner));
    }
    a->frame->instances[a->strips] = instance(a, leaf, level, r.x0 >> leaf->coarse, r.y0 >> leaf->coarse, cells);
    a->frame->draws[a->strips++] = (tc_draw){.count = tc_block_strip_count(cells, cells),
                                             .instance_count = 1,
                                             .first_index = a->s->index.strip_first[cells - 1]};
    if (leaf->sides && !a->v->head.options.no_closers && !a->v->head.options.no_stitch)
        add_closers(a, leaf, r, cells);
}

/* What faces.glsl says of surface[...], whole[...] and layer[...]. */
static void set_uniforms(assembly *a)
{
    const faces_view *v = a->v;
    const faces_surface *s = a->s;
    const tc_frame_options *options = &v->head.options;
    tc_frame *f = a->frame;
    float(*u)[4] = f->surface;
    int32_t(*whole)[4] = f->integers;
    tc_set4(u[0], v->axes[2][2], hypot(v->axes[2][0], v->axes[2][1]), 1 / (double)s->cells, v->height);
    const double reference = fmin(v->z_eye, s->z_hi);
    tc_set4(u[1], s->cell, reference, reference - (double)(float)reference, reference - v->z_eye);
    const double start = FACES_PASSED * (1 - FACES_PASSAGE), width = FACES_PASSED * FACES_PASSAGE;
    const bool passes = s->kind->morphs && !options->no_morph && !options->no_stitch;
    tc_set4(u[2], passes ? start : 1, passes ? 1 / width : 0, !options->no_stitch, v->from_pole);
    if (s->head.by_error)
        tc_set4(u[3], 1 / ldexp(s->shaded * exp2(-fmax(options->throttle, 0)), s->head.refined), start, 1 / width, 0);
    else
        tc_set4(u[3], 1 / v->range, v->edge, 8 * v->sag, s->kind->bends);
    const int32_t common[4] = {(int32_t)s->cells, s->head.refined, s->lattice.levels - 1};
    memcpy(whole[0], common, sizeof common);
    for (int chart = 0; chart < s->map->charts; chart++) {
        float(*vectors)[4] = u + FACES_FIRST_VECTOR + chart * FACES_VECTORS;
        int32_t(*integers)[4] = whole + FACES_FIRST_INTEGER + chart * FACES_INTEGERS;
        memset(vectors, 0, FACES_VECTORS * sizeof *vectors);
        memset(integers, 0, FACES_INTEGERS * sizeof *integers);
        s->kind->place(v, chart, vectors, integers);
        double at[2];
        for (int k = 0; k < 2; k++)
            at[k] = fmin(fmax(v->chart[chart][k], 0), (double)s->cells);
        const faces_spot here = tc_faces_spot(at[0], at[1]);
        tc_set4(vectors[FACES_VECTORS - 1], here.rest[0], here.rest[1], at[0] / (double)s->cells,
                at[1] / (double)s->cells);
        for (int side = 0; side < TC_SIDES; side++) {
            const tc_seam *seam = &s->lattice.seam[chart][side];
            int32_t *seams = integers[FACES_INTEGERS - TC_SIDES + side];
            seams[0] = seam->chart;
            for (int k = 0; k < 4; k++)
                seams[0] |= (seam->m[k] + 8) << (8 + 4 * k);
            seams[1] = (int32_t)(seam->dx * s->cells), seams[2] = (int32_t)(seam->dy * s->cells);
            seams[3] = side < 2 ? (int32_t)here.at[side] : 0;
        }
        const int first = tc_first_layer(a->layers, chart);
        for (int level = 1; level <= a->layers->held[chart]; level++) {
            const int shift = s->lattice.levels - level;
            const tc_rect clip = tc_clipmap_level(v->head.windows->clipmap[chart], level)->clip;
            tc_set4(f->layer[first + level - 1][0], chart, shift, level == 1 ? 0 : 1 / tc_faces_range(v, level),
                    first + a->layers->ready[chart] - 1);
            tc_set4(f->layer[first + level - 1][1], ldexp(at[0], -shift) - (double)clip.x0,
                    ldexp(at[1], -shift) - (double)clip.y0, 0, 0);
        }
    }
}

/* Whether all that a view calls for is held, and in the textures. */
static bool all_ready(const faces_view *v, const tc_layers *layers)
{
    bool all = true;
    for (int chart = 0; chart < v->head.windows->charts; chart++)
        all &= layers->ready[chart] == layers->held[chart] && tc_faces_all_held(v, chart);
    return all;
}

/* Whether cells on the mesh of the data's finest level may be drawn. */
static bool drawn_curved(const faces_view *v)
{
    const faces_surface *s = tc_faces_of(v);
    tc_rect blocks;
    bool any = !tc_faces_by_error(v) && v->finest > s->own;
    for (int chart = 0; chart < s->map->charts && tc_faces_by_error(v) && !any; chart++)
        any = s->own < s->lattice.levels && tc_block_bounds(&v->tree, chart, s->own + 1, &blocks);
    return any;
}

static void faces_draws(const tc_view *head, const tc_layers *layers, tc_frame *frame)
{
    const faces_view *v = (const faces_view *)head;
    const faces_surface *s = tc_faces_of(v);
    assembly a = {.v = v, .s = s, .layers = layers, .frame = frame, .frustum = tc_camera_frustum(&head->culled)};
    const double place[3] = {head->culled.x, head->culled.y, head->culled.z};
    s->map->body.class->position(&s->map->body, place, a.eye);
    s->map->body.class->axes(&s->map->body, place, a.axes);
    const double z_base = tc_field_info(s->head.field)->z_base;
    double least;
    s->map->body.class->curvatures(&s->map->body, &least, &a.most);
    a.most += z_base;
    a.horizon = tc_faces_horizon(v, head->culled.z - z_base);
    tc_block_tree *behind = &((faces_view *)head)->behind; /* of what is called for, where something is missing */
    const bool all = all_ready(v, layers);
    if (!all)
        tc_faces_tree(v, layers->ready, behind);
    tc_block_leaves(all ? &v->tree : behind, add_leaf, &a);
    for (int i = 0, end = s->head.draw_capacity - 1; i < a.lists; i++) {
        frame->draws[a.strips + i] = frame->draws[end - i];
        frame->instances[a.strips + i] = frame->instances[end - i];
    }
    for (int i = 0; i < a.strips + a.lists; i++)
        frame->draws[i].base_instance = (uint32_t)i;
    set_uniforms(&a);
    const double eye[3] = {head->camera.x, head->camera.y, head->camera.z};
    s->map->body.class->uniforms(&s->map->body, eye, z_base, frame->body);
    double z;
    frame->strip_draws = a.strips, frame->list_draws = a.lists;
    frame->triangles = a.triangles, frame->triangles_unculled = a.triangles_unculled;
    frame->draws_unculled = a.blocks;
    /* Cells that are drawn curved have a ridge of their own before the eye, where triangles are edge-on: a driver may
     * take one for a back, by its rounding, that alone covers a pixel. */
    frame->one_sided = !head->options.two_sided && !drawn_curved(v) && !tc_ground_voids(head->windows->clipmap[0], 1) &&
                       tc_faces_height_in(v, all ? &v->tree : behind, head->camera.x, head->camera.y, &z) &&
                       head->camera.z > z + 1e-6 * fabs(z);
    if (tc_faces_by_error(v))
        frame->error_bound = a.off * tc_camera_pixel_scale(&head->camera);
    frame->levels_active = 0;
    for (int level = s->lattice.levels; level >= 1; level--)
        frame->levels_active += a.levels[level - 1] > 0;
    frame->levels_fine = s->lattice.levels - a.finest;
    frame->levels_beyond = a.finest - frame->levels_active;
}

/* ---- Creation ---------------------------------------------------------------------------------------------------- */

static void faces_destroy(tc_surface *surface)
{
    faces_surface *s = (faces_surface *)surface;
    free(s->head.geometry.vertices);
    free(s->head.geometry.indices);
    free(s->index.strip_first);
    free(s);
}

static tc_status faces_windows(const tc_surface *surface, tc_windows *windows_ret, tc_error *error)
{
    const faces_surface *s = (const faces_surface *)surface;
    *windows_ret = (tc_windows){.charts = s->map->charts};
    tc_status status = TC_OK;
    for (int chart = 0; chart < s->map->charts && !status; chart++)
        status = tc_ground_create(s->map->chart[chart].field, &s->windows, &windows_ret->clipmap[chart], error);
    if (status)
        tc_windows_destroy(windows_ret);
    return status;
}

/* Levels until a cell's edge covers so little of the globe that its flat middle is but some 1e-10 of the radius too
 * low, a millimetre on an Earth. */
static int levels_until_flat(double cell)
{
    const double flat = 2.5e-5;
    int levels = 0;
    while (ldexp(flat, levels) < cell)
        levels++;
    return levels;
}

/* Cells of a block along a side, at most: smaller ones where each has an error of its own. */
static int block_side(const faces_surface *s)
{
    const int n = s->windows.n;
    return s->head.by_error ? (int)tc_clamp64((n + 1) / 128, 8, 16) : (n + 1) / 16;
}

/* The longest way between two corners of a cell, in mean cells: of 64 x 64 on a chart, all of which are alike. */
static double longest_diagonal(const faces_surface *s)
{
    enum { CELLS = 64 };
    const double cell = (double)s->cells / CELLS;
    double most = 0, p[4][3];
    for (int k = 0; k < CELLS * CELLS; k++) {
        for (int c = 0; c < 4; c++)
            tc_faces_normal(s, 0, (k % CELLS + (c & 1)) * cell, ((int)(k / CELLS) + (c >> 1)) * cell, p[c]);
        most = fmax(most, fmax(apart(p[0], p[3]), apart(p[1], p[2])));
    }
    return 1.05 * most / (s->cell * cell);
}

/* Distance up to which the finest level of windows of n samples is drawn: a window reaches (n - 1) / 2 cells to all
 * sides of the viewer; a block lies partly beyond what asks for it, and windows begin on even samples. */
static double range_in(const faces_surface *s, int n)
{
    return s->cell * ((n - 1) / 2 - s->lattice.side[s->lattice.levels - 1] - 2) / s->kind->reach;
}

/* Levels of the windows, from one that is coarse enough to be seen from afar; those on the mesh of the data's finest
 * one; and blocks of them. */
static tc_status set_lattice(faces_surface *s, tc_error *error)
{
    const tc_map *map = s->map;
    const tc_field *field = map->chart[0].field;
    int first = tc_field_info(field)->levels;
    int64_t coarsest = tc_field_level(field, first).width - 1;
    const int finest = first, most = TC_MAX_LAYERS / map->charts;
    /* With a tolerance down to one that costs little where it is all that is needed. */
    const int64_t whole = s->head.by_error ? 32 : (s->windows.n + 1) / 4;
    while (first > 1 && coarsest % 4 == 0 &&
           (coarsest >= s->windows.n || (coarsest > whole && finest - first + 1 < most)))
        first--, coarsest /= 2;
    s->windows.coarsest = (int)coarsest + 1;
    int levels = finest - first + 1;
    if (s->windows.max_levels && levels > s->windows.max_levels)
        levels = s->windows.max_levels;
    /* Places are 32-bit numbers, also what seams make of them. What is finer than that has room for is left out where
     * it is made up. */
    enum { MOST_CELLS = 1 << 29 };
    const int data = levels - tc_field_info(field)->synthesised;
    while (levels > 1 && levels > data &&
           (levels > most || tc_field_level(field, first + levels - 1).width - 1 > MOST_CELLS))
        levels--;
    s->own = s->windows.max_levels = levels;
    s->cells = tc_field_level(field, first + levels - 1).width - 1;
    if (s->cells > MOST_CELLS)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected at most 2^29 samples along a chart's side, found %lld",
                       s->kind->name, (long long)s->cells);
    if (levels > most)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected at most %d levels of detail, found %d", s->kind->name,
                       most, levels);
    s->cut = first + levels - 1 < finest;
    if (!s->cut)
        s->head.refined = levels_until_flat(M_PI / 2 / (double)s->cells);
    if (levels + s->head.refined > TC_BLOCK_LEVELS)
        s->head.refined = TC_BLOCK_LEVELS - levels;
    s->cells <<= s->head.refined;
    s->cell = M_PI / 2 / (double)s->cells;
    if (!tc_block_lattice_set(&s->lattice, map->chart, map->charts, tc_field_level(field, finest).width - 1, s->cells,
                              levels + s->head.refined, block_side(s)))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected charts of 16 to 31 cells halved again, found %lld cells", s->kind->name,
                       (long long)s->cells);
    return TC_OK;
}

/* The most draws: as many blocks as a tree has room for; and of closers as many as a window full of blocks can have
 * sides to coarser ones, every second one of 16 x 16 being held. */
static void set_capacity(faces_surface *s)
{
    const int across = TC_BLOCKS_ACROSS;
    s->strips = s->map->charts * s->lattice.levels * across * across;
    s->lists = s->map->charts * s->lattice.levels * across * across / 2;
    s->head.draw_capacity = s->strips + s->lists;
}

tc_status tc_faces_create(const tc_map *map, const tc_faces_options *options, tc_surface **surface_ret, tc_error *error)
{
    static const tc_surface_words words = {.levels = "levels",
                                           .blocks = "blocks",
                                           .fine = "too fine for the height above ground",
                                           .beyond = "beyond the horizon or outside the view",
                                           .outside = "beyond the horizon or outside the view",
                                           .charts = true};
    static const char *const defines[] = {"CLIMATE", TC_GLOBE_RELIEF_DEFINE, "TOLERANCE", NULL},
                             *const plain[] = {"CLIMATE", TC_GLOBE_RELIEF_DEFINE, NULL};
    const bool by_error = options->shaded_n > 0;
    const faces_kind *kind = options->kind;
    const int n = options->n ? options->n : 255;
    if (tc_clipmap_check_n(n, error) != TC_OK)
        return TC_ERR_USAGE;
    if (n < TC_FACES_LEAST_N)
        return tc_fail(error, TC_ERR_USAGE, "--n: expected at least %d, found %d", TC_FACES_LEAST_N, n);
    if (map->chart[0].class != kind->chart || map->charts != kind->charts)
        return tc_fail(
            error, TC_ERR_UNSUPPORTED,
            "%s: expected a planet in charts of that kind, found one in %s; `terraclip pack --planet --atlas "
            "%s` makes them",
            kind->name, map->chart[0].class->name, kind->chart->name);
    faces_surface *s = calloc(1, sizeof *s);
    if (!s)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", kind->name);
    s->kind = kind;
    s->map = map;
    s->windows = (tc_ground_options){.n = n,
                                     .max_levels = options->max_levels,
                                     .normals = options->normals,
                                     .fine_normals = options->fine_normals,
                                     .holes = options->holes,
                                     .relief = TC_GLOBE_RELIEF};
    const char *const body = map->body.class->glsl, *const chart = kind->chart->glsl;
    const char *const vertex[] = {body, kind->metric, "faces.glsl", chart, "faces.vert", NULL};
    /* Without a tolerance fragments need no distance: the first one is left out. */
    const char *const fragment[] = {kind->metric, body,         "faces.glsl", chart, "air.glsl",
                                    "globe.glsl", "shown.glsl", "faces.frag", NULL};
    const char *const sky[] = {"air.glsl", body, "globe_sky.frag", NULL};
    memcpy(s->vertex_parts, vertex, sizeof vertex);
    memcpy(s->fragment_parts, fragment, sizeof fragment);
    memcpy(s->sky_parts, sky, sizeof sky);
    s->head = (tc_surface){.name = kind->name,
                           .words = &words,
                           .defines = by_error ? defines : plain,
                           .vertex_parts = s->vertex_parts,
                           .fragment_parts = s->fragment_parts + !by_error,
                           .sky_parts = s->sky_parts,
                           .closers = true,
                           .instances = true,
                           .own_haze = true,
                           .near_plane = 1e-4 * fmin(1, map->body.radius * 1e-3),
                           .extent = 2 * map->body.radius,
                           .body = map->body,
                           .field = map->chart[0].field,
                           .n = n,
                           .most_throttle = 3,
                           .shaded_n = options->shaded_n,
                           .by_error = by_error,
                           .view_bytes = by_error ? sizeof(faces_error_view) : sizeof(faces_view),
                           .make_windows = faces_windows,
                           .look = tc_faces_look,
                           .wanted = tc_faces_wanted,
                           .stand = tc_faces_stand,
                           .draws = faces_draws,
                           .height = tc_faces_drawn_height,
                           .destroy = faces_destroy};
    for (int k = 0; k < map->charts && by_error; k++)
        tc_field_know_errors(map->chart[k].field);
    s->shear.turn = kind->chart->turn;
    s->windows.shear = kind->chart->turn ? &s->shear : NULL;
    tc_status status = set_lattice(s, error);
    if (status == TC_OK) {
        s->range = range_in(s, n);
        s->shaded = options->shaded_n ? range_in(s, options->shaded_n) : 0;
        s->diagonal = longest_diagonal(s);
        s->windows.spacing_x = s->windows.spacing_y = ldexp(s->cell * map->body.radius, s->head.refined);
        const tc_range heights = tc_map_range(map);
        s->z_lo = heights.lo, s->z_hi = heights.hi;
        set_capacity(s);
        status = tc_block_geometry_make(block_side(s), &s->head.geometry, &s->index, error);
    }
    if (status != TC_OK) {
        faces_destroy(&s->head);
        return status;
    }
    *surface_ret = &s->head;
    return TC_OK;
}
