/* exact_tile.h - what the parts of the exact codec share: the fields of a tile, prediction and expected error.
 *
 * Everything is relative to base, a multiple of the step near the tile's heights, in 1/16 of a step. */
#ifndef TC_EXACT_TILE_H
#define TC_EXACT_TILE_H

#include "codec_exact.h"
#include "common/base/rect.h"

#define TC_INLINE static inline __attribute__((always_inline))

enum {
    TC_EXACT_SIDE = 2 * TC_TILE, /* samples */
    TC_EXACT_MARGIN = 2,         /* positions of the coarser level around the tile */
    TC_EXACT_COARSE_SIDE = TC_TILE + 2 * TC_EXACT_MARGIN,
    TC_EXACT_REACH = 3, /* samples before a sample that it sees */
    TC_EXACT_ROW = TC_EXACT_SIDE + 2 * TC_EXACT_REACH,
    TC_EXACT_PART = 16,         /* of a step */
    TC_EXACT_RELIEF = 1 << 22,  /* limit of coarse heights, in parts */
    TC_EXACT_SIGNAL = 1 << 20,  /* limit of what prediction sees, in parts */
    TC_EXACT_ERROR = 1 << 17,   /* limit of what contexts see, in parts */
    TC_EXACT_SCALE_LEAST = 492, /* expected errors are in 1/1024 part */
    TC_EXACT_SCALE_MOST = 1 << 28
};

/* Decisions on a sample's distance r from the prediction: 0 is it not zero, 1 is it away from the side that rounding
 * left, then, for either side, is it more than n + 1. */
enum {
    TC_EXACT_UNARY = 7,
    TC_EXACT_TOWARDS = 2,
    TC_EXACT_AWAY = TC_EXACT_TOWARDS + TC_EXACT_UNARY,
    TC_EXACT_SCALE_OCTAVE = 8 /* of the least expected error */
};

/* The nodes of the pattern contexts share what lies beyond the third decision of a side. */
extern const uint8_t tc_exact_pattern_node[TC_EXACT_NODES];

/* The values that a tile takes, where they are few (exact_values.c). */
enum { TC_EXACT_VALUES = TC_EXACT_SIDE * TC_EXACT_SIDE, TC_EXACT_RANGE = 1 << 16 };
typedef struct tc_exact_values {
    int32_t first, range, count;        /* steps above the base; first to first + range - 1 */
    uint16_t below[TC_EXACT_RANGE + 1]; /* values below first + n; none takes all of 1 << 16 */
    uint16_t value[TC_EXACT_VALUES];    /* less first */
    tc_mix_state recent[1 << 8], gaps[1 << 8], past[1 << 12];
    int32_t weight[TC_MIX_INPUTS];
} tc_exact_values;

struct tc_exact_work {
    int64_t base; /* in steps */
    int32_t coarse[TC_EXACT_COARSE_SIDE][TC_EXACT_COARSE_SIDE];
    int32_t across[TC_EXACT_COARSE_SIDE][TC_EXACT_SIDE]; /* upsampled in x only, 1/16 part */
    int32_t up[TC_EXACT_SIDE][TC_EXACT_SIDE];            /* the upsampled coarser level */
    int32_t guess[TC_EXACT_SIDE][TC_EXACT_SIDE];         /* the prediction's share of the coarser level, 1/16 part */
    uint32_t curvature[TC_TILE][TC_TILE];
    /* Behind row y + TC_EXACT_REACH and column x + TC_EXACT_REACH. */
    int32_t signal[TC_EXACT_SIDE + TC_EXACT_REACH][TC_EXACT_ROW]; /* sample less upsampled */
    int32_t error[TC_EXACT_SIDE + TC_EXACT_REACH][TC_EXACT_ROW];  /* sample less predicted */
    tc_exact_state state;
    tc_exact_values values;
};

/* Neighbours of the prediction, x and y from the sample. */
extern const int8_t tc_exact_coarse_at[TC_EXACT_COARSE][2];
extern const int8_t tc_exact_causal_at[TC_EXACT_CAUSAL][2];

