/* tile_faults.c - a short table: while all is well it is empty and costs nothing. */
#include "tile_faults.h"

#include "common/base/clock.h"
#include "common/packed/file/block_cache.h"

static const double first_pause_ms = 250, longest_pause_ms = 30000;

void tc_faults_init(tc_tile_faults *f)
{
    f->count = 0;
    pthread_mutex_init(&f->mutex, NULL);
}

void tc_faults_free(tc_tile_faults *f)
{
    pthread_mutex_destroy(&f->mutex);
}

static tc_tile_fault *find(tc_tile_faults *f, uint64_t key)
{
    for (int n = 0; n < f->count; n++)
        if (f->fault[n].key == key)
            return &f->fault[n];
    return NULL;
}

static tc_tile_fault *place(tc_tile_faults *f)
{
    if (f->count < TC_MOST_FAULTS)
        return &f->fault[f->count++];
    tc_tile_fault *soonest = f->fault;
    for (int n = 1; n < TC_MOST_FAULTS; n++)
        soonest = f->fault[n].not_before < soonest->not_before ? &f->fault[n] : soonest;
    return soonest;
}

void tc_faults_add(tc_tile_faults *f, uint64_t key)
{
    pthread_mutex_lock(&f->mutex);
    double now = tc_clock_ms();
    tc_tile_fault *fault = find(f, key);
    if (!fault) {
        fault = place(f);
        *fault = (tc_tile_fault){key, 0, 0};
    }
    if (now >= fault->not_before) { /* else somebody tried without waiting for it */
        double pause = first_pause_ms;
        for (int n = 0; n < fault->failures && pause < longest_pause_ms; n++)
            pause *= 2;
        fault->failures++;
        fault->not_before = now + (pause < longest_pause_ms ? pause : longest_pause_ms);
    }
    pthread_mutex_unlock(&f->mutex);
}

void tc_faults_remove(tc_tile_faults *f, uint64_t key)
{
    if (f->count == 0)
        return;
    pthread_mutex_lock(&f->mutex);
    tc_tile_fault *fault = find(f, key);
    if (fault)
        *fault = f->fault[--f->count];
    pthread_mutex_unlock(&f->mutex);
}

bool tc_faults_pause(tc_tile_faults *f, uint64_t key)
{
    if (f->count == 0)
        return false;
    pthread_mutex_lock(&f->mutex);
    const tc_tile_fault *fault = find(f, key);
    bool pause = fault && tc_clock_ms() < fault->not_before;
    pthread_mutex_unlock(&f->mutex);
    return pause;
}

int tc_faults_count(tc_tile_faults *f, int owner)
{
    int count = 0;
    pthread_mutex_lock(&f->mutex);
    for (int n = 0; n < f->count; n++)
        count += (int)(f->fault[n].key >> TC_BLOCK_OWNER_SHIFT) == owner;
    pthread_mutex_unlock(&f->mutex);
    return count;
}
