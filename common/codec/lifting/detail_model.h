/* detail_model.h - what encoder and decoder know about a level's details before they see any: the numbers by which
 * details are predicted, their size is guessed, and symbols are coded.
 *
 * Three parts. (1) Prediction: HL and LH as linear functions of the reconstructed coarser level (a 5 x 6 kernel with
 * the symmetries of the band, free of constants), LH also of HL. (2) Scale: the expected magnitude of a coefficient
 * as a non-negative linear function of magnitudes around it that are known by then and of the coarser level's
 * curvatures (a Laplacian scale as in the context models of image coders, e.g. Wu, Memon 1997, but trained). It
 * selects one of TC_BINS bins. (3) A table of symbol frequencies for each bin. Each part is one of the built-in sets
 * or comes with the level's header. All integers: every machine decodes the same bits. */
#ifndef TC_DETAIL_MODEL_H
#define TC_DETAIL_MODEL_H

#include "common/terraclip.h"
#include "lifting.h"
#include "common/codec/entropy/rans.h"

enum {
    TC_BINS = 24,
    TC_PLAIN_BINS = 17,    /* as many have no low bits */
    TC_PREDICT_KERNEL = 8, /* numbers of one band's kernel */
    TC_PREDICT_CROSS = 4,  /* LH from HL */
    TC_PREDICT = TC_PREDICT_KERNEL + TC_PREDICT_CROSS,
    TC_PREDICT_BITS = 12,                                           /* their unit is 1/4096 */
    TC_SCALE_OWN = 5,                                               /* magnitudes of the same band */
    TC_SCALE_CROSS = 2,                                             /* of bands coded before */
    TC_SCALE_COARSE = 5,                                            /* curvatures of the coarser level */
    TC_SCALE = TC_SCALE_OWN + TC_SCALE_CROSS + TC_SCALE_COARSE + 1, /* the last one is a constant */
    TC_SCALE_BITS = 10,                                             /* their unit is 1/1024 */
    TC_SCALE_MOST = 1 << 13,                                        /* the largest weight */
    TC_MAX_STEP = 1 << 24,
    TC_BUILTIN_MODELS = 3
};

/* Columns of a row are coded in two phases, even columns first, so that a phase needs nothing of itself: all its
 * contexts are known at once, and the second phase knows both neighbours. */
enum { TC_PHASES = 2 };

typedef struct tc_detail_model {
    int32_t step[TC_BANDS];                        /* quantiser steps, in height units; 1 is lossless */
    int16_t predict[2][TC_PREDICT];                /* HL (no cross terms), LH */
    uint16_t scale[TC_BANDS][TC_PHASES][TC_SCALE]; /* at most TC_SCALE_MOST, and 65535 in a row */
    tc_rans_frequencies symbols[TC_BINS];
} tc_detail_model;

/* Scales are in 1/256 of a quantiser step; bin b holds scales from tc_bin_threshold[b - 1] to below
 * tc_bin_threshold[b]. In bins of large scales a symbol is a magnitude without its low tc_bin_shift bits, which follow
 * raw. */
extern const int16_t tc_bin_threshold[TC_BINS - 1];
extern const uint8_t tc_bin_shift[TC_BINS];

/* Built-in models, 0 <= set < TC_BUILTIN_MODELS: 0 radar terrain (noisy), 1 smooth terrain, 2 coarse
 * levels of any terrain. Steps are left alone. */
void tc_detail_model_builtin(int set, tc_detail_model *model);

/* Which parts a header carries itself; else the number of the built-in set. */
enum { TC_MODEL_OWN = 3 };
typedef struct tc_detail_parts {
    int predict, scale, symbols;
} tc_detail_parts;

/* A level's header. Writing rounds what the level has of its own to what a header can carry, so the encoder must go on
 * with the model that it reads back. Reading gives TC_ERR_FORMAT for bytes that no writer makes or a size that is not
 * exact. */
size_t tc_detail_model_bound(void);
size_t tc_detail_model_write(const tc_detail_model *model, tc_detail_parts parts, uint8_t *bytes);
tc_status tc_detail_model_read(const uint8_t *bytes, size_t size, tc_detail_model *model, tc_detail_parts *parts);

#endif
