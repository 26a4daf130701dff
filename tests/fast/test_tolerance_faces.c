/* test_tolerance_faces.c - as test_tolerance.c has it, of planets drawn by hexagons and by a cube's chunks.
 *
 * Where windows end before their levels may go, distance lets heights pass over as well, by at most what a level is off
 * the coarser one there times the change of its alpha. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/field/field.h"
#include "spherical/faces_internal.h"
#include "tests/support/planet_scene.h"

enum { STEPS = 48, POINTS = 600, WIDTH = 1024, KINDS = 2 };
static const double RATE = 4;

typedef struct walk {
    const tc_map *map;
    tc_surface *surface;
    tc_windows windows;
    tc_view *view;
    tc_camera camera;
    tc_frame_options options;
    double x[POINTS], y[POINTS], drawn[POINTS], passes[POINTS];
} walk;

static void see(walk *w)
{
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    w->surface->look(w->surface, &w->windows, &w->camera, &w->options, true, w->view);
    w->surface->wanted(w->view, wanted);
    for (int chart = 0; chart < w->windows.charts; chart++) {
        tc_clipmap_update(w->windows.clipmap[chart], wanted[chart], -1, true, 0);
        assert_true(tc_clipmap_resident(w->windows.clipmap[chart]));
    }
    w->surface->look(w->surface, &w->windows, &w->camera, &w->options, true, w->view);
}

static double ground_at(const walk *w, double x, double y)
{
    double z;
    assert_int_equal(tc_map_height(w->map, x, y, &z), TC_OK);
    return z;
}

static void begin(walk *w, const tc_map *map, const faces_kind *kind, int n, double error)
{
    tc_error e;
    const tc_faces_options options = {.kind = kind, .n = n, .shaded_n = n < 255 ? n : 255};
    const double cell = 2 * M_PI / WIDTH;
    *w = (walk){.map = map, .options = {.error = error, .no_cull = true}};
    if (tc_faces_create(map, &options, &w->surface, &e) || w->surface->make_windows(w->surface, &w->windows, &e) ||
        !(w->view = tc_view_allocate(w->surface)))
        exit(99);
    /* Across a seam of either kind of charts. */
    w->camera = (tc_camera){.x = M_PI / 4 - 0.11, .y = 0.58, .fov = 1.5, .width = 640, .height = 480};
    test_random r = {4};
    for (int k = 0; k < POINTS; k++) { /* around the path, most of them near */
        const double reach = pow(2, test_random_range(&r, 0, 8)) * cell;
        w->x[k] = w->camera.x + test_random_range(&r, -reach, reach);
        w->y[k] = fmin(fmax(w->camera.y + test_random_range(&r, -reach, reach), -1.5), 1.5);
    }
}

static void end(walk *w)
{
    free(w->view);
    tc_windows_destroy(&w->windows);
    w->surface->destroy(w->surface);
}

/* Metres that a height may change by distance where the eye moves by a length on the unit sphere. */
static double passes(const walk *w, double x, double y, double way)
{
    const faces_view *v = (const faces_view *)w->view;
    const faces_surface *s = tc_faces_of(v);
    const tc_body *body = &w->map->body;
    const double place[3] = {x, y, 0};
    double normal[3], d[3], u, t;
    body->class->normal(body, place, normal);
    const int chart = tc_faces_chart(s->map, normal);
    s->map->chart[chart].class->from_place(&s->map->chart[chart], x, y, &u, &t);
    u = fmin(fmax(u, 0), 1) * (double)s->cells, t = fmin(fmax(t, 0), 1) * (double)s->cells;
    tc_faces_direction(v, chart, u, t, d);
    const double distance = s->kind->distance(d, v->height);
    const tc_leaf leaf = tc_block_leaf_at(&v->tree, chart, u, t);
    double most = 0;
    for (int level = leaf.block.level - 1; level <= leaf.block.level + 1; level++) {
        if (level < 2 || level > s->own)
            continue;
        const double range = tc_faces_range(v, level), cell = ldexp(1, s->lattice.levels - level);
        const double slack = 4 * cell * s->cell;
        if (distance + slack < FACES_PASSED * (1 - FACES_PASSAGE) * range)
            continue;
        const int64_t i = (int64_t)(u / cell), j = (int64_t)(t / cell);
        const tc_clipmap *clipmap = w->windows.clipmap[chart];
        const tc_range r = tc_field_range(tc_clipmap_field(clipmap), tc_clipmap_field_level(clipmap, level),
                                          (tc_rect){i - 2, j - 2, i + 4, j + 4});
        most = fmax(most, (double)r.step * way / (FACES_PASSED * FACES_PASSAGE * range));
    }
    return most;
}

