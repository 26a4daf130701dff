/* range_pyramid.c - a quadtree without pointers. */
#include "range_pyramid.h"

#include <math.h>

#include "common/base/rect.h"

/* Nodes of a scale. */
typedef struct scale {
    int64_t nx, ny, first;
} scale;

static bool coarser(scale *s)
{
    if (s->nx * s->ny <= 1)
        return false;
    *s = (scale){(s->nx + 1) / 2, (s->ny + 1) / 2, s->first + s->nx * s->ny};
    return true;
}

int64_t tc_range_nodes(int64_t nx, int64_t ny)
{
    scale s = {nx, ny, 0};
    while (coarser(&s))
        continue;
    return s.first + 1;
}

/* Node (x, y) of scale `to` from its up to four parts. */
static void join(const tc_range_pyramid *p, const scale *from, const scale *to, int64_t x, int64_t y)
{
    tc_range all = TC_NO_RANGE;
    for (int64_t j = 2 * y; j < tc_min64(2 * y + 2, from->ny); j++)
        for (int64_t i = 2 * x; i < tc_min64(2 * x + 2, from->nx); i++)
            all = tc_range_both(all, p->node[from->first + j * from->nx + i]);
    p->node[to->first + y * to->nx + x] = all;
}

void tc_range_build(const tc_range_pyramid *p)
{
    scale to = {p->nx, p->ny, 0};
    for (scale from = to; coarser(&to); from = to)
        for (int64_t y = 0; y < to.ny; y++)
            for (int64_t x = 0; x < to.nx; x++)
                join(p, &from, &to, x, y);
}

void tc_range_update(const tc_range_pyramid *p, int64_t x, int64_t y)
{
    scale to = {p->nx, p->ny, 0};
    for (scale from = to; coarser(&to); from = to) {
        x /= 2, y /= 2;
        join(p, &from, &to, x, y);
    }
}

/* The finest scale at which leaves touch at most `most_x` x 2 nodes. */
static int scale_of(tc_rect r, int64_t most_x)
{
    int k = 0;
    while (((r.x1 - 1) >> k) - (r.x0 >> k) >= most_x || ((r.y1 - 1) >> k) - (r.y0 >> k) >= 2)
        k++;
    return k;
}

static scale scale_at(const tc_range_pyramid *p, int *k)
{
    scale s = {p->nx, p->ny, 0};
    int n = 0;
    while (n < *k && coarser(&s))
        n++;
    *k = n;
    return s;
}

tc_range tc_range_node(const tc_range_pyramid *p, int k, int64_t x, int64_t y)
{
    scale s = scale_at(p, &k);
    return p->node[s.first + (y >> k) * s.nx + (x >> k)];
}

tc_range tc_range_ask(const tc_range_pyramid *p, tc_rect r, int64_t most_x, int *reads)
{
    int k = scale_of(r, most_x);
    scale s = scale_at(p, &k);
    tc_range all = TC_NO_RANGE;
    for (int64_t y = r.y0 >> k; y <= (r.y1 - 1) >> k; y++)
        for (int64_t x = r.x0 >> k; x <= (r.x1 - 1) >> k; x++, ++*reads)
            all = tc_range_both(all, p->node[s.first + y * s.nx + x]);
    return all;
}
