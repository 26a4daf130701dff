/* square_morph.c - the flat map's levels around a viewer: windows, transition regions, drawn heights.
 *
 * Windows are centred on the viewer and snapped to even samples (LH04 section 5); levels finer than the height above
 * ground calls for (h > 0.8 n g_l) are not wanted. LH04 drops them at 0.4: then the coarser level, of spacing G = 2
 * g_l, is seen from 0.2 n G on, twice as near as where LH04 takes the size of its triangles, 0.4 n G. In the transition
 * region of width n / 10 at a window's edge the heights pass over into the coarser level's (LH04 section 6.2). alpha
 * depends on the distance to the viewer, not to the snapped window, so it does not jump when a window moves. We add a
 * passage by height, so that nothing jumps either when a level is dropped on the way up: it has become the coarser
 * level by then.
 *
 * A throttled frame (LH04 section 1) is drawn as if windows were smaller, by 2^-throttle: alpha reaches 1 nearer to the
 * viewer, levels are dropped nearer to the ground, and what lies beyond that is left out. Windows themselves stay, so
 * that nothing has to be read again when there is more time. */
#include <math.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "square_internal.h"

static const double DROP_HEIGHT = 0.8;  /* of n g_l above ground: a level is dropped (LH04 section 5: 0.4) */
static const double FADE_HEIGHT = 0.64; /* from here on it passes into the coarser one */
static const double LEAST_SIDE = 17;    /* samples a side that throttling leaves: ramps then have all of their width */
static const double MOST_THROTTLE = 3;
static const double SATURATED = 1.5; /* cells within the window's half size where alpha is 1: the snapping moves
                                        the edge by up to 1, and half a cell covers rounding in float */
static const double CLEAR = 0.25;    /* cells between a ramp's start and the finer level, for the same reason */

/* ---- The viewer -------------------------------------------------------------------------------------------------- */

/* Cell that holds position p (finest samples), and the place within it; cells at the edge may be narrower. */
static int64_t find_cell(double p, int shift, int64_t edge, double *t_ret)
{
    double cell = ldexp(1, shift);
    int64_t i = tc_max64(0, tc_min64((int64_t)floor(p / cell), tc_ceil_shift(edge, shift) - 1));
    double start = (double)i * cell, end = fmin(start + cell, (double)edge);
    *t_ret = end > start ? (p - start) / (end - start) : 0;
    return i;
}

/* The cell of a level that finest position (px, py) is in; false where it is not in the region. */
static bool cell_of(const tc_clip_level *l, tc_rect region, double px, double py, int64_t cell_ret[2], double t_ret[2])
{
    tc_square_cell(l, px, py, cell_ret, t_ret);
    return tc_rect_contains(region, cell_ret[0], cell_ret[1]) &&
           tc_rect_contains(region, cell_ret[0] + 1, cell_ret[1] + 1);
}

void tc_square_cell(const tc_clip_level *l, double px, double py, int64_t cell_ret[2], double t_ret[2])
{
    cell_ret[0] = find_cell(px, l->shift, l->edge_x, &t_ret[0]);
    cell_ret[1] = find_cell(py, l->shift, l->edge_y, &t_ret[1]);
}

const float *tc_square_held(const tc_clipmap *clipmap, int level, int64_t i, int64_t j)
{
    const int64_t mask = tc_clipmap_n(clipmap);
    return tc_ground_heights(clipmap, level)[(j & mask) * (mask + 1) + (i & mask)];
}

bool tc_square_place(const tc_field *field, double x, double y, double place_ret[2])
{
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    const double px = x / finest.spacing_x, py = y / finest.spacing_y;
    place_ret[0] = px, place_ret[1] = py;
    return px >= 0 && py >= 0 && px <= (double)(finest.width - 1) && py <= (double)(finest.height - 1);
}

/* Height above ground in windows of the level, `side` samples wide. */
static double height_in(const tc_clipmap *clipmap, int level, double side, double height)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    return height / (side * fmax(l->spacing_x, l->spacing_y));
}
static double relative_height(const tc_clipmap *clipmap, int level, double height)
{
    return height_in(clipmap, level, tc_clipmap_n(clipmap), height);
}

/* Height above the ground that windows hold: of level after level for as long as the eye is low enough for it. A level
 * by whose own ground it would be too high says nothing, or it would be dropped and wanted in turns. */
static double held_height(const tc_clipmap *clipmap, double px, double py, double z)
{
    double height = 0;
    for (int level = 1; level <= tc_clipmap_levels(clipmap); level++) {
        int64_t cell[2];
        double t[2], c[4];
        if (level > 1 && relative_height(clipmap, level, height) > DROP_HEIGHT)
            break;
        const tc_clip_level *l = tc_clipmap_level(clipmap, level);
        if (!cell_of(l, l->active, px, py, cell, t))
            continue;
        for (int k = 0; k < 4; k++)
            c[k] = tc_square_held(clipmap, level, cell[0] + (k & 1), cell[1] + (k >> 1))[0];
        double own = fabs(z - tc_triangle_height(c[0], c[1], c[2], c[3], t[0], t[1]));
        if (level == 1 || relative_height(clipmap, level, own) <= DROP_HEIGHT)
            height = own;
    }
    return height;
}

