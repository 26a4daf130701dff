/* info.c - `terraclip info`: what a packed terrain holds, from its header alone. */
#include "info.h"

#include "common/base/status.h"
#include "common/packed/file/packed_file.h"
#include "common/field/field.h"
#include "common/app/arguments.h"
#include "common/app/credits.h"
#include "common/app/json.h"
#include "common/app/load.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

struct arguments {
    const char *file;
    bool json, quiet, verbose;
};

/* ---- Command line ----------------------------------------------------------------------------------------------- */

static const tc_option table[] = {
    TC_SWITCH(struct arguments, json, 0, "json", "print the same as JSON"),
    TC_SWITCH(struct arguments, quiet, 'q', "quiet", "no warnings"),
    TC_SWITCH(struct arguments, verbose, 'v', "verbose", "also the coordinate system in full"),
    TC_HELP_AND_VERSION,
};

static const tc_command_line line = {.options = table,
                                     .count = sizeof table / sizeof *table,
                                     .help = "'terraclip info --help'",
                                     .operand = tc_take_file,
                                     .offset = offsetof(struct arguments, file)};

void tc_info_help(FILE *file)
{
    fprintf(file, "Usage: terraclip info [OPTION]... FILE.tclip\n"
                  "Shows what a packed terrain holds. Of a file that was cut short it shows what is left, with a\n"
                  "warning.\n\n");
    tc_arguments_print(&line, file);
}

/* ---- Telling ---------------------------------------------------------------------------------------------------- */

static const char *const mode_names[] = {"rms", "max-error", "lossless"};       /* as tc_pack_mode */
static const char *const codec_names[] = {"lifting", "lh04"};                   /* as tc_pack_codec */
static const char *const policy_names[] = {"fill", "hole", "constant"};         /* as tc_void_policy */
static const char *const type_names[] = {"uint8",  "int8",  "uint16",  "int16", /* as tc_sample_type */
                                         "uint32", "int32", "float32", "float64"};

/* All that is told. */
typedef struct facts {
    const tc_map *map;
    const tc_field *field; /* of its first chart */
    const tc_packed_info *packed;
    const tc_terrain_info *info;
    tc_packed_level finest;
    int faces;     /* of an atlas; 0: none */
    double bits;   /* a sample */
    char crs[128]; /* name of the coordinate system; empty none */
    const tc_credits *credits;
} facts;

/* The name is the first string of the text. */
static void name_crs(const char *wkt, char *name, size_t capacity)
{
    const char *start = wkt ? strchr(wkt, '"') : NULL;
    int length = start ? (int)strcspn(start + 1, "\"") : 0;
    snprintf(name, capacity, "%.*s", length, start ? start + 1 : "");
}

static facts gather(const tc_map *map, const tc_credits *credits)
{
    const tc_field *field = tc_map_field(map, 0);
    facts f = {.map = map,
               .field = field,
               .packed = tc_field_packed_info(field),
               .info = tc_field_info(field),
               .credits = credits};
    const tc_pack_terrain *t = &f.packed->terrain;
    f.finest = tc_field_packed_level(field, f.info->levels);
    f.faces = map->chart[0].class->seam ? map->charts : 0;
    f.bits = 8 * (double)f.packed->bytes / ((double)t->width * (double)t->height * fmax(f.faces, 1));
    name_crs(t->georef.crs_wkt, f.crs, sizeof f.crs);
    return f;
}

static void print_key(const char *name, double value)
{
    printf("  \"%s\": ", name);
    tc_json_number(value, stdout);
    printf(",\n");
}

static bool is_planet(const facts *f)
{
    return tc_map_radius(f->map) > 0;
}

static void print_planet_json(const facts *f)
{
    print_key("radius_m", f->packed->terrain.radius);
    print_key("flattening", f->packed->terrain.flattening);
    printf("  \"charts\": [");
    for (int c = 0; c < f->map->charts; c++) {
        const tc_field *chart = f->map->chart[c].field;
        const tc_pack_terrain *t = &tc_field_packed_info(chart)->terrain;
        int levels = tc_field_info(chart)->levels;
        printf("%s\n    {\"chart\": \"%s\", \"width\": %" PRId64 ", \"height\": %" PRId64 ", \"bytes\": %" PRId64
               ", \"levels\": %d, \"levels_missing\": %d, \"rms_m\": ",
               c ? "," : "", f->map->chart[c].class->name, t->width, t->height, tc_packed_chart_bytes(chart), levels,
               tc_field_packed_info(chart)->levels_missing);
        tc_json_number(tc_field_packed_level(chart, levels).rms, stdout);
        printf("}");
    }
    printf("\n  ],\n");
    if (f->faces) {
        const tc_face_source *s = &tc_field_container(f->field)->source;
        printf("  \"source_width\": %" PRId64 ",\n  \"source_height\": %" PRId64 ",\n", s->width, s->height);
        print_key("resampling_rms_m", s->rms);
        print_key("resampling_max_error_m", s->max);
    }
}

