/* beyond.c - reading across the sides of a level. */
#include "beyond.h"

#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"

/* Steps of the slope between the last two samples to add at sample i of `size`; 0 inside. */
static inline float steps_beyond(int64_t i, int64_t size, bool straight, float edge)
{
    return i < 0 ? (float)-i : i < size ? 0 : straight ? (float)(i - size + 1) : edge;
}

/* The inner neighbour that gives the slope at border sample b. */
static inline int64_t inner(int64_t b, int64_t size)
{
    return size < 2 ? b : b == 0 ? 1 : b == size - 1 ? size - 2 : b;
}

/* The part of rect that exists, with what its continuation needs, and the rectangle around both. */
typedef struct reading {
    tc_rect part;
    int64_t x0, y0;          /* of the buffer's first sample */
    ptrdiff_t stride, start; /* of the part's first sample */
} reading;

static reading part_of(tc_level size, tc_rect rect, bool wraps)
{
    int64_t w = size.width, h = size.height;
    tc_rect part = {tc_nearest_sample(rect.x0, w), tc_nearest_sample(rect.y0, h), tc_nearest_sample(rect.x1 - 1, w) + 1,
                    tc_nearest_sample(rect.y1 - 1, h) + 1};
    if (wraps)
        part.x0 = rect.x0, part.x1 = rect.x1;
    else if (rect.x0 < 0)
        part.x1 = tc_max64(part.x1, tc_min64(2, w));
    if (rect.y0 < 0)
        part.y1 = tc_max64(part.y1, tc_min64(2, h));
    if (rect.x1 > w && !wraps)
        part.x0 = tc_min64(part.x0, tc_max64(w - 2, 0));
    if (rect.y1 > h)
        part.y0 = tc_min64(part.y0, tc_max64(h - 2, 0));
    reading r = {.part = part, .x0 = tc_min64(rect.x0, part.x0), .y0 = tc_min64(rect.y0, part.y0)};
    r.stride = tc_max64(rect.x1, part.x1) - r.x0;
    r.start = (part.y0 - r.y0) * r.stride + part.x0 - r.x0;
    return r;
}

tc_status tc_read_beyond(const tc_fill *fill, int level, tc_rect rect, tc_beyond how, float *buffer, float **z_ret,
                         ptrdiff_t *stride_ret)
{
    tc_level size = tc_field_level(tc_clipmap_field(fill->clipmap), level);
    int64_t w = size.width, h = size.height;
    if (how.straight && tc_clipmap_field(fill->clipmap)->beyond > 0) { /* the neighbours' heights are there */
        *z_ret = buffer, *stride_ret = rect.x1 - rect.x0;
        return tc_fill_read(fill, level, rect, buffer, NULL, *stride_ret);
    }
    reading r = part_of(size, rect, how.wraps);
    ptrdiff_t stride = r.stride;
    tc_status status = tc_fill_read(fill, level, r.part, buffer + r.start, NULL, stride);
    if (status)
        return status;
    for (int64_t j = r.part.y0; j < r.part.y1 && !how.wraps; j++) {
        float *row = buffer + (j - r.y0) * stride - r.x0; /* sample (i, j) is row[i] */
        for (int64_t i = rect.x0; i < rect.x1; i++) {
            int64_t b = tc_nearest_sample(i, w);
            if (i != b)
                row[i] = row[b] + steps_beyond(i, w, how.straight, how.x) * (row[b] - row[inner(b, w)]);
            else if (i < w - 1)
                i = tc_max64(i, tc_min64(rect.x1, w) - 1); /* on to the other side */
        }
    }
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        int64_t b = tc_nearest_sample(j, h);
        if (j == b)
            continue;
        float steps = steps_beyond(j, h, how.straight, how.y);
        float *row = buffer + (j - r.y0) * stride - r.x0;
        const float *r0 = buffer + (b - r.y0) * stride - r.x0, *r1 = buffer + (inner(b, h) - r.y0) * stride - r.x0;
        for (int64_t i = rect.x0; i < rect.x1; i++)
            row[i] = r0[i] + steps * (r0[i] - r1[i]);
    }
    *z_ret = buffer + (rect.y0 - r.y0) * stride + rect.x0 - r.x0;
    *stride_ret = stride;
    return TC_OK;
}

tc_clamped tc_clamped_rows(const tc_fill *f)
{
    int level = tc_clipmap_field_level(f->clipmap, f->level);
    tc_level size = tc_field_level(tc_clipmap_field(f->clipmap), level);
    tc_clamped c = {f->rect, size.width, size.height, tc_clipmap_level(f->clipmap, f->level)->wraps};
    if (!c.wraps)
        c.part.x0 = tc_nearest_sample(f->rect.x0, size.width),
        c.part.x1 = tc_nearest_sample(f->rect.x1 - 1, size.width) + 1;
    c.part.y0 = tc_nearest_sample(f->rect.y0, size.height);
    c.part.y1 = tc_nearest_sample(f->rect.y1 - 1, size.height) + 1;
    return c;
}

void tc_clamped_row(const tc_clamped *c, const void *read, size_t bytes, int64_t y, tc_rect rect, void *row)
{
    const char *from = (const char *)read +
                       (size_t)((tc_nearest_sample(y, c->height) - c->part.y0) * (c->part.x1 - c->part.x0)) * bytes;
    for (int64_t x = rect.x0; x < rect.x1; x++) {
        int64_t at = (c->wraps ? x : tc_nearest_sample(x, c->width)) - c->part.x0;
        memcpy((char *)row + (size_t)(x - rect.x0) * bytes, from + (size_t)at * bytes, bytes);
    }
}
