/* test_blocks.c - trees of blocks over the charts of an octahedron and of a cube: levels of neighbours differ by one,
 * and the mesh of all leaves, with what closes their T-junctions, has every edge twice, whatever a rule asks for. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/blocks/blocks.h"

typedef struct kind {
    const tc_chart_class *class;
    int faces;
} kind;
static const kind kinds[] = {{&tc_chart_hex, 4}, {&tc_chart_cube, 6}};
enum { KINDS = 2, MOST_FACES = 6, COARSEST = 24, LEVELS = 5, CELLS = COARSEST << (LEVELS - 1), BLOCK = 8 };

/* Blocks are wanted around a place, in sight of which some are not held; all by hashes of a seed. */
typedef struct asking {
    const tc_chart *chart;
    double n[3], reach;
    uint64_t seed;
    int missing; /* of 16 */
} asking;

static const tc_block_lattice *lattice_of(const kind *k, tc_chart chart[MOST_FACES], tc_block_lattice *l)
{
    for (int face = 0; face < k->faces; face++) {
        chart[face] = (tc_chart){.class = k->class, .face = face};
        for (int side = 0; side < TC_SIDES; side++)
            chart[face].side[side] = k->class->seam(face, side, CELLS);
    }
    assert_true(tc_block_lattice_set(l, chart, k->faces, CELLS, CELLS, LEVELS, BLOCK));
    return l;
}

static void normal_at(const tc_chart *c, double x, double y, double n[3])
{
    double lon, lat;
    c->class->to_place(c, x, y, &lon, &lat);
    n[0] = cos(lat) * cos(lon), n[1] = cos(lat) * sin(lon), n[2] = sin(lat);
}

static bool wanted(void *context, tc_block b)
{
    const asking *a = context;
    double n[3], across = (double)(COARSEST << (b.level - 1)) / BLOCK;
    normal_at(&a->chart[b.chart], (b.x + 0.5) / across, (b.y + 0.5) / across, n);
    double d = sqrt(pow(n[0] - a->n[0], 2) + pow(n[1] - a->n[1], 2) + pow(n[2] - a->n[2], 2));
    return d < ldexp(a->reach, -b.level);
}

static bool held(void *context, tc_block b)
{
    const asking *a = context;
    uint64_t which = (uint64_t)b.chart << 48 | (uint64_t)b.level << 40 | (uint64_t)b.x << 20 | (uint64_t)b.y;
    return (int)(tc_hash64(a->seed, which) % 16) >= a->missing;
}

/* ---- The mesh --------------------------------------------------------------------------------------------------- */

/* A vertex by the lowest chart that has it. */
static uint64_t vertex(const tc_block_lattice *l, int chart, int64_t i, int64_t j)
{
    for (int times = 0; times < 4; times++) {
        const bool on[TC_SIDES] = {
            [TC_WEST] = i == 0, [TC_EAST] = i == CELLS, [TC_SOUTH] = j == 0, [TC_NORTH] = j == CELLS};
        int lowest = chart;
        int64_t x = i, y = j;
        for (int side = 0; side < TC_SIDES; side++) {
            const tc_seam *s = &l->seam[chart][side];
            if (!on[side] || s->chart >= lowest)
                continue;
            lowest = s->chart;
            x = s->m[0] * i + s->m[1] * j + s->dx * CELLS, y = s->m[2] * i + s->m[3] * j + s->dy * CELLS;
        }
        chart = lowest, i = x, j = y;
    }
    return (uint64_t)chart << 40 | (uint64_t)i << 20 | (uint64_t)j;
}

/* What a leaf says of a vertex on its edge. */
typedef struct touch {
    uint64_t vertex;
    int level; /* of the mesh that it is drawn by */
    int alpha;
} touch;

typedef struct mesh {
    const tc_block_lattice *l;
    const tc_block_tree *tree;
    uint64_t (*edge)[2];
    size_t edges, room;
    touch *touch;
    size_t touches, touch_room;
    int leaves, coarse, closers, finest;
} mesh;

static void add_edge(mesh *m, uint64_t a, uint64_t b)
{
    if (m->edges == m->room) {
        m->room = m->room ? 2 * m->room : 1 << 16;
        m->edge = realloc(m->edge, m->room * sizeof *m->edge);
        assert_non_null(m->edge);
    }
    m->edge[m->edges][0] = a < b ? a : b;
    m->edge[m->edges++][1] = a < b ? b : a;
}

static void add_triangle(mesh *m, uint64_t a, uint64_t b, uint64_t c)
{
    add_edge(m, a, b), add_edge(m, b, c), add_edge(m, c, a);
}

