/* ray_globe.c - rays against a planet's finest levels, between the shells of tiles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/measure/view_error.h"
#include "ray_cast.h"

#define DEGREE (M_PI / 180)
enum { TILE = 8 }; /* samples of chart 0 */

/* Tiles of longitude and latitude: the highest ground in a tile and in all tiles around it, so that it holds as far as
 * a tile is wide. Where meridians are close together, of all tiles of three rows. */
struct ray_globe {
    const tc_map *atlas;
    double z_base, radius; /* of what heights are above, the least that a radian is long */
    double z_max;          /* of all of them */
    double x0, y0, side;   /* of the tiles, radians */
    int64_t columns, rows;
    float *most;
    double *narrow; /* of each row: the least share of a tile's side that one is wide in it and beside it */
};

static const double SHORT = 0.17; /* cosine of the latitude from which on rows are taken as a whole */

/* Highest ground of a cap over a rectangle of longitude and latitude. */
static float cap_highest(const tc_map *a, int chart, double x0, double y0, double x1, double y1)
{
    const tc_chart *c = &a->chart[chart];
    double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
    enum { STEPS = 32 };
    for (int i = 0; i <= STEPS; i++)
        for (int side = 0; side < 2; side++) {
            double latitude = fmin(side ? y1 : y0, M_PI / 2), lambda = x0 + (x1 - x0) * i / STEPS;
            double r = 2 * tan((M_PI / 2 - (chart == 1 ? latitude : -fmax(latitude, -M_PI / 2))) / 2);
            const double p[2] = {(r * cos(lambda) - c->x0) / c->dx, (r * sin(lambda) - c->y0) / c->dy};
            for (int k = 0; k < 2; k++)
                lo[k] = fmin(lo[k], p[k]), hi[k] = fmax(hi[k], p[k]);
        }
    /* Arcs between the points bulge by less than this. */
    double slack = 2 + 0.01 * fmax(hi[0] - lo[0], hi[1] - lo[1]);
    return tc_field_range(c->field, tc_field_info(c->field)->levels,
                          (tc_rect){(int64_t)floor(lo[0] - slack), (int64_t)floor(lo[1] - slack),
                                    (int64_t)ceil(hi[0] + slack) + 1, (int64_t)ceil(hi[1] + slack) + 1})
        .hi;
}

/* Highest ground of one tile alone. */
static float tile_highest(const ray_globe *g, int64_t i, int64_t j)
{
    const tc_chart *c = &g->atlas->chart[0];
    tc_rect r = {i * TILE - 1, j * TILE - 1, (i + 1) * TILE + 2, (j + 1) * TILE + 2};
    tc_range range = tc_field_range(c->field, tc_field_info(c->field)->levels, r);
    float hi = range.hi;
    double x0 = g->x0 + (double)i * g->side, y0 = g->y0 + (double)j * g->side, y1 = y0 + g->side;
    if (g->atlas->charts > 1 && y1 > TC_CAP_BLEND_START * DEGREE)
        hi = fmaxf(hi, cap_highest(g->atlas, 1, x0, y0, x0 + g->side, y1));
    if (g->atlas->charts > 1 && y0 < -TC_CAP_BLEND_START * DEGREE)
        hi = fmaxf(hi, cap_highest(g->atlas, 2, x0, y0, x0 + g->side, y1));
    return hi;
}

static bool whole_row(const ray_globe *g, int64_t j)
{
    double south = g->y0 + (double)(j - 1) * g->side, north = g->y0 + (double)(j + 2) * g->side;
    return cos(fmin(fmax(fabs(south), fabs(north)), M_PI / 2)) < SHORT;
}

static float around(const ray_globe *g, const float *own, int64_t i, int64_t j)
{
    float most = -INFINITY;
    for (int64_t v = tc_max64(j - 1, 0); v <= tc_min64(j + 1, g->rows - 1); v++)
        for (int64_t u = i - 1; u <= i + 1; u++)
            most = fmaxf(most, own[v * g->columns + (u + g->columns) % g->columns]);
    return most;
}

ray_globe *ray_globe_create(const tc_map *atlas)
{
    const tc_chart *c = &atlas->chart[0];
    tc_level l = tc_field_level(c->field, tc_field_info(c->field)->levels);
    ray_globe *g = calloc(1, sizeof *g);
    if (g)
        *g = (ray_globe){.atlas = atlas,
                         .z_base = tc_field_info(c->field)->z_base,
                         .x0 = c->x0,
                         .y0 = c->y0,
                         .side = TILE * c->dx,
                         .columns = (l.width + TILE - 1) / TILE,
                         .rows = (l.height + TILE - 1) / TILE,
                         .z_max = -INFINITY};
    float *own = g ? malloc((size_t)(g->columns * g->rows) * sizeof *own) : NULL;
    if (!own || !(g->most = malloc((size_t)(g->columns * g->rows) * sizeof *g->most)) ||
        !(g->narrow = malloc((size_t)g->rows * sizeof *g->narrow))) {
        fputs("ray cast: not enough memory\n", stderr);
        exit(99);
    }
    double most;
    atlas->body.class->curvatures(&atlas->body, &g->radius, &most);
    g->radius += g->z_base;
    for (int64_t k = 0; k < g->columns * g->rows; k++)
        own[k] = tile_highest(g, k % g->columns, k / g->columns), g->z_max = fmax(g->z_max, own[k]);
    for (int64_t j = 0; j < g->rows; j++) {
        float row = -INFINITY;
        for (int64_t i = 0; i < g->columns; i++)
            row = fmaxf(row, g->most[j * g->columns + i] = around(g, own, i, j));
        for (int64_t i = 0; i < g->columns && whole_row(g, j); i++)
            g->most[j * g->columns + i] = row;
        const double south = g->y0 + (double)j * g->side, farthest = fmax(fabs(south), fabs(south + g->side));
        g->narrow[j] = whole_row(g, j) ? 1 : cos(fmin(farthest + g->side, M_PI / 2));
    }
    free(own);
    return g;
}

