/* options.c - the viewers' command line; see options.h. A new option is one line of the table and, where its kind is
 * new, one setter. */
#include "options.h"
#include "video.h"
#include "common/base/status.h"
#include "common/render/surface.h"
#include "common/base/numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)

/* ---- Setters ------------------------------------------------------------------------------------------------ */

static bool set_view(void *options, const char *value)
{
    tc_options *o = options;
    o->view_name = value[0] == '@' && value[1] ? value + 1 : NULL;
    if (o->view_name)
        return o->has_view = true;
    return o->has_view = tc_pose_parse(o->program->navigation, value, &o->view);
}

static bool read_look(void *look, const char *value)
{
    tc_look *l = look;
    double v[3] = {0};
    int count = 0;
    for (; count < 3 && (count == 0 || *value == ','); count++) {
        value += count > 0;
        if (!tc_take_number(&value, &v[count]))
            return false;
    }
    if (*value || count < 2)
        return false;
    l->longitude = v[0], l->latitude = v[1], l->height = v[2], l->has_height = count == 3;
    return l->given = fabs(v[0]) <= 360 && fabs(v[1]) <= 90 && fabs(v[2]) <= 1e9;
}

static bool read_distance(void *metres, const char *value)
{
    double m;
    if (!tc_read_number(value, 0, TC_POSE_LIMIT, &m) || m <= 0)
        return false;
    *(double *)metres = m;
    return true;
}

static bool read_heading(void *look, const char *value)
{
    tc_look *l = look;
    if (!tc_read_number(value, -360, 360, &l->heading))
        return false;
    l->heading *= DEGREE;
    return l->has_heading = true;
}

static bool read_pitch(void *look, const char *value)
{
    tc_look *l = look;
    if (!tc_read_number(value, -90, 90, &l->pitch))
        return false;
    l->pitch *= DEGREE;
    return l->has_pitch = true;
}

static bool set_size(void *options, const char *value)
{
    tc_options *o = options;
    char text[32];
    const char *x = strchr(value, 'x');
    if (!x || (size_t)(x - value) >= sizeof text)
        return false;
    snprintf(text, sizeof text, "%.*s", (int)(x - value), value);
    return tc_read_int(text, 1, 16384, &o->width) && tc_read_int(x + 1, 1, 16384, &o->height);
}

static bool read_fov(void *fov, const char *value)
{
    double degrees;
    if (!tc_read_number(value, 1, 170, &degrees))
        return false;
    *(double *)fov = degrees * DEGREE;
    return true;
}

static bool read_background(void *scene, const char *value)
{
    tc_scene_options *s = scene;
    if (strlen(value) != 6 || strspn(value, "0123456789abcdefABCDEF") != 6)
        return false;
    unsigned long rgb = strtoul(value, NULL, 16);
    for (int i = 0; i < 3; i++)
        s->background[i] = (uint8_t)(rgb >> (16 - 8 * i));
    return s->background_set = true;
}

static bool read_shade(void *shade, const char *value)
{
    const tc_shade *named = tc_shade_named(value);
    if (named)
        *(const tc_shade **)shade = named;
    return named != NULL;
}

static bool read_contours(void *metres, const char *value)
{
    return tc_read_number(value, 1e-3, 1e6, metres);
}

static bool read_target(void *target_ms, const char *value)
{
    double ms;
    if (!tc_read_number(value, 0, 1e6, &ms) || ms <= 0)
        return false;
    *(double *)target_ms = ms;
    return true;
}

static bool read_error(void *pixels, const char *value)
{
    return tc_read_number(value, 0, 1000, pixels);
}

static bool read_exaggeration(void *factor, const char *value)
{
    return tc_read_number(value, TC_LEAST_EXAGGERATION, TC_MOST_EXAGGERATION, factor);
}

static bool read_sun(void *sun, const char *value)
{
    double azimuth, elevation;
    if (!tc_take_number(&value, &azimuth) || *value++ != ',' || !tc_take_number(&value, &elevation) || *value ||
        !(fabs(azimuth) <= 360 && fabs(elevation) <= 90))
        return false;
    *(tc_sun *)sun = (tc_sun){.kind = TC_SUN_LOCAL,
                              .azimuth = (azimuth < 0 ? azimuth + 360 : azimuth) * M_PI / 180,
                              .elevation = elevation * M_PI / 180};
    return true;
}

