/* codec_lh04.h - the pyramid of residuals of LH04 (Losasso, Hoppe 2004, sections 6 and 7), to compare.
 *
 * Level after level, coarse to fine: the residual of all samples of the fine level against U of the reconstructed
 * coarser level. (The four-point subdivision of Kobbelt 1996 in integers, first down the columns, then along the rows,
 * (9 (b + c) - (a + d) + 8) >> 4, rounding down; borders go on in a straight line: exactly tc_lifting_synthesise() of
 * zero details.) The paper codes the residual with PTC (Malvar 2000), a lapped block transform with adaptive run
 * codes; here a lapped orthogonal transform of 8 x 8 blocks takes its place (a plain DCT needs 4 to 15 % more), with an
 * entropy coder as strong as that of codec.h.
 *
 * Tiles are those of codec.h: TC_TILE x TC_TILE positions, twice as many samples either way. A tile's residual depends
 * on its bytes and the model only; a tile without a coded coefficient takes no bytes. Everything that a decoder does is
 * integers; nothing here but the training allocates, and all functions are thread-safe. */
#ifndef TC_CODEC_LH04_H
#define TC_CODEC_LH04_H

#include "common/codec/lifting/codec.h"

enum {
    TC_LH04_SIDE = 8, /* samples of a block */
    TC_LH04_BANDS = TC_LH04_SIDE * TC_LH04_SIDE,
    TC_LH04_SPAN = 2 * TC_TILE,                   /* samples of a tile */
    TC_LH04_BLOCKS = TC_LH04_SPAN / TC_LH04_SIDE, /* blocks of a tile, either way */
    TC_LH04_CLASSES = 4,                          /* of frequencies */
    TC_LH04_SCALE = 9,
    TC_LH04_FLAGS = 12,
    TC_LH04_MEANS = 57
};

/* What is known of a level's residual. Index of a frequency: 8 v + u, u horizontal. */
typedef struct tc_lh04_model {
    int32_t step; /* in height units, 1 to TC_MAX_STEP; that of an orthonormal transform */
    bool own_weights, own_symbols;
    uint8_t mean[TC_LH04_BANDS];                                /* mean magnitude of each frequency: 2^(code/4 - 8) */
    uint16_t weight[TC_LH04_CLASSES][TC_PHASES][TC_LH04_SCALE]; /* in 1/1024; codec_lh04_tile.h */
    uint8_t empty[TC_LH04_FLAGS];                               /* how likely a tile lacks a frequency, in 1/256; 1.. */
    tc_rans_frequencies symbols[TC_BINS];
} tc_lh04_model;

/* The built-in model, for any step. */
void tc_lh04_model_builtin(int32_t step, tc_lh04_model *model);

/* A level's header. Writing rounds weights and symbols to what a header can carry, so the encoder must go on with the
 * model that it reads back (tc_lh04_train() does). Reading gives TC_ERR_FORMAT for bytes that make no model. */
size_t tc_lh04_model_bound(void);
size_t tc_lh04_model_write(const tc_lh04_model *model, uint8_t *bytes);
tc_status tc_lh04_model_read(const uint8_t *bytes, size_t size, tc_lh04_model *model);

/* How one frequency is coded after others: what its contexts are made of. */
typedef struct tc_lh04_band {
    uint8_t index; /* 8 v + u */
    uint8_t nears, fars;
    uint8_t near[4], far[8];                  /* places in the order of coding of frequencies beside it, coded before */
    uint8_t class, flag;                      /* flag: 3 * class of the mean */
    int32_t weight[TC_PHASES][TC_LH04_SCALE]; /* in 1/4096 of a step for each unit of a feature */
    int32_t ratio[TC_LH04_SCALE];             /* of means, in 1/4096: what weight is, where the model's is 1 */
} tc_lh04_band;

