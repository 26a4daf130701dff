/* raw_bits.h - bits without a model behind a rANS stream, low ones first, and the escape code in them.
 *
 * The first bytes travel in the states of the rANS lanes (rans.h), so a reader takes two pieces: the payload of the
 * states, then what follows the stream. */
#ifndef TC_RAW_BITS_H
#define TC_RAW_BITS_H

#include "common/terraclip.h"

/* ---- Writing ------------------------------------------------------------------------------------------------- */

typedef struct tc_raw_writer {
    uint8_t *bytes; /* eight bytes behind the whole ones may be written */
    size_t size;    /* whole bytes */
    uint64_t held;
    int count; /* bits held: less than a byte */
} tc_raw_writer;

/* 0 <= n <= 32. Stores all it holds each time, which takes less than asking how many bytes there are. */
static inline __attribute__((always_inline)) void tc_raw_put(tc_raw_writer *r, uint32_t value, int n)
{
    r->held |= (uint64_t)value << r->count;
    r->count += n;
    for (int i = 0; i < 8; i++)
        r->bytes[r->size + (size_t)i] = (uint8_t)(r->held >> 8 * i);
    r->size += (size_t)(r->count >> 3);
    r->held >>= r->count & ~7;
    r->count &= 7;
}

/* Fills the last byte and, with zeros, up to `least` bytes. */
static inline void tc_raw_finish(tc_raw_writer *r, size_t least)
{
    if (r->count > 0)
        tc_raw_put(r, 0, 8 - r->count);
    while (r->size < least)
        r->bytes[r->size++] = 0;
}

/* Bits of the exponential Golomb code of `beyond` are twice this and one more. */
static inline int tc_escape_length(uint32_t beyond)
{
    return 31 - __builtin_clz(beyond + 1);
}

enum { TC_ESCAPE_LENGTH = 24, TC_ESCAPE_BITS = 2 * TC_ESCAPE_LENGTH + 1 }; /* at most */

static inline void tc_raw_put_escape(tc_raw_writer *r, uint32_t beyond)
{
    int n = tc_escape_length(beyond);
    tc_raw_put(r, (1u << n) - 1, n + 1); /* never so long that the reader would not look for the zero */
    tc_raw_put(r, beyond + 1 - (1u << n), n);
}

/* ---- Reading ------------------------------------------------------------------------------------------------- */

typedef struct tc_raw_reader {
    uint64_t held;
    int count; /* bits held */
    const uint8_t *at, *end;
    bool overrun;
    const uint8_t *next, *next_end; /* what follows behind `end`; NULL: nothing, or reading has gone on there */
} tc_raw_reader;

/* Four bytes more, which must be there; at most 32 bits are held. */
static inline __attribute__((always_inline)) void tc_raw_load(tc_raw_reader *r)
{
    const uint8_t *p = r->at;
    uint32_t bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    r->held |= (uint64_t)bits << r->count;
    r->at += 4, r->count += 32;
}

/* 0 <= n <= 32 */
static inline __attribute__((always_inline)) uint32_t tc_raw_take(tc_raw_reader *r, int n)
{
    if (r->count < n && r->end - r->at >= 4)
        tc_raw_load(r);
    while (r->count < n) {
        if (r->at == r->end && r->next)
            r->at = r->next, r->end = r->next_end, r->next = NULL;
        if (r->at < r->end)
            r->held |= (uint64_t)*r->at++ << r->count;
        else
            r->overrun = true;
        r->count += 8;
    }
    uint32_t v = (uint32_t)(r->held & (((uint64_t)1 << n) - 1));
    r->held >>= n, r->count -= n;
    return v;
}

static inline __attribute__((always_inline)) uint32_t tc_raw_take_escape(tc_raw_reader *r)
{
    int n = 0;
    if (r->count < 32 && r->end - r->at >= 4)
        tc_raw_load(r);
    /* All ones and the zero at once, where they are held: bits beyond are zero. */
    if (~r->held && (n = __builtin_ctzll(~r->held)) < r->count && n < TC_ESCAPE_LENGTH) {
        r->held >>= n + 1, r->count -= n + 1;
    } else {
        n = 0;
        while (n < TC_ESCAPE_LENGTH && !r->overrun && tc_raw_take(r, 1))
            n++;
    }
    return (1u << n) - 1 + tc_raw_take(r, n);
}

/* Whether nothing is missing and nothing is left over: bits loaded and not taken are zero and less than a byte, unless
 * the states were more than enough. */
static inline bool tc_raw_finished(const tc_raw_reader *r)
{
    if (r->overrun || r->held != 0)
        return false;
    if (!r->next)
        return r->at == r->end && r->count < 8;
    for (const uint8_t *p = r->at; p < r->end; p++)
        if (*p)
            return false;
    return r->next == r->next_end;
}

#endif
