/* plugin_gdal_warp.c - a raster in any coordinate system as one in longitude and latitude.
 *
 * Where the way from columns and rows to degrees is straight (equirectangular and simple cylindrical maps) the samples
 * stay as they are and only their place is told anew. Else GDAL warps while it reads: columns are as far apart as the
 * raster's own samples are on the parallel where they are finest, rows as in the raster's middle. */
#include "plugin_gdal.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_utils.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Along a side of a raster: places that are looked at, and those by which it is told how far it goes. */
enum { PARTS = 64, EXTENT_PARTS = 512 };

/* ---- Straight ways ---------------------------------------------------------------------------------------------- */

/* The transform to degrees of a raster whose columns are meridians and whose rows parallels, evenly spaced. */
static bool straight(const tc_gdal_places *places, double w, double h, double t[6])
{
    const double off = 0.01; /* of a sample */
    double middle[2], east[2], north[2];
    if (!tc_gdal_place_of(places, w / 2, h / 2, middle) || !tc_gdal_place_of(places, w * 7 / 8, h / 2, east) ||
        !tc_gdal_place_of(places, w / 2, h / 8, north))
        return false;
    double dx = tc_gdal_turn(east[0] - middle[0]) / (w * 3 / 8), dy = (north[1] - middle[1]) / (h * 3 / 8);
    if (!(dx != 0) || !(dy != 0))
        return false;
    for (int k = 0; k < (PARTS - 1) * (PARTS - 1); k++) {
        double column = w * (1 + k % (PARTS - 1)) / PARTS, row = h * (1 + k / (PARTS - 1)) / PARTS, place[2];
        if (!tc_gdal_place_of(places, column, row, place))
            return false;
        double x = tc_gdal_turn(place[0] - middle[0] - (column - w / 2) * dx), y = place[1] - middle[1];
        if (fabs(x) > off * fabs(dx) || fabs(y + (row - h / 2) * dy) > off * fabs(dy))
            return false;
    }
    t[0] = middle[0] - w / 2 * dx, t[1] = dx, t[2] = 0;
    t[3] = middle[1] + h / 2 * dy, t[4] = 0, t[5] = -dy;
    return true;
}

/* ---- Warping ---------------------------------------------------------------------------------------------------- */

/* What a raster covers, and how fine its samples are, in degrees. */
typedef struct cover {
    double west, south, east, north;
    double columns, rows; /* between samples */
} cover;

static bool inside(const double transform[6], double w, double h, double x, double y)
{
    const double *t = transform;
    double determinant = t[1] * t[5] - t[2] * t[4];
    double column = ((x - t[0]) * t[5] - (y - t[3]) * t[2]) / determinant;
    double row = ((y - t[3]) * t[1] - (x - t[0]) * t[4]) / determinant;
    return column >= 0 && column <= w && row >= 0 && row <= h;
}

