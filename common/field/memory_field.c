/* memory_field.c - a pyramid held in memory: every level as floats, with height bounds by tiles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "filter.h"
#include "common/base/parallel.h"
#include "field.h"
#include "common/base/rect.h"
#include "common/base/status.h"

enum {
    TILE = 16, /* samples of a bounds tile along a side */
    BAND = 64  /* rows that one task filters */
};

typedef struct memory_level {
    float *z;       /* [j * width + i] */
    uint8_t *voids; /* the same; NULL where the terrain has no voids */
    float *bounds;  /* (min, max) of each tile */
    int64_t tiles_x;
} memory_level;

typedef struct memory_field {
    tc_field head;
    tc_georef georef;
    memory_level level[TC_MAX_FIELD_LEVELS];
} memory_field;

static tc_status memory_read(const tc_field *field, int level, tc_rect rect, float *z, uint8_t *voids, ptrdiff_t stride)
{
    const memory_level *l = &((const memory_field *)field)->level[level - 1];
    int64_t width = field->level[level - 1].width, w = rect.x1 - rect.x0;
    for (int64_t j = rect.y0; j < rect.y1; j++) {
        if (z)
            memcpy(z + (j - rect.y0) * stride, l->z + j * width + rect.x0, (size_t)w * sizeof *z);
        if (voids && l->voids)
            memcpy(voids + (j - rect.y0) * stride, l->voids + j * width + rect.x0, (size_t)w);
        else if (voids)
            memset(voids + (j - rect.y0) * stride, 0, (size_t)w);
    }
    return TC_OK;
}

static void memory_bounds(const tc_field *field, int level, tc_rect rect, float *z_min_ret, float *z_max_ret)
{
    const memory_level *l = &((const memory_field *)field)->level[level - 1];
    float lo = INFINITY, hi = -INFINITY;
    for (int64_t ty = rect.y0 / TILE; ty <= (rect.y1 - 1) / TILE; ty++) {
        const float *b = l->bounds + 2 * (ty * l->tiles_x + rect.x0 / TILE);
        for (int64_t tx = rect.x0 / TILE; tx <= (rect.x1 - 1) / TILE; tx++, b += 2) {
            lo = fminf(lo, b[0]);
            hi = fmaxf(hi, b[1]);
        }
    }
    *z_min_ret = lo;
    *z_max_ret = hi;
}

static int64_t tiles(int64_t size)
{
    return (size + TILE - 1) / TILE;
}

static size_t memory_bytes(const tc_field *field)
{
    const memory_field *p = (const memory_field *)field;
    size_t bytes = sizeof *p;
    for (int l = 0; l < field->info.levels; l++) {
        int64_t w = field->level[l].width, h = field->level[l].height;
        bytes += (size_t)(w * h) * (sizeof(float) + (p->level[l].voids ? 1 : 0));
        bytes += (size_t)(tiles(w) * tiles(h)) * 2 * sizeof(float);
    }
    return bytes;
}

static void memory_destroy(tc_field *field)
{
    memory_field *p = (memory_field *)field;
    for (int l = 0; l < field->info.levels; l++) {
        free(p->level[l].z);
        free(p->level[l].voids);
        free(p->level[l].bounds);
    }
    free(p->georef.crs_wkt);
    free(p);
}

static const tc_field_class memory_class = {memory_read, memory_bounds, NULL, memory_bytes, memory_destroy};

/* Building: each level from the next finer one, in bands of rows. */
typedef struct step {
    memory_field *p;
    int level; /* of the result */
    float void_height;
    _Atomic int failed;
} step;

static void downsample_band(void *context, int64_t i)
{
    step *s = context;
    const tc_level *fine = &s->p->head.level[s->level], *coarse = &s->p->head.level[s->level - 1];
    int64_t j0 = i * BAND, j1 = tc_min64(j0 + BAND, coarse->height);
    float *scratch = malloc(tc_downsample_scratch(fine->width, j1 - j0) * sizeof *scratch);
    if (!scratch) {
        s->failed = 1;
        return;
    }
    memory_level *out = &s->p->level[s->level - 1];
    const memory_level *in = &s->p->level[s->level];
    bool wraps = tc_field_wraps(&s->p->head, s->level); /* a wrapping result comes from an even halving */
    tc_downsample(in->z, fine->width, fine->height, wraps, j0, j1, out->z + j0 * coarse->width, scratch);
    /* A coarse sample is void where the fine sample on the same spot is: outlines of holes then meet at shared
     * vertices. */
    if (in->voids)
        for (int64_t j = j0; j < j1; j++)
            for (int64_t x = 0; x < coarse->width; x++)
                out->voids[j * coarse->width + x] = in->voids[2 * j * fine->width + 2 * x];
    free(scratch);
}

static void flatten_row(void *context, int64_t j)
{
    step *s = context;
    memory_level *l = &s->p->level[s->level - 1];
    int64_t width = s->p->head.level[s->level - 1].width;
    for (int64_t i = j * width; i < (j + 1) * width; i++)
        if (l->voids[i])
            l->z[i] = s->void_height;
}

