/* rings_capture.c - the rings' vertices as the driver computes them, against the oracle. */
#include "rings_capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "feedback.h"

static const long double pi = 3.14159265358979323846264338327950288L;

/* In place of renderer.vert: the same, and what was looked up, by the same functions. */
static const char captured_main[] =
    "out vec3 c_position;\n"
    "out vec4 c_map[3];\n"
    "invariant gl_Position;\n"
    "void main()\n"
    "{\n"
    "    vec3 position = surface_vertex();\n"
    "    gl_Position = view_projection * vec4(position, 1.0);\n"
    "    c_position = position;\n"
    "    for (int chart = 0; chart < 3; chart++) {\n"
    "        float share;\n"
    "        vec2 place = map_chart(chart, in_vertex.xyz, in_vertex.w, share);\n"
    "        Spot spot;\n"
    "        bool there = find_spot(stack_of(chart), place, shift_of(in_vertex.w, 0.0), spot);\n"
    "        c_map[chart] = there ? vec4(spot.at, float(spot.layer), spot.alpha) : vec4(0.0, 0.0, -1.0, 0.0);\n"
    "    }\n"
    "}\n";

rings_capture rings_capture_create(globe_scene *globe)
{
    rings_capture c = {.globe = globe};
    const tc_surface *surface = globe->surface;
    c.program = feedback_program(globe->gl, surface, "", NULL, captured_main,
                                 (const char *[]){"gl_Position", "c_position", "c_map", NULL});
    c.plain = feedback_program(globe->gl, surface, "", "renderer.vert", "", (const char *[]){"gl_Position", NULL});
    size_t vertices = (size_t)globe->surface->geometry.vertex_count;
    c.vertices = calloc(vertices, sizeof *c.vertices);
    c.elements = calloc(vertices, sizeof *c.elements);
    c.positions = calloc(vertices, sizeof *c.positions);
    return c;
}

void rings_capture_destroy(rings_capture *c)
{
    c->globe->gl->DeleteProgram(c->program);
    c->globe->gl->DeleteProgram(c->plain);
    free(c->vertices);
    free(c->elements);
    free(c->positions);
    *c = (rings_capture){0};
}

/* What the camera sees of the windows as they stand. */
static rings_view view_of(rings_capture *c, const tc_camera *camera)
{
    scene s = {.surface = c->globe->surface, .renderer = c->globe->renderer};
    rings_view view = *(const rings_view *)scene_look(&s, camera, NULL);
    for (int chart = 0; chart < view.head.windows->charts; chart++)
        c->place[chart][0] = view.place[chart].x, c->place[chart][1] = view.place[chart].y;
    free(s.view);
    return view;
}

static double worse(double a, double b)
{
    return isnan(b) ? INFINITY : fmax(a, b);
}

/* How far apart two places of a level are that may be `turn` apart and still be one. */
static double apart(double a, double turn)
{
    return fabs(remainder(a, turn));
}

/* Samples between where the driver looked and where it should have, in the level that it read. */
static double texel_error(const rings_capture *capture, const captured_vertex *v, const oracle_vertex *o, int chart)
{
    const rings_surface *s = (const rings_surface *)capture->globe->surface;
    const tc_layers *layers = &tc_renderer_used(capture->globe->renderer).textures->layers;
    const tc_clipmap *clipmap = tc_renderer_used(capture->globe->renderer).windows->clipmap[chart];
    const tc_chart *c = &s->map->chart[chart];
    int first = tc_first_layer(layers, chart), layer = (int)v->map[chart][2];
    if (layer < 0)
        return 0;
    int shift = tc_clipmap_level(clipmap, layer - first + 1)->shift;
    double torus = 2.0 * (tc_clipmap_n(clipmap) + 1), least = INFINITY;
    double cell[2] = {rint(ldexp(capture->place[chart][0], -shift)), rint(ldexp(capture->place[chart][1], -shift))};
    for (int a = 0; a < 2; a++)
        cell[a] = (double)((int64_t)cell[a] & ((int64_t)torus - 1));
    double dx = (double)(v->map[chart][0] - ldexpl(o->x[chart], -shift)) + cell[0];
    double dy = (double)(v->map[chart][1] - ldexpl(o->y[chart], -shift)) + cell[1];
    for (int turn = -1; turn <= 1; turn++) /* where it wraps, half a turn from the viewer is on both sides */
        if (turn == 0 || c->wraps)
            least = fmin(least, apart(dx + turn * ldexp(2 * M_PI / c->dx, -shift), torus));
    return hypot(least, apart(dy, torus));
}

