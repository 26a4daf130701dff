/* bench_update.c - LH04's table 1: what each step of an update of a full level costs. update.csv.
 *
 * A level of 255 x 255 samples of the default terrain, at random places; medians of processor time, and for scale the
 * copying of as many bytes as the step writes, in turns with it. Steps stand in our code as they stand in a frame: z_c
 * and normals are made while a window is filled, so they are the difference between two fillings that differ in nothing
 * else; decompression reads a packed terrain, and U is part of it; so it is of synthesis, which makes a level anew from
 * the data, through all levels between. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/content/ground.h"
#include "common/field/filter.h"
#include "common/render/level_textures.h"
#include "planar/square.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/scene.h"
#include "tests/support/terrain_files.h"
#include "tests/support/terrains.h"

enum { SIDE = 255, SIZE = 2049, MOST = 501, LEVEL_SAMPLES = SIDE * SIDE, NORMAL_SIDE = 2 * SIDE + 1 };

/* Times of one step, in microseconds, and of copying what it writes. */
typedef struct step {
    const char *name;
    double paper_ms; /* NAN: not in the paper's table */
    size_t bytes;    /* that it writes */
    int count;
    double us[MOST], copy_us[MOST];
} step;

/* What all steps work on. */
typedef struct bench {
    int runs;
    test_random random;
    const tc_field *memory;
    const tc_field *finer[2]; /* with one level finer than that, and with eight */
    const char *path;
    unsigned char *from, *to; /* to copy */
} bench;

/* Processor time of all threads: how busy the machine is does not count. */
static double now_us(void)
{
    return 1e6 * terrain_cpu();
}

static void note(bench *b, step *s, double us)
{
    double start = now_us();
    memcpy(b->to, b->from, s->bytes);
    __asm__ volatile("" : : "r"(b->to) : "memory");
    s->copy_us[s->count] = now_us() - start;
    s->us[s->count++] = us;
}

/* A window of a pyramid's level with an even origin, wholly inside. The first two runs take opposite corners: what goes
 * wrong at edges goes wrong in every run of the program, however few places it takes. */
static tc_rect place(bench *b, tc_level level, int run)
{
    int64_t most_x = (level.width - SIDE) / 2 - 2, most_y = (level.height - SIDE) / 2 - 2;
    int64_t x = 2 * (run == 0 ? 1 : run == 1 ? most_x : test_random_int(&b->random, 1, most_x));
    int64_t y = 2 * (run == 0 ? 1 : run == 1 ? most_y : test_random_int(&b->random, 1, most_y));
    return (tc_rect){x, y, x + SIDE, y + SIDE};
}

static tc_clipmap *clipmap_of(const tc_field *field, bool normals)
{
    tc_clipmap *c;
    tc_error error;
    terrain_must(tc_ground_create(field, &(tc_ground_options){.n = SIDE, .normals = normals}, &c, &error), &error);
    return c;
}

