/* atlas_caps.c - polar caps from rows of longitude and latitude.
 *
 * Rows are filtered along their parallel (row_filter.c), then a cap sample is interpolated from four columns of four
 * rows by cubics through the samples (Catmull-Rom). A cap is counted in rows from its pole. Its annulus k lies between
 * rows k and k + 1 and needs rows k - 1 to k + 2: as soon as all four are there it is written, so that few rows are
 * held whatever the direction they come in. Beyond the pole the same rows follow, half a turn further: those next to it
 * lie at most a row's distance away on both sides. */
#include "atlas_caps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "chart.h"

enum { BAND = 64, SLOTS = BAND + 3 }; /* rows filtered together; and held */

static const double pi = 3.141592653589793;

/* A row this close to its pole, in rows, is taken for the pole itself: a point, all columns of which mean the same. */
static const double at_pole = 0.1;

typedef struct cap {
    tc_cap_target target;
    double offset; /* angle from the pole to row 0 */
    bool pole_row; /* row 0 lies on the pole */
    float *z;      /* slot of row k: k % SLOTS */
    uint8_t *voids;
    int64_t held[SLOTS]; /* the row in each slot; -1 none */
    uint8_t *done;       /* annulus k at [k + 1] */
    int64_t first, last; /* annuli to be written now */
    const float *in_z;   /* rows to be filtered now, row `start` first, `step` samples from one to the next */
    const uint8_t *in_voids;
    int64_t start;
    ptrdiff_t step;
} cap;

struct tc_caps {
    tc_lonlat grid;
    int64_t side, half, reach;
    int threads;
    cap cap[TC_CAPS];
    cap *current;
    _Atomic int failed;
};

static int64_t half_side(const tc_lonlat *grid)
{
    double edge = 2 * tan(0.5 * (90 - TC_CAP_EDGE) * pi / 180);
    return (int64_t)ceil(edge / grid->dy - 1e-9);
}

int64_t tc_caps_side(const tc_lonlat *grid)
{
    return 2 * half_side(grid) + 1;
}

/* From the pole to a corner of its cap. */
static double corner_angle(const tc_lonlat *grid)
{
    return 2 * atan(0.5 * sqrt(2) * (double)half_side(grid) * grid->dy);
}

int64_t tc_caps_reach(const tc_lonlat *grid)
{
    return tc_min64((int64_t)ceil(corner_angle(grid) / grid->dy) + 3, grid->height);
}

static bool usable(const tc_lonlat *g)
{
    double south = g->y0 + pi / 2, north = pi / 2 - (g->y0 + (double)(g->height - 1) * g->dy);
    return g->width >= 2 && g->height >= 4 && g->dy > 0 && fabs((double)g->width * g->dx - 2 * pi) < 1e-6 &&
           south > -1e-3 * g->dy && south < 1.001 * g->dy && north > -1e-3 * g->dy && north < 1.001 * g->dy;
}

/* The annulus of an angle; -1: between row 0 and the pole. */
static int64_t annulus_at(const tc_caps *caps, const cap *p, double theta)
{
    int64_t k = (int64_t)floor((theta - p->offset) / caps->grid.dy);
    return tc_max64(k, p->pole_row ? 0 : -1);
}

static int64_t last_annulus(const tc_caps *caps, const cap *p)
{
    return annulus_at(caps, p, corner_angle(&caps->grid));
}

tc_status tc_caps_create(const tc_lonlat *grid, const tc_cap_target target[TC_CAPS], int threads, tc_caps **caps_ret)
{
    if (!usable(grid))
        return TC_ERR_USAGE;
    tc_caps *caps = calloc(1, sizeof *caps);
    if (!caps)
        return TC_ERR_MEMORY;
    caps->grid = *grid;
    caps->half = half_side(grid);
    caps->side = tc_caps_side(grid);
    caps->reach = tc_caps_reach(grid);
    caps->threads = threads;
    bool enough = true;
    for (int c = 0; c < TC_CAPS; c++) {
        cap *p = &caps->cap[c];
        double south = grid->y0 + pi / 2, north = pi / 2 - (grid->y0 + (double)(grid->height - 1) * grid->dy);
        p->target = target[c];
        p->offset = fmax(c == TC_NORTH_CAP ? north : south, 0);
        p->pole_row = p->offset < at_pole * grid->dy;
        p->z = malloc(SLOTS * (size_t)grid->width * sizeof *p->z);
        p->voids = target[c].voids ? malloc(SLOTS * (size_t)grid->width) : NULL;
        p->done = calloc((size_t)caps->reach + 2, 1);
        for (int s = 0; s < SLOTS; s++)
            p->held[s] = -1;
        enough = enough && p->z && p->done && (!target[c].voids || p->voids);
    }
    tc_status status = enough ? TC_OK : TC_ERR_MEMORY;
    for (int c = 0; c < TC_CAPS && enough; c++)
        if (last_annulus(caps, &caps->cap[c]) + 2 >= caps->reach) /* few rows: their caps reach beyond the last */
            status = TC_ERR_USAGE;
    if (status != TC_OK) {
        tc_caps_destroy(caps);
        return status;
    }
    *caps_ret = caps;
    return TC_OK;
}

