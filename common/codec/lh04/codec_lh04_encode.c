/* codec_lh04_encode.c - encoding a tile of residuals: transform, quantisation as in codec_encode.c, streams.
 *
 * A frequency of a tile that costs more than it mends is left out whole, and so is a tile. */
#include <math.h>
#include <stdlib.h>

#include "codec_lh04_tile.h"
#include "common/codec/entropy/raw_bits.h"

static const double TILE_BITS = 96; /* what having a tile at all costs: head of the stream, index entry, checksum */
enum {
    MOST_MAGNITUDE = 1 << 24,
    EIGHT_FROM = 64 /* raw bytes; four more lanes cost about four bytes */
};

/* ---- Transform ----------------------------------------------------------------------------------------------- */

/* Improves the inverse x of a matrix of n rows, from its transpose on, by Newton's iteration: the integers that the
 * decoder works with are only nearly orthogonal, which would show where relief is large against the step. */
static void invert(int n, const double *a, double *x)
{
    for (int round = 0; round < 3; round++) {
        double rest[SIDE * SIDE], next[SIDE * SIDE];
        for (int i = 0; i < n * n; i++) {
            rest[i] = i / n == i % n ? 2 : 0;
            for (int k = 0; k < n; k++)
                rest[i] -= a[i / n * n + k] * x[k * n + i % n];
        }
        for (int i = 0; i < n * n; i++) {
            next[i] = 0;
            for (int k = 0; k < n; k++)
                next[i] += x[i / n * n + k] * rest[k * n + i % n];
        }
        memcpy(x, next, (size_t)(n * n) * sizeof *x);
    }
}

/* Inverses of the decoder's filter and of its DCT. */
static void invert_transforms(double lap[4][4], double dct[SIDE][SIDE])
{
    double filter[4][4], blocks[SIDE][SIDE];
    for (int n = 0; n < 4; n++)
        for (int k = 0; k < 4; k++)
            lap[k][n] = filter[n][k] = tc_lh04_lap[n][k] / (double)(1 << LAP_BITS);
    for (int n = 0; n < SIDE; n++)
        for (int k = 0; k < SIDE; k++)
            dct[n][k] = blocks[k][n] = tc_lh04_dct[n][k] / sqrt(32768);
    invert(4, filter[0], lap[0]);
    invert(SIDE, blocks[0], dct[0]);
}

/* Undoes the filter across an edge. */
static void unlap(const double inverse[4][4], double *x, ptrdiff_t stride)
{
    double s[4], d[4];
    for (int n = 0; n < 4; n++)
        s[n] = x[(3 - n) * stride] + x[(4 + n) * stride], d[n] = x[(3 - n) * stride] - x[(4 + n) * stride];
    for (int n = 0; n < 4; n++) {
        double e = inverse[n][0] * d[0] + inverse[n][1] * d[1] + inverse[n][2] * d[2] + inverse[n][3] * d[3];
        x[(3 - n) * stride] = (s[n] + e) / 2, x[(4 + n) * stride] = (s[n] - e) / 2;
    }
}

