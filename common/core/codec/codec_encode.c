/* codec_encode.c - encoding a tile: quantisation with an eye on the rate, then the streams of codec_tile.c.
 *
 * Of the two or three magnitudes near a coefficient, the one with the least squared error + lambda * bits is taken, in
 * squared steps, as the contexts stand (greedy rate-distortion optimised quantisation; Sullivan, Wiegand 1998). A band
 * of a tile that costs more than it mends is left out whole. */
#include <math.h>
#include <stdlib.h>

#include "codec_tile.h"

static const double TILE_BITS = 96; /* what having a tile at all costs: head of the stream, index entry, checksum */
enum {
    MOST_MAGNITUDE = 1 << 24,
    EIGHT_FROM = 64 /* raw bytes; four more lanes cost about four bytes */
};

typedef struct coder {
    const tc_codec *codec;
    double lambda; /* 0: plain rounding */
    float bits[TC_BINS][TC_RANS_SYMBOLS];
} coder;

static uint32_t escape_length(uint32_t beyond)
{
    uint32_t n = 0;
    while ((beyond + 1) >> (n + 1))
        n++;
    return n;
}

static double magnitude_bits(const coder *e, int bin, uint32_t magnitude)
{
    uint32_t shift = tc_bin_shift[bin], symbol = magnitude >> shift, most = TC_RANS_SYMBOLS - 1;
    double bits = shift + (magnitude > 0);
    if (symbol >= most)
        bits += 2 * escape_length(symbol - most) + 1, symbol = most;
    return bits + e->bits[bin][symbol];
}

/* What a band costs: squared error in squared steps, and bits. */
typedef struct cost {
    double error, bits;
} cost;

/* Chooses a magnitude for |residual| / step. */
static uint32_t choose(const coder *e, double lambda, int bin, double size, cost *sum)
{
    uint32_t best = (uint32_t)(size + 0.5);
    cost least = {(size - best) * (size - best), magnitude_bits(e, bin, best)};
    if (best > 0 && lambda > 0) {
        uint32_t other[2] = {best - 1, 0};
        for (int n = 0; n < (best == 2 ? 2 : 1); n++) {
            cost now = {(size - other[n]) * (size - other[n]), magnitude_bits(e, bin, other[n])};
            if (now.error + lambda * now.bits < least.error + lambda * least.bits)
                least = now, best = other[n];
        }
    }
    sum->error += least.error, sum->bits += least.bits;
    return best;
}

/* Quantises a band against w's prediction (rows of `pred`, stride `stride`; NULL: zero), which becomes the
 * reconstruction. False where a magnitude is out of range. *coded: whether anything is left of it. */
static bool quantise_band(const coder *e, int band, tc_rect tile, const tc_plane *truth, int32_t *pred,
                          ptrdiff_t stride, double *spare, cost *total, bool *coded, tc_tile_work *w)
{
    const tc_codec *c = e->codec;
    int columns, rows;
    tc_tile_extent(c, band, tile, 0, &columns, &rows);
    int32_t step = c->model.step[band];
    double inverse = 1.0 / step, zero = 0, lambda = step == 1 ? 0 : e->lambda;
    cost sum = {0, 0};
    bool any = false;
    for (int j = 0; j < rows; j++) {
        const int32_t *t = tc_plane_at(truth, tile.x0, tile.y0 + j);
        int32_t *p = pred ? pred + j * stride : NULL;
        for (int phase = 0; phase < TC_PHASES; phase++) {
            uint8_t *bin = w->bin[band][j][phase], *seen = magnitude_at(w, band, j, phase);
            tc_context_bins(c, w, band, j, phase, bin);
            int count = tc_phase_columns(columns, phase);
            for (int k = 0; k < count; k++) {
                int i = TC_PHASES * k + phase;
                int32_t residual = (int32_t)((uint32_t)t[i] - (p ? (uint32_t)p[i] : 0));
                double size = fabs((double)residual) * inverse;
                if (size >= MOST_MAGNITUDE)
                    return false;
                uint32_t magnitude = choose(e, lambda, bin[k], size, &sum);
                zero += size * size;
                any |= magnitude != 0;
                w->value[band][j][i] = residual < 0 ? -(int32_t)magnitude : (int32_t)magnitude;
                uint32_t symbol = magnitude >> tc_bin_shift[bin[k]];
                symbol = symbol < TC_RANS_SYMBOLS ? symbol : TC_RANS_SYMBOLS - 1;
                w->symbol[band][j][phase][k] = (uint8_t)symbol;
                seen[k] = tc_context_magnitude(symbol, bin[k]);
            }
        }
    }
    *coded = any;
    if (any && lambda > 0 && zero <= sum.error + lambda * (sum.bits + *spare))
        *coded = false;
    if (any && !*coded)
        memset(w->magnitude[band], 0, sizeof w->magnitude[band]);
    *total = *coded ? (cost){sum.error, sum.bits + *spare} : (cost){zero, 0};
    *spare = *coded ? 0 : *spare;
    for (int j = 0; j < rows && *coded && pred; j++)
        for (int i = 0; i < columns; i++)
            pred[j * stride + i] =
                (int32_t)((uint32_t)pred[j * stride + i] + (uint32_t)w->value[band][j][i] * (uint32_t)step);
    return true;
}

