/* memory_field.c - a field held in memory: every level as floats, with a pyramid of ranges over its tiles. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "filter.h"
#include "measured_errors.h"
#include "common/base/parallel.h"
#include "memory_field.h"
#include "range_pyramid.h"
#include "common/base/rect.h"
#include "common/base/status.h"

enum {
    TILE = 16, /* samples of a bounds tile along a side */
    BAND = 64  /* rows that one task filters */
};

typedef struct memory_level {
    float *z;                /* [j * width + i] */
    uint8_t *voids;          /* the same; NULL where the terrain has no voids */
    tc_range_pyramid ranges; /* leaves: tiles */
} memory_level;

typedef struct memory_field {
    tc_field head;
    memory_level level[TC_MAX_FIELD_LEVELS];
    tc_range_pyramid error[TC_MAX_FIELD_LEVELS]; /* once errors_known (measured_errors.h) */
    pthread_mutex_t mutex;                       /* of finding out about them */
    _Atomic bool errors_known;
    bool flat; /* voids are shown at a height of their own */
    float void_height;
    _Atomic int64_t asked, range_reads;
} memory_field;

static tc_status memory_read(const tc_field *field, int level, tc_rect rect, void *samples, uint8_t *voids,
                             ptrdiff_t stride)
{
    float *z = samples;
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

static tc_range memory_range(const tc_field *field, int level, tc_rect rect)
{
    memory_field *p = (memory_field *)field;
    tc_rect piece[2];
    int pieces = tc_rect_round(rect, field->level[level - 1].width, piece), reads = 0;
    float error = p->errors_known ? 0 : INFINITY;
    tc_range all = TC_NO_RANGE;
    for (int n = 0; n < pieces; n++) {
        tc_rect r = piece[n], leaves = {r.x0 / TILE, r.y0 / TILE, (r.x1 - 1) / TILE + 1, (r.y1 - 1) / TILE + 1};
        const int64_t most_x = pieces == 1 ? 2 : 1;
        all = tc_range_both(all, tc_range_ask(&p->level[level - 1].ranges, leaves, most_x, &reads));
        if (p->errors_known)
            error = fmaxf(error, tc_measured_error(&p->error[level - 1], r, most_x, &reads));
    }
    all.error = error;
    p->asked++;
    p->range_reads += reads;
    return all;
}

static int64_t tiles(int64_t size)
{
    return (size + TILE - 1) / TILE;
}

static void memory_tell(const tc_field *field, tc_field_stats *stats)
{
    const memory_field *p = (const memory_field *)field;
    stats->bytes += sizeof *p;
    for (int l = 0; l < field->info.levels; l++) {
        int64_t w = field->level[l].width, h = field->level[l].height;
        stats->bytes += (size_t)(w * h) * (sizeof(float) + (p->level[l].voids ? 1 : 0));
        stats->bytes += (size_t)tc_range_nodes(tiles(w), tiles(h)) * sizeof(tc_range) * (p->errors_known ? 2 : 1);
    }
    stats->ranges += p->asked, stats->range_reads += p->range_reads;
}

static void memory_destroy(tc_field *field)
{
    memory_field *p = (memory_field *)field;
    for (int l = 0; l < field->info.levels; l++) {
        free(p->level[l].z);
        free(p->level[l].voids);
        free(p->level[l].ranges.node);
    }
    tc_measured_errors_free(p->error, field->info.levels);
    pthread_mutex_destroy(&p->mutex);
    free(p->head.georef.crs_wkt);
    free(p);
}

static void memory_know_errors(const tc_field *field)
{
    memory_field *p = (memory_field *)field;
    if (p->errors_known)
        return;
    pthread_mutex_lock(&p->mutex);
    if (!p->errors_known) {
        p->errors_known = tc_measure_errors(field, p->error) == TC_OK;
        if (!p->errors_known)
            tc_measured_errors_free(p->error, field->info.levels);
    }
    pthread_mutex_unlock(&p->mutex);
}

static const tc_field_class memory_class = {.sample = TC_FIELD_HEIGHTS,
                                            .read = memory_read,
                                            .range = memory_range,
                                            .know_errors = memory_know_errors,
                                            .tell = memory_tell,
                                            .destroy = memory_destroy};

/* Building: each level from the next finer one, in bands of rows. */
typedef struct step {
    memory_field *p;
    int level; /* of the result */
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
            l->z[i] = s->p->void_height;
}

/* `count` heights of the coarser level's row j, and what goes on behind its sides: the slope between the last two
 * samples, half a step further, or the other side of a level that wraps. */
static void coarse_row(const memory_field *p, int level, int64_t j, int64_t count, float *row)
{
    const tc_level *size = &p->head.level[level - 1];
    int64_t w = size->width, inside = tc_min64(j, size->height - 1);
    const float *z = p->level[level - 1].z + inside * w, *before = inside > 0 ? z - w : z;
    for (int64_t i = 0; i < w; i++)
        row[i] = j > inside ? z[i] + 0.5f * (z[i] - before[i]) : z[i];
    if (count > w)
        row[w] = tc_field_wraps(&p->head, level) ? row[0] : row[w - 1] + 0.5f * (row[w - 1] - row[tc_max64(w - 2, 0)]);
}

/* Heights of the coarser level's mesh on the spots of row j, whose cells are cut from south-east to north-west
 * (mesh.h): in the middle of a cell is the middle of that edge. */
static void mesh_row(const memory_field *p, int level, int64_t j, float *row, float *mesh)
{
    int64_t w = p->head.level[level - 1].width, cw = p->head.level[level - 2].width;
    float *south = row, *north = row + cw + 1;
    coarse_row(p, level - 1, j / 2, w / 2 + 1, south);
    if (j % 2)
        coarse_row(p, level - 1, j / 2 + 1, w / 2 + 1, north);
    else
        memcpy(north, south, (size_t)(cw + 1) * sizeof *north);
    for (int64_t i = 0; i < w / 2; i++) {
        mesh[2 * i] = 0.5f * (south[i] + north[i]);
        mesh[2 * i + 1] = 0.5f * (south[i + 1] + north[i]);
    }
    if (w % 2)
        mesh[w - 1] = 0.5f * (south[w / 2] + north[w / 2]);
}

/* Ranges of a row of tiles. */
static void range_row(void *context, int64_t ty)
{
    step *s = context;
    memory_level *l = &s->p->level[s->level - 1];
    int64_t width = s->p->head.level[s->level - 1].width, height = s->p->head.level[s->level - 1].height;
    tc_range *range = l->ranges.node + ty * l->ranges.nx;
    float *mesh = s->level > 1 ? malloc((size_t)(2 * width + 4) * sizeof *mesh) : NULL;
    if (s->level > 1 && !mesh) {
        s->failed = 1;
        return;
    }
    for (int64_t tx = 0; tx < l->ranges.nx; tx++)
        range[tx] = (tc_range){INFINITY, -INFINITY, mesh ? 0 : INFINITY, 0};
    for (int64_t j = ty * TILE; j < tc_min64((ty + 1) * TILE, height); j++) {
        const float *row = l->z + j * width;
        if (mesh)
            mesh_row(s->p, s->level, j, mesh + width, mesh);
        for (int64_t tx = 0; tx < l->ranges.nx; tx++) {
            tc_range r = range[tx];
            int64_t end = tc_min64((tx + 1) * TILE, width);
            for (int64_t i = tx * TILE; i < end; i++) {
                r.lo = row[i] < r.lo ? row[i] : r.lo;
                r.hi = row[i] > r.hi ? row[i] : r.hi;
            }
            for (int64_t i = tx * TILE; i < end && mesh; i++) {
                float off = fabsf(row[i] - mesh[i]);
                r.step = off > r.step ? off : r.step;
            }
            range[tx] = r;
        }
    }
    free(mesh);
}

static bool allocate_level(memory_field *p, int level, bool voids)
{
    int64_t w = p->head.level[level - 1].width, h = p->head.level[level - 1].height;
    memory_level *l = &p->level[level - 1];
    if (!l->z)
        l->z = malloc((size_t)(w * h) * sizeof *l->z);
    if (voids && !l->voids)
        l->voids = malloc((size_t)(w * h));
    l->ranges = (tc_range_pyramid){tiles(w), tiles(h), NULL};
    l->ranges.node = malloc((size_t)tc_range_nodes(tiles(w), tiles(h)) * sizeof *l->ranges.node);
    return l->z && l->ranges.node && (!voids || l->voids);
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
    info->other_body = tc_is_other_body(&grid->georef);
    info->semi_major = grid->georef.semi_major;
    p->head.georef = grid->georef;
    p->level[info->levels - 1].z = grid->z;
    p->level[info->levels - 1].voids = grid->void_count > 0 ? grid->voids : NULL;
    if (grid->void_count <= 0)
        free(grid->voids);
    memset(grid, 0, sizeof *grid);
}

static tc_status no_memory(memory_field *p, tc_error *error)
{
    memory_destroy(&p->head);
    return tc_fail(error, TC_ERR_MEMORY, "pyramid: not enough memory");
}

tc_status tc_memory_field_begin(tc_grid *grid, tc_field **field_ret, tc_error *error)
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
    pthread_mutex_init(&p->mutex, NULL);
    bool voids = grid->voids != NULL && grid->void_count > 0;
    p->flat = voids && grid->voids_flat;
    p->void_height = grid->void_height;
    take_grid(p, grid);
    for (int l = p->head.info.levels; l >= 1; l--)
        if (!allocate_level(p, l, voids))
            return no_memory(p, error);
    *field_ret = &p->head;
    return TC_OK;
}

