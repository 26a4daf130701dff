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

static const double AIM = 0.986, LEAST = 0.97; /* of the target */
enum { MOST_TRIES = 12 };
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

/* Square error that level l's details leave in each sample of the finest level, by the quantiser's model. */
static double level_error(const tc_packer *p, int l, double q)
{
    const tc_level *finest = &p->container.level[p->container.levels - 1];
    int32_t step[TC_BANDS];
    double sum = 0;
    tc_coding_steps(p, l, q, step);
    for (int b = 0; b < TC_BANDS; b++) {
        double norm = tc_lifting_norm(b, p->container.levels - l);
        sum += norm * norm * histogram_error(&p->histogram[l - 1][b], step[b]);
    }
    return sum / ((double)finest->width * (double)finest->height);
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

/* ---- Search ---------------------------------------------------------------------------------------------------- */

typedef struct search {
    tc_coding coding;
    double q;      /* step of the levels below the finest */
    double target; /* squared error in squared height units */
} search;

/* Square error that coding a sample of the finest level's tiles leaves in each sample of the level, by the model's
 * steps scaled to q. The sample is corrected by what the quantiser's model says of all details and of those of the
 * sample. */
static tc_status estimate(const search *s, const tc_sample *tiles, double q, double *error_ret, tc_error *error)
{
    const tc_packer *p = s->coding.p;
    int l = p->container.levels;
    tc_detail_model model = s->coding.model;
    double bits[TC_BANDS], errors[TC_BANDS], seen = 0, modelled = 0;
    tc_coding_steps(p, l, q, model.step);
    tc_status status = tc_codec_price(&tiles->level, tiles->tile, tiles->count, 0, &model, bits, errors);
    if (status)
        return tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    for (int b = 0; b < TC_BANDS; b++) {
        tc_detail_histogram h = {0};
        for (int i = 0; i < tiles->count; i++)
            tc_pack_count(&tiles->tile[i].band[b], &h);
        double norm = tc_lifting_norm(b, 0);
        seen += norm * norm * errors[b];
        modelled += norm * norm * histogram_error(&h, model.step[b]);
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

/* Codes the finest level with a step near s->q that brings the whole to the target, given what coarser levels leave in
 * its samples. Sets *error_ret to what all levels come to; where a step near s->q cannot reach the target, which is
 * foreseen if it is far away, *coded_ret is false. */
static tc_status code_finest(search *s, double carried, bool last_try, double *error_ret, bool *coded_ret,
                             tc_error *error)
{
    enum { MOST_CODINGS = 3, SHARE = 16 };
    const double near = 1.25, far = 1.08;
    tc_packer *p = s->coding.p;
    int l = p->container.levels;
    const tc_level *level = &p->container.level[l - 1];
    double tiles = (double)level->width * (double)level->height / (TC_TILE_SIDE * TC_TILE_SIDE);
    double aim = AIM * AIM * s->target, own = fmax(aim - carried, 0.01 * aim), q = s->q, foreseen = 0;
    tc_sample *sample = NULL;
    tc_status status = tc_pack_sample(
        p, l, &s->coding.coarse, (int)fmin(fmax(tiles / SHARE, TC_TRAINING_TILES), TC_SAMPLE_TILES), &sample, error);
    if (!status && !(status = tc_coding_choose(&s->coding, l, q, sample, error)))
        status = estimate(s, sample, q, &foreseen, error);
    *error_ret = carried + foreseen;
    *coded_ret = last_try || fabs(log(*error_ret / aim)) < 2 * log(far);
    if (!status && *coded_ret) {
        curve guess = {.exponent = 1.6};
        q = fmin(fmax(next_step(&guess, q, foreseen, own), s->q / near), s->q * near);
    }
    curve seen = {.exponent = 1.8};
    int64_t body = p->body_size;
    for (int codings = 0; !status && *coded_ret; codings++) {
        p->body_size = body;
        if ((status = tc_coding_choose(&s->coding, l, q, sample, error)) ||
            (status = tc_coding_level(&s->coding, l, 0, false, 0.75 * TC_SHARE_LEVELS, error)))
            break;
        *error_ret = tc_coding_error(&s->coding);
        double next = next_step(&seen, q, *error_ret - carried, own);
        if (meets(s, *error_ret) || next < s->q / (near * near) || next > s->q * near * near || codings == MOST_CODINGS)
            break;
        q = next;
    }
    tc_sample_free(sample);
    return status;
}

/* The error of a terrain of a few tiles goes in leaps, between which the search may end above the target. Then smaller
 * steps follow until it is not: q times the nth of these. */
enum { LAST_TRIES = 10 };
static double smaller_step(double q, int n)
{
    return q * pow(0.98, 1 << n);
}

static tc_status code_with(search *s, double q, double *error_ret, tc_error *error)
{
    tc_packer *p = s->coding.p;
    int m = p->container.levels;
    tc_sample *sample = NULL;
    tc_status status = tc_coding_begin(p, &s->coding, error);
    if (!status)
        status = tc_coding_below(&s->coding, m - 1, q, error);
    if (!status)
        status = tc_pack_sample(p, m, &s->coding.coarse, TC_TRAINING_TILES, &sample, error);
    if (!status && !(status = tc_coding_choose(&s->coding, m, q, sample, error)))
        status = tc_coding_level(&s->coding, m, 0, false, 0.75 * TC_SHARE_LEVELS, error);
    *error_ret = tc_coding_error(&s->coding);
    tc_sample_free(sample);
    tc_coding_end(&s->coding);
    return status;
}

static double squared_target(const tc_packer *p)
{
    double target = p->options.error / p->container.z_unit;
    return target * target;
}

tc_status tc_pack_to_rms(tc_packer *p, tc_error *error)
{
    search s = {.target = squared_target(p)};
    s.q = solve(p, AIM * AIM * s.target);
    curve whole = {.exponent = 1.2};
    tc_status status = TC_OK;
    double before = 0, found = 0;
    for (int tries = 0; tries < MOST_TRIES && !status; tries++) {
        bool coded = false, all_dropped = false;
        status = tc_coding_begin(p, &s.coding, error);
        if (!status)
            status = tc_coding_below(&s.coding, p->container.levels - 1, s.q, error);
        if (!status) {
            /* A larger step that changes nothing has nothing left to drop. */
            all_dropped = tries > 0 && s.coding.carried < s.target && s.q > LARGEST_STEP / 2;
            status = code_finest(&s, s.coding.carried, tries == MOST_TRIES - 1 || all_dropped, &found, &coded, error);
        }
        tc_coding_end(&s.coding);
        if (!status && coded && (meets(&s, found) || all_dropped || tries == MOST_TRIES - 1))
            break;
        double next = fmin(next_step(&whole, s.q, found, AIM * AIM * s.target), LARGEST_STEP);
        if (found < s.target && fabs(found - before) <= 1e-3 * found)
            next = LARGEST_STEP;
        before = found;
        s.q = next;
    }
    for (int n = 0; n < LAST_TRIES && !status && found > s.target; n++)
        status = code_with(&s, smaller_step(s.q, n), &found, error);
    return status;
}

/* ---- LH04 -------------------------------------------------------------------------------------------------------- */

static tc_status choose_lh04(tc_coding *coding, int l, double step, tc_error *error)
{
    tc_packer *p = coding->p;
    tc_level_record *record = &p->container.record[l - 1];
    tc_sample *sample = NULL;
    tc_lh04_sample *tiles = calloc(TC_SAMPLE_TILES, sizeof *tiles);
    tc_lh04_model model;
    free(record->model);
    record->coder = TC_CODER_LH04;
    record->model = malloc(tc_lh04_model_bound());
    tc_status status = tc_pack_sample(p, l, &coding->coarse, TC_SAMPLE_TILES, &sample, error);
    if (!status && (!tiles || !record->model))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status) {
        for (int i = 0; i < sample->count; i++)
            tiles[i] =
                (tc_lh04_sample){sample->tile[i].tx, sample->tile[i].ty, sample->tile[i].coarse, sample->fine[i]};
        status = tc_lh04_train(&sample->level, tiles, sample->count, 0, (int32_t)fmin(fmax(1, rint(step)), TC_MAX_STEP),
                               &model);
        if (status)
            tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
        else
            record->model_size = tc_lh04_model_write(&model, record->model);
    }
    tc_sample_free(sample);
    free(tiles);
    return status;
}

static tc_status code_lh04(tc_packer *p, double step, double *error_ret, tc_error *error)
{
    tc_container *c = &p->container;
    tc_coding coding;
    tc_status status = tc_coding_begin(p, &coding, error);
    for (int l = c->base + 1; l <= c->levels && !status; l++)
        if (!(status = choose_lh04(&coding, l, step, error)))
            status =
                tc_coding_level(&coding, l, 0, l < c->levels, 0.75 * TC_SHARE_LEVELS * pow(0.25, c->levels - l), error);
    *error_ret = tc_coding_error(&coding);
    tc_coding_end(&coding);
    return status;
}

tc_status tc_pack_lh04(tc_packer *p, tc_error *error)
{
    search s = {.target = squared_target(p)};
    curve whole = {.exponent = 1.5};
    double step = 3 * sqrt(s.target), found = 0;
    tc_status status = TC_OK;
    for (int tries = 0; tries < MOST_TRIES && !status; tries++) {
        status = code_lh04(p, step, &found, error);
        if (status || meets(&s, found))
            break;
        double next = fmin(next_step(&whole, step, found, AIM * AIM * s.target), TC_MAX_STEP);
        if (found <= s.target && next <= step * 1.001)
            break;
        step = next;
    }
    for (int n = 0; n < LAST_TRIES && !status && found > s.target; n++)
        status = code_lh04(p, smaller_step(step, n), &found, error);
    return status;
}
