/* test_block_errors.c - alphas of corners by a tolerance suit the tree of blocks that they ask for: over a plane that
 * ends between blocks, an octahedron and a cube, with errors made up, from any eye. No field, no surface. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/hash.h"
#include "common/blocks/block_errors.h"
#include "tests/support/terrains.h"

enum { LEVELS = 5, COARSEST = 24, BLOCK = 8, TILES = 64, MOST_CHARTS = 6, KINDS = 3 };

/* A ground whose errors and heights are those of the tiles of its finest cells: a level's are at least the next finer
 * one's, a larger rectangle's at least a smaller one's. Lengths are in the body's radii, or the plane's sides. */
typedef struct ground {
    const char *name;
    const tc_chart_class *class; /* NULL: a plane */
    int charts;
    tc_chart chart[MOST_CHARTS];
    tc_block_lattice lattice;
    double diagonal[LEVELS], eye[3], height; /* the eye on the plane, or its direction; above z = 0 */
    float error[LEVELS][MOST_CHARTS][TILES][TILES], lo[MOST_CHARTS][TILES][TILES], hi[MOST_CHARTS][TILES][TILES];
} ground;
static ground grounds[KINDS] = {{.name = "plane", .charts = 1},
                                {.name = "hex", .class = &tc_chart_hex, .charts = 4},
                                {.name = "cube", .class = &tc_chart_cube, .charts = 6}};

static int64_t cells_across(const ground *g)
{
    const int64_t *cells = g->lattice.cells[LEVELS - 1];
    return cells[0] > cells[1] ? cells[0] : cells[1];
}

static tc_range range_of(void *context, int chart, int level, tc_rect samples)
{
    const ground *g = context;
    const double tile = (double)cells_across(g) / TILES, cell = ldexp(1, LEVELS - level);
    tc_range r = {INFINITY, -INFINITY, 0, 0};
    const int x0 = (int)((double)samples.x0 * cell / tile), x1 = (int)ceil((double)samples.x1 * cell / tile),
              y0 = (int)((double)samples.y0 * cell / tile), y1 = (int)ceil((double)samples.y1 * cell / tile);
    assert_true(x0 < x1 && y0 < y1);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const int i = x < TILES ? x : TILES - 1, j = y < TILES ? y : TILES - 1;
            r.error = fmaxf(r.error, g->error[level - 1][chart][j][i]);
            r.lo = fminf(r.lo, g->lo[chart][j][i]), r.hi = fmaxf(r.hi, g->hi[chart][j][i]);
        }
    return r;
}

/* Where sample (x, y) of a level is. */
static void place_of(const ground *g, int chart, int level, double x, double y, double p[3])
{
    const int64_t *cells = g->lattice.cells[LEVELS - 1];
    const double cell = ldexp(1, LEVELS - level), u = fmin(x * cell, (double)cells[0]) / (double)cells_across(g),
                 v = fmin(y * cell, (double)cells[1]) / (double)cells_across(g);
    if (g->class)
        g->class->normal(&g->chart[chart], u, v, p);
    else
        p[0] = u, p[1] = v, p[2] = 0;
}

