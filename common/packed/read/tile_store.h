/* tile_store.h - what the charts of a file share: decoded tiles that are kept, the thread that reads ahead, and what
 * could not be read. */
#ifndef TC_TILE_STORE_H
#define TC_TILE_STORE_H

#include "common/packed/file/block_cache.h"
#include "common/packed/file/packed_file.h"
#include "prefetch.h"
#include "tile_faults.h"

typedef struct tc_tile_store {
    _Atomic int users;
    _Atomic int owners;    /* charts so far, for their keys */
    tc_block_cache blocks; /* tiles, and masks as bytes, [j][i] over 128 x 128 samples */
    tc_prefetch prefetch;
    tc_tile_faults faults;
} tc_tile_store;

/* For one user; bytes: 0 for as many as is usual. NULL where there is no memory. */
tc_tile_store *tc_tile_store_create(size_t bytes);
/* The last user's frees it. */
void tc_tile_store_release(tc_tile_store *store);

/* As tc_field_open_bytes(), of a chart of a file of version 3 (of older files chart 0 alone), with a store that other
 * charts of the same file use as well; NULL: one of its own. At most TC_BLOCK_OWNERS charts. */
tc_status tc_packed_open_chart(const char *name, const tc_byte_source *source, int chart,
                               const tc_open_options *options, tc_tile_store *store, tc_field **field_ret,
                               tc_error *error);

#endif
