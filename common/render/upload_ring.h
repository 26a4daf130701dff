/* upload_ring.h - memory that a driver fetches uploads from while the program goes on: one buffer, mapped once for all.
 * Each frame writes into a part of its own, and comes back to it behind a fence. Nothing is ever waited for: what finds
 * no room goes the plain way, on which the driver copies it before it returns. */
#ifndef TC_UPLOAD_RING_H
#define TC_UPLOAD_RING_H

#include "common/gl/gl.h"

enum { TC_UPLOAD_PARTS = 3, TC_UPLOAD_PART_BYTES = 2 << 20 };

typedef struct tc_upload_ring {
    GLuint buffer;      /* 0: there is none */
    unsigned char *map; /* of all parts */
    GLsync done[TC_UPLOAD_PARTS];
    int now;
    bool open; /* the driver has come to an end with the part that is now written */
    size_t used;
} tc_upload_ring;

/* Whether a driver gains by it: those that draw on the processor would only copy once more. */
bool tc_upload_ring_pays(const tc_gl *gl);

/* None, and TC_OK, with a driver that does not map buffers for good; TC_ERR_MEMORY where it has no memory. */
tc_status tc_upload_ring_create(const tc_gl *gl, tc_upload_ring *ring, tc_error *error);
void tc_upload_ring_destroy(const tc_gl *gl, tc_upload_ring *ring);

/* A frame's uploads; of a ring that there is not nothing comes. */
void tc_upload_ring_begin(const tc_gl *gl, tc_upload_ring *ring);
void tc_upload_ring_end(const tc_gl *gl, tc_upload_ring *ring);

/* Room for so many bytes, at *offset_ret in the buffer; NULL: there is none. */
void *tc_upload_ring_take(tc_upload_ring *ring, size_t bytes, size_t *offset_ret);

size_t tc_upload_ring_bytes(const tc_upload_ring *ring);

#endif
