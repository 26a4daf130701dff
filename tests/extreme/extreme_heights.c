/* extreme_heights.c - terrains whose heights are extreme: drawn, packed and read back.
 *
 * Each is written as a GeoTIFF, opened as any file is, and drawn from several views; then its samples are packed, and
 * what the packed file gives back is held against them. Limits:
 * - cracks: none may be (watertight.h);
 * - depth: a pixel's depth lies on the surface to within half a pixel, as a picture's does on ordinary terrain: the
 *   rasteriser rounds corners to 1/256 pixel, which walls and spires make more of;
 * - numbers: heights, uniforms and clip coordinates are all finite;
 * - packed: no height off by more than was asked for, errors as declared, the mask of voids bit for bit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/flight.h"
#include "common/app/load.h"
#include "planar/square_internal.h"
#include "tests/support/drawn.h"
#include "tests/support/extreme.h"
#include "tests/support/made_files.h"
#include "tests/support/regions.h"
#include "tests/support/watertight.h"

enum { SIZE = 257, SAMPLES = SIZE * SIZE, SPACING = 30, N = 63, VIEWS = 5, WIDTH = 160, HEIGHT = 120 };

/* ---- Terrains --------------------------------------------------------------------------------------------------- */

/* Row j counts from the north; NAN: void. */
static double zero(int i, int j)
{
    return 0 * (i + j);
}
static double high(int i, int j)
{
    return 1e4 + zero(i, j);
}
static double low(int i, int j)
{
    return -1e4 + zero(i, j);
}
static double checkerboard(int i, int j)
{
    return (i + j) & 1 ? 32767 : -32768;
}
static double needle(int i, int j)
{
    return i == SIZE / 2 + 3 && j == SIZE / 3 ? 8848 : 0;
}
static double cliff(int i, int j)
{
    return i > SIZE / 2 + j / 7 ? 8848 : 0;
}
static double sawtooth(int i, int j)
{
    return (i & 1) * 1000 + zero(i, j);
}
static double dust(int i, int j) /* a relief of 1e-3 m far above the zero of heights */
{
    return 1e6 + 5e-4 * sin(0.13 * i) * cos(0.11 * j);
}
static double one_left(int i, int j)
{
    return i == 100 && j == 131 ? 1234.5 : NAN;
}
static double void_checkerboard(int i, int j)
{
    return (i + j) & 1 ? NAN : 500 + 200 * sin(0.05 * i) * cos(0.07 * j);
}
static double huge(int i, int j) /* between -1e7 and 1e7, with single samples of either */
{
    return (i * 31 + j * 17) % 97 == 0 ? 1e7 : (i * 13 + j * 29) % 89 == 0 ? -1e7 : 9e6 * sin(0.02 * i) * cos(0.03 * j);
}
static double greatest(int i, int j) /* all that a file may hold */
{
    return 1e9 * sin(0.02 * i) * cos(0.03 * j);
}
static double denormal(int i, int j)
{
    return 1e-40 * (i % 17 - 8) + 1e-42 * (j % 5);
}

typedef struct terrain {
    const char *name;
    double (*height)(int i, int j);
    tc_void_policy voids;
    double max_error; /* to pack to, metres; 0: an rms of this terrain is met instead */
    double rms;
    bool lossless;
    double depth_limit; /* pixels; 0: half a one */
} terrain;

static const terrain terrains[] = {
    {"flat at 0 m", zero, 0, 0.01, 0, true, 0},
    {"flat at 10,000 m", high, 0, 0.01, 0, true, 0},
    {"flat at -10,000 m", low, 0, 0.01, 0, true, 0},
    {"checkerboard of -32768 and 32767 m", checkerboard, 0, 1, 0, true, 0},
    {"one needle of 8,848 m", needle, 0, 0.5, 0, true, 0},
    {"vertical cliff of 8,848 m", cliff, 0, 0.5, 0, true, 0},
    {"sawtooth at the Nyquist rate", sawtooth, 0, 0.5, 0, true, 0},
    {"relief of 0.001 m at 1,000,000 m", dust, 0, 1e-5, 0, false, 0},
    {"all void but one sample", one_left, 0, 0.01, 0, true, 0},
    {"all void but one sample, holes", one_left, TC_VOIDS_HOLE, 0.01, 0, true, 0},
    {"checkerboard of voids", void_checkerboard, 0, 0.1, 0, false, 0},
    {"checkerboard of voids, holes", void_checkerboard, TC_VOIDS_HOLE, 0.1, 0, false, 0},
    {"heights to 10,000,000 m", huge, 0, 0, 100, false, 0},
    /* Here floats are 64 m apart, some pixels where levels pass into each other a kilometre away. */
    {"heights to 1,000,000,000 m", greatest, 0, 0, 1e5, false, 16},
    {"denormal heights", denormal, 0, 1e-3, 0, false, 0},
};

