/* rings_view.c - where the viewer is: on the charts, above what ground, and which levels and windows follow from that.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "common/field/field.h"
#include "rings_internal.h"

#define DEGREE (M_PI / 180)

/* ---- On the charts --------------------------------------------------------------------------------------------- */

/* Turns by which a chart's windows are to begin anew. Numbers of columns go on with a viewer who goes around; before
 * there are so many turns that they lose digits, windows are read again in the first two. An even number: so is the
 * first column of every window. */
static int64_t turns_back(const tc_chart *c, double x)
{
    enum { MOST = 16 };
    int64_t turns = 2 * (int64_t)floor(x * c->dx / (4 * M_PI));
    return llabs(turns) > MOST ? turns : 0;
}

static rings_place place_lonlat(const rings_view *v, int chart)
{
    const tc_camera *camera = &v->head.camera;
    const tc_chart *c = &tc_rings_of(v)->map->chart[chart];
    rings_place at = {.x = (camera->x - c->x0) / c->dx, .y = (camera->y - c->y0) / c->dy, .near = true};
    tc_level size = tc_field_level(c->field, tc_field_info(c->field)->levels);
    double middle = 0.5 * (double)(size.width - 1), period = 2 * M_PI / c->dx;
    if (c->wraps) { /* the number of the viewer's column that is next to what is held already */
        const tc_clip_level *l = tc_clipmap_level(tc_rings_clipmap(v, chart), 1);
        middle = ldexp(0.5 * (double)(l->clip.x0 + l->clip.x1), l->shift);
        period = (double)size.width;
        /* So short that all its numbers, for dozens of turns, are exact: pictures do not depend on which one it is.
         * Not shorter: next to steep ground micrometres count. */
        double grain = ldexp(1, ilogb(period) + 5 - 52);
        at.x = rint((at.x - period * floor(at.x / period)) / grain) * grain;
    }
    at.x += period * rint((middle - at.x) / period);
    if (c->wraps)
        at.x -= period * (double)turns_back(c, at.x);
    return at;
}

static rings_place place_cap(const rings_view *v, int chart)
{
    const tc_chart *c = &tc_rings_of(v)->map->chart[chart];
    bool north = c->class == &tc_chart_north_cap;
    double theta = north ? v->theta : M_PI - v->theta, t = tan(theta / 2);
    rings_place at = {.near = theta <= M_PI / 2};
    double x = at.near ? 2 * t : 0; /* along the viewer's meridian */
    at.x = (x * v->cos_lambda - c->x0) / c->dx;
    at.y = (x * v->sin_lambda - c->y0) / c->dy;
    if (at.near)
        at.c[0] = north ? 1 : -1, at.c[1] = -t;
    else
        at.c[0] = v->cos_theta, at.c[1] = -v->sin_theta, at.c[2] = v->sin_theta;
    return at;
}

/* Windows are wide enough for the geometry where a degree of longitude is shortest; elsewhere, and where frames are
 * large, they hold finer levels for colours and normals. */
static double finer_detail(const rings_surface *s, double latitude)
{
    const double limit = TC_CAP_BLEND_END * DEGREE;
    double lat = fabs(latitude), fits = 0.97 * cos(fmin(lat, limit));
    if (s->map->charts > 1 && lat > limit) /* on to the caps, where all directions are alike */
        fits += (0.93 - fits) * fmin(1, (lat - limit) / (16 * DEGREE));
    double samples = ldexp(M_PI / s->map->chart[0].dy, -s->shift_base); /* of a ring in the level that it reads */
    return fmax(0, log2(0.5 * (s->head.n - 11) * fits / (1.07 * samples)));
}

/* Sides of chart 0, once its place is known. */
static void set_sides(rings_view *v)
{
    const tc_map *map = tc_rings_of(v)->map;
    const tc_chart *c = &map->chart[0];
    tc_level size = tc_field_level(c->field, tc_field_info(c->field)->levels);
    double x = v->place[0].x, y = v->place[0].y, rows = (double)(size.height - 1);
    v->partial = map->charts == 1;
    v->south = c->y0 - 1.01 * c->dy < -M_PI / 2;
    v->north = c->y0 + (rows + 1.01) * c->dy > M_PI / 2;
    v->sides = (rings_extent){-x, -y, (double)(size.width - 1) - x, rows - y};
}

