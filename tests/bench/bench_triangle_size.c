/* bench_triangle_size.c - how large the triangles of the schemes are on the screen, by the way that one looks:
 * triangle_size.csv. BN08 claims that its hexagons' are alike at any yaw.
 *
 * Triangles that lie whole in the frame and have an area, the square root of it in pixels: their number, mean, and
 * spread, the standard deviation over the mean. From the same places at the same yaws, counted together by yaw, over
 * the default planet with synthesis down to less than a metre, so that levels go on to the viewer from the ground, too.
 * Quick: one size, fewer yaws. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/drawn_triangles.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum { PLACES = 3, YAWS = 12, SYNTHESIS = 14, WIDTH = 640, HEIGHT = 480 };

/* Smaller ones have no area but for rounding, pixels. */
#define LEAST_AREA 1e-6

typedef struct sizes {
    int64_t count;
    double sum, squares;
} sizes;

typedef struct bench {
    measure_options options;
    tc_context *context;
    int first_rung, rungs, places, yaws;
} bench;

static void add(triangle_catcher *catcher, const tc_camera *c, sizes *sum)
{
    drawn_triangles t = triangle_catcher_draw(catcher, c);
    for (int64_t k = 0; k < t.count; k++) {
        const double area = drawn_triangle_area((const float(*)[4])t.clip[k], c);
        if (area > LEAST_AREA)
            sum->count++, sum->sum += sqrt(area), sum->squares += area;
    }
    free(t.clip);
}

static void measure_scheme(bench *b, const scheme_planet *planet, scheme_view kind, const tc_scheme *scheme, int n)
{
    scene s = scheme_scene(b->context, planet, scheme, n);
    triangle_catcher catcher = triangle_catcher_create(tc_context_gl(b->context), &s);
    sizes by_yaw[YAWS] = {{0}};
    test_random r = {200 + (uint64_t)kind};
    for (int place = 0; place < b->places; place++) {
        tc_camera c = scheme_camera(&r, planet, kind, WIDTH, HEIGHT);
        for (int k = 0; k < b->yaws; k++) {
            c.heading = 2 * M_PI * k / b->yaws;
            add(&catcher, &c, &by_yaw[k]);
        }
    }
    for (int k = 0; k < b->yaws; k++) {
        const double count = (double)by_yaw[k].count / b->places, mean = by_yaw[k].sum / (double)by_yaw[k].count,
                     spread = sqrt(fmax(by_yaw[k].squares / (double)by_yaw[k].count - mean * mean, 0)) / mean;
        const int yaw = 360 * k / b->yaws;
        printf("%-14s %-8s %-10s %4d %3d degrees: %8.0f triangles, %.3f px, spread %.4f\n", planet->name,
               scheme_view_name[kind], scheme->name, n, yaw, count, mean, spread);
        if (b->options.csv)
            fprintf(b->options.csv, "%s,%s,%s,%d,%d,%.0f,%.4f,%.4f\n", planet->name, scheme_view_name[kind],
                    scheme->name, n, yaw, count, mean, spread);
    }
    fflush(stdout);
    triangle_catcher_destroy(&catcher);
    scene_destroy(&s);
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    bench *b = context;
    for (int rung = b->first_rung; rung < b->first_rung + b->rungs; rung++)
        for (scheme_view kind = VIEW_GROUND; kind <= VIEW_AIRCRAFT; kind++)
            for (int k = 0; k < scheme_count(); k++)
                measure_scheme(b, planet, kind, scheme_of(k), scheme_size(scheme_of(k), rung));
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv, "planet,view,scheme,n,yaw_deg,triangles,mean_px,spread");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.first_rung = 1, b.rungs = b.options.quick ? 1 : 2;
    b.places = b.options.quick ? 1 : PLACES, b.yaws = b.options.quick ? 4 : YAWS;
    scheme_default_planet(b.options.quick, SYNTHESIS, measure_planet, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
