/* lh04_packed.c - packing a terrain in memory as LH04 does it. */
#include "lh04_packed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/core/base/rect.h"
#include "packed.h"

enum { COARSEST = 16, TRAINING_TILES = 24 };

static void *get(size_t bytes)
{
    void *p = calloc(bytes + 1, 1);
    if (!p)
        puts("lh04: no memory"), exit(99);
    return p;
}

/* The columns that a level which wraps has beyond its sides. */
static tc_plane wrapped(const tc_plane *p, tc_rect rect)
{
    tc_plane w = packed_plane(rect);
    int64_t width = p->rect.x1 - p->rect.x0;
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++)
            *tc_plane_at(&w, x, y) = *tc_plane_at(p, ((x % width) + width) % width, y);
    return w;
}

tc_status lh04_read(const lh04_level *l, const tc_plane *fine, tc_simd simd)
{
    const tc_lh04_codec *c = l->codec;
    tc_rect r = fine->rect, need = tc_lh04_needs(&c->level, r);
    tc_plane coarse = tc_rect_within(need, l->coarse.rect) ? l->coarse : wrapped(&l->coarse, need);
    tc_lh04_work *work = get(tc_lh04_work_bytes());
    tc_status status = TC_OK;
    for (int64_t n = 0; n < c->tiles_x * c->tiles_y && !status; n++)
        for (int64_t shift = -2 * c->level.width; shift <= 2 * c->level.width && !status; shift += c->level.width) {
            tc_rect tile = tc_lh04_tile_rect(c, n % c->tiles_x, n / c->tiles_x, shift);
            if (!tc_rect_empty(tc_rect_intersect(tile, r)) && (shift == 0 || c->level.wrap_x))
                status = tc_lh04_decode_tile(c, n % c->tiles_x, n / c->tiles_x, shift, l->tile[n], l->tile_size[n],
                                             fine, work, simd);
        }
    tc_lh04_assemble(&c->level, &coarse, fine, fine);
    if (coarse.z != l->coarse.z)
        free(coarse.z);
    free(work);
    return status;
}

static void pack_level(lh04_level *l, const tc_plane *coarse, const tc_plane *truth, int n, const lh04_options *o)
{
    tc_lh04_codec *c = l->codec;
    tc_lifting_level level = c->level;
    tc_lh04_model model;
    int64_t tiles_x = (level.width + TC_LH04_SPAN - 1) / TC_LH04_SPAN,
            all = tiles_x * ((level.height + TC_LH04_SPAN - 1) / TC_LH04_SPAN),
            count = tc_min64(all, o->training_tiles ? o->training_tiles : TRAINING_TILES);
    tc_plane source =
        level.wrap_x ? wrapped(coarse, (tc_rect){-TC_TILE_MARGIN, 0, coarse->rect.x1 + TC_TILE_MARGIN, coarse->rect.y1})
                     : *coarse;
    tc_lh04_sample *sample = get((size_t)count * sizeof *sample);
    for (int64_t k = 0; k < count; k++) {
        int64_t t = count == all ? k : (int64_t)fmod(((double)k + 0.5) * 0.6180339887498949 * (double)all, (double)all);
        sample[k] = (tc_lh04_sample){t % tiles_x, t / tiles_x, source, *truth};
    }
    double step = o->q * pow(o->finer > 0 ? o->finer : 1, n);
    tc_status status =
        tc_lh04_train(&level, sample, count, o->lambda, (int32_t)fmin(fmax(1, rint(step)), TC_MAX_STEP), &model);
    free(sample);
    l->header = get(tc_lh04_model_bound());
    l->header_size = status ? 0 : tc_lh04_model_write(&model, l->header);
    if (status || tc_lh04_model_read(l->header, l->header_size, &model))
        puts("lh04: no model"), exit(99);
    tc_lh04_init(c, &level, &model);
    l->tile = get((size_t)all * sizeof *l->tile), l->tile_size = get((size_t)all * sizeof *l->tile_size);
    tc_lh04_work *work = get(tc_lh04_work_bytes());
    uint8_t *bytes = get(tc_lh04_tile_bound());
    for (int64_t t = 0; t < all; t++) {
        tc_lh04_options options = {.lambda = o->lambda};
        if (tc_lh04_encode_tile(c, t % tiles_x, t / tiles_x, &source, truth, &options, bytes, &l->tile_size[t], work))
            puts("lh04: a tile cannot be encoded"), exit(99);
        if (l->tile_size[t])
            l->tile[t] = get(l->tile_size[t]), memcpy(l->tile[t], bytes, l->tile_size[t]);
    }
    free(bytes), free(work);
    if (source.z != coarse->z)
        free(source.z);
}

lh04_packed lh04_new(const int32_t *z, int64_t width, int64_t height, const lh04_options *o)
{
    lh04_packed p = {0};
    tc_plane low[LH04_LEVELS + 1];
    low[0] = packed_plane((tc_rect){0, 0, width, height});
    memcpy(low[0].z, z, (size_t)(width * height) * sizeof *z);
    for (; tc_max64(low[p.levels].rect.x1, low[p.levels].rect.y1) > COARSEST; p.levels++) {
        int n = p.levels;
        tc_rect r = low[n].rect, c = {0, 0, tc_coarse_size(r.x1), tc_coarse_size(r.y1)};
        tc_lifting_level level = {r.x1, r.y1, o->wrap_x && r.x1 % 2 == 0};
        tc_plane band[TC_BANDS];
        low[n + 1] = packed_plane(c);
        for (int b = 0; b < TC_BANDS; b++)
            band[b] = packed_plane(c);
        int32_t *scratch = get(tc_lifting_analyse_scratch(&level, c.y1) * sizeof *scratch);
        tc_lifting_analyse(&level, &low[n], 0, c.y1, &low[n + 1], band, scratch);
        free(scratch);
        for (int b = 0; b < TC_BANDS; b++)
            free(band[b].z);
        p.level[n].codec = get(sizeof *p.level[n].codec);
        p.level[n].codec->level = level;
    }
    tc_plane coarse = low[p.levels];
    p.coarsest_bytes = 4 * (size_t)tc_rect_area(coarse.rect);
    for (int n = p.levels - 1; n >= 0; n--) {
        lh04_level *l = &p.level[n];
        l->coarse = coarse;
        pack_level(l, &coarse, &low[n], n, o);
        l->fine = packed_plane(low[n].rect);
        if (lh04_read(l, &l->fine, TC_SIMD_AUTO))
            puts("lh04: cannot be read"), exit(99);
        coarse = l->fine;
        free(low[n].z);
    }
    if (p.levels == 0)
        free(low[0].z);
    return p;
}

void lh04_free(lh04_packed *p)
{
    if (p->levels)
        free(p->level[p->levels - 1].coarse.z);
    for (int n = 0; n < p->levels; n++) {
        lh04_level *l = &p->level[n];
        for (int64_t i = 0; i < l->codec->tiles_x * l->codec->tiles_y; i++)
            free(l->tile[i]);
        free(l->tile), free(l->tile_size), free(l->header), free(l->fine.z), free(l->codec);
    }
    *p = (lh04_packed){0};
}

size_t lh04_bytes(const lh04_packed *p)
{
    size_t bytes = p->coarsest_bytes, empty = 0;
    for (int n = 0; n < p->levels; n++) {
        const lh04_level *l = &p->level[n];
        bytes += l->header_size;
        for (int64_t i = 0; i < l->codec->tiles_x * l->codec->tiles_y; i++)
            if (l->tile_size[i])
                bytes += l->tile_size[i] + 8;
            else
                empty++;
    }
    return bytes + (empty + 7) / 8;
}
