/* codec_train.c - fits a level's model to its details.
 *
 * Prediction: least squares. Scales: maximum likelihood (codec_fit.c). Symbols: counts. Scales and symbols depend on
 * quantisation, which depends on them, so they go twice around. What a tile teaches is found by any thread, and put
 * together in the tiles' order, so that a model does not depend on how many threads there are. */
#include <math.h>
#include <stdlib.h>

#include "codec_avx2.h"
#include "codec_fit.h"
#include "common/base/parallel.h"

enum {
    ROUNDS = 2,
    STRANDS = TC_FIT_STRANDS,
    TILE_STRANDS = TC_TILE / 2 * HALF / STRANDS, /* of a phase of a band: every second row */
    PRICED_TILES = 6,                            /* for a choice among the built-in sets */
};

/* What coding tiles costs: symbols apart from all else, and errors as the bits that they are worth. */
typedef struct price {
    tc_symbol_counts count;
    double rest, bits[TC_BANDS], error[TC_BANDS];
} price;

/* What one tile teaches. */
typedef struct lesson {
    tc_tile_work work;
    tc_normal normal;
    price price;
    tc_status status;
} lesson;

typedef struct trainer {
    tc_codec *codec;
    const tc_training_tile *tile;
    int tiles, threads;
    double lambda;
    lesson *lesson;                           /* one for each tile */
    tc_strands *feature[TC_BANDS][TC_PHASES]; /* TILE_STRANDS for each tile */
    int each;                                 /* tiles that are encoded: every such one */
    bool keep;                                /* their features */
    uint16_t (*scale)[TC_PHASES][TC_SCALE];   /* to be fitted */
} trainer;

/* ---- Prediction ---------------------------------------------------------------------------------------------- */

static void predictor_solve(tc_normal *n, int count, int16_t weight[TC_PREDICT])
{
    double x[TC_FIT_COLUMNS] = {0};
    tc_normal_solve(n, count, x);
    for (int k = 0; k < TC_PREDICT; k++) {
        double v = k < count ? x[k] * (1 << TC_PREDICT_BITS) : 0;
        weight[k] = isfinite(v) ? (int16_t)lrint(fmin(fmax(v, INT16_MIN), INT16_MAX)) : 0;
    }
}

static tc_rect tile_rect(const trainer *t, int n)
{
    return tc_codec_tile_rect(t->codec, t->tile[n].tx, t->tile[n].ty, 0);
}

static void learn_hl(void *context, int64_t n)
{
    trainer *t = context;
    lesson *l = &t->lesson[n];
    const tc_training_tile *from = &t->tile[n];
    tc_rect tile = tile_rect(t, (int)n);
    int columns, rows;
    l->normal = (tc_normal){0};
    tc_tile_extent(t->codec, TC_HL, tile, 0, &columns, &rows);
    tc_tile_load(t->codec, tile, TC_TILE, &from->coarse, &l->work);
    for (int j = 0; j < rows; j += 2)
        for (int i = j / 2 % 2; i < columns; i += 2) {
            uint32_t term[TC_PREDICT_KERNEL];
            tc_terms_hl(&l->work, i, j, term);
            tc_normal_add(&l->normal, term, TC_PREDICT_KERNEL,
                          *tc_plane_at(&from->band[TC_HL], tile.x0 + i, tile.y0 + j));
        }
}

