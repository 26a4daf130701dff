/* allocations.h - what our own objects ask malloc() and its like for: counted, and one call of them refused. Linked
 * only with tests that the Makefile names (ALLOCATIONS), by --wrap; what the driver and other libraries allocate is not
 * counted. */
#ifndef ALLOCATIONS_H
#define ALLOCATIONS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* Any thread counts. asked: calls that allocate, since allocations_refuse(); freed: calls of free(); live: bytes given
 * out and not freed; most_live, largest (asked for at once): since the test last set them. */
typedef struct allocation_counts {
    atomic_llong asked, freed, live, most_live, largest;
} allocation_counts;

extern allocation_counts allocations;

/* Has a call from now on refused, from 1 on; 0: none. */
void allocations_refuse(int call);

/* No more; whether it came. Also true where none was to be. */
bool allocations_refused(void);

/* The C library's own, for what a test itself needs meanwhile: not counted. */
void *__real_malloc(size_t size);
void __real_free(void *p);

#endif
