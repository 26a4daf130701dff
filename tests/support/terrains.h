/* terrains.h - terrains for tests, made in memory. */
#ifndef TERRAINS_H
#define TERRAINS_H

#include "common/terraclip.h"

typedef enum terrain_kind {
    TERRAIN_CLIFF,   /* full-range checkerboard of blocks and single samples: every cell a wall */
    TERRAIN_SMOOTH,  /* a few broad hills */
    TERRAIN_DEFAULT, /* what `terraclip synth --kind planar` makes */
    TERRAIN_SLOPE    /* a plane, z = 0.25 x + 0.5 y: every filter must leave it alone */
} terrain_kind;

/* The same numbers for the same seed everywhere. */
typedef struct test_random {
    uint64_t state;
} test_random;
uint64_t test_random_bits(test_random *r);
double test_random_unit(test_random *r); /* 0 <= u < 1 */
double test_random_range(test_random *r, double lo, double hi);
int64_t test_random_int(test_random *r, int64_t lo, int64_t hi); /* lo <= i <= hi */

/* A grid to hand to tc_field_build; ends the program when there is no memory. Default terrains are kept (kept.h). */
tc_grid terrain_grid(terrain_kind kind, int64_t width, int64_t height, double spacing, uint64_t seed);
tc_field *terrain_field(terrain_kind kind, int64_t width, int64_t height, double spacing, uint64_t seed);

/* The field, which it takes over, with so many levels finer than its data, fitted to it; 0: as it is. */
tc_field *terrain_synthesised(tc_field *field, int levels);

#endif
