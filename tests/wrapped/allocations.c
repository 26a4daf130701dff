/* allocations.c - the functions that --wrap puts in the place of the C library's. */
#include "allocations.h"

#include <malloc.h>
#include <string.h>

allocation_counts allocations;
static atomic_llong refused; /* the call, counted by allocations.asked */

void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *p, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
char *__wrap_strdup(const char *text);
void __wrap_free(void *p);

void allocations_refuse(int call)
{
    allocations.asked = 0;
    refused = call;
}

bool allocations_refused(void)
{
    bool came = allocations.asked >= refused;
    refused = 0;
    return came;
}

static bool refuse(size_t size)
{
    allocations.largest = (long long)size > allocations.largest ? (long long)size : allocations.largest;
    return ++allocations.asked == refused;
}

static long long bytes_of(void *p)
{
    return p ? (long long)malloc_usable_size(p) : 0;
}

static void *given(void *p)
{
    allocations.live += bytes_of(p);
    allocations.most_live = allocations.live > allocations.most_live ? allocations.live : allocations.most_live;
    return p;
}

void *__wrap_malloc(size_t size)
{
    return refuse(size) ? NULL : given(__real_malloc(size));
}
void *__wrap_calloc(size_t count, size_t size)
{
    return refuse(count * size) ? NULL : given(__real_calloc(count, size));
}
void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return refuse(size) ? NULL : given(__real_aligned_alloc(alignment, size));
}
void *__wrap_realloc(void *p, size_t size)
{
    if (refuse(size))
        return NULL;
    allocations.live -= bytes_of(p);
    return given(__real_realloc(p, size));
}
char *__wrap_strdup(const char *text)
{
    char *copy = __wrap_malloc(strlen(text) + 1);
    return copy ? memcpy(copy, text, strlen(text) + 1) : NULL;
}
void __wrap_free(void *p)
{
    allocations.freed++;
    allocations.live -= bytes_of(p);
    __real_free(p);
}
