/* ray_flat.c - rays against the finest level's mesh, by maxima of blocks of cells (Tevs, Ihrke, Seidel, "Maximum
 * Mipmaps for Fast, Accurate, and Scalable Dynamic Height Field Rendering", I3D 2008). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "ray_cast.h"

enum { SMALLEST = 2, LEVELS = 32 }; /* blocks of 4 x 4 cells and larger; below cells are looked at one by one */

struct ray_flat {
    int64_t width, height; /* samples */
    double spacing_x, spacing_y, z_base;
    float *z;
    int top; /* of the largest block, which is all of the terrain */
    int64_t columns[LEVELS], rows[LEVELS];
    float *most[LEVELS];
};

static void *must_have(size_t bytes)
{
    void *p = malloc(bytes);
    if (!p) {
        fputs("ray cast: not enough memory\n", stderr);
        exit(99);
    }
    return p;
}

/* Highest corner of the cells [x0, x1) x [y0, y1). */
static float highest(const ray_flat *f, int64_t x0, int64_t y0, int64_t x1, int64_t y1)
{
    float most = -INFINITY;
    for (int64_t y = y0; y <= tc_min64(y1, f->height - 1); y++)
        for (int64_t x = x0; x <= tc_min64(x1, f->width - 1); x++)
            most = fmaxf(most, f->z[y * f->width + x]);
    return most;
}

static void make_maxima(ray_flat *f)
{
    for (int k = SMALLEST;; k++) {
        int64_t side = (int64_t)1 << k, w = (f->width - 2) / side + 1, h = (f->height - 2) / side + 1;
        f->columns[k] = w, f->rows[k] = h, f->top = k;
        f->most[k] = must_have((size_t)(w * h) * sizeof(float));
        for (int64_t j = 0; j < h; j++)
            for (int64_t i = 0; i < w; i++) {
                float most = -INFINITY;
                for (int c = 0; c < 4 && k > SMALLEST; c++) {
                    int64_t x = 2 * i + (c & 1), y = 2 * j + (c >> 1);
                    if (x < f->columns[k - 1] && y < f->rows[k - 1])
                        most = fmaxf(most, f->most[k - 1][y * f->columns[k - 1] + x]);
                }
                f->most[k][j * w + i] =
                    k > SMALLEST ? most : highest(f, i * side, j * side, (i + 1) * side, (j + 1) * side);
            }
        if (w == 1 && h == 1)
            return;
    }
}

ray_flat *ray_flat_create(const tc_field *field)
{
    int finest = tc_field_info(field)->levels;
    tc_level l = tc_field_level(field, finest);
    ray_flat *f = must_have(sizeof *f);
    *f = (ray_flat){.width = l.width,
                    .height = l.height,
                    .spacing_x = l.spacing_x,
                    .spacing_y = l.spacing_y,
                    .z_base = tc_field_info(field)->z_base};
    f->z = must_have((size_t)(l.width * l.height) * sizeof *f->z);
    if (tc_field_read(field, finest, (tc_rect){0, 0, l.width, l.height}, f->z, NULL, l.width))
        exit(1);
    make_maxima(f);
    return f;
}

void ray_flat_destroy(ray_flat *f)
{
    for (int k = SMALLEST; k <= f->top; k++)
        free(f->most[k]);
    free(f->z);
    free(f);
}

/* A ray in cells and metres above z_base: o + t d, t in metres from the eye. */
typedef struct ray {
    double o[3], d[3], from, to;
    double nudge; /* metres: a ten-millionth of a cell */
} ray;

/* The part of the ray over the terrain. */
static bool clip(const ray_flat *f, ray *r)
{
    const double size[2] = {(double)(f->width - 1), (double)(f->height - 1)};
    r->from = 0, r->to = INFINITY;
    for (int a = 0; a < 2; a++) {
        if (r->d[a] == 0) {
            if (r->o[a] < 0 || r->o[a] > size[a])
                return false;
            continue;
        }
        double t = -r->o[a] / r->d[a], u = (size[a] - r->o[a]) / r->d[a];
        r->from = fmax(r->from, fmin(t, u)), r->to = fmin(r->to, fmax(t, u));
    }
    /* Straight down there is no end; the lowest ground is one. */
    if (!isfinite(r->to))
        r->to = fmax(0, (r->o[2] + 1e6) / fmax(-r->d[2], 1e-12));
    return r->to > r->from;
}

