/* mosaic_read.c - bands of rows, read ahead.
 *
 * Two bands: one is being read while the other is being worked on. A band has room for as many rows as its file decodes
 * together, so that no block is decoded twice, but for a bounded number of bytes. */
#include "mosaic_internal.h"

#include "common/base/rect.h"
#include "common/base/status.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>

/* Rows of a band are fewer than its file reads together where they would take more than this. */
enum { BAND_BYTES = 16 << 20, SAMPLE_BYTES = sizeof(float) + 1 };

typedef struct band {
    float *z;
    uint8_t *voids;
    size_t room; /* samples */
    tc_rect rect;
    bool full; /* read, not yet worked on; under the lock */
} band;

typedef struct reader {
    tc_mosaic *mosaic;
    band bands[2];
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool done;    /* nothing more will come; under the lock */
    bool stopped; /* nothing more is wanted; likewise */
    tc_status status;
    tc_error error;
} reader;

/* ---- The reading thread ----------------------------------------------------------------------------------------- */

/* Waits for a band to be free; NULL: nothing more is wanted. */
static band *wait_free(reader *r, int *turn)
{
    band *b = &r->bands[*turn];
    pthread_mutex_lock(&r->lock);
    while (b->full && !r->stopped)
        pthread_cond_wait(&r->changed, &r->lock);
    bool stopped = r->stopped;
    pthread_mutex_unlock(&r->lock);
    *turn = !*turn;
    return stopped ? NULL : b;
}

static void hand_over(reader *r, band *b)
{
    pthread_mutex_lock(&r->lock);
    b->full = true;
    pthread_cond_broadcast(&r->changed);
    pthread_mutex_unlock(&r->lock);
}

static bool make_room(band *b, size_t samples)
{
    if (b->room >= samples)
        return true;
    free(b->z);
    free(b->voids);
    b->z = malloc(samples * sizeof *b->z);
    b->voids = malloc(samples);
    b->room = b->z && b->voids ? samples : 0;
    return b->room > 0;
}

static tc_status read_part(reader *r, int i, int *turn, tc_error *error)
{
    tc_mosaic *m = r->mosaic;
    const tc_mosaic_part *part = &m->parts[i];
    tc_source *source = NULL;
    m->silent = true; /* what there is to say on opening was said the first time */
    tc_status status = tc_mosaic_open_part(m, i, &source, error);
    m->silent = false;
    if (status != TC_OK)
        return status;
    const tc_source_info *info = tc_source_get_info(source);
    if (info->width != part->width || info->height != part->height)
        status = tc_fail(error, TC_ERR_IO,
                         "%s: expected %" PRId64 " x %" PRId64 " samples as before, found %" PRId64 " x %" PRId64
                         ": it has changed meanwhile",
                         part->path, part->width, part->height, info->width, info->height);
    int64_t rows = tc_min64(tc_source_chunk_rows(source), tc_max64(1, BAND_BYTES / (SAMPLE_BYTES * part->width)));
    for (int64_t end = part->height; end > 0 && status == TC_OK; end -= rows) {
        int64_t start = tc_max64(0, end - rows);
        band *b = wait_free(r, turn);
        if (!b)
            break;
        if (!make_room(b, (size_t)(tc_min64(rows, part->height) * part->width)))
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %" PRId64 " rows", part->path, rows);
        else
            status = tc_source_read(source, start, end - start, b->z, b->voids, error);
        b->rect = (tc_rect){part->x0, part->y0 + start, part->x0 + part->width, part->y0 + end};
        if (status == TC_OK)
            hand_over(r, b);
    }
    tc_source_close(source);
    return status;
}

static void *read_all(void *context)
{
    reader *r = context;
    int turn = 0;
    tc_status status = TC_OK;
    for (int i = 0; i < r->mosaic->count && status == TC_OK; i++) {
        pthread_mutex_lock(&r->lock);
        bool stopped = r->stopped;
        pthread_mutex_unlock(&r->lock);
        if (stopped)
            break;
        status = read_part(r, i, &turn, &r->error);
    }
    pthread_mutex_lock(&r->lock);
    r->status = status;
    r->done = true;
    pthread_cond_broadcast(&r->changed);
    pthread_mutex_unlock(&r->lock);
    return NULL;
}

/* ---- The calling thread ----------------------------------------------------------------------------------------- */

static tc_status work(reader *r, tc_band_function give, void *context, tc_error *error)
{
    tc_status status = TC_OK;
    for (int turn = 0; status == TC_OK; turn = !turn) {
        band *b = &r->bands[turn];
        pthread_mutex_lock(&r->lock);
        while (!b->full && !r->done)
            pthread_cond_wait(&r->changed, &r->lock);
        bool full = b->full;
        pthread_mutex_unlock(&r->lock);
        if (!full)
            break;
        status = give(context, b->rect, b->z, b->voids, error);
        pthread_mutex_lock(&r->lock);
        b->full = false;
        r->stopped = status != TC_OK;
        pthread_cond_broadcast(&r->changed);
        pthread_mutex_unlock(&r->lock);
    }
    return status;
}

tc_status tc_mosaic_read(tc_mosaic *mosaic, tc_band_function give, void *context, tc_error *error)
{
    reader r = {
        .mosaic = mosaic, .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .status = TC_OK};
    pthread_t thread;
    if (pthread_create(&thread, NULL, read_all, &r) != 0)
        return tc_fail(error, TC_ERR_MEMORY, "mosaic: no thread to read with can be started");
    tc_status status = work(&r, give, context, error);
    pthread_join(thread, NULL);
    for (int i = 0; i < 2; i++) {
        free(r.bands[i].z);
        free(r.bands[i].voids);
    }
    if (status == TC_OK && r.status != TC_OK)
        status = tc_fail(error, r.status, "%s", r.error.text);
    return status;
}
