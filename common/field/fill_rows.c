/* fill_rows.c - void filling by rows: pull-push with a membrane at the top (fill_rows.h).
 *
 *   pull   each level's samples are the means, with weights (1 2 1)/4 along both axes, of the valid samples around them
 *          on the next finer level, void where there is none; until a level fits memory (Gortler et al. 1996, "The
 *          Lumigraph");
 *   top    fill.c's membrane over the voids of that level;
 *   push   back down: the voids start from the coarser level, upsampled linearly, and are relaxed by a few red-black
 *          Gauss-Seidel sweeps of Laplace's equation: what the coarser levels got wrong is rough, and goes quickly.
 *
 * All sweeps of a level run over its rows together, each half-sweep a row behind the one before it: that is the same,
 * to the bit, as one after the other over the whole level, and needs only as many rows in memory as there are
 * half-sweeps. Runs of rows that hold voids do not depend on each other. */
#include "fill_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "fill.h"
#include "filter.h"

enum {
    MAX_LEVELS = 34,
    HALF_SWEEPS = 16,
    RING = HALF_SWEEPS + 2, /* rows of the push: all that half-sweeps are at, one before and one after */
    BLOCK_SAMPLES = 1 << 18
};

typedef struct level {
    tc_fill_rows rows;
    uint8_t *has_voids; /* of each row */
    bool voids;
} level;

/* Cells x0 <= x < x1 of a row, all void. */
typedef struct span {
    int32_t x0, x1;
} span;

typedef struct fill {
    level levels[MAX_LEVELS];
    int count;
    int64_t memory_samples, block_rows;
    float low, high; /* of the valid samples */
} fill;

/* Rows in memory on their way in or out: y0 <= y < y0 + count. */
typedef struct block {
    const tc_fill_rows *of;
    int64_t y0, count, room;
    float *z;
} block;

static bool open_block(block *b, const fill *f, const tc_fill_rows *of)
{
    int64_t room = f->block_rows > 0 ? f->block_rows : BLOCK_SAMPLES / of->width;
    room = tc_clamp64(room, 2, tc_max64(of->height, 2));
    *b = (block){.of = of, .room = room, .z = malloc((size_t)(room * of->width) * sizeof(float))};
    return b->z != NULL;
}

/* Row y, with at least `rows` rows from it on in memory; reads ahead, but not to row `until`. */
static tc_status fetch(block *b, int64_t y, int64_t rows, int64_t until, const float **row_ret)
{
    if (y < b->y0 || y + rows > b->y0 + b->count) {
        b->y0 = y;
        b->count = tc_min64(tc_max64(tc_min64(until - y, b->room), rows), b->of->height - y);
        tc_status status = b->of->read(b->of->context, y, b->count, b->z);
        if (status) {
            b->count = 0;
            return status;
        }
    }
    *row_ret = b->z + (y - b->y0) * b->of->width;
    return TC_OK;
}

static tc_status flush(block *b)
{
    tc_status status = b->count > 0 ? b->of->write(b->of->context, b->y0, b->count, b->z) : TC_OK;
    b->count = 0;
    return status;
}

/* Room for row y, which is written now or later. */
static tc_status append(block *b, int64_t y, float **row_ret)
{
    if (b->count == b->room || y != b->y0 + b->count) {
        tc_status status = flush(b);
        if (status)
            return status;
        b->y0 = y;
    }
    *row_ret = b->z + b->count++ * b->of->width;
    return TC_OK;
}

/* ---- Pull ---------------------------------------------------------------------------------------------------- */

/* Weighted sums of the valid samples along a row, and the weights. */
typedef struct sums {
    float *sum, *weight;
} sums;

static inline float or_zero(float z)
{
    return isnan(z) ? 0 : z;
}
static inline float is_valid(float z)
{
    return isnan(z) ? 0 : 1;
}

/* Whether the row holds a void; widens the range of valid samples. */
static bool scan_row(fill *f, const float *z, int64_t width)
{
    float low = f->low, high = f->high;
    int voids = 0;
    for (int64_t x = 0; x < width; x++) { /* comparisons with NaN are false */
        low = z[x] < low ? z[x] : low;
        high = z[x] > high ? z[x] : high;
        voids |= isnan(z[x]) != 0;
    }
    f->low = low, f->high = high;
    return voids;
}

