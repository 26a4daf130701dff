/* level_coder.h - the tiles of a level, whichever of the coders made them: what a decoder needs to know, a tile from
 * its bytes, heights from tiles and the coarser level. */
#ifndef TC_LEVEL_CODER_H
#define TC_LEVEL_CODER_H

#include "common/codec/lifting/codec_correction.h"
#include "common/codec/exact/codec_exact.h"
#include "common/codec/lh04/codec_lh04.h"
#include "container.h"

enum { TC_TILE_SIDE = 2 * TC_TILE }; /* samples */

/* A decoded tile, before the coarser level is added. */
typedef struct tc_decoded_tile {
    union {
        int32_t band[TC_BANDS][TC_TILE][TC_TILE];   /* of the lifting, corrected or not: details */
        int32_t sample[TC_TILE_SIDE][TC_TILE_SIDE]; /* TC_CODER_EXACT: heights; TC_CODER_LH04: residuals */
    };
    int32_t correction[TC_TILE_SIDE][TC_TILE_SIDE]; /* multiples; there for coders that correct only */
} tc_decoded_tile;

/* Bytes of it that a coder uses. */
size_t tc_decoded_tile_bytes(tc_coder coder);

/* What decoding a level takes; encoding too. */
typedef struct tc_level_coder {
    tc_coder coder;
    tc_lifting_level level;
    int32_t correction_step, correction_snap;
    tc_codec *codec; /* the lifting's; of the others, those that the coder uses */
    tc_correction *correction;
    tc_exact *exact;
    tc_lh04_codec *lh04;
} tc_level_coder;

/* Reads the model of a level's record. TC_ERR_FORMAT: damaged. */
tc_status tc_level_coder_init(tc_level_coder *coder, const tc_lifting_level *level, const tc_level_record *record);
void tc_level_coder_free(tc_level_coder *coder);
size_t tc_level_coder_bytes(const tc_level_coder *coder);

/* Memory for a tile's work, and room for its bytes, all streams; whatever the coder. */
size_t tc_level_coder_work_bytes(void);
size_t tc_level_coder_bound(void);

/* Samples of a tile, cut to the level, and its positions. */
tc_rect tc_level_coder_samples(const tc_level_coder *coder, int64_t tx, int64_t ty);
tc_rect tc_level_coder_positions(const tc_level_coder *coder, int64_t tx, int64_t ty);

/* Rectangle of the coarser level that decoding a tile looks at; may be empty. */
tc_rect tc_level_coder_needs(const tc_level_coder *coder, int64_t tx, int64_t ty);

/* A tile to decode. */
typedef struct tc_level_tile {
    int64_t tx, ty;
    tc_tile_entry entry;
    const uint8_t *bytes; /* NULL: lost */
    tc_decoded_tile *to;
    const tc_plane *band; /* [TC_BANDS] where details go instead, without corrections; else NULL */
    void *work;
    tc_status status; /* set */
} tc_level_tile;

/* Decodes up to TC_TOGETHER tiles at a time, each with its own work memory; where a tile's bytes are damaged or lost,
 * it comes out as one that adds nothing to the coarser level, and its status is TC_ERR_FORMAT. */
void tc_level_coder_decode(const tc_level_coder *coder, tc_level_tile *tile, int count, const tc_plane *coarse);

/* A synthesised height, corrected. */
static inline int32_t tc_corrected(const tc_level_coder *c, int32_t z, int32_t k)
{
    int64_t snap = c->correction_snap, half = snap / 2, up = (int64_t)z + half;
    int64_t snapped = (up >= 0 ? up / snap : -((-up + snap - 1) / snap)) * snap;
    return (int32_t)(uint32_t)(uint64_t)(snapped + (int64_t)k * c->correction_step);
}

/* The same of a row. */
void tc_level_coder_correct(const tc_level_coder *coder, int32_t *z, const int32_t *k, int64_t count);

#endif
