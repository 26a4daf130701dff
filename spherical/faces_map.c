/* faces_map.c - the mesh of blocks in double: the oracle of shaders/faces.vert, which does the same in float. */
#include <math.h>

#include "common/base/mesh.h"
#include "common/base/rect.h"
#include "common/field/field.h"
#include "faces_internal.h"

double tc_faces_alpha(const faces_view *v, const tc_leaf *leaf, int level, int64_t cells, int64_t i, int64_t j,
                      const double d[3])
{
    const faces_surface *s = tc_faces_of(v);
    const tc_frame_options *options = &v->head.options;
    if (level == 1 || options->no_stitch)
        return 0;
    const int met = tc_leaf_alpha(leaf, i, j, cells);
    if (met >= 0)
        return met;
    double alpha = 0;
    const bool by_error = v->error != NULL; /* as the shader knows it */
    const double x = (double)i / (double)cells, y = (double)j / (double)cells;
    if (s->kind->morphs && !options->no_morph && !(by_error && level > s->own)) {
        double share = s->kind->distance(d, v->height) / tc_faces_range(v, level);
        alpha = (share / FACES_PASSED - (1 - FACES_PASSAGE)) / FACES_PASSAGE;
    }
    double missing = 0, error = 0;
    for (int k = 0; k < 4; k++) {
        const double share = (k & 1 ? x : 1 - x) * (k & 2 ? y : 1 - y);
        missing += leaf->forced & 1 << k ? share : 0;
        error += by_error && !options->no_morph ? share * (double)tc_faces_corner(v, leaf, k) : 0;
    }
    alpha = fmax(alpha, error);
    return fmin(fmax(fmax(alpha, missing), 0), 1);
}

/* A leaf's mesh: its level, and its first sample there. */
typedef struct leaf_mesh {
    const faces_view *view;
    const tc_leaf *leaf;
    int level;
    int64_t cells, x, y;
    double cell; /* finest cells */
} leaf_mesh;

/* From the viewer's foot point on the body, in the viewer's axes, metres. */
static void place_at(const leaf_mesh *m, int64_t i, int64_t j, double height, double d[3], double p[3])
{
    const faces_view *v = m->view;
    const tc_body *body = &tc_faces_of(v)->map->body;
    const double z_base = tc_field_info(v->head.surface->field)->z_base, foot[3] = {v->place[0], v->place[1], 0};
    tc_faces_direction(v, m->leaf->block.chart, (double)i * m->cell, (double)j * m->cell, d);
    body->class->offset(body, foot, d, p);
    for (int k = 0; k < 3; k++)
        p[k] += (z_base + height) * (d[k] + (k == 2));
}

/* The pair that a window has. */
static const float *held(const leaf_mesh *m, int level, int64_t i, int64_t j)
{
    const tc_clipmap *clipmap = m->view->head.windows->clipmap[m->leaf->block.chart];
    const int64_t mask = tc_clipmap_n(clipmap);
    return tc_ground_heights(clipmap, level)[(j & mask) * (mask + 1) + (i & mask)];
}

/* The heights of a sample of the level and of the coarser one on the same spot. */
static void heights_at(const leaf_mesh *m, int64_t i, int64_t j, double z[2])
{
    const int own = tc_faces_of(m->view)->own, finer = m->level - own;
    if (finer <= 0) {
        const float *pair = held(m, m->level, i, j);
        z[0] = (double)pair[0], z[1] = (double)pair[1];
        return;
    }
    const int64_t x = tc_floor_shift(i, finer), y = tc_floor_shift(j, finer), one = (int64_t)1 << finer;
    const double u = (double)(i - x * one) / (double)one, w = (double)(j - y * one) / (double)one;
    const int64_t next_x = x + (u > 0), next_y = y + (w > 0);
    z[0] = z[1] = tc_triangle_height((double)held(m, own, x, y)[0], (double)held(m, own, next_x, y)[0],
                                     (double)held(m, own, x, next_y)[0], (double)held(m, own, next_x, next_y)[0], u, w);
}

/* Vertex (i, j) of the leaf's level, as it is drawn. */
static void vertex(const leaf_mesh *m, int64_t i, int64_t j, double p[3])
{
    double z[2], end[2][2];
    heights_at(m, i, j, z);
    const bool between = i & 1 || j & 1;
    double d[3];
    place_at(m, i, j, 0, d, p);
    double alpha = tc_faces_alpha(m->view, m->leaf, m->level, m->cells, i - m->x, j - m->y, d);
    place_at(m, i, j, between ? z[0] : (1 - alpha) * z[0] + alpha * z[1], d, p);
    if (!between || alpha <= 0)
        return;
    const int64_t di = i & 1, dj = i & 1 ? -(j & 1) : 1;
    double a[3], b[3];
    heights_at(m, i + di, j + dj, end[0]), heights_at(m, i - di, j - dj, end[1]);
    place_at(m, i + di, j + dj, end[0][1], d, a);
    place_at(m, i - di, j - dj, end[1][1], d, b);
    for (int k = 0; k < 3; k++)
        p[k] = (1 - alpha) * p[k] + alpha * 0.5 * (a[k] + b[k]);
}

/* How far along the line from o in direction n the plane of a triangle is; *inside_ret: how far within it, in shares of
 * its corners. */
