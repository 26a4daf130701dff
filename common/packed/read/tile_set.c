/* tile_set.c - a hash table that doubles. */
#include "tile_set.h"

#include <stdlib.h>

void tc_tile_set_init(tc_tile_set *s)
{
    *s = (tc_tile_set){.key = NULL};
    pthread_mutex_init(&s->mutex, NULL);
}

void tc_tile_set_free(tc_tile_set *s)
{
    free(s->key);
    pthread_mutex_destroy(&s->mutex);
}

/* Where a key is, or is to be. */
static uint64_t *place(uint64_t *keys, size_t room, uint64_t key)
{
    size_t at = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & (room - 1);
    while (keys[at] && keys[at] != key)
        at = (at + 1) & (room - 1);
    return &keys[at];
}

/* False: it stays as it is. */
static bool grow(tc_tile_set *s)
{
    enum { FIRST = 64 };
    const size_t room = s->room ? 2 * s->room : FIRST;
    uint64_t *keys = calloc(room, sizeof *keys);
    if (!keys)
        return false;
    for (size_t n = 0; n < s->room; n++)
        if (s->key[n])
            *place(keys, room, s->key[n]) = s->key[n];
    free(s->key);
    s->key = keys, s->room = room;
    return true;
}

bool tc_tile_set_add(tc_tile_set *s, uint64_t key)
{
    pthread_mutex_lock(&s->mutex);
    bool is_new = s->room == 0 || *place(s->key, s->room, key) != key;
    if (is_new && s->count < TC_MOST_IN_SET && (2 * s->count < s->room || grow(s)))
        *place(s->key, s->room, key) = key, s->count++;
    pthread_mutex_unlock(&s->mutex);
    return is_new;
}

size_t tc_tile_set_bytes(tc_tile_set *s)
{
    pthread_mutex_lock(&s->mutex);
    const size_t bytes = s->room * sizeof *s->key;
    pthread_mutex_unlock(&s->mutex);
    return bytes;
}
