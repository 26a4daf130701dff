/* void_mask.h - the packed form of one level's void mask, given the next coarser level's.
 *
 * A mask has a byte for every sample of a level: 1 where the source had no height, else 0. The coarser mask is the
 * finer one at even positions, so that only the other three quarters are coded. Tiles are those of codec.h: TC_TILE x
 * TC_TILE positions, that is twice as many samples either way; each decodes alone, given the coarser mask around it.
 * Most tiles are of one kind throughout and need no bytes but their class. Nothing here allocates, and all functions
 * are thread-safe.
 *
 * Contexts of coded and coarser samples as in JBIG (ITU-T T.82), which codes pictures progressively too; here they are
 * gathered to a score, as a logistic regression would, and the score chooses the adaptive model. */
#ifndef TC_VOID_MASK_H
#define TC_VOID_MASK_H

#include "common/codec/lifting/codec.h"

enum {
    TC_MASK_MARGIN = 2,                       /* positions of the coarser level that a tile looks at around itself */
    TC_MASK_BOUND = 3 * TC_TILE * TC_TILE / 8 /* bytes that a tile can take at most */
};

/* A mask over a rectangle: (x, y) is v[(y - rect.y0) * stride + (x - rect.x0)]. */
typedef struct tc_mask_plane {
    uint8_t *v;
    ptrdiff_t stride;
    tc_rect rect;
} tc_mask_plane;

/* Samples of tile (tx, ty) of a level, cut to it. shift moves them in x: where the level wraps, a window that sticks
 * out of it holds tiles of the other side moved by a multiple of its width. */
tc_rect tc_mask_tile_rect(const tc_lifting_level *level, int64_t tx, int64_t ty, int64_t shift);

/* Rectangle of the coarser level that coding a tile needs; beyond the sides where the level wraps. */
tc_rect tc_mask_tile_needs(const tc_lifting_level *level, tc_rect tile);

/* The next coarser mask over coarse->rect, whose samples' positions on the finer level `fine` holds. */
void tc_mask_downsample(const tc_mask_plane *fine, const tc_mask_plane *coarse);

typedef enum tc_mask_class { TC_MASK_VALID = 0, TC_MASK_VOID, TC_MASK_CODED } tc_mask_class;

/* The class of a tile: VALID or VOID where all samples of it are (then the coarser ones are too), else CODED. */
tc_mask_class tc_mask_classify(tc_rect tile, const tc_mask_plane *fine);

/* Encodes a tile (a rectangle that tc_mask_tile_rect() gave), of any class. `fine` covers it, `coarse` at least
 * tc_mask_tile_needs(). bytes: room for TC_MASK_BOUND. Bytes written, which can be none. */
size_t tc_mask_encode(const tc_lifting_level *level, tc_rect tile, const tc_mask_plane *coarse,
                      const tc_mask_plane *fine, uint8_t *bytes);

/* Decodes a tile from exactly its bytes, of which only CODED ones have any, into those samples that `fine` holds.
 * TC_ERR_FORMAT where the bytes are seen to be damaged; the samples that are not known from `coarse` are then made up,
 * as they are where damage goes unseen. */
tc_status tc_mask_decode(const tc_lifting_level *level, tc_rect tile, tc_mask_class class, const tc_mask_plane *coarse,
                         const uint8_t *bytes, size_t size, const tc_mask_plane *fine);

/* ---- Model (void_mask_model.c) --------------------------------------------------------------------------------- */

enum { TC_MASK_REACH = 3, TC_MASK_NEAR = 8, TC_MASK_FAR = 16, TC_MASK_BINS = 48 };

/* What the samples around one say about it, 1/32 of the logarithm of the odds that it is void: a term for all
 * combinations of the nearest ones, the first of which is the most significant bit, and terms of others that are
 * void. All are samples that a decoder knows: earlier ones of the tile in order of rows, and coarser ones. */
typedef struct tc_mask_model {
    struct {
        int8_t x, y;
    } near[TC_MASK_NEAR];
    int far_count;
    struct {
        int8_t x, y, score;
    } far[TC_MASK_FAR];
    int16_t score[1 << TC_MASK_NEAR];
} tc_mask_model;

/* Of samples at (2i + 1, 2j), (2i, 2j + 1), (2i + 1, 2j + 1). */
extern const tc_mask_model tc_mask_models[3];

/* Where the adaptive models of the upper half of the bins start: 2^22 times the probability of a valid sample in the
 * middle of the bin, bins being 16 units of score wide. */
extern const uint32_t tc_mask_start[TC_MASK_BINS / 2];

#endif