static void place(rings_view *v)
{
    const rings_surface *s = tc_rings_of(v);
    const tc_camera *camera = &v->head.camera;
    double z_base = tc_field_info(s->head.field)->z_base;
    v->theta = M_PI / 2 - camera->y;
    v->radius = s->map->body.radius + z_base;
    s->map->body.class->curvatures(&s->map->body, &v->least, &v->most);
    v->least += z_base, v->most += z_base;
    v->z_eye = camera->z - z_base;
    v->sin_theta = fmax(cos(camera->y), 0), v->cos_theta = sin(camera->y);
    v->detail = finer_detail(s, camera->y);
    v->cos_lambda = cos(camera->x), v->sin_lambda = sin(camera->x);
    for (int chart = 0; chart < s->map->charts; chart++)
        v->place[chart] = s->map->chart[chart].class == &tc_chart_lonlat ? place_lonlat(v, chart) : place_cap(v, chart);
    double weight[TC_MAX_CHARTS];
    tc_rings_weights(v, 0, 0, weight);
    for (int chart = 0; chart < s->map->charts; chart++) {
        v->place[chart].weight = weight[chart];
        v->near[chart].shift = -1;
    }
    set_sides(v);
}

/* ---- Ground ---------------------------------------------------------------------------------------------------- */

enum { AROUND = 6, BLOCK = 2 * AROUND, NEAR = 4 }; /* samples; slopes bound heights within NEAR of the viewer */

/* What a block of samples around the viewer, whose first one is at (i, j), says; w x h of them with this stride. */
static rings_near near_of(const float *z, int64_t w, int64_t h, int64_t stride, double u, double v, int shift)
{
    rings_near near = {.shift = shift};
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            double here = z[y * stride + x];
            if (x + 1 < w)
                near.steepest = fmax(near.steepest, fabs((double)z[y * stride + x + 1] - here));
            if (y + 1 < h)
                near.steepest = fmax(near.steepest, fabs((double)z[(y + 1) * stride + x] - here));
        }
    int64_t i = tc_clamp64((int64_t)floor(u), 0, tc_max64(w - 2, 0)), right = w > 1 ? 1 : 0;
    int64_t j = tc_clamp64((int64_t)floor(v), 0, tc_max64(h - 2, 0)), up = h > 1 ? stride : 0;
    const float *c = z + j * stride + i;
    double tu = u - (double)i, tv = v - (double)j, twist = (double)c[up + right] - c[up] - c[right] + c[0];
    near.slope[0] = (double)c[right] - c[0] + twist * tv;
    near.slope[1] = (double)c[up] - c[0] + twist * tu;
    near.slope[2] = twist;
    near.z = c[0] + tu * ((double)c[right] - c[0]) + tv * ((double)c[up] - c[0]) + tu * tv * twist;
    return near;
}

/* The ground around the viewer on a chart, from its pyramid. */
static rings_near read_near(const rings_view *v, int chart)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
    const tc_field *field = tc_clipmap_field(clipmap);
    int levels = tc_clipmap_levels(clipmap), shift = tc_clipmap_level(clipmap, levels)->shift;
    int level = tc_clipmap_field_level(clipmap, levels);
    double x = ldexp(v->place[chart].x, -shift), y = ldexp(v->place[chart].y, -shift);
    tc_level size = tc_field_level(field, level);
    bool wraps = tc_rings_of(v)->map->chart[chart].wraps;
    tc_rect r = {(int64_t)floor(x) - AROUND + 1, (int64_t)floor(y) - AROUND + 1, (int64_t)floor(x) + AROUND + 1,
                 (int64_t)floor(y) + AROUND + 1};
    tc_rect there = tc_rect_intersect(r, (tc_rect){wraps ? r.x0 : 0, 0, wraps ? r.x1 : size.width, size.height});
    float z[BLOCK * BLOCK];
    if (!v->place[chart].near || tc_rect_empty(there) || tc_field_read(field, level, there, z, NULL, BLOCK))
        return (rings_near){.shift = -1};
    return near_of(z, there.x1 - there.x0, there.y1 - there.y0, BLOCK, x - (double)there.x0, y - (double)there.y0,
                   shift);
}

