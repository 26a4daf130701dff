/* codec_exact.c - coding the tiles of an exact level, and the state that they start from (codec_exact.h).
 *
 * Encoder and decoder are one function, so that they cannot come apart. What is coded of a sample is r, its distance
 * in steps from the rounded prediction, counted towards the side on which the prediction was before rounding: is it
 * zero, which side, then in unary, the rest in an exponential Golomb code. Where errors are large the low bits of r go
 * raw. */
#include <string.h>

#include "exact_tile.h"

enum {
    START_COUNT = 24,     /* bits that the shape below is worth */
    START_WEIGHT = 26214, /* 0.4 of TC_MIX_ONE */
    UNARY = 7,
    MOST_LENGTH = 27,
    TOWARDS = 2,            /* nodes: 0 not zero, 1 away, then */
    AWAY = TOWARDS + UNARY, /* more than n */
    SCALE_OCTAVE = 8        /* of the least expected error */
};

/* ---- Geometry ------------------------------------------------------------------------------------------------ */

tc_rect tc_exact_tile_rect(const tc_exact *c, int64_t tx, int64_t ty)
{
    return (tc_rect){tx * TC_EXACT_SIDE, ty * TC_EXACT_SIDE, tc_min64((tx + 1) * TC_EXACT_SIDE, c->level.width),
                     tc_min64((ty + 1) * TC_EXACT_SIDE, c->level.height)};
}

tc_rect tc_exact_tile_needs(const tc_exact *c, int64_t tx, int64_t ty)
{
    tc_rect r = {tx * TC_TILE - TC_EXACT_MARGIN, tc_max64(ty * TC_TILE - TC_EXACT_MARGIN, 0),
                 tc_min64((tx + 1) * TC_TILE, c->cw) + TC_EXACT_MARGIN,
                 tc_min64((ty + 1) * TC_TILE + TC_EXACT_MARGIN, c->ch)};
    if (!c->level.wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, c->cw);
    return r;
}

size_t tc_exact_work_bytes(void)
{
    return sizeof(tc_exact_work);
}

size_t tc_exact_tile_bound(void)
{
    /* Every decision at the least probability takes 12 bits; a sample at most 2 + UNARY + 2 * MOST_LENGTH of them,
     * half of which are raw or cost less. */
    return (size_t)TC_EXACT_SIDE * TC_EXACT_SIDE * 64 + 64;
}

/* ---- The state before the first sample ----------------------------------------------------------------------- */

/* Share (1/65536) of errors above 2^((n - 24) / 4) of the expected one, measured on radar terrain. */
static uint32_t tail(int64_t distance, int64_t scale)
{
    static const uint16_t share[48] = {
        64845, 64717, 64561, 64374, 64156, 63892, 63580, 63204, 62758, 62235, 61607, 60867, 59990, 58946, 57703, 56241,
        54519, 52477, 50078, 47274, 44020, 40297, 36086, 31408, 26369, 21128, 15965, 11217, 7220,  4199,  2207,  1045,
        455,   189,   79,    34,    16,    8,     4,     2,     1,     1,     1,     1,     1,     1,     1,     1};
    int64_t ratio = (distance << 24) / scale; /* 1/4096 */
    if (ratio < 64)
        return 65536 - (uint32_t)(ratio * (65536 - 64845) / 64);
    int octave = 63 - __builtin_clzll((uint64_t)ratio), n = 4 * (octave - 12) + 24;
    int64_t part = ((ratio << 8) >> octave) - 256; /* 0 .. 255 of the octave */
    n += (int)(part >> 6), part &= 63;
    if (n >= 47)
        return 1;
    return share[n] - (uint32_t)((share[n] - share[n + 1]) * part / 64);
}

static tc_mix_state start_state(uint64_t part, uint64_t whole)
{
    uint64_t p = whole ? part * 65536 / whole : 32768;
    return tc_mix_state_of((uint32_t)(p < 48 ? 48 : p > 65488 ? 65488 : p), START_COUNT);
}

