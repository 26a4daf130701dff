/* blocks.h - which blocks of which levels a frame draws, over charts joined by seams: one rule for all metrics.
 *
 * Each level of a square chart is cut into blocks along lines fixed in the chart; blocks of the next finer level cut
 * those in four (or, where a level's blocks have fewer cells than the finer one's, cover just one). A frame has a tree
 * of them: all blocks of the coarsest level, and in place of a block, where a caller's rule wants it, those of the next
 * finer level on the same ground. The tree is closed by itself:
 *
 *   A block is split only where all blocks that touch it, also at corners and across seams, are there and drawn by
 *   their own level. So levels of neighbours differ by one, and a block that touches a finer one touches no coarser
 * one.
 *
 * Along an edge between two levels the finer one's vertices then are brought to the coarser mesh (alpha = 1), which
 * is as it is there (alpha = 0), and triangles without area close the T-junctions. Which vertices those are is told
 * with each leaf. Blocks that are there, and all of whose vertices are brought to the coarser mesh anyhow, are drawn by
 * that mesh: a quarter of the triangles, the same surface.
 *
 * A caller's rule sees places only; what a block is wanted for (a distance, an error) is its affair. No GL, no heights,
 * no allocation but in tc_block_lattice_create(). */
#ifndef TC_BLOCKS_H
#define TC_BLOCKS_H

#include "common/chart/chart.h"

enum {
    TC_BLOCK_CHARTS = 6,   /* at most */
    TC_BLOCK_LEVELS = 32,  /* likewise */
    TC_BLOCKS_ACROSS = 128 /* of a level and chart that can be in a tree, along a side */
};

/* How charts are cut: square ones, all of the same size, or a single one. Level 1 is the coarsest. */
typedef struct tc_block_lattice {
    int charts, levels;
    tc_seam seam[TC_BLOCK_CHARTS][TC_SIDES]; /* dx and dy are counted in whole sides */
    int64_t cells[TC_BLOCK_LEVELS][2];       /* [level - 1]: of a chart along x and y, even */
    int side[TC_BLOCK_LEVELS];               /* of a block, even; those next to a chart's end may be cut short */
    int32_t blocks[TC_BLOCK_LEVELS][2];      /* of a chart */
} tc_block_lattice;

/* A lattice over charts of `cells` cells a side, as their seams count them, whose finest level drawn has `finest` and
 * which has `levels`; blocks have `most` cells (a power of two) a side but for those of the coarsest levels, which may
 * have fewer. False where charts cannot be cut so: more than TC_BLOCKS_ACROSS blocks at the coarsest level, or an odd
 * number of cells. */
bool tc_block_lattice_set(tc_block_lattice *lattice, const tc_chart *chart, int charts, int64_t cells, int64_t finest,
                          int levels, int most);

/* A lattice over one chart without neighbours, of so many cells, even, at each level; a cell is two of the next finer
 * level, but beyond the end of that there are none. Blocks have `side` cells. False where there would be more than
 * TC_BLOCKS_ACROSS blocks at the coarsest level. */
bool tc_block_lattice_cut(tc_block_lattice *lattice, int levels, const int64_t (*cells)[2], int side);

/* Cells of a chart along a side at a level. */
static inline int64_t tc_block_cells(const tc_block_lattice *lattice, int level)
{
    return lattice->cells[level - 1][0];
}

typedef struct tc_block {
    int chart, level;
    int32_t x, y; /* blocks of the level from the chart's first */
} tc_block;

/* Blocks of the next finer level along a side of a whole one: 2, or 1. */
static inline int tc_block_parts(const tc_block_lattice *l, int level)
{
    return 2 * l->side[level - 1] / l->side[level];
}

/* Its cells. */
static inline tc_rect tc_block_rect(const tc_block_lattice *l, tc_block b)
{
    const int64_t side = l->side[b.level - 1], x = b.x * side, y = b.y * side;
    const int64_t *cells = l->cells[b.level - 1];
    return (tc_rect){x, y, x + side < cells[0] ? x + side : cells[0], y + side < cells[1] ? y + side : cells[1]};
}

/* Blocks of a level that touch a corner, counted in blocks of its chart, also those of other charts; returns how many.
 */
enum { TC_BLOCKS_TOUCHING = 8 };
int tc_block_touching(const tc_block_lattice *lattice, int chart, int level, int32_t x, int32_t y,
                      tc_block touching_ret[TC_BLOCKS_TOUCHING]);

/* A corner as the chart of the lowest number has it that has it. */
void tc_block_settle(const tc_block_lattice *lattice, int level, int *chart, int32_t *x, int32_t *y);

/* A caller's rule. Both are asked coarse to fine; a block of level 1 is wanted and held. */
typedef struct tc_block_rule {
    bool (*wanted)(void *context, tc_block block); /* to be drawn by its own level, at least */
    bool (*held)(void *context, tc_block block);   /* can be */
    void *context;
} tc_block_rule;

typedef struct tc_block_tree {
    const tc_block_lattice *lattice;
    struct {
        bool room;                                         /* else there are none, and what follows means nothing */
        int32_t x0, y0;                                    /* of the first block that has room */
        int32_t lo[2], hi[2];                              /* blocks that are there, half-open; lo > hi: none */
        uint8_t state[TC_BLOCKS_ACROSS][TC_BLOCKS_ACROSS]; /* [y - y0][x - x0] */
    } level[TC_BLOCK_CHARTS][TC_BLOCK_LEVELS];
} tc_block_tree;

/* Makes the tree anew. */
void tc_block_tree_make(tc_block_tree *tree, const tc_block_lattice *lattice, const tc_block_rule *rule);

/* Whether the tree's rule was asked for a block, of level 2 or finer, and wanted it: of a tree made from the same
 * wishes with less that is held, no more can be asked. */
bool tc_block_asked(const tc_block_tree *tree, tc_block block);

/* What is drawn in place of a block, and how its edges meet its neighbours'. Corners are numbered east + 2 north;
 * halves of a side by the corner that they begin at: from the one of the lower number 0, from the other 1. */
typedef struct tc_leaf {
    tc_block block;
    bool coarse;           /* drawn by the next coarser level's mesh: all alphas were 1 */
    uint8_t sides;         /* 1 << side: beyond it is a coarser mesh; */
    uint8_t corners;       /* 1 << corner: or at that corner: vertices there have alpha 1 */
    uint8_t finer_halves;  /* 1 << (2 side + half): beyond it is a finer mesh; */
    uint8_t finer_corners; /* 1 << corner: or at that corner: vertices there have alpha 0 */
    uint8_t forced;        /* corners: a block there is coarser than the rule wants it, since it is not held */
} tc_leaf;

/* Which alpha a leaf says of vertex (i, j) of its `cells` cells a side: 1, 0, or below 0: none. */
int tc_leaf_alpha(const tc_leaf *leaf, int64_t i, int64_t j, int64_t cells);

/* Calls for each leaf, finest levels first. */
void tc_block_leaves(const tc_block_tree *tree, void (*leaf)(void *context, const tc_leaf *leaf), void *context);

/* The leaf at a place of a chart, in finest cells from its first sample. */
tc_leaf tc_block_leaf_at(const tc_block_tree *tree, int chart, double x, double y);

/* The block that a leaf was split from, as a leaf that has no neighbours. */
tc_leaf tc_block_leaf_above(const tc_block_lattice *lattice, const tc_leaf *leaf);

/* Blocks of a level and chart that are drawn by it, by their bounds; false: none. A split one counts. */
bool tc_block_bounds(const tc_block_tree *tree, int chart, int level, tc_rect *blocks_ret);

#endif
