/* level_coder.h - decoding the tiles of a level, whichever of the coders made them. */
#ifndef TC_LEVEL_CODER_H
#define TC_LEVEL_CODER_H

#include "container.h"

/* A decoded tile, before the coarser level is added: details of the lifting's bands, [band][j][i] over 64 x 64
 * positions. */
typedef struct tc_decoded_tile {
    int32_t band[TC_BANDS][TC_TILE][TC_TILE];
} tc_decoded_tile;

/* A level's decoder. */
typedef struct tc_level_coder {
    tc_coder coder;
    tc_lifting_level level;
    tc_codec *codec;
} tc_level_coder;

/* Reads the model of a level's record. TC_ERR_FORMAT: damaged. */
tc_status tc_level_coder_init(tc_level_coder *coder, const tc_level *size, const tc_level_record *record, bool wrap_x);
void tc_level_coder_free(tc_level_coder *coder);
size_t tc_level_coder_bytes(const tc_level_coder *coder);

/* Memory for decoding a tile. */
size_t tc_level_coder_work_bytes(void);

/* Rectangle of the coarser level that decoding a tile looks at. */
tc_rect tc_level_coder_needs(const tc_level_coder *coder, int64_t tx, int64_t ty);

/* Decodes a tile; where its bytes are damaged it comes out as if it were empty, and the status is TC_ERR_FORMAT. */
tc_status tc_level_coder_decode(const tc_level_coder *coder, int64_t tx, int64_t ty, const tc_tile_entry *entry,
                                const uint8_t *bytes, const tc_plane *coarse, tc_decoded_tile *tile, void *work);

#endif