static void add_touch(mesh *m, touch t)
{
    if (m->touches == m->touch_room) {
        m->touch_room = m->touch_room ? 2 * m->touch_room : 1 << 14;
        m->touch = realloc(m->touch, m->touch_room * sizeof *m->touch);
        assert_non_null(m->touch);
    }
    m->touch[m->touches++] = t;
}

static void add_leaf(void *context, const tc_leaf *leaf)
{
    mesh *m = context;
    const tc_block b = leaf->block;
    const int level = b.level - leaf->coarse, cells = m->l->side[b.level - 1] >> leaf->coarse;
    const int64_t step = (int64_t)1 << (LEVELS - level), x0 = b.x * cells * step, y0 = b.y * cells * step;
    m->leaves++, m->coarse += leaf->coarse;
    m->finest = b.level > m->finest ? b.level : m->finest;
    for (int j = 0; j < cells; j++)
        for (int i = 0; i < cells; i++) {
            uint64_t v[4];
            for (int k = 0; k < 4; k++)
                v[k] = vertex(m->l, b.chart, x0 + (i + (k & 1)) * step, y0 + (j + (k >> 1)) * step);
            add_triangle(m, v[0], v[1], v[2]);
            add_triangle(m, v[1], v[3], v[2]);
        }
    for (int j = 0; j <= cells; j++)
        for (int i = 0; i <= cells; i++) {
            const int alpha = tc_leaf_alpha(leaf, i, j, cells);
            if (i == 0 || j == 0 || i == cells || j == cells)
                add_touch(m, (touch){vertex(m->l, b.chart, x0 + i * step, y0 + j * step), level, alpha});
            else
                assert_true(alpha < 0);
        }
    for (int side = 0; side < TC_SIDES; side++) {
        if (!(leaf->sides & 1 << side))
            continue;
        assert_false(leaf->coarse);
        m->closers++;
        const bool column = side == TC_WEST || side == TC_EAST;
        const int64_t x = x0 + (side == TC_EAST) * cells * step, y = y0 + (side == TC_NORTH) * cells * step;
        for (int k = 0; k + 2 <= cells; k += 2) {
            uint64_t v[3];
            for (int i = 0; i < 3; i++)
                v[i] = vertex(m->l, b.chart, column ? x : x + (k + i) * step, column ? y + (k + i) * step : y);
            add_triangle(m, v[0], v[1], v[2]);
        }
    }
}

static int by_ends(const void *a, const void *b)
{
    const uint64_t *p = a, *q = b;
    return p[0] != q[0] ? (p[0] < q[0] ? -1 : 1) : p[1] != q[1] ? (p[1] < q[1] ? -1 : 1) : 0;
}

/* Edges that are not there twice. */
static size_t open_edges(mesh *m)
{
    size_t open = 0;
    qsort(m->edge, m->edges, sizeof *m->edge, by_ends);
    for (size_t k = 0, run; k < m->edges; k += run) {
        for (run = 1; k + run < m->edges && by_ends(m->edge[k], m->edge[k + run]) == 0; run++)
            ;
        open += run != 2;
    }
    return open;
}

