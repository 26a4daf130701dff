/* void_mask.c - coding of void masks (void_mask.h).
 *
 * Bytes of a tile: samples are coded row by row, the known ones (both coordinates even) left out, in the adaptive
 * binary code of binary_coder.h. Contexts are scored (void_mask_model.c), the score divided by 16 chooses one of 48
 * probabilities, each for the three kinds of samples, that adapt by 1 / n: they start as if 24 samples had been seen,
 * and reach back 200 at most. Where that would take no less room than a bit a sample, the samples themselves
 * follow each other, most significant bit first: (samples + 7) / 8 bytes, which is how a decoder tells.
 *
 * Beyond the tile's own samples stand those of the coarser level to the south-west of them, nearest ones at the
 * level's border. */
#include "void_mask.h"

#include <string.h>

#include "common/codec/entropy/binary_coder.h"
#include "common/base/rect.h"

enum {
    SIDE = 2 * TC_TILE,
    ROW = SIDE + 2 * TC_MASK_REACH + 2, /* of the window; two more, so that eight bytes can be loaded at its end */
    FINE_BITS = 22,                     /* of a probability */
    COARSE_BITS = 12,                   /* of one that the coder takes */
    SEEN_FIRST = 24,
    SEEN_LAST = 200
};

/* The tile and what stands around it. */
typedef uint8_t window[SIDE + 2 * TC_MASK_REACH][ROW];

typedef struct probability {
    uint32_t valid; /* of a valid sample, in 2^-FINE_BITS */
    uint32_t seen;
} probability;

/* Either of the two coders, and what they share. */
typedef struct coder {
    probability of[3][TC_MASK_BINS];
    int uniform[3][2];            /* bin where all samples around are 0, are 1 */
    uint32_t step[SEEN_LAST + 1]; /* 2^16 / (n + 1/2) */
    bool decoding;
    union {
        tc_bit_encoder encoder;
        tc_bit_decoder decoder;
    } as;
} coder;

/* ---- Geometry ------------------------------------------------------------------------------------------------ */

tc_rect tc_mask_tile_rect(const tc_lifting_level *level, int64_t tx, int64_t ty, int64_t shift)
{
    return (tc_rect){tx * SIDE + shift, ty * SIDE, tc_min64((tx + 1) * SIDE, level->width) + shift,
                     tc_min64((ty + 1) * SIDE, level->height)};
}

tc_rect tc_mask_tile_needs(const tc_lifting_level *level, tc_rect tile)
{
    int64_t cw = tc_coarse_size(level->width), ch = tc_coarse_size(level->height);
    tc_rect r = {tile.x0 / 2 - TC_MASK_MARGIN, tc_max64(tile.y0 / 2 - TC_MASK_MARGIN, 0),
                 tc_ceil_shift(tile.x1, 1) + TC_MASK_MARGIN, tc_min64(tc_ceil_shift(tile.y1, 1) + TC_MASK_MARGIN, ch)};
    if (!level->wrap_x)
        r.x0 = tc_max64(r.x0, 0), r.x1 = tc_min64(r.x1, cw);
    return r;
}

static const uint8_t *at(const tc_mask_plane *p, int64_t x, int64_t y)
{
    return p->v + (y - p->rect.y0) * p->stride + (x - p->rect.x0);
}

void tc_mask_downsample(const tc_mask_plane *fine, const tc_mask_plane *coarse)
{
    for (int64_t y = coarse->rect.y0; y < coarse->rect.y1; y++) {
        uint8_t *row = coarse->v + (y - coarse->rect.y0) * coarse->stride;
        for (int64_t x = coarse->rect.x0; x < coarse->rect.x1; x++)
            row[x - coarse->rect.x0] = *at(fine, 2 * x, 2 * y);
    }
}

tc_mask_class tc_mask_classify(tc_rect tile, const tc_mask_plane *fine)
{
    bool valid = false, not_valid = false;
    for (int64_t y = tile.y0; y < tile.y1 && !(valid && not_valid); y++) {
        const uint8_t *row = at(fine, tile.x0, y);
        uint8_t any = 0, all = 1;
        for (int64_t x = 0; x < tile.x1 - tile.x0; x++)
            any |= row[x], all &= row[x];
        valid |= !all, not_valid |= any;
    }
    return valid && not_valid ? TC_MASK_CODED : not_valid ? TC_MASK_VOID : TC_MASK_VALID;
}

