/* pack.c - `terraclip pack`: one or several DEMs become a packed terrain.
 *
 * All that can be wrong with the command line, the inputs' agreement and the output is found before the first height is
 * read. The inputs stream through in bands of rows; what is packed lies beside the output until it is whole. */
#include "pack.h"

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/app/arguments.h"
#include "common/app/credits.h"
#include "common/app/interrupt.h"
#include "common/app/json.h"
#include "common/chart/atlas.h"
#include "common/input/mosaic.h"
#include "common/base/numbers.h"
#include "common/input/folder.h"
#include "pack_planet.h"
#include "progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* The default error: LH04 packs samples 10 m apart with an rms of 1 m, those 30 m apart with 1.8 m. From the distance
 * at which a level is drawn, this share of its spacing is less than a fifth of a pixel; no more than the elevation
 * models themselves are off by. */
static const double default_share = 0.06, default_most = 10;

/* The largest error of the default, in rms: of errors spread like noise one in 16,000 is beyond it. What it catches is
 * crests and single peaks that an rms alone lets go. */
static const double default_bound = 4;
static const int64_t worth_telling = 10000; /* bytes of a file that might be a smaller one without loss */

struct arguments {
    const char **inputs;
    int count;
    const char *output;
    const tc_atlas *atlas; /* NULL: not given */
    double rms, max_error; /* 0: not given */
    tc_globe_choice globe;
    bool lossless, synthesis_fit, planet, json, quiet, verbose;
    tc_pack_codec codec;
    int threads;
    tc_source_options source;
};

/* ---- Command line ----------------------------------------------------------------------------------------------- */

static bool read_error(void *error, const char *value)
{
    return tc_read_number(value, 1e-9, 1e6, error);
}

static bool read_codec(void *codec, const char *value)
{
    bool lifting = strcmp(value, "lifting") == 0;
    *(tc_pack_codec *)codec = lifting ? TC_CODEC_LIFTING : TC_CODEC_LH04;
    return lifting || strcmp(value, "lh04") == 0;
}

static bool read_atlas(void *atlas, const char *value)
{
    *(const tc_atlas **)atlas = tc_atlas_named(value);
    return *(const tc_atlas **)atlas != NULL;
}

static bool read_radius(void *radius, const char *value)
{
    return tc_read_number(value, 1, 1e12, radius);
}

#define EXPECTED_ERROR "metres above 0, up to 1e6"

static const tc_option table[] = {
    {'o', "output", "FILE.tclip", "the name of a file", "where it goes", tc_read_text,
     offsetof(struct arguments, output)},

    {.help = "What may be lost"},
    {0, "rms", "M", EXPECTED_ERROR, "root mean square of the error, metres; alone it bounds no single height's",
     read_error, offsetof(struct arguments, rms)},
    {0, "max-error", "M", EXPECTED_ERROR, "no height is off by more than M metres; alone, or with --rms", read_error,
     offsetof(struct arguments, max_error)},
    TC_SWITCH(struct arguments, lossless, 0, "lossless", "nothing: the stored values come back"),
    {0, "codec", "NAME", "lifting or lh04", "lifting, or lh04, the paper's, to compare; with an rms only (lifting)",
     read_codec, offsetof(struct arguments, codec)},

    {.help = "What else is stored"},
    TC_SWITCH(struct arguments, synthesis_fit, 0, "synthesis-fit",
              "what --synthesis goes by, fitted to the heights as they are given"),

    {.help = "How the inputs are read"},
    TC_READING_ROWS(struct arguments, source),
    {0, "voids", "POLICY", TC_EXPECTED_VOIDS,
     "what is to show where there is no height: fill, hole or constant=V (fill)", tc_read_voids,
     offsetof(struct arguments, source)},

    {.help = "Planets"},
    TC_SWITCH(struct arguments, planet, 0, "planet",
              "the inputs go around a globe: polar caps are packed too, and the levels of detail join at its seam"),
    {0, "ellipsoid", "NAME", TC_EXPECTED_ELLIPSOID,
     "that heights are above: wgs84, A,1/F (metres, inverse flattening) or sphere (by the coordinate system, else a "
     "sphere)",
     tc_read_ellipsoid, offsetof(struct arguments, globe)},
    {0, "radius", "M", "metres, 1 or more",
     "of a sphere instead (the semi-major axis of the coordinate system, else 6371000)", read_radius,
     offsetof(struct arguments, globe.radius)},
    {0, "atlas", "NAME", "lonlat, hex or cube",
     "charts: lonlat, the inputs' own; hex or cube, resampled to four sheared charts of an octahedron or the six "
     "faces of a cube, for schemes that draw them (lonlat)",
     read_atlas, offsetof(struct arguments, atlas)},

    {.help = "Work"},
    {0, "threads", "N", TC_EXPECTED_THREADS, "that pack (all processors); the file does not depend on it",
     tc_read_threads, offsetof(struct arguments, threads)},
    TC_SWITCH(struct arguments, json, 0, "json", "print the figures as JSON"),
    TC_SWITCH(struct arguments, quiet, 'q', "quiet", "neither warnings nor progress nor figures"),
    TC_SWITCH(struct arguments, verbose, 'v', "verbose", "how the files were understood"),
    TC_HELP_AND_VERSION,
};

