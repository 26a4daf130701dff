/* rect.h - half-open rectangles of samples. */
#ifndef TC_RECT_H
#define TC_RECT_H

#include "common/terraclip.h"

static inline int64_t tc_min64(int64_t a, int64_t b)
{
    return a < b ? a : b;
}
static inline int64_t tc_max64(int64_t a, int64_t b)
{
    return a > b ? a : b;
}
static inline int64_t tc_clamp64(int64_t v, int64_t lo, int64_t hi)
{
    return v < lo ? lo : v > hi ? hi : v;
}

/* floor(a / 2^k) and ceil(a / 2^k), also for negative a. */
static inline int64_t tc_floor_shift(int64_t a, int k)
{
    return a >> k;
}
static inline int64_t tc_ceil_shift(int64_t a, int k)
{
    return -((-a) >> k);
}

/* The whole turn, a multiple of `width`, that x lies in where columns go round. */
static inline int64_t tc_turn(int64_t x, int64_t width)
{
    int64_t past = x % width;
    return x - past - (past < 0 ? width : 0);
}

static inline bool tc_rect_empty(tc_rect r)
{
    return r.x1 <= r.x0 || r.y1 <= r.y0;
}

static inline int64_t tc_rect_area(tc_rect r)
{
    return tc_rect_empty(r) ? 0 : (r.x1 - r.x0) * (r.y1 - r.y0);
}

static inline tc_rect tc_rect_intersect(tc_rect a, tc_rect b)
{
    tc_rect r = {tc_max64(a.x0, b.x0), tc_max64(a.y0, b.y0), tc_min64(a.x1, b.x1), tc_min64(a.y1, b.y1)};
    return tc_rect_empty(r) ? (tc_rect){0, 0, 0, 0} : r;
}

/* Whether a lies within b; an empty a does. */
static inline bool tc_rect_within(tc_rect a, tc_rect b)
{
    return tc_rect_empty(a) || (a.x0 >= b.x0 && a.y0 >= b.y0 && a.x1 <= b.x1 && a.y1 <= b.y1);
}

/* The one or two pieces on a level that wraps, `width` wide, of what sticks out of it; once around is all. */
static inline int tc_rect_round(tc_rect rect, int64_t width, tc_rect piece[2])
{
    int64_t x = rect.x0 - tc_turn(rect.x0, width), w = rect.x1 - rect.x0;
    if (w >= width)
        x = 0, w = width;
    piece[0] = (tc_rect){x, rect.y0, tc_min64(x + w, width), rect.y1};
    piece[1] = (tc_rect){0, rect.y0, x + w - width, rect.y1};
    return x + w > width ? 2 : 1;
}

static inline bool tc_rect_equal(tc_rect a, tc_rect b)
{
    return (tc_rect_empty(a) && tc_rect_empty(b)) || (a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1);
}

static inline tc_rect tc_rect_grown(tc_rect r, int64_t by)
{
    return (tc_rect){r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by};
}

/* The smallest one around both; an empty one does not count. */
static inline tc_rect tc_rect_around(tc_rect a, tc_rect b)
{
    if (tc_rect_empty(a) || tc_rect_empty(b))
        return tc_rect_empty(a) ? b : a;
    return (tc_rect){tc_min64(a.x0, b.x0), tc_min64(a.y0, b.y0), tc_max64(a.x1, b.x1), tc_max64(a.y1, b.y1)};
}

static inline bool tc_rect_contains(tc_rect r, int64_t x, int64_t y)
{
    return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

#endif
