/* plugin_gdal.c - terraclip-gdal.so: elevation files through GDAL's C API (GeoTIFF out: plugin_gdal_write.c).
 *
 * GDAL is kept silent (messages are collected and the first failure goes into our error), off the network (drivers
 * that fetch are left out, remote file names inside a VRT are refused) and away from the user's folders (side files
 * are read, since nodata and coordinate systems live there, but never written). */
#include "plugin_gdal_image.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Set-up and messages ---------------------------------------------------------------------------------------- */

static void CPL_STDCALL collect(CPLErr severity, CPLErrorNum number, const char *text)
{
    (void)number;
    tc_gdal_messages *m = CPLGetErrorHandlerUserData();
    if (!m)
        return;
    char *kept = severity >= CE_Failure ? m->failure : severity == CE_Warning ? m->warning : NULL;
    if (kept && !*kept)
        snprintf(kept, sizeof m->failure, "%s", text);
}

void tc_gdal_listen(tc_gdal_messages *m)
{
    memset(m, 0, sizeof *m);
    CPLPushErrorHandlerEx(collect, m);
}

const char *tc_gdal_heard(const tc_gdal_messages *m)
{
    CPLPopErrorHandler();
    return *m->failure ? m->failure : *m->warning ? m->warning : "GDAL gives no reason";
}

/* Of GDAL's cache of decoded blocks. */
enum { CACHE_BYTES = 64 << 20, MOST_CACHE_BYTES = 512 << 20 };

static void start_gdal(void)
{
    static const struct {
        const char *key, *value;
    } settings[] = {
        {"GDAL_NUM_THREADS", "ALL_CPUS"},         /* compressed tiles are decoded in parallel */
        {"GDAL_ERROR_ON_LIBJPEG_WARNING", "YES"}, /* else a truncated JPEG is filled up with grey */
        {"RAW_CHECK_FILE_SIZE", "YES"},
        {"GDAL_VRT_ENABLE_PYTHON", "NO"}, /* opening a file runs no code */
        /* No network: no fetching drivers, no URL has this ending, and were one opened after all, no proxy answers. */
        {"GDAL_SKIP",
         "WMS WCS WMTS HTTP PLMOSAIC EEDA EEDAI DAAS OGCAPI NGW STACTA STACIT RDA IIP "
         "PostGISRaster RasterLite GeoRaster TGA"}, /* TGA: takes truncated files for whole; OpenImageIO reads it */
        {"CPL_VSIL_CURL_ALLOWED_EXTENSIONS", ".no-network"},
        {"GDAL_HTTP_PROXY", "127.0.0.1:9"},
        {"PROJ_NETWORK", "OFF"},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        CPLSetConfigOption(settings[i].key, settings[i].value);
    CPLSetErrorHandlerEx(collect, NULL); /* also for GDAL's own threads, which inherit no pushed handler */
    GDALAllRegister();
    /* Whole rows of blocks are read at once, so a cache of a twentieth of the memory would only hold what has been
     * converted already. */
    GDALSetCacheMax64(CACHE_BYTES);
}

void tc_gdal_start(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, start_gdal);
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

typedef struct gdal_raster {
    tc_raster base;
    GDALDatasetH dataset;
    tc_gdal_lonlat lonlat;
    tc_gdal_text text;
    GDALRasterBandH band, mask;
    GDALDataType type; /* of the buffer */
    char path[];
} gdal_raster;

/* Says how the band's samples lie in a buffer; false for what cannot be heights. */
static bool choose_type(GDALRasterBandH band, gdal_raster *r)
{
    tc_raster_info *info = &r->base.info;
    info->integer = true;
    r->type = GDALGetRasterDataType(band);
    switch (r->type) {
    case GDT_Byte:
        info->type = TC_SAMPLE_UINT8;
        info->type_name = "uint8";
        const char *signedness = GDALGetMetadataItem(band, "PIXELTYPE", "IMAGE_STRUCTURE");
        if (signedness && EQUAL(signedness, "SIGNEDBYTE")) {
            info->type = TC_SAMPLE_INT8;
            info->type_name = "int8";
        }
        return true;
    case GDT_UInt16:
        info->type = TC_SAMPLE_UINT16;
        info->type_name = "uint16";
        return true;
    case GDT_Int16:
        info->type = TC_SAMPLE_INT16;
        info->type_name = "int16";
        return true;
    case GDT_UInt32:
        info->type = TC_SAMPLE_UINT32;
        info->type_name = "uint32";
        return true;
    case GDT_Int32:
        info->type = TC_SAMPLE_INT32;
        info->type_name = "int32";
        return true;
    case GDT_Float32:
        info->type = TC_SAMPLE_FLOAT32;
        info->type_name = "float32";
        info->integer = false;
        return true;
    case GDT_Float64:
        info->type = TC_SAMPLE_FLOAT64;
        info->type_name = "float64";
        info->integer = false;
        return true;
    default: break;
    }
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 5, 0)
    if (r->type == GDT_Int64 || r->type == GDT_UInt64) {
        info->type = TC_SAMPLE_FLOAT64;
        info->type_name = r->type == GDT_Int64 ? "int64" : "uint64";
        r->type = GDT_Float64;
        return true;
    }
#endif
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 7, 0)
    if (r->type == GDT_Int8) {
        info->type = TC_SAMPLE_INT8;
        info->type_name = "int8";
        return true;
    }