/* The ground around a sample at the viewer's place, from its window. */
static rings_near held_near(const rings_view *v, int chart, const rings_sample *at)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
    rings_extent r = tc_rings_lattice(clipmap, at->level);
    int64_t i = (int64_t)floor(at->u), j = (int64_t)floor(at->v), mask = tc_clipmap_n(clipmap);
    tc_rect there = {tc_max64(i - AROUND + 1, (int64_t)r.x0), tc_max64(j - AROUND + 1, (int64_t)r.y0),
                     tc_min64(i + AROUND, (int64_t)r.x1) + 1, tc_min64(j + AROUND, (int64_t)r.y1) + 1};
    float z[BLOCK * BLOCK];
    for (int64_t y = there.y0; y < there.y1; y++)
        for (int64_t x = there.x0; x < there.x1; x++)
            z[(y - there.y0) * BLOCK + x - there.x0] =
                tc_ground_heights(clipmap, at->level)[(y & mask) * (mask + 1) + (x & mask)][0];
    return near_of(z, there.x1 - there.x0, there.y1 - there.y0, BLOCK, at->u - (double)there.x0,
                   at->v - (double)there.y0, tc_clipmap_level(clipmap, at->level)->shift);
}

/* The same as read_near() without reading: unknown where the finest level is not held around the viewer. */
static rings_near finest_near(const rings_view *v, int chart)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
    const tc_clip_level *l = tc_clipmap_level(clipmap, tc_clipmap_levels(clipmap));
    rings_sample at = {.level = tc_clipmap_levels(clipmap),
                       .u = ldexp(v->place[chart].x, -l->shift),
                       .v = ldexp(v->place[chart].y, -l->shift)};
    int64_t i = (int64_t)floor(at.u), j = (int64_t)floor(at.v);
    tc_rect around =
        tc_rect_intersect(l->extent, (tc_rect){i - AROUND + 1, j - AROUND + 1, i + AROUND + 1, j + AROUND + 1});
    rings_extent r = tc_rings_lattice(clipmap, at.level); /* which ends before the vertices of an edge */
    bool beside = (double)around.x0 > r.x1 || (double)around.y0 > r.y1;
    if (!v->place[chart].near || tc_rect_empty(around) || beside || !tc_rect_within(around, l->clip))
        return (rings_near){.shift = -1};
    return held_near(v, chart, &at);
}

void tc_rings_ground(rings_view *v)
{
    double share;
    int coarser = tc_rings_coarser(v, v->finest + 1, &share);
    double shift = tc_rings_shift(v, v->finest + 1, coarser), next = tc_rings_shift(v, v->finest + 1, coarser + 1);
    v->z = 0;
    for (int chart = 0; chart < v->head.windows->charts; chart++) {
        const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
        rings_sample at = tc_rings_find(v, chart, 0, 0, shift);
        /* Beside the terrain, and on its last fraction of a cell, no slopes hold. */
        v->near[chart] = (rings_near){.shift = -1, .z = tc_rings_of(v)->outside};
        if (at.level && v->place[chart].near) {
            rings_extent r = tc_rings_lattice(clipmap, at.level);
            v->near[chart] = held_near(v, chart, &at);
            v->near[chart].z = tc_rings_sample_height(v, chart, &at);
            bool mixed = at.alpha > 0; /* of two levels, which no slopes describe */
            if (share > 0 && next > shift) {
                rings_sample other = tc_rings_find(v, chart, 0, 0, next);
                v->near[chart].z = (1 - share) * v->near[chart].z + share * tc_rings_sample_height(v, chart, &other);
                mixed |= other.level != at.level || other.alpha > 0;
            }
            if (mixed || (int64_t)floor(at.u) + 1 > (int64_t)r.x1 || (int64_t)floor(at.v) + 1 > (int64_t)r.y1)
                v->near[chart].shift = -1;
        }
        v->z += v->place[chart].weight * v->near[chart].z;
    }
}

