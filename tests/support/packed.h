/* packed.h - a whole terrain packed in memory by the codec, level by level: what tests and measurements look at. */
#ifndef PACKED_H
#define PACKED_H

#include "common/core/codec/codec.h"

enum { PACKED_LEVELS = 32 };

/* One level above the coarsest: its details given the next coarser one. */
typedef struct packed_level {
    tc_codec *codec;
    uint8_t *header;
    size_t header_size;
    uint8_t **tile; /* [ty * tiles_x + tx]; NULL: empty */
    size_t *tile_size;
    tc_plane coarse, fine; /* reconstructed; fine is the coarse one of the next level */
} packed_level;

typedef struct packed {
    int levels;                        /* above the coarsest */
    packed_level level[PACKED_LEVELS]; /* 0: the finest */
    size_t coarsest_bytes;
    double train_s, encode_s; /* processor time of models and of tiles */
} packed;

typedef struct packed_options {
    double q;      /* step of a band of norm 1, in units */
    double lambda; /* as tc_encode_options */
    int threads, training_tiles;
    bool wrap_x, builtin; /* builtin: no own models */
    tc_simd simd;         /* of encoding */
} packed_options;

/* Packs z (width x height). Ends the program on failure. */
packed packed_new(const int32_t *z, int64_t width, int64_t height, const packed_options *options);
void packed_free(packed *p);

/* All bytes that a file would need for the streams: tiles, 8 bytes (index entry and checksum) for each that is not
 * empty and one bit for each that is, headers, the coarsest level. */
size_t packed_bytes(const packed *p);

/* A tile source over a packed level. */
tc_status packed_source(void *level, int64_t tx, int64_t ty, const uint8_t **bytes, size_t *size);

/* Reads rect of a level, given its reconstructed coarser level, which is extended over the sides where it wraps. */
tc_status packed_read(const packed_level *l, const tc_plane *fine, int64_t *damaged, tc_simd simd);

tc_plane packed_plane(tc_rect rect);

#endif
