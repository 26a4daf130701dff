/* imagery_field.c - tiles of colours as a field: made when they are read, or ahead of that, and kept for a while. */
#include <stdlib.h>
#include <string.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "imagery_internal.h"

enum { TILE = TC_IMAGERY_TILE, TILE_BYTES = TILE * TILE * 4 };

static uint64_t key_of(const tc_colour_field *f, int level, int64_t tx, int64_t ty)
{
    return (uint64_t)f->owner << TC_BLOCK_OWNER_SHIFT | (uint64_t)level << 52 | (uint64_t)ty << 26 | (uint64_t)tx;
}

/* Tiles that a rectangle touches, row by row. */
typedef struct tiles {
    int64_t x0, y0, across, count;
} tiles;

static tiles tiles_of(tc_rect r)
{
    tiles t = {r.x0 / TILE, r.y0 / TILE, (r.x1 - 1) / TILE - r.x0 / TILE + 1, 0};
    t.count = t.across * ((r.y1 - 1) / TILE - t.y0 + 1);
    return t;
}

static tc_rect tile_rect(const tc_colour_field *f, int level, int64_t tx, int64_t ty)
{
    const tc_level *l = &f->head.level[level - 1];
    return tc_rect_intersect((tc_rect){tx * TILE, ty * TILE, (tx + 1) * TILE, (ty + 1) * TILE},
                             (tc_rect){0, 0, l->width, l->height});
}

static void tell_failure(tc_imagery *imagery, tc_status status, const tc_error *error)
{
    pthread_mutex_lock(&imagery->mutex);
    if (imagery->failed == TC_OK)
        imagery->failed = status, imagery->error = *error;
    pthread_mutex_unlock(&imagery->mutex);
}

/* The tile, made if need be; to be released. NULL: it cannot be made. */
static tc_block *take_tile(tc_colour_field *f, int level, int64_t tx, int64_t ty, tc_status *status_ret)
{
    tc_imagery *imagery = f->imagery;
    uint64_t key = key_of(f, level, tx, ty);
    tc_block *block = tc_block_pin(&imagery->blocks, key, TILE_BYTES);
    *status_ret = block ? TC_OK : TC_ERR_MEMORY;
    if (!block || block->made)
        return block;
    tc_error error = {0};
    *status_ret = tc_imagery_make(f, level, tile_rect(f, level, tx, ty), (uint8_t(*)[4])block->bytes, TILE, &error);
    tc_block_made(&imagery->blocks, block, *status_ret == TC_OK);
    if (*status_ret == TC_OK) {
        f->made++;
        tc_faults_remove(&imagery->faults, key);
        return block;
    }
    if (*status_ret != TC_ERR_MEMORY) {
        tc_faults_add(&imagery->faults, key);
        tell_failure(imagery, *status_ret, &error);
    }
    tc_block_release(&imagery->blocks, block);
    return NULL;
}

/* ---- Reading ------------------------------------------------------------------------------------------------------
 */

typedef struct reading {
    tc_colour_field *field;
    int level;
    tc_rect rect;
    uint8_t (*out)[4];
    ptrdiff_t stride;
    tiles tiles;
    _Atomic int status;
} reading;

static void copy_part(const reading *r, int64_t tx, int64_t ty, const tc_block *block)
{
    tc_rect part = tc_rect_intersect(r->rect, tile_rect(r->field, r->level, tx, ty));
    for (int64_t y = part.y0; y < part.y1; y++)
        memcpy(r->out + (y - r->rect.y0) * r->stride + (part.x0 - r->rect.x0),
               block->bytes + ((y - ty * TILE) * TILE + part.x0 - tx * TILE) * 4, (size_t)(part.x1 - part.x0) * 4);
}

static void read_tile(void *context, int64_t i)
{
    reading *r = context;
    int64_t tx = r->tiles.x0 + i % r->tiles.across, ty = r->tiles.y0 + i / r->tiles.across;
    tc_status status;
    tc_block *block = take_tile(r->field, r->level, tx, ty, &status);
    if (!block) {
        r->status = status;
        return;
    }
    copy_part(r, tx, ty, block);
    tc_block_release(&r->field->imagery->blocks, block);
}

static tc_status colours_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                              ptrdiff_t stride)
{
    tc_colour_field *f = (tc_colour_field *)field;
    (void)voids; /* alpha tells */
    reading r = {.field = f, .level = level, .rect = rect, .out = samples, .stride = stride, .tiles = tiles_of(rect)};
    int missing = 0;
    for (int64_t i = 0; i < r.tiles.count && missing < 2; i++)
        missing += !tc_block_has(&f->imagery->blocks,
                                 key_of(f, level, r.tiles.x0 + i % r.tiles.across, r.tiles.y0 + i / r.tiles.across));
    tc_parallel_for(missing > 1 ? f->imagery->threads : 1, r.tiles.count, read_tile, &r);
    return (tc_status)r.status;
}