/* Expected error in the middle of a bin, and how many bits go raw there. */
static int64_t bin_scale(int bin)
{
    return ((int64_t)(2 * (4 + bin % 4) + 1) << (SCALE_OCTAVE + bin / 4)) / 8;
}

static int scale_shift(uint32_t scale)
{
    enum { FOUR = 4 * TC_EXACT_PART * 1024 };
    int shift = 0;
    while (scale > (uint32_t)FOUR << shift)
        shift++;
    return shift;
}

static void start_nodes(int bin, int fraction, tc_mix_state node[TC_EXACT_NODES])
{
    static const int64_t middle[TC_EXACT_FRACTIONS] = {1, 4, 6, 9, 12, 15}; /* 1/32 of a step */
    int64_t scale = 2 * bin_scale(bin);
    int shift = scale_shift((uint32_t)bin_scale(bin));
    int64_t f = shift ? 8 : middle[fraction], unit = (int64_t)2 * TC_EXACT_PART << shift;
    uint32_t towards[UNARY + 1], away[UNARY + 1];
    for (int n = 0; n <= UNARY; n++) {
        towards[n] = tail(n * unit + unit / 2 - f, scale);
        away[n] = tail(n * unit + unit / 2 + f, scale);
    }
    node[0] = start_state(towards[0] + away[0], 2 * 65536);
    node[1] = start_state(away[0], towards[0] + away[0]);
    for (int n = 0; n < UNARY; n++) {
        node[TOWARDS + n] = start_state(towards[n + 1], towards[n]);
        node[AWAY + n] = start_state(away[n + 1], away[n]);
    }
}

/* The nodes of the pattern contexts share what lies beyond the third decision of a side. */
static const uint8_t pattern_node[TC_EXACT_NODES] = {0, 1, 2, 3, 4, 4, 4, 4, 4, 5, 6, 7, 7, 7, 7, 7};

static int limited(int v, int most)
{
    return v < most ? v : most;
}

void tc_exact_init(tc_exact *c, const tc_lifting_level *level, const tc_exact_model *model)
{
    memset(c, 0, sizeof *c);
    c->level = *level, c->model = *model;
    c->cw = (level->width + 1) / 2, c->ch = (level->height + 1) / 2;
    c->tiles_x = (c->cw + TC_TILE - 1) / TC_TILE, c->tiles_y = (c->ch + TC_TILE - 1) / TC_TILE;
    tc_mix_tables_init(&c->tables);
    tc_exact_state *s = &c->start;
    for (int n = 0; n < TC_EXACT_CONTEXTS1; n++)
        start_nodes(n / TC_EXACT_FRACTIONS, n % TC_EXACT_FRACTIONS, s->scale[n]);
    for (int n = 0; n < TC_EXACT_CONTEXTS2; n++)
        start_nodes(limited(n / TC_EXACT_FRACTIONS / TC_EXACT_PHASES * 3 + 1, TC_EXACT_BINS - 1),
                    n % TC_EXACT_FRACTIONS, s->phase[n]);
    for (int n = 0; n < TC_EXACT_CONTEXTS3; n++) {
        tc_mix_state node[TC_EXACT_NODES];
        start_nodes((n / 3 % TC_EXACT_LEVELS3 * 8 + 4) / 3, n % 3 * 2, node);
        for (int k = TC_EXACT_NODES - 1; k >= 0; k--)
            s->pattern[n][pattern_node[k]] = node[k];
    }
    for (int n = 0; n < TC_EXACT_LENGTHS; n++)
        s->length[n] = tc_mix_state_of(32768, 6);
    for (int n = 0; n < 22; n++)
        for (int k = 0; k < TC_EXACT_NODES; k++)
            for (int i = 0; i < TC_MIX_INPUTS; i++)
                s->weight[n][k][i] = START_WEIGHT;
}

/* ---- A sample ------------------------------------------------------------------------------------------------ */

typedef struct context {
    tc_mix_state *scale, *phase, *pattern;
    int32_t (*weight)[TC_MIX_INPUTS];
    int shift;
} context;