/* A level's geometry, model and decoding tables. */
typedef struct tc_lh04_codec {
    tc_lifting_level level;
    int64_t tiles_x, tiles_y; /* tiles */
    tc_lh04_model model;
    tc_lh04_band band[TC_LH04_BANDS]; /* in the order of coding */
    tc_rans_table table[TC_BINS];
} tc_lh04_codec;

void tc_lh04_init(tc_lh04_codec *codec, const tc_lifting_level *level, const tc_lh04_model *model);

/* Memory for coding one tile; holds nothing between calls. */
typedef struct tc_lh04_work tc_lh04_work;
size_t tc_lh04_work_bytes(void);

/* Samples of tile (tx, ty), moved by shift in x: a multiple of the width where the level wraps. */
tc_rect tc_lh04_tile_rect(const tc_lh04_codec *codec, int64_t tx, int64_t ty, int64_t shift);

/* Rectangle of the coarser level that U of a rectangle of samples needs; beyond the sides where the level wraps. */
tc_rect tc_lh04_needs(const tc_lifting_level *level, tc_rect rect);

/* Decodes one tile from exactly its bytes (size 0: the empty tile) into those of its samples that `residual` holds.
 * TC_ERR_FORMAT where the bytes are damaged; the samples are then as if the tile were empty, that is zero. */
tc_status tc_lh04_decode_tile(const tc_lh04_codec *codec, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes,
                              size_t size, const tc_plane *residual, tc_lh04_work *work, tc_simd simd);

/* fine = U(coarse) + residual over fine->rect, which lies within the level, or beyond its sides where it wraps. coarse
 * covers at least tc_lh04_needs(), residual (NULL: zero) at least fine->rect; residual may be fine itself. */
void tc_lh04_assemble(const tc_lifting_level *level, const tc_plane *coarse, const tc_plane *residual,
                      const tc_plane *fine);

/* ---- Encoding ------------------------------------------------------------------------------------------------ */

/* Counts for building tables. */
typedef struct tc_lh04_counts {
    uint64_t of[TC_BINS][TC_RANS_SYMBOLS], flag[TC_LH04_FLAGS][2];
} tc_lh04_counts;

/* Squared error that a bit is worth, in squared steps: at equal rms of the finest level, the best or within 1 % of it
 * on every terrain tried. More than TC_DEFAULT_LAMBDA, because finer levels mend what coarser ones leave. */
#define TC_LH04_LAMBDA 0.14

/* Options of the encoder; zero is the default. */
typedef struct tc_lh04_options {
    double lambda;         /* 0: TC_LH04_LAMBDA; negative: plain rounding */
    tc_lh04_counts *count; /* where not NULL, symbols are added */
    double *bits, *error;  /* where not NULL, the ideal code length and the squared error in squared steps are added */
} tc_lh04_options;

/* Bytes that a tile can take at most. */
size_t tc_lh04_tile_bound(void);

/* Encodes tile (tx, ty) of the true level `fine` against the reconstructed coarser level; the planes cover the tile and
 * what it needs. bytes: room for tc_lh04_tile_bound(); *size_ret: bytes written, 0 for an empty tile.
 * TC_ERR_UNSUPPORTED where a coefficient is too many steps to be coded (2^24). */
tc_status tc_lh04_encode_tile(const tc_lh04_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                              const tc_plane *fine, const tc_lh04_options *options, uint8_t *bytes, size_t *size_ret,
                              tc_lh04_work *work);

/* A tile to learn from: planes as for tc_lh04_encode_tile(). */
typedef struct tc_lh04_sample {
    int64_t tx, ty;
    tc_plane coarse, fine;
} tc_lh04_sample;

/* Trains a model on `count` tiles, which should be spread evenly over the level, and takes of it what pays over the
 * built-in one. *model_ret is as a header carries it. */
tc_status tc_lh04_train(const tc_lifting_level *level, const tc_lh04_sample *samples, int64_t count, double lambda,
                        int32_t step, tc_lh04_model *model_ret);

#endif
