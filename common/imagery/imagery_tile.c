/* imagery_tile.c - a tile of colours: for each texel the pixels of the area that it stands for, in linear light.
 *
 * A tile is made in blocks of 32 x 32 texels. Pixels of texels are found exactly on a lattice of every eighth one and,
 * where the middle of a cell is where its corners say, in between by them; elsewhere (poles, the sides of a map in
 * longitude and latitude, the edge of a projection) one by one. How far it is from texel to texel along either axis
 * says which level of the picture is read and over how many of its pixels, at most 1,024 along the longer axis,
 * bilinear ones are averaged: one a pixel, at most 64 along either axis (Heckbert 1989's elliptical average by boxes).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/srgb.h"
#include "common/base/status.h"
#include "imagery_internal.h"

enum {
    BLOCK = 32,
    CELL = 8,
    CELLS = BLOCK / CELL,
    CORNERS = CELLS + 1,
    MOST_TAPS = 64,
    MOST_PIXELS = 1024,     /* along the longer axis */
    LARGEST_PIECE = 1 << 20 /* pixels read at once */
};
#define CLOSE 0.03 /* pixels of the level read, by which the middle of a cell may be beside what its corners say */

/* Where the texels of a block are in a picture, in pixels of its level 0. */
typedef struct found {
    double x[BLOCK * BLOCK], y[BLOCK * BLOCK];
} found;

/* The pixels that a texel stands for: along the longer and the shorter axis of its area. */
typedef struct steps {
    double longer[2], shorter[2];
} steps;

/* A cell of a block. */
typedef struct cell {
    steps steps;   /* in its middle */
    int level;     /* of the picture; -1: nothing of it is here */
    tc_rect needs; /* pixels of that level; columns may go beyond a picture that comes round again */
} cell;

/* What a block is made with; one for a tile. */
typedef struct workshop {
    found at;
    cell cell[CELLS * CELLS];
    bool exact[CELLS * CELLS];     /* cells whose texels were found one by one */
    float light[BLOCK * BLOCK][4]; /* linear, times alpha; alpha: all layers so far */
    uint8_t (*pixels)[4];
    size_t room; /* pixels of it */
    const tc_srgb *srgb;
} workshop;

typedef struct block {
    tc_colour_field *field;
    int level;
    int64_t x, y; /* first texel */
    int w, h;
} block;

/* ---- Finding ------------------------------------------------------------------------------------------------------
 */

/* Chart coordinates of texel (i, j) of a block. */
static void place_of(const block *b, double i, double j, double *x, double *y)
{
    int coarser = b->field->head.info.levels - b->level;
    *x = b->field->x0 + ldexp(((double)b->x + i) * b->field->dx, coarser);
    *y = b->field->y0 + ldexp(((double)b->y + j) * b->field->dy, coarser);
}

/* The way from one pixel to another, the short way round. */
static double way(const tc_layer *layer, double from, double to)
{
    double d = to - from;
    return layer->period > 0 ? d - layer->period * rint(d / layer->period) : d;
}

/* Whether a cell's corners say where its inside is; fills it in then. c: x, y of corners and middle. */
static bool between(const tc_layer *layer, const double c[5][2], int ci, int cj, found *at)
{
    double x0 = c[0][0], ex = way(layer, x0, c[1][0]), sx = way(layer, x0, c[2][0]), bx = way(layer, x0, c[3][0]);
    double y0 = c[0][1], ey = c[1][1] - y0, sy = c[2][1] - y0, by = c[3][1] - y0;
    double mx = 0.25 * (ex + sx + bx), my = 0.25 * (ey + sy + by), size = hypot(ex, ey) + hypot(sx, sy);
    double off = hypot(way(layer, x0, c[4][0]) - mx, c[4][1] - y0 - my), step = fmax(1, size / (2 * CELL));
    if (!(off <= CLOSE * step))
        return false;
    for (int j = 0; j < CELL; j++)
        for (int i = 0; i < CELL; i++) {
            double u = (double)i / CELL, v = (double)j / CELL, both = u * v;
            int k = (cj * CELL + j) * BLOCK + ci * CELL + i;
            at->x[k] = x0 + u * ex + v * sx + both * (bx - ex - sx);
            at->y[k] = y0 + u * ey + v * sy + both * (by - ey - sy);
        }
    return true;
}

