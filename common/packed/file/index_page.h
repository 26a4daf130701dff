/* index_page.h - what a packed level says of its tiles: where they are, their checksums, their lowest and highest
 * heights. Tiles are listed in pages of TC_PAGE_COLUMNS x TC_PAGE_ROWS, each compressed and checked on its own. */
#ifndef TC_INDEX_PAGE_H
#define TC_INDEX_PAGE_H

#include "common/codec/mask/void_mask.h"

enum {
    TC_PAGE_COLUMNS = 32,
    TC_PAGE_ROWS = 8,
    TC_PAGE_TILES = TC_PAGE_COLUMNS * TC_PAGE_ROWS,
    TC_BOUND_STEPS = 256 /* from a page's lowest to its highest height, in which tiles' bounds are told */
};

/* The streams of a tile, one behind the other. */
enum { TC_STREAM_HEIGHTS, TC_STREAM_CORRECTIONS, TC_STREAM_MASK, TC_STREAMS };

typedef struct tc_tile_entry {
    uint32_t size[TC_STREAMS]; /* bytes */
    uint32_t crc;              /* of all of them; 0 where there are none */
    uint8_t mask_class;        /* tc_mask_class */
    uint32_t step;     /* most that a sample is off the coarser level's mesh on the spot, height units; reading gives as
                          much     or a little more, or TC_STEP_UNKNOWN */
    int32_t low, high; /* heights, in height units; reading gives what is as low and as high or a little more */
    uint64_t offset;   /* in the file; not stored: tiles follow their page in order */
} tc_tile_entry;

static inline uint32_t tc_tile_bytes(const tc_tile_entry *entry)
{
    return entry->size[0] + entry->size[1] + entry->size[2];
}

/* What is told of every tile of a level. */
typedef struct tc_page_form {
    bool corrections, mask, step;
    bool repeats; /* not whether it has heights, but whether as many bytes of them as the tile before: as raw ones do */
} tc_page_form;

#define TC_STEP_UNKNOWN UINT32_MAX

/* Writes `count` entries; room for tc_page_bound() bytes. Returns their size. */
size_t tc_page_bound(void);
size_t tc_page_write(tc_page_form form, const tc_tile_entry *entries, int count, uint8_t *bytes);

/* Reads `count` entries but for their offsets. TC_ERR_FORMAT for what no writer makes. */
tc_status tc_page_read(tc_page_form form, const uint8_t *bytes, size_t size, tc_tile_entry *entries, int count);

#endif
