/* rings_map.c - the map transform in double: from the static geometry to the charts, and the heights drawn.
 *
 * The oracle of shaders/rings.glsl, which does the same in float. */
#include <math.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "rings_internal.h"

/* Longitude and colatitude relative to the viewer's, without cancellation (the design, section 7). */
static void relative_angles(const rings_view *v, double s_x, double s_y, double h, double *dphi_ret, double *dtheta_ret)
{
    double c = 1 - h, st = v->sin_theta, ct = v->cos_theta;
    double px = ct * s_x + st * c, pz = -st * s_x + ct * c, rho = hypot(px, s_y);
    double sine = px >= 0 ? s_x + (rho + px > 0 ? ct * s_y * s_y / (rho + px) : 0) : rho * ct - pz * st;
    *dphi_ret = atan2(s_y, px);
    *dtheta_ret = atan2(sine, rho * st + pz * ct);
}

/* z of a direction in the frame of the viewer's meridian, and how much it is above the viewer's. */
static double rise(const rings_view *v, double s_x, double h)
{
    return -v->sin_theta * s_x - v->cos_theta * h;
}

void tc_rings_map(const rings_view *view, int chart, double s_x, double s_y, double h, double *du_ret, double *dv_ret)
{
    const tc_chart *c = &tc_rings_of(view)->map->chart[chart];
    double dx, dy;
    if (c->class == &tc_chart_lonlat) {
        relative_angles(view, s_x, s_y, h, &dx, &dy);
        dy = -dy;
        if (view->partial && !c->wraps) { /* the way round on which it is nearer */
            rings_extent r = view->sides;
            dx += 2 * M_PI * rint((0.5 * (r.x0 + r.x1) * c->dx - dx) / (2 * M_PI));
        }
    } else {
        const double *k = view->place[chart].c;
        double pz = view->cos_theta + rise(view, s_x, h),
               scale = 2 / (1 + (c->class == &tc_chart_north_cap ? pz : -pz));
        double x = scale * (k[0] * s_x + k[1] * h + k[2]), y = scale * s_y;
        dx = view->cos_lambda * x - view->sin_lambda * y;
        dy = view->sin_lambda * x + view->cos_lambda * y;
    }
    *du_ret = dx / c->dx;
    *dv_ret = dy / c->dy;
}

void tc_rings_weights(const rings_view *view, double s_x, double h, double weight_ret[TC_MAX_CHARTS])
{
    const double normal[3] = {0, 0, view->cos_theta + rise(view, s_x, h)}; /* caps look at no more */
    tc_map_shares(tc_rings_of(view)->map, normal, weight_ret);
}

double tc_rings_passed(const rings_view *view, int stage, double w)
{
    if (!view->throttled)
        return 0;
    /* In float, as the shaders do: what has passed is left out. */
    float past = (float)w - view->front[stage];
    if (view->head.options.no_morph)
        return past >= 1;
    return fminf(fmaxf(past, 0), 1) * view->ease;
}

int tc_rings_stage(const rings_view *view, int i)
{
    int stage = 0;
    while (stage < RINGS_STAGES && tc_rings_passed(view, stage, i) >= 1)
        stage++;
    return stage;
}

double tc_rings_shift(const rings_view *view, double w, int coarser)
{
    double shift = fmax(0, tc_rings_of(view)->shift_base + 1 - w + coarser);
    return view->head.options.no_morph ? floor(shift) : shift;
}

int tc_rings_coarser(const rings_view *view, double w, double *share_ret)
{
    double coarser = 0;
    for (int stage = 0; stage < RINGS_STAGES; stage++)
        coarser += tc_rings_passed(view, stage, w);
    *share_ret = coarser - floor(coarser);
    return (int)floor(coarser);
}

