/* plugin_gdal_crs.c - what a raster's coordinate system says, and where on the ground PROJ has its samples.
 *
 * Maps in degrees come out in degrees east of Greenwich, whatever their unit and prime meridian. */
#include "plugin_gdal.h"

#include "common/base/status.h"

#include <cpl_conv.h>
#include <ogr_srs_api.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Systems ---------------------------------------------------------------------------------------------------- */

OGRSpatialReferenceH tc_gdal_lonlat_of(OGRSpatialReferenceH crs)
{
    OGRSpatialReferenceH base = OSRCloneGeogCS(crs);
    if (!base)
        return NULL;
    char *meridian = NULL; /* GDAL's */
    double unit = OSRGetAngularUnits(base, NULL), from = OSRGetPrimeMeridian(base, &meridian);
    if (from != 0 || fabs(unit / TC_RADIANS_PER_DEGREE - 1) > 1e-9 || OSRIsDerivedGeographic(base)) {
        const char *name = OSRGetAttrValue(base, "GEOGCS", 0), *datum = OSRGetAttrValue(base, "DATUM", 0),
                   *spheroid = OSRGetAttrValue(base, "SPHEROID", 0);
        OGRSpatialReferenceH own = OSRNewSpatialReference(NULL);
        OGRErr failed = OSRSetGeogCS(own, name, datum, spheroid, OSRGetSemiMajor(base, NULL),
                                     OSRGetInvFlattening(base, NULL), "Greenwich", 0, "degree", TC_RADIANS_PER_DEGREE);
        OSRDestroySpatialReference(base);
        base = own;
        if (failed != OGRERR_NONE) {
            OSRDestroySpatialReference(base);
            return NULL;
        }
    }
    OSRSetAxisMappingStrategy(base, OAMS_TRADITIONAL_GIS_ORDER);
    return base;
}

static void keep_wkt(OGRSpatialReferenceH crs, tc_raster_info *info)
{
    static const char *const format[] = {"FORMAT=WKT2_2018", NULL};
    char *wkt = NULL;
    if (OSRExportToWktEx(crs, &wkt, format) == OGRERR_NONE && wkt && *wkt)
        info->crs_wkt = strdup(wkt);
    CPLFree(wkt);
}

/* The unit of heights, of a system that has a vertical part. */
static void read_vertical_unit(OGRSpatialReferenceH crs, tc_raster_info *info)
{
    if (!OSRIsCompound(crs) && !OSRIsVertical(crs))
        return;
    char *name = NULL; /* GDAL's */
    double metres = OSRGetTargetLinearUnits(crs, "VERT_CS", &name);
    if (metres > 0 && isfinite(metres)) {
        info->vertical_unit = metres;
        snprintf(info->vertical_name, sizeof info->vertical_name, "%s", name ? name : "");
    }
}

/* Degrees east of Greenwich from other angles east of another meridian. */
static void to_degrees(OGRSpatialReferenceH crs, tc_raster_info *info)
{
    char *name = NULL; /* GDAL's */
    double unit = info->crs_unit / TC_RADIANS_PER_DEGREE, meridian = OSRGetPrimeMeridian(crs, &name);
    OGRSpatialReferenceH lonlat = fabs(unit - 1) > 1e-9 || meridian != 0 ? tc_gdal_lonlat_of(crs) : NULL;
    if (!lonlat) {
        keep_wkt(crs, info);
        return;
    }
    snprintf(info->brought_from, sizeof info->brought_from, "%s", name ? name : "another meridian");
    for (int i = 0; i < 6; i++)
        info->transform[i] *= unit;
    info->transform[0] += meridian;
    info->crs_unit = TC_RADIANS_PER_DEGREE;
    keep_wkt(lonlat, info);
    OSRDestroySpatialReference(lonlat);
}

