/* pack_rate.c - which quantiser step gives the error asked for.
 *
 * The transform is nearly orthogonal, so the square error of the finest level is about the sum of the bands' square
 * errors by their norms. The cascade has counted the details of every level; a model of what a quantiser does to them
 * gives a first step. Coarse levels are coded with it. For the finest level the model is corrected by the ratio of what
 * coding a sample of tiles gives to what the model says of the same tiles, and once the level is coded by what came of
 * it. Seldom is a level coded twice.
 *
 * With a bound, what is too far off is corrected as the finest level is coded, so that its step may be wider by what
 * corrections take off the error (pack_outliers.c). */
#include <math.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

static const double AIM = 0.986, LEAST = 0.97; /* of the target */
enum { MOST_TRIES = 12 };
static const double LARGEST_STEP = 64.0 * TC_MAX_STEP, SMALLER = 0.7;

/* The widest step beside a bound, by it: on smooth terrain, where most details vanish, wider ones leave more to correct
 * than they spare. */
static const double WIDEST_BY_BOUND = 5;

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
            sum += (double)h->count[i] * quantiser_error(tc_detail_bin(i), step);
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

/* Steps tried for one thing, and the error they led to: within which two the target lies, and where by the power law
 * through the last two points, or through one with a likely exponent. */
typedef struct curve {
    double low, high; /* steps whose error was within the target, and beyond it */
    int points;
    double q, error, exponent;
} curve;

#define CURVE(likely) ((curve){0, INFINITY, 0, 0, 0, likely})

/* The step to try after step q gave `error`, when `aim` is wanted and `most` allowed; sure: it is no estimate. */
static double next_step(curve *c, double q, double error, double aim, double most, bool sure)
{
    const double reach = 4, least_exponent = 0.3, most_exponent = 3, inside = 0.1;
    error = fmax(error, 1e-12), aim = fmax(aim, 1e-12);
    if (sure && error <= most)
        c->low = fmax(c->low, q);
    else if (sure)
        c->high = fmin(c->high, q);
    if (c->points++ > 0 && fabs(log(q / c->q)) > 1e-4)
        c->exponent = fmin(fmax(log(error / c->error) / log(q / c->q), least_exponent), most_exponent);
    c->q = q, c->error = error;
    double next = q * fmin(fmax(pow(aim / error, 1 / c->exponent), 1 / reach), reach);
    /* Well inside what is left; a little off the one side that is known. */
    bool between = c->low > 0 && c->high < INFINITY;
    double margin = between ? exp(inside * log(c->high / c->low)) : 1.003;
    return fmin(fmax(next, c->low * margin), c->high / margin);
}

/* Nothing is left to try between steps so near. */
static bool narrow(const curve *c)
{
    return c->high < 1.01 * c->low;
}

typedef struct search {
    tc_coding coding;
    int32_t bound, lattice;         /* as for tc_pack_to_bound(); 0: no bound */
    double largest;                 /* step: the widest that is tried */
    double target;                  /* squared error in squared height units */
    double q, fine;                 /* steps of the levels below the finest, and of the finest */
    double best_q, best_fine, best; /* the largest error within the target so far, and its steps; -1: none */
    double last_q, last_fine;       /* what the packer holds */
} search;

/* The price of each tile of a sample, found by all threads. */
typedef struct pricing {
    const tc_sample *sample;
    const tc_detail_model *model;
    double seen[TC_SAMPLE_TILES], modelled[TC_SAMPLE_TILES]; /* square errors, by the bands' norms */
    tc_status status[TC_SAMPLE_TILES];
} pricing;

static void price_tile(void *context, int64_t n)
{
    pricing *p = context;
    const tc_training_tile *tile = &p->sample->tile[n];
    double bits[TC_BANDS], errors[TC_BANDS];
    p->status[n] = tc_codec_price(&p->sample->level, tile, 1, 0, p->model, bits, errors);
    p->seen[n] = p->modelled[n] = 0;
    for (int b = 0; b < TC_BANDS && !p->status[n]; b++) {
        tc_detail_histogram h = {0};
        tc_pack_count(&tile->band[b], &h);
        double norm = tc_lifting_norm(b, 0);
        p->seen[n] += norm * norm * errors[b];
        p->modelled[n] += norm * norm * histogram_error(&h, p->model->step[b]);
    }
}

/* Square error that coding the finest level leaves in each of its samples, by the last model with its steps scaled to
 * q: that of the sample of tiles, corrected by what the quantiser's model says of all details and of those of the
 * sample. */