/* Coefficients in steps. Samples that a block at the level's border lacks are those of its last column and row. */
static void forward(const tc_lh04_codec *c, tc_rect tile, tc_lh04_work *w)
{
    int columns, rows;
    int64_t width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    double scale = 1.0 / c->model.step, lap[4][4], dct[SIDE][SIDE];
    tc_lh04_extent(tile, &columns, &rows);
    invert_transforms(lap, dct);
    for (int y = 0; y < rows * SIDE; y++) {
        const int32_t *z = w->residual[tc_min64(y, height - 1)];
        for (int x = 0; x < columns * SIDE; x++)
            w->smooth[y][x] = z[tc_min64(x, width - 1)];
        for (int x = SIDE; x < columns * SIDE; x += SIDE)
            unlap(lap, &w->smooth[y][x - SIDE / 2], 1);
    }
    for (int y = SIDE; y < rows * SIDE; y += SIDE)
        for (int x = 0; x < columns * SIDE; x++)
            unlap(lap, &w->smooth[y - SIDE / 2][x], SPAN);
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            double half[SIDE][SIDE]; /* [y][u] */
            for (int y = 0; y < SIDE; y++) {
                const double *x = &w->smooth[j * SIDE + y][i * SIDE];
                for (int u = 0; u < SIDE; u++) {
                    double sum = 0;
                    for (int n = 0; n < SIDE; n++)
                        sum += dct[u][n] * x[n];
                    half[y][u] = sum;
                }
            }
            for (int v = 0; v < SIDE; v++)
                for (int u = 0; u < SIDE; u++) {
                    double sum = 0;
                    for (int n = 0; n < SIDE; n++)
                        sum += dct[v][n] * half[n][u];
                    w->exact[SIDE * v + u][j][i] = sum * scale;
                }
        }
}

/* ---- Quantisation -------------------------------------------------------------------------------------------- */

typedef struct coder {
    const tc_lh04_codec *codec;
    double lambda; /* 0: plain rounding */
    float bits[TC_BINS][TC_RANS_SYMBOLS];
} coder;

/* Squared error in squared steps, and bits. */
typedef struct cost {
    double error, bits;
} cost;

static double magnitude_bits(const coder *e, int bin, uint32_t magnitude)
{
    uint32_t shift = tc_bin_shift[bin], symbol = magnitude >> shift, most = TC_RANS_SYMBOLS - 1;
    double bits = shift + (magnitude > 0);
    if (symbol >= most)
        bits += 2 * tc_escape_length(symbol - most) + 1, symbol = most;
    return bits + e->bits[bin][symbol];
}

/* Chooses a magnitude for one of `size` steps. */
static uint32_t choose(const coder *e, int bin, double size, cost *sum)
{
    uint32_t best = (uint32_t)(size + 0.5);
    cost least = {(size - best) * (size - best), magnitude_bits(e, bin, best)};
    if (best > 0 && e->lambda > 0) {
        uint32_t other[2] = {best - 1, 0};
        for (int n = 0; n < (best == 2 ? 2 : 1); n++) {
            cost now = {(size - other[n]) * (size - other[n]), magnitude_bits(e, bin, other[n])};
            if (now.error + e->lambda * now.bits < least.error + e->lambda * least.bits)
                least = now, best = other[n];
        }
    }
    sum->error += least.error, sum->bits += least.bits;
    return best;
}

static double flag_bits(const tc_lh04_codec *c, int flag, bool coded)
{
    uint32_t empty = tc_lh04_empty(c, flag);
    return TC_RANS_BITS - log2(coded ? TC_RANS_SLOTS - empty : empty);
}

/* Quantises a frequency. False where a magnitude is out of range. */
static bool quantise_band(const coder *e, int place, int columns, int rows, cost *total, double *zero_ret,
                          tc_lh04_work *w)
{
    const tc_lh04_band *b = &e->codec->band[place];
    int flag = tc_lh04_flag(b, w->coded);
    cost sum = {0, flag_bits(e->codec, flag, true)};
    double zero = 0, none = flag_bits(e->codec, flag, false);
    bool any = false;
    for (int j = 0; j < rows; j++) {
        tc_lh04_row(b, j, w);
        for (int p = 0; p < TC_PHASES; p++) {
            uint8_t *bin = w->bin[place][j][p], *seen = seen_at(w, place, j, p);
            tc_lh04_bins(b, w, place, p, j, bin);
            for (int k = 0; k < tc_lh04_run(columns, p); k++) {
                int i = TC_PHASES * k + p;
                double exact = w->exact[b->index][j][i], size = fabs(exact);
                if (size >= MOST_MAGNITUDE)
                    return false;
                uint32_t magnitude = choose(e, bin[k], size, &sum), symbol = magnitude >> tc_bin_shift[bin[k]];
                zero += size * size;
                any |= magnitude != 0;
                w->value[b->index][j][i] = exact < 0 ? -(int32_t)magnitude : (int32_t)magnitude;
                symbol = symbol < TC_RANS_SYMBOLS ? symbol : TC_RANS_SYMBOLS - 1;
                w->symbol[place][j][p][k] = (uint8_t)symbol;
                seen[k] = tc_lh04_seen(symbol, bin[k]);
            }
        }
    }
    w->coded[place] = any && !(e->lambda > 0 && zero + e->lambda * none <= sum.error + e->lambda * sum.bits);
    *zero_ret += zero;
    if (w->coded[place]) {
        total->error += sum.error, total->bits += sum.bits;
        tc_lh04_add(w, place, rows);
    } else {
        total->error += zero, total->bits += none;
        memset(w->seen[place], 0, sizeof w->seen[place]);
    }
    return true;
}

