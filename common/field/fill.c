/* fill.c - void filling: pull-push for a first surface, multigrid for a smooth one.
 *
 * The surface wanted is the solution of Laplace's equation over the voids, with the valid samples beside them as
 * boundary values and free (Neumann) sides at the edge of the raster: by the maximum principle it has no extremum
 * inside a void. Level 0 is the raster; a cell of level k + 1 covers 2 x 2 cells of level k. A cell is VOID where all
 * samples under it are, and DATA where it has a valid sample and lies at a void; all other cells are never touched, and
 * only spans (runs of VOID cells in a row) are visited, so that a few voids in a large raster cost next to nothing.
 *
 *   pull   means of the DATA cells, level by level, until no cell is VOID any more;
 *   push   back down: bilinear interpolation from the coarser level, then Gauss-Seidel relaxation;
 *   cycle  V-cycles of the correction scheme until the surface moves no more. A coarse DATA cell holds correction 0:
 * the coarse domain is never larger than the fine one, so that the correction errs towards too little.
 *
 * Why DATA is enough: a cell at a VOID cell lies over samples that are void or beside a void, so it has been reached
 * from the level below, where it was VOID or DATA (by induction), and each of its own values comes from those. */
#include "fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LEVELS = 34, SMOOTH_PUSH = 4, SMOOTH_CYCLE = 2, SMOOTH_COARSEST = 24, MAX_CYCLES = 12 };

enum { UNTOUCHED = 0, DATA, VOID };

/* Cells x0 <= x < x1 of row y, all VOID. */
typedef struct span {
    int32_t y, x0, x1;
} span;

typedef struct level {
    int64_t width, height;
    span *spans; /* in order of rows, then columns */
    int64_t count, room;
    uint8_t *state; /* NULL at level 0, where the void mask serves */
    float *u;       /* surface, later correction */
    float *b;       /* right-hand side of the correction; NULL at level 0, where it is 0 */
} level;

typedef struct fill {
    const uint8_t *voids;
    level levels[MAX_LEVELS];
    int count;
    float low, high; /* of the valid samples beside voids */
} fill;

static int cell_state(const fill *f, int k, int64_t i)
{
    if (k > 0)
        return f->levels[k].state[i];
    return f->voids[i] ? VOID : DATA;
}

static bool add_span(level *l, int64_t y, int64_t x0, int64_t x1)
{
    if (l->count == l->room) {
        int64_t room = l->room ? 2 * l->room : 256;
        span *grown = realloc(l->spans, (size_t)room * sizeof *grown);
        if (!grown)
            return false;
        l->spans = grown;
        l->room = room;
    }
    l->spans[l->count++] = (span){(int32_t)y, (int32_t)x0, (int32_t)x1};
    return true;
}

/* Runs of cells of row y, between columns from and to, that test as VOID. */
static bool add_row_spans(fill *f, int k, int64_t y, int64_t from, int64_t to)
{
    level *l = &f->levels[k];
    for (int64_t x = from; x < to;) {
        while (x < to && cell_state(f, k, y * l->width + x) != VOID)
            x++;
        int64_t start = x;
        while (x < to && cell_state(f, k, y * l->width + x) == VOID)
            x++;
        if (x > start && !add_span(l, y, start, x))
            return false;
    }
    return true;
}

/* Spans of the raster itself: the one pass over all samples, so rows without voids must be skipped fast. */
static bool find_voids(fill *f)
{
    level *l = &f->levels[0];
    for (int64_t y = 0; y < l->height; y++) {
        const uint8_t *row = f->voids + y * l->width;
        for (int64_t x = 0; x < l->width;) {
            uint64_t word[4];
            if (x + (int64_t)sizeof word <= l->width) {
                memcpy(word, row + x, sizeof word);
                if (!(word[0] | word[1] | word[2] | word[3])) {
                    x += (int64_t)sizeof word;
                    continue;
                }
            }
            while (x < l->width && !row[x])
                x++;
            int64_t start = x;
            while (x < l->width && row[x])
                x++;
            if (x > start && !add_span(l, y, start, x))
                return false;
        }
    }
    return true;
}