static void find_block(const block *b, tc_layer *layer, found *at, bool *exact)
{
    const tc_map *map = b->field->imagery->map;
    double x[CORNERS * CORNERS + CELLS * CELLS], y[CORNERS * CORNERS + CELLS * CELLS];
    int middle = CORNERS * CORNERS;
    for (int k = 0; k < middle; k++)
        place_of(b, k % CORNERS * CELL, k / CORNERS * CELL, &x[k], &y[k]);
    for (int k = 0; k < CELLS * CELLS; k++)
        place_of(b, (k % CELLS + 0.5) * CELL, (k / CELLS + 0.5) * CELL, &x[middle + k], &y[middle + k]);
    pthread_mutex_lock(&layer->mutex);
    tc_layer_find(map, layer, b->field->chart, middle + CELLS * CELLS, x, y);
    for (int cj = 0; cj < CELLS; cj++)
        for (int ci = 0; ci < CELLS; ci++) {
            int k = cj * CORNERS + ci, m = middle + cj * CELLS + ci;
            const double c[5][2] = {{x[k], y[k]},
                                    {x[k + 1], y[k + 1]},
                                    {x[k + CORNERS], y[k + CORNERS]},
                                    {x[k + CORNERS + 1], y[k + CORNERS + 1]},
                                    {x[m], y[m]}};
            exact[cj * CELLS + ci] = !between(layer, c, ci, cj, at);
            if (!exact[cj * CELLS + ci])
                continue;
            double cx[CELL * CELL], cy[CELL * CELL];
            for (int n = 0; n < CELL * CELL; n++)
                place_of(b, ci * CELL + n % CELL, cj * CELL + n / CELL, &cx[n], &cy[n]);
            tc_layer_find(map, layer, b->field->chart, CELL * CELL, cx, cy);
            for (int n = 0; n < CELL * CELL; n++) {
                int to = (cj * CELL + n / CELL) * BLOCK + ci * CELL + n % CELL;
                at->x[to] = cx[n], at->y[to] = cy[n];
            }
        }
    pthread_mutex_unlock(&layer->mutex);
}

/* ---- What of the picture is read ----------------------------------------------------------------------------------
 */

/* The way between two texels, where both have a place. */
static bool step_of(const tc_layer *layer, const found *at, int from, int to, double step[2])
{
    step[0] = way(layer, at->x[from], at->x[to]), step[1] = at->y[to] - at->y[from];
    return isfinite(step[0]) && isfinite(step[1]);
}

/* The shorter of the steps before and behind a texel: one of them may lead across where a projection is cut. */
static bool shorter_step(const tc_layer *layer, const found *at, int k, int apart, bool first, bool last,
                         double step[2])
{
    double before[2] = {0, 0}, behind[2] = {0, 0};
    bool has_before = !first && step_of(layer, at, k - apart, k, before);
    bool has_behind = !last && step_of(layer, at, k, k + apart, behind);
    bool take_before = has_before && (!has_behind || hypot(before[0], before[1]) < hypot(behind[0], behind[1]));
    memcpy(step, take_before ? before : behind, sizeof before);
    return has_before || has_behind;
}