square_viewer tc_square_viewer(const tc_clipmap *clipmap, const tc_camera *camera, bool wait)
{
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    square_viewer v = {.x = camera->x, .y = camera->y};
    double px = fmin(fmax(camera->x / finest.spacing_x, 0), (double)(finest.width - 1));
    double py = fmin(fmax(camera->y / finest.spacing_y, 0), (double)(finest.height - 1));
    v.snap_x = (int64_t)fmin(fmax(floor(camera->x / finest.spacing_x + 0.5), 0), (double)(finest.width - 1));
    v.snap_y = (int64_t)fmin(fmax(floor(camera->y / finest.spacing_y + 0.5), 0), (double)(finest.height - 1));
    v.rest_x = camera->x - (double)v.snap_x * finest.spacing_x;
    v.rest_y = camera->y - (double)v.snap_y * finest.spacing_y;
    double ground = 0, z = camera->z - tc_field_info(field)->z_base;
    if (wait && tc_field_height(field, camera->x, camera->y, &ground))
        ground = tc_field_info(field)->z_min;
    v.height = wait ? fabs(z - ground) : held_height(clipmap, px, py, z);
    return v;
}

/* ---- Windows ----------------------------------------------------------------------------------------------------- */

/* First and last sample of a window of n samples around v (in samples), even. Far outside any terrain v is cut off:
 * what matters is that the window does not touch it. Of a whole and odd n the last is n - 1 from the first. */
static int64_t window_start(double v, double n)
{
    v = fmin(fmax(v, -4e15), 4e15);
    return 2 * (int64_t)floor((v - (n - 1) / 2 + 1) / 2);
}
static int64_t window_end(double v, double n)
{
    v = fmin(fmax(v, -4e15), 4e15);
    return 2 * (int64_t)floor((v + (n - 1) / 2 + 1) / 2);
}

void tc_square_wanted(const tc_clipmap *clipmap, int n, const square_viewer *viewer, tc_rect *wanted)
{
    wanted[0] = tc_clipmap_level(clipmap, 1)->extent;
    for (int l = 2; l <= tc_clipmap_levels(clipmap); l++) {
        const tc_clip_level *level = tc_clipmap_level(clipmap, l);
        if (height_in(clipmap, l, n, viewer->height) > DROP_HEIGHT) {
            wanted[l - 1] = (tc_rect){0, 0, 0, 0};
            continue;
        }
        int64_t x = window_start(viewer->x / level->spacing_x, n), y = window_start(viewer->y / level->spacing_y, n);
        wanted[l - 1] = tc_rect_intersect(level->extent, (tc_rect){x, y, x + n, y + n});
    }
}

/* Samples a side of the windows as they are drawn. */
static double drawn_side(const tc_clipmap *clipmap, const tc_frame_options *options)
{
    double n = tc_clipmap_n(clipmap);
    return fmin(n, fmax(LEAST_SIDE, n * exp2(-fmax(options->throttle, 0))));
}

double tc_square_most_throttle(int n)
{
    return fmax(0, fmin(MOST_THROTTLE, log2(n / LEAST_SIDE)));
}

tc_rect tc_square_region(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                         const tc_frame_options *options)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    if (level == 1 || options->throttle <= 0)
        return l->active;
    double n = drawn_side(clipmap, options), x = viewer->x / l->spacing_x, y = viewer->y / l->spacing_y;
    if (height_in(clipmap, level, n, viewer->height) > DROP_HEIGHT)
        return (tc_rect){0, 0, 0, 0};
    tc_rect around = {window_start(x, n), window_start(y, n), window_end(x, n) + 1, window_end(y, n) + 1};
    tc_rect r = tc_rect_intersect(l->active, around);
    return r.x1 - r.x0 < 3 || r.y1 - r.y0 < 3 ? (tc_rect){0, 0, 0, 0} : r; /* no cell */
}

/* ---- Morph ------------------------------------------------------------------------------------------------------- */

/* One axis of the morph: the ramps at its low and its high side. */
typedef struct axis {
    int64_t lo, hi;               /* first and last sample drawn */
    int64_t extent_lo, extent_hi; /* of the map */
    int64_t fine_lo, fine_hi;     /* the finer level's region, in its samples; fine_lo > fine_hi: none */
    double snap;                  /* the snapped viewer, in samples of the level */
    double rest;                  /* the viewer beyond it, likewise */
} axis;

