/* synth.c - `terraclip synth`: writes a synthetic terrain.
 *
 * The command line is checked whole, and the output tried, before a sample is computed: a terrain can take minutes, and
 * nobody should wait that long to read that a folder does not exist. */
#include "synth.h"

#include "common/base/status.h"
#include "common/app/arguments.h"
#include "common/base/numbers.h"
#include "common/base/outfile.h"
#include "common/input/source.h"
#include "synth_planar.h"
#include "synth_planet.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

struct arguments {
    const char *kind, *output;
    int64_t size; /* 0: the kind's */
    uint64_t seed;
    double spacing; /* metres; 0: not given */
    int threads;
    bool quiet, verbose;
};

/* ---- Command line ----------------------------------------------------------------------------------------------- */

static bool read_kind(void *kind, const char *value)
{
    *(const char **)kind = value;
    return strcmp(value, "planar") == 0 || strcmp(value, "planet") == 0;
}

static bool read_size(void *size, const char *value)
{
    return tc_read_integer(value, TC_SYNTH_SIZE_MIN, TC_SYNTH_SIZE_MAX, size);
}

static bool read_seed(void *seed, const char *value)
{
    return tc_read_unsigned(value, 0, UINT64_MAX, seed);
}

static bool read_spacing(void *spacing, const char *value)
{
    return tc_read_number(value, TC_SYNTH_SPACING_MIN, TC_SYNTH_SPACING_MAX, spacing);
}

/* It is no packed file, whatever its name says. */
static bool read_output(void *output, const char *value)
{
    const char *end = strrchr(value, '.');
    return tc_read_text(output, value) && !(end && strcasecmp(end, ".tclip") == 0);
}

static const tc_option table[] = {
    {.help = "Options"},
    {0, "kind", "KIND", "planar or planet",
     "planar: mountains, valleys, plains and a coast; planet: all around a globe (planar)", read_kind,
     offsetof(struct arguments, kind)},
    {0, "size", "N", "a whole number 2..65537", "N x N samples (4097); of a planet N x N/2, N even (4096)", read_size,
     offsetof(struct arguments, size)},
    {0, "seed", "S", "a whole number 0..18446744073709551615", "which terrain (1)", read_seed,
     offsetof(struct arguments, seed)},
    {0, "spacing", "M", "metres of 0.001..100000", "between samples, planar only (30)", read_spacing,
     offsetof(struct arguments, spacing)},
    {0, "threads", "N", TC_EXPECTED_THREADS, "that compute (all processors)", tc_read_threads,
     offsetof(struct arguments, threads)},
    {'o', "output", "FILE.tif", "the name of a GeoTIFF, which 'terraclip pack' packs", "where it goes", read_output,
     offsetof(struct arguments, output)},
    TC_SWITCH(struct arguments, quiet, 'q', "quiet", "no progress"),
    TC_SWITCH(struct arguments, verbose, 'v', "verbose", "what was written"),
    TC_HELP_AND_VERSION,
};

static tc_status refuse_operand(void *arguments, const char *operand, tc_error *error)
{
    (void)arguments;
    return tc_fail(error, TC_ERR_USAGE, "synth: expected options only, found '%s'", operand);
}

static const tc_command_line line = {.options = table,
                                     .count = sizeof table / sizeof *table,
                                     .help = "'terraclip synth --help'",
                                     .operand = refuse_operand};

void tc_synth_help(FILE *file)
{
    fprintf(file, "Usage: terraclip synth [OPTION]... -o FILE.tif\n"
                  "Writes a synthetic terrain as a float32 GeoTIFF, heights in metres above the sea.\n"
                  "The same size, seed and spacing give the same heights on every machine. A planet is a grid of\n"
                  "longitude and latitude around a sphere of 6371 km; another size is the same planet.\n");
    tc_arguments_print(&line, file);
}

/* ---- Running ---------------------------------------------------------------------------------------------------- */

static void show_progress(void *context, double done)
{
    int *shown = context, percent = (int)(100 * done);
    if (percent == *shown)
        return;
    *shown = percent;
    fprintf(stderr, "\rsynth: %3d %%", percent);
    fflush(stderr);
}

static void clear_progress(bool progress)
{
    if (progress)
        fprintf(stderr, "\r            \r");
}

struct rows {
    const float *z;
    int64_t size;
};

static tc_status give_row(void *context, int64_t y, double *values)
{
    const struct rows *rows = context;
    for (int64_t i = 0; i < rows->size; i++)
        values[i] = rows->z[y * rows->size + i];
    return TC_OK;
}

/* Memory is given out before it is there; a terrain that cannot fit would be killed half-way. */
static tc_status check_memory(const struct arguments *a, tc_error *error)
{
    double land = (double)a->size * (double)a->size * sizeof(float);
    double needed = land + (double)tc_synth_planar_bytes(a->size, a->spacing);
    double there = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (there > 0 && needed > there)
        return tc_fail(error, TC_ERR_MEMORY, "--size %" PRId64 ": expected %.1f GB of memory, found %.1f GB", a->size,
                       needed * 1e-9, there * 1e-9);
    return TC_OK;
}

