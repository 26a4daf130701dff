/* pack_tile.c - the work on one tile of a level being packed: its details, its bytes, its errors. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/crc32c.h"
#include "pack_level.h"

/* ---- Details of a tile ---------------------------------------------------------------------------------------- */

enum { WINDOW = TC_TILE + 2 * MARGIN };

tc_rect tc_pack_details_need(const tc_lifting_level *level, tc_rect t)
{
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height);
    tc_rect r = {t.x0 - MARGIN, tc_max64(t.y0 - MARGIN, 0), t.x1 + MARGIN, tc_min64(t.y1 + MARGIN, ch)};
    if (!level->wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, cw);
    int64_t limit = level->wrap_x ? INT64_MAX : level->width;
    return (tc_rect){2 * r.x0, 2 * r.y0, tc_min64(2 * r.x1, limit), tc_min64(2 * r.y1, level->height)};
}

size_t tc_pack_details_scratch(void)
{
    const tc_lifting_level most = {2 * WINDOW, 2 * WINDOW, false};
    return tc_lifting_analyse_scratch(&most, TC_TILE) + 4 * WINDOW * TC_TILE;
}

void tc_pack_details(const tc_lifting_level *level, tc_rect tile, const tc_plane *fine, const tc_plane band[TC_BANDS],
                     int32_t *scratch)
{
    /* The window is a level of its own: its borders, where they are not the level's, are far enough away. */
    tc_rect need = tc_pack_details_need(level, tile);
    tc_lifting_level window = {need.x1 - need.x0, need.y1 - need.y0, false};
    int64_t cw = tc_coarse_size(window.width), i0 = tile.x0 - need.x0 / 2, j0 = tile.y0 - need.y0 / 2;
    int64_t j1 = j0 + tile.y1 - tile.y0;
    tc_rect rows = {0, j0, cw, j1};
    tc_plane from = {tc_plane_at(fine, need.x0, need.y0), fine->stride, {0, 0, window.width, window.height}};
    tc_plane low = {scratch, cw, rows}, all[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        all[b] = (tc_plane){scratch + (b + 1) * WINDOW * TC_TILE, cw, rows};
    tc_lifting_analyse(&window, &from, j0, j1, &low, all, scratch + 4 * WINDOW * TC_TILE);
    for (int b = 0; b < TC_BANDS; b++)
        for (int64_t y = tile.y0; y < tile.y1; y++)
            memcpy(tc_plane_at(&band[b], tile.x0, y), tc_plane_at(&all[b], i0, y - tile.y0 + j0),
                   (size_t)(tile.x1 - tile.x0) * sizeof(int32_t));
}

/* ---- Memory of threads ------------------------------------------------------------------------------------------ */

void tc_pack_fail(level_state *s, tc_status status)
{
    pthread_mutex_lock(&s->mutex);
    s->status = s->status ? s->status : status;
    pthread_mutex_unlock(&s->mutex);
}

static tile_memory *borrow(level_state *s)
{
    pthread_mutex_lock(&s->mutex);
    tile_memory *m = s->idle;
    if (m)
        s->idle = m->next;
    pthread_mutex_unlock(&s->mutex);
    if (m || !(m = calloc(1, sizeof *m)))
        return m;
    m->work = malloc(tc_level_coder_work_bytes());
    m->details = malloc((size_t)TC_TILE_SIDE * TC_TILE_SIDE * sizeof(int32_t));
    m->scratch = malloc(tc_pack_details_scratch() * sizeof(int32_t));
    m->bytes = malloc(tc_level_coder_bound());
    if (m->work && m->details && m->scratch && m->bytes)
        return m;
    free(m->work), free(m->details), free(m->scratch), free(m->bytes), free(m);
    return NULL;
}

static void give_back(level_state *s, tile_memory *m)
{
    pthread_mutex_lock(&s->mutex);
    m->next = s->idle, s->idle = m;
    pthread_mutex_unlock(&s->mutex);
}

void tc_pack_tile_memory_free(level_state *s)
{
    while (s->idle) {
        tile_memory *m = s->idle;
        s->idle = m->next;
        free(m->work), free(m->details), free(m->scratch), free(m->bytes), free(m);
    }
}

/* ---- Coding ---------------------------------------------------------------------------------------------------- */

/* The tile's heights as multiples of the exact coder's step: what it will give. */
static void round_samples(const level_state *s, tc_rect rect, int32_t *to)
{
    int64_t step = s->coding->coder->exact->model.step;
    for (int64_t y = rect.y0; y < rect.y1; y++) {
        const int32_t *z = tc_plane_at(&s->truth, rect.x0, y);
        for (int64_t i = 0; i < rect.x1 - rect.x0; i++) {
            int64_t up = z[i] + step / 2, k = up >= 0 ? up / step : -((-up + step - 1) / step);
            to[(y - rect.y0) * TC_TILE_SIDE + i] = (int32_t)(k * step);
        }
    }
}

/* Encodes, and decodes what was written, so that an encoder that goes astray shows in the error. */
static tc_status code_lifting(level_state *s, int64_t tx, int64_t ty, size_t *size, tile_memory *m)
{
    const tc_codec *codec = s->coding->coder->codec;
    tc_rect rect = tc_codec_tile_rect(codec, tx, ty, 0);
    tc_plane detail[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        detail[b] = (tc_plane){m->details + b * TC_TILE * TC_TILE, TC_TILE, rect};
    tc_pack_details(&s->level, rect, &s->truth, detail, m->scratch);
    tc_encode_options options = {.lambda = s->coding->lambda};
    tc_status status = tc_codec_encode_tile(codec, tx, ty, &s->coarse, detail, &options, m->bytes, size, m->work);
    return status ? status
                  : tc_codec_decode_tile(codec, tx, ty, 0, m->bytes, *size, &s->coarse, s->band, m->work, TC_SIMD_AUTO);
}

static tc_status code_exact(level_state *s, int64_t tx, int64_t ty, size_t *size, tile_memory *m)
{
    const tc_exact *codec = s->coding->coder->exact;
    tc_plane fine = {m->details, TC_TILE_SIDE, tc_exact_tile_rect(codec, tx, ty)};
    round_samples(s, fine.rect, m->details);
    tc_status status = tc_exact_encode_tile(codec, tx, ty, &s->coarse, &fine, m->bytes, size, m->work);
    return status ? status : tc_exact_decode_tile(codec, tx, ty, m->bytes, *size, &s->coarse, &s->fine, m->work);
}

static tc_status code_lh04(level_state *s, int64_t tx, int64_t ty, size_t *size, tile_memory *m)
{
    const tc_lh04_codec *codec = s->coding->coder->lh04;
    tc_lh04_options options = {.lambda = s->coding->lambda};
    tc_status status = tc_lh04_encode_tile(codec, tx, ty, &s->coarse, &s->truth, &options, m->bytes, size, m->work);
    if (!status)
        status = tc_lh04_decode_tile(codec, tx, ty, 0, m->bytes, *size, &s->fine, m->work, TC_SIMD_AUTO);
    tc_rect rect = tc_lh04_tile_rect(codec, tx, ty, 0);
    tc_plane part = {tc_plane_at(&s->fine, rect.x0, rect.y0), s->fine.stride, rect};
    if (!status)
        tc_lh04_assemble(&s->level, &s->coarse, &part, &part);
    return status;
}

void tc_pack_code_tile(void *context, int64_t n)
{
    level_state *s = context;
    const tc_level_coder *coder = s->coding->coder;
    int64_t tx = n % s->pages.tiles_x, ty = s->t0 + n / s->pages.tiles_x;
    coded_tile *tile = &s->tile[(ty - s->finished) * s->pages.tiles_x + tx];
    tile_memory *m = borrow(s);
    if (!m) {
        tc_pack_fail(s, TC_ERR_MEMORY);
        return;
    }
    size_t size = 0;
    tc_status status = coder->exact  ? code_exact(s, tx, ty, &size, m)
                       : coder->lh04 ? code_lh04(s, tx, ty, &size, m)
                                     : code_lifting(s, tx, ty, &size, m);
    *tile = (coded_tile){.entry.size[TC_STREAM_HEIGHTS] = (uint32_t)size,
                         .raw = coder->exact && tc_exact_is_raw(m->bytes, size)};
    if (!status && size > 0 && !(tile->bytes = malloc(size)))
        status = TC_ERR_MEMORY;
    if (!status && size > 0)
        memcpy(tile->bytes, m->bytes, size);
    give_back(s, m);
    if (status)
        tc_pack_fail(s, status);
}

/* ---- Finishing ------------------------------------------------------------------------------------------------- */

static tc_rect fine_rect(const level_state *s, int64_t tx, int64_t ty)
{
    return (tc_rect){tx * FINE, ty * FINE, tc_min64((tx + 1) * FINE, s->level.width),
                     tc_min64((ty + 1) * FINE, s->level.height)};
}

static const uint8_t *voids_at(const level_state *s, int64_t x, int64_t y)
{
    return s->voids.v + (y - s->voids.rect.y0) * s->voids.stride + x - s->voids.rect.x0;
}

/* Adds a tile's mask to its bytes. False: no memory. */
static bool add_mask(const level_state *s, tc_rect rect, coded_tile *tile)
{
    tile->entry.mask_class = (uint8_t)tc_mask_classify(rect, &s->voids);
    if (tile->entry.mask_class != TC_MASK_CODED)
        return true;
    uint8_t coarse_v[(TC_TILE + 2 * TC_MASK_MARGIN) * (TC_TILE + 2 * TC_MASK_MARGIN)], bytes[TC_MASK_BOUND];
    tc_rect need = tc_mask_tile_needs(&s->level, rect);
    tc_mask_plane coarse = {coarse_v, need.x1 - need.x0, need};
    tc_mask_downsample(&s->voids, &coarse);
    size_t size = tc_mask_encode(&s->level, rect, &coarse, &s->voids, bytes), before = tc_tile_bytes(&tile->entry);
    uint8_t *all = realloc(tile->bytes, before + size + 1);
    if (!all)
        return false;
    memcpy(all + before, bytes, size);
    tile->bytes = all;
    tile->entry.size[TC_STREAM_MASK] = (uint32_t)size;
    return true;
}

/* Corrects what is off by more than the bound, and adds the corrections to the tile's bytes. */
static tc_status correct_tile(const level_state *s, int64_t tx, int64_t ty, coded_tile *tile, tile_memory *m)
{
    const tc_level_coder *c = s->coding->coder;
    tc_rect r = tc_level_coder_samples(c, tx, ty);
    tc_plane k = {m->details, TC_TILE_SIDE, r};
    for (int64_t y = r.y0; y < r.y1; y++) {
        int32_t *z = tc_plane_at(&s->fine, r.x0, y), *n = tc_plane_at(&k, r.x0, y);
        const int32_t *truth = tc_plane_at(&s->truth, r.x0, y);
        const uint8_t *voids = s->voids.v ? voids_at(s, r.x0, y) : NULL;
        for (int64_t i = 0; i < r.x1 - r.x0; i++) {
            n[i] = voids && voids[i] ? 0 : tc_pack_correction(c, z[i], truth[i], s->coding->bound);
            z[i] = tc_corrected(c, z[i], n[i]);
        }
    }
    size_t size = 0, before = tc_tile_bytes(&tile->entry);
    tc_status status =
        tc_correction_encode(c->correction, s->band, c->codec->model.step, &k, m->bytes, tc_level_coder_bound(), &size);
    uint8_t *all = status || !size ? tile->bytes : realloc(tile->bytes, before + size);
    if (!status && size && !all)
        return TC_ERR_MEMORY;
    tile->bytes = all;
    if (!status && size)
        memcpy(all + before, m->bytes, size);
    tile->entry.size[TC_STREAM_CORRECTIONS] = (uint32_t)size;
    return status;
}

/* Sums in lanes, so that compilers can make vectors of them and all add up the same. */
enum { LANES = 8 };
typedef struct error_sum {
    double square[LANES], most[LANES];
} error_sum;

static void add_errors(error_sum *sum, const double *error, int64_t count)
{
    int64_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (int k = 0; k < LANES; k++) {
            sum->square[k] += error[i + k] * error[i + k];
            sum->most[k] = error[i + k] > sum->most[k] ? error[i + k] : sum->most[k];
        }
    for (int k = 0; i + k < count; k++) {
        sum->square[k] += error[i + k] * error[i + k];
        sum->most[k] = error[i + k] > sum->most[k] ? error[i + k] : sum->most[k];
    }
}

/* Metres by which heights are off: from those given, as a reader will have them, and from the filtered ones. */
static void errors_of_source(const tc_container *c, const int32_t *z, const float *source, int64_t count, double *error)
{
    double unit = c->z_unit, origin = c->z_origin;
    for (int64_t i = 0; i < count; i++)
        error[i] = fabs((double)(float)(origin + unit * z[i]) - source[i]);
}

static void errors_of_level(const tc_container *c, const int32_t *z, const int32_t *truth, int64_t count, double *error)
{
    double unit = c->z_unit;
    for (int64_t i = 0; i < count; i++)
        error[i] = fabs((double)z[i] - truth[i]) * unit;
}

/* Twice the height of the coarser level's sample (x, y). Beyond its last ones heights go on in a straight line, or from
 * the other side. */
static int64_t below_at(const level_state *s, int64_t x, int64_t y)
{
    if (x >= s->cw && s->level.wrap_x)
        x -= s->cw;
    if (x >= s->cw)
        return s->cw < 2 ? below_at(s, s->cw - 1, y) : 2 * below_at(s, s->cw - 1, y) - below_at(s, s->cw - 2, y);
    if (y >= s->ch)
        return s->ch < 2 ? below_at(s, x, 0) : 2 * below_at(s, x, s->ch - 1) - below_at(s, x, s->ch - 2);
    return 2 * (int64_t)*tc_plane_at(&s->below, x, y);
}

/* The most that a sample of the tile is off the coarser level's mesh on the spot (mesh.h), rounded up. */
static uint32_t largest_step(const level_state *s, tc_rect r)
{
    int64_t most = 0;
    for (int64_t y = r.y0; y < r.y1; y++) {
        const int32_t *z = tc_plane_at(&s->fine, r.x0, y);
        int64_t y0 = y >> 1, y1 = (y + 1) >> 1, x = r.x0;
        if (y1 < s->ch) { /* nearly everywhere nothing lies beyond the last samples */
            const int32_t *p = tc_plane_at(&s->below, 0, y0), *q = tc_plane_at(&s->below, 0, y1);
            for (int64_t end = tc_min64(r.x1, 2 * s->cw - 1); x < end; x++) {
                int64_t off = 4 * (int64_t)z[x - r.x0] - 2 * ((int64_t)p[(x + 1) >> 1] + q[x >> 1]);
                most = tc_max64(most, llabs(off));
            }
        }
        for (; x < r.x1; x++) {
            int64_t a = below_at(s, (x + 1) >> 1, y0), b = below_at(s, x >> 1, y1);
            most = tc_max64(most, llabs(4 * (int64_t)z[x - r.x0] - a - b));
        }
    }
    return (uint32_t)tc_min64((most + 3) / 4, UINT32_MAX - 1);
}

/* Errors and bounds of a tile whose heights are all there. */
void tc_pack_finish_tile(void *context, int64_t n)
{
    level_state *s = context;
    const tc_container *c = &s->p->container;
    int64_t tx = n % s->pages.tiles_x, ty = s->finished + n / s->pages.tiles_x, w = s->level.width;
    coded_tile *tile = &s->tile[n];
    tc_rect r = fine_rect(s, tx, ty);
    if (s->coding->coder->correction) {
        tile_memory *m = borrow(s);
        tc_status status = m ? correct_tile(s, tx, ty, tile, m) : TC_ERR_MEMORY;
        if (m)
            give_back(s, m);
        if (status)
            tc_pack_fail(s, status);
    }
    int32_t low = INT32_MAX, high = INT32_MIN;
    error_sum sum = {{0}, {0}};
    double error[TC_TILE_SIDE];
    int64_t count = r.x1 - r.x0, samples = 0;
    for (int64_t y = r.y0; y < r.y1; y++) {
        const int32_t *z = tc_plane_at(&s->fine, r.x0, y);
        for (int64_t i = 0; i < count; i++)
            low = z[i] < low ? z[i] : low, high = z[i] > high ? z[i] : high;
        if (s->source)
            errors_of_source(c, z, s->source + (y - s->finished * FINE) * w + r.x0, count, error);
        else
            errors_of_level(c, z, tc_plane_at(&s->truth, r.x0, y), count, error);
        const uint8_t *voids = s->voids.v ? voids_at(s, r.x0, y) : NULL;
        samples += count;
        for (int64_t i = 0; i < count && voids; i++)
            if (voids[i])
                error[i] = 0, samples--;
        add_errors(&sum, error, count);
    }
    tile->entry.low = low, tile->entry.high = high;
    tile->entry.step = largest_step(s, r);
    tile->samples = samples;
    for (int k = 0; k < LANES; k++) {
        tile->square_error += sum.square[k];
        tile->max_error = fmax(tile->max_error, sum.most[k]);
    }
    if (s->voids.v && !add_mask(s, r, tile))
        tc_pack_fail(s, TC_ERR_MEMORY);
    uint32_t size = tc_tile_bytes(&tile->entry);
    tile->entry.crc = size ? tc_crc32c(0, tile->bytes, size) : 0;
}
