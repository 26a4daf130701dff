/* block_cache.h - the blocks that were used last, for any number of threads, within a budget of bytes that several
 * owners share. A block that is being made by one thread is waited for by the others. */
#ifndef TC_BLOCK_CACHE_H
#define TC_BLOCK_CACHE_H

#include <pthread.h>

#include "common/terraclip.h"

typedef struct tc_block {
    uint64_t key;
    size_t size; /* bytes of memory, this head among them */
    int users;
    bool made, failed; /* failed: nobody finds it any more */
    struct tc_block *same_hash, *newer, *older;
    _Alignas(64) unsigned char bytes[];
} tc_block;

/* The uppermost bits of a key say whose it is. */
enum { TC_BLOCK_OWNERS = 8, TC_BLOCK_OWNER_SHIFT = 61 };

typedef struct tc_block_cache {
    size_t promised, most, bytes; /* of memory; more than `most` only while more is in use */
    size_t asked[2];              /* the most asked for at once, lately and before */
    int asks;
    size_t owned[TC_BLOCK_OWNERS]; /* bytes */
    int64_t buckets;
    tc_block **bucket;
    tc_block *newest, *oldest;
    pthread_mutex_t mutex;
    pthread_cond_t made;
} tc_block_cache;

/* A cache of about so many bytes. No block is allocated before it is needed. */
tc_status tc_block_cache_init(tc_block_cache *cache, size_t bytes);
void tc_block_cache_free(tc_block_cache *cache);

/* Says how many bytes somebody needs at once: while that is more than the cache was made for, it grows, and shrinks
 * again some hundred calls after it was. */
void tc_block_cache_needs(tc_block_cache *cache, size_t bytes);

/* The block of a key, whose content has so many bytes, which stays until it is released; NULL where there is no memory.
 * Where block->made is false the caller must fill it and call tc_block_made(). */
tc_block *tc_block_pin(tc_block_cache *cache, uint64_t key, size_t bytes);
/* The same without waiting: NULL, and *busy set, where another thread is making the block. A thread that holds blocks
 * it has not made yet must take others of the cache this way only, or two threads could wait for each other. */
tc_block *tc_block_try(tc_block_cache *cache, uint64_t key, size_t bytes, bool *busy);
/* The same only where it is there and made; else NULL. */
tc_block *tc_block_find(tc_block_cache *cache, uint64_t key);
/* good: false where it could not be filled; who asks for it next makes it anew. */
void tc_block_made(tc_block_cache *cache, tc_block *block, bool good);
/* Whether the block of a key is there and made; it then counts as used. */
bool tc_block_has(tc_block_cache *cache, uint64_t key);

void tc_block_release(tc_block_cache *cache, tc_block *block);

/* Forgets all blocks of an owner, none of which may be in use. */
void tc_block_cache_forget(tc_block_cache *cache, int owner);

/* Bytes of memory held: by all, by an owner. */
size_t tc_block_cache_bytes(tc_block_cache *cache);
size_t tc_block_cache_owned(tc_block_cache *cache, int owner);

#endif
