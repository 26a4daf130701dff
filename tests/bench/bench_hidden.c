/* bench_hidden.c - what leaving out blocks behind nearer ground saves: triangles of squares, by distance and with a
 * tolerance of a pixel, with blocks only outside the view left out and with both, in views all around from 2, 30 and
 * 300 m above ground; and what it costs the processor, of the time in which a frame's draws are made. hidden.csv.
 *
 * Blocks are only left out in frames that need no backs of triangles: where backs are asked for, none are. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "planar/square.h"
#include "tests/support/measure.h"
#include "tests/support/measured.h"

enum { WIDTH = 1280, HEIGHT = 720, HEADINGS = 8, HEIGHTS = 3, REPEATS = 9 };
static const double heights[HEIGHTS] = {2, 30, 300};
static const struct {
    const char *name;
    double error;
} kinds[] = {{"square", 0}, {"square-error", 1}};

typedef struct bench {
    measure_options options;
    tc_context *context;
} bench;

static double processor_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* Milliseconds of the processor in which the draws of a resident view are made: the least, since others disturb. */
static double draws_ms(scene *s, const tc_camera *camera, const tc_frame_options *options)
{
    const tc_renderer_use use = tc_renderer_used(s->renderer);
    tc_view *view = tc_view_allocate(s->surface);
    tc_frame frame = {0};
    double least = INFINITY;
    if (!view || !tc_frame_allocate(s->surface, &frame))
        exit(99);
    s->surface->look(s->surface, use.windows, camera, options, true, view);
    for (int i = 0; i < REPEATS; i++) {
        const double start = processor_ms();
        s->surface->draws(view, &use.textures->layers, &frame);
        least = fmin(least, processor_ms() - start);
    }
    tc_frame_free(&frame);
    free(view);
    return least;
}

static void measure_terrain(void *context, const measured *m)
{
    bench *b = context;
    if (m->round)
        return;
    for (int kind = 0; kind < 2; kind++) {
        const tc_camera wide = {.width = WIDTH, .height = HEIGHT, .fov = M_PI / 2};
        tc_scene_options options = {.frame.error = kinds[kind].error};
        const int n = kind ? tc_square_n_for(m->field, kinds[kind].error, &wide, NULL) : tc_clipmap_n_for(&wide);
        scene s = measured_scene(b->context, m, n, NULL, &options);
        for (int h = 0; h < HEIGHTS; h++) {
            int64_t all = 0, kept = 0;
            int blocks = 0, blocks_kept = 0;
            double ms = 0, more = 0, most = 0;
            for (int i = 0; i < MEASURED_PLACES * HEADINGS; i++) {
                tc_camera c = measured_camera(m, 0, i / HEADINGS, WIDTH, HEIGHT);
                c.z += heights[h] - measured_height(m, 0);
                c.heading = 2 * M_PI * (i % HEADINGS) / HEADINGS;
                options.frame.two_sided = true;
                tc_renderer_set_options(s.renderer, &options);
                tc_frame_stats f = scene_draw(&s, &c, true);
                const double without = draws_ms(&s, &c, &options.frame);
                all += f.triangles, blocks += f.blocks, ms += without;
                options.frame.two_sided = false;
                tc_renderer_set_options(s.renderer, &options);
                f = scene_draw(&s, &c, true);
                const double with = draws_ms(&s, &c, &options.frame) - without;
                kept += f.triangles, blocks_kept += f.blocks, more += with, most = fmax(most, with);
            }
            const int views = MEASURED_PLACES * HEADINGS;
            printf("%-24s %-12s %4d %4.0f m: triangles %8lld, %.3f with what is hidden left out; blocks %5d, %.3f; "
                   "%.3f ms and %.3f more, at most %.3f\n",
                   m->name, kinds[kind].name, n, heights[h], (long long)(all / views), (double)kept / (double)all,
                   blocks / views, (double)blocks_kept / blocks, ms / views, more / views, most);
            fflush(stdout);
            if (b->options.csv)
                fprintf(b->options.csv, "%s,%s,%d,%g,%lld,%lld,%d,%d,%.4f,%.4f,%.4f\n", m->name, kinds[kind].name, n,
                        heights[h], (long long)(all / views), (long long)(kept / views), blocks / views,
                        blocks_kept / views, ms / views, more / views, most);
        }
        scene_destroy(&s);
    }
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv,
                              "terrain,scheme,n,height_m,triangles,triangles_kept,blocks,blocks_kept,draws_ms,more_ms,"
                              "most_more_ms");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    measured_all(b.options.quick, measure_terrain, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
