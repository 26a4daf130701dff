/* bench_error_time.c - error on the screen against the time of a frame, for every scheme: error_time.csv, and beside it
 * frames.csv with what else there is to say of the same rows.
 *
 * Flat terrains by squares, with and without morph, and by squares whose blocks are chosen by a tolerance; planets by
 * rings with both map transforms; and the full-resolution mesh of each (plain_mesh.h), whose error is measured like the
 * others'. From four heights, at two places (--quick: one, and the mesh from the lowest and the highest alone), whose
 * pixels are counted together. Errors are view_error.h's. Frames repeat a view whose windows are held; median and
 * spread are each place's, and their means are in the tables: a spread is that of repeating, not that of views. Times
 * of the first view of a new scene, and what it loads, are in frames.csv. Marked with * on the terminal: no other row
 * of the scene is both faster and nearer to the truth (99.9th percentile). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "planar/square.h"
#include "tests/support/frame_clock.h"
#include "tests/support/measured.h"
#include "tests/support/plain_mesh.h"

enum { MOST_ROWS = 64, MOST_FRAMES = 5 };

typedef struct row {
    char scene[112];
    const char *scheme;
    int n;
    int64_t triangles;
    measure_spread frame;
    double brute_ms; /* NAN: not measured */
    double rms, p999, max;
    bool first_view; /* whether the following was measured */
    double first_ms, update_ms;
    int64_t samples, bytes;
    int draws, levels;
    double tolerance; /* pixels; 0: none */
} row;

typedef struct bench {
    measure_options options;
    FILE *frames_csv;
    tc_context *context;
    frame_clock clock;
    int width, height, places, frames;
    const char *suffix; /* of scene names, by the frame's size */
    row row[MOST_ROWS];
    int rows;
} bench;

/* ---- One row ----------------------------------------------------------------------------------------------------- */

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
        fprintf(stderr, "error against time: %s\n", error.text);
        exit(1);
    }
}

static void add_error(const measured *m, const tc_camera *c, double near_plane, float *depth, tc_error_stats *e)
{
    const tc_truth truth = measured_truth(m);
    const tc_body body = measured_body(m);
    if (tc_view_error_add(c, near_plane, &body, depth, &truth, e))
        exit(1);
    free(depth);
}

static void set_error(row *r, tc_error_stats *e)
{
    r->rms = tc_error_stats_rms(e), r->p999 = tc_error_stats_percentile(e, 0.999), r->max = e->max;
    tc_error_stats_free(e);
}

static row *new_row(bench *b, const measured *m, int height, const char *more, const char *scheme, int n)
{
    if (b->rows == MOST_ROWS)
        exit(99);
    row *r = &b->row[b->rows++];
    *r = (row){.scheme = scheme, .n = n, .brute_ms = NAN};
    char name[96];
    measured_scene_name(m, height, name, sizeof name);
    snprintf(r->scene, sizeof r->scene, "%s%s%s", name, more, b->suffix);
    return r;
}

/* A view of a scene that has just been made. */
static void first_view(scene *s, const tc_camera *c, row *r)
{
    scene_view v = {.s = s, .camera = c};
    r->first_view = true;
    do {
        draw_scene(&v, true);
        r->samples += v.stats.samples_updated, r->bytes += v.stats.bytes_uploaded;
        r->update_ms += v.stats.update_ms, r->first_ms += v.stats.update_ms + v.stats.draw_ms;
    } while (!v.stats.resident);
}

/* Adds a place's times to the mean of all. */
static void add_place(const bench *b, double *ms, int count, measure_spread *mean)
{
    measure_spread place = measure_of(ms, count);
    mean->median += place.median / b->places;
    mean->low += place.low / b->places, mean->high += place.high / b->places;
    mean->count += count;
}

/* All places from one height. */
static void measure_row(bench *b, const measured *m, int height, scene *s, row *r)
{
    double ms[MOST_FRAMES];
    tc_error_stats e;
    if (tc_error_stats_init(&e))
        exit(99);
    for (int p = 0; p < b->places; p++) {
        tc_camera c = measured_camera(m, height, p, b->width, b->height);
        scene_view v = {s, &c, scene_draw(s, &c, true)};
        add_error(m, &c, s->surface->near_plane, planet_depth(s, &c), &e);
        frame_clock_repeat(&b->clock, draw_scene, &v, b->frames, ms);
        add_place(b, ms, b->frames, &r->frame);
        r->triangles += v.stats.triangles / b->places;
        r->draws = v.stats.draws > r->draws ? v.stats.draws : r->draws;
        r->levels = v.stats.levels_active > r->levels ? v.stats.levels_active : r->levels;
    }
    set_error(r, &e);
}

