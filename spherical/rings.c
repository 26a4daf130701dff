/* rings.c - concentric rings over a planet's charts: what a frame draws.
 *
 * Levels beyond the horizon and below a pixel are left out (rings_view.c), and of the others the sectors outside the
 * view (CH06's future work). */
#include "rings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/view/camera.h"
#include "common/field/field.h"
#include "globe.h"
#include "rings_internal.h"

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* All that is looked at while a frame is put together. */
typedef struct assembly {
    const rings_surface *s;
    tc_frame *frame;
    const rings_view *view; /* of the camera drawn */
    tc_frustum frustum;     /* of the camera culled for */
    bool frozen;            /* which is another one: to its axes from the drawn eye's, and to its eye */
    double turn[3][3], eye[3];
    bool no_cull;
    int count, sectors; /* drawn, looked at */
    int64_t triangles, triangles_unculled;
} assembly;

/* Range of f(x) = x * y over two ranges. */
static void multiply(const double a[2], const double b[2], double out[2])
{
    double p[4] = {a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]};
    out[0] = out[1] = p[0];
    for (int k = 1; k < 4; k++) { /* without fmin(), which is a call, some hundred times a frame */
        out[0] = p[k] < out[0] ? p[k] : out[0];
        out[1] = p[k] > out[1] ? p[k] : out[1];
    }
}

/* Range of cos over an interval of at most a half turn that does not hold a multiple of a turn but at its ends. */
static void cosine(double from, double to, double out[2])
{
    double a = cos(from), b = cos(to);
    out[0] = fmin(a, b), out[1] = fmax(a, b);
    if (ceil(from / M_PI) <= floor(to / M_PI)) { /* an extremum inside */
        double k = ceil(from / M_PI);
        if (fmod(fabs(k), 2) == 1)
            out[0] = -1;
        else
            out[1] = 1;
    }
}

/* Culls for another camera than is drawn. */
static void freeze(assembly *a, const tc_camera *drawn, const tc_camera *culled)
{
    const tc_body *body = &a->s->map->body;
    const double here[3] = {drawn->x, drawn->y, drawn->z}, there[3] = {culled->x, culled->y, culled->z};
    double from[3][3], to[3][3], p[3], q[3], way[3];
    body->class->axes(body, here, from);
    body->class->axes(body, there, to);
    body->class->position(body, here, p);
    body->class->position(body, there, q);
    for (int i = 0; i < 3; i++)
        way[i] = p[i] - q[i];
    a->frozen = true;
    for (int i = 0; i < 3; i++) {
        a->eye[i] = to[i][0] * way[0] + to[i][1] * way[1] + to[i][2] * way[2];
        for (int k = 0; k < 3; k++)
            a->turn[i][k] = to[i][0] * from[k][0] + to[i][1] * from[k][1] + to[i][2] * from[k][2];
    }
}

/* The box around a box, as seen from the camera culled for. */
static void turn_box(const assembly *a, double lo[3], double hi[3])
{
    double middle[3], half[3];
    for (int i = 0; i < 3; i++) {
        middle[i] = a->eye[i], half[i] = 0;
        for (int k = 0; k < 3; k++) {
            middle[i] += a->turn[i][k] * 0.5 * (lo[k] + hi[k]);
            half[i] += fabs(a->turn[i][k]) * 0.5 * (hi[k] - lo[k]);
        }
    }
    for (int i = 0; i < 3; i++)
        lo[i] = middle[i] - half[i], hi[i] = middle[i] + half[i];
}

/* A level from angle inner to outer around the foot point, between two heights: how far it reaches from the axis
 * through the viewer, and up and down from the eye; and how far to any side it may be elsewhere. */
typedef struct band {
    double across[2], up[2], aside;
} band;

/* A body whose radii of curvature are all within two bounds is a ball of the least one and a body whose radii are
 * within 0 and their difference, each of whose places is added to the ball's of the same normal. */
static band band_of(const rings_view *v, double inner, double outer, double lo, double hi)
{
    const double more = v->most - v->least;
    double sine[2] = {fmin(sin(inner), sin(outer)),
                      inner <= M_PI / 2 && outer >= M_PI / 2 ? 1 : fmax(sin(inner), sin(outer))};
    double radius[2] = {fmax(v->least + lo, 0), v->least + hi};
    double h[2] = {2 * pow(sin(inner / 2), 2), 2 * pow(sin(outer / 2), 2)}, z[2] = {lo, hi};
    band b = {.up = {INFINITY, -INFINITY}, .aside = more * outer};
    multiply(sine, radius, b.across);
    for (int k = 0; k < 4; k++) {
        double value = (z[k & 1] - v->z_eye) - (v->least + z[k & 1]) * h[k >> 1];
        b.up[0] = fmin(b.up[0], value), b.up[1] = fmax(b.up[1], value);
    }
    b.up[0] -= more * fmax(h[0], h[1]);
    return b;
}

