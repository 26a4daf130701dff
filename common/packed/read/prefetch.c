/* prefetch.c - some threads and a table of wishes. */
#include "prefetch.h"

#include <errno.h>
#include <time.h>
#include <unistd.h>

#include "common/base/rect.h"

enum {
    PATIENCE_MS = 250,         /* with what is fetched and nobody collects, and after a want of memory */
    LATER_ASKS = 4 * TC_WISHES /* for other things, after which nobody comes for it any more */
};

void tc_prefetch_init(tc_prefetch *p, tc_read_piece read, size_t room, int threads)
{
    const int64_t most = threads > 0 ? threads : sysconf(_SC_NPROCESSORS_ONLN) - 1;
    *p = (tc_prefetch){.read = read, .room = room, .most = (int)tc_clamp64(most, 1, TC_PREFETCH_THREADS)};
    pthread_mutex_init(&p->mutex, NULL);
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&p->wake, &attributes);
    pthread_cond_init(&p->pause, &attributes);
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
        return a->index > b->index;
    return a->level != b->level ? a->level < b->level : a->asked > b->asked;
}

/* The wish that is next; NULL: none, or none as long as so much waits for being collected or is being fetched. */
static tc_wish *next_wish(tc_prefetch *p, bool *full)
{
    tc_wish *next = NULL;
    size_t waiting = 0;
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++) {
        if (w->field && !w->index && !w->busy && p->count - w->asked > LATER_ASKS)
            drop(p, w);
        if (w->field && (w->fetched || w->busy))
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
static bool wait_until(tc_prefetch *p, pthread_cond_t *event, struct timespec until)
{
    return pthread_cond_timedwait(event, &p->mutex, &until) != ETIMEDOUT;
}

/* The wish as it is now; NULL where it is there no more. */
static tc_wish *find_number(tc_prefetch *p, uint64_t number)
{
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field && w->number == number)
            return w;
    return NULL;
}

/* A thread reads a piece. */
static void serve(tc_prefetch *p, tc_prefetch_thread *own, tc_wish *next)
{
    next->busy = true;
    tc_wish wish = *next;
    own->serves = wish.field;
    pthread_mutex_unlock(&p->mutex);
    tc_piece piece = p->read(&wish);
    pthread_mutex_lock(&p->mutex);
    own->serves = NULL;
    pthread_cond_broadcast(&p->done);
    tc_wish *w = find_number(p, wish.number);
    if (w)
        w->busy = false;
    if (w && piece == TC_PIECE_MORE)
        w->rest = wish.rest;
    else if (w && piece == TC_PIECE_LAST && !w->index && w->urgency != TC_LATER)
        w->fetched = true;
    else if (w)
        drop(p, w);
    if (p->idle > 0) /* there may be room again for what others have to fetch */
        pthread_cond_signal(&p->wake);
    const struct timespec until = a_while(); /* however often the thread is woken */
    while (piece == TC_PIECE_NO_MEMORY && !p->stop && wait_until(p, &p->pause, until))
        continue;
}

static void *run(void *context)
{
    tc_prefetch_thread *own = context;
    tc_prefetch *p = own->of;
    pthread_mutex_lock(&p->mutex);
    while (!p->stop) {
        bool full;
        tc_wish *w = next_wish(p, &full);
        if (w) {
            serve(p, own, w);
            continue;
        }
        p->idle++;
        if (!full)
            pthread_cond_wait(&p->wake, &p->mutex);
        else if (!wait_until(p, &p->wake, a_while()))
            drop_oldest(p);
        p->idle--;
    }
    pthread_mutex_unlock(&p->mutex);
    return NULL;
}

static void start(tc_prefetch *p)
{
    tc_prefetch_thread *t = &p->thread[p->threads];
    t->of = p;
    if (pthread_create(&t->thread, NULL, run, t) != 0)
        return;
    p->threads++;
#ifdef __linux__
    pthread_setname_np(t->thread, TC_PREFETCH_NAME);
#endif
}

static tc_wish *find(tc_prefetch *p, const void *field, int level, int index, tc_rect rect)
{
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field == field && w->level == level && w->index == index && tc_rect_equal(w->rect, rect))
            return w;
    return NULL;
}

/* Whether there are as many wishes for the index, for errors, or for later, as may stand among others. */
static bool enough(const tc_prefetch *p, const tc_wish *wish)
{
    int count = 0;
    for (const tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        count += w->field && (wish->index ? w->index == wish->index : w->urgency == TC_LATER);
    return (wish->index || wish->urgency == TC_LATER) && count >= TC_WISHES / 4;
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
    tc_wish *w = find(p, wish->field, wish->level, wish->index, wish->rect);
    if (w && w->fetched) { /* it was pushed out */
        drop(p, w);
        w = NULL;
    }
    if (!w && p->idle == 0 && p->threads < p->most)
        start(p);
    bool started = p->threads > 0;
    if (w) {
        w->asked = ++p->count;
        w->urgency = wish->urgency == TC_LATER ? w->urgency : wish->urgency;
    } else if (started && !enough(p, wish)) {
        w = place(p);
        *w = *wish;
        p->wishes++;
        w->rest = w->rect, w->fetched = w->busy = false;
        w->number = w->asked = ++p->count;
    }
    if (p->idle > 0)
        pthread_cond_signal(&p->wake);
    pthread_mutex_unlock(&p->mutex);
    return started;
}

void tc_prefetch_collect(tc_prefetch *p, const void *field, int level, tc_rect rect)
{
    if (p->wishes == 0)
        return;
    pthread_mutex_lock(&p->mutex);
    tc_wish *w = find(p, field, level, 0, rect);
    if (w) { /* also where no thread has come to the end of it */
        drop(p, w);
        pthread_cond_signal(&p->wake);
    }
    pthread_mutex_unlock(&p->mutex);
}

bool tc_prefetch_cancel(tc_prefetch *p, const void *field, int level, tc_rect rect)
{
    if (p->wishes == 0)
        return false;
    pthread_mutex_lock(&p->mutex);
    tc_wish *w = find(p, field, level, 0, rect);
    const bool unread = w && !w->fetched;
    if (w) {
        drop(p, w);
        pthread_cond_signal(&p->wake);
    }
    pthread_mutex_unlock(&p->mutex);
    return unread;
}

/* Whether a thread reads the field. */
static bool served(const tc_prefetch *p, const void *field)
{
    for (int k = 0; k < p->threads; k++)
        if (p->thread[k].serves == field)
            return true;
    return false;
}

void tc_prefetch_forget(tc_prefetch *p, const void *field)
{
    pthread_mutex_lock(&p->mutex);
    for (tc_wish *w = p->wish; w < p->wish + TC_WISHES; w++)
        if (w->field == field)
            drop(p, w);
    while (served(p, field))
        pthread_cond_wait(&p->done, &p->mutex);
    pthread_mutex_unlock(&p->mutex);
}

void tc_prefetch_free(tc_prefetch *p)
{
    pthread_mutex_lock(&p->mutex);
    p->stop = true;
    pthread_cond_broadcast(&p->wake);
    pthread_cond_broadcast(&p->pause);
    pthread_mutex_unlock(&p->mutex);
    for (int k = 0; k < p->threads; k++)
        pthread_join(p->thread[k].thread, NULL);
    pthread_mutex_destroy(&p->mutex);
    pthread_cond_destroy(&p->wake);
    pthread_cond_destroy(&p->done);
    pthread_cond_destroy(&p->pause);
}
