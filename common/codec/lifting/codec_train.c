/* codec_train.c - fits a level's model to its details.
 *
 * Prediction: least squares, by the normal equations. Scales: maximum likelihood of magnitudes q that are geometrically
 * distributed (a quantised Laplacian) with expected value s = sum of w_k f_k over non-negative weights. The likelihood
 * of q is s^q / (1 + s)^(q + 1); Fisher scoring (McCullagh, Nelder 1989) climbs it by steps that solve
 *     (sum f f' / (s (1 + s))) step = sum f (q / s - (1 + q) / (1 + s)),
 * where weights that would fall below zero are held there. A continuous exponential would not do: where s is small, it
 * fears the rare one far more than the code does. Symbols: counts. Scales and symbols depend on quantisation, which
 * depends on them, so they go twice around. */
#include <math.h>
#include <stdlib.h>

#include "codec_avx2.h"

enum {
    ROUNDS = 2,
    ITERATIONS = 3,
    COLUMNS = TC_SCALE,
    STRANDS = 8,      /* coefficients that are summed side by side */
    PRICED_TILES = 6, /* for a choice among the built-in sets */
};

/* Features of some coefficients, and their magnitudes; beyond the last coefficient all is zero. */
typedef struct strands {
    float of[TC_SCALE + 1][STRANDS];
} strands;

typedef struct trainer {
    tc_codec *codec;
    const tc_training_tile *tile;
    int tiles;
    tc_tile_work *work;
    double lambda;
    strands *feature[TC_BANDS][TC_PHASES];
    int64_t features[TC_BANDS][TC_PHASES]; /* coefficients */
} trainer;

/* ---- Prediction ---------------------------------------------------------------------------------------------- */

typedef struct normal {
    double a[COLUMNS][COLUMNS + 1];
} normal;

static void normal_add(normal *n, const uint32_t *term, int count, double truth)
{
    double t[COLUMNS];
    for (int k = 0; k < count; k++)
        t[k] = (int32_t)term[k];
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < count; i++)
            n->a[k][i] += t[k] * t[i];
        n->a[k][COLUMNS] += t[k] * truth;
    }
}

/* Solves by elimination with pivots; a slight ridge keeps what the data does not say at zero. */
static void normal_solve(normal *n, int count, double x[])
{
    int order[COLUMNS];
    for (int k = 0; k < count; k++)
        n->a[k][k] = n->a[k][k] * (1 + 1e-6) + 1e-3, order[k] = k;
    for (int k = 0; k < count; k++) {
        int pivot = k;
        for (int i = k + 1; i < count; i++)
            if (fabs(n->a[order[i]][k]) > fabs(n->a[order[pivot]][k]))
                pivot = i;
        int swap = order[k];
        order[k] = order[pivot], order[pivot] = swap;
        double *p = n->a[order[k]];
        for (int i = k + 1; i < count; i++) {
            double *q = n->a[order[i]], f = q[k] / p[k];
            for (int m = k; m < count; m++)
                q[m] -= f * p[m];
            q[COLUMNS] -= f * p[COLUMNS];
        }
    }
    for (int k = count - 1; k >= 0; k--) {
        const double *p = n->a[order[k]];
        double sum = p[COLUMNS];
        for (int i = k + 1; i < count; i++)
            sum -= p[i] * x[i];
        x[k] = sum / p[k];
    }
}

static void predictor_solve(normal *n, int count, int16_t weight[TC_PREDICT])
{
    double x[COLUMNS] = {0};
    normal_solve(n, count, x);
    for (int k = 0; k < TC_PREDICT; k++) {
        double v = k < count ? x[k] * (1 << TC_PREDICT_BITS) : 0;
        weight[k] = isfinite(v) ? (int16_t)lrint(fmin(fmax(v, INT16_MIN), INT16_MAX)) : 0;
    }
}

static tc_rect tile_rect(const trainer *t, int n)
{
    return tc_codec_tile_rect(t->codec, t->tile[n].tx, t->tile[n].ty, 0);
}

static void train_hl(trainer *t)
{
    normal n = {0};
    for (int k = 0; k < t->tiles; k++) {
        tc_rect tile = tile_rect(t, k);
        int columns, rows;
        tc_tile_extent(t->codec, TC_HL, tile, 0, &columns, &rows);
        tc_tile_load(t->codec, tile, TC_TILE, &t->tile[k].coarse, t->work);
        for (int j = 0; j < rows; j += 2)
            for (int i = j / 2 % 2; i < columns; i += 2) {
                uint32_t term[TC_PREDICT_KERNEL];
                tc_terms_hl(t->work, i, j, term);
                normal_add(&n, term, TC_PREDICT_KERNEL,
                           *tc_plane_at(&t->tile[k].band[TC_HL], tile.x0 + i, tile.y0 + j));
            }
    }
    predictor_solve(&n, TC_PREDICT_KERNEL, t->codec->model.predict[TC_HL]);
}