/* Whether a sector of it may be seen. */
static bool visible(const assembly *a, const band *b, const rings_sector *sector)
{
    double x[2], y[2];
    if (a->no_cull)
        return true;
    multiply(b->across, sector->south, x);
    multiply(b->across, sector->east, y);
    double box_lo[3] = {y[0] - b->aside, -x[1] - b->aside, b->up[0]};
    double box_hi[3] = {y[1] + b->aside, -x[0] + b->aside, b->up[1]};
    for (int i = 0; i < 3; i++) { /* what float makes of it */
        double slack = fabs(box_lo[i]) > fabs(box_hi[i]) ? 1e-5 * fabs(box_lo[i]) : 1e-5 * fabs(box_hi[i]);
        box_lo[i] -= slack, box_hi[i] += slack;
    }
    if (a->frozen)
        turn_box(a, box_lo, box_hi);
    return tc_frustum_sees(&a->frustum, box_lo, box_hi);
}

/* How a level, or the disc inside it, is drawn: where the next one outwards has all vertices of the stage before, with
 * those along their edge. */
static const rings_strips *strips_of(const rings_view *v, int i, bool disc)
{
    const rings_geometry *g = &tc_rings_of(v)->geometry;
    int stage = tc_rings_stage(v, disc ? i + 1 : i), outwards = tc_rings_stage(v, disc ? i : i - 1);
    return &(disc ? g->fill_strips : g->ring_strips)[stage][outwards < stage];
}

/* The visible sectors of a level, or of the disc inside it. */
static void add_level(assembly *a, int i, bool disc)
{
    const rings_surface *s = a->s;
    const rings_geometry *g = &s->geometry;
    double outer = ldexp(M_PI, disc ? -i - 1 : -i), inner = disc ? 0 : outer / 2, lo, hi;
    const rings_strips *list = strips_of(a->view, i, disc);
    tc_rings_bounds(a->view, disc ? i + 1 : i, &lo, &hi);
    const band b = band_of(a->view, inner, outer, lo, hi);
    for (int k = 0; k < g->sectors; k++) {
        a->triangles_unculled += list->triangles;
        a->sectors++;
        if (!visible(a, &b, &s->sector[k]))
            continue;
        a->triangles += list->triangles;
        a->frame->draws[a->count] =
            (tc_draw){.count = list->count,
                      .instance_count = 1,
                      .first_index = list->first + (uint32_t)k * list->count,
                      .base_vertex = disc ? tc_rings_fill_base(g, i) : tc_rings_level_base(g, i)};
        a->count++;
        a->frame->blocks[i]++; /* the disc counts with the innermost ring */
    }
}

/* What rings.glsl needs to know of a chart: of one without layers, one level that holds nothing. */
static void set_chart(tc_frame *f, const rings_view *v, const tc_layers *layers, int chart)
{
    float(*u)[4] = f->surface;
    int32_t(*whole)[4] = f->integers;
    const rings_near *near = &v->near[chart];
    const rings_place *at = &v->place[chart];
    const tc_clipmap *clipmap = tc_rings_clipmap(v, chart);
    int levels = tc_clipmap_levels(clipmap), first = tc_first_layer(layers, chart);
    int held = layers->held[chart], finest = tc_clipmap_level(clipmap, levels)->shift;
    int coarsest = finest + levels - 1;
    double z = near->z;
    int fine_layer = first + levels - 1 + finest; /* of shift 0, were there one */
    tc_set4(u[4 + chart], z, z - (double)(float)z, z - v->z, 0);
    tc_set4(u[7 + chart], 0, 0, 0, 0);
    whole[0][chart] = fine_layer;
    whole[1][chart] = -1;
    whole[2][chart] = coarsest - held + 1 + 64 * coarsest;
    if (held == 0) {
        int nothing = tc_first_layer(layers, v->head.windows->charts);
        float(*q)[4] = f->layer[nothing];
        whole[0][chart] = nothing;
        whole[2][chart] = 0;
        memset(q, 0, sizeof *f->layer);
        q[2][2] = q[2][3] = -1;
        return;
    }
    if (near->shift >= 0) {
        tc_set4(u[7 + chart], near->slope[0], near->slope[1], near->slope[2], 0);
        whole[1][chart] = fine_layer - near->shift;
    }
    for (int level = 1; level <= held; level++) {
        const tc_clip_level *l = tc_clipmap_level(clipmap, level);
        float(*q)[4] = f->layer[first + level - 1];
        double x = ldexp(at->x, -l->shift), y = ldexp(at->y, -l->shift), i = rint(x), j = rint(y);
        int64_t torus = 2 * (tc_clipmap_n(clipmap) + 1);
        rings_extent r = tc_rings_held(clipmap, level), lattice = tc_rings_lattice(clipmap, level);
        const tc_chart *c = &tc_rings_of(v)->map->chart[chart];
        tc_set4(q[0], x - i, y - j, ldexp(1 / c->dx, -l->shift), ldexp(1 / c->dy, -l->shift));
        tc_set4(q[1], (double)((int64_t)i & (torus - 1)), (double)((int64_t)j & (torus - 1)), lattice.x1 - i,
                lattice.y1 - j);
        tc_set4(q[2], r.x0 - i, r.y0 - j, r.x1 - i, r.y1 - j);
        if (level > layers->ready[chart]) /* nothing, yet */
            tc_set4(q[2], 0, 0, -1, -1);
    }
}

