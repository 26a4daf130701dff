/* error_store.h - how far levels are off the finest one (measured_errors.h), as a packed file tells it: codes of a byte
 * for each leaf of quadtrees over its samples, in pages of as many samples as those of the index; docs/format.md,
 * "Section 4". */
#ifndef TC_ERROR_STORE_H
#define TC_ERROR_STORE_H

#include "common/field/measured_errors.h"
#include "container.h"

enum {
    TC_ERROR_PAGE_WIDTH = TC_PAGE_COLUMNS * 2 * TC_TILE, /* samples */
    TC_ERROR_PAGE_HEIGHT = TC_PAGE_ROWS * 2 * TC_TILE,
    TC_ERROR_PAGE_LEAVES = TC_ERROR_PAGE_WIDTH / TC_ERROR_TILE * (TC_ERROR_PAGE_HEIGHT / TC_ERROR_TILE), /* most */
    TC_ERROR_COARSEST = 10, /* leaves are as high as a page */
    TC_ERROR_CODES = 256
};

/* Metres that a code of a level stands for whose largest error is `most`: 0, then 16 codes an octave up to `most`. */
float tc_error_metres(float most, int code);

/* The least code that stands for no less than an error, which is at most `most`. */
uint8_t tc_error_code(float most, float error);

/* Leaves of a page of a level: a rectangle of leaves. */
tc_rect tc_error_page_leaves(const tc_level *level, int shift, int64_t px, int64_t py);

/* Codes of a page of w x h leaves, row by row. Room for tc_error_page_bound() bytes; returns the size. */
size_t tc_error_page_bound(void);
size_t tc_error_page_write(const uint8_t *codes, int64_t w, int64_t h, uint8_t *bytes);
tc_status tc_error_page_read(const uint8_t *bytes, size_t size, int64_t w, int64_t h, uint8_t *codes_ret);

/* What the head says of a chart's: bytes, to and from those of a container whose levels are known. False: what no
 * writer makes. */
size_t tc_error_places_bytes(const tc_container *c);
void tc_error_places_put(const tc_container *c, tc_byte_writer *w);
bool tc_error_places_get(tc_container *c, int64_t file_bytes, tc_byte_reader *r);

#endif