static void sum_row(const float *z, int64_t width, sums s)
{
    int64_t cw = tc_coarse_size(width);
    for (int64_t i = 1; i < cw - 1; i++) {
        const float *c = z + 2 * i;
        s.sum[i] = (or_zero(c[-1]) + or_zero(c[1])) + 2 * or_zero(c[0]);
        s.weight[i] = (is_valid(c[-1]) + is_valid(c[1])) + 2 * is_valid(c[0]);
    }
    for (int64_t i = 0; i<cw; i += cw> 1 ? cw - 1 : 1) { /* the ends */
        float west = 2 * i > 0 ? z[2 * i - 1] : NAN, east = 2 * i + 1 < width ? z[2 * i + 1] : NAN;
        s.sum[i] = (or_zero(west) + or_zero(east)) + 2 * or_zero(z[2 * i]);
        s.weight[i] = (is_valid(west) + is_valid(east)) + 2 * is_valid(z[2 * i]);
    }
}

/* Whether the coarse row got a void. */
static bool mean_row(sums south, sums at, sums north, int64_t cw, float *z)
{
    int voids = 0;
    for (int64_t i = 0; i < cw; i++) {
        float weight = (south.weight[i] + north.weight[i]) + 2 * at.weight[i];
        z[i] = ((south.sum[i] + north.sum[i]) + 2 * at.sum[i]) / weight; /* 0 / 0 is NaN */
        voids |= weight == 0;
    }
    return voids;
}

/* Makes level k + 1 from level k, whose has_voids it fills in where k is 0. */
static tc_status pull_rows(fill *f, int k, block *in, block *out, const sums row[3])
{
    level *fine = &f->levels[k], *coarse = &f->levels[k + 1];
    int64_t width = fine->rows.width, height = fine->rows.height, cw = coarse->rows.width;
    for (int64_t j = 0; j < coarse->rows.height; j++) {
        /* Row 2j - 1 is still there from the coarse row before. */
        sums south = row[j % 2 ? 2 : 0], at = row[1], north = row[j % 2 ? 0 : 2];
        if (j == 0)
            memset(south.sum, 0, (size_t)cw * sizeof(float)), memset(south.weight, 0, (size_t)cw * sizeof(float));
        for (int64_t y = 2 * j; y < 2 * j + 2; y++) {
            sums s = y % 2 ? north : at;
            if (y == height) {
                memset(s.sum, 0, (size_t)cw * sizeof(float)), memset(s.weight, 0, (size_t)cw * sizeof(float));
                continue;
            }
            const float *z;
            tc_status status = fetch(in, y, 1, height, &z);
            if (status)
                return status;
            sum_row(z, width, s);
            if (k == 0 && (fine->has_voids[y] = scan_row(f, z, width)))
                fine->voids = true;
        }
        float *z;
        tc_status status = append(out, j, &z);
        if (status)
            return status;
        if ((coarse->has_voids[j] = mean_row(south, at, north, cw, z)))
            coarse->voids = true;
    }
    return flush(out);
}

static tc_status pull_level(fill *f, int k, tc_fill_scratch scratch, void *scratch_context)
{
    level *fine = &f->levels[k], *coarse = &f->levels[k + 1];
    int64_t cw = tc_coarse_size(fine->rows.width), ch = tc_coarse_size(fine->rows.height);
    tc_status status = scratch(scratch_context, cw, ch, &coarse->rows);
    if (status)
        return status;
    coarse->rows.width = cw, coarse->rows.height = ch;
    f->count = k + 2;
    coarse->has_voids = calloc((size_t)ch, 1);
    block in = {0}, out = {0};
    float *memory = malloc((size_t)(6 * cw) * sizeof *memory);
    status = TC_ERR_MEMORY;
    if (coarse->has_voids && memory && open_block(&in, f, &fine->rows) && open_block(&out, f, &coarse->rows)) {
        const sums row[3] = {
            {memory, memory + cw}, {memory + 2 * cw, memory + 3 * cw}, {memory + 4 * cw, memory + 5 * cw}};
        status = pull_rows(f, k, &in, &out, row);
    }
    free(in.z), free(out.z), free(memory);
    return status;
}

/* ---- Top ----------------------------------------------------------------------------------------------------- */

