/* synth.c - `terraclip synth`: writes a synthetic terrain.
 *
 * The command line is checked whole, and the output tried, before a sample is computed: a terrain can take minutes, and
 * nobody should wait that long to read that a folder does not exist. */
#include "synth.h"

#include "common/core/base/status.h"
#include "common/shell/arguments.h"
#include "common/shell/numbers.h"
#include "common/core/base/outfile.h"
#include "common/shell/source.h"
#include "synth_planar.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct arguments {
    const char *kind, *output;
    int64_t size;
    uint64_t seed;
    double spacing; /* metres */
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

static const tc_option table[] = {
    {.help = "Options"},
    {0, "kind", "KIND", "planar or planet",
     "planar: mountains, valleys, plains and a coast; planet: not in this version (planar)", read_kind,
     offsetof(struct arguments, kind)},
    {0, "size", "N", "a whole number 2..65537", "N x N samples (4097)", read_size, offsetof(struct arguments, size)},
    {0, "seed", "S", "a whole number 0..18446744073709551615", "which terrain (1)", read_seed,
     offsetof(struct arguments, seed)},
    {0, "spacing", "M", "metres of 0.001..100000", "between samples (30)", read_spacing,
     offsetof(struct arguments, spacing)},
    {0, "threads", "N", TC_EXPECTED_THREADS, "that compute (all processors)", tc_read_threads,
     offsetof(struct arguments, threads)},
    {'o', "output", "FILE.tif", "the name of a file", "where it goes", tc_read_text,
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
                  "The same size, seed and spacing give the same heights on every machine.\n");
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

static tc_status run(const struct arguments *a, tc_error *error)
{
    if (strcmp(a->kind, "planet") == 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "--kind: expected planar, found planet, which is not in this version");
    tc_status status = check_memory(a, error);
    if (status == TC_OK)
        status = tc_outfile_probe(a->output, error);
    if (status != TC_OK)
        return status;
    float *z = malloc((size_t)a->size * (size_t)a->size * sizeof *z);
    if (!z)
        return tc_fail(error, TC_ERR_MEMORY, "--size %" PRId64 ": expected %.1f GB of memory, found less", a->size,
                       (double)a->size * (double)a->size * sizeof *z * 1e-9);
    int shown = -1;
    bool progress = !a->quiet && isatty(STDERR_FILENO);
    tc_synth_planar_options options = {.seed = a->seed,
                                       .spacing = a->spacing,
                                       .threads = a->threads,
                                       .progress = progress ? show_progress : NULL,
                                       .progress_context = &shown};
    status = tc_synth_planar(a->size, &options, z, error);
    if (progress)
        fprintf(stderr, "\r            \r");
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

tc_status tc_synth_main(int argc, char **argv, tc_error *error)
{
    struct arguments arguments = {.kind = "planar", .size = 4097, .seed = 1, .spacing = TC_SYNTH_SPACING};
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &arguments, &action, error);
    if (status == TC_OK && !arguments.output)
        status = tc_fail(error, TC_ERR_USAGE, "synth: expected -o FILE.tif, found none");
    return status == TC_OK ? run(&arguments, error) : status;
}