static void train_lh(trainer *t)
{
    normal n = {0};
    int32_t step = t->codec->model.step[TC_HL];
    for (int k = 0; k < t->tiles; k++) {
        tc_rect tile = tile_rect(t, k);
        int columns, rows;
        tc_tile_load(t->codec, tile, TC_TILE, &t->tile[k].coarse, t->work);
        tc_predict_hl(t->codec, t->work, TC_TILE, TC_TILE);
        tc_tile_extent(t->codec, TC_HL, tile, 0, &columns, &rows);
        for (int j = 0; j < rows; j++)
            for (int i = 0; i < columns; i++) { /* about what the decoder will have */
                int32_t *p = &t->work->hl[j + 1][HL_X + i];
                double size = ((double)*tc_plane_at(&t->tile[k].band[TC_HL], tile.x0 + i, tile.y0 + j) - *p) / step;
                *p = (int32_t)(*p + copysign(step == 1 ? fabs(rint(size)) : floor(fabs(size) + 0.4), size) * step);
            }
        tc_tile_extent(t->codec, TC_LH, tile, 0, &columns, &rows);
        for (int j = 0; j < rows; j += 2)
            for (int i = j / 2 % 2; i < columns; i += 2) {
                uint32_t term[TC_PREDICT];
                tc_terms_lh(t->work, i, j, term);
                tc_terms_cross(t->work, i, j, term + TC_PREDICT_KERNEL);
                normal_add(&n, term, TC_PREDICT, *tc_plane_at(&t->tile[k].band[TC_LH], tile.x0 + i, tile.y0 + j));
            }
    }
    predictor_solve(&n, TC_PREDICT, t->codec->model.predict[TC_LH]);
}

/* ---- Scales and symbols -------------------------------------------------------------------------------------- */

/* Features of the coefficients of every second row of a tile that encode() has left in the work. */
static void gather(trainer *t, tc_rect tile)
{
    const tc_codec *c = t->codec;
    for (int b = 0; b < TC_BANDS; b++) {
        int columns, rows;
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        float scale = (float)c->coarse_scale[b] / (1 << 20);
        for (int j = 0; j < rows; j += 2)
            for (int i = 0; i < columns; i++) {
                int phase = i % TC_PHASES, k = i / TC_PHASES;
                int64_t at = t->features[b][phase]++;
                strands *f = &t->feature[b][phase][at / STRANDS];
                int lane = (int)(at % STRANDS), m = 0;
                int32_t known[TC_SCALE_OWN + TC_SCALE_CROSS], coarse[TC_SCALE_COARSE];
                if (lane == 0)
                    *f = (strands){0};
                tc_known_features(t->work, b, phase, k, j, known);
                tc_coarse_features(t->work, b, phase, k, j, coarse);
                for (int n = 0; n < TC_SCALE_OWN + TC_SCALE_CROSS; n++)
                    f->of[m++][lane] = (float)known[n];
                for (int n = 0; n < TC_SCALE_COARSE; n++)
                    f->of[m++][lane] = (float)coarse[n] * scale;
                f->of[m++][lane] = 1;
                f->of[m][lane] = magnitude_at(t->work, b, j, phase)[k];
            }
    }
}

/* The matrix of a step and its right side. */
TC_INLINE void scoring(const strands *feature, int64_t count, const float w[TC_SCALE], normal *sum)
{
    float matrix[TC_SCALE][TC_SCALE][STRANDS] = {{{0}}}, side[TC_SCALE][STRANDS] = {{0}};
    for (int64_t i = 0; i < (count + STRANDS - 1) / STRANDS; i++) {
        const strands *f = &feature[i];
        float s[STRANDS], slope[STRANDS], inverse[STRANDS];
        for (int l = 0; l < STRANDS; l++)
            s[l] = 0.001F;
        for (int k = 0; k < TC_SCALE; k++)
            for (int l = 0; l < STRANDS; l++)
                s[l] += w[k] * f->of[k][l];
        for (int l = 0; l < STRANDS; l++) {
            float q = f->of[TC_SCALE][l];
            inverse[l] = 1 / (s[l] * (1 + s[l]));
            slope[l] = (q - s[l]) * inverse[l]; /* q / s - (1 + q) / (1 + s) */
        }
        for (int k = 0; k < TC_SCALE; k++) {
            float weighed[STRANDS];
            for (int l = 0; l < STRANDS; l++) {
                side[k][l] += f->of[k][l] * slope[l];
                weighed[l] = f->of[k][l] * inverse[l];
            }
            for (int m = 0; m <= k; m++)
                for (int l = 0; l < STRANDS; l++)
                    matrix[k][m][l] += weighed[l] * f->of[m][l];
        }
    }
    memset(sum, 0, sizeof *sum);
    for (int k = 0; k < TC_SCALE; k++) {
        for (int m = 0; m <= k; m++) {
            for (int l = 0; l < STRANDS; l++)
                sum->a[k][m] += matrix[k][m][l];
            sum->a[m][k] = sum->a[k][m];
        }
        for (int l = 0; l < STRANDS; l++)
            sum->a[k][COLUMNS] += side[k][l];
    }
}

