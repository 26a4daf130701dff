/* extreme_sizes.c - terrains of extreme sizes: packed and drawn, or refused in words.
 *
 * Packed: heights are whole metres of 16 bits, so lossless gives each back; the widest is sparse, void but for one tile
 * in a thousand, and packed to an rms. Drawn: limits as in extreme_cameras.c; no cracks, vertices within a fiftieth of
 * a pixel, depths within half a one, and all numbers finite. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "planar/square.h"
#include "tests/support/computed.h"
#include "tests/support/drawn.h"
#include "tests/support/extreme.h"
#include "tests/support/made_files.h"
#include "tests/support/terrain_files.h"
#include "tests/support/watertight.h"

enum { SPACING = 30, VIEWS = 6, WIDTH = 160, HEIGHT = 120, LARGE = 1000000 };

static tc_context *context;

/* Hills of whole metres; no two samples near each other are alike. */
static tc_grid grid_of(int64_t width, int64_t height)
{
    tc_grid g = {.width = width, .height = height, .spacing_x = SPACING, .spacing_y = SPACING};
    g.z = malloc((size_t)(width * height) * sizeof *g.z);
    if (!g.z)
        exit(99);
    g.z_min = INFINITY, g.z_max = -INFINITY;
    for (int64_t j = 0; j < height; j++)
        for (int64_t i = 0; i < width; i++) {
            double z = 700 + 500 * sin(0.011 * (double)i) * cos(0.017 * (double)j) + (double)((i * 7 + j * 13) % 11);
            g.z[j * width + i] = (float)rint(z);
            g.z_min = fminf(g.z_min, g.z[j * width + i]), g.z_max = fmaxf(g.z_max, g.z[j * width + i]);
        }
    return g;
}

/* ---- Drawn ------------------------------------------------------------------------------------------------------ */

/* Whether a viewer could be made; else the row says why it was refused. */
static tc_status try_scene(const tc_field *p, int n, tc_error *error)
{
    tc_windows windows = {0};
    tc_surface *surface = NULL;
    tc_status status = tc_square_create(p, &(tc_ground_options){.n = n}, NULL, &surface, error);
    if (status)
        return status;
    status = surface->make_windows(surface, &windows, error);
    tc_windows_destroy(&windows);
    surface->destroy(surface);
    return status;
}

/* Over the terrain, along its longer side: a narrow one is seldom seen from elsewhere. */
static tc_camera along(const tc_field *p, int v)
{
    tc_level finest = tc_field_level(p, tc_field_info(p)->levels);
    double x = (double)(finest.width - 1) * finest.spacing_x, y = (double)(finest.height - 1) * finest.spacing_y;
    tc_camera c = {.x = x * (0.1 + 0.15 * v), .y = y * (0.3 + 0.1 * v), .fov = 1, .width = WIDTH, .height = HEIGHT};
    c.heading = (x > y ? M_PI / 2 : 0) + 0.01 * v;
    c.pitch = -0.2 * v;
    tc_field_height(p, c.x, c.y, &c.z);
    c.z += finest.spacing_x * v;
    return c;
}

static void draw(const char *name, const tc_field *p, int n, double highest)
{
    if (!context) {
        extreme_skipped(name, "no OpenGL context");
        return;
    }
    tc_scene_options options = watertight_options();
    scene s = scene_create(context, p, n, &options);
    drawn d = drawn_create(context, &s);
    test_random r = {31};
    drawn_figures f = {0};
    for (int v = 0; v < VIEWS; v++) {
        tc_camera c = v & 1 ? along(p, v) : watertight_view(&r, p, highest, WIDTH, HEIGHT);
        drawn_look(&d, &c, &options, &f);
    }
    extreme_at_most(name, "cracks, pixels", extreme_of(f.terrain, (double)f.cracks), 0,
                    "%lld pixels of terrain in %d views, %d levels", (long long)f.terrain, f.views,
                    tc_clipmap_levels(s.clipmap));
    extreme_at_most(name, "vertices off, pixels", extreme_of(f.vertices, f.vertex_px), 0.02, "of %lld",
                    (long long)f.vertices);
    extreme_at_most(name, "depth off the surface, pixels", extreme_of(f.depths, f.depth_px), 0.5, "of %lld pixels",
                    (long long)f.depths);
    extreme_at_most(name, "numbers not finite", extreme_of(f.numbers, (double)f.not_finite), 0, "of %lld",
                    (long long)f.numbers);
    drawn_destroy(&d);
    scene_destroy(&s);
}