static tc_status make_planar(const struct arguments *a, bool progress, tc_error *error)
{
    float *z = malloc((size_t)a->size * (size_t)a->size * sizeof *z);
    if (!z)
        return tc_fail(error, TC_ERR_MEMORY, "--size %" PRId64 ": expected %.1f GB of memory, found less", a->size,
                       (double)a->size * (double)a->size * sizeof *z * 1e-9);
    int shown = -1;
    tc_synth_planar_options options = {.seed = a->seed,
                                       .spacing = a->spacing,
                                       .threads = a->threads,
                                       .progress = progress ? show_progress : NULL,
                                       .progress_context = &shown};
    tc_status status = tc_synth_planar(a->size, &options, z, error);
    clear_progress(progress);
    if (status == TC_OK) {
        struct rows rows = {z, a->size};
        tc_tiff_options tiff = {.width = a->size, .height = a->size, .type = TC_SAMPLE_FLOAT32, .spacing = a->spacing};
        status = tc_write_tiff(a->output, &tiff, give_row, &rows, error);
    }
    if (status == TC_OK && a->verbose)
        fprintf(stderr, "synth: %s: %" PRId64 " x %" PRId64 " samples, %g m apart, seed %" PRIu64 "\n", a->output,
                a->size, a->size, a->spacing, a->seed);
    free(z);
    return status;
}

/* ---- A planet: made while it is written, some rows at a time ---------------------------------------------------- */

enum { STRIP = 64 };

struct strip {
    const tc_synth_planet *planet;
    int64_t width, height, y0, rows; /* rows y0 .. y0 + rows - 1 are there */
    float *z;
    bool progress;
    int shown;
};

/* Rows are asked for from north to south. */
static tc_status give_planet_row(void *context, int64_t y, double *values)
{
    struct strip *strip = context;
    if (y < strip->y0 || y >= strip->y0 + strip->rows) {
        strip->y0 = y < STRIP ? 0 : y + 1 - STRIP;
        strip->rows = y + 1 - strip->y0;
        tc_synth_planet_rows(strip->planet, strip->y0, strip->rows, strip->z);
        if (strip->progress)
            show_progress(&strip->shown, 1 - (double)strip->y0 / (double)strip->height);
    }
    for (int64_t i = 0; i < strip->width; i++)
        values[i] = strip->z[(y - strip->y0) * strip->width + i];
    return TC_OK;
}

static tc_status make_planet(const struct arguments *a, bool progress, tc_error *error)
{
    struct strip strip = {.width = a->size, .height = a->size / 2, .progress = progress, .shown = -1};
    tc_synth_planet *planet = NULL;
    tc_status status = tc_synth_planet_open(a->size, a->seed, a->threads, &planet, error);
    if (status != TC_OK)
        return status;
    strip.planet = planet;
    strip.z = malloc((size_t)(strip.width * STRIP) * sizeof *strip.z);
    if (strip.z) {
        char wkt[256];
        snprintf(wkt, sizeof wkt,
                 "GEOGCS[\"planet\",DATUM[\"planet\",SPHEROID[\"sphere\",%.0f,0]],"
                 "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]",
                 TC_SYNTH_PLANET_RADIUS);
        double step = 360.0 / (double)strip.width;
        tc_georef georef = {.known = true,
                            .geographic = true,
                            .transform = {-180, step, 0, 90, 0, -step},
                            .semi_major = TC_SYNTH_PLANET_RADIUS,
                            .crs_wkt = wkt};
        tc_tiff_options tiff = {.width = strip.width,
                                .height = strip.height,
                                .type = TC_SAMPLE_FLOAT32,
                                .georef = &georef,
                                .area_registered = true};
        status = tc_write_tiff(a->output, &tiff, give_planet_row, &strip, error);
        clear_progress(progress);
    } else
        status = tc_fail(error, TC_ERR_MEMORY, "not enough memory for %" PRId64 " columns", strip.width);
    if (status == TC_OK && a->verbose)
        fprintf(stderr, "synth: %s: %" PRId64 " x %" PRId64 " samples around a planet, seed %" PRIu64 "\n", a->output,
                strip.width, strip.height, a->seed);
    free(strip.z);
    tc_synth_planet_close(planet);
    return status;
}

static tc_status run(struct arguments *a, tc_error *error)
{
    bool planet = strcmp(a->kind, "planet") == 0, progress = !a->quiet && isatty(STDERR_FILENO);
    tc_status status = TC_OK;
    if (planet) {
        if (a->spacing > 0)
            return tc_fail(error, TC_ERR_USAGE,
                           "--spacing: expected none with --kind planet, whose size says how far samples are apart");
        a->size = a->size > 0 ? a->size : 4096;
        if (a->size < TC_SYNTH_PLANET_MIN || a->size > TC_SYNTH_PLANET_MAX || a->size % 2 != 0)
            return tc_fail(error, TC_ERR_USAGE,
                           "--size: expected an even number %d..%d with --kind planet, found %" PRId64,
                           TC_SYNTH_PLANET_MIN, TC_SYNTH_PLANET_MAX, a->size);
    } else {
        a->size = a->size > 0 ? a->size : 4097;
        a->spacing = a->spacing > 0 ? a->spacing : TC_SYNTH_SPACING;
        status = check_memory(a, error);
    }
    if (status == TC_OK)
        status = tc_outfile_probe(a->output, error);
    if (status != TC_OK)
        return status;
    return planet ? make_planet(a, progress, error) : make_planar(a, progress, error);
}

tc_status tc_synth_main(int argc, char **argv, tc_error *error)
{
    struct arguments arguments = {.kind = "planar", .seed = 1};
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &arguments, &action, error);
    if (status == TC_OK && !arguments.output)
        status = tc_fail(error, TC_ERR_USAGE, "synth: expected -o FILE.tif, found none");
    return status == TC_OK ? run(&arguments, error) : status;
}
