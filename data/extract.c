/* extract.c - `terraclip extract`: a level of a packed terrain, or a part of one, as a GeoTIFF.
 *
 * Rows are asked for from the north, one by one; they are read from the pyramid in strips that begin at multiples of
 * their height, so that tiles are decoded once. */
#include "extract.h"

#include "common/field/field.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/app/arguments.h"
#include "common/app/interrupt.h"
#include "common/base/numbers.h"
#include "common/base/outfile.h"
#include "common/app/load.h"
#include "common/chart/joined.h"
#include "progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct arguments {
    const char *file, *output;
    int level;     /* 0: the finest */
    int synthesis; /* levels finer than the data, or TC_SYNTHESIS_AUTO; 0: none */
    bool has_rect;
    int64_t rect[4]; /* X, Y from the north-west, W, H */
    bool quiet, verbose;
};

/* ---- Command line ----------------------------------------------------------------------------------------------- */

static bool set_rect(void *arguments, const char *value)
{
    struct arguments *a = arguments;
    for (int i = 0; i < 4; i++) {
        double number;
        if (!tc_take_number(&value, &number) || *value != (i < 3 ? ',' : '\0') || number != floor(number) ||
            !(number >= (i < 2 ? 0 : 1) && number <= INT32_MAX))
            return false;
        a->rect[i] = (int64_t)number;
        value++;
    }
    return a->has_rect = true;
}

static const tc_option table[] = {
    {0, "level", "L", TC_EXPECTED_LEVEL, "of detail; 1 is the coarsest (the finest)", tc_read_level,
     offsetof(struct arguments, level)},
    {0, "synthesis", "LEVELS", TC_EXPECTED_SYNTHESIS, TC_SYNTHESIS_HELP, tc_read_synthesis,
     offsetof(struct arguments, synthesis)},
    {0, "rect", "X,Y,W,H", "whole numbers X,Y,W,H, W and H 1 or more",
     "a part, in samples of that level: column X and row Y of its north-west sample, counted from the level's "
     "north-west; width and height (all)",
     set_rect, 0},
    {'o', "output", "FILE.tif", "the name of a file", "where it goes", tc_read_text,
     offsetof(struct arguments, output)},
    TC_SWITCH(struct arguments, quiet, 'q', "quiet", "neither warnings nor progress"),
    TC_SWITCH(struct arguments, verbose, 'v', "verbose", "what was written"),
    TC_HELP_AND_VERSION,
};

static const tc_command_line line = {.options = table,
                                     .count = sizeof table / sizeof *table,
                                     .help = "'terraclip extract --help'",
                                     .operand = tc_take_file,
                                     .offset = offsetof(struct arguments, file)};

void tc_extract_help(FILE *file)
{
    fprintf(
        file,
        "Usage: terraclip extract [OPTION]... FILE.tclip -o OUT.tif\n"
        "Writes a level as a GeoTIFF, north up and in its place: heights in metres as float32; of the finest\n"
        "level of a terrain packed without loss the source's own values in its own type. Voids get the source's\n"
        "nodata value; where it has none or it lies among the heights, NaN or an extreme of the integer type.\n"
        "Where tiles are damaged the next coarser level stands in, and the exit code is 1. A planet on faces\n"
        "(--atlas hex or cube) is interpolated to the grid of longitude and latitude that it was resampled from.\n\n");
    tc_arguments_print(&line, file);
}

static tc_status check_together(const struct arguments *a, tc_error *error)
{
    if (!a->file)
        return tc_fail(error, TC_ERR_USAGE, "FILE: expected a packed terrain, found none");
    if (!a->output)
        return tc_fail(error, TC_ERR_USAGE, "extract: expected -o OUT.tif, found none");
    tc_outputs outputs = {0};
    tc_status status = tc_outputs_add(&outputs, a->output, error);
    if (status == TC_OK)
        status = tc_outputs_spare(&outputs, a->file, error);
    tc_outputs_free(&outputs);
    return status;
}

/* ---- What is written -------------------------------------------------------------------------------------------- */

enum { STRIP_ROWS = 256, STRIP_BYTES = 48 << 20 };

typedef struct job {
    const tc_map *map;
    const tc_field *field; /* of the first chart */
    bool faces;            /* the level is that of their source's grid, to which it is interpolated */
    double stride;         /* finest samples of that between those of the level */
    tc_progress *progress;
    int level;
    tc_rect rect; /* rows from the south */
    tc_tiff_options tiff;
    tc_georef georef;
    bool stored;       /* stored values, else metres */
    double base, unit; /* of tc_stored_value */
    double z_base;

    float *z;
    uint8_t *voids;
    int64_t strip_rows;     /* a power of two */
    int64_t from, to;       /* rows in the strip */
    int64_t voids_mistaken; /* heights that look like nodata */
    tc_status status;       /* of reading */
} job;