/* ---- Sizes that fit memory -------------------------------------------------------------------------------------- */

/* Voids but for the first of every `every` tiles; flat there, as a grid's voids must be filled. */
static void make_sparse(tc_grid *grid, int64_t every)
{
    enum { TILE = 64 };
    grid->voids = calloc((size_t)(grid->width * grid->height), 1);
    if (!grid->voids)
        exit(99);
    for (int64_t k = 0; k < grid->width * grid->height; k++)
        if (k % grid->width / TILE % every != 0)
            grid->voids[k] = 1, grid->z[k] = 700, grid->void_count++;
}

static void pack(const char *name, const tc_grid *grid)
{
    const char *path = made_path("sizes.tclip");
    const terrain_file about = {.type = TC_SAMPLE_INT16, .unit = 1};
    bool large = grid->width * grid->height > LARGE;
    const tc_pack_options options = {.mode = large ? TC_PACK_RMS : TC_PACK_LOSSLESS, .error = 1};
    terrain_packed packed = terrain_pack(grid, &about, &options, path);
    terrain_error e = terrain_compare(grid, path);
    if (large)
        extreme_at_most(name, "packed, sparse: rms, m", e.rms, options.error, "%.0f bytes, %lld of %lld void",
                        packed.bytes, (long long)grid->void_count, (long long)(grid->width * grid->height));
    else
        extreme_at_most(name, "packed lossless: largest error, m", e.max, 0, "%.0f bytes", packed.bytes);
}

/* n samples a side of a window. */
static void size(int64_t width, int64_t height, int n)
{
    char name[64];
    snprintf(name, sizeof name, "%lldx%lld, n %d", (long long)width, (long long)height, n);
    tc_grid grid = grid_of(width, height);
    if (width * height > LARGE)
        make_sparse(&grid, 1000);
    pack(name, &grid);
    tc_field *p, *packed = terrain_open(made_path("sizes.tclip"));
    tc_error error = {.text = ""};
    terrain_must(tc_field_build(&grid, 0, &p, &error), &error);
    double highest = fmax(100, fmin(1e5, 2.0 * SPACING * (double)(width + height)));
    if (width < 2 || height < 2) {
        extreme_refused(name, try_scene(p, n, &error), TC_ERR_UNSUPPORTED, error.text);
    } else {
        draw(name, p, n, highest);
        snprintf(name, sizeof name, "%lldx%lld, n %d, packed", (long long)width, (long long)height, n);
        draw(name, packed, n, highest);
    }
    tc_field_destroy(p), tc_field_destroy(packed);
}

/* ---- Sizes that do not ------------------------------------------------------------------------------------------ */

/* Heights that are computed when asked for stand for a packed file of that size, of which only the tiles around the
 * viewer would be decoded. */
static void computed_size(const char *name, int64_t width, int64_t height, double spacing, int n)
{
    tc_field *p = computed_field(width, height, spacing, 100);
    draw(name, p, n, 1e6 * spacing);
    tc_field_destroy(p);
}

