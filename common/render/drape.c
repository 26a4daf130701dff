/* drape.c - which windows of colours a view wants, and where they lie relative to it.
 *
 * Windows have four texels to a sample that shading calls for along a side, up to the size that windows may have: at
 * the distances where a level begins its texels are then about a pixel. A level is wanted where any ground may be so
 * near that it shows: pixels there are no larger than two of its texels. */
#include "drape.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/content/colours.h"
#include "common/view/camera.h"

enum { DENSER = 4 };

/* By which the ground may be nearer to the eye than that below it, on a slope. */
static const double NEARER = 2;

/* ---- Windows ------------------------------------------------------------------------------------------------------
 */

/* At least what a level that wraps needs to be held as a whole. */
static int window_size(const tc_surface *surface)
{
    enum { LEAST = 255 };
    int n = DENSER * ((surface->shaded_n ? surface->shaded_n : surface->n) + 1) - 1;
    return n < LEAST ? LEAST : n > TC_CLIPMAP_MAX_N ? TC_CLIPMAP_MAX_N : n;
}

tc_status tc_drape_create(const tc_gl *gl, const tc_imagery *imagery, const tc_surface *surface, tc_drape *drape_ret,
                          tc_error *error)
{
    tc_drape d = {.imagery = imagery, .windows.charts = tc_imagery_charts(imagery)};
    tc_status status = TC_OK;
    for (int chart = 0; chart < d.windows.charts && status == TC_OK; chart++) {
        const tc_field *field = tc_imagery_field(imagery, chart);
        tc_clipmap_options windows = {.n = window_size(surface), .wraps = tc_field_info(field)->wraps_x, .contents = 1};
        windows.content[0] = (tc_content){.class = &tc_colours_content};
        status = tc_clipmap_create(field, &windows, &d.windows.clipmap[chart], error);
    }
    if (status == TC_ERR_IO || status == TC_ERR_FORMAT) /* the picture says why */
        status = tc_imagery_failed(imagery, error) ? tc_imagery_failed(imagery, error) : status;
    d.textures.anisotropy = tc_gl_anisotropy(gl);
    if (status == TC_OK)
        *drape_ret = d;
    else
        tc_windows_destroy(&d.windows);
    return status;
}

void tc_drape_destroy(const tc_gl *gl, tc_drape *drape)
{
    tc_level_textures_destroy(gl, &drape->textures);
    tc_windows_destroy(&drape->windows);
}

/* Where a view stands on a chart's colours; false: it does not see that chart. */
static bool stand(const tc_drape *d, const tc_view *view, int chart, tc_standing *at)
{
    double texel[2];
    tc_imagery_texel(d->imagery, chart, texel);
    return view->surface->stand(view, chart, texel, at);
}

/* Texel coordinates of the view's place at a level. */
static void texel_place(const tc_clipmap *clipmap, int level, const tc_standing *at, double *u, double *v)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    *u = ldexp(at->x, -l->shift), *v = ldexp(at->y, -l->shift);
}

/* A window of at most n texels around the view's place, of what is in sight of the level; on even texels. */
static tc_rect window(const tc_clipmap *clipmap, int level, const tc_standing *at)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    const int64_t n = tc_clipmap_n(clipmap), least[2] = {l->extent.x0, l->extent.y0},
                  most[2] = {l->extent.x1, l->extent.y1};
    double middle[2];
    int64_t side[2][2];
    texel_place(clipmap, level, at, &middle[0], &middle[1]);
    for (int a = 0; a < 2; a++) {
        int64_t eye = 2 * (int64_t)floor(0.5 * middle[a] - 0.25 * (double)(n - 1) + 0.5); /* centred */
        int64_t from = (int64_t)fmax(floor(middle[a] + ldexp(at->lo[a], -l->shift)) - 2, (double)eye);
        int64_t to = (int64_t)fmin(ceil(middle[a] + ldexp(at->hi[a], -l->shift)) + 3, (double)(eye + n));
        side[a][0] = tc_max64(from & ~(int64_t)1, least[a]), side[a][1] = tc_min64(to | 1, most[a]);
    }
    tc_rect r = {side[0][0], side[1][0], side[0][1], side[1][1]};
    return tc_rect_empty(r) ? (tc_rect){0, 0, 0, 0} : r;
}

