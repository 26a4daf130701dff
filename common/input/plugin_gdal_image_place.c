/* plugin_gdal_image_place.c - from places of a map to pixels of a picture in any coordinate system, and back. */
#include "plugin_gdal_image.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_alg.h>

#include <math.h>
#include <stdlib.h>

OGRSpatialReferenceH tc_gdal_image_system(GDALDatasetH dataset)
{
    OGRSpatialReferenceH system = GDALGetSpatialRef(dataset);
    if (!system)
        system = GDALGetGCPSpatialRef(dataset);
    char *wkt = NULL; /* GDAL has empty ones where it does not understand what a file says */
    bool named = system && OSRExportToWkt(system, &wkt) == OGRERR_NONE && wkt && *wkt;
    CPLFree(wkt);
    return named ? system : NULL;
}

/* The picture's own system, or on a globe its degrees; to be freed with CPLFree. NULL: it has none. */
static char *own_system(GDALDatasetH dataset, bool globe)
{
    OGRSpatialReferenceH own = tc_gdal_image_system(dataset);
    OGRSpatialReferenceH taken = !own ? NULL : globe ? tc_gdal_lonlat_of(own) : OSRClone(own);
    char *wkt = NULL;
    if (taken)
        OSRExportToWktEx(taken, &wkt, (const char *const[]){"FORMAT=WKT2_2018", NULL});
    OSRDestroySpatialReference(taken);
    return wkt;
}

void *tc_gdal_image_places(const char *name, GDALDatasetH dataset, const tc_image_map *map, tc_error *error)
{
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    char *own = map->crs_wkt ? NULL : own_system(dataset, map->globe);
    const char *wkt = map->crs_wkt ? map->crs_wkt : own;
    char **how = wkt ? CSLSetNameValue(NULL, "DST_SRS", wkt) : NULL; /* else none on either side */
    void *transformer = GDALCreateGenImgProjTransformer2(dataset, NULL, how);
    const char *why = tc_gdal_heard(&said);
    if (!transformer)
        tc_fail(error, TC_ERR_UNSUPPORTED, "%s: cannot be brought to the terrain's coordinate system: %s", name, why);
    CSLDestroy(how);
    CPLFree(own);
    return transformer;
}

static void transform(void *transformer, bool to_pixels, int count, double *x, double *y)
{
    int *good = calloc((size_t)count, sizeof *good);
    double *z = calloc((size_t)count, sizeof *z);
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    if (good && z)
        GDALGenImgProjTransform(transformer, to_pixels, count, x, y, z, good);
    for (int i = 0; i < count; i++)
        if (!good || !good[i] || !isfinite(x[i]) || !isfinite(y[i]))
            x[i] = y[i] = NAN;
    tc_gdal_heard(&said);
    free(good);
    free(z);
}

void tc_gdal_image_find(void *places, int count, double *x, double *y)
{
    transform(places, true, count, x, y);
}

void tc_gdal_image_locate(void *places, int count, double *x, double *y)
{
    transform(places, false, count, x, y);
}

void tc_gdal_image_places_close(void *places)
{
    if (places)
        GDALDestroyGenImgProjTransformer(places);
}