static bool read_sea(void *sea, const char *value)
{
    tc_sea s = {.kind = TC_SEA_GIVEN};
    if (strcmp(value, "none") == 0)
        s.kind = TC_SEA_NONE;
    else if (!tc_read_number(value, -1e9, 1e9, &s.level))
        return false;
    *(tc_sea *)sea = s;
    return true;
}

static bool set_date(void *options, const char *value)
{
    tc_options *o = options;
    o->date = value;
    return tc_sun_read_date(value, &o->julian);
}

bool tc_read_scheme(void *options, const char *value)
{
    tc_options *o = options;
    o->scheme = tc_scheme_named(o->program->schemes, NULL, value);
    return o->scheme;
}

static bool read_samples(void *samples, const char *value)
{
    return tc_read_int(value, 1, 16, samples);
}

static bool add_imagery(void *options, const char *value)
{
    tc_options *o = options;
    if (!*value || o->imagery_count == TC_MOST_IMAGERY)
        return false;
    o->imagery[o->imagery_count++] = value;
    return true;
}

bool tc_read_levels(void *levels, const char *value)
{
    return tc_read_int(value, 1, TC_MAX_LEVELS, levels);
}

bool tc_read_budget(void *budget, const char *value)
{
    return tc_read_integer(value, 1, (int64_t)1 << 40, budget);
}

static bool read_rate(void *rate, const char *value)
{
    return tc_read_int(value, 1, 240, rate);
}

static bool read_frames(void *frames, const char *value)
{
    return tc_read_int(value, 1, 1000000, frames);
}

static bool read_backend(void *backend, const char *value)
{
    static const char *const names[] = {"auto", "window", "egl", "osmesa"}; /* as tc_backend */
    for (int i = 0; i < 4; i++)
        if (strcmp(value, names[i]) == 0) {
            *(tc_backend *)backend = (tc_backend)i;
            return true;
        }
    return false;
}

/* ---- The table ---------------------------------------------------------------------------------------------- */

