/* block_geometry.c - static support geometry: blocks as triangle strips, and crack closers.
 *
 * A level's frame is drawn in blocks, so that what lies outside the view can be left out. Each row of a block is a
 * strip; strips follow each other after a restart index (joined by degenerate triangles they cost the same, and show
 * as lines in wireframe). Vertices are numbered row by row with a stride of block + 1, so that the two rows in use stay
 * in a vertex cache. The strip goes south-west, north-west, south-east, ... in each row: the diagonal runs from
 * south-east to north-west (mesh.h), and triangles are clockwise from above. */
#include <stdlib.h>

#include "common/base/status.h"
#include "block_geometry.h"

static uint32_t strip(tc_geometry *g, uint32_t at, int w, int h, int stride)
{
    for (int j = 0; j < h; j++) {
        int south = j * stride, north = south + stride;
        if (j > 0)
            tc_set_index(g, at++, tc_restart(g));
        for (int i = 0; i <= w; i++) {
            tc_set_index(g, at++, (uint32_t)(south + i));
            tc_set_index(g, at++, (uint32_t)(north + i));
        }
    }
    return at;
}

/* A coarse edge is two fine ones; the triangle of their three vertices fills whatever lies between. */
static uint32_t closers(tc_geometry *g, uint32_t at, int cells, int step)
{
    for (int i = 0; i + 2 <= cells; i += 2)
        for (int k = 0; k < 3; k++)
            tc_set_index(g, at++, (uint32_t)((i + k) * step));
    return at;
}

tc_status tc_block_geometry_make(int block, tc_geometry *geometry, tc_block_geometry *index, tc_error *error)
{
    int stride = block + 1, count = 0;
    for (int w = 1; w <= block; w++)
        count += (int)tc_block_strip_count(w, block);
    count += 2 * 3 * (block / 2);
    geometry->vertex_count = stride * stride;
    geometry->index_count = count;
    uint16_t(*vertices)[2] = malloc((size_t)geometry->vertex_count * sizeof *vertices);
    geometry->format = TC_VERTEX_UINT16_2;
    geometry->vertices = vertices;
    geometry->index_bytes = tc_index_bytes(geometry->vertex_count);
    geometry->indices = malloc((size_t)count * (size_t)geometry->index_bytes);
    index->strip_first = malloc((size_t)block * sizeof *index->strip_first);
    if (!geometry->vertices || !geometry->indices || !index->strip_first)
        return tc_fail(error, TC_ERR_MEMORY, "blocks: not enough memory");
    for (int j = 0; j < stride; j++)
        for (int i = 0; i < stride; i++) {
            vertices[j * stride + i][0] = (uint16_t)i;
            vertices[j * stride + i][1] = (uint16_t)j;
        }
    uint32_t at = 0;
    index->block = block;
    for (int w = 1; w <= block; w++) {
        index->strip_first[w - 1] = at;
        at = strip(geometry, at, w, block, stride);
    }
    index->row_first = at;
    at = closers(geometry, at, block, 1);
    index->column_first = at;
    closers(geometry, at, block, stride);
    return TC_OK;
}
