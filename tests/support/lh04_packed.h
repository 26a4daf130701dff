/* lh04_packed.h - a whole terrain packed in memory as LH04 does it, as packed.h does with the lifting codec. */
#ifndef LH04_PACKED_H
#define LH04_PACKED_H

#include "packed.h"

typedef struct lh04_options {
    double q;           /* step in units */
    double finer;       /* factor of the step from a level to the next coarser one; 0: 1, as in the paper */
    double lambda;      /* as tc_lh04_options */
    int training_tiles; /* 0: a default */
    bool wrap_x;
} lh04_options;

/* Packs z (width x height). Ends the program on failure. packed_free() and packed_bytes() are for it too. */
packed lh04_new(const int32_t *z, int64_t width, int64_t height, const lh04_options *options);
/* Reads rect of a level, given its reconstructed coarser level; rect may stick out where the level wraps. */
tc_status lh04_read(const packed_level *l, const tc_plane *fine, tc_simd simd);

#endif
