/* synthesis_pair.c - samples of two neighbouring levels of a terrain, to learn from. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/same_math.h"
#include "common/field/filter.h"
#include "synthesis_rehearsal.h"

enum {
    REACH = TC_PAIR_REACH,
    LIFT = TC_PAIR_LIFT,
    SIDE = TC_PAIR_SIDE + 2 * REACH,
    FINE = 2 * TC_PAIR_SIDE + 2 * LIFT
};

void tc_pair_free(tc_pair *p)
{
    free(p->cell);
    *p = (tc_pair){0};
}

/* Blocks of `side` cells within a level less `reach` around, at most TC_PAIR_BLOCKS, in an even scatter (the golden
 * ratio's lattice in the plane; Roberts 2018). */
static int choose_blocks(tc_level size, int64_t reach, tc_rect *block)
{
    int64_t w = size.width - 1 - 2 * reach, h = size.height - 1 - 2 * reach;
    if (w < 4 || h < 4)
        return 0;
    int64_t bw = tc_min64(w, TC_PAIR_SIDE), bh = tc_min64(h, TC_PAIR_SIDE);
    int64_t across = (w + bw - 1) / bw, all = across * ((h + bh - 1) / bh);
    int count = (int)tc_min64(all, TC_PAIR_BLOCKS);
    for (int n = 0; n < count; n++) {
        double u = fmod(0.5 + 0.7548776662466927 * n, 1), v = fmod(0.5 + 0.5698402909980532 * n, 1);
        if (all <= TC_PAIR_BLOCKS) { /* all of it, the last ones overlapping others */
            u = across > 1 ? (double)(n % across) / (double)(across - 1) : 0;
            v = all > across ? (double)(n / across) / (double)(all / across - 1) : 0;
        }
        int64_t x = reach + (int64_t)(u * (double)(w - bw) + 0.5), y = reach + (int64_t)(v * (double)(h - bh) + 0.5);
        block[n] = (tc_rect){x, y, x + bw, y + bh};
    }
    return count;
}

bool tc_near_void(const uint8_t *voids, int64_t stride)
{
    enum { NEAR = 3 };
    int any = 0;
    for (int64_t j = -NEAR; j <= NEAR + 1; j++)
        for (int64_t i = -NEAR; i <= NEAR + 1; i++)
            any |= voids[j * stride + i];
    return any != 0;
}

/* ---- True details ------------------------------------------------------------------------------------------------ */

/* low and high of `count` pairs from x[0] on, which reaches LIFT samples further both ways. */
static void lift(const float *x, ptrdiff_t step, int64_t count, float *low, float *high, ptrdiff_t out)
{
    float d[FINE];
    for (int64_t i = -2; i < count + 1; i++) {
        const float *p = x + (2 * i + 1) * step;
        d[i + 2] = p[0] - tc_predict(p[-3 * step], p[-step], p[step], p[3 * step]);
    }
    for (int64_t i = 0; i < count; i++) {
        low[i * out] = x[2 * i * step] + TC_UPDATE_NEAR * (d[i + 1] + d[i + 2]) + TC_UPDATE_FAR * (d[i] + d[i + 3]);
        high[i * out] = d[i + 2];
    }
}

void tc_true_details(const float *fine, int64_t w, int64_t h, float *const band[TC_DETAIL_BANDS], float *work)
{
    int64_t stride = 2 * w + 2 * LIFT, rows = 2 * h + 2 * LIFT;
    float *low = work, *high = low + w * rows, *unused = high + w * rows;
    for (int64_t y = 0; y < rows; y++)
        lift(fine + y * stride + LIFT, 1, w, low + y * w, high + y * w, 1);
    for (int64_t i = 0; i < w; i++) {
        lift(low + LIFT * w + i, w, h, unused, band[TC_HIGH_Y] + i, w);
        lift(high + LIFT * w + i, w, h, band[TC_HIGH_X] + i, band[TC_HIGH_XY] + i, w);
    }
}

/* ---- Reading ----------------------------------------------------------------------------------------------------- */

typedef struct buffers {
    float coarse[SIDE * SIDE], fine[FINE * FINE], work[3 * FINE * FINE], energy[SIDE * SIDE], slope[SIDE * SIDE];
    float band[TC_DETAIL_BANDS][TC_PAIR_SIDE * TC_PAIR_SIDE], scratch[TC_ENERGY_ROWS * TC_ROW_PITCH];
    uint8_t voids[FINE * FINE];
} buffers;

