/* bench_views.c - views like those that papers give rates of: views.csv.
 *
 * LH04's and BN08's squares: n = 255, 90 degrees, 640 x 480, with 1 and with 4 samples a pixel, from four heights above
 * the default terrain. CH06's three situations (section 5.2): rings of 512 steps by 20, 1280 x 960, over the default
 * planet, by both map transforms; and its ground view 90 degrees wide, for which CH06 expects a factor of culling. Lit,
 * before a flat background, of held windows. Quick: squares from the lowest height, and the exact transform, alone.
 * Levels are counted from the coarsest one, of rings as CH06 does. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "spherical/rings_internal.h"
#include "tests/support/frame_clock.h"
#include "tests/support/measured.h"

enum { MOST_FRAMES = 9 };

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
    int frames;
} bench;

typedef struct view {
    scene *s;
    tc_camera camera;
} view;

static void draw(void *context, bool finish)
{
    const view *v = context;
    tc_frame_stats stats;
    tc_error error;
    if (tc_renderer_frame(v->s->renderer, &v->camera, finish, &stats, &error)) {
        fprintf(stderr, "views: %s\n", error.text);
        exit(1);
    }
}

/* all: triangles of the levels that are drawn, wherever they lie. */
static void put_view(bench *b, const measured *m, int height, scene *s, const tc_camera *camera, const char *scheme,
                     int n, int samples)
{
    view v = {s, *camera};
    tc_frame_stats stats = scene_draw(s, camera, true);
    long long all = (long long)stats.triangles_unculled, drawn = (long long)stats.triangles;
    int first = 1;
    if (m->round) {
        const rings_geometry *g = &((const rings_surface *)s->surface)->geometry;
        all = (stats.levels_active * 2 * (long long)g->m + 2 * g->fill - 1) * g->n_phi;
        first = stats.levels_beyond;
    }
    double ms[MOST_FRAMES];
    frame_clock_repeat(&b->clock, draw, &v, b->frames, ms);
    measure_spread t = measure_of(ms, b->frames);
    char name[96];
    measured_scene_name(m, height, name, sizeof name);
    int last = first + stats.levels_active - 1, degrees = (int)(camera->fov * 180 / M_PI + 0.5);
    printf("%-24s %-10s %4d %4dx%-4d %3d %2d  %2d to %2d %9lld %9lld %8.2f (%.2f to %.2f) ms\n", name, scheme, n,
           camera->width, camera->height, degrees, samples, first, last, all, drawn, t.median, t.low, t.high);
    fflush(stdout);
    if (b->options.csv)
        fprintf(b->options.csv, "%s,%s,%d,%d,%d,%d,%d,%d,%d,%lld,%lld,%.3f,%.3f,%.3f\n", name, scheme, n, camera->width,
                camera->height, degrees, samples, first, last, all, drawn, t.median, t.low, t.high);
}

static void squares(bench *b)
{
    enum { N = 255 };
    measured m = {.name = "default", .field = terrain_field(TERRAIN_DEFAULT, 4097, 4097, 30, 4)};
    for (int samples = 1; samples <= 4; samples += 3) {
        scene s = scene_create(b->context, m.field, N,
                               &(tc_scene_options){.background_set = true, .budget = -1, .samples = samples});
        for (int height = 0; height < (b->options.quick ? 1 : MEASURED_HEIGHTS); height++) {
            tc_camera c = measured_camera(&m, height, 0, 640, 480);
            put_view(b, &m, height, &s, &c, "square", N, samples);
        }
        scene_destroy(&s);
    }
    measured_close(&m);
}

static void rings(bench *b)
{
    static const int situation[] = {0, 1, 3};
    measured m = measured_default_planet();
    for (int ch06 = 0; ch06 < (b->options.quick ? 1 : 2); ch06++) {
        const tc_rings_options o = {.scheme = ch06 ? TC_RINGS_CH06 : TC_RINGS_EXACT, .n_phi = 512, .m = 20};
        scene s = planet_scene(b->context, m.planet, &o, &(tc_scene_options){.background_set = true, .budget = -1});
        for (int k = 0; k < 3; k++) {
            tc_camera c = measured_camera(&m, situation[k], 0, 1280, 960);
            put_view(b, &m, situation[k], &s, &c, s.surface->name, o.n_phi, 1);
        }
        tc_camera c = measured_camera(&m, 0, 0, 1280, 960);
        c.fov = M_PI / 2;
        put_view(b, &m, 0, &s, &c, s.surface->name, o.n_phi, 1);
        scene_destroy(&s);
    }
    measured_close(&m);
}

int main(int argc, char **argv)
{
    bench b = {.options = measure_begin(argc, argv,
                                        "scene,scheme,n,width,height,fov_deg,samples,first_level,last_level,"
                                        "triangles_levels,triangles,frame_ms,frame_low_ms,frame_high_ms")};
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.frames = b.options.quick ? 3 : MOST_FRAMES;
    squares(&b);
    rings(&b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
