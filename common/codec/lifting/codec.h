/* codec.h - the packed form of one level's details, given the next coarser level.
 *
 * A level (codec of the lifting's details, lifting.h) is cut into tiles of TC_TILE x TC_TILE positions, that is twice
 * as many samples either way. Only the entropy coding knows tiles: a tile decodes alone, given the reconstructed
 * coarser level around it, and the transform runs across tile edges. A tile without a coded coefficient takes no bytes.
 * Everything is integers and does the same on every machine; nothing but training allocates, and all
 * functions are thread-safe. */
#ifndef TC_CODEC_H
#define TC_CODEC_H

#include "common/terraclip.h"
#include "detail_model.h"
#include "lifting.h"

enum {
    TC_TILE = 64,
    TC_TILE_MARGIN = 5, /* positions of the coarser level that a tile looks at around itself */
    TC_TILE_SYMBOLS = TC_BANDS * TC_TILE * TC_TILE,
    TC_BIN_SPANS = 32,
    TC_TOGETHER = 4
};

/* A level's geometry, model and tables. */
typedef struct tc_codec {
    tc_lifting_level level;
    int64_t cw, ch;           /* positions */
    int64_t tiles_x, tiles_y; /* tiles */
    tc_detail_model model;
    int32_t coarse_shift, coarse_scale[TC_BANDS]; /* curvatures to steps */
    int32_t pair[TC_BANDS][TC_PHASES][7];         /* scale weights, two in each for codec_avx2.h */
    uint8_t spread[256][8];                       /* [which of eight lanes want a word][lane]: how many do before it */
    /* Sizes of contexts by halves of octaves, 2 and 3 being numbers 2 and 3, 4 to 5 number 4: the bin of the first one,
     * and the last one, low byte and high, that has the same bin; the next has the next bin. */
    uint8_t span_bin[TC_BIN_SPANS], span_last[2][TC_BIN_SPANS];
    int32_t shift[TC_BINS];                        /* tc_bin_shift */
    float bits[TC_BINS * TC_RANS_SYMBOLS];         /* what symbols cost, [bin * TC_RANS_SYMBOLS + symbol] */
    tc_rans_symbol put[TC_BINS * TC_RANS_SYMBOLS]; /* to encode them */
    tc_rans_table table[TC_BINS];
} tc_codec;

/* Sets up *codec for a level and model. */
void tc_codec_init(tc_codec *codec, const tc_lifting_level *level, const tc_detail_model *model);

/* Memory for coding one tile; holds nothing between calls. */
typedef struct tc_tile_work tc_tile_work;
size_t tc_tile_work_bytes(void);

/* Positions of tile (tx, ty). shift moves them in x: where the level wraps, a window that sticks out of it holds tiles
 * of the other side moved by a multiple of cw. */
tc_rect tc_codec_tile_rect(const tc_codec *codec, int64_t tx, int64_t ty, int64_t shift);

/* Rectangle of the coarser level that coding the tiles of a rectangle of positions needs. */
tc_rect tc_codec_tile_needs(const tc_codec *codec, tc_rect positions);

/* Decodes one tile from exactly its bytes (size 0: the empty tile) into those positions of band that the planes hold.
 * coarse covers at least tc_codec_tile_needs(). All planes of band have the same rectangle. TC_ERR_FORMAT where the
 * bytes are damaged; band is then as if the tile were empty. */
tc_status tc_codec_decode_tile(const tc_codec *codec, int64_t tx, int64_t ty, int64_t shift, const uint8_t *bytes,
                               size_t size, const tc_plane *coarse, const tc_plane band[TC_BANDS], tc_tile_work *work,
                               tc_simd simd);

/* A tile to decode, as tc_codec_decode_tile() does. */
typedef struct tc_tile_job {
    int64_t tx, ty, shift;
    const uint8_t *bytes;
    size_t size;
    const tc_plane *band; /* [TC_BANDS] */
    tc_tile_work *work;
    tc_status status; /* set */
} tc_tile_job;

/* Decodes up to TC_TOGETHER tiles at a time, each with its own bytes, planes and work memory, which takes less than one
 * after the other: decoding a symbol waits for the one before it in the same tile. */
void tc_codec_decode_tiles(const tc_codec *codec, tc_tile_job job[], int count, const tc_plane *coarse, tc_simd simd);

/* Details of empty tiles over `part`: what tc_codec_decode_tile() gives there, whatever tiles it touches. coarse covers
 * at least tc_codec_tile_needs(part), the planes of band `part`. */
void tc_codec_predict(const tc_codec *codec, tc_rect part, const tc_plane *coarse, const tc_plane band[TC_BANDS],
                      tc_tile_work *work, tc_simd simd);

/* Bytes that a tile can take at most. */
size_t tc_codec_tile_bound(void);

/* Counts of symbols, for building tables. */
typedef struct tc_symbol_counts {
    uint64_t of[TC_BINS][TC_RANS_SYMBOLS];
} tc_symbol_counts;

/* Squared error that a bit is worth, in squared steps. */
#define TC_DEFAULT_LAMBDA 0.1

/* Options of the encoder; zero is the default. */
typedef struct tc_encode_options {
    double lambda;           /* 0: TC_DEFAULT_LAMBDA; negative: plain rounding */
    tc_symbol_counts *count; /* where not NULL, symbols are added */
    /* Where not NULL, the bands' ideal code lengths (a coded tile's head and index entry with its first band) and their
     * squared errors in squared steps are added. */
    double *bits, *error;
    tc_simd simd; /* the bytes are the same */
} tc_encode_options;