/* Height above the mesh in a cell whose corners are c. */
static double above(const ray *r, const double c[4], int64_t x, int64_t y, double t)
{
    double tx = fmin(fmax(r->o[0] + t * r->d[0] - (double)x, 0), 1),
           ty = fmin(fmax(r->o[1] + t * r->d[1] - (double)y, 0), 1);
    return r->o[2] + t * r->d[2] - tc_triangle_height(c[0], c[1], c[2], c[3], tx, ty);
}

/* The cell at t. */
static void cell_at(const ray_flat *f, const ray *r, double t, int64_t *x_ret, int64_t *y_ret)
{
    *x_ret = tc_clamp64((int64_t)floor(r->o[0] + t * r->d[0]), 0, f->width - 2);
    *y_ret = tc_clamp64((int64_t)floor(r->o[1] + t * r->d[1]), 0, f->height - 2);
}

static void corners(const ray_flat *f, int64_t x, int64_t y, double c[4])
{
    const float *z = f->z + y * f->width + x;
    c[0] = z[0], c[1] = z[1], c[2] = z[f->width], c[3] = z[f->width + 1];
}

/* Whether it comes in under the terrain's edge, or begins below the ground. */
static bool begins_below(const ray_flat *f, const ray *r)
{
    int64_t x, y;
    double c[4];
    cell_at(f, r, r->from, &x, &y);
    corners(f, x, y, c);
    return above(r, c, x, y, r->from) < 0;
}

/* Between t0 and t1, in one cell: linear on both sides of its diagonal. */
static bool meet(const ray_flat *f, const ray *r, int64_t x, int64_t y, double t0, double t1, double *t_ret)
{
    double c[4];
    corners(f, x, y, c);
    double along = r->d[0] + r->d[1], middle = along != 0 ? ((double)(x + y + 1) - r->o[0] - r->o[1]) / along : t1;
    const double end[2] = {fmin(fmax(middle, t0), t1), t1};
    double h0 = above(r, c, x, y, t0);
    if (h0 < 0) {
        *t_ret = t0;
        return true;
    }
    for (int k = 0; k < 2; k++) {
        double h1 = above(r, c, x, y, end[k]);
        if (h1 < 0) {
            *t_ret = t0 + (end[k] - t0) * h0 / (h0 - h1);
            return true;
        }
        t0 = end[k], h0 = h1;
    }
    return false;
}

/* Where the ray leaves the block of `side` cells that begins at x, y. */
static double leaves(const ray *r, double x, double y, double side)
{
    double t = r->to;
    if (r->d[0] != 0)
        t = fmin(t, ((r->d[0] > 0 ? x + side : x) - r->o[0]) / r->d[0]);
    if (r->d[1] != 0)
        t = fmin(t, ((r->d[1] > 0 ? y + side : y) - r->o[1]) / r->d[1]);
    return t;
}

bool ray_flat_hit(const ray_flat *f, const tc_camera *camera, const double d[3], double *distance_ret)
{
    ray r = {.o = {camera->x / f->spacing_x, camera->y / f->spacing_y, camera->z - f->z_base},
             .d = {d[0] / f->spacing_x, d[1] / f->spacing_y, d[2]}};
    r.nudge = 1e-7 / fmax(fmax(fabs(r.d[0]), fabs(r.d[1])), 1e-7 / fmax(f->spacing_x, f->spacing_y));
    if (!clip(f, &r) || begins_below(f, &r))
        return false;
    int k = f->top;
    for (double t = r.from; t < r.to;) {
        double inside = fmin(t + r.nudge, r.to);
        int64_t x, y;
        cell_at(f, &r, inside, &x, &y);
        int64_t i = x >> k, j = y >> k;
        double out = fmax(leaves(&r, (double)(i << k), (double)(j << k), (double)((int64_t)1 << k)), inside);
        double low = r.o[2] + fmin(t * r.d[2], out * r.d[2]);
        if (k >= SMALLEST && low > f->most[k][j * f->columns[k] + i]) {
            t = out;
            k = k < f->top ? k + 1 : k;
        } else if (k > 0) {
            k = k > SMALLEST ? k - 1 : 0;
        } else {
            if (meet(f, &r, x, y, t, out, distance_ret))
                return true;
            t = out;
            int64_t nx, ny;
            cell_at(f, &r, out + r.nudge, &nx, &ny);
            k = (nx ^ x) >> SMALLEST || (ny ^ y) >> SMALLEST ? SMALLEST : 0;
        }
    }
    return false;
}