/* ---- Streams ------------------------------------------------------------------------------------------------- */

/* Raw bits of a run. */
static void put_run(tc_raw_writer *raw, const uint8_t *symbol, const uint8_t *bin, const int32_t *value, int count)
{
    for (int k = 0; k < count; k++) {
        int shift = tc_bin_shift[bin[k]];
        uint32_t magnitude = (uint32_t)abs(value[TC_PHASES * k]);
        if (symbol[k] == TC_RANS_SYMBOLS - 1)
            tc_raw_put_escape(raw, (magnitude >> shift) - (TC_RANS_SYMBOLS - 1));
        tc_raw_put(raw, magnitude & ((1u << shift) - 1), shift);
    }
    for (int k = 0; k < count; k++)
        if (value[TC_PHASES * k])
            tc_raw_put(raw, value[TC_PHASES * k] < 0, 1);
}

enum { TILE_SYMBOLS = BANDS * BLOCKS * BLOCKS, RAW_BITS = TC_ESCAPE_BITS + 4 + 1 };

size_t tc_lh04_tile_bound(void)
{
    return 1 + tc_rans_bound(TILE_SYMBOLS + BANDS) + TC_RANS_PAYLOAD + (size_t)TILE_SYMBOLS * RAW_BITS / 8 + 8;
}

/* Writes the tile from w's symbols and values. */
static size_t write_tile(const tc_lh04_codec *c, int columns, int rows, uint8_t *bytes, tc_lh04_work *w)
{
    /* Raw bits go where the longest rANS stream would end, the stream in front of them; then all moves to the front. */
    uint8_t *middle = bytes + 1 + tc_rans_bound(TILE_SYMBOLS + BANDS);
    tc_raw_writer raw = {middle, 0, 0, 0};
    size_t count = 0;
    for (int n = 0; n < BANDS; n++)
        for (int j = 0; j < rows && w->coded[n]; j++)
            for (int p = 0; p < TC_PHASES; p++) {
                const uint8_t *bin = w->bin[n][j][p], *symbol = w->symbol[n][j][p];
                int run = tc_lh04_run(columns, p);
                put_run(&raw, symbol, bin, &w->value[c->band[n].index][j][p], run);
                for (int k = 0; k < run; k++)
                    w->order[count++] = (uint16_t)(bin[k] << 7 | symbol[k] << 3 | k);
            }
    int lanes = raw.size > EIGHT_FROM ? 8 : 4;
    size_t carried = 2 * (size_t)lanes;
    tc_raw_finish(&raw, carried);

    tc_rans_symbol put[TC_BINS][TC_RANS_SYMBOLS];
    for (int b = 0; b < TC_BINS; b++)
        tc_rans_symbols_build(&c->model.symbols[b], put[b]);
    uint8_t payload[TC_RANS_PAYLOAD];
    memcpy(payload, raw.bytes, carried);
    tc_rans_encoder rans;
    tc_rans_encode_begin(&rans, lanes, bytes + 1, middle, payload);
    while (count-- > 0) {
        int bin = w->order[count] >> 7, symbol = w->order[count] >> 3 & 15, lane = w->order[count] & (lanes - 1);
        tc_rans_put(&put[bin][symbol], &rans.state[lane], &rans.at);
    }
    for (int n = BANDS - 1; n >= 0; n--) {
        uint32_t empty = tc_lh04_empty(c, tc_lh04_flag(&c->band[n], w->coded));
        tc_rans_symbol flag = tc_rans_symbol_of(w->coded[n] ? empty : 0, w->coded[n] ? TC_RANS_SLOTS - empty : empty);
        tc_rans_put(&flag, &rans.state[n & (lanes - 1)], &rans.at);
    }
    tc_rans_encode_end(&rans);
    size_t words = (size_t)(middle - rans.at), rest = raw.size - carried;
    bytes[0] = lanes == 8 ? TILE_EIGHT : 0;
    memmove(bytes + 1, rans.at, words);
    memmove(bytes + 1 + words, middle + carried, rest);
    return 1 + words + rest;
}

