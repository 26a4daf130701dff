/* bench_scaling.c - what frames and updates cost against the size of the terrain, the number of levels, the size of a
 * window, the speed of the viewer and the number of threads: scaling.csv.
 *
 * Terrains are the default one of 1025 x 1025 samples, repeated in mirror images as they are packed, so that all have
 * the same ground and none need fit into memory. A frame is 640 x 480, unlit, n = 255 unless said otherwise.
 *   size          samples a side; packed; a held view, and the first view of a scene that has just been opened
 *   levels        of detail at most, the same terrain in memory
 *   n             samples a side of a window
 *   speed         finest samples that the viewer moves between frames, within the budget of n x n samples a frame
 *   speed_packed  the same, decoded from the file meanwhile
 *   teleport      the same between places at random; the value is their mean distance, samples
 *   pack_threads, decode_threads  update_ms: of packing, and of reading the finest level by so many threads at once;
 *                 medians of three
 * update_ms is what windows and uploads take of a frame: the first view's where views are held, else the median. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/clock.h"
#include "planar/square.h"
#include "tests/support/frame_clock.h"
#include "tests/support/made_files.h"
#include "tests/support/scene.h"
#include "tests/support/terrain_files.h"
#include "tests/support/terrains.h"

enum { BASE = 1025, N = 255, HELD = 9, MOST_MOVES = 200, STRIP = 64 };
static const double spacing = 30;

typedef struct bench {
    measure_options options;
    tc_context *context;
    frame_clock clock;
    tc_grid base;
} bench;

/* NAN and negative: not measured. */
typedef struct figures {
    measure_spread frame;
    double update_ms;
    int64_t triangles, samples, bytes;
} figures;

static void put_ms(char *text, size_t size, double ms)
{
    snprintf(text, size, isfinite(ms) ? "%.3f" : "", ms);
}

static void put_count(char *text, size_t size, int64_t count)
{
    if (count >= 0)
        snprintf(text, size, "%lld", (long long)count);
    else
        *text = 0;
}

static void put_row(bench *b, const char *what, double value, const figures *f)
{
    char column[7][32];
    const double ms[4] = {f->frame.median, f->frame.low, f->frame.high, f->update_ms};
    const int64_t count[3] = {f->triangles, f->samples, f->bytes};
    for (int i = 0; i < 4; i++)
        put_ms(column[i], sizeof column[i], ms[i]);
    for (int i = 0; i < 3; i++)
        put_count(column[4 + i], sizeof column[4 + i], count[i]);
    printf("%-14s %8.0f  frame %9s (%s to %s) ms, update %9s ms, %9s triangles, %10s samples, %10s bytes\n", what,
           value, column[0], column[1], column[2], column[3], column[4], column[5], column[6]);
    fflush(stdout);
    if (b->options.csv)
        fprintf(b->options.csv, "%s,%.0f,%s,%s,%s,%s,%s,%s,%s\n", what, value, column[0], column[1], column[2],
                column[3], column[4], column[5], column[6]);
}

/* ---- Terrains ---------------------------------------------------------------------------------------------------- */

/* The base's height at any place, mirrored at its sides. */
static int64_t mirrored(int64_t i)
{
    i %= 2 * (BASE - 1);
    return i < BASE ? i : 2 * (BASE - 1) - i;
}

/* Packs size x size samples; returns milliseconds, without those that making the heights takes. */
static double pack(const bench *b, int64_t size, int threads, const char *path)
{
    const tc_pack_terrain terrain = {.width = size,
                                     .height = size,
                                     .spacing_x = spacing,
                                     .spacing_y = spacing,
                                     .sample_type = TC_SAMPLE_FLOAT32,
                                     .unit = 1};
    const tc_pack_options options = {.error = 0.06 * spacing, .threads = threads};
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error error;
    float *z = malloc((size_t)(size * STRIP) * sizeof *z);
    double start = tc_clock_ms(), ms = 0;
    terrain_must(z ? tc_packer_create(path, &terrain, &options, &packer, &error) : TC_ERR_MEMORY,
                 z ? &error : &(tc_error){.text = "not enough memory"});
    ms += tc_clock_ms() - start;
    for (int64_t y = 0; y < size; y += STRIP) {
        tc_rect strip = {0, y, size, tc_min64(y + STRIP, size)};
        for (int64_t j = strip.y0; j < strip.y1; j++)
            for (int64_t i = 0; i < size; i++)
                z[(j - y) * size + i] = b->base.z[mirrored(j) * BASE + mirrored(i)];
        start = tc_clock_ms();
        terrain_must(tc_packer_put(packer, strip, z, NULL, size, &error), &error);
        ms += tc_clock_ms() - start;
    }
    start = tc_clock_ms();
    terrain_must(tc_packer_finish(packer, &result, &error), &error);
    tc_packer_destroy(packer);
    ms += tc_clock_ms() - start;
    free(z);
    return ms;
}

