/* load.c - a map from any file: which way it is read. */
#include "load.h"

#include <stdlib.h>

#include "common/base/clock.h"
#include "common/base/status.h"
#include "common/input/source_internal.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* How files come onto each body; the first one's way is that of files that say nothing. */
static const struct way {
    const tc_body_class *body;
    tc_status (*load)(const char *path, const tc_source_options *source, const tc_load_options *options,
                      tc_map **map_ret, tc_error *error);
    bool flat; /* packed planets as their grid alone */
    /* What is to be done with a map from a packed file; NULL: nothing. */
    tc_status (*settle)(const char *path, const tc_source_options *source, const tc_load_options *options, tc_map *map,
                        tc_error *error);
} ways[] = {{&tc_plane_body, tc_load_flat, true, NULL}, {&tc_sphere_body, tc_load_globe, false, tc_load_onto_globe}};
enum { WAYS = sizeof ways / sizeof *ways };

static const struct way *way_of(const tc_body_class *body)
{
    for (int i = 0; i < WAYS; i++)
        if (ways[i].body == body)
            return &ways[i];
    return &ways[0];
}

tc_status tc_load_build(tc_grid *grid, const tc_body *body, const tc_source_options *source,
                        const tc_load_options *options, double start, tc_map **map_ret, tc_error *error)
{
    double read = tc_clock_ms();
    tc_map *map;
    tc_status status = tc_tell_progress(source, "making levels", -1, error);
    if (status != TC_OK)
        tc_grid_free(grid);
    else if (body->radius > 0)
        status = tc_map_build_ellipsoid(grid, body->radius, body->flattening, options->threads, &map, error);
    else
        status = tc_map_build(grid, 0, options->threads, &map, error);
    if (status != TC_OK)
        return status;
    map->voids = source->voids;
    map->read_ms = read - start;
    map->build_ms = tc_clock_ms() - read;
    *map_ret = map;
    return TC_OK;
}

/* By its first bytes. */
static bool is_packed(const char *path)
{
    unsigned char signature[8] = {0};
    struct stat about;
    FILE *file = stat(path, &about) == 0 && S_ISREG(about.st_mode) ? fopen(path, "rb") : NULL; /* a pipe is not read */
    bool packed = file && fread(signature, 1, 8, file) == 8 && tc_is_tclip(signature);
    if (file)
        fclose(file);
    return packed;
}

/* What was settled on packing. */
static tc_status refuse_settled(const char *path, const tc_source_options *source, tc_error *error)
{
    const char *name = source->spacing > 0  ? "spacing"
                       : source->unit != 0  ? "unit"
                       : source->has_offset ? "offset"
                       : source->band > 0   ? "band"
                       : source->layer      ? "layer"
                       : source->crs        ? "crs"
                       : source->has_nodata ? "nodata"
                                            : NULL;
    if (name)
        return tc_fail(error, TC_ERR_USAGE, "--%s: expected none for %s, a packed terrain: it was settled when packing",
                       name, path);
    return tc_check_source_options(source, error);
}

static void tell_missing(const char *path, const tc_source_options *source, const tc_map *map)
{
    const tc_packed_info *packed = tc_field_packed_info(map->chart[0].field);
    if (packed->levels_missing > 0)
        tc_say(source, true, "%s: cut short: expected %lld bytes, found fewer; missing: the finest %d of its levels",
               path, (long long)packed->bytes, packed->levels_missing);
    else if (packed->cut_short)
        tc_say(source, true, "%s: cut short: expected %lld bytes, found fewer; %s", path, (long long)packed->bytes,
               packed->version < 3 ? "its polar caps are not whole"
                                   : "its levels are whole, what they are off is measured anew");
}

/* Whose the heights are, line by line. */
static tc_status tell_credits(const tc_source_options *source, const tc_map *map)
{
    const char *credits = tc_field_packed_info(map->chart[0].field)->terrain.credits;
    if (!credits || !source->credit)
        return TC_OK;
    char *lines = strdup(credits), *rest;
    for (char *line = lines ? strtok_r(lines, "\n", &rest) : NULL; line; line = strtok_r(NULL, "\n", &rest))
        source->credit(source->credit_context, line);
    free(lines);
    return lines ? TC_OK : TC_ERR_MEMORY;
}

tc_status tc_map_load_packed(const char *path, const tc_source_options *source, const tc_load_options *options,
                             tc_map **map_ret, tc_error *error)
{
    tc_status status = refuse_settled(path, source, error);
    if (status != TC_OK)
        return status;
    double start = tc_clock_ms();
    const struct way *way = way_of(options->body);
    const tc_open_options how = {.has_policy = source->has_voids,
                                 .voids = source->voids,
                                 .void_constant = source->void_constant,
                                 .flat = options->body && way->flat};
    tc_map *map;
    status = tc_map_open(path, &how, &map, error);
    if (status != TC_OK)
        return status;
    tell_missing(path, source, map);
    if ((status = tell_credits(source, map)))
        tc_fail(error, status, "%s: not enough memory", path);
    else if (way->settle)
        status = way->settle(path, source, options, map, error);
    if (status != TC_OK) {
        tc_map_destroy(map);
        return status;
    }
    map->read_ms = tc_clock_ms() - start;
    *map_ret = map;
    return TC_OK;
}

/* Onto the charts that are asked for. */
static tc_status lay_out(const char *path, bool packed, const tc_source_options *source, const tc_load_options *options,
                         tc_map **map, tc_error *error)
{
    const tc_atlas *has = tc_atlas_of((*map)->chart[0].class), *wanted = options->atlas;
    if (way_of(options->body)->flat && options->body && tc_map_radius(*map) > 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a flat terrain or a planet in longitude and latitude, found one packed with "
                       "--atlas %s",
                       path, has->name);
    if (!wanted || tc_atlas_same(has, wanted))
        return TC_OK;
    if (packed)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a planet packed with --atlas %s, found one with --atlas %s; 'terraclip pack "
                       "--planet --atlas %s INPUT -o FILE.tclip' makes one of the same input",
                       path, wanted->name, has ? has->name : "none", wanted->name);
    tc_status status = tc_map_check_whole(*map, path, error);
    double start = tc_clock_ms();
    tc_map *made;
    struct tc_synthesis_fit *fit = NULL;
    if (status == TC_OK)
        status = tc_tell_progress(source, "resampling to other charts", -1, error);
    if (status == TC_OK && options->synthesises)
        status = tc_map_learn(*map, &fit, error);
    if (status == TC_OK)
        status = tc_map_resample(*map, wanted, options->threads, &made, error);
    if (status != TC_OK) {
        free(fit);
        return status;
    }
    made->fit = fit;
    made->build_ms += tc_clock_ms() - start;
    tc_map_destroy(*map);
    *map = made;
    return TC_OK;
}

tc_status tc_map_load(const char *path, const tc_source_options *source, const tc_load_options *options,
                      tc_map **map_ret, tc_error *error)
{
    static const tc_source_options no_source = {0};
    static const tc_load_options no_options = {0};
    source = source ? source : &no_source;
    options = options ? options : &no_options;
    bool packed = is_packed(path);
    tc_map *map;
    tc_status status = packed ? tc_map_load_packed(path, source, options, &map, error)
                              : way_of(options->body)->load(path, source, options, &map, error);
    if (status)
        return status;
    if ((status = lay_out(path, packed, source, options, &map, error)))
        tc_map_destroy(map);
    else
        *map_ret = map;
    return status;
}
