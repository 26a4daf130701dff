/* faces_view.c - where the viewer is: on the charts, above what ground, which blocks and windows follow from that. */
#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "common/view/camera.h"
#include "common/base/mesh.h"
#include "faces_internal.h"

/* ---- Places ----------------------------------------------------------------------------------------------------- */

void tc_faces_direction(const faces_view *v, int chart, double u, double w, double d[3])
{
    const faces_surface *s = tc_faces_of(v);
    const tc_chart *c = &s->map->chart[chart];
    const double cells = (double)s->cells;
    double lon, lat;
    c->class->to_place(c, u / cells, w / cells, &lon, &lat);
    /* By half angles, so that what is next to the viewer keeps its digits. */
    double dlon = lon - v->place[0], dlat = lat - v->place[1], sl = sin(dlon / 2), sp = sin(dlat / 2);
    d[0] = cos(lat) * sin(dlon);
    d[1] = sin(dlat) + 2 * sin(v->place[1]) * cos(lat) * sl * sl;
    d[2] = -2 * (sp * sp + cos(lat) * cos(v->place[1]) * sl * sl);
}

void tc_faces_normal(const faces_surface *s, int chart, double u, double w, double n[3])
{
    const tc_chart *c = &s->map->chart[chart];
    c->class->normal(c, u / (double)s->cells, w / (double)s->cells, n);
}

void tc_faces_roughly(const faces_view *v, int chart, double u, double w, double d[3])
{
    double n[3];
    tc_faces_normal(tc_faces_of(v), chart, u, w, n);
    for (int k = 0; k < 3; k++)
        d[k] = v->axes[k][0] * n[0] + v->axes[k][1] * n[1] + v->axes[k][2] * n[2];
    d[2] = fmin(d[2] - 1, 0);
}

faces_spot tc_faces_spot(double u, double v)
{
    const double at[2] = {rint(u), rint(v)};
    return (faces_spot){{(int64_t)at[0], (int64_t)at[1]}, {u - at[0], v - at[1]}};
}

/* An arc's height above its chord. Beside a pole of a sheared chart parallels are arcs as well, which matters as far as
 * the ground is steep. */
double tc_faces_sag(const faces_view *v, double edge, double from_pole)
{
    return edge * edge / 8 * (1 + tc_faces_of(v)->kind->bends / fmax(from_pole, edge));
}

double tc_faces_range(const faces_view *v, int level)
{
    const faces_surface *s = tc_faces_of(v);
    const double range = ldexp(v->range, s->lattice.levels - level);
    if (level <= s->own)
        return range;
    /* On the data's mesh: for as long as the next coarser level is seen to be off. */
    return fmin(range, tc_faces_sag(v, ldexp(v->edge, s->own + 1 - level), v->from_pole) / v->sag);
}

tc_rect tc_faces_samples(const tc_block_lattice *lattice, tc_block b)
{
    const int64_t side = lattice->side[b.level - 1];
    return (tc_rect){b.x * side, b.y * side, (b.x + 1) * side + 1, (b.y + 1) * side + 1};
}

int tc_faces_window(const faces_surface *s, int level, tc_rect *r)
{
    const int finer = level - s->own;
    if (finer <= 0)
        return level;
    *r = (tc_rect){tc_floor_shift(r->x0, finer), tc_floor_shift(r->y0, finer), tc_ceil_shift(r->x1 - 1, finer) + 1,
                   tc_ceil_shift(r->y1 - 1, finer) + 1};
    return s->own;
}

/* ---- Ground ----------------------------------------------------------------------------------------------------- */

int tc_faces_chart(const tc_map *map, const double normal[3])
{
    double share[TC_MAP_CHARTS];
    tc_map_shares(map, normal, share);
    int chart = 0;
    while (chart + 1 < map->charts && share[chart] <= 0)
        chart++;
    return chart;
}

/* What counts of a height above the ground, metres. */
static double counts(const faces_view *v, double height)
{
    return FACES_HEIGHT_SHARE * height / v->radius;
}

/* Height above the ground that windows hold, metres: of level after level for as long as the eye is low enough for it
 * to be drawn. A level by whose own ground it would be too high says nothing, or it would be dropped and wanted in
 * turns. */
