/* measured_errors.c - finest samples against coarser meshes, block by block. */
#include "measured_errors.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"

enum {
    BLOCK = 512, /* finest samples a side that a task looks at */
    COARSE = BLOCK / 2 + 2
};

typedef struct measurement {
    const tc_field *field;
    tc_range_pyramid *errors;
    int64_t across; /* blocks in a row */
    pthread_mutex_t mutex;
    _Atomic tc_status status;
} measurement;

/* A task's memory. */
typedef struct room {
    float fine[BLOCK * BLOCK], coarse[COARSE * COARSE];
    float held[COARSE + 1][COARSE + 1]; /* what of the coarse ones there is */
    float error[(BLOCK / TC_ERROR_TILE) * (BLOCK / TC_ERROR_TILE)];
} room;

/* The coarse samples (x0, y0) to (x1, y1), which may lie one beyond the level's last ones: there it goes on in a
 * straight line, or from its other side. */
static tc_status read_mesh(const tc_field *field, int level, tc_rect r, float (*z)[COARSE + 1], float *mesh)
{
    const tc_level size = tc_field_level(field, level);
    const int64_t w = r.x1 - r.x0, h = r.y1 - r.y0;
    /* Two samples at least, for the line. */
    const tc_rect held = {tc_max64(tc_min64(r.x0, size.width - 2), 0), tc_max64(tc_min64(r.y0, size.height - 2), 0),
                          tc_min64(r.x1, size.width), tc_min64(r.y1, size.height)};
    tc_status status = tc_field_read(field, level, held, z[0], NULL, COARSE + 1);
    for (int64_t j = 0; j < h && !status; j++)
        for (int64_t i = 0; i < w; i++) {
            const int64_t x = r.x0 + i, y = r.y0 + j, cx = tc_min64(x, size.width - 1),
                          cy = tc_min64(y, size.height - 1), u = cx - held.x0, v = cy - held.y0;
            float at = z[v][u];
            if (x > cx && u > 0)
                at += z[v][u] - z[v][u - 1];
            if (y > cy && v > 0)
                at += z[v][u] - z[v - 1][u];
            mesh[j * w + i] = at;
        }
    if (r.x1 > size.width && tc_field_wraps(field, level + 1) && !status) {
        float column[COARSE];
        const tc_rect first = {0, r.y0, 1, held.y1};
        status = tc_field_read(field, level, first, column, NULL, 1);
        for (int64_t j = 0; j < h && !status; j++)
            mesh[j * w + w - 1] = column[tc_min64(j, first.y1 - first.y0 - 1)];
    }
    return status;
}

/* Samples `begin` to `end` - 1 of a cell's row, from its west side on, against its two triangles: heights go evenly
 * from `west` to the diagonal after `kink` samples, and on to `east`. */
static float cell_error(const float *z, int64_t begin, int64_t end, float west, float diagonal, float east,
                        int64_t kink, int64_t cell)
{
    const float to = kink > 0 ? (diagonal - west) / (float)kink : 0,
                on = kink < cell ? (east - diagonal) / (float)(cell - kink) : 0;
    const int64_t first = tc_min64(kink, end);
    float most = 0;
    for (int64_t i = begin; i < first; i++) {
        const float off = fabsf(z[i] - (west + (float)i * to));
        most = off > most ? off : most;
    }
    for (int64_t i = tc_max64(kink, begin); i < end; i++) {
        const float off = fabsf(z[i] - (diagonal + (float)(i - kink) * on));
        most = off > most ? off : most;
    }
    return most;
}

/* Finest samples of a block, rows BLOCK apart, against the mesh of a level `shift` halvings coarser, whose first sample
 * is at or before the block's: the largest distance in each of the block's tiles, 2^tile samples wide. */
static void compare(const float *fine, tc_rect block, const float *mesh, tc_rect coarse, int shift, int tile,
                    float *error)
{
    const int64_t cell = (int64_t)1 << shift, stride = coarse.x1 - coarse.x0;
    for (int64_t j = block.y0; j < block.y1; j++) {
        const int64_t row = j >> shift, up = j - (row << shift);
        const float t = (float)up / (float)cell, *south = mesh + (row - coarse.y0) * stride, *north = south + stride;
        float *to = error + ((j >> tile) - (block.y0 >> tile)) * (BLOCK / TC_ERROR_TILE);
        for (int64_t x = block.x0; x < block.x1;) {
            /* A block may begin within a cell. */
            const int64_t c = x >> shift, from = c << shift, end = tc_min64(from + cell, block.x1), i = c - coarse.x0;
            const float west = south[i] + t * (north[i] - south[i]),
                        diagonal = south[i + 1] + t * (north[i] - south[i + 1]),
                        east = south[i + 1] + t * (north[i + 1] - south[i + 1]);
            const float *z = fine + (j - block.y0) * BLOCK + (from - block.x0);
            const float most = cell_error(z, x - from, end - from, west, diagonal, east, cell - up, cell);
            float *of = &to[(x >> tile) - (block.x0 >> tile)];
            *of = most > *of ? most : *of;
            x = end;
        }
    }
}

