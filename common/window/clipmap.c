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
#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/base/status.h"
#include "turn.h"

/* Where a region grows: beyond its four sides; where it begins. */
enum { SIDES = 4, BEGINNING = SIDES, PLACES };

/* What could not be read there: the other sides go on meanwhile. */
typedef struct pause {
    int failures;      /* in a row */
    double not_before; /* when to try again */
} pause;

typedef struct clip_state {
    tc_clip_level view;
    int field_level;
    int64_t width;                 /* samples that the field has at this level; vertices beyond lie on the edge */
    void *texels[TC_MAX_CONTENTS]; /* toroidal */
    tc_rect changes[TC_MAX_CHANGES];
    uint64_t changed; /* how often; the last ones are in changes[(k - 1) % TC_MAX_CHANGES] */
    pause pause[PLACES];
} clip_state;

struct tc_clipmap {
    const tc_field *field;
    int n, levels, contents;
    tc_content content[TC_MAX_CONTENTS];
    clip_state level[TC_MAX_LEVELS]; /* [l - 1] */
    void *scratch;
    tc_status failed; /* of the last filling that failed, while any level waits to be read again */
};

/* Seconds until what could not be read is tried again: first, and at most. */
static const double FIRST_PAUSE = 0.25, LONGEST_PAUSE = 30;

size_t tc_texel_bytes(tc_texel_format format)
{
    static const size_t bytes[TC_TEXEL_FORMATS] = {[TC_TEXEL_RG32F] = 8,
                                                   [TC_TEXEL_RGBA8_SNORM] = 4,
                                                   [TC_TEXEL_RGBA16_SNORM] = 8,
                                                   [TC_TEXEL_SRGB8_ALPHA8] = 4,
                                                   [TC_TEXEL_R8] = 1};
    return bytes[format];
}

static const clip_state *state(const tc_clipmap *clipmap, int level)
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
int tc_clipmap_contents(const tc_clipmap *clipmap)
{
    return clipmap->contents;
}
const tc_content_class *tc_clipmap_content(const tc_clipmap *clipmap, int content)
{
    return clipmap->content[content].class;
}
const void *tc_clipmap_texels(const tc_clipmap *clipmap, const tc_content_class *content, int level)
{
    for (int k = 0; k < clipmap->contents; k++)
        if (clipmap->content[k].class == content)
            return state(clipmap, level)->texels[k];
    return NULL;
}

/* Texels along a side of a content's arrays. */
static int64_t side_of(const tc_clipmap *c, const tc_content_class *content)
{
    return (int64_t)content->scale * (c->n + 1);
}

static size_t array_bytes(const tc_clipmap *c, const tc_content_class *content)
{
    size_t side = (size_t)side_of(c, content);
    return side * side * tc_texel_bytes(content->format);
}

static size_t scratch_bytes(const tc_clipmap *c)
{
    size_t most = 1; /* never none, or it would look like no memory */
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        size_t bytes = content->scratch_bytes(c->n);
        size_t row = (size_t)(side_of(c, content) + 2 * content->border) * tc_texel_bytes(content->format);
        most = bytes > most ? bytes : most;
        most = row > most ? row : most;
    }
    return most;
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
    clip_state *s = &c->level[level - 1];
    int finest = tc_field_info(c->field)->levels;
    tc_level top = tc_field_level(c->field, finest), own = tc_field_level(c->field, s->field_level);
    s->width = own.width;
    s->view.shift = finest - s->field_level;
    s->view.spacing_x = options->spacing_x > 0 ? ldexp(options->spacing_x, s->view.shift) : own.spacing_x;
    s->view.spacing_y = options->spacing_y > 0 ? ldexp(options->spacing_y, s->view.shift) : own.spacing_y;
    s->view.edge_x = top.width - 1;
    s->view.edge_y = top.height - 1;
    s->view.extent = (tc_rect){0, 0, vertices_to_edge(s->view.edge_x, s->view.shift),
                               vertices_to_edge(s->view.edge_y, s->view.shift)};
    s->view.wraps = options->wraps;
    if (s->view.wraps) {
        s->view.edge_x = ENDLESS;
        s->view.extent.x1 = (ENDLESS >> s->view.shift) + 1;
        s->view.extent.x0 = 1 - s->view.extent.x1;
    }
    for (int k = 0; k < c->contents; k++)
        if (!(s->texels[k] = calloc(1, array_bytes(c, c->content[k].class))))
            return TC_ERR_MEMORY;
    return TC_OK;
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

