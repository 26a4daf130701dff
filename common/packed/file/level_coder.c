/* level_coder.c - one switch over the coders. */
#include "level_coder.h"

#include <stddef.h>

#include "common/base/rect.h"

size_t tc_decoded_tile_bytes(tc_coder coder)
{
    return tc_coder_corrects(coder) ? sizeof(tc_decoded_tile) : offsetof(tc_decoded_tile, correction);
}

static tc_status init_lifting(tc_level_coder *c, const tc_level_record *record)
{
    tc_detail_model model;
    tc_detail_parts parts;
    if (tc_detail_model_read(record->model, record->model_size, &model, &parts))
        return TC_ERR_FORMAT;
    if (!(c->codec = malloc(sizeof *c->codec)))
        return TC_ERR_MEMORY;
    tc_codec_init(c->codec, &c->level, &model);
    if (record->coder == TC_CODER_LIFTING)
        return TC_OK;
    if (record->correction_step < 1 || record->correction_snap < 1)
        return TC_ERR_FORMAT;
    if (!(c->correction = malloc(sizeof *c->correction)))
        return TC_ERR_MEMORY;
    tc_correction_init(c->correction, record->coder == TC_CODER_SPARSE);
    return TC_OK;
}

static tc_status init_exact(tc_level_coder *c, const tc_level_record *record)
{
    tc_exact_model *model = malloc(sizeof *model);
    c->exact = malloc(sizeof *c->exact);
    tc_status status =
        model && c->exact ? tc_exact_model_read(record->model, record->model_size, model) : TC_ERR_MEMORY;
    if (!status)
        tc_exact_init(c->exact, &c->level, model);
    free(model);
    return status;
}

static tc_status init_lh04(tc_level_coder *c, const tc_level_record *record)
{
    tc_lh04_model model;
    if (tc_lh04_model_read(record->model, record->model_size, &model))
        return TC_ERR_FORMAT;
    if (!(c->lh04 = malloc(sizeof *c->lh04)))
        return TC_ERR_MEMORY;
    tc_lh04_init(c->lh04, &c->level, &model);
    return TC_OK;
}

tc_status tc_level_coder_init(tc_level_coder *c, const tc_lifting_level *level, const tc_level_record *record)
{
    *c = (tc_level_coder){.coder = record->coder,
                          .level = *level,
                          .correction_step = record->correction_step,
                          .correction_snap = record->correction_snap};
    switch (record->coder) {
    case TC_CODER_EXACT: return init_exact(c, record);
    case TC_CODER_LH04: return init_lh04(c, record);
    default: return init_lifting(c, record);
    }
}

void tc_level_coder_free(tc_level_coder *c)
{
    free(c->codec), free(c->correction), free(c->exact), free(c->lh04);
    *c = (tc_level_coder){0};
}