void tc_caps_destroy(tc_caps *caps)
{
    for (int c = 0; caps && c < TC_CAPS; c++) {
        free(caps->cap[c].z);
        free(caps->cap[c].voids);
        free(caps->cap[c].done);
    }
    free(caps);
}

/* ---- Rows ---------------------------------------------------------------------------------------------------- */

/* Row k, which beyond the pole (k < 0) is another one, turned. */
static int64_t real_row(const cap *p, int64_t k, bool *turned_ret)
{
    *turned_ret = k < 0;
    return k >= 0 ? k : p->pole_row ? -k : -1 - k;
}

/* Angle from the pole to row k. */
static double row_angle(const tc_caps *caps, const cap *p, int64_t k)
{
    bool turned;
    int64_t real = real_row(p, k, &turned);
    double angle = real == 0 && p->pole_row ? 0 : p->offset + (double)real * caps->grid.dy;
    return turned ? -angle : angle;
}

static void filter_row(void *context, int64_t n)
{
    tc_caps *caps = context;
    cap *p = caps->current;
    int64_t k = p->start + n, width = caps->grid.width;
    double *scratch = malloc(tc_row_filter_scratch(width) * sizeof *scratch);
    if (!scratch) {
        caps->failed = 1;
        return;
    }
    tc_row_filter(p->in_z + n * p->step, width, row_angle(caps, p, k), caps->grid.dy, p->z + k % SLOTS * width,
                  scratch);
    free(scratch);
    if (p->voids && p->in_voids)
        memcpy(p->voids + k % SLOTS * width, p->in_voids + n * p->step, (size_t)width);
    else if (p->voids)
        memset(p->voids + k % SLOTS * width, 0, (size_t)width);
}

/* ---- Annuli -------------------------------------------------------------------------------------------------- */

/* Weights of the cubic through z1 and z2 at positions p1 and p2, with the slopes of the parabolas through three. */
static void cubic(const double p[4], double at, double w[4])
{
    double h0 = p[1] - p[0], h1 = p[2] - p[1], h2 = p[3] - p[2], s = (at - p[1]) / h1;
    double left = s * (1 - s) * (1 - s), right = s * s * (s - 1);
    w[0] = -left * h1 * h1 / (h0 * (h0 + h1));
    w[3] = right * h1 * h1 / (h2 * (h1 + h2));
    w[1] = (2 * s - 3) * s * s + 1 + left * (h1 * h1 - h0 * h0) / (h0 * (h0 + h1)) - right * h2 / (h1 + h2);
    w[2] = 1 - (w[0] + w[1] + w[3]);
}

/* Columns around a longitude: the four, with their weights, and the nearest. */
typedef struct columns {
    int64_t column[4], nearest;
    double weight[4];
} columns;

static void find_columns(const tc_lonlat *grid, double longitude, columns *c)
{
    static const double p[4] = {-1, 0, 1, 2};
    double u = (longitude - grid->x0) / grid->dx, start = floor(u);
    int64_t first = (int64_t)start % grid->width + grid->width - 1;
    for (int n = 0; n < 4; n++)
        c->column[n] = (first + n) % grid->width;
    cubic(p, u - start, c->weight);
    c->nearest = c->column[u - start < 0.5 ? 1 : 2];
}

static double between(const columns *c, const float *row)
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += c->weight[i] * (double)row[c->column[i]];
    return sum;
}

/* The pole lies on all meridians. */
static double mean(const float *row, int64_t width)
{
    double sum = 0;
    for (int64_t i = 0; i < width; i++)
        sum += (double)row[i] - (double)row[0];
    return (double)row[0] + sum / (double)width;
}

static void write_sample(const tc_caps *caps, const cap *p, int64_t k, double theta, double longitude, int64_t at)
{
    const tc_lonlat *grid = &caps->grid;
    columns there[2]; /* on this side of the pole and on the other */
    double angle[4], weight[4], z = 0;
    find_columns(grid, longitude, &there[0]);
    if (k < 1)
        find_columns(grid, longitude + pi, &there[1]);
    for (int n = 0; n < 4; n++)
        angle[n] = row_angle(caps, p, k - 1 + n);
    cubic(angle, theta, weight);
    int nearest = theta - angle[1] < angle[2] - theta ? 1 : 2;
    for (int n = 0; n < 4; n++) {
        bool turned;
        int64_t slot = real_row(p, k - 1 + n, &turned) % SLOTS;
        const columns *c = &there[turned];
        const float *row = p->z + slot * grid->width;
        z += weight[n] * (theta > 0 ? between(c, row) : mean(row, grid->width));
        if (n == nearest && p->voids)
            p->target.voids[at] = p->voids[slot * grid->width + c->nearest];
    }
    p->target.z[at] = (float)z;
}