/* What rings.glsl names surface[...], whole[...] and layer[...]. */
static void set_uniforms(tc_frame *f, const rings_view *v, const tc_layers *layers)
{
    const rings_surface *s = tc_rings_of(v);
    float(*u)[4] = f->surface;
    const double lo = TC_CAP_BLEND_START_SINE, hi = TC_CAP_BLEND_END_SINE;
    bool caps = !v->partial;
    tc_set4(u[0], v->cos_theta, v->sin_theta, v->cos_lambda, v->sin_lambda);
    tc_set4(u[1], v->radius + v->z, v->z_eye - v->z, v->z, s->shift_base + 1);
    /* Without caps weights never leave 0. */
    tc_set4(u[2], caps ? (v->cos_theta - lo) / (hi - lo) : -1, caps ? (-v->cos_theta - lo) / (hi - lo) : -1,
            caps ? 1 / (hi - lo) : 0, s->outside - v->z);
    tc_set4(u[3], v->theta, RINGS_PASSAGE / s->head.n, v->detail, v->partial);
    for (int chart = 0; chart < v->head.windows->charts; chart++)
        set_chart(f, v, layers, chart);
    u[10][3] = v->head.options.no_morph;
    const rings_geometry *g = &s->geometry;
    tc_set4(u[13], v->front[0], v->front[1], v->ease, 2 * M_PI / g->n_phi);
    int32_t(*whole)[4] = f->integers;
    whole[0][3] = g->stride;
    whole[1][3] = tc_rings_fill_base(g, v->finest);
    whole[2][3] = g->m | g->fill << 8 | g->n_phi / g->sectors << 16;
    if (!caps) {
        const tc_chart *c = &s->map->chart[0];
        rings_extent r = v->sides;
        tc_set4(u[11], r.x0 * c->dx, r.y0 * c->dy, r.x1 * c->dx, r.y1 * c->dy);
        tc_set4(u[12], c->wraps, v->south, v->north, 0);
    }
    for (int cap = 1; cap < v->head.windows->charts; cap++)
        tc_set4(u[10 + cap], v->place[cap].c[0], v->place[cap].c[1], v->place[cap].c[2],
                1 - ((cap == 1 ? v->cos_theta : -v->cos_theta) - lo) / (hi - lo));
}

static void rings_draws(const tc_view *head, const tc_layers *layers, tc_frame *frame)
{
    const tc_frame_options *options = &head->options;
    const rings_surface *s = (const rings_surface *)head->surface;
    rings_view view = *(const rings_view *)head;
    tc_rings_ground(&view);
    assembly a = {.s = s,
                  .frame = frame,
                  .view = &view,
                  .frustum = tc_camera_frustum(&head->culled),
                  .no_cull = options->no_cull};
    if (head->frozen)
        freeze(&a, &head->camera, &head->culled);
    int first = options->no_cull ? 0 : view.first;
    for (int i = view.finest; i >= 0; i--) { /* nearest first */
        if (i == view.finest)
            add_level(&a, i, true);
        if (i >= first)
            add_level(&a, i, false);
        else {
            a.triangles_unculled += (int64_t)strips_of(&view, i, false)->triangles * s->geometry.sectors;
            a.sectors += s->geometry.sectors;
        }
    }
    set_uniforms(frame, &view, layers);
    const tc_body *body = &s->map->body;
    const double eye[3] = {head->camera.x, head->camera.y, head->camera.z};
    body->class->uniforms(body, eye, head->camera.z - view.z_eye + view.z, frame->body);
    frame->strip_draws = a.count, frame->list_draws = 0;
    frame->triangles = a.triangles, frame->triangles_unculled = a.triangles_unculled;
    frame->one_sided = !options->two_sided && !tc_ground_voids(tc_rings_clipmap(&view, 0), 1) && view.z_eye > view.z;
    frame->draws_unculled = a.sectors;
    frame->levels_active = view.finest - first + 1;
    frame->levels_fine = s->geometry.levels - 1 - view.finest;
    frame->levels_beyond = first;
}

