/* bench_throttle.c - what throttling saves and costs: triangles and the processor time of a frame as shares of those of
 * the frame that is not throttled, frame by frame in turns, and the error on the screen. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "tests/support/measure.h"
#include "tests/support/measured.h"

enum { WIDTH = 640, HEIGHT = 480, MOST_PAIRS = 15 };

typedef struct bench {
    measure_options options;
    tc_context *context;
} bench;

/* Of all threads: a software renderer's work, whatever else the machine does. */
static double processor_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static double frame_ms(scene *s, const tc_camera *c, tc_scene_options *options, double throttle)
{
    options->frame.throttle = throttle;
    tc_renderer_set_options(s->renderer, options);
    double start = processor_ms();
    scene_draw(s, c, true);
    return processor_ms() - start;
}

static double error_px(scene *s, const measured *m, const tc_camera *c)
{
    tc_error_stats e;
    if (tc_error_stats_init(&e))
        exit(99);
    const tc_truth truth = measured_truth(m);
    const tc_body body = measured_body(m);
    float *depth = planet_depth(s, c);
    if (tc_view_error_add(c, s->surface->near_plane, &body, depth, &truth, &e))
        exit(1);
    double p999 = tc_error_stats_percentile(&e, 0.999);
    free(depth);
    tc_error_stats_free(&e);
    return p999;
}

static void measure_view(bench *b, scene *s, const measured *m, int height, tc_scene_options *options)
{
    char name[112];
    const tc_camera c = measured_camera(m, height, 0, WIDTH, HEIGHT);
    int pairs = b->options.quick ? 5 : MOST_PAIRS;
    measured_scene_name(m, height, name, sizeof name);
    frame_ms(s, &c, options, 0);
    double whole = (double)tc_renderer_used(s->renderer).frame->triangles;
    for (double throttle = 0; throttle <= s->surface->most_throttle + 1e-9; throttle += 0.5) {
        double shares[MOST_PAIRS];
        frame_ms(s, &c, options, throttle);
        for (int i = 0; i < pairs; i++) {
            double all = frame_ms(s, &c, options, 0);
            shares[i] = frame_ms(s, &c, options, throttle) / all;
        }
        measure_spread time = measure_of(shares, pairs);
        double triangles = (double)tc_renderer_used(s->renderer).frame->triangles, error = error_px(s, m, &c);
        printf("%-20s %-7s throttle %.1f: %.3f of %.0f triangles, %.2f of the time (%.2f to %.2f), 99.9 %% within %.2f "
               "pixels\n",
               name, s->surface->name, throttle, triangles / whole, whole, time.median, time.low, time.high, error);
        if (b->options.csv)
            fprintf(b->options.csv, "%s,%s,%.1f,%.0f,%.4f,%.4f\n", name, s->surface->name, throttle, triangles,
                    time.median, error);
    }
}

static void measure_terrain(void *context, const measured *m)
{
    bench *b = context;
    tc_scene_options options = {.unlit = true, .background_set = true, .budget = -1, .throttle = true};
    const tc_rings_options rings = {.n_phi = 512};
    scene s = measured_scene(b->context, m, m->round ? 512 : 255, m->round ? &rings : NULL, &options);
    for (int height = 0; height < 3; height++)
        measure_view(b, &s, m, height, &options);
    scene_destroy(&s);
}

int main(int argc, char **argv)
{
    bench b = {.options = measure_begin(argc, argv, "scene,scheme,throttle,triangles,time_share,p999_px")};
    b.context = scene_context();
    if (!b.context)
        return 1;
    measured_all(b.options.quick, measure_terrain, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