/* start[0], start[1] and rate[0], rate[1] of a square_morph, in cells relative to the snapped viewer. */
static void ramps(const axis *a, double n, const tc_frame_options *options, double *start, double *rate)
{
    double lo = (double)a->lo - a->snap, hi = (double)a->hi - a->snap;
    bool lo_meets = a->lo > a->extent_lo, hi_meets = a->hi < a->extent_hi; /* a coarser level goes on there */
    if (options->no_morph) { /* the perimeter alone, so that there is no crack */
        start[0] = lo + 0.75, start[1] = hi - 0.75;
        rate[0] = lo_meets ? 4 : 0, rate[1] = hi_meets ? 4 : 0;
        return;
    }
    double half = (n - 1) / 2 - SATURATED;
    double one_lo = a->rest - half, one_hi = a->rest + half; /* alpha reaches 1 */
    if (lo_meets)
        one_lo = fmax(one_lo, lo + 0.5);
    if (hi_meets)
        one_hi = fmin(one_hi, hi - 0.5);
    double w_lo = n / 10, w_hi = n / 10;
    if (a->fine_lo <= a->fine_hi) { /* alpha must be 0 where the finer level begins */
        w_lo = fmin(w_lo, fmax(0.5, (double)(a->fine_lo / 2) - a->snap - one_lo - CLEAR));
        w_hi = fmin(w_hi, fmax(0.5, one_hi - ((double)(a->fine_hi / 2) - a->snap) - CLEAR));
    }
    start[0] = one_lo + w_lo, start[1] = one_hi - w_hi;
    rate[0] = 1 / w_lo, rate[1] = 1 / w_hi;
}

double tc_square_least(const tc_clipmap *clipmap, int level, double n, double height)
{
    const double h = height_in(clipmap, level, n, height);
    return fmin(fmax((h - FADE_HEIGHT) / (DROP_HEIGHT - FADE_HEIGHT), 0), 1);
}

square_morph tc_square_morph(const tc_clipmap *clipmap, int level, const square_viewer *viewer,
                             const tc_frame_options *options)
{
    square_morph m = {.least = 0};
    if (level == 1 || options->no_stitch)
        return m;
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    const tc_field *field = tc_clipmap_field(clipmap);
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    double cell = ldexp(1, l->shift);
    double n = drawn_side(clipmap, options);
    tc_rect region = tc_square_region(clipmap, level, viewer, options), fine = {1, 1, 0, 0};
    if (level < tc_clipmap_levels(clipmap)) {
        tc_rect finer = tc_square_region(clipmap, level + 1, viewer, options);
        fine = tc_rect_empty(finer) ? fine : finer;
    }
    axis x = {region.x0, region.x1 - 1, l->extent.x0, l->extent.x1 - 1, fine.x0, fine.x1 - 1, 0, 0};
    axis y = {region.y0, region.y1 - 1, l->extent.y0, l->extent.y1 - 1, fine.y0, fine.y1 - 1, 0, 0};
    x.snap = (double)viewer->snap_x / cell, x.rest = viewer->rest_x / finest.spacing_x / cell;
    y.snap = (double)viewer->snap_y / cell, y.rest = viewer->rest_y / finest.spacing_y / cell;
    ramps(&x, n, options, &m.start[0], &m.rate[0]);
    ramps(&y, n, options, &m.start[2], &m.rate[2]);
    if (!options->no_morph)
        m.least = tc_square_least(clipmap, level, n, viewer->height);
    return m;
}

double tc_square_alpha(const square_morph *m, double x, double y)
{
    double a = fmax(fmax((m->start[0] - x) * m->rate[0], (x - m->start[1]) * m->rate[1]),
                    fmax((m->start[2] - y) * m->rate[2], (y - m->start[3]) * m->rate[3]));
    return fmin(fmax(fmax(a, m->least), 0), 1);
}

/* The drawn height of a vertex. */
static double vertex_height(const tc_clipmap *clipmap, int level, const square_morph *m, const square_viewer *viewer,
                            int64_t i, int64_t j)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    const float *z = tc_square_held(clipmap, level, i, j);
    double cell = ldexp(1, l->shift);
    double x = (double)(tc_min64(i << l->shift, l->edge_x) - viewer->snap_x) / cell;
    double y = (double)(tc_min64(j << l->shift, l->edge_y) - viewer->snap_y) / cell;
    double a = tc_square_alpha(m, x, y);
    return (1 - a) * (double)z[0] + a * (double)z[1];
}

bool tc_square_height(const tc_clipmap *clipmap, const square_viewer *viewer, const tc_frame_options *options, double x,
                      double y, double *z_ret)
{
    const tc_field *field = tc_clipmap_field(clipmap);
    double place[2];
    if (!tc_square_place(field, x, y, place))
        return false;
    for (int level = tc_clipmap_levels(clipmap); level >= 1; level--) {
        int64_t cell[2];
        double t[2], z[4];
        tc_rect region = tc_square_region(clipmap, level, viewer, options);
        if (!cell_of(tc_clipmap_level(clipmap, level), region, place[0], place[1], cell, t))
            continue;
        square_morph m = tc_square_morph(clipmap, level, viewer, options);
        for (int k = 0; k < 4; k++)
            z[k] = vertex_height(clipmap, level, &m, viewer, cell[0] + (k & 1), cell[1] + (k >> 1));
        *z_ret = tc_triangle_height(z[0], z[1], z[2], z[3], t[0], t[1]) + tc_field_info(field)->z_base;
        return true;
    }
    return false;
}
