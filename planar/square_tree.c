/* square_tree.c - square grids whose blocks are chosen by their error (common/blocks): LH04's windows, of which a frame
 * draws what its tolerance asks for.
 *
 * A block is drawn by its own level where its window may hold it, and where the coarser level is seen to be off by more
 * than the tolerance. Each of its corners has an alpha, the larger one of what the error leaves and of a ramp in the
 * distance, for what the windows end at; heights pass over by it, bilinearly within the block. All are told with the
 * draw: blocks of one level have the same alpha on the edge between them, and 1 next to a coarser one, bit for bit. */
#include <math.h>
#include <string.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/field.h"
#include "square_internal.h"

typedef struct tree_view {
    square_view square;
    double reach;          /* cells of a level, any, in which its blocks may be wanted */
    tc_block_tree tree;    /* of blocks that the view calls for */
    tc_block_tree held;    /* of what windows held of them when the view was made, */
    bool all;              /* unless that was all */
    tc_block_tree behind;  /* room for what a frame draws of them where something is missing */
    tc_block_errors error; /* of the view's blocks */
} tree_view;

/* Share of the reach in which heights pass over where windows end. */
static const double PASSAGE = 0.2;
/* Of the eye's height above the ground that counts as distance: a level is dropped at 0.8 n of its cells, as nests do.
 */
static const double HEIGHT_SHARE = 0.6;
enum { LEAST_SIDE = 8, MOST_SIDE = 16, COARSEST = 128 };

/* Cells of a level that all of its blocks' corners within them can be wanted of: a window reaches (n - 1) / 2 to all
 * sides, a block lies partly beyond the corner that asks for it, and windows begin on even samples. */
static double reach_of(int n, int side)
{
    return 0.5 * (n - 1) - side - 2;
}

/* As asked for, or by n; not so large that a level's alpha by distance would not be 0 around where the finer one ends,
 * nor so small that a window had more than there may be. */
static int tree_block(const square_surface *s)
{
    const int n = s->windows.n;
    int side = s->blocks.side ? s->blocks.side : (int)tc_clamp64((n + 1) / 64, LEAST_SIDE, MOST_SIDE);
    while (side > LEAST_SIDE && (0.5 - PASSAGE) * reach_of(n, side) < side)
        side /= 2;
    while (n + 1 > TC_BLOCKS_ACROSS * side)
        side *= 2;
    return side;
}

double tc_square_tree_reach(int n, int side)
{
    return (1 - PASSAGE) * reach_of(n, side);
}

static const square_surface *surface_of(const tree_view *v)
{
    return (const square_surface *)v->square.head.surface;
}

static const tc_clipmap *clipmap_of(const tree_view *v)
{
    return v->square.head.windows->clipmap[0];
}

/* ---- Blocks ----------------------------------------------------------------------------------------------------- */

static tc_range range_of(void *context, int chart, int level, tc_rect samples)
{
    const tc_clipmap *clipmap = clipmap_of(context);
    (void)chart;
    return tc_field_range(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, 1) + level - 1, samples);
}

/* Metres east and north of the eye of sample (x, y) of a level. */
static void way_to(const tree_view *v, int level, double x, double y, double way[2])
{
    const tc_clip_level *l = tc_clipmap_level(clipmap_of(v), level);
    const tc_field *field = tc_clipmap_field(clipmap_of(v));
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    const square_viewer *viewer = &v->square.viewer;
    way[0] = (fmin(ldexp(x, l->shift), (double)l->edge_x) - (double)viewer->snap_x) * finest.spacing_x - viewer->rest_x;
    way[1] = (fmin(ldexp(y, l->shift), (double)l->edge_y) - (double)viewer->snap_y) * finest.spacing_y - viewer->rest_y;
}

static void distance_of(void *context, int chart, int level, double x, double y, double lo, double hi, double *across,
                        double *apart)
{
    const tree_view *v = context;
    const double z = v->square.head.camera.z - tc_field_info(tc_clipmap_field(clipmap_of(v)))->z_base;
    double way[2];
    (void)chart;
    way_to(v, level, x, y, way);
    *across = hypot(way[0], way[1]);
    *apart = fabs(z - fmin(fmax(z, lo), hi));
}

/* alpha of a corner where all blocks that touch it are drawn by their level: the larger one of the distance's and the
 * error's, in 2^-16: so that what a shader interpolates of it along an edge is exact. */