/* ---- Extents ---------------------------------------------------------------------------------------------------- */

static const rings_extent nothing = {0, 0, -1, -1};

/* Longitudes on either side of the viewer that the disc reaches where it is between two latitudes. */
static double reach(const rings_view *v, double angle, double south, double north)
{
    double lat = M_PI / 2 - v->theta;
    /* Where meridians touch the disc. */
    double touch = angle < M_PI / 2 ? asin(fmin(fmax(sin(lat) / cos(angle), -1), 1)) : lat > 0 ? M_PI / 2 : -M_PI / 2;
    double phi = fmin(fmax(touch, south), north), d = v->sin_theta * cos(phi);
    if (d <= 0 || angle >= M_PI)
        return M_PI;
    double c = (cos(angle) - v->cos_theta * sin(phi)) / d;
    return c >= 1 ? 0 : c <= -1 ? M_PI : acos(c);
}

rings_extent tc_rings_extent(const rings_view *v, int chart, double angle)
{
    const tc_chart *c = &tc_rings_of(v)->map->chart[chart];
    const rings_place *at = &v->place[chart];
    bool caps = !v->partial;
    double lat = M_PI / 2 - v->theta;
    if (c->class == &tc_chart_lonlat) {
        double limit = caps ? TC_CAP_BLEND_END * DEGREE : M_PI / 2;
        double south = fmax(lat - angle, -limit), north = fmin(lat + angle, limit);
        if (south > north)
            return nothing;
        double half = reach(v, angle, south, north) / c->dx;
        return (rings_extent){-half, (south - lat) / c->dy, half, (north - lat) / c->dy};
    }
    double theta = c->class == &tc_chart_north_cap ? v->theta : M_PI - v->theta;
    double rim = (90 - TC_CAP_BLEND_START) * DEGREE, edge = 2 * tan(rim / 2);
    if (theta - angle > rim)
        return nothing;
    /* A disc on the sphere is a disc on the chart: from its nearest to its farthest point on the viewer's meridian. */
    double x0 = -edge, x1 = edge, y0 = -edge, y1 = edge;
    if (theta + angle < 0.9 * M_PI) {
        double near_end = 2 * tan((theta - angle) / 2), far_end = 2 * tan((theta + angle) / 2);
        double middle = 0.5 * (near_end + far_end), r = 0.5 * (far_end - near_end);
        x0 = fmax(x0, middle * v->cos_lambda - r), x1 = fmin(x1, middle * v->cos_lambda + r);
        y0 = fmax(y0, middle * v->sin_lambda - r), y1 = fmin(y1, middle * v->sin_lambda + r);
    }
    if (x0 > x1 || y0 > y1)
        return nothing;
    double px = c->x0 + at->x * c->dx, py = c->y0 + at->y * c->dy;
    return (rings_extent){(x0 - px) / c->dx, (y0 - py) / c->dy, (x1 - px) / c->dx, (y1 - py) / c->dy};
}

/* ---- Bounds ----------------------------------------------------------------------------------------------------- */

static void widen(double *lo, double *hi, double a, double b)
{
    *lo = a < *lo ? a : *lo;
    *hi = b > *hi ? b : *hi;
}

/* Range of the coarsest level, which is held as a whole. Few samples are looked at one by one: tiles, which ranges are
 * kept for, are as large as continents there, and what is in them far away would count as near. */
static tc_range coarsest_range(const tc_clipmap *clipmap, tc_rect r)
{
    enum { FEW = 400 };
    const tc_clip_level *l = tc_clipmap_level(clipmap, 1);
    const tc_field *field = tc_clipmap_field(clipmap);
    const int field_level = tc_clipmap_field_level(clipmap, 1);
    const int64_t mask = tc_clipmap_n(clipmap), width = tc_field_level(field, field_level).width;
    const float(*heights)[2] = tc_ground_heights(clipmap, 1);
    if (tc_rect_area(r) > FEW)
        return tc_field_range(field, field_level, r);
    tc_range all = {INFINITY, -INFINITY, 0, 0};
    for (int64_t j = tc_max64(r.y0, l->clip.y0); j < tc_min64(r.y1, l->clip.y1); j++)
        for (int64_t i = r.x0; i < r.x1; i++) {
            int64_t x = i - (l->wraps ? tc_turn(i - l->clip.x0, width) : 0);
            if (x < l->clip.x0 || x >= l->clip.x1)
                continue;
            float z = heights[(j & mask) * (mask + 1) + (x & mask)][0];
            all.lo = z < all.lo ? z : all.lo, all.hi = z > all.hi ? z : all.hi;
        }
    return all;
}

