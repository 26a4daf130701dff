/* lh04_packed.h - a whole terrain packed in memory as LH04 does it, as packed.h does with the lifting codec. */
#ifndef LH04_PACKED_H
#define LH04_PACKED_H

#include "common/core/codec/codec_lh04.h"

enum { LH04_LEVELS = 32 };

typedef struct lh04_level {
    tc_lh04_codec *codec;
    uint8_t *header;
    size_t header_size;
    uint8_t **tile; /* [ty * tiles_x + tx]; NULL: empty */
    size_t *tile_size;
    tc_plane coarse, fine; /* reconstructed; fine is the coarse one of the next level */
} lh04_level;

typedef struct lh04_packed {
    int levels;                    /* above the coarsest */
    lh04_level level[LH04_LEVELS]; /* 0: the finest */
    size_t coarsest_bytes;
} lh04_packed;

typedef struct lh04_options {
    double q;           /* step in units */
    double finer;       /* factor of the step from a level to the next coarser one; 0: 1, as in the paper */
    double lambda;      /* as tc_lh04_options */
    int training_tiles; /* 0: a default */
    bool wrap_x;
} lh04_options;

/* Packs z (width x height). Ends the program on failure. */
lh04_packed lh04_new(const int32_t *z, int64_t width, int64_t height, const lh04_options *options);
void lh04_free(lh04_packed *p);

/* All bytes that a file would need for the streams, counted as packed_bytes() does. */
size_t lh04_bytes(const lh04_packed *p);

/* Reads rect of a level, given its reconstructed coarser level; rect may stick out where the level wraps. */
tc_status lh04_read(const lh04_level *l, const tc_plane *fine, tc_simd simd);

#endif
