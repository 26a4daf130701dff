/* square_horizon.c - square grids: blocks of a frame that lie behind nearer ground.
 *
 * As far as is known from height bounds. All around the eye the lowest horizon that the ground surely makes is kept, in
 * bins of directions: a ray in a bin that is below a block's lowest height anywhere over that block has met the ground
 * by then, since the eye is above it and the drawn surface has no gaps. Blocks come nearest first; a block whose
 * highest points are below the horizon in all of its bins is left out.
 *
 * Directions are (1 - p, p) in each quadrant, 0 <= p <= 1, and distances are told in that measure, |x| + |y|: slopes
 * of one direction compare as they do in metres. Where a direction enters a rectangle, and where it leaves it, grows or
 * falls with p along one side, so that a bin's least and most are those of its two ends. */
#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "square_internal.h"

static const double STEEPEST = 1; /* height over distance: what is seen more from above is not asked for */
/* Relative, of places and heights, that float makes of them. */
static const double ROUNDING = 1e-5;
static const double HEIGHT_ROUNDING = 3e-7;

/* A rectangle in a quadrant: |x| and |y|, what is beyond the quadrant cut off. */
typedef struct quarter {
    double x0, x1, y0, y1;
} quarter;

static double least_of(const double lo[2], const double hi[2], int axis, bool back)
{
    return back ? -hi[axis] : lo[axis];
}

/* fmin() and fmax() but for what is no number, in a place where their cost is seen. */
static double lesser(double a, double b)
{
    return a < b ? a : b;
}
static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* False: nothing of it lies in the quadrant. */
static bool quarter_of(const double lo[2], const double hi[2], int quadrant, quarter *ret)
{
    const bool west = quadrant & 1, south = quadrant & 2;
    *ret = (quarter){greater(0, west ? -hi[0] : lo[0]), west ? -lo[0] : hi[0], greater(0, south ? -hi[1] : lo[1]),
                     south ? -lo[1] : hi[1]};
    return ret->x1 > 0 && ret->y1 > 0;
}

/* One over a distance; of 0 so much that 0 times it is 0. */
static double inverse(double distance)
{
    return 1 / greater(distance, 1e-30);
}

/* Bins outside the view hide whatever is no steeper than STEEPEST. */
static void begin(square_horizon *h, const square_draws *a, double pixel)
{
    for (int q = 0; q < 4; q++)
        for (int b = 0; b < SQUARE_BINS; b++) {
            bool outside = false;
            for (int p = 0; p < 4 && !outside; p++) {
                const double *n = a->frustum.normal[p];
                const double beyond = STEEPEST * fabs(n[2]) + 4 * pixel * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                outside = true;
                for (int end = 0; end < 2; end++) {
                    const double t = (double)(b + end) / SQUARE_BINS, x = q & 1 ? t - 1 : 1 - t, y = q & 2 ? -t : t;
                    outside &= n[0] * x + n[1] * y + beyond < 0;
                }
            }
            h->bins[q][b] = outside ? (square_bin){INFINITY, -INFINITY, -INFINITY} : (square_bin){-INFINITY, 0, 0};
        }
}

/* Raises the horizon where each direction of a bin meets the block. */
static void raise(square_horizon *h, const square_box *box)
{
    const double lo[2] = {(double)box->lo[0], (double)box->lo[1]}, hi[2] = {(double)box->hi[0], (double)box->hi[1]},
                 z = (double)box->lo[2];
    for (int q = 0; q < 4; q++) {
        quarter r;
        if (!quarter_of(lo, hi, q, &r))
            continue;
        const int first = (int)ceil(r.y0 / (r.x1 + r.y0) * SQUARE_BINS),
                  end = r.x0 + r.y1 > 0 ? (int)floor(r.y1 / (r.x0 + r.y1) * SQUARE_BINS) : SQUARE_BINS;
        /* A height above the eye's counts most where the ray comes, one below where it goes. */
        const double x = inverse(z > 0 ? r.x0 : r.x1), y = inverse(z > 0 ? r.y0 : r.y1);
        /* That is the lesser slope either way. */
        double before = INFINITY;
        for (int b = first; b <= end; b++) {
            const double t = (double)b / SQUARE_BINS, slope = lesser(z * x * (1 - t), z * y * t),
                         both = lesser(before, slope);
            if (b > first && both > (double)h->bins[q][b - 1].slope)
                h->bins[q][b - 1] = (square_bin){(float)both, (float)r.x1, (float)r.y1};
            before = slope;
        }
    }
}

