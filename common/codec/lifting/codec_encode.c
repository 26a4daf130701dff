/* codec_encode.c - encoding a tile: quantisation with an eye on the rate, then the streams of codec_tile.c.
 *
 * A magnitude is rounded, and then lowered by one where that saves more bits, as the contexts stand, than lambda times
 * what it adds in error (greedy rate-distortion optimised quantisation; Sullivan, Wiegand 1998): a threshold for each
 * bin and magnitude. A band of a tile that costs more than it mends is left out whole. Sums are of floats in eight
 * strands, so that they come out the same with AVX2 and without. */
#include <math.h>
#include <stdlib.h>

#include "codec_avx2.h"
#include "common/codec/entropy/raw_bits.h"

static const double TILE_BITS = 96; /* what having a tile at all costs: head of the stream, index entry, checksum */
enum {
    MOST_MAGNITUDE = 1 << 24,
    LAST = TC_RANS_SYMBOLS - 1,
    ENTRIES = TC_BINS * TC_RANS_SYMBOLS,
    STRANDS = 8,
    /* Raw bytes from which so many lanes pay, each of which costs about one byte. */
    EIGHT_FROM = 64,
    SIXTEEN_FROM = 640
};

typedef struct coder {
    const tc_codec *codec;
    double lambda;            /* 0: plain rounding */
    float bits[ENTRIES];      /* of a symbol with its sign and low bits */
    float threshold[ENTRIES]; /* of sizes below which a magnitude is lowered */
} coder;

static void coder_init(coder *e, const tc_codec *codec, double lambda)
{
    e->codec = codec;
    e->lambda = lambda == 0 ? TC_DEFAULT_LAMBDA : lambda < 0 ? 0 : lambda;
    for (int n = 0; n < ENTRIES; n++) {
        int shift = tc_bin_shift[n / TC_RANS_SYMBOLS], symbol = n % TC_RANS_SYMBOLS;
        e->bits[n] = codec->bits[n] + (float)(shift + (symbol || shift) + (symbol == LAST));
        e->threshold[n] = 0;
        if (shift == 0 && symbol > 0)
            e->threshold[n] = (float)(symbol - 0.5 + e->lambda / 2 * (e->bits[n] - e->bits[n - 1]));
    }
}

/* ---- Quantisation -------------------------------------------------------------------------------------------- */

typedef struct sums {
    float error[STRANDS], zero[STRANDS], bits[STRANDS]; /* in squared steps; zero: the error were all zero */
    bool too_large, any;
} sums;

/* How a band's residuals are quantised. */
typedef struct quantiser {
    float inverse;
    bool exact; /* step 1 */
    const float *threshold;
} quantiser;

/* Quantises the residuals of a run: signed values, symbols, and what contexts see. */
static void quantise_run(const coder *e, const quantiser *q, const int32_t residual[HALF], const uint8_t bin[HALF],
                         int32_t value[HALF], uint8_t symbol[HALF], uint8_t seen[HALF], sums *sum)
{
    for (int k = 0; k < HALF; k++) {
        uint32_t absolute = residual[k] < 0 ? 0 - (uint32_t)residual[k] : (uint32_t)residual[k];
        float size = (float)(int32_t)absolute * q->inverse; /* negative for INT32_MIN */
        if (!(size >= 0 && size < MOST_MAGNITUDE)) {
            sum->too_large = true;
            size = 0;
        }
        int32_t magnitude = (int32_t)(size + 0.5F);
        magnitude -= size < q->threshold[bin[k] * TC_RANS_SYMBOLS + (magnitude < LAST ? magnitude : LAST)];
        if (q->exact)
            magnitude = (int32_t)size;
        int32_t s = magnitude >> tc_bin_shift[bin[k]];
        s = s < LAST ? s : LAST;
        float error = size - (float)magnitude;
        sum->error[k % STRANDS] += error * error;
        sum->zero[k % STRANDS] += size * size;
        sum->bits[k % STRANDS] += e->bits[bin[k] * TC_RANS_SYMBOLS + s];
        sum->any |= magnitude != 0;
        value[k] = residual[k] < 0 ? -magnitude : magnitude;
        symbol[k] = (uint8_t)s;
        seen[k] = tc_context_magnitude((uint32_t)s, bin[k]);
    }
}