#if TC_AVX2
TC_TARGET_AVX2 static void scoring_avx2(const strands *feature, int64_t count, const float w[TC_SCALE], normal *sum)
{
    scoring(feature, count, w, sum);
}
#endif

/* Goes one step; weights that would fall below zero go to zero, which the others then answer to. */
static void take_step(const normal *sum, float w[TC_SCALE])
{
    bool held[TC_SCALE] = {false};
    double x[COLUMNS];
    for (bool again = true; again;) {
        normal n = *sum;
        for (int k = 0; k < TC_SCALE; k++)
            for (int m = 0; m < TC_SCALE && held[k]; m++) { /* x[k] is known: -w[k] */
                n.a[m][COLUMNS] += n.a[m][k] * w[k];
                n.a[m][k] = n.a[k][m] = 0;
            }
        for (int k = 0; k < TC_SCALE; k++)
            if (held[k])
                n.a[k][k] = 1, n.a[k][COLUMNS] = -w[k];
        normal_solve(&n, TC_SCALE, x);
        again = false;
        for (int k = 0; k < TC_SCALE; k++)
            if (!held[k] && !(w[k] + x[k] >= 0))
                held[k] = again = true;
    }
    for (int k = 0; k < TC_SCALE; k++)
        w[k] = held[k] ? 0 : (float)fmin(w[k] + x[k], 4);
}

/* Weights of one phase of a band from its features. */
static void fit(const strands *feature, int64_t count, uint16_t weight[TC_SCALE])
{
    enum { UNIT = 1 << TC_SCALE_BITS };
    float w[TC_SCALE];
    for (int k = 0; k < TC_SCALE; k++)
        w[k] = (float)weight[k] / UNIT;
    for (int n = 0; n < ITERATIONS; n++) {
        normal sum;
#if TC_AVX2
        if (tc_have_avx2())
            scoring_avx2(feature, count, w, &sum);
        else
#endif
            scoring(feature, count, w, &sum);
        take_step(&sum, w);
    }
    for (int k = 0; k < TC_SCALE; k++)
        weight[k] = (uint16_t)lrintf(w[k] * UNIT);
}

static void trainer_free(trainer *t)
{
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            free(t->feature[b][p]);
    free(t->codec), free(t->work);
}

static tc_status trainer_init(trainer *t, const tc_lifting_level *level, const tc_training_tile *tiles, int count,
                              double lambda, const tc_detail_model *model)
{
    *t = (trainer){.tile = tiles, .tiles = count, .lambda = lambda};
    t->codec = malloc(sizeof *t->codec), t->work = malloc(sizeof *t->work);
    if (!t->codec || !t->work)
        return TC_ERR_MEMORY;
    tc_codec_init(t->codec, level, model);
    return TC_OK;
}

static tc_status make_room(trainer *t)
{
    size_t room = (size_t)t->tiles * (TC_TILE / 2) * HALF / STRANDS * sizeof(strands);
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            if (!(t->feature[b][p] = malloc(room + !room)))
                return TC_ERR_MEMORY;
    return TC_OK;
}

/* What coding tiles costs: symbols apart from all else, and errors as the bits that they are worth. */
typedef struct price {
    tc_symbol_counts count;
    double rest, bits[TC_BANDS], error[TC_BANDS];
} price;

static double symbol_bits(const tc_symbol_counts *count, const tc_detail_model *model)
{
    double bits = 0;
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            if (count->of[b][s])
                bits += (double)count->of[b][s] * (TC_RANS_BITS - log2(model->symbols[b].of[s]));
    return bits;
}

