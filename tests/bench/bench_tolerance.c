/* bench_tolerance.c - what a tolerance costs: blocks chosen by their error against the smallest plain clipmap that
 * keeps the same largest error; tolerance.csv.
 *
 * Flat terrains, from four heights, at two places each; planets by rings, hexagons and cube from the ground, an
 * aircraft and space, at four places each, whose pixels are counted together. Triangles and milliseconds are sums over
 * the places. Errors are view_error.h's, against what is drawn in its finest level. A pixel that is off by more than
 * 100 pixels shows a triangle edge-on, whose depth says nothing: it is counted apart. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/frame_clock.h"
#include "planar/square.h"
#include "tests/support/scheme_planets.h"
#include "tests/support/measured.h"

enum { WIDTH = 640, HEIGHT = 480, PLAINS = 5, TOLERANCES = 3, MOST_FRAMES = 5, ROUND_PLACES = 4, ROUND_PLAINS = 4 };
static const int plain_n[PLAINS] = {63, 127, 255, 511, 1023};
static const double tolerances[TOLERANCES] = {2, 1, 0.5};

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
    int frames;
} bench;

typedef struct cost {
    int64_t triangles, edge_on;
    int draws;
    double ms, p999, most;
} cost;

/* The largest error of no more than 100 pixels, to 1/512 of itself, and how many are larger. */
static double largest(const tc_error_stats *e, int64_t *larger_ret)
{
    *larger_ret = tc_error_stats_above(e, 100);
    return *larger_ret ? tc_error_stats_percentile(e, 1 - ((double)*larger_ret + 0.5) / (double)e->count) : e->max;
}

typedef struct scene_view {
    scene *s;
    const tc_camera *camera;
    tc_frame_stats stats;
} scene_view;

static void draw_scene(void *context, bool finish)
{
    scene_view *v = context;
    tc_error error;
    if (tc_renderer_frame(v->s->renderer, v->camera, finish, &v->stats, &error)) {
        fprintf(stderr, "tolerance: %s\n", error.text);
        exit(1);
    }
}

/* All places of a row. */
static cost measure_scene(bench *b, scene *s, const tc_camera *camera, int places, tc_truth truth, tc_body body)
{
    cost c = {0};
    tc_error_stats e;
    if (tc_error_stats_init(&e))
        exit(99);
    for (int p = 0; p < places; p++) {
        scene_view v = {s, &camera[p], scene_draw(s, &camera[p], true)};
        float *depth = planet_depth(s, &camera[p]);
        double ms[MOST_FRAMES];
        if (tc_view_error_add(&camera[p], s->surface->near_plane, &body, depth, &truth, &e))
            exit(1);
        free(depth);
        frame_clock_repeat(&b->clock, draw_scene, &v, b->frames, ms);
        c.ms += measure_of(ms, b->frames).median;
        c.triangles += v.stats.triangles, c.draws += v.stats.draws;
    }
    c.p999 = tc_error_stats_percentile(&e, 0.999), c.most = largest(&e, &c.edge_on);
    tc_error_stats_free(&e);
    return c;
}

static void print_plain(const char *name, const char *scheme, int n, const cost *c)
{
    printf("%-40s %-12s %4d %8lld triangles %5d draws %7.2f ms %.3f %.3f px\n", name, scheme, n,
           (long long)c->triangles, c->draws, c->ms, c->p999, c->most);
}

/* Against the smallest of the plain ones that is as near, or the largest. */
static void print_within(const bench *b, const char *name, const char *scheme, int n, double tolerance, const cost *c,
                         const cost *plain, const int *plain_size, int plains)
{
    int same = 0;
    while (same < plains - 1 && plain[same].most > c->most)
        same++;
    const cost *p = &plain[same];
    printf("%-40s %-12s %4d %8lld triangles %5d draws %7.2f ms %.3f %.3f px of %.1f: %.3f, %.3f of n = %d's%s", name,
           scheme, n, (long long)c->triangles, c->draws, c->ms, c->p999, c->most, tolerance,
           (double)c->triangles / (double)p->triangles, c->ms / p->ms, plain_size[same],
           p->most > c->most ? ", which is not as near" : "");
    printf(c->edge_on ? "; %lld edge-on\n" : "\n", (long long)c->edge_on);
    fflush(stdout);
    if (b->options.csv)
        fprintf(b->options.csv, "%s,%s,%.3g,%d,%lld,%.3f,%.5f,%.5f,%d,%lld,%.3f,%.5f\n", name, scheme, tolerance, n,
                (long long)c->triangles, c->ms, c->p999, c->most, plain_size[same], (long long)p->triangles, p->ms,
                p->most);
}