void tc_memory_field_level(tc_field *field, int level, float **z_ret, uint8_t **voids_ret)
{
    const memory_level *l = &((memory_field *)field)->level[level - 1];
    *z_ret = l->z, *voids_ret = l->voids;
}

/* Only once all levels are filtered: a flat void must not leak into its neighbours. */
tc_status tc_memory_field_finish(tc_field *field, int threads, tc_error *error)
{
    memory_field *p = (memory_field *)field;
    step s = {.p = p};
    int m = field->info.levels;
    for (s.level = m; s.level >= 1 && p->flat; s.level--)
        tc_parallel_for(threads, field->level[s.level - 1].height, flatten_row, &s);
    for (s.level = m; s.level >= 1 && !s.failed; s.level--) {
        tc_parallel_for(threads, p->level[s.level - 1].ranges.ny, range_row, &s);
        tc_range_build(&p->level[s.level - 1].ranges);
    }
    return s.failed ? tc_fail(error, TC_ERR_MEMORY, "pyramid: not enough memory") : TC_OK;
}

tc_status tc_field_build(tc_grid *grid, int threads, tc_field **field_ret, tc_error *error)
{
    tc_field *field;
    tc_status status = tc_memory_field_begin(grid, &field, error);
    if (status != TC_OK)
        return status;
    memory_field *p = (memory_field *)field;
    step s = {.p = p};
    for (s.level = field->info.levels - 1; s.level >= 1 && !s.failed; s.level--)
        tc_parallel_for(threads, (field->level[s.level - 1].height + BAND - 1) / BAND, downsample_band, &s);
    if (s.failed)
        return no_memory(p, error);
    status = tc_memory_field_finish(field, threads, error);
    if (status == TC_OK)
        *field_ret = field;
    else
        memory_destroy(field);
    return status;
}
