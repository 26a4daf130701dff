/* prefetch.h - a thread that reads ahead, so that who draws need not wait for decoding. */
#ifndef TC_PREFETCH_H
#define TC_PREFETCH_H

#include <pthread.h>

#include "common/field/field.h"

/* At most one rectangle of each level waits: the last one asked for. */
typedef struct tc_prefetch {
    void (*read)(void *context, int level, tc_rect rect);
    void *context;
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    pthread_t thread;
    bool started, stop;
    bool waiting[TC_MAX_FIELD_LEVELS];
    tc_rect rect[TC_MAX_FIELD_LEVELS];
} tc_prefetch;

/* What the system knows the thread by. */
#define TC_PREFETCH_NAME "reading-ahead"

/* read is called from the thread, which starts with the first wish. */
void tc_prefetch_init(tc_prefetch *prefetch, void (*read)(void *context, int level, tc_rect rect), void *context);
void tc_prefetch_free(tc_prefetch *prefetch);

/* Has the rectangle read soon, coarse levels first. False where no thread can be started. */
bool tc_prefetch_ask(tc_prefetch *prefetch, int level, tc_rect rect);

#endif
