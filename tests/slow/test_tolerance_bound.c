/* test_tolerance_bound.c - pictures by a tolerance are off the finest level's mesh by no more than it allows.
 *
 * Every pixel that shows ground says by its depth where it saw it; there |drawn height - finest level's mesh| over the
 * distance from the eye, in pixels, is held against the tolerance (common/measure/view_error.h), where windows reach as
 * far as that asks for. On a globe the finest mesh is that along the charts, not bent flat (tc_map_height()), and what
 * the finest cells are flat by, a millimetre on an Earth, is allowed besides. Of triangles that are seen edge-on a
 * pixel's depth may say nothing: where the place is off the surface drawn, in double, by more than a pixel to all
 * sides, it is counted and left out. Where windows end before the tolerance is kept, what is drawn is held against the
 * error that the surface tells of itself. The whole sweep prints the table of docs/figures.md, "Error by name". */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/measure/view_error.h"
#include "planar/square_internal.h"
#include "spherical/faces_internal.h"
#include "tests/support/measured.h"
#include "tests/support/scheme_planets.h"
#include "tests/support/sweep.h"
#include "tests/support/watertight.h"

enum { WIDTH = 160, HEIGHT = 120, LARGEST_N = 1023, LARGEST_SIDE = 16, VIEWS = 500, BINS = 2000 };
#define MOST 1.1 /* of a tolerance */

static tc_context *context;

typedef struct totals {
    int views;
    int wide;  /* of them told to be off by more than the tolerance */
    int below; /* more of them, from below what is drawn so coarsely */
    int64_t pixels, edge_on;
    int64_t polar;       /* of cells of hexagons that touch a pole: left out */
    int64_t over, above; /* off by more than MOST; of those edge-on, by their depth alone */
    double worst;        /* of tolerances */
    int64_t count[BINS]; /* [n]: pixels of errors from n / BINS of a tolerance on, the last one of all above */
} totals;

static void add(totals *sum, const totals *t)
{
    sum->views += t->views, sum->below += t->below, sum->pixels += t->pixels, sum->edge_on += t->edge_on;
    sum->worst = fmax(sum->worst, t->worst), sum->above += t->above, sum->over += t->over;
    sum->wide += t->wide, sum->polar += t->polar;
    for (int n = 0; n < BINS; n++)
        sum->count[n] += t->count[n];
}

/* The error that all but so large a share of pixels are below, of tolerances, to 1 / BINS. */
static double percentile(const totals *t, double share)
{
    int64_t left = (int64_t)((1 - share) * (double)(t->pixels - t->edge_on));
    int n = BINS - 1;
    while (n > 0 && (left -= t->count[n]) >= 0)
        n--;
    return (n + 1) / (double)BINS;
}

/* A row of the table in docs/figures.md. */
static void tell_row(const char *terrain, const char *by, const totals *t)
{
    printf("| %s | %s | %d, %d | %lld | %.3f | %.3f | %lld | %lld, %lld | %lld |\n", terrain, by, t->views, t->wide,
           (long long)t->pixels, t->worst, percentile(t, 0.999), (long long)t->over, (long long)t->edge_on,
           (long long)t->above, (long long)t->polar);
    fflush(stdout);
}

/* What to print of a view where something is wrong. */
static void tell_view(const tc_camera *c, double error, const double p[3], double off)
{
    printf(
        "tolerance %.17g: %.4f of it at %.17g %.17g %.17g from x %.17g y %.17g z %.17g heading %.17g pitch %.17g fov "
        "%.17g\n",
        error, off, p[0], p[1], p[2], c->x, c->y, c->z, c->heading, c->pitch, c->fov);
}

/* Whether the surface drawn passes through what is within a pixel of a place, metres; unit: of the place's x and y. */
static bool passes_by(const scene *s, const tc_view *view, const double p[3], double a_pixel, const double unit[2])
{
    double lo = INFINITY, hi = -INFINITY, z;
    for (int k = 0; k < 4; k++) {
        const double way = (k & 1 ? a_pixel : -a_pixel) / unit[k >> 1];
        if (!s->surface->height(view, p[0] + (k < 2 ? way : 0), p[1] + (k < 2 ? 0 : way), &z))
            continue;
        lo = fmin(lo, z), hi = fmax(hi, z);
    }
    return p[2] > lo - a_pixel && p[2] < hi + a_pixel;
}

