/* codec_exact.h - the packed form of a finest level whose heights come back exactly, given the next coarser level.
 *
 * The level's heights are multiples of a step: the source's lattice for lossless packing, 2E + 1 lattice units for an
 * error of at most E. A level is cut into the tiles of codec.h, each of which decodes alone, sample by sample in rows,
 * given the reconstructed coarser level around it. A sample is predicted by trained linear functions of the samples
 * before it and of the coarser level on all sides of it (least squares, one function for each of the four places a
 * sample can have among the coarser ones); the size of the error is guessed from the errors before it; and what is
 * left is coded in binary decisions whose probabilities are mixed from several contexts (mixing_coder.h). Where none
 * of this helps, a tile holds its samples as they are. Linear
 * prediction with error contexts is that of CALIC (Wu, Memon 1997) and TMW (Meyer, Tischer 1997); what the coarser
 * levels cost comes nearly all back here, since they are known to the prediction. All integers; nothing here but the
 * training allocates; all functions are thread-safe. */
#ifndef TC_CODEC_EXACT_H
#define TC_CODEC_EXACT_H

#include "common/codec/lifting/codec.h"
#include "common/codec/entropy/mixing_coder.h"

enum {
    TC_EXACT_PHASES = 4, /* (y & 1) * 2 + (x & 1) */
    TC_EXACT_COARSE = 20,
    TC_EXACT_CAUSAL = 16,
    TC_EXACT_TERMS = TC_EXACT_COARSE + TC_EXACT_CAUSAL,
    TC_EXACT_SCALES = 9,
    TC_EXACT_BINS = 64,
    TC_EXACT_FRACTIONS = 6,
    TC_EXACT_NODES = 16,
    TC_EXACT_CONTEXTS1 = TC_EXACT_BINS * TC_EXACT_FRACTIONS,
    TC_EXACT_CONTEXTS2 = (TC_EXACT_BINS + 2) / 3 * TC_EXACT_PHASES * TC_EXACT_FRACTIONS,
    TC_EXACT_PATTERNS = 75 * 3,
    TC_EXACT_LEVELS3 = 16,
    TC_EXACT_NODES3 = 8,
    TC_EXACT_CONTEXTS3 = TC_EXACT_PATTERNS * TC_EXACT_LEVELS3,
    TC_EXACT_LENGTHS = 32,
    TC_EXACT_WEIGHTS = (TC_EXACT_BINS + 2) / 3
};

/* What encoder and decoder know about a level beforehand. */
typedef struct tc_exact_model {
    int32_t step;                                     /* height units; at most TC_MAX_STEP */
    int16_t predict[TC_EXACT_PHASES][TC_EXACT_TERMS]; /* in 1/4096 */
    uint16_t scale[TC_EXACT_PHASES][TC_EXACT_SCALES]; /* in 1/1024 */
    int8_t start[TC_EXACT_CONTEXTS1][TC_EXACT_NODES]; /* corrections of logits, in 1/16 */
} tc_exact_model;

/* What is learnt while a tile is coded. */
typedef struct tc_exact_state {
    tc_mix_state scale[TC_EXACT_CONTEXTS1][TC_EXACT_NODES];
    tc_mix_state phase[TC_EXACT_CONTEXTS2][TC_EXACT_NODES];
    tc_mix_state pattern[TC_EXACT_CONTEXTS3][TC_EXACT_NODES3];
    tc_mix_state length[TC_EXACT_LENGTHS];
    int32_t weight[TC_EXACT_WEIGHTS][TC_EXACT_NODES][TC_MIX_INPUTS];
} tc_exact_state;

/* A level's geometry, model, tables, and the state that every tile starts from. */
typedef struct tc_exact {
    tc_lifting_level level;
    int64_t cw, ch;           /* positions */
    int64_t tiles_x, tiles_y; /* tiles */
    tc_exact_model model;
    tc_mix_tables tables;
    tc_exact_state start;
} tc_exact;

/* Sets up *codec for a level and model. */
void tc_exact_init(tc_exact *codec, const tc_lifting_level *level, const tc_exact_model *model);

/* Memory for coding one tile; holds nothing between calls. */
typedef struct tc_exact_work tc_exact_work;
size_t tc_exact_work_bytes(void);

/* Samples of tile (tx, ty), and the rectangle of the coarser level that coding it needs (beyond the sides where the
 * level wraps). */
tc_rect tc_exact_tile_rect(const tc_exact *codec, int64_t tx, int64_t ty);
tc_rect tc_exact_tile_needs(const tc_exact *codec, int64_t tx, int64_t ty);

/* Bytes that a tile can take at most. */
size_t tc_exact_tile_bound(void);

/* Whether a tile's bytes are raw samples, which need neither the model nor the coarser level. */
bool tc_exact_is_raw(const uint8_t *bytes, size_t size);

/* Encodes the samples of tile (tx, ty) in `fine`, which holds at least them. bytes: room for tc_exact_tile_bound().
 * TC_ERR_USAGE where a height is not a multiple of the step, or is not within TC_LIFTING_LIMIT. */
tc_status tc_exact_encode_tile(const tc_exact *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                               const tc_plane *fine, uint8_t *bytes, size_t *size_ret, tc_exact_work *work);

/* Decodes one tile from exactly its bytes into `fine`, which holds at least the tile. TC_ERR_FORMAT where the bytes are
 * seen to be damaged (not all damage is); the tile's samples are then anything within the limits of a height. */
tc_status tc_exact_decode_tile(const tc_exact *codec, int64_t tx, int64_t ty, const uint8_t *bytes, size_t size,
                               const tc_plane *coarse, const tc_plane *fine, tc_exact_work *work);

/* ---- Model --------------------------------------------------------------------------------------------------- */

/* A tile to learn from: its samples and the coarser level around it, as for encoding. */
typedef struct tc_exact_tile {
    int64_t tx, ty;
    tc_plane coarse, fine;
} tc_exact_tile;

/* Trains a model on the tiles, 0 or more; a few dozens are enough. threads: as in tc_parallel_for(); nothing depends
 * on them. */
tc_status tc_exact_train(const tc_lifting_level *level, const tc_exact_tile *tiles, int count, int32_t step,
                         int threads, tc_exact_model *model);

/* A level's header. The encoder must go on with the model that it reads back. Reading gives TC_ERR_FORMAT for bytes
 * that no writer makes or a size that is not exact. */
size_t tc_exact_model_bound(void);
size_t tc_exact_model_write(const tc_exact_model *model, uint8_t *bytes);
tc_status tc_exact_model_read(const uint8_t *bytes, size_t size, tc_exact_model *model);

#endif
