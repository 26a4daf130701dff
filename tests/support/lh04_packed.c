/* lh04_packed.c - packing a terrain in memory as LH04 does it. */
#include "lh04_packed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"

enum { TRAINING_TILES = 24 };

tc_status lh04_read(const packed_level *l, const tc_plane *fine, tc_simd simd)
{
    const tc_lh04_codec *c = l->lh04;
    tc_rect r = fine->rect, need = tc_lh04_needs(&c->level, r);
    tc_plane coarse = tc_rect_within(need, l->coarse.rect) ? l->coarse : packed_wrapped(&l->coarse, need);
    tc_lh04_work *work = packed_memory(tc_lh04_work_bytes());
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

static void pack_level(packed_level *l, tc_lifting_level level, const tc_plane *coarse, const tc_plane *truth, int n,
                       const lh04_options *o)
{
    tc_lh04_codec *c = l->lh04 = packed_memory(sizeof *c);
    tc_lh04_model model;
    int64_t tiles_x = (level.width + TC_LH04_SPAN - 1) / TC_LH04_SPAN,
            all = tiles_x * ((level.height + TC_LH04_SPAN - 1) / TC_LH04_SPAN),
            count = tc_min64(all, o->training_tiles ? o->training_tiles : TRAINING_TILES);
    tc_plane source =
        level.wrap_x
            ? packed_wrapped(coarse, (tc_rect){-TC_TILE_MARGIN, 0, coarse->rect.x1 + TC_TILE_MARGIN, coarse->rect.y1})
            : *coarse;
    tc_lh04_sample *sample = packed_memory((size_t)count * sizeof *sample);
    for (int64_t k = 0; k < count; k++) {
        int64_t t = count == all ? k : (int64_t)fmod(((double)k + 0.5) * 0.6180339887498949 * (double)all, (double)all);
        sample[k] = (tc_lh04_sample){t % tiles_x, t / tiles_x, source, *truth};
    }
    double step = o->q * pow(o->finer > 0 ? o->finer : 1, n);
    tc_status status =
        tc_lh04_train(&level, sample, count, o->lambda, (int32_t)fmin(fmax(1, rint(step)), TC_MAX_STEP), &model);
    free(sample);
    l->header = packed_memory(tc_lh04_model_bound());
    l->header_size = status ? 0 : tc_lh04_model_write(&model, l->header);
    if (status || tc_lh04_model_read(l->header, l->header_size, &model))
        puts("lh04: no model"), exit(99);
    tc_lh04_init(c, &level, &model);
    packed_make_tiles(l, all);
    tc_lh04_work *work = packed_memory(tc_lh04_work_bytes());
    uint8_t *bytes = packed_memory(tc_lh04_tile_bound());
    for (int64_t t = 0; t < all; t++) {
        tc_lh04_options options = {.lambda = o->lambda};
        size_t size;
        if (tc_lh04_encode_tile(c, t % tiles_x, t / tiles_x, &source, truth, &options, bytes, &size, work))
            puts("lh04: a tile cannot be encoded"), exit(99);
        packed_keep_tile(l, t, bytes, size);
    }
    free(bytes), free(work);
    if (source.z != coarse->z)
        free(source.z);
}

packed lh04_new(const int32_t *z, int64_t width, int64_t height, const lh04_options *o)
{
    packed p = {0};
    tc_lifting_level level[PACKED_LEVELS];
    tc_plane low[PACKED_LEVELS + 1], band[PACKED_LEVELS][TC_BANDS];
    p.levels = packed_analyse(z, width, height, o->wrap_x, level, low, band);
    tc_plane coarse = low[p.levels];
    p.coarsest_bytes = 4 * (size_t)tc_rect_area(coarse.rect);
    for (int n = p.levels - 1; n >= 0; n--) {
        packed_level *l = &p.level[n];
        l->coarse = coarse;
        pack_level(l, level[n], &coarse, &low[n], n, o);
        l->fine = packed_plane(low[n].rect);
        if (lh04_read(l, &l->fine, TC_SIMD_AUTO))
            puts("lh04: cannot be read"), exit(99);
        coarse = l->fine;
        for (int b = 0; b < TC_BANDS; b++)
            free(band[n][b].z); /* the residuals are of the heights themselves */
        free(low[n].z);
    }
    if (p.levels == 0)
        free(low[0].z);
    return p;
}
