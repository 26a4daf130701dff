/* codec_train.c - fits a level's model to its details.
 *
 * Prediction: least squares, by the normal equations. Scales: maximum likelihood of magnitudes q that are geometrically
 * distributed (a quantised Laplacian) with expected value s = sum of w_k f_k over non-negative weights. The likelihood
 * of q is s^q / (1 + s)^(q + 1), and the updates are multiplicative, in the manner of non-negative matrix factorisation
 * (Lee, Seung 2000):
 *     w_k <- w_k sqrt(sum f_k q / s  /  sum f_k (1 + q) / (1 + s)).
 * A continuous exponential would not do: where s is small, it fears the rare one far more than the code does. Symbols:
 * counts. Scales and symbols depend on quantisation, which depends on them, so they go twice around. */
#include <math.h>
#include <stdlib.h>

#include "codec_tile.h"

enum { ROUNDS = 2, ITERATIONS = 16, COLUMNS = TC_PREDICT };

typedef struct trainer {
    tc_codec *codec;
    const tc_training_tile *tile;
    int tiles;
    tc_tile_work *work;
    double lambda;
    float *feature[TC_BANDS][TC_PHASES]; /* TC_SCALE + 1 numbers a coefficient, the last one its magnitude */
    int64_t features[TC_BANDS][TC_PHASES];
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
static void normal_solve(normal *n, int count, int16_t weight[TC_PREDICT])
{
    double x[COLUMNS] = {0};
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
            for (int m = k; m <= COLUMNS; m++)
                q[m] -= f * p[m];
        }
    }
    for (int k = count - 1; k >= 0; k--) {
        const double *p = n->a[order[k]];
        double sum = p[COLUMNS];
        for (int i = k + 1; i < count; i++)
            sum -= p[i] * x[i];
        x[k] = sum / p[k];
    }
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
        tc_tile_load(t->codec, tile, &t->tile[k].coarse, t->work);
        for (int j = 0; j < rows; j += 2)
            for (int i = j / 2 % 2; i < columns; i += 2) {
                uint32_t term[TC_PREDICT_KERNEL];
                tc_terms_hl(t->work, i, j, term);
                normal_add(&n, term, TC_PREDICT_KERNEL,
                           *tc_plane_at(&t->tile[k].band[TC_HL], tile.x0 + i, tile.y0 + j));
            }
    }
    normal_solve(&n, TC_PREDICT_KERNEL, t->codec->model.predict[TC_HL]);
}

