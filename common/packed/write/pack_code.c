/* pack_code.c - levels coded one after the other, each against what the one before came to. */
#include <math.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "pack_internal.h"

tc_status tc_coding_begin(tc_packer *p, tc_coding *coding, tc_error *error)
{
    tc_container *c = &p->container;
    const tc_level *base = &c->level[c->base - 1];
    *coding = (tc_coding){.p = p, .coarse = TC_SPOOL_NONE};
    p->body_size = 0;
    tc_status status = tc_spool_create(p->path, base->width, base->height, sizeof(int32_t), &coding->coarse, error);
    return status ? status
                  : tc_spool_write(&coding->coarse, (tc_rect){0, 0, base->width, base->height}, c->base_z, base->width,
                                   error);
}

void tc_coding_end(tc_coding *coding)
{
    tc_spool_close(&coding->coarse);
}

void tc_coding_steps(const tc_packer *p, int l, double q, int32_t step[TC_BANDS])
{
    for (int b = 0; b < TC_BANDS; b++)
        step[b] = (int32_t)fmin(fmax(1, rint(q / tc_lifting_norm(b, p->container.levels - l))), TC_MAX_STEP);
}

tc_status tc_coding_choose(tc_coding *coding, int l, double q, const tc_sample *sample, tc_error *error)
{
    tc_packer *p = coding->p;
    tc_level_record *record = &p->container.record[l - 1];
    int32_t step[TC_BANDS];
    tc_coding_steps(p, l, q, step);
    free(record->model);
    record->coder = TC_CODER_LIFTING;
    record->model = malloc(tc_detail_model_bound());
    tc_detail_model model;
    tc_status status = TC_ERR_MEMORY;
    if (record->model)
        status = tc_codec_choose(&sample->level, sample->tile, (int)tc_min64(sample->count, TC_TRAINING_TILES), 0, step,
                                 coding->has_model ? &coding->model : NULL, p->options.threads, record->model,
                                 &record->model_size, &model);
    if (status)
        return tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    coding->model = model, coding->has_model = true;
    return TC_OK;
}

void tc_coding_correct(tc_coding *coding, int l, int32_t bound, int32_t lattice)
{
    tc_level_record *record = &coding->p->container.record[l - 1];
    record->coder = TC_CODER_SPARSE;
    record->correction_snap = lattice, record->correction_step = 2 * bound + lattice;
}

tc_status tc_coding_level(tc_coding *coding, int l, int32_t bound, bool keep, double share, tc_error *error)
{
    tc_packer *p = coding->p;
    const tc_level *size = &p->container.level[l - 1];
    tc_spool fine = TC_SPOOL_NONE;
    tc_level_coder coder = {0};
    tc_lifting_level level = tc_container_lifting(&p->container, l);
    tc_status status =
        keep ? tc_spool_create(p->path, size->width, size->height, sizeof(int32_t), &fine, error) : TC_OK;
    if (!status && (status = tc_level_coder_init(&coder, &level, &p->container.record[l - 1])))
        tc_fail(error, status, "%s: level %d cannot be coded: %s", p->path, l, tc_status_text(status));
    tc_level_coding how = {l, &coder, 0, bound, &coding->coarse, keep ? &fine : NULL, share};
    if (!status)
        status = tc_pack_level(p, &how, &coding->outcome, error);
    tc_level_coder_free(&coder);
    if (keep && !status) {
        /* Of a level's own error, which is spread over high frequencies, upsampling keeps about two thirds, of what
         * came from coarser ones nearly all (the ratios of the bands' norms). */
        const double kept = 0.66;
        coding->carried = kept * tc_coding_error(coding) + (1 - kept) * coding->carried;
        tc_spool_close(&coding->coarse);
        coding->coarse = fine;
    } else {
        tc_spool_close(&fine);
    }
    return status;
}

tc_status tc_coding_below(tc_coding *coding, int last, double q, tc_error *error)
{
    tc_packer *p = coding->p;
    tc_status status = TC_OK;
    for (int l = p->container.base + 1; l <= last && !status; l++) {
        tc_sample *sample = NULL;
        status = tc_pack_sample(p, l, &coding->coarse, TC_TRAINING_TILES, &sample, error);
        if (!status && !(status = tc_coding_choose(coding, l, q, sample, error)))
            status =
                tc_coding_level(coding, l, 0, true, 0.75 * TC_SHARE_LEVELS * pow(0.25, p->container.levels - l), error);
        tc_sample_free(sample);
    }
    return status;
}

double tc_coding_error(const tc_coding *coding)
{
    double unit = coding->p->container.z_unit;
    const tc_level_outcome *o = &coding->outcome;
    return o->samples ? o->square_error / (double)o->samples / (unit * unit) : 0;
}