static double apart(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void distance_of(void *context, int chart, int level, double x, double y, double lo, double hi, double *across,
                        double *up)
{
    const ground *g = context;
    const double z = fmin(fmax(g->height, lo), hi);
    double p[3];
    place_of(g, chart, level, x, y, p);
    *across = apart(p, g->eye) * (g->class ? sqrt((1 + g->height) * (1 + z)) : 1);
    *up = fabs(g->height - z);
}

/* ---- Grounds ---------------------------------------------------------------------------------------------------- */

static void corner_place(const ground *g, tc_block b, int k, double p[3])
{
    const int side = g->lattice.side[b.level - 1];
    place_of(g, b.chart, b.level, (double)(b.x + (k & 1)) * side, (double)(b.y + (k >> 1)) * side, p);
}

static void set_lattice(ground *g, test_random *r)
{
    if (g->class) {
        const int64_t cells = COARSEST << (LEVELS - 1);
        for (int face = 0; face < g->charts; face++) {
            g->chart[face] = (tc_chart){.class = g->class, .face = face};
            for (int side = 0; side < TC_SIDES; side++)
                g->chart[face].side[side] = g->class->seam(face, side, cells);
        }
        assert_true(tc_block_lattice_set(&g->lattice, g->chart, g->charts, cells, cells, LEVELS, BLOCK));
    } else {
        int64_t cells[LEVELS][2];
        for (int a = 0; a < 2; a++) {
            cells[LEVELS - 1][a] = 2 * test_random_int(r, 30, COARSEST << (LEVELS - 2));
            for (int k = LEVELS - 2; k >= 0; k--) /* even, and as far as the finer level at least */
                cells[k][a] = 2 * ((cells[k + 1][a] + 3) / 4);
        }
        assert_true(tc_block_lattice_cut(&g->lattice, LEVELS, (const int64_t(*)[2])cells, BLOCK));
    }
    for (int level = 1; level <= LEVELS; level++) {
        double most = 0, p[4][3];
        for (int32_t n = g->lattice.blocks[level - 1][0] * g->lattice.blocks[level - 1][1] - 1; n >= 0; n--) {
            const int32_t across = g->lattice.blocks[level - 1][0];
            for (int k = 0; k < 4; k++)
                corner_place(g, (tc_block){0, level, n % across, n / across}, k, p[k]);
            most = fmax(most, fmax(apart(p[0], p[3]), apart(p[1], p[2])));
        }
        g->diagonal[level - 1] = most * 1.3; /* heights are below 0.3 */
    }
}

/* Rough and smooth tiles, some without any error; `unknown`: of some nothing is known. */
static void set_errors(ground *g, test_random *r, bool unknown)
{
    memset(g->error, 0, sizeof g->error);
    const double relief = pow(10, test_random_range(r, -4, -1)), falls = test_random_range(r, 0.2, 0.9),
                 flat = test_random_range(r, 0, 0.5);
    for (int chart = 0; chart < g->charts; chart++)
        for (int k = 0; k < TILES * TILES; k++) {
            const int i = k % TILES, j = k / TILES;
            const double rough = test_random_unit(r) < flat ? 0 : relief * pow(10, test_random_range(r, -2, 0));
            g->lo[chart][j][i] = (float)test_random_range(r, 0, relief);
            g->hi[chart][j][i] = g->lo[chart][j][i] + (float)test_random_range(r, 0, relief);
            float error = 0;
            for (int level = LEVELS; level >= 1; level--) { /* of the coarser level, as tc_range has it */
                error = fmaxf(error, (float)(rough * pow(falls, level) * test_random_unit(r)));
                error = unknown && test_random_unit(r) < 1e-3 ? INFINITY : error;
                g->error[level - 1][chart][j][i] = error;
            }
        }
}

/* Anywhere, many on corners of charts and blocks, low and high. */
static void set_eye(ground *g, test_random *r)
{
    const int level = (int)test_random_int(r, 1, LEVELS), chart = (int)test_random_int(r, 0, g->charts - 1);
    const int64_t *cells = g->lattice.cells[level - 1];
    double at[2];
    for (int a = 0; a < 2; a++) {
        at[a] = test_random_unit(r) * (double)cells[a];
        if (test_random_unit(r) < 0.3)
            at[a] = test_random_bits(r) & 1 ? rint(at[a] / BLOCK) * BLOCK
                                            : rint(at[a] / (double)cells[a]) * (double)cells[a];
    }
    place_of(g, chart, level, at[0], at[1], g->eye);
    if (!g->class && test_random_unit(r) < 0.2)
        g->eye[0] += test_random_range(r, -1, 1), g->eye[1] += test_random_range(r, -1, 1);
    g->height = pow(10, test_random_range(r, -6, 0.5)) - 1e-6;
}

/* ---- Trees ------------------------------------------------------------------------------------------------------ */

typedef struct looking {
    ground *g;
    tc_block_errors *errors;
    int64_t leaves[LEVELS], coarse, between, met, finer;
} looking;

static bool wanted(void *context, tc_block b)
{
    return tc_block_errors_want(((looking *)context)->errors, b);
}

static bool held(void *context, tc_block b)
{
    (void)context, (void)b;
    return true;
}

static double alpha_of(const looking *l, tc_block b, int k)
{
    return tc_block_errors_alpha(l->errors, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1));
}