static double fill_us(tc_clipmap *c, int level, tc_rect rect)
{
    double start = now_us();
    tc_clipmap_fill(c, level, rect);
    return now_us() - start;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------ */

/* A pyramid of one window's worth of the same heights: its clipmap has no coarser level, and so no z_c. */
static tc_field *window_alone(const tc_field *field)
{
    tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    tc_grid g = {.width = SIDE, .height = SIDE, .spacing_x = finest.spacing_x, .spacing_y = finest.spacing_y};
    g.z = malloc(LEVEL_SAMPLES * sizeof *g.z);
    if (!g.z)
        exit(99);
    tc_rect rect = {512, 512, 512 + SIDE, 512 + SIDE};
    terrain_must(tc_field_read(field, tc_field_info(field)->levels, rect, g.z, NULL, SIDE),
                 &(tc_error){.text = "reading from memory failed"});
    g.z_min = tc_field_info(field)->z_min, g.z_max = tc_field_info(field)->z_max;
    tc_field *alone;
    tc_error error;
    terrain_must(tc_field_build(&g, 0, &alone, &error), &error);
    return alone;
}

/* A window of the finest level and one of the next coarser one, with z_c and normals and without. */
static void fillings(bench *b, step *z_c, step *finest_normals, step *inner_normals)
{
    tc_field *window = window_alone(b->memory);
    tc_clipmap *alone = clipmap_of(window, false), *bare = clipmap_of(b->memory, false),
               *lit = clipmap_of(b->memory, true);
    int m = tc_clipmap_levels(bare), finest = tc_field_info(b->memory)->levels;
    for (int i = 0; i < b->runs; i++) {
        tc_rect r = place(b, tc_field_level(b->memory, finest), i);
        double without = fill_us(alone, 1, (tc_rect){0, 0, SIDE, SIDE}), with = fill_us(bare, m, r);
        note(b, z_c, with - without);
        note(b, finest_normals, fill_us(lit, m, r) - with);
        r = place(b, tc_field_level(b->memory, finest - 1), i);
        with = fill_us(bare, m - 1, r);
        note(b, inner_normals, fill_us(lit, m - 1, r) - with);
    }
    tc_clipmap_destroy(alone);
    tc_clipmap_destroy(bare);
    tc_clipmap_destroy(lit);
    tc_field_destroy(window);
}

static void upsampling(bench *b, step *s)
{
    enum { HALF = (SIDE + 1) / 2, STRIDE = HALF + 3 };
    static float coarse[STRIDE * STRIDE], fine[4 * HALF * HALF], rows[2 * HALF * STRIDE];
    for (int i = 0; i < b->runs; i++) {
        coarse[i % (STRIDE * STRIDE)] = (float)i;
        double start = now_us();
        tc_upsample(coarse + STRIDE + 1, STRIDE, HALF, HALF, fine, rows);
        __asm__ volatile("" : : "r"(fine) : "memory");
        note(b, s, now_us() - start);
    }
}

/* The finest level of a packed terrain: in a file just opened, and where the coarser level was read there before. */
static void decompression(bench *b, step *cold, step *held)
{
    static float z[LEVEL_SAMPLES], coarse[SIDE * SIDE];
    const tc_error failed = {.text = "reading a packed terrain failed"};
    for (int i = 0; i < b->runs; i++) {
        for (int warm = 0; warm < 2; warm++) {
            tc_field *p = terrain_open(b->path);
            int finest = tc_field_info(p)->levels;
            tc_rect r = place(b, tc_field_level(p, finest), i);
            tc_rect c = terrain_coarser_place(r, tc_field_level(p, finest - 1));
            if (warm)
                terrain_must(tc_field_read(p, finest - 1, c, coarse, NULL, SIDE), &failed);
            double start = now_us();
            terrain_must(tc_field_read(p, finest, r, z, NULL, SIDE), &failed);
            note(b, warm ? held : cold, now_us() - start);
            tc_field_destroy(p);
        }
    }
}

/* Levels finer than the data, made of it. */
static void synthesis(bench *b, step *first, step *eighth)
{
    static float z[LEVEL_SAMPLES];
    for (int i = 0; i < b->runs; i++)
        for (int k = 0; k < 2; k++) {
            const tc_field *p = b->finer[k];
            int finest = tc_field_info(p)->levels;
            tc_rect r = place(b, tc_field_level(p, finest), i);
            double start = now_us();
            terrain_must(tc_field_read(p, finest, r, z, NULL, SIDE), &(tc_error){.text = "synthesis failed"});
            note(b, k ? eighth : first, now_us() - start);
        }
}

/* A whole update of a level, the finest or so many coarser, whose coarser level is held: from the field to the
 * textures, and of that the upload alone; through a ring, or as the driver copies it where that is NULL. */
static void update(bench *b, const tc_gl *gl, const tc_field *p, int coarser, int run, tc_upload_ring *ring,
                   step *upload, step *whole)
{
    tc_clipmap *c = clipmap_of(p, true);
    tc_level_textures textures = {.ring = ring};
    tc_error error;
    int m = tc_clipmap_levels(c), l = m - coarser, all[TC_MAX_CHARTS] = {m};
    terrain_must(tc_level_textures_hold(gl, &textures, &c, 1, all, &error), &error);
    tc_rect r = place(b, tc_field_level(p, tc_field_info(p)->levels - coarser), run);
    tc_rect around = {r.x0 / 2 - 2, r.y0 / 2 - 2, r.x1 / 2 + 3, r.y1 / 2 + 3};
    tc_clipmap_fill(c, l - 1, around);
    tc_level_textures_upload(gl, &textures, &c, 1, -1, 0);
    gl->Finish();
    double start = now_us();
    tc_clipmap_fill(c, l, r);
    double filled = now_us();
    if (ring)
        tc_upload_ring_begin(gl, ring);
    tc_level_textures_upload(gl, &textures, &c, 1, -1, 0);
    if (ring)
        tc_upload_ring_end(gl, ring);
    gl->Finish();
    double end = now_us();
    if (upload)
        note(b, upload, end - filled);
    if (whole)
        note(b, whole, end - start);
    tc_level_textures_destroy(gl, &textures);
    tc_clipmap_destroy(c);
}

static void updates(bench *b, const tc_gl *gl, step *upload, step *through, step *packed, step *finest, step *inner)
{
    tc_upload_ring ring;
    tc_error error;
    terrain_must(tc_upload_ring_create(gl, &ring, &error), &error);
    for (int i = 0; i < b->runs; i++) {
        tc_field *p = terrain_open(b->path);
        update(b, gl, p, 0, i, NULL, upload, packed);
        update(b, gl, p, 0, i, &ring, through, NULL);
        tc_field_destroy(p);
        update(b, gl, b->finer[0], 0, i, NULL, NULL, finest);
        update(b, gl, b->finer[1], 1, i, NULL, NULL, inner);
    }
    tc_upload_ring_destroy(gl, &ring);
}

/* A field of a copy of the grid. */
static tc_field *field_of(const tc_grid *grid)
{
    tc_grid copy = *grid;
    tc_field *field;
    tc_error error;
    copy.z = malloc((size_t)(grid->width * grid->height) * sizeof *copy.z);
    if (!copy.z)
        exit(99);
    memcpy(copy.z, grid->z, (size_t)(grid->width * grid->height) * sizeof *copy.z);
    terrain_must(tc_field_build(&copy, 0, &field, &error), &error);
    return field;
}

/* ---- Table ------------------------------------------------------------------------------------------------------ */

static void print(const measure_options *o, step *s)
{
    if (s->count == 0)
        return;
    measure_spread t = measure_of(s->us, s->count), copy = measure_of(s->copy_us, s->count);
    char paper[32] = "";
    if (!isnan(s->paper_ms))
        snprintf(paper, sizeof paper, "%g", s->paper_ms);
    printf("%-52s %9.1f %9.1f %9.1f %10.2f %8s\n", s->name, t.median, t.low, t.high, t.median / copy.median, paper);
    if (o->csv)
        fprintf(o->csv, "%s,%.2f,%.2f,%.2f,%.3f,%s\n", s->name, t.median, t.low, t.high, t.median / copy.median, paper);
}

int main(int argc, char **argv)
{
    enum { Z_C, UP, HELD, COLD, FIRST, EIGHTH, INNER, FINEST, UPLOAD, THROUGH, WHOLE, WHOLE_FIRST, WHOLE_INNER, STEPS };
    const size_t heights = LEVEL_SAMPLES * sizeof(float), normals = NORMAL_SIDE * NORMAL_SIDE * 4;
    static step steps[STEPS] = {
        [Z_C] = {.name = "z_c", .paper_ms = 2},
        [UP] = {.name = "U", .paper_ms = 3},
        [HELD] = {.name = "decompression and U; coarser level at hand", .paper_ms = 8},
        [COLD] = {.name = "decompression and U; all levels from the file", .paper_ms = NAN},
        [FIRST] = {.name = "synthesis and U; first level finer than the data", .paper_ms = 3},
        [EIGHTH] = {.name = "synthesis and U; eighth level; all between made anew", .paper_ms = NAN},
        [INNER] = {.name = "normal map; from the next finer level", .paper_ms = 11},
        [FINEST] = {.name = "normal map; of the finest level", .paper_ms = NAN},
        [UPLOAD] = {.name = "upload of heights and normals", .paper_ms = 2},
        [THROUGH] = {.name = "upload of heights and normals; through a ring", .paper_ms = NAN},
        [WHOLE] = {.name = "whole update; from the file to the textures", .paper_ms = 26},
        [WHOLE_FIRST] = {.name = "whole update; synthesised; finest level", .paper_ms = 21},
        [WHOLE_INNER] = {.name = "whole update; synthesised; normals from a finer level", .paper_ms = NAN}};
    for (int i = 0; i < STEPS; i++)
        steps[i].bytes = i == INNER || i == FINEST ? normals : i >= UPLOAD ? 2 * heights + normals : heights;
    measure_options o = measure_begin(argc, argv, "step,us,us_low,us_high,copy_ratio,paper_ms");
    bench b = {.runs = o.quick ? 51 : MOST, .random = {1}, .path = made_path("update.tclip")};
    b.from = calloc(1, 2 * heights + normals), b.to = calloc(1, 2 * heights + normals);
    if (!b.from || !b.to)
        return 99;
    tc_context *context = scene_context();
    tc_grid grid = terrain_grid(TERRAIN_DEFAULT, o.quick ? 1025 : SIZE, o.quick ? 1025 : SIZE, 30, 4);
    const terrain_file about = {{"default", 0, 0}, TC_SAMPLE_FLOAT32, 0};
    terrain_pack(&grid, &about, &(tc_pack_options){.mode = TC_PACK_RMS, .error = 1.8}, b.path);
    tc_field *field[3];
    for (int k = 0; k < 3; k++)
        field[k] = terrain_synthesised(field_of(&grid), k == 0 ? 0 : k == 1 ? 1 : 8);
    tc_grid_free(&grid);
    b.memory = field[0], b.finer[0] = field[1], b.finer[1] = field[2];
    fillings(&b, &steps[Z_C], &steps[FINEST], &steps[INNER]);
    upsampling(&b, &steps[UP]);
    decompression(&b, &steps[COLD], &steps[HELD]);
    synthesis(&b, &steps[FIRST], &steps[EIGHTH]);
    if (context)
        updates(&b, tc_context_gl(context), &steps[UPLOAD], &steps[THROUGH], &steps[WHOLE], &steps[WHOLE_FIRST],
                &steps[WHOLE_INNER]);
    printf("%-52s %9s %9s %9s %10s %8s\n", "a level of 255 x 255: microseconds of a processor", "median", "10 %",
           "90 %", "x copying", "LH04 ms");
    for (int i = 0; i < STEPS; i++)
        print(&o, &steps[i]);
    for (int k = 0; k < 3; k++)
        tc_field_destroy(field[k]);
    tc_context_destroy(context);
    free(b.from), free(b.to);
    made_folder_remove();
    return measure_end(&o) || !context;
}