static double held_height(const faces_view *v)
{
    const faces_surface *s = tc_faces_of(v);
    const double middle[3] = {0, 0, 0};
    const int chart = tc_faces_chart(s->map, v->axes[2]);
    const tc_clipmap *clipmap = v->head.windows->clipmap[chart];
    double height = 0;
    for (int level = 1; level <= s->own; level++) {
        const tc_clip_level *l = tc_clipmap_level(clipmap, level);
        if (level > 1 && s->kind->distance(middle, counts(v, height)) > tc_faces_range(v, level))
            break;
        const int64_t last = tc_block_cells(&s->lattice, level), mask = tc_clipmap_n(clipmap);
        const double scale = (double)last / (double)s->cells, u = v->chart[chart][0] * scale,
                     w = v->chart[chart][1] * scale;
        const int64_t i = tc_clamp64((int64_t)floor(u), 0, last - 1), j = tc_clamp64((int64_t)floor(w), 0, last - 1);
        if (!tc_rect_contains(l->active, i, j) || !tc_rect_contains(l->active, i + 1, j + 1))
            continue;
        double z[4];
        for (int k = 0; k < 4; k++)
            z[k] = tc_ground_heights(clipmap, level)[((j + (k >> 1)) & mask) * (mask + 1) + ((i + (k & 1)) & mask)][0];
        double own = fabs(v->z_eye - tc_triangle_height(z[0], z[1], z[2], z[3], u - (double)i, w - (double)j));
        if (level == 1 || s->kind->distance(middle, counts(v, own)) <= tc_faces_range(v, level))
            height = own;
    }
    return height;
}

/* ---- Horizon ---------------------------------------------------------------------------------------------------- */

/* Angle by which normals turn up to where a body of ground so high is seen edge-on from a place so high, metres above
 * z_base. What is as curved as a ball of its least radius or less is touched no farther away than the ball, by that
 * angle; chords lie below it as those of one of its most. */
static double edge_on(const faces_view *v, double ground, double sag, double place)
{
    double least, most;
    const tc_body *body = &tc_faces_of(v)->map->body;
    body->class->curvatures(body, &least, &most);
    const double z_base = v->radius - body->radius;
    const double low = fmax((most + z_base + ground) * sag - (most - least), 0), high = least + z_base + place;
    return acos(fmin(1, low / fmax(high, low)));
}

/* What hides is the lowest ground, less the sag of the coarsest mesh's chords. */
double tc_faces_horizon(const faces_view *v, double z_eye)
{
    const faces_surface *s = tc_faces_of(v);
    const double step = FACES_LONGEST * s->cell * (double)(s->cells / tc_block_cells(&s->lattice, 1)),
                 sag = cos(fmin(0.5 * step, M_PI / 2));
    return edge_on(v, s->z_lo, sag, z_eye) + edge_on(v, s->z_lo, sag, s->z_hi);
}

/* ---- Blocks ----------------------------------------------------------------------------------------------------- */

/* What is known of a tree while it is made. */
typedef struct growing {
    const faces_view *view;
    const int *ready; /* NULL: as many levels as there are, each as far as a window can reach */
} growing;

static bool wanted_before(void *context, tc_block b)
{
    const growing *g = context;
    return tc_block_asked(&g->view->tree, b);
}

/* d at one of 3 x 3 places on a block. */
static void place_on(const faces_view *v, tc_block b, int k, double d[3])
{
    const double block = (double)tc_faces_of(v)->cells / tc_faces_of(v)->lattice.blocks[b.level - 1][0];
    tc_faces_roughly(v, b.chart, (b.x + 0.5 * (k % 3)) * block, (b.y + 0.5 * (int)(k / 3)) * block, d);
}

static double distance_at(const faces_view *v, tc_block b, int k)
{
    double d[3];
    place_on(v, b, k, d);
    return tc_faces_of(v)->kind->distance(d, v->height);
}

enum { SOUTH_WEST = 0, SOUTH_EAST = 2, MIDDLE = 4, NORTH_WEST = 6, NORTH_EAST = 8, PLACES = 9 };

/* Half of its longer diagonal. */
static double half_diagonal(const faces_view *v, tc_block b)
{
    double sw[3], se[3], nw[3], ne[3], up = 0, down = 0;
    place_on(v, b, SOUTH_WEST, sw), place_on(v, b, SOUTH_EAST, se);
    place_on(v, b, NORTH_WEST, nw), place_on(v, b, NORTH_EAST, ne);
    for (int k = 0; k < 3; k++)
        up += (ne[k] - sw[k]) * (ne[k] - sw[k]), down += (nw[k] - se[k]) * (nw[k] - se[k]);
    return 0.5 * sqrt(fmax(up, down));
}

/* As far as the nearest of its places: hexagons have corners, of which one may lie between two of them by 0.06 of the
 * range at most, which is then drawn by the coarser level.
 *
 * A level on the data's mesh may have a range of less than a block, and the next finer one a quarter of it. A block is
 * split only where all around it are there, whose middles lie up to two of its half diagonals h further away than its
 * own, and that from those of its parts by half of one: so beyond the range the finest level is wanted within its h,
 * the next one within h / 2 + 2 h + h / 2, and so on, which goes towards 5 h. */