/* ---- Pull ------------------------------------------------------------------------------------------------------- */

/* Sets state and mean of cell (x, y) of level k from its children. */
static void pull_cell(fill *f, int k, int64_t x, int64_t y)
{
    level *fine = &f->levels[k - 1], *coarse = &f->levels[k];
    int64_t cell = y * coarse->width + x;
    if (coarse->state[cell] != UNTOUCHED)
        return;
    float sum = 0;
    int data = 0;
    for (int64_t j = 2 * y; j < 2 * y + 2 && j < fine->height; j++) {
        for (int64_t i = 2 * x; i < 2 * x + 2 && i < fine->width; i++) {
            int64_t child = j * fine->width + i;
            if (cell_state(f, k - 1, child) != DATA)
                continue;
            sum += fine->u[child];
            data++;
            if (k == 1) {
                f->low = fminf(f->low, fine->u[child]);
                f->high = fmaxf(f->high, fine->u[child]);
            }
        }
    }
    coarse->state[cell] = data ? DATA : VOID;
    coarse->u[cell] = data ? sum / (float)data : 0;
}

/* Makes level k from level k - 1: the parents of its VOID cells and of all cells around them. */
static bool pull_level(fill *f, int k)
{
    level *fine = &f->levels[k - 1], *coarse = &f->levels[k];
    coarse->width = (fine->width + 1) / 2;
    coarse->height = (fine->height + 1) / 2;
    size_t cells = (size_t)coarse->width * (size_t)coarse->height;
    coarse->state = calloc(cells, sizeof *coarse->state); /* pages that are not touched cost nothing */
    coarse->u = calloc(cells, sizeof *coarse->u);
    if (!coarse->state || !coarse->u)
        return false;
    for (int64_t s = 0; s < fine->count; s++) {
        span run = fine->spans[s];
        int64_t x0 = run.x0 > 0 ? (run.x0 - 1) / 2 : 0;
        int64_t x1 = (run.x1 < fine->width ? run.x1 : run.x1 - 1) / 2;
        int64_t y0 = run.y > 0 ? (run.y - 1) / 2 : 0;
        int64_t y1 = (run.y + 1 < fine->height ? run.y + 1 : run.y) / 2;
        for (int64_t y = y0; y <= y1; y++)
            for (int64_t x = x0; x <= x1; x++)
                pull_cell(f, k, x, y);
    }
    /* A VOID cell's first child is void, in an even row, and begins or lies in a span. */
    for (int64_t s = 0; s < fine->count; s++) {
        span run = fine->spans[s];
        if (run.y % 2 == 0 && !add_row_spans(f, k, run.y / 2, (run.x0 + 1) / 2, (run.x1 + 1) / 2))
            return false;
    }
    return true;
}

/* ---- Push and cycle --------------------------------------------------------------------------------------------- */

/* Bilinear value of the coarse level at the centre of fine cell (x, y). As a surface: untouched cells have
 * no value and are left out of the mean; as a correction they count, with 0. */
static float interpolate(const level *coarse, int64_t x, int64_t y, bool surface)
{
    int64_t cx = x / 2, cy = y / 2, nx = cx + (x % 2 ? 1 : -1), ny = cy + (y % 2 ? 1 : -1);
    if (nx < 0 || nx >= coarse->width)
        nx = cx;
    if (ny < 0 || ny >= coarse->height)
        ny = cy;
    const int64_t cells[4] = {cy * coarse->width + cx, cy * coarse->width + nx, ny * coarse->width + cx,
                              ny * coarse->width + nx};
    static const float weights[4] = {9, 3, 3, 1};
    float sum = 0, weight = 0;
    for (int c = 0; c < 4; c++) {
        if (surface && coarse->state[cells[c]] == UNTOUCHED)
            continue;
        sum += weights[c] * coarse->u[cells[c]];
        weight += weights[c];
    }
    return sum / weight;
}

