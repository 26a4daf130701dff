/* codec_lh04_model.c - models of residuals: contexts made from them, the built-in one, and headers.
 *
 * A header is one stream of binary_coder.h: two raw bits (own weights; own symbols); the step, 25 raw bits; the codes
 * of the means in zigzag order, each as the difference from the one before (the first from 24), then 1/256ths of flags
 * as differences from 128 likewise; weights as differences of codes (weight_of()) from the built-in ones; symbols as a
 * bit for each bin, whether it differs from the built-in one, and where it does 16 differences of logarithms. */
#include "codec_lh04_tile.h"

#include "common/codec/entropy/binary_coder.h"

/* ---- Contexts ------------------------------------------------------------------------------------------------ */

/* 2^(n/16) in 1/4096, 0 <= n < 16. */
static const uint16_t root[16] = {4096, 4277, 4467, 4664, 4871, 5087, 5312, 5547,
                                  5793, 6049, 6317, 6597, 6889, 7194, 7512, 7845};

/* Mean magnitude in 1/16384: from 1/256 to 64. */
static int64_t mean_of(int code)
{
    return ((int64_t)root[code % 4 * 4] << code / 4) >> 6;
}

/* The u of number n of the zigzag in bits 0-2, v in bits 3-5. */
static const uint8_t zigzag[BANDS] = {0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,
                                      12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
                                      35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,
                                      58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

static int class_of(int index)
{
    int sum = index % SIDE + index / SIDE;
    return sum < 2 ? 0 : sum < 5 ? 1 : sum < 9 ? 2 : 3;
}

static int32_t at_most(int64_t value, int64_t limit)
{
    return (int32_t)(value < limit ? value : limit);
}

static void init_band(tc_lh04_codec *c, int place, const uint8_t position[BANDS], int64_t before)
{
    const tc_lh04_model *m = &c->model;
    tc_lh04_band *b = &c->band[place];
    int u = b->index % SIDE, v = b->index / SIDE;
    int64_t mean = mean_of(m->mean[b->index]), near = 0, far = 0;
    b->nears = b->fars = 0;
    for (int dv = -2; dv <= 2; dv++)
        for (int du = -2; du <= 2; du++) {
            int distance = du * du + dv * dv, p = u + du, q = v + dv;
            if (distance == 0 || distance > 4 || p < 0 || p >= SIDE || q < 0 || q >= SIDE)
                continue;
            int other = SIDE * q + p;
            if (position[other] >= place)
                continue;
            if (distance == 1)
                b->near[b->nears++] = position[other], near += mean_of(m->mean[other]);
            else
                b->far[b->fars++] = position[other], far += mean_of(m->mean[other]);
        }
    b->class = (uint8_t)class_of(b->index);
    b->flag = (uint8_t)(3 * (m->mean[b->index] < 4 ? 0 : m->mean[b->index] < 10 ? 1 : m->mean[b->index] < 18 ? 2 : 3));
    enum { ONE = 4096 };
    for (int n = 0; n < TC_LH04_SCALE; n++)
        b->ratio[n] = ONE;
    b->ratio[F_NEAR] = near ? at_most(mean * ONE / near, 16 * ONE) : 0;
    b->ratio[F_FAR] = far ? at_most(mean * ONE / far, 16 * ONE) : 0;
    b->ratio[F_BLOCK] = before ? at_most(mean * ONE / before, 16 * ONE) : 0;
    b->ratio[F_AROUND] = before ? at_most(mean * ONE / before, 16 * ONE) : 0;
    b->ratio[F_ONE] = (int32_t)(mean >> 2);
    for (int p = 0; p < TC_PHASES; p++)
        for (int n = 0; n < TC_LH04_SCALE; n++) /* the sum of all features times these stays below 2^31 */
            b->weight[p][n] =
                at_most(((int64_t)m->weight[b->class][p][n] * b->ratio[n]) >> 10, n == F_ONE ? 1 << 28 : UINT16_MAX);
}

void tc_lh04_init(tc_lh04_codec *codec, const tc_lifting_level *level, const tc_lh04_model *model)
{
    uint8_t position[BANDS];
    int64_t before = 0;
    codec->level = *level;
    codec->tiles_x = (level->width + SPAN - 1) / SPAN, codec->tiles_y = (level->height + SPAN - 1) / SPAN;
    codec->model = *model;
    for (int n = 0; n < BANDS; n++)
        codec->band[n].index = zigzag[n], position[zigzag[n]] = (uint8_t)n;
    for (int n = 0; n < BANDS; n++) {
        init_band(codec, n, position, before);
        before += mean_of(model->mean[zigzag[n]]);
    }
    for (int b = 0; b < TC_BINS; b++)
        tc_rans_table_build(&model->symbols[b], &codec->table[b]);
}

/* ---- The built-in model -------------------------------------------------------------------------------------- */

/* Trained by tc_lh04_train() on SRTM 3" of the Tatra: weights, as codes (weight_of()), and flags on its finest level at
 * 1.5 m rms, symbols on the next coarser one; symbols of large scales, which it hardly has, are those of a geometric
 * distribution. */
static const uint8_t builtin_weight[TC_LH04_CLASSES][TC_PHASES][TC_LH04_SCALE] = {
    {{76, 78, 74, 75, 65, 71, 68, 65, 157}, {73, 85, 74, 78, 63, 48, 62, 66, 157}},
    {{102, 89, 91, 90, 119, 97, 108, 97, 115}, {103, 89, 90, 106, 115, 92, 105, 94, 112}},
    {{101, 84, 88, 84, 135, 125, 116, 84, 11}, {100, 77, 86, 109, 132, 124, 108, 73, 11}},
    {{98, 75, 88, 84, 137, 142, 97, 48, 0}, {92, 84, 86, 107, 136, 140, 94, 45, 0}},
};

static const uint8_t builtin_empty[TC_LH04_FLAGS] = {230, 200, 150, 255, 209, 39, 255, 169, 47, 203, 52, 17};

static const uint16_t builtin_symbols[TC_BINS][TC_RANS_SYMBOLS] = {
    {4077, 4, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4072, 9, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4066, 15, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4057, 24, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4040, 40, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4012, 68, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3908, 173, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3720, 358, 5, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3462, 611, 9, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3125, 929, 26, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2674, 1337, 64, 8, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2065, 1736, 236, 38, 8, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {1530, 1820, 541, 147, 31, 13, 3, 2, 2, 1, 1, 1, 1, 1, 1, 1},
    {1038, 1601, 873, 367, 130, 50, 17, 8, 4, 2, 1, 1, 1, 1, 1, 1},
    {674, 1236, 953, 566, 337, 168, 84, 34, 17, 11, 6, 4, 2, 2, 1, 1},
    {473, 870, 796, 614, 473, 335, 217, 129, 77, 41, 29, 16, 10, 6, 4, 6},
    {306, 612, 611, 515, 471, 396, 306, 257, 182, 140, 90, 64, 41, 41, 19, 45},
    {1047, 779, 580, 432, 321, 239, 178, 133, 99, 73, 55, 41, 30, 23, 17, 49},
    {749, 611, 500, 408, 334, 273, 223, 182, 149, 122, 100, 81, 67, 54, 44, 199},
    {980, 745, 567, 431, 328, 250, 190, 145, 110, 84, 64, 48, 37, 28, 21, 68},
    {689, 573, 477, 397, 330, 274, 228, 190, 158, 131, 109, 91, 76, 63, 52, 258},
    {898, 701, 547, 427, 334, 261, 203, 159, 124, 97, 76, 59, 46, 36, 28, 100},
    {628, 530, 449, 381, 322, 273, 231, 196, 166, 141, 119, 101, 86, 72, 61, 340},
    {814, 653, 523, 419, 336, 269, 215, 172, 138, 111, 89, 71, 57, 46, 36, 147},
};

/* Weight of a code: 0 is 0, then 2^((code - 1) / 16), at most 2^13. */
static uint32_t weight_of(int code)
{
    return code == 0 ? 0 : ((((uint32_t)root[(code - 1) % 16] << (code - 1) / 16) + 2048) >> 12);
}

/* Frequency of a logarithm: 2^(code/8). */
static uint32_t frequency_of(int code)
{
    return ((uint32_t)root[code % 8 * 2] << code / 8) >> 12;
}

enum { WEIGHT_CODES = 13 * 16 + 2, LOG_CODES = 12 * 8 + 1, FIRST_MEAN = 24, FIRST_EMPTY = 128 };

/* The code, of `codes`, whose value is nearest; the lowest of equals. */
static int nearest_code(uint32_t (*value_of)(int code), int codes, uint32_t value)
{
    int best = 0;
    for (int c = 1; c < codes; c++) {
        int64_t now = (int64_t)value_of(c) - value, old = (int64_t)value_of(best) - value;
        if (now * now < old * old)
            best = c;
    }
    return best;
}

static tc_rans_frequencies frequencies_of(const uint8_t code[TC_RANS_SYMBOLS])
{
    uint64_t w[TC_RANS_SYMBOLS];
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        w[s] = frequency_of(code[s]) - 1; /* normalising gives everybody one */
    return tc_rans_normalise(w);
}

static void frequency_codes(const tc_rans_frequencies *f, uint8_t code[TC_RANS_SYMBOLS])
{
    for (int s = 0; s < TC_RANS_SYMBOLS; s++)
        code[s] = (uint8_t)nearest_code(frequency_of, LOG_CODES, f->of[s]);
}

void tc_lh04_model_builtin(int32_t step, tc_lh04_model *model)
{
    *model = (tc_lh04_model){.step = step};
    memset(model->mean, FIRST_MEAN, sizeof model->mean);
    memcpy(model->empty, builtin_empty, sizeof builtin_empty);
    for (int c = 0; c < TC_LH04_CLASSES; c++)
        for (int p = 0; p < TC_PHASES; p++)
            for (int n = 0; n < TC_LH04_SCALE; n++)
                model->weight[c][p][n] = (uint16_t)weight_of(builtin_weight[c][p][n]);
    for (int b = 0; b < TC_BINS; b++)
        memcpy(model->symbols[b].of, builtin_symbols[b], sizeof builtin_symbols[b]);
}

/* ---- Header -------------------------------------------------------------------------------------------------- */

enum { STEP_BITS = 25 };

size_t tc_lh04_model_bound(void)
{
    return 8 + 9 * (BANDS + TC_LH04_FLAGS + TC_LH04_CLASSES * TC_PHASES * TC_LH04_SCALE + TC_BINS * TC_RANS_SYMBOLS);
}

typedef struct header_models {
    tc_number_model mean, empty, weight, symbol;
    tc_bit_model same;
} header_models;

static void reset(header_models *h)
{
    tc_number_reset(&h->mean), tc_number_reset(&h->empty), tc_number_reset(&h->weight), tc_number_reset(&h->symbol);
    tc_bit_models_reset(&h->same, 1);
}

static void put_codes(tc_bit_encoder *e, tc_number_model *m, const uint8_t *code, const uint8_t *from, int count)
{
    for (int n = 0; n < count; n++)
        tc_number_encode(e, m, tc_zigzag(code[n] - from[n]));
}

static bool get_codes(tc_bit_decoder *d, tc_number_model *m, uint8_t *code, const uint8_t *from, int count, int codes)
{
    for (int n = 0; n < count; n++) {
        int64_t v = (int64_t)tc_unzigzag(tc_number_decode(d, m)) + from[n];
        if (v < 0 || v >= codes)
            return false;
        code[n] = (uint8_t)v;
    }
    return true;
}

size_t tc_lh04_model_write(const tc_lh04_model *model, uint8_t *bytes)
{
    header_models h;
    tc_bit_encoder e;
    tc_lh04_model base;
    tc_lh04_model_builtin(1, &base);
    reset(&h);
    tc_bit_encode_begin(&e, bytes, tc_lh04_model_bound());
    tc_bit_encode_raw(&e, model->own_weights, 1);
    tc_bit_encode_raw(&e, model->own_symbols, 1);
    tc_bit_encode_raw(&e, (uint32_t)model->step, STEP_BITS);
    int last = FIRST_MEAN;
    for (int n = 0; n < BANDS; n++) {
        int now = model->mean[zigzag[n]];
        tc_number_encode(&e, &h.mean, tc_zigzag(now - last));
        last = now;
    }
    last = FIRST_EMPTY;
    for (int n = 0; n < TC_LH04_FLAGS; n++) {
        tc_number_encode(&e, &h.empty, tc_zigzag(model->empty[n] - last));
        last = model->empty[n];
    }
    if (model->own_weights)
        for (int c = 0; c < TC_LH04_CLASSES; c++)
            for (int p = 0; p < TC_PHASES; p++) {
                uint8_t code[TC_LH04_SCALE];
                for (int n = 0; n < TC_LH04_SCALE; n++)
                    code[n] = (uint8_t)nearest_code(weight_of, WEIGHT_CODES, model->weight[c][p][n]);
                put_codes(&e, &h.weight, code, builtin_weight[c][p], TC_LH04_SCALE);
            }
    for (int b = 0; b < TC_BINS && model->own_symbols; b++) {
        uint8_t code[TC_RANS_SYMBOLS], from[TC_RANS_SYMBOLS];
        bool same = memcmp(&model->symbols[b], &base.symbols[b], sizeof base.symbols[b]) == 0;
        tc_bit_encode(&e, &h.same, same);
        frequency_codes(&model->symbols[b], code), frequency_codes(&base.symbols[b], from);
        if (!same)
            put_codes(&e, &h.symbol, code, from, TC_RANS_SYMBOLS);
    }
    return tc_bit_encode_end(&e);
}

/* A code as the difference from the one before it. */
static bool get_next(tc_bit_decoder *d, tc_number_model *m, int *last, int least, int codes)
{
    int64_t v = (int64_t)tc_unzigzag(tc_number_decode(d, m)) + *last;
    *last = (int)v;
    return v >= least && v < codes;
}

static bool read_model(tc_bit_decoder *d, tc_lh04_model *m)
{
    header_models h;
    reset(&h);
    bool own_weights = tc_bit_decode_raw(d, 1), own_symbols = tc_bit_decode_raw(d, 1);
    uint32_t step = tc_bit_decode_raw(d, STEP_BITS);
    if (step < 1 || step > TC_MAX_STEP)
        return false;
    tc_lh04_model_builtin((int32_t)step, m);
    m->own_weights = own_weights, m->own_symbols = own_symbols;
    for (int n = 0, last = FIRST_MEAN; n < BANDS; n++) {
        if (!get_next(d, &h.mean, &last, 0, TC_LH04_MEANS))
            return false;
        m->mean[zigzag[n]] = (uint8_t)last;
    }
    for (int n = 0, last = FIRST_EMPTY; n < TC_LH04_FLAGS; n++) {
        if (!get_next(d, &h.empty, &last, 1, 256))
            return false;
        m->empty[n] = (uint8_t)last;
    }
    for (int c = 0; c < TC_LH04_CLASSES && own_weights; c++)
        for (int p = 0; p < TC_PHASES; p++) {
            uint8_t code[TC_LH04_SCALE];
            if (!get_codes(d, &h.weight, code, builtin_weight[c][p], TC_LH04_SCALE, WEIGHT_CODES))
                return false;
            for (int n = 0; n < TC_LH04_SCALE; n++)
                m->weight[c][p][n] = (uint16_t)weight_of(code[n]);
        }
    for (int b = 0; b < TC_BINS && own_symbols; b++) {
        uint8_t code[TC_RANS_SYMBOLS], from[TC_RANS_SYMBOLS];
        if (tc_bit_decode(d, &h.same))
            continue;
        frequency_codes(&m->symbols[b], from);
        if (!get_codes(d, &h.symbol, code, from, TC_RANS_SYMBOLS, LOG_CODES))
            return false;
        m->symbols[b] = frequencies_of(code);
    }
    return tc_bit_decode_end(d);
}

tc_status tc_lh04_model_read(const uint8_t *bytes, size_t size, tc_lh04_model *model)
{
    tc_bit_decoder d;
    tc_lh04_model read;
    tc_bit_decode_begin(&d, bytes, size);
    if (!read_model(&d, &read))
        return TC_ERR_FORMAT;
    *model = read;
    return TC_OK;
}
