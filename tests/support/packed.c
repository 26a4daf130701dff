/* packed.c - packing a terrain in memory. */
#include "packed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "terrain_files.h"

enum { COARSEST = 16 };

void *packed_memory(size_t bytes)
{
    void *p = calloc(bytes + 1, 1);
    if (!p)
        puts("packed: no memory"), exit(99);
    return p;
}

tc_plane packed_plane(tc_rect rect)
{
    return (tc_plane){packed_memory((size_t)tc_rect_area(rect) * sizeof(int32_t)), rect.x1 - rect.x0, rect};
}

tc_plane packed_wrapped(const tc_plane *p, tc_rect rect)
{
    tc_plane w = packed_plane(rect);
    int64_t width = p->rect.x1 - p->rect.x0;
    for (int64_t y = rect.y0; y < rect.y1; y++)
        for (int64_t x = rect.x0; x < rect.x1; x++)
            *tc_plane_at(&w, x, y) = *tc_plane_at(p, ((x % width) + width) % width, y);
    return w;
}

void packed_make_tiles(packed_level *l, int64_t tiles)
{
    l->tiles = tiles;
    l->tile = packed_memory((size_t)tiles * sizeof *l->tile);
    l->tile_size = packed_memory((size_t)tiles * sizeof *l->tile_size);
}

void packed_keep_tile(packed_level *l, int64_t n, const uint8_t *bytes, size_t size)
{
    l->tile_size[n] = size;
    if (size)
        l->tile[n] = packed_memory(size), memcpy(l->tile[n], bytes, size);
}

typedef struct job {
    packed_level *l;
    const tc_plane *coarse, *band;
    double lambda;
    tc_simd simd;
} job;

/* A row of tiles. */
static void encode_row(void *context, int64_t ty)
{
    job *j = context;
    packed_level *l = j->l;
    tc_tile_work *work = packed_memory(tc_tile_work_bytes());
    uint8_t *bytes = packed_memory(tc_codec_tile_bound());
    tc_encode_options options = {.lambda = j->lambda, .simd = j->simd};
    for (int64_t tx = 0; tx < l->codec->tiles_x; tx++) {
        size_t size;
        if (tc_codec_encode_tile(l->codec, tx, ty, j->coarse, j->band, &options, bytes, &size, work))
            puts("packed: a tile cannot be encoded"), exit(99);
        packed_keep_tile(l, ty * l->codec->tiles_x + tx, bytes, size);
    }
    free(bytes), free(work);
}

tc_status packed_source(void *level, int64_t tx, int64_t ty, const uint8_t **bytes, size_t *size)
{
    const packed_level *l = level;
    *bytes = l->tile[ty * l->codec->tiles_x + tx], *size = l->tile_size[ty * l->codec->tiles_x + tx];
    return TC_OK;
}

tc_status packed_read(const packed_level *l, const tc_plane *fine, int64_t *damaged, tc_simd simd)
{
    tc_rect need = tc_codec_read_needs(l->codec, fine->rect);
    tc_plane coarse = l->coarse;
    if (!tc_rect_within(need, coarse.rect))
        coarse = packed_wrapped(&coarse, need);
    void *scratch = packed_memory(tc_codec_read_scratch(l->codec, fine->rect));
    tc_status status = tc_codec_read(l->codec, &coarse, packed_source, (void *)l, fine, scratch, damaged, simd);
    free(scratch);
    if (coarse.z != l->coarse.z)
        free(coarse.z);
    return status;
}

/* The part of a plane that its copy holds. */
static void crop(const tc_plane *from, tc_plane *to)
{
    *to = packed_plane(to->rect);
    for (int64_t y = to->rect.y0; y < to->rect.y1; y++)
        memcpy(tc_plane_at(to, to->rect.x0, y), tc_plane_at(from, to->rect.x0, y), (size_t)to->stride * sizeof *to->z);
}

/* Makes the level's header as a packer does that never has whole planes: from copies of some tiles. */
static tc_status choose(packed_level *l, const tc_lifting_level *level, const packed_options *o, const tc_plane *coarse,
                        const tc_plane *band, const int32_t *step, const tc_detail_model *start, tc_detail_model *model)
{
    int wanted = o->training_tiles ? o->training_tiles : TC_TRAINING_TILES;
    tc_training_tile *tiles = packed_memory((size_t)wanted * sizeof *tiles);
    int count = tc_codec_sample(level, wanted, tiles);
    for (int k = 0; k < count; k++) {
        crop(coarse, &tiles[k].coarse);
        for (int b = 0; b < TC_BANDS; b++)
            crop(&band[b], &tiles[k].band[b]);
    }
    tc_status status =
        tc_codec_choose(level, tiles, count, o->lambda, step, start, 1, l->header, &l->header_size, model);
    for (int k = 0; k < count; k++) {
        free(tiles[k].coarse.z);
        for (int b = 0; b < TC_BANDS; b++)
            free(tiles[k].band[b].z);
    }
    free(tiles);
    return status;
}