/* Level 1 of a map that wraps: once around, with the view's place in its middle. */
static tc_rect once_around(const tc_clipmap *clipmap, const tc_standing *at)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, 1);
    double u, v;
    texel_place(clipmap, 1, at, &u, &v);
    int64_t width = l->clip.x1 - l->clip.x0, x0 = ((int64_t)floor(u + 0.5) - width / 2) & ~(int64_t)1;
    return (tc_rect){x0, l->extent.y0, x0 + width, l->extent.y1};
}

static void want_chart(tc_drape *d, const tc_view *view, int chart)
{
    const tc_clipmap *clipmap = d->windows.clipmap[chart];
    const double pixel = 1 / tc_camera_pixel_scale(&view->camera);
    tc_standing at;
    memset(d->wanted[chart], 0, sizeof d->wanted[chart]);
    if (!stand(d, view, chart, &at))
        return;
    d->wanted[chart][0] =
        tc_clipmap_level(clipmap, 1)->wraps ? once_around(clipmap, &at) : tc_clipmap_level(clipmap, 1)->extent;
    for (int level = 2; level <= tc_clipmap_levels(clipmap); level++) {
        double texel = ldexp(at.texel, tc_clipmap_level(clipmap, level)->shift);
        if (2 * texel * NEARER >= at.distance * pixel)
            d->wanted[chart][level - 1] = window(clipmap, level, &at);
    }
}

/* Room for the levels wanted. */
static tc_status hold(const tc_gl *gl, tc_drape *d, tc_error *error)
{
    int levels[TC_MAX_CHARTS];
    for (int chart = 0; chart < d->windows.charts; chart++) {
        levels[chart] = tc_clipmap_levels(d->windows.clipmap[chart]);
        while (levels[chart] > 0 && tc_rect_empty(d->wanted[chart][levels[chart] - 1]))
            levels[chart]--;
    }
    return tc_level_textures_hold(gl, &d->textures, d->windows.clipmap, d->windows.charts, levels, error);
}

tc_status tc_drape_move(const tc_gl *gl, tc_drape *d, const tc_view *view, const tc_update *how, double until,
                        tc_drape_update *update_ret, tc_error *error)
{
    tc_drape_update u = {.resident = true};
    tc_update move = *how;
    for (int chart = 0; chart < d->windows.charts; chart++) { /* each gets at least what makes progress */
        tc_clipmap *clipmap = d->windows.clipmap[chart];
        want_chart(d, view, chart);
        move.budget = how->budget < 0 ? -1 : tc_max64(tc_clipmap_n(clipmap), how->budget - u.texels);
        u.texels += tc_clipmap_update_as(clipmap, d->wanted[chart], &move);
        u.resident &= tc_clipmap_resident(clipmap);
        u.failed |= tc_clipmap_failed(clipmap) != TC_OK;
    }
    tc_status status = hold(gl, d, error);
    if (status == TC_OK) {
        u.bytes = tc_level_textures_upload(gl, &d->textures, d->windows.clipmap, d->windows.charts,
                                           how->wait || how->budget < 0 ? -1 : u.texels + how->budget, until);
        for (int chart = 0; chart < d->windows.charts; chart++)
            u.resident &= d->textures.layers.ready[chart] == d->textures.layers.held[chart];
    }
    *update_ret = u;
    return status;
}

/* ---- What shaders know --------------------------------------------------------------------------------------------
 */

