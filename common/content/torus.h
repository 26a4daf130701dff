/* torus.h - toroidal rows: element x lies at x mod size, a power of two. */
#ifndef TC_TORUS_H
#define TC_TORUS_H

#include <string.h>

#include "common/base/rect.h"

/* Copies `count` elements of `size` bytes to toroidal columns x, x + 1, ... of a row with mask + 1 columns. */
static inline void tc_torus_store(void *row, int64_t x, int64_t mask, const void *from, int64_t count, size_t size)
{
    while (count > 0) {
        int64_t at = x & mask, run = tc_min64(count, mask + 1 - at);
        memcpy((char *)row + (size_t)at * size, from, (size_t)run * size);
        from = (const char *)from + (size_t)run * size;
        x += run;
        count -= run;
    }
}

#endif
