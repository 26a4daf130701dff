/* spool.h - a large array of rows on disk that nobody else sees: a file without a name, gone with the process. */
#ifndef TC_SPOOL_H
#define TC_SPOOL_H

#include "common/terraclip.h"

typedef struct tc_spool {
    int file; /* -1: none */
    int64_t width, height;
    size_t size;      /* bytes of an element */
    const char *path; /* beside which it is; the caller's, for errors */
} tc_spool;

#define TC_SPOOL_NONE ((tc_spool){-1, 0, 0, 0, NULL})

/* Makes a spool of width x height elements, all bytes zero, in the folder of `path`. */
tc_status tc_spool_create(const char *path, int64_t width, int64_t height, size_t element, tc_spool *spool_ret,
                          tc_error *error);
void tc_spool_close(tc_spool *spool);

/* Copies a rectangle, to or from elements with a row stride in elements. Thread-safe for rectangles apart. */
tc_status tc_spool_read(const tc_spool *spool, tc_rect rect, void *to, ptrdiff_t stride, tc_error *error);
/* The same where columns go round: of a rectangle that sticks out in x, those of the other side. */
tc_status tc_spool_read_round(const tc_spool *spool, tc_rect rect, void *to, ptrdiff_t stride, tc_error *error);
tc_status tc_spool_write(const tc_spool *spool, tc_rect rect, const void *from, ptrdiff_t stride, tc_error *error);

/* So many bytes of such a file as memory, all zero, which need not stay in it; let go of by munmap(). */
tc_status tc_spool_map(const char *path, size_t size, void **bytes_ret, tc_error *error);

#endif