/* Steps at texel k of a block, by its neighbours: what makes a circle of the ways to both an ellipse, by its axes. */
static bool steps_at(const tc_layer *layer, const found *at, int k, steps *s)
{
    double a[2] = {0, 0}, b[2] = {0, 0};
    if (!shorter_step(layer, at, k, 1, k % BLOCK == 0, k % BLOCK == BLOCK - 1, a) ||
        !shorter_step(layer, at, k, BLOCK, k / BLOCK == 0, k / BLOCK == BLOCK - 1, b))
        return false;
    double both = 2 * (a[0] * b[0] + a[1] * b[1]), more = a[0] * a[0] + a[1] * a[1] - b[0] * b[0] - b[1] * b[1];
    double angle = both == 0 && more == 0 ? 0 : 0.5 * atan2(both, more), c = cos(angle), d = sin(angle);
    for (int i = 0; i < 2; i++)
        s->longer[i] = c * a[i] + d * b[i], s->shorter[i] = c * b[i] - d * a[i];
    return true;
}

/* The level whose pixels are no larger than a texel along its shorter axis. */
static int level_for(const tc_layer *layer, const steps *s)
{
    double longer = hypot(s->longer[0], s->longer[1]), shorter = hypot(s->shorter[0], s->shorter[1]);
    int level = (int)floor(log2(fmax(fmax(shorter, longer / MOST_PIXELS), 1)));
    return level < layer->image->levels ? level : layer->image->levels - 1;
}

/* Texel n of a cell as one of its block. */
static int texel_of(int ci, int cj, int n)
{
    return (cj * CELL + n / CELL) * BLOCK + ci * CELL + n % CELL;
}

/* Columns or rows of a level, where they lie: the last one stands for what of the picture is left, and is as narrow as
 * that; where columns come round again, the first is next to it after the picture's period. */
typedef struct line {
    int64_t count;
    double last, period; /* its middle, and the way around, both in pixels of the level; period 0: none */
} line;

static line line_of(int64_t count, double span, double period, int level)
{
    const double scale = ldexp(1, -level), turn = period * scale;
    if (period > 0)
        count = tc_min64(count, (int64_t)ceil(turn - 1e-6));
    return (line){count, 0.5 * ((double)count - 1 + fmin((double)count, span * scale)), turn};
}

static line columns_of(const tc_layer *layer, int level)
{
    const tc_image *image = layer->image;
    return line_of(image->level[level].width, (double)image->level[0].width, layer->joined ? layer->period : 0, level);
}

static line rows_of(const tc_layer *layer, int level)
{
    const tc_image *image = layer->image;
    return line_of(image->level[level].height, (double)image->level[0].height, 0, level);
}

/* Between which pixels of a line x is, of the same unit as its period: their middles are at halves, all equally far
 * apart, and come round again after its count. */
static double among(const line *l, double x)
{
    const double before = (double)l->count - 1.5; /* the middle of the last but one */
    double round = 0;
    if (l->period > 0 && (x < 0.5 || x >= l->period + 0.5)) {
        double turns = floor((x - 0.5) / l->period);
        x -= turns * l->period, round = turns * (double)l->count;
    }
    if (x <= before || l->count == 1)
        return round + x;
    if (x < l->last || !(l->period > 0))
        return round + before + (x - before) / (l->last - before);
    return round + before + 1 + (x - l->last) / (l->period + 0.5 - l->last);
}

/* Pixels of a level from lo to hi, pixels of level 0. */
static tc_rect pixels_between(const tc_layer *layer, int level, const double lo[2], const double hi[2])
{
    const line columns = columns_of(layer, level), rows = rows_of(layer, level);
    const double scale = ldexp(1, -level);
    tc_rect r = {(int64_t)floor(among(&columns, lo[0] * scale) - 0.5),
                 (int64_t)floor(among(&rows, lo[1] * scale) - 0.5),
                 (int64_t)floor(among(&columns, hi[0] * scale) - 0.5) + 2,
                 (int64_t)floor(among(&rows, hi[1] * scale) - 0.5) + 2};
    if (layer->joined && r.x1 - r.x0 >= columns.count) /* all around */
        r.x0 = 0, r.x1 = columns.count;
    if (!layer->joined)
        r.x0 = tc_clamp64(r.x0, 0, columns.count - 1), r.x1 = tc_clamp64(r.x1, r.x0 + 1, columns.count);
    r.y0 = tc_clamp64(r.y0, 0, rows.count - 1);
    r.y1 = tc_clamp64(r.y1, r.y0 + 1, rows.count);
    return r;
}