static tc_status measure_block(measurement *m, tc_rect block, room *r)
{
    const int finest = tc_field_info(m->field)->levels;
    tc_status status = tc_field_read(m->field, finest, block, r->fine, NULL, BLOCK);
    for (int level = finest; level >= 2 && !status; level--) {
        const int shift = finest - level + 1, tile = TC_ERROR_TILE_SHIFT + finest - level;
        const tc_rect coarse = {block.x0 >> shift, block.y0 >> shift, ((block.x1 - 1) >> shift) + 2,
                                ((block.y1 - 1) >> shift) + 2};
        const tc_range_pyramid *to = &m->errors[level - 1];
        const int64_t tx = block.x0 >> tile, ty = block.y0 >> tile, nx = ((block.x1 - 1) >> tile) + 1 - tx,
                      ny = ((block.y1 - 1) >> tile) + 1 - ty;
        status = read_mesh(m->field, level - 1, coarse, r->held, r->coarse);
        if (status)
            break;
        for (int64_t n = 0; n < ny * (BLOCK / TC_ERROR_TILE); n++)
            r->error[n] = 0;
        compare(r->fine, block, r->coarse, coarse, shift, tile, r->error);
        pthread_mutex_lock(&m->mutex);
        for (int64_t y = 0; y < ny; y++)
            for (int64_t x = 0; x < nx; x++) {
                float *error = &to->node[(ty + y) * to->nx + tx + x].error;
                *error = fmaxf(*error, r->error[y * (BLOCK / TC_ERROR_TILE) + x]);
            }
        pthread_mutex_unlock(&m->mutex);
    }
    return status;
}

static void measure_task(void *context, int64_t n)
{
    measurement *m = context;
    const tc_level size = tc_field_level(m->field, tc_field_info(m->field)->levels);
    const int64_t x = n % m->across * BLOCK, y = n / m->across * BLOCK;
    if (m->status)
        return;
    room *r = malloc(sizeof *r);
    tc_status status =
        r ? measure_block(m, (tc_rect){x, y, tc_min64(x + BLOCK, size.width), tc_min64(y + BLOCK, size.height)}, r)
          : TC_ERR_MEMORY;
    if (status)
        m->status = status;
    free(r);
}

/* No less than the finer level's. */
static void add_finer(const tc_range_pyramid *to, const tc_range_pyramid *finer)
{
    for (int64_t y = 0; y < finer->ny; y++)
        for (int64_t x = 0; x < finer->nx; x++) {
            float *error = &to->node[tc_min64(y / 2, to->ny - 1) * to->nx + tc_min64(x / 2, to->nx - 1)].error;
            *error = fmaxf(*error, finer->node[y * finer->nx + x].error);
        }
}

tc_status tc_measure_errors(const tc_field *field, tc_range_pyramid *errors)
{
    const int levels = tc_field_info(field)->levels;
    const tc_level finest = tc_field_level(field, levels);
    measurement m = {.field = field, .errors = errors, .across = (finest.width + BLOCK - 1) / BLOCK};
    for (int l = 1; l <= levels; l++) {
        const tc_level size = tc_field_level(field, l);
        tc_range_pyramid *r = &errors[l - 1];
        r->nx = tc_ceil_shift(size.width, TC_ERROR_TILE_SHIFT), r->ny = tc_ceil_shift(size.height, TC_ERROR_TILE_SHIFT);
        r->node = calloc((size_t)tc_range_nodes(r->nx, r->ny), sizeof *r->node);
        if (!r->node)
            return TC_ERR_MEMORY;
        for (int64_t n = 0; n < r->nx * r->ny && l == 1; n++)
            r->node[n].error = INFINITY;
    }
    pthread_mutex_init(&m.mutex, NULL);
    tc_parallel_for(0, m.across * ((finest.height + BLOCK - 1) / BLOCK), measure_task, &m);
    pthread_mutex_destroy(&m.mutex);
    for (int l = levels; l >= 2 && !m.status; l--)
        if (l > 2)
            add_finer(&errors[l - 2], &errors[l - 1]);
    for (int l = 1; l <= levels && !m.status; l++)
        tc_range_build(&errors[l - 1]);
    return m.status;
}

float tc_measured_error(const tc_range_pyramid *errors, tc_rect r, int64_t most_x, int *reads)
{
    const tc_rect leaves = {r.x0 >> TC_ERROR_TILE_SHIFT, r.y0 >> TC_ERROR_TILE_SHIFT,
                            ((r.x1 - 1) >> TC_ERROR_TILE_SHIFT) + 1, ((r.y1 - 1) >> TC_ERROR_TILE_SHIFT) + 1};
    return tc_range_ask(errors, leaves, most_x, reads).error;
}

void tc_measured_errors_free(tc_range_pyramid *errors, int levels)
{
    for (int l = 0; l < levels; l++)
        free(errors[l].node), errors[l].node = NULL;
}
