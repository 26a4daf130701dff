/* imagery.c - pictures over a map: where they are, and how fine the colours of each chart are made. */
#include "imagery.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "imagery_internal.h"

enum {
    PROBES = 17, /* places along a side by which it is told where a picture is and how fine */
    CACHE_BYTES = 32 << 20,
    FINEST = 24 /* powers of two by which colours are finer than heights, at most */
};

/* ---- How fine -----------------------------------------------------------------------------------------------------
 */

/* The corners of a chart: chart coordinates, west to east and south to north. */
static void corners_of(const tc_chart *c, double lo[2], double hi[2])
{
    const tc_level size = tc_field_level(c->field, tc_field_info(c->field)->levels);
    lo[0] = c->x0 - 0.5 * c->dx, hi[0] = c->x0 + ((double)size.width - 0.5) * c->dx;
    lo[1] = c->y0 - 0.5 * c->dy, hi[1] = c->y0 + ((double)size.height - 0.5) * c->dy;
}

/* Whether a place is on the chart. */
static bool on_chart(const tc_chart *c, double x, double y)
{
    double lo[2], hi[2];
    corners_of(c, lo, hi);
    return isfinite(x) && isfinite(y) && (c->wraps || (x >= lo[0] && x <= hi[0])) && y >= lo[1] && y <= hi[1];
}

/* Pixels to a sample of the data there: the geometric mean of both axes, but no more than suits the one with fewer, or
 * around the poles pixels of longitude, which are slivers there, would call for levels without end; 0: no pixel. */
static double pixels_a_sample(const tc_map *map, tc_layer *layer, int chart, double x, double y)
{
    const tc_chart *c = &map->chart[chart];
    double dx = ldexp(c->dx, map->synthesised), dy = ldexp(c->dy, map->synthesised);
    double px[3] = {x, x + 0.5 * dx, x}, py[3] = {y, y, y + 0.5 * dy};
    const double at[2] = {x, y};
    tc_layer_find(map, layer, chart, 3, px, py);
    if (!tc_layer_holds(layer, px[0], py[0]))
        return 0;
    if (!tc_layer_may_hold(layer, chart, at, at)) /* the way back led elsewhere: around the globe, from a plane */
        layer->bounds[chart].everywhere = true;
    double a[2] = {2 * (px[1] - px[0]), 2 * (py[1] - py[0])}, b[2] = {2 * (px[2] - px[0]), 2 * (py[2] - py[0])};
    double area = fabs(a[0] * b[1] - a[1] * b[0]), fewer = area / fmax(hypot(a[0], a[1]), hypot(b[0], b[1]));
    return isfinite(fewer) ? fmin(sqrt(area), 1.5 * fewer) : 0;
}

/* The most of them on a lattice over a rectangle of the chart. */
static double finest_within(const tc_map *map, tc_layer *layer, int chart, const double lo[2], const double hi[2])
{
    double most = 0;
    for (int k = 0; k < PROBES * PROBES; k++) {
        double u = (double)(k % PROBES) / (PROBES - 1), v = (double)(k / PROBES) / (PROBES - 1); /* sides included */
        most = fmax(most, pixels_a_sample(map, layer, chart, lo[0] + u * (hi[0] - lo[0]), lo[1] + v * (hi[1] - lo[1])));
    }
    return most;
}

/* The most of them anywhere: over the chart, at places of the picture, which may be small, and over what the rectangles
 * around both have in common, which may be smaller than either. */
static double finest_of(const tc_map *map, tc_layer *layer, int chart)
{
    const tc_chart *c = &map->chart[chart];
    const tc_image_size *size = &layer->image->level[0];
    double lo[2], hi[2], least[2] = {INFINITY, INFINITY}, last[2] = {-INFINITY, -INFINITY};
    corners_of(c, lo, hi);
    double most = finest_within(map, layer, chart, lo, hi);
    for (int k = 0; k < PROBES * PROBES; k++) {
        double x = (double)(k % PROBES) / (PROBES - 1) * (double)size->width,
               y = (double)(k / PROBES) / (PROBES - 1) * (double)size->height;
        tc_layer_locate(map, layer, chart, 1, &x, &y);
        if (on_chart(c, x, y))
            most = fmax(most, pixels_a_sample(map, layer, chart, x, y));
        if (isfinite(x) && isfinite(y))
            least[0] = fmin(least[0], x), last[0] = fmax(last[0], x), least[1] = fmin(least[1], y),
            last[1] = fmax(last[1], y);
    }
    for (int i = 0; i < 2; i++)
        lo[i] = fmax(lo[i], least[i]), hi[i] = fmin(hi[i], last[i]);
    return lo[0] < hi[0] && lo[1] < hi[1] ? fmax(most, finest_within(map, layer, chart, lo, hi)) : most;
}

/* Powers of two by which a chart's colours are finer than its heights, so that hardly a pixel is left out. */
static int finer_by(const tc_map *map, double pixels, tc_level data)
{
    const double slack = 0.15; /* of a power: pixels are seldom as sharp */
    int finer = (int)fmin(ceil(log2(pixels) - slack), FINEST), coarsest = 0;
    if (map->chart[0].wraps) /* or columns would not come round again */
        while (coarsest < 30 && (data.width >> coarsest) % 2 == 0)
            coarsest++;
    else
        coarsest = 30;
    while (finer > 0 && ldexp((double)(data.width > data.height ? data.width : data.height), finer) > 1 << 30)
        finer--;
    return finer > -coarsest ? finer : -coarsest;
}

