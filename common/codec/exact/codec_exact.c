/* codec_exact.c - coding the tiles of an exact level (codec_exact.h).
 *
 * Encoder and decoder are one function, so that they cannot come apart. What is coded of a sample is r, its distance
 * in steps from the rounded prediction, counted towards the side on which the prediction was before rounding: is it
 * zero, which side, then in unary, the rest in an exponential Golomb code. Where errors are large the low bits of r go
 * raw. */
#include <string.h>

#include "exact_tile.h"

enum {
    FEW_CHANCE = 1 << 13, /* that a tile is coded by ranks, in 1/65536 */
    MOST_LENGTH = 27      /* of the exponential Golomb code */
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
    /* A decision takes 12 bits at most: a sample 2 + TC_EXACT_UNARY + MOST_LENGTH of them and fewer than 64 raw bits,
     * a value of the range one. */
    return (size_t)TC_EXACT_SIDE * TC_EXACT_SIDE * 64 + 2 * TC_EXACT_RANGE + 64;
}

/* ---- A sample ------------------------------------------------------------------------------------------------ */

typedef struct context {
    tc_mix_state *scale, *phase, *pattern;
    int32_t (*weight)[TC_MIX_INPUTS];
    int shift;
} context;

TC_INLINE int decide(const tc_exact *c, tc_mix_coder *coder, const context *x, int node, int bit, bool encode)
{
    return tc_mix_bit(&c->tables, coder, &x->scale[node], &x->phase[node], &x->pattern[tc_exact_pattern_node[node]],
                      x->weight[node], bit, encode);
}

/* Codes r, |r| < 2^26. */
TC_INLINE int32_t code_distance(const tc_exact *c, tc_mix_coder *coder, tc_exact_state *s, const context *x, int32_t r,
                                bool encode)
{
    int32_t half = x->shift ? 1 << (x->shift - 1) : 0, high = (r + half) >> x->shift;
    uint32_t size = (uint32_t)(high < 0 ? -high : high), n = 0;
    if (decide(c, coder, x, 0, high != 0, encode)) {
        int away = decide(c, coder, x, 1, high < 0, encode), first = away ? TC_EXACT_AWAY : TC_EXACT_TOWARDS;
        while (n < TC_EXACT_UNARY && decide(c, coder, x, first + (int)n, size > n + 1, encode))
            n++;
        if (n == TC_EXACT_UNARY) {
            uint32_t beyond = encode ? size - TC_EXACT_UNARY : 0;
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

/* scale: the expected error; ranks: the same in units of what is coded. */
TC_INLINE context find_context(tc_exact_state *s, uint32_t scale, uint32_t ranks, int fraction16, const int32_t *e,
                               bool flip, int phase)
{
    context x;
    x.shift = tc_exact_shift(ranks);
    int bin = tc_exact_bin(ranks), fraction = tc_exact_fraction(x.shift, fraction16);
    int bin3 = bin / 3, level = bin * 3 / 8 < TC_EXACT_LEVELS3 ? bin * 3 / 8 : TC_EXACT_LEVELS3 - 1;
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

/* few: samples are coded by their rank in w->values. */
TC_INLINE tc_status code_samples(const tc_exact *c, tc_rect tile, tc_mix_coder *coder, const tc_plane *fine,
                                 tc_exact_work *w, bool few, bool encode)
{
    tc_exact_state *s = &w->state;
    const tc_exact_values *v = &w->values;
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
            uint32_t scale = tc_exact_scale(w, c->model.scale[phase], x, y), ranks = scale;
            int32_t nearest = (p + TC_EXACT_PART / 2) >> 4, fraction = p - nearest * TC_EXACT_PART, r = 0;
            bool flip = fraction < 0;
            fraction = flip ? -fraction : fraction;
            if (few) {
                tc_exact_place at = tc_exact_values_place(v, p, scale);
                nearest = at.rank, fraction = at.fraction, flip = at.flip, ranks = at.scale;
            }
            context at = find_context(s, scale, ranks, fraction, error + x, flip, phase);
            if (encode) {
                r = (int32_t)(z[x] / step - base);
                r = (few ? v->below[r - v->first] : r) - nearest;
                r = flip ? -r : r;
            }
            r = code_distance(c, coder, s, &at, r, encode);
            int64_t k = (int64_t)nearest + (flip ? -(int64_t)r : r);
            if (few) {
                if (k < 0 || k >= v->count)
                    return TC_ERR_FORMAT;
                k = v->value[k] + v->first;
            }
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

static tc_status code_tile(const tc_exact *c, tc_rect tile, tc_mix_coder *coder, const tc_plane *fine, tc_exact_work *w,
                           bool few, bool encode)
{
    /* One copy of the code for each case. */
    if (tc_mix_code(coder, FEW_CHANCE, few, encode)) {
        if (!tc_exact_values_code(&c->tables, coder, &w->values, encode))
            return TC_ERR_FORMAT;
        return encode ? code_samples(c, tile, coder, fine, w, true, true)
                      : code_samples(c, tile, coder, fine, w, true, false);
    }
    return encode ? code_samples(c, tile, coder, fine, w, false, true)
                  : code_samples(c, tile, coder, fine, w, false, false);
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
    bool few = tc_exact_values_find(&c->tables, &work->values, fine, tile, step, work->base, bytes);
    tc_mix_encode_begin(&coder, bytes, tc_exact_tile_bound());
    code_tile(c, tile, &coder, fine, work, few, true);
    *size_ret = tc_mix_encode_end(&coder, bytes);
    tc_exact_raw raw;
    size_t raw_size = tc_exact_raw_size(fine, tile, step, &raw);
    if (raw_size < *size_ret) {
        tc_exact_raw_encode(fine, tile, step, &raw, bytes);
        *size_ret = raw_size;
    }
    return TC_OK;
}

tc_status tc_exact_decode_tile(const tc_exact *c, int64_t tx, int64_t ty, const uint8_t *bytes, size_t size,
                               const tc_plane *coarse, const tc_plane *fine, tc_exact_work *work)
{
    if (tc_exact_is_raw(bytes, size))
        return tc_exact_raw_decode(fine, tc_exact_tile_rect(c, tx, ty), c->model.step, bytes, size);
    if (size > 0 && bytes[size - 1] == 0)
        return TC_ERR_FORMAT;
    tc_exact_prepare(c, tx, ty, coarse, work);
    work->state = c->start;
    tc_mix_coder coder;
    tc_mix_decode_begin(&coder, bytes, size);
    tc_status status = code_tile(c, tc_exact_tile_rect(c, tx, ty), &coder, fine, work, false, false);
    return status ? status : tc_mix_decode_end(&coder) ? TC_OK : TC_ERR_FORMAT;
}