static void count_symbols(const tc_lh04_codec *c, int columns, int rows, tc_lh04_counts *count, const tc_lh04_work *w)
{
    for (int n = 0; n < BANDS; n++) {
        count->flag[tc_lh04_flag(&c->band[n], w->coded)][w->coded[n]]++;
        for (int j = 0; j < rows && w->coded[n]; j++)
            for (int p = 0; p < TC_PHASES; p++)
                for (int k = 0; k < tc_lh04_run(columns, p); k++)
                    count->of[w->bin[n][j][p][k]][w->symbol[n][j][p][k]]++;
    }
}

tc_status tc_lh04_encode_tile(const tc_lh04_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                              const tc_plane *fine, const tc_lh04_options *options, uint8_t *bytes, size_t *size_ret,
                              tc_lh04_work *w)
{
    tc_lh04_options none = {0};
    options = options ? options : &none;
    coder e = {.codec = codec, .lambda = options->lambda};
    e.lambda = e.lambda == 0 ? TC_LH04_LAMBDA : e.lambda < 0 ? 0 : e.lambda;
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            e.bits[b][s] = (float)(TC_RANS_BITS - log2(codec->model.symbols[b].of[s]));
    tc_rect tile = tc_lh04_tile_rect(codec, tx, ty, 0);
    tc_plane residual = {w->residual[0], SPAN, tile};
    tc_lh04_assemble(&codec->level, coarse, NULL, &residual);
    for (int64_t y = tile.y0; y < tile.y1; y++) {
        const int32_t *z = tc_plane_at(fine, tile.x0, y);
        for (int64_t i = 0; i < tile.x1 - tile.x0; i++) {
            int32_t *r = &w->residual[y - tile.y0][i];
            *r = (int32_t)((uint32_t)z[i] - (uint32_t)*r);
        }
    }
    forward(codec, tile, w);
    int columns, rows;
    tc_lh04_extent(tile, &columns, &rows);
    memset(w->seen, 0, sizeof w->seen), memset(w->total, 0, sizeof w->total), memset(w->coded, 0, sizeof w->coded);
    cost total = {0, 0};
    double zero = 0;
    bool coded = false;
    for (int n = 0; n < BANDS; n++) {
        if (!quantise_band(&e, n, columns, rows, &total, &zero, w))
            return TC_ERR_UNSUPPORTED;
        coded |= w->coded[n];
    }
    coded = coded && !(e.lambda > 0 && zero <= total.error + e.lambda * (total.bits + TILE_BITS));
    if (options->count && coded)
        count_symbols(codec, columns, rows, options->count, w);
    if (options->bits)
        *options->bits += coded ? total.bits + TILE_BITS : 0;
    if (options->error)
        *options->error += coded ? total.error : zero;
    *size_ret = coded ? write_tile(codec, columns, rows, bytes, w) : 0;
    return TC_OK;
}