/* Samples from..to of a row of the cap that belong to the annuli to be written. */
static void write_span(const tc_caps *caps, const cap *p, int64_t row, int64_t from, int64_t to)
{
    double d = caps->grid.dy, y = (double)(row - caps->half) * d;
    for (int64_t i = tc_max64(from, 0); i <= tc_min64(to, caps->side - 1); i++) {
        double x = (double)(i - caps->half) * d, theta = 2 * atan(0.5 * sqrt(x * x + y * y));
        int64_t k = annulus_at(caps, p, theta);
        if (k >= p->first && k <= p->last)
            write_sample(caps, p, k, theta, atan2(y, x), row * caps->side + i);
    }
}

static void write_row(void *context, int64_t row)
{
    tc_caps *caps = context;
    const cap *p = caps->current;
    double d = caps->grid.dy, y = (double)(row - caps->half);
    double least = p->offset + (double)p->first * d, most = fmin(p->offset + (double)(p->last + 1) * d, 0.9 * pi);
    double outer = 2 * tan(0.5 * most) / d, inner = p->first < 0 || least <= 0 ? 0 : 2 * tan(0.5 * least) / d;
    if (fabs(y) > outer + 1)
        return;
    int64_t far = (int64_t)fmin(sqrt(fmax(outer * outer - y * y, 0)) + 2, (double)caps->half);
    int64_t near = (int64_t)(sqrt(fmax(inner * inner - y * y, 0)) - 2);
    if (near <= 0) {
        write_span(caps, p, row, caps->half - far, caps->half + far);
        return;
    }
    write_span(caps, p, row, caps->half - far, caps->half - near);
    write_span(caps, p, row, caps->half + near, caps->half + far);
}

static bool ready(const tc_caps *caps, const cap *p, int64_t k)
{
    if (k < (p->pole_row ? 0 : -1) || k + 2 >= caps->reach || p->done[k + 1])
        return false;
    for (int64_t n = k - 1; n < k + 3; n++) {
        bool turned;
        int64_t real = real_row(p, n, &turned);
        if (p->held[real % SLOTS] != real)
            return false;
    }
    return true;
}

/* Writes what rows `from` to `to`, just taken in, have made possible. */
static void write_annuli(tc_caps *caps, cap *p, int64_t from, int64_t to)
{
    for (int64_t k = from - 2; k <= to + 1;) {
        if (!ready(caps, p, k)) {
            k++;
            continue;
        }
        p->first = k;
        for (; k <= to + 1 && ready(caps, p, k); k++)
            p->done[k + 1] = 1;
        p->last = k - 1;
        tc_parallel_for(caps->threads, caps->side, write_row, caps);
    }
}

tc_status tc_caps_put(tc_caps *caps, int64_t j0, int64_t rows, const float *z, const uint8_t *voids)
{
    int64_t width = caps->grid.width, height = caps->grid.height;
    if (rows < 0 || j0 < 0 || j0 + rows > height)
        return TC_ERR_USAGE;
    for (int c = 0; c < TC_CAPS; c++) {
        cap *p = caps->current = &caps->cap[c];
        bool north = c == TC_NORTH_CAP;
        /* From the pole: rows k0 to k1 - 1. */
        int64_t k0 = north ? height - j0 - rows : j0, k1 = tc_min64(k0 + rows, caps->reach);
        if (k1 <= k0)
            continue;
        /* In bands in the direction that the rows come in, which shows in what is held. */
        bool inwards = k0 > 0 ? p->held[(k0 - 1) % SLOTS] != k0 - 1 : p->held[k1 % SLOTS] == k1;
        int64_t bands = (k1 - k0 + BAND - 1) / BAND;
        for (int64_t b = 0; b < bands; b++) {
            int64_t from = k0 + (inwards ? bands - 1 - b : b) * BAND, to = tc_min64(from + BAND, k1);
            int64_t j = north ? height - 1 - from : from;
            p->start = from;
            p->step = north ? -width : width;
            p->in_z = z + (j - j0) * width;
            p->in_voids = voids ? voids + (j - j0) * width : NULL;
            tc_parallel_for(caps->threads, to - from, filter_row, caps);
            if (caps->failed)
                return TC_ERR_MEMORY;
            for (int64_t k = from; k < to; k++)
                p->held[k % SLOTS] = k;
            write_annuli(caps, p, from, to - 1);
        }
    }
    return TC_OK;
}

tc_status tc_caps_finish(tc_caps *caps, tc_cap_result result[TC_CAPS])
{
    for (int c = 0; c < TC_CAPS; c++) {
        const cap *p = &caps->cap[c];
        for (int64_t k = p->pole_row ? 0 : -1; k <= last_annulus(caps, p); k++)
            if (!p->done[k + 1])
                return TC_ERR_USAGE;
        if (!result)
            continue;
        tc_cap_result r = {INFINITY, -INFINITY, 0};
        for (int64_t i = 0; i < caps->side * caps->side; i++) {
            if (p->target.voids && p->target.voids[i]) {
                r.void_count++;
                continue;
            }
            r.z_min = fminf(r.z_min, p->target.z[i]);
            r.z_max = fmaxf(r.z_max, p->target.z[i]);
        }
        if (r.void_count == caps->side * caps->side)
            r.z_min = r.z_max = 0;
        result[c] = r;
    }
    return TC_OK;
}
