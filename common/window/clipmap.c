/* clipmap.c - a geometry clipmap: its levels and their arrays, how they are filled, and what is asked about them. */
#include "clipmap_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/camera.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/base/status.h"

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

int64_t tc_clipmap_side(const tc_clipmap *c, const tc_content_class *content)
{
    return (int64_t)content->scale * (c->n + 1);
}

static size_t array_bytes(const tc_clipmap *c, const tc_content_class *content)
{
    size_t side = (size_t)tc_clipmap_side(c, content);
    return side * side * tc_texel_bytes(content->format);
}

static size_t scratch_bytes(const tc_clipmap *c)
{
    size_t most = 1; /* never none, or it would look like no memory */
    for (int k = 0; k < c->contents; k++) {
        const tc_content_class *content = c->content[k].class;
        size_t bytes = content->scratch_bytes(c->n);
        size_t row = (size_t)(tc_clipmap_side(c, content) + 2 * content->border) * tc_texel_bytes(content->format);
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
    s->view.extent = tc_clipmap_extent(c->field, s->field_level);
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

static int first_level(const tc_field *field, int n, int coarsest, bool wraps)
{
    int first = tc_field_info(field)->levels;
    while (first > 1 &&
           (!fits_window(field, first, wraps, n) || (coarsest > 0 && tc_field_level(field, first).width > coarsest)))
        first--;
    return first;
}

int tc_clipmap_coarsest(const tc_field *field, int n, int coarsest)
{
    return first_level(field, n, coarsest, false);
}

tc_rect tc_clipmap_extent(const tc_field *field, int field_level)
{
    const int finest = tc_field_info(field)->levels;
    const tc_level top = tc_field_level(field, finest);
    return (tc_rect){0, 0, vertices_to_edge(top.width - 1, finest - field_level),
                     vertices_to_edge(top.height - 1, finest - field_level)};
}

tc_status tc_clipmap_fill_contents(tc_clipmap *c, int level, tc_rect rect, bool *late)
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
                           .size = tc_clipmap_side(c, c->content[k].class),
                           .scratch = c->scratch};
        status = c->content[k].class->fill(&f);
    }
    return status;
}

tc_status tc_clipmap_fill(tc_clipmap *c, int level, tc_rect rect)
{
    tc_status status = tc_clipmap_fill_contents(c, level, rect, NULL);
    if (!status)
        tc_clipmap_changed(&c->level[level - 1], rect);
    return status;
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
    int first = first_level(field, n, options->coarsest, options->wraps);
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
    tc_clipmap_ask_nothing(clipmap);
    for (int l = 0; l < TC_MAX_LEVELS; l++)
        for (int k = 0; k < TC_MAX_CONTENTS; k++)
            free(clipmap->level[l].texels[k]);
    free(clipmap->scratch);
    free(clipmap);
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