/* Range of a chart's heights within `angle` of the foot point, on all levels that may be drawn there. */
static rings_range chart_range(const rings_view *v, int chart, double angle)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
    const tc_field *field = tc_clipmap_field(clipmap);
    rings_extent e = tc_rings_extent(v, chart, angle);
    rings_range range = {true, INFINITY, -INFINITY};
    if (e.x1 < e.x0)
        return range;
    for (int level = tc_clipmap_levels(clipmap); level >= 1; level--) {
        const double scale = ldexp(1, -tc_clipmap_level(clipmap, level)->shift);
        if (scale * fmax(e.x1 - e.x0, e.y1 - e.y0) > 2.0 * tc_clipmap_n(clipmap))
            continue; /* no window of this level reaches as far as that, where it matters (set_horizon) */
        double x = v->place[chart].x, y = v->place[chart].y;
        tc_rect r = {(int64_t)floor(scale * (x + e.x0)) - 1, (int64_t)floor(scale * (y + e.y0)) - 1,
                     (int64_t)ceil(scale * (x + e.x1)) + 2, (int64_t)ceil(scale * (y + e.y1)) + 2};
        tc_range there =
            level == 1 ? coarsest_range(clipmap, r) : tc_field_range(field, tc_clipmap_field_level(clipmap, level), r);
        widen(&range.lo, &range.hi, there.lo, there.hi);
    }
    return range;
}

/* Beyond it, radians, all heights of the planet may be seen. */
static const double LOCAL = 0.3;

/* What is left of a range when that of the planet and what is beside a part of a globe are looked at. */
static void settle(const rings_view *v, double *lo, double *hi)
{
    const rings_surface *s = tc_rings_of(v);
    if (v->partial)
        widen(lo, hi, s->outside, s->outside);
    *lo = fmax(*lo, s->z_lo), *hi = fmin(*hi, s->z_hi);
}

/* keep: of ring i's charts, filled in where they are asked for. */
static void bounds(const rings_view *v, int i, rings_range keep[TC_MAX_CHARTS], double *lo_ret, double *hi_ret)
{
    double angle = ldexp(M_PI, -i);
    *lo_ret = tc_rings_of(v)->z_lo, *hi_ret = tc_rings_of(v)->z_hi;
    if (angle > LOCAL)
        return;
    double lo = INFINITY, hi = -INFINITY;
    for (int chart = 0; chart < v->head.windows->charts; chart++) {
        const rings_near *near = &v->near[chart];
        rings_extent e = {0};
        double cells = INFINITY;
        if (near->shift >= 0) {
            e = tc_rings_extent(v, chart, angle);
            cells = ldexp(fmax(fmax(e.x1, -e.x0), fmax(e.y1, -e.y0)), -near->shift);
        }
        if (e.x1 < e.x0)
            continue;
        if (cells <= NEAR && tc_rings_shift(v, i, v->throttled ? RINGS_STAGES : 0) <= near->shift) {
            widen(&lo, &hi, near->z - 2 * cells * near->steepest, near->z + 2 * cells * near->steepest);
        } else {
            if (!keep[chart].known)
                keep[chart] = chart_range(v, chart, angle);
            widen(&lo, &hi, keep[chart].lo, keep[chart].hi);
        }
    }
    settle(v, &lo, &hi);
    *lo_ret = lo, *hi_ret = hi;
}

void tc_rings_bounds(const rings_view *v, int i, double *lo_ret, double *hi_ret)
{
    rings_range keep[TC_MAX_CHARTS];
    memcpy(keep, v->range[i], sizeof keep);
    bounds(v, i, keep, lo_ret, hi_ret);
}