static void survey_cell(const block *b, const tc_layer *layer, const found *at, int ci, int cj, cell *c)
{
    double first = NAN, lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    bool any = false, known = false;
    for (int n = 0; n < CELL * CELL && !known; n++)
        known = steps_at(layer, at, texel_of(ci, cj, n), &c->steps);
    c->level = layer->image->levels;
    for (int n = 0; n < CELL * CELL && known; n++) {
        const int k = texel_of(ci, cj, n);
        steps own;
        if (k % BLOCK >= b->w || k / BLOCK >= b->h || !isfinite(at->x[k]) || !isfinite(at->y[k]))
            continue;
        if (!steps_at(layer, at, k, &own)) /* at the edge of what there is */
            own = c->steps;
        if (n == CELL * CELL / 2 + CELL / 2)
            c->steps = own;
        first = isnan(first) ? at->x[k] : first;
        double x = first + way(layer, first, at->x[k]), y = at->y[k];
        double reach_x = 0.5 * (fabs(own.longer[0]) + fabs(own.shorter[0])),
               reach_y = 0.5 * (fabs(own.longer[1]) + fabs(own.shorter[1]));
        int level = level_for(layer, &own);
        c->level = level < c->level ? level : c->level;
        lo[0] = fmin(lo[0], x - reach_x), hi[0] = fmax(hi[0], x + reach_x);
        lo[1] = fmin(lo[1], y - reach_y), hi[1] = fmax(hi[1], y + reach_y);
        any |= tc_layer_holds(layer, at->x[k], at->y[k]);
    }
    if (!any) {
        c->level = -1;
        return;
    }
    c->needs = pixels_between(layer, c->level, lo, hi);
    while (tc_rect_area(c->needs) > LARGEST_PIECE && c->level + 1 < layer->image->levels) /* across a cut */
        c->needs = pixels_between(layer, ++c->level, lo, hi);
}

/* Pixels rect of a level, whose columns may go round. */
static tc_status read_round(tc_layer *layer, int level, tc_rect rect, workshop *w, tc_error *error)
{
    size_t pixels = (size_t)tc_rect_area(rect);
    if (pixels > w->room) {
        free(w->pixels);
        w->room = 0;
        if (!(w->pixels = malloc(pixels * sizeof *w->pixels)))
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for a part of it", layer->image->name);
        w->room = pixels;
    }
    int64_t width = columns_of(layer, level).count, stride = rect.x1 - rect.x0;
    tc_status status = TC_OK;
    pthread_mutex_lock(&layer->mutex);
    for (int64_t x = rect.x0, next; x < rect.x1 && status == TC_OK; x = next) {
        int64_t column = x % width + (x % width < 0 ? width : 0);
        next = tc_min64(rect.x1, x + width - column);
        status = layer->image->read(layer->image, level, (tc_rect){column, rect.y0, column + next - x, rect.y1},
                                    w->pixels + (x - rect.x0), stride, error);
    }
    pthread_mutex_unlock(&layer->mutex);
    return status;
}

/* ---- Colours ------------------------------------------------------------------------------------------------------
 */

/* Pixels that were read, and where from. */
typedef struct piece {
    const uint8_t (*pixels)[4];
    tc_rect rect;
    line columns, rows;
    bool around; /* all columns: the first is beside the last */
    const tc_srgb *srgb;
} piece;

/* Column of a piece. Beyond it, which is beyond the picture, its border goes on. */
static int64_t column_of(const piece *p, int64_t i)
{
    int64_t w = p->rect.x1 - p->rect.x0, at = i - p->rect.x0;
    return !p->around ? tc_clamp64(at, 0, w - 1) : at % w + (at % w < 0 ? w : 0);
}