rings_sample tc_rings_find(const rings_view *view, int chart, double du, double dv, double shift)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(view, chart);
    const rings_place *at = &view->place[chart];
    int levels = tc_clipmap_levels(clipmap), finest = tc_clipmap_level(clipmap, levels)->shift;
    int k = (int)fmin(fmax(floor(shift), finest), finest + levels - 1);
    double alpha = fmin(fmax(shift - k, 0), 1), fade = RINGS_PASSAGE / tc_clipmap_n(clipmap);
    for (; k < finest + levels; k++, alpha = 0) {
        int level = levels - (k - finest);
        rings_extent r = tc_rings_held(clipmap, level);
        double u = ldexp(at->x + du, -k), v = ldexp(at->y + dv, -k);
        double inside = fmin(fmin(u - r.x0, r.x1 - u), fmin(v - r.y0, r.y1 - v));
        if (inside < 0)
            continue;
        if (level > 1)
            alpha = fmax(alpha, 1 - inside * fade);
        else
            alpha = 0;
        return (rings_sample){level, alpha, u, v};
    }
    return (rings_sample){0};
}

rings_extent tc_rings_lattice(const tc_clipmap *clipmap, int level)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    tc_level size = tc_field_level(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, level));
    bool wraps = l->extent.x0 < 0;
    int64_t x1 = wraps ? l->clip.x1 : tc_min64(l->clip.x1, size.width), y1 = tc_min64(l->clip.y1, size.height);
    return (rings_extent){(double)l->clip.x0, (double)l->clip.y0, (double)x1 - 1, (double)y1 - 1};
}

rings_extent tc_rings_held(const tc_clipmap *clipmap, int level)
{
    const tc_clip_level *l = tc_clipmap_level(clipmap, level);
    rings_extent r = tc_rings_lattice(clipmap, level);
    if (l->clip.x1 == l->extent.x1)
        r.x1 = ldexp((double)l->edge_x, -l->shift);
    if (l->clip.y1 == l->extent.y1)
        r.y1 = ldexp((double)l->edge_y, -l->shift);
    return r;
}

/* Brings a place beside a part of a globe to its side; the share of the height there that is left, since what is
 * outside comes down to the sphere within about a cell of the mesh. */
static double come_inside(const rings_view *view, double h, double *du, double *dv)
{
    const tc_chart *c = &tc_rings_of(view)->map->chart[0];
    rings_extent r = view->sides;
    double u = c->wraps ? *du : fmin(fmax(*du, r.x0), r.x1), v = fmin(fmax(*dv, r.y0), r.y1);
    double across = (*du - u) * c->dx * view->sin_theta, along = (*dv - v) * c->dy;
    if (along > 0 ? view->north : view->south)
        along = 0;
    *du = u, *dv = v;
    return across != 0 || along != 0 ? fmax(0, 1 - hypot(across, along) / (RINGS_APRON * sqrt(2 * h))) : 1;
}

double tc_rings_sample_height(const rings_view *view, int chart, const rings_sample *sample)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(view, chart);
    int64_t mask = tc_clipmap_n(clipmap);
    rings_extent r = tc_rings_lattice(clipmap, sample->level);
    double i = fmax(fmin(floor(sample->u), r.x1 - 1), r.x0), j = fmax(fmin(floor(sample->v), r.y1 - 1), r.y0);
    double t[2] = {fmin(sample->u - i, fmin(1, r.x1 - i)), fmin(sample->v - j, fmin(1, r.y1 - j))}, z[4];
    for (int k = 0; k < 4; k++) {
        int64_t x = ((int64_t)i + (k & 1)) & mask, y = ((int64_t)j + (k >> 1)) & mask;
        const float *q = tc_ground_heights(clipmap, sample->level)[y * (mask + 1) + x];
        z[k] = (1 - sample->alpha) * (double)q[0] + sample->alpha * (double)q[1];
    }
    double south = z[0] + t[0] * (z[1] - z[0]), north = z[2] + t[0] * (z[3] - z[2]);
    return south + t[1] * (north - south);
}

