/* block_cache.h - the blocks of equal size that were used last, for any number of threads. A block that is being made
 * by one thread is waited for by the others. */
#ifndef TC_BLOCK_CACHE_H
#define TC_BLOCK_CACHE_H

#include <pthread.h>

#include "common/terraclip.h"

typedef struct tc_block {
    uint64_t key;
    int users;
    bool made, failed; /* failed: nobody finds it any more */
    struct tc_block *same_hash, *newer, *older;
    _Alignas(64) unsigned char bytes[];
} tc_block;

typedef struct tc_block_cache {
    size_t block_bytes;
    int64_t most, count; /* blocks; more than `most` only while more are in use */
    int64_t buckets;
    tc_block **bucket;
    tc_block *newest, *oldest;
    pthread_mutex_t mutex;
    pthread_cond_t made;
} tc_block_cache;

/* A cache of blocks of block_bytes that together take about `bytes`. No block is allocated before it is needed. */
tc_status tc_block_cache_init(tc_block_cache *cache, size_t block_bytes, size_t bytes);
void tc_block_cache_free(tc_block_cache *cache);

/* The block of a key, which stays until it is released; NULL where there is no memory. Where block->made is false the
 * caller must fill it and call tc_block_made(). */
tc_block *tc_block_pin(tc_block_cache *cache, uint64_t key);
/* The same without waiting: NULL, and *busy set, where another thread is making the block. A thread that holds blocks
 * it has not made yet must take others of the cache this way only, or two threads could wait for each other. */
tc_block *tc_block_try(tc_block_cache *cache, uint64_t key, bool *busy);
/* good: false where it could not be filled; who asks for it next makes it anew. */
void tc_block_made(tc_block_cache *cache, tc_block *block, bool good);
/* Whether the block of a key is there and made. */
bool tc_block_has(tc_block_cache *cache, uint64_t key);

void tc_block_release(tc_block_cache *cache, tc_block *block);

/* Bytes of memory held. */
size_t tc_block_cache_bytes(tc_block_cache *cache);

#endif