static bool is_flat(const float *z, ptrdiff_t s)
{
    return z[0] == z[1] && z[0] == z[s] && z[0] == z[s + 1] && z[0] == z[-1] && z[0] == z[-s];
}

/* A level's heights around a block with what is void, and their log2 E and log2 S. */
static tc_status read_block(const tc_field *field, int level, tc_rect block, float floor, buffers *b)
{
    const tc_synthesis_fit floors = {.energy_floor = floor, .slope_floor = TC_SLOPE_FLOOR};
    const tc_level size = tc_field_level(field, level);
    tc_rect around = tc_rect_grown(block, REACH);
    tc_patch patch = {b->coarse, around.x1 - around.x0, around};
    tc_status status = tc_field_read(field, level, around, b->coarse, b->voids, patch.stride);
    if (!status)
        tc_local_energy(&patch, &floors, (float)size.spacing_x, (float)size.spacing_y, block, b->energy, b->slope,
                        b->scratch);
    return status;
}

/* Whether cell (i, j) of a block that was read can be learned from. */
static bool is_useful(const buffers *b, int64_t w, int64_t i, int64_t j)
{
    int64_t stride = w + 2 * REACH, at = (j + REACH) * stride + i + REACH;
    return !is_flat(b->coarse + at, stride) && !tc_near_void(b->voids + at, stride);
}

/* Mean energy of a level over blocks. */
static tc_status mean_energy(const tc_field *field, int level, const tc_rect *block, int blocks, buffers *b,
                             double *mean_ret)
{
    double sum = 0, count = 0;
    for (int n = 0; n < blocks; n++) {
        int64_t w = block[n].x1 - block[n].x0;
        tc_status status = read_block(field, level, block[n], 1e-30f, b);
        if (status)
            return status;
        for (int64_t i = 0; i < tc_rect_area(block[n]); i++)
            if (is_useful(b, w, i % w, i / w))
                sum += tc_exp2(b->energy[i]), count++;
    }
    *mean_ret = sum / fmax(count, 1);
    return TC_OK;
}

/* Cells of a pair's blocks, with the details of the next finer level or without. */
static tc_status take_cells(const tc_field *field, bool with_detail, buffers *b, tc_pair *p)
{
    float *band[TC_DETAIL_BANDS] = {b->band[0], b->band[1], b->band[2]};
    for (int n = 0; n < p->blocks; n++) {
        tc_rect r = p->block[n], fine = tc_pair_fine(r);
        int64_t w = r.x1 - r.x0, h = r.y1 - r.y0;
        tc_status status = read_block(field, p->coarse, r, p->floor, b);
        if (!status && with_detail)
            status = tc_field_read(field, p->coarse + 1, fine, b->fine, NULL, fine.x1 - fine.x0);
        if (status)
            return status;
        if (with_detail)
            tc_true_details(b->fine, w, h, band, b->work);
        for (int64_t i = 0; i < w * h; i++) {
            if (!is_useful(b, w, i % w, i / w))
                continue;
            tc_pair_cell c = {b->energy[i], b->slope[i], 0};
            for (int k = 0; k < TC_DETAIL_BANDS && with_detail; k++)
                c.detail += band[k][i] * band[k][i];
            p->cell[p->cells++] = c, p->energy += c.detail;
        }
    }
    return TC_OK;
}

tc_status tc_pair_read(const tc_field *field, int coarse, float floor, tc_pair *p)
{
    const size_t most = (size_t)TC_PAIR_BLOCKS * TC_PAIR_SIDE * TC_PAIR_SIDE;
    double mean = 0;
    *p = (tc_pair){.coarse = coarse, .floor = floor};
    p->blocks = choose_blocks(tc_field_level(field, coarse), REACH, p->block);
    buffers *b = malloc(sizeof *b);
    p->cell = malloc(most * sizeof *p->cell);
    tc_status status = b && p->cell ? TC_OK : TC_ERR_MEMORY;
    if (!status && floor == 0) {
        status = mean_energy(field, coarse, p->block, p->blocks, b, &mean);
        p->floor = (float)fmax(1e-3 * mean, 1e-20);
    }
    if (!status)
        status = take_cells(field, coarse < tc_field_info(field)->levels, b, p);
    free(b);
    return status;
}
