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
    const tc_error_sink *sink;
    int64_t across, first; /* blocks in a row, and before those under way */
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
        float column[COARSE + 1];
        const tc_rect first = {0, held.y0, 1, held.y1};
        status = tc_field_read(field, level, first, column, NULL, 1);
        for (int64_t j = 0; j < h && !status; j++) {
            const int64_t y = r.y0 + j, cy = tc_min64(y, size.height - 1), v = cy - held.y0;
            mesh[j * w + w - 1] = column[v] + (y > cy && v > 0 ? column[v] - column[v - 1] : 0);
        }
    }
    return status;
}

/* A row of finest samples in cells of a coarser mesh: `up` rows above its southern samples, cells `cell` samples wide,
 * the first sample `first` within one. */
typedef struct mesh_row {
    const float *south, *north;
    int up, cell, first, count;
} mesh_row;

/* Heights of the mesh there: in a cell they go evenly from its west side to the diagonal, and on to its east side. */
static void follow(const mesh_row *r, float *z)
{
    const float t = (float)r->up / (float)r->cell;
    const int kink = r->cell - r->up;
    for (int x = 0, c = 0, i = r->first; x < r->count; c++, i = 0) {
        const float *south = r->south + c, *north = r->north + c;
        const int end = r->count - x < r->cell - i ? i + r->count - x : r->cell, middle = kink < end ? kink : end;
        const float west = south[0] + t * (north[0] - south[0]), diagonal = south[1] + t * (north[0] - south[1]),
                    east = south[1] + t * (north[1] - south[1]), to = (diagonal - west) / (float)kink,
                    on = r->up > 0 ? (east - diagonal) / (float)r->up : 0;
        for (; i < middle; i++)
            z[x++] = west + (float)i * to;
        for (; i < end; i++)
            z[x++] = diagonal + (float)(i - kink) * on;
    }
}

/* The same where cells are small: by the place within them, for all of them at once. */
static inline void follow_small(const mesh_row *r, int cell, float *z)
{
    const float part = 1 / (float)cell;
    const int cells = (r->count + cell - 1) / cell;
    for (int i = 0; i < cell; i++) {
        const int beyond = i + r->up - cell; /* of the diagonal */
        if (beyond < 0) {
            const float se = (float)i * part, nw = (float)r->up * part, sw = 1 - se - nw;
            for (int c = 0; c < cells; c++)
                z[c * cell + i] = sw * r->south[c] + se * r->south[c + 1] + nw * r->north[c];
        } else {
            const float nw = (float)(cell - i) * part, se = (float)(cell - r->up) * part, ne = 1 - se - nw;
            for (int c = 0; c < cells; c++)
                z[c * cell + i] = nw * r->north[c] + se * r->south[c + 1] + ne * r->north[c + 1];
        }
    }
}

/* Finest samples of a block, rows BLOCK apart, against the mesh of a level `shift` halvings coarser, whose first sample
 * is at or before the block's: the largest distance in each of the block's tiles, 2^tile samples wide. */
static void compare(const float *fine, tc_rect block, const float *mesh, tc_rect coarse, int shift, int tile,
                    float *error)
{
    const int64_t cell = (int64_t)1 << shift, stride = coarse.x1 - coarse.x0;
    const int count = (int)(block.x1 - block.x0);
    float line[BLOCK], most[BLOCK] = {0};
    for (int64_t j = block.y0; j < block.y1; j++) {
        const int64_t row = j >> shift;
        const mesh_row r = {mesh + (row - coarse.y0) * stride, mesh + (row - coarse.y0 + 1) * stride,
                            (int)(j - (row << shift)),         (int)cell,
                            (int)(block.x0 & (cell - 1)),      count};
        if (cell == 2)
            follow_small(&r, 2, line);
        else if (cell == 4)
            follow_small(&r, 4, line);
        else if (cell == 8)
            follow_small(&r, 8, line);
        else
            follow(&r, line);
        const float *z = fine + (j - block.y0) * BLOCK;
        for (int x = 0; x < count; x++) {
            const float off = fabsf(z[x] - line[x]);
            most[x] = off > most[x] ? off : most[x];
        }
        if (((j + 1) & (((int64_t)1 << tile) - 1)) != 0 && j + 1 < block.y1)
            continue;
        float *to = error + ((j >> tile) - (block.y0 >> tile)) * (BLOCK / TC_ERROR_TILE);
        for (int x = 0; x < count; x++) {
            float *of = &to[((block.x0 + x) >> tile) - (block.x0 >> tile)];
            *of = most[x] > *of ? most[x] : *of;
            most[x] = 0;
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
        const int64_t tx = block.x0 >> tile, ty = block.y0 >> tile, nx = ((block.x1 - 1) >> tile) + 1 - tx,
                      ny = ((block.y1 - 1) >> tile) + 1 - ty;
        status = read_mesh(m->field, level - 1, coarse, r->held, r->coarse);
        if (status)
            break;
        for (int64_t n = 0; n < ny * (BLOCK / TC_ERROR_TILE); n++)
            r->error[n] = 0;
        compare(r->fine, block, r->coarse, coarse, shift, tile, r->error);
        pthread_mutex_lock(&m->mutex);
        m->sink->raise(m->sink->context, level, (tc_rect){tx, ty, tx + nx, ty + ny}, r->error, BLOCK / TC_ERROR_TILE);
        pthread_mutex_unlock(&m->mutex);
    }
    return status;
}

static void measure_task(void *context, int64_t n)
{
    measurement *m = context;
    const tc_level size = tc_field_level(m->field, tc_field_info(m->field)->levels);
    const int64_t x = (m->first + n) % m->across * BLOCK, y = (m->first + n) / m->across * BLOCK;
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

tc_status tc_measure_errors_to(const tc_field *field, const tc_error_sink *sink, int threads)
{
    enum { AT_ONCE = 256 }; /* blocks between questions whether to go on */
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    measurement m = {.field = field, .sink = sink, .across = (finest.width + BLOCK - 1) / BLOCK};
    const int64_t blocks = m.across * ((finest.height + BLOCK - 1) / BLOCK);
    pthread_mutex_init(&m.mutex, NULL);
    for (; m.first < blocks && !m.status; m.first += AT_ONCE) {
        const int64_t count = tc_min64(AT_ONCE, blocks - m.first);
        tc_parallel_for(threads, count, measure_task, &m);
        if (!m.status && sink->go_on && !sink->go_on(sink->context, (double)count / (double)blocks))
            m.status = TC_ERR_IO;
    }
    pthread_mutex_destroy(&m.mutex);
    return m.status;
}

/* ---- Into pyramids ---------------------------------------------------------------------------------------------- */

static void raise_nodes(void *context, int level, tc_rect leaves, const float *error, ptrdiff_t stride)
{
    const tc_range_pyramid *to = (const tc_range_pyramid *)context + level - 1;
    for (int64_t y = leaves.y0; y < leaves.y1; y++)
        for (int64_t x = leaves.x0; x < leaves.x1; x++) {
            float *node = &to->node[y * to->nx + x].error;
            *node = fmaxf(*node, error[(y - leaves.y0) * stride + x - leaves.x0]);
        }
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
    const tc_status status = tc_measure_errors_to(field, &(tc_error_sink){errors, raise_nodes, NULL}, 0);
    for (int l = levels; l > 2 && !status; l--)
        add_finer(&errors[l - 2], &errors[l - 1]);
    for (int l = 1; l <= levels && !status; l++)
        tc_range_build(&errors[l - 1]);
    return status;
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