static void print_json(const facts *f)
{
    const tc_pack_terrain *t = &f->packed->terrain;
    printf("{\n  \"version\": %d,\n  \"atlas\": \"%s\",\n", f->packed->version, f->map->chart[0].class->name);
    if (is_planet(f))
        print_planet_json(f);
    printf("  \"levels\": [\n");
    for (int l = 1; l <= f->info->levels; l++) {
        const tc_level level = tc_field_level(f->field, l);
        const tc_packed_level packed = tc_field_packed_level(f->field, l);
        printf("    {\"level\": %d, \"width\": %" PRId64 ", \"height\": %" PRId64 ", \"spacing_m\": ", l, level.width,
               level.height);
        tc_json_number(0.5 * (level.spacing_x + level.spacing_y), stdout);
        printf(", \"bytes\": %" PRId64 ", \"rms_m\": ", packed.bytes);
        tc_json_number(packed.rms, stdout);
        printf(", \"max_error_m\": ");
        tc_json_number(packed.max_error, stdout);
        printf("}%s\n", l < f->info->levels ? "," : "");
    }
    printf("  ],\n  \"bytes\": %" PRId64 ",\n", f->packed->bytes);
    print_key("bits_per_sample", f->bits);
    print_key("rms_m", f->finest.rms);
    print_key("max_error_m", f->finest.max_error);
    print_key("z_min_m", f->info->z_base + f->info->z_min);
    print_key("z_max_m", f->info->z_base + f->info->z_max);
    printf("  \"voids\": %" PRId64 ",\n", f->info->void_count);
    printf("  \"levels_missing\": %d,\n", f->packed->levels_missing);
    printf("  \"width\": %" PRId64 ",\n  \"height\": %" PRId64 ",\n", t->width, t->height);
    print_key("spacing_x_m", t->spacing_x);
    print_key("spacing_y_m", t->spacing_y);
    print_key("z_mean_m", f->packed->mean);
    print_key("z_deviation_m", f->packed->deviation);
    printf("  \"mode\": \"%s\",\n  \"codec\": \"%s\",\n", mode_names[f->packed->mode], codec_names[f->packed->codec]);
    print_key("error_asked_m", f->packed->error);
    printf("  \"void_policy\": \"%s\",\n  \"sample_type\": \"%s\",\n", policy_names[t->voids],
           type_names[t->sample_type]);
    print_key("unit_m", t->unit);
    printf("  \"nodata\": ");
    tc_json_number(t->has_nodata ? t->nodata : NAN, stdout);
    printf(",\n  \"synthesis_fit\": %s,\n  \"transform\": ", f->packed->synthesis_fit ? "true" : "false");
    const tc_georef *g = &f->map->georef;
    for (int i = 0; i < 6 && g->known; i++)
        printf("%s%.17g%s", i ? ", " : "[", g->transform[i], i == 5 ? "]" : "");
    printf("%s,\n  \"geographic\": %s,\n  \"registration\": \"%s\",\n  \"crs\": ", g->known ? "" : "null",
           g->geographic ? "true" : "false", t->area_registered ? "area" : "point");
    if (*f->crs)
        tc_json_string(f->crs, stdout);
    else
        printf("null");
    printf(",\n  \"credits\": [");
    for (int i = 0; i < f->credits->count; i++) {
        printf("%s", i ? ", " : "");
        tc_json_string(f->credits->line[i], stdout);
    }
    printf("]\n}\n");
}

/* A size for people. */
static void print_bytes(int64_t bytes)
{
    static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    int unit = 0;
    double size = (double)bytes;
    for (; size >= 1024 && unit < 4; unit++)
        size /= 1024;
    printf(unit ? "%.1f %s" : "%.0f %s", size, units[unit]);
}

static void print_place(const facts *f)
{
    const tc_pack_terrain *t = &f->packed->terrain;
    const double *g = f->map->georef.transform;
    if (!f->map->georef.known) {
        printf("  place          no georeference\n");
        return;
    }
    /* Of areas to their edges, of points to the outermost ones: where `height` answers. */
    double first = t->area_registered ? 0 : 0.5, w = (double)f->map->width - first, h = (double)f->map->height - first;
    printf("  place          %s %.10g to %.10g, %s %.10g to %.10g, %s-registered\n",
           f->map->georef.geographic ? "longitude" : "x", g[0] + first * (g[1] + g[2]), g[0] + w * g[1] + h * g[2],
           f->map->georef.geographic ? "latitude" : "y", g[3] + w * g[4] + h * g[5], g[3] + first * (g[4] + g[5]),
           t->area_registered ? "area" : "point");
    printf("  coordinates    %s\n", *f->crs ? f->crs : "not named");
}