#endif
    return false;
}

static void read_nodata(GDALRasterBandH band, tc_raster_info *info)
{
    int has = 0;
    double value = GDALGetRasterNoDataValue(band, &has);
#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 5, 0)
    if (GDALGetRasterDataType(band) == GDT_Int64)
        value = (double)GDALGetRasterNoDataValueAsInt64(band, &has);
    else if (GDALGetRasterDataType(band) == GDT_UInt64)
        value = (double)GDALGetRasterNoDataValueAsUInt64(band, &has);
#endif
    info->has_nodata = has;
    info->nodata = has ? value : 0;
}

static void read_transform(GDALDatasetH dataset, tc_raster_info *info)
{
    static const double unset[6] = {0, 1, 0, 0, 0, 1}; /* what GDAL means by "none" where it gives one all the same */
    double t[6];
    if (GDALGetGeoTransform(dataset, t) == CE_None && memcmp(t, unset, sizeof t) != 0) {
        info->has_transform = true;
        memcpy(info->transform, t, sizeof t);
    }
    info->has_control_points = !info->has_transform && GDALGetGCPCount(dataset) > 0;
    const char *registration = GDALGetMetadataItem(dataset, "AREA_OR_POINT", NULL);
    info->area_registered = info->has_transform && !(registration && EQUAL(registration, "Point"));
}

/* The system that is to be gone by: that of the options, else the file's own; destroyed by the caller. NULL none. */
static tc_status find_crs(const gdal_raster *r, const tc_source_options *options, OGRSpatialReferenceH *crs_ret,
                          tc_error *error)
{
    OGRSpatialReferenceH own = GDALGetSpatialRef(r->dataset);
    *crs_ret = NULL;
    if (!options->crs) {
        *crs_ret = own ? OSRClone(own) : NULL;
        return TC_OK;
    }
    OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
    bool here = !strstr(options->crs, "://") && !strstr(options->crs, "/vsi");
    if (!here || OSRSetFromUserInput(crs, options->crs) != OGRERR_NONE) {
        OSRDestroySpatialReference(crs);
        return tc_fail(error, TC_ERR_USAGE, "--crs: expected a coordinate system as PROJ knows them, found '%.100s'",
                       options->crs);
    }
    if (!r->base.info.has_transform) {
        OSRDestroySpatialReference(crs);
        return tc_fail(error, TC_ERR_USAGE, "--crs: expected a file that says where its samples are, found %s",
                       r->path);
    }
    *crs_ret = crs;
    return TC_OK;
}

/* Where the samples lie: as the file says, or on the globe. */
static tc_status place(gdal_raster *r, const tc_source_options *options, int band, tc_error *error)
{
    tc_raster_info *info = &r->base.info;
    OGRSpatialReferenceH crs;
    read_transform(r->dataset, info);
    tc_status status = find_crs(r, options, &crs, error);
    if (status || !crs)
        return status;
    bool other = OSRIsProjected(crs) || (OSRIsGeographic(crs) && OSRIsDerivedGeographic(crs));
    if (options->lonlat && info->has_transform && other) {
        status = tc_gdal_onto_globe(r->path, &r->dataset, band, crs, options, &r->lonlat, error);
        if (status == TC_OK && r->lonlat.straight)
            memcpy(info->transform, r->lonlat.transform, sizeof info->transform);
        else if (status == TC_OK)
            read_transform(r->dataset, info);
        if (status == TC_OK)
            status = tc_gdal_read_crs(r->path, r->lonlat.crs, info, error);
    } else {
        status = tc_gdal_read_crs(r->path, crs, info, error);
    }
    OSRDestroySpatialReference(crs);
    return status;
}

