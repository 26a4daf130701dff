/* source_georef.c - from a file's georeference to metres.
 *
 * Samples are points. GDAL's transform gives the corners of pixels for area and for point registration alike (it shifts
 * the latter on reading), so the sample of column i and row r lies at transform(i + 1/2, r + 1/2) in both cases:
 * sample_latitude below is the one place that knows. The transform itself is kept corner-based, as tc_georef says, but
 * always for columns west to east and rows north to south: that of a file which runs otherwise is turned over. */
#include "plugin.h"
#include "source_internal.h"

#include <math.h>
#include <string.h>
#include <strings.h>

static const double wgs84_semi_major = 6378137, wgs84_inverse_flattening = 298.257223563;

double tc_unit_by_name(const char *name)
{
    static const struct {
        const char *name;
        double metres;
    } units[] = {
        {"", 1},
        {"m", 1},
        {"metre", 1},
        {"meter", 1},
        {"metres", 1},
        {"meters", 1},
        {"metre(s)", 1},
        {"mm", 0.001},
        {"cm", 0.01},
        {"centimetre", 0.01},
        {"dm", 0.1},
        {"decimetre", 0.1},
        {"decimeter", 0.1},
        {"km", 1000},
        {"kilometre", 1000},
        {"kilometer", 1000},
        {"ft", 0.3048},
        {"foot", 0.3048},
        {"feet", 0.3048},
        {"international foot", 0.3048},
        {"us-ft", 1200. / 3937},
        {"ftus", 1200. / 3937},
        {"us survey foot", 1200. / 3937},
        {"us_survey_foot", 1200. / 3937},
        {"foot_us", 1200. / 3937},
        {"centimeter", 0.01},
        {"yd", 0.9144},
    };
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(name, units[i].name) == 0)
            return units[i].metres;
    return 0;
}

/* Latitude of sample (column, row), in the CRS's unit. */
static double sample_latitude(const double t[6], double column, double row)
{
    return t[3] + (column + 0.5) * t[4] + (row + 0.5) * t[5];
}

/* Spacing of a raster in degrees, at its mean latitude on the ellipsoid: a degree of longitude is as long as the
 * parallel there, one of latitude as the meridian. */
static void degrees_to_metres(const double t[6], int64_t width, int64_t height, double semi_major,
                              double inverse_flattening, double unit, double *x, double *y)
{
    double a = semi_major > 0 ? semi_major : wgs84_semi_major;
    double inverse = semi_major > 0 ? inverse_flattening : wgs84_inverse_flattening;
    double f = inverse > 0 ? 1 / inverse : 0, e2 = f * (2 - f);
    double middle = sample_latitude(t, 0.5 * (double)(width - 1), 0.5 * (double)(height - 1)) * unit;
    double limit = 89.9 * TC_RADIANS_PER_DEGREE; /* at a pole itself columns would have no distance */
    double latitude = fmax(-limit, fmin(limit, middle));
    double w2 = 1 - e2 * sin(latitude) * sin(latitude);
    double east = a * cos(latitude) / sqrt(w2), north = a * (1 - e2) / (w2 * sqrt(w2));
    *x = unit * hypot(t[1] * east, t[4] * north);
    *y = unit * hypot(t[2] * east, t[5] * north);
}

/* A whole number of minutes that has no end as a decimal fraction: 10' are 0.1666..., and nobody measures in such
 * metres.
 */
static bool is_minutes(double spacing)
{
    double minutes = spacing * 60, decimals = spacing * 1e4;
    return fabs(minutes - rint(minutes)) < 1e-4 && fabs(decimals - rint(decimals)) > 1e-2;
}

/* Many grids (.asc, .bil, world files) come in degrees without saying so. Within the bounds of the globe those are
 * taken for degrees whose samples are less than 72 arc-seconds apart (in metres that were 2 cm), that go around the
 * globe in steps of 2 degrees at most, or whose steps are whole minutes and no decimals. */
static bool looks_like_degrees(const tc_raster_info *raster, bool *could_be_ret)
{
    const double *t = raster->transform, dx = fabs(t[1]), dy = fabs(t[5]), most = 2 + 1e-6;
    double x1 = t[0] + (double)raster->width * t[1], y1 = t[3] + (double)raster->height * t[5];
    bool fits = t[2] == 0 && t[4] == 0 && fmin(t[0], x1) >= -180.5 - dx / 2 && fmax(t[0], x1) <= 360.5 + dx / 2 &&
                fmin(t[3], y1) >= -90.5 - dy / 2 && fmax(t[3], y1) <= 90.5 + dy / 2;
    bool around = fabs(x1 - t[0]) >= 360 - 1.5 * dx && dx <= most && dy <= most;
    bool taken = fits && ((dx < 0.02 && dy < 0.02) || around || (dx <= most && is_minutes(dx) && is_minutes(dy)));
    bool from_origin = (t[0] == 0 || x1 == 0) && (t[3] == 0 || y1 == 0);
    *could_be_ret = fits && !taken && dx <= most && dy <= most && !from_origin;
    return taken;
}

/* Lengths of a projected map as they are on the ground in its middle, where its projection makes others of them by more
 * than what zones of UTM and national grids are allowed. */
static void use_ground(const char *wkt, const double t[6], int64_t width, int64_t height,
                       const tc_source_options *options, double *x, double *y)
{
    const double allowed = 0.002, told = 1.02;
    const void *table = NULL;
    tc_ground_scale ground;
    if (!wkt || !tc_plugin_loaded("gdal") || tc_plugin_load("gdal", &table, NULL) != TC_OK ||
        !((const struct tc_gdal_plugin *)table)->ground(wkt, t, width, height, &ground))
        return;
    if (ground.most > told * ground.least)
        tc_say(
            options, true,
            "the projection's scale varies over the map: its metre is %.4g to %.4g m on the ground; shown with that of "
            "the middle",
            ground.least, ground.most);
    if (fabs(ground.x / *x - 1) <= allowed && fabs(ground.y / *y - 1) <= allowed)
        return;
    tc_say(options, false, "%.6g x %.6g m of the map are %.6g x %.6g m on the ground in its middle", *x, *y, ground.x,
           ground.y);
    *x = ground.x, *y = ground.y;
}