int tc_clipmap_coarsest(const tc_field *field, int n)
{
    int first = tc_field_info(field)->levels;
    while (first > 1 && !fits_window(field, first, false, n))
        first--;
    return first;
}

tc_rect tc_clipmap_extent(const tc_field *field, int field_level)
{
    const int finest = tc_field_info(field)->levels;
    const tc_level top = tc_field_level(field, finest);
    return (tc_rect){0, 0, vertices_to_edge(top.width - 1, finest - field_level),
                     vertices_to_edge(top.height - 1, finest - field_level)};
}

static void change(clip_state *s, tc_rect rect)
{
    s->changes[s->changed++ % TC_MAX_CHANGES] = rect;
}

/* late: NULL to wait for the field; else set where that would have been needed, and nothing is filled. */
static tc_status fill_contents(tc_clipmap *c, int level, tc_rect rect, bool *late)
{
    clip_state *s = &c->level[level - 1];
    tc_status status = TC_OK;
    for (int k = 0; k < c->contents && !status; k++) {
        const tc_fill f = {.clipmap = c,
                           .late = late,
                           .content = &c->content[k],
                           .level = level,
                           .rect = rect,
                           .texels = s->texels[k],
                           .coarse = level > 1 ? s[-1].texels[k] : NULL,
                           .size = side_of(c, c->content[k].class),
                           .scratch = c->scratch};
        status = c->content[k].class->fill(&f);
    }
    if (!status)
        change(s, rect);
    return status;
}

tc_status tc_clipmap_fill(tc_clipmap *c, int level, tc_rect rect)
{
    return fill_contents(c, level, rect, NULL);
}

tc_status tc_fill_read(const tc_fill *f, int level, tc_rect rect, void *samples, uint8_t *voids, ptrdiff_t stride)
{
    const tc_field *field = f->clipmap->field;
    if (!f->late)
        return tc_field_read_samples(field, level, rect, samples, voids, stride);
    tc_ready ready = tc_field_samples_ready(field, level, rect, samples, voids, stride, TC_SOON);
    *f->late = ready == TC_COMING;
    return ready == TC_READY ? TC_OK : TC_ERR_IO;
}

/* A part of the level cannot be read: its pause begins. */
static void put_off(tc_clipmap *c, int level, int place, tc_status why, double now)
{
    pause *p = &c->level[level - 1].pause[place];
    c->failed = why;
    p->not_before = now + fmin(ldexp(FIRST_PAUSE, p->failures < 16 ? p->failures : 16), LONGEST_PAUSE);
    p->failures++;
}

tc_status tc_clipmap_check_n(int n, tc_error *error)
{
    if (n < 15 || n > TC_CLIPMAP_MAX_N || (n & (n + 1)) != 0)
        return tc_fail(error, TC_ERR_USAGE, "n: expected 2^k - 1 from 15 to 2047, found %d", n);
    return TC_OK;
}