static bool colours_read_ready(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                               ptrdiff_t stride)
{
    tc_colour_field *f = (tc_colour_field *)field;
    (void)voids;
    const reading r = {.field = f, .level = level, .rect = rect, .out = samples, .stride = stride};
    const tiles t = tiles_of(rect);
    for (int64_t i = 0; i < t.count; i++) {
        int64_t tx = t.x0 + i % t.across, ty = t.y0 + i / t.across;
        tc_block *block = tc_block_find(&f->imagery->blocks, key_of(f, level, tx, ty));
        if (!block)
            return false;
        copy_part(&r, tx, ty, block);
        tc_block_release(&f->imagery->blocks, block);
    }
    return true;
}

/* ---- Reading ahead ------------------------------------------------------------------------------------------------
 */

static tc_ready colours_ready(const tc_field *field, int level, tc_rect rect, tc_urgency urgency)
{
    tc_colour_field *f = (tc_colour_field *)field;
    tc_imagery *imagery = f->imagery;
    const tc_level *l = &field->level[level - 1];
    tc_rect piece[2];
    bool missing = false, failed = false;
    size_t bytes = 0;
    for (int n = tc_rect_round(rect, l->width, piece) - 1; n >= 0; n--) {
        const tiles t = tiles_of(piece[n]);
        for (int64_t i = 0; i < t.count; i++) {
            uint64_t key = key_of(f, level, t.x0 + i % t.across, t.y0 + i / t.across);
            bytes += TILE_BYTES;
            if (tc_block_has(&imagery->blocks, key))
                continue;
            missing = true;
            failed |= tc_faults_pause(&imagery->faults, key);
        }
    }
    tc_block_cache_needs(&imagery->blocks, 2 * bytes);
    if (!missing) {
        tc_prefetch_collect(&imagery->prefetch, f, level, rect);
        return TC_READY;
    }
    if (failed)
        return TC_FAILED;
    const tc_wish wish = {.field = f, .level = level, .rect = rect, .urgency = urgency, .bytes = bytes};
    return urgency == TC_ONLY_ASK || tc_prefetch_ask(&imagery->prefetch, &wish) ? TC_COMING : TC_FAILED;
}

static void colours_overtaken(const tc_field *field, int level, tc_rect rect)
{
    tc_colour_field *f = (tc_colour_field *)field;
    f->cancelled += tc_prefetch_cancel(&f->imagery->prefetch, f, level, rect);
}

/* The next tile of a wish: the first one that is missing. */
tc_piece tc_colour_read_piece(tc_wish *wish)
{
    tc_colour_field *f = wish->field;
    tc_rect piece[2];
    int pieces = tc_rect_round(wish->rect, f->head.level[wish->level - 1].width, piece);
    for (int n = 0; n < pieces; n++) {
        const tiles t = tiles_of(piece[n]);
        for (int64_t i = 0; i < t.count; i++) {
            int64_t tx = t.x0 + i % t.across, ty = t.y0 + i / t.across;
            tc_status status;
            if (tc_block_has(&f->imagery->blocks, key_of(f, wish->level, tx, ty)))
                continue;
            tc_block *block = take_tile(f, wish->level, tx, ty, &status);
            if (!block)
                return status == TC_ERR_MEMORY ? TC_PIECE_NO_MEMORY : TC_PIECE_FAILED;
            tc_block_release(&f->imagery->blocks, block);
            return TC_PIECE_MORE;
        }
    }
    return TC_PIECE_LAST;
}

/* ---- The rest -----------------------------------------------------------------------------------------------------
 */

static tc_range colours_range(const tc_field *field, int level, tc_rect rect)
{
    (void)field, (void)level, (void)rect;
    return (tc_range){0, 0, INFINITY, INFINITY}; /* colours have no height */
}

static void colours_tell(const tc_field *field, tc_field_stats *stats)
{
    tc_colour_field *f = (tc_colour_field *)field;
    size_t cached = tc_block_cache_owned(&f->imagery->blocks, f->owner);
    stats->bytes += sizeof *f + cached;
    stats->cache_bytes += cached;
    stats->decoded += f->made * TILE_BYTES;
    stats->cancelled += f->cancelled;
    stats->unreadable += tc_faults_count(&f->imagery->faults, f->owner);
}

static void colours_destroy(tc_field *field)
{
    free(field);
}

static const tc_field_class colours_class = {.sample = TC_FIELD_COLOURS,
                                             .read = colours_read,
                                             .read_ready = colours_read_ready,
                                             .ready = colours_ready,
                                             .overtaken = colours_overtaken,
                                             .range = colours_range,
                                             .tell = colours_tell,
                                             .destroy = colours_destroy};

tc_colour_field *tc_colour_field_create(tc_imagery *imagery, int chart, tc_level finest)
{
    tc_colour_field *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->head.class = &colours_class;
    f->head.info.wraps_x = imagery->map->chart[chart].wraps;
    f->imagery = imagery;
    f->chart = f->owner = chart;
    tc_field_set_levels(&f->head, finest);
    return f;
}