/* ---- Brute force ------------------------------------------------------------------------------------------------- */

typedef struct mesh_view {
    const tc_gl *gl;
    const plain_mesh *mesh;
    const tc_camera *camera;
    double near_plane;
} mesh_view;

static void draw_mesh(void *context, bool finish)
{
    const mesh_view *v = context;
    plain_draw(v->gl, v->mesh, v->camera, v->near_plane, false);
    if (finish)
        v->gl->Finish();
}

/* A row of the full mesh; nothing where it is too large. NAN then, else milliseconds. */
static double measure_brute(bench *b, const measured *m, int height)
{
    const tc_gl *gl = tc_context_gl(b->context);
    double near_plane = m->round ? 1e-3 * fmin(1, m->planet->body.radius * 1e-3) : 1e-4, ms[MOST_FRAMES];
    int frames = b->clock.gpu ? b->frames : b->options.quick ? 1 : 2;
    tc_error_stats e;
    if (tc_error_stats_init(&e))
        exit(99);
    row *r = NULL;
    for (int p = 0; p < b->places; p++) {
        tc_camera c = measured_camera(m, height, p, b->width, b->height);
        plain_mesh mesh;
        bool done = m->round ? plain_brute_globe(gl, m->planet, &c, &mesh) : plain_brute_flat(gl, m->field, &c, &mesh);
        if (!done) {
            tc_error_stats_free(&e);
            return NAN;
        }
        if (!r)
            r = new_row(b, m, height, "", "brute", 0);
        mesh_view v = {gl, &mesh, &c, near_plane};
        draw_mesh(&v, true);
        add_error(m, &c, near_plane, plain_depth(gl, &mesh), &e);
        frame_clock_repeat(&b->clock, draw_mesh, &v, frames, ms);
        add_place(b, ms, frames, &r->frame);
        r->triangles = mesh.triangles, r->draws = mesh.strip_draws;
        plain_destroy(gl, &mesh);
    }
    r->brute_ms = r->frame.median;
    set_error(r, &e);
    return r->brute_ms;
}

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

/* Whether no row of the same scene is better in both. */
static bool best(const bench *b, const row *r)
{
    for (const row *q = b->row; q < b->row + b->rows; q++)
        if (strcmp(q->scene, r->scene) == 0 && q->frame.median <= r->frame.median && q->p999 <= r->p999 &&
            (q->frame.median < r->frame.median || q->p999 < r->p999))
            return false;
    return true;
}

static void write_rows(bench *b)
{
    for (const row *r = b->row; r < b->row + b->rows; r++) {
        char brute[32] = "";
        if (isfinite(r->brute_ms))
            snprintf(brute, sizeof brute, "%.3f", r->brute_ms);
        printf("%c %-44s %-12s %4d %10lld %8.2f (%.2f to %.2f) ms, brute %9s; %.4f %.4f %.4f px\n",
               best(b, r) ? '*' : ' ', r->scene, r->scheme, r->n, (long long)r->triangles, r->frame.median,
               r->frame.low, r->frame.high, *brute ? brute : "-", r->rms, r->p999, r->max);
        if (!b->options.csv)
            continue;
        char tolerance[32] = "";
        if (r->tolerance > 0)
            snprintf(tolerance, sizeof tolerance, "%g", r->tolerance);
        fprintf(b->options.csv, "%s,%s,%d,%lld,%.3f,%s,%.5f,%.5f,%.5f,%s\n", r->scene, r->scheme, r->n,
                (long long)r->triangles, r->frame.median, brute, r->rms, r->p999, r->max, tolerance);
        fprintf(b->frames_csv, "%s,%s,%d,%.3f,%.3f,%.3f,%d,%d,%d,", r->scene, r->scheme, r->n, r->frame.median,
                r->frame.low, r->frame.high, r->frame.count, r->draws, r->levels);
        if (r->first_view)
            fprintf(b->frames_csv, "%.3f,%.3f,%lld,%lld,%s\n", r->first_ms, r->update_ms, (long long)r->samples,
                    (long long)r->bytes, tolerance);
        else
            fprintf(b->frames_csv, ",,,,%s\n", tolerance);
    }
    fflush(stdout);
    b->rows = 0;
}

/* ---- Terrains ---------------------------------------------------------------------------------------------------- */

