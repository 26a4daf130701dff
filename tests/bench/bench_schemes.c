/* bench_schemes.c - all schemes for planets beside each other: schemes.csv.
 *
 * A row is a scheme of one size in one kind of view (scheme_planets.h) over one planet; places are the same for all
 * schemes and sizes, and their pixels are counted together. Errors are view_error.h's, twice: against the source's own
 * samples, and (own_*) against those of the charts that the scheme draws, so that what resampling to faces loses is
 * told apart. Planets are drawn as they are, and one from the ground and from an aircraft with synthesis down to less
 * than a metre ("-detail"), so that levels go on to a viewer at the ground; each atlas then has its own detail, and
 * both errors are those against it, of every 31st pixel. Triangles and samples are means over the places. Samples held
 * are those of all windows' regions that are drawn. Frames repeat a view whose windows are held, all schemes of a size
 * in turns: frame_ms is a median, frame_ratio the median of the ratios to the first scheme's frame of the same turn.
 * Updates are those of a flight straight on as high above the ground, over 256 samples or the height, in 16 frames
 * (quick: 8) without pixels: update_ms is a frame's mean. Memory is what the windows, textures and the geometry take,
 * without the planet; map_samples are those of the data on the
 * planet's charts. Quick: two sizes, one place, the
 * default planet alone, from the ground and an aircraft with detail, from space as it is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "tests/support/frame_clock.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum { RUNGS = 3, PLACES = 2, TURNS = 3, STEPS = 16, SYNTHESIS = 14, DETAIL_EVERY = 31, WIDTH = 640, HEIGHT = 480 };

typedef struct row {
    tc_error_stats error, own;
    double triangles, held, ms[PLACES * TURNS], ratio[PLACES * TURNS], update_ms, kilometres;
    int64_t bytes;
    int frames, updates;
    bool twice; /* error is another than own */
} row;

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
    int rungs, places, turns, steps;
    const scheme_planet *planet;
    int schemes;
    scene scene[SCHEMES_MOST];
    row row[SCHEME_VIEWS][SCHEMES_MOST];
} bench;

typedef struct drawing {
    scene *s;
    const tc_camera *camera;
    tc_frame_stats stats;
} drawing;

static void draw(void *context, bool finish)
{
    drawing *d = context;
    tc_error error;
    if (tc_renderer_frame(d->s->renderer, d->camera, finish, &d->stats, &error)) {
        fprintf(stderr, "schemes: %s\n", error.text);
        exit(1);
    }
}

/* ---- One place --------------------------------------------------------------------------------------------------- */

static void add_error(const bench *b, const scene *s, const tc_map *truth, const tc_camera *c, const float *depth,
                      tc_error_stats *e)
{
    const tc_truth height = {planet_atlas_height, (void *)truth};
    if (tc_view_error_add(c, s->surface->near_plane, &b->planet->source->body, depth, &height, e))
        exit(1);
}

/* Where the source is what is drawn, or is no truth, once is enough. */
static void add_errors(const bench *b, scene *s, const tc_map *own, const tc_camera *c, row *r)
{
    float *depth = planet_depth(s, c);
    for (int k = 0; b->planet->detail && k < c->width * c->height; k++)
        depth[k] = k % DETAIL_EVERY ? 0 : depth[k];
    add_error(b, s, own, c, depth, &r->own);
    r->twice = own != b->planet->source && !b->planet->detail;
    if (r->twice)
        add_error(b, s, b->planet->source, c, depth, &r->error);
    free(depth);
}

static double samples_held(const scene *s)
{
    const tc_windows *w = tc_renderer_used(s->renderer).windows;
    double held = 0;
    for (int chart = 0; chart < w->charts; chart++)
        for (int level = 1; level <= tc_clipmap_levels(w->clipmap[chart]); level++) {
            const tc_rect r = tc_clipmap_level(w->clipmap[chart], level)->active;
            held += (double)tc_max64(r.x1 - r.x0, 0) * (double)tc_max64(r.y1 - r.y0, 0);
        }
    return held;
}

/* All schemes in turns, so that what else the machine does is shared by all of them. */
static void add_times(bench *b, scheme_view kind, const tc_camera *c)
{
    for (int turn = 0; turn < b->turns; turn++) {
        double first = 0;
        for (int k = 0; k < b->schemes; k++) {
            row *r = &b->row[kind][k];
            drawing d = {.s = &b->scene[k], .camera = c};
            const double ms = frame_clock_ms(&b->clock, draw, &d);
            first = k ? first : ms;
            r->ms[r->frames] = ms, r->ratio[r->frames++] = ms / first;
        }
    }
}

/* Without pixels: what windows and textures cost on the way. */
static void add_flight(const bench *b, scene *s, const tc_camera *from, row *r)
{
    const tc_gl *gl = tc_context_gl(b->context);
    const double above = scheme_above(b->planet, from), way = fmax(256 * b->planet->spacing, above);
    tc_camera c = *from;
    gl->Enable(GL_RASTERIZER_DISCARD);
    for (int step = 0; step < b->steps; step++) {
        c = scheme_onward(b->planet, &c, above, way / b->steps);
        drawing d = {.s = s, .camera = &c};
        do {
            draw(&d, true);
            r->update_ms += d.stats.update_ms, r->bytes += d.stats.bytes_uploaded;
        } while (!d.stats.resident);
        r->updates++;
    }
    gl->Disable(GL_RASTERIZER_DISCARD);
    r->kilometres += way / 1000;
}

