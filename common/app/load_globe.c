/* load_globe.c - a DEM or a picture of heights on a globe. */
#include "load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/clock.h"
#include "common/chart/row_resample.h"
#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/fill.h"
#include "common/input/folder.h"
#include "common/input/source_internal.h"
#include "planet_place.h"

/* Places a file before it is read, so that one that cannot be shown is refused at once. Says nothing: tc_grid_load
 * will. */
static tc_status check_place(const char *path, const tc_source_options *options, bool whole, tc_error *error)
{
    tc_source_options quiet = *options;
    quiet.say = NULL;
    quiet.lonlat = true;
    tc_source *source = NULL;
    tc_planet_place place;
    tc_status status = tc_source_open(path, &quiet, &source, error);
    if (status != TC_OK)
        return status;
    const tc_source_info *info = tc_source_get_info(source);
    status = tc_planet_place_raster(path, &quiet, info->width, info->height, &info->georef, whole, &place, error);
    tc_source_close(source);
    return status;
}

/* Leaves out what is not used, in the same memory. */
static void crop(tc_grid *grid, const tc_planet_place *place)
{
    for (int64_t j = 0; j < place->rows; j++) {
        int64_t to = j * place->columns, from = (j + place->south) * grid->width;
        memmove(grid->z + to, grid->z + from, (size_t)place->columns * sizeof *grid->z);
        if (grid->voids)
            memmove(grid->voids + to, grid->voids + from, (size_t)place->columns);
    }
    grid->width = place->columns;
    grid->height = place->rows;
}

/* ---- Voids across the seam ------------------------------------------------------------------------------------ */

/* Whether a void reaches both sides of the map's edge, where its surface then would not meet. */
static bool voids_at_seam(const tc_grid *grid)
{
    for (int64_t j = 0; grid->voids && j < grid->height; j++)
        if (grid->voids[j * grid->width] && grid->voids[(j + 1) * grid->width - 1])
            return true;
    return false;
}

/* Fills voids once more, on a map that goes on by a quarter on either side. */
static tc_status fill_across_seam(const char *path, tc_grid *grid, tc_error *error)
{
    int64_t pad = tc_max64(grid->width / 4, 1), width = grid->width + 2 * pad;
    float *z = malloc((size_t)(width * grid->height) * sizeof *z);
    uint8_t *voids = malloc((size_t)(width * grid->height));
    tc_status status = z && voids ? TC_OK : TC_ERR_MEMORY;
    for (int64_t j = 0; j < grid->height && status == TC_OK; j++)
        for (int64_t i = 0; i < width; i++) {
            int64_t from = j * grid->width + (i + grid->width - pad) % grid->width;
            z[j * width + i] = grid->z[from];
            voids[j * width + i] = grid->voids[from];
        }
    if (status == TC_OK)
        status = tc_fill_voids(z, voids, width, grid->height);
    for (int64_t j = 0; j < grid->height && status == TC_OK; j++)
        memcpy(grid->z + j * grid->width, z + j * width + pad, (size_t)grid->width * sizeof *z);
    free(z);
    free(voids);
    return status == TC_OK ? TC_OK : tc_fail(error, status, "%s: not enough memory to fill its voids", path);
}

/* ---- Resampling ----------------------------------------------------------------------------------------------- */

typedef struct resampling {
    const tc_row_resampler *resampler;
    const tc_grid *from;
    tc_grid *to;
} resampling;

static void resample_row(void *context, int64_t j)
{
    const resampling *r = context;
    tc_row_resample(r->resampler, r->from->z + j * r->from->width, r->to->z + j * r->to->width);
    if (r->to->voids)
        tc_row_resample_voids(r->resampler, r->from->voids + j * r->from->width, r->to->voids + j * r->to->width);
}