static double *heights_of(const terrain *t)
{
    double *z = malloc(SAMPLES * sizeof *z);
    if (!z)
        exit(99);
    for (int j = 0; j < SIZE; j++)
        for (int i = 0; i < SIZE; i++)
            z[j * SIZE + i] = t->height(i, j);
    return z;
}

/* The terrain as a file gives it. */
static tc_status load(const double *z, tc_void_policy voids, tc_grid *grid, tc_error *error)
{
    const char *path = made_path("heights.tif");
    make_tiff(path, &(made_tiff){.width = SIZE, .height = SIZE, .bits = 64, .format = MADE_FLOAT, .samples = z});
    return tc_grid_load(path, &(tc_source_options){.spacing = SPACING, .has_voids = true, .voids = voids}, grid, error);
}

static void must(tc_status status, const tc_error *error)
{
    if (status != TC_OK) {
        fprintf(stderr, "extreme heights: %s\n", error->text);
        exit(99);
    }
}

/* ---- Packed ----------------------------------------------------------------------------------------------------- */

/* A packed file against the samples that went into it. */
typedef struct comparison {
    double rms, max; /* metres; infinite where a height is not finite */
    int64_t voids_differ, heights_differ;
} comparison;

static comparison compare(const tc_field *p, const tc_grid *grid)
{
    comparison c = {0};
    float *z = malloc(SAMPLES * sizeof *z);
    uint8_t *voids = malloc(SAMPLES);
    if (!z || !voids || tc_field_read(p, tc_field_info(p)->levels, (tc_rect){0, 0, SIZE, SIZE}, z, voids, SIZE))
        exit(99);
    int64_t valid = 0;
    for (int i = 0; i < SAMPLES; i++) {
        bool is_void = grid->voids && grid->voids[i];
        c.voids_differ += voids[i] != is_void;
        if (!isfinite(z[i]))
            c.max = INFINITY;
        if (is_void)
            continue;
        double e = fabs((double)z[i] - grid->z[i]);
        c.rms += e * e, c.max = fmax(c.max, e), valid++;
        c.heights_differ += e > 0;
    }
    c.rms = sqrt(c.rms / (double)valid);
    free(z), free(voids);
    return c;
}

static tc_status pack(const tc_grid *grid, const tc_pack_options *options, tc_pack_result *result, tc_error *error)
{
    const tc_pack_terrain about = {.width = SIZE,
                                   .height = SIZE,
                                   .spacing_x = SPACING,
                                   .spacing_y = SPACING,
                                   .z_base = grid->z_base,
                                   .sample_type = TC_SAMPLE_FLOAT32,
                                   .unit = 1};
    tc_packer *packer = NULL;
    tc_status status = tc_packer_create(made_path("heights.tclip"), &about, options, &packer, error);
    if (!status)
        status = tc_packer_put(packer, (tc_rect){0, 0, SIZE, SIZE}, grid->z, grid->voids, SIZE, error);
    if (!status)
        status = tc_packer_finish(packer, result, error);
    tc_packer_destroy(packer);
    return status;
}

static tc_field *open_packed(tc_void_policy voids)
{
    tc_field *p;
    tc_error error;
    must(tc_field_open(made_path("heights.tclip"), &(tc_open_options){.has_policy = true, .voids = voids}, &p, &error),
         &error);
    return p;
}