static void bounds_row(void *context, int64_t ty)
{
    step *s = context;
    memory_level *l = &s->p->level[s->level - 1];
    int64_t width = s->p->head.level[s->level - 1].width, height = s->p->head.level[s->level - 1].height;
    float *bounds = l->bounds + 2 * ty * l->tiles_x;
    for (int64_t tx = 0; tx < l->tiles_x; tx++)
        bounds[2 * tx] = INFINITY, bounds[2 * tx + 1] = -INFINITY;
    for (int64_t j = ty * TILE; j < tc_min64((ty + 1) * TILE, height); j++) {
        const float *row = l->z + j * width;
        for (int64_t tx = 0; tx < l->tiles_x; tx++) {
            float lo = bounds[2 * tx], hi = bounds[2 * tx + 1];
            for (int64_t i = tx * TILE; i < tc_min64((tx + 1) * TILE, width); i++) {
                lo = row[i] < lo ? row[i] : lo;
                hi = row[i] > hi ? row[i] : hi;
            }
            bounds[2 * tx] = lo, bounds[2 * tx + 1] = hi;
        }
    }
}

static bool allocate_level(memory_field *p, int level, bool voids)
{
    int64_t w = p->head.level[level - 1].width, h = p->head.level[level - 1].height;
    memory_level *l = &p->level[level - 1];
    if (!l->z)
        l->z = malloc((size_t)(w * h) * sizeof *l->z);
    if (voids && !l->voids)
        l->voids = malloc((size_t)(w * h));
    l->tiles_x = tiles(w);
    l->bounds = malloc((size_t)(tiles(w) * tiles(h)) * 2 * sizeof *l->bounds);
    return l->z && l->bounds && (!voids || l->voids);
}

/* Whether the body that the georeference is on is clearly not the Earth: its radius tells. */
static bool is_other_body(const tc_georef *georef)
{
    return georef->semi_major > 0 && (georef->semi_major < 6.3e6 || georef->semi_major > 6.45e6);
}

/* Takes over what the grid owns; its numbers become the finest level and the terrain's. */
static void take_grid(memory_field *p, tc_grid *grid)
{
    tc_terrain_info *info = &p->head.info;
    p->head.class = &memory_class;
    tc_field_set_levels(&p->head, (tc_level){grid->width, grid->height, grid->spacing_x, grid->spacing_y});
    info->z_base = grid->z_base;
    info->z_min = grid->z_min;
    info->z_max = grid->z_max;
    if (grid->voids_flat && grid->void_count > 0) { /* it will be seen */
        info->z_min = fminf(info->z_min, grid->void_height);
        info->z_max = fmaxf(info->z_max, grid->void_height);
    }
    info->void_count = grid->void_count;
    info->wraps_x = grid->wraps_x;
    info->other_body = is_other_body(&grid->georef);
    p->georef = grid->georef;
    p->level[info->levels - 1].z = grid->z;
    p->level[info->levels - 1].voids = grid->void_count > 0 ? grid->voids : NULL;
    if (grid->void_count <= 0)
        free(grid->voids);
    memset(grid, 0, sizeof *grid);
}

tc_status tc_field_build(tc_grid *grid, int threads, tc_field **field_ret, tc_error *error)
{
    if (!grid->z || grid->width < 1 || grid->height < 1 || !(grid->spacing_x > 0) || !(grid->spacing_y > 0)) {
        tc_grid_free(grid);
        return tc_fail(error, TC_ERR_USAGE, "pyramid: expected a grid of samples with a spacing above 0");
    }
    memory_field *p = calloc(1, sizeof *p);
    if (!p) {
        tc_grid_free(grid);
        return tc_fail(error, TC_ERR_MEMORY, "pyramid: not enough memory");
    }
    bool voids = grid->voids != NULL && grid->void_count > 0, flat = voids && grid->voids_flat;
    step s = {.p = p, .void_height = grid->void_height};
    take_grid(p, grid);
    int m = p->head.info.levels;
    for (s.level = m; s.level >= 1 && !s.failed; s.level--) {
        if (!allocate_level(p, s.level, voids))
            s.failed = 1;
        else if (s.level < m)
            tc_parallel_for(threads, (p->head.level[s.level - 1].height + BAND - 1) / BAND, downsample_band, &s);
    }
    /* Only once all levels are filtered: a flat void must not leak into its neighbours. */
    for (s.level = m; s.level >= 1 && !s.failed; s.level--) {
        if (flat)
            tc_parallel_for(threads, p->head.level[s.level - 1].height, flatten_row, &s);
        tc_parallel_for(threads, tiles(p->head.level[s.level - 1].height), bounds_row, &s);
    }
    if (s.failed) {
        memory_destroy(&p->head);
        return tc_fail(error, TC_ERR_MEMORY, "pyramid: not enough memory");
    }
    *field_ret = &p->head;
    return TC_OK;
}
