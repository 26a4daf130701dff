/* clipmap.c - the regions of a geometry clipmap and their update within a budget (LH04 sections 3 to 5).
 *
 * Clip regions move coarse to fine. A region is a rectangle at all times: what leaves the wanted window is dropped,
 * then whole rows or columns are added at its sides until it is the wanted window or the budget is used up. The active
 * regions follow from the clip regions; LH04's four constraints hold after every update. Where the terrain ends both
 * levels end, so erosion stops there. */
#include "clipmap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/camera.h"
#include "clipmap_internal.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/base/status.h"

static const tc_clip_state *state(const tc_clipmap *clipmap, int level)
{
    return &clipmap->level[level - 1];
}

int tc_clipmap_n_for(const tc_camera *camera)
{
    double k = round(log2(0.8 * tc_camera_pixel_scale(camera)));
    return (1 << (int)fmin(fmax(k, 6), 11)) - 1;
}

int tc_clipmap_n(const tc_clipmap *clipmap)
{
    return clipmap->n;
}
int tc_clipmap_levels(const tc_clipmap *clipmap)
{
    return clipmap->levels;
}
const tc_field *tc_clipmap_field(const tc_clipmap *clipmap)
{
    return clipmap->field;
}
int tc_clipmap_field_level(const tc_clipmap *clipmap, int level)
{
    return state(clipmap, level)->field_level;
}
const tc_clip_level *tc_clipmap_level(const tc_clipmap *clipmap, int level)
{
    return &state(clipmap, level)->view;
}
const float (*tc_clipmap_heights(const tc_clipmap *clipmap, int level))[2]
{
    return state(clipmap, level)->heights;
}
const int8_t (*tc_clipmap_normals(const tc_clipmap *clipmap, int level))[4]
{
    return state(clipmap, level)->normals;
}
const uint8_t *tc_clipmap_voids(const tc_clipmap *clipmap, int level)
{
    return state(clipmap, level)->voids;
}

/* Vertices from 0 to the terrain's edge, rounded up so that the last one is even. */
static int64_t vertices_to_edge(int64_t edge, int shift)
{
    return 2 * tc_ceil_shift(edge, shift + 1) + 1;
}

/* The part of a level's rectangle that lies `distance` samples within, but up to the terrain's end where it reaches it.
 */
static tc_rect erode(tc_rect r, tc_rect extent, int64_t distance)
{
    if (tc_rect_empty(r))
        return r;
    r.x0 += r.x0 > extent.x0 ? distance : 0;
    r.y0 += r.y0 > extent.y0 ? distance : 0;
    r.x1 -= r.x1 < extent.x1 ? distance : 0;
    r.y1 -= r.y1 < extent.y1 ? distance : 0;
    return tc_rect_empty(r) ? (tc_rect){0, 0, 0, 0} : r;
}

/* The rectangle of a finer level's samples that spans r of the coarser one. */
static tc_rect refine(tc_rect r)
{
    return tc_rect_empty(r) ? r : (tc_rect){2 * r.x0, 2 * r.y0, 2 * r.x1 - 1, 2 * r.y1 - 1};
}

/* The largest rectangle within r whose first and last samples are even; empty where it would cover no cell. */
static tc_rect even_perimeter(tc_rect r)
{
    r.x0 += r.x0 & 1;
    r.y0 += r.y0 & 1;
    r.x1 -= (r.x1 - 1) & 1;
    r.y1 -= (r.y1 - 1) & 1;
    return r.x1 - r.x0 < 3 || r.y1 - r.y0 < 3 ? (tc_rect){0, 0, 0, 0} : r;
}

/* A column farther out than any viewer gets, in samples of the finest level: even on all levels. */
static const int64_t ENDLESS = INT64_C(1) << 50;