/* ---- Creation ---------------------------------------------------------------------------------------------------- */

static void rings_destroy(tc_surface *surface)
{
    rings_surface *s = (rings_surface *)surface;
    free(s->head.geometry.vertices);
    free(s->head.geometry.indices);
    free(s);
}

static tc_status rings_windows(const tc_surface *surface, tc_windows *windows_ret, tc_error *error)
{
    const rings_surface *s = (const rings_surface *)surface;
    *windows_ret = (tc_windows){.charts = s->map->charts};
    tc_status status = TC_OK;
    for (int chart = 0; chart < s->map->charts && !status; chart++) {
        const tc_chart *c = &s->map->chart[chart];
        tc_ground_options options = s->windows;
        options.wraps = c->wraps;
        options.spacing_x = c->dx * s->map->body.radius, options.spacing_y = c->dy * s->map->body.radius;
        status = tc_ground_create(c->field, &options, &windows_ret->clipmap[chart], error);
    }
    if (status)
        tc_windows_destroy(windows_ret);
    return status;
}

/* A window holds at least twice the n_phi / 2 samples that the disc of its ring is wide, less one: enough up to the
 * latitude where caps take over. Grids whose coarsest even width is larger need larger ones. */
static int window_size(const rings_surface *s, int least)
{
    int n = 63;
    while (n < TC_CLIPMAP_MAX_N && (n + 1 < s->geometry.n_phi || n < least))
        n = 2 * n + 1;
    return s->map->chart[0].wraps && n < 255 ? 255 : n; /* > TC_MOST_ODD */
}

static void set_sectors(rings_surface *s)
{
    const int sectors = s->geometry.sectors;
    for (int k = 0; k < sectors; k++) {
        double from = 2 * M_PI * k / sectors, to = 2 * M_PI * (k + 1) / sectors;
        cosine(from, to, s->sector[k].south);
        cosine(from - M_PI / 2, to - M_PI / 2, s->sector[k].east);
    }
}

/* Of all charts on all levels. */
static void set_heights(rings_surface *s)
{
    const tc_range all = tc_map_range(s->map);
    s->z_lo = all.lo, s->z_hi = all.hi;
    if (s->map->charts == 1)
        s->z_lo = fmin(s->z_lo, s->outside), s->z_hi = fmax(s->z_hi, s->outside);
}

int tc_rings_steps(int n_phi)
{
    /* Up to 1024 around no more than 16-bit indices count: a step outwards is then at most 1.4 of those around. */
    int most = n_phi <= 1024 ? (int)fmin(64, UINT16_MAX / (n_phi + 64) - 1) & ~1 : TC_RINGS_MOST_STEPS;
    return (int)fmin(fmax(2 * round(n_phi / (8 * M_PI)), TC_RINGS_LEAST_STEPS), most);
}

int tc_rings_n_phi_for(const tc_camera *camera)
{
    enum { LEAST = 512 };
    int n = tc_clipmap_n_for(camera) + 1;
    if (n > TC_CLIPMAP_MAX_N && 0.8 * tc_camera_pixel_scale(camera) > n * M_SQRT2) /* the nearest power of two */
        n *= 2;
    return n < LEAST ? LEAST : n;
}

/* Levels of rings down to centimetres. */
static int ring_levels(const rings_surface *s)
{
    double radius = s->map->body.radius;
    return (int)fmin(fmax(ceil(log2(M_PI * radius / 0.02)), 8), TC_DRAWN_LEVELS);
}

