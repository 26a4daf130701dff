/* tile_faults.h - tiles that could not be read, and when that is to be tried again: after a pause that grows. */
#ifndef TC_TILE_FAULTS_H
#define TC_TILE_FAULTS_H

#include <pthread.h>
#include <stdatomic.h>

#include "common/terraclip.h"

enum { TC_MOST_FAULTS = 256 };

typedef struct tc_tile_fault {
    uint64_t key; /* as in the cache */
    int failures;
    double not_before; /* tc_clock_ms() */
} tc_tile_fault;

/* Thread-safe. Of more than TC_MOST_FAULTS those are forgotten that may be tried the soonest. */
typedef struct tc_tile_faults {
    pthread_mutex_t mutex;
    _Atomic int count;
    tc_tile_fault fault[TC_MOST_FAULTS];
} tc_tile_faults;

void tc_faults_init(tc_tile_faults *faults);
void tc_faults_free(tc_tile_faults *faults);

/* A tile could not be read; it could. */
void tc_faults_add(tc_tile_faults *faults, uint64_t key);
void tc_faults_remove(tc_tile_faults *faults, uint64_t key);

/* Those of an owner (block_cache.h). */
int tc_faults_count(tc_tile_faults *faults, int owner);

/* Whether a tile is not to be tried yet. */
bool tc_faults_pause(tc_tile_faults *faults, uint64_t key);

#endif