static void train_lh(trainer *t)
{
    normal n = {0};
    int32_t step = t->codec->model.step[TC_HL];
    for (int k = 0; k < t->tiles; k++) {
        tc_rect tile = tile_rect(t, k);
        int columns, rows;
        tc_tile_load(t->codec, tile, &t->tile[k].coarse, t->work);
        tc_predict_hl(t->codec, t->work);
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
    normal_solve(&n, TC_PREDICT, t->codec->model.predict[TC_LH]);
}

/* ---- Scales and symbols -------------------------------------------------------------------------------------- */

static tc_status encode(trainer *t, int n, tc_symbol_counts *count, double *bits, double *error)
{
    size_t size;
    const tc_training_tile *tile = &t->tile[n];
    tc_encode_options options = {.lambda = t->lambda, .count = count, .bits = bits, .error = error};
    return tc_codec_encode_tile(t->codec, tile->tx, tile->ty, &tile->coarse, tile->band, &options, NULL, &size,
                                t->work);
}

/* Features of every coefficient of a tile that encode() has left in the work. */
static void gather(trainer *t, tc_rect tile)
{
    const tc_codec *c = t->codec;
    for (int b = 0; b < TC_BANDS; b++) {
        int columns, rows;
        tc_tile_extent(c, b, tile, 0, &columns, &rows);
        for (int j = 0; j < rows; j++)
            for (int i = 0; i < columns; i++) {
                int phase = i % TC_PHASES, k = i / TC_PHASES;
                float *f = t->feature[b][phase] + t->features[b][phase]++ * (TC_SCALE + 1);
                int32_t known[TC_SCALE_OWN + TC_SCALE_CROSS], coarse[TC_SCALE_COARSE];
                tc_known_features(t->work, b, phase, k, j, known);
                tc_coarse_features(t->work, b, phase, k, j, coarse);
                for (int n = 0; n < TC_SCALE_OWN + TC_SCALE_CROSS; n++)
                    *f++ = (float)known[n];
                for (int n = 0; n < TC_SCALE_COARSE; n++)
                    *f++ = (float)coarse[n] * (float)c->coarse_scale[b] / (1 << 20);
                *f++ = 1;
                *f = magnitude_at(t->work, b, j, phase)[k];
            }
    }
}

/* Weights of one phase of a band from its features. */
static void fit(const float *feature, int64_t count, uint16_t weight[TC_SCALE])
{
    enum { UNIT = 1 << TC_SCALE_BITS };
    double w[TC_SCALE];
    for (int k = 0; k < TC_SCALE; k++)
        w[k] = fmax(weight[k] / (double)UNIT, k == TC_SCALE - 1 ? 0.003 : 0.004); /* zero would stay zero */
    for (int n = 0; n < ITERATIONS; n++) {
        double up[TC_SCALE] = {0}, down[TC_SCALE] = {0};
        for (int64_t i = 0; i < count; i++) {
            const float *f = feature + i * (TC_SCALE + 1);
            double s = 0.001;
            for (int k = 0; k < TC_SCALE; k++)
                s += w[k] * f[k];
            double seen = f[TC_SCALE] / s, expected = (1 + f[TC_SCALE]) / (1 + s);
            for (int k = 0; k < TC_SCALE; k++)
                up[k] += f[k] * seen, down[k] += f[k] * expected;
        }
        for (int k = 0; k < TC_SCALE; k++)
            w[k] = down[k] > 0 ? fmin(w[k] * sqrt(up[k] / down[k]), 4) : w[k];
    }
    for (int k = 0; k < TC_SCALE; k++)
        weight[k] = (uint16_t)lrint(w[k] * UNIT);
}

static tc_status train_scale(trainer *t)
{
    memset(t->features, 0, sizeof t->features);
    for (int n = 0; n < t->tiles; n++) {
        tc_status status = encode(t, n, NULL, NULL, NULL);
        if (status)
            return status;
        gather(t, tile_rect(t, n));
    }
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            if (t->features[b][p] > 0)
                fit(t->feature[b][p], t->features[b][p], t->codec->model.scale[b][p]);
    return TC_OK;
}

static tc_status train_symbols(trainer *t)
{
    enum { PRIOR = 64 }; /* what the old table weighs against symbols seen */
    tc_symbol_counts count = {{{0}}};
    for (int n = 0; n < t->tiles; n++) {
        tc_status status = encode(t, n, &count, NULL, NULL);
        if (status)
            return status;
    }
    for (int b = 0; b < TC_BINS; b++) {
        uint64_t weight[TC_RANS_SYMBOLS];
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            weight[s] = count.of[b][s] * TC_RANS_SLOTS + (uint64_t)t->codec->model.symbols[b].of[s] * PRIOR;
        t->codec->model.symbols[b] = tc_rans_normalise(weight);
    }
    return TC_OK;
}

static void set_up(trainer *t, const tc_detail_model *model)
{
    tc_lifting_level level = t->codec->level;
    tc_detail_model copy = *model;
    tc_codec_init(t->codec, &level, &copy);
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
    size_t room = (size_t)t->tiles * TC_TILE * HALF * (TC_SCALE + 1) * sizeof(float);
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            if (!(t->feature[b][p] = malloc(room + !room)))
                return TC_ERR_MEMORY;
    return TC_OK;
}

/* Trains the codec's model. */
static tc_status train(trainer *t)
{
    train_hl(t);
    train_lh(t);
    for (int k = 0; k < ROUNDS; k++) {
        tc_status status = train_scale(t);
        if (status || (status = train_symbols(t)))
            return status;
        set_up(t, &t->codec->model);
    }
    return TC_OK;
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

static tc_status price(trainer *t, double bits[TC_BANDS], double error[TC_BANDS])
{
    memset(bits, 0, TC_BANDS * sizeof *bits), memset(error, 0, TC_BANDS * sizeof *error);
    for (int n = 0; n < t->tiles; n++) {
        tc_status status = encode(t, n, NULL, bits, error);
        if (status)
            return status;
    }
    return TC_OK;
}

tc_status tc_codec_price(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                         const tc_detail_model *model, double bits[TC_BANDS], double error[TC_BANDS])
{
    trainer t;
    tc_status status = trainer_init(&t, level, tiles, count, lambda, model);
    if (!status && !(status = price(&t, bits, error)))
        for (int b = 0; b < TC_BANDS; b++)
            error[b] *= (double)model->step[b] * model->step[b];
    trainer_free(&t);
    return status;
}

/* Bits of the whole level with the codec's model, errors counted as the bits that they are worth. */
static tc_status whole_price(trainer *t, double *bits_ret)
{
    double bits[TC_BANDS], error[TC_BANDS], lambda = t->lambda == 0 ? TC_DEFAULT_LAMBDA : t->lambda, sum = 0;
    tc_status status = price(t, bits, error);
    for (int b = 0; b < TC_BANDS && !status; b++)
        sum += bits[b] + (lambda > 0 ? error[b] / lambda : 0);
    *bits_ret = sum * (double)(t->codec->tiles_x * t->codec->tiles_y) / t->tiles;
    return status;
}

tc_status tc_codec_choose(const tc_lifting_level *level, const tc_training_tile *tiles, int count, double lambda,
                          const int32_t step[TC_BANDS], const tc_detail_model *start, uint8_t *header, size_t *size_ret,
                          tc_detail_model *model_ret)
{
    trainer t;
    tc_detail_model own, model;
    tc_detail_parts parts, best = {0};
    double least = INFINITY;
    int set = 0;
    tc_detail_model_builtin(0, &own);
    memcpy(own.step, step, sizeof own.step);
    tc_status status = trainer_init(&t, level, tiles, count, lambda, &own);
    status = status ? status : make_room(&t);
    /* The built-in sets, then own parts. */
    for (int n = 0; n < TC_BUILTIN_MODELS + 4 && !status && count > 0; n++) {
        enum { OWN = TC_MODEL_OWN };
        if (n == TC_BUILTIN_MODELS) {
            set = best.predict;
            tc_detail_model_builtin(set, &own);
            if (start)
                own = *start;
            memcpy(own.step, step, sizeof own.step);
            set_up(&t, &own);
            if ((status = train(&t)))
                break;
            own = t.codec->model;
        }
        const tc_detail_parts tries[] = {{OWN, set, set}, {OWN, OWN, set}, {OWN, set, OWN}, {OWN, OWN, OWN}};
        parts = n < TC_BUILTIN_MODELS ? (tc_detail_parts){n, n, n} : tries[n - TC_BUILTIN_MODELS];
        double bits = 0;
        size_t size = tc_detail_model_write(&own, parts, header);
        if ((status = tc_detail_model_read(header, size, &model, &parts)))
            break;
        set_up(&t, &model);
        if (!(status = whole_price(&t, &bits)) && bits + 8 * (double)size < least)
            least = bits + 8 * (double)size, best = parts;
    }
    if (!status) {
        *size_ret = tc_detail_model_write(&own, best, header);
        status = tc_detail_model_read(header, *size_ret, model_ret, &best);
    }
    trainer_free(&t);
    return status;
}