/* Why rows cannot be read: messages of the threads that decode many blocks at once are lost, so the blocks are read one
 * by one until one fails here. */
static void find_damage(gdal_raster *r, int y, int height, void *samples, tc_gdal_messages *said)
{
    int width = (int)r->base.info.width, block_width = 0, block_height = 0;
    GDALGetBlockSize(r->band, &block_width, &block_height);
    if (block_width < 1 || block_height < 1)
        return;
    for (int row = y; row < y + height; row += block_height) {
        int rows = y + height - row < block_height ? y + height - row : block_height;
        for (int x = 0; x < width; x += block_width) {
            int columns = width - x < block_width ? width - x : block_width;
            if (GDALRasterIO(r->band, GF_Read, x, row, columns, rows, samples, columns, rows, r->type, 0, 0) ||
                *said->failure)
                return;
        }
    }
}

static tc_status read_rows(tc_raster *raster, int64_t row, int64_t rows, void *samples, uint8_t *mask, tc_error *error)
{
    gdal_raster *r = (gdal_raster *)raster;
    int width = (int)r->base.info.width, y = (int)row, height = (int)rows;
    tc_status status = tc_gdal_text_check(&r->text, r->path, error);
    if (status != TC_OK)
        return status;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    CPLErr failed = GDALRasterIO(r->band, GF_Read, 0, y, width, height, samples, width, height, r->type, 0, 0);
    if (!failed && r->mask)
        failed = GDALRasterIO(r->mask, GF_Read, 0, y, width, height, mask, width, height, GDT_Byte, 0, 0);
    if (failed && !*said.failure)
        find_damage(r, y, height, samples, &said);
    const char *why = tc_gdal_heard(&said);
    if (failed)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read to its end, damaged or truncated: %s", r->path, why);
    return TC_OK;
}

static void close_raster(tc_raster *raster)
{
    gdal_raster *r = (gdal_raster *)raster;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    if (r->dataset)
        GDALClose(r->dataset);
    tc_gdal_lonlat_close(&r->lonlat);
    tc_gdal_text_free(&r->text);
    tc_gdal_heard(&said);
    CSLDestroy(r->base.info.parts);
    free(r->base.info.crs_wkt);
    free(r);
}

/* A VRT is text that may name files on the network; nothing else that GDAL opens here does. */
static bool names_remote_files(const char *path)
{
    static const char *const remote[] = {"/vsicurl",  "/vsis3",      "/vsigs",   "/vsiaz",  "/vsiadls", "/vsioss",
                                         "/vsiswift", "/vsiwebhdfs", "/vsihdfs", "http://", "https://", "ftp://"};
    GByte *text = NULL; /* also of one in an archive */
    if (!VSIIngestFile(NULL, path, &text, NULL, 1 << 30))
        return false;
    bool found = false;
    char *rest = NULL;
    for (char *line = strtok_r((char *)text, "\n", &rest); line && !found; line = strtok_r(NULL, "\n", &rest))
        for (size_t i = 0; i < sizeof remote / sizeof *remote; i++)
            /* Only where a source is named: coordinate systems cite URLs too. */
            found |= strstr(line, "SourceFilename") && strstr(line, remote[i]);
    VSIFree(text);
    return found;
}

/* GDAL names the files of a VRT, but not those of the VRTs that it is made of. */
char **tc_gdal_all_files(GDALDatasetH dataset)
{
    enum { MOST = 1 << 16 };
    char **files = GDALGetFileList(dataset);
    for (int i = 1; files && i < CSLCount(files) && i < MOST; i++) {
        GDALDriverH driver = GDALIdentifyDriverEx(files[i], GDAL_OF_RASTER, NULL, NULL);
        if (!driver || !EQUAL(GDALGetDriverShortName(driver), "VRT") || names_remote_files(files[i]))
            continue;
        GDALDatasetH part = GDALOpenEx(files[i], GDAL_OF_RASTER | GDAL_OF_READONLY, NULL, NULL, NULL);
        char **inner = part ? GDALGetFileList(part) : NULL;
        for (int k = 0; inner && inner[k]; k++)
            if (CSLFindString(files, inner[k]) < 0)
                files = CSLAddString(files, inner[k]);
        CSLDestroy(inner);
        if (part)
            GDALClose(part);
    }
    return files;
}

