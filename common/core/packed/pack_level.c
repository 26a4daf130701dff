/* pack_level.c - one level, strip by strip of tiles: encoded, decoded again, measured, indexed.
 *
 * A group of rows of tiles is in memory at a time. Details of a tile are taken from the true heights around it; the
 * decoded details of the group, with some rows before it, give the reconstructed heights but for the last few, which
 * wait for the next group. A row of tiles whose heights are all known is finished: measured, and handed to its page.
 * Tiles are tasks that any thread may take; what goes into the file and into sums is put together in their order. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <unistd.h>

#include "common/core/base/parallel.h"
#include "common/core/base/rect.h"
#include "common/core/base/status.h"
#include "crc32c.h"
#include "pack_internal.h"

enum {
    FINE = 2 * TC_TILE,            /* fine samples of a tile along a side */
    MARGIN = TC_LIFTING_REACH + 1, /* positions around a tile that its details depend on */
    BEFORE = 8,                    /* rows of positions kept before the group: more than the filters reach */
    GROUP_BYTES = 96 << 20,
    GROUP_TASKS = 8, /* for each thread, at least */
    CHUNK = 32       /* fine rows synthesised by one task */
};

/* ---- Details of a tile ---------------------------------------------------------------------------------------- */

enum { WINDOW = TC_TILE + 2 * MARGIN };

tc_rect tc_pack_details_need(const tc_lifting_level *level, tc_rect t)
{
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height);
    tc_rect r = {tc_max64(t.x0 - MARGIN, 0), tc_max64(t.y0 - MARGIN, 0), tc_min64(t.x1 + MARGIN, cw),
                 tc_min64(t.y1 + MARGIN, ch)};
    return (tc_rect){2 * r.x0, 2 * r.y0, tc_min64(2 * r.x1, level->width), tc_min64(2 * r.y1, level->height)};
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

/* ---- State ---------------------------------------------------------------------------------------------------- */

/* A coded tile that waits to be finished, and what finishing finds. */
typedef struct coded_tile {
    tc_tile_entry entry;
    uint8_t *bytes;
    double square_error, max_error;
    int64_t samples;
} coded_tile;

/* What a thread needs while it works on a tile. */
typedef struct tile_memory {
    struct tile_memory *next;
    void *work;
    int32_t *details, *scratch;
    uint8_t *bytes;
} tile_memory;

typedef struct level_state {
    tc_packer *p;
    const tc_level_coding *coding;
    tc_level_record *record;
    tc_lifting_level level;
    tc_pages pages;
    int64_t cw, ch;
    /* The group. */
    int64_t rows_at_once, t0, t1, finished; /* rows of tiles */
    tc_plane truth, coarse, band[TC_BANDS], fine;
    int64_t ready, ready_before; /* fine rows reconstructed */
    coded_tile *tile;            /* of rows `finished` .. t1 - 1 */
    float *source;               /* finest level: heights as given, of the rows being finished */
    tc_mask_plane voids;         /* of the same rows and some around them; v NULL where the level has none */
    int64_t finish_to;
    /* Pages. */
    coded_tile *band_tile; /* finished tiles of the row of pages being gathered */
    int64_t band_rows;
    uint8_t *directory;
    tc_byte_writer out;
    int64_t written; /* bytes of the level so far */
    tc_level_outcome outcome;
    pthread_mutex_t mutex;
    tile_memory *idle;
    tc_status status;
} level_state;

static void fail_once(level_state *s, tc_status status)
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
    return m;
}

static void give_back(level_state *s, tile_memory *m)
{
    pthread_mutex_lock(&s->mutex);
    m->next = s->idle, s->idle = m;
    pthread_mutex_unlock(&s->mutex);
}

/* ---- Group of rows of tiles ------------------------------------------------------------------------------------ */

static int64_t plane_room(int64_t rows, int64_t width, int64_t height)
{
    return tc_min64(rows, height) * width;
}