/* Packed to an error and opened again. */
static tc_field *packed_lossy(const terrain *t, const tc_grid *grid)
{
    const tc_pack_options options = {.mode = t->max_error > 0 ? TC_PACK_MAX_ERROR : TC_PACK_RMS,
                                     .error = t->max_error > 0 ? t->max_error : t->rms};
    tc_pack_result result;
    tc_error error;
    must(pack(grid, &options, &result, &error), &error);
    tc_field *p = open_packed(t->voids);
    comparison c = compare(p, grid);
    extreme_at_most(t->name, t->max_error > 0 ? "packed: largest error, m" : "packed: rms, m",
                    t->max_error > 0 ? c.max : c.rms, options.error, "%lld bytes", (long long)result.bytes);
    /* Those declared are floats. */
    double beyond = fmax(fmax(c.max - result.max_error, c.rms - result.rms), 0);
    extreme_at_most(t->name, "packed: errors beyond those declared, m", beyond, 1e-6 * options.error,
                    "declared rms %.3g m, largest %.3g m", result.rms, result.max_error);
    if (grid->void_count)
        extreme_at_most(t->name, "packed: voids that differ, samples", (double)c.voids_differ, 0, "%lld voids",
                        (long long)grid->void_count);
    if (grid->z_min == grid->z_max && grid->void_count == 0) /* the head, the coarsest level and an empty index */
        extreme_at_most(t->name, "packed: bytes of constant terrain", (double)result.bytes, 1024, "%d samples",
                        SAMPLES);
    return p;
}

static void packed_lossless(const terrain *t, const tc_grid *grid)
{
    tc_pack_result result;
    tc_error error;
    tc_status status = pack(grid, &(tc_pack_options){.mode = TC_PACK_LOSSLESS}, &result, &error);
    char name[128];
    snprintf(name, sizeof name, "%s, lossless", t->name);
    if (!t->lossless) { /* on no lattice that the format has */
        extreme_refused(name, status, TC_ERR_UNSUPPORTED, status ? error.text : "");
        return;
    }
    must(status, &error);
    tc_field *p = open_packed(t->voids);
    comparison c = compare(p, grid);
    extreme_at_most(name, "packed: samples that differ", (double)(c.heights_differ + c.voids_differ), 0, "%lld bytes",
                    (long long)result.bytes);
    tc_field_destroy(p);
}

/* ---- Drawn ------------------------------------------------------------------------------------------------------ */

/* Where the mask in the windows is not the file's; of a coarser sample it is that of the sample on the same spot. */
static int64_t masks_differ(const tc_clipmap *clipmap, const double *z)
{
    int64_t mask = tc_clipmap_n(clipmap), differ = 0;
    for (int l = 1; l <= tc_clipmap_levels(clipmap); l++) {
        const tc_clip_level *v = tc_clipmap_level(clipmap, l);
        for (int64_t j = v->clip.y0; j < v->clip.y1 && j << v->shift < SIZE; j++)
            for (int64_t i = v->clip.x0; i < v->clip.x1 && i << v->shift < SIZE; i++) {
                bool is_void = isnan(z[(SIZE - 1 - (j << v->shift)) * SIZE + (i << v->shift)]);
                differ += tc_ground_voids(clipmap, l)[(j & mask) * (mask + 1) + (i & mask)] != (is_void ? 255 : 0);
            }
    }
    return differ;
}

static double ground_height(void *field, double x, double y)
{
    double z = 0;
    tc_field_height(field, x, y, &z);
    return z + tc_field_info(field)->z_base;
}

/* A view whose eye keeps the viewers' clearance to all sides (flight.h): at a wall of 10,000 km to the cell an eye 1 m
 * above the ground is a thousandth of a millimetre beside it, nearer than any float of the wall's size tells. */
static tc_camera view(test_random *r, const tc_field *p)
{
    tc_camera c = watertight_view(r, p, 4.0 * SIZE * SPACING, WIDTH, HEIGHT);
    const double clearance = tc_flight_clearance(SPACING);
    const tc_ground ground = {ground_height, (void *)p, clearance, {0}};
    c.z = fmax(c.z, clearance + tc_highest_ground(&ground, c.x, c.y, clearance, clearance));
    return c;
}

/* Everything that windows hold, computed anew in double: heights, morph targets, normals, voids; at several places. */
static void look_at_windows(const terrain *t, const tc_field *p)
{
    tc_clipmap *clipmap;
    tc_error error;
    tc_rect wanted[TC_MAX_LEVELS];
    const tc_ground_options options = {.n = N, .normals = true, .holes = t->voids == TC_VOIDS_HOLE};
    must(tc_ground_create(p, &options, &clipmap, &error), &error);
    test_random r = {12};
    int broken = 0, looked = 0;
    char first[200] = "nothing broken";
    for (int v = 0; v < 3; v++) {
        tc_camera c = view(&r, p);
        square_viewer viewer = tc_square_viewer(clipmap, &c, true);
        tc_square_wanted(clipmap, tc_clipmap_n(clipmap), &viewer, wanted);
        tc_clipmap_update(clipmap, wanted, -1, true, 0);
        for (int l = 1; l <= tc_clipmap_levels(clipmap); l++, looked++) {
            const char *what = content_broken(clipmap, l, v, 5);
            if (what && !broken++)
                snprintf(first, sizeof first, "first: %s", what);
        }
    }
    extreme_at_most(t->name, "windows that differ from double", broken, 0, "of %d; %s", looked, first);
    tc_clipmap_destroy(clipmap);
}