/* Encodes tile (tx, ty) of the true details `band` against the reconstructed coarser level. The planes hold at least
 * the tile's rectangle and tc_codec_tile_needs(). bytes: room for tc_codec_tile_bound(), or NULL to write nothing;
 * *size_ret: bytes written, 0 for an empty tile. TC_ERR_UNSUPPORTED where a detail is too many steps away from its
 * prediction to be coded (2^24). */
tc_status tc_codec_encode_tile(const tc_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                               const tc_plane band[TC_BANDS], const tc_encode_options *options, uint8_t *bytes,
                               size_t *size_ret, tc_tile_work *work);

/* ---- Rectangles of the fine level ---------------------------------------------------------------------------- */

/* Where the details of a rectangle come from, one row of tiles after the other: puts those of row ty into the bands,
 * which hold the rows of them that are wanted. */
typedef struct tc_assembly {
    tc_status (*details)(void *context, int64_t ty, const tc_plane band[TC_BANDS]);
    /* Where not NULL, takes fine rows that are made, at most tc_codec_made_rows(), whose memory is then used again. */
    void (*made)(void *context, const tc_plane *part);
    void *context;
} tc_assembly;

/* Of a rectangle: so few that they stay near, and so many that starting anew is little of the work. */
static inline int64_t tc_codec_made_rows(tc_rect rect)
{
    enum { LEAST = 32, SAMPLES = 1 << 15 };
    int64_t width = rect.x1 - rect.x0, rows = width * LEAST >= SAMPLES ? LEAST : SAMPLES / width;
    return rows < rect.y1 - rect.y0 ? rows : rect.y1 - rect.y0;
}

/* Makes fine->rect from the coarser level, which covers what tc_lifting_needs() names, and from details, so that both
 * are in the nearer caches when heights are made of them. Where `made` takes the rows, fine->z has room for
 * tc_codec_made_rows() rows. scratch: tc_codec_assemble_scratch() bytes, aligned as malloc does. */
size_t tc_codec_assemble_scratch(const tc_codec *codec, tc_rect rect);
tc_status tc_codec_assemble(const tc_codec *codec, const tc_plane *coarse, const tc_assembly *from,
                            const tc_plane *fine, void *scratch, tc_simd simd);

/* Where tiles' bytes come from: sets *bytes and *size (0: empty tile), which stay valid until the next call. */
typedef tc_status (*tc_tile_source)(void *context, int64_t tx, int64_t ty, const uint8_t **bytes, size_t *size);

/* Rectangle of the coarser level that reading `rect` of the fine one needs; beyond the sides where the level wraps. */
tc_rect tc_codec_read_needs(const tc_codec *codec, tc_rect rect);

/* Reads fine->rect, which lies within the level, or beyond its sides where it wraps. scratch: tc_codec_read_scratch()
 * bytes, aligned as malloc does. A damaged tile is read as if it were empty, the rest goes on, and *damaged (where not
 * NULL) counts it; statuses of the source end the reading. */
size_t tc_codec_read_scratch(const tc_codec *codec, tc_rect rect);
tc_status tc_codec_read(const tc_codec *codec, const tc_plane *coarse, tc_tile_source source, void *context,
                        const tc_plane *fine, void *scratch, int64_t *damaged, tc_simd simd);

/* ---- Training ------------------------------------------------------------------------------------------------ */

/* A tile to learn from: its true details, and the reconstructed coarser level around it. */
typedef struct tc_training_tile {
    int64_t tx, ty;
    tc_plane coarse;         /* holds at least tc_codec_tile_needs() of the tile */
    tc_plane band[TC_BANDS]; /* hold at least the tile */
} tc_training_tile;

enum { TC_TRAINING_TILES = 16 }; /* enough to learn from */

/* Names at most `wanted` distinct tiles, evenly spread over a level, and returns how many. Sets tx, ty and, in the
 * planes, the least rectangles and strides; the caller gives them memory and heights. Where the level wraps, coarse
 * may stick out of it and holds columns of the other side there. */
int tc_codec_sample(const tc_lifting_level *level, int wanted, tc_training_tile *tiles);

/* Trains all parts of *model, from what it holds on; its steps stay. Allocates. */
tc_status tc_codec_train(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                         tc_detail_model *model);

/* Makes a level's header: trains a model on the tiles, from *start on (NULL: the built-in sets; else best that of the
 * next coarser level), and takes of it what pays over the built-in sets for the whole level. step: the quantiser steps;
 * lambda as in tc_encode_options; threads as in tc_parallel_for(), on which nothing depends. header: room for
 * tc_detail_model_bound() bytes. *model_ret is the model that the header holds. Allocates. */
tc_status tc_codec_choose(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                          const int32_t step[TC_BANDS], const tc_detail_model *start, int threads, uint8_t *header,
                          size_t *size_ret, tc_detail_model *model_ret);

/* What coding the tiles with a model and its steps gives: bits of each band, and squared error in squared height units
 * of details (an orthonormal transform would have the same in heights; see tc_lifting_norm()). Allocates. */
tc_status tc_codec_price(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                         const tc_detail_model *model, double bits[TC_BANDS], double error[TC_BANDS]);

#endif