static int by_vertex(const void *a, const void *b)
{
    const touch *p = a, *q = b;
    return p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

/* Vertices on edges of leaves of which these do not all say the same: where levels meet, the finer ones that it is the
 * coarser mesh's, and the coarser one that it is as it is; where they do not, nothing, or all that it lies on an edge
 * of a coarser mesh. */
static size_t unmet(mesh *m)
{
    size_t wrong = 0;
    qsort(m->touch, m->touches, sizeof *m->touch, by_vertex);
    for (size_t k = 0, run; k < m->touches; k += run) {
        int lo = m->touch[k].level, hi = lo;
        for (run = 1; k + run < m->touches && m->touch[k + run].vertex == m->touch[k].vertex; run++) {
            lo = m->touch[k + run].level < lo ? m->touch[k + run].level : lo;
            hi = m->touch[k + run].level > hi ? m->touch[k + run].level : hi;
        }
        wrong += hi - lo > 1;
        for (size_t i = k; i < k + run; i++)
            wrong += lo == hi ? m->touch[i].alpha != m->touch[k].alpha || m->touch[i].alpha == 0
                              : m->touch[i].alpha != (m->touch[i].level == hi);
    }
    return wrong;
}

static void free_mesh(mesh *m)
{
    free(m->edge), free(m->touch);
}

static tc_block_tree tree;

static mesh mesh_of(const tc_block_lattice *l, asking *a)
{
    const tc_block_rule rule = {wanted, held, a};
    tc_block_tree_make(&tree, l, &rule);
    mesh m = {.l = l, .tree = &tree};
    tc_block_leaves(&tree, add_leaf, &m);
    return m;
}

static double uniform(uint64_t seed, uint64_t n)
{
    return (double)(tc_hash64(seed, n) >> 11) / 9007199254740992.0;
}

static void meshes_are_closed(void **state)
{
    (void)state;
    int coarse = 0, closers = 0, finest = 0;
    for (int k = 0; k < KINDS; k++) {
        tc_chart chart[MOST_FACES];
        tc_block_lattice l;
        lattice_of(&kinds[k], chart, &l);
        for (uint64_t seed = 0; seed < 60; seed++) {
            asking a = {.chart = chart, .seed = seed, .missing = seed % 3 == 2 ? (int)(seed % 5) : 0};
            double x = uniform(seed, 1), y = uniform(seed, 2);
            x = seed % 4 == 1 ? rint(x) : x, y = seed % 8 < 3 ? rint(y) : y; /* also on sides and corners */
            normal_at(&chart[seed % (uint64_t)kinds[k].faces], x, y, a.n);
            a.reach = 1 + 2.5 * uniform(seed, 3);
            mesh m = mesh_of(&l, &a);
            assert_int_equal(open_edges(&m), 0);
            assert_int_equal(unmet(&m), 0);
            coarse += m.coarse, closers += m.closers, finest = m.finest > finest ? m.finest : finest;
            free_mesh(&m);
        }
    }
    assert_true(coarse > 500 && closers > 2000 && finest == LEVELS);
}

/* The test sees what is not closed. */
static void open_meshes_are_found(void **state)
{
    (void)state;
    tc_chart chart[MOST_FACES];
    tc_block_lattice l;
    lattice_of(&kinds[0], chart, &l);
    asking a = {.chart = chart, .reach = 2};
    normal_at(&chart[0], 0.3, 0, a.n);
    mesh m = mesh_of(&l, &a);
    m.edges -= 3; /* one triangle less */
    assert_int_equal(open_edges(&m), 3);
    free_mesh(&m);
    l.seam[1][TC_SOUTH].dx++; /* a seam that says something else: trees of neighbours no longer meet */
    m = mesh_of(&l, &a);
    assert_true(open_edges(&m) > 0);
    free_mesh(&m);
}

/* A leaf at a place is one of those that were told, and no coarser than it is asked for, where all is held. */
static void leaves_are_found(void **state)
{
    (void)state;
    tc_chart chart[MOST_FACES];
    tc_block_lattice l;
    lattice_of(&kinds[1], chart, &l);
    asking a = {.chart = chart, .reach = 2.5};
    normal_at(&chart[2], 0.9, 0.1, a.n);
    mesh m = mesh_of(&l, &a);
    free_mesh(&m);
    for (uint64_t n = 0; n < 20000; n++) {
        int c = (int)(n % 6);
        double x = uniform(n, 1) * CELLS, y = uniform(n, 2) * CELLS;
        tc_leaf leaf = tc_block_leaf_at(&tree, c, x, y);
        const tc_block b = leaf.block;
        const double side = ldexp(l.side[b.level - 1], LEVELS - b.level);
        assert_true(x >= b.x * side && x <= (b.x + 1) * side && y >= b.y * side && y <= (b.y + 1) * side);
        assert_int_equal(leaf.forced, 0);
        tc_block finer = {c, b.level + 1, 0, 0};
        if (b.level == LEVELS)
            continue;
        finer.x = (int32_t)(x / (double)CELLS * l.blocks[b.level][0]),
        finer.y = (int32_t)(y / (double)CELLS * l.blocks[b.level][0]);
        assert_false(wanted(&a, finer));
    }
}

static void lattices_are_refused(void **state)
{
    (void)state;
    tc_chart chart[MOST_FACES];
    tc_block_lattice l;
    lattice_of(&kinds[0], chart, &l);
    assert_false(tc_block_lattice_set(&l, chart, 4, 17 * 64, 17 * 64, 7, 16)); /* 17 cells at the coarsest level */
    assert_false(tc_block_lattice_set(&l, chart, 4, 800, 800, 2, 2));          /* 200 blocks */
    assert_false(tc_block_lattice_set(&l, chart, 4, 96, 96, 7, 8));            /* not so often */
    assert_true(tc_block_lattice_set(&l, chart, 4, 176, 176, 2, 16));
    assert_int_equal(l.side[0], 8); /* 88 = 11 x 8 */
    assert_int_equal(l.side[1], 16);
    assert_int_equal(l.blocks[0][0], 11);
    assert_int_equal(l.blocks[1][0], 11);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_closed),
        cmocka_unit_test(open_meshes_are_found),
        cmocka_unit_test(leaves_are_found),
        cmocka_unit_test(lattices_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