static float corner_alpha(const tree_view *v, int level, int32_t x, int32_t y)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap_of(v), level);
    const tc_frame_options *options = &v->square.head.options;
    const int side = surface_of(v)->lattice.side[level - 1];
    double way[2];
    if (level == 1)
        return 0;
    way_to(v, level, (double)x * side, (double)y * side, way);
    const double high = HEIGHT_SHARE * v->square.viewer.height / fmax(l->spacing_x, l->spacing_y),
                 distance = fmax(fmax(fabs(way[0]) / l->spacing_x, fabs(way[1]) / l->spacing_y), high);
    double alpha = (distance / v->reach - (1 - PASSAGE)) / PASSAGE;
    if (alpha < 1 && v->error.tolerance > 0)
        alpha = fmax(alpha, tc_block_errors_alpha((tc_block_errors *)&v->error, 0, level, x, y));
    if (options->no_morph && alpha < 1)
        alpha = 0;
    return (float)(floor(fmin(fmax(alpha, 0), 1) * 65536) / 65536);
}

/* Of a corner of what a leaf is drawn by. What is drawn by the coarser mesh lies next to what is not, where that has an
 * alpha of 0 (block_errors.h). */
static float leaf_alpha(const tree_view *v, const tc_leaf *leaf, int k)
{
    if (leaf->coarse || v->square.head.options.no_stitch)
        return 0;
    if (leaf->corners >> k & 1)
        return 1;
    if (leaf->finer_corners >> k & 1)
        return 0;
    return corner_alpha(v, leaf->block.level, leaf->block.x + (k & 1), leaf->block.y + (k >> 1));
}

/* Its level and cells. */
static int mesh_of(const tree_view *v, const tc_leaf *leaf, tc_rect *cells)
{
    const int coarse = leaf->coarse;
    const tc_rect r = tc_block_rect(&surface_of(v)->lattice, leaf->block);
    *cells = (tc_rect){r.x0 >> coarse, r.y0 >> coarse, r.x1 >> coarse, r.y1 >> coarse};
    return leaf->block.level - coarse;
}

/* ---- The tree --------------------------------------------------------------------------------------------------- */

/* What is known while it is made. */
typedef struct growing {
    const tree_view *view;
    int ready; /* levels that are held; 0: all, as far as windows can reach */
} growing;

static bool wanted(void *context, tc_block b)
{
    const growing *g = context;
    if (g->ready)
        return tc_block_asked(&g->view->tree, b);
    for (int k = 0; k < 4; k++)
        if (corner_alpha(g->view, b.level, b.x + (k & 1), b.y + (k >> 1)) < 1)
            return true;
    return false;
}

static bool held(void *context, tc_block b)
{
    const growing *g = context;
    if (!g->ready)
        return true;
    const tc_rect r = tc_block_rect(&surface_of(g->view)->lattice, b);
    return b.level <= g->ready && tc_rect_within((tc_rect){r.x0, r.y0, r.x1 + 1, r.y1 + 1},
                                                 tc_clipmap_level(clipmap_of(g->view), b.level)->active);
}

static void make_tree(const tree_view *v, int ready, tc_block_tree *tree)
{
    growing g = {v, ready};
    const tc_block_rule rule = {wanted, held, &g};
    tc_block_tree_make(tree, &surface_of(v)->lattice, &rule);
}

/* Samples of all that the tree has of a level; empty: nothing. */
static tc_rect samples_called_for(const tree_view *v, int level)
{
    tc_rect blocks;
    const int64_t side = surface_of(v)->lattice.side[level - 1];
    if (!tc_block_bounds(&v->tree, 0, level, &blocks))
        return (tc_rect){0, 0, 0, 0};
    return tc_rect_intersect(tc_clipmap_level(clipmap_of(v), level)->extent,
                             (tc_rect){blocks.x0 * side, blocks.y0 * side, blocks.x1 * side + 1, blocks.y1 * side + 1});
}

static bool all_held(const tree_view *v)
{
    for (int level = 2; level <= tc_clipmap_levels(clipmap_of(v)); level++)
        if (!tc_rect_within(samples_called_for(v, level), tc_clipmap_level(clipmap_of(v), level)->active))
            return false;
    return true;
}

static void tree_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                      const tc_frame_options *options, bool wait, tc_view *view)
{
    const square_surface *s = (const square_surface *)surface;
    tree_view *v = (tree_view *)view;
    const double coarser = exp2(fmax(options->throttle, 0));
    const tc_clip_level *coarsest = tc_clipmap_level(windows->clipmap[0], 1);
    v->square.head = tc_view_of(surface, windows, camera, options);
    v->square.viewer = tc_square_viewer(windows->clipmap[0], camera, wait);
    v->reach = reach_of(s->windows.n, tree_block(s)) / coarser;
    tc_block_ground ground = {.lattice = &s->lattice,
                              .data = s->lattice.levels + s->cut,
                              .range = range_of,
                              .distance = distance_of,
                              .context = v};
    for (int k = 0; k < s->lattice.levels; k++)
        ground.diagonal[k] = ldexp(hypot(coarsest->spacing_x, coarsest->spacing_y) * s->lattice.side[k], -k);
    tc_block_errors_begin(&v->error, &ground, options->error * coarser / tc_camera_pixel_scale(camera));
    make_tree(v, 0, &v->tree);
    v->all = all_held(v);
    if (!v->all)
        make_tree(v, s->lattice.levels, &v->held);
}