/* ---- Levels ----------------------------------------------------------------------------------------------------- */

/* Angle by which normals turn up to where a body of ground so high, or the mesh's chords below it, is seen edge-on from
 * a place so high. A line of sight touches what is as curved everywhere as a ball of the body's least radius no farther
 * away, by that angle, than it touches the ball; chords lie below it as those of one of the most. */
static double edge_on(const rings_view *v, double ground, double place)
{
    const rings_geometry *g = &tc_rings_of(v)->geometry;
    double step = fmax(M_PI / g->n_phi, M_PI / (8 * g->m));
    if (tc_rings_of(v)->head.most_throttle > 0) /* or that of the last stage as far away as the horizon can be */
        step *= fmax(1, ldexp(acos(fmin(1, (v->least + tc_rings_of(v)->z_lo) / (v->least + v->z_eye))), RINGS_STAGES));
    double sag = cos(fmin(step, M_PI / 2));
    double low = fmax((v->most + ground) * sag - (v->most - v->least), 0), high = v->least + place;
    return acos(fmin(1, low / fmax(high, low)));
}

/* Heights of all charts within an angle. */
static void range_within(const rings_view *v, double angle, double *lo_ret, double *hi_ret)
{
    *lo_ret = INFINITY, *hi_ret = -INFINITY;
    for (int chart = 0; chart < v->head.windows->charts; chart++) {
        rings_range r = chart_range(v, chart, angle);
        widen(lo_ret, hi_ret, r.lo, r.hi);
    }
    settle(v, lo_ret, hi_ret);
}

/* Equation 6. What hides is the ground up to where the line of sight touches it: the planet's lowest would hide what is
 * beyond it, so none but that within the angle does, which is higher and is touched nearer, and so on. What may rise
 * above it is likewise first the planet's highest ground, and then the highest within the horizon that follows. A step
 * nearer may find finer levels, and so lower or higher ground than the step before: that is taken, and looked at again;
 * what does not settle is the planet's. */
static void set_horizon(rings_view *v)
{
    enum { TIMES = 5 };
    const double lowest = tc_rings_of(v)->z_lo, highest = tc_rings_of(v)->z_hi;
    double low = lowest, high = highest, lo, hi;
    bool back = false, settled = false;
    for (int k = 0; k < TIMES && !settled; k++) {
        range_within(v, edge_on(v, low, v->z_eye), &lo, &hi);
        settled = lo == low || (back && lo > low);
        back |= lo < low;
        low = settled ? low : lo;
    }
    low = settled || !back ? low : lowest;
    v->horizon = edge_on(v, low, v->z_eye) + edge_on(v, low, high);
    back = settled = false;
    for (int k = 0; k < TIMES && !settled; k++) {
        range_within(v, v->horizon, &lo, &hi);
        settled = hi == high || (back && hi < high);
        back |= hi > high;
        high = settled ? high : hi;
        v->horizon = edge_on(v, low, v->z_eye) + edge_on(v, low, high);
    }
    if (!settled && back)
        v->horizon = edge_on(v, low, v->z_eye) + edge_on(v, low, highest);
}

static void set_levels(rings_view *v, bool wait)
{
    const rings_surface *s = tc_rings_of(v);
    const rings_geometry *g = &s->geometry;
    set_horizon(v);
    while (v->first < g->levels - 1 && ldexp(M_PI, -v->first - 1) > v->horizon)
        v->first++;
    /* Equation 8: the steps of the finest level are about a pixel. */
    double scale = tc_camera_pixel_scale(&v->head.camera);
    bool read = false;
    for (v->finest = v->first; v->finest < g->levels - 1; v->finest++) {
        double angle = ldexp(M_PI, -v->finest), lo, hi;
        if (!read && v->finest > s->shift_base + 3) { /* within a few of the finest samples: see what they are */
            for (int chart = 0; chart < v->head.windows->charts; chart++)
                v->near[chart] = wait ? read_near(v, chart) : finest_near(v, chart);
            read = true;
        }
        bounds(v, v->finest, v->range[v->finest], &lo, &hi);
        double step = angle * v->most * fmax(0.5 / g->m, 2 * M_PI / g->n_phi);
        if (step * scale <= v->z_eye - hi)
            break;
    }
    double lo, hi;
    for (int i = v->finest; i <= v->finest + 1; i++) /* and of the disc */
        bounds(v, i, v->range[i], &lo, &hi);
}