static void measure_place(bench *b, scheme_view kind, const tc_camera *c)
{
    for (int k = 0; k < b->schemes; k++) {
        row *r = &b->row[kind][k];
        const tc_frame_stats stats = scene_draw(&b->scene[k], c, true);
        r->triangles += (double)stats.triangles / b->places;
        r->held += samples_held(&b->scene[k]) / b->places;
        add_errors(b, &b->scene[k], scheme_map(b->planet, scheme_of(k)), c, r);
    }
    add_times(b, kind, c);
    for (int k = 0; k < b->schemes; k++)
        add_flight(b, &b->scene[k], c, &b->row[kind][k]);
}

/* ---- Rows -------------------------------------------------------------------------------------------------------- */

static double map_samples(const tc_map *map)
{
    double samples = 0;
    for (int k = 0; k < map->charts; k++) {
        const tc_terrain_info *info = tc_field_info(map->chart[k].field);
        const tc_level l = tc_field_level(map->chart[k].field, info->levels - info->synthesised);
        samples += (double)l.width * (double)l.height;
    }
    return samples;
}

static void put(bench *b, scheme_view kind, int k, int n)
{
    row *r = &b->row[kind][k];
    tc_memory_stats memory;
    tc_renderer_memory(b->scene[k].renderer, &memory);
    const measure_spread ms = measure_of(r->ms, r->frames), ratio = measure_of(r->ratio, r->frames);
    tc_error_stats *error = r->twice ? &r->error : &r->own;
    const char *planet = b->planet->name, *view = scheme_view_name[kind], *scheme = scheme_of(k)->name;
    const double update = r->update_ms / r->updates, rms = tc_error_stats_rms(error),
                 p999 = tc_error_stats_percentile(error, 0.999), own_rms = tc_error_stats_rms(&r->own),
                 own_p999 = tc_error_stats_percentile(&r->own, 0.999), per_km = (double)r->bytes / r->kilometres,
                 bytes = (double)(memory.geometry + memory.heights + memory.normals);
    printf("%-14s %-8s %-10s %4d %8.0f triangles: %.4f %.4f %.4f px, own %.4f %.4f %.4f; %8.0f held, %9.0f bytes a km, "
           "update %.2f ms, frame %.2f ms (%.2f times), %.1f MB\n",
           planet, view, scheme, n, r->triangles, rms, p999, error->max, own_rms, own_p999, r->own.max, r->held, per_km,
           update, ms.median, ratio.median, 1e-6 * bytes);
    fflush(stdout);
    if (b->options.csv)
        fprintf(b->options.csv, "%s,%s,%s,%d,%.0f,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f,%.0f,%.0f,%.4f,%.3f,%.4f,%.0f,%.0f\n",
                planet, view, scheme, n, r->triangles, rms, p999, error->max, own_rms, own_p999, r->own.max, r->held,
                per_km, update, ms.median, ratio.median, bytes, map_samples(scheme_map(b->planet, scheme_of(k))));
    tc_error_stats_free(&r->error), tc_error_stats_free(&r->own);
}

static void measure_rung(bench *b, int rung)
{
    memset(b->row, 0, sizeof b->row);
    for (int k = 0; k < b->schemes; k++)
        b->scene[k] = scheme_scene(b->context, b->planet, scheme_of(k), scheme_size(scheme_of(k), rung));
    for (scheme_view kind = 0; kind < SCHEME_VIEWS; kind++) {
        const bool low = kind <= VIEW_AIRCRAFT;
        if ((b->planet->detail && !low) || (b->options.quick && (kind == VIEW_POLE || b->planet->detail != low)))
            continue;
        test_random r = {100 + (uint64_t)kind};
        for (int k = 0; k < b->schemes; k++)
            if (tc_error_stats_init(&b->row[kind][k].error) || tc_error_stats_init(&b->row[kind][k].own))
                exit(99);
        for (int place = 0; place < b->places; place++) {
            const tc_camera c = scheme_camera(&r, b->planet, kind, WIDTH, HEIGHT);
            measure_place(b, kind, &c);
        }
        for (int k = 0; k < b->schemes; k++)
            put(b, kind, k, scheme_size(scheme_of(k), rung));
    }
    for (int k = 0; k < b->schemes; k++)
        scene_destroy(&b->scene[k]);
}

static void measure_planet(void *context, const scheme_planet *planet)
{
    bench *b = context;
    b->planet = planet;
    for (int rung = 0; rung < b->rungs; rung++)
        measure_rung(b, rung);
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv,
                              "planet,view,scheme,n,triangles,err_rms_px,err_p999_px,err_max_px,own_rms_px,own_p999_px,"
                              "own_max_px,samples_held,bytes_per_km,update_ms,frame_ms,frame_ratio,memory_bytes,"
                              "map_samples");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.schemes = scheme_count();
    b.rungs = b.options.quick ? 2 : RUNGS, b.places = b.options.quick ? 1 : PLACES;
    b.turns = b.options.quick ? 2 : TURNS, b.steps = b.options.quick ? 8 : STEPS;
    scheme_default_planet(b.options.quick, SYNTHESIS, measure_planet, &b);
    scheme_planets(b.options.quick, measure_planet, &b);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
