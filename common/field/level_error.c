/* level_error.c - finest samples against a coarser mesh, row by row. */
#include "level_error.h"

#include <math.h>
#include <string.h>

#include "common/base/rect.h"

/* Row j of the coarse level and one more sample; beyond the last row it goes on in a straight line. */
static void coarse_row(const tc_level_pair *p, int64_t j, float *row)
{
    const int64_t w = p->coarse.width, last = p->coarse.height - 1;
    const float *z = p->mesh + tc_min64(j, last) * w, *before = last > 0 ? z - w : z;
    for (int64_t i = 0; i < w; i++)
        row[i] = j > last ? 2 * z[i] - before[i] : z[i];
    row[w] = p->wraps ? row[0] : w > 1 ? 2 * row[w - 1] - row[w - 2] : row[w - 1];
}

/* A cell's samples of a row, `count` of them from its west side on, against its two triangles: heights go evenly from
 * `west` to the diagonal after `kink` samples, and on to `east`. */
static float cell_error(const float *z, int64_t count, float west, float diagonal, float east, int64_t kink,
                        int64_t cell)
{
    const float to = kink > 0 ? (diagonal - west) / (float)kink : 0,
                on = kink < cell ? (east - diagonal) / (float)(cell - kink) : 0;
    const int64_t first = tc_min64(kink, count);
    float most = 0;
    for (int64_t i = 0; i < first; i++) {
        const float off = fabsf(z[i] - (west + (float)i * to));
        most = off > most ? off : most;
    }
    for (int64_t i = kink; i < count; i++) {
        const float off = fabsf(z[i] - (diagonal + (float)(i - kink) * on));
        most = off > most ? off : most;
    }
    return most;
}

void tc_level_errors(const tc_level_pair *p, int tile, int64_t j0, int64_t j1, float *errors, float *scratch)
{
    const int64_t width = p->fine.width, cell = (int64_t)1 << p->shift;
    float *south = scratch, *north = scratch + p->coarse.width + 1;
    memset(errors, 0, (size_t)tc_ceil_shift(width, tile) * sizeof *errors);
    for (int64_t j = j0, rows = -1; j < j1; j++) {
        const int64_t row = j >> p->shift, up = j - (row << p->shift);
        const float t = (float)up / (float)cell;
        if (row != rows)
            coarse_row(p, row, south), coarse_row(p, row + 1, north);
        rows = row;
        for (int64_t x = 0, c = 0; x < width; x += cell, c++) {
            const float error =
                cell_error(p->z + j * width + x, tc_min64(cell, width - x), south[c] + t * (north[c] - south[c]),
                           south[c + 1] + t * (north[c] - south[c + 1]),
                           south[c + 1] + t * (north[c + 1] - south[c + 1]), cell - up, cell);
            errors[x >> tile] = error > errors[x >> tile] ? error : errors[x >> tile];
        }
    }
}