/* ---- Throttling ------------------------------------------------------------------------------------------------- */

/* Height above the ground, which must be the same for the same view whatever is throttled: the pyramids' ground, or of
 * what is held. */
static double height_above_ground(const rings_view *v, bool wait)
{
    const rings_surface *s = tc_rings_of(v);
    const tc_camera *camera = &v->head.camera;
    double z = 0;
    if (wait && tc_map_height(s->map, camera->x, camera->y, &z) == TC_OK)
        return camera->z - z;
    for (int chart = 0; chart < v->head.windows->charts; chart++) {
        rings_sample at = v->place[chart].weight > 0 ? tc_rings_find(v, chart, 0, 0, 0) : (rings_sample){0};
        z += v->place[chart].weight * (at.level ? tc_rings_sample_height(v, chart, &at) : s->outside);
    }
    return v->z_eye - z;
}

/* A throttle of 1 lets the first stage go from the inside, where the steps are about a pixel, outwards to the horizon;
 * as it goes on, so does the next stage behind it. Both ends follow evenly from where the eye is, so that nothing leaps
 * as it moves: what is drawn (first, finest) goes by bounds that do. */
static void set_fronts(rings_view *v, double throttle, bool wait)
{
    const double EASED = 1.0 / 16; /* where ground is so steep that rings are drawn farther inwards than that */
    const double APART = 2.5;      /* rings between two stages: a ring has one of them at most */
    const double LEAST = 0.01;     /* metres */
    const rings_geometry *g = &tc_rings_of(v)->geometry;
    throttle = fmin(throttle, tc_rings_of(v)->head.most_throttle);
    v->throttled = throttle > 0;
    if (!v->throttled)
        return;
    double height = fmax(height_above_ground(v, wait), LEAST), radius = v->least + v->z_eye - height;
    double step = fmax(0.5 / g->m, 2 * M_PI / g->n_phi) * tc_camera_pixel_scale(&v->head.camera);
    double inner = log2(M_PI * radius * step / height) + 2; /* beyond the disc of the finest ring: equation 8 */
    double outer = log2(M_PI / acos(radius / (radius + height))) - 2;
    double way = fmax(inner - outer, APART);
    for (int stage = 0; stage < RINGS_STAGES; stage++)
        v->front[stage] = (float)(inner - way * (throttle - stage));
    v->ease = (float)fmin(throttle / EASED, 1);
}

void tc_rings_look(const tc_surface *surface, const tc_windows *windows, const tc_camera *camera,
                   const tc_frame_options *options, bool wait, tc_view *view_ret)
{
    rings_view *v = (rings_view *)view_ret;
    *v = (rings_view){.head = tc_view_of(surface, windows, camera, options)};
    place(v);
    set_fronts(v, options->throttle, wait);
    set_levels(v, wait);
}

/* Samples at a window's sides in which it passes over to the coarser level: none of them may be in view where a window
 * could be larger, or even the ground below the viewer would not be its own level's. */
#define PASSAGE(n) ((int64_t)(n) / 10 + 1)