/* Programs for places as pairs of integers, lit, with several samples and levels' colours. */
static void wide_programs(void)
{
    if (!context) {
        extreme_skipped("2^33 columns, lit, 4 samples a pixel", "no OpenGL context");
        return;
    }
    tc_field *p = computed_field(INT64_C(1) << 33, INT64_C(1) << 33, 1, 100);
    int64_t differ = 0;
    enum { PIXELS = WIDTH * HEIGHT };
    tc_camera c = {.x = 8e9, .y = 7e9, .z = 500, .pitch = -0.4, .fov = 1, .width = WIDTH, .height = HEIGHT};
    for (int samples = 1; samples <= 4; samples += 3) {
        tc_scene_options options = {.samples = samples, .level_colours = samples > 1};
        uint8_t *rgb[2];
        for (int k = 0; k < 2; k++) { /* by way of another place */
            scene s = scene_create(context, p, 63, &options);
            tc_camera other = c;
            other.x -= 700, other.heading = 1;
            if (k)
                scene_draw(&s, &other, true);
            scene_draw(&s, &c, true);
            rgb[k] = scene_pixels(&s, &c);
            scene_destroy(&s);
        }
        for (int i = 0; i < PIXELS; i++)
            differ += memcmp(rgb[0] + 3 * (size_t)i, rgb[1] + 3 * (size_t)i, 3) != 0;
        free(rgb[0]), free(rgb[1]);
    }
    extreme_at_most("2^33x2^33, lit, 1 and 4 samples a pixel", "pixels that depend on the path", (double)differ, 0,
                    "of %d", 2 * PIXELS);
    tc_field_destroy(p);
}

static void refused_to_draw(const char *name, int64_t width, int64_t height, int n)
{
    tc_field *p = computed_field(width, height, 1, 100);
    tc_error error = {.text = ""};
    extreme_refused(name, try_scene(p, n, &error), TC_ERR_UNSUPPORTED, error.text);
    tc_field_destroy(p);
}

static void refused_to_pack(const char *name, int64_t width, int64_t height, tc_status expected)
{
    const tc_pack_terrain terrain = {.width = width, .height = height, .spacing_x = 1, .spacing_y = 1, .unit = 1};
    tc_packer *packer = NULL;
    tc_error error = {.text = ""};
    tc_status status =
        tc_packer_create(made_path("never.tclip"), &terrain, &(tc_pack_options){.error = 1}, &packer, &error);
    extreme_refused(name, status, expected, error.text);
    tc_packer_destroy(packer);
}

int main(void)
{
    extreme_begin("sizes");
    context = scene_context();
    size(1, 1, 15);
    size(1, 2, 15);
    size(2, 1, 15);
    size(2, 2, 15);
    size(2, 3, 255);
    size(1, 65537, 63);
    size(65537, 1, 63);
    size(2, 65537, 63);
    size(127, 257, 31);
    size(509, 1021, 63);
    size(40, 23, 255);
    size(INT64_C(1) << 20, 3, 63);
    computed_size("2^20x2^20", INT64_C(1) << 20, INT64_C(1) << 20, 30, 63);
    computed_size("2^33x5", INT64_C(1) << 33, 5, 30, 63);
    computed_size("2^33x2^33", INT64_C(1) << 33, INT64_C(1) << 33, 0.1, 63);
    wide_programs();
    refused_to_draw("2^40+1 columns, n 2047", (INT64_C(1) << 40) + 1, 2, 2047);
    refused_to_draw("2^40+1 columns, n 63", (INT64_C(1) << 40) + 1, 2, 63);
    refused_to_pack("0 columns, packed", 0, 5, TC_ERR_USAGE);
    refused_to_pack("2^31+1 columns, packed", (INT64_C(1) << 31) + 1, 5, TC_ERR_USAGE);
    refused_to_pack("2^31x2^31, packed", INT64_C(1) << 31, INT64_C(1) << 31, TC_ERR_IO);
    extreme_skipped("2^20x2^20, packed",
                    "the packer goes through all 2^40 samples, given or void: days, and 4 TiB of sparse spool; drawn "
                    "above from heights computed on demand, which the viewer reads as it reads a packed file");
    made_folder_remove();
    tc_context_destroy(context);
    return extreme_end();
}