#if TC_AVX2
TC_TARGET_AVX2 static void quantise_run_avx2(const coder *e, const quantiser *q, const int32_t residual[HALF],
                                             const uint8_t bin[HALF], int32_t value[HALF], uint8_t symbol[HALF],
                                             uint8_t seen[HALF], sums *sum)
{
    const __m256i last = _mm256_set1_epi32(LAST);
    const __m256 inverse = _mm256_set1_ps(q->inverse), limit = _mm256_set1_ps(MOST_MAGNITUDE);
    __m256 error = _mm256_loadu_ps(sum->error), zero = _mm256_loadu_ps(sum->zero), bits = _mm256_loadu_ps(sum->bits);
    __m256i any = _mm256_setzero_si256(), packed[HALF / 8];
    __m256 fine = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
    for (int k = 0; k < HALF; k += 8) {
        __m256i b = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(bin + k))), r = load_avx2(residual + k);
        __m256i entry = _mm256_slli_epi32(b, 4), absolute = _mm256_abs_epi32(r);
        __m256 size = _mm256_mul_ps(_mm256_cvtepi32_ps(absolute), inverse);
        __m256 good =
            _mm256_and_ps(_mm256_cmp_ps(size, _mm256_setzero_ps(), _CMP_GE_OQ), _mm256_cmp_ps(size, limit, _CMP_LT_OQ));
        size = _mm256_and_ps(size, good), fine = _mm256_and_ps(fine, good);
        __m256i magnitude = _mm256_cvttps_epi32(_mm256_add_ps(size, _mm256_set1_ps(0.5F)));
        __m256 threshold =
            _mm256_i32gather_ps(q->threshold, _mm256_add_epi32(entry, _mm256_min_epi32(magnitude, last)), 4);
        magnitude = _mm256_add_epi32(magnitude, _mm256_castps_si256(_mm256_cmp_ps(size, threshold, _CMP_LT_OQ)));
        if (q->exact)
            magnitude = _mm256_cvttps_epi32(size);
        __m256i shift = _mm256_i32gather_epi32(e->codec->shift, b, 4);
        __m256i s = _mm256_min_epi32(_mm256_srav_epi32(magnitude, shift), last);
        __m256 off = _mm256_sub_ps(size, _mm256_cvtepi32_ps(magnitude));
        error = _mm256_add_ps(error, _mm256_mul_ps(off, off));
        zero = _mm256_add_ps(zero, _mm256_mul_ps(size, size));
        bits = _mm256_add_ps(bits, _mm256_i32gather_ps(e->bits, _mm256_add_epi32(entry, s), 4));
        any = _mm256_or_si256(any, magnitude);
        __m256i minus = _mm256_srai_epi32(r, 31);
        _mm256_storeu_si256((__m256i *)(value + k), _mm256_sub_epi32(_mm256_xor_si256(magnitude, minus), minus));
        packed[k / 8] = s;
    }
    packed[0] = _mm256_packus_epi32(packed[0], packed[1]), packed[2] = _mm256_packus_epi32(packed[2], packed[3]);
    packed[0] = _mm256_permutevar8x32_epi32(_mm256_packus_epi16(packed[0], packed[2]),
                                            _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
    _mm256_storeu_si256((__m256i *)symbol, packed[0]);
    _mm256_storeu_si256((__m256i *)seen, packed[0]);
    _mm256_storeu_ps(sum->error, error), _mm256_storeu_ps(sum->zero, zero), _mm256_storeu_ps(sum->bits, bits);
    sum->any |= !_mm256_testz_si256(any, any);
    sum->too_large |= _mm256_movemask_ps(fine) != 0xff;
    __m256i b = load_avx2(bin); /* bins of low bits */
    if (_mm256_movemask_epi8(_mm256_cmpgt_epi8(b, _mm256_set1_epi8(TC_PLAIN_BINS - 1))))
        for (int k = 0; k < HALF; k++)
            seen[k] = tc_context_magnitude(symbol[k], bin[k]);
}
#endif

