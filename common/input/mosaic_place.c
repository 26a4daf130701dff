/* mosaic_place.c - where the files of a mosaic lie: on one lattice, next to each other, in one rectangle.
 *
 * The first file is the measure of all others: offsets are found by taking their corners through its transform back to
 * its columns and rows. Neighbouring SRTM tiles come out one sample short of their width apart: they share an edge. */
#include "common/base/rect.h"
#include "common/base/status.h"
#include "mosaic_internal.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* Column and row of a place, by the transform. */
static void to_pixels(const double t[6], double x, double y, double *column, double *row)
{
    double determinant = t[1] * t[5] - t[2] * t[4];
    x -= t[0];
    y -= t[3];
    *column = (x * t[5] - y * t[2]) / determinant;
    *row = (y * t[1] - x * t[4]) / determinant;
}

tc_status tc_mosaic_place(const tc_mosaic *m, const char *path, const tc_source_info *info, int64_t *column_ret,
                          int64_t *row_ret, tc_error *error)
{
    const double *t = m->terrain.georef.transform, *u = info->georef.transform;
    const char *first = m->parts[0].path;
    for (int k = 1; k <= 5; k += k == 2 ? 2 : 1) { /* the four that are not the origin */
        double scale = k % 3 == 1 ? hypot(t[1], t[4]) : hypot(t[2], t[5]);
        if (!(fabs(u[k] - t[k]) <= 1e-6 * scale))
            return tc_fail(error, TC_ERR_FORMAT,
                           "%s: pixel size: expected %.9g x %.9g as in %s, found %.9g x %.9g; `gdalbuildvrt "
                           "-resolution highest -r bilinear all.vrt FILE...` makes one map of them",
                           path, hypot(t[1], t[4]), hypot(t[2], t[5]), first, hypot(u[1], u[4]), hypot(u[2], u[5]));
    }
    double w = (double)info->width, h = (double)info->height, column, row, end_column, end_row;
    to_pixels(t, u[0], u[3], &column, &row);
    to_pixels(t, u[0] + w * u[1] + h * u[2], u[3] + w * u[4] + h * u[5], &end_column, &end_row);
    const double limit = 0.01, far = INT_MAX;
    if (!(fabs(column - rint(column)) <= limit && fabs(row - rint(row)) <= limit))
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: position: expected whole samples from %s, found %.3f columns and %.3f rows", path, first,
                       column, row);
    if (!(fabs(end_column - w - rint(column)) <= limit && fabs(end_row - h - rint(row)) <= limit))
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: pixel size: expected that of %s, found one that is %.3f columns and %.3f rows off at the "
                       "far corner",
                       path, first, end_column - w - rint(column), end_row - h - rint(row));
    if (!(fabs(column) < far && fabs(row) < far))
        return tc_fail(error, TC_ERR_FORMAT, "%s: position: expected less than 2147483647 samples from %s, found %.0f",
                       path, first, fmax(fabs(column), fabs(row)));
    *column_ret = llrint(column);
    *row_ret = llrint(row);
    return TC_OK;
}

/* Columns once around the globe; 0 where the terrain's are no whole share of it. */
static int64_t columns_around(const tc_pack_terrain *t)
{
    double turn = t->georef.geographic && t->georef.transform[2] == 0 ? 360 / fabs(t->georef.transform[1]) : 0;
    return turn >= 2 && turn < INT_MAX && fabs(turn - rint(turn)) < 1e-3 ? llrint(turn) : 0;
}

/* Numbers, and pairs by their first ones. */
static int compare(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Longitudes go on across 180 degrees: of all turns of the globe by which files can be placed, those by which they lie
 * next to each other, with the widest gap between them outside. The first file keeps its place. */
static tc_status turn_together(tc_mosaic *m, tc_error *error)
{
    const int64_t around = columns_around(&m->terrain);
    int64_t left = INT64_MAX, right = INT64_MIN;
    for (int i = 0; i < m->count; i++) {
        left = tc_min64(left, m->parts[i].column);
        right = tc_max64(right, m->parts[i].column + m->parts[i].width);
    }
    if (around == 0 || right - left <= around / 2)
        return TC_OK;
    int64_t(*spans)[2] = malloc((size_t)m->count * sizeof *spans);
    if (!spans)
        return tc_fail(error, TC_ERR_MEMORY, "mosaic: not enough memory for %d files", m->count);
    for (int i = 0; i < m->count; i++) {
        int64_t column = m->parts[i].column % around;
        spans[i][0] = column < 0 ? column + around : column;
        spans[i][1] = spans[i][0] + m->parts[i].width;
    }
    qsort(spans, (size_t)m->count, sizeof *spans, compare);
    int64_t end = spans[0][1], widest = 0, start = 0; /* of the first file that is east of the widest gap */
    for (int i = 1; i < m->count; i++) {
        if (spans[i][0] - end > widest)
            widest = spans[i][0] - end, start = spans[i][0];
        end = tc_max64(end, spans[i][1]);
    }
    if (spans[0][0] + around - end >= widest)
        widest = spans[0][0] + around - end, start = spans[0][0];
    free(spans);
    if (around - widest >= right - left)
        return TC_OK;
    start -= start > 0 ? around : 0; /* the first file's column is 0 */
    for (int i = 0; i < m->count; i++) {
        int64_t column = (m->parts[i].column - start) % around;
        m->parts[i].column = start + (column < 0 ? column + around : column);
    }
    return TC_OK;
}

/* The rectangle around all files becomes the terrain; places are counted from its south-west sample. */
static tc_status surround(tc_mosaic *m, tc_error *error)
{
    int64_t left = 0, top = 0, right = 0, bottom = 0;
    for (int i = 0; i < m->count; i++) {
        const tc_mosaic_part *p = &m->parts[i];
        left = tc_min64(left, p->column);
        top = tc_min64(top, p->row);
        right = tc_max64(right, p->column + p->width);
        bottom = tc_max64(bottom, p->row + p->height);
    }
    tc_pack_terrain *t = &m->terrain;
    t->width = right - left;
    t->height = bottom - top;
    if (t->width > INT_MAX || t->height > INT_MAX)
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: position: expected inputs within 2147483647 samples, found %" PRId64 " x %" PRId64,
                       m->parts[m->count - 1].path, t->width, t->height);
    for (int i = 0; i < m->count; i++) {
        tc_mosaic_part *p = &m->parts[i];
        p->x0 = p->column - left;
        p->y0 = bottom - (p->row + p->height);
    }
    if (m->count == 1)
        return TC_OK;
    double *g = t->georef.transform;
    g[0] += (double)left * g[1] + (double)top * g[2];
    g[3] += (double)left * g[4] + (double)top * g[5];
    if (m->options.spacing == 0)
        tc_georef_spacing(&m->first, &t->georef, t->width, t->height, &t->spacing_x, &t->spacing_y);
    return TC_OK;
}

