/* bench_tolerance.c - what a tolerance costs: blocks chosen by their error against the smallest plain clipmap that
 * keeps the same largest error; tolerance.csv.
 *
 * Flat terrains, from four heights, at two places each, whose pixels are counted together; triangles in the view and
 * milliseconds are those of both. Errors are view_error.h's. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/frame_clock.h"
#include "planar/square.h"
#include "tests/support/measured.h"

enum { WIDTH = 640, HEIGHT = 480, PLAINS = 5, TOLERANCES = 3, MOST_FRAMES = 5 };
static const int plain_n[PLAINS] = {63, 127, 255, 511, 1023};
static const double tolerances[TOLERANCES] = {2, 1, 0.5};

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
    int frames;
} bench;

typedef struct cost {
    int64_t triangles;
    int draws;
    double ms, p999, most;
} cost;

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

/* All places from one height. */
static cost measure_scene(bench *b, const measured *m, int height, scene *s)
{
    cost c = {0};
    tc_error_stats e;
    if (tc_error_stats_init(&e))
        exit(99);
    for (int p = 0; p < MEASURED_PLACES; p++) {
        const tc_camera camera = measured_camera(m, height, p, WIDTH, HEIGHT);
        scene_view v = {s, &camera, scene_draw(s, &camera, true)};
        const tc_truth truth = measured_truth(m);
        const tc_body body = measured_body(m);
        float *depth = planet_depth(s, &camera);
        double ms[MOST_FRAMES];
        if (tc_view_error_add(&camera, s->surface->near_plane, &body, depth, &truth, &e))
            exit(1);
        free(depth);
        frame_clock_repeat(&b->clock, draw_scene, &v, b->frames, ms);
        c.ms += measure_of(ms, b->frames).median;
        c.triangles += v.stats.triangles, c.draws += v.stats.draws;
    }
    c.p999 = tc_error_stats_percentile(&e, 0.999), c.most = e.max;
    tc_error_stats_free(&e);
    return c;
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
        measured_scene_name(m, height, name, sizeof name);
        for (int i = 0; i < PLAINS; i++) {
            p[i] = measure_scene(b, m, height, &plain[i]);
            printf("%-40s square       %4d %8lld triangles %5d draws %7.2f ms %.3f %.3f px\n", name, plain_n[i],
                   (long long)p[i].triangles, p[i].draws, p[i].ms, p[i].p999, p[i].most);
        }
        for (int t = 0; t < TOLERANCES; t++) {
            const tc_scene_options options = {.frame.error = tolerances[t]};
            const int n = tc_square_n_for(m->field, tolerances[t], &(tc_camera){.width = WIDTH, .fov = M_PI / 2});
            scene s = measured_scene(b->context, m, n, NULL, &options);
            const cost c = measure_scene(b, m, height, &s);
            int same = 0;
            while (same < PLAINS - 1 && p[same].most > c.most)
                same++;
            const double triangles = (double)c.triangles / (double)p[same].triangles, ms = c.ms / p[same].ms;
            printf(
                "%-40s square-error %4d %8lld triangles %5d draws %7.2f ms %.3f %.3f px of %.1f: %.3f, %.3f of n = %d's"
                "%s\n",
                name, n, (long long)c.triangles, c.draws, c.ms, c.p999, c.most, tolerances[t], triangles, ms,
                plain_n[same], p[same].most > c.most ? ", which is not as near" : "");
            fflush(stdout);
            if (b->options.csv)
                fprintf(b->options.csv, "%s,%.3g,%d,%lld,%.3f,%.5f,%.5f,%d,%lld,%.3f,%.5f\n", name, tolerances[t], n,
                        (long long)c.triangles, c.ms, c.p999, c.most, plain_n[same], (long long)p[same].triangles,
                        p[same].ms, p[same].most);
            scene_destroy(&s);
        }
    }
    for (int i = 0; i < PLAINS; i++)
        scene_destroy(&plain[i]);
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv,
                              "scene,tolerance_px,n,triangles,frame_ms,err_p999_px,err_max_px,plain_n,plain_triangles,"
                              "plain_frame_ms,plain_err_max_px");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.frames = b.options.quick ? 1 : 3;
    measured_all(b.options.quick, measure_terrain, &b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