static double strands(const float sum[STRANDS])
{
    double all = 0;
    for (int n = 0; n < STRANDS; n++)
        all += sum[n];
    return all;
}

/* What a band costs: squared error in squared steps, and bits. */
typedef struct cost {
    double error, bits;
} cost;

/* Quantises a band against w's prediction (rows of `pred`, stride `stride`; NULL: zero), which becomes the
 * reconstruction. False where a magnitude is out of range. *coded: whether anything is left of it. */
TC_INLINE bool quantise_band(const coder *e, int band, tc_rect tile, const tc_plane *truth, int32_t *pred,
                             ptrdiff_t stride, double *spare, cost *total, bool *coded, tc_tile_work *w, bool simd)
{
    const tc_codec *c = e->codec;
    int columns, rows;
    tc_tile_extent(c, band, tile, 0, &columns, &rows);
    int32_t step = c->model.step[band];
    double lambda = step == 1 ? 0 : e->lambda;
    quantiser q = {1.0F / (float)step, step == 1, e->threshold};
    sums sum = {{0}, {0}, {0}, false, false};
    double beyond = 0; /* bits of columns that do not exist, and of escapes */
    for (int j = 0; j < rows; j++) {
        const int32_t *t = tc_plane_at(truth, tile.x0, tile.y0 + j);
        int32_t residual[TC_PHASES][HALF + 1] = {{0}};
        for (int i = 0; i < columns; i++)
            residual[i % TC_PHASES][i / TC_PHASES] =
                (int32_t)((uint32_t)t[i] - (pred ? (uint32_t)pred[j * stride + i] : 0));
        for (int phase = 0; phase < TC_PHASES; phase++) {
            uint8_t *bin = w->bin[band][j][phase], *symbol = w->symbol[band][j][phase];
            uint8_t *seen = magnitude_at(w, band, j, phase);
            int32_t *value = w->value[band][j][phase];
#if TC_AVX2
            if (simd) {
                context_bins_avx2(c, w, band, j, phase, bin);
                quantise_run_avx2(e, &q, residual[phase], bin, value, symbol, seen, &sum);
            } else
#endif
            {
                tc_context_bins(c, w, band, j, phase, bin);
                quantise_run(e, &q, residual[phase], bin, value, symbol, seen, &sum);
            }
            (void)simd;
            for (int k = tc_phase_columns(columns, phase); k < HALF; k++)
                beyond -= e->bits[bin[k] * TC_RANS_SYMBOLS];
            if (memchr(symbol, LAST, HALF))
                for (int k = 0; k < HALF; k++)
                    if (symbol[k] == LAST)
                        beyond += 2 * tc_escape_length(((uint32_t)abs(value[k]) >> tc_bin_shift[bin[k]]) - LAST);
        }
    }
    if (sum.too_large)
        return false;
    double zero = strands(sum.zero), error = strands(sum.error), bits = strands(sum.bits) + beyond;
    *coded = sum.any;
    if (sum.any && lambda > 0 && zero <= error + lambda * (bits + *spare))
        *coded = false;
    if (sum.any && !*coded)
        memset(w->magnitude[band], 0, sizeof w->magnitude[band]);
    *total = *coded ? (cost){error, bits + *spare} : (cost){zero, 0};
    *spare = *coded ? 0 : *spare;
    for (int j = 0; j < rows && *coded && pred; j++)
        for (int k = 0; k < HALF; k++) {
            uint32_t *p = (uint32_t *)pred + j * stride + TC_PHASES * k;
            p[0] += (uint32_t)w->value[band][j][0][k] * (uint32_t)step;
            p[1] += (uint32_t)w->value[band][j][1][k] * (uint32_t)step;
        }
    return true;
}