static tc_status make_level(tc_clipmap *c, int level, const tc_clipmap_options *options)
{
    tc_clip_state *s = &c->level[level - 1];
    int finest = tc_field_info(c->field)->levels;
    tc_level top = tc_field_level(c->field, finest), own = tc_field_level(c->field, s->field_level);
    s->width = own.width;
    s->height = own.height;
    s->view.shift = finest - s->field_level;
    s->view.spacing_x = options->spacing_x > 0 ? ldexp(options->spacing_x, s->view.shift) : own.spacing_x;
    s->view.spacing_y = options->spacing_y > 0 ? ldexp(options->spacing_y, s->view.shift) : own.spacing_y;
    s->view.edge_x = top.width - 1;
    s->view.edge_y = top.height - 1;
    s->view.extent = (tc_rect){0, 0, vertices_to_edge(s->view.edge_x, s->view.shift),
                               vertices_to_edge(s->view.edge_y, s->view.shift)};
    s->wraps = options->wraps;
    s->relief = tc_normal_relief(sqrt(s->view.spacing_x * s->view.spacing_y), options->relief);
    if (s->wraps) {
        s->view.edge_x = ENDLESS;
        s->view.extent.x1 = (ENDLESS >> s->view.shift) + 1;
        s->view.extent.x0 = 1 - s->view.extent.x1;
    }
    size_t count = (size_t)(c->n + 1) * (size_t)(c->n + 1);
    s->heights = calloc(count, sizeof *s->heights);
    s->normals = options->normals ? calloc(4 * count, sizeof *s->normals) : NULL;
    s->voids = options->holes ? calloc(count, 1) : NULL;
    return s->heights && (s->normals || !options->normals) && (s->voids || !options->holes) ? TC_OK : TC_ERR_MEMORY;
}

/* Once around with two samples more on either side and an even perimeter: half a turn from the viewer in either
 * direction is then held wherever between two even samples the viewer is. */
static int64_t once_around(int64_t width)
{
    return width + 5 - (width & 1);
}

/* Whether a window holds the whole of a level. */
static bool fits_window(const tc_field *field, int level, bool wraps, int n)
{
    const tc_terrain_info *info = tc_field_info(field);
    tc_level top = tc_field_level(field, info->levels);
    int shift = info->levels - level;
    int64_t x = wraps ? once_around(tc_field_level(field, level).width) : vertices_to_edge(top.width - 1, shift);
    return x <= n && vertices_to_edge(top.height - 1, shift) <= n;
}

tc_status tc_clipmap_create(const tc_field *field, const tc_clipmap_options *options, tc_clipmap **clipmap_ret,
                            tc_error *error)
{
    int n = options->n ? options->n : 255;
    if (n < 15 || n > TC_CLIPMAP_MAX_N || (n & (n + 1)) != 0)
        return tc_fail(error, TC_ERR_USAGE, "n: expected 2^k - 1 from 15 to 2047, found %d", n);
    const tc_terrain_info *info = tc_field_info(field);
    tc_level top = tc_field_level(field, info->levels);
    int first = info->levels;
    while (first > 1 && !fits_window(field, first, options->wraps, n))
        first--;
    if (options->wraps && !(tc_field_wraps(field, first) && fits_window(field, first, true, n)))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "terrain: expected a width of 2^k times at most %d samples to go round, found %lld", n - 5,
                       (long long)top.width);
    int levels = info->levels - first + 1;
    if (options->max_levels > 0 && options->max_levels < levels)
        levels = options->max_levels;
    if (levels > TC_MAX_LEVELS)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "clipmap: at most %d levels, the terrain needs %d", TC_MAX_LEVELS,
                       levels);
    if (top.width < 2 || top.height < 2)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "terrain: expected at least 2x2 samples, found %lldx%lld",
                       (long long)top.width, (long long)top.height);

    tc_clipmap *c = calloc(1, sizeof *c);
    if (!c)
        return tc_fail(error, TC_ERR_MEMORY, "clipmap: not enough memory");
    c->field = field;
    c->n = n;
    c->levels = levels;
    c->scratch = malloc(tc_fill_scratch(n, options->normals) * sizeof *c->scratch);
    tc_status status = c->scratch ? TC_OK : TC_ERR_MEMORY;
    for (int l = 1; l <= levels && !status; l++) {
        c->level[l - 1].field_level = first + l - 1;
        status = make_level(c, l, options);
    }
    if (status) {
        tc_clipmap_destroy(c);
        return tc_fail(error, status, "clipmap: not enough memory for %d levels of %dx%d", levels, n, n);
    }
    tc_clip_state *s = &c->level[0];
    tc_rect whole = s->view.extent;
    if (s->wraps)
        whole.x0 = 0, whole.x1 = once_around(s->width);
    tc_clipmap_fill(c, 1, whole);
    s->view.clip = s->view.active = s->view.wanted = whole;
    if (c->failed) {
        tc_clipmap_destroy(c);
        return tc_fail(error, TC_ERR_IO, "clipmap: the coarsest level cannot be read");
    }
    *clipmap_ret = c;
    return TC_OK;
}