static tc_status estimate(const search *s, const tc_sample *sample, double q, double *error_ret, tc_error *error)
{
    const tc_packer *p = s->coding.p;
    int l = p->container.levels;
    tc_detail_model model = s->coding.model;
    tc_coding_steps(p, l, q, model.step);
    pricing all = {.sample = sample, .model = &model};
    tc_parallel_for(p->options.threads, sample->count, price_tile, &all);
    double seen = 0, modelled = 0;
    for (int n = 0; n < sample->count; n++) {
        if (all.status[n])
            return tc_fail(error, all.status[n], "%s: level %d cannot be coded: %s", p->path, l,
                           tc_status_text(all.status[n]));
        seen += all.seen[n], modelled += all.modelled[n];
    }
    *error_ret = level_error(p, l, q) * (modelled > 0 ? seen / modelled : 1);
    return TC_OK;
}

/* Near the target, or as near as the widest step beside a bound comes. */
static bool meets(const search *s, double error)
{
    bool all = s->bound > 0 && s->fine >= s->largest;
    return error <= s->target && (all || error >= LEAST * LEAST * s->target);
}

/* Codes the finest level with step s->fine; *error_ret: what all levels come to. */
static tc_status code_finest(search *s, const tc_sample *sample, int64_t body, double *error_ret, tc_error *error)
{
    tc_packer *p = s->coding.p;
    int l = p->container.levels;
    p->body_size = body;
    tc_status status = tc_coding_choose(&s->coding, l, s->fine, sample, error);
    if (s->bound > 0)
        tc_coding_correct(&s->coding, l, s->bound, s->lattice);
    if (!status)
        status = tc_coding_level(&s->coding, l, s->bound, false, 0.75 * TC_SHARE_LEVELS, error);
    if (status)
        return status;
    *error_ret = tc_coding_error(&s->coding);
    s->last_q = s->q, s->last_fine = s->fine;
    if (*error_ret <= s->target && *error_ret > s->best)
        s->best = *error_ret, s->best_q = s->q, s->best_fine = s->fine;
    return TC_OK;
}

static tc_status sample_finest(const search *s, tc_sample **sample_ret, tc_error *error)
{
    enum { SHARE = 16 };
    const tc_packer *p = s->coding.p;
    tc_pages pages = tc_level_pages(&p->container.level[p->container.levels - 1]);
    int64_t wanted = pages.tiles_x * pages.tiles_y / SHARE;
    return tc_pack_sample(p, p->container.levels, &s->coding.coarse,
                          (int)tc_clamp64(wanted, TC_TRAINING_TILES, TC_SAMPLE_TILES), sample_ret, error);
}

/* What coding the finest level with step s->q is likely to leave in each of its samples, and the share of all that is
 * left in them that corrections leave. */
static tc_status foresee_finest(search *s, const tc_sample *sample, double *own_ret, double *left_ret, tc_error *error)
{
    int l = s->coding.p->container.levels;
    *left_ret = 1;
    tc_status status = tc_coding_choose(&s->coding, l, s->q, sample, error);
    if (!status)
        status = estimate(s, sample, s->q, own_ret, error);
    if (!status && s->bound > 0)
        status = tc_pack_left_by_corrections(&s->coding, l, sample, s->bound, s->lattice, left_ret, error);
    return status;
}

/* Codes the finest level with steps near s->q that may bring the whole to the target, given what coarser levels leave
 * in its samples. Sets *error_ret to what all levels come to; where a step near s->q is foreseen not to reach the
 * target, and `foresee` allows it, the level is not coded, and *coded_ret false. */
static tc_status tune_finest(search *s, double carried, bool foresee, double *error_ret, bool *coded_ret,
                             tc_error *error)
{
    enum { MOST_CODINGS = 4 };
    const double near = 1.25, far = 1.08;
    double aim = AIM * AIM * s->target, own = fmax(aim - carried, 0.01 * aim),
           own_most = fmax(s->target - carried, own);
    double foreseen = 0, left = 1;
    tc_sample *sample = NULL;
    tc_status status = sample_finest(s, &sample, error);
    if (!status)
        status = foresee_finest(s, sample, &foreseen, &left, error);
    *error_ret = left * (carried + foreseen);
    bool code = *coded_ret = !foresee || fabs(log(*error_ret / aim)) < 2 * log(far);
    curve guess = CURVE(1.6), seen = CURVE(1.8);
    double uncorrected = fmax(aim / left - carried, 0.01 * aim);
    s->fine = next_step(&guess, s->q, foreseen, uncorrected, own_most, false);
    s->fine = fmin(fmin(fmax(s->fine, s->q / near), s->q * near), s->largest);
    int64_t body = s->coding.p->body_size;
    if (!status && code && s->coding.p->options.price_lossless && s->coding.p->result.lossless_bytes == 0)
        tc_pack_price_lossless(s->coding.p, sample);
    for (int codings = 0; !status && code && codings < MOST_CODINGS; codings++) {
        if ((status = code_finest(s, sample, body, error_ret, error)) || meets(s, *error_ret))
            break;
        /* Corrections take off what coarser levels left as well: then only the whole tells. */
        double next = left < 1 ? next_step(&seen, s->fine, *error_ret, aim, s->target, true)
                               : next_step(&seen, s->fine, *error_ret - carried, own, own_most, true);
        if (next < s->q / (near * near) || next > s->q * near * near || narrow(&seen))
            break;
        s->fine = fmin(next, s->largest);
    }
    tc_sample_free(sample);
    return status;
}

