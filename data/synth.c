/* synth.c - `terraclip synth`: writes a synthetic terrain.
 *
 * The command line is checked whole, and the output tried, before a sample is computed: a terrain can take minutes, and
 * nobody should wait that long to read that a folder does not exist. */
#include "synth.h"

#include "common/core/base/status.h"
#include "common/core/base/outfile.h"
#include "common/shell/source.h"
#include "synth_planar.h"

#include <ctype.h>
#include <errno.h>
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

void tc_synth_help(FILE *file)
{
    fprintf(file,
            "Usage: terraclip synth [OPTION]... -o FILE.tif\n"
            "Writes a synthetic terrain as a float32 GeoTIFF, heights in metres above the sea.\n"
            "The same size, seed and spacing give the same heights on every machine.\n"
            "\n"
            "  --kind KIND      planar: mountains, valleys, plains and a coast (default)\n"
            "                   planet: not in this version\n"
            "  --size N         N x N samples, %d..%d (default 4097)\n"
            "  --seed S         which terrain, 0..%" PRIu64 " (default 1)\n"
            "  --spacing M      metres between samples, %g..%g (default %g)\n"
            "  --threads N      1..1024 (default: as many as there are processors)\n"
            "  -o, --output FILE.tif\n"
            "  -q, --quiet      no progress\n"
            "  -v, --verbose    what was written\n"
            "  -h, --help\n"
            "      --version\n",
            TC_SYNTH_SIZE_MIN, TC_SYNTH_SIZE_MAX, UINT64_MAX, TC_SYNTH_SPACING_MIN, TC_SYNTH_SPACING_MAX,
            TC_SYNTH_SPACING);
}

/* ---- Command line ----------------------------------------------------------------------------------------------- */

/* A whole decimal number in low..high and nothing around it. */
static bool read_whole(const char *text, uint64_t low, uint64_t high, uint64_t *value_ret)
{
    if (!isdigit((unsigned char)*text))
        return false;
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (*end || errno || value < low || value > high)
        return false;
    *value_ret = value;
    return true;
}

static bool read_metres(const char *text, double *value_ret)
{
    /* strtod also takes spaces, hexadecimals, "inf" and "nan". */
    size_t length = strspn(text, "0123456789.eE+-");
    char *end;
    double value = strtod(text, &end);
    if (length == 0 || text[length] || *end || !(value >= TC_SYNTH_SPACING_MIN && value <= TC_SYNTH_SPACING_MAX))
        return false;
    *value_ret = value;
    return true;
}

enum { KIND, SIZE, SEED, SPACING, THREADS, OUTPUT, QUIET, VERBOSE };

static const struct option_row {
    int id;
    char letter;
    const char *name;
    bool has_value;
} table[] = {
    {KIND, 0, "kind", true},       {SIZE, 0, "size", true},          {SEED, 0, "seed", true},
    {SPACING, 0, "spacing", true}, {THREADS, 0, "threads", true},    {OUTPUT, 'o', "output", true},
    {QUIET, 'q', "quiet", false},  {VERBOSE, 'v', "verbose", false},
};

static tc_status set(struct arguments *a, int id, const char *value, tc_error *error)
{
    uint64_t number = 0;
    switch (id) {
    case KIND:
        if (strcmp(value, "planar") != 0 && strcmp(value, "planet") != 0)
            return tc_fail(error, TC_ERR_USAGE, "--kind: expected planar or planet, found '%s'", value);
        a->kind = value;
        break;
    case SIZE:
        if (!read_whole(value, TC_SYNTH_SIZE_MIN, TC_SYNTH_SIZE_MAX, &number))
            return tc_fail(error, TC_ERR_USAGE, "--size: expected a whole number %d..%d, found '%s'", TC_SYNTH_SIZE_MIN,
                           TC_SYNTH_SIZE_MAX, value);
        a->size = (int64_t)number;
        break;
    case SEED:
        if (!read_whole(value, 0, UINT64_MAX, &a->seed))
            return tc_fail(error, TC_ERR_USAGE, "--seed: expected a whole number 0..%" PRIu64 ", found '%s'",
                           UINT64_MAX, value);
        break;
    case SPACING:
        if (!read_metres(value, &a->spacing))
            return tc_fail(error, TC_ERR_USAGE, "--spacing: expected %g..%g metres, found '%s'", TC_SYNTH_SPACING_MIN,
                           TC_SYNTH_SPACING_MAX, value);
        break;
    case THREADS:
        if (!read_whole(value, 1, 1024, &number))
            return tc_fail(error, TC_ERR_USAGE, "--threads: expected a whole number 1..1024, found '%s'", value);
        a->threads = (int)number;
        break;
    case OUTPUT:
        if (!*value)
            return tc_fail(error, TC_ERR_USAGE, "--output: expected the name of a file, found ''");
        a->output = value;
        break;
    case QUIET: a->quiet = true; break;
    case VERBOSE: a->verbose = true; break;
    }
    return TC_OK;
}

/* Finds the option that an argument names; *value_ret is what is stuck to it (--size=5, -oFILE), or NULL. */
static const struct option_row *find(const char *argument, const char **value_ret)
{
    *value_ret = NULL;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        size_t length = strlen(table[i].name);
        if (argument[1] == '-') {
            if (strncmp(argument + 2, table[i].name, length) != 0)
                continue;
            const char *rest = argument + 2 + length;
            if (*rest && *rest != '=')
                continue;
            *value_ret = *rest ? rest + 1 : NULL;
            return &table[i];
        }
        if (table[i].letter && argument[1] == table[i].letter && (table[i].has_value || !argument[2])) {
            *value_ret = argument[2] ? argument + 2 : NULL;
            return &table[i];
        }
    }
    return NULL;
}

static tc_status parse(int argc, char **argv, struct arguments *a, tc_error *error)
{
    for (int i = 1; i < argc; i++) {
        if (argv[i][0] != '-' || !argv[i][1])
            return tc_fail(error, TC_ERR_USAGE, "synth: expected options only, found '%s'", argv[i]);
        const char *value;
        const struct option_row *option = find(argv[i], &value);
        if (!option)
            return tc_fail(error, TC_ERR_USAGE, "%s: expected an option of 'terraclip synth --help', found none such",
                           argv[i]);
        if (option->has_value && !value && ++i == argc)
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected a value, found none", option->name);
        if (!option->has_value && value)
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected no value, found '%s'", option->name, value);
        tc_status status = set(a, option->id, value ? value : argv[i], error);
        if (status != TC_OK)
            return status;
    }
    if (!a->output)
        return tc_fail(error, TC_ERR_USAGE, "synth: expected -o FILE.tif, found none");
    return TC_OK;
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

static tc_status give_row(void *context, int64_t y, float *z)
{
    const struct rows *rows = context;
    memcpy(z, rows->z + y * rows->size, (size_t)rows->size * sizeof *z);
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
        tc_tiff_options tiff = {.width = a->size, .height = a->size, .spacing = a->spacing};
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
    tc_status status = parse(argc, argv, &arguments, error);
    return status == TC_OK ? run(&arguments, error) : status;
}