static tc_field *in_memory(const bench *b, int64_t size)
{
    tc_grid g = {.width = size,
                 .height = size,
                 .spacing_x = spacing,
                 .spacing_y = spacing,
                 .z_min = b->base.z_min,
                 .z_max = b->base.z_max};
    tc_field *p;
    tc_error error;
    g.z = malloc((size_t)(size * size) * sizeof *g.z);
    terrain_must(g.z ? TC_OK : TC_ERR_MEMORY, &(tc_error){.text = "not enough memory"});
    for (int64_t j = 0; j < size; j++)
        for (int64_t i = 0; i < size; i++)
            g.z[j * size + i] = b->base.z[mirrored(j) * BASE + mirrored(i)];
    terrain_must(tc_field_build(&g, 0, &p, &error), &error);
    return p;
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

static scene open_scene(const bench *b, const tc_field *field, int n, int max_levels, int64_t budget)
{
    const tc_scene_options look = {.unlit = true, .background_set = true, .budget = budget};
    scene s = {.field = field};
    tc_error error;
    tc_ground_options clip = {.n = n, .max_levels = max_levels};
    terrain_must(tc_square_create(field, &clip, NULL, &s.surface, &error), &error);
    terrain_must(tc_renderer_create(tc_context_gl(b->context), s.surface, &look, &s.renderer, &error), &error);
    s.clipmap = tc_renderer_used(s.renderer).windows->clipmap[0];
    return s;
}

/* `above` metres above the ground of a place, in samples. */
static tc_camera camera_at(const bench *b, double x, double y, double above)
{
    int64_t i = mirrored((int64_t)x), j = mirrored((int64_t)y);
    return (tc_camera){.x = x * spacing,
                       .y = y * spacing,
                       .z = b->base.z[j * BASE + i] + above,
                       .heading = 0.6,
                       .pitch = -0.3,
                       .fov = M_PI / 2,
                       .width = 640,
                       .height = 480};
}

typedef struct frame_of {
    scene *s;
    tc_camera camera;
    tc_frame_stats stats;
} frame_of;

static void draw(void *context, bool finish)
{
    frame_of *f = context;
    tc_error error;
    terrain_must(tc_renderer_frame(f->s->renderer, &f->camera, finish, &f->stats, &error), &error);
}

/* The first view of a scene that has just been made, and then the view held. Destroys the scene. */
static figures held_view(const bench *b, scene s, double middle)
{
    frame_of f = {.s = &s, .camera = camera_at(b, middle + 100, middle + 60, 300)};
    figures r = {0};
    double ms[HELD];
    do {
        draw(&f, true);
        r.update_ms += f.stats.update_ms, r.samples += f.stats.samples_updated, r.bytes += f.stats.bytes_uploaded;
    } while (!f.stats.resident);
    frame_clock_repeat(&b->clock, draw, &f, HELD, ms);
    r.frame = measure_of(ms, HELD), r.triangles = f.stats.triangles;
    scene_destroy(&s);
    return r;
}

/* ---- What is varied ---------------------------------------------------------------------------------------------- */

static void sizes(bench *b)
{
    for (int64_t size = 1025; size <= (b->options.quick ? 4097 : 16385); size = 2 * size - 1) {
        const char *path = made_path("size.tclip");
        pack(b, size, 0, path);
        tc_field *p = terrain_open(path);
        figures f = held_view(b, open_scene(b, p, N, 0, -1), (double)(size / 2));
        put_row(b, "size", (double)size, &f);
        tc_field_destroy(p);
        unlink(path);
    }
}

static void levels_and_windows(bench *b, const tc_field *p, double middle)
{
    scene all = open_scene(b, p, N, 0, -1);
    int levels = tc_clipmap_levels(all.clipmap);
    scene_destroy(&all);
    for (int l = 1; l <= levels; l++) {
        figures f = held_view(b, open_scene(b, p, N, l, -1), middle);
        put_row(b, "levels", l, &f);
    }
    for (int n = 31; n <= (b->options.quick ? 511 : 1023); n = 2 * n + 1) {
        figures f = held_view(b, open_scene(b, p, n, 0, -1), middle);
        put_row(b, "n", n, &f);
    }
}

/* Frames of a viewer that moves; step: samples between them, negative for places at random. Whole frames with their
 * updates, by the clock on the wall. */
static void moving(bench *b, const tc_field *p, const char *what, double step)
{
    int64_t size = tc_field_level(p, tc_field_info(p)->levels).width;
    int moves = b->options.quick ? 25 : 80;
    double ms[MOST_MOVES], update[MOST_MOVES], samples[MOST_MOVES], bytes[MOST_MOVES], far = 0;
    double x = (double)size / 3, y = (double)size / 2, way = 1, margin = 300;
    scene s = open_scene(b, p, N, 0, 0);
    frame_of f = {.s = &s, .camera = camera_at(b, x, y, 300)};
    test_random r = {7};
    do
        draw(&f, true);
    while (!f.stats.resident);
    for (int i = 0; i < moves; i++) {
        double from_x = x, from_y = y;
        if (step < 0) {
            x = test_random_range(&r, margin, (double)size - margin);
            y = test_random_range(&r, margin, (double)size - margin);
        } else {
            if (x + way * 0.8 * step > (double)size - margin || x + way * 0.8 * step < margin)
                way = -way;
            x = fmin(fmax(x + way * 0.8 * step, 0), (double)size - 1);
            y = fmin(fmax(y + way * (i % 2 ? 0.6 : -0.6) * step, 0), (double)size - 1);
        }
        far += hypot(x - from_x, y - from_y) / moves;
        f.camera = camera_at(b, x, y, 300);
        double start = tc_clock_ms();
        draw(&f, true);
        ms[i] = tc_clock_ms() - start, update[i] = f.stats.update_ms;
        samples[i] = (double)f.stats.samples_updated, bytes[i] = (double)f.stats.bytes_uploaded;
    }
    figures g = {.frame = measure_of(ms, moves),
                 .update_ms = measure_of(update, moves).median,
                 .triangles = f.stats.triangles,
                 .samples = (int64_t)measure_of(samples, moves).median,
                 .bytes = (int64_t)measure_of(bytes, moves).median};
    put_row(b, what, step < 0 ? far : step, &g);
    scene_destroy(&s);
}

static void speeds(bench *b, const tc_field *p, const char *path)
{
    static const double steps[] = {0, 1, 4, 16, 64, 256};
    for (int i = 0; i < 6; i++)
        moving(b, p, "speed", steps[i]);
    moving(b, p, "teleport", -1);
    for (int i = b->options.quick ? 1 : 0; i < 6; i += b->options.quick ? 2 : 1) {
        tc_field *packed = terrain_open(path); /* with nothing decoded */
        moving(b, packed, "speed_packed", steps[i]);
        tc_field_destroy(packed);
    }
}

/* ---- Threads ----------------------------------------------------------------------------------------------------- */

enum { BLOCK = 256, REPEATS = 3 };

typedef struct reading {
    const tc_field *p;
    int64_t across;
} reading;

static void read_block(void *context, int64_t k)
{
    const reading *r = context;
    int finest = tc_field_info(r->p)->levels;
    int64_t x = k % r->across * BLOCK, y = k / r->across * BLOCK;
    float *z = malloc(sizeof *z * BLOCK * BLOCK);
    if (!z || tc_field_read(r->p, finest, (tc_rect){x, y, x + BLOCK, y + BLOCK}, z, NULL, BLOCK))
        exit(1);
    free(z);
}

/* Milliseconds to read the finest level of a file that has just been opened. */
static double decode(const char *path, int threads, int64_t across)
{
    tc_field *p = terrain_open(path);
    reading r = {p, across};
    double start = tc_clock_ms();
    tc_parallel_for(threads, across * across, read_block, &r);
    double ms = tc_clock_ms() - start;
    tc_field_destroy(p);
    return ms;
}

static void threads(bench *b, int64_t size)
{
    long most = sysconf(_SC_NPROCESSORS_ONLN);
    const char *path = made_path("threads.tclip");
    const double nothing = NAN;
    const int64_t blocks = (size - 1) / BLOCK; /* of a side */
    for (int k = 1; k <= most && k <= 16; k = k < most && 2 * k > most ? (int)most : 2 * k) {
        figures f = {.frame = {nothing, nothing, nothing, 0}, .triangles = -1, .bytes = -1, .samples = size * size};
        double packing[REPEATS], decoding[REPEATS];
        for (int i = 0; i < REPEATS; i++) {
            packing[i] = pack(b, size, k, path);
            decoding[i] = decode(path, k, blocks);
        }
        f.update_ms = measure_of(packing, REPEATS).median;
        put_row(b, "pack_threads", k, &f);
        f.update_ms = measure_of(decoding, REPEATS).median, f.samples = blocks * blocks * BLOCK * BLOCK;
        put_row(b, "decode_threads", k, &f);
    }
}

int main(int argc, char **argv)
{
    static bench b;
    b.options = measure_begin(argc, argv,
                              "what,value,frame_ms,frame_low_ms,frame_high_ms,update_ms,triangles,samples,"
                              "bytes_uploaded");
    b.context = scene_context_fastest();
    if (!b.context)
        return 1;
    b.clock = frame_clock_create(b.context);
    b.base = terrain_grid(TERRAIN_DEFAULT, BASE, BASE, spacing, 4);
    int64_t size = b.options.quick ? 2049 : 4097;
    const char *path = made_path("speed.tclip");
    tc_field *p = in_memory(&b, size);
    sizes(&b);
    levels_and_windows(&b, p, (double)(size / 2));
    pack(&b, size, 0, path);
    speeds(&b, p, path);
    threads(&b, size);
    tc_field_destroy(p);
    made_folder_remove();
    tc_grid_free(&b.base);
    frame_clock_destroy(&b.clock);
    tc_context_destroy(b.context);
    return measure_end(&b.options);
}
