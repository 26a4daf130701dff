/* codec_lh04_train.c - fits a model to residuals: means by counting, weights as scales in codec_train.c (maximum
 * likelihood by multiplicative updates), symbols and flags by counting. Each depends on quantisation, which depends on
 * them, so they go around several times. */
#include <math.h>
#include <stdlib.h>

#include "codec_lh04_tile.h"

enum { ROUNDS = 3, ITERATIONS = 16, COLUMNS = TC_LH04_SCALE + 1 };

typedef struct trainer {
    tc_lh04_codec *codec;
    const tc_lh04_sample *sample;
    int64_t samples;
    double lambda;
    tc_lh04_work *work;
    uint8_t *bytes;
    float *feature[TC_LH04_CLASSES][TC_PHASES]; /* COLUMNS numbers a coefficient, the last one its magnitude */
    int64_t features[TC_LH04_CLASSES][TC_PHASES];
    double sum[BANDS]; /* of magnitudes */
    int64_t blocks;
} trainer;

static tc_status encode(trainer *t, int64_t n, tc_lh04_options *options)
{
    const tc_lh04_sample *s = &t->sample[n];
    size_t size;
    options->lambda = t->lambda;
    return tc_lh04_encode_tile(t->codec, s->tx, s->ty, &s->coarse, &s->fine, options, t->bytes, &size, t->work);
}

static void set_up(trainer *t, const tc_lh04_model *model)
{
    tc_lifting_level level = t->codec->level;
    tc_lh04_model copy = *model;
    tc_lh04_init(t->codec, &level, &copy);
}

/* Number of blocks of sample n. */
static void extent(const trainer *t, int64_t n, int *columns, int *rows)
{
    tc_lh04_extent(tc_lh04_tile_rect(t->codec, t->sample[n].tx, t->sample[n].ty, 0), columns, rows);
}

static void take_means(trainer *t, tc_lh04_model *model)
{
    for (int b = 0; b < BANDS; b++) {
        double mean = (t->sum[b] + 0.05) / (double)(t->blocks + 1);
        model->mean[b] = (uint8_t)fmin(fmax(rint(4 * (log2(mean) + 8)), 0), TC_LH04_MEANS - 1);
    }
}

/* First means: coefficients rounded with a dead zone. */
static tc_status first_means(trainer *t)
{
    tc_lh04_model model = t->codec->model;
    memset(t->sum, 0, sizeof t->sum), t->blocks = 0;
    for (int64_t n = 0; n < t->samples; n++) {
        tc_lh04_options options = {0};
        tc_status status = encode(t, n, &options);
        if (status)
            return status;
        int columns, rows;
        extent(t, n, &columns, &rows);
        t->blocks += columns * rows;
        for (int b = 0; b < BANDS; b++)
            for (int j = 0; j < rows; j++)
                for (int i = 0; i < columns; i++)
                    t->sum[b] += floor(fabs(t->work->exact[b][j][i]) + 0.35);
    }
    take_means(t, &model);
    set_up(t, &model);
    return TC_OK;
}

/* Features of every coefficient that the tile in the work has. The totals are gathered once more on the way. */
static void gather(trainer *t, int64_t n)
{
    tc_lh04_work *w = t->work;
    int columns, rows;
    extent(t, n, &columns, &rows);
    t->blocks += columns * rows;
    memset(w->total, 0, sizeof w->total);
    for (int place = 0; place < BANDS; place++) {
        const tc_lh04_band *b = &t->codec->band[place];
        if (!w->coded[place])
            continue;
        for (int j = 0; j < rows; j++) {
            tc_lh04_row(b, j, w);
            for (int i = 0; i < columns; i++) {
                int phase = i % TC_PHASES, k = i / TC_PHASES;
                float *f = t->feature[b->class][phase] + t->features[b->class][phase]++ * COLUMNS;
                int32_t known[TC_LH04_SCALE];
                tc_lh04_features(w, place, phase, j, k, known);
                for (int m = 0; m < TC_LH04_SCALE; m++)
                    f[m] = (float)known[m] * (float)b->ratio[m] / 4096;
                f[TC_LH04_SCALE] = seen_at(w, place, j, phase)[k];
                t->sum[b->index] += seen_at(w, place, j, phase)[k];
            }
        }
        tc_lh04_add(w, place, rows);
    }
}

static void fit(const float *feature, int64_t count, uint16_t weight[TC_LH04_SCALE])
{
    enum { UNIT = 1024 };
    double w[TC_LH04_SCALE];
    for (int k = 0; k < TC_LH04_SCALE; k++)
        w[k] = fmax(weight[k] / (double)UNIT, 0.004); /* zero would stay zero */
    for (int n = 0; n < ITERATIONS; n++) {
        double up[TC_LH04_SCALE] = {0}, down[TC_LH04_SCALE] = {0};
        for (int64_t i = 0; i < count; i++) {
            const float *f = feature + i * COLUMNS;
            double s = 0.001;
            for (int k = 0; k < TC_LH04_SCALE; k++)
                s += w[k] * f[k];
            double seen = f[TC_LH04_SCALE] / s, expected = (1 + f[TC_LH04_SCALE]) / (1 + s);
            for (int k = 0; k < TC_LH04_SCALE; k++)
                up[k] += f[k] * seen, down[k] += f[k] * expected;
        }
        for (int k = 0; k < TC_LH04_SCALE; k++)
            w[k] = down[k] > 0 ? fmin(w[k] * sqrt(up[k] / down[k]), 4) : w[k];
    }
    for (int k = 0; k < TC_LH04_SCALE; k++)
        weight[k] = (uint16_t)lrint(w[k] * UNIT);
}