static bool hidden(const square_horizon *h, const square_box *box, double pixel)
{
    const double near_x = greater(0, greater((double)box->lo[0], -(double)box->hi[0])),
                 near_y = greater(0, greater((double)box->lo[1], -(double)box->hi[1])),
                 far = greater(fabs((double)box->lo[0]), fabs((double)box->hi[0])) +
                       greater(fabs((double)box->lo[1]), fabs((double)box->hi[1])),
                 z = (double)box->hi[2], more = 2 * pixel * far;
    if (greater(fabs((double)box->lo[2]), fabs(z)) >= STEEPEST * (near_x + near_y))
        return false;
    const double own_lo[2] = {(double)box->lo[0], (double)box->lo[1]},
                 own_hi[2] = {(double)box->hi[0], (double)box->hi[1]};
    const double lo[2] = {own_lo[0] - more, own_lo[1] - more}, hi[2] = {own_hi[0] + more, own_hi[1] + more};
    for (int q = 0; q < 4; q++) {
        quarter r;
        if (!quarter_of(lo, hi, q, &r))
            continue;
        if (r.x0 + r.y0 <= 0)
            return false;
        const double own_x = least_of(own_lo, own_hi, 0, q & 1), own_y = least_of(own_lo, own_hi, 1, q & 2);
        const int first = (int)(r.y0 / (r.x1 + r.y0) * SQUARE_BINS),
                  last = (int)lesser(r.y1 / (r.x0 + r.y1) * SQUARE_BINS, SQUARE_BINS - 1);
        const double x = inverse(z > 0 ? r.x0 : r.x1), y = inverse(z > 0 ? r.y0 : r.y1);
        for (int b = first; b <= last; b++) {
            const square_bin *bin = &h->bins[q][b];
            const double t = (double)b / SQUARE_BINS, u = (double)(b + 1) / SQUARE_BINS;
            const double slope = z > 0 ? lesser(z * x * (1 - t), z * y * u) : lesser(z * x * (1 - u), z * y * t);
            /* What makes the horizon must lie before the block: a line between them, the eye on its side. */
            if (slope + 2 * pixel * (1 + 2 * slope * slope) >= (double)bin->slope ||
                ((double)bin->x1 > own_x && (double)bin->y1 > own_y))
                return false;
        }
    }
    return true;
}

/* The order of boxes, nearest first, but for those that are about as near. */
static int sort(square_horizon *h, int boxes, double unit)
{
    enum { AN_OCTAVE = 16 };
    int16_t first[SQUARE_BUCKETS];
    memset(first, -1, sizeof first);
    for (int i = boxes - 1; i >= 0; i--) {
        const square_box *b = &h->boxes[i];
        const double x = greater(0, greater((double)b->lo[0], -(double)b->hi[0])),
                     y = greater(0, greater((double)b->lo[1], -(double)b->hi[1]));
        const int k = (int)lesser(AN_OCTAVE * log2(1 + (x + y) / unit), SQUARE_BUCKETS - 1);
        h->next[i] = first[k], first[k] = (int16_t)i;
    }
    int at = -1, head = -1;
    for (int k = 0; k < SQUARE_BUCKETS; k++)
        for (int i = first[k]; i >= 0; i = h->next[i]) {
            if (at < 0)
                head = i;
            else
                h->next[at] = (int16_t)i;
            at = i;
        }
    if (at >= 0)
        h->next[at] = -1;
    return head;
}

void tc_square_horizon_add(square_draws *a, int level, tc_rect cells, const double lo[3], const double hi[3])
{
    const tc_clip_level *l = tc_clipmap_level(a->clipmap, level);
    if (a->strips >= SQUARE_BOXES)
        return;
    square_box *box = &a->horizon->boxes[a->strips];
    *box = (square_box){.level = level, .triangles = (int32_t)(2 * (cells.x1 - cells.x0) * (cells.y1 - cells.y0))};
    const double edge[2] = {(double)(l->edge_x - a->viewer.snap_x) * a->spacing[0] - a->eye[0],
                            (double)(l->edge_y - a->viewer.snap_y) * a->spacing[1] - a->eye[1]};
    for (int i = 0; i < 2; i++) /* no further than vertices are */
        box->lo[i] = (float)lo[i], box->hi[i] = (float)lesser(hi[i], edge[i]);
    const double slack = HEIGHT_ROUNDING * greater(fabs(lo[2] + a->eye[2]), fabs(hi[2] + a->eye[2]));
    box->lo[2] = (float)(lo[2] - slack - ROUNDING * fabs(lo[2]));
    box->hi[2] = (float)(hi[2] + slack + ROUNDING * fabs(hi[2]));
}

void tc_square_horizon_cut(square_draws *a)
{
    square_horizon *h = a->horizon;
    tc_frame *frame = a->frame;
    const int boxes = a->strips < SQUARE_BOXES ? a->strips : SQUARE_BOXES;
    const double scale = lesser(tc_camera_pixel_scale(&a->view->camera), tc_camera_pixel_scale(&a->view->culled)),
                 pixel = 0.5 / scale + 2 * ROUNDING; /* half of one */
    begin(h, a, pixel);
    for (int next, i = sort(h, boxes, lesser(a->spacing[0], a->spacing[1])); i >= 0; i = next) {
        square_box *box = &h->boxes[i];
        next = h->next[i];
        box->hidden = hidden(h, box, pixel);
        if (!box->hidden)
            raise(h, box);
    }
    int kept = 0;
    for (int i = 0; i < a->strips; i++) {
        if (i < boxes && h->boxes[i].hidden) {
            frame->blocks[h->boxes[i].level - 1]--;
            a->triangles -= h->boxes[i].triangles;
            continue;
        }
        frame->draws[kept] = frame->draws[i];
        frame->instances[kept++] = frame->instances[i];
    }
    a->strips = kept;
}
