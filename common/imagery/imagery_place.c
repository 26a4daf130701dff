/* imagery_place.c - from the charts of a map to the pixels of a picture, and back. */
#include <math.h>
#include <stdlib.h>

#include "imagery_internal.h"

/* Columns and rows of the samples that the georeference counts, from the north-west corner, and back. */
static void to_corner(const tc_map *map, double *x, double *y)
{
    const tc_chart *c = &map->grid;
    *x = (*x - c->x0) / c->dx + 0.5;
    *y = (double)map->height - 0.5 - (*y - c->y0) / c->dy;
}

static void from_corner(const tc_map *map, double *x, double *y)
{
    const tc_chart *c = &map->grid;
    *x = c->x0 + (*x - 0.5) * c->dx;
    *y = c->y0 + ((double)map->height - 0.5 - *y) * c->dy;
}

/* The column next to the picture's middle of all that are the same place. */
static double come_round(const tc_layer *layer, double px)
{
    double middle = 0.5 * (double)layer->image->level[0].width;
    return layer->period > 0 ? px - layer->period * floor((px - middle) / layer->period + 0.5) : px;
}

void tc_layer_find(const tc_map *map, tc_layer *layer, int chart, int count, double *x, double *y)
{
    const tc_chart *c = &map->chart[chart], *base = &map->grid;
    const double *t = map->georef.transform, w = (double)layer->image->level[0].width,
                 h = (double)layer->image->level[0].height;
    for (int i = 0; i < count; i++) {
        double a, b;
        c->class->to_place(c, x[i], y[i], &a, &b);
        if (layer->around) {
            x[i] = (a / (2 * M_PI) + 0.5) * w, y[i] = (0.5 - b / M_PI) * h;
            continue;
        }
        base->class->from_place(base, a, b, &a, &b);
        to_corner(map, &a, &b);
        if (layer->image->find)
            x[i] = t[0] + a * t[1] + b * t[2], y[i] = t[3] + a * t[4] + b * t[5];
        else
            x[i] = a / (double)map->width * w, y[i] = b / (double)map->height * h;
    }
    if (layer->image->find)
        layer->image->find(layer->image, count, x, y);
    for (int i = 0; i < count; i++)
        x[i] = come_round(layer, x[i]);
}

void tc_layer_locate(const tc_map *map, tc_layer *layer, int chart, int count, double *x, double *y)
{
    const tc_chart *c = &map->chart[chart], *base = &map->grid;
    const double *t = map->georef.transform, w = (double)layer->image->level[0].width,
                 h = (double)layer->image->level[0].height, determinant = t[1] * t[5] - t[2] * t[4];
    if (layer->image->locate)
        layer->image->locate(layer->image, count, x, y);
    for (int i = 0; i < count; i++) {
        double a = x[i], b = y[i];
        if (layer->around) {
            a = (a / w - 0.5) * 2 * M_PI, b = (0.5 - b / h) * M_PI;
        } else {
            if (layer->image->find)
                a = ((x[i] - t[0]) * t[5] - (y[i] - t[3]) * t[2]) / determinant,
                b = ((y[i] - t[3]) * t[1] - (x[i] - t[0]) * t[4]) / determinant;
            else
                a = a / w * (double)map->width, b = b / h * (double)map->height;
            from_corner(map, &a, &b);
            base->class->to_place(base, a, b, &a, &b);
        }
        c->class->from_place(c, a, b, &x[i], &y[i]);
    }
}

bool tc_layer_holds(const tc_layer *layer, double px, double py)
{
    const tc_image_size *size = &layer->image->level[0];
    return isfinite(px) && py >= 0 && py <= (double)size->height &&
           (layer->joined || (px >= 0 && px <= (double)size->width));
}

/* ---- Bounds -------------------------------------------------------------------------------------------------------
 */

enum { PLACES = 33 }; /* of a picture, a side, that say where all of it is */

static int by_size(const void *a, const void *b)
{
    double d = *(const double *)a - *(const double *)b;
    return (d > 0) - (d < 0);
}

/* From the least to the greatest of them, the way around that leaves out the widest gap. Sorts them. */
static void span_of(double *x, int count, double turn, double *lo_ret, double *hi_ret)
{
    qsort(x, (size_t)count, sizeof *x, by_size);
    *lo_ret = x[0], *hi_ret = x[count - 1];
    double gap = turn - (x[count - 1] - x[0]);
    for (int i = 1; i < count && turn > 0; i++)
        if (x[i] - x[i - 1] > gap)
            gap = x[i] - x[i - 1], *lo_ret = x[i], *hi_ret = x[i - 1] + turn;
}

/* How far it is at most from one of the places to that `apart` further on, in a row or a column of them. */
static double longest_step(const double *x, int apart, double turn)
{
    double most = 0;
    for (int k = 0; k + apart < PLACES * PLACES; k++) {
        double step = fabs(x[k + apart] - x[k]);
        if (apart == PLACES || k % PLACES != PLACES - 1)
            most = fmax(most, turn > 0 ? fmin(step, fabs(turn - step)) : step);
    }
    return most;
}

/* All that lies between places of the picture is no further from them than they are from each other. */
static tc_layer_bounds bounds_on(const tc_map *map, tc_layer *layer, int chart)
{
    const tc_image_size *size = &layer->image->level[0];
    tc_layer_bounds b = {.everywhere = true, .turn = map->chart[chart].class->period};
    double at[2][PLACES * PLACES];
    if (layer->around || (layer->image->find && !layer->image->locate))
        return b;
    for (int k = 0; k < PLACES * PLACES; k++)
        at[0][k] = (double)(k % PLACES) / (PLACES - 1) * (double)size->width,
        at[1][k] = (double)(k / PLACES) / (PLACES - 1) * (double)size->height;
    tc_layer_locate(map, layer, chart, PLACES * PLACES, at[0], at[1]);
    for (int k = 0; k < PLACES * PLACES; k++)
        if (!isfinite(at[0][k]) || !isfinite(at[1][k]))
            return b;
    for (int i = 0; i < 2; i++) {
        const double turn = i == 0 ? b.turn : 0;
        double beyond = longest_step(at[i], 1, turn) + longest_step(at[i], PLACES, turn);
        span_of(at[i], PLACES * PLACES, turn, &b.lo[i], &b.hi[i]);
        b.lo[i] -= beyond, b.hi[i] += beyond;
    }
    b.everywhere = false;
    return b;
}

void tc_layer_place(const tc_map *map, tc_layer *layer)
{
    const tc_image *image = layer->image;
    layer->around = !image->find && map->grid.wraps;
    layer->period = layer->around ? (double)image->level[0].width : image->period;
    layer->joined = layer->period > 0 && layer->period <= (double)image->level[0].width + 0.5;
    for (int chart = 0; chart < map->charts; chart++)
        layer->bounds[chart] = bounds_on(map, layer, chart);
}

bool tc_layer_may_hold(const tc_layer *layer, int chart, const double lo[2], const double hi[2])
{
    const tc_layer_bounds *b = &layer->bounds[chart];
    if (b->everywhere)
        return true;
    double turns = b->turn > 0 ? b->turn * ceil((b->lo[0] - hi[0]) / b->turn) : 0; /* the first that is not before it */
    return lo[1] <= b->hi[1] && hi[1] >= b->lo[1] && lo[0] + turns <= b->hi[0] && hi[0] + turns >= b->lo[0];
}