/* What vertex v is off the oracle's o. */
static void add_error(const rings_capture *capture, const tc_camera *camera, const captured_vertex *v,
                      const oracle_vertex *o, rings_error *e)
{
    const rings_surface *s = (const rings_surface *)capture->globe->surface;
    double d = 0;
    for (int i = 0; i < 3; i++)
        d = hypot(d, (double)(v->position[i] - o->position[i]));
    e->over_radius = worse(e->over_radius, d / s->map->body.radius);
    for (int chart = 0; chart < s->map->charts; chart++)
        if (o->weight[chart] > 1e-6L)
            e->texels = worse(e->texels, texel_error(capture, v, o, chart));
    long double pixel[2];
    e->vertices++;
    if (!rings_oracle_pixel(camera, o->position, pixel))
        return;
    double x = (0.5 + 0.5 * v->clip[0] / v->clip[3]) * camera->width - (double)pixel[0];
    double y = (0.5 + 0.5 * v->clip[1] / v->clip[3]) * camera->height - (double)pixel[1];
    e->pixels = worse(e->pixels, hypot(x, y));
    e->seen++;
}

static void compare(const rings_capture *capture, const rings_view *view, const tc_camera *camera,
                    const captured_vertex *v, long double theta, long double phi, long double w, rings_error *e)
{
    const rings_surface *s = (const rings_surface *)capture->globe->surface;
    oracle_vertex o = rings_oracle(s, view, camera, theta, phi, w);
    const tc_chart *c = &s->map->chart[0];
    /* Half a turn from the viewer is on both sides, and each may hold another level: either is right. */
    double turn = o.weight[0] > 0 ? fabs((double)(o.x[0] - view->place[0].x)) * c->dx : 0;
    if (turn > M_PI * (1 - 1e-9)) {
        rings_error side[2] = {{0}};
        for (int k = 0; k < 2; k++) {
            o = rings_oracle(s, view, camera, theta, phi + (k ? 1e-12L : -1e-12L), w);
            add_error(capture, camera, v, &o, &side[k]);
        }
        const rings_error *best = &side[side[1].over_radius < side[0].over_radius];
        e->over_radius = worse(e->over_radius, best->over_radius);
        e->pixels = worse(e->pixels, best->pixels);
        e->texels = worse(e->texels, best->texels);
        e->vertices++, e->seen += best->seen;
        return;
    }
    double t = (double)theta, half = sin(t / 2), sine = sin(t), height;
    height = tc_rings_height(view, sine * cos((double)phi), sine * sin((double)phi), 2 * half * half, (double)w, 0);
    e->differ += !(fabs((double)(height - o.height)) <= 1e-12 * s->map->body.radius);
    add_error(capture, camera, v, &o, e);
}

/* Captures every `step`-th column of rows from a vertex on, row by row, and a last vertex where it is not negative. */
static void capture_columns(rings_capture *c, int first, int rows, int step, int last)
{
    const rings_geometry *g = &((const rings_surface *)c->globe->surface)->geometry;
    int count = 0;
    for (int row = 0; row < rows; row++)
        for (int k = row % step; k < g->n_phi; k += step)
            c->elements[count++] = (uint32_t)(first + row * g->stride + k);
    if (last >= 0)
        c->elements[count++] = (uint32_t)last;
    feedback_elements(c->globe->gl, c->program, c->elements, count, sizeof *c->vertices / sizeof(float),
                      (float *)c->vertices);
}