static void learn_lh(void *context, int64_t n)
{
    trainer *t = context;
    lesson *l = &t->lesson[n];
    const tc_training_tile *from = &t->tile[n];
    tc_rect tile = tile_rect(t, (int)n);
    int columns, rows;
    int32_t step = t->codec->model.step[TC_HL];
    l->normal = (tc_normal){0};
    tc_tile_load(t->codec, tile, TC_TILE, &from->coarse, &l->work);
    tc_predict_hl(t->codec, &l->work, TC_TILE, TC_TILE);
    tc_tile_extent(t->codec, TC_HL, tile, 0, &columns, &rows);
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) { /* about what the decoder will have */
            int32_t *p = &l->work.hl[j + 1][HL_X + i];
            double size = ((double)*tc_plane_at(&from->band[TC_HL], tile.x0 + i, tile.y0 + j) - *p) / step;
            *p = (int32_t)(*p + copysign(step == 1 ? fabs(rint(size)) : floor(fabs(size) + 0.4), size) * step);
        }
    tc_tile_extent(t->codec, TC_LH, tile, 0, &columns, &rows);
    for (int j = 0; j < rows; j += 2)
        for (int i = j / 2 % 2; i < columns; i += 2) {
            uint32_t term[TC_PREDICT];
            tc_terms_lh(&l->work, i, j, term);
            tc_terms_cross(&l->work, i, j, term + TC_PREDICT_KERNEL);
            tc_normal_add(&l->normal, term, TC_PREDICT, *tc_plane_at(&from->band[TC_LH], tile.x0 + i, tile.y0 + j));
        }
}

/* Fits the weights of a band's prediction to all tiles. */
static void train_prediction(trainer *t, int band, void (*learn)(void *context, int64_t n), int terms)
{
    tc_normal all = {0};
    tc_parallel_for(t->threads, t->tiles, learn, t);
    for (int n = 0; n < t->tiles; n++)
        tc_normal_join(&all, &t->lesson[n].normal);
    predictor_solve(&all, terms, t->codec->model.predict[band]);
}

/* ---- Scales and symbols -------------------------------------------------------------------------------------- */

/* Features of the coefficients of every second row of a tile that encoding has left in its work. */
static void gather(const trainer *t, int64_t n)
{
    const tc_codec *c = t->codec;
    tc_tile_work *work = &t->lesson[n].work;
    for (int b = 0; b < TC_BANDS; b++) {
        int columns, rows;
        int64_t count[TC_PHASES] = {0};
        tc_tile_extent(c, b, tile_rect(t, (int)n), 0, &columns, &rows);
        float scale = (float)c->coarse_scale[b] / (1 << 20);
        for (int p = 0; p < TC_PHASES; p++)
            memset(t->feature[b][p] + n * TILE_STRANDS, 0, TILE_STRANDS * sizeof(tc_strands));
        for (int j = 0; j < rows; j += 2)
            for (int i = 0; i < columns; i++) {
                int phase = i % TC_PHASES, k = i / TC_PHASES;
                int64_t at = count[phase]++;
                tc_strands *f = &t->feature[b][phase][n * TILE_STRANDS + at / STRANDS];
                int lane = (int)(at % STRANDS), m = 0;
                int32_t known[TC_SCALE_OWN + TC_SCALE_CROSS], coarse[TC_SCALE_COARSE];
                tc_known_features(work, b, phase, k, j, known);
                tc_coarse_features(work, b, phase, k, j, coarse);
                for (int e = 0; e < TC_SCALE_OWN + TC_SCALE_CROSS; e++)
                    f->of[m++][lane] = (float)known[e];
                for (int e = 0; e < TC_SCALE_COARSE; e++)
                    f->of[m++][lane] = (float)coarse[e] * scale;
                f->of[m++][lane] = 1;
                f->of[m][lane] = magnitude_at(work, b, j, phase)[k];
            }
    }
}

static void fit_phase(void *context, int64_t n)
{
    const trainer *t = context;
    int64_t b = n / TC_PHASES, p = n % TC_PHASES;
    tc_fit_scale(t->feature[b][p], (int64_t)t->tiles * TILE_STRANDS * STRANDS, t->scale[b][p]);
}

static void trainer_free(trainer *t)
{
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            free(t->feature[b][p]);
    free(t->codec), free(t->lesson);
}