tc_status tc_clipmap_create(const tc_field *field, const tc_clipmap_options *options, tc_clipmap **clipmap_ret,
                            tc_error *error)
{
    int n = options->n ? options->n : 255;
    if (tc_clipmap_check_n(n, error) != TC_OK)
        return TC_ERR_USAGE;
    const tc_terrain_info *info = tc_field_info(field);
    tc_level top = tc_field_level(field, info->levels);
    int first = info->levels;
    while (first > 1 && (!fits_window(field, first, options->wraps, n) ||
                         (options->coarsest > 0 && tc_field_level(field, first).width > options->coarsest)))
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
    c->contents = options->contents;
    memcpy(c->content, options->content, sizeof c->content);
    c->scratch = malloc(scratch_bytes(c));
    tc_status status = c->scratch ? TC_OK : TC_ERR_MEMORY;
    for (int l = 1; l <= levels && !status; l++) {
        c->level[l - 1].field_level = first + l - 1;
        status = make_level(c, l, options);
    }
    if (status) {
        tc_clipmap_destroy(c);
        return tc_fail(error, status, "clipmap: not enough memory for %d levels of %dx%d", levels, n, n);
    }
    clip_state *s = &c->level[0];
    tc_rect whole = s->view.extent;
    if (s->view.wraps)
        whole.x0 = 0, whole.x1 = once_around(s->width);
    if ((status = tc_clipmap_fill(c, 1, whole))) {
        tc_clipmap_destroy(c);
        return tc_fail(error, status, "clipmap: the coarsest level cannot be read%s",
                       status == TC_ERR_MEMORY ? ": not enough memory" : "");
    }
    s->view.clip = s->view.active = s->view.wanted = whole;
    *clipmap_ret = c;
    return TC_OK;
}

void tc_clipmap_destroy(tc_clipmap *clipmap)
{
    if (!clipmap)
        return;
    for (int l = 0; l < TC_MAX_LEVELS; l++)
        for (int k = 0; k < TC_MAX_CONTENTS; k++)
            free(clipmap->level[l].texels[k]);
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

/* What a field is asked for at once where it is not waited for: as many lines as have about PIECE_SAMPLES samples. With
 * normals four times as many are read. */
enum { PIECE_SAMPLES = 1 << 16, PIECE_LINES = 128 };

static int64_t lines_a_piece(int64_t length)
{
    return tc_clamp64(PIECE_SAMPLES / tc_max64(length, 1), 1, PIECE_LINES);
}

/* Whether filling rect need not wait for the field. */
static tc_ready readiness(const tc_clipmap *c, int level, tc_rect rect)
{
    const clip_state *s = &c->level[level - 1];
    int own = 0, finer = -1;
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        own = content->reach > own ? content->reach : own;
        finer = content->reach_finer > finer ? content->reach_finer : finer;
    }
    tc_ready ready = tc_field_ready(c->field, s->field_level, tc_rect_grown(rect, own), TC_SOON), more = TC_READY;
    if (finer >= 0 && s->field_level < tc_field_info(c->field)->levels)
        more = tc_field_ready(c->field, s->field_level + 1, tc_rect_grown(refine(rect), finer), TC_SOON);
    return ready == TC_FAILED || more == TC_FAILED ? TC_FAILED : ready == TC_READY ? more : ready;
}

/* How an update is to be made. */
typedef struct effort {
    int64_t budget; /* samples; below 0: no limit */
    bool wait;      /* for what is not ready */
    bool at_once;   /* tries what could not be read, whatever its pause */
    double now;
} effort;

/* Lines first .. last - 1 beyond a side of r, counted outwards: columns in the west (0) and east (1), rows in the south
 * (2) and north (3). */
static tc_rect lines_beyond(tc_rect r, int side, int64_t first, int64_t last)
{
    switch (side) {
    case 0: return (tc_rect){r.x0 - last, r.y0, r.x0 - first, r.y1};
    case 1: return (tc_rect){r.x1 + first, r.y0, r.x1 + last, r.y1};
    case 2: return (tc_rect){r.x0, r.y0 - last, r.x1, r.y0 - first};
    default: return (tc_rect){r.x0, r.y1 + first, r.x1, r.y1 + last};
    }
}

/* How many of the lines beyond a side, from the innermost on, need not wait. The field is asked for them piece by piece
 * and no farther than the first that is not ready: a window comes as its parts do, those next to what is held first,
 * and no piece is too large for a cache to keep until it is used. *failed_ret: set where the next ones cannot be read.
 */