static tc_status add_input(void *arguments, const char *operand, tc_error *error)
{
    struct arguments *a = arguments;
    if (!*operand)
        return tc_fail(error, TC_ERR_USAGE, "INPUT: expected the name of a file, found ''");
    a->inputs[a->count++] = operand;
    return TC_OK;
}

static const tc_command_line line = {
    .options = table, .count = sizeof table / sizeof *table, .help = "'terraclip pack --help'", .operand = add_input};

void tc_pack_help(FILE *file)
{
    fputs("Usage: terraclip pack [OPTION]... INPUT... -o FILE.tclip\n"
          "Packs elevation models and pictures of heights; of a folder all that are in it. Several inputs are placed\n"
          "by their georeferences, whose samples must lie on one lattice; where they overlap the first one holds.\n"
          "Without options the rms of the error is 6 % of the samples' spacing, 10 m at most, and no height is off by\n"
          "more than four times that.\n\n",
          file);
    tc_arguments_print(&line, file);
}

static tc_status check_together(const struct arguments *a, tc_error *error)
{
    if (a->count == 0)
        return tc_fail(error, TC_ERR_USAGE, "INPUT: expected at least one file, found none");
    if (!a->output)
        return tc_fail(error, TC_ERR_USAGE, "pack: expected -o FILE.tclip, found none");
    if (a->lossless && (a->rms > 0 || a->max_error > 0))
        return tc_fail(error, TC_ERR_USAGE, "pack: expected --rms, --max-error, both of them or --lossless, found %s",
                       !(a->max_error > 0) ? "--rms and --lossless"
                       : !(a->rms > 0)     ? "--max-error and --lossless"
                                           : "all three");
    if (a->codec == TC_CODEC_LH04 && (a->max_error > 0 || a->lossless))
        return tc_fail(error, TC_ERR_USAGE, "--codec: expected lifting with %s, found lh04, which keeps --rms only",
                       a->lossless ? "--lossless" : "--max-error");
    const char *globe = tc_globe_given(&a->globe);
    if (globe && !a->planet)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected --planet with it, found none", globe);
    tc_status status = tc_globe_check(&a->globe, error);
    if (status != TC_OK)
        return status;
    if (a->planet && a->source.spacing > 0)
        return tc_fail(error, TC_ERR_USAGE, "--spacing: expected none for a planet: its samples lie in degrees");
    if (a->atlas && !a->planet)
        return tc_fail(error, TC_ERR_USAGE, "--atlas: expected --planet with it, found none");
    if (a->lossless && a->atlas && a->atlas != &tc_atlas_lonlat)
        return tc_fail(error, TC_ERR_USAGE,
                       "--atlas: expected lonlat with --lossless, found %s, to which heights are resampled",
                       a->atlas->name);
    return TC_OK;
}

/* ---- Telling ---------------------------------------------------------------------------------------------------- */