size_t tc_level_coder_bytes(const tc_level_coder *c)
{
    return (c->codec ? sizeof *c->codec : 0) + (c->correction ? sizeof *c->correction : 0) +
           (c->exact ? sizeof *c->exact : 0) + (c->lh04 ? sizeof *c->lh04 : 0);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

size_t tc_level_coder_work_bytes(void)
{
    return larger(tc_tile_work_bytes(), larger(tc_exact_work_bytes(), tc_lh04_work_bytes()));
}

size_t tc_level_coder_bound(void)
{
    return larger(tc_codec_tile_bound(), larger(tc_exact_tile_bound(), tc_lh04_tile_bound())) + tc_correction_bound() +
           TC_MASK_BOUND;
}

tc_rect tc_level_coder_samples(const tc_level_coder *c, int64_t tx, int64_t ty)
{
    return tc_mask_tile_rect(&c->level, tx, ty, 0);
}

tc_rect tc_level_coder_positions(const tc_level_coder *c, int64_t tx, int64_t ty)
{
    tc_rect r = tc_level_coder_samples(c, tx, ty);
    return (tc_rect){r.x0 / 2, r.y0 / 2, (r.x1 + 1) / 2, (r.y1 + 1) / 2};
}

tc_rect tc_level_coder_needs(const tc_level_coder *c, int64_t tx, int64_t ty)
{
    switch (c->coder) {
    case TC_CODER_EXACT: return tc_exact_tile_needs(c->exact, tx, ty);
    case TC_CODER_LH04: return (tc_rect){0, 0, 0, 0};
    default: return tc_codec_tile_needs(c->codec, tc_level_coder_positions(c, tx, ty));
    }
}

static void decode_lifting(const tc_level_coder *c, tc_level_tile *tile, int count, const tc_plane *coarse)
{
    tc_plane band[TC_TOGETHER][TC_BANDS];
    tc_tile_job job[TC_TOGETHER];
    for (int n = 0; n < count; n++) {
        tc_level_tile *t = &tile[n];
        tc_rect rect = tc_level_coder_positions(c, t->tx, t->ty);
        for (int b = 0; b < TC_BANDS; b++)
            band[n][b] = t->band ? t->band[b] : (tc_plane){t->to->band[b][0], TC_TILE, rect};
        job[n] = (tc_tile_job){t->tx, t->ty, 0, t->bytes, t->entry.size[TC_STREAM_HEIGHTS], band[n], t->work, TC_OK};
    }
    tc_codec_decode_tiles(c->codec, job, count, coarse, TC_SIMD_AUTO);
    for (int n = 0; n < count; n++) {
        tc_level_tile *t = &tile[n];
        t->status = job[n].status;
        if (c->coder == TC_CODER_LIFTING)
            continue;
        tc_plane k = {t->to->correction[0], TC_TILE_SIDE, tc_level_coder_samples(c, t->tx, t->ty)};
        tc_status corrected = tc_correction_decode(c->correction, band[n], c->codec->model.step,
                                                   t->bytes + t->entry.size[TC_STREAM_HEIGHTS],
                                                   t->status ? 0 : t->entry.size[TC_STREAM_CORRECTIONS], &k);
        t->status = t->status ? t->status : corrected;
    }
}

/* Heights of the coarser level's upsampling, for an exact tile that is lost. */
static void upsample_tile(const tc_plane *coarse, const tc_plane *fine)
{
    /* At every other sample the coarser level's, between them their mean: no more is known. */
    for (int64_t y = fine->rect.y0; y < fine->rect.y1; y++)
        for (int64_t x = fine->rect.x0; x < fine->rect.x1; x++) {
            int64_t x1 = tc_min64((x + 1) / 2, coarse->rect.x1 - 1), y1 = tc_min64((y + 1) / 2, coarse->rect.y1 - 1);
            int64_t sum = (int64_t)*tc_plane_at(coarse, x / 2, y / 2) + *tc_plane_at(coarse, x1, y / 2) +
                          *tc_plane_at(coarse, x / 2, y1) + *tc_plane_at(coarse, x1, y1);
            *tc_plane_at(fine, x, y) = (int32_t)(sum / 4);
        }
}

/* A tile that adds nothing. */
static void clear_tile(const tc_level_coder *c, const tc_level_tile *t)
{
    if (t->to) {
        memset(t->to, 0, tc_decoded_tile_bytes(c->coder));
        return;
    }
    for (int b = 0; b < TC_BANDS; b++) {
        tc_rect r = tc_rect_intersect(tc_level_coder_positions(c, t->tx, t->ty), t->band[b].rect);
        for (int64_t y = r.y0; y < r.y1; y++)
            memset(tc_plane_at(&t->band[b], r.x0, y), 0, (size_t)(r.x1 - r.x0) * sizeof(int32_t));
    }
}

/* Of the lifting: nothing is known of a tile that is lost. */
static void decode_details(const tc_level_coder *c, tc_level_tile *t, const tc_plane *coarse)
{
    t->status = TC_ERR_FORMAT;
    if (t->bytes)
        decode_lifting(c, t, 1, coarse);
    if (t->status)
        clear_tile(c, t);
}

static void decode_tile(const tc_level_coder *c, tc_level_tile *t, const tc_plane *coarse)
{
    if (c->codec) {
        decode_details(c, t, coarse);
        return;
    }
    tc_plane samples = {t->to->sample[0], TC_TILE_SIDE, tc_level_coder_samples(c, t->tx, t->ty)};
    t->status = TC_ERR_FORMAT;
    if (!t->bytes) {
        /* As damaged. */
    } else if (c->coder == TC_CODER_EXACT) {
        t->status = tc_exact_decode_tile(c->exact, t->tx, t->ty, t->bytes, t->entry.size[TC_STREAM_HEIGHTS], coarse,
                                         &samples, t->work);
    } else if (c->coder == TC_CODER_LH04) {
        t->status = tc_lh04_decode_tile(c->lh04, t->tx, t->ty, 0, t->bytes, t->entry.size[TC_STREAM_HEIGHTS], &samples,
                                        t->work, TC_SIMD_AUTO);
    }
    if (t->status)
        clear_tile(c, t);
    if (t->status && c->coder == TC_CODER_EXACT)
        upsample_tile(coarse, &samples);
}

void tc_level_coder_decode(const tc_level_coder *c, tc_level_tile *tile, int count, const tc_plane *coarse)
{
    bool all = c->codec;
    for (int n = 0; n < count; n++)
        all &= tile[n].bytes != NULL;
    if (!all) {
        for (int n = 0; n < count; n++)
            decode_tile(c, &tile[n], coarse);
        return;
    }
    decode_lifting(c, tile, count, coarse);
    for (int n = 0; n < count; n++)
        if (tile[n].status)
            clear_tile(c, &tile[n]);
}

void tc_level_coder_correct(const tc_level_coder *c, int32_t *z, const int32_t *k, int64_t count)
{
    const uint32_t step = (uint32_t)c->correction_step;
    if (c->correction_snap == 1)
        for (int64_t i = 0; i < count; i++)
            z[i] = (int32_t)((uint32_t)z[i] + (uint32_t)k[i] * step);
    else
        for (int64_t i = 0; i < count; i++)
            z[i] = tc_corrected(c, z[i], k[i]);
}