void tc_clipmap_destroy(tc_clipmap *clipmap)
{
    if (!clipmap)
        return;
    for (int l = 0; l < TC_MAX_LEVELS; l++) {
        free(clipmap->level[l].heights);
        free(clipmap->level[l].normals);
        free(clipmap->level[l].voids);
    }
    free(clipmap->scratch);
    free(clipmap);
}

/* How many rows (or columns) of `length` samples to add of `missing`: what the budget allows. */
static int64_t affordable(int64_t missing, int64_t length, int64_t budget)
{
    return budget < 0 ? missing : tc_min64(missing, budget / length);
}

/* The first rectangle of an empty region: as much as the budget allows, which may be nothing, around the middle of its
 * target. */
static tc_rect seed(tc_rect target, int64_t budget)
{
    if (budget < 0 || tc_rect_area(target) <= budget)
        return target;
    int64_t side = 0;
    while ((side + 1) * (side + 1) <= budget)
        side++;
    int64_t x = (target.x0 + target.x1 - side) / 2, y = (target.y0 + target.y1 - side) / 2;
    return tc_rect_intersect(target, (tc_rect){x, y, x + side, y + side});
}

/* Whether filling rect need not wait for the pyramid. */
static bool is_ready(const tc_clipmap *c, int level, tc_rect rect)
{
    enum { REACH = 3 }; /* of normals and of the terrain's edge, at least */
    const tc_clip_state *s = &c->level[level - 1];
    tc_rect own = {rect.x0 - REACH, rect.y0 - REACH, rect.x1 + REACH, rect.y1 + REACH};
    bool ready = tc_field_ready(c->field, s->field_level, own);
    if (s->normals && s->field_level < tc_field_info(c->field)->levels)
        ready &= tc_field_ready(c->field, s->field_level + 1, refine(own));
    return ready;
}

/* Adds rows and columns to s->view.clip on its way to target; returns the samples filled. Without waiting, what
 * the pyramid would have to decode first is left to a later call. */
static int64_t grow(tc_clipmap *c, int level, tc_rect target, int64_t budget, bool wait)
{
    tc_clip_state *s = &c->level[level - 1];
    tc_rect *clip = &s->view.clip;
    int64_t spent = 0;
    if (tc_rect_empty(*clip) && !tc_rect_empty(target)) {
        tc_rect first = seed(target, budget);
        if (tc_rect_empty(first) || (!wait && !is_ready(c, level, first)))
            return 0;
        tc_clipmap_fill(c, level, first);
        *clip = first;
        spent += tc_rect_area(first);
    }
    for (int side = 0; side < 4 && !tc_rect_empty(target); side++) {
        int64_t w = clip->x1 - clip->x0, h = clip->y1 - clip->y0, left = budget < 0 ? -1 : tc_max64(0, budget - spent);
        tc_rect add = *clip, grown = *clip;
        switch (side) {
        case 0:
            grown.x0 -= affordable(clip->x0 - target.x0, h, left);
            add.x0 = grown.x0, add.x1 = clip->x0;
            break;
        case 1:
            grown.x1 += affordable(target.x1 - clip->x1, h, left);
            add.x0 = clip->x1, add.x1 = grown.x1;
            break;
        case 2:
            grown.y0 -= affordable(clip->y0 - target.y0, w, left);
            add.y0 = grown.y0, add.y1 = clip->y0;
            break;
        default: grown.y1 += affordable(target.y1 - clip->y1, w, left); add.y0 = clip->y1, add.y1 = grown.y1;
        }
        if (tc_rect_empty(add) || (!wait && !is_ready(c, level, add)))
            continue;
        tc_clipmap_fill(c, level, add);
        *clip = grown;
        spent += tc_rect_area(add);
    }
    return spent;
}