static tc_status train_weights(trainer *t)
{
    tc_lh04_model model = t->codec->model;
    memset(t->features, 0, sizeof t->features), memset(t->sum, 0, sizeof t->sum), t->blocks = 0;
    for (int64_t n = 0; n < t->samples; n++) {
        tc_lh04_options options = {0};
        tc_status status = encode(t, n, &options);
        if (status)
            return status;
        gather(t, n);
    }
    for (int c = 0; c < TC_LH04_CLASSES; c++)
        for (int p = 0; p < TC_PHASES; p++)
            if (t->features[c][p] > 0)
                fit(t->feature[c][p], t->features[c][p], model.weight[c][p]);
    take_means(t, &model);
    set_up(t, &model);
    return TC_OK;
}

static tc_status train_symbols(trainer *t)
{
    enum { PRIOR = 64, FLAG_PRIOR = 8 }; /* what the old tables weigh against symbols seen */
    tc_lh04_counts count = {0};
    tc_lh04_model model = t->codec->model;
    for (int64_t n = 0; n < t->samples; n++) {
        tc_lh04_options options = {.count = &count};
        tc_status status = encode(t, n, &options);
        if (status)
            return status;
    }
    for (int b = 0; b < TC_BINS; b++) {
        uint64_t weight[TC_RANS_SYMBOLS];
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            weight[s] = count.of[b][s] * TC_RANS_SLOTS + (uint64_t)model.symbols[b].of[s] * PRIOR;
        model.symbols[b] = tc_rans_normalise(weight);
    }
    for (int n = 0; n < TC_LH04_FLAGS; n++) {
        double none = (double)count.flag[n][0] + FLAG_PRIOR * model.empty[n] / 256.0;
        double all = (double)(count.flag[n][0] + count.flag[n][1]) + FLAG_PRIOR;
        model.empty[n] = (uint8_t)fmin(fmax(rint(256 * none / all), 1), 255);
    }
    set_up(t, &model);
    return TC_OK;
}

/* Bits of all tiles of the level with the codec's model, errors counted as the bits that they are worth. */
static tc_status price(trainer *t, double *bits_ret)
{
    double bits = 0, error = 0, lambda = t->lambda == 0 ? TC_LH04_LAMBDA : t->lambda;
    for (int64_t n = 0; n < t->samples; n++) {
        tc_lh04_options options = {.bits = &bits, .error = &error};
        tc_status status = encode(t, n, &options);
        if (status)
            return status;
    }
    *bits_ret = (bits + (lambda > 0 ? error / lambda : 0)) * (double)(t->codec->tiles_x * t->codec->tiles_y) /
                (double)t->samples;
    return TC_OK;
}

static tc_status train(trainer *t, tc_lh04_model *model_ret)
{
    tc_lh04_model own, base, best;
    double least = INFINITY;
    tc_status status = first_means(t);
    base = t->codec->model;
    for (int k = 0; k < ROUNDS && !status; k++)
        if (!(status = train_weights(t)))
            status = train_symbols(t);
    own = t->codec->model;
    memcpy(base.mean, own.mean, sizeof own.mean), memcpy(base.empty, own.empty, sizeof own.empty);
    for (int n = 0; n < 4 && !status; n++) {
        tc_lh04_model now = own;
        double bits;
        now.own_weights = n & 1, now.own_symbols = n >> 1;
        if (!now.own_weights)
            memcpy(now.weight, base.weight, sizeof base.weight);
        if (!now.own_symbols)
            memcpy(now.symbols, base.symbols, sizeof base.symbols);
        size_t size = tc_lh04_model_write(&now, t->bytes);
        if ((status = tc_lh04_model_read(t->bytes, size, &now)))
            break;
        set_up(t, &now);
        if (!(status = price(t, &bits)) && bits + 8 * (double)size < least)
            least = bits + 8 * (double)size, best = now;
    }
    if (!status)
        *model_ret = best;
    return status;
}

static void trainer_free(trainer *t)
{
    for (int c = 0; c < TC_LH04_CLASSES; c++)
        for (int p = 0; p < TC_PHASES; p++)
            free(t->feature[c][p]);
    free(t->codec), free(t->work), free(t->bytes);
}

tc_status tc_lh04_train(const tc_lifting_level *level, const tc_lh04_sample *samples, int64_t count, double lambda,
                        int32_t step, tc_lh04_model *model_ret)
{
    tc_lh04_model model;
    trainer t = {.sample = samples, .samples = count, .lambda = lambda};
    tc_status status = TC_OK;
    if (count < 1)
        return TC_ERR_USAGE;
    tc_lh04_model_builtin(step, &model);
    t.codec = malloc(sizeof *t.codec), t.work = malloc(sizeof *t.work), t.bytes = malloc(tc_lh04_tile_bound());
    if (!t.codec || !t.work || !t.bytes)
        status = TC_ERR_MEMORY;
    if (!status) {
        tc_lh04_init(t.codec, level, &model);
        int64_t bands[TC_LH04_CLASSES] = {0};
        for (int b = 0; b < BANDS; b++)
            bands[t.codec->band[b].class]++;
        for (int c = 0; c < TC_LH04_CLASSES; c++)
            for (int p = 0; p < TC_PHASES; p++) {
                size_t room = (size_t)(count * bands[c] * BLOCKS * RUN) * COLUMNS * sizeof(float);
                if (!(t.feature[c][p] = malloc(room)))
                    status = TC_ERR_MEMORY;
            }
    }
    if (!status)
        status = train(&t, model_ret);
    trainer_free(&t);
    return status;
}