tc_status tc_gdal_read_crs(const char *path, OGRSpatialReferenceH crs, tc_raster_info *info, tc_error *error)
{
    read_vertical_unit(crs, info);
    if (OSRIsGeographic(crs) && OSRIsDerivedGeographic(crs))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected longitude and latitude, found those of a rotated globe; `gdalwarp -t_srs "
                       "EPSG:4326` makes a map of them",
                       path);
    if (OSRIsGeographic(crs)) {
        info->crs = TC_CRS_GEOGRAPHIC;
        info->crs_unit = OSRGetAngularUnits(crs, NULL);
    } else if (OSRIsProjected(crs) || OSRIsLocal(crs)) {
        char *unit = NULL; /* GDAL's */
        info->crs_unit = OSRGetLinearUnits(crs, &unit);
        if (unit && EQUAL(unit, "unknown"))
            return TC_OK; /* GDAL made the system up for a TIFF that only says how it is registered */
        info->crs = TC_CRS_PROJECTED;
    } else {
        return TC_OK;
    }
    OGRErr failed = OGRERR_NONE;
    double semi_major = OSRGetSemiMajor(crs, &failed);
    info->semi_major = failed == OGRERR_NONE ? semi_major : 0; /* on failure GDAL gives the Earth's */
    failed = OGRERR_NONE;
    double inverse_flattening = OSRGetInvFlattening(crs, &failed);
    info->inverse_flattening = failed == OGRERR_NONE ? inverse_flattening : 0;
    if (info->crs == TC_CRS_GEOGRAPHIC && info->has_transform)
        to_degrees(crs, info);
    else
        keep_wkt(crs, info);
    return TC_OK;
}

/* ---- Places ----------------------------------------------------------------------------------------------------- */

bool tc_gdal_places_open(OGRSpatialReferenceH crs, OGRSpatialReferenceH lonlat, const double transform[6],
                         tc_gdal_places *places_ret)
{
    OGRSpatialReferenceH from = OSRClone(crs);
    OSRSetAxisMappingStrategy(from, OAMS_TRADITIONAL_GIS_ORDER);
    *places_ret = (tc_gdal_places){.to_lonlat = OCTNewCoordinateTransformation(from, lonlat)};
    OSRDestroySpatialReference(from);
    memcpy(places_ret->transform, transform, sizeof places_ret->transform);
    double a = OSRGetSemiMajor(lonlat, NULL), inverse = OSRGetInvFlattening(lonlat, NULL);
    double f = inverse > 0 ? 1 / inverse : 0;
    places_ret->semi_major = a;
    places_ret->e2 = f * (2 - f);
    return places_ret->to_lonlat != NULL;
}

void tc_gdal_places_close(tc_gdal_places *places)
{
    OCTDestroyCoordinateTransformation(places->to_lonlat);
}

bool tc_gdal_place_of(const tc_gdal_places *places, double column, double row, double degrees[2])
{
    const double *t = places->transform;
    double x = t[0] + column * t[1] + row * t[2], y = t[3] + column * t[4] + row * t[5];
    if (!OCTTransform(places->to_lonlat, 1, &x, &y, NULL) || !isfinite(x) || !isfinite(y))
        return false;
    degrees[0] = x, degrees[1] = y;
    return true;
}

bool tc_gdal_from_lonlat(const char *wkt, const double degrees[2], double xy_ret[2])
{
    tc_gdal_start();
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    OGRSpatialReferenceH crs = OSRNewSpatialReference(wkt), lonlat = crs ? tc_gdal_lonlat_of(crs) : NULL;
    OGRCoordinateTransformationH to = NULL;
    if (lonlat) {
        OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
        to = OCTNewCoordinateTransformation(lonlat, crs);
    }
    double x = degrees[0], y = degrees[1];
    const bool there = to && OCTTransform(to, 1, &x, &y, NULL) && isfinite(x) && isfinite(y);
    if (there)
        xy_ret[0] = x, xy_ret[1] = y;
    OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(lonlat);
    OSRDestroySpatialReference(crs);
    tc_gdal_heard(&said);
    return there;
}

double tc_gdal_turn(double degrees)
{
    return degrees - 360 * round(degrees / 360);
}

/* Metres from the body's middle. */
static void in_space(const tc_gdal_places *places, const double degrees[2], double p[3])
{
    double longitude = degrees[0] * TC_RADIANS_PER_DEGREE, latitude = degrees[1] * TC_RADIANS_PER_DEGREE,
           s = sin(latitude);
    double n = places->semi_major / sqrt(1 - places->e2 * s * s);
    p[0] = n * cos(latitude) * cos(longitude), p[1] = n * cos(latitude) * sin(longitude);
    p[2] = n * (1 - places->e2) * s;
}