/* The place of the rectangle: sample (i, j) of the level lies on finest sample (i s, j s), counted from the south-west.
 */
static void place(job *j, const tc_pack_terrain *terrain, tc_level level, double west, double north)
{
    double s = tc_level_stride(level.spacing_x, terrain->spacing_x), h = (double)terrain->height;
    double local[6] = {-0.5 * terrain->spacing_x, terrain->spacing_x, 0, (h - 0.5) * terrain->spacing_y, 0,
                       -terrain->spacing_y};
    const double *t = terrain->georef.known ? terrain->georef.transform : local;
    j->georef = terrain->georef;
    if (!terrain->georef.known)
        j->georef.crs_wkt = (char *)TC_LOCAL_CRS;
    j->georef.known = true;
    /* Its corner in columns and rows of the finest level; pixels are as large as the spacing, around their samples. */
    double column = 0.5 + (west - 0.5) * s, row = h - 0.5 - ((double)level.height - 0.5 - north) * s;
    double *u = j->georef.transform;
    u[0] = t[0] + column * t[1] + row * t[2];
    u[3] = t[3] + column * t[4] + row * t[5];
    u[1] = t[1] * s;
    u[2] = t[2] * s;
    u[4] = t[4] * s;
    u[5] = t[5] * s;
}

/* Whether a value is none that heights could come to: outside of their range and as much again. */
static bool is_apart(double value, double low, double high)
{
    double margin = high - low + 1;
    return isnan(value) || value < low - margin || value > high + margin;
}

static bool is_integer(tc_sample_type type)
{
    return type != TC_SAMPLE_FLOAT32 && type != TC_SAMPLE_FLOAT64;
}

/* The value for voids of an integer type whose source has none: an extreme that no height has; NaN: there is none. */
static double spare_value(tc_sample_type type, double low, double high)
{
    static const double limits[][2] = {{255, 0},        {-128, 127},      {65535, 0},
                                       {-32768, 32767}, {4294967295., 0}, {-2147483648., 2147483647.}};
    for (int i = 0; i < 2; i++)
        if (limits[type][i] < floor(low) || limits[type][i] > ceil(high))
            return limits[type][i];
    return NAN;
}

/* Whether an integer type has the value. */
static bool fits_integer(tc_sample_type type, double value)
{
    static const double low[] = {0, -128, 0, -32768, 0, -2147483648.0};
    static const double high[] = {255, 127, 65535, 32767, 4294967295.0, 2147483647};
    return value == rint(value) && value >= low[type] && value <= high[type];
}

/* Settles type, meaning and nodata of what is written. */
static void choose_storage(job *j, const tc_packed_info *packed, bool finest)
{
    const tc_pack_terrain *t = &packed->terrain;
    const tc_terrain_info *info = tc_field_info(j->field);
    tc_tiff_options *o = &j->tiff;
    j->stored = finest && packed->mode == TC_PACK_LOSSLESS;
    j->z_base = t->z_base;
    j->base = t->offset - t->z_base;
    j->unit = t->unit;
    o->type = j->stored ? t->sample_type : TC_SAMPLE_FLOAT32;
    o->area_registered = t->area_registered;
    double low = info->z_base + info->z_min, high = info->z_base + info->z_max;
    if (j->stored) {
        double a = tc_stored_value(info->z_min, j->base, j->unit), b = tc_stored_value(info->z_max, j->base, j->unit);
        low = fmin(a, b);
        high = fmax(a, b);
    }

    bool fits = t->has_nodata && (!is_integer(o->type) || fits_integer(o->type, t->nodata));
    o->has_nodata = fits || info->void_count > 0;
    o->nodata = fits ? t->nodata : NAN;
    if (is_integer(o->type) && !fits && info->void_count > 0) {
        o->nodata = spare_value(o->type, low, high);
        if (isnan(o->nodata)) { /* every value means a height */
            j->stored = false;
            o->type = TC_SAMPLE_FLOAT32;
        }
    } else if (!j->stored && fits && (!is_apart(t->nodata, low, high) || fabs(t->nodata) > 3e38)) {
        o->nodata = NAN;
    }
    if (j->stored) {
        o->unit = t->unit;
        o->offset = t->offset;
    }
    if (o->type == TC_SAMPLE_FLOAT32)
        o->nodata = (float)o->nodata; /* as the samples have it */
}

