/* rings_geometry.c - static support geometry of concentric rings (CH06 section 3.4).
 *
 * Rows of vertices lie n_phi + 64 apart: then the two rows that cells use, and the next one, do not fall on each other
 * in a direct-mapped vertex cache of 256 entries. Column n_phi repeats column 0 bit for bit.
 *
 * Throttled frames draw of some rings only every second or every fourth vertex along rows and columns: lists of their
 * own over the same vertices. What is left out lies in the middle of an edge between two vertices that are not, where
 * the vertex stage has brought it by then: on the diagonal, which all cells have from the inner to the outer row, or on
 * a row or a column. So the rings with all of their vertices are the same surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/status.h"
#include "rings_internal.h"

enum { PAD = 64, TOGETHER = 7 };

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

/* ---- Triangles ----------------------------------------------------------------------------------------------------
 */

int tc_rings_stage_of(int at, int last)
{
    for (int stage = 0; stage < RINGS_STAGES; stage++)
        if (at & 1 << stage)
            return at + (1 << stage) <= last ? stage : RINGS_STAGES;
    return RINGS_STAGES;
}

/* The next of 0 .. last that a stage draws. */
static int next_drawn(int at, int last, int stage)
{
    do
        at++;
    while (at < last && tc_rings_stage_of(at, last) < stage);
    return at;
}

/* A sector's part of a ring or of the disc inside one, as it is put together. Without `out` it is only counted. */
typedef struct strips {
    const rings_geometry *g;
    tc_geometry *out;
    uint32_t first, count;
    int column; /* first */
    int rows;
    bool disc; /* whose last row is the middle */
    int triangles;
} strips;

static void add_triangle(strips *s, const int row[3], const int column[3])
{
    for (int k = 0; k < 3; k++) {
        int index = row[k] * s->g->stride + (s->disc && row[k] == s->rows ? 0 : s->column + column[k]);
        if (s->out)
            tc_set_index(s->out, s->first + s->count, (uint32_t)index);
        s->count++;
    }
    s->triangles++;
}

/* A cell between two rows and two columns of a stage, clockwise from above. middle: a column of the stage before
 * between them, which the outer row has: three triangles; west: none. */
static void add_cell(strips *s, int outer, int inner, int west, int middle, int east)
{
    const bool tip = s->disc && inner == s->rows; /* both inner corners are one */
    if (middle > west) {
        if (!tip)
            add_triangle(s, (int[]){inner, outer, inner}, (int[]){east, east, west});
        add_triangle(s, (int[]){inner, outer, outer}, (int[]){west, east, middle});
        add_triangle(s, (int[]){inner, outer, outer}, (int[]){west, middle, west});
        return;
    }
    add_triangle(s, (int[]){outer, inner, outer}, (int[]){west, west, east});
    if (!tip)
        add_triangle(s, (int[]){outer, inner, inner}, (int[]){east, west, east});
}

/* Some columns at a time, from the outside inwards: then the vertices of a row are still in a cache of 16 when the next
 * row reads them. */
static void add_sector(strips *s, int stage, bool finer_edge)
{
    const int columns = s->g->n_phi / s->g->sectors;
    int drawn = 0, east;
    for (int k = 0; k < columns; k = next_drawn(k, columns, stage))
        drawn++;
    const int parts = (drawn + TOGETHER - 1) / TOGETHER;
    for (int part = 0, from = 0, done = 0, to; part < parts; part++, from = to) {
        to = from;
        for (const int end = drawn * (part + 1) / parts; done < end; done++)
            to = next_drawn(to, columns, stage);
        for (int row = 0, inner; row < s->rows; row = inner) {
            inner = next_drawn(row, s->rows, stage);
            for (int west = from; west < to; west = east) {
                east = next_drawn(west, columns, stage);
                const int before = row == 0 && finer_edge ? next_drawn(west, columns, stage - 1) : east;
                add_cell(s, row, inner, west, before < east ? before : west, east);
            }
        }
    }
}

/* All sectors, at index `first` on. */
static rings_strips add_strips(const rings_geometry *g, tc_geometry *out, uint32_t first, int stage, bool finer_edge,
                               bool disc)
{
    rings_strips list = {.first = first};
    for (int sector = 0; sector < g->sectors; sector++) {
        strips s = {g, out, first, 0, sector * (g->n_phi / g->sectors), disc ? g->fill : g->m, disc, 0};
        add_sector(&s, stage, finer_edge);
        list.count = s.count, list.triangles = s.triangles; /* alike in all of them */
        first += s.count;
    }
    return list;
}

/* All lists, into out where it has room; returns how many indices they are. */
static uint32_t index_lists(rings_geometry *g, tc_geometry *out)
{
    uint32_t at = 0;
    for (int disc = 0; disc < 2; disc++)
        for (int stage = 0; stage < (g->throttled ? RINGS_STAGES + 1 : 1); stage++)
            for (int finer = 0; finer < (stage ? 2 : 1); finer++) {
                rings_strips *list = &(disc ? g->fill_strips : g->ring_strips)[stage][finer];
                *list = add_strips(g, out, at, stage, finer, disc);
                at += list->count * (uint32_t)g->sectors;
            }
    return at;
}

tc_status tc_rings_geometry(rings_geometry *g, tc_geometry *geometry, tc_error *error)
{
    g->stride = g->n_phi + PAD;
    g->sectors = RINGS_SECTORS;
    geometry->format = TC_VERTEX_FLOAT_4;
    geometry->vertex_count = tc_rings_fill_base(g, g->levels);
    geometry->index_count = (int)index_lists(g, NULL);
    float(*v)[4] = calloc((size_t)geometry->vertex_count, sizeof *v);
    geometry->vertices = v;
    geometry->index_bytes = tc_index_bytes((int64_t)(g->m + 1) * g->stride); /* from a ring's first vertex on */
    geometry->indices = malloc((size_t)geometry->index_count * (size_t)geometry->index_bytes);
    if (!v || !geometry->indices)
        return tc_fail(error, TC_ERR_MEMORY, "rings: not enough memory");
    vertices(g, v);
    index_lists(g, geometry);
    return TC_OK;
}
