/* options.c - the viewers' command line; see options.h. A new option is one line of the table and one setter. */
#include "options.h"
#include "common/core/base/status.h"
#include "common/core/clipmap/surface.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)

/* ---- Values ------------------------------------------------------------------------------------------------- */

/* A whole decimal number, nothing around it. */
static bool read_integer(const char *text, int64_t low, int64_t high, int64_t *value_ret)
{
    if (!isdigit((unsigned char)text[text[0] == '-']))
        return false;
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (*end || errno || value < low || value > high)
        return false;
    *value_ret = value;
    return true;
}

static bool read_int(const char *text, int low, int high, int *value_ret)
{
    int64_t value;
    if (!read_integer(text, low, high, &value))
        return false;
    *value_ret = (int)value;
    return true;
}

/* A finite decimal number, nothing around it. */
static bool read_number(const char *text, double low, double high, double *value_ret)
{
    /* strtod also takes spaces, hexadecimals, "inf" and "nan". */
    size_t length = strspn(text, "0123456789.eE+-");
    char *end;
    double value = strtod(text, &end);
    if (length == 0 || end != text + length || *end || !(value >= low && value <= high))
        return false;
    *value_ret = value;
    return true;
}

/* ---- Setters ------------------------------------------------------------------------------------------------ */

static bool set_view(tc_options *o, const char *value)
{
    return o->has_view = tc_view_parse(value, &o->view);
}

static bool set_output(tc_options *o, const char *value)
{
    o->output = value;
    return *value != '\0';
}

static bool set_size(tc_options *o, const char *value)
{
    char text[32];
    const char *x = strchr(value, 'x');
    if (!x || (size_t)(x - value) >= sizeof text)
        return false;
    snprintf(text, sizeof text, "%.*s", (int)(x - value), value);
    return read_int(text, 1, 16384, &o->width) && read_int(x + 1, 1, 16384, &o->height);
}

static bool set_fov(tc_options *o, const char *value)
{
    double degrees;
    if (!read_number(value, 1, 170, &degrees))
        return false;
    o->fov = degrees * DEGREE;
    return true;
}

static bool set_background(tc_options *o, const char *value)
{
    if (strlen(value) != 6 || strspn(value, "0123456789abcdefABCDEF") != 6)
        return false;
    unsigned long rgb = strtoul(value, NULL, 16);
    for (int i = 0; i < 3; i++)
        o->scene.background[i] = (uint8_t)(rgb >> (16 - 8 * i));
    return o->scene.background_set = true;
}

static bool set_n(tc_options *o, const char *value)
{
    return read_int(value, 15, 2047, &o->clipmap.n) && (o->clipmap.n & (o->clipmap.n + 1)) == 0;
}

static bool set_samples(tc_options *o, const char *value)
{
    return read_int(value, 1, 16, &o->scene.samples);
}

static bool set_levels(tc_options *o, const char *value)
{
    return read_int(value, 1, TC_MAX_LEVELS, &o->clipmap.max_levels);
}

static bool set_budget(tc_options *o, const char *value)
{
    return read_integer(value, 1, (int64_t)1 << 40, &o->scene.budget);
}

static bool set_path(tc_options *o, const char *value)
{
    o->path = value;
    return *value != '\0';
}

static bool set_frames(tc_options *o, const char *value)
{
    return read_int(value, 1, 1000000, &o->frames);
}

static bool set_backend(tc_options *o, const char *value)
{
    static const char *const names[] = {"auto", "window", "egl", "osmesa"}; /* as tc_backend */
    for (int i = 0; i < 4; i++)
        if (strcmp(value, names[i]) == 0) {
            o->backend = (tc_backend)i;
            return true;
        }
    return false;
}

static bool set_stats(tc_options *o, const char *value)
{
    o->stats = value;
    return *value != '\0';
}

static bool set_threads(tc_options *o, const char *value)
{
    return read_int(value, 1, 1024, &o->threads);
}

static bool set_voids(tc_options *o, const char *value)
{
    if (strcmp(value, "fill") == 0)
        o->source.voids = TC_VOIDS_FILL;
    else if (strcmp(value, "hole") == 0)
        o->source.voids = TC_VOIDS_HOLE;
    else if (strncmp(value, "constant=", 9) == 0 && read_number(value + 9, -1e12, 1e12, &o->source.void_constant))
        o->source.voids = TC_VOIDS_CONSTANT;
    else
        return false;
    return true;
}

static bool set_nodata(tc_options *o, const char *value)
{
    return o->source.has_nodata =
               read_number(value, -HUGE_VAL, HUGE_VAL, &o->source.nodata) && isfinite(o->source.nodata);
}

static bool set_spacing(tc_options *o, const char *value)
{
    return read_number(value, 1e-6, 1e7, &o->source.spacing);
}

static bool set_unit(tc_options *o, const char *value)
{
    return read_number(value, 1e-9, 1e9, &o->source.unit);
}

/* A switch is a bool of tc_options, by its place there. */
#define SWITCH(letter, name, member, help)                                                                             \
    {                                                                                                                  \
        letter, name, NULL, NULL, help, NULL, offsetof(tc_options, member)                                             \
    }

