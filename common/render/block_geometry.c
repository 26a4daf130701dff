/* block_geometry.c - static support geometry: blocks of cells, and crack closers.
 *
 * A level's frame is drawn in blocks, so that what lies outside the view can be left out. A block's cells follow each
 * other row by row, every other row from east to west: of wide rows at least the end is still in a small cache then.
 * They are triangles, not strips: a software driver forgets the vertices that it has run where a strip ends
 * (tests/bench/bench_acmr.c), and strips joined by triangles without area show as lines in wireframe. Vertices are
 * numbered row by row with a stride of block + 1, so that the two rows in use stay in a vertex cache. A cell is
 * south-west, north-west, south-east; south-east, north-west, north-east: the diagonal runs from south-east to
 * north-west (mesh.h), and triangles are clockwise from above. */
#include <stdlib.h>

#include "common/base/status.h"
#include "block_geometry.h"

static uint32_t cells(tc_geometry *g, uint32_t at, int w, int h, int stride)
{
    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++) {
            const int sw = j * stride + (j & 1 ? w - 1 - i : i), nw = sw + stride,
                      of[6] = {sw, nw, sw + 1, sw + 1, nw, nw + 1};
            for (int k = 0; k < 6; k++)
                tc_set_index(g, at++, (uint32_t)of[k]);
        }
    return at;
}

/* A coarse edge is two fine ones; the triangle of their three vertices fills whatever lies between. */
static uint32_t closers(tc_geometry *g, uint32_t at, int edges, int step)
{
    for (int i = 0; i + 2 <= edges; i += 2)
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
        at = cells(geometry, at, w, block, stride);
    }
    index->row_first = at;
    at = closers(geometry, at, block, 1);
    index->column_first = at;
    closers(geometry, at, block, stride);
    return TC_OK;
}