static int64_t ready_lines(const tc_clipmap *c, int level, tc_rect r, int side, int64_t lines, bool *failed_ret)
{
    int64_t piece = lines_a_piece(side < 2 ? r.y1 - r.y0 : r.x1 - r.x0), ready = 0;
    while (ready < lines) {
        int64_t next = tc_min64(lines, ready + piece);
        tc_ready answer = readiness(c, level, lines_beyond(r, side, ready, next));
        *failed_ret |= answer == TC_FAILED;
        if (answer != TC_READY)
            break;
        ready = next;
    }
    return ready;
}

/* The part of an empty region's first rectangle that need not wait: all of it, else its middle, else nothing. */
static tc_rect ready_seed(const tc_clipmap *c, int level, tc_rect first, bool *failed_ret)
{
    tc_rect none = {0, 0, 0, 0}, middle = seed(first, PIECE_SAMPLES / 4);
    tc_ready answer = tc_rect_empty(first) ? TC_COMING : readiness(c, level, middle);
    *failed_ret |= answer == TC_FAILED;
    if (answer != TC_READY)
        return none;
    tc_rect row = {first.x0, first.y0, first.x1, first.y0};
    return ready_lines(c, level, row, 3, first.y1 - first.y0, failed_ret) == first.y1 - first.y0 ? first : middle;
}

/* Adds a rectangle to what is held; returns its samples, none where it is empty, late, or cannot be read, which then is
 * put off. failed: its next part is known not to be read. */
static int64_t add_rect(tc_clipmap *c, int level, int place, tc_rect add, const effort *e, bool failed)
{
    tc_rect *clip = &c->level[level - 1].view.clip;
    bool late = false;
    tc_status status = tc_rect_empty(add) ? TC_OK : fill_contents(c, level, add, e->wait ? NULL : &late);
    if (late)
        return 0;
    if (status || failed)
        put_off(c, level, place, status ? status : TC_ERR_IO, e->now);
    else if (!tc_rect_empty(add))
        c->level[level - 1].pause[place].failures = 0;
    if (status || tc_rect_empty(add))
        return 0;
    *clip = tc_rect_empty(*clip) ? add
                                 : (tc_rect){tc_min64(clip->x0, add.x0), tc_min64(clip->y0, add.y0),
                                             tc_max64(clip->x1, add.x1), tc_max64(clip->y1, add.y1)};
    return tc_rect_area(add);
}

static bool pauses(const clip_state *s, int place, const effort *e)
{
    return !e->at_once && s->pause[place].failures && e->now < s->pause[place].not_before;
}

/* Adds rows and columns to what is held on its way to target; returns the samples filled. Without waiting, what the
 * field would have to decode first is left to a later call. */
static int64_t grow(tc_clipmap *c, int level, tc_rect target, effort e)
{
    clip_state *s = &c->level[level - 1];
    const tc_rect *clip = &s->view.clip;
    int64_t spent = 0;
    if (tc_rect_empty(target))
        return 0;
    if (tc_rect_empty(*clip) && !pauses(s, BEGINNING, &e)) {
        tc_rect first = seed(target, e.budget);
        bool failed = false;
        if (!e.wait)
            first = ready_seed(c, level, first, &failed);
        spent = add_rect(c, level, BEGINNING, first, &e, failed);
    }
    for (int side = 0; side < SIDES && !tc_rect_empty(*clip); side++) {
        int64_t missing[] = {clip->x0 - target.x0, target.x1 - clip->x1, clip->y0 - target.y0, target.y1 - clip->y1};
        int64_t length = side < 2 ? clip->y1 - clip->y0 : clip->x1 - clip->x0;
        int64_t lines = affordable(missing[side], length, e.budget < 0 ? -1 : tc_max64(0, e.budget - spent));
        bool failed = false;
        if (missing[side] == 0)
            s->pause[side].failures = 0;
        if (missing[side] == 0 || pauses(s, side, &e))
            continue;
        if (!e.wait)
            lines = ready_lines(c, level, *clip, side, lines, &failed);
        spent += add_rect(c, level, side, lines_beyond(*clip, side, 0, lines), &e, failed);
    }
    return spent;
}

