/* synthesis_chain.h - heights of a synthesised level by way of the levels below it, down to the data's finest one. */
#ifndef TC_SYNTHESIS_CHAIN_H
#define TC_SYNTHESIS_CHAIN_H

#include "synthesis_kept.h"
#include "synthesis_level.h"

typedef struct tc_chain {
    const tc_field *base;   /* the data */
    const tc_level *levels; /* of all, [l - 1] */
    int data;               /* the data's finest one: m */
    bool wraps;
    tc_synthesis_fit fit;
    int chart;
    tc_synthesis_share share;
    float lowest, highest;
    tc_kept *kept; /* of levels that others were made from; NULL: nothing is */
    size_t room;   /* floats of scratch that it is given */
} tc_chain;

/* The part of a rectangle that lies within level m + k. */
tc_rect tc_chain_within(const tc_chain *c, int k, tc_rect rect);

/* What of the data's finest level heights of a rectangle of level m + k depend on, and what may be read for them; also
 * beyond its sides. */
tc_rect tc_chain_depends(const tc_chain *c, int k, tc_rect rect);
tc_rect tc_chain_reads(const tc_chain *c, int k, tc_rect rect);

/* Floats of scratch for that; and for any rectangle of at most side x side samples of levels m + 1 .. m + levels,
 * wherever it lies: which is the room that tc_chain_make() is to have. */
size_t tc_chain_scratch(const tc_chain *c, int k, tc_rect rect);
size_t tc_chain_room(int levels, int64_t side);

/* Writes heights of level m + k, k >= 1. TC_COMING only where it must not wait for the data. */
tc_ready tc_chain_make(const tc_chain *c, int k, tc_rect rect, float *z, ptrdiff_t stride, bool wait, float *scratch,
                       tc_status *status_ret);

/* Reads of the data's finest level. */
tc_ready tc_chain_read(const tc_chain *c, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride, bool wait,
                       tc_status *status_ret);

#endif