tc_status tc_rings_create(const tc_map *map, const tc_rings_options *options, tc_surface **surface_ret, tc_error *error)
{
    static const tc_surface_words words = {.levels = "rings",
                                           .blocks = "sectors",
                                           .fine = "finer than a pixel",
                                           .beyond = "beyond the horizon",
                                           .outside = "beyond the horizon or outside the view",
                                           .charts = true};
    static const char *const defines[] = {"CLIMATE", TC_GLOBE_RELIEF_DEFINE, "APRON " TC_TEXT_OF(RINGS_APRON), NULL};
    const char *const body = map->body.class->glsl;
    const rings_parts parts = {
        .vertex = {"rings_ch06.glsl", body, "stack.glsl", "rings.glsl", "rings.vert"},
        .fragment = {"rings_ch06.glsl", body, "stack.glsl", "rings.glsl", "air.glsl", "globe.glsl", "rings.frag"},
        .sky = {"air.glsl", body, "globe_sky.frag"}};
    int n_phi = options->n_phi ? options->n_phi : 512;
    if (n_phi < TC_RINGS_LEAST_N_PHI || n_phi > TC_RINGS_MOST_N_PHI || n_phi % 32 != 0)
        return tc_fail(error, TC_ERR_USAGE, "--n: expected a multiple of 32 from %d to %d, found %d",
                       TC_RINGS_LEAST_N_PHI, TC_RINGS_MOST_N_PHI, n_phi);
    int m = options->m ? options->m : tc_rings_steps(n_phi);
    if (m < TC_RINGS_LEAST_STEPS || m > TC_RINGS_MOST_STEPS || m % 2 != 0)
        return tc_fail(error, TC_ERR_USAGE, "--steps: expected an even number from %d to %d, found %d",
                       TC_RINGS_LEAST_STEPS, TC_RINGS_MOST_STEPS, m);
    if (map->chart[0].class != &tc_chart_lonlat || (map->charts != 1 && map->charts != 3))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "rings: expected a planet in longitude and latitude, found a map of another kind");
    rings_surface *s = calloc(1, sizeof *s);
    if (!s)
        return tc_fail(error, TC_ERR_MEMORY, "rings: not enough memory");
    bool ch06 = options->scheme == TC_RINGS_CH06;
    s->map = map;
    s->parts = parts;
    s->scheme = options->scheme;
    s->outside = options->outside - tc_field_info(map->chart[0].field)->z_base;
    s->geometry = (rings_geometry){
        .levels = ring_levels(s), .n_phi = n_phi, .m = m, .fill = m / 2, .throttled = options->throttle};
    /* Ring i spans Q / 2 to Q samples of the level that it reads, Q = n_phi / 4: steps around are up to pi / 2 samples
     * long, and as long outwards with as many as tc_rings_steps() says. CH06 section 4.2 has n_phi / 8. No more than
     * windows can hold. */
    int samples = n_phi <= TC_CLIPMAP_MAX_N ? n_phi : TC_CLIPMAP_MAX_N + 1;
    s->shift_base = (int)ceil(log2(M_PI / (map->chart[0].dy * samples / 4)) - 1e-9);
    s->head = (tc_surface){.name = ch06 ? "rings-ch06" : "rings",
                           .words = &words,
                           .defines = defines,
                           .vertex_parts = s->parts.vertex + !ch06,
                           .fragment_parts = s->parts.fragment + !ch06,
                           .sky_parts = s->parts.sky,
                           .own_haze = true,
                           .near_plane = 1e-4 * fmin(1, map->body.radius * 1e-3),
                           .extent = 2 * map->body.radius,
                           .body = map->body,
                           .field = map->chart[0].field,
                           .n = window_size(s, options->n),
                           .shaded_n = options->n,
                           .most_throttle = options->throttle ? RINGS_STAGES : 0,
                           .throttled_stage = options->throttle,
                           .view_bytes = sizeof(rings_view),
                           .make_windows = rings_windows,
                           .look = tc_rings_look,
                           .wanted = tc_rings_wanted,
                           .stand = tc_rings_stand,
                           .draws = rings_draws,
                           .height = tc_rings_drawn_height,
                           .destroy = rings_destroy};
    s->windows = (tc_ground_options){.n = s->head.n,
                                     .max_levels = options->max_levels,
                                     .normals = options->normals,
                                     .fine_normals = options->fine_normals,
                                     .holes = options->holes,
                                     .relief = TC_GLOBE_RELIEF};
    set_heights(s);
    tc_status status = tc_rings_geometry(&s->geometry, &s->head.geometry, error);
    set_sectors(s);
    s->head.draw_capacity = (s->geometry.levels + 1) * s->geometry.sectors; /* every ring, and the disc */
    if (status) {
        rings_destroy(&s->head);
        return status;
    }
    *surface_ret = &s->head;
    return TC_OK;
}