static void measure_flat(bench *b, const measured *m, int height, double brute_ms)
{
    static const int all[] = {31, 63, 127, 255, 511}, few[] = {63, 255};
    const int *n = b->options.quick ? few : all;
    for (int i = 0; i < (b->options.quick ? 2 : 5); i++) {
        tc_scene_options options = {0};
        scene s = measured_scene(b->context, m, n[i], NULL, &options);
        row *morph = new_row(b, m, height, "", "square", n[i]), *no_morph;
        tc_camera c = measured_camera(m, height, 0, b->width, b->height);
        first_view(&s, &c, morph);
        measure_row(b, m, height, &s, morph);
        no_morph = new_row(b, m, height, "-no-morph", "square", n[i]);
        options = (tc_scene_options){.budget = -1, .frame.no_morph = true};
        tc_renderer_set_options(s.renderer, &options);
        measure_row(b, m, height, &s, no_morph);
        morph->brute_ms = no_morph->brute_ms = brute_ms;
        scene_destroy(&s);
    }
}

/* The same by tolerances, in windows as large as they call for. */
static void measure_by_error(bench *b, const measured *m, int height, double brute_ms)
{
    static const double tolerances[] = {4, 2, 1, 0.5};
    const tc_camera c = measured_camera(m, height, 0, b->width, b->height);
    for (int i = b->options.quick ? 1 : 0; i < (b->options.quick ? 3 : 4); i++) {
        const tc_scene_options options = {.frame.error = tolerances[i]};
        const int n = tc_square_n_for(m->field, tolerances[i], &c, NULL);
        scene s = measured_scene(b->context, m, n, NULL, &options);
        row *r = new_row(b, m, height, "", "square-error", n);
        r->tolerance = tolerances[i];
        first_view(&s, &c, r);
        measure_row(b, m, height, &s, r);
        r->brute_ms = brute_ms;
        scene_destroy(&s);
    }
}

static void measure_round(bench *b, const measured *m, int height, double brute_ms)
{
    static const int all[] = {128, 256, 512, 1024}, few[] = {256, 512};
    const int *n = b->options.quick ? few : all;
    for (int ch06 = 0; ch06 < 2; ch06++)
        for (int i = 0; i < (b->options.quick ? 2 : 4); i++) {
            const tc_rings_options rings = {.scheme = ch06 ? TC_RINGS_CH06 : TC_RINGS_EXACT};
            scene s = measured_scene(b->context, m, n[i], &rings, &(tc_scene_options){0});
            row *r = new_row(b, m, height, "", s.surface->name, n[i]);
            tc_camera c = measured_camera(m, height, 0, b->width, b->height);
            first_view(&s, &c, r);
            measure_row(b, m, height, &s, r);
            r->brute_ms = brute_ms;
            scene_destroy(&s);
        }
}

static void measure_terrain(void *context, const measured *m)
{
    bench *b = context;
    static const struct {
        int width, height;
        const char *suffix;
    } size[] = {{640, 480, ""}, {1920, 1080, "-1080p"}};
    for (int k = 0; k < (b->clock.gpu ? 2 : 1); k++) {
        b->width = size[k].width, b->height = size[k].height, b->suffix = size[k].suffix;
        for (int height = 0; height < MEASURED_HEIGHTS; height++) {
            bool brute = !b->options.quick || height == 0 || height == MEASURED_HEIGHTS - 1;
            double brute_ms = brute ? measure_brute(b, m, height) : NAN;
            (m->round ? measure_round : measure_flat)(b, m, height, brute_ms);
            if (!m->round)
                measure_by_error(b, m, height, brute_ms);
            write_rows(b);
        }
    }
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv,
                              "scene,scheme,n,triangles,frame_ms,brute_ms,err_rms_px,err_p999_px,err_max_px,"
                              "tolerance_px");
    b.frames_csv = measure_beside(&b.options, "frames.csv",
                                  "scene,scheme,n,frame_ms,frame_low_ms,frame_high_ms,frames,draws,levels_active,"
                                  "first_view_ms,update_ms,samples_updated,bytes_uploaded,tolerance_px");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.places = b.options.quick ? 1 : MEASURED_PLACES, b.frames = b.options.quick ? 3 : 5;
    printf("error against time: %s, %s's time of a frame\n", tc_context_backend(b.context),
           b.clock.gpu ? "the GPU" : "the processor");
    measured_all(b.options.quick, measure_terrain, &b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    bool failed = b.frames_csv && (ferror(b.frames_csv) || fclose(b.frames_csv));
    return measure_end(&b.options) || failed;
}