/* Fills a level in memory. */
static tc_status fill_level(const level *l)
{
    int64_t width = l->rows.width, height = l->rows.height, count = width * height;
    float *z = malloc((size_t)count * sizeof *z);
    uint8_t *voids = malloc((size_t)count);
    tc_status status = z && voids ? l->rows.read(l->rows.context, 0, height, z) : TC_ERR_MEMORY;
    if (status == TC_OK) {
        for (int64_t i = 0; i < count; i++)
            voids[i] = isnan(z[i]) != 0;
        status = tc_fill_voids(z, voids, width, height);
    }
    for (int64_t y = 0; y < height && status == TC_OK;) { /* runs of rows that were changed */
        int64_t start = y;
        while (y < height && memchr(voids + y * width, 1, (size_t)width))
            y++;
        if (y > start)
            status = l->rows.write(l->rows.context, start, y - start, z + start * width);
        else
            y++;
    }
    free(z), free(voids);
    return status;
}

/* ---- Push ---------------------------------------------------------------------------------------------------- */

/* Rows of a level in different states of relaxation; row y is at y % RING. */
typedef struct ring {
    int64_t width;
    float *z[RING];
    span *spans[RING];
    int64_t count[RING];
} ring;

static inline int slot(int64_t y)
{
    return (int)(y % RING);
}

/* Puts row y in the ring, its voids set to what the coarse rows say. coarse[1] is the row north of coarse[0], or the
 * same one. */
static void enter_row(ring *r, int64_t y, const float *z, const float *const coarse[2], int64_t cw)
{
    float *to = r->z[slot(y)];
    span *spans = r->spans[slot(y)];
    int64_t count = 0;
    memcpy(to, z, (size_t)r->width * sizeof *to);
    for (int64_t x = 0; x < r->width;) {
        while (x < r->width && !isnan(z[x]))
            x++;
        int64_t start = x;
        for (; x < r->width && isnan(z[x]); x++) {
            int64_t i = x / 2, e = x % 2 ? tc_min64(i + 1, cw - 1) : i;
            to[x] = 0.25f * ((coarse[0][i] + coarse[1][i]) + (coarse[0][e] + coarse[1][e]));
        }
        if (x > start)
            spans[count++] = (span){(int32_t)start, (int32_t)x};
    }
    r->count[slot(y)] = count;
}

/* Sets every other void of row y to the mean of its neighbours, those with (x + y) % 2 == colour. */
static void relax_row(ring *r, int64_t y, int64_t height, int colour)
{
    int s = slot(y);
    float *z = r->z[s];
    const float *south = y > 0 ? r->z[slot(y - 1)] : NULL, *north = y + 1 < height ? r->z[slot(y + 1)] : NULL;
    for (int64_t n = 0; n < r->count[s]; n++) {
        int64_t x = r->spans[s][n].x0, end = r->spans[s][n].x1;
        bool inner = south && north && x > 0 && end < r->width;
        x += (x ^ y ^ colour) & 1;
        for (; inner && x < end; x += 2)
            z[x] = 0.25f * ((north[x] + south[x]) + (z[x - 1] + z[x + 1]));
        for (; x < end; x += 2) {
            float sum = 0;
            int sides = 0;
            if (x > 0)
                sum += z[x - 1], sides++;
            if (x + 1 < r->width)
                sum += z[x + 1], sides++;
            if (south)
                sum += south[x], sides++;
            if (north)
                sum += north[x], sides++;
            z[x] = sides ? sum / (float)sides : z[x];
        }
    }
}

/* Gives row y to the output. Means can overstep the range by rounding. */
static tc_status leave_row(const fill *f, ring *r, int64_t y, block *out)
{
    int s = slot(y);
    for (int64_t n = 0; n < r->count[s]; n++)
        for (float *z = r->z[s] + r->spans[s][n].x0, *end = r->z[s] + r->spans[s][n].x1; z < end; z++)
            *z = *z < f->low ? f->low : *z > f->high ? f->high : *z;
    float *row;
    tc_status status = append(out, y, &row);
    if (status == TC_OK)
        memcpy(row, r->z[s], (size_t)r->width * sizeof *row);
    return status;
}

