/* tile_set.h - tiles of which something is to be told once. */
#ifndef TC_TILE_SET_H
#define TC_TILE_SET_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Thread-safe. Takes no memory while it is empty, and holds up to TC_MOST_IN_SET keys. */
enum { TC_MOST_IN_SET = 1 << 16 };
typedef struct tc_tile_set {
    pthread_mutex_t mutex;
    uint64_t *key; /* [room]: hashed, at most half full; 0: none */
    size_t room, count;
} tc_tile_set;

void tc_tile_set_init(tc_tile_set *set);
void tc_tile_set_free(tc_tile_set *set);

/* Whether a key, not 0, is new; also of those for which there is no room. */
bool tc_tile_set_add(tc_tile_set *set, uint64_t key);

size_t tc_tile_set_bytes(tc_tile_set *set);

#endif
