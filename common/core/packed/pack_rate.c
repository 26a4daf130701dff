/* pack_rate.c - which quantiser step gives the error asked for.
 *
 * The transform is nearly orthogonal, so the square error of the finest level is about the sum of the bands' square
 * errors by their norms. The cascade has counted the details of every level; a model of what a quantiser does to them
 * gives a first step. Coarse levels are coded with it. For the finest level the model is corrected by the ratio of what
 * coding a sample of tiles gives to what the model says of the same tiles, and once the level is coded by what came of
 * it. Seldom is a level coded twice. */
#include <math.h>

#include "common/core/base/rect.h"
#include "common/core/base/status.h"
#include "pack_internal.h"

static const double AIM = 0.988, LEAST = 0.97; /* of the target */
enum { SAMPLE_TILES = 48, MOST_TRIES = 12 };
static const double LARGEST_STEP = 64.0 * TC_MAX_STEP;

/* Square error that quantising a detail leaves: small ones vanish, others are off by an even share of the step. */
static double quantiser_error(double detail, double step)
{
    return detail < 0.62 * step ? detail * detail : 0.093 * step * step;
}

/* Sum of square errors of a band, in squared height units. */
static double histogram_error(const tc_detail_histogram *h, double step)
{
    double sum = 0;
    for (int i = 1; i < TC_DETAIL_BINS; i++)
        if (h->count[i])
            sum += (double)h->count[i] * quantiser_error(exp2((i - 1) / 4.0 + 0.125), step);
    return sum;
}

static double band_step(const tc_packer *p, int band, int l, double q)
{
    return fmin(fmax(1, rint(q / tc_lifting_norm(band, p->container.levels - l))), TC_MAX_STEP);
}

/* Square error that level l's own details leave in each sample of the level. */
static double level_error(const tc_packer *p, int l, double q)
{
    const tc_level *level = &p->container.level[l - 1];
    double sum = 0;
    for (int b = 0; b < TC_BANDS; b++) {
        double norm = tc_lifting_norm(b, 0);
        sum += norm * norm * histogram_error(&p->histogram[l - 1][b], band_step(p, b, l, q));
    }
    return sum / ((double)level->width * (double)level->height);
}

static double all_levels_error(const tc_packer *p, double q)
{
    double sum = 0;
    for (int k = p->container.base + 1; k <= p->container.levels; k++)
        sum += level_error(p, k, q);
    return sum;
}