double tc_rings_height(const rings_view *view, double s_x, double s_y, double h, double w, int coarser)
{
    double weight[TC_MAX_CHARTS], z = 0, outside = tc_rings_of(view)->outside;
    double shift = tc_rings_shift(view, w, coarser);
    tc_rings_weights(view, s_x, h, weight);
    for (int chart = 0; chart < view->head.windows->charts; chart++) {
        if (weight[chart] <= 0)
            continue;
        double du, dv;
        tc_rings_map(view, chart, s_x, s_y, h, &du, &dv);
        double share = view->partial ? come_inside(view, h, &du, &dv) : 1;
        rings_sample at = share > 0 ? tc_rings_find(view, chart, du, dv, shift) : (rings_sample){0};
        double there = at.level ? tc_rings_sample_height(view, chart, &at) : outside;
        z += weight[chart] * (outside + share * (there - outside));
    }
    return z;
}

/* A ring, or the disc inside the finest one. */
typedef struct mesh_part {
    int i;              /* the ring; of the disc one more than the finest */
    double edge, depth; /* angle from the foot point of row 0; share of it that the rows go inwards */
    double w, w_depth;  /* ring coordinate, likewise */
    int last;           /* row */
} mesh_part;

static mesh_part part_of(const rings_view *view, int i)
{
    const rings_geometry *g = &tc_rings_of(view)->geometry;
    if (i > view->finest)
        return (mesh_part){view->finest + 1, ldexp(M_PI, -view->finest - 1), 1, view->finest + 1, 0, g->fill};
    return (mesh_part){i, ldexp(M_PI, -i), 0.5, i, 1, g->m};
}

/* How far the body's place of a direction around the viewer is from that of a sphere through the foot point, of the
 * radius that it has at the equator; in the frame of the viewer. */
static void departure(const rings_view *view, double s_x, double s_y, double h, double p[3])
{
    const tc_body *body = &tc_rings_of(view)->map->body;
    const double place[3] = {view->head.camera.x, view->head.camera.y, 0}, d[3] = {s_y, -s_x, -h};
    double offset[3];
    body->class->offset(body, place, d, offset);
    p[0] = -(offset[1] - body->radius * d[1]);
    p[1] = offset[0] - body->radius * d[0];
    p[2] = offset[2] - body->radius * d[2];
}

/* Vertex of the mesh that is drawn once stages before `stage` have left theirs out, from the middle of that sphere: on
 * its way to where the next stage has it, or to the middle of its neighbours there. */
static void mesh_vertex(const rings_view *view, const mesh_part *part, int row, int column, int stage, double p[3])
{
    const rings_geometry *g = &tc_rings_of(view)->geometry;
    double theta = part->edge * (1 - part->depth * row / part->last), phi = 2 * M_PI * column / g->n_phi;
    double half = sin(theta / 2), h = 2 * half * half, sx = sin(theta) * cos(phi), sy = sin(theta) * sin(phi);
    double w = part->w + part->w_depth * row / part->last;
    double passed = stage < RINGS_STAGES ? tc_rings_passed(view, stage, w) : 0;
    if (passed < 1) {
        double r = view->radius + tc_rings_height(view, sx, sy, h, w, stage);
        departure(view, sx, sy, h, p);
        p[0] += r * sx, p[1] += r * sy, p[2] += r * (1 - h);
    }
    if (passed <= 0)
        return;
    int columns = g->n_phi / g->sectors;
    int rows = tc_rings_stage_of(row, part->last) == stage ? 1 << stage : 0;
    int across = tc_rings_stage_of(column % columns, columns) == stage ? 1 << stage : 0;
    double a[3], b[3];
    mesh_vertex(view, part, row + rows, column - across, stage + 1, a);
    mesh_vertex(view, part, row - rows, column + across, stage + 1, b);
    for (int i = 0; i < 3; i++)
        p[i] = (passed < 1 ? (1 - passed) * p[i] : 0) + passed * 0.5 * (a[i] + b[i]);
}

/* Where the ray from the origin along d meets the triangle's plane; *inside_ret: at least this far within, in shares of
 * its corners. */