static bool reserve(level_state *s)
{
    int64_t w = s->level.width, h = s->level.height, g = s->rows_at_once;
    size_t n = sizeof(int32_t);
    s->truth.z = malloc((size_t)plane_room((g + 1) * FINE + 4 * MARGIN + 2 * BEFORE, w, h) * n);
    s->fine.z = malloc((size_t)plane_room((g + 2) * FINE, w, h) * n);
    s->coarse.z = malloc((size_t)plane_room(g * TC_TILE + 2 * BEFORE, s->cw, s->ch) * n);
    bool good = s->truth.z && s->fine.z && s->coarse.z;
    for (int b = 0; b < TC_BANDS; b++) {
        s->band[b].z = malloc((size_t)plane_room((g + 1) * TC_TILE + BEFORE, s->cw, s->ch) * n);
        good &= s->band[b].z != NULL;
    }
    s->tile = calloc((size_t)((g + 1) * s->pages.tiles_x), sizeof *s->tile);
    s->band_tile = calloc((size_t)(TC_PAGE_ROWS * s->pages.tiles_x), sizeof *s->band_tile);
    s->directory = calloc((size_t)tc_directory_bytes(&s->pages), 1);
    good &= s->tile && s->band_tile && s->directory;
    if (s->coding->l == s->p->container.levels)
        good &= (s->source = malloc((size_t)plane_room((g + 1) * FINE, w, h) * sizeof(float))) != NULL;
    if (s->record->mask)
        good &= (s->voids.v = malloc((size_t)plane_room((g + 1) * FINE + 4 * TC_MASK_MARGIN, w, h))) != NULL;
    return good;
}

static void release(level_state *s)
{
    free(s->truth.z), free(s->fine.z), free(s->coarse.z);
    for (int b = 0; b < TC_BANDS; b++)
        free(s->band[b].z);
    for (int64_t i = 0; s->tile && i < (s->rows_at_once + 1) * s->pages.tiles_x; i++)
        free(s->tile[i].bytes);
    for (int64_t i = 0; s->band_tile && i < TC_PAGE_ROWS * s->pages.tiles_x; i++)
        free(s->band_tile[i].bytes);
    free(s->tile), free(s->band_tile), free(s->directory), free(s->source), free(s->voids.v), free(s->out.bytes);
    while (s->idle) {
        tile_memory *m = s->idle;
        s->idle = m->next;
        free(m->work), free(m->details), free(m->scratch), free(m->bytes), free(m);
    }
    pthread_mutex_destroy(&s->mutex);
}

/* Lets a plane of whole rows start at row y0, keeping what it has from there on. */
static void slide(tc_plane *plane, int64_t y0, int64_t width)
{
    int64_t from = tc_clamp64(y0, plane->rect.y0, plane->rect.y1);
    memmove(plane->z, plane->z + (from - plane->rect.y0) * width,
            (size_t)((plane->rect.y1 - from) * width) * sizeof *plane->z);
    plane->stride = width;
    plane->rect = (tc_rect){0, from, width, tc_max64(from, plane->rect.y1)};
    if (plane->rect.y0 == plane->rect.y1)
        plane->rect.y0 = plane->rect.y1 = y0;
}

/* Brings in what rows t0 .. t1 - 1 of tiles need. */
static tc_status load_group(level_state *s, tc_error *error)
{
    int64_t w = s->level.width, h = s->level.height;
    int64_t j0 = s->t0 * TC_TILE, j1 = tc_min64(s->t1 * TC_TILE, s->ch);
    slide(&s->truth, tc_min64(s->finished * FINE, tc_max64(2 * (j0 - MARGIN), 0)), w);
    tc_rect fresh = {0, s->truth.rect.y1, w, tc_min64(2 * (j1 + MARGIN), h)};
    tc_status status =
        tc_pack_truth(s->p, s->coding->l, fresh, s->truth.z + (fresh.y0 - s->truth.rect.y0) * w, w, error);
    s->truth.rect.y1 = fresh.y1;
    s->coarse.stride = s->cw;
    s->coarse.rect = (tc_rect){0, tc_max64(j0 - BEFORE, 0), s->cw, tc_min64(j1 + BEFORE, s->ch)};
    if (!status)
        status = tc_spool_read(s->coding->coarse, s->coarse.rect, s->coarse.z, s->cw, error);
    for (int b = 0; b < TC_BANDS; b++) {
        slide(&s->band[b], tc_max64(s->finished * TC_TILE - BEFORE, 0), s->cw);
        s->band[b].rect.y1 = j1;
    }
    slide(&s->fine, s->finished * FINE, w);
    s->ready_before = s->ready;
    bool at_once = !s->coding->coder->codec; /* tiles give heights by themselves */
    s->ready = j1 == s->ch ? h : tc_max64(s->ready, 2 * (at_once ? j1 : j1 - TC_LIFTING_REACH));
    s->fine.rect.y1 = s->ready;
    return status;
}

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

