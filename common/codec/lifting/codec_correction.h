/* codec_correction.h - a sparse layer on a finest level coded by the lifting, which bounds its error.
 *
 * Where the synthesised height is off by more than E, it is moved by a multiple of C: height = synthesised + k C, with
 * C = 2E + 1 on integers and at most 2E in general. k is 0 nearly everywhere. A tile (codec.h) is coded alone, sample
 * by sample in rows, in binary decisions mixed from three contexts (mixing_coder.h): what k was around the sample, and
 * how large the tile's decoded details are there. A tile without corrections takes no bytes. By squares, a tile tells
 * first in which squares of 8 x 8 samples there are any, and only of those the samples: hardly a byte more, and where
 * corrections are few, decoded several times faster. All integers; nothing here allocates; all functions are
 * thread-safe. */
#ifndef TC_CODEC_CORRECTION_H
#define TC_CODEC_CORRECTION_H

#include "codec.h"
#include "common/codec/entropy/mixing_coder.h"

/* The same for every level that is coded in the same way. */
typedef struct tc_correction {
    tc_mix_tables tables;
    bool by_squares;
} tc_correction;

void tc_correction_init(tc_correction *correction, bool by_squares);

/* Bytes that a tile can take at most. */
size_t tc_correction_bound(void);

/* Encodes k over its rectangle: a tile's samples, at most 2 TC_TILE either way, starting on even ones. band: the tile's
 * details as tc_codec_decode_tile() gives them, at least over k's positions; step: their quantiser steps. *size_ret: 0
 * where all are 0. TC_ERR_USAGE where some |k| is above TC_CORRECTION_MOST. */
enum { TC_CORRECTION_MOST = 1 << 24 };
tc_status tc_correction_encode(const tc_correction *correction, const tc_plane band[TC_BANDS],
                               const int32_t step[TC_BANDS], const tc_plane *k, uint8_t *bytes, size_t room,
                               size_t *size_ret);

/* Decodes k->rect from exactly its bytes. TC_ERR_FORMAT where they are seen to be damaged (not all damage is); all k
 * are then 0. */
tc_status tc_correction_decode(const tc_correction *correction, const tc_plane band[TC_BANDS],
                               const int32_t step[TC_BANDS], const uint8_t *bytes, size_t size, const tc_plane *k);

#endif