/* The active region: what is held, cropped so that the coarser level can surround it. */
static void set_active(tc_clipmap *c, int level)
{
    tc_clip_level *v = &c->level[level - 1].view;
    if (level == 1) {
        v->active = v->clip;
        return;
    }
    const tc_clip_level *coarse = &c->level[level - 2].view;
    tc_rect around = refine(erode(coarse->active, coarse->extent, 2));
    v->active = even_perimeter(tc_rect_intersect(v->clip, around));
}

int64_t tc_clipmap_update(tc_clipmap *clipmap, const tc_rect *wanted, int64_t budget, bool wait)
{
    int64_t samples = 0;
    for (int l = 1; l <= clipmap->levels; l++) {
        tc_clip_level *v = &clipmap->level[l - 1].view;
        if (l == 1 && clipmap->level[0].wraps && !tc_rect_empty(wanted[0])) {
            v->wanted = tc_rect_intersect(wanted[0], v->extent);
            v->clip = tc_rect_intersect(v->clip, v->wanted);
            samples += grow(clipmap, 1, v->wanted, -1, true); /* always whole */
        } else if (l > 1) {
            const tc_clip_level *coarse = &clipmap->level[l - 2].view;
            tc_rect allowed = refine(erode(coarse->clip, coarse->extent, 1));
            /* No more than there will be room for within the coarser level, or it would be waited for for ever. */
            tc_rect room = refine(erode(coarse->wanted, coarse->extent, 1));
            v->wanted = tc_rect_intersect(tc_rect_intersect(wanted[l - 1], v->extent), room);
            tc_rect target = tc_rect_intersect(v->wanted, allowed);
            v->clip = tc_rect_intersect(v->clip, target);
            int64_t spent = grow(clipmap, l, target, budget, wait);
            samples += spent;
            if (budget >= 0)
                budget = tc_max64(0, budget - spent);
        }
        set_active(clipmap, l);
    }
    return samples;
}

bool tc_clipmap_resident(const tc_clipmap *clipmap)
{
    for (int l = 1; l <= clipmap->levels; l++)
        if (!tc_rect_equal(state(clipmap, l)->view.clip, state(clipmap, l)->view.wanted))
            return false;
    return true;
}

bool tc_clipmap_failed(const tc_clipmap *clipmap)
{
    return clipmap->failed;
}

int tc_clipmap_take_changes(tc_clipmap *clipmap, int level, tc_rect changes[TC_MAX_CHANGES])
{
    tc_clip_state *s = &clipmap->level[level - 1];
    int count = s->change_count;
    memcpy(changes, s->changes, (size_t)count * sizeof *changes);
    s->change_count = 0;
    return count;
}

void tc_clipmap_bytes(const tc_clipmap *clipmap, size_t *heights_ret, size_t *normals_ret)
{
    size_t count = (size_t)(clipmap->n + 1) * (size_t)(clipmap->n + 1);
    *heights_ret = tc_fill_scratch(clipmap->n, clipmap->level[0].normals) * sizeof(float);
    *normals_ret = 0;
    for (int l = 0; l < clipmap->levels; l++) {
        *heights_ret += count * (sizeof(float[2]) + (clipmap->level[l].voids ? 1 : 0));
        *normals_ret += clipmap->level[l].normals ? 4 * count * sizeof(int8_t[4]) : 0;
    }
}
