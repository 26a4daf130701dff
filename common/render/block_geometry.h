/* block_geometry.h - static support geometry of schemes that draw blocks of cells: a grid of (block + 1)^2 vertices;
 * triangles for blocks of every width from 1 to block cells, whose first rows serve every height; and those that
 * close T-junctions along a row and along a column. */
#ifndef TC_BLOCK_GEOMETRY_H
#define TC_BLOCK_GEOMETRY_H

#include "surface.h"

typedef struct tc_block_geometry {
    int block;                        /* cells of the largest block along a side; even */
    uint32_t *strip_first;            /* [w - 1]: first index of blocks w cells wide; owned */
    uint32_t row_first, column_first; /* of the closers along a row and a column of `block` cells */
} tc_block_geometry;

/* Vertices are the cells' corners, (0, 0) to (block, block), ivec2 in GLSL. Both results are freed with free(), also
 * after TC_ERR_MEMORY. */
tc_status tc_block_geometry_make(int block, tc_geometry *geometry, tc_block_geometry *index, tc_error *error);

/* Indices of a block of w x h cells. */
static inline uint32_t tc_block_strip_count(int64_t w, int64_t h)
{
    return (uint32_t)(6 * w * h);
}

#endif