/* A leaf's corners have the alpha that the meshes around them ask for, without being told. */
static void check_leaf(void *context, const tc_leaf *leaf)
{
    looking *l = context;
    const tc_block b = leaf->block;
    assert_int_equal(leaf->forced, 0);
    l->leaves[b.level - 1]++, l->coarse += leaf->coarse;
    const tc_leaf above = leaf->coarse ? tc_block_leaf_above(&l->g->lattice, leaf) : *leaf;
    for (int k = 0; k < 4; k++) {
        if (leaf->coarse) {
            if (above.block.level > 1)
                assert_true(alpha_of(l, above.block, k) == 0);
            continue;
        }
        if (b.level == 1) /* there is none coarser */
            continue;
        const double alpha = alpha_of(l, b, k);
        assert_true(alpha >= 0 && alpha <= 1);
        if (leaf->corners & 1 << k)
            assert_true(alpha == 1), l->met++;
        if (leaf->finer_corners & 1 << k)
            assert_true(alpha == 0), l->finer++;
        l->between += alpha > 0 && alpha < 1;
    }
}

/* Whether two places are the same. */
static bool same_place(const ground *g, tc_block a, int k, tc_block b, int i)
{
    double p[3], q[3];
    corner_place(g, a, k, p), corner_place(g, b, i, q);
    return apart(p, q) < 1e-9;
}

/* A corner has one alpha, whichever of the blocks around it asks, and whatever was asked before. */
static int check_corner(const looking *l, tc_block_errors *fresh, test_random *r)
{
    const tc_block_lattice *lattice = &l->g->lattice;
    tc_block b = {(int)test_random_int(r, 0, l->g->charts - 1), (int)test_random_int(r, 2, LEVELS), 0, 0}, near[8];
    const int32_t *blocks = lattice->blocks[b.level - 1];
    b.x = (int32_t)test_random_int(r, 0, blocks[0] - 1), b.y = (int32_t)test_random_int(r, 0, blocks[1] - 1);
    if (test_random_bits(r) & 1)
        b.x = test_random_bits(r) & 1 ? 0 : blocks[0] - 1;
    if (test_random_bits(r) & 1)
        b.y = test_random_bits(r) & 1 ? 0 : blocks[1] - 1;
    const int k = (int)test_random_int(r, 0, 3);
    const float alpha = (float)alpha_of(l, b, k);
    assert_true((float)tc_block_errors_alpha(fresh, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1)) == alpha);
    int across = 0;
    for (int n = tc_block_touching(lattice, b.chart, b.level, b.x + (k & 1), b.y + (k >> 1), near) - 1; n >= 0; n--) {
        int same = 0;
        for (int i = 0; i < 4; i++)
            if (same_place(l->g, b, k, near[n], i)) {
                assert_true((float)alpha_of(l, near[n], i) == alpha);
                same++;
            }
        assert_int_equal(same, 1);
        across += near[n].chart != b.chart;
    }
    return across;
}

static tc_block_tree tree;

static tc_block_errors *no_errors(void)
{
    tc_block_errors *e = calloc(1, sizeof *e);
    if (!e)
        exit(99);
    return e;
}

