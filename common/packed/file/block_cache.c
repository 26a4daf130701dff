/* block_cache.c - a hash table and a list by age under one lock, which is never held while a block is made. */
#include "block_cache.h"

#include <stdlib.h>
#include <string.h>

enum { BYTES_A_BUCKET = 1 << 13, ASKS = 256 };

tc_status tc_block_cache_init(tc_block_cache *c, size_t bytes)
{
    *c = (tc_block_cache){.promised = bytes, .most = bytes, .buckets = 64};
    while ((size_t)c->buckets < bytes / BYTES_A_BUCKET && c->buckets < 1 << 20)
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

static tc_block *look_up(tc_block_cache *c, uint64_t key)
{
    tc_block *b = *bucket_of(c, key);
    while (b && b->key != key)
        b = b->same_hash;
    return b;
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

static void take_out(tc_block_cache *c, tc_block *b)
{
    unlink_age(c, b);
    if (!b->failed)
        unlink_hash(c, b);
    c->bytes -= b->size, c->owned[b->key >> TC_BLOCK_OWNER_SHIFT] -= b->size;
}

/* ---- How much is needed ------------------------------------------------------------------------------------------ */

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

/* Some of the oldest blocks that nobody uses, where there are too many bytes: few enough for a thread that draws. */
static void give_up_some(tc_block_cache *c)
{
    enum { SOME = 16 };
    int left = SOME;
    for (tc_block *b = c->oldest, *newer; b && c->bytes > c->most && left > 0; b = newer) {
        newer = b->newer;
        if (b->users > 0)
            continue;
        take_out(c, b);
        free(b);
        left--;
    }
}

void tc_block_cache_needs(tc_block_cache *c, size_t bytes)
{
    pthread_mutex_lock(&c->mutex);
    c->asked[0] = larger(c->asked[0], bytes);
    c->most = larger(c->promised, larger(c->asked[0], c->asked[1]));
    if (++c->asks == ASKS)
        c->asked[1] = c->asked[0], c->asked[0] = 0, c->asks = 0;
    give_up_some(c);
    pthread_mutex_unlock(&c->mutex);
}

/* ---- Blocks ------------------------------------------------------------------------------------------------------ */

/* A block for a new key. Where there are too many bytes, the oldest blocks that nobody uses go; one of them may serve
 * again. */
static tc_block *take_block(tc_block_cache *c, uint64_t key, size_t bytes)
{
    size_t size = (sizeof(tc_block) + bytes + 63) / 64 * 64;
    tc_block *kept = NULL;
    for (tc_block *b = c->oldest, *newer; b && c->bytes + size > c->most; b = newer) {
        newer = b->newer;
        if (b->users > 0)
            continue;
        take_out(c, b);
        if (!kept && b->size == size)
            kept = b;
        else
            free(b);
    }
    tc_block *b = kept ? kept : aligned_alloc(64, size);
    if (!b)
        return NULL;
    b->key = key, b->size = size, b->users = 1, b->made = b->failed = false;
    b->same_hash = *bucket_of(c, key), *bucket_of(c, key) = b;
    link_newest(c, b);
    c->bytes += size, c->owned[key >> TC_BLOCK_OWNER_SHIFT] += size;
    return b;
}

/* busy: NULL to wait. */
static tc_block *pin(tc_block_cache *c, uint64_t key, size_t bytes, bool *busy)
{
    pthread_mutex_lock(&c->mutex);
    tc_block *b = look_up(c, key);
    while (b && !b->made && !busy) {
        b->users++;
        while (!b->made)
            pthread_cond_wait(&c->made, &c->mutex);
        b->users--;
        b = look_up(c, key); /* gone where it has failed */
    }
    if (b && !b->made) {
        *busy = true, b = NULL;
    } else if (b) {
        b->users++;
        unlink_age(c, b), link_newest(c, b);
    } else {
        b = take_block(c, key, bytes);
    }
    pthread_mutex_unlock(&c->mutex);
    return b;
}

tc_block *tc_block_pin(tc_block_cache *c, uint64_t key, size_t bytes)
{
    return pin(c, key, bytes, NULL);
}

tc_block *tc_block_try(tc_block_cache *c, uint64_t key, size_t bytes, bool *busy)
{
    *busy = false;
    return pin(c, key, bytes, busy);
}

tc_block *tc_block_find(tc_block_cache *c, uint64_t key)
{
    pthread_mutex_lock(&c->mutex);
    tc_block *b = look_up(c, key);
    if (b && b->made) {
        b->users++;
        unlink_age(c, b), link_newest(c, b);
    } else {
        b = NULL;
    }
    pthread_mutex_unlock(&c->mutex);
    return b;
}

bool tc_block_has(tc_block_cache *c, uint64_t key)
{
    tc_block *b = tc_block_find(c, key);
    if (b)
        tc_block_release(c, b);
    return b != NULL;
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

void tc_block_cache_forget(tc_block_cache *c, int owner)
{
    pthread_mutex_lock(&c->mutex);
    for (tc_block *b = c->oldest, *newer; b; b = newer) {
        newer = b->newer;
        if ((int)(b->key >> TC_BLOCK_OWNER_SHIFT) != owner)
            continue;
        take_out(c, b);
        free(b);
    }
    pthread_mutex_unlock(&c->mutex);
}

size_t tc_block_cache_bytes(tc_block_cache *c)
{
    pthread_mutex_lock(&c->mutex);
    size_t bytes = c->bytes + (size_t)c->buckets * sizeof *c->bucket;
    pthread_mutex_unlock(&c->mutex);
    return bytes;
}

size_t tc_block_cache_owned(tc_block_cache *c, int owner)
{
    pthread_mutex_lock(&c->mutex);
    size_t bytes = c->owned[owner];
    pthread_mutex_unlock(&c->mutex);
    return bytes;
}