/* The step at which the model of all levels is at the target. */
static double solve(const tc_packer *p, double target)
{
    double low = 0.1, high = LARGEST_STEP;
    if (all_levels_error(p, high) <= target)
        return high;
    for (int i = 0; i < 60; i++) {
        double middle = sqrt(low * high);
        if (all_levels_error(p, middle) < target)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* ---- Sample tiles ---------------------------------------------------------------------------------------------- */

typedef struct sample {
    tc_lifting_level level;
    int count;
    tc_training_tile tile[SAMPLE_TILES];
} sample;

static void sample_free(sample *s)
{
    for (int i = 0; i < s->count; i++) {
        free(s->tile[i].coarse.z);
        for (int b = 0; b < TC_BANDS; b++)
            free(s->tile[i].band[b].z);
    }
}

static int32_t *plane_memory(tc_plane *plane)
{
    plane->stride = plane->rect.x1 - plane->rect.x0;
    return plane->z = malloc((size_t)tc_rect_area(plane->rect) * sizeof *plane->z);
}

static tc_status sample_tiles(const tc_packer *p, int l, const tc_spool *coarse, int wanted, sample *s, tc_error *error)
{
    const tc_level *size = &p->container.level[l - 1];
    s->level = (tc_lifting_level){size->width, size->height, p->container.wrap_x};
    s->count = tc_codec_sample(&s->level, wanted, s->tile);
    int32_t *scratch = malloc(tc_pack_details_scratch() * sizeof *scratch);
    tc_status status = scratch ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    for (int i = 0; i < s->count && !status; i++) {
        tc_training_tile *t = &s->tile[i];
        tc_plane fine = {.rect = tc_pack_details_need(&s->level, t->band[0].rect)};
        bool good = plane_memory(&fine) && plane_memory(&t->coarse);
        for (int b = 0; b < TC_BANDS; b++)
            good &= plane_memory(&t->band[b]) != NULL;
        if (!good)
            status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
        if (!status)
            status = tc_pack_truth(p, l, fine.rect, fine.z, fine.stride, error);
        if (!status)
            status = tc_spool_read(coarse, t->coarse.rect, t->coarse.z, t->coarse.stride, error);
        if (!status)
            tc_pack_details(&s->level, t->band[0].rect, &fine, t->band, scratch);
        free(fine.z);
    }
    free(scratch);
    return status;
}

/* ---- Levels ---------------------------------------------------------------------------------------------------- */

typedef struct search {
    tc_packer *p;
    tc_spool coarse, fine; /* reconstructed levels */
    tc_codec *codec;
    tc_detail_model model; /* of the last level coded */
    bool has_model;
    double q;      /* of the levels below the finest */
    double target; /* squared error in squared height units */
    tc_level_outcome outcome;
} search;

/* Gives the level a model for step q. */
static tc_status choose_model(search *s, const sample *tiles, int l, double q, tc_error *error)
{
    tc_packer *p = s->p;
    tc_level_record *record = &p->container.record[l - 1];
    int32_t step[TC_BANDS];
    for (int b = 0; b < TC_BANDS; b++)
        step[b] = (int32_t)band_step(p, b, l, q);
    free(record->model);
    record->model = malloc(tc_detail_model_bound());
    tc_detail_model model;
    tc_status status =
        record->model
            ? tc_codec_choose(&tiles->level, tiles->tile, (int)tc_min64(tiles->count, TC_TRAINING_TILES), 0, step,
                              s->has_model ? &s->model : NULL, record->model, &record->model_size, &model)
            : TC_ERR_MEMORY;
    if (status)
        return tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    s->model = model, s->has_model = true;
    tc_codec_init(s->codec, &tiles->level, &model);
    return TC_OK;
}

static tc_status code_level(search *s, int l, double share, tc_error *error)
{
    tc_packer *p = s->p;
    bool last = l == p->container.levels;
    tc_level_coding coding = {l, s->codec, 0, &s->coarse, last ? NULL : &s->fine, share};
    return tc_pack_level(p, &coding, &s->outcome, error);
}

/* Square error of each sample that is not void, in squared height units. */
static double mean_error(const search *s)
{
    double unit = s->p->container.z_unit;
    return s->outcome.samples ? s->outcome.square_error / (double)s->outcome.samples / (unit * unit) : 0;
}

/* Square error that coding a sample of the finest level's tiles leaves in each sample of the level, by the model's
 * steps scaled to q. The sample is corrected by what the quantiser's model says of all details and of those of the
 * sample. */
static tc_status estimate(const search *s, const sample *tiles, double q, double *error_ret, tc_error *error)
{
    const tc_packer *p = s->p;
    int l = p->container.levels;
    tc_detail_model model = s->model;
    double bits[TC_BANDS], errors[TC_BANDS], seen = 0, modelled = 0;
    for (int b = 0; b < TC_BANDS; b++)
        model.step[b] = (int32_t)band_step(p, b, l, q);
    tc_status status = tc_codec_price(&tiles->level, tiles->tile, tiles->count, 0, &model, bits, errors);
    if (status)
        return tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    for (int b = 0; b < TC_BANDS; b++) {
        tc_detail_histogram h = {0};
        for (int i = 0; i < tiles->count; i++)
            tc_pack_count(&tiles->tile[i].band[b], &h);
        double norm = tc_lifting_norm(b, 0);
        seen += norm * norm * errors[b];
        modelled += norm * norm * histogram_error(&h, band_step(p, b, l, q));
    }
    *error_ret = level_error(p, l, q) * (modelled > 0 ? seen / modelled : 1);
    return TC_OK;
}

/* A point of a curve of errors over steps, and where the curve reaches a target: by the power law through two points,
 * or through one with a likely exponent. No further than REACH times from the last point. */
typedef struct curve {
    int points;
    double q, error, exponent;
} curve;

static double next_step(curve *c, double q, double error, double target)
{
    const double reach = 4, least = 0.3, most = 3;
    error = fmax(error, 1e-9), target = fmax(target, 1e-9);
    if (c->points++ > 0 && fabs(log(q / c->q)) > 1e-4)
        c->exponent = fmin(fmax(log(error / c->error) / log(q / c->q), least), most);
    c->q = q, c->error = error;
    return q * fmin(fmax(pow(target / error, 1 / c->exponent), 1 / reach), reach);
}

static bool meets(const search *s, double error)
{
    return error <= s->target && error >= LEAST * LEAST * s->target;
}

/* Codes the finest level, with the step that brings the whole to the target given what coarser levels left, as long as
 * that step is near the others'. *error_ret: what was reached. */
static tc_status code_finest(search *s, double coarse_error, double *error_ret, tc_error *error)
{
    enum { MOST_CODINGS = 3 };
    const double near = 2.5;
    tc_packer *p = s->p;
    int l = p->container.levels;
    const tc_level *level = &p->container.level[l - 1];
    sample *tiles = calloc(1, sizeof *tiles);
    if (!tiles)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    double samples = (double)level->width * (double)level->height, tile_samples = 4. * TC_TILE * TC_TILE;
    int wanted = (int)fmin(fmax(samples / tile_samples / 16, TC_TRAINING_TILES), SAMPLE_TILES);
    tc_status status = sample_tiles(p, l, &s->coarse, wanted, tiles, error);
    double own = fmax(AIM * AIM * s->target - coarse_error, 0.01 * s->target), q = s->q;
    if (!status)
        status = choose_model(s, tiles, l, q, error);
    curve guess = {.exponent = 1.6};
    for (int round = 0; round < 2 && !status; round++) {
        double found = 0;
        if (!(status = estimate(s, tiles, q, &found, error)))
            q = fmin(fmax(next_step(&guess, q, found, own), s->q / near), s->q * near);
    }
    int64_t body = p->body_size;
    for (int codings = 0; !status; codings++) {
        p->body_size = body;
        if ((status = choose_model(s, tiles, l, q, error)) ||
            (status = code_level(s, l, 0.75 * TC_SHARE_LEVELS, error)))
            break;
        *error_ret = mean_error(s);
        double next = next_step(&guess, q, *error_ret - coarse_error, own);
        bool off = next < s->q / near || next > s->q * near;
        if (meets(s, *error_ret) || off || codings == MOST_CODINGS)
            break;
        q = next;
    }
    sample_free(tiles);
    free(tiles);
    return status;
}

/* Codes all levels with step s->q, but the finest with one that is better if it can be. *error_ret: what was reached.
 */
static tc_status code_all(search *s, double *error_ret, tc_error *error)
{
    tc_packer *p = s->p;
    tc_container *c = &p->container;
    const tc_level *base = &c->level[c->base - 1];
    tc_status status = tc_spool_create(p->path, base->width, base->height, sizeof(int32_t), &s->coarse, error);
    if (!status)
        status = tc_spool_write(&s->coarse, (tc_rect){0, 0, base->width, base->height}, c->base_z, base->width, error);
    p->body_size = 0;
    s->has_model = false;
    double coarse_error = 0;
    for (int l = c->base + 1; l < c->levels && !status; l++) {
        sample *tiles = calloc(1, sizeof *tiles);
        if (!tiles)
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
        const tc_level *level = &c->level[l - 1];
        status = tc_spool_create(p->path, level->width, level->height, sizeof(int32_t), &s->fine, error);
        if (!status)
            status = sample_tiles(p, l, &s->coarse, TC_TRAINING_TILES, tiles, error);
        if (!status && !(status = choose_model(s, tiles, l, s->q, error)))
            status = code_level(s, l, 0.75 * TC_SHARE_LEVELS * pow(0.25, c->levels - l), error);
        sample_free(tiles);
        free(tiles);
        tc_spool_close(&s->coarse);
        s->coarse = s->fine, s->fine = TC_SPOOL_NONE;
        coarse_error = mean_error(s);
    }
    return status ? status : code_finest(s, coarse_error, error_ret, error);
}

tc_status tc_pack_to_rms(tc_packer *p, tc_error *error)
{
    search s = {.p = p, .coarse = TC_SPOOL_NONE, .fine = TC_SPOOL_NONE};
    double target = p->options.error / p->container.z_unit;
    s.target = target * target;
    s.q = solve(p, AIM * AIM * s.target);
    s.codec = malloc(sizeof *s.codec);
    tc_status status = s.codec ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    curve whole = {.exponent = 1.2};
    for (int tries = 0; tries < MOST_TRIES && !status; tries++) {
        double found = 0;
        status = code_all(&s, &found, error);
        tc_spool_close(&s.coarse), tc_spool_close(&s.fine);
        if (status || meets(&s, found))
            break;
        double next = fmin(next_step(&whole, s.q, found, AIM * AIM * s.target), LARGEST_STEP);
        if (found <= s.target && next <= s.q * 1.001) /* all that can be dropped is */
            break;
        s.q = next;
    }
    free(s.codec);
    p->result.rms = p->container.record[p->container.levels - 1].rms;
    p->result.max_error = p->container.record[p->container.levels - 1].max_error;
    return status;
}
