/* synthesis_rehearsal.h - samples of two neighbouring levels of a terrain, to learn from; and level m synthesised from
 * m - 1 in their places, to compare with what is there. */
#ifndef TC_SYNTHESIS_REHEARSAL_H
#define TC_SYNTHESIS_REHEARSAL_H

#include "common/base/rect.h"
#include "synthesis_level.h"

#define TC_SLOPE_FLOOR 1e-5f /* of squares of slopes: a third of a percent */

/* A cell of the coarser level. */
typedef struct tc_pair_cell {
    float energy, slope; /* log2 E and log2 S there (tc_local_energy()) */
    float detail;        /* square metres: sum of its three details' squares */
} tc_pair_cell;

enum {
    TC_PAIR_BLOCKS = 48,
    TC_PAIR_SIDE = 32,                                        /* cells along a side of a block */
    TC_PAIR_REACH = TC_ENERGY_REACH + TC_AMPLITUDE_REACH + 1, /* samples of its level around one */
    TC_PAIR_LIFT = 6                                          /* samples of the finer level around what is lifted */
};

typedef struct tc_pair {
    int coarse; /* level; the finer one is the next */
    int blocks;
    tc_rect block[TC_PAIR_BLOCKS]; /* cells */
    int64_t cells;                 /* of them, those that are neither flat nor void */
    tc_pair_cell *cell;
    double energy; /* sum of detail */
    float floor;   /* square metres, added to energies */
} tc_pair;

/* What of the finer level the details of a block take. */
static inline tc_rect tc_pair_fine(tc_rect block)
{
    return tc_rect_grown((tc_rect){2 * block.x0, 2 * block.y0, 2 * block.x1, 2 * block.y1}, TC_PAIR_LIFT);
}

/* Reads blocks of level `coarse` and of the next finer one, spread evenly; of the finest level alone, whose cells have
 * no detail yet. floor: 0: a thousandth of the mean energy. The pair is the caller's to free, also on failure. */
tc_status tc_pair_read(const tc_field *field, int coarse, float floor, tc_pair *pair_ret);
void tc_pair_free(tc_pair *pair);

/* Details of w x h cells, band by band, from fine heights that reach TC_PAIR_LIFT beyond. work: 3 times as many floats
 * as there are of these. */
void tc_true_details(const float *fine, int64_t w, int64_t h, float *const band[TC_DETAIL_BANDS], float *work);

/* Whether a void is so near the cell from voids[0] on that it has to do with its energy or its details. */
bool tc_near_void(const uint8_t *voids, int64_t stride);

/* Sets what of the fit is settled by rehearsal; log2 A^2 = a + b log2 E + c log2 S is the regression of the pair. */
tc_status tc_synthesis_rehearse(const tc_field *field, const tc_pair *pair, double a, double b, double c,
                                tc_synthesis_fit *fit);

#endif