static const char *const mode_names[] = {"rms", "max-error", "lossless"}; /* as tc_pack_mode */

/* Whether heights are resampled to faces. */
static bool faces_of(const struct arguments *a)
{
    return a->atlas && a->atlas->class->seam;
}

static double bits_per_sample(const tc_pack_result *result)
{
    return 8 * (double)result->bytes / (double)result->samples;
}

static void print_json(const struct arguments *a, const tc_pack_terrain *terrain, tc_pack_mode mode,
                       const tc_pack_result *result, double seconds)
{
    struct rusage used = {0};
    getrusage(RUSAGE_SELF, &used);
    printf("{\n  \"input\": [");
    for (int i = 0; i < a->count; i++) {
        fputs(i ? ", " : "", stdout);
        tc_json_string(a->inputs[i], stdout);
    }
    printf("],\n  \"width\": %" PRId64 ",\n  \"height\": %" PRId64 ",\n  \"samples\": %" PRId64
           ",\n  \"bytes\": %" PRId64 ",\n  \"bits_per_sample\": ",
           terrain->width, terrain->height, result->samples, result->bytes);
    tc_json_number(bits_per_sample(result), stdout);
    printf(",\n  \"mode\": \"%s\",\n  \"rms_m\": ", mode_names[mode]);
    tc_json_number(result->rms, stdout);
    printf(",\n  \"max_error_m\": ");
    tc_json_number(result->max_error, stdout);
    if (result->lossless_bytes > 0)
        printf(",\n  \"lossless_bytes_about\": %" PRId64, result->lossless_bytes);
    if (faces_of(a)) {
        printf(",\n  \"atlas\": \"%s\",\n  \"resampling_rms_m\": ", a->atlas->name);
        tc_json_number(result->trip_rms, stdout);
        printf(",\n  \"resampling_max_error_m\": ");
        tc_json_number(result->trip_max, stdout);
    }
    printf(",\n  \"voids\": %" PRId64 ",\n  \"seconds\": %.3f,\n  \"msamples_per_s\": ", result->voids, seconds);
    tc_json_number((double)result->samples / seconds * 1e-6, stdout);
    printf(",\n  \"peak_rss_bytes\": %" PRId64 "\n}\n", (int64_t)used.ru_maxrss * 1024);
}

static void print_line(const struct arguments *a, const tc_pack_terrain *terrain, tc_pack_mode mode,
                       const tc_pack_result *result, double seconds)
{
    printf("%s: %" PRId64 " x %" PRId64 " samples, %" PRId64 " bytes, %.3f bits a sample, ", a->output, terrain->width,
           terrain->height, result->bytes, bits_per_sample(result));
    if (mode == TC_PACK_LOSSLESS && result->max_error == 0)
        printf("lossless");
    else
        printf("rms %.3g m, at most %.3g m off", result->rms, result->max_error);
    if (result->lossless_bytes > 0)
        printf(" (lossless about %" PRId64 " bytes)", result->lossless_bytes);
    if (result->voids > 0)
        printf(", %" PRId64 " voids", result->voids);
    if (faces_of(a))
        printf("; resampled to %" PRId64 " samples on %s, the source's are rms %.3g m, at most %.3g m off them",
               result->samples, a->atlas->name, result->trip_rms, result->trip_max);
    printf("; %.2f s, %.2f Msamples/s\n", seconds, (double)result->samples / seconds * 1e-6);
}

static void warn_of_disagreement(const tc_mosaic *mosaic, const tc_pack_result *result, tc_progress *progress)
{
    char text[160];
    if (result->disagreeing == 0)
        return;
    snprintf(text, sizeof text,
             "%" PRId64 " of %" PRId64 " shared edge samples differ by up to %.4g m; the first input's hold",
             result->disagreeing, tc_mosaic_shared(mosaic), result->largest_disagreement);
    tc_progress_say(progress, true, text);
}

/* ---- Running ---------------------------------------------------------------------------------------------------- */

static bool on_progress(void *context, double done)
{
    tc_progress_show(context, done);
    return !tc_interrupted();
}