static double squared_target(const tc_packer *p)
{
    double target = p->options.error / p->container.z_unit;
    return target * target;
}

static tc_status code_below(search *s, tc_packer *p, tc_error *error)
{
    tc_status status = tc_coding_begin(p, &s->coding, error);
    return status ? status : tc_coding_below(&s->coding, p->container.levels - 1, s->q, error);
}

/* Codes everything with these two steps. */
static tc_status code_with(search *s, tc_packer *p, double q, double fine, tc_error *error)
{
    double found = 0;
    tc_sample *sample = NULL;
    s->q = q, s->fine = fine;
    tc_status status = code_below(s, p, error);
    if (!status)
        status = sample_finest(s, &sample, error);
    if (!status)
        status = code_finest(s, sample, p->body_size, &found, error);
    tc_sample_free(sample);
    tc_coding_end(&s->coding);
    return status;
}

static tc_status too_fine(const tc_packer *p, tc_error *error)
{
    return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: an rms of %g m is too small for heights %g m apart", p->path,
                   p->options.error, (double)p->z_max - p->z_min);
}

tc_status tc_pack_to_rms(tc_packer *p, int32_t bound, int32_t lattice, tc_error *error)
{
    enum { FORESEEN_TRIES = 5 };
    search s = {.bound = bound, .lattice = lattice, .target = squared_target(p), .best = -1};
    double aim = AIM * AIM * s.target;
    curve whole = CURVE(1.2);
    tc_status status = TC_OK;
    s.largest = bound > 0 ? fmin(WIDEST_BY_BOUND * bound, LARGEST_STEP) : LARGEST_STEP;
    s.q = fmin(solve(p, aim), s.largest);
    for (int tries = 0; !status && tries < MOST_TRIES; tries++) {
        double found = 0;
        bool coded = false, foresee = tries < FORESEEN_TRIES && s.q < s.largest;
        status = code_below(&s, p, error);
        if (!status)
            status = tune_finest(&s, s.coding.carried, foresee, &found, &coded, error);
        tc_coding_end(&s.coding);
        if (status || (coded && meets(&s, found)))
            break;
        if (s.best >= 0 && (s.q >= s.largest || narrow(&whole))) /* as good as it gets */
            break;
        s.q = fmin(next_step(&whole, s.q, found, aim, s.target, coded), s.largest);
        if (s.q < 0.1)
            break;
    }
    /* An error that goes in leaps: well below the target rather than above. */
    for (double q = s.q * SMALLER; !status && s.best < 0 && q > 0.1; q *= SMALLER)
        status = code_with(&s, p, q, q, error);
    if (!status && s.best < 0)
        status = too_fine(p, error);
    if (!status && (s.last_q != s.best_q || s.last_fine != s.best_fine))
        status = code_with(&s, p, s.best_q, s.best_fine, error);
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
    search s = {.target = squared_target(p), .best = -1};
    double aim = AIM * AIM * s.target;
    curve whole = CURVE(1.5);
    s.q = 3 * sqrt(s.target);
    tc_status status = TC_OK;
    double found = 0;
    for (int tries = 0; tries < MOST_TRIES && !status; tries++) {
        status = code_lh04(p, s.q, &found, error);
        s.last_q = s.q;
        if (!status && found <= s.target && found > s.best)
            s.best = found, s.best_q = s.q;
        if (status || meets(&s, found) || (s.best >= 0 && (s.q >= TC_MAX_STEP || narrow(&whole))) || s.q < 1)
            break;
        s.q = fmin(next_step(&whole, s.q, found, aim, s.target, true), TC_MAX_STEP);
    }
    for (double q = s.q * SMALLER; !status && s.best < 0 && q >= 0.5; q *= SMALLER)
        if (!(status = code_lh04(p, s.last_q = q, &found, error)) && found <= s.target)
            s.best = found, s.best_q = q;
    if (!status && s.best < 0)
        status = too_fine(p, error);
    if (!status && s.last_q != s.best_q)
        status = code_lh04(p, s.best_q, &s.best, error);
    return status;
}