/* Encodes the tiles with the codec's model, every `each`-th of them; keeps their features where asked to. */
static tc_status encode_all(trainer *t, int each, bool keep, price *p)
{
    double lambda = t->lambda == 0 ? TC_DEFAULT_LAMBDA : t->lambda;
    memset(p, 0, sizeof *p);
    if (keep)
        memset(t->features, 0, sizeof t->features);
    for (int n = 0; n < t->tiles; n += each) {
        size_t size;
        const tc_training_tile *tile = &t->tile[n];
        tc_encode_options options = {.lambda = t->lambda, .count = &p->count, .bits = p->bits, .error = p->error};
        tc_status status = tc_codec_encode_tile(t->codec, tile->tx, tile->ty, &tile->coarse, tile->band, &options, NULL,
                                                &size, t->work);
        if (status)
            return status;
        if (keep)
            gather(t, tile_rect(t, n));
    }
    for (int b = 0; b < TC_BANDS; b++)
        p->rest += p->bits[b] + (lambda > 0 ? p->error[b] / lambda : 0);
    p->rest -= symbol_bits(&p->count, &t->codec->model);
    return TC_OK;
}

/* Takes what a header can carry of a model as the codec's. */
static tc_status set_up(trainer *t, const tc_detail_model *model, tc_detail_parts parts, uint8_t *header,
                        size_t *size_ret)
{
    tc_detail_model read;
    tc_lifting_level level = t->codec->level;
    *size_ret = tc_detail_model_write(model, parts, header);
    tc_status status = tc_detail_model_read(header, *size_ret, &read, &parts);
    if (!status)
        tc_codec_init(t->codec, &level, &read);
    return status;
}

/* ---- Choice -------------------------------------------------------------------------------------------------- */

static int64_t common_divisor(int64_t a, int64_t b)
{
    return b == 0 ? a : common_divisor(b, a % b);
}

int tc_codec_sample(const tc_lifting_level *level, int wanted, tc_training_tile *tiles)
{
    tc_codec c = {.level = *level, .cw = tc_coarse_size(level->width), .ch = tc_coarse_size(level->height)};
    int64_t across = (c.cw + TC_TILE - 1) / TC_TILE, all = across * ((c.ch + TC_TILE - 1) / TC_TILE);
    int count = (int)tc_min64(all, wanted);
    /* Steps of about the golden section through all tiles, which come to none twice. */
    int64_t step = tc_max64(1, (int64_t)(0.6180339887498949 * (double)all));
    while (count < all && common_divisor(step, all) != 1)
        step++;
    for (int k = 0; k < count; k++) {
        int64_t n = count == all ? k : (all / 2 + k * step) % all;
        tc_training_tile *t = &tiles[k];
        *t = (tc_training_tile){.tx = n % across, .ty = n / across};
        tc_rect tile = tc_codec_tile_rect(&c, t->tx, t->ty, 0), need = tc_codec_tile_needs(&c, tile);
        t->coarse = (tc_plane){NULL, need.x1 - need.x0, need};
        for (int b = 0; b < TC_BANDS; b++)
            t->band[b] = (tc_plane){NULL, tile.x1 - tile.x0, tile};
    }
    return count;
}

tc_status tc_codec_price(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                         const tc_detail_model *model, double bits[TC_BANDS], double error[TC_BANDS])
{
    trainer t;
    price p;
    tc_status status = trainer_init(&t, level, tiles, count, lambda, model);
    if (!status && !(status = encode_all(&t, 1, false, &p)))
        for (int b = 0; b < TC_BANDS; b++)
            bits[b] = p.bits[b], error[b] = p.error[b] * ((double)model->step[b] * model->step[b]);
    trainer_free(&t);
    return status;
}

/* The cheapest parts so far, for the whole level. */
typedef struct choice {
    tc_detail_parts parts;
    double bits;
} choice;

static void offer(choice *best, const trainer *t, tc_detail_parts parts, double bits, size_t header)
{
    bits = bits * (double)(t->codec->tiles_x * t->codec->tiles_y) / t->tiles + 8 * (double)header;
    if (bits < best->bits)
        *best = (choice){parts, bits};
}

/* Symbols from counts and the table before. */
static void learn_symbols(const tc_symbol_counts *count, tc_rans_frequencies symbols[TC_BINS])
{
    enum { PRIOR = 64 }; /* what the old table weighs against symbols seen */
    for (int b = 0; b < TC_BINS; b++) {
        uint64_t weight[TC_RANS_SYMBOLS];
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            weight[s] = count->of[b][s] * TC_RANS_SLOTS + (uint64_t)symbols[b].of[s] * PRIOR;
        symbols[b] = tc_rans_normalise(weight);
    }
}

