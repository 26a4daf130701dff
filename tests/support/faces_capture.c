/* faces_capture.c - vertices of surfaces over faces as the driver computes them. */
#include "faces_capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/chart/joined.h"
#include "feedback.h"
#include "rings_oracle.h"

static const long double pi = 3.14159265358979323846264338327950288L;

/* In place of renderer.vert: the same, and where the vertex is. */
static const char captured_main[] = "out vec3 c_position;\n"
                                    "out vec2 c_place;\n"
                                    "invariant gl_Position;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    vec3 position = surface_vertex();\n"
                                    "    gl_Position = view_projection * vec4(position, 1.0);\n"
                                    "    c_position = position;\n"
                                    "    c_place = v_terrain.yz;\n"
                                    "}\n";

typedef struct captured {
    float clip[4], position[3], place[2];
} captured;
enum { FLOATS = sizeof(captured) / sizeof(float) };

faces_capture faces_capture_create(const tc_gl *gl, scene *s, const char *defines)
{
    const char *const varyings[] = {"gl_Position", "c_position", "c_place", NULL};
    return (faces_capture){gl, s, feedback_program(gl, s->surface, defines, NULL, captured_main, varyings)};
}

void faces_capture_destroy(faces_capture *c)
{
    c->gl->DeleteProgram(c->program);
}

/* A block that is drawn, by its instance. */
typedef struct drawn_block {
    const faces_view *view;
    tc_leaf leaf;
    int level, cells, finer; /* than the level whose window it reads */
    int64_t x, y;
} drawn_block;

static drawn_block block_of(const faces_view *view, const tc_layers *layers, const tc_instance *instance)
{
    const uint32_t bits = (uint32_t)instance->v[3];
    const faces_surface *s = tc_faces_of(view);
    drawn_block b = {.view = view, .cells = 1 << ((uint32_t)instance->v[2] >> 26), .finer = instance->v[2] & 31};
    int layer = (int)(bits & 127);
    while (b.leaf.block.chart + 1 < s->map->charts && layer >= tc_first_layer(layers, b.leaf.block.chart + 1))
        b.leaf.block.chart++;
    b.level = layer - tc_first_layer(layers, b.leaf.block.chart) + 1 + b.finer;
    b.leaf.sides = bits >> 7 & 15, b.leaf.corners = bits >> 11 & 15, b.leaf.forced = bits >> 15 & 15;
    b.leaf.finer_corners = bits >> 19 & 15, b.leaf.finer_halves = bits >> 23 & 255;
    const int shift = s->lattice.levels - b.level;
    b.x = instance->v[0] >> shift, b.y = instance->v[1] >> shift;
    /* A part of a block is a finer one's, which this mesh is drawn for. */
    b.leaf.coarse = b.cells < s->lattice.side[b.level - 1];
    b.leaf.block.level = b.level + b.leaf.coarse;
    b.leaf.block.x = (int32_t)(b.x / b.cells), b.leaf.block.y = (int32_t)(b.y / b.cells);
    return b;
}

/* Unit normal at sample (i, j) of a level. */
static void normal_at(const drawn_block *b, int64_t i, int64_t j, long double n[3])
{
    const faces_surface *s = tc_faces_of(b->view);
    const long double cells = (long double)tc_block_cells(&s->lattice, b->level), x = (long double)i / cells,
                      y = (long double)j / cells;
    const int face = b->leaf.block.chart;
    if (s->kind->chart == &tc_chart_hex) {
        const bool north = x + y <= 1;
        const long double t = north ? x + y : 2 - x - y, z = (north ? 1 : -1) * (1 - t * t),
                          turn = t > 0 ? (north ? y : 1 - x) / t : 0, lon = pi / 2 * (face + turn),
                          rho = t * sqrtl(2 - t * t);
        n[0] = rho * cosl(lon), n[1] = rho * sinl(lon), n[2] = z;
        return;
    }
    const long double a = tanl(pi / 4 * (2 * x - 1)), w = tanl(pi / 4 * (2 * y - 1)), l = sqrtl(1 + a * a + w * w);
    const long double lon = face * pi / 2;
    if (face < 4)
        n[0] = cosl(lon) - a * sinl(lon), n[1] = sinl(lon) + a * cosl(lon), n[2] = w;
    else
        n[0] = face == 4 ? -w : w, n[1] = a, n[2] = face == 4 ? 1 : -1;
    for (int k = 0; k < 3; k++)
        n[k] /= l;
}

