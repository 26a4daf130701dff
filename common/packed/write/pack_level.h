/* pack_level.h - a level being packed: what pack_level.c, which goes through its strips, and pack_tile.c, which does
 * the work on a tile, share. */
#ifndef TC_PACK_LEVEL_H
#define TC_PACK_LEVEL_H

#include <pthread.h>

#include "pack_internal.h"

enum { FINE = TC_TILE_SIDE, MARGIN = TC_LIFTING_REACH + 1 /* positions around a tile that its details depend on */ };

/* A coded tile that waits to be finished, and what finishing finds. */
typedef struct coded_tile {
    tc_tile_entry entry;
    uint8_t *bytes;
    double square_error, max_error;
    int64_t samples;
    bool raw; /* takes no model */
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
    int64_t beyond; /* columns of the other side that planes have on either; 0 where the level does not wrap */
    /* The group. */
    int64_t rows_at_once, t0, t1, finished; /* rows of tiles */
    tc_plane truth, coarse, band[TC_BANDS], fine;
    int64_t ready, ready_before; /* fine rows reconstructed */
    coded_tile *tile;            /* of rows `finished` .. t1 - 1 */
    float *source;               /* finest level: heights as given, of the rows being finished */
    tc_plane below;              /* the coarser level as it is reconstructed, under the same rows */
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

/* Work on one tile, for tc_parallel_for(): tile number n of the group coded; tile number n of the rows to be finished
 * corrected, measured, and its mask added. `context` is a level_state. */
void tc_pack_code_tile(void *context, int64_t n);
void tc_pack_finish_tile(void *context, int64_t n);

/* The multiple that corrects a height z as synthesised to within `bound` of what it should be; 0 where it is. */
static inline int32_t tc_pack_correction(const tc_level_coder *c, int32_t z, int32_t truth, int32_t bound)
{
    int64_t off = (int64_t)truth - tc_corrected(c, z, 0), step = c->correction_step;
    return llabs(off) > bound ? (int32_t)((off + (off > 0 ? step : -step) / 2) / step) : 0;
}

/* Keeps the first status that is not TC_OK. */
void tc_pack_fail(level_state *s, tc_status status);

void tc_pack_tile_memory_free(level_state *s);

#endif