static void measure_terrain(void *context, const measured *m)
{
    bench *b = context;
    if (m->round)
        return;
    scene plain[PLAINS];
    for (int i = 0; i < PLAINS; i++)
        plain[i] = measured_scene(b->context, m, plain_n[i], NULL, &(tc_scene_options){0});
    for (int height = 0; height < MEASURED_HEIGHTS; height++) {
        char name[96];
        cost p[PLAINS];
        tc_camera camera[MEASURED_PLACES];
        measured_scene_name(m, height, name, sizeof name);
        for (int k = 0; k < MEASURED_PLACES; k++)
            camera[k] = measured_camera(m, height, k, WIDTH, HEIGHT);
        for (int i = 0; i < PLAINS; i++) {
            p[i] = measure_scene(b, &plain[i], camera, MEASURED_PLACES, measured_truth(m), measured_body(m));
            print_plain(name, "square", plain_n[i], &p[i]);
        }
        for (int t = 0; t < TOLERANCES; t++) {
            const tc_scene_options options = {.frame.error = tolerances[t]};
            const int n = tc_square_n_for(m->field, tolerances[t], &camera[0], NULL);
            scene s = measured_scene(b->context, m, n, NULL, &options);
            const cost c = measure_scene(b, &s, camera, MEASURED_PLACES, measured_truth(m), measured_body(m));
            print_within(b, name, "square-error", n, tolerances[t], &c, p, plain_n, PLAINS);
            scene_destroy(&s);
        }
    }
    for (int i = 0; i < PLAINS; i++)
        scene_destroy(&plain[i]);
}

/* A kind of view by one scheme, and by tolerances where it heeds them. */
static void measure_scheme(bench *b, const scheme_planet *planet, const char *name, const tc_scheme *scheme,
                           const tc_camera *camera)
{
    const tc_map *own = scheme_map(planet, scheme);
    const tc_truth truth = {planet_atlas_height, (void *)own};
    cost p[ROUND_PLAINS];
    int size[ROUND_PLAINS];
    char by_error[32];
    snprintf(by_error, sizeof by_error, "%s-error", scheme->name);
    for (int i = 0; i < ROUND_PLAINS; i++) {
        size[i] = scheme_size(scheme, i);
        scene s = scheme_scene(b->context, planet, scheme, size[i]);
        p[i] = measure_scene(b, &s, camera, ROUND_PLACES, truth, planet->source->body);
        print_plain(name, scheme->name, size[i], &p[i]);
        scene_destroy(&s);
    }
    for (int t = 0; t < TOLERANCES && scheme->by_error; t++) {
        const int n = size[ROUND_PLAINS - 1];
        scene s = scheme_scene_within(b->context, planet, scheme, n, tolerances[t]);
        const cost c = measure_scene(b, &s, camera, ROUND_PLACES, truth, planet->source->body);
        print_within(b, name, by_error, n, tolerances[t], &c, p, size, ROUND_PLAINS);
        scene_destroy(&s);
    }
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    test_random r = {15};
    for (int kind = VIEW_GROUND; kind <= VIEW_SPACE; kind++) {
        char name[96];
        tc_camera camera[ROUND_PLACES];
        snprintf(name, sizeof name, "%s-%s", planet->name, scheme_view_name[kind]);
        for (int k = 0; k < ROUND_PLACES; k++)
            camera[k] = scheme_camera(&r, planet, (scheme_view)kind, WIDTH, HEIGHT);
        for (int k = 0; k < scheme_count(); k++)
            if (k == 0 || scheme_of(k)->by_error)
                measure_scheme(context, planet, name, scheme_of(k), camera);
    }
}

int main(int argc, char **argv)
{
    static bench b;
    b.options =
        measure_begin(argc, argv,
                      "scene,scheme,tolerance_px,n,triangles,frame_ms,err_p999_px,err_max_px,plain_n,plain_triangles,"
                      "plain_frame_ms,plain_err_max_px");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.frames = b.options.quick ? 1 : 3;
    measured_all(b.options.quick, measure_terrain, &b);
    if (!b.options.quick)
        scheme_planets(false, measure_planet, &b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
