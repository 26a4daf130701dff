/* rings_oracle.c - vertices of the rings by the plainest of long double arithmetic. */
#include "rings_oracle.h"

#include <math.h>

static const long double pi = 3.14159265358979323846264338327950288L;

/* Height on a chart at a place in finest samples, by the rules of find_spot() in shaders/stack.glsl. */
static long double chart_height(const rings_view *view, int chart, long double x, long double y, long double shift)
{
    const tc_clipmap *clipmap = tc_rings_clipmap(view, chart);
    int levels = tc_clipmap_levels(clipmap), finest = tc_clipmap_level(clipmap, levels)->shift;
    int k = (int)floorl(shift);
    k = k < finest ? finest : k >= finest + levels ? finest + levels - 1 : k;
    long double alpha = fminl(fmaxl(shift - k, 0), 1);
    for (int level = levels - (k - finest); level >= 1; level--, k++, alpha = 0) {
        rings_extent held = tc_rings_held(clipmap, level);
        long double u = x / exp2l(k), v = y / exp2l(k);
        long double inside = fminl(fminl(u - held.x0, held.x1 - u), fminl(v - held.y0, held.y1 - v));
        if (inside < 0)
            continue;
        int64_t n = tc_clipmap_n(clipmap);
        alpha = level > 1 ? fmaxl(alpha, 1 - inside * 10 / n) : 0;
        rings_extent lattice = tc_rings_lattice(clipmap, level); /* beyond its last sample heights go on */
        u = fminl(u, lattice.x1), v = fminl(v, lattice.y1);
        long double i = fmaxl(fminl(floorl(u), lattice.x1 - 1), lattice.x0);
        long double j = fmaxl(fminl(floorl(v), lattice.y1 - 1), lattice.y0);
        long double z = 0;
        for (int corner = 0; corner < 4; corner++) {
            int right = corner & 1, up = corner >> 1;
            int64_t column = ((int64_t)i + right) & n, row = ((int64_t)j + up) & n;
            const float *pair = tc_ground_heights(clipmap, level)[row * (n + 1) + column];
            z += ((1 - alpha) * pair[0] + alpha * pair[1]) * (right ? u - i : 1 - (u - i)) * (up ? v - j : 1 - (v - j));
        }
        return z;
    }
    return tc_rings_of(view)->outside;
}

/* The place of a height along a normal, from the body's middle. */
static void body_place(const tc_body *body, const long double n[3], long double z, long double p[3])
{
    long double e2 = body->flattening * (2 - (long double)body->flattening);
    long double radius = body->radius / sqrtl(1 - e2 * n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        p[i] = (radius * (i == 2 ? 1 - e2 : 1) + z) * n[i];
}

oracle_vertex rings_oracle(const rings_surface *s, const rings_view *view, const tc_camera *camera, long double theta,
                           long double phi, long double w)
{
    oracle_vertex r = {0};
    long double sl = sinl(camera->x), cl = cosl(camera->x), sp = sinl(camera->y), cp = cosl(camera->y);
    long double south = sinl(theta) * cosl(phi), east = sinl(theta) * sinl(phi), up = cosl(theta);
    long double p[3] = {up * cp * cl + south * sp * cl - east * sl, up * cp * sl + south * sp * sl + east * cl,
                        up * sp - south * cp};
    long double lo = sinl(TC_CAP_BLEND_START * pi / 180), hi = sinl(TC_CAP_BLEND_END * pi / 180);
    if (s->map->charts == 3)
        for (int cap = 1; cap <= 2; cap++)
            r.weight[cap] = fminl(fmaxl(((cap == 1 ? p[2] : -p[2]) - lo) / (hi - lo), 0), 1);
    r.weight[0] = 1 - r.weight[1] - r.weight[2];
    long double shift = fmaxl(s->shift_base + 1 - w, 0);
    for (int chart = 0; chart < s->map->charts; chart++) {
        const tc_chart *c = &s->map->chart[chart];
        if (r.weight[chart] <= 0)
            continue;
        long double scale = 2 / (1 + (chart == 1 ? p[2] : -p[2])), x = scale * p[0], y = scale * p[1];
        if (c->class == &tc_chart_lonlat)
            x = atan2l(p[1], p[0]), y = atan2l(p[2], hypotl(p[0], p[1]));
        r.x[chart] = (x - c->x0) / c->dx;
        r.y[chart] = (y - c->y0) / c->dy;
        if (c->class == &tc_chart_lonlat) { /* the column's number that is nearest to the viewer's */
            long double period = 2 * pi / c->dx;
            r.x[chart] += period * rintl((view->place[chart].x - r.x[chart]) / period);
        }
        r.height += r.weight[chart] * chart_height(view, chart, r.x[chart], r.y[chart], shift);
    }
    long double place[3], eye[3];
    body_place(&s->map->body, p, r.height, place);
    body_place(&s->map->body, (long double[3]){cp * cl, cp * sl, sp}, camera->z, eye);
    const long double axes[3][3] = {{-sl, cl, 0}, {-sp * cl, -sp * sl, cp}, {cp * cl, cp * sl, sp}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            r.position[i] += axes[i][k] * (place[k] - eye[k]);
    return r;
}

bool rings_oracle_pixel(const tc_camera *camera, const long double position[3], long double pixel_ret[2])
{
    long double sh = sinl(camera->heading), ch = cosl(camera->heading);
    long double sp = sinl(camera->pitch), cp = cosl(camera->pitch);
    const long double *p = position;
    long double right = ch * p[0] - sh * p[1], ahead = sh * p[0] + ch * p[1];
    long double forward = cp * ahead + sp * p[2], up = cp * p[2] - sp * ahead;
    long double scale = camera->width / (2 * tanl(camera->fov / 2));
    pixel_ret[0] = camera->width / 2.0L + scale * right / forward;
    pixel_ret[1] = camera->height / 2.0L + scale * up / forward;
    return forward > 0 && pixel_ret[0] >= 0 && pixel_ret[0] <= camera->width && pixel_ret[1] >= 0 &&
           pixel_ret[1] <= camera->height;
}