int packed_analyse(const int32_t *z, int64_t width, int64_t height, bool wrap_x, tc_lifting_level *level, tc_plane *low,
                   tc_plane (*band)[TC_BANDS])
{
    int n = 0;
    low[0] = packed_plane((tc_rect){0, 0, width, height});
    memcpy(low[0].z, z, (size_t)(width * height) * sizeof *z);
    for (; tc_max64(low[n].rect.x1, low[n].rect.y1) > COARSEST; n++) {
        tc_rect r = low[n].rect, c = {0, 0, tc_coarse_size(r.x1), tc_coarse_size(r.y1)};
        level[n] = (tc_lifting_level){r.x1, r.y1, wrap_x && r.x1 % 2 == 0};
        low[n + 1] = packed_plane(c);
        for (int b = 0; b < TC_BANDS; b++)
            band[n][b] = packed_plane(c);
        int32_t *scratch = packed_memory(tc_lifting_analyse_scratch(&level[n], c.y1) * sizeof *scratch);
        tc_lifting_analyse(&level[n], &low[n], 0, c.y1, &low[n + 1], band[n], scratch);
        free(scratch);
    }
    return n;
}

packed packed_new(const int32_t *z, int64_t width, int64_t height, const packed_options *o)
{
    packed p = {0};
    tc_lifting_level levels[PACKED_LEVELS];
    tc_plane low[PACKED_LEVELS + 1], band[PACKED_LEVELS][TC_BANDS];
    p.levels = packed_analyse(z, width, height, o->wrap_x, levels, low, band);
    tc_plane coarse = low[p.levels];
    p.coarsest_bytes = 4 * (size_t)tc_rect_area(coarse.rect);
    tc_detail_model model;
    for (int n = p.levels - 1; n >= 0; n--) {
        packed_level *l = &p.level[n];
        tc_lifting_level level = levels[n];
        l->codec = packed_memory(sizeof *l->codec);
        int32_t step[TC_BANDS];
        for (int b = 0; b < TC_BANDS; b++)
            step[b] = (int32_t)fmin(fmax(1, rint(o->q / tc_lifting_norm(b, n))), TC_MAX_STEP);
        tc_status status = TC_OK;
        l->coarse = coarse;
        tc_plane source = level.wrap_x
                              ? packed_wrapped(&coarse, (tc_rect){-TC_TILE_MARGIN, 0, coarse.rect.x1 + TC_TILE_MARGIN,
                                                                  coarse.rect.y1})
                              : coarse;
        l->header = packed_memory(tc_detail_model_bound());
        double begin = terrain_cpu();
        if (o->builtin) {
            tc_detail_model_builtin(0, &model);
            memcpy(model.step, step, sizeof step);
            l->header_size = tc_detail_model_write(&model, (tc_detail_parts){0}, l->header);
        } else {
            const tc_detail_model *start = n == p.levels - 1 ? NULL : &model;
            status = choose(l, &level, o, &source, band[n], step, start, &model);
        }
        p.train_s += terrain_cpu() - begin;
        tc_detail_parts parts;
        if (status || (status = tc_detail_model_read(l->header, l->header_size, &model, &parts)))
            puts("packed: no model"), exit(99);
        tc_codec_init(l->codec, &level, &model);
        packed_make_tiles(l, l->codec->tiles_x * l->codec->tiles_y);
        job j = {l, &source, band[n], o->lambda, o->simd};
        begin = terrain_cpu();
        tc_parallel_for(o->threads, l->codec->tiles_y, encode_row, &j);
        p.encode_s += terrain_cpu() - begin;
        l->fine = packed_plane(low[n].rect);
        if (packed_read(l, &l->fine, NULL, TC_SIMD_AUTO))
            puts("packed: cannot be read"), exit(99);
        if (source.z != coarse.z)
            free(source.z);
        coarse = l->fine;
        for (int b = 0; b < TC_BANDS; b++)
            free(band[n][b].z);
        free(low[n].z);
    }
    if (p.levels == 0)
        free(low[0].z);
    return p;
}

void packed_free(packed *p)
{
    if (p->levels)
        free(p->level[p->levels - 1].coarse.z);
    for (int n = 0; n < p->levels; n++) {
        packed_level *l = &p->level[n];
        for (int64_t i = 0; i < l->tiles; i++)
            free(l->tile[i]);
        free(l->tile), free(l->tile_size), free(l->header), free(l->fine.z), free(l->codec), free(l->lh04);
    }
    *p = (packed){0};
}

size_t packed_bytes(const packed *p)
{
    size_t bytes = p->coarsest_bytes, empty = 0;
    for (int n = 0; n < p->levels; n++) {
        const packed_level *l = &p->level[n];
        bytes += l->header_size;
        for (int64_t i = 0; i < l->tiles; i++)
            if (l->tile_size[i])
                bytes += l->tile_size[i] + 8;
            else
                empty++;
    }
    return bytes + (empty + 7) / 8;
}

int32_t *packed_heights(test_random *r, int kind, int64_t w, int64_t h, int32_t cliff)
{
    int32_t *z = packed_memory((size_t)(w * h) * sizeof *z);
    double a = test_random_range(r, 0.02, 0.3), b = test_random_range(r, 0.02, 0.3);
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            double v = 0, smooth = sin(a * (double)x) * cos(b * (double)y);
            switch (kind) {
            case 0: v = test_random_range(r, -20000, 20000); break;
            case 1: v = 30000 * smooth; break;
            case 2: v = (x / 7 + y / 5) % 2 ? cliff : -cliff; break;
            case 3: v = -12345; break;
            case 4: v = 20000 * smooth + test_random_range(r, -300, 300) * (1 + smooth); break;
            case 5: v = x == w / 2 && y == h / 3 ? TC_LIFTING_LIMIT / 4 : 0; break;
            default: v = 3.0 * (double)x - 2.0 * (double)y; break;
            }
            z[y * w + x] = (int32_t)lrint(v);
        }
    return z;
}