/* Rows may be read in smaller portions than those of blocks: none should be decoded twice for that. */
static void keep_two_rows_of_blocks(const gdal_raster *r)
{
    const tc_raster_info *info = &r->base.info;
    GIntBig bytes = 2 * (GIntBig)info->width * info->block_rows * GDALGetDataTypeSizeBytes(r->type);
    if (bytes > GDALGetCacheMax64() && bytes <= MOST_CACHE_BYTES)
        GDALSetCacheMax64(bytes);
}

static bool is_colour(GDALRasterBandH band)
{
    GDALColorInterp meaning = GDALGetRasterColorInterpretation(band);
    return (meaning >= GCI_RedBand && meaning <= GCI_YCbCr_CrBand) || GDALGetRasterDataType(band) == GDT_Byte;
}

/* Which band holds the heights, and whether the second one is its mask. */
static tc_status choose_band(const gdal_raster *r, const tc_source_options *options, int *band_ret, bool *alpha_ret,
                             tc_error *error)
{
    int bands = GDALGetRasterCount(r->dataset), band = options->band > 0 ? options->band : 1;
    *alpha_ret = false;
    if (band > bands)
        return tc_fail(error, TC_ERR_USAGE, "--band: expected 1..%d in %s, found %d", bands, r->path, band);
    GDALRasterBandH chosen = GDALGetRasterBand(r->dataset, band);
    if (GDALGetRasterColorInterpretation(chosen) == GCI_PaletteIndex)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected heights, found indices into a palette of colours",
                       r->path);
    *alpha_ret =
        bands == 2 && band == 1 && GDALGetRasterColorInterpretation(GDALGetRasterBand(r->dataset, 2)) == GCI_AlphaBand;
    if (bands > 2 && options->band == 0 && is_colour(chosen))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected one channel of heights, found %s channels: %s", r->path,
                       bands == 3 ? "three" : "more than three", tc_channels_advice());
    if (bands > 1 && !*alpha_ret && options->band == 0) {
        const char *name = GDALGetDescription(chosen);
        tc_say(options, true, "%d bands: the first%s%.60s is taken for heights; --band N takes another", bands,
               *name ? ", " : "", name);
    }
    *band_ret = band;
    return TC_OK;
}

/* Fills in what the opened dataset says of itself, or refuses it. */
static tc_status describe(gdal_raster *r, const tc_source_options *options, tc_error *error)
{
    tc_raster_info *info = &r->base.info;
    int band = 1;
    bool alpha = false;
    tc_status status = choose_band(r, options, &band, &alpha, error);
    if (status != TC_OK)
        return status;
    r->band = GDALGetRasterBand(r->dataset, band);
    int given = 0;
    double scale = GDALGetRasterScale(r->band, &given);
    info->scale = given && scale != 0 && isfinite(scale) ? scale : 1;
    double offset = GDALGetRasterOffset(r->band, &given);
    info->offset = given && isfinite(offset) ? offset : 0;
    snprintf(info->unit_name, sizeof info->unit_name, "%s", GDALGetRasterUnitType(r->band));
    if (!choose_type(r->band, r))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected real numbers, found samples of type %s", r->path,
                       GDALGetDataTypeName(r->type));

    status = place(r, options, band, error);
    if (status != TC_OK)
        return status;
    if (r->lonlat.stored) { /* it is another dataset now: floats, and whether there are any */
        r->band = GDALGetRasterBand(r->dataset, 1);
        choose_type(r->band, r);
        alpha = true;
    }
    info->width = GDALGetRasterXSize(r->dataset);
    info->height = GDALGetRasterYSize(r->dataset);
    int block_width = 0, block_height = 0;
    GDALGetBlockSize(r->band, &block_width, &block_height);
    info->block_rows = block_height > 0 ? block_height : 1;
    keep_two_rows_of_blocks(r);

    read_nodata(r->band, info);
    int flags = GDALGetMaskFlags(r->band);
    if (!(flags & (GMF_ALL_VALID | GMF_NODATA)) || alpha) {
        /* Of a warped raster nodata values are one reason for a void; its second band knows all. */
        r->mask = r->lonlat.stored ? GDALGetRasterBand(r->dataset, 2) : GDALGetMaskBand(r->band);
        info->has_mask = r->mask != NULL;
    }
    return TC_OK;
}