static tc_level level_of(const tc_chart *c, tc_level data, int finer)
{
    int64_t w = c->wraps     ? (finer >= 0 ? data.width << finer : data.width >> -finer)
                : finer >= 0 ? ((data.width - 1) << finer) + 1
                             : ((data.width - 1) >> -finer) + 1;
    int64_t h = finer >= 0 ? ((data.height - 1) << finer) + 1 : ((data.height - 1) >> -finer) + 1;
    return (tc_level){w, h, ldexp(data.spacing_x, -finer), ldexp(data.spacing_y, -finer)};
}

static tc_status make_field(tc_imagery *im, int chart, double pixels, tc_error *error)
{
    const tc_map *map = im->map;
    const tc_chart *c = &map->chart[chart];
    tc_level data = tc_field_level(c->field, tc_field_info(c->field)->levels - map->synthesised);
    int finer = finer_by(map, pixels, data);
    tc_colour_field *f = tc_colour_field_create(im, chart, level_of(c, data, finer));
    if (!f)
        return tc_fail(error, TC_ERR_MEMORY, "imagery: not enough memory");
    f->x0 = c->x0, f->y0 = c->y0;
    f->dx = ldexp(c->dx, map->synthesised - finer), f->dy = ldexp(c->dy, map->synthesised - finer);
    im->field[chart] = f;
    return TC_OK;
}

/* ---- All together -------------------------------------------------------------------------------------------------
 */

static tc_status settle(tc_imagery *im, tc_error *error)
{
    double most[TC_MAP_CHARTS] = {0};
    for (int n = 0; n < im->layers; n++) {
        bool overlaps = false;
        for (int chart = 0; chart < im->charts; chart++) {
            double pixels = finest_of(im->map, &im->layer[n], chart);
            overlaps |= pixels > 0;
            most[chart] = fmax(most[chart], pixels);
        }
        if (!overlaps)
            return tc_fail(error, TC_ERR_UNSUPPORTED,
                           "%s: expected a picture of the terrain, found one of another place",
                           im->layer[n].image->name);
    }
    tc_status status = TC_OK;
    for (int chart = 0; chart < im->charts && status == TC_OK; chart++)
        status = make_field(im, chart, most[chart] > 0 ? most[chart] : 1, error);
    return status;
}

tc_status tc_imagery_create(const tc_map *map, tc_image *const *images, int count, int threads,
                            tc_imagery **imagery_ret, tc_error *error)
{
    tc_imagery *im = calloc(1, sizeof *im);
    tc_layer *layer = calloc((size_t)count, sizeof *layer);
    if (!im || !layer || tc_block_cache_init(&im->blocks, CACHE_BYTES)) {
        if (im && layer)
            tc_block_cache_free(&im->blocks); /* what there is of it */
        free(im), free(layer);
        for (int n = 0; n < count; n++)
            images[n]->close(images[n]);
        return tc_fail(error, TC_ERR_MEMORY, "imagery: not enough memory");
    }
    im->map = map, im->layers = count, im->charts = map->charts, im->threads = threads, im->layer = layer;
    pthread_mutex_init(&im->mutex, NULL);
    tc_faults_init(&im->faults);
    tc_prefetch_init(&im->prefetch, tc_colour_read_piece, CACHE_BYTES / 2, threads);
    for (int n = 0; n < count; n++) {
        layer[n].image = images[n];
        pthread_mutex_init(&layer[n].mutex, NULL);
        tc_layer_place(map, &layer[n]);
    }
    tc_status status = settle(im, error);
    if (status == TC_OK)
        *imagery_ret = im;
    else
        tc_imagery_destroy(im);
    return status;
}

void tc_imagery_destroy(tc_imagery *im)
{
    if (!im)
        return;
    tc_prefetch_free(&im->prefetch);
    for (int chart = 0; chart < TC_MAP_CHARTS; chart++)
        if (im->field[chart])
            tc_field_destroy(&im->field[chart]->head);
    for (int n = 0; n < im->layers; n++) {
        pthread_mutex_destroy(&im->layer[n].mutex);
        im->layer[n].image->close(im->layer[n].image);
    }
    tc_faults_free(&im->faults);
    tc_block_cache_free(&im->blocks);
    pthread_mutex_destroy(&im->mutex);
    free(im->layer);
    free(im);
}

const tc_field *tc_imagery_field(const tc_imagery *imagery, int chart)
{
    return &imagery->field[chart]->head;
}

int tc_imagery_charts(const tc_imagery *imagery)
{
    return imagery->charts;
}

void tc_imagery_texel(const tc_imagery *imagery, int chart, double texel_ret[2])
{
    texel_ret[0] = imagery->field[chart]->dx, texel_ret[1] = imagery->field[chart]->dy;
}

tc_status tc_imagery_failed(const tc_imagery *imagery, tc_error *error)
{
    tc_imagery *im = (tc_imagery *)imagery;
    pthread_mutex_lock(&im->mutex);
    tc_status status = im->failed;
    if (status != TC_OK && error)
        *error = im->error;
    pthread_mutex_unlock(&im->mutex);
    return status;
}
