/* block_errors.h - what a tolerance on the screen makes of blocks: how far their corners pass over into the coarser
 * level.
 *
 * A level's mesh is off the finest one's by no more than E_l over a block's ground (tc_range.error). At a distance d
 * the tolerance T, in pixels, allows a = T d / S metres, where S is tc_camera_pixel_scale(). At a corner of blocks of
 * level l
 *
 *     alpha_l = (a - start) / (end - start), 0 below and 1 above,
 *
 * and alpha is bilinear within a block. end is at least E_(l-1) of the blocks that touch the corner and start at least
 * E_l, so that what is drawn, (1 - alpha) of level l and alpha of the coarser one, is off by no more than a. alpha is
 * continuous in space, and as the eye moves: a height then changes by at most some 8 T / S of the way.
 *
 * Where level l + 1 is drawn, alpha_l has to be 0 on all that its blocks touch (blocks.h). So start lies as much
 * further out as a block of level l is wide: by M = T / S times its diagonal, and by as much again where the same has
 * pushed the finer level's end out. What asks for levels by this never asks for one whose surroundings are missing.
 *
 * No GL, no allocation. */
#ifndef TC_BLOCK_ERRORS_H
#define TC_BLOCK_ERRORS_H

#include "blocks.h"

/* Blocks' bounds are of the ground that they cover; of which field they come, and where the eye is, is a caller's
 * affair. */
typedef struct tc_block_ground {
    const tc_block_lattice *lattice;
    int data; /* levels whose range is known: the lattice's, and one more where it ends before the terrain's finest one
               */
    double diagonal[TC_BLOCK_LEVELS]; /* [level - 1]: the longest of a block's, metres */
    /* Bounds of samples of a level (counted from its chart's first): heights, step and error. */
    tc_range (*range)(void *context, int chart, int level, tc_rect samples);
    /* How far from the eye sample (x, y) of a level is, metres: across, and up or down, if its height is the nearest
     * one of lo .. hi. */
    void (*distance)(void *context, int chart, int level, double x, double y, double lo, double hi, double *across_ret,
                     double *apart_ret);
    void *context;
} tc_block_ground;

enum { TC_ERROR_ROOM = 64 }; /* places of a level and chart along a side, a power of two */

/* What is known of a level, at [y mod TC_ERROR_ROOM][x mod TC_ERROR_ROOM]: of the last one that was looked up there,
 * whose x + 1 and y + 1 are told. */
typedef struct tc_level_errors {
    struct {
        int32_t x, y;
        uint32_t view;          /* for which it holds, where an error is not known so far; 0: for all */
        float error[3], lo, hi; /* E of the coarser, the own and the finer level; heights, metres */
    } block[TC_ERROR_ROOM][TC_ERROR_ROOM];
    struct {
        int32_t x, y;
        uint32_t view;
        float alpha;
    } corner[TC_ERROR_ROOM][TC_ERROR_ROOM];
} tc_level_errors;

/* Memory of the caller's, zero at first, of which no more is touched than views need. Of one field and lattice: what is
 * known of blocks stays from view to view. */
typedef struct tc_block_errors {
    tc_block_ground ground;
    double tolerance; /* T / S: metres of error a metre of distance */
    uint32_t view;
    tc_level_errors level[TC_BLOCK_CHARTS][TC_BLOCK_LEVELS];
} tc_block_errors;

/* Begins a view. tolerance: above 0. */
void tc_block_errors_begin(tc_block_errors *errors, const tc_block_ground *ground, double tolerance);

/* alpha of a corner, counted in blocks of its chart. */
double tc_block_errors_alpha(tc_block_errors *errors, int chart, int level, int32_t x, int32_t y);

/* Whether any corner of a block, of level 2 or finer, has an alpha below 1. */
bool tc_block_errors_want(tc_block_errors *errors, tc_block block);

/* alpha at a place on a block, shares of its sides, by its corners'. */
static inline double tc_block_alpha_at(const float corner[4], double x, double y)
{
    return (1 - y) * ((1 - x) * (double)corner[0] + x * (double)corner[1]) +
           y * ((1 - x) * (double)corner[2] + x * (double)corner[3]);
}

/* Metres of error a metre of distance that a leaf's mesh is off by at most, with these alphas at its corners. */
double tc_block_errors_bound(tc_block_errors *errors, const tc_leaf *leaf, const float alpha[4]);

#endif