/* Adds what is at (x, y), pixels of the piece's level, by `share`. */
static void add_bilinear(const piece *p, double x, double y, float share, float sum[4])
{
    x = among(&p->columns, x), y = among(&p->rows, y);
    double i = floor(x - 0.5), j = floor(y - 0.5);
    float u = (float)(x - 0.5 - i), v = (float)(y - 0.5 - j);
    int64_t w = p->rect.x1 - p->rect.x0, h = p->rect.y1 - p->rect.y0;
    int64_t c0 = column_of(p, (int64_t)i), c1 = column_of(p, (int64_t)i + 1);
    int64_t r0 = tc_clamp64((int64_t)j - p->rect.y0, 0, h - 1), r1 = tc_clamp64((int64_t)j + 1 - p->rect.y0, 0, h - 1);
    const uint8_t *q[4] = {p->pixels[r0 * w + c0], p->pixels[r0 * w + c1], p->pixels[r1 * w + c0],
                           p->pixels[r1 * w + c1]};
    const float weight[4] = {(1 - u) * (1 - v) * share, u * (1 - v) * share, (1 - u) * v * share, u * v * share};
    for (int k = 0; k < 4; k++) {
        float a = weight[k] * (float)q[k][3];
        sum[0] += a * p->srgb->linear[q[k][0]];
        sum[1] += a * p->srgb->linear[q[k][1]];
        sum[2] += a * p->srgb->linear[q[k][2]];
        sum[3] += a;
    }
}

static int taps(double pixels)
{
    return (int)fmin(fmax(ceil(pixels - 0.1), 1), MOST_TAPS);
}

/* The average over a texel, whose middle is at (x, y) of the piece's level. */
static void average(const piece *p, double x, double y, const steps *s, double scale, float sum[4])
{
    const double ax = s->longer[0] * scale, ay = s->longer[1] * scale;
    const double dx = s->shorter[0] * scale, dy = s->shorter[1] * scale;
    const int na = taps(hypot(ax, ay)), nd = taps(hypot(dx, dy));
    const float share = 1 / (255.0f * (float)(na * nd));
    memset(sum, 0, 4 * sizeof *sum);
    for (int t = 0; t < na * nd; t++) {
        double a = (t % na + 0.5) / na - 0.5, d = (t / na + 0.5) / nd - 0.5;
        add_bilinear(p, x + a * ax + d * dx, y + a * ay + d * dy, share, sum);
    }
}

/* The texels of a cell, over what is there. */
static void paint_cell(const block *b, const tc_layer *layer, int ci, int cj, const piece *p, workshop *w)
{
    const cell *c = &w->cell[cj * CELLS + ci];
    const double scale = ldexp(1, -c->level), count = (double)p->columns.count;
    for (int n = 0; n < CELL * CELL; n++) {
        const int k = texel_of(ci, cj, n);
        steps own;
        if (k % BLOCK >= b->w || k / BLOCK >= b->h || !tc_layer_holds(layer, w->at.x[k], w->at.y[k]))
            continue;
        if (!w->exact[cj * CELLS + ci] || !steps_at(layer, &w->at, k, &own))
            own = c->steps;
        double x = w->at.x[k] * scale, y = w->at.y[k] * scale;
        if (layer->joined) /* as the piece counts them */
            x -= p->columns.period * rint((among(&p->columns, x) - 0.5 * (double)(p->rect.x0 + p->rect.x1)) / count);
        float light[4];
        average(p, x, y, &own, scale, light);
        for (int q = 0; q < 4; q++)
            w->light[k][q] = light[q] + (1 - light[3]) * w->light[k][q];
    }
}