static double meet(const double d[3], const double a[3], const double b[3], const double c[3], double *inside_ret)
{
    /* d = x a + y b + z c by Cramer's rule; the plane is x + y + z = 1. */
    double bc[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    double ca[3] = {c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]};
    double ab[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    double det = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
    double x = (d[0] * bc[0] + d[1] * bc[1] + d[2] * bc[2]) / det;
    double y = (d[0] * ca[0] + d[1] * ca[1] + d[2] * ca[2]) / det;
    double z = (d[0] * ab[0] + d[1] * ab[1] + d[2] * ab[2]) / det;
    double sum = x + y + z;
    *inside_ret = det == 0 ? -INFINITY : fmin(fmin(x, y), z) / sum;
    return 1 / sum;
}

/* Distance from `from` at which the ray from there along d meets a cell's triangles, or would if they were larger;
 * how far inside of them. A row above 0 or beyond the part's last is another part's. */
static double meet_cell(const rings_view *view, const double d[3], const double from[3], mesh_part part, int row,
                        int column, double *inside_ret)
{
    double p[4][3], in[2];
    *inside_ret = -INFINITY;
    if (row < 0 || row >= part.last) {
        if (row < 0 ? part.i == 0 : part.i > view->finest)
            return NAN;
        part = part_of(view, part.i + (row < 0 ? -1 : 1));
        row = row < 0 ? part.last - 1 : 0;
    }
    for (int k = 0; k < 4; k++) {
        mesh_vertex(view, &part, row + (k & 1), column + (k >> 1), 0, p[k]);
        for (int i = 0; i < 3; i++)
            p[k][i] -= from[i];
    }
    bool middle = part.i > view->finest && row + 1 == part.last;
    double r0 = meet(d, p[0], p[1], p[2], &in[0]);
    double r1 = middle ? (in[1] = -INFINITY, 0) : meet(d, p[1], p[3], p[2], &in[1]);
    *inside_ret = fmax(in[0], in[1]);
    return in[0] >= in[1] ? r0 : r1;
}

bool tc_rings_drawn_height(const tc_view *head, double x, double y, double *z_ret)
{
    const rings_view *view = (const rings_view *)head;
    const rings_surface *s = tc_rings_of(view);
    const rings_geometry *g = &s->geometry;
    const tc_camera *camera = &head->camera;
    /* Polar coordinates around the viewer, by half angles. */
    double dlat = y - camera->y, dlon = x - camera->x, sl = sin(dlon / 2), sp = sin(dlat / 2);
    double h = 2 * (sp * sp + cos(y) * cos(camera->y) * sl * sl);
    double sy = cos(y) * sin(dlon), sx = -(sin(dlat) + 2 * sin(camera->y) * cos(y) * sl * sl);
    double theta = 2 * asin(fmin(1, sqrt(h / 2))), phi = atan2(sy, sx);
    double d[3] = {sx, sy, 1 - h}, middle[3]; /* where all heights along this normal are counted from */
    departure(view, sx, sy, h, middle);
    if (phi < 0)
        phi += 2 * M_PI;
    int column = (int)fmin(floor(phi / (2 * M_PI) * g->n_phi), g->n_phi - 1);
    int i = theta > 0 ? (int)fmax(0, fmin(floor(log2(M_PI / theta)), 1000)) : 1000;
    mesh_part part = part_of(view, i);
    int row = (int)fmin(fmax(floor((1 - theta / part.edge) * part.last / part.depth), 0), part.last - 1);
    double inside, r = meet_cell(view, d, middle, part, row, column, &inside);
    /* What has passed over is not where it was: at most a row and, inside the disc, some columns beside. And next to an
     * edge of a large cell a normal may come through the mesh beside it. */
    enum { BESIDE = 1 << RINGS_STAGES };
    for (int k = 1; k < 3 * (2 * BESIDE + 1) && inside < (view->throttled ? 0 : -1e-9); k++) {
        int rows = k % 3 == 0 ? 0 : k % 3 == 1 ? -1 : 1, across = (k / 3 + 1) / 2 * (k / 3 & 1 ? 1 : -1);
        double its, there = meet_cell(view, d, middle, part, row + rows, (column + across + g->n_phi) % g->n_phi, &its);
        if (its > inside)
            inside = its, r = there;
    }
    *z_ret = r - view->radius + tc_field_info(s->map->chart[0].field)->z_base;
    return isfinite(*z_ret);
}