static void tree_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    const tree_view *v = (const tree_view *)view;
    memset(wanted[0], 0, sizeof wanted[0]);
    wanted[0][0] = tc_clipmap_level(clipmap_of(v), 1)->extent;
    tc_square_wanted(clipmap_of(v), surface_of(v)->blocks.shaded_n, &v->square.viewer, wanted[0]);
    for (int level = 2; level <= surface_of(v)->lattice.levels; level++)
        wanted[0][level - 1] = tc_rect_around(wanted[0][level - 1], samples_called_for(v, level));
}

/* ---- Heights ---------------------------------------------------------------------------------------------------- */

/* Whether the samples of a level's cells are there still. */
static bool holds(const tree_view *v, int level, tc_rect cells)
{
    return tc_rect_within((tc_rect){cells.x0, cells.y0, cells.x1 + 1, cells.y1 + 1},
                          tc_clipmap_level(clipmap_of(v), level)->clip);
}

static bool tree_height(const tc_view *view, double x, double y, double *z_ret)
{
    const tree_view *v = (const tree_view *)view;
    const tc_block_lattice *lattice = &surface_of(v)->lattice;
    const tc_field *field = tc_clipmap_field(clipmap_of(v));
    double place[2], t[2], z[4];
    tc_rect cells;
    if (!tc_square_place(field, x, y, place))
        return false;
    tc_leaf leaf = tc_block_leaf_at(v->all ? &v->tree : &v->held, 0, place[0], place[1]);
    int level = mesh_of(v, &leaf, &cells);
    while (!holds(v, level, cells)) { /* the windows have moved since the tree was made */
        if (leaf.block.level == 1)
            return false;
        leaf = tc_block_leaf_above(lattice, &leaf);
        level = mesh_of(v, &leaf, &cells);
    }
    float corner[4];
    for (int k = 0; k < 4; k++)
        corner[k] = leaf_alpha(v, &leaf, k);
    int64_t cell[2];
    tc_square_cell(tc_clipmap_level(clipmap_of(v), level), place[0], place[1], cell, t);
    for (int k = 0; k < 4; k++) {
        const int64_t i = cell[0] + (k & 1), j = cell[1] + (k >> 1);
        const double side = lattice->side[level - 1], u = (double)(i - cells.x0) / side,
                     w = (double)(j - cells.y0) / side;
        const double alpha = tc_block_alpha_at(corner, u, w);
        const float *pair = tc_square_held(clipmap_of(v), level, i, j);
        z[k] = (1 - alpha) * (double)pair[0] + alpha * (double)pair[1];
    }
    *z_ret = tc_triangle_height(z[0], z[1], z[2], z[3], t[0], t[1]) + tc_field_info(field)->z_base;
    return true;
}

/* ---- Draws ------------------------------------------------------------------------------------------------------ */

typedef struct drawing {
    const tree_view *view;
    square_draws draws;
    int levels[TC_BLOCK_LEVELS]; /* leaves of each */
    double off;                  /* metres a metre of distance that any is off at most */
} drawing;

static void add_leaf(void *context, const tc_leaf *leaf)
{
    drawing *d = context;
    const tc_frame_options *options = &d->view->square.head.options;
    float corner[4];
    tc_rect cells;
    const int level = mesh_of(d->view, leaf, &cells);
    for (int k = 0; k < 4; k++)
        corner[k] = leaf_alpha(d->view, leaf, k);
    d->levels[level - 1]++;
    const int before = d->draws.strips;
    tc_square_add_block(&d->draws, level, cells, corner);
    if (d->draws.strips > before && d->view->error.tolerance > 0)
        d->off = fmax(d->off, tc_block_errors_bound((tc_block_errors *)&d->view->error, leaf, corner));
    if (options->no_closers || options->no_stitch)
        return;
    if (leaf->sides & 1 << TC_SOUTH)
        tc_square_add_closers(&d->draws, level, cells.x0, cells.y0, cells.x1 - cells.x0, true);
    if (leaf->sides & 1 << TC_NORTH)
        tc_square_add_closers(&d->draws, level, cells.x0, cells.y1, cells.x1 - cells.x0, true);
    if (leaf->sides & 1 << TC_WEST)
        tc_square_add_closers(&d->draws, level, cells.x0, cells.y0, cells.y1 - cells.y0, false);
    if (leaf->sides & 1 << TC_EAST)
        tc_square_add_closers(&d->draws, level, cells.x1, cells.y0, cells.y1 - cells.y0, false);
}

/* What fragments read for normals and colours: those of the level that LH04's windows of shaded_n samples would show.
 */