static void code_tile(void *context, int64_t n)
{
    level_state *s = context;
    const tc_level_coder *coder = s->coding->coder;
    int64_t tx = n % s->pages.tiles_x, ty = s->t0 + n / s->pages.tiles_x;
    coded_tile *tile = &s->tile[(ty - s->finished) * s->pages.tiles_x + tx];
    tile_memory *m = borrow(s);
    if (!m || !m->work || !m->details || !m->scratch || !m->bytes) {
        if (m)
            give_back(s, m);
        fail_once(s, TC_ERR_MEMORY);
        return;
    }
    size_t size = 0;
    tc_status status = coder->exact  ? code_exact(s, tx, ty, &size, m)
                       : coder->lh04 ? code_lh04(s, tx, ty, &size, m)
                                     : code_lifting(s, tx, ty, &size, m);
    *tile = (coded_tile){.entry.size[TC_STREAM_HEIGHTS] = (uint32_t)size};
    if (!status && size > 0 && !(tile->bytes = malloc(size)))
        status = TC_ERR_MEMORY;
    if (!status && size > 0)
        memcpy(tile->bytes, m->bytes, size);
    give_back(s, m);
    if (status)
        fail_once(s, status);
}

static void synthesise_rows(void *context, int64_t n)
{
    level_state *s = context;
    int64_t y0 = s->ready_before + n * CHUNK, y1 = tc_min64(y0 + CHUNK, s->ready), w = s->level.width;
    tc_plane part = {tc_plane_at(&s->fine, 0, y0), w, {0, y0, w, y1}};
    int32_t *scratch = malloc(tc_lifting_synthesise_scratch(&s->level, part.rect) * sizeof *scratch);
    if (scratch)
        tc_lifting_synthesise(&s->level, &s->coarse, s->band, &part, scratch, TC_SIMD_AUTO);
    else
        fail_once(s, TC_ERR_MEMORY);
    free(scratch);
}

/* ---- Finishing ------------------------------------------------------------------------------------------------- */

static tc_rect fine_rect(const level_state *s, int64_t tx, int64_t ty)
{
    return (tc_rect){tx * FINE, ty * FINE, tc_min64((tx + 1) * FINE, s->level.width),
                     tc_min64((ty + 1) * FINE, s->level.height)};
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
        const uint8_t *voids = s->voids.v ? s->voids.v + (y - s->voids.rect.y0) * s->voids.stride + r.x0 : NULL;
        for (int64_t i = 0; i < r.x1 - r.x0; i++) {
            int64_t off = (int64_t)truth[i] - tc_corrected(c, z[i], 0), step = c->correction_step;
            int64_t up = llabs(off) > s->coding->bound && !(voids && voids[i]) ? off + (off > 0 ? step : -step) / 2 : 0;
            n[i] = (int32_t)(up / step);
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

/* Errors and bounds of a tile whose heights are all there. */
static void measure_tile(void *context, int64_t n)
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
            fail_once(s, status);
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
        const uint8_t *voids = s->voids.v ? s->voids.v + (y - s->voids.rect.y0) * w + r.x0 : NULL;
        samples += count;
        for (int64_t i = 0; i < count && voids; i++)
            if (voids[i])
                error[i] = 0, samples--;
        add_errors(&sum, error, count);
    }
    tile->entry.low = low, tile->entry.high = high;
    tile->samples = samples;
    for (int k = 0; k < LANES; k++) {
        tile->square_error += sum.square[k];
        tile->max_error = fmax(tile->max_error, sum.most[k]);
    }
    if (s->voids.v && !add_mask(s, r, tile))
        fail_once(s, TC_ERR_MEMORY);
    uint32_t size = tc_tile_bytes(&tile->entry);
    tile->entry.crc = size ? tc_crc32c(0, tile->bytes, size) : 0;
}

