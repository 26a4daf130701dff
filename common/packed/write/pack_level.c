/* pack_level.c - one level, strip by strip of tiles: encoded, decoded again, measured, indexed.
 *
 * A group of rows of tiles is in memory at a time. Details of a tile are taken from the true heights around it; the
 * decoded details of the group, with some rows before it, give the reconstructed heights but for the last few, which
 * wait for the next group. A row of tiles whose heights are all known is finished: measured, and handed to its page.
 * Tiles are tasks that any thread may take; what goes into the file and into sums is put together in their order. */
#include <errno.h>
#include <math.h>
#include <unistd.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/base/crc32c.h"
#include "pack_level.h"

enum {
    BEFORE = 8, /* rows of positions kept before the group: more than the filters reach */
    BEYOND = 8, /* columns of planes beyond the seam: more than anything looks at */
    GROUP_BYTES = 96 << 20,
    GROUP_TASKS = 128, /* for each thread, at least */
    CHUNK = 32         /* rows that are one task */
};

/* ---- Group of rows of tiles ------------------------------------------------------------------------------------ */

static int64_t plane_room(int64_t rows, int64_t width, int64_t height)
{
    return tc_min64(rows, height) * width;
}

static bool reserve(level_state *s)
{
    int64_t w = s->level.width + 2 * s->beyond, h = s->level.height, cw = s->cw + 2 * s->beyond, g = s->rows_at_once;
    size_t n = sizeof(int32_t);
    s->truth.z = malloc((size_t)plane_room((g + 1) * FINE + 4 * MARGIN + 2 * BEFORE, w, h) * n);
    s->fine.z = malloc((size_t)plane_room((g + 2) * FINE, w, h) * n);
    s->coarse.z = malloc((size_t)plane_room(g * TC_TILE + 2 * BEFORE, cw, s->ch) * n);
    s->below.z = malloc((size_t)(plane_room((g + 1) * TC_TILE, s->cw, s->ch) + 2 * s->cw) * n);
    bool good = s->truth.z && s->fine.z && s->coarse.z && s->below.z;
    for (int b = 0; b < TC_BANDS; b++) {
        s->band[b].z = malloc((size_t)plane_room((g + 1) * TC_TILE + BEFORE, cw, s->ch) * n);
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
    free(s->truth.z), free(s->fine.z), free(s->coarse.z), free(s->below.z);
    for (int b = 0; b < TC_BANDS; b++)
        free(s->band[b].z);
    for (int64_t i = 0; s->tile && i < (s->rows_at_once + 1) * s->pages.tiles_x; i++)
        free(s->tile[i].bytes);
    for (int64_t i = 0; s->band_tile && i < TC_PAGE_ROWS * s->pages.tiles_x; i++)
        free(s->band_tile[i].bytes);
    free(s->tile), free(s->band_tile), free(s->directory), free(s->source), free(s->voids.v), free(s->out.bytes);
    tc_pack_tile_memory_free(s);
    pthread_mutex_destroy(&s->mutex);
}

/* A plane of whole rows, and columns beyond their ends, that is to start at row y0 and to keep what it has from there
 * on. */
typedef struct slide {
    tc_plane *plane;
    int64_t y0, width, beyond;
} slide;

static void slide_plane(void *context, int64_t n)
{
    const slide *s = (slide *)context + n;
    tc_plane *plane = s->plane;
    int64_t from = tc_clamp64(s->y0, plane->rect.y0, plane->rect.y1), stride = s->width + 2 * s->beyond;
    memmove(plane->z, plane->z + (from - plane->rect.y0) * stride,
            (size_t)((plane->rect.y1 - from) * stride) * sizeof *plane->z);
    plane->stride = stride;
    plane->rect = (tc_rect){-s->beyond, from, s->width + s->beyond, tc_max64(from, plane->rect.y1)};
    if (plane->rect.y0 == plane->rect.y1)
        plane->rect.y0 = plane->rect.y1 = s->y0;
}

/* Lets go of what the group does not need; the largest planes first, each by one thread. */
static void slide_planes(level_state *s)
{
    const int64_t truth = tc_min64(s->finished * FINE, tc_max64(2 * (s->t0 * TC_TILE - MARGIN), 0));
    const int64_t details = tc_max64(s->finished * TC_TILE - BEFORE, 0);
    slide all[2 + TC_BANDS] = {{&s->truth, truth, s->level.width, s->beyond},
                               {&s->fine, s->finished * FINE, s->level.width, 0}};
    for (int b = 0; b < TC_BANDS; b++)
        all[2 + b] = (slide){&s->band[b], details, s->cw, s->beyond};
    tc_parallel_for(s->p->options.threads, 2 + TC_BANDS, slide_plane, all);
}

/* Copies the columns beyond either end of rows y0 .. y1 - 1 from the other side. */
static void close_ring(const tc_plane *plane, int64_t y0, int64_t y1, int64_t width)
{
    for (int64_t y = y0; y < y1; y++) {
        int32_t *row = tc_plane_at(plane, 0, y);
        for (int64_t x = plane->rect.x0; x < 0; x++)
            row[x] = row[x - tc_turn(x, width)];
        for (int64_t x = width; x < plane->rect.x1; x++)
            row[x] = row[x - tc_turn(x, width)];
    }
}

static void close_mask_ring(const tc_mask_plane *mask, int64_t width)
{
    for (int64_t y = mask->rect.y0; y < mask->rect.y1; y++) {
        uint8_t *row = mask->v + (y - mask->rect.y0) * mask->stride - mask->rect.x0;
        for (int64_t x = mask->rect.x0; x < 0; x++)
            row[x] = row[x - tc_turn(x, width)];
        for (int64_t x = width; x < mask->rect.x1; x++)
            row[x] = row[x - tc_turn(x, width)];
    }
}

/* Rows that go from or to a spool, and what they are turned into meanwhile. */
typedef tc_status (*move_rows)(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error);

static tc_status truth_rows(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error)
{
    return tc_pack_truth(s->p, s->coding->l, rows, memory, stride, error);
}

static tc_status coarse_rows(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error)
{
    return tc_spool_read_round(s->coding->coarse, rows, memory, stride, error);
}

static tc_status source_rows(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error)
{
    (void)stride;
    return tc_pack_source_rows(s->p, rows.y0, rows.y1, memory, error);
}

static tc_status mask_rows(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error)
{
    return tc_pack_mask(s->p, s->coding->l, rows, memory, stride, error);
}

static tc_status fine_rows(const level_state *s, tc_rect rows, void *memory, ptrdiff_t stride, tc_error *error)
{
    return tc_spool_write(s->coding->fine, rows, memory, stride, error);
}

typedef struct move {
    level_state *s;
    move_rows rows;
    tc_rect rect;
    char *memory;
    ptrdiff_t stride; /* samples */
    size_t size;      /* of a sample */
    tc_pack_failure failure;
} move;

static void move_chunk(void *context, int64_t n)
{
    move *m = context;
    tc_rect part = m->rect;
    part.y0 += n * CHUNK, part.y1 = tc_min64(part.y0 + CHUNK, m->rect.y1);
    tc_error error = {TC_OK, ""};
    tc_status status = m->rows(m->s, part, m->memory + n * CHUNK * m->stride * (ptrdiff_t)m->size, m->stride, &error);
    tc_pack_failure_keep(&m->failure, status, &error);
}

/* Has all threads move the rows of a rectangle in chunks; memory: where its first sample is, or goes. */
static tc_status move_by_all(level_state *s, move_rows rows, tc_rect rect, void *memory, ptrdiff_t stride, size_t size,
                             tc_error *error)
{
    move m = {.s = s,
              .rows = rows,
              .rect = rect,
              .memory = memory,
              .stride = stride,
              .size = size,
              .failure = {.mutex = PTHREAD_MUTEX_INITIALIZER}};
    tc_parallel_for(s->p->options.threads, (rect.y1 - rect.y0 + CHUNK - 1) / CHUNK, move_chunk, &m);
    return tc_pack_failure_end(&m.failure, error);
}

/* Brings in what rows t0 .. t1 - 1 of tiles need. */
static tc_status load_group(level_state *s, tc_error *error)
{
    int64_t w = s->level.width, h = s->level.height;
    int64_t j0 = s->t0 * TC_TILE, j1 = tc_min64(s->t1 * TC_TILE, s->ch);
    slide_planes(s);
    int64_t from = s->truth.rect.y1, until = tc_max64(from, tc_min64(2 * (j1 + MARGIN), h));
    tc_status status = move_by_all(s, truth_rows, (tc_rect){0, from, w, until}, tc_plane_at(&s->truth, 0, from),
                                   s->truth.stride, sizeof *s->truth.z, error);
    s->truth.rect.y1 = until;
    close_ring(&s->truth, from, until, w);
    s->coarse.stride = s->cw + 2 * s->beyond;
    s->coarse.rect = (tc_rect){-s->beyond, tc_max64(j0 - BEFORE, 0), s->cw + s->beyond, tc_min64(j1 + BEFORE, s->ch)};
    if (!status)
        status = move_by_all(s, coarse_rows, s->coarse.rect, s->coarse.z, s->coarse.stride, sizeof *s->coarse.z, error);
    for (int b = 0; b < TC_BANDS; b++)
        s->band[b].rect.y1 = j1;
    s->ready_before = s->ready;
    bool at_once = !s->coding->coder->codec; /* tiles give heights by themselves */
    s->ready = j1 == s->ch ? h : tc_max64(s->ready, 2 * (at_once ? j1 : j1 - TC_LIFTING_REACH));
    s->fine.rect.y1 = s->ready;
    return status;
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
        tc_pack_fail(s, TC_ERR_MEMORY);
    free(scratch);
}

/* ---- Finishing ------------------------------------------------------------------------------------------------- */

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
    tc_page_form form = tc_level_form(s->record, true);
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
        tc_directory_put(s->directory, py * s->pages.pages_x + px, (uint64_t)s->written, page_size,
                         tc_crc32c(0, s->out.bytes, page_size));
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
        status = move_by_all(s, source_rows, (tc_rect){0, y0, w, y1}, s->source, w, sizeof *s->source, error);
    if (!status && s->voids.v) {
        s->voids.stride = w + 2 * s->beyond;
        s->voids.rect = (tc_rect){-s->beyond, tc_max64(y0 - 2 * TC_MASK_MARGIN, 0), w + s->beyond,
                                  tc_min64(y1 + 2 * TC_MASK_MARGIN, h)};
        status = move_by_all(s, mask_rows, (tc_rect){0, s->voids.rect.y0, w, s->voids.rect.y1}, s->voids.v + s->beyond,
                             s->voids.stride, 1, error);
        if (!status)
            close_mask_ring(&s->voids, w);
    }
    if (status)
        return status;
    s->below.rect = (tc_rect){0, tc_max64(0, tc_min64(y0 / 2, s->ch - 2)), s->cw, tc_min64(y1 / 2 + 1, s->ch)};
    s->below.stride = s->cw;
    if ((status = move_by_all(s, coarse_rows, s->below.rect, s->below.z, s->cw, sizeof *s->below.z, error)))
        return status;
    tc_parallel_for(s->p->options.threads, (s->finish_to - s->finished) * across, tc_pack_finish_tile, s);
    if (s->status)
        return tc_fail(error, s->status, "%s: %s", s->p->path, tc_status_text(s->status));
    if (s->coding->fine)
        status = move_by_all(s, fine_rows, (tc_rect){0, y0, w, y1}, tc_plane_at(&s->fine, 0, y0), w, sizeof *s->fine.z,
                             error);
    for (int64_t ty = s->finished; ty < s->finish_to && !status; ty++) {
        for (int64_t tx = 0; tx < across; tx++) {
            coded_tile *tile = &s->tile[(ty - s->finished) * across + tx];
            s->outcome.square_error += tile->square_error, s->outcome.samples += tile->samples;
            s->outcome.max_error = fmax(s->outcome.max_error, tile->max_error);
            s->outcome.modelled += !tile->raw;
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
    tc_parallel_for(s->p->options.threads, (s->t1 - s->t0) * s->pages.tiles_x, tc_pack_code_tile, s);
    for (int b = 0; b < TC_BANDS && s->coding->coder->codec; b++)
        close_ring(&s->band[b], s->t0 * TC_TILE, s->band[b].rect.y1, s->cw);
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

tc_status tc_pack_level(tc_packer *p, const tc_level_coding *coding, tc_level_outcome *outcome_ret, tc_error *error)
{
    const tc_level *size = &p->container.level[coding->l - 1];
    level_state s = {.p = p, .coding = coding, .record = &p->container.record[coding->l - 1]};
    s.level = coding->coder->level;
    s.cw = tc_coarse_size(size->width), s.ch = tc_coarse_size(size->height);
    s.beyond = s.level.wrap_x ? BEYOND : 0;
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
        tc_directory_seal(s.directory, s.pages.pages_x * s.pages.pages_y);
        status = write_body(&s, s.directory, (size_t)tc_directory_bytes(&s.pages), 0, error);
    }
    if (!status) {
        tc_level_outcome *o = &s.outcome;
        o->bytes = s.written;
        s.record->end = p->body_size = s.record->begin + s.written;
        s.record->rms = (float)(o->samples ? sqrt(o->square_error / (double)o->samples) : 0);
        s.record->max_error = (float)o->max_error;
        if (s.record->max_error < o->max_error)
            s.record->max_error = nextafterf(s.record->max_error, INFINITY);
        *outcome_ret = *o;
    }
    release(&s);
    return status;
}
