/* bench_popping.c - how much the ground that is drawn changes from frame to frame in a slow flight: popping.csv.
 *
 * A mesh of all samples stands still, whoever looks at it. What a scheme draws at a place of the ground does not:
 * levels pass over into each other, or are exchanged at once, and vertices that go with the viewer swim. So a change is
 * that of the height drawn at one and the same place, from one frame to the next, as it is seen: over the distance of
 * the eye, times W / (2 tan(fov/2)). A flight goes on by a two-hundredth of the eye's height above ground a frame,
 * which is 0.3 of it a second at 60 frames. The places are those that each 16th pixel of the flight's first frame
 * shows, on a lattice; one counts while it is in the frame. Over the default planet with synthesis down to less than a
 * metre. rings-ch06 is left out: heights in double are those of the exact transform, so that it would be rings once
 * more. Quick: one size, fewer places, one short flight from an aircraft and from space. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/camera.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum { FLIGHTS = 2, FRAMES = 40, SYNTHESIS = 14, WIDTH = 640, HEIGHT = 480, STEP = 8 };
enum { POINTS = WIDTH / STEP * (HEIGHT / STEP) };

typedef struct bench {
    measure_options options;
    tc_context *context;
    int first_rung, rungs, flights, frames, every; /* n-th of the places */
} bench;

typedef struct point {
    double place[2], p[3]; /* longitude and latitude; where that is in space */
    double z;              /* drawn in the last frame, metres; NAN: not in it */
} point;

/* Places that a picture shows; those of the rest are NAN. */
static void find_points(const scheme_planet *planet, const scene *s, const tc_camera *c, const float *depth, int every,
                        point points[POINTS])
{
    const tc_body *body = &planet->source->body;
    for (int k = 0; k < POINTS; k++) {
        const int x = k % (WIDTH / STEP) * STEP + STEP / 2, y = k / (WIDTH / STEP) * STEP + STEP / 2;
        const float d = depth[(size_t)y * WIDTH + (size_t)x];
        double at[3] = {NAN, NAN, NAN};
        points[k] = (point){.place = {NAN, NAN}, .z = NAN};
        if (d > 0 && k % every == 0) {
            tc_view_unproject(c, s->surface->near_plane, body, x + 0.5, y + 0.5, d, at);
            points[k].place[0] = at[0], points[k].place[1] = at[1];
            body->class->position(body, at, points[k].p);
        }
    }
}

/* Metres from the eye; 0: not in the frame. */
static double seen_at(const tc_body *body, const tc_camera *c, const double p[3])
{
    const double eye[3] = {c->x, c->y, c->z};
    double from[3], axes[3][3], way[3] = {0}, right = 0, up = 0, forward = 0, tx, ty;
    body->class->position(body, eye, from);
    body->class->axes(body, eye, axes);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            way[i] += axes[i][k] * (p[k] - from[k]);
    const tc_basis b = tc_camera_basis(c);
    for (int i = 0; i < 3; i++)
        right += b.right[i] * way[i], up += b.up[i] * way[i], forward += b.forward[i] * way[i];
    tc_camera_tangents(c, &tx, &ty);
    if (!(forward > 0 && fabs(right) <= tx * forward && fabs(up) <= ty * forward))
        return 0;
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
}

static void fly(const bench *b, const scheme_planet *planet, scene *s, tc_camera c, point points[POINTS],
                tc_error_stats *changes)
{
    const tc_gl *gl = tc_context_gl(b->context);
    const double above = scheme_above(planet, &c), scale = tc_camera_pixel_scale(&c);
    gl->Enable(GL_RASTERIZER_DISCARD);
    for (int k = 0; k < POINTS; k++)
        points[k].z = NAN;
    for (int frame = 0; frame <= b->frames; frame++) {
        scene_draw(s, &c, true);
        const tc_view *view = scene_look(s, &c, NULL); /* of windows that hold all of it */
        for (int k = 0; k < POINTS; k++) {
            point *q = &points[k];
            double z = NAN, distance = isnan(q->place[0]) ? 0 : seen_at(&planet->source->body, &c, q->p);
            if (distance > 0 && s->surface->height(view, q->place[0], q->place[1], &z) && isfinite(q->z))
                tc_error_stats_add(changes, fabs(z - q->z) / distance * scale);
            q->z = z;
        }
        c = scheme_onward(planet, &c, above, above / 200);
    }
    gl->Disable(GL_RASTERIZER_DISCARD);
}

/* All schemes over the same places on the same flights. */
static void measure_view(const bench *b, const scheme_planet *planet, scheme_view kind, int rung)
{
    static point points[POINTS];
    scene scenes[SCHEMES_MOST];
    tc_error_stats changes[SCHEMES_MOST];
    const tc_scheme *scheme[SCHEMES_MOST];
    int schemes = 0;
    test_random r = {300 + (uint64_t)kind};
    for (int k = 0; k < scheme_count(); k++)
        if (strcmp(scheme_of(k)->name, "rings-ch06") != 0)
            scheme[schemes++] = scheme_of(k);
    for (int k = 0; k < schemes; k++) {
        scenes[k] = scheme_scene(b->context, planet, scheme[k], scheme_size(scheme[k], rung));
        if (tc_error_stats_init(&changes[k]))
            exit(99);
    }
    for (int flight = 0; flight < b->flights; flight++) {
        const tc_camera c = scheme_camera(&r, planet, kind, WIDTH, HEIGHT);
        scene_draw(&scenes[0], &c, true);
        float *depth = planet_depth(&scenes[0], &c);
        find_points(planet, &scenes[0], &c, depth, b->every, points);
        free(depth);
        for (int k = 0; k < schemes; k++)
            fly(b, planet, &scenes[k], c, points, &changes[k]);
    }
    for (int k = 0; k < schemes; k++) {
        const tc_error_stats *e = &changes[k];
        const char *view = scheme_view_name[kind], *name = scheme[k]->name;
        const int n = scheme_size(scheme[k], rung), frames = b->flights * b->frames;
        const double rms = tc_error_stats_rms(e), p999 = tc_error_stats_percentile(e, 0.999);
        printf("%-14s %-8s %-10s %4d: %lld changes in %d frames, rms %.5f, 99.9 %% %.5f, largest %.4f px\n",
               planet->name, view, name, n, (long long)e->count, frames, rms, p999, e->max);
        if (b->options.csv)
            fprintf(b->options.csv, "%s,%s,%s,%d,%d,%lld,%.6f,%.6f,%.6f\n", planet->name, view, name, n, frames,
                    (long long)e->count, rms, p999, e->max);
        tc_error_stats_free(&changes[k]);
        scene_destroy(&scenes[k]);
    }
    fflush(stdout);
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    const bench *b = context;
    for (int rung = b->first_rung; rung < b->first_rung + b->rungs; rung++)
        for (scheme_view kind = b->options.quick ? VIEW_AIRCRAFT : VIEW_GROUND; kind <= VIEW_SPACE; kind++)
            measure_view(b, planet, kind, rung);
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv, "planet,view,scheme,n,frames,changes,rms_px,p999_px,max_px");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.first_rung = 1, b.rungs = b.options.quick ? 1 : 2;
    b.flights = b.options.quick ? 1 : FLIGHTS, b.frames = b.options.quick ? 12 : FRAMES;
    b.every = b.options.quick ? 5 : 2;
    scheme_default_planet(b.options.quick, SYNTHESIS, measure_planet, &b);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
