/* parallel.c - a parallel loop with work handed out by an atomic counter. */
#include "parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

typedef struct loop {
    void (*body)(void *context, int64_t i);
    void *context;
    int64_t count;
    _Atomic int64_t next;
} loop;

static void *run(void *argument)
{
    loop *l = argument;
    for (int64_t i; (i = atomic_fetch_add(&l->next, 1)) < l->count;)
        l->body(l->context, i);
    return NULL;
}

void tc_parallel_for(int threads, int64_t count, void (*body)(void *context, int64_t i), void *context)
{
    enum { MAX_THREADS = 64 };
    if (threads <= 0)
        threads = (int)sysconf(_SC_NPROCESSORS_ONLN);
    if (threads > MAX_THREADS)
        threads = MAX_THREADS;
    if (threads > count)
        threads = (int)count;
    loop l = {body, context, count, 0};
    pthread_t ids[MAX_THREADS];
    int started = 0;
    while (started < threads - 1 && pthread_create(&ids[started], NULL, run, &l) == 0)
        started++;
    run(&l);
    for (int i = 0; i < started; i++)
        pthread_join(ids[i], NULL);
}
