/* packed_scratch.c - a stack of chunks of memory for one reading at a time, kept for the next one. */
#include "packed_internal.h"

mark tc_scratch_here(const scratch *s)
{
    return (mark){s->top, s->top ? s->top->used : 0};
}

void *tc_scratch_take(scratch *s, size_t bytes)
{
    bytes = (bytes + 63) / 64 * 64;
    if (!s->top || s->top->size - s->top->used < bytes) {
        chunk *c = s->spare;
        if (c && c->size >= bytes) {
            s->spare = c->before;
        } else {
            size_t size = bytes > CHUNK_BYTES ? bytes : CHUNK_BYTES;
            c = aligned_alloc(64, (sizeof *c + size + 63) / 64 * 64);
            if (!c)
                return NULL;
            c->size = size;
        }
        c->used = 0, c->before = s->top, s->top = c;
    }
    s->top->used += bytes;
    return s->top->bytes + s->top->used - bytes;
}

void tc_scratch_return(scratch *s, mark m)
{
    while (s->top != m.top) {
        chunk *c = s->top;
        s->top = c->before;
        c->before = s->spare, s->spare = c;
    }
    if (s->top)
        s->top->used = m.used;
}

void tc_scratch_free(scratch *s)
{
    tc_scratch_return(s, (mark){NULL, 0});
    while (s->spare) {
        chunk *c = s->spare;
        s->spare = c->before;
        free(c);
    }
    for (int n = 0; n < AT_ONCE; n++)
        free(s->work[n]), free(s->stream[n]);
    free(s);
}

scratch *tc_packed_borrow(packed_field *p)
{
    pthread_mutex_lock(&p->mutex);
    scratch *s = p->idle;
    if (s)
        p->idle = s->next;
    pthread_mutex_unlock(&p->mutex);
    if (s) {
        s->only_ready = s->missed = s->waited = false;
        return s;
    }
    if (!(s = calloc(1, sizeof *s)))
        return NULL;
    bool enough = true;
    for (int n = 0; n < AT_ONCE; n++) {
        s->work[n] = malloc(tc_level_coder_work_bytes());
        s->stream[n] = malloc(tc_level_coder_bound());
        enough &= s->work[n] && s->stream[n];
    }
    if (enough)
        return s;
    tc_scratch_free(s);
    return NULL;
}

void tc_packed_give_back(packed_field *p, scratch *s)
{
    pthread_mutex_lock(&p->mutex);
    s->next = p->idle, p->idle = s;
    pthread_mutex_unlock(&p->mutex);
}
