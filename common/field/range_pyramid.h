/* range_pyramid.h - heights' ranges over rectangles of leaves in at most four reads: a quadtree of them. */
#ifndef TC_RANGE_PYRAMID_H
#define TC_RANGE_PYRAMID_H

#include "common/terraclip.h"

/* Nodes of all scales, the leaves' first, row by row; a node of scale k covers 2^k x 2^k leaves, of the last one all.
 */
typedef struct tc_range_pyramid {
    int64_t nx, ny; /* leaves */
    tc_range *node;
} tc_range_pyramid;

/* What covers nothing, and what covers both. */
#define TC_NO_RANGE ((tc_range){INFINITY, -INFINITY, 0, 0})
static inline tc_range tc_range_both(tc_range a, tc_range b)
{
    return (tc_range){a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi, a.step > b.step ? a.step : b.step,
                      a.error > b.error ? a.error : b.error};
}

/* Nodes of a pyramid over so many leaves. */
int64_t tc_range_nodes(int64_t nx, int64_t ny);

/* Makes the coarser scales from the leaves, all of them or those above one leaf. */
void tc_range_build(const tc_range_pyramid *p);
void tc_range_update(const tc_range_pyramid *p, int64_t x, int64_t y);

/* What covers the leaves (not empty, within the pyramid), by reading at most most_x x 2 nodes, which are added to
 * *reads. */
tc_range tc_range_ask(const tc_range_pyramid *p, tc_rect leaves, int64_t most_x, int *reads);

/* The node of a scale (the last one, where there are not so many) that leaf (x, y) lies in. */
tc_range tc_range_node(const tc_range_pyramid *p, int scale, int64_t x, int64_t y);

#endif
