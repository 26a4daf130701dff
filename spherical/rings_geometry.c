/* rings_geometry.c - static support geometry of concentric rings (CH06 section 3.4).
 *
 * Rows of vertices lie n_phi + 64 apart: then the two rows that a strip uses, and the next one, do not fall on each
 * other in a direct-mapped vertex cache of 256 entries. Column n_phi repeats column 0 bit for bit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"
#include "rings_internal.h"

enum { PAD = 64 };

static int level_vertices(const rings_geometry *g)
{
    return g->m * g->stride;
}

/* Rows of the disc and its middle. */
static int fill_vertices(const rings_geometry *g)
{
    return g->fill * g->stride + 1;
}

int tc_rings_level_base(const rings_geometry *g, int i)
{
    return i * level_vertices(g);
}

int tc_rings_fill_base(const rings_geometry *g, int i)
{
    return g->levels * level_vertices(g) + g->stride + i * fill_vertices(g);
}

/* Vertices at angle theta~ and level w. */
static void row(const rings_geometry *g, double theta, double w, float (*out)[4])
{
    double s = sin(theta), half = sin(theta / 2);
    for (int k = 0; k <= g->n_phi; k++) {
        double phi = 2 * M_PI * (k % g->n_phi) / g->n_phi;
        out[k][0] = (float)(s * cos(phi));
        out[k][1] = (float)(s * sin(phi));
        out[k][2] = (float)(2 * half * half);
        out[k][3] = (float)w;
    }
}

static void vertices(const rings_geometry *g, float (*v)[4])
{
    for (int r = 0; r <= g->levels * g->m; r++) {
        int i = r / g->m, j = r % g->m;
        double theta = ldexp(M_PI, -i) * (1 - 0.5 * j / g->m);
        row(g, theta, i + (double)j / g->m, v + (size_t)r * (size_t)g->stride);
    }
    for (int i = 0; i < g->levels; i++) {
        float(*disc)[4] = v + tc_rings_fill_base(g, i);
        for (int q = 0; q < g->fill; q++)
            row(g, ldexp(M_PI, -i - 1) * (1 - (double)q / g->fill), i + 1, disc + q * g->stride);
        float middle[4] = {0, 0, 0, (float)(i + 1)};
        memcpy(disc[g->fill * g->stride], middle, sizeof middle);
    }
}

/* Strips of one sector, from the outside inwards; clockwise from above. disc: the last row is the middle. */
static uint32_t strips(const rings_geometry *g, tc_geometry *out, uint32_t at, int sector, int rows, bool disc)
{
    int columns = g->n_phi / g->sectors, k0 = sector * columns;
    for (int j = 0; j < rows; j++) {
        if (j > 0)
            tc_set_index(out, at++, tc_restart(out));
        for (int k = k0; k <= k0 + columns; k++) {
            tc_set_index(out, at++, (uint32_t)(j * g->stride + k));
            tc_set_index(out, at++, (uint32_t)(disc && j == rows - 1 ? rows * g->stride : (j + 1) * g->stride + k));
        }
    }
    return at;
}

static uint32_t strip_count(const rings_geometry *g, int rows)
{
    return (uint32_t)(rows * (2 * (g->n_phi / g->sectors) + 3) - 1);
}

tc_status tc_rings_geometry(rings_geometry *g, tc_geometry *geometry, tc_error *error)
{
    g->stride = g->n_phi + PAD;
    g->sectors = RINGS_SECTORS;
    g->ring_count = strip_count(g, g->m);
    g->fill_count = strip_count(g, g->fill);
    geometry->format = TC_VERTEX_FLOAT_4;
    geometry->vertex_count = tc_rings_fill_base(g, g->levels);
    geometry->index_count = (int)(g->ring_count + g->fill_count) * g->sectors;
    float(*v)[4] = calloc((size_t)geometry->vertex_count, sizeof *v);
    geometry->vertices = v;
    geometry->index_bytes = tc_index_bytes((int64_t)(g->m + 1) * g->stride); /* from a ring's first vertex on */
    geometry->indices = malloc((size_t)geometry->index_count * (size_t)geometry->index_bytes);
    g->ring_first = malloc(2 * (size_t)g->sectors * sizeof *g->ring_first);
    g->fill_first = g->ring_first + g->sectors;
    if (!v || !geometry->indices || !g->ring_first)
        return tc_fail(error, TC_ERR_MEMORY, "rings: not enough memory");
    vertices(g, v);
    uint32_t at = 0;
    for (int s = 0; s < g->sectors; s++) {
        g->ring_first[s] = at;
        at = strips(g, geometry, at, s, g->m, false);
    }
    for (int s = 0; s < g->sectors; s++) {
        g->fill_first[s] = at;
        at = strips(g, geometry, at, s, g->fill, true);
    }
    return TC_OK;
}
