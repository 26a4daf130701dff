/* planet.c - a planet from any DEM or picture. */
#include "planet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/clock.h"
#include "common/map/atlas_packed.h"
#include "common/map/atlas.h"
#include "common/chart/row_resample.h"
#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/fill.h"
#include "common/map/planet_place.h"
#include "common/input/source_internal.h"
#include "terrain.h"

/* Places a file before it is read, so that one that cannot be shown is refused at once. Says nothing: tc_grid_load
 * will. */
static tc_status check_place(const char *path, const tc_source_options *options, bool whole, tc_error *error)
{
    tc_source_options quiet = *options;
    quiet.say = NULL;
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

static void measure(tc_grid *grid)
{
    grid->z_min = INFINITY, grid->z_max = -INFINITY;
    grid->void_count = 0;
    for (int64_t i = 0; i < grid->width * grid->height; i++) {
        if (grid->voids && grid->voids[i]) {
            grid->void_count++;
            continue;
        }
        grid->z_min = fminf(grid->z_min, grid->z[i]);
        grid->z_max = fmaxf(grid->z_max, grid->z[i]);
    }
}

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
        measure(grid);
    if (grid->void_count == grid->width * grid->height)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected heights on the globe, found none", path);
    grid->georef.known = grid->georef.geographic = true;
    memcpy(grid->georef.transform, place.transform, sizeof place.transform);
    return TC_OK;
}

tc_status tc_planet_load(const char *path, const tc_source_options *options, double radius, bool whole, int threads,
                         tc_planet *planet_ret, tc_error *error)
{
    tc_source_options settled = {0};
    if (options)
        settled = *options;
    if (settled.spacing > 0)
        return tc_fail(error, TC_ERR_USAGE, "--spacing: expected none for a planet: its samples lie in degrees");
    tc_status status = tc_planet_check_radius(radius, error);
    if (status == TC_OK)
        status = check_place(path, &settled, whole, error);
    if (status != TC_OK)
        return status;

    double start = tc_clock_ms();
    tc_planet planet = {.voids = settled.voids};
    tc_grid grid = {0};
    tc_source_options loading = settled;
    loading.spacing = 1; /* metres on a flat map are not settled, and not talked about */
    status = tc_grid_load(path, &loading, &grid, error);
    if (status == TC_OK)
        status = settle(path, &settled, whole, threads, &grid, error);
    if (status == TC_OK) {
        radius = tc_planet_radius(&grid.georef, radius);
        status = tc_atlas_check_grid(path, &grid, radius, error);
    }
    if (status != TC_OK) {
        tc_grid_free(&grid);
        return status;
    }
    double read = tc_clock_ms();
    if (grid.georef.semi_major <= 0)
        grid.georef.semi_major = radius; /* tells the body */
    planet.georef = grid.georef;
    planet.georef.crs_wkt = NULL; /* the pyramid's */
    planet.width = grid.width;
    planet.height = grid.height;
    status = tc_atlas_build(&grid, radius, threads, &planet.atlas, error);
    planet.read_ms = read - start;
    planet.build_ms = tc_clock_ms() - read;
    if (status == TC_OK)
        *planet_ret = planet;
    return status;
}

/* A packed flat terrain in degrees is a part of a globe. */
static tc_status place_packed(const char *path, const tc_source_options *options, double radius, tc_terrain *terrain,
                              tc_atlas *atlas_ret, tc_error *error)
{
    const tc_terrain_info *info = tc_field_info(terrain->field);
    const tc_georef *g = &tc_field_packed_info(terrain->field)->terrain.georef;
    const double degree = M_PI / 180, *t = g->transform;
    if (!g->known || !g->geographic || t[2] != 0 || t[4] != 0)
        return tc_fail(
            error, TC_ERR_UNSUPPORTED,
            "%s: expected a terrain in longitude and latitude, or one packed with --planet, found a flat one", path);
    radius = tc_planet_radius(g, radius);
    tc_status status = tc_atlas_check_relief(path, info->z_base + (double)info->z_min,
                                             info->z_base + (double)info->z_max, radius, error);
    if (status != TC_OK)
        return status;
    /* Its levels do not go round, and it has no caps. */
    double turn = 360 / t[1];
    if (tc_atlas_around(terrain->width, turn) || (double)terrain->width > turn)
        tc_say(options, true,
               "%s: packed flat: around the globe it has a gap where its sides meet, and at the poles holes; pack it "
               "with --planet",
               path);
    tc_chart chart = {.field = terrain->field, .projection = TC_LONLAT, .dx = t[1] * degree, .dy = -t[5] * degree};
    chart.x0 = (t[0] + 0.5 * t[1]) * degree;
    chart.y0 = (t[3] + ((double)terrain->height - 0.5) * t[5]) * degree;
    tc_level held = tc_field_level(chart.field, tc_field_info(chart.field)->levels);
    double coarser =
        ldexp(1, (int)lround(log2((double)terrain->width / (double)held.width))); /* where it was cut short */
    chart.dx *= coarser, chart.dy *= coarser;
    *atlas_ret = (tc_atlas){.radius = radius, .charts = 1, .chart = {chart}};
    terrain->field = NULL;
    return TC_OK;
}

tc_status tc_planet_open(const char *path, const tc_source_options *options, double radius, int threads,
                         tc_planet *planet_ret, tc_error *error)
{
    if (!tc_is_packed(path))
        return tc_planet_load(path, options, radius, false, threads, planet_ret, error);
    double start = tc_clock_ms();
    tc_terrain terrain;
    tc_status status = tc_planet_check_radius(radius, error);
    if (status == TC_OK)
        status = tc_terrain_open_packed(path, options, &terrain, error);
    if (status != TC_OK)
        return status;
    if (radius > 0 && tc_field_packed_info(terrain.field)->terrain.radius > 0) {
        tc_terrain_close(&terrain);
        return tc_fail(error, TC_ERR_USAGE,
                       "--radius: expected none for %s, a packed planet: it was settled when packing", path);
    }
    const tc_open_options how = {
        .has_policy = options->has_voids, .voids = options->voids, .void_constant = options->void_constant};
    tc_planet planet = {
        .voids = terrain.voids, .georef = terrain.georef, .width = terrain.width, .height = terrain.height};
    status = tc_atlas_open(path, &how, &planet.atlas, error);
    if (status == TC_ERR_UNSUPPORTED)
        status = place_packed(path, options, radius, &terrain, &planet.atlas, error);
    tc_terrain_close(&terrain);
    planet.read_ms = tc_clock_ms() - start;
    if (status == TC_OK)
        *planet_ret = planet;
    return status;
}

void tc_planet_close(tc_planet *planet)
{
    tc_atlas_free(&planet->atlas);
    *planet = (tc_planet){0};
}