static tc_status trainer_init(trainer *t, const tc_lifting_level *level, const tc_training_tile *tiles, int count,
                              double lambda, const tc_detail_model *model, int threads)
{
    *t = (trainer){.tile = tiles, .tiles = count, .threads = threads, .lambda = lambda};
    t->codec = malloc(sizeof *t->codec), t->lesson = malloc((size_t)count * sizeof *t->lesson + 1);
    if (!t->codec || !t->lesson)
        return TC_ERR_MEMORY;
    tc_codec_init(t->codec, level, model);
    return TC_OK;
}

static tc_status make_room(trainer *t)
{
    size_t room = (size_t)t->tiles * TILE_STRANDS * sizeof(tc_strands);
    for (int b = 0; b < TC_BANDS; b++)
        for (int p = 0; p < TC_PHASES; p++)
            if (!(t->feature[b][p] = malloc(room + !room)))
                return TC_ERR_MEMORY;
    return TC_OK;
}

static double symbol_bits(const tc_symbol_counts *count, const tc_detail_model *model)
{
    double bits = 0;
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            if (count->of[b][s])
                bits += (double)count->of[b][s] * (TC_RANS_BITS - log2(model->symbols[b].of[s]));
    return bits;
}

static void encode_tile(void *context, int64_t n)
{
    trainer *t = context;
    lesson *l = &t->lesson[n * t->each];
    const tc_training_tile *tile = &t->tile[n * t->each];
    size_t size;
    memset(&l->price, 0, sizeof l->price);
    tc_encode_options options = {
        .lambda = t->lambda, .count = &l->price.count, .bits = l->price.bits, .error = l->price.error};
    l->status =
        tc_codec_encode_tile(t->codec, tile->tx, tile->ty, &tile->coarse, tile->band, &options, NULL, &size, &l->work);
    if (!l->status && t->keep)
        gather(t, n * t->each);
}

static void add_price(price *to, const price *from)
{
    for (int b = 0; b < TC_BINS; b++)
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            to->count.of[b][s] += from->count.of[b][s];
    for (int b = 0; b < TC_BANDS; b++)
        to->bits[b] += from->bits[b], to->error[b] += from->error[b];
}

/* Encodes the tiles with the codec's model, every `each`-th of them; keeps their features where asked to. */
static tc_status encode_all(trainer *t, int each, bool keep, price *p)
{
    double lambda = t->lambda == 0 ? TC_DEFAULT_LAMBDA : t->lambda;
    memset(p, 0, sizeof *p);
    t->each = each, t->keep = keep;
    tc_parallel_for(t->threads, (t->tiles + each - 1) / each, encode_tile, t);
    for (int n = 0; n < t->tiles; n += each) {
        if (t->lesson[n].status)
            return t->lesson[n].status;
        add_price(p, &t->lesson[n].price);
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
    tc_status status = trainer_init(&t, level, tiles, count, lambda, model, 1);
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
    train_prediction(t, TC_HL, learn_hl, TC_PREDICT_KERNEL);
    train_prediction(t, TC_LH, learn_lh, TC_PREDICT);
    memcpy(own->predict, t->codec->model.predict, sizeof own->predict);
    if ((status = set_up(t, own, parts, header, &size)) || (status = encode_all(t, 1, true, &p)))
        return status;
    offer(best, t, parts, p.rest + symbol_bits(&p.count, &t->codec->model), size);
    for (int round = 0; round < ROUNDS; round++) {
        t->scale = own->scale;
        tc_parallel_for(t->threads, TC_BANDS * TC_PHASES, fit_phase, t);
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
    tc_status status = trainer_init(&t, level, tiles, count, lambda, model, 1);
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
                          const int32_t step[TC_BANDS], const tc_detail_model *start, int threads, uint8_t *header,
                          size_t *size_ret, tc_detail_model *model_ret)
{
    trainer t;
    tc_detail_model own;
    choice best = {{0}, INFINITY};
    int set = 0;
    tc_detail_model_builtin(0, &own);
    memcpy(own.step, step, sizeof own.step);
    tc_status status = trainer_init(&t, level, tiles, count, lambda, &own, threads);
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