/* The place so high above the body with that normal, from its middle. */
static void place_at(const tc_body *body, const long double n[3], long double height, long double p[3])
{
    const long double a = body->radius, q = 1 - (long double)body->flattening, e2 = 1 - q * q,
                      nu = a / sqrtl(1 - e2 * n[2] * n[2]);
    p[0] = (nu + height) * n[0], p[1] = (nu + height) * n[1], p[2] = (nu * (1 - e2) + height) * n[2];
}

typedef struct eye {
    long double place[3], axes[3][3], normal[3];
} eye;

static eye eye_of(const tc_body *body, const tc_camera *c)
{
    const long double sl = sinl(c->x), cl = cosl(c->x), sp = sinl(c->y), cp = cosl(c->y);
    eye e = {.axes = {{-sl, cl, 0}, {-sp * cl, -sp * sl, cp}, {cp * cl, cp * sl, sp}},
             .normal = {cp * cl, cp * sl, sp}};
    place_at(body, e.normal, c->z, e.place);
    return e;
}

static void seen_from(const eye *e, const long double p[3], long double seen[3])
{
    for (int i = 0; i < 3; i++) {
        seen[i] = 0;
        for (int k = 0; k < 3; k++)
            seen[i] += e->axes[i][k] * (p[k] - e->place[k]);
    }
}

/* Heights of a sample of the level and of the coarser one there; of levels finer than the windows' on the triangles of
 * these. */
static void sample(const drawn_block *b, int64_t i, int64_t j, long double z[2])
{
    const tc_clipmap *clipmap = b->view->head.windows->clipmap[b->leaf.block.chart];
    const int64_t mask = tc_clipmap_n(clipmap), one = (int64_t)1 << b->finer, x = i / one, y = j / one;
    const float(*pairs)[2] = tc_ground_heights(clipmap, b->level - b->finer);
    float of[4][2];
    for (int k = 0; k < 4; k++) {
        const int64_t u = x + (k & 1 && i % one), v = y + (k >> 1 && j % one);
        memcpy(of[k], pairs[(v & mask) * (mask + 1) + (u & mask)], sizeof of[k]);
    }
    const long double u = (long double)(i % one) / (long double)one, v = (long double)(j % one) / (long double)one;
    z[0] = u + v <= 1 ? (1 - u - v) * of[0][0] + u * of[1][0] + v * of[2][0]
                      : (u + v - 1) * of[3][0] + (1 - v) * of[1][0] + (1 - u) * of[2][0];
    z[1] = b->finer ? z[0] : (long double)of[0][1];
}

/* A vertex relative to the eye; whether it is on its way to a coarser edge. */
static bool vertex(const drawn_block *b, const eye *e, int64_t i, int64_t j, long double seen[3])
{
    const tc_map *map = tc_faces_of(b->view)->map;
    const long double z_base = tc_field_info(map->chart[0].field)->z_base;
    long double n[3], p[3], d[3] = {0};
    normal_at(b, i, j, n);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            d[k] += e->axes[k][c] * (n[c] - e->normal[c]);
    const double near[3] = {(double)d[0], (double)d[1], (double)d[2]};
    const double alpha = tc_faces_alpha(b->view, &b->leaf, b->level, b->cells, i - b->x, j - b->y, near);
    long double z[2];
    sample(b, i, j, z);
    const bool between = (i & 1) || (j & 1);
    place_at(&map->body, n, z_base + (between ? z[0] : (1 - alpha) * z[0] + alpha * z[1]), p);
    seen_from(e, p, seen);
    if (!between || alpha <= 0)
        return false;
    const int64_t di = i & 1, dj = i & 1 ? -(j & 1) : 1;
    for (int k = 0; k < 3; k++)
        seen[k] *= 1 - alpha;
    for (int end = -1; end <= 1; end += 2) {
        long double q[3];
        normal_at(b, i + end * di, j + end * dj, n);
        sample(b, i + end * di, j + end * dj, z);
        place_at(&map->body, n, z_base + z[1], p);
        seen_from(e, p, q);
        for (int k = 0; k < 3; k++)
            seen[k] += alpha * 0.5L * q[k];
    }
    return true;
}

