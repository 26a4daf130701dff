/* packed.h - a whole terrain packed in memory by the codec, level by level: what tests and measurements look at. */
#ifndef PACKED_H
#define PACKED_H

#include "common/codec/lifting/codec.h"
#include "common/codec/lh04/codec_lh04.h"
#include "terrains.h"

enum { PACKED_LEVELS = 32 };

/* One level above the coarsest: its details given the next coarser one. */
typedef struct packed_level {
    tc_codec *codec;     /* NULL where lh04_packed.h packed it */
    tc_lh04_codec *lh04; /* NULL else */
    uint8_t *header;
    size_t header_size;
    int64_t tiles;
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

/* For packing: memory of zeros and planes of it; the program ends where there is none. */
void *packed_memory(size_t bytes);
tc_plane packed_plane(tc_rect rect);

/* A plane with the columns of the other side around it, for a level that wraps. */
tc_plane packed_wrapped(const tc_plane *plane, tc_rect rect);

/* Takes z apart down to the coarsest level, low[count], and returns count: heights low[n] of level[n], whose details
 * against low[n + 1] are band[n]. */
int packed_analyse(const int32_t *z, int64_t width, int64_t height, bool wrap_x, tc_lifting_level *level, tc_plane *low,
                   tc_plane (*band)[TC_BANDS]);

/* Room for the tiles of a level, and one of them. */
void packed_make_tiles(packed_level *l, int64_t tiles);
void packed_keep_tile(packed_level *l, int64_t n, const uint8_t *bytes, size_t size);

/* Heights of one of PACKED_KINDS kinds, in units; cliffs of one of them are 2 * cliff high. */
enum { PACKED_KINDS = 7 };
int32_t *packed_heights(test_random *r, int kind, int64_t width, int64_t height, int32_t cliff);

#endif
