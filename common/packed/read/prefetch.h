/* prefetch.h - threads that read ahead, so that who draws need not wait for decoding. They serve any number of readers
 * of any number of fields, what is urgent first, coarse levels before fine ones, in pieces: what comes in between and
 * is more urgent goes before the rest, and what nobody wants any more is not begun. */
#ifndef TC_PREFETCH_H
#define TC_PREFETCH_H

#include <pthread.h>
#include <stdatomic.h>

#include "common/field/field.h"

enum { TC_WISH_ERRORS = 1, TC_WISH_INDEX }; /* what goes first is larger */
typedef struct tc_wish {
    void *field; /* whose; NULL: no wish */
    int level;
    int index;          /* TC_WISH_INDEX, TC_WISH_ERRORS: no samples, but a page of these, rect.x0 and rect.y0 */
    tc_rect rect, rest; /* rest: where the next piece begins */
    tc_urgency urgency;
    size_t bytes; /* that what is decoded takes */
    bool busy;    /* a thread reads a piece of it */
    bool fetched; /* it waits for being collected */
    uint64_t number, asked;
} tc_wish;

/* How a piece went. */
typedef enum tc_piece { TC_PIECE_MORE, TC_PIECE_LAST, TC_PIECE_FAILED, TC_PIECE_NO_MEMORY } tc_piece;

typedef tc_piece (*tc_read_piece)(tc_wish *wish); /* moves wish->rest on */

enum { TC_WISHES = 64, TC_PREFETCH_THREADS = 16 };

typedef struct tc_prefetch_thread {
    struct tc_prefetch *of;
    pthread_t thread;
    void *serves; /* the field that it reads; NULL: none */
} tc_prefetch_thread;

typedef struct tc_prefetch {
    tc_read_piece read;
    pthread_mutex_t mutex;
    pthread_cond_t wake, done, pause;
    tc_prefetch_thread thread[TC_PREFETCH_THREADS];
    int threads, most, idle; /* that run; that may; that wait for a wish */
    bool stop;
    size_t room; /* bytes of what is fetched and not collected */
    uint64_t count;
    _Atomic int wishes;
    tc_wish wish[TC_WISHES];
} tc_prefetch;

/* What the system knows the threads by. */
#define TC_PREFETCH_NAME "reading-ahead"

/* read is called from the threads, for several wishes at once. They start with the first wishes, one more whenever none
 * is idle, up to `threads` (0: one less than there are processors, at least one). No more than about `room` bytes are
 * fetched before some are collected, since later ones would push them out of a cache. */
void tc_prefetch_init(tc_prefetch *prefetch, tc_read_piece read, size_t room, int threads);
void tc_prefetch_free(tc_prefetch *prefetch);

/* Has what the wish says (field to bytes; not rest) read; of the index, of errors, and of what is for later, only while
 * there are few such wishes of the kind. What is for later is not waited for to be collected. False where no thread can
 * be started. */
bool tc_prefetch_ask(tc_prefetch *prefetch, const tc_wish *wish);

/* What a wish fetched has been found ready. */
void tc_prefetch_collect(tc_prefetch *prefetch, const void *field, int level, tc_rect rect);

/* What was wished is not wanted any more: no further piece of it is begun. True where some of it was still to be read.
 */
bool tc_prefetch_cancel(tc_prefetch *prefetch, const void *field, int level, tc_rect rect);

/* Forgets all wishes of a field; returns when none is being read. */
void tc_prefetch_forget(tc_prefetch *prefetch, const void *field);

#endif