static void compare(const drawn_block *b, const eye *e, const tc_camera *camera, int64_t i, int64_t j,
                    const captured *v, faces_error *error)
{
    const faces_surface *s = tc_faces_of(b->view);
    long double seen[3], pixel[2];
    const bool between = vertex(b, e, i, j, seen);
    for (int k = 0; k < 9; k++)
        error->not_finite += !isfinite(k < 4 ? v->clip[k] : k < 7 ? v->position[k - 4] : v->place[k - 7]);
    error->vertices++;
    double place[2] = {(double)i, (double)j}, off = 0;
    for (int a = 0; a < 2; a++) {
        double viewer = fmin(fmax(b->view->chart[b->leaf.block.chart][a], 0), (double)s->cells);
        off =
            hypot(off, ldexp((double)v->place[a], b->finer) - (place[a] - ldexp(viewer, b->level - s->lattice.levels)));
    }
    if (!rings_oracle_pixel(camera, seen, pixel))
        return;
    error->samples = isnan(off) ? INFINITY : fmax(error->samples, off);
    double x = (0.5 + 0.5 * v->clip[0] / v->clip[3]) * camera->width - (double)pixel[0];
    double y = (0.5 + 0.5 * v->clip[1] / v->clip[3]) * camera->height - (double)pixel[1];
    double d = hypot(x, y);
    if (getenv("VERBOSE") && d > 0.01 && d > error->pixels)
        fprintf(stderr, "chart %d level %d (%lld, %lld): %.4f px; %.9Lg %.9Lg %.9Lg, found %.9g %.9g %.9g\n",
                b->leaf.block.chart, b->level, (long long)i, (long long)j, d, seen[0], seen[1], seen[2],
                (double)v->position[0], (double)v->position[1], (double)v->position[2]);
    error->pixels = isnan(d) ? INFINITY : fmax(error->pixels, d);
    error->seen++, error->between += between;
}

/* Calls for each block of a frame, with its vertices. */
static void each_block(faces_capture *c, const tc_camera *camera, const tc_frame_options *options,
                       void (*block)(void *context, const drawn_block *b, const captured *v, int stride), void *context)
{
    static const tc_frame_options none;
    scene *s = c->scene;
    scene_leave_draws_out(s->surface);
    scene_draw(s, camera, true);
    scene_put_draws_back(s->surface);
    const tc_view *view = scene_look(s, camera, options ? options : &none);
    const tc_layers *layers = &tc_renderer_used(s->renderer).textures->layers;
    tc_frame frame;
    if (!tc_frame_allocate(s->surface, &frame))
        exit(99);
    s->surface->draws(view, layers, &frame);
    const int count = s->surface->geometry.vertex_count, stride = (int)lrint(sqrt(count));
    captured *v = calloc((size_t)count, sizeof *v);
    if (!v)
        exit(99);
    GLint vao;
    GLuint instances;
    c->gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &vao);
    c->gl->CreateBuffers(1, &instances);
    c->gl->NamedBufferStorage(instances, (GLsizeiptr)((size_t)(frame.strip_draws + 1) * sizeof(tc_instance)),
                              frame.instances, 0);
    for (int n = 0; n < frame.strip_draws; n++) {
        const drawn_block b = block_of((const faces_view *)view, layers, &frame.instances[n]);
        c->gl->VertexArrayVertexBuffer((GLuint)vao, 1, instances, (GLintptr)((size_t)n * sizeof(tc_instance)),
                                       sizeof(tc_instance));
        feedback_run(c->gl, c->program, 0, count, FLOATS, (float *)v);
        block(context, &b, v, stride);
    }
    c->gl->DeleteBuffers(1, &instances);
    tc_frame_free(&frame);
    free(v);
}