/* ---- Streams ------------------------------------------------------------------------------------------------- */

/* Raw bits of a run. */
TC_INLINE void put_run(tc_raw_writer *raw, int band, int j, int phase, const tc_tile_work *w)
{
    const uint8_t *symbol = w->symbol[band][j][phase], *bin = w->bin[band][j][phase];
    const int32_t *value = w->value[band][j][phase];
    uint8_t most = 0, most_bin = 0;
    uint32_t nonzero = 0, negative = 0;
    for (int k = 0; k < HALF; k++)
        most = symbol[k] > most ? symbol[k] : most, most_bin = bin[k] > most_bin ? bin[k] : most_bin;
    if (most == LAST || most_bin >= TC_PLAIN_BINS)
        for (int k = 0; k < HALF; k++) {
            int shift = tc_bin_shift[bin[k]];
            uint32_t magnitude = (uint32_t)abs(value[k]);
            if (symbol[k] == LAST)
                tc_raw_put_escape(raw, (magnitude >> shift) - LAST);
            tc_raw_put(raw, magnitude & ((1u << shift) - 1), shift);
        }
    else if (most == 0)
        return;
    for (int k = 0; k < HALF; k++) {
        nonzero |= (uint32_t)(value[k] != 0) << k;
        negative |= (uint32_t)(value[k] < 0) << k;
    }
    uint32_t signs = 0;
    int count = 0;
    for (uint32_t left = nonzero; left; left &= left - 1)
        signs |= (uint32_t)((left & -left & negative) != 0) << count++;
    tc_raw_put(raw, signs, count);
}

enum { RAW_BITS = TC_ESCAPE_BITS + 4 + 1 };

size_t tc_codec_tile_bound(void)
{
    return 1 + tc_rans_bound(TC_TILE_SYMBOLS) + TC_RANS_PAYLOAD + (size_t)TC_TILE_SYMBOLS * RAW_BITS / 8 + 8;
}

/* Puts the symbols of a run, the last one first. lanes: a constant. */
TC_INLINE void put_symbols(const tc_codec *c, tc_rans_encoder *rans, const uint8_t *bin, const uint8_t *symbol,
                           int lanes)
{
    uint32_t state[TC_RANS_LANES];
    uint8_t *at = rans->at;
    memcpy(state, rans->state, sizeof state);
    for (int k = HALF - lanes; k >= 0; k -= lanes)
        for (int lane = lanes - 1; lane >= 0; lane--)
            tc_rans_put(&c->put[bin[k + lane] * TC_RANS_SYMBOLS + symbol[k + lane]], &state[lane], &at);
    memcpy(rans->state, state, sizeof state);
    rans->at = at;
}