/* ---- The table ---------------------------------------------------------------------------------------------- */

static const struct option {
    char letter;          /* 0 none */
    const char *name;     /* without dashes; NULL: a heading of the help */
    const char *argument; /* as the help shows it; NULL: a switch */
    const char *expected; /* as errors show it */
    const char *help;
    bool (*set)(tc_options *options, const char *value);
    size_t offset; /* of the switch */
} table[] = {
    {.help = "What is seen"},
    {0, "view", "X,Y,Z,HEADING,PITCH", "X,Y,Z,HEADING,PITCH in metres and degrees, |PITCH| up to 90",
     "eye in metres from the south-west sample, degrees clockwise from north, degrees up (default: all of the terrain)",
     set_view, 0},
    {0, "fov", "DEG", "1..170 degrees", "horizontal field of view (75)", set_fov, 0},
    {0, "size", "WxH", "WxH of 1..16384", "of the picture or window, pixels (1280x720)", set_size, 0},
    SWITCH(0, "unlit", scene.unlit, "colours without light"),
    {0, "background", "RRGGBB", "six hexadecimal digits RRGGBB", "flat background: no sky, no haze", set_background, 0},
    SWITCH(0, "wireframe", scene.wireframe, "lines instead of faces"),
    SWITCH(0, "level-colours", scene.level_colours, "a colour for each level of detail"),
    SWITCH(0, "no-morph", scene.frame.no_morph, "levels meet abruptly"),
    {0, "samples", "N", "1..16", "a pixel, for smooth edges (4 with -o, else 1)", set_samples, 0},

    {.help = "Where it goes"},
    {'o', "output", "FILE.png", "a file name", "write one frame and open no window", set_output, 0},
    {0, "path", "FILE", "a file name",
     "fly through the views of FILE, one X,Y,Z,HEADING,PITCH a line; with -o frame-%05d.png write each frame, "
     "without only measure",
     set_path, 0},
    {0, "frames", "N", "1..1000000", "frames of the flight; in a window without --path: close after N", set_frames, 0},
    {0, "backend", "NAME", "auto, window, egl or osmesa", "auto, window, egl or osmesa (auto)", set_backend, 0},

    {.help = "How the file is read"},
    {0, "spacing", "M", "metres of 1e-6..1e7", "between samples, whatever the file says", set_spacing, 0},
    {0, "unit", "M", "metres of 1e-9..1e9", "per unit of height, whatever the file says", set_unit, 0},
    {0, "nodata", "V", "a number", "stored value that means no height", set_nodata, 0},
    {0, "voids", "POLICY", "fill, hole or constant=V", "where there is no height: fill, hole or constant=V (fill)",
     set_voids, 0},
    {0, "threads", "N", "1..1024", "that prepare the terrain (all processors)", set_threads, 0},

    {.help = "Geometry clipmap"},
    {0, "n", "N", "2^k - 1 of 15..2047", "samples a side of each level's window (by the frame's width)", set_n, 0},
    {0, "levels", "M", "1..32", "of detail at most (all)", set_levels, 0},
    {0, "budget", "SAMPLES", "1 or more samples", "updated a frame (N * N; all that is missing with -o)", set_budget,
     0},

    {.help = "What is told"},
    {0, "stats", "FILE.json", "a file name", "write times, counts and memory", set_stats, 0},
    SWITCH(0, "json", json, "print the same to standard output"),
    SWITCH(0, "explain", explain, "print what the scene does not need and was left out"),
    SWITCH('q', "quiet", quiet, "neither warnings nor progress"),
    SWITCH('v', "verbose", verbose, "how the file was understood, what it is drawn with"),
    {'h', "help", NULL, NULL, "print this", NULL, 0},
    {0, "version", NULL, NULL, "print the version", NULL, 0},
};

enum { OPTIONS = sizeof table / sizeof *table };

/* ---- Parsing ------------------------------------------------------------------------------------------------ */

/* The option that an argument names, and its value where it is part of the argument (--name=VALUE, -oVALUE). */
static const struct option *find_option(const char *argument, const char **value_ret)
{
    *value_ret = NULL;
    for (int i = 0; i < OPTIONS; i++) {
        const struct option *option = &table[i];
        if (!option->name)
            continue;
        if (argument[1] == '-') {
            size_t length = strlen(option->name);
            if (strncmp(argument + 2, option->name, length) != 0)
                continue;
            char after = argument[2 + length];
            if (after != '\0' && after != '=')
                continue;
            *value_ret = after ? argument + 3 + length : NULL;
            return option;
        }
        if (option->letter && argument[1] == option->letter && (!argument[2] || option->argument)) {
            *value_ret = argument[2] ? argument + 2 : NULL;
            return option;
        }
    }
    return NULL;
}