/* Counts the samples that the files cover, each once: strip by strip between their western and eastern edges. */
static tc_status count_samples(tc_mosaic *m, tc_error *error)
{
    size_t n = (size_t)m->count;
    int64_t *edges = malloc(2 * n * sizeof *edges), (*spans)[2] = malloc(n * sizeof *spans);
    if (!edges || !spans) {
        free(edges);
        free(spans);
        return tc_fail(error, TC_ERR_MEMORY, "mosaic: not enough memory for %zu files", n);
    }
    int64_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        edges[2 * i] = m->parts[i].x0;
        edges[2 * i + 1] = m->parts[i].x0 + m->parts[i].width;
        sum += m->parts[i].width * m->parts[i].height;
    }
    qsort(edges, 2 * n, sizeof *edges, compare);
    m->samples = 0;
    for (size_t k = 0; k + 1 < 2 * n; k++) {
        size_t count = 0;
        if (edges[k] == edges[k + 1])
            continue;
        for (size_t i = 0; i < n; i++) {
            const tc_mosaic_part *p = &m->parts[i];
            if (p->x0 <= edges[k] && p->x0 + p->width >= edges[k + 1]) {
                spans[count][0] = p->y0;
                spans[count++][1] = p->y0 + p->height;
            }
        }
        qsort(spans, count, sizeof *spans, compare);
        int64_t end = INT64_MIN, covered = 0;
        for (size_t i = 0; i < count; i++) {
            covered += tc_max64(0, spans[i][1] - tc_max64(spans[i][0], end));
            end = tc_max64(end, spans[i][1]);
        }
        m->samples += covered * (edges[k + 1] - edges[k]);
    }
    m->shared = sum - m->samples;
    free(edges);
    free(spans);
    return TC_OK;
}

/* Refuses files so far apart that next to nothing of the terrain would be any of them: work would go with the voids. */
static tc_status check_apart(const tc_mosaic *m, tc_error *error)
{
    const double most = 256, least = 1 << 26; /* samples of the terrain: for each one that there is, altogether */
    double all = (double)m->terrain.width * (double)m->terrain.height;
    if (all <= least || all <= most * (double)m->samples)
        return TC_OK;
    const tc_mosaic_part *first = &m->parts[0], *far = first;
    for (int i = 1; i < m->count; i++) {
        const tc_mosaic_part *p = &m->parts[i];
        if (hypot((double)(p->x0 - first->x0), (double)(p->y0 - first->y0)) >
            hypot((double)(far->x0 - first->x0), (double)(far->y0 - first->y0)))
            far = p;
    }
    const double *g = m->terrain.georef.transform;
    double place[2][2];
    for (int i = 0; i < 2; i++) {
        const tc_mosaic_part *p = i ? far : first;
        double column = (double)p->x0, row = (double)(m->terrain.height - p->y0);
        place[i][0] = g[0] + column * g[1] + row * g[2], place[i][1] = g[3] + column * g[4] + row * g[5];
    }
    return tc_fail(
        error, TC_ERR_FORMAT,
        "%s: position: expected inputs near each other, found it at %.8g, %.8g and %s at %.8g, %.8g: %.2g voids "
        "for each sample; pack them one by one",
        far->path, place[1][0], place[1][1], first->path, place[0][0], place[0][1], all / (double)m->samples);
}

tc_status tc_mosaic_lay_out(tc_mosaic *m, tc_error *error)
{
    tc_status status = turn_together(m, error);
    if (status == TC_OK)
        status = surround(m, error);
    if (status == TC_OK)
        status = count_samples(m, error);
    return status ? status : check_apart(m, error);
}