/* ---- Streams ------------------------------------------------------------------------------------------------- */

typedef struct raw_writer {
    uint8_t *bytes;
    size_t size; /* whole bytes */
    uint64_t held;
    int count;
} raw_writer;

static void put(raw_writer *r, uint32_t value, int n)
{
    r->held |= (uint64_t)value << r->count;
    for (r->count += n; r->count >= 8; r->count -= 8, r->held >>= 8)
        r->bytes[r->size++] = (uint8_t)r->held;
}

static void put_escape(raw_writer *r, uint32_t beyond)
{
    int n = (int)escape_length(beyond);
    for (int i = 0; i < n; i++)
        put(r, 1, 1);
    put(r, 0, 1); /* not written after 24 ones: never so long */
    put(r, beyond + 1 - (1u << n), n);
}

/* Raw bits of a run. */
static void put_run(raw_writer *raw, int band, int j, int phase, int count, const tc_tile_work *w)
{
    const uint8_t *symbol = w->symbol[band][j][phase], *bin = w->bin[band][j][phase];
    const int32_t *value = w->value[band][j] + phase;
    for (int k = 0; k < count; k++) {
        int shift = tc_bin_shift[bin[k]];
        uint32_t magnitude = (uint32_t)abs(value[TC_PHASES * k]);
        if (symbol[k] == TC_RANS_SYMBOLS - 1)
            put_escape(raw, (magnitude >> shift) - (TC_RANS_SYMBOLS - 1));
        put(raw, magnitude & ((1u << shift) - 1), shift);
    }
    for (int k = 0; k < count; k++)
        if (value[TC_PHASES * k])
            put(raw, value[TC_PHASES * k] < 0, 1);
}

enum { RAW_BITS = 4 + 2 * 24 + 1 + 1 };

size_t tc_codec_tile_bound(void)
{
    return 1 + tc_rans_bound(TC_TILE_SYMBOLS) + TC_RANS_PAYLOAD + (size_t)TC_TILE_SYMBOLS * RAW_BITS / 8 + 8;
}