static double meet(const double o[3], const double n[3], const double a[3], const double b[3], const double c[3],
                   double *inside_ret)
{
    double e[3], f[3], g[3];
    for (int k = 0; k < 3; k++)
        e[k] = b[k] - a[k], f[k] = c[k] - a[k], g[k] = o[k] - a[k];
    const double nf[3] = {n[1] * f[2] - n[2] * f[1], n[2] * f[0] - n[0] * f[2], n[0] * f[1] - n[1] * f[0]};
    const double ge[3] = {g[1] * e[2] - g[2] * e[1], g[2] * e[0] - g[0] * e[2], g[0] * e[1] - g[1] * e[0]};
    const double det = e[0] * nf[0] + e[1] * nf[1] + e[2] * nf[2];
    const double u = (g[0] * nf[0] + g[1] * nf[1] + g[2] * nf[2]) / det,
                 w = (n[0] * ge[0] + n[1] * ge[1] + n[2] * ge[2]) / det;
    *inside_ret = det == 0 ? -INFINITY : fmin(fmin(u, w), 1 - u - w);
    return (f[0] * ge[0] + f[1] * ge[1] + f[2] * ge[2]) / det;
}

/* The height at which the normal's line meets the cell of the leaf's mesh, or would if it were larger. */
static double meet_cell(const leaf_mesh *m, int64_t i, int64_t j, const double o[3], const double n[3],
                        double *inside_ret)
{
    double p[4][3], in[2];
    for (int k = 0; k < 4; k++)
        vertex(m, i + (k & 1), j + (k >> 1), p[k]);
    double south = meet(o, n, p[0], p[1], p[2], &in[0]), north = meet(o, n, p[1], p[3], p[2], &in[1]);
    *inside_ret = fmax(in[0], in[1]);
    return in[0] >= in[1] ? south : north;
}

/* Whether a leaf's samples are there still. */
static bool holds(const faces_view *v, const tc_leaf *leaf)
{
    tc_rect r = tc_faces_samples(&tc_faces_of(v)->lattice, leaf->block);
    if (leaf->coarse)
        r = (tc_rect){r.x0 / 2, r.y0 / 2, r.x1 / 2 + 1, r.y1 / 2 + 1};
    const int level = tc_faces_window(tc_faces_of(v), leaf->block.level - leaf->coarse, &r);
    return tc_rect_within(r, tc_clipmap_level(v->head.windows->clipmap[leaf->block.chart], level)->clip);
}

bool tc_faces_height_in(const faces_view *v, const tc_block_tree *tree, double x, double y, double *z_ret)
{
    const faces_surface *s = tc_faces_of(v);
    const tc_body *body = &s->map->body;
    const double place[3] = {x, y, 0}, foot[3] = {v->place[0], v->place[1], 0};
    double normal[3], d[3], o[3], n[3], u, w;
    body->class->normal(body, place, normal);
    const int chart = tc_faces_chart(s->map, normal);
    const tc_chart *c = &s->map->chart[chart];
    c->class->from_place(c, x, y, &u, &w);
    u = fmin(fmax(u * (double)s->cells, 0), (double)s->cells);
    w = fmin(fmax(w * (double)s->cells, 0), (double)s->cells);
    tc_faces_direction(v, chart, u, w, d);
    body->class->offset(body, foot, d, o);
    for (int k = 0; k < 3; k++)
        n[k] = d[k] + (k == 2);
    tc_leaf leaf = tc_block_leaf_at(tree, chart, u, w);
    while (!holds(v, &leaf)) { /* the windows have moved since the tree was made */
        if (leaf.block.level == 1)
            return false;
        leaf = tc_block_leaf_above(&s->lattice, &leaf);
    }
    leaf_mesh m = {.view = v, .leaf = &leaf, .level = leaf.block.level - leaf.coarse};
    const tc_rect r = tc_faces_samples(&s->lattice, leaf.block);
    const int64_t cells = s->lattice.side[leaf.block.level - 1] >> leaf.coarse;
    m.cells = cells, m.x = r.x0 >> leaf.coarse, m.y = r.y0 >> leaf.coarse;
    m.cell = ldexp(1, s->lattice.levels - m.level);
    const int64_t i0 = tc_clamp64((int64_t)floor(u / m.cell), m.x, m.x + cells - 1),
                  j0 = tc_clamp64((int64_t)floor(w / m.cell), m.y, m.y + cells - 1);
    double inside, z = meet_cell(&m, i0, j0, o, n, &inside);
    /* Vertices that pass over lie beside their places. */
    for (int k = 0; k < 9 && inside < 0; k++) {
        const int64_t i = i0 + k % 3 - 1, j = j0 + k / 3 - 1;
        double its;
        if (i < m.x || j < m.y || i >= m.x + cells || j >= m.y + cells)
            continue;
        double there = meet_cell(&m, i, j, o, n, &its);
        if (its > inside)
            inside = its, z = there;
    }
    *z_ret = z;
    return isfinite(z);
}

bool tc_faces_drawn_height(const tc_view *head, double x, double y, double *z_ret)
{
    const faces_view *v = (const faces_view *)head;
    return tc_faces_height_in(v, v->all ? &v->tree : &v->held, x, y, z_ret);
}
