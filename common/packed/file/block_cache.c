/* block_cache.c - a hash table and a list by age under one lock, which is never held while a block is made. */
#include "block_cache.h"

#include <stdlib.h>
#include <string.h>

tc_status tc_block_cache_init(tc_block_cache *c, size_t block_bytes, size_t bytes)
{
    *c = (tc_block_cache){.block_bytes = block_bytes, .most = (int64_t)(bytes / block_bytes) + 8, .buckets = 64};
    while (c->buckets < 2 * c->most)
        c->buckets *= 2;
    c->bucket = calloc((size_t)c->buckets, sizeof *c->bucket);
    pthread_mutex_init(&c->mutex, NULL);
    pthread_cond_init(&c->made, NULL);
    return c->bucket ? TC_OK : TC_ERR_MEMORY;
}

void tc_block_cache_free(tc_block_cache *c)
{
    while (c->newest) {
        tc_block *b = c->newest;
        c->newest = b->older;
        free(b);
    }
    free(c->bucket);
    pthread_mutex_destroy(&c->mutex);
    pthread_cond_destroy(&c->made);
}

static tc_block **bucket_of(tc_block_cache *c, uint64_t key)
{
    return &c->bucket[(key * 0x9e3779b97f4a7c15u >> 32) & (uint64_t)(c->buckets - 1)];
}

static void unlink_age(tc_block_cache *c, tc_block *b)
{
    *(b->newer ? &b->newer->older : &c->newest) = b->older;
    *(b->older ? &b->older->newer : &c->oldest) = b->newer;
}

static void link_newest(tc_block_cache *c, tc_block *b)
{
    b->newer = NULL, b->older = c->newest;
    *(c->newest ? &c->newest->newer : &c->oldest) = b;
    c->newest = b;
}

static void unlink_hash(tc_block_cache *c, tc_block *b)
{
    tc_block **at = bucket_of(c, b->key);
    while (*at != b)
        at = &(*at)->same_hash;
    *at = b->same_hash;
}

/* A block for a new key: the oldest that nobody uses, once there are enough. */
static tc_block *take_block(tc_block_cache *c)
{
    tc_block *b = NULL;
    if (c->count >= c->most)
        for (b = c->oldest; b && b->users > 0;)
            b = b->newer;
    if (b) {
        unlink_age(c, b);
        if (!b->failed)
            unlink_hash(c, b);
        return b;
    }
    size_t bytes = (sizeof *b + c->block_bytes + 63) / 64 * 64;
    b = aligned_alloc(64, bytes);
    c->count += b != NULL;
    return b;
}

/* busy: NULL to wait. */
static tc_block *pin(tc_block_cache *c, uint64_t key, bool *busy)
{
    pthread_mutex_lock(&c->mutex);
    tc_block *b;
again:
    b = *bucket_of(c, key);
    while (b && b->key != key)
        b = b->same_hash;
    if (b && !b->made && busy) {
        *busy = true, b = NULL;
    } else if (b) {
        b->users++;
        while (!b->made)
            pthread_cond_wait(&c->made, &c->mutex);
        if (b->failed) {
            b->users--;
            goto again;
        }
        unlink_age(c, b), link_newest(c, b);
    } else if ((b = take_block(c))) {
        b->key = key, b->users = 1, b->made = b->failed = false;
        b->same_hash = *bucket_of(c, key), *bucket_of(c, key) = b;
        link_newest(c, b);
    }
    pthread_mutex_unlock(&c->mutex);
    return b;
}

tc_block *tc_block_pin(tc_block_cache *c, uint64_t key)
{
    return pin(c, key, NULL);
}

tc_block *tc_block_try(tc_block_cache *c, uint64_t key, bool *busy)
{
    *busy = false;
    return pin(c, key, busy);
}

void tc_block_made(tc_block_cache *c, tc_block *b, bool good)
{
    pthread_mutex_lock(&c->mutex);
    b->made = true;
    if (!good) {
        b->failed = true;
        unlink_hash(c, b);
    }
    pthread_cond_broadcast(&c->made);
    pthread_mutex_unlock(&c->mutex);
}

void tc_block_release(tc_block_cache *c, tc_block *b)
{
    pthread_mutex_lock(&c->mutex);
    b->users--;
    pthread_mutex_unlock(&c->mutex);
}

size_t tc_block_cache_bytes(tc_block_cache *c)
{
    pthread_mutex_lock(&c->mutex);
    size_t bytes = (size_t)c->count * (sizeof(tc_block) + c->block_bytes) + (size_t)c->buckets * sizeof *c->bucket;
    pthread_mutex_unlock(&c->mutex);
    return bytes;
}

bool tc_block_has(tc_block_cache *c, uint64_t key)
{
    pthread_mutex_lock(&c->mutex);
    const tc_block *b = *bucket_of(c, key);
    while (b && b->key != key)
        b = b->same_hash;
    bool has = b && b->made;
    pthread_mutex_unlock(&c->mutex);
    return has;
}