tc_status tc_gdal_open_dataset(const char *path, const char *name, GDALDatasetH *dataset_ret, bool *recognised,
                               tc_error *error)
{
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    GDALDriverH driver = GDALIdentifyDriverEx(name, GDAL_OF_RASTER, NULL, NULL);
    const char *format = driver ? GDALGetDriverShortName(driver) : "";
    bool remote = EQUAL(format, "VRT") && names_remote_files(name);
    if (driver && !remote) {
        const char *const only[] = {format, NULL};
        *dataset_ret = GDALOpenEx(name, GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, only, NULL, NULL);
    }
    const char *why = tc_gdal_heard(&said);
    *recognised = driver != NULL; /* the file's format; whether it opens or not */
    if (!driver)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: of no elevation format that GDAL knows", path);
    if (remote)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: names files on the network, expected local files", path);
    if (!*dataset_ret)
        return tc_fail(error, TC_ERR_FORMAT, "%s: looks like %s but cannot be opened, damaged or truncated: %s", path,
                       format, why);
    return TC_OK;
}

void tc_gdal_tell_credit(GDALDatasetH dataset, const tc_source_options *options)
{
    static const char *const items[] = {"TIFFTAG_COPYRIGHT", "EXIF_Copyright", "COPYRIGHT", "ATTRIBUTION", "CREDIT",
                                        "TIFFTAG_ARTIST",    "EXIF_Artist",    "AUTHOR"};
    const char *text = NULL;
    if (!options || !options->credit)
        return;
    for (size_t k = 0; k < sizeof items / sizeof *items && (!text || !*text); k++)
        text = GDALGetMetadataItem(dataset, items[k], NULL);
    if (text && *text)
        options->credit(options->credit_context, text);
}

static tc_status open_raster(const char *path, const tc_source_options *options, bool *recognised,
                             tc_raster **raster_ret, tc_error *error)
{
    tc_gdal_start();
    *recognised = false;
    gdal_raster *r = calloc(1, sizeof *r + strlen(path) + 1);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    strcpy(r->path, path);
    r->base.read = read_rows;
    r->base.close = close_raster;

    char *inner = NULL;
    bool layer_taken = false;
    tc_status status = tc_gdal_look_inside(path, options, &inner, &layer_taken, error);
    *recognised = status != TC_OK || inner; /* a container */
    if (status == TC_OK)
        status = tc_gdal_open_dataset(path, inner ? inner : path, &r->dataset, recognised, error);
    CPLFree(inner);
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    if (status == TC_OK) {
        r->base.info.parts = tc_gdal_all_files(r->dataset);
        r->text = tc_gdal_text_of(r->dataset);
        status = tc_gdal_take_layer(path, options, layer_taken, &r->dataset, error);
    }
    if (status == TC_OK)
        tc_gdal_tell_credit(r->dataset, options);
    if (status == TC_OK)
        status = describe(r, options, error);
    tc_gdal_heard(&said);
    if (status == TC_OK)
        *raster_ret = &r->base;
    else
        close_raster(&r->base);
    return status;
}

static bool recognises(const char *path)
{
    tc_gdal_start();
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    bool known = GDALIdentifyDriverEx(path, GDAL_OF_RASTER, NULL, NULL) != NULL;
    tc_gdal_heard(&said);
    return known;
}

static bool same_crs(const char *wkt, const char *other_wkt)
{
    tc_gdal_start();
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    OGRSpatialReferenceH a = OSRNewSpatialReference(wkt), b = OSRNewSpatialReference(other_wkt);
    /* The order of axes does not matter: transforms are always x, y. */
    const char *const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", "CRITERION=EQUIVALENT", NULL};
    bool same = a && b && OSRIsSameEx(a, b, options);
    OSRDestroySpatialReference(a);
    OSRDestroySpatialReference(b);
    tc_gdal_heard(&said);
    return same;
}

extern const struct tc_gdal_plugin tc_plugin __attribute__((visibility("default"))); /* found by this name */
const struct tc_gdal_plugin tc_plugin = {.open = open_raster,
                                         .open_image = tc_gdal_open_image,
                                         .cache_image = tc_gdal_cache_image,
                                         .unpack_hgt = tc_gdal_unpack_hgt,
                                         .recognises = recognises,
                                         .write_tiff = tc_gdal_write_tiff,
                                         .ground = tc_gdal_ground,
                                         .same_crs = same_crs,
                                         .from_lonlat = tc_gdal_from_lonlat,
                                         .places_open = tc_gdal_ground_open,
                                         .place_of = tc_gdal_ground_at,
                                         .places_close = tc_gdal_ground_close};