/* Trains *own, whose scales and symbols are what to start from, and offers what comes of it. set: the built-in set
 * whose parts go with own ones. */
static tc_status train(trainer *t, int set, tc_detail_model *own, uint8_t *header, choice *best)
{
    enum { OWN = TC_MODEL_OWN };
    tc_detail_parts parts = {OWN, set, set};
    tc_detail_model base;
    price p;
    size_t size;
    tc_status status = set_up(t, own, parts, header, &size);
    if (status)
        return status;
    train_hl(t), train_lh(t);
    memcpy(own->predict, t->codec->model.predict, sizeof own->predict);
    if ((status = set_up(t, own, parts, header, &size)) || (status = encode_all(t, 1, true, &p)))
        return status;
    offer(best, t, parts, p.rest + symbol_bits(&p.count, &t->codec->model), size);
    for (int round = 0; round < ROUNDS; round++) {
        for (int b = 0; b < TC_BANDS; b++)
            for (int n = 0; n < TC_PHASES; n++)
                if (t->features[b][n] > 0)
                    fit(t->feature[b][n], t->features[b][n], own->scale[b][n]);
        if ((status = set_up(t, own, (tc_detail_parts){OWN, OWN, OWN}, header, &size)) ||
            (status = encode_all(t, 1, round < ROUNDS - 1, &p)))
            return status;
        learn_symbols(&p.count, own->symbols);
    }
    tc_detail_model_builtin(set, &base);
    parts = (tc_detail_parts){OWN, OWN, set};
    offer(best, t, parts, p.rest + symbol_bits(&p.count, &base), tc_detail_model_write(own, parts, header));
    parts.symbols = OWN;
    if (!(status = set_up(t, own, parts, header, &size)))
        offer(best, t, parts, p.rest + symbol_bits(&p.count, &t->codec->model), size);
    return status;
}

tc_status tc_codec_train(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                         tc_detail_model *model)
{
    trainer t;
    choice best = {{0}, INFINITY};
    tc_detail_model own = *model;
    tc_status status = trainer_init(&t, level, tiles, count, lambda, model);
    uint8_t *header = malloc(tc_detail_model_bound());
    if (!status && !header)
        status = TC_ERR_MEMORY;
    if (!status && !(status = make_room(&t)) && !(status = train(&t, 0, &own, header, &best)))
        *model = own;
    free(header);
    trainer_free(&t);
    return status;
}

/* Offers the best built-in set. Some tiles are enough to see which it is, but the offer counts all, as others do. */
static tc_status best_set(trainer *t, const tc_detail_model *steps, uint8_t *header, int *set_ret, choice *best)
{
    double least = INFINITY;
    price p;
    size_t size;
    tc_status status = TC_OK;
    for (int set = 0; set < TC_BUILTIN_MODELS && !status; set++) {
        status = set_up(t, steps, (tc_detail_parts){set, set, set}, header, &size);
        if (status || (status = encode_all(t, (t->tiles + PRICED_TILES - 1) / PRICED_TILES, false, &p)))
            return status;
        double bits = p.rest + symbol_bits(&p.count, &t->codec->model);
        if (bits < least)
            least = bits, *set_ret = set;
    }
    tc_detail_parts parts = {*set_ret, *set_ret, *set_ret};
    if ((status = set_up(t, steps, parts, header, &size)) || (status = encode_all(t, 1, false, &p)))
        return status;
    offer(best, t, parts, p.rest + symbol_bits(&p.count, &t->codec->model), size);
    return TC_OK;
}

tc_status tc_codec_choose(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                          const int32_t step[TC_BANDS], const tc_detail_model *start, uint8_t *header, size_t *size_ret,
                          tc_detail_model *model_ret)
{
    trainer t;
    tc_detail_model own;
    choice best = {{0}, INFINITY};
    int set = 0;
    tc_detail_model_builtin(0, &own);
    memcpy(own.step, step, sizeof own.step);
    tc_status status = trainer_init(&t, level, tiles, count, lambda, &own);
    status = status ? status : make_room(&t);
    status = status || count == 0 ? status : best_set(&t, &own, header, &set, &best);
    if (!status && count > 0) {
        if (start)
            own = *start;
        else
            tc_detail_model_builtin(set, &own);
        memcpy(own.step, step, sizeof own.step);
        status = train(&t, set, &own, header, &best);
    }
    if (!status) {
        *size_ret = tc_detail_model_write(&own, best.parts, header);
        status = tc_detail_model_read(header, *size_ret, model_ret, &best.parts);
    }
    trainer_free(&t);
    return status;
}
