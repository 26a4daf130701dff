/* plugin_gdal_write.c - GeoTIFF out: tiled, compressed, strip by strip so that the memory is bounded. */
#include "plugin_gdal.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <stdlib.h>
#include <string.h>

enum { TILE = 256 }; /* rows of a strip */

/* How a sample type is called in GDAL. */
static const struct {
    GDALDataType type;
    int size;
    bool integer;
} types[] = {
    [TC_SAMPLE_UINT8] = {GDT_Byte, 1, true},    [TC_SAMPLE_INT8] = {GDT_Byte, 1, true},
    [TC_SAMPLE_UINT16] = {GDT_UInt16, 2, true}, [TC_SAMPLE_INT16] = {GDT_Int16, 2, true},
    [TC_SAMPLE_UINT32] = {GDT_UInt32, 4, true}, [TC_SAMPLE_INT32] = {GDT_Int32, 4, true},
    [TC_SAMPLE_FLOAT32] = {GDT_Float32, 4},     [TC_SAMPLE_FLOAT64] = {GDT_Float64, 8},
};

static GDALDatasetH create(const char *temporary, const tc_tiff_options *options)
{
    char **how = NULL;
    how = CSLSetNameValue(how, "TILED", "YES");
    how = CSLSetNameValue(how, "COMPRESS", "DEFLATE");
    how = CSLSetNameValue(how, "PREDICTOR", types[options->type].integer ? "2" : "3");
    how = CSLSetNameValue(how, "NUM_THREADS", "ALL_CPUS");
    how = CSLSetNameValue(how, "BIGTIFF", "IF_SAFER");
    GDALDataType type = types[options->type].type;
    if (options->type == TC_SAMPLE_INT8) {
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 7, 0)
        type = GDT_Int8;
#else
        how = CSLSetNameValue(how, "PIXELTYPE", "SIGNEDBYTE");
#endif
    }
    GDALDatasetH dataset =
        GDALCreate(GDALGetDriverByName("GTiff"), temporary, (int)options->width, (int)options->height, 1, type, how);
    CSLDestroy(how);
    return dataset;
}

/* Where it lies. */
static bool set_georeference(GDALDatasetH dataset, const tc_tiff_options *options)
{
    const tc_georef *georef = options->georef;
    const char *registration = options->area_registered ? "Area" : "Point";
    if (GDALSetMetadataItem(dataset, "AREA_OR_POINT", registration, NULL) != CE_None)
        return false;
    /* Without a georeference sample centres lie at multiples of the spacing, the south-west one at the origin; GDAL's
     * transform is that of pixel corners. A local system says that the unit is the metre. */
    double s = options->spacing, transform[6] = {-0.5 * s, s, 0, ((double)options->height - 0.5) * s, 0, -s};
    const char *wkt = TC_LOCAL_CRS;
    if (georef && georef->known) {
        memcpy(transform, georef->transform, sizeof transform);
        wkt = georef->crs_wkt;
    }
    if (GDALSetGeoTransform(dataset, transform) != CE_None)
        return false;
    OGRSpatialReferenceH crs = wkt ? OSRNewSpatialReference(wkt) : NULL;
    if (crs) {
        OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
        GDALSetSpatialRef(dataset, crs);
        OSRDestroySpatialReference(crs);
    }
    return true;
}

static bool set_credits(GDALDatasetH dataset, const tc_tiff_options *options)
{
    return !options->credits || GDALSetMetadataItem(dataset, "TIFFTAG_COPYRIGHT", options->credits, NULL) == CE_None;
}

/* What its values mean. */
static bool set_meaning(GDALRasterBandH band, const tc_tiff_options *options)
{
    if (options->has_nodata && GDALSetRasterNoDataValue(band, options->nodata) != CE_None)
        return false;
    if (options->unit > 0 && options->unit != 1 && GDALSetRasterScale(band, options->unit) != CE_None)
        return false;
    return options->offset == 0 || GDALSetRasterOffset(band, options->offset) == CE_None;
}

tc_status tc_gdal_write_tiff(const char *path, const char *temporary, const tc_tiff_options *options,
                             tc_sample_row_function row, void *context, tc_error *error)
{
    tc_gdal_start();
    int width = (int)options->width, height = (int)options->height, size = types[options->type].size;
    char *strip = malloc((size_t)width * TILE * (size_t)size);
    if (!strip)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %d columns", path, width);

    tc_gdal_messages said;
    tc_gdal_listen(&said);
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO"); /* no .aux.xml beside the file */
    GDALDatasetH dataset = create(temporary, options);
    tc_status status = TC_OK;
    bool failed = dataset == NULL;
    if (dataset) {
        GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
        failed = !set_georeference(dataset, options) || !set_credits(dataset, options) || !set_meaning(band, options);
        GDALDataType type = GDALGetRasterDataType(band);
        for (int y = 0; y < height && !failed && status == TC_OK; y += TILE) {
            int rows = height - y < TILE ? height - y : TILE;
            for (int k = 0; k < rows && status == TC_OK; k++)
                status = row(context, height - 1 - (y + k), strip + (size_t)k * (size_t)width * (size_t)size);
            if (status == TC_OK)
                failed = GDALRasterIO(band, GF_Write, 0, y, width, rows, strip, width, rows, type, 0, 0) != CE_None ||
                         GDALFlushRasterCache(band) != CE_None; /* keeps the memory bounded */
        }
        GDALClose(dataset); /* writes the directory; tells of failure only by a message */
        failed |= *said.failure != '\0';
    }
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", NULL);
    const char *why = tc_gdal_heard(&said);
    free(strip);
    if (status == TC_OK && failed)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, why);
    return status;
}