/* Creeps over a seam, then climbs; returns heights that changed more than they may. */
static int creep(const tc_map *map, const faces_kind *kind, int n, double error, bool no_morph, double *worst)
{
    static walk w;
    int jumps = 0, moved = 0;
    const double radius = map->body.radius, spacing = 2 * M_PI * radius / WIDTH, pace = 0.5 * spacing;
    begin(&w, map, kind, n, error);
    w.options.no_morph = no_morph;
    w.camera.z = ground_at(&w, w.camera.x, w.camera.y) + 0.1 * spacing;
    *worst = 0;
    for (int s = 0; s <= STEPS; s++) {
        const double up = s < STEPS / 2 ? 0 : 0.08 * (w.camera.z + spacing), east = pace * cos(0.6),
                     north = pace * sin(0.6), high = 1 + w.camera.z / radius;
        const double way = hypot(pace * high, up), allowed = RATE * error / tc_camera_pixel_scale(&w.camera) * way;
        see(&w);
        for (int k = 0; k < POINTS; k++) {
            double z;
            const double passing = passes(&w, w.x[k], w.y[k], hypot(pace, up) / radius);
            assert_true(w.surface->height(w.view, w.x[k], w.y[k], &z));
            const double change = fabs(z - w.drawn[k]), may = allowed + fmax(passing, w.passes[k]);
            if (s > 0) {
                jumps += change > may + 1e-6 * spacing;
                moved += change > 1e-5 * spacing;
                *worst = fmax(*worst, change / may);
            }
            w.drawn[k] = z, w.passes[k] = passing;
        }
        w.camera.x += east / (radius * cos(w.camera.y)), w.camera.y += north / radius, w.camera.z += up;
    }
    assert_true(no_morph || moved > 1000); /* it was no idle walk */
    end(&w);
    return jumps;
}

static const faces_kind *const kinds[KINDS] = {&tc_faces_hex, &tc_faces_cube};
enum { PLANETS = 2 };
static const struct {
    planet_kind kind;
    const char *name;
    double radius;
} made[PLANETS] = {{PLANET_CLIFF, "cliffs", 400e3}, {PLANET_DEFAULT, "default planet", 6371000}};
static tc_map *planet[KINDS][PLANETS];

static int set_up(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS * PLANETS; k++)
        planet[k / PLANETS][k % PLANETS] = planet_of_faces(
            planet_made(made[k % PLANETS].kind, WIDTH, made[k % PLANETS].radius, 5), kinds[k / PLANETS]->chart);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS * PLANETS; k++)
        tc_map_destroy(planet[k / PLANETS][k % PLANETS]);
    return 0;
}

static const struct {
    int planet, n;
    double error;
} walks[] = {{0, 511, 60}, {0, 127, 20}, {1, 511, 0.1}, {1, 127, 0.5}};

static void heights_move_no_faster(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t k = 0; k < sizeof walks / sizeof *walks; k++) {
            double worst;
            const int jumps =
                creep(planet[kind][walks[k].planet], kinds[kind], walks[k].n, walks[k].error, false, &worst);
            printf("%s, tolerance %g px, %s, n = %d: %d jumps, largest change %.3f of what is allowed\n",
                   kinds[kind]->name, walks[k].error, made[walks[k].planet].name, walks[k].n, jumps, worst);
            assert_int_equal(jumps, 0);
        }
}

static void without_alpha_heights_jump(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        double worst;
        const int jumps = creep(planet[kind][1], kinds[kind], 511, 0.2, true, &worst);
        printf("%s, tolerance 0.2 px, without alpha: %d jumps, the largest %.1f times what is allowed\n",
               kinds[kind]->name, jumps, worst);
        assert_true(jumps > 10);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_move_no_faster),
        cmocka_unit_test(without_alpha_heights_jump),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