static bool near_enough(const faces_view *v, tc_block b, double range)
{
    const faces_surface *s = tc_faces_of(v);
    const double middle = distance_at(v, b, MIDDLE);
    if (middle < range)
        return true;
    if (b.level > s->own)
        return b.level <= v->finest &&
               middle < range + 1.05 * (5 - ldexp(4, b.level - v->finest)) * half_diagonal(v, b);
    if (middle >= range + FACES_LONGEST * M_PI / 2 / s->lattice.blocks[b.level - 1][0])
        return false;
    for (int k = 0; k < PLACES; k++)
        if (distance_at(v, b, k) < range)
            return true;
    return false;
}

static bool wanted(void *context, tc_block b)
{
    const faces_view *v = ((const growing *)context)->view;
    const double range = tc_faces_range(v, b.level);
    if (!tc_faces_by_error(v))
        return near_enough(v, b, range);
    return (b.level > tc_faces_of(v)->own || near_enough(v, b, range)) && tc_faces_want_by_error(v, b);
}

/* For normals and colours alone, which have no levels beyond the data's. */
static bool shown(void *context, tc_block b)
{
    const faces_view *v = ((const growing *)context)->view;
    const faces_surface *s = tc_faces_of(v);
    return b.level <= s->own && near_enough(v, b, tc_faces_range(v, b.level) * (s->shaded / s->range));
}

static bool held(void *context, tc_block b)
{
    const growing *g = context;
    const faces_view *v = g->view;
    if (!g->ready)
        return true;
    if (!v->sight[b.chart]) /* nobody will see what it lacks */
        return true;
    tc_rect samples = tc_faces_samples(&tc_faces_of(v)->lattice, b);
    const int level = tc_faces_window(tc_faces_of(v), b.level, &samples);
    return level <= g->ready[b.chart] &&
           tc_rect_within(samples, tc_clipmap_level(v->head.windows->clipmap[b.chart], level)->active);
}

void tc_faces_tree(const faces_view *v, const int ready[TC_MAX_CHARTS], tc_block_tree *tree)
{
    growing g = {v, ready};
    const tc_block_rule rule = {ready ? wanted_before : wanted, held, &g};
    tc_block_tree_make(tree, &tc_faces_of(v)->lattice, &rule);
}

/* Blocks whose normals and colours are called for by distance alone. */
static void make_shading(const faces_view *v)
{
    growing g = {v, NULL};
    const tc_block_rule rule = {shown, held, &g};
    tc_block_tree_make(v->shading, &tc_faces_of(v)->lattice, &rule);
}

/* Samples of all that a tree has of a chart's level; empty: nothing. */
static tc_rect samples_called_for(const faces_view *v, const tc_block_tree *tree, int chart, int level)
{
    tc_rect blocks;
    const int64_t side = tc_faces_of(v)->lattice.side[level - 1];
    if (!tc_block_bounds(tree, chart, level, &blocks))
        return (tc_rect){0, 0, 0, 0};
    return (tc_rect){blocks.x0 * side, blocks.y0 * side, blocks.x1 * side + 1, blocks.y1 * side + 1};
}

bool tc_faces_all_held(const faces_view *v, int chart)
{
    for (int level = 2; level <= tc_faces_of(v)->own && v->sight[chart]; level++)
        if (!tc_rect_within(samples_called_for(v, &v->tree, chart, level),
                            tc_clipmap_level(v->head.windows->clipmap[chart], level)->active))
            return false;
    return true;
}

/* Whether any block of a chart's coarsest level is this side of the horizon. */
static bool in_sight(const faces_view *v, int chart)
{
    const faces_surface *s = tc_faces_of(v);
    const double block = (double)s->cells / s->lattice.blocks[0][0];
    for (int32_t y = 0; y <= s->lattice.blocks[0][0]; y++)
        for (int32_t x = 0; x <= s->lattice.blocks[0][0]; x++) {
            double d[3];
            tc_faces_roughly(v, chart, x * block, y * block, d);
            /* As far as to a block's middle, wherever that is. */
            if (2 * asin(fmin(0.5 * sqrt(-2 * d[2]), 1)) < v->horizon + FACES_LONGEST * block * s->cell)
                return true;
        }
    return false;
}

/* ---- The view --------------------------------------------------------------------------------------------------- */