static void set_shading(const drawing *d, const tc_layers *layers)
{
    const tree_view *v = d->view;
    const square_viewer *viewer = &v->square.viewer;
    const double n = surface_of(v)->blocks.shaded_n;
    tc_frame *f = d->draws.frame;
    tc_set4(f->surface[1], 1.0 / surface_of(v)->index.block, viewer->rest_x / d->draws.spacing[0],
            viewer->rest_y / d->draws.spacing[1], 0);
    tc_set4(f->surface[2], (n - 1) / 2 - 1.5, 10 / n, 0, 0);
    int coarser = 0;
    for (int level = surface_of(v)->lattice.levels; level >= 1; level--) {
        const tc_clip_level *l = tc_clipmap_level(clipmap_of(v), level);
        float(*u)[4] = f->layer[level - 1];
        const double cell = ldexp(1, l->shift), least = tc_square_least(clipmap_of(v), level, n, viewer->height);
        tc_set4(u[0], (double)viewer->snap_x / cell - (double)l->clip.x0,
                (double)viewer->snap_y / cell - (double)l->clip.y0, least, 0);
        coarser += level > 1 && least >= 1 && coarser == l->shift;
    }
    f->integers[1][1] = layers->ready[0] - 1;
    f->integers[1][2] = coarser;
}

static void tree_draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    const tree_view *v = (const tree_view *)view;
    const int levels = surface_of(v)->lattice.levels;
    drawing d = {.view = v, .draws = tc_square_begin_draws(&v->square, frame)};
    tc_block_tree *behind = &((tree_view *)v)->behind;
    const bool all = layers->ready[0] == layers->held[0] && all_held(v);
    if (!all)
        make_tree(v, layers->ready[0], behind);
    tc_block_leaves(all ? &v->tree : behind, add_leaf, &d);
    frame->levels_active = 0;
    for (int level = 1; level <= levels; level++)
        frame->levels_active += d.levels[level - 1] > 0;
    frame->levels_fine = levels - frame->levels_active;
    if (v->error.tolerance > 0)
        frame->error_bound = d.off * tc_camera_pixel_scale(&view->camera);
    set_shading(&d, layers);
    tc_square_end_draws(&d.draws, &v->square, all);
}

/* ---- Creation --------------------------------------------------------------------------------------------------- */

static tc_status tree_prepare(square_surface *s, tc_error *error)
{
    const tc_field *field = s->head.field;
    const int finest = tc_field_info(field)->levels, n = s->windows.n;
    int64_t cells[TC_MAX_LEVELS][2];
    int levels = 0;
    if (n < TC_SQUARE_LEAST_N)
        return tc_fail(error, TC_ERR_USAGE, "--n: expected at least %d with --error, found %d", TC_SQUARE_LEAST_N, n);
    tc_field_know_errors(field);
    /* The clipmap's, coarse to fine; those that a window holds as a whole go on down to one that costs little where it
     * is all that is needed. */
    s->windows.coarsest = COARSEST;
    for (int level = tc_clipmap_coarsest(field, n, COARSEST); level <= finest && levels < TC_MAX_LEVELS;
         level++, levels++) {
        const tc_rect extent = tc_clipmap_extent(field, level);
        cells[levels][0] = extent.x1 - 1, cells[levels][1] = extent.y1 - 1;
    }
    s->cut = s->windows.max_levels && levels > s->windows.max_levels;
    if (s->cut)
        levels = s->windows.max_levels;
    if (!tc_block_lattice_cut(&s->lattice, levels, (const int64_t(*)[2])cells, tree_block(s)))
        return tc_fail(
            error, TC_ERR_UNSUPPORTED,
            "--error: expected a terrain of up to 2^33 samples a side, and no more than 128 times as long as "
            "wide, found %lld x %lld",
            (long long)tc_field_level(field, finest).width, (long long)tc_field_level(field, finest).height);
    s->strips = levels * TC_BLOCKS_ACROSS * TC_BLOCKS_ACROSS;
    s->lists = levels * TC_BLOCKS_ACROSS * TC_BLOCKS_ACROSS / 2;
    s->head.wall_capacity = levels * 4 * TC_BLOCKS_ACROSS + 1; /* the floor */
    s->head.by_error = true;
    /* A block next to what a finer level's window can hold still has an alpha of 0. */
    s->head.most_throttle = fmax(0, fmin(3, log2((0.5 - PASSAGE) * reach_of(n, tree_block(s)) / tree_block(s))));
    return TC_OK;
}

static const char *const defines[] = {"TOLERANCE", NULL};
const square_way tc_square_tree = {.view_bytes = sizeof(tree_view),
                                   .prepare = tree_prepare,
                                   .look = tree_look,
                                   .wanted = tree_wanted,
                                   .draws = tree_draws,
                                   .height = tree_height,
                                   .block = tree_block,
                                   .vertex_defines = defines};