static void corners_suit_the_trees_they_ask_for(void **state)
{
    (void)state;
    enum { GROUNDS = 8, EYES = 8, CORNERS = 100 };
    for (int kind = 0; kind < KINDS; kind++) {
        ground *g = &grounds[kind];
        test_random r = {5 + (uint64_t)kind};
        looking l = {.g = g};
        int across = 0, split = 0;
        for (int n = 0; n < GROUNDS; n++) {
            set_lattice(g, &r);
            set_errors(g, &r, n % 4 == 3);
            l.errors = no_errors();
            for (int eye = 0; eye < EYES; eye++) {
                const tc_block_rule rule = {wanted, held, &l};
                tc_block_errors *fresh = no_errors();
                tc_block_ground to = {
                    .lattice = &g->lattice, .data = LEVELS, .range = range_of, .distance = distance_of, .context = g};
                memcpy(to.diagonal, g->diagonal, sizeof g->diagonal);
                set_eye(g, &r);
                const double tolerance = pow(10, test_random_range(&r, -4, -0.5));
                tc_block_errors_begin(l.errors, &to, tolerance);
                tc_block_errors_begin(fresh, &to, tolerance);
                tc_block_tree_make(&tree, &g->lattice, &rule);
                const int64_t coarsest = l.leaves[0];
                tc_block_leaves(&tree, check_leaf, &l);
                split +=
                    l.leaves[0] - coarsest < (int64_t)g->charts * g->lattice.blocks[0][0] * g->lattice.blocks[0][1];
                for (int k = 0; k < CORNERS; k++)
                    across += check_corner(&l, fresh, &r);
                free(fresh);
            }
            free(l.errors);
        }
        int64_t leaves = 0;
        for (int k = 0; k < LEVELS; k++)
            leaves += l.leaves[k], assert_true(l.leaves[k] > 10);
        printf("%s: %lld leaves of %d trees, %lld by the coarser mesh; of corners %lld between meshes, %lld at coarser "
               "ones, %lld at finer ones; %d alphas told across seams\n",
               g->name, (long long)leaves, GROUNDS * EYES, (long long)l.coarse, (long long)l.between, (long long)l.met,
               (long long)l.finer, across);
        assert_true(split > GROUNDS * EYES / 4 && l.coarse > 100 && l.between > 100 && l.met > 100 && l.finer > 100);
        assert_true(g->class ? across > 1000 : across == 0);
    }
}

/* Diagonals that are told shorter than they are leave too little room for passing over. */
static void too_short_diagonals_are_found(void **state)
{
    (void)state;
    ground *g = &grounds[0];
    test_random r = {9};
    int wrong = 0;
    for (int n = 0; n < 60; n++) {
        tc_block_errors *errors = no_errors();
        looking l = {.g = g, .errors = errors};
        const tc_block_rule rule = {wanted, held, &l};
        set_lattice(g, &r), set_errors(g, &r, false), set_eye(g, &r);
        tc_block_ground to = {
            .lattice = &g->lattice, .data = LEVELS, .range = range_of, .distance = distance_of, .context = g};
        for (int k = 0; k < LEVELS; k++)
            to.diagonal[k] = 0.05 * g->diagonal[k];
        tc_block_errors_begin(errors, &to, pow(10, test_random_range(&r, -3, -0.5)));
        tc_block_tree_make(&tree, &g->lattice, &rule);
        for (int level = 2; level < LEVELS; level++)
            for (int32_t k = g->lattice.blocks[level - 1][0] * g->lattice.blocks[level - 1][1] - 1; k >= 0; k--) {
                const int32_t x = k % g->lattice.blocks[level - 1][0], y = k / g->lattice.blocks[level - 1][0];
                const tc_block finer = {0, level + 1, 2 * x, 2 * y};
                for (int c = 0; c < 4 && tc_block_errors_want(errors, finer); c++)
                    wrong += alpha_of(&l, (tc_block){0, level, x, y}, c) > 0;
            }
        free(errors);
    }
    printf("diagonals told too short: %d corners below finer blocks pass over\n", wrong);
    assert_true(wrong > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_suit_the_trees_they_ask_for),
        cmocka_unit_test(too_short_diagonals_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
