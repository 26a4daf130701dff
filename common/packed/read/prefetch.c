/* prefetch.c - one thread and a wish for each level. */
#include "prefetch.h"

void tc_prefetch_init(tc_prefetch *p, void (*read)(void *context, int level, tc_rect rect), void *context)
{
    *p = (tc_prefetch){.read = read, .context = context};
    pthread_mutex_init(&p->mutex, NULL);
    pthread_cond_init(&p->wake, NULL);
}

static int next_level(const tc_prefetch *p)
{
    for (int l = 1; l <= TC_MAX_FIELD_LEVELS; l++)
        if (p->waiting[l - 1])
            return l;
    return 0;
}

static void *run(void *context)
{
    tc_prefetch *p = context;
    pthread_mutex_lock(&p->mutex);
    while (!p->stop) {
        int l = next_level(p);
        if (l == 0) {
            pthread_cond_wait(&p->wake, &p->mutex);
            continue;
        }
        tc_rect rect = p->rect[l - 1];
        p->waiting[l - 1] = false;
        pthread_mutex_unlock(&p->mutex);
        p->read(p->context, l, rect);
        pthread_mutex_lock(&p->mutex);
    }
    pthread_mutex_unlock(&p->mutex);
    return NULL;
}

static void start(tc_prefetch *p)
{
    p->started = pthread_create(&p->thread, NULL, run, p) == 0;
#ifdef __linux__
    if (p->started)
        pthread_setname_np(p->thread, TC_PREFETCH_NAME);
#endif
}

bool tc_prefetch_ask(tc_prefetch *p, int level, tc_rect rect)
{
    pthread_mutex_lock(&p->mutex);
    if (!p->started)
        start(p);
    bool started = p->started;
    if (started) {
        p->waiting[level - 1] = true, p->rect[level - 1] = rect;
        pthread_cond_signal(&p->wake);
    }
    pthread_mutex_unlock(&p->mutex);
    return started;
}

void tc_prefetch_free(tc_prefetch *p)
{
    pthread_mutex_lock(&p->mutex);
    p->stop = true;
    pthread_cond_signal(&p->wake);
    pthread_mutex_unlock(&p->mutex);
    if (p->started)
        pthread_join(p->thread, NULL);
    pthread_mutex_destroy(&p->mutex);
    pthread_cond_destroy(&p->wake);
}