static void push_level(level *fine, const level *coarse)
{
    for (int64_t s = 0; s < fine->count; s++) {
        span run = fine->spans[s];
        for (int64_t x = run.x0; x < run.x1; x++)
            fine->u[run.y * fine->width + x] = interpolate(coarse, x, run.y, true);
    }
}

/* What cell x of the row at u would have to be, given its neighbours. up and down are the distances of the rows above
 * and below, 0 at the edge of the raster. */
static inline float relaxed(const float *u, float b, int64_t x, int64_t width, int64_t up, int64_t down)
{
    float sum = b;
    int sides = 0;
    if (x > 0)
        sum += u[x - 1], sides++;
    if (x + 1 < width)
        sum += u[x + 1], sides++;
    if (up)
        sum += u[x + up], sides++;
    if (down)
        sum += u[x - down], sides++;
    return sides ? sum / (float)sides : u[x];
}

/* Relaxes every other cell, those with (x + y) % 2 == colour; the largest change where measured is asked for. */
static inline float relax_colour(level *l, int colour, bool measured)
{
    float largest = 0;
    int64_t width = l->width;
    for (int64_t n = 0; n < l->count; n++) {
        span run = l->spans[n];
        float *u = l->u + run.y * width;
        const float *b = l->b ? l->b + run.y * width : NULL;
        int64_t up = run.y + 1 < l->height ? width : 0, down = run.y > 0 ? width : 0;
        bool inner = up && down && run.x0 > 0 && run.x1 < width;
        for (int64_t x = run.x0 + ((run.x0 ^ run.y ^ colour) & 1); x < run.x1; x += 2) {
            float right_side = b ? b[x] : 0;
            float v = inner ? 0.25f * ((right_side + u[x + width] + u[x - width]) + (u[x - 1] + u[x + 1]))
                            : relaxed(u, right_side, x, width, up, down);
            if (measured)
                largest = fabsf(v - u[x]) > largest ? fabsf(v - u[x]) : largest;
            u[x] = v;
        }
    }
    return largest;
}

/* One red-black Gauss-Seidel sweep; first is the colour that comes first. */
static void sweep(level *l, int first)
{
    relax_colour(l, first, false);
    relax_colour(l, !first, false);
}

/* Sweeps until nothing moves by more than enough. */
static float settle(level *l, float enough)
{
    float change = INFINITY;
    for (int n = 0; n < SMOOTH_COARSEST && change > enough; n++) {
        change = relax_colour(l, 0, true);
        change = fmaxf(change, relax_colour(l, 1, true));
    }
    return change;
}

/* Right-hand side of the coarser level: over each of its VOID cells the sum of the children's residuals (the coarse
 * spacing is twice the fine one, so its equations weigh four times as much as the mean). */
static void restrict_residual(const level *fine, level *coarse)
{
    for (int64_t s = 0; s < coarse->count; s++) {
        span run = coarse->spans[s];
        for (int64_t x = run.x0; x < run.x1; x++) {
            float sum = 0;
            for (int64_t j = 2 * run.y; j < 2 * (int64_t)run.y + 2 && j < fine->height; j++) {
                const float *u = fine->u + j * fine->width;
                int64_t up = j + 1 < fine->height ? fine->width : 0, down = j > 0 ? fine->width : 0;
                for (int64_t i = 2 * x; i < 2 * x + 2 && i < fine->width; i++) {
                    float b = fine->b ? fine->b[j * fine->width + i] : 0;
                    int sides = (i > 0) + (i + 1 < fine->width) + (up != 0) + (down != 0);
                    sum += (float)sides * (relaxed(u, b, i, fine->width, up, down) - u[i]);
                }
            }
            coarse->b[run.y * coarse->width + x] = sum;
            coarse->u[run.y * coarse->width + x] = 0;
        }
    }
}