/* As stack.glsl has layers. */
static void set_layer(const tc_clipmap *clipmap, int level, bool ready, const tc_standing *at, float (*q)[4])
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    const tc_level size = tc_field_level(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, level));
    int64_t torus = 2 * (tc_clipmap_n(clipmap) + 1);
    double u, v;
    texel_place(clipmap, level, at, &u, &v);
    double i = rint(u), j = rint(v);
    int64_t x1 = l->wraps ? l->clip.x1 : tc_min64(l->clip.x1, size.width), y1 = tc_min64(l->clip.y1, size.height);
    tc_set4(q[0], u - i, v - j, ldexp(at->per_place[0], -l->shift), ldexp(at->per_place[1], -l->shift));
    tc_set4(q[1], (double)((int64_t)i & (torus - 1)), (double)((int64_t)j & (torus - 1)), (double)(x1 - 1) - i,
            (double)(y1 - 1) - j);
    /* Where the map itself ends a level does not pass over to the coarser one: imagery.glsl takes this off again. */
    const double west = l->clip.x0 == l->extent.x0 ? TC_DRAPE_END : 0,
                 south = l->clip.y0 == l->extent.y0 ? TC_DRAPE_END : 0;
    const double east = l->clip.x1 == l->extent.x1 ? TC_DRAPE_END : 0,
                 north = l->clip.y1 == l->extent.y1 ? TC_DRAPE_END : 0;
    tc_set4(q[2], (double)l->clip.x0 - i - west, (double)l->clip.y0 - j - south, (double)(x1 - 1) - i + east,
            (double)(y1 - 1) - j + north);
    if (!ready || tc_rect_empty(l->clip)) /* nothing, yet */
        tc_set4(q[2], 0, 0, -1, -1);
}

void tc_drape_uniforms(const tc_drape *d, const tc_view *view, tc_frame_uniforms *uniforms)
{
    const tc_layers *layers = &d->textures.layers;
    for (int chart = 0; chart < d->windows.charts; chart++) {
        const tc_clipmap *clipmap = d->windows.clipmap[chart];
        int levels = tc_clipmap_levels(clipmap), first = TC_MAX_LAYERS + tc_first_layer(layers, chart),
            held = layers->held[chart], finest = tc_clipmap_level(clipmap, levels)->shift;
        int32_t *stack = uniforms->image_stack[chart];
        tc_standing at;
        stack[0] = stack[1] = 0, stack[2] = -1; /* no level */
        if (held == 0 || !stand(d, view, chart, &at))
            continue;
        stack[0] = first + levels - 1 + finest; /* the layer of shift 0, were there one */
        stack[1] = finest + levels - held, stack[2] = finest + levels - 1;
        tc_set4(uniforms->image_scale[chart], at.per_place[0], at.per_place[1], 0, 0);
        for (int level = 1; level <= held; level++)
            set_layer(clipmap, level, level <= layers->ready[chart], &at,
                      uniforms->image[first - TC_MAX_LAYERS + level - 1]);
    }
}

/* ---- Telling ------------------------------------------------------------------------------------------------------
 */

int tc_drape_levels(const tc_drape *d)
{
    int held = 0;
    for (int chart = 0; chart < d->windows.charts; chart++)
        for (int level = 1; level <= d->textures.layers.held[chart]; level++)
            held += !tc_rect_empty(tc_clipmap_level(d->windows.clipmap[chart], level)->clip);
    return held;
}

size_t tc_drape_bytes(const tc_drape *d)
{
    size_t bytes = tc_level_texture_of(&d->textures, &tc_colours_content).bytes;
    for (int chart = 0; chart < d->windows.charts; chart++) {
        const tc_clipmap *clipmap = d->windows.clipmap[chart];
        bytes += tc_clipmap_bytes(clipmap, NULL) + tc_clipmap_bytes(clipmap, &tc_colours_content) +
                 tc_field_tell(tc_clipmap_field(clipmap)).bytes;
    }
    return bytes;
}