/* Writes the tile from w's symbols and values. */
TC_INLINE size_t write_tile(const coder *e, int coded, tc_rect tile, uint8_t *bytes, tc_tile_work *w)
{
    const tc_codec *c = e->codec;
    /* Raw bits go where the longest rANS stream would end, the stream in front of them; then all moves to the front. */
    uint8_t *middle = bytes + 1 + tc_rans_bound(TC_TILE_SYMBOLS);
    tc_raw_writer raw = {middle, 0, 0, 0};
    int columns, rows;
    for (int b = 0; b < TC_BANDS; b++) {
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        for (int j = 0; j < rows && coded >> b & 1; j++)
            for (int phase = 0; phase < TC_PHASES; phase++) {
                int n = tc_phase_columns(columns, phase);
                if (n < HALF) /* columns that do not exist have no raw bits */
                    memset(&w->bin[b][j][phase][n], 0, (size_t)(HALF - n));
                put_run(&raw, b, j, phase, w);
            }
    }
    tc_raw_finish(&raw, 0);
    int lanes = raw.size > SIXTEEN_FROM ? 16 : raw.size > EIGHT_FROM ? 8 : 4;
    size_t carried = 2 * (size_t)lanes;
    tc_raw_finish(&raw, carried);
    uint8_t payload[TC_RANS_PAYLOAD];
    memcpy(payload, raw.bytes, carried);
    tc_rans_encoder rans;
    tc_rans_encode_begin(&rans, lanes, bytes + 1, middle, payload);
    for (int b = TC_BANDS - 1; b >= 0; b--) {
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        for (int j = coded >> b & 1 ? rows - 1 : -1; j >= 0; j--)
            for (int phase = TC_PHASES - 1; phase >= 0; phase--) {
                const uint8_t *bin = w->bin[b][j][phase], *symbol = w->symbol[b][j][phase];
                int n = tc_phase_columns(columns, phase);
                if (n == HALF && lanes == 16)
                    put_symbols(c, &rans, bin, symbol, 16);
                else if (n == HALF && lanes == 8)
                    put_symbols(c, &rans, bin, symbol, 8);
                else if (n == HALF)
                    put_symbols(c, &rans, bin, symbol, 4);
                else
                    for (int k = n - 1; k >= 0; k--)
                        tc_rans_put(&c->put[bin[k] * TC_RANS_SYMBOLS + symbol[k]], &rans.state[k % lanes], &rans.at);
            }
    }
    tc_rans_encode_end(&rans);
    size_t words = (size_t)(middle - rans.at), rest = raw.size - carried;
    bytes[0] = (uint8_t)(coded | lanes / 8 << TC_TILE_LANES);
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

TC_INLINE tc_status encode_tile(const tc_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                                const tc_plane band[TC_BANDS], const tc_encode_options *options, uint8_t *bytes,
                                size_t *size_ret, tc_tile_work *work, bool simd)
{
    coder e;
    coder_init(&e, codec, options->lambda);
    tc_rect tile = tc_codec_tile_rect(codec, tx, ty, 0);
    tc_tile_load(codec, tile, TC_TILE, coarse, work);
#if TC_AVX2
    if (simd)
        tile_curves_avx2(codec, work);
    else
#endif
        tc_tile_curves(codec, work);
    memset(work->magnitude, 0, sizeof work->magnitude);
    double spare = TILE_BITS;
    cost total[TC_BANDS];
    bool coded[TC_BANDS];
    tc_predict_hl(codec, work, TC_TILE, TC_TILE);
    if (!quantise_band(&e, TC_HL, tile, &band[TC_HL], &work->hl[1][HL_X], HL_STRIDE, &spare, &total[TC_HL],
                       &coded[TC_HL], work, simd))
        return TC_ERR_UNSUPPORTED;
    tc_predict_lh(codec, work, TC_TILE, TC_TILE);
    if (!quantise_band(&e, TC_LH, tile, &band[TC_LH], work->pred[0], TC_TILE, &spare, &total[TC_LH], &coded[TC_LH],
                       work, simd) ||
        !quantise_band(&e, TC_HH, tile, &band[TC_HH], NULL, 0, &spare, &total[TC_HH], &coded[TC_HH], work, simd))
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

/* The same code for processors with AVX2 and without. */
#if TC_AVX2
TC_TARGET_AVX2 static tc_status encode_tile_avx2(const tc_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                                                 const tc_plane band[TC_BANDS], const tc_encode_options *options,
                                                 uint8_t *bytes, size_t *size_ret, tc_tile_work *work)
{
    return encode_tile(codec, tx, ty, coarse, band, options, bytes, size_ret, work, true);
}
#endif

tc_status tc_codec_encode_tile(const tc_codec *codec, int64_t tx, int64_t ty, const tc_plane *coarse,
                               const tc_plane band[TC_BANDS], const tc_encode_options *options, uint8_t *bytes,
                               size_t *size_ret, tc_tile_work *work)
{
    tc_encode_options none = {0};
    options = options ? options : &none;
#if TC_AVX2
    if (options->simd == TC_SIMD_AUTO && tc_have_avx2())
        return encode_tile_avx2(codec, tx, ty, coarse, band, options, bytes, size_ret, work);
#endif
    return encode_tile(codec, tx, ty, coarse, band, options, bytes, size_ret, work, false);
}