/* Adds the coarser level's correction; the largest one. */
static float correct(level *fine, const level *coarse)
{
    float largest = 0;
    for (int64_t s = 0; s < fine->count; s++) {
        span run = fine->spans[s];
        for (int64_t x = run.x0; x < run.x1; x++) {
            float correction = interpolate(coarse, x, run.y, false);
            largest = fabsf(correction) > largest ? fabsf(correction) : largest;
            fine->u[run.y * fine->width + x] += correction;
        }
    }
    return largest;
}

/* One V-cycle; how far it moved the surface. The correction tells, not the sweeps: what is still wrong is smooth, and
 * a sweep hardly moves that. */
static float v_cycle(fill *f, float enough)
{
    int coarsest = f->count - 1;
    for (int k = 0; k < coarsest; k++) {
        for (int n = 0; n < SMOOTH_CYCLE; n++)
            sweep(&f->levels[k], 0);
        restrict_residual(&f->levels[k], &f->levels[k + 1]);
    }
    float moved = settle(&f->levels[coarsest], 0.01f * enough);
    for (int k = coarsest - 1; k >= 0; k--) {
        moved = correct(&f->levels[k], &f->levels[k + 1]);
        for (int n = 0; n < SMOOTH_CYCLE; n++)
            sweep(&f->levels[k], 1);
    }
    return moved;
}

/* ---- All together ----------------------------------------------------------------------------------------------- */

static tc_status run_fill(fill *f)
{
    if (!find_voids(f))
        return TC_ERR_MEMORY;
    if (f->levels[0].count == 0)
        return TC_OK;
    int k = 0;
    while (f->levels[k].count > 0) {
        if (f->levels[k].width == 1 && f->levels[k].height == 1)
            return TC_ERR_USAGE; /* one cell, and it is VOID: all are */
        if (!pull_level(f, ++k))
            return TC_ERR_MEMORY;
    }

    for (int n = k - 1; n >= 0; n--) {
        push_level(&f->levels[n], &f->levels[n + 1]);
        for (int s = 0; s < SMOOTH_PUSH; s++)
            sweep(&f->levels[n], s % 2);
    }

    /* From here on only levels with VOID cells take part, and their surface makes room for the correction: fresh
     * memory, so that DATA cells hold 0. */
    f->count = k;
    for (int n = 1; n <= k; n++) {
        level *l = &f->levels[n];
        free(l->u);
        size_t cells = (size_t)l->width * (size_t)l->height;
        l->u = n < k ? calloc(cells, sizeof *l->u) : NULL;
        l->b = n < k ? calloc(cells, sizeof *l->b) : NULL;
        if (n < k && (!l->u || !l->b))
            return TC_ERR_MEMORY;
    }
    float enough = 2e-5f * (f->high - f->low);
    for (int n = 0; n < MAX_CYCLES && v_cycle(f, enough) > enough; n++)
        ;

    /* Rounding and a correction just before the last sweeps could overstep the range by a hair. */
    level *l = &f->levels[0];
    for (int64_t s = 0; s < l->count; s++) {
        span run = l->spans[s];
        for (float *u = l->u + run.y * l->width + run.x0, *end = u + (run.x1 - run.x0); u < end; u++)
            *u = *u < f->low ? f->low : *u > f->high ? f->high : *u;
    }
    return TC_OK;
}

tc_status tc_fill_voids(float *z, const uint8_t *voids, int64_t width, int64_t height)
{
    if (width < 1 || height < 1 || width > INT32_MAX || height > INT32_MAX)
        return TC_ERR_USAGE;
    fill f = {.voids = voids, .low = INFINITY, .high = -INFINITY};
    f.levels[0] = (level){.width = width, .height = height, .u = z};
    tc_status status = run_fill(&f);
    for (int k = 0; k < MAX_LEVELS; k++) {
        free(f.levels[k].spans);
        if (k == 0)
            continue;
        free(f.levels[k].state);
        free(f.levels[k].u);
        free(f.levels[k].b);
    }
    return status;
}