static tc_status put_band(void *packer, tc_rect rect, const float *z, const uint8_t *voids, tc_error *error)
{
    if (tc_interrupted())
        return tc_fail(error, TC_ERR_IO, "interrupted");
    return tc_packer_put(packer, rect, z, voids, rect.x1 - rect.x0, error);
}

static tc_pack_options choose_options(const struct arguments *a, const tc_pack_terrain *terrain, tc_progress *progress)
{
    tc_pack_options o = {.codec = a->codec,
                         .synthesis_fit = a->synthesis_fit,
                         .atlas = a->atlas ? a->atlas->name : NULL,
                         .threads = a->threads,
                         .progress = on_progress,
                         .progress_context = progress};
    if (a->lossless) {
        o.mode = TC_PACK_LOSSLESS;
    } else if (a->max_error > 0 && !(a->rms > 0)) {
        o.mode = TC_PACK_MAX_ERROR;
        o.error = a->max_error;
    } else if (a->rms > 0) {
        o.mode = TC_PACK_RMS, o.price_lossless = true;
        o.error = a->rms, o.max_error = a->max_error;
    } else {
        double spacing = 0.5 * (terrain->spacing_x + terrain->spacing_y);
        o.mode = TC_PACK_RMS, o.price_lossless = true;
        o.error = fmin(default_share * spacing, default_most);
        o.max_error = a->codec == TC_CODEC_LH04 ? 0 : default_bound * o.error;
        o.max_error_may_yield = true;
    }
    return o;
}

/* The files of folders among the inputs in their place; *files_ret: theirs, one after the other. */
static tc_status open_folders(struct arguments *a, tc_folder *files_ret, tc_error *error)
{
    tc_status status = TC_OK;
    for (int i = 0; i < a->count && status == TC_OK; i++) {
        tc_folder folder;
        if (!tc_is_folder(a->inputs[i]))
            continue;
        status = tc_folder_list(a->inputs[i], &a->source, &folder, error);
        if (status != TC_OK)
            break;
        size_t all = (size_t)(a->count - 1 + folder.count), held = (size_t)(files_ret->count + folder.count);
        const char **inputs = realloc(a->inputs, all * sizeof *inputs);
        a->inputs = inputs ? inputs : a->inputs;
        char **held_files = realloc(files_ret->file, held * sizeof *held_files);
        files_ret->file = held_files ? held_files : files_ret->file;
        if (!inputs || !held_files) {
            tc_folder_free(&folder);
            return tc_fail(error, TC_ERR_MEMORY, "pack: not enough memory for %zu files", all);
        }
        memmove(inputs + i + folder.count, inputs + i + 1, (size_t)(a->count - i - 1) * sizeof *inputs);
        for (int k = 0; k < folder.count; k++)
            inputs[i + k] = files_ret->file[files_ret->count++] = folder.file[k];
        a->count += folder.count - 1;
        i += folder.count - 1;
        free(folder.file);
    }
    return status;
}

static void say_plan(const struct arguments *a, const tc_pack_terrain *terrain, const tc_pack_options *options,
                     tc_progress *progress)
{
    char text[256], bound[32] = "";
    if (options->max_error > 0)
        snprintf(bound, sizeof bound, ", max-error %.4g", options->max_error);
    snprintf(text, sizeof text, "%" PRId64 " x %" PRId64 " samples every %.6g x %.6g m from %d input%s, mode %s %.4g%s",
             terrain->width, terrain->height, terrain->spacing_x, terrain->spacing_y, a->count,
             a->count == 1 ? "" : "s", mode_names[options->mode], options->error, bound);
    tc_progress_say(progress, false, text);
}