/* A view's texts are the navigation's. The program's own options follow. */
static const tc_option table[] = {
    {.help = "What is seen"},
    {0, "view", NULL, NULL, NULL, set_view, 0},
    {0, "views", "FILE", "a file name",
     "of views, one a line as --view has it, with a name behind a #: --view @NAME is one of them, and V in the window "
     "adds the present one",
     tc_read_text, offsetof(tc_options, views)},
    {0, "lookat", "LON,LAT[,HEIGHT]",
     "LON,LAT[,HEIGHT] in degrees and metres, |LON| up to 360, |LAT| up to 90, |HEIGHT| up to 1e9",
     "place to look at, of any map that says where it lies: degrees east and north, metres above the sea (on the "
     "ground)",
     read_look, offsetof(tc_options, look)},
    {0, "distance", "M", "metres above 0, up to 1e12", "from the eye to that place (some km, or a share of the map)",
     read_distance, offsetof(tc_options, look.distance)},
    {0, "heading", "DEG", "-360..360 degrees",
     "in which the eye looks at it, clockwise from north, of a flat map up its columns (0)", read_heading,
     offsetof(tc_options, look)},
    {0, "pitch", "DEG", "-90..90 degrees", "upwards (-30)", read_pitch, offsetof(tc_options, look)},
    {0, "fov", "DEG", "1..170 degrees", "horizontal field of view (75)", read_fov, offsetof(tc_options, fov)},
    {0, "size", "WxH", "WxH of 1..16384", "of the picture or window, pixels (1280x720)", set_size, 0},
    {0, "colours", "FILE", "a file name", "of heights, as `gdaldem color-relief` reads them: HEIGHT RED GREEN BLUE",
     tc_read_text, offsetof(tc_options, colours)},
    {0, "imagery", "FILE", "a file name, at most 64 times",
     "colours from a picture: where its georeference says, else over all of the terrain or the globe; again: over that",
     add_imagery, 0},
    {0, "synthesis", "LEVELS", TC_EXPECTED_SYNTHESIS, TC_SYNTHESIS_HELP, tc_read_synthesis,
     offsetof(tc_options, synthesis)},
    {0, "exaggeration", "FACTOR", TC_EXPECTED_EXAGGERATION,
     "of heights over the sea; colours and contours tell true ones (1)", read_exaggeration,
     offsetof(tc_options, exaggeration)},
    {0, "sea", "Z", "metres of -1e9..1e9, or none",
     "height of the sea: its surface is drawn over all ground below it, opaque, over colours and pictures, and also "
     "around a terrain or a part of a globe that ends; colours of dry ground are those of land, below 0 the lowest "
     "one. none: no sea at all. Without it what lies below 0 has colours of depths, and a terrain whose edge lies at 0 "
     "has a sea around it",
     read_sea, offsetof(tc_options, sea)},
    {0, "shade", "NAME", TC_SHADE_NAMES,
     "what colours say: natural, or as maps do slope, aspect (of the fall), height (as a hillshade) or none (heights "
     "without light) (natural)",
     read_shade, offsetof(tc_options, scene.shade)},
    {0, "contours", "METRES", "metres of 0.001..1e6", "between lines of equal height, every fifth heavier (none)",
     read_contours, offsetof(tc_options, scene.contours)},
    TC_SWITCH(tc_options, scene.unlit, 0, "unlit", "colours without light"),
    {0, "sun", "AZIMUTH,ELEVATION", "AZIMUTH,ELEVATION in degrees, |AZIMUTH| up to 360, |ELEVATION| up to 90",
     "of the light of natural colours, clockwise from north and above the horizon; on a globe as from the ground below "
     "the eye, which it follows. A hillshade keeps its own (310,38)",
     read_sun, offsetof(tc_options, scene.sun)},
    {0, "date", "YYYY-MM-DDTHH:MMZ", "YYYY-MM-DDTHH:MMZ, a minute of UTC of the years 1901 to 2099",
     "instead: the sun where it stands over the Earth then, of a flat map that says where it lies as from its middle",
     set_date, 0},
    {0, "background", "RRGGBB", "six hexadecimal digits RRGGBB", "flat background: no sky, no haze", read_background,
     offsetof(tc_options, scene)},
    TC_SWITCH(tc_options, alone, 0, "no-surroundings",
              "the map alone: no walls and no sea around a flat terrain, with --sea one within it; no land around a "
              "part of a globe, no stars"),
    TC_SWITCH(tc_options, scene.wireframe, 0, "wireframe", "lines instead of faces"),
    TC_SWITCH(tc_options, scene.level_colours, 0, "level-colours", "a colour for each level of detail"),
    TC_SWITCH(tc_options, scene.frame.no_morph, 0, "no-morph", "levels meet abruptly"),
    {0, "samples", "N", "1..16", "a pixel, for smooth edges (4; measured flights 1)", read_samples,
     offsetof(tc_options, scene.samples)},
    {0, "error", "PX", "0..1000 pixels",
     "that what is drawn may be off the data, which chooses its blocks; 0: by distance alone (0)", read_error,
     offsetof(tc_options, scene.frame.error)},
    {0, "target-ms", "MS", "more than 0 ms",
     "milliseconds a frame may take; less detail is drawn while it would take longer (as long as it takes)",
     read_target, offsetof(tc_options, target_ms)},
    {.help = "Where it goes"},
    {'o', "output", "FILE.png", "a file name", "write one frame and open no window", tc_read_text,
     offsetof(tc_options, output)},
    {0, "path", "FILE", "a file name",
     "fly through the views of FILE, one a line as --view has it; with -o frame-%05d.png write each frame, "
     "without only measure",
     tc_read_text, offsetof(tc_options, path)},
    {0, "video", "FILE", "a file name", "make a film of the flight, .mp4 or .webm; beside frames or alone",
     tc_read_text, offsetof(tc_options, video)},
    {0, "rate", "N", "1..240", "frames a second of the film (30)", read_rate, offsetof(tc_options, rate)},
    {0, "frames", "N", "1..1000000", "frames of the flight; in a window without --path: close after N", read_frames,
     offsetof(tc_options, frames)},
    {0, "backend", "NAME", "auto, window, egl or osmesa", "auto, window, egl or osmesa (auto)", read_backend,
     offsetof(tc_options, backend)},
    {.help = "How the file is read"},
    TC_READING_ROWS(tc_options, source),
    {0, "voids", "POLICY", TC_EXPECTED_VOIDS, "where there is no height: fill, hole or constant=V (fill)",
     tc_read_voids, offsetof(tc_options, source)},
    {0, "threads", "N", TC_EXPECTED_THREADS, "that prepare the terrain (all processors)", tc_read_threads,
     offsetof(tc_options, threads)},
};
static const tc_option last_rows[] = {
    {.help = "What is told"},
    {0, "stats", "FILE.json", "a file name", "write times, counts and memory", tc_read_text,
     offsetof(tc_options, stats)},
    TC_SWITCH(tc_options, json, 0, "json", "print the same to standard output"),
    TC_SWITCH(tc_options, explain, 0, "explain",
              "print what the scene uses, and what it does not need and was left out"),
    TC_SWITCH(tc_options, no_display, 0, "no-display", "no texts, compass and settings in the window"),
    TC_SWITCH(tc_options, quiet, 'q', "quiet", "neither warnings nor progress"),
    TC_SWITCH(tc_options, verbose, 'v', "verbose", "how the file was understood, what it is drawn with"),
    TC_HELP_AND_VERSION,
};

