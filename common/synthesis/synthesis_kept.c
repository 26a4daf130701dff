/* synthesis_kept.c - blocks of heights that were made lately: each in one of eight places, by its key. */
#include "synthesis_kept.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"

enum { PLACES = 8, SETS = 512, LOCKS = 16 };

typedef struct set {
    uint64_t key[PLACES]; /* 0: none */
    uint32_t asked[PLACES], now;
    float z[PLACES][TC_KEPT_SIDE * TC_KEPT_SIDE];
} set;

struct tc_kept {
    pthread_mutex_t mutex[LOCKS];
    set set[SETS];
};

size_t tc_kept_bytes(void)
{
    return sizeof(tc_kept);
}

tc_kept *tc_kept_create(void)
{
    tc_kept *k = calloc(1, sizeof *k);
    for (int n = 0; n < LOCKS && k; n++)
        pthread_mutex_init(&k->mutex[n], NULL);
    return k;
}

void tc_kept_destroy(tc_kept *k)
{
    for (int n = 0; n < LOCKS && k; n++)
        pthread_mutex_destroy(&k->mutex[n]);
    free(k);
}

/* The place of a key in its set; PLACES: it has none. */
static int place_of(const set *s, uint64_t key)
{
    int n = 0;
    while (n < PLACES && s->key[n] != key)
        n++;
    return n;
}

bool tc_kept_find(tc_kept *k, uint64_t key, tc_rect part, float *z, ptrdiff_t stride)
{
    const uint64_t number = tc_hash64(key, 0) % SETS;
    set *s = &k->set[number];
    pthread_mutex_lock(&k->mutex[number % LOCKS]);
    int n = place_of(s, key);
    if (n < PLACES) {
        s->asked[n] = ++s->now;
        for (int64_t j = part.y0; j < part.y1; j++)
            memcpy(z + (j - part.y0) * stride, s->z[n] + j * TC_KEPT_SIDE + part.x0,
                   (size_t)(part.x1 - part.x0) * sizeof *z);
    }
    pthread_mutex_unlock(&k->mutex[number % LOCKS]);
    return n < PLACES;
}

void tc_kept_add(tc_kept *k, uint64_t key, int64_t width, int64_t height, const float *z, ptrdiff_t stride)
{
    const uint64_t number = tc_hash64(key, 0) % SETS;
    set *s = &k->set[number];
    pthread_mutex_lock(&k->mutex[number % LOCKS]);
    int n = place_of(s, key);
    if (n == PLACES) {
        n = 0;
        for (int other = 1; other < PLACES; other++) /* also where the count went round */
            if (s->now - s->asked[other] > s->now - s->asked[n])
                n = other;
        s->key[n] = key;
        for (int64_t j = 0; j < height; j++)
            memcpy(s->z[n] + j * TC_KEPT_SIDE, z + j * stride, (size_t)width * sizeof *z);
    }
    s->asked[n] = ++s->now;
    pthread_mutex_unlock(&k->mutex[number % LOCKS]);
}
