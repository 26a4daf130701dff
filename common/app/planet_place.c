/* planet_place.c - where a file's raster lies on a planet. */
#include "planet_place.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/chart/lonlat.h"
#include "common/input/source_internal.h"

enum { MOST_RESAMPLED = 4 }; /* times the columns that there are: higher maps would take any amount of memory */

/* Whether a transform that no coordinate system explains can be one of degrees. */
static bool fits_globe(const double t[6], int64_t width, int64_t height)
{
    double x0 = t[0], x1 = t[0] + (double)width * t[1], y0 = t[3] + (double)height * t[5], y1 = t[3];
    return x0 >= -360.5 && x1 <= 720.5 && x1 - x0 <= 360 + 1.5 * t[1] && y0 >= -90 + t[5] && y1 <= 90 - t[5];
}

/* Sets t to the transform, in degrees. */
static tc_status settle_transform(const char *path, const tc_source_options *options, int64_t width, int64_t height,
                                  const tc_georef *georef, double t[6], tc_error *error)
{
    static const char *const advice =
        "longitude and latitude; `gdalwarp -t_srs` with a geographic system makes them so";
    if (!georef->known && width != 2 * height)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a georeference in longitude and latitude, or a map of the whole globe that is "
                       "twice as wide as high, found %" PRId64 " x %" PRId64 " samples without one",
                       path, width, height);
    if (!georef->known) {
        const double globe[6] = {-180, 360 / (double)width, 0, 90, 0, -180 / (double)height};
        memcpy(t, globe, sizeof globe);
        tc_say(options, true,
               "no georeference: taken for a map of the whole globe from -180 to 180 degrees of longitude");
        return TC_OK;
    }
    memcpy(t, georef->transform, sizeof georef->transform);
    if (t[2] != 0 || t[4] != 0)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected %s, found a rotated raster", path, advice);
    if (!georef->geographic && georef->crs_wkt)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected %s, found a projected coordinate system", path, advice);
    if (!georef->geographic && !fits_globe(t, width, height))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected %s, found no coordinate system and numbers up to %.6g",
                       path, advice, fmax(fabs(t[0]), fabs(t[3])));
    if (!georef->geographic)
        tc_say(options, true, "no coordinate system: its transform is taken to be in degrees");
    return TC_OK;
}

/* Rows beyond the pole, of the first row at `latitude` degrees and those after it towards the equator. */
static int64_t beyond_pole(double latitude, double dy)
{
    return tc_max64(0, (int64_t)ceil((latitude - 90) / dy - 5e-4));
}

/* Less than this has no surface, or no polar caps. */
static tc_status check_size(const char *path, int64_t columns, int64_t rows, bool around, bool poles, tc_error *error)
{
    int64_t least_columns = around ? 4 : 2, least_rows = poles ? 4 : 2;
    if (columns < least_columns || rows < least_rows)
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: expected at least %" PRId64 " x %" PRId64 " samples%s, found %" PRId64 " x %" PRId64, path,
                       least_columns, least_rows, around ? " around the globe" : "", columns, rows);
    return TC_OK;
}

/* A map from pole to pole can only lie between them. Labels of planetary data are read by two conventions, half a
 * sample apart; where by one the rows would run beyond a pole, it is the other, for columns too. */
static void settle_half_samples(const tc_source_options *options, int64_t width, int64_t height, double t[6])
{
    double dx = t[1], dy = -t[5], off = (t[3] - 90) / dy;
    bool all = fabs((double)height * dy - 180) < 1e-3 * dy && fabs((double)width * dx - 360) < 1e-3 * dx;
    if (!all || fabs(fabs(off) - 0.5) > 0.01)
        return;
    tc_say(options, true, "its rows are half a sample off the poles: taken to run from pole to pole, columns likewise");
    t[3] = 90;
    double columns = (t[0] + 180) / dx, half = off > 0 ? 0.5 : -0.5;
    if (fabs(columns + half - rint(columns + half)) <
        0.01) /* west of a whole number of them, as rows are north of it */
        t[0] += half * dx;
}

tc_status tc_planet_place_raster(const char *path, const tc_source_options *options, int64_t width, int64_t height,
                                 const tc_georef *georef, bool whole, tc_planet_place *place_ret, tc_error *error)
{
    static const tc_source_options defaults = {0};
    options = options ? options : &defaults;
    double t[6];
    tc_status status = settle_transform(path, options, width, height, georef, t, error);
    if (status != TC_OK)
        return status;

    settle_half_samples(options, width, height, t);
    double dx = t[1], dy = -t[5], top = t[3] - 0.5 * dy, bottom = t[3] - ((double)height - 0.5) * dy;
    int64_t north = beyond_pole(top, dy), south = beyond_pole(-bottom, dy);
    if (north > 1 || south > 1 || north + south >= height)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected latitudes from -90 to 90 degrees, found %.6g to %.6g", path,
                       bottom, top);
    if (north + south > 0)
        tc_say(options, true, "%" PRId64 " of its rows lie beyond a pole and are left out", north + south);

    double turn = 360 / dx;
    int64_t columns = (double)width > turn + 0.5 ? (int64_t)floor(turn + 0.5) : width, rows = height - north - south;
    const tc_georef used = {
        .known = true, .geographic = true, .transform = {t[0], dx, 0, t[3] - (double)north * dy, 0, -dy}};
    tc_lonlat at;
    if (!tc_lonlat_of(&used, columns, rows, &at))
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected columns from west to east and rows from north to south",
                       path);
    bool around = at.round;
    status = check_size(path, columns, rows, around, at.poles, error);
    if (status != TC_OK)
        return status;
    if (whole && !around)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a map of all 360 degrees of longitude, found %.6g", path,
                       (double)width * dx);
    if (columns < width)
        tc_say(options, false, "%" PRId64 " of its columns come round again and are left out", width - columns);
    tc_planet_place place = {.columns = columns, .south = south, .rows = rows, .around = around};
    place.width = around ? tc_lonlat_width(columns, rows) : columns;
    if (place.width > MOST_RESAMPLED * columns)
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: expected a map that is wider or not so high, found %" PRId64 " x %" PRId64
                       " samples around the globe",
                       path, columns, rows);
    if (place.width != columns)
        tc_say(options, false,
               "its %" PRId64 " columns are resampled to %" PRId64
               ", which levels of detail around the globe can halve",
               columns, place.width);
    double step = around ? 360 / (double)place.width : dx;
    const double placed[6] = {t[0] + 0.5 * (dx - step), step, 0, t[3] - (double)north * dy, 0, -dy};
    memcpy(place.transform, placed, sizeof placed);
    *place_ret = place;
    return TC_OK;
}