/* ---- Rows ------------------------------------------------------------------------------------------------------- */

/* From the faces that have the places of the source's grid. */
static tc_status read_faces(const job *j, tc_rect strip)
{
    const tc_chart *grid = &j->map->grid;
    int64_t width = strip.x1 - strip.x0;
    double *place = malloc(2 * (size_t)width * sizeof *place);
    tc_status status = place ? TC_OK : TC_ERR_MEMORY;
    for (int64_t y = strip.y0; y < strip.y1 && !status; y++) {
        for (int64_t i = 0; i < width; i++) {
            double latitude = grid->y0 + (double)y * j->stride * grid->dy;
            grid->class->to_place(grid, grid->x0 + (double)(strip.x0 + i) * j->stride * grid->dx,
                                  fmin(fmax(latitude, -M_PI / 2), M_PI / 2), &place[i], &place[width + i]);
        }
        ptrdiff_t at = (y - strip.y0) * width;
        status = tc_joined_heights(j->map->chart, j->map->charts, j->level, width, place, place + width, j->z + at,
                                   j->voids + at);
    }
    free(place);
    return status;
}

static tc_status read_strip(job *j, int64_t y)
{
    tc_rect strip = j->rect;
    strip.y0 = tc_max64(j->rect.y0, y / j->strip_rows * j->strip_rows);
    strip.y1 = tc_min64(j->rect.y1, strip.y0 / j->strip_rows * j->strip_rows + j->strip_rows);
    tc_status status =
        j->faces ? read_faces(j, strip) : tc_field_read(j->field, j->level, strip, j->z, j->voids, strip.x1 - strip.x0);
    j->from = strip.y0;
    j->to = status == TC_OK ? strip.y1 : strip.y0;
    return status;
}

static tc_status give_row(void *context, int64_t row, double *values)
{
    job *j = context;
    int64_t y = j->rect.y0 + row, width = j->rect.x1 - j->rect.x0;
    if (y < j->from || y >= j->to) {
        if (tc_interrupted())
            return TC_ERR_IO;
        tc_status status = read_strip(j, y);
        if (status != TC_OK)
            return status;
        tc_progress_show(j->progress, (double)(j->rect.y1 - y) / (double)(j->rect.y1 - j->rect.y0));
    }
    const float *z = j->z + (y - j->from) * width;
    const uint8_t *voids = j->voids + (y - j->from) * width;
    bool rounded = is_integer(j->tiff.type);
    for (int64_t i = 0; i < width; i++) {
        double value = j->stored ? tc_stored_value(z[i], j->base, j->unit) : (double)z[i] + j->z_base;
        value = rounded ? rint(value) : value;
        values[i] = voids[i] ? NAN : value;
        j->voids_mistaken += !voids[i] && j->tiff.has_nodata && value == j->tiff.nodata;
    }
    return TC_OK;
}

/* ---- Running ---------------------------------------------------------------------------------------------------- */

static tc_status settle_rect(const struct arguments *a, tc_level level, job *j, tc_error *error)
{
    const int64_t all[4] = {0, 0, level.width, level.height}, *r = a->has_rect ? a->rect : all;
    if (r[2] > level.width - r[0] || r[3] > level.height - r[1])
        return tc_fail(error, TC_ERR_USAGE,
                       "--rect: expected a part of level %d, %" PRId64 " x %" PRId64 " samples, found %" PRId64
                       ",%" PRId64 ",%" PRId64 ",%" PRId64,
                       j->level, level.width, level.height, r[0], r[1], r[2], r[3]);
    j->rect = (tc_rect){r[0], level.height - r[1] - r[3], r[0] + r[2], level.height - r[1]};
    return TC_OK;
}

static tc_status make_room(job *j, tc_error *error)
{
    int64_t width = j->rect.x1 - j->rect.x0;
    for (j->strip_rows = STRIP_ROWS; j->strip_rows > 1 && j->strip_rows * width * 5 > STRIP_BYTES;)
        j->strip_rows /= 2;
    size_t samples = (size_t)(j->strip_rows * width);
    j->z = malloc(samples * sizeof *j->z);
    j->voids = malloc(samples);
    return j->z && j->voids
               ? TC_OK
               : tc_fail(error, TC_ERR_MEMORY, "extract: not enough memory for %" PRId64 " rows", j->strip_rows);
}

