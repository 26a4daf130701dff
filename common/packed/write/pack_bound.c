/* pack_bound.c - a bound on every height's error, or none at all.
 *
 * Two ways are there, and the smaller file is kept: the finest level as the exact coder gives it, in steps as wide as
 * the bound allows; or by the lifting, with corrections of what is too far off. The first is better where the bound is
 * tight, the second where it is loose or the terrain is smooth. Coarser levels are lossy in both. */
#include <math.h>
#include <unistd.h>

#include "common/base/outfile.h"
#include "common/base/status.h"
#include "pack_internal.h"

/* Steps that give about the least bytes in all (tests/bench/bench_exact.c): of the levels below an exact one, by its
 * step or, where that is more, by the mean magnitude of its details; of all levels, by the bound of corrections. */
static const double COARSE_BY_EXACT = 8, STEP_BY_BOUND = 2.8;

static double mean_detail(const tc_packer *p)
{
    double sum = 0, count = 0;
    for (int b = 0; b < TC_BANDS; b++)
        for (int i = 0; i < TC_DETAIL_BINS; i++) {
            double n = (double)p->histogram[p->container.levels - 1][b].count[i];
            sum += n * tc_detail_bin(i), count += n;
        }
    return sum / fmax(count, 1);
}

/* A finished way of coding. */
typedef struct attempt {
    int body;
    int64_t size;
    tc_level_record record[TC_MAX_FIELD_LEVELS];
} attempt;

/* Takes the packer's body and records away from it, which gets fresh ones. */
static tc_status set_aside(tc_packer *p, attempt *a, tc_error *error)
{
    int body = tc_outfile_nameless(p->path);
    if (body < 0)
        return tc_fail(error, TC_ERR_IO, "%s: no temporary file can be made beside it", p->path);
    a->body = p->body, a->size = p->body_size;
    memcpy(a->record, p->container.record, sizeof a->record);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        p->container.record[l].model = NULL, p->container.record[l].model_size = 0;
    p->body = body, p->body_size = 0;
    return TC_OK;
}

/* Puts it back in the place of what the packer has. */
static void put_back(tc_packer *p, attempt *a)
{
    attempt other = {.body = p->body, .size = p->body_size};
    memcpy(other.record, p->container.record, sizeof other.record);
    p->body = a->body, p->body_size = a->size;
    memcpy(p->container.record, a->record, sizeof a->record);
    *a = other;
}

static void drop(attempt *a)
{
    if (a->body >= 0)
        close(a->body);
    for (int l = 0; l < TC_MAX_FIELD_LEVELS; l++)
        free(a->record[l].model);
}

static tc_status choose_exact(tc_coding *coding, int l, int32_t step, tc_error *error)
{
    tc_packer *p = coding->p;
    tc_level_record *record = &p->container.record[l - 1];
    tc_sample *sample = NULL;
    tc_exact_tile *tiles = calloc(TC_SAMPLE_TILES, sizeof *tiles);
    tc_exact_model *model = malloc(sizeof *model);
    free(record->model);
    record->coder = TC_CODER_EXACT;
    record->model = malloc(tc_exact_model_bound());
    tc_status status = tc_pack_sample(p, l, &coding->coarse, TC_SAMPLE_TILES, &sample, error);
    if (!status && (!tiles || !model || !record->model))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", p->path);
    if (!status) {
        for (int i = 0; i < sample->count; i++)
            tiles[i] = (tc_exact_tile){sample->tile[i].tx, sample->tile[i].ty, sample->tile[i].coarse, sample->fine[i]};
        status = tc_exact_train(&sample->level, tiles, sample->count, step, p->options.threads, model);
        if (status)
            tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
        else
            record->model_size = tc_exact_model_write(model, record->model);
    }
    tc_sample_free(sample);
    free(tiles), free(model);
    return status;
}

/* A level of raw tiles alone is left a model that says its step and takes next to nothing. */
static tc_status forget_model(tc_level_record *record, int32_t step)
{
    tc_exact_model *plain = calloc(1, sizeof *plain);
    if (!plain)
        return TC_ERR_MEMORY;
    plain->step = step;
    record->model_size = tc_exact_model_write(plain, record->model);
    free(plain);
    return TC_OK;
}

static tc_status code_exact(tc_packer *p, int32_t step, double share, tc_error *error)
{
    tc_coding coding;
    int m = p->container.levels;
    tc_status status = tc_coding_begin(p, &coding, error);
    if (!status)
        status = tc_coding_below(&coding, m - 1, COARSE_BY_EXACT * fmax(step, mean_detail(p)), error);
    if (!status)
        status = choose_exact(&coding, m, step, error);
    if (!status)
        status = tc_coding_level(&coding, m, 0, false, share, error);
    if (!status && coding.outcome.modelled == 0 && (status = forget_model(&p->container.record[m - 1], step)))
        tc_fail(error, status, "%s: not enough memory", p->path);
    tc_coding_end(&coding);
    return status;
}

static tc_status code_corrected(tc_packer *p, int32_t bound, int32_t lattice, double share, tc_error *error)
{
    tc_coding coding;
    int m = p->container.levels;
    double q = STEP_BY_BOUND * bound;
    tc_sample *sample = NULL;
    tc_status status = tc_coding_begin(p, &coding, error);
    if (!status)
        status = tc_coding_below(&coding, m - 1, q, error);
    if (!status)
        status = tc_pack_sample(p, m, &coding.coarse, TC_TRAINING_TILES, &sample, error);
    if (!status)
        status = tc_coding_choose(&coding, m, q, sample, error);
    tc_coding_correct(&coding, m, bound, lattice);
    if (!status)
        status = tc_coding_level(&coding, m, bound, false, share, error);
    tc_sample_free(sample);
    tc_coding_end(&coding);
    return status;
}

tc_status tc_pack_to_bound(tc_packer *p, int32_t bound, int32_t lattice, tc_error *error)
{
    double share = 0.75 * TC_SHARE_LEVELS;
    /* Lossless, corrections pay only where there is nothing to correct, and a tile without details takes no bytes. */
    if (bound == 0 && mean_detail(p) > 0)
        return code_exact(p, lattice, share, error);
    tc_status status = code_corrected(p, bound, lattice, share / 2, error);
    attempt corrected = {.body = -1};
    if (!status)
        status = set_aside(p, &corrected, error);
    if (!status)
        status = code_exact(p, 2 * bound + lattice, share / 2, error);
    if (!status && corrected.size < p->body_size)
        put_back(p, &corrected);
    drop(&corrected);
    return status;
}