static tc_status resample(const char *path, tc_grid *grid, int64_t width, int threads, tc_error *error)
{
    tc_row_resampler *resampler = tc_row_resampler_create(grid->width, width);
    tc_grid to = *grid;
    size_t samples = (size_t)(width * grid->height);
    to.width = width;
    to.z = malloc(samples * sizeof *to.z);
    to.voids = grid->voids ? malloc(samples) : NULL;
    if (!resampler || !to.z || (grid->voids && !to.voids)) {
        tc_row_resampler_destroy(resampler);
        free(to.z);
        free(to.voids);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to resample it", path);
    }
    resampling r = {resampler, grid, &to};
    tc_parallel_for(threads, grid->height, resample_row, &r);
    tc_row_resampler_destroy(resampler);
    free(grid->z);
    free(grid->voids);
    *grid = to;
    return TC_OK;
}

/* ---- All together --------------------------------------------------------------------------------------------- */

static tc_status settle(const char *path, const tc_source_options *options, bool whole, int threads, tc_grid *grid,
                        tc_error *error)
{
    tc_planet_place place;
    tc_status status =
        tc_planet_place_raster(path, options, grid->width, grid->height, &grid->georef, whole, &place, error);
    if (status != TC_OK)
        return status;
    bool changes = place.columns != grid->width || place.rows != grid->height || place.width != place.columns;
    crop(grid, &place);
    if (place.around && voids_at_seam(grid))
        status = fill_across_seam(path, grid, error);
    if (status == TC_OK && place.width != place.columns)
        status = resample(path, grid, place.width, threads, error);
    if (status != TC_OK)
        return status;
    if (changes)
        tc_grid_measure(grid);
    if (grid->void_count == grid->width * grid->height)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected heights on the globe, found none", path);
    grid->georef.known = grid->georef.geographic = true;
    memcpy(grid->georef.transform, place.transform, sizeof place.transform);
    return TC_OK;
}

tc_status tc_load_globe(const char *path, const tc_source_options *source, const tc_load_options *options,
                        tc_map **map_ret, tc_error *error)
{
    if (source->spacing > 0)
        return tc_fail(error, TC_ERR_USAGE, "--spacing: expected none for a planet: its samples lie in degrees");
    tc_status status = tc_globe_check(&options->globe, error);
    if (status == TC_OK)
        status = tc_is_folder(path) ? TC_OK : check_place(path, source, options->whole, error);
    if (status != TC_OK)
        return status;

    double start = tc_clock_ms();
    tc_body body = {0};
    tc_grid grid = {0};
    tc_source_options loading = *source;
    loading.lonlat = true;
    loading.spacing = 1; /* metres on a flat map are not settled, and not talked about */
    status = tc_grid_load(path, &loading, &grid, error);
    if (status == TC_OK)
        status = settle(path, source, options->whole, options->threads, &grid, error);
    if (status == TC_OK) {
        body = tc_globe_body(&options->globe, &grid.georef, source);
        status = tc_map_check_grid(path, &grid, &body, error);
    }
    if (status != TC_OK) {
        tc_grid_free(&grid);
        return status;
    }
    if (grid.georef.semi_major <= 0)
        grid.georef.semi_major = body.radius; /* tells the body */
    return tc_load_build(&grid, &body, source, options, start, map_ret, error);
}

tc_status tc_load_onto_globe(const char *path, const tc_source_options *source, const tc_load_options *options,
                             tc_map *map, tc_error *error)
{
    tc_status status = tc_globe_check(&options->globe, error);
    if (status != TC_OK)
        return status;
    const char *given = tc_globe_given(&options->globe);
    if (tc_map_radius(map) > 0)
        return given ? tc_fail(error, TC_ERR_USAGE,
                               "%s: expected none for %s, a packed planet: it was settled when packing", given, path)
                     : TC_OK;
    bool gap;
    status = tc_map_onto_globe(map, path, tc_globe_body(&options->globe, &map->georef, source), &gap, error);
    if (status == TC_OK && gap) /* its levels do not go round, and it has no caps */
        tc_say(source, true,
               "%s: packed flat: around the globe it has a gap where its sides meet, and at the poles holes; pack it "
               "with --planet",
               path);
    return status;
}