/* Metres on the ground from one place to another that is not far from it, also across a pole. */
static double apart(const tc_gdal_places *places, const double a[2], const double b[2])
{
    double p[3], q[3];
    in_space(places, a, p), in_space(places, b, q);
    double chord = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]), radius = places->semi_major;
    return 2 * radius * asin(fmin(1, chord / (2 * radius)));
}

bool tc_gdal_spacing_at(const tc_gdal_places *places, double column, double row, double half, double *x, double *y)
{
    double p[4][2];
    bool there =
        tc_gdal_place_of(places, column - half, row, p[0]) && tc_gdal_place_of(places, column + half, row, p[1]) &&
        tc_gdal_place_of(places, column, row - half, p[2]) && tc_gdal_place_of(places, column, row + half, p[3]);
    if (!there)
        return false;
    *x = apart(places, p[0], p[1]) / (2 * half);
    *y = apart(places, p[2], p[3]) / (2 * half);
    return isfinite(*x) && isfinite(*y) && *x > 0 && *y > 0;
}

/* Samples on either side of a place over which its spacing is taken: enough that PROJ's last digits do not count. */
static double half_step(const double t[6], double unit)
{
    const double enough = 500; /* metres */
    return fmax(0.5, enough / (unit * fmax(hypot(t[1], t[4]), hypot(t[2], t[5]))));
}

bool tc_gdal_ground(const char *wkt, const double transform[6], int64_t width, int64_t height,
                    tc_ground_scale *ground_ret)
{
    enum { PARTS = 8 }; /* along a side of the map */
    tc_gdal_start();
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    OGRSpatialReferenceH crs = OSRNewSpatialReference(wkt);
    OGRSpatialReferenceH lonlat = crs && OSRIsProjected(crs) ? tc_gdal_lonlat_of(crs) : NULL;
    tc_gdal_places places = {0};
    double unit = crs ? OSRGetLinearUnits(crs, NULL) : 1, w = (double)width, h = (double)height;
    double nominal_x = hypot(transform[1], transform[4]) * unit, nominal_y = hypot(transform[2], transform[5]) * unit;
    double half = half_step(transform, unit);
    bool known = lonlat && tc_gdal_places_open(crs, lonlat, transform, &places) &&
                 tc_gdal_spacing_at(&places, w / 2, h / 2, half, &ground_ret->x, &ground_ret->y);
    ground_ret->least = INFINITY, ground_ret->most = 0;
    for (int k = 0; known && k < (PARTS + 1) * (PARTS + 1); k++) {
        double x, y;
        if (!tc_gdal_spacing_at(&places, k % (PARTS + 1) * w / PARTS, k / (PARTS + 1) * h / PARTS, half, &x, &y))
            continue;
        ground_ret->least = fmin(ground_ret->least, fmin(x / nominal_x, y / nominal_y));
        ground_ret->most = fmax(ground_ret->most, fmax(x / nominal_x, y / nominal_y));
    }
    known = known && ground_ret->most > 0;
    if (places.to_lonlat)
        tc_gdal_places_close(&places);
    OSRDestroySpatialReference(lonlat);
    OSRDestroySpatialReference(crs);
    tc_gdal_heard(&said);
    return known;
}

void *tc_gdal_ground_open(const char *wkt, const double transform[6])
{
    tc_gdal_start();
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    OGRSpatialReferenceH crs = OSRNewSpatialReference(wkt);
    OGRSpatialReferenceH lonlat = crs && OSRIsProjected(crs) ? tc_gdal_lonlat_of(crs) : NULL;
    tc_gdal_places *places = lonlat ? calloc(1, sizeof *places) : NULL;
    if (places && !tc_gdal_places_open(crs, lonlat, transform, places)) {
        free(places);
        places = NULL;
    }
    OSRDestroySpatialReference(lonlat);
    OSRDestroySpatialReference(crs);
    tc_gdal_heard(&said);
    return places;
}

bool tc_gdal_ground_at(void *places, double column, double row, double degrees_ret[2])
{
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    const bool there = tc_gdal_place_of(places, column, row, degrees_ret);
    tc_gdal_heard(&said);
    return there;
}

void tc_gdal_ground_close(void *places)
{
    tc_gdal_places_close(places);
    free(places);
}