/* ---- Against long double ---------------------------------------------------------------------------------------- */

typedef struct comparing {
    const tc_camera *camera;
    eye eye;
    faces_error *error;
} comparing;

static void compare_block(void *context, const drawn_block *b, const captured *v, int stride)
{
    comparing *c = context;
    for (int j = 0; j <= b->cells; j++)
        for (int i = 0; i <= b->cells; i++)
            compare(b, &c->eye, c->camera, b->x + i, b->y + j, &v[j * stride + i], c->error);
}

void faces_capture_compare(faces_capture *c, const tc_camera *camera, const tc_frame_options *options,
                           faces_error *error)
{
    const tc_body *body = &((const faces_surface *)c->scene->surface)->map->body;
    each_block(c, camera, options, compare_block, &(comparing){camera, eye_of(body, camera), error});
}

/* ---- Against each other ----------------------------------------------------------------------------------------- */

typedef struct shared_vertex {
    int64_t at[3]; /* of the chart that has it: chart, finest samples */
    int chart;     /* that draws it */
    float clip[4];
} shared_vertex;

typedef struct sharing {
    shared_vertex *vertex;
    size_t count, room;
} sharing;

static void add_edge_vertices(void *context, const drawn_block *b, const captured *v, int stride)
{
    sharing *s = context;
    const faces_surface *surface = tc_faces_of(b->view);
    const int64_t step = surface->cells / tc_block_cells(&surface->lattice, b->level);
    for (int j = 0; j <= b->cells; j++)
        for (int i = 0; i <= b->cells; i++) {
            if (i != 0 && j != 0 && i != b->cells && j != b->cells)
                continue;
            if (s->count == s->room) {
                s->room = s->room ? 2 * s->room : 1 << 14;
                if (!(s->vertex = realloc(s->vertex, s->room * sizeof *s->vertex)))
                    exit(99);
            }
            shared_vertex *q = &s->vertex[s->count++];
            int face = q->chart = b->leaf.block.chart;
            q->at[1] = (b->x + i) * step, q->at[2] = (b->y + j) * step;
            tc_joined_owner(surface->kind->chart, surface->cells, &face, &q->at[1], &q->at[2]);
            q->at[0] = face;
            memcpy(q->clip, v[j * stride + i].clip, sizeof q->clip);
        }
}

static int by_place(const void *a, const void *b)
{
    const shared_vertex *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->at[k] != q->at[k])
            return p->at[k] < q->at[k] ? -1 : 1;
    return 0;
}

void faces_capture_shared(faces_capture *c, const tc_camera *camera, const tc_frame_options *options,
                          faces_shared *shared)
{
    sharing s = {0};
    each_block(c, camera, options, add_edge_vertices, &s);
    qsort(s.vertex, s.count, sizeof *s.vertex, by_place);
    for (size_t k = 0, run; k < s.count; k += run) {
        bool same = true, across = false;
        for (run = 1; k + run < s.count && by_place(&s.vertex[k], &s.vertex[k + run]) == 0; run++) {
            same &= memcmp(s.vertex[k].clip, s.vertex[k + run].clip, sizeof s.vertex[k].clip) == 0;
            across |= s.vertex[k].chart != s.vertex[k + run].chart;
        }
        shared->shared += run > 1, shared->across += across, shared->different += !same;
    }
    free(s.vertex);
}