static tc_status set_terrain(void *options, const char *operand, tc_error *error)
{
    tc_options *o = options;
    if (o->terrain)
        return tc_fail(error, TC_ERR_USAGE, "TERRAIN: expected one file, found also '%s'", operand);
    o->terrain = operand;
    return TC_OK;
}

/* The rows of a program. */
enum { ROWS = sizeof table / sizeof *table, LAST_ROWS = sizeof last_rows / sizeof *last_rows };
typedef struct rows {
    tc_option row[ROWS + TC_PROGRAM_OPTIONS + LAST_ROWS];
    char schemes[128], schemes_help[512];
    tc_command_line line;
} rows;

/* "a, b or c", and what each is. */
static void name_schemes(const tc_viewer_program *program, rows *r)
{
    size_t names = 0, help = 0;
    const tc_scheme *scheme, *next = tc_scheme_at(program->schemes, NULL, 0);
    for (int i = 0; (scheme = next); i++) {
        next = tc_scheme_at(program->schemes, NULL, i + 1);
        const char *before = i == 0 ? "" : next ? ", " : " or ";
        names += (size_t)snprintf(r->schemes + names, sizeof r->schemes - names, "%s%s", before, scheme->name);
        before = i == 0 ? "" : next ? ", " : ", or ";
        help += (size_t)snprintf(r->schemes_help + help, sizeof r->schemes_help - help, "%s%s%s%s", before,
                                 scheme->name, scheme->help ? ": " : "", scheme->help ? scheme->help : "");
    }
    snprintf(r->schemes_help + help, sizeof r->schemes_help - help, " (%s)",
             tc_scheme_at(program->schemes, NULL, 0)->name);
}

static void make_rows(const tc_viewer_program *program, rows *r)
{
    int own = program->option_count, count = ROWS + own + LAST_ROWS;
    memcpy(r->row, table, sizeof table);
    for (int i = 0; i < own; i++)
        r->row[ROWS + i] = program->options[i];
    memcpy(r->row + ROWS + own, last_rows, sizeof last_rows);
    for (int i = 0; i < count; i++) {
        tc_option *row = &r->row[i];
        if (row->set == set_view) {
            row->argument = program->navigation->form;
            row->expected = program->navigation->bounds;
            row->help = program->navigation->help;
        } else if (row->set == tc_read_scheme) {
            name_schemes(program, r);
            row->expected = r->schemes;
            row->help = r->schemes_help;
        }
    }
    r->line = (tc_command_line){.options = r->row, .count = count, .help = "--help", .operand = set_terrain};
}

/* ---- Parsing ------------------------------------------------------------------------------------------------ */

static tc_status check_look(const tc_options *o, tc_error *error)
{
    const tc_look *l = &o->look;
    const char *alone = l->distance > 0 ? "distance" : l->has_heading ? "heading" : l->has_pitch ? "pitch" : NULL;
    if (l->given && (o->has_view || o->path))
        return tc_fail(error, TC_ERR_USAGE, "--lookat: expected either it or --%s, found both",
                       o->has_view ? "view" : "path");
    if (!l->given && alone)
        return tc_fail(error, TC_ERR_USAGE, "--%s: expected --lookat LON,LAT with it, found none", alone);
    return TC_OK;
}