TC_INLINE int decide(const tc_exact *c, tc_mix_coder *coder, const context *x, int node, int bit, bool encode)
{
    return tc_mix_bit(&c->tables, coder, &x->scale[node], &x->phase[node], &x->pattern[pattern_node[node]],
                      x->weight[node], bit, encode);
}

/* Codes r, |r| < 2^26. */
TC_INLINE int32_t code_distance(const tc_exact *c, tc_mix_coder *coder, tc_exact_state *s, const context *x, int32_t r,
                                bool encode)
{
    int32_t half = x->shift ? 1 << (x->shift - 1) : 0, high = (r + half) >> x->shift;
    uint32_t size = (uint32_t)(high < 0 ? -high : high), n = 0;
    if (decide(c, coder, x, 0, high != 0, encode)) {
        int away = decide(c, coder, x, 1, high < 0, encode), first = away ? AWAY : TOWARDS;
        while (n < UNARY && decide(c, coder, x, first + (int)n, size > n + 1, encode))
            n++;
        if (n == UNARY) {
            uint32_t beyond = encode ? size - UNARY : 0;
            int length = 0, bits = 31 - __builtin_clz(beyond | 1);
            while (length < MOST_LENGTH && tc_mix_plain(&c->tables, coder, &s->length[length], bits > length, encode))
                length++;
            n += tc_mix_raw(coder, beyond, length, encode) | (uint32_t)1 << length;
            n--;
        }
        n++;
        high = away ? -(int32_t)n : (int32_t)n;
    } else {
        high = 0;
    }
    uint32_t low = tc_mix_raw(coder, (uint32_t)(r + half), x->shift, encode);
    return (int32_t)(((uint32_t)high << x->shift) + low - (uint32_t)half);
}

TC_INLINE context find_context(tc_exact_state *s, uint32_t scale, int fraction16, const int32_t *e, bool flip,
                               int phase)
{
    static const uint8_t fraction_bin[TC_EXACT_PART / 2 + 1] = {0, 0, 1, 2, 3, 3, 4, 5, 5};
    context x;
    x.shift = scale_shift(scale);
    int fraction = x.shift ? 0 : fraction_bin[fraction16], octave = 31 - __builtin_clz(scale);
    int bin = 4 * (octave - SCALE_OCTAVE) + (int)(scale >> (octave - 2) & 3);
    while (bin >= TC_EXACT_BINS)
        bin -= 4;
    int bin3 = bin / 3, level = limited(bin * 3 / 8, TC_EXACT_LEVELS3 - 1);
    int32_t sign = flip ? -2048 : 2048, far = (int32_t)scale;
    int32_t w = e[-1] * sign, n = e[-TC_EXACT_ROW] * sign, ne = e[1 - TC_EXACT_ROW] * sign;
    int wq = (w >= -3 * far) + (w >= -far) + (w >= far) + (w >= 3 * far);
    int nq = (n >= -3 * far) + (n >= -far) + (n >= far) + (n >= 3 * far);
    int neq = (ne >= -2 * far) + (ne >= 2 * far);
    x.scale = s->scale[bin * TC_EXACT_FRACTIONS + fraction];
    x.phase = s->phase[(bin3 * TC_EXACT_PHASES + phase) * TC_EXACT_FRACTIONS + fraction];
    x.pattern = s->pattern[(((wq * 5 + nq) * 3 + neq) * TC_EXACT_LEVELS3 + level) * 3 + fraction / 2];
    x.weight = s->weight[bin3];
    return x;
}

/* ---- A tile -------------------------------------------------------------------------------------------------- */