/* The window of a level: the extent as even samples, at most n around the viewer. */
static tc_rect window(const rings_place *at, rings_extent e, int shift, int n, tc_rect extent)
{
    int64_t side[2][2];
    const double middle[2] = {at->x, at->y}, lo[2] = {e.x0, e.y0}, hi[2] = {e.x1, e.y1};
    const int64_t least[2] = {extent.x0, extent.y0}, most[2] = {extent.x1, extent.y1};
    for (int a = 0; a < 2; a++) {
        /* A sample more on all sides for what is between samples, and the passage to the coarser level. */
        int64_t x0 = (int64_t)floor(ldexp(middle[a] + lo[a], -shift)) - 1 - PASSAGE(n);
        int64_t x1 = (int64_t)ceil(ldexp(middle[a] + hi[a], -shift)) + 2 + PASSAGE(n);
        int64_t eye = tc_clamp64((int64_t)floor(ldexp(middle[a], -shift)), x0, x1);
        if (x1 - x0 > n - 1) {
            x0 = tc_clamp64(eye - n / 2, x0, x1 - (n - 1));
            x1 = x0 + n - 1;
        }
        x0 = tc_max64(x0 & ~(int64_t)1, least[a]);
        x1 = tc_min64(x1 | 1, most[a]);
        side[a][0] = x0, side[a][1] = x1;
    }
    tc_rect r = {side[0][0], side[1][0], side[0][1], side[1][1]};
    return tc_rect_empty(r) ? (tc_rect){0, 0, 0, 0} : r;
}

/* Whether any vertex drawn may read a chart: also those beyond the horizon that belong to triangles before it. */
static bool in_reach(const rings_view *v, int chart)
{
    const double margin = 1.001; /* what float makes of it */
    rings_extent e = tc_rings_extent(v, chart, fmin(ldexp(M_PI, -v->first) * margin, M_PI));
    return e.x1 >= e.x0;
}

void tc_rings_wanted(const tc_view *view, tc_rect (*wanted)[TC_MAX_LEVELS])
{
    const rings_view *v = (const rings_view *)view;
    const rings_surface *s = tc_rings_of(v);
    for (int chart = 0; chart < view->windows->charts; chart++) {
        const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
        int levels = tc_clipmap_levels(clipmap), n = tc_clipmap_n(clipmap);
        bool read = in_reach(v, chart);
        for (int level = 1; level <= levels; level++) {
            const tc_clip_level *l = tc_clipmap_level(clipmap, level);
            /* The ring coordinate from which on outwards this level is not read any more. */
            double w = s->shift_base - l->shift - v->detail, i = floor(fmax(w, 0));
            double angle = w <= 0 ? M_PI : ldexp(M_PI, -(int)i) * (1 - 0.5 * (w - i));
            wanted[chart][level - 1] = (tc_rect){0, 0, 0, 0};
            if (!read)
                continue;
            if (level == 1 && l->extent.x0 < 0) { /* once around, and about the next level's window to half a sample */
                int64_t width = l->clip.x1 - l->clip.x0;
                int64_t x0 = ((int64_t)floor(ldexp(v->place[chart].x, -l->shift) + 0.5) - width / 2) & ~(int64_t)1;
                wanted[chart][0] = (tc_rect){x0, l->extent.y0, x0 + width, l->extent.y1};
                continue;
            }
            if (level > 1 && w >= v->finest + 1)
                continue;
            rings_extent e = tc_rings_extent(v, chart, fmin(angle, v->horizon * 1.02 + 1e-9));
            if (level == 1)
                wanted[chart][0] = l->extent;
            else if (e.x1 >= e.x0)
                wanted[chart][level - 1] = window(&v->place[chart], e, l->shift, n, l->extent);
        }
    }
}

bool tc_rings_stand(const tc_view *view, int chart, const double texel[2], tc_standing *at)
{
    const rings_view *v = (const rings_view *)view;
    const tc_chart *c = &tc_rings_of(v)->map->chart[chart];
    const rings_place *p = &v->place[chart];
    const double kx = c->dx / texel[0], ky = c->dy / texel[1], around = M_PI / fabs(texel[0]);
    const rings_extent e = tc_rings_extent(v, chart, fmin(v->horizon * 1.02 + 1e-9, M_PI));
    if (e.x1 < e.x0)
        return false;
    double lo, hi;
    tc_rings_bounds(v, v->finest, &lo, &hi);
    *at = (tc_standing){.x = p->x * kx,
                        .y = p->y * ky,
                        .per_place = {1 / texel[0], 1 / texel[1]}, /* places are chart coordinates */
                        .lo = {fmax(e.x0 * kx, -around), e.y0 * ky},
                        .hi = {fmin(e.x1 * kx, around), e.y1 * ky},
                        .texel = texel[1] * v->radius,
                        .distance = fmax(v->z_eye - hi, 0)};
    return true;
}
