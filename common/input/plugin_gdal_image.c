/* plugin_gdal_image.c - pictures through GDAL: opened, placed, and read. */
#include "plugin_gdal_image.h"

#include "common/base/status.h"

#include <cpl_string.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Reading ------------------------------------------------------------------------------------------------------
 */

static tc_status read_level(tc_image *image, int level, tc_rect rect, uint8_t (*rgba)[4], ptrdiff_t stride,
                            tc_error *error)
{
    tc_gdal_image *g = (tc_gdal_image *)image;
    const tc_gdal_level *l = &g->level[level];
    if (l->small)
        return l->small->read(l->small, l->small_level, rect, rgba, stride, error);
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    bool good = tc_gdal_pixels_read(l->pixels, l->dataset, l->overview, rect, rgba, stride, &said);
    const char *why = tc_gdal_heard(&said);
    if (good)
        return TC_OK;
    if (l->pixels != &g->plain)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read, damaged or truncated: %s", g->path, why);
    tc_gdal_cache_forget(&g->cache);
    return tc_fail(error, TC_ERR_FORMAT,
                   "%s: its levels in %s-*.tif were damaged; the next program makes them anew: %s", g->path,
                   g->cache.base, why);
}

static void find(tc_image *image, int count, double *x, double *y)
{
    tc_gdal_image_find(((tc_gdal_image *)image)->places, count, x, y);
}

static void locate(tc_image *image, int count, double *x, double *y)
{
    tc_gdal_image_locate(((tc_gdal_image *)image)->places, count, x, y);
}

static void close_image(tc_image *image)
{
    tc_gdal_image *g = (tc_gdal_image *)image;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    tc_gdal_image_places_close(g->places);
    for (int k = 0; k < TC_IMAGE_LEVELS; k++)
        if (g->cached[k])
            GDALClose(g->cached[k]);
    if (g->dataset)
        GDALClose(g->dataset);
    tc_gdal_heard(&said);
    tc_gdal_pixels_free(&g->pixels);
    tc_gdal_pixels_free(&g->plain);
    CSLDestroy(image->parts);
    if (g->small)
        g->small->close(g->small);
    free(g);
}

/* ---- Opening ------------------------------------------------------------------------------------------------------
 */

static bool has_place(GDALDatasetH dataset)
{
    static const double unset[6] = {0, 1, 0, 0, 0, 1};
    double t[6];
    bool transform = GDALGetGeoTransform(dataset, t) == CE_None && memcmp(t, unset, sizeof t) != 0;
    return transform || GDALGetGCPCount(dataset) > 0;
}

/* Pixels around the globe, of a picture in longitude and latitude. */
static double period_of(GDALDatasetH dataset)
{
    double t[6];
    OGRSpatialReferenceH own = GDALGetSpatialRef(dataset);
    if (!own || !OSRIsGeographic(own) || OSRIsDerivedGeographic(own) || GDALGetGeoTransform(dataset, t) != CE_None ||
        t[2] != 0 || !(t[1] != 0))
        return 0;
    return fabs(2 * M_PI / OSRGetAngularUnits(own, NULL) / t[1]);
}

static tc_status place(tc_gdal_image *g, const tc_image_map *map, const tc_image_options *options, tc_error *error)
{
    if (!has_place(g->dataset))
        return TC_OK;
    bool named = tc_gdal_image_system(g->dataset) != NULL;
    if (!map->known) {
        tc_say(options->source, true,
               "%s: says where it lies, but the terrain does not: it is laid over all of the terrain", g->path);
        return TC_OK;
    }
    if (!named && map->crs_wkt)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a coordinate system with its transform, found none: gdal_edit.py -a_srs or a VRT "
                       "gives it one",
                       g->path);
    g->places = tc_gdal_image_places(g->path, g->dataset, map, error);
    if (!g->places)
        return TC_ERR_UNSUPPORTED;
    g->base.find = find, g->base.locate = locate;
    g->base.period = period_of(g->dataset);
    return TC_OK;
}

static tc_gdal_image *make_image(const char *path)
{
    tc_gdal_image *g = calloc(1, sizeof *g + strlen(path) + 1);
    if (!g)
        return NULL;
    strcpy(g->path, path);
    g->base = (tc_image){.name = g->path, .read = read_level, .close = close_image};
    return g;
}

tc_status tc_gdal_cache_image(tc_image_rows *rows, const tc_image_options *options, tc_image **image_ret,
                              tc_error *error)
{
    tc_gdal_start();
    tc_gdal_image *g = make_image(rows->name);
    if (!g)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", rows->name);
    tc_status status = tc_gdal_image_levels(g, rows, options, error);
    if (status == TC_OK)
        *image_ret = &g->base;
    else
        close_image(&g->base);
    return status;
}

tc_status tc_gdal_open_image(const char *path, const tc_image_map *map, const tc_image_options *options,
                             bool *recognised, tc_image **image_ret, tc_error *error)
{
    tc_gdal_start();
    *recognised = false;
    tc_gdal_image *g = make_image(path);
    if (!g)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    tc_status status = tc_gdal_open_dataset(path, path, &g->dataset, recognised, error);
    if (status == TC_OK)
        g->base.parts = tc_gdal_all_files(g->dataset);
    if (status == TC_OK)
        tc_gdal_tell_credit(g->dataset, options->source);
    if (status == TC_OK)
        status = tc_gdal_pixels_of(path, g->dataset, options->source, &g->pixels, error);
    if (status == TC_OK)
        status = place(g, map, options, error);
    if (status == TC_OK)
        status = tc_gdal_image_levels(g, NULL, options, error);
    if (status == TC_OK)
        *image_ret = &g->base;
    else
        close_image(&g->base);
    return status;
}