/* The states that a context starts from where the header does not correct it. */
void tc_exact_start_nodes(int bin, int fraction, tc_mix_state node[TC_EXACT_NODES]);

/* Prepares a tile: base, coarse, up and curvature; signal and error empty. */
void tc_exact_prepare(const tc_exact *codec, int64_t tx, int64_t ty, const tc_plane *coarse, tc_exact_work *work);

/* Codes the set of values; the encoder has filled in first, range and below. False where it is damaged. */
bool tc_exact_values_code(const tc_mix_tables *tables, tc_mix_coder *coder, tc_exact_values *values, bool encode);

/* Whether coding samples by the values' ranks saves more than coding the set of values takes. k: steps above the base.
 * spare: room for the set, TC_EXACT_RANGE / 2 bytes. */
bool tc_exact_values_find(const tc_mix_tables *tables, tc_exact_values *values, const tc_plane *fine, tc_rect tile,
                          int32_t step, int64_t base, uint8_t *spare);

/* A tile as raw samples (exact_raw.c), and the size that it has so. */
typedef struct tc_exact_raw {
    int32_t first; /* the lowest sample, in steps */
    int first_bytes;
    size_t size;
} tc_exact_raw;
size_t tc_exact_raw_size(const tc_plane *fine, tc_rect tile, int32_t step, tc_exact_raw *raw_ret);
void tc_exact_raw_encode(const tc_plane *fine, tc_rect tile, int32_t step, const tc_exact_raw *raw, uint8_t *bytes);

/* Decodes bytes that tc_exact_is_raw(). TC_ERR_FORMAT where they are damaged. */
tc_status tc_exact_raw_decode(const tc_plane *fine, tc_rect tile, int32_t step, const uint8_t *bytes, size_t size);

static inline int32_t tc_exact_clamp(int64_t v, int32_t limit)
{
    return (int32_t)(v < -limit ? -limit : v > limit ? limit : v);
}

/* The features of the expected error of sample (x, y) but the constant one. */
TC_INLINE void tc_exact_scale_features(const tc_exact_work *w, int x, int y, uint32_t f[TC_EXACT_SCALES - 1])
{
    const int32_t *e = &w->error[y + TC_EXACT_REACH][x + TC_EXACT_REACH], *n = e - TC_EXACT_ROW, *nn = n - TC_EXACT_ROW;
#define SIZE(v) (uint32_t)((v) < 0 ? -(v) : (v))
    f[0] = SIZE(e[-1]), f[1] = SIZE(n[0]), f[2] = SIZE(n[-1]), f[3] = SIZE(n[1]), f[4] = SIZE(e[-2]);
    f[5] = SIZE(nn[0]), f[6] = SIZE(n[2]) + SIZE(n[-2]) + SIZE(nn[-1]) + SIZE(nn[1]);
#undef SIZE
    f[7] = w->curvature[y >> 1][x >> 1];
}

/* The prediction of sample (x, y) in parts. */
TC_INLINE int32_t tc_exact_predict(const tc_exact_work *w, const int16_t weight[TC_EXACT_CAUSAL], int x, int y)
{
    const int32_t *d = &w->signal[y + TC_EXACT_REACH][x + TC_EXACT_REACH];
    int64_t sum = 0;
#define TERM(k, dx, dy) sum += (int64_t)weight[k] * d[(dy)*TC_EXACT_ROW + (dx)]
    TERM(0, -1, 0), TERM(1, 0, -1), TERM(2, -1, -1), TERM(3, 1, -1), TERM(4, -2, 0), TERM(5, 0, -2);
    TERM(6, -2, -1), TERM(7, -1, -2), TERM(8, 1, -2), TERM(9, 2, -1), TERM(10, 2, -2), TERM(11, -2, -2);
    TERM(12, -3, 0), TERM(13, 0, -3), TERM(14, -3, -1), TERM(15, 3, -1);
#undef TERM
    return (int32_t)((w->guess[y][x] + (sum >> 8) + 8) >> 4);
}