static void print_planet(const facts *f)
{
    char about[64] = "";
    f->map->body.class->describe(&f->map->body, about, sizeof about);
    printf("  planet         %s, %s\n", about, f->packed->terrain.wraps_x || f->faces ? "once around" : "a part of it");
    if (f->faces) {
        const tc_face_source *s = &tc_field_container(f->field)->source;
        printf("  resampled      from %" PRId64 " x %" PRId64 " samples, which are rms %.4g m, at most %.4g m off it\n",
               s->width, s->height, s->rms, s->max);
    }
    for (int c = 1; c < f->map->charts; c++) {
        const tc_field *chart = f->map->chart[c].field;
        const tc_pack_terrain *t = &tc_field_packed_info(chart)->terrain;
        if (f->faces)
            printf("  %-4s %d         %" PRId64 " x %" PRId64 " samples, ", f->map->chart[c].class->name, c, t->width,
                   t->height);
        else
            printf("  %s      %" PRId64 " x %" PRId64 " samples, ", f->map->chart[c].class->name, t->width, t->height);
        print_bytes(tc_packed_chart_bytes(chart));
        printf(", rms %.4g m\n", tc_field_packed_level(chart, tc_field_info(chart)->levels).rms);
    }
}

static void print_table(const facts *f, const char *path)
{
    const tc_pack_terrain *t = &f->packed->terrain;
    printf("%s: packed terrain, format version %d, ", path, f->packed->version);
    print_bytes(f->packed->bytes);
    struct stat file;
    if (f->packed->cut_short && stat(path, &file) == 0) {
        printf(" of which ");
        print_bytes(file.st_size);
        printf(" are there");
    }
    printf(", %.3f bits a sample\n", f->bits);
    printf("  size           %" PRId64 " x %" PRId64 " samples every %.6g x %.6g m", t->width, t->height, t->spacing_x,
           t->spacing_y);
    if (f->faces)
        printf(", on each of %d faces (%s)", f->faces, f->map->chart[0].class->name);
    printf("\n");
    print_place(f);
    if (is_planet(f))
        print_planet(f);
    printf("  heights        %.2f to %.2f m, mean %.2f m, deviation %.2f m%s\n", f->info->z_base + f->info->z_min,
           f->info->z_base + f->info->z_max, f->packed->mean, f->packed->deviation,
           f->packed->mode == TC_PACK_LOSSLESS ? "" : ", of the source");
    printf("  voids          %" PRId64 ", shown as %s", f->info->void_count, policy_names[t->voids]);
    if (t->voids == TC_VOIDS_CONSTANT)
        printf(" %.6g m", t->void_constant);
    printf("\n  packed         %s by %s", mode_names[f->packed->mode], codec_names[f->packed->codec]);
    if (f->packed->mode != TC_PACK_LOSSLESS)
        printf(", %.4g m asked for", f->packed->error);
    if (f->packed->mode == TC_PACK_RMS && f->finest.bound > 0)
        printf(", corrected beyond %.4g m", f->finest.bound);
    printf("; rms %.4g m, at most %.4g m off\n  source         %s, %.6g m a unit", f->finest.rms, f->finest.max_error,
           type_names[t->sample_type], t->unit);
    if (t->has_nodata)
        printf(", nodata %.10g", t->nodata);
    if (f->packed->synthesis_fit)
        printf("\n  synthesis      by a fit to the heights as they were given");
    for (int i = 0; i < f->credits->count; i++)
        printf("\n  credit         %s", f->credits->line[i]);
    printf("\n\n  level      width x height       spacing m          bytes     rms m   max m\n");
    for (int l = f->info->levels; l >= 1; l--) {
        const tc_level level = tc_field_level(f->field, l);
        const tc_packed_level packed = tc_field_packed_level(f->field, l);
        if (packed.bytes == 0 && l < f->info->levels) {
            printf("  %5d and coarser: made from level %d\n", l, l + 1);
            break;
        }
        printf("  %5d %10" PRId64 " x %-10" PRId64 " %12.6g %14" PRId64 " %9.3g %7.3g\n", l, level.width, level.height,
               0.5 * (level.spacing_x + level.spacing_y), packed.bytes, packed.rms, packed.max_error);
    }
}

static void say(void *context, bool warning, const char *text)
{
    const struct arguments *a = context;
    if (warning && !a->quiet)
        fprintf(stderr, "terraclip: warning: %s\n", text);
}

tc_status tc_info_main(int argc, char **argv, tc_error *error)
{
    struct arguments a = {0};
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &a, &action, error);
    if (status == TC_OK && !a.file)
        status = tc_fail(error, TC_ERR_USAGE, "FILE: expected a packed terrain, found none");
    if (status != TC_OK)
        return status;
    tc_credits credits = {.count = 0};
    const tc_source_options source = {
        .say = say, .say_context = &a, .credit = tc_credits_take, .credit_context = &credits};
    tc_map *map;
    status = tc_map_load_packed(a.file, &source, &(tc_load_options){0}, &map, error);
    if (status != TC_OK)
        return status;
    const facts f = gather(map, &credits);
    if (a.json)
        print_json(&f);
    else
        print_table(&f, a.file);
    if (!a.json && a.verbose && f.packed->terrain.georef.crs_wkt)
        printf("\n%s\n", f.packed->terrain.georef.crs_wkt);
    tc_map_destroy(map);
    return TC_OK;
}
