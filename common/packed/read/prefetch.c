/* prefetch.c - one thread and a table of wishes. */
#include "prefetch.h"

#include <errno.h>
#include <time.h>

#include "common/base/rect.h"

enum {
    PATIENCE_MS = 250,         /* with what is fetched and nobody collects, and after a want of memory */
    LATER_ASKS = 4 * TC_WISHES /* for other things, after which nobody comes for it any more */
};

void tc_prefetch_init(tc_prefetch *p, tc_read_piece read, size_t room)
{
    *p = (tc_prefetch){.read = read, .room = room};
    pthread_mutex_init(&p->mutex, NULL);
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&p->wake, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_cond_init(&p->done, NULL);
}

static void drop(tc_prefetch *p, tc_wish *w)
{
    p->wishes--;
    *w = (tc_wish){0};
}

static bool before(const tc_wish *a, const tc_wish *b)
{
    if (a->urgency != b->urgency)
        return a->urgency > b->urgency;
    if (a->index != b->index)
        return a->index;
    return a->level != b->level ? a->level < b->level : a->asked > b->asked;
}

/* The wish that is next; NULL: none, or none as long as so much waits for being collected. */
static tc_wish *next_wish(tc_prefetch *p, bool *full)
{
    tc_wish *next = NULL;
    size_t waiting = 0;
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++) {
        if (w->field && w->fetched && p->count - w->asked > LATER_ASKS)
            drop(p, w);
        if (w->field && w->fetched)
            waiting += w->bytes;
        else if (w->field && (!next || before(w, next)))
            next = w;
    }
    *full = next && waiting > 0 && waiting + next->bytes > p->room;
    return *full ? NULL : next;
}

/* Drops the oldest of what is fetched. */
static void drop_oldest(tc_prefetch *p)
{
    tc_wish *oldest = NULL;
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field && w->fetched && (!oldest || w->asked < oldest->asked))
            oldest = w;
    if (oldest)
        drop(p, oldest);
}

static struct timespec a_while(void)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += PATIENCE_MS * 1000000L;
    until.tv_sec += until.tv_nsec / 1000000000L, until.tv_nsec %= 1000000000L;
    return until;
}

/* False when the time is over. */
static bool wait_until(tc_prefetch *p, struct timespec until)
{
    return pthread_cond_timedwait(&p->wake, &p->mutex, &until) != ETIMEDOUT;
}

/* The wish as it is now; NULL where it is there no more. */
static tc_wish *find_number(tc_prefetch *p, uint64_t number)
{
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field && w->number == number)
            return w;
    return NULL;
}

static void serve(tc_prefetch *p, tc_wish wish)
{
    p->busy = wish.field;
    pthread_mutex_unlock(&p->mutex);
    tc_piece piece = p->read(&wish);
    pthread_mutex_lock(&p->mutex);
    p->busy = NULL;
    pthread_cond_broadcast(&p->done);
    tc_wish *w = find_number(p, wish.number);
    if (w && piece == TC_PIECE_MORE)
        w->rest = wish.rest;
    else if (w && piece == TC_PIECE_LAST && !w->index)
        w->fetched = true;
    else if (w)
        drop(p, w);
    const struct timespec until = a_while(); /* however often the thread is woken by who asks again */
    while (piece == TC_PIECE_NO_MEMORY && !p->stop && wait_until(p, until))
        continue;
}

static void *run(void *context)
{
    tc_prefetch *p = context;
    pthread_mutex_lock(&p->mutex);
    while (!p->stop) {
        bool full;
        const tc_wish *w = next_wish(p, &full);
        if (w)
            serve(p, *w);
        else if (!full)
            pthread_cond_wait(&p->wake, &p->mutex);
        else if (!wait_until(p, a_while()))
            drop_oldest(p);
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

static tc_wish *find(tc_prefetch *p, const void *field, int level, bool index, tc_rect rect)
{
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field == field && w->level == level && w->index == index && tc_rect_equal(w->rect, rect))
            return w;
    return NULL;
}

/* Whether there are as many wishes for the index as may stand among others. */
static bool enough_index(const tc_prefetch *p)
{
    int count = 0;
    for (const tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        count += w->field && w->index;
    return count >= TC_WISHES / 4;
}

/* A place for a new wish: a free one, or that of the one which was not asked for the longest. */
static tc_wish *place(tc_prefetch *p)
{
    tc_wish *oldest = p->wish;
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++) {
        if (!w->field)
            return w;
        oldest = w->asked < oldest->asked ? w : oldest;
    }
    drop(p, oldest);
    return oldest;
}

bool tc_prefetch_ask(tc_prefetch *p, const tc_wish *wish)
{
    pthread_mutex_lock(&p->mutex);
    if (!p->started)
        start(p);
    bool started = p->started;
    tc_wish *w = started ? find(p, wish->field, wish->level, wish->index, wish->rect) : NULL;
    if (w && w->fetched) { /* it was pushed out */
        drop(p, w);
        w = NULL;
    }
    if (w) {
        w->asked = ++p->count, w->urgency = wish->urgency;
    } else if (started && !(wish->index && enough_index(p))) {
        w = place(p);
        *w = *wish;
        p->wishes++;
        w->rest = w->rect, w->fetched = false;
        w->number = w->asked = ++p->count;
    }
    if (started)
        pthread_cond_signal(&p->wake);
    pthread_mutex_unlock(&p->mutex);
    return started;
}

void tc_prefetch_collect(tc_prefetch *p, const void *field, int level, tc_rect rect)
{
    if (p->wishes == 0)
        return;
    pthread_mutex_lock(&p->mutex);
    tc_wish *w = find(p, field, level, false, rect);
    if (w) { /* also where the thread has not come to the end of it */
        drop(p, w);
        pthread_cond_signal(&p->wake);
    }
    pthread_mutex_unlock(&p->mutex);
}

void tc_prefetch_forget(tc_prefetch *p, const void *field)
{
    pthread_mutex_lock(&p->mutex);
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field == field)
            drop(p, w);
    while (p->busy == field)
        pthread_cond_wait(&p->done, &p->mutex);
    pthread_mutex_unlock(&p->mutex);
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
    pthread_cond_destroy(&p->done);
}
