/* tile_store.c - made with the first chart of a file, freed with the last one. */
#include "tile_store.h"

#include <stdlib.h>

#include "packed_internal.h"

enum { USUAL_BYTES = 40 << 20, LEAST_BYTES = 1 << 20 };

tc_tile_store *tc_tile_store_create(size_t bytes)
{
    tc_tile_store *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    bytes = bytes ? bytes : USUAL_BYTES;
    bytes = bytes > LEAST_BYTES ? bytes : LEAST_BYTES;
    s->users = 1;
    if (tc_block_cache_init(&s->blocks, bytes)) {
        tc_block_cache_free(&s->blocks);
        free(s);
        return NULL;
    }
    tc_faults_init(&s->faults);
    tc_prefetch_init(&s->prefetch, tc_packed_read_piece, bytes / 2, 0);
    return s;
}

void tc_tile_store_release(tc_tile_store *s)
{
    if (!s || --s->users > 0)
        return;
    tc_prefetch_free(&s->prefetch);
    tc_faults_free(&s->faults);
    tc_block_cache_free(&s->blocks);
    free(s);
}