/* Moves a level that holds all of a map which wraps: what comes in it has already. */
static int64_t move_round(tc_clipmap *c, int level, tc_rect target)
{
    clip_state *s = &c->level[level - 1];
    const tc_rect clip = s->view.clip, kept = tc_rect_intersect(clip, target);
    tc_rect add = target;
    if (!tc_rect_empty(kept) && kept.x0 > target.x0)
        add.x1 = kept.x0;
    else if (!tc_rect_empty(kept))
        add.x0 = kept.x1;
    if (tc_rect_empty(add))
        return 0;
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        tc_turn_texels(s->texels[k], side_of(c, content), tc_texel_bytes(content->format),
                       tc_content_rect(content, add), content->scale * clip.x0, content->scale * s->width, c->scratch);
    }
    change(s, add);
    s->view.clip = target;
    return tc_rect_area(add);
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

int64_t tc_clipmap_update(tc_clipmap *clipmap, const tc_rect *wanted, int64_t budget, bool wait, double now)
{
    int64_t samples = 0;
    for (int l = 1; l <= clipmap->levels; l++) {
        tc_clip_level *v = &clipmap->level[l - 1].view;
        if (l == 1 && v->wraps && !tc_rect_empty(wanted[0])) {
            int64_t width = v->clip.x1 - v->clip.x0; /* always whole */
            v->wanted = (tc_rect){wanted[0].x0, v->clip.y0, wanted[0].x0 + width, v->clip.y1};
            samples += move_round(clipmap, 1, v->wanted);
        } else if (l > 1) {
            const tc_clip_level *coarse = &clipmap->level[l - 2].view;
            tc_rect allowed = refine(erode(coarse->clip, coarse->extent, 1));
            /* No more than there will be room for within the coarser level, or it would be waited for for ever. */
            tc_rect room = refine(erode(coarse->wanted, coarse->extent, 1));
            v->wanted = tc_rect_intersect(tc_rect_intersect(wanted[l - 1], v->extent), room);
            tc_rect target = tc_rect_intersect(v->wanted, allowed);
            v->clip = tc_rect_intersect(v->clip, target);
            int64_t spent = grow(clipmap, l, target, (effort){budget, wait, wait, now});
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

tc_status tc_clipmap_failed(const tc_clipmap *clipmap)
{
    for (int l = 1; l <= clipmap->levels; l++) {
        const clip_state *s = state(clipmap, l);
        bool wants = !tc_rect_equal(s->view.clip, s->view.wanted);
        for (int place = 0; place < PLACES && wants; place++)
            if (s->pause[place].failures)
                return clipmap->failed;
    }
    return TC_OK;
}

int tc_clipmap_changes(const tc_clipmap *clipmap, int level, uint64_t *cursor, tc_rect changes[TC_MAX_CHANGES])
{
    const clip_state *s = state(clipmap, level);
    uint64_t since = *cursor;
    int count = 0;
    /* Of the first change on, a cursor is above 0. */
    *cursor = s->changed + 1;
    if (since == 0 || s->changed + 1 - since > TC_MAX_CHANGES) {
        changes[0] = s->view.clip;
        return tc_rect_empty(s->view.clip) ? 0 : 1;
    }
    for (uint64_t k = since - 1; k < s->changed; k++)
        changes[count++] = s->changes[k % TC_MAX_CHANGES];
    return count;
}

size_t tc_clipmap_bytes(const tc_clipmap *clipmap, const tc_content_class *content)
{
    if (!content)
        return scratch_bytes(clipmap);
    bool kept = tc_clipmap_texels(clipmap, content, 1) != NULL;
    return kept ? (size_t)clipmap->levels * array_bytes(clipmap, content) : 0;
}