/* Fills rows y0 <= y < y1 of level k, all of which have voids while those before and after have none. */
static tc_status push_run(const fill *f, int k, int64_t y0, int64_t y1, ring *r, block *in, block *coarse, block *out)
{
    const level *fine = &f->levels[k];
    int64_t height = fine->rows.height, cw = coarse->of->width, last_coarse = coarse->of->height - 1;
    for (int64_t y = tc_max64(y0 - 1, 0); y < y1 + HALF_SWEEPS; y++) {
        if (y <= y1 && y < height) {
            const float *z, *from[2];
            tc_status status = fetch(in, y, 1, y1 + 1, &z);
            if (status == TC_OK) {
                int64_t j = y / 2, rows = y % 2 && j < last_coarse ? 2 : 1;
                status = fetch(coarse, j, rows, tc_min64(y1 / 2, last_coarse) + 1, &from[0]);
                from[1] = from[0] + (rows - 1) * cw;
            }
            if (status)
                return status;
            enter_row(r, y, z, from, cw);
        }
        for (int s = 0; s < HALF_SWEEPS; s++) {
            int64_t behind = y - 1 - s;
            if (behind >= y0 && behind < y1)
                relax_row(r, behind, height, s & 1);
        }
        int64_t done = y - HALF_SWEEPS;
        if (done >= y0) {
            tc_status status = leave_row(f, r, done, out);
            if (status)
                return status;
        }
    }
    return TC_OK;
}

static tc_status push_level(const fill *f, int k)
{
    const level *l = &f->levels[k];
    int64_t width = l->rows.width, height = l->rows.height, most = width / 2 + 1; /* spans of a row */
    ring r = {.width = width};
    block in = {0}, coarse = {0}, out = {0};
    float *z = malloc((size_t)(RING * width) * sizeof *z);
    span *spans = malloc((size_t)(RING * most) * sizeof *spans);
    tc_status status = TC_ERR_MEMORY;
    if (z && spans && open_block(&in, f, &l->rows) && open_block(&coarse, f, &f->levels[k + 1].rows) &&
        open_block(&out, f, &l->rows))
        status = TC_OK;
    for (int n = 0; n < RING && status == TC_OK; n++)
        r.z[n] = z + n * width, r.spans[n] = spans + n * most;
    for (int64_t y = 0; y < height && status == TC_OK;) {
        while (y < height && !l->has_voids[y])
            y++;
        int64_t start = y;
        while (y < height && l->has_voids[y])
            y++;
        if (y > start)
            status = push_run(f, k, start, y, &r, &in, &coarse, &out);
    }
    if (status == TC_OK)
        status = flush(&out);
    free(z), free(spans), free(in.z), free(coarse.z), free(out.z);
    return status;
}

/* ---- All together -------------------------------------------------------------------------------------------- */

static tc_status run(fill *f, tc_fill_scratch scratch, void *scratch_context)
{
    int k = 0;
    bool voids = true; /* level 0 will tell */
    while (voids && f->levels[k].rows.height > f->memory_samples / f->levels[k].rows.width) {
        tc_status status = pull_level(f, k, scratch, scratch_context);
        if (status)
            return status;
        if (!f->levels[0].voids)
            return TC_OK;
        voids = f->levels[++k].voids;
    }
    tc_status status = voids ? fill_level(&f->levels[k]) : TC_OK;
    while (status == TC_OK && --k >= 0)
        status = push_level(f, k);
    return status;
}

tc_status tc_fill_void_rows(const tc_fill_rows *rows, tc_fill_scratch scratch, void *scratch_context,
                            const tc_fill_options *options)
{
    if (rows->width < 1 || rows->height < 1 || rows->width > INT32_MAX || rows->height > INT32_MAX)
        return TC_ERR_USAGE;
    fill f = {.count = 1, .low = INFINITY, .high = -INFINITY};
    f.memory_samples = options && options->memory_samples > 0 ? options->memory_samples : 4 << 20;
    f.block_rows = options ? options->block_rows : 0;
    f.levels[0].rows = *rows;
    f.levels[0].has_voids = calloc((size_t)rows->height, 1);
    tc_status status = f.levels[0].has_voids ? run(&f, scratch, scratch_context) : TC_ERR_MEMORY;
    for (int k = 0; k < f.count; k++)
        free(f.levels[k].has_voids);
    return status;
}