void rings_capture_compare(rings_capture *c, const tc_camera *camera, int step, rings_error error[RINGS_MAX_LEVELS])
{
    const rings_surface *s = (const rings_surface *)c->globe->surface;
    const rings_geometry *g = &s->geometry;
    globe_scene_frame(c->globe, camera, false);
    rings_view view = view_of(c, camera);
    int first = tc_rings_level_base(g, view.first), rows = (view.finest - view.first + 1) * g->m + 1;
    capture_columns(c, first, rows, step, -1);
    const captured_vertex *v = c->vertices;
    for (int row = 0; row < rows; row++)
        for (int k = row % step; k < g->n_phi; k += step) {
            int i = view.first + row / g->m;
            long double j = row % g->m, theta = ldexpl(pi, -i) * (1 - j / (2 * g->m));
            compare(c, &view, camera, v++, theta, 2 * pi * k / g->n_phi, i + j / g->m, &error[i]);
        }
    first = tc_rings_fill_base(g, view.finest);
    capture_columns(c, first, g->fill, step, first + g->fill * g->stride);
    v = c->vertices;
    long double w = view.finest + 1, edge = ldexpl(pi, -view.finest - 1);
    for (int row = 0; row < g->fill; row++)
        for (int k = row % step; k < g->n_phi; k += step)
            compare(c, &view, camera, v++, edge * (1 - (long double)row / g->fill), 2 * pi * k / g->n_phi, w,
                    &error[view.finest + 1]);
    compare(c, &view, camera, v, 0, 0, w, &error[view.finest + 1]);
}

int rings_capture_offsets(rings_capture *c, const tc_camera *camera, int step, int capacity, double (*offset)[2])
{
    const rings_surface *s = (const rings_surface *)c->globe->surface;
    const rings_geometry *g = &s->geometry;
    globe_scene_frame(c->globe, camera, false);
    rings_view view = view_of(c, camera);
    int count = 0, from = view.finest - 4, rows = 5 * g->m;
    capture_columns(c, tc_rings_level_base(g, from), rows, step, -1);
    for (int row = 0; row < rows; row++)
        for (int k = row % step; k < g->n_phi && count < capacity; k += step, count++) {
            const captured_vertex *v = &c->vertices[count];
            int i = from + row / g->m;
            long double j = row % g->m, theta = ldexpl(pi, -i) * (1 - j / (2 * g->m)), pixel[2];
            oracle_vertex o = rings_oracle(s, &view, camera, theta, 2 * pi * k / g->n_phi, i + j / g->m);
            offset[count][0] = offset[count][1] = NAN;
            if (!rings_oracle_pixel(camera, o.position, pixel))
                continue;
            offset[count][0] = (0.5 + 0.5 * v->clip[0] / v->clip[3]) * camera->width - (double)pixel[0];
            offset[count][1] = (0.5 + 0.5 * v->clip[1] / v->clip[3]) * camera->height - (double)pixel[1];
        }
    return count;
}

static int64_t not_finite(rings_capture *c, int first, int count)
{
    const rings_geometry *g = &((const rings_surface *)c->globe->surface)->geometry;
    int64_t bad = 0;
    feedback_run(c->globe->gl, c->program, first, count, sizeof *c->vertices / sizeof(float), (float *)c->vertices);
    for (int i = 0; i < count; i++) {
        const captured_vertex *v = &c->vertices[i];
        if (i % g->stride > g->n_phi) /* between rows there is nothing */
            continue;
        for (int k = 0; k < 4; k++)
            bad += !isfinite(v->clip[k]) + (k < 3 && !isfinite(v->position[k]));
    }
    return bad;
}

int64_t rings_capture_not_finite(rings_capture *c, const tc_camera *camera)
{
    const rings_surface *s = (const rings_surface *)c->globe->surface;
    const rings_geometry *g = &s->geometry;
    globe_scene_frame(c->globe, camera, false);
    rings_view view = view_of(c, camera);
    int rows = (view.finest - view.first + 1) * g->m + 1;
    return not_finite(c, tc_rings_level_base(g, view.first), rows * g->stride) +
           not_finite(c, tc_rings_fill_base(g, view.finest), g->fill * g->stride + 1);
}

int64_t rings_capture_additions(rings_capture *c, const tc_camera *camera)
{
    const rings_surface *s = (const rings_surface *)c->globe->surface;
    int count = s->geometry.stride * s->geometry.m * s->geometry.levels;
    globe_scene_frame(c->globe, camera, false);
    feedback_run(c->globe->gl, c->program, 0, count, sizeof *c->vertices / sizeof(float), (float *)c->vertices);
    feedback_run(c->globe->gl, c->plain, 0, count, 4, (float *)c->positions);
    int64_t different = 0;
    for (int i = 0; i < count; i++)
        different += memcmp(c->vertices[i].clip, c->positions[i], sizeof c->positions[i]) != 0;
    return different;
}