void tc_faces_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options, bool wait, tc_view *view)
{
    const faces_surface *s = (const faces_surface *)surface;
    faces_view *v = (faces_view *)view;
    const double z_base = tc_field_info(surface->field)->z_base, at[3] = {camera->x, camera->y, camera->z};
    v->head = tc_view_of(surface, windows, camera, options);
    v->place[0] = camera->x, v->place[1] = camera->y;
    s->map->body.class->axes(&s->map->body, at, v->axes);
    v->z_eye = camera->z - z_base;
    v->radius = s->map->body.radius + z_base;
    const double coarser = exp2(-fmax(options->throttle, 0)), rho = hypot(v->axes[2][0], v->axes[2][1]);
    v->range = s->range * coarser;
    v->edge = FACES_LONGEST * ldexp(s->cell, s->head.refined);
    v->sag = FACES_SAG / tc_camera_pixel_scale(camera) / coarser;
    v->from_pole = rho; /* of what lies within the range that follows from that */
    for (int k = 0; k < 4; k++)
        v->from_pole = fmax(rho - tc_faces_sag(v, v->edge, v->from_pole) / v->sag, 0);
    for (int k = 0; k < s->map->charts; k++) {
        const tc_chart *c = &s->map->chart[k];
        c->class->from_place(c, camera->x, camera->y, &v->chart[k][0], &v->chart[k][1]);
        v->chart[k][0] *= (double)s->cells, v->chart[k][1] *= (double)s->cells;
    }
    double ground = 0;
    if (wait && tc_map_height(s->map, camera->x, camera->y, &ground))
        ground = z_base + s->z_lo;
    v->above = wait ? fabs(camera->z - ground) : held_height(v);
    v->height = counts(v, v->above);
    v->finest = s->own;
    while (v->finest < s->lattice.levels && v->height < tc_faces_range(v, v->finest + 1))
        v->finest++;
    v->horizon = tc_faces_horizon(v, v->z_eye);
    for (int k = 0; k < s->map->charts; k++)
        v->sight[k] = options->no_cull || in_sight(v, k);
    v->error = s->head.by_error ? &((faces_error_view *)v)->error : NULL;
    v->shading = s->head.by_error ? &((faces_error_view *)v)->shading : NULL;
    if (v->error)
        tc_faces_begin_errors(v);
    tc_faces_tree(v, NULL, &v->tree);
    if (v->shading)
        make_shading(v);
    int levels[TC_MAX_CHARTS] = {0};
    v->all = true;
    for (int chart = 0; chart < s->map->charts; chart++) {
        levels[chart] = s->own;
        v->all &= tc_faces_all_held(v, chart);
    }
    if (!v->all)
        tc_faces_tree(v, levels, &v->held);
}

/* A window no larger than it may be, in the middle of what is wanted. */
static tc_rect window(tc_rect r, int n)
{
    const int64_t too_wide = r.x1 - r.x0 - n, too_high = r.y1 - r.y0 - n;
    if (too_wide > 0)
        r.x0 += (too_wide / 2 + 1) & ~(int64_t)1, r.x1 = tc_min64(r.x0 + n, r.x1);
    if (too_high > 0)
        r.y0 += (too_high / 2 + 1) & ~(int64_t)1, r.y1 = tc_min64(r.y0 + n, r.y1);
    return r;
}

void tc_faces_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    const faces_view *v = (const faces_view *)view;
    const faces_surface *s = tc_faces_of(v);
    for (int chart = 0; chart < s->map->charts; chart++) {
        memset(wanted[chart], 0, sizeof wanted[chart]);
        if (!v->sight[chart])
            continue;
        const tc_clipmap *clipmap = v->head.windows->clipmap[chart];
        wanted[chart][0] = tc_clipmap_level(clipmap, 1)->extent;
        for (int level = 2; level <= s->own; level++)
            wanted[chart][level - 1] = window(
                tc_rect_around(samples_called_for(v, &v->tree, chart, level),
                               v->shading ? samples_called_for(v, v->shading, chart, level) : (tc_rect){0, 0, 0, 0}),
                tc_clipmap_n(clipmap));
    }
}

bool tc_faces_stand(const tc_view *view, int chart, const double texel[2], tc_standing *at)
{
    const faces_view *v = (const faces_view *)view;
    const faces_surface *s = tc_faces_of(v);
    const double cells = (double)s->cells, kx = 1 / (cells * texel[0]), ky = 1 / (cells * texel[1]);
    const double far = FACES_LONGEST * v->horizon / s->cell; /* cells */
    double x[2];
    if (!v->sight[chart])
        return false;
    for (int a = 0; a < 2; a++)
        x[a] = fmin(fmax(v->chart[chart][a], 0), cells);
    *at = (tc_standing){.x = x[0] * kx,
                        .y = x[1] * ky,
                        .per_place = {1 / texel[0], 1 / texel[1]}, /* places are chart coordinates */
                        .lo = {-fmin(far, x[0]) * kx, -fmin(far, x[1]) * ky},
                        .hi = {fmin(far, cells - x[0]) * kx, fmin(far, cells - x[1]) * ky},
                        .texel = texel[1] * cells * s->cell * v->radius,
                        .distance = v->above};
    return true;
}