/* Writes the tile from w's symbols and values. */
static size_t write_tile(const coder *e, int coded, tc_rect tile, uint8_t *bytes, tc_tile_work *w)
{
    const tc_codec *c = e->codec;
    /* Raw bits go where the longest rANS stream would end, the stream in front of them; then all moves to the front. */
    uint8_t *middle = bytes + 1 + tc_rans_bound(TC_TILE_SYMBOLS);
    raw_writer raw = {middle, 0, 0, 0};
    size_t count = 0;
    for (int b = 0; b < TC_BANDS; b++) {
        int columns, rows;
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        for (int j = 0; j < rows && coded >> b & 1; j++)
            for (int phase = 0; phase < TC_PHASES; phase++) {
                int n = tc_phase_columns(columns, phase);
                put_run(&raw, b, j, phase, n, w);
                for (int k = 0; k < n; k++)
                    w->order[count++] =
                        (uint16_t)(w->bin[b][j][phase][k] << 7 | w->symbol[b][j][phase][k] << 3 | k % TC_RANS_LANES);
            }
    }
    if (raw.count > 0)
        put(&raw, 0, 8 - raw.count);
    int lanes = raw.size > EIGHT_FROM ? 8 : 4;
    size_t carried = 2 * (size_t)lanes;
    while (raw.size < carried)
        raw.bytes[raw.size++] = 0;

    uint16_t start[TC_BINS][TC_RANS_SYMBOLS];
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0, at = 0; s < TC_RANS_SYMBOLS; at += c->model.symbols[b].of[s++])
            start[b][s] = (uint16_t)at;
    uint8_t payload[TC_RANS_PAYLOAD];
    memcpy(payload, raw.bytes, carried);
    tc_rans_encoder rans;
    tc_rans_encode_begin(&rans, lanes, bytes + 1, middle, payload);
    while (count-- > 0) {
        int bin = w->order[count] >> 7, symbol = w->order[count] >> 3 & 15, lane = w->order[count] & (lanes - 1);
        tc_rans_encode(&rans, lane, start[bin][symbol], c->model.symbols[bin].of[symbol]);
    }
    tc_rans_encode_end(&rans);
    size_t words = (size_t)(middle - rans.at), rest = raw.size - carried;
    bytes[0] = (uint8_t)(coded | (lanes == 8 ? TC_TILE_EIGHT : 0));
    memmove(bytes + 1, rans.at, words);
    memmove(bytes + 1 + words, middle + carried, rest);
    return 1 + words + rest;
}

static void count_symbols(const tc_codec *c, int coded, tc_rect tile, tc_symbol_counts *count, const tc_tile_work *w)
{
    for (int b = 0; b < TC_BANDS; b++) {
        int columns, rows;
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        for (int j = 0; j < rows && coded >> b & 1; j++)
            for (int phase = 0; phase < TC_PHASES; phase++)
                for (int k = 0; k < tc_phase_columns(columns, phase); k++)
                    count->of[w->bin[b][j][phase][k]][w->symbol[b][j][phase][k]]++;
    }
}

tc_status tc_codec_encode_tile(const tc_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                               const tc_plane band[TC_BANDS], const tc_encode_options *options, uint8_t *bytes,
                               size_t *size_ret, tc_tile_work *work)
{
    tc_encode_options none = {0};
    options = options ? options : &none;
    coder e = {.codec = codec, .lambda = options->lambda};
    e.lambda = e.lambda == 0 ? TC_DEFAULT_LAMBDA : e.lambda < 0 ? 0 : e.lambda;
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            e.bits[b][s] = (float)(TC_RANS_BITS - log2(codec->model.symbols[b].of[s]));
    tc_rect tile = tc_codec_tile_rect(codec, tx, ty, 0);
    tc_tile_load(codec, tile, coarse, work);
    tc_tile_curves(codec, work);
    memset(work->magnitude, 0, sizeof work->magnitude);
    double spare = TILE_BITS;
    cost total[TC_BANDS];
    bool coded[TC_BANDS];
    tc_predict_hl(codec, work);
    if (!quantise_band(&e, TC_HL, tile, &band[TC_HL], &work->hl[1][HL_X], HL_STRIDE, &spare, &total[TC_HL],
                       &coded[TC_HL], work))
        return TC_ERR_UNSUPPORTED;
    tc_predict_lh(codec, work);
    if (!quantise_band(&e, TC_LH, tile, &band[TC_LH], work->pred[0], TC_TILE, &spare, &total[TC_LH], &coded[TC_LH],
                       work) ||
        !quantise_band(&e, TC_HH, tile, &band[TC_HH], NULL, 0, &spare, &total[TC_HH], &coded[TC_HH], work))
        return TC_ERR_UNSUPPORTED;
    int flags = coded[TC_HL] << TC_HL | coded[TC_LH] << TC_LH | coded[TC_HH] << TC_HH;
    if (options->count)
        count_symbols(codec, flags, tile, options->count, work);
    for (int b = 0; b < TC_BANDS; b++) {
        if (options->bits)
            options->bits[b] += total[b].bits;
        if (options->error)
            options->error[b] += total[b].error;
    }
    *size_ret = flags && bytes ? write_tile(&e, flags, tile, bytes, work) : 0;
    return TC_OK;
}