/* Straight down from just above all that is near: random views of a terrain that is flat from afar may all miss it. */
static tc_camera view_down(const tc_field *p)
{
    tc_camera c = {.x = 100.3 * SPACING, .y = 120.4 * SPACING, .pitch = -M_PI / 2, .fov = 1};
    const tc_ground ground = {ground_height, (void *)p, SPACING, {0}};
    c.z = 3 * SPACING + tc_highest_ground(&ground, c.x, c.y, SPACING, SPACING);
    c.width = WIDTH, c.height = HEIGHT;
    return c;
}

static void draw(const tc_context *context, const terrain *t, const tc_field *p, const char *from, const double *z)
{
    tc_scene_options options = watertight_options();
    options.holes = t->voids == TC_VOIDS_HOLE;
    scene s = scene_create(context, p, N, &options);
    drawn d = drawn_create(context, &s);
    test_random r = {11};
    drawn_figures f = {0};
    char name[128];
    snprintf(name, sizeof name, "%s, from %s", t->name, from);
    int64_t differ = 0;
    for (int v = 0; v < VIEWS + 1; v++) {
        tc_camera c = v < VIEWS ? view(&r, p) : view_down(p);
        if (!options.holes) {
            drawn_look(&d, &c, &options, &f);
            continue;
        }
        scene_draw(&s, &c, true); /* what is open on purpose has no cracks */
        drawn_vertices(&d, &c, &options.frame, &f);
        differ += masks_differ(s.clipmap, z);
    }
    if (options.holes) {
        extreme_at_most(name, "voids of the windows that differ, samples", (double)differ, 0, "in %d views", VIEWS + 1);
    } else {
        extreme_at_most(name, "cracks, pixels", extreme_of(f.terrain, (double)f.cracks), 0,
                        "%lld pixels of terrain in %d views", (long long)f.terrain, f.views);
        extreme_at_most(name, "depth off the surface, pixels", extreme_of(f.depths, f.depth_px),
                        t->depth_limit > 0 ? t->depth_limit : 0.5, "of %lld pixels", (long long)f.depths);
    }
    extreme_at_most(name, "numbers not finite", extreme_of(f.numbers, (double)f.not_finite), 0, "of %lld",
                    (long long)f.numbers);
    drawn_destroy(&d);
    scene_destroy(&s);
}

static void run(const tc_context *context, const terrain *t)
{
    double *z = heights_of(t);
    tc_grid grid;
    tc_error error;
    tc_field *p;
    must(load(z, t->voids, &grid, &error), &error);
    packed_lossless(t, &grid);
    tc_field *packed = packed_lossy(t, &grid);
    must(tc_field_build(&grid, 0, &p, &error), &error);
    look_at_windows(t, p);
    draw(context, t, p, "the file", z);
    draw(context, t, packed, "the packed file", z);
    tc_field_destroy(p), tc_field_destroy(packed);
    free(z);
}

/* Files without any height, or with one that is none. */
static void refused(const char *name, double value, tc_status expected)
{
    double *z = malloc(SAMPLES * sizeof *z);
    if (!z)
        exit(99);
    for (int i = 0; i < SAMPLES; i++)
        z[i] = value;
    tc_grid grid;
    tc_error error;
    tc_status status = load(z, 0, &grid, &error);
    extreme_refused(name, status, expected, status ? error.text : "");
    if (!status)
        tc_grid_free(&grid);
    free(z);
}

int main(void)
{
    extreme_begin("heights");
    tc_context *context = scene_context();
    for (size_t k = 0; k < sizeof terrains / sizeof *terrains; k++)
        if (context)
            run(context, &terrains[k]);
        else
            extreme_skipped(terrains[k].name, "no OpenGL context");
    refused("nothing but NaN", NAN, TC_ERR_FORMAT);
    refused("nothing but infinities", INFINITY, TC_ERR_FORMAT);
    refused("heights of 1e10 m", 1e10, TC_ERR_FORMAT);
    made_folder_remove();
    tc_context_destroy(context);
    return extreme_end();
}