/* All cells that read one level: what they need is read at once where that is not too much. */
static tc_status paint(const block *b, tc_layer *layer, int level, workshop *w, tc_error *error)
{
    tc_rect all = {0, 0, 0, 0};
    for (int k = 0; k < CELLS * CELLS; k++)
        if (w->cell[k].level == level)
            all = tc_rect_around(all, w->cell[k].needs);
    const line columns = columns_of(layer, level), rows = rows_of(layer, level);
    if (layer->joined && all.x1 - all.x0 > columns.count)
        all.x0 = 0, all.x1 = columns.count;
    bool at_once = tc_rect_area(all) <= LARGEST_PIECE;
    tc_status status = at_once ? read_round(layer, level, all, w, error) : TC_OK;
    for (int k = 0; k < CELLS * CELLS && status == TC_OK; k++) {
        const cell *c = &w->cell[k];
        if (c->level != level)
            continue;
        if (!at_once)
            status = read_round(layer, level, c->needs, w, error);
        const tc_rect read = at_once ? all : c->needs;
        const piece p = {(const uint8_t(*)[4])w->pixels,
                         read,
                         columns,
                         rows,
                         layer->joined && read.x1 - read.x0 == columns.count,
                         w->srgb};
        if (status == TC_OK)
            paint_cell(b, layer, k % CELLS, k / CELLS, &p, w);
    }
    return status;
}

static void store(const block *b, const workshop *w, uint8_t (*texels)[4], ptrdiff_t stride)
{
    for (int j = 0; j < b->h; j++)
        for (int i = 0; i < b->w; i++) {
            const float *light = w->light[j * BLOCK + i];
            uint8_t *to = texels[j * stride + i];
            for (int q = 0; q < 3; q++)
                to[q] = tc_srgb_shown(w->srgb, sqrtf(fmaxf(light[q], 0)));
            to[3] = (uint8_t)lrintf(255 * fminf(light[3], 1));
        }
}

/* Whether a picture may hold a texel of a block. */
static bool may_hold(const block *b, const tc_layer *layer)
{
    double first[2], last[2], lo[2], hi[2];
    place_of(b, 0, 0, &first[0], &first[1]);
    place_of(b, b->w - 1, b->h - 1, &last[0], &last[1]);
    for (int i = 0; i < 2; i++)
        lo[i] = fmin(first[i], last[i]), hi[i] = fmax(first[i], last[i]);
    return tc_layer_may_hold(layer, b->field->chart, lo, hi);
}

static tc_status make_block(const block *b, workshop *w, uint8_t (*texels)[4], ptrdiff_t stride, tc_error *error)
{
    const tc_imagery *imagery = b->field->imagery;
    tc_status status = TC_OK;
    memset(w->light, 0, sizeof w->light);
    for (int n = 0; n < imagery->layers && status == TC_OK; n++) {
        tc_layer *layer = &imagery->layer[n];
        uint64_t levels = 0;
        if (!may_hold(b, layer))
            continue;
        find_block(b, layer, &w->at, w->exact);
        for (int k = 0; k < CELLS * CELLS; k++) {
            survey_cell(b, layer, &w->at, k % CELLS, k / CELLS, &w->cell[k]);
            levels |= w->cell[k].level < 0 ? 0 : UINT64_C(1) << w->cell[k].level;
        }
        for (int level = 0; levels >> level && status == TC_OK; level++)
            if (levels >> level & 1)
                status = paint(b, layer, level, w, error);
    }
    if (status == TC_OK)
        store(b, w, texels, stride);
    return status;
}

tc_status tc_imagery_make(tc_colour_field *field, int level, tc_rect rect, uint8_t (*texels)[4], ptrdiff_t stride,
                          tc_error *error)
{
    workshop *w = malloc(sizeof *w);
    if (!w)
        return tc_fail(error, TC_ERR_MEMORY, "imagery: not enough memory");
    w->pixels = NULL, w->room = 0, w->srgb = tc_srgb_tables();
    tc_status status = TC_OK;
    for (int64_t y = rect.y0; y < rect.y1 && status == TC_OK; y += BLOCK)
        for (int64_t x = rect.x0; x < rect.x1 && status == TC_OK; x += BLOCK) {
            const block b = {field, level, x, y, (int)tc_min64(BLOCK, rect.x1 - x), (int)tc_min64(BLOCK, rect.y1 - y)};
            status = make_block(&b, w, texels + (y - rect.y0) * stride + (x - rect.x0), stride, error);
        }
    free(w->pixels);
    free(w);
    return status;
}
