/* byte_order.h - little-endian fields in a growing or a bounded buffer. */
#ifndef TC_BYTE_ORDER_H
#define TC_BYTE_ORDER_H

#include <stdlib.h>
#include <string.h>

#include "common/terraclip.h"

/* A buffer that grows; `failed` once memory was missing. */
typedef struct tc_byte_writer {
    uint8_t *bytes; /* owned by whoever started it */
    size_t size, room;
    bool failed;
} tc_byte_writer;

/* `size` more bytes at the end; NULL where there is no memory. */
static inline uint8_t *tc_put_room(tc_byte_writer *w, size_t size)
{
    if (w->size + size > w->room && !w->failed) {
        size_t room = 2 * (w->size + size) + 256;
        uint8_t *bytes = realloc(w->bytes, room);
        if (bytes)
            w->bytes = bytes, w->room = room;
        else
            w->failed = true;
    }
    if (w->failed)
        return NULL;
    w->size += size;
    return w->bytes + w->size - size;
}

static inline void tc_put_bytes(tc_byte_writer *w, const void *bytes, size_t size)
{
    uint8_t *to = tc_put_room(w, size);
    if (to && size > 0)
        memcpy(to, bytes, size);
}

static inline void tc_store(uint8_t *to, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

static inline uint64_t tc_load(const uint8_t *from, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << 8 * i;
    return value;
}

/* An unsigned number of 1 to 8 bytes. */
static inline void tc_put(tc_byte_writer *w, uint64_t value, int bytes)
{
    uint8_t *to = tc_put_room(w, (size_t)bytes);
    if (to)
        tc_store(to, value, bytes);
}

static inline void tc_put_f64(tc_byte_writer *w, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    tc_put(w, bits, 8);
}

static inline void tc_put_f32(tc_byte_writer *w, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    tc_put(w, bits, 4);
}

/* Bytes being read; `failed` once they were not enough (everything read from then on is zero). */
typedef struct tc_byte_reader {
    const uint8_t *at, *end;
    bool failed;
} tc_byte_reader;

static inline const uint8_t *tc_get_bytes(tc_byte_reader *r, size_t size)
{
    if (r->failed || (size_t)(r->end - r->at) < size) {
        r->failed = true;
        return NULL;
    }
    r->at += size;
    return r->at - size;
}

static inline uint64_t tc_get(tc_byte_reader *r, int bytes)
{
    const uint8_t *from = tc_get_bytes(r, (size_t)bytes);
    return from ? tc_load(from, bytes) : 0;
}

static inline double tc_get_f64(tc_byte_reader *r)
{
    uint64_t bits = tc_get(r, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline float tc_get_f32(tc_byte_reader *r)
{
    uint32_t bits = (uint32_t)tc_get(r, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