void ray_globe_destroy(ray_globe *g)
{
    free(g->most);
    free(g->narrow);
    free(g);
}

/* ---- Rays -------------------------------------------------------------------------------------------------------- */

typedef struct ray {
    const ray_globe *g;
    const tc_camera *camera;
    const double *d;
    double eye[3], way[3]; /* the eye and d in the body's axes */
} ray;

/* A point of the ray: where it is, and how high above the body of heights 0. */
typedef struct point {
    double s, place[3];
} point;

static point at(const ray *r, double s)
{
    point p = {.s = s};
    const double e[3] = {s * r->d[0], s * r->d[1], s * r->d[2]};
    tc_view_place(r->camera, &r->g->atlas->body, e, p.place);
    p.place[2] -= r->g->z_base;
    return p;
}

static double above(const ray *r, const point *p)
{
    double z;
    if (tc_map_height(r->g->atlas, p->place[0], p->place[1], &z))
        exit(1);
    return p->place[2] - (z - r->g->z_base);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Change of the height with the distance. */
static double slope(const ray *r, const point *p)
{
    double n[3];
    const tc_body *body = &r->g->atlas->body;
    body->class->normal(body, p->place, n);
    return dot(n, r->way);
}

static double shell(const ray_globe *g, const point *p, double *reach_ret)
{
    double x = p->place[0] - g->x0;
    int64_t i = tc_clamp64((int64_t)floor((x - 2 * M_PI * floor(x / (2 * M_PI))) / g->side), 0, g->columns - 1);
    int64_t j = tc_clamp64((int64_t)floor((p->place[1] - g->y0) / g->side), 0, g->rows - 1);
    *reach_ret = 0.99 * g->side * g->narrow[j] * (g->radius + fmin(p->place[2], 0));
    return g->most[j * g->columns + i];
}

/* Where it is met between two points, by the secant; the end that stays twice counts half (the Illinois rule). */
static double meet(const ray *r, double clear, double below)
{
    const point first = at(r, clear), last = at(r, below);
    double over = above(r, &first), under = above(r, &last);
    int side = 0;
    for (int i = 0; i < 100 && over > 0 && below - clear > 1e-12 * below; i++) {
        /* The middle now and then, so that it surely ends. */
        const double s = i % 8 == 7 ? 0.5 * (clear + below) : clear + (below - clear) * (over / (over - under));
        const point p = at(r, s);
        const double z = above(r, &p);
        if (z < 0) {
            below = s, under = z, over *= side < 0 ? 0.5 : 1;
            side = -1;
        } else {
            clear = s, over = z, under *= side > 0 ? 0.5 : 1;
            side = 1;
        }
    }
    return over > 0 ? 0.5 * (clear + below) : clear;
}

bool ray_globe_hit(const ray_globe *g, const tc_camera *camera, const double d[3], double *distance_ret)
{
    const tc_body *body = &g->atlas->body;
    const double place[3] = {camera->x, camera->y, camera->z};
    double axes[3][3];
    ray r = {.g = g, .camera = camera, .d = d};
    body->class->position(body, place, r.eye);
    body->class->axes(body, place, axes);
    for (int i = 0; i < 3; i++)
        r.way[i] = d[0] * axes[0][i] + d[1] * axes[1][i] + d[2] * axes[2][i];
    double s = 0, up = sqrt(dot(r.eye, r.eye)), top = body->radius + g->z_base + g->z_max,
           cell = g->side / TILE * g->radius;
    if (up > top) { /* to where it enters a ball around all ground */
        double b = dot(r.eye, r.way), c = (up - top) * (up + top), q = b * b - c;
        if (b >= 0 || q < 0)
            return false;
        s = c / (-b + sqrt(q));
    }
    const double from = s;
    point p = at(&r, s);
    double reach, most = shell(g, &p, &reach);
    while (p.place[2] <= g->z_max * (1 + 1e-9) + 1e-6 || slope(&r, &p) < 0) {
        double step = fmin(cell / 8, fmax(0.02 * fmax(p.s - from, p.s * 0.02), 1e-3)), free = 0;
        if (p.place[2] > most) {
            const double fall = -slope(&r, &p);
            free = fall > 0 ? fmin(reach, (p.place[2] - most) / fall) : reach; /* heights along a ray are convex */
        }
        const point next = at(&r, p.s + fmax(step, free));
        most = shell(g, &next, &reach);
        if (next.place[2] <= most && above(&r, &next) < 0) {
            *distance_ret = meet(&r, p.s, next.s);
            return true;
        }
        p = next;
    }
    return false;
}