/* flat: metres that are allowed besides. */
static void look_at(scene *s, const tc_camera *c, const tc_scene_options *options, const tc_body *body,
                    const tc_truth *truth, double flat, double pole, totals *t)
{
    const tc_lens lens = tc_view_lens(c);
    const double scale = tc_camera_pixel_scale(c), before = t->worst;
    double at[3] = {0}, worst = 0;
    tc_renderer_set_options(s->renderer, options);
    /* Where windows do not reach as far as the tolerance asks for, what is told. */
    const double told = scene_draw(s, c, true).error_bound, allowed = fmax(told, options->frame.error);
    const tc_view *view = scene_look(s, c, &options->frame);
    double ground;
    if (s->surface->height(view, c->x, c->y, &ground) && ground >= c->z) {
        t->below++;
        return;
    }
    float *depth = planet_depth(s, c);
    for (int i = 0; i < c->width * c->height; i++) {
        const double x = i % c->width + 0.5, y = i / c->width + 0.5;
        double p[3], ray[3], z, drawn, along = 0;
        if (depth[i] <= 0)
            continue;
        tc_view_unproject(c, s->surface->near_plane, body, x, y, depth[i], p);
        tc_lens_ray(&lens, x, y, ray);
        for (int k = 0; k < 3; k++)
            along += ray[k] * lens.basis.forward[k];
        const double a_pixel = s->surface->near_plane / (double)depth[i] / along / scale; /* metres */
        if (truth->height(truth->context, p[0], p[1], &z) || !isfinite(z) ||
            !s->surface->height(view, p[0], p[1], &drawn))
            continue; /* on the very rim */
        t->pixels++;
        const double unit[2] = {body->radius > 0 ? body->radius * fmax(cos(p[1]), 1e-6) : 1,
                                body->radius > 0 ? body->radius : 1};
        if (pole > 0 && fabs(p[1]) > M_PI / 2 - pole) {
            t->polar++;
            continue; /* there chart_hex's heights go evenly with longitude, those of a flat triangle do not */
        }
        const bool on_it = fabs(p[2] - drawn) <= a_pixel; /* else on a wall, which says more of x and y */
        if (!on_it && !passes_by(s, view, p, a_pixel, unit)) {
            t->edge_on++, t->above += fabs(p[2] - z) - flat > MOST * allowed * a_pixel;
            continue;
        }
        const double off = fmax(fabs((on_it ? p[2] : drawn) - z) - flat, 0) / a_pixel / allowed;
        t->over += off > MOST;
        t->count[(int)fmin(off * BINS, BINS - 1)]++;
        if (off > worst)
            worst = off, at[0] = p[0], at[1] = p[1], at[2] = p[2];
    }
    free(depth);
    t->views++, t->wide += told > options->frame.error, t->worst = fmax(before, worst);
    if (worst > MOST)
        tell_view(c, options->frame.error, at, worst);
}

/* ---- Flat ------------------------------------------------------------------------------------------------------- */

/* The least tolerance, metres of error a metre of distance, for which windows of LARGEST_N samples reach as far as
 * levels may be drawn. */
static double least_tolerance(const tc_field *field)
{
    double least = 1e-5;
    tc_field_know_errors(field);
    for (int level = 2; level <= tc_field_info(field)->levels; level++) {
        const tc_level size = tc_field_level(field, level);
        const tc_range r = tc_field_range(field, level, (tc_rect){0, 0, size.width, size.height});
        const double cells = tc_square_tree_reach(LARGEST_N, LARGEST_SIDE);
        least = fmax(least, (double)r.error / (cells * fmin(size.spacing_x, size.spacing_y)));
    }
    return least;
}

static tc_status flat_height(void *field, double x, double y, double *z_ret)
{
    const tc_status status = tc_field_height(field, x, y, z_ret);
    *z_ret += tc_field_info(field)->z_base;
    return status;
}

/* Windows of a few sizes, each for tolerances from the one on that they reach far enough for. */
static void flat(const char *name, tc_field *field, int views, uint64_t seed, totals *all)
{
    enum { SIZES = 3, STEP = 5 };
    totals t = {0};
    test_random r = {seed};
    const double least = least_tolerance(field);
    const tc_camera camera = {.width = 640, .fov = M_PI / 2};
    for (int size = 0; size < SIZES; size++) {
        const double from = least * pow(STEP, size), pixels = from * tc_camera_pixel_scale(&camera);
        int n = tc_square_n_for(field, pixels, &camera, NULL);
        while (n < LARGEST_N && /* a frame alone might have none so large */
               tc_square_tree_reach(n, LARGEST_SIDE) * from < tc_square_tree_reach(LARGEST_N, LARGEST_SIDE) * least)
            n = 2 * n + 1;
        tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .frame.error = pixels};
        scene s = scene_create(context, field, n, &options);
        for (int view = size; view < views; view += SIZES) {
            const tc_camera c = watertight_view(&r, field, 50e3, WIDTH, HEIGHT);
            options.frame.error = from * pow(STEP, test_random_unit(&r)) * tc_camera_pixel_scale(&c);
            look_at(&s, &c, &options, &(tc_body){&tc_plane_body, 0, 0}, &(tc_truth){flat_height, field}, 0, 0, &t);
        }
        scene_destroy(&s);
    }
    tell_row(name, "squares", &t);
    add(all, &t);
}

/* ---- Round ------------------------------------------------------------------------------------------------------ */

