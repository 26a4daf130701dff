/* square_nests.c - LH04's nested grids: which blocks of which level a frame draws.
 *
 * A level's render region is its active region (LH04 section 3), or what a throttled frame leaves of it, without the
 * finer level's, cut into blocks along lines fixed in the map. */
#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "square_internal.h"

/* What is drawn of a level. */
typedef struct ring {
    int level;
    const tc_clip_level *l;
    tc_rect region, finer; /* drawn of the level, and of the finer one */
} ring;

/* A tile without the hole's part of it, in at most four blocks. */
static void add_tile(square_draws *a, int level, tc_rect tile, tc_rect hole)
{
    tc_rect h = tc_rect_intersect(tile, hole);
    if (tc_rect_empty(h)) {
        tc_square_add_block(a, level, tile, NULL);
        return;
    }
    tc_square_add_block(a, level, (tc_rect){tile.x0, tile.y0, tile.x1, h.y0}, NULL);
    tc_square_add_block(a, level, (tc_rect){tile.x0, h.y0, h.x0, h.y1}, NULL);
    tc_square_add_block(a, level, (tc_rect){h.x1, h.y0, tile.x1, h.y1}, NULL);
    tc_square_add_block(a, level, (tc_rect){tile.x0, h.y1, tile.x1, tile.y1}, NULL);
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

static void add_level(square_draws *a, const ring *g, bool closers)
{
    const tc_rect r = g->region, f = g->finer;
    tc_rect cells = {r.x0, r.y0, r.x1 - 1, r.y1 - 1}, hole = {0, 0, 0, 0};
    if (!tc_rect_empty(f))
        hole = (tc_rect){f.x0 / 2, f.y0 / 2, (f.x1 - 1) / 2, (f.y1 - 1) / 2};
    /* Rows and columns of tiles nearest first, so that what is hidden is seldom shaded. */
    int64_t b = a->s->index.block;
    tc_rect tiles = {cells.x0 / b, cells.y0 / b, (cells.x1 + b - 1) / b, (cells.y1 + b - 1) / b};
    int64_t eye_x = (a->viewer.snap_x >> g->l->shift) / b, eye_y = (a->viewer.snap_y >> g->l->shift) / b;
    for (int64_t v = 0; v < tiles.y1 - tiles.y0; v++) {
        int64_t y = b * nearest_first(v, tiles.y0, tiles.y1, eye_y);
        for (int64_t u = 0; u < tiles.x1 - tiles.x0; u++) {
            int64_t x = b * nearest_first(u, tiles.x0, tiles.x1, eye_x);
            add_tile(a, g->level, tc_rect_intersect(cells, (tc_rect){x, y, x + b, y + b}), hole);
        }
    }
    if (!closers)
        return;
    if (cells.y0 > g->l->extent.y0)
        tc_square_add_closers(a, g->level, cells.x0, cells.y0, cells.x1 - cells.x0, true);
    if (cells.y1 < g->l->extent.y1 - 1)
        tc_square_add_closers(a, g->level, cells.x0, cells.y1, cells.x1 - cells.x0, true);
    if (cells.x0 > g->l->extent.x0)
        tc_square_add_closers(a, g->level, cells.x0, cells.y0, cells.y1 - cells.y0, false);
    if (cells.x1 < g->l->extent.x1 - 1)
        tc_square_add_closers(a, g->level, cells.x1, cells.y0, cells.y1 - cells.y0, false);
}

static void nests_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                       const tc_frame_options *options, bool wait, tc_view *view)
{
    *view = tc_view_of(surface, windows, camera, options);
    ((square_view *)view)->viewer = tc_square_viewer(windows->clipmap[0], camera, wait);
}

static void nests_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    tc_square_wanted(view->windows->clipmap[0], view->surface->n, &((const square_view *)view)->viewer, wanted[0]);
}

static bool nests_height(const tc_view *view, double x, double y, double *z_ret)
{
    const square_view *v = (const square_view *)view;
    return tc_square_height(view->windows->clipmap[0], &v->viewer, &view->options, x, y, z_ret);
}

/* What vertices read of a level. */
static void set_morph(const square_draws *a, int level)
{
    const square_morph m = tc_square_morph(a->clipmap, level, &a->viewer, &a->view->options);
    float(*u)[4] = a->frame->layer[level - 1];
    for (int i = 0; i < 4; i++)
        u[0][i] = (float)m.start[i], u[1][i] = (float)m.rate[i];
    u[2][0] = (float)m.least;
}

static void nests_draws(const tc_view *view, const tc_layers *layers, tc_frame *frame)
{
    const square_view *v = (const square_view *)view;
    const tc_frame_options *options = &view->options;
    const tc_clipmap *clipmap = view->windows->clipmap[0];
    square_draws a = tc_square_begin_draws(v, frame);
    ring g = {.region = {0, 0, 0, 0}};
    bool skipped = false;
    frame->levels_active = 0;
    for (int level = layers->ready[0] + 1; level <= tc_clipmap_levels(clipmap); level++)
        skipped |= !tc_rect_empty(tc_square_region(clipmap, level, &a.viewer, options));
    for (int level = layers->ready[0]; level >= 1; level--) { /* nearest first */
        g = (ring){level, tc_clipmap_level(clipmap, level), tc_square_region(clipmap, level, &a.viewer, options),
                   g.region};
        if (tc_rect_empty(g.region))
            continue;
        frame->levels_active++;
        add_level(&a, &g, !options->no_closers && !options->no_stitch);
    }
    for (int level = 1; level <= tc_clipmap_levels(clipmap); level++)
        set_morph(&a, level);
    frame->levels_fine = tc_clipmap_levels(clipmap) - frame->levels_active;
    tc_square_end_draws(&a, v, !skipped);
}

static int nests_block(const square_surface *s)
{
    const int n = s->windows.n;
    return n + 1 >= 128 ? (n + 1) / 16 : 8;
}

static tc_status nests_prepare(square_surface *s, tc_error *error)
{
    (void)error;
    const tc_level finest = tc_field_level(s->head.field, tc_field_info(s->head.field)->levels);
    const int n = s->windows.n, block = nests_block(s), across = (n + 1) / block + 1;
    /* A level of at most n - 1 cells meets `across` tiles a side; those that the hole's perimeter goes through, at most
     * across on each of its sides, are cut in up to four. */
    int most = 1; /* levels that no window holds as a whole, and the one that it does */
    for (int64_t size = tc_max64(finest.width, finest.height) - 1; size > n / 2 && most < TC_MAX_LEVELS; size /= 2)
        most++;
    s->strips = most * (across * across + 4 * across * 3);
    s->lists = most * 4 * across;
    s->head.wall_capacity = most * 8 * across + 1; /* the floor */
    s->head.most_throttle = tc_square_most_throttle(n);
    return TC_OK;
}

const square_way tc_square_nests = {.view_bytes = sizeof(square_view),
                                    .prepare = nests_prepare,
                                    .look = nests_look,
                                    .wanted = nests_wanted,
                                    .draws = nests_draws,
                                    .height = nests_height,
                                    .block = nests_block};