/* The expected error of sample (x, y), in 1/1024 part. */
TC_INLINE uint32_t tc_exact_scale(const tc_exact_work *w, const uint16_t weight[TC_EXACT_SCALES], int x, int y)
{
    uint32_t f[TC_EXACT_SCALES - 1], sum = 16u * weight[TC_EXACT_SCALES - 1] + TC_EXACT_SCALE_LEAST;
    tc_exact_scale_features(w, x, y, f);
    for (int k = 0; k < TC_EXACT_SCALES - 1; k++)
        sum += weight[k] * f[k];
    return sum < TC_EXACT_SCALE_MOST ? sum : TC_EXACT_SCALE_MOST;
}

/* How many low bits of r go raw. */
TC_INLINE int tc_exact_shift(uint32_t scale)
{
    /* So that no more than four units are expected. */
    int above = 31 - __builtin_clz((scale - 1) | 1) - 15;
    return above > 0 ? above : 0;
}

/* Expected errors in four bins an octave; those above the last one go where they would be octaves below. */
TC_INLINE int tc_exact_bin(uint32_t scale)
{
    int octave = 31 - __builtin_clz(scale),
        bin = 4 * (octave - TC_EXACT_SCALE_OCTAVE) + (int)(scale >> (octave - 2) & 3);
    return bin < TC_EXACT_BINS ? bin : TC_EXACT_BINS - 4 + (bin & 3);
}

TC_INLINE int tc_exact_fraction(int shift, int parts)
{
    static const uint8_t bin[TC_EXACT_PART / 2 + 1] = {0, 0, 1, 2, 3, 3, 4, 5, 5};
    return shift ? 0 : bin[parts];
}

/* Where a prediction falls among the values. */
typedef struct tc_exact_place {
    int32_t rank, fraction; /* of the nearest one; parts of the gap that the prediction is away from it, 0 to half */
    bool flip;              /* the prediction is below it */
    uint32_t scale;         /* expected error in ranks, 1/1024 part */
} tc_exact_place;

static inline tc_exact_place tc_exact_values_place(const tc_exact_values *v, int32_t prediction, uint32_t scale)
{
    int32_t at = prediction - v->first * TC_EXACT_PART, n = tc_exact_clamp(at >> 4, TC_EXACT_RANGE), near,
            gap = TC_EXACT_PART;
    n = n < 0 ? 0 : n >= v->range ? v->range - 1 : n;
    tc_exact_place p = {.rank = v->below[n]};
    /* The first value at or above the prediction, or the last one below it. */
    while (p.rank + 1 < v->count && v->value[p.rank] * TC_EXACT_PART < at)
        p.rank++;
    if (p.rank > 0) {
        gap = (v->value[p.rank] - v->value[p.rank - 1]) * TC_EXACT_PART;
        if (at - v->value[p.rank - 1] * TC_EXACT_PART < v->value[p.rank] * TC_EXACT_PART - at)
            p.rank--;
    }
    near = v->value[p.rank] * TC_EXACT_PART;
    p.flip = at < near;
    int64_t away = (int64_t)(p.flip ? near - at : at - near) * TC_EXACT_PART / gap;
    p.fraction = away > TC_EXACT_PART / 2 ? TC_EXACT_PART / 2 : (int32_t)away;
    int32_t reach = (int32_t)(scale >> 13) + 8, from = n - reach < 0 ? 0 : n - reach;
    int32_t to = n + reach + 1 > v->range ? v->range : n + reach + 1;
    uint64_t there = (uint64_t)(v->below[to] - v->below[from]) + 1;
    uint64_t ranks = scale * there / (uint64_t)(to - from + 1);
    p.scale = ranks < TC_EXACT_SCALE_LEAST ? TC_EXACT_SCALE_LEAST : (uint32_t)(ranks < scale ? ranks : scale);
    return p;
}

#endif