static void round_by(const char *name, const tc_map *planet, const faces_kind *kind, int views, uint64_t seed,
                     totals *all)
{
    totals t = {0};
    test_random r = {seed};
    tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .frame.error = 1};
    scene s = planet_scene_of(context, planet, planet_faces(planet, kind, LARGEST_N, &options), &options);
    const double edge = FACES_LONGEST * ((const faces_surface *)s.surface)->cell,
                 flat = edge * edge / 8 * planet->body.radius,
                 pole = kind == &tc_faces_hex ? 2 * ((const faces_surface *)s.surface)->cell : 0;
    for (int view = 0; view < views; view++) {
        const tc_camera c = planet_view(&r, planet, 0.5, 5 * planet->body.radius);
        options.frame.error = 0.1 * pow(200, test_random_unit(&r));
        look_at(&s, &c, &options, &planet->body, &(tc_truth){planet_atlas_height, (void *)planet}, flat, pole, &t);
    }
    scene_destroy(&s);
    tell_row(name, kind->name, &t);
    add(all, &t);
}

/* ---- All -------------------------------------------------------------------------------------------------------- */

static totals sum;

static void also_measured(void *unused, const measured *m)
{
    (void)unused;
    if (!m->round)
        flat(m->name, m->field, sweep_of(60), 9, &sum);
}

/* The default planet, the Moon and ETOPO. */
static void also_planets(void *unused, const scheme_planet *planet)
{
    (void)unused;
    static const faces_kind *const kinds[] = {&tc_faces_hex, &tc_faces_cube};
    for (int k = 0; k < 2; k++)
        for (int n = 0; n < planet->atlases; n++)
            if (planet->own[n].atlas->class == kinds[k]->chart)
                round_by(planet->name, planet->own[n].map, kinds[k], sweep_of(60), 30 + (uint64_t)k, &sum);
}

static void pictures_keep_to_the_tolerance(void **state)
{
    (void)state;
    enum { FLAT = 4, SPACING = 30, KINDS = 2 };
    static const struct {
        terrain_kind kind;
        const char *name;
        int width, height, synthesised;
    } made[FLAT] = {{TERRAIN_CLIFF, "cliffs", 1025, 1025, 0},
                    {TERRAIN_SMOOTH, "hills", 1025, 700, 0},
                    {TERRAIN_DEFAULT, "default terrain", 1000, 1000, 0},
                    {TERRAIN_DEFAULT, "default terrain, synthesised", 190, 190, 6}};
    static const faces_kind *const kinds[KINDS] = {&tc_faces_hex, &tc_faces_cube};
    printf("| terrain | by | views, told wider | pixels | largest | 99.9 %% | above 1.1 | edge-on, of these above | at "
           "a pole |\n");
    for (int k = 0; k < FLAT; k++) {
        tc_field *field = terrain_synthesised(terrain_field(made[k].kind, made[k].width, made[k].height, SPACING, 7),
                                              made[k].synthesised);
        flat(made[k].name, field, sweep_of(VIEWS / (FLAT + KINDS)), (uint64_t)k + 1, &sum);
        tc_field_destroy(field);
    }
    for (int k = 0; k < KINDS; k++) {
        tc_map *planet = planet_of_faces(planet_made(PLANET_DEFAULT, 1024, 6371000, 5), kinds[k]->chart);
        round_by("default planet", planet, kinds[k], sweep_of(VIEWS / (FLAT + KINDS)), 20 + (uint64_t)k, &sum);
        tc_map_destroy(planet);
    }
    if (getenv("TERRACLIP_DATA") && sweep_whole()) {
        measured_all(false, also_measured, NULL);
        scheme_planets(false, also_planets, NULL);
    }
    tell_row("all", "", &sum);
    printf(
        "by tolerances: %d views, %lld pixels of ground, %lld of them seen edge-on (%.1e); largest error %.3f of the "
        "tolerance\n",
        sum.views, (long long)sum.pixels, (long long)sum.edge_on, (double)sum.edge_on / (double)sum.pixels, sum.worst);
    assert_true(sum.pixels > 5000 * sum.views);
    assert_true((double)sum.edge_on <= 1e-5 * (double)sum.pixels);
    assert_true(sum.worst <= MOST);
}

/* Frames drawn by more than the tolerance that they are held against are found. */
static void larger_errors_are_found(void **state)
{
    (void)state;
    enum { TIMES = 8 };
    tc_field *field = terrain_field(TERRAIN_DEFAULT, 1000, 1000, 30, 7);
    totals t = {0};
    test_random r = {3};
    const double least = TIMES * least_tolerance(field);
    tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .frame.error = 1};
    scene s = scene_create(context, field, LARGEST_N, &options);
    for (int view = 0; view < 10; view++) {
        const tc_camera c = watertight_view(&r, field, 50e3, WIDTH, HEIGHT);
        options.frame.error = least * tc_camera_pixel_scale(&c);
        look_at(&s, &c, &options, &(tc_body){&tc_plane_body, 0, 0}, &(tc_truth){flat_height, field}, 0, 0, &t);
    }
    scene_destroy(&s);
    tc_field_destroy(field);
    printf("by %d times the tolerance: at most %.3f of it\n", TIMES, TIMES * t.worst);
    assert_true(TIMES * t.worst > MOST);
}

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_keep_to_the_tolerance),
        cmocka_unit_test(larger_errors_are_found),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