/* Fills the window from the coarser level. */
static void surround(const tc_lifting_level *level, tc_rect tile, const tc_mask_plane *coarse, window w)
{
    tc_rect needs = tc_mask_tile_needs(level, tile);
    int64_t rows = tile.y1 - tile.y0 + 2 * TC_MASK_REACH;
    memset(w, 0, sizeof(window));
    for (int64_t j = 0; j < rows; j++) {
        int64_t y = tc_clamp64(tc_floor_shift(tile.y0 + j - TC_MASK_REACH, 1), needs.y0, needs.y1 - 1);
        if (j > 0 && (j + TC_MASK_REACH) % 2 == 1) {
            memcpy(w[j], w[j - 1], ROW);
            continue;
        }
        const uint8_t *row = at(coarse, needs.x0, y);
        for (int64_t i = 0; i < tile.x1 - tile.x0 + 2 * TC_MASK_REACH; i++) {
            int64_t x = tc_clamp64(tc_floor_shift(tile.x0 + i - TC_MASK_REACH, 1), needs.x0, needs.x1 - 1);
            w[j][i] = row[x - needs.x0] != 0;
        }
    }
}

/* Samples of a tile that are not known from the coarser level. */
static size_t unknown(tc_rect tile)
{
    int64_t width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    return (size_t)(width * height - tc_coarse_size(width) * tc_coarse_size(height));
}

/* ---- Samples ------------------------------------------------------------------------------------------------- */

static int bin_of(int score)
{
    return (int)tc_clamp64(tc_floor_shift(score, 4) + TC_MASK_BINS / 2, 0, TC_MASK_BINS - 1);
}

static void begin(coder *c)
{
    for (int b = 0; b < TC_MASK_BINS; b++) {
        int half = TC_MASK_BINS / 2;
        uint32_t valid = b < half ? (1u << FINE_BITS) - tc_mask_start[half - 1 - b] : tc_mask_start[b - half];
        for (int kind = 0; kind < 3; kind++)
            c->of[kind][b] = (probability){valid, SEEN_FIRST};
    }
    for (int kind = 0; kind < 3; kind++) {
        const tc_mask_model *m = &tc_mask_models[kind];
        int score = m->score[(1 << TC_MASK_NEAR) - 1];
        for (int i = 0; i < m->far_count; i++)
            score += m->far[i].score;
        c->uniform[kind][0] = bin_of(m->score[0]);
        c->uniform[kind][1] = bin_of(score);
    }
    for (uint32_t n = SEEN_FIRST; n <= SEEN_LAST; n++)
        c->step[n] = (1u << 17) / (2 * n + 1);
}

/* The bin of the sample at s, within a window. */
static int context(const coder *c, int kind, const uint8_t *s)
{
    /* Nearly everywhere all is the same: the quick way to the same result. */
    uint64_t any = 0, all = UINT64_MAX;
    for (int y = -TC_MASK_REACH; y <= TC_MASK_REACH; y++) {
        uint64_t word;
        memcpy(&word, s + y * ROW - TC_MASK_REACH, sizeof word);
        any |= word, all &= word;
    }
    if (any == 0)
        return c->uniform[kind][0];
    if (all == 0x0101010101010101u)
        return c->uniform[kind][1];

    const tc_mask_model *m = &tc_mask_models[kind];
    unsigned near = 0;
    for (int i = 0; i < TC_MASK_NEAR; i++)
        near = 2 * near + s[m->near[i].y * ROW + m->near[i].x];
    int score = m->score[near];
    for (int i = 0; i < m->far_count; i++)
        score += s[m->far[i].y * ROW + m->far[i].x] ? m->far[i].score : 0;
    return bin_of(score);
}

/* Codes one sample: the value that it has, or gets. */
static inline uint8_t code(coder *c, int kind, const uint8_t *s, uint8_t value)
{
    probability *p = &c->of[kind][context(c, kind, s)];
    uint32_t valid = p->valid >> (FINE_BITS - COARSE_BITS);
    tc_bit_model model = (tc_bit_model)(valid < 1 ? 1 : valid);
    if (c->decoding)
        value = (uint8_t)tc_bit_decode(&c->as.decoder, &model);
    else
        tc_bit_encode(&c->as.encoder, &model, value);
    p->seen += p->seen < SEEN_LAST;
    if (value)
        p->valid -= (uint32_t)((uint64_t)p->valid * c->step[p->seen] >> 16);
    else
        p->valid += (uint32_t)((uint64_t)((1u << FINE_BITS) - 1 - p->valid) * c->step[p->seen] >> 16);
    return value;
}