/* Whether the raster has a pole within. */
static bool has_pole(OGRSpatialReferenceH crs, OGRSpatialReferenceH lonlat, const double t[6], double w, double h,
                     double latitude)
{
    OGRSpatialReferenceH to = OSRClone(crs);
    OSRSetAxisMappingStrategy(to, OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformationH back = OCTNewCoordinateTransformation(lonlat, to);
    double x[2] = {0, 90}, y[2] = {latitude, latitude};
    bool found = back && OCTTransform(back, 2, x, y, NULL) && isfinite(x[0]) && isfinite(y[0]) &&
                 /* a point there, not a line along the map's edge */
                 hypot(x[1] - x[0], y[1] - y[0]) < hypot(t[1], t[4]) && inside(t, w, h, x[0], y[0]);
    OCTDestroyCoordinateTransformation(back);
    OSRDestroySpatialReference(to);
    return found;
}

static bool find_cover(const tc_gdal_places *places, double w, double h, bool north_pole, bool south_pole,
                       cover *cover_ret)
{
    cover c = {INFINITY, INFINITY, -INFINITY, -INFINITY, INFINITY, 0};
    double middle = NAN, nearest = INFINITY;
    /* All longitudes are counted from the place nearest to the middle. */
    for (int k = 0; k < (PARTS + 1) * (PARTS + 1); k++) {
        double column = w * (k % (PARTS + 1)) / PARTS, row = h * (k / (PARTS + 1)) / PARTS, place[2], x, y;
        if (!tc_gdal_place_of(places, column, row, place) || !tc_gdal_spacing_at(places, column, row, 0.5, &x, &y))
            continue;
        double from = hypot(column / w - 0.5, row / h - 0.5);
        double degrees = sqrt(x * y) / places->semi_major / TC_RADIANS_PER_DEGREE;
        if (from < nearest && degrees > 0)
            nearest = from, middle = place[0], c.rows = degrees;
        if (degrees > 0 && fabs(place[1]) < 89.9)
            c.columns = fmin(c.columns, degrees / cos(place[1] * TC_RADIANS_PER_DEGREE));
    }
    /* Interrupted maps come to a pole in points. */
    int across = (int)fmin(w, EXTENT_PARTS), down = (int)fmin(h, EXTENT_PARTS);
    for (int k = 0; k < (across + 1) * (down + 1) && !isnan(middle); k++) {
        double place[2];
        if (!tc_gdal_place_of(places, w * (k % (across + 1)) / across, h * (k / (across + 1)) / down, place))
            continue;
        double longitude = middle + tc_gdal_turn(place[0] - middle);
        c.west = fmin(c.west, longitude), c.east = fmax(c.east, longitude);
        c.south = fmin(c.south, place[1]), c.north = fmax(c.north, place[1]);
    }
    if (!(c.west < c.east) || !(c.south < c.north) || !(c.rows > 0) || !isfinite(c.columns))
        return false;
    c.north = north_pole ? 90 : c.north, c.south = south_pole ? -90 : c.south;
    if (north_pole || south_pole || c.east - c.west > 360 - 360. / PARTS)
        c.west = -180, c.east = 180;
    *cover_ret = c;
    return true;
}

/* As many columns as levels of detail can halve: within 3 % of those that are needed. */
static int even_columns(double columns)
{
    double step = exp2(fmax(0, floor(log2(columns)) - 5));
    return (int)(ceil(columns / step - 1e-6) * step);
}

static GDALDatasetH warped(GDALDatasetH dataset, OGRSpatialReferenceH crs, OGRSpatialReferenceH lonlat, const cover *c)
{
    char numbers[6][40], *wkt = NULL, *from = NULL;
    double width = (c->east - c->west) / c->columns, height = (c->north - c->south) / c->rows;
    if (!(width >= 1 && height >= 1 && width < 1 << 30 && height < 1 << 30))
        return NULL;
    static const char *const wkt2[] = {"FORMAT=WKT2_2018", NULL};
    OGRSpatialReferenceH flat = OSRClone(crs); /* heights stay in their unit, which source.c takes to metres */
    OSRStripVertical(flat);
    OSRExportToWktEx(lonlat, &wkt, wkt2), OSRExportToWktEx(flat, &from, wkt2);
    OSRDestroySpatialReference(flat);
    const double edges[4] = {c->west, c->south, c->east, c->north};
    for (int i = 0; i < 4; i++)
        snprintf(numbers[i], sizeof numbers[i], "%.15g", edges[i]);
    snprintf(numbers[4], sizeof numbers[4], "%d", even_columns(width));
    snprintf(numbers[5], sizeof numbers[5], "%d", (int)ceil(height - 1e-6));
    char *options[] = {"-of",      "VRT",      "-s_srs",    from,       "-t_srs", wkt,        "-te",
                       numbers[0], numbers[1], numbers[2],  numbers[3], "-ts",    numbers[4], numbers[5],
                       "-r",       "cubic",    "-dstalpha", "-et",      "0.125",  "-wo",      "NUM_THREADS=ALL_CPUS",
                       NULL};
    GDALWarpAppOptions *how = GDALWarpAppOptionsNew(options, NULL);
    GDALDatasetH warp = how ? GDALWarp("", NULL, 1, &dataset, how, NULL) : NULL;
    GDALWarpAppOptionsFree(how);
    CPLFree(wkt), CPLFree(from);
    return warp;
}

/* The first band in floating point, so that what lies between integers stays there. */
static GDALDatasetH in_floats(GDALDatasetH dataset, int band)
{
    char number[12];
    snprintf(number, sizeof number, "%d", band);
    char *options[] = {"-of", "VRT", "-ot", "Float32", "-b", number, "-mask", "auto", NULL};
    GDALTranslateOptions *how = GDALTranslateOptionsNew(options, NULL);
    GDALDatasetH floats = how ? GDALTranslate("", dataset, how, NULL) : NULL;
    GDALTranslateOptionsFree(how);
    return floats;
}

tc_status tc_gdal_onto_globe(const char *path, GDALDatasetH *dataset, int band, OGRSpatialReferenceH crs,
                             const tc_source_options *options, tc_gdal_lonlat *lonlat_ret, tc_error *error)
{
    OGRSpatialReferenceH lonlat = tc_gdal_lonlat_of(crs);
    double t[6], w = GDALGetRasterXSize(*dataset), h = GDALGetRasterYSize(*dataset);
    tc_gdal_places places = {0};
    cover c;
    bool placed = lonlat && GDALGetGeoTransform(*dataset, t) == CE_None && tc_gdal_places_open(crs, lonlat, t, &places);
    tc_status status = TC_OK;
    *lonlat_ret = (tc_gdal_lonlat){.crs = lonlat};
    if (!placed) {
        status = tc_fail(error, TC_ERR_UNSUPPORTED,
                         "%s: expected a coordinate system that can be taken to longitude and latitude, found one that "
                         "PROJ cannot",
                         path);
    } else if (straight(&places, w, h, lonlat_ret->transform)) {
        lonlat_ret->straight = true;
    } else if (!find_cover(&places, w, h, has_pole(crs, lonlat, t, w, h, 90), has_pole(crs, lonlat, t, w, h, -90),
                           &c)) {
        status = tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected places on the globe, found none", path);
    } else if (options->exact) {
        status =
            tc_fail(error, TC_ERR_UNSUPPORTED,
                    "%s: lossless: expected longitude and latitude, found a map that would have to be resampled", path);
    } else {
        lonlat_ret->floats = in_floats(*dataset, band);
        GDALDatasetH warp = lonlat_ret->floats ? warped(lonlat_ret->floats, crs, lonlat, &c) : NULL;
        if (warp) {
            lonlat_ret->stored = *dataset;
            *dataset = warp;
            tc_say(options, false,
                   "warped to longitude and latitude while it is read: %d x %d samples from %.0f x %.0f, "
                   "%.6g to %.6g and %.6g to %.6g degrees",
                   GDALGetRasterXSize(warp), GDALGetRasterYSize(warp), w, h, c.west, c.east, c.south, c.north);
        } else {
            status = tc_fail(error, TC_ERR_UNSUPPORTED, "%s: cannot be warped to longitude and latitude", path);
        }
    }
    if (places.to_lonlat)
        tc_gdal_places_close(&places);
    return status;
}

void tc_gdal_lonlat_close(tc_gdal_lonlat *lonlat)
{
    if (lonlat->floats)
        GDALClose(lonlat->floats);
    if (lonlat->stored)
        GDALClose(lonlat->stored);
    OSRDestroySpatialReference(lonlat->crs);
    *lonlat = (tc_gdal_lonlat){0};
}