/* Turns the transform over so that it fits rows north to south and columns west to east. */
static void orient(const tc_raster_info *raster, double t[6], bool *flip_x, bool *flip_y)
{
    *flip_x = t[1] < 0;
    *flip_y = t[5] > 0;
    if (*flip_x) {
        t[0] += (double)raster->width * t[1];
        t[3] += (double)raster->width * t[4];
        t[1] = -t[1];
        t[4] = -t[4];
    }
    if (*flip_y) {
        t[0] += (double)raster->height * t[2];
        t[3] += (double)raster->height * t[5];
        t[2] = -t[2];
        t[5] = -t[5];
    }
}

double tc_crs_unit(const tc_raster_info *raster, const tc_georef *georef)
{
    /* Degrees without a coordinate system are a guess. */
    return raster->crs == TC_CRS_NONE && georef->geographic ? TC_RADIANS_PER_DEGREE
           : raster->crs_unit > 0                           ? raster->crs_unit
                                                            : 1;
}

void tc_georef_spacing(const tc_source_info *info, const tc_georef *georef, int64_t width, int64_t height,
                       double *spacing_x, double *spacing_y)
{
    const double *t = georef->transform;
    *spacing_x = hypot(t[1], t[4]) * info->crs_unit;
    *spacing_y = hypot(t[2], t[5]) * info->crs_unit;
    if (georef->geographic)
        degrees_to_metres(t, width, height, georef->semi_major, info->inverse_flattening, info->crs_unit, spacing_x,
                          spacing_y);
    else
        use_ground(georef->crs_wkt, t, width, height, &(tc_source_options){0}, spacing_x, spacing_y);
}

static bool usable(double spacing)
{
    return isfinite(spacing) && spacing > 1e-9 && spacing < 1e9;
}

void tc_settle_georef(const tc_raster_info *raster, const tc_source_options *options, tc_georef *georef,
                      double *spacing_x, double *spacing_y, bool *flip_x, bool *flip_y)
{
    memset(georef, 0, sizeof *georef);
    *flip_x = *flip_y = false;
    double x = raster->nominal_x > 0 ? raster->nominal_x : 1, y = raster->nominal_y > 0 ? raster->nominal_y : 1;
    bool quiet = options->spacing > 0; /* what the file says of its spacing does not matter */

    if (raster->has_transform) {
        double t[6];
        memcpy(t, raster->transform, sizeof t);
        orient(raster, t, flip_x, flip_y);
        bool degrees = raster->crs == TC_CRS_GEOGRAPHIC, guessed = false, could_be = false;
        double unit = raster->crs_unit > 0 ? raster->crs_unit : 1;
        if (raster->crs == TC_CRS_NONE && looks_like_degrees(raster, &could_be)) {
            degrees = guessed = true;
            unit = TC_RADIANS_PER_DEGREE;
        }
        double tx = hypot(t[1], t[4]) * unit, ty = hypot(t[2], t[5]) * unit;
        if (degrees)
            degrees_to_metres(t, raster->width, raster->height, raster->semi_major, raster->inverse_flattening, unit,
                              &tx, &ty);
        else if (!quiet)
            use_ground(raster->crs_wkt, t, raster->width, raster->height, options, &tx, &ty);
        if (could_be && !quiet)
            tc_say(options, true,
                   "no coordinate system: %.9g x %.9g taken for metres; --crs EPSG:4326 takes them for degrees",
                   hypot(t[1], t[4]), hypot(t[2], t[5]));
        if (*raster->brought_from)
            tc_say(options, false, "%s: brought to degrees east of Greenwich", raster->brought_from);
        if (usable(tx) && usable(ty)) {
            x = tx;
            y = ty;
            georef->known = true;
            georef->geographic = degrees;
            memcpy(georef->transform, t, sizeof t);
            georef->semi_major = raster->semi_major;
            georef->inverse_flattening = raster->inverse_flattening;
            if (degrees && !quiet)
                tc_say(options, guessed,
                       "%s: %.9g x %.9g degrees become %.6g x %.6g m at the mean latitude of %.4f degrees",
                       guessed ? "no coordinate system, but what look like degrees" : "geographic coordinates",
                       hypot(t[1], t[4]) * unit / TC_RADIANS_PER_DEGREE,
                       hypot(t[2], t[5]) * unit / TC_RADIANS_PER_DEGREE, x, y,
                       sample_latitude(t, 0.5 * (double)(raster->width - 1), 0.5 * (double)(raster->height - 1)) *
                           unit / TC_RADIANS_PER_DEGREE);
            if (t[2] != 0 || t[4] != 0)
                tc_say(options, true, "the raster is rotated on the map: shown unrotated, its columns taken as north");
        } else {
            tc_say(options, true, "its georeference makes no sense (samples %g x %g m apart) and is not used", tx, ty);
        }
    } else if (raster->nominal_x <= 0 && !quiet) {
        tc_say(options, true, "no georeference%s: samples taken to be 1 m apart; --spacing and --unit set the scale",
               raster->has_control_points ? " but control points, by which `gdalwarp FILE MAP.tif` makes a map" : "");
    }
    *spacing_x = quiet ? options->spacing : x;
    *spacing_y = quiet ? options->spacing : y;
}