/* What only shows once all options are there. */
static tc_status check_together(const tc_options *o, tc_error *error)
{
    bool offscreen = o->backend == TC_BACKEND_EGL || o->backend == TC_BACKEND_OSMESA;
    if (!o->terrain)
        return tc_fail(error, TC_ERR_USAGE, "TERRAIN: expected a file, found none; --help tells more");
    if (o->path && !o->frames)
        return tc_fail(error, TC_ERR_USAGE, "--path: expected --frames N with it, found none");
    if (o->path && o->output && !tc_frame_pattern_valid(o->output))
        return tc_fail(error, TC_ERR_USAGE, "--output: expected one number such as %%05d for the frames, found '%s'",
                       o->output);
    if (o->frames && !o->path && (o->output || offscreen))
        return tc_fail(error, TC_ERR_USAGE, "--frames: expected --path FILE with it, found none");
    if (offscreen && !o->output && !o->path)
        return tc_fail(error, TC_ERR_USAGE, "--backend: expected -o FILE or --path FILE with it, found neither");
    if (o->path && o->has_view)
        return tc_fail(error, TC_ERR_USAGE, "--view: expected either it or --path, found both");
    return TC_OK;
}

tc_status tc_options_parse(int argc, char **argv, tc_options *options_ret, tc_error *error)
{
    tc_options o = {.width = 1280, .height = 720, .fov = 75 * DEGREE};
    bool only_files = false;
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i];
        if (!only_files && strcmp(argument, "--") == 0) {
            only_files = true;
            continue;
        }
        if (only_files || argument[0] != '-' || !argument[1]) {
            if (o.terrain)
                return tc_fail(error, TC_ERR_USAGE, "TERRAIN: expected one file, found also '%s'", argument);
            o.terrain = argument;
            continue;
        }
        const char *value;
        const struct option *option = find_option(argument, &value);
        if (!option)
            return tc_fail(error, TC_ERR_USAGE, "%s: no such option; --help lists them", argument);
        if (!option->argument) {
            if (value)
                return tc_fail(error, TC_ERR_USAGE, "--%s: expected no value, found '%s'", option->name, value);
            if (option->offset) {
                *(bool *)((char *)&o + option->offset) = true;
                continue;
            }
            *options_ret = (tc_options){.action = option->letter == 'h' ? TC_SHOW_HELP : TC_SHOW_VERSION};
            return TC_OK;
        }
        if (!value && ++i < argc)
            value = argv[i];
        if (!value)
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected %s, found nothing", option->name, option->expected);
        if (!option->set(&o, value))
            return tc_fail(error, TC_ERR_USAGE, "--%s: expected %s, found '%s'", option->name, option->expected, value);
    }
    tc_status status = check_together(&o, error);
    if (status == TC_OK)
        *options_ret = o;
    return status;
}

/* ---- Help --------------------------------------------------------------------------------------------------- */

/* Prints text from column `column` on, broken between words before column 100. The cursor is at `at`. */
static void print_wrapped(FILE *file, const char *text, int at, int column)
{
    enum { LINE_END = 100 };
    if (at > column - 2) {
        fputc('\n', file);
        at = 0;
    }
    fprintf(file, "%*s", column - at, "");
    at = column;
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (at > column && at + 1 + length > LINE_END) {
            fprintf(file, "\n%*s", column, "");
            at = column;
        } else if (at > column) {
            fputc(' ', file);
            at++;
        }
        fprintf(file, "%.*s", length, text);
        at += length;
        text += length;
        text += *text == ' ';
    }
    fputc('\n', file);
}

void tc_options_print_help(const tc_options_program *program, FILE *file)
{
    fprintf(file, "usage: %s [OPTION]... TERRAIN\n\n%s\n", program->name, program->summary);
    for (int i = 0; i < OPTIONS; i++) {
        const struct option *option = &table[i];
        if (!option->name) {
            fprintf(file, "\n%s:\n", option->help);
            continue;
        }
        int at = option->letter ? fprintf(file, "  -%c, --%s", option->letter, option->name)
                                : fprintf(file, "      --%s", option->name);
        if (option->argument)
            at += fprintf(file, " %s", option->argument);
        print_wrapped(file, option->help, at, 30);
    }
}

/* ---- Names of frames ---------------------------------------------------------------------------------------- */

/* The place of the one number, its digits and what follows it. */
static bool split_pattern(const char *pattern, int *prefix_ret, int *digits_ret, const char **suffix_ret)
{
    const char *percent = strchr(pattern, '%');
    if (!percent)
        return false;
    const char *at = percent + 1;
    *digits_ret = 1;
    if (at[0] == '0' && at[1] >= '1' && at[1] <= '9') {
        *digits_ret = at[1] - '0';
        at += 2;
    }
    if (*at != 'd' || strchr(at, '%'))
        return false;
    *prefix_ret = (int)(percent - pattern);
    *suffix_ret = at + 1;
    return true;
}

bool tc_frame_pattern_valid(const char *pattern)
{
    int prefix, digits;
    const char *suffix;
    return split_pattern(pattern, &prefix, &digits, &suffix);
}

bool tc_frame_pattern_name(const char *pattern, int frame, char *name, size_t capacity)
{
    int prefix, digits;
    const char *suffix;
    if (!split_pattern(pattern, &prefix, &digits, &suffix))
        return false;
    int length = snprintf(name, capacity, "%.*s%0*d%s", prefix, pattern, digits, frame, suffix);
    return length >= 0 && (size_t)length < capacity;
}