static tc_status write(const struct arguments *a, job *j, tc_error *error)
{
    tc_status status = make_room(j, error);
    if (status == TC_OK)
        status = tc_write_tiff(a->output, &j->tiff, give_row, j, error);
    free(j->z);
    free(j->voids);
    tc_progress_end(j->progress);
    if (status != TC_OK)
        return tc_interrupted() ? tc_fail(error, TC_ERR_IO, "interrupted") : status;
    char text[256];
    if (j->voids_mistaken > 0) {
        snprintf(text, sizeof text, "%" PRId64 " heights have the value %.10g, which means void in the file written",
                 j->voids_mistaken, j->tiff.nodata);
        tc_progress_say(j->progress, true, text);
    }
    snprintf(text, sizeof text, "level %d, %" PRId64 " x %" PRId64 " samples, %s", j->level, j->tiff.width,
             j->tiff.height, j->stored ? "stored values of the source" : "metres as float32");
    tc_progress_say(j->progress, false, text);
    int64_t damaged = j->faces ? tc_map_damaged(j->map) : tc_field_tell(j->field).damaged;
    if (damaged > 0)
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: damaged: %" PRId64 " tiles could not be read; %s was written with the next coarser level "
                       "in their place",
                       a->file, damaged, a->output);
    return TC_OK;
}

/* The level that is written, and the terrain whose level it is: of faces the grid that they were resampled from, whose
 * levels are made of theirs. */
static tc_level level_of(job *j, tc_pack_terrain *terrain)
{
    const tc_map *m = j->map;
    const tc_level level = tc_field_level(j->field, j->level);
    j->faces = m->chart[0].class->seam != NULL;
    if (!j->faces)
        return level;
    j->stride = tc_level_stride(level.spacing_x, m->spacing_x);
    terrain->width = m->width, terrain->height = m->height;
    terrain->spacing_x = m->grid.dx * m->body.radius, terrain->spacing_y = m->grid.dy * m->body.radius;
    terrain->georef.known = true, terrain->georef.geographic = true;
    memcpy(terrain->georef.transform, m->georef.transform, sizeof m->georef.transform);
    /* Of finer levels columns go once around, and rows end where the data's do. */
    return (tc_level){(int64_t)ceil((double)m->width / j->stride),
                      (int64_t)floor((double)(m->height - 1) / j->stride) + 1, j->stride * terrain->spacing_x,
                      j->stride * terrain->spacing_y};
}

static tc_status extract(const struct arguments *a, const tc_map *map, tc_progress *progress, tc_error *error)
{
    const tc_field *field = tc_map_field(map, 0);
    const tc_packed_info *packed = tc_field_packed_info(field);
    int levels = tc_field_info(field)->levels;
    if (a->level > levels)
        return tc_fail(error, TC_ERR_USAGE, "--level: expected 1..%d, found %d", levels, a->level);
    job j = {.map = map, .field = field, .progress = progress, .level = a->level ? a->level : levels};
    tc_pack_terrain terrain = packed->terrain;
    const tc_level level = level_of(&j, &terrain);
    tc_status status = settle_rect(a, level, &j, error);
    if (status != TC_OK)
        return status;
    place(&j, &terrain, level, (double)j.rect.x0, (double)(level.height - j.rect.y1));
    j.tiff.width = j.rect.x1 - j.rect.x0;
    j.tiff.height = j.rect.y1 - j.rect.y0;
    j.tiff.georef = &j.georef;
    j.tiff.credits = packed->terrain.credits;
    choose_storage(&j, packed, !j.faces && tc_level_stride(level.spacing_x, terrain.spacing_x) == 1);
    progress->samples = (double)j.tiff.width * (double)j.tiff.height;
    return write(a, &j, error);
}

tc_status tc_extract_main(int argc, char **argv, tc_error *error)
{
    struct arguments a = {0};
    tc_action action;
    tc_status status = tc_arguments_read(&line, argc, argv, &a, &action, error);
    if (status == TC_OK)
        status = check_together(&a, error);
    if (status != TC_OK)
        return status;
    tc_progress progress = tc_progress_begin("extract", a.quiet, a.verbose);
    const tc_source_options options = {.say = tc_progress_say, .say_context = &progress};
    tc_map *map = NULL;
    status = tc_map_load_packed(a.file, &options, &(tc_load_options){.body = &tc_plane_body}, &map, error);
    if (status == TC_OK)
        status = tc_map_synthesise(map, a.synthesis, error);
    if (status == TC_OK)
        status = tc_outfile_probe(a.output, error);
    if (status == TC_OK) {
        tc_watch_interrupts();
        status = extract(&a, map, &progress, error);
    }
    tc_map_destroy(map);
    return status;
}