/* What only shows once all options are there. */
static tc_status check_together(const tc_options *o, tc_error *error)
{
    bool offscreen = o->backend == TC_BACKEND_EGL || o->backend == TC_BACKEND_OSMESA;
    const bool window = !o->output && !o->path && !o->video && !offscreen && tc_display_there();
    if (!o->terrain && !window)
        return tc_fail(error, TC_ERR_USAGE, "TERRAIN: expected a file, found none; --help tells more");
    if (o->path && !o->frames)
        return tc_fail(error, TC_ERR_USAGE, "--path: expected --frames N with it, found none");
    if (o->path && o->output && !tc_frame_pattern_valid(o->output))
        return tc_fail(error, TC_ERR_USAGE, "--output: expected one number such as %%05d for the frames, found '%s'",
                       o->output);
    if (o->video && !o->path)
        return tc_fail(error, TC_ERR_USAGE, "--video: expected --path FILE with it, found none");
    if (o->rate && !o->video)
        return tc_fail(error, TC_ERR_USAGE, "--rate: expected --video FILE with it, found none");
    if (o->video && o->backend == TC_BACKEND_WINDOW)
        return tc_fail(error, TC_ERR_USAGE, "--video: expected --backend egl or osmesa with it, found window");
    if (o->video && tc_video_check_name(o->video, error) != TC_OK)
        return TC_ERR_USAGE;
    if (o->frames && !o->path && (o->output || offscreen))
        return tc_fail(error, TC_ERR_USAGE, "--frames: expected --path FILE with it, found none");
    if (offscreen && !o->output && !o->path)
        return tc_fail(error, TC_ERR_USAGE, "--backend: expected -o FILE or --path FILE with it, found neither");
    if (o->scene.unlit && o->scene.shade && o->scene.shade->lit)
        return tc_fail(
            error, TC_ERR_USAGE,
            "--unlit: expected no --shade %s with it, whose light it takes, found both; --shade none has no light",
            o->scene.shade->name);
    const char *sun = o->date ? "date" : o->scene.sun.kind != TC_SUN_USUAL ? "sun" : NULL;
    if (o->date && o->scene.sun.kind != TC_SUN_USUAL)
        return tc_fail(error, TC_ERR_USAGE, "--date: expected either it or --sun, found both");
    if (sun && o->scene.unlit)
        return tc_fail(error, TC_ERR_USAGE, "--%s: expected no --unlit with it, which has no light, found both", sun);
    if (sun && o->scene.shade && !o->scene.shade->natural)
        return tc_fail(error, TC_ERR_USAGE,
                       "--%s: expected natural colours, whose light it is, found --shade %s, which has none or its own",
                       sun, o->scene.shade->name);
    if (o->target_ms > 0 && o->output && !o->path)
        return tc_fail(
            error, TC_ERR_USAGE,
            "--target-ms: expected a window or --path FILE with it, found one picture, which takes its time");
    if (o->scene.frame.error > 0 && o->scheme && !o->scheme->by_error)
        return tc_fail(error, TC_ERR_USAGE,
                       "--error: expected a scheme that chooses blocks by it, as %s does, found %s",
                       tc_scheme_by_error(o->program->schemes)->name, o->scheme->name);
    if (o->path && o->has_view)
        return tc_fail(error, TC_ERR_USAGE, "--view: expected either it or --path, found both");
    if (o->view_name && !o->views)
        return tc_fail(error, TC_ERR_USAGE, "--view: expected --views FILE with @%s, found none", o->view_name);
    return check_look(o, error);
}

tc_status tc_options_parse(const tc_viewer_program *program, int argc, char **argv, tc_options *options_ret,
                           tc_error *error)
{
    tc_options o = {.width = 1280,
                    .height = 720,
                    .fov = 75 * DEGREE,
                    .exaggeration = 1,
                    .look = {.pitch = -30 * DEGREE},
                    .program = program};
    tc_action action = TC_RUN;
    rows r;
    make_rows(program, &r);
    tc_status status = tc_arguments_read(&r.line, argc, argv, &o, &action, error);
    if (status == TC_OK && action != TC_RUN)
        o = (tc_options){.action = action};
    else if (status == TC_OK)
        status = check_together(&o, error);
    if (o.scene.frame.error > 0 && !o.scheme)
        o.scheme = tc_scheme_by_error(program->schemes), o.scheme_implied = true;
    if (status == TC_OK)
        *options_ret = o;
    return status;
}

void tc_options_print_help(const tc_viewer_program *program, FILE *file)
{
    fprintf(file, "usage: %s [OPTION]... [TERRAIN]\n\n%s Without a file a window shows a default one, made once.\n",
            program->name, program->summary);
    rows r;
    make_rows(program, &r);
    tc_arguments_print(&r.line, file);
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
