/* terrain.c - a terrain from any file. No library is loaded for a packed one. */
#include "terrain.h"

#include "common/base/clock.h"
#include "common/base/status.h"
#include "common/input/source_internal.h"

#include <stdio.h>
#include <sys/stat.h>

bool tc_is_packed(const char *path)
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
static tc_status refuse_settled(const char *path, const tc_source_options *options, tc_error *error)
{
    const char *name = options->spacing > 0  ? "spacing"
                       : options->unit > 0   ? "unit"
                       : options->has_nodata ? "nodata"
                                             : NULL;
    if (name)
        return tc_fail(error, TC_ERR_USAGE, "--%s: expected none for %s, a packed terrain: it was settled when packing",
                       name, path);
    return tc_check_source_options(options, error);
}

tc_status tc_terrain_open_packed(const char *path, const tc_source_options *options, tc_terrain *terrain_ret,
                                 tc_error *error)
{
    tc_status status = refuse_settled(path, options, error);
    if (status != TC_OK)
        return status;
    double start = tc_clock_ms();
    tc_terrain terrain = {0};
    const tc_open_options how = {
        .has_policy = options->has_voids, .voids = options->voids, .void_constant = options->void_constant};
    status = tc_field_open(path, &how, &terrain.field, error);
    if (status != TC_OK)
        return status;
    const tc_packed_info *packed = tc_field_packed_info(terrain.field);
    terrain.voids = options->has_voids ? options->voids : packed->terrain.voids;
    terrain.georef = packed->terrain.georef;
    terrain.width = packed->terrain.width;
    terrain.height = packed->terrain.height;
    terrain.spacing_x = packed->terrain.spacing_x;
    terrain.spacing_y = packed->terrain.spacing_y;
    terrain.read_ms = tc_clock_ms() - start;
    if (packed->levels_missing > 0)
        tc_say(options, true, "%s: cut short: expected %lld bytes, found fewer; missing: the finest %d of its levels",
               path, (long long)packed->bytes, packed->levels_missing);
    else if (packed->cut_short)
        tc_say(options, true, "%s: cut short: expected %lld bytes, found fewer; its polar caps are not whole", path,
               (long long)packed->bytes);
    terrain.georef.crs_wkt = NULL; /* the pyramid's */
    *terrain_ret = terrain;
    return TC_OK;
}

static tc_status load(const char *path, const tc_source_options *options, int threads, tc_terrain *terrain,
                      tc_error *error)
{
    double start = tc_clock_ms();
    tc_grid grid;
    tc_status status = tc_grid_load(path, options, &grid, error);
    if (status != TC_OK)
        return status;
    double read = tc_clock_ms();
    terrain->voids = options->voids;
    terrain->georef = grid.georef;
    terrain->width = grid.width;
    terrain->height = grid.height;
    terrain->spacing_x = grid.spacing_x;
    terrain->spacing_y = grid.spacing_y;
    status = tc_field_build(&grid, threads, &terrain->field, error);
    terrain->read_ms = read - start;
    terrain->build_ms = tc_clock_ms() - read;
    return status;
}

tc_status tc_terrain_open(const char *path, const tc_source_options *options, int threads, tc_terrain *terrain_ret,
                          tc_error *error)
{
    static const tc_source_options defaults = {0};
    options = options ? options : &defaults;
    if (tc_is_packed(path))
        return tc_terrain_open_packed(path, options, terrain_ret, error);
    tc_terrain terrain = {0};
    tc_status status = load(path, options, threads, &terrain, error);
    terrain.georef.crs_wkt = NULL; /* the pyramid's */
    if (status == TC_OK)
        *terrain_ret = terrain;
    return status;
}

void tc_terrain_close(tc_terrain *terrain)
{
    tc_field_destroy(terrain->field);
    *terrain = (tc_terrain){0};
}

int64_t tc_terrain_bytes_decoded(const tc_field *field)
{
    return tc_field_tell(field).decoded;
}

int64_t tc_terrain_damaged(const tc_field *field)
{
    return tc_field_tell(field).damaged;
}