static tc_status write_body(level_state *s, const void *bytes, size_t size, int64_t at, tc_error *error)
{
    const char *from = bytes;
    for (size_t done = 0; done < size;) {
        ssize_t n = pwrite(s->p->body, from + done, size - done, s->record->begin + at + (int64_t)done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", s->p->path, strerror(errno));
        done += (size_t)n;
    }
    return TC_OK;
}

/* Writes the pages and tiles of the row of pages that has been gathered. */
static tc_status flush_pages(level_state *s, int64_t py, tc_error *error)
{
    tc_page_form form = {s->record->coder == TC_CODER_CORRECTIONS, s->record->mask};
    for (int64_t px = 0; px < s->pages.pages_x; px++) {
        tc_rect t = tc_page_tiles(&s->pages, px, py);
        tc_tile_entry entry[TC_PAGE_TILES];
        int count = 0;
        for (int64_t ty = t.y0; ty < t.y1; ty++)
            for (int64_t tx = t.x0; tx < t.x1; tx++)
                entry[count++] = s->band_tile[(ty - t.y0) * s->pages.tiles_x + tx].entry;
        s->out.size = 0;
        uint8_t *page = tc_put_room(&s->out, tc_page_bound());
        size_t page_size = page ? tc_page_write(form, entry, count, page) : 0;
        s->out.size = page_size;
        for (int64_t ty = t.y0; ty < t.y1; ty++)
            for (int64_t tx = t.x0; tx < t.x1; tx++) {
                coded_tile *tile = &s->band_tile[(ty - t.y0) * s->pages.tiles_x + tx];
                tc_put_bytes(&s->out, tile->bytes, tc_tile_bytes(&tile->entry));
                free(tile->bytes);
                *tile = (coded_tile){0};
            }
        if (s->out.failed)
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", s->p->path);
        int64_t number = py * s->pages.pages_x + px, chunk = number / TC_DIRECTORY_CHUNK;
        uint8_t *where =
            s->directory + tc_directory_chunk_offset(chunk) + number % TC_DIRECTORY_CHUNK * TC_DIRECTORY_ENTRY;
        tc_store(where, (uint64_t)s->written, 8);
        tc_store(where + 8, page_size, 4);
        tc_store(where + 12, tc_crc32c(0, s->out.bytes, page_size), 4);
        tc_status status = write_body(s, s->out.bytes, s->out.size, s->written, error);
        if (status)
            return status;
        s->written += (int64_t)s->out.size;
    }
    return TC_OK;
}

/* Finishes the rows of tiles whose heights are all there. */
static tc_status finish_rows(level_state *s, tc_error *error)
{
    int64_t h = s->level.height, w = s->level.width, across = s->pages.tiles_x;
    s->finish_to = s->ready == h ? s->pages.tiles_y : s->ready / FINE;
    int64_t y0 = s->finished * FINE, y1 = tc_min64(s->finish_to * FINE, h);
    tc_status status = TC_OK;
    if (s->source)
        status = tc_pack_source_rows(s->p, y0, y1, s->source, error);
    if (!status && s->voids.v) {
        s->voids.stride = w;
        s->voids.rect = (tc_rect){0, tc_max64(y0 - 2 * TC_MASK_MARGIN, 0), w, tc_min64(y1 + 2 * TC_MASK_MARGIN, h)};
        status = tc_pack_mask_rows(s->p, s->coding->l, s->voids.rect.y0, s->voids.rect.y1, s->voids.v, error);
    }
    if (status)
        return status;
    tc_parallel_for(s->p->options.threads, (s->finish_to - s->finished) * across, measure_tile, s);
    if (s->status)
        return tc_fail(error, s->status, "%s: %s", s->p->path, tc_status_text(s->status));
    if (s->coding->fine)
        status = tc_spool_write(s->coding->fine, (tc_rect){0, y0, w, y1}, tc_plane_at(&s->fine, 0, y0), w, error);
    for (int64_t ty = s->finished; ty < s->finish_to && !status; ty++) {
        for (int64_t tx = 0; tx < across; tx++) {
            coded_tile *tile = &s->tile[(ty - s->finished) * across + tx];
            s->outcome.square_error += tile->square_error, s->outcome.samples += tile->samples;
            s->outcome.max_error = fmax(s->outcome.max_error, tile->max_error);
            s->record->lowest = tile->entry.low < s->record->lowest ? tile->entry.low : s->record->lowest;
            s->record->highest = tile->entry.high > s->record->highest ? tile->entry.high : s->record->highest;
            s->band_tile[ty % TC_PAGE_ROWS * across + tx] = *tile;
            tile->bytes = NULL;
        }
        if (ty % TC_PAGE_ROWS == TC_PAGE_ROWS - 1 || ty == s->pages.tiles_y - 1)
            status = flush_pages(s, ty / TC_PAGE_ROWS, error);
    }
    /* What is not finished moves to the front. */
    int64_t gone = s->finish_to - s->finished, left = s->t1 - s->finish_to;
    memmove(s->tile, s->tile + gone * across, (size_t)(left * across) * sizeof *s->tile);
    memset(s->tile + left * across, 0, (size_t)((s->rows_at_once + 1 - left) * across) * sizeof *s->tile);
    s->finished = s->finish_to;
    return status;
}

static tc_status run_group(level_state *s, tc_error *error)
{
    tc_status status = load_group(s, error);
    if (status)
        return status;
    tc_parallel_for(s->p->options.threads, (s->t1 - s->t0) * s->pages.tiles_x, code_tile, s);
    if (!s->status && s->coding->coder->codec)
        tc_parallel_for(s->p->options.threads, (s->ready - s->ready_before + CHUNK - 1) / CHUNK, synthesise_rows, s);
    if (s->status == TC_ERR_UNSUPPORTED)
        return tc_fail(error, s->status, "%s: the step is too fine for heights so far apart", s->p->path);
    if (s->status)
        return tc_fail(error, s->status, "%s: a tile of level %d cannot be coded: %s", s->p->path, s->coding->l,
                       tc_status_text(s->status));
    return finish_rows(s, error);
}

/* Rows of tiles in memory at once: enough for all threads, but not too many bytes. */
static int64_t group_rows(const level_state *s)
{
    int threads = s->p->options.threads > 0 ? s->p->options.threads : (int)sysconf(_SC_NPROCESSORS_ONLN);
    int64_t bytes = FINE * s->level.width * 13, wanted = (GROUP_TASKS * threads - 1) / s->pages.tiles_x + 1;
    return tc_clamp64(wanted, 1, tc_max64(1, tc_min64(GROUP_BYTES / bytes, s->pages.tiles_y)));
}

static void seal_directory(level_state *s)
{
    int64_t entries = s->pages.pages_x * s->pages.pages_y;
    for (int64_t first = 0, chunk = 0; first < entries; first += TC_DIRECTORY_CHUNK, chunk++) {
        uint8_t *bytes = s->directory + tc_directory_chunk_offset(chunk);
        size_t size = (size_t)tc_min64(entries - first, TC_DIRECTORY_CHUNK) * TC_DIRECTORY_ENTRY;
        tc_store(bytes + size, tc_crc32c(0, bytes, size), 4);
    }
}

tc_status tc_pack_level(tc_packer *p, const tc_level_coding *coding, tc_level_outcome *outcome_ret, tc_error *error)
{
    const tc_level *size = &p->container.level[coding->l - 1];
    level_state s = {.p = p, .coding = coding, .record = &p->container.record[coding->l - 1]};
    s.level = coding->coder->level;
    s.cw = tc_coarse_size(size->width), s.ch = tc_coarse_size(size->height);
    s.pages = tc_level_pages(size);
    s.rows_at_once = group_rows(&s);
    s.written = tc_directory_bytes(&s.pages);
    s.record->begin = p->body_size;
    s.record->lowest = INT32_MAX, s.record->highest = INT32_MIN;
    pthread_mutex_init(&s.mutex, NULL);
    tc_status status = reserve(&s) ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (s.t0 = 0; s.t0 < s.pages.tiles_y && !status; s.t0 = s.t1) {
        s.t1 = tc_min64(s.t0 + s.rows_at_once, s.pages.tiles_y);
        status = run_group(&s, error);
        if (!status)
            status = tc_pack_progress(p, coding->share * (double)(s.t1 - s.t0) / (double)s.pages.tiles_y, error);
    }
    if (!status) {
        seal_directory(&s);
        status = write_body(&s, s.directory, (size_t)tc_directory_bytes(&s.pages), 0, error);
    }
    if (!status) {
        tc_level_outcome *o = &s.outcome;
        o->bytes = s.written;
        s.record->end = p->body_size = s.record->begin + s.written;
        s.record->rms = (float)(o->samples ? sqrt(o->square_error / (double)o->samples) : 0);
        s.record->max_error = nextafterf((float)o->max_error, INFINITY);
        if (o->max_error == 0)
            s.record->max_error = 0;
        *outcome_ret = *o;
    }
    release(&s);
    return status;
}