/* Codes a tile's samples, which `fine` holds when encoding, and leaves them in the window. */
static void code_samples(coder *c, tc_rect tile, const tc_mask_plane *fine, window w)
{
    for (int64_t y = 0; y < tile.y1 - tile.y0; y++) {
        uint8_t *s = w[y + TC_MASK_REACH] + TC_MASK_REACH;
        const uint8_t *given = c->decoding ? NULL : at(fine, tile.x0, tile.y0 + y);
        for (int64_t x = 1 - y % 2; x < tile.x1 - tile.x0; x += 2 - y % 2) {
            int kind = (int)(y % 2 ? 1 + x % 2 : 0);
            s[x] = code(c, kind, s + x, given ? given[x] != 0 : 0);
        }
    }
}

/* ---- Tiles --------------------------------------------------------------------------------------------------- */

/* The samples themselves. */
static size_t pack_samples(tc_rect tile, const tc_mask_plane *fine, uint8_t *bytes)
{
    size_t n = 0;
    memset(bytes, 0, (unknown(tile) + 7) / 8);
    for (int64_t y = 0; y < tile.y1 - tile.y0; y++) {
        const uint8_t *row = at(fine, tile.x0, tile.y0 + y);
        for (int64_t x = 1 - y % 2; x < tile.x1 - tile.x0; x += 2 - y % 2, n++)
            bytes[n / 8] |= (uint8_t)((row[x] != 0) << (7 - n % 8));
    }
    return (n + 7) / 8;
}

/* Whether the bits that are left over are zero. */
static bool unpack_samples(tc_rect tile, const uint8_t *bytes, window w)
{
    size_t n = 0;
    for (int64_t y = 0; y < tile.y1 - tile.y0; y++) {
        uint8_t *s = w[y + TC_MASK_REACH] + TC_MASK_REACH;
        for (int64_t x = 1 - y % 2; x < tile.x1 - tile.x0; x += 2 - y % 2, n++)
            s[x] = bytes[n / 8] >> (7 - n % 8) & 1;
    }
    return n % 8 == 0 || (bytes[n / 8] << n % 8 & 0xff) == 0;
}

size_t tc_mask_encode(const tc_lifting_level *level, tc_rect tile, const tc_mask_plane *coarse,
                      const tc_mask_plane *fine, uint8_t *bytes)
{
    size_t packed = (unknown(tile) + 7) / 8;
    if (packed == 0)
        return 0;
    window w;
    coder c = {.decoding = false};
    surround(level, tile, coarse, w);
    begin(&c);
    tc_bit_encode_begin(&c.as.encoder, bytes, packed - 1);
    code_samples(&c, tile, fine, w);
    size_t size = tc_bit_encode_end(&c.as.encoder);
    return c.as.encoder.full ? pack_samples(tile, fine, bytes) : size;
}

tc_status tc_mask_decode(const tc_lifting_level *level, tc_rect tile, tc_mask_class class, const tc_mask_plane *coarse,
                         const uint8_t *bytes, size_t size, const tc_mask_plane *fine)
{
    tc_rect part = tc_rect_intersect(tile, fine->rect);
    size_t packed = (unknown(tile) + 7) / 8;
    bool whole = true;
    window w;
    if (class != TC_MASK_CODED) {
        whole = size == 0;
        for (int64_t y = part.y0; y < part.y1; y++)
            memset(fine->v + (y - fine->rect.y0) * fine->stride + (part.x0 - fine->rect.x0), class == TC_MASK_VOID,
                   (size_t)(part.x1 - part.x0));
        return whole ? TC_OK : TC_ERR_FORMAT;
    }
    surround(level, tile, coarse, w);
    if (size > packed) {
        whole = false; /* what stands in the window will do */
    } else if (size == packed) {
        whole = packed == 0 || unpack_samples(tile, bytes, w);
    } else {
        coder c = {.decoding = true};
        begin(&c);
        tc_bit_decode_begin(&c.as.decoder, bytes, size);
        code_samples(&c, tile, NULL, w);
        /* An encoder leaves zeros at the end out. */
        whole = tc_bit_decode_end(&c.as.decoder) && (size == 0 || bytes[size - 1] != 0);
    }
    for (int64_t y = part.y0; y < part.y1; y++)
        memcpy(fine->v + (y - fine->rect.y0) * fine->stride + (part.x0 - fine->rect.x0),
               w[y - tile.y0 + TC_MASK_REACH] + TC_MASK_REACH + (part.x0 - tile.x0), (size_t)(part.x1 - part.x0));
    return whole ? TC_OK : TC_ERR_FORMAT;
}