TC_INLINE tc_status code_tile(const tc_exact *c, tc_rect tile, tc_mix_coder *coder, const tc_plane *fine,
                              tc_exact_work *w, bool encode)
{
    tc_exact_state *s = &w->state;
    int columns = (int)(tile.x1 - tile.x0), rows = (int)(tile.y1 - tile.y0);
    int32_t step = c->model.step;
    int64_t most = TC_LIFTING_LIMIT / step, base = w->base;
    for (int y = 0; y < rows; y++) {
        int32_t *z = tc_plane_at(fine, tile.x0, tile.y0 + y);
        int32_t *signal = &w->signal[y + TC_EXACT_REACH][TC_EXACT_REACH];
        int32_t *error = &w->error[y + TC_EXACT_REACH][TC_EXACT_REACH];
        for (int x = 0; x < columns; x++) {
            int phase = (y & 1) * 2 + (x & 1);
            int32_t p = tc_exact_predict(w, c->model.predict[phase] + TC_EXACT_COARSE, x, y);
            p = tc_exact_clamp(p, 2 * TC_EXACT_RELIEF);
            int32_t nearest = (p + TC_EXACT_PART / 2) >> 4, fraction = p - nearest * TC_EXACT_PART;
            bool flip = fraction < 0;
            uint32_t f[TC_EXACT_SCALES - 1], scale;
            const uint16_t *weight = c->model.scale[phase];
            tc_exact_scale_features(w, x, y, f);
            scale = 16u * weight[TC_EXACT_SCALES - 1] + TC_EXACT_SCALE_LEAST;
            for (int k = 0; k < TC_EXACT_SCALES - 1; k++)
                scale += weight[k] * f[k];
            scale = scale < TC_EXACT_SCALE_MOST ? scale : TC_EXACT_SCALE_MOST;
            context at = find_context(s, scale, flip ? -fraction : fraction, error + x, flip, phase);
            int32_t r = 0;
            if (encode) {
                r = (int32_t)(z[x] / step - base - nearest);
                r = flip ? -r : r;
            }
            r = code_distance(c, coder, s, &at, r, encode);
            int64_t k = (int64_t)nearest + (flip ? -(int64_t)r : r);
            if (!encode) {
                if (k + base < -most || k + base > most)
                    return TC_ERR_FORMAT;
                z[x] = (int32_t)((k + base) * step);
            }
            signal[x] = tc_exact_clamp(k * TC_EXACT_PART - w->up[y][x], TC_EXACT_SIGNAL);
            error[x] = tc_exact_clamp(k * TC_EXACT_PART - p, TC_EXACT_ERROR);
        }
    }
    return TC_OK;
}

tc_status tc_exact_encode_tile(const tc_exact *c, int64_t tx, int64_t ty, const tc_plane *coarse, const tc_plane *fine,
                               uint8_t *bytes, size_t *size_ret, tc_exact_work *work)
{
    tc_rect tile = tc_exact_tile_rect(c, tx, ty);
    int32_t step = c->model.step, most = TC_LIFTING_LIMIT;
    for (int64_t y = tile.y0; y < tile.y1; y++)
        for (int64_t x = tile.x0; x < tile.x1; x++) {
            int32_t z = *tc_plane_at(fine, x, y);
            if (z < -most || z > most || z % step)
                return TC_ERR_USAGE;
        }
    tc_exact_prepare(c, tx, ty, coarse, work);
    work->state = c->start;
    tc_mix_coder coder;
    tc_mix_encode_begin(&coder, bytes, tc_exact_tile_bound());
    code_tile(c, tile, &coder, fine, work, true);
    *size_ret = tc_mix_encode_end(&coder, bytes);
    return TC_OK;
}

tc_status tc_exact_decode_tile(const tc_exact *c, int64_t tx, int64_t ty, const uint8_t *bytes, size_t size,
                               const tc_plane *coarse, const tc_plane *fine, tc_exact_work *work)
{
    tc_exact_prepare(c, tx, ty, coarse, work);
    work->state = c->start;
    tc_mix_coder coder;
    tc_mix_decode_begin(&coder, bytes, size);
    tc_status status = code_tile(c, tc_exact_tile_rect(c, tx, ty), &coder, fine, work, false);
    return status ? status : tc_mix_decode_end(&coder) ? TC_OK : TC_ERR_FORMAT;
}