/* planet: NULL for a flat terrain. */
static tc_status pack(const struct arguments *a, tc_mosaic *mosaic, const tc_planet_input *planet,
                      const tc_credits *credits, tc_progress *progress, tc_error *error)
{
    char whose[TC_CREDITS_TEXT];
    tc_credits_join(credits, whose);
    tc_pack_terrain terrain = planet ? planet->terrain : *tc_mosaic_terrain(mosaic);
    terrain.credits = *whose ? whose : NULL;
    const tc_pack_options options = choose_options(a, &terrain, progress);
    say_plan(a, &terrain, &options, progress);
    progress->samples = (double)terrain.width * (double)terrain.height;

    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_status status = tc_packer_create(a->output, &terrain, &options, &packer, error);
    if (status == TC_OK)
        status = planet ? tc_planet_input_read(planet, a->output, put_band, packer, error)
                        : tc_mosaic_read(mosaic, put_band, packer, error);
    if (status == TC_OK) {
        status = tc_packer_finish(packer, &result, error);
        if (status == TC_ERR_FORMAT) /* it knows the output only, but the input is to blame */
            tc_fail(error, status, "%s: expected heights, found %" PRId64 " samples that are all void", a->inputs[0],
                    tc_mosaic_samples(mosaic));
    }
    tc_packer_destroy(packer);
    tc_progress_end(progress);
    if (status != TC_OK)
        return tc_interrupted() ? tc_fail(error, TC_ERR_IO, "interrupted") : status;

    warn_of_disagreement(mosaic, &result, progress);
    if (result.lossless_bytes > 0 && result.lossless_bytes < result.bytes && result.bytes > worth_telling)
        tc_progress_say(progress, true, "without loss the file would take fewer bytes: --lossless, or a wider --rms");
    if (options.max_error_may_yield && options.max_error > 0 && result.max_error > options.max_error)
        tc_progress_say(progress, true,
                        "these heights are not held finely enough for a largest error: the rms alone is kept");
    double seconds = tc_progress_seconds(progress);
    if (a->json)
        print_json(a, &terrain, options.mode, &result, seconds);
    else if (!a->quiet)
        print_line(a, &terrain, options.mode, &result, seconds);
    return TC_OK;
}

static tc_status run(struct arguments *a, tc_error *error)
{
    tc_status status = check_together(a, error);
    if (status != TC_OK)
        return status;
    tc_outputs outputs = {0};
    status = tc_outputs_add(&outputs, a->output, error);
    for (int i = 0; i < a->count && status == TC_OK; i++) /* before the first is opened */
        status = tc_outputs_spare(&outputs, a->inputs[i], error);
    if (status != TC_OK) {
        tc_outputs_free(&outputs);
        return status;
    }
    tc_watch_interrupts();
    tc_progress progress = tc_progress_begin("pack", a->quiet, a->verbose);
    tc_mosaic *mosaic = NULL;
    a->source.exact = a->lossless;
    a->source.outputs = &outputs;
    a->source.say = tc_progress_say;
    a->source.say_context = &progress;
    tc_credits credits = {.count = 0};
    a->source.credit = tc_credits_take;
    a->source.credit_context = &credits;
    a->source.lonlat = a->planet;
    if (a->planet)
        a->source.spacing = 1; /* metres on a flat map are not settled, and not talked about */
    tc_folder files = {0};
    status = open_folders(a, &files, error);
    if (status == TC_OK)
        status = tc_mosaic_open(a->inputs, a->count, &a->source, &mosaic, error);
    tc_planet_input planet;
    if (status == TC_OK && a->planet)
        status = tc_planet_input_settle(mosaic, a->inputs[0], &a->source, &a->globe, a->lossless, &planet, error);
    if (status == TC_OK)
        status = pack(a, mosaic, a->planet ? &planet : NULL, &credits, &progress, error);
    tc_mosaic_close(mosaic);
    tc_folder_free(&files);
    tc_outputs_free(&outputs);
    return status;
}

tc_status tc_pack_main(int argc, char **argv, tc_error *error)
{
    struct arguments arguments = {.inputs = malloc((size_t)argc * sizeof *arguments.inputs)};
    if (!arguments.inputs)
        return tc_fail(error, TC_ERR_MEMORY, "pack: not enough memory for %d arguments", argc);
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &arguments, &action, error);
    if (status == TC_OK)
        status = run(&arguments, error);
    free(arguments.inputs);
    return status;
}
