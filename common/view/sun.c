/* sun.c - directions of light, calendar and the sun's place; see sun.h. */
#include "sun.h"

#include <math.h>
#include <string.h>

static const double DEGREE = M_PI / 180;

/* ---- Directions -------------------------------------------------------------------------------------------------- */

static void from_angles(double azimuth, double elevation, double direction_ret[3])
{
    direction_ret[0] = sin(azimuth) * cos(elevation);
    direction_ret[1] = cos(azimuth) * cos(elevation);
    direction_ret[2] = sin(elevation);
}

void tc_sun_direction(const tc_sun *sun, const tc_body *body, const double place[3], double direction_ret[3])
{
    if (sun->kind == TC_SUN_OVER) {
        const double over[3] = {sun->longitude, sun->latitude, 0};
        double to[3], axes[3][3];
        body->class->normal(body, over, to);
        body->class->axes(body, place, axes);
        for (int i = 0; i < 3; i++)
            direction_ret[i] = to[0] * axes[i][0] + to[1] * axes[i][1] + to[2] * axes[i][2];
    } else if (sun->kind == TC_SUN_LOCAL) {
        from_angles(sun->azimuth, sun->elevation, direction_ret);
    } else {
        from_angles(TC_SUN_AZIMUTH, TC_SUN_ELEVATION, direction_ret);
    }
}

tc_sun tc_sun_from(const tc_sun *sun, const tc_body *body, const double place[3])
{
    double d[3];
    if (sun->kind == TC_SUN_USUAL)
        return (tc_sun){.kind = TC_SUN_LOCAL, .azimuth = TC_SUN_AZIMUTH, .elevation = TC_SUN_ELEVATION};
    if (sun->kind == TC_SUN_LOCAL)
        return *sun;
    tc_sun_direction(sun, body, place, d);
    const double azimuth = atan2(d[0], d[1]);
    return (tc_sun){.kind = TC_SUN_LOCAL,
                    .azimuth = azimuth < 0 ? azimuth + 2 * M_PI : azimuth,
                    .elevation = atan2(d[2], hypot(d[0], d[1]))};
}

double tc_sun_day(double height)
{
    const double t = fmin(fmax((height + 0.22) / 0.52, 0), 1);
    return t * t * (3 - 2 * t);
}

/* ---- Time -------------------------------------------------------------------------------------------------------- */

/* The number that so many digits at *text are, which then points behind them; -1: they are not all digits. */
static int take_digits(const char **text, int count)
{
    int number = 0;
    for (; count > 0; count--, (*text)++) {
        if (**text < '0' || **text > '9')
            return -1;
        number = 10 * number + (**text - '0');
    }
    return number;
}

static int days_of(int year, int month)
{
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    return days[month - 1] + (month == 2 && leap ? 1 : 0);
}

bool tc_sun_read_date(const char *text, double *julian_ret)
{
    /* Digits of a part, its bounds and what follows it. */
    static const struct {
        int digits, least, most;
        const char *behind;
    } parts[] = {{4, 1901, 2099, "-"}, {2, 1, 12, "-"}, {2, 1, 31, "T"}, {2, 0, 23, ":"}, {2, 0, 59, "Z"}};
    int part[5];
    for (int i = 0; i < 5; i++) {
        part[i] = take_digits(&text, parts[i].digits);
        if (part[i] < parts[i].least || part[i] > parts[i].most || *text++ != *parts[i].behind)
            return false;
    }
    if (*text || part[2] > days_of(part[0], part[1]))
        return false;
    /* Of the Gregorian calendar: Meeus, chapter 7. */
    const int year = part[1] > 2 ? part[0] : part[0] - 1, month = part[1] > 2 ? part[1] : part[1] + 12;
    const int century = year / 100;
    *julian_ret = floor(365.25 * (year + 4716)) + floor(30.6001 * (month + 1)) + part[2] + 2 - century + century / 4 -
                  1524.5 + (part[3] + part[4] / 60.0) / 24;
    return true;
}

/* ---- The sun's place --------------------------------------------------------------------------------------------- */

static const double J2000 = 2451545, CENTURY = 36525; /* days */

/* Of the moon's ascending node, radians, at so many centuries since J2000: what nutation and aberration go by. */
static double node(double t)
{
    return (125.04 - 1934.136 * t) * DEGREE;
}

static double obliquity(double t)
{
    return (23 + (26 + (21.448 - t * (46.815 + t * (0.00059 - t * 0.001813))) / 60) / 60 + 0.00256 * cos(node(t))) *
           DEGREE;
}

void tc_sun_apparent(double julian, double *ascension_ret, double *declination_ret)
{
    const double t = (julian - J2000) / CENTURY;
    const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = (357.52911 + t * (35999.05029 - t * 0.0001537)) * DEGREE;
    const double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * sin(anomaly) +
                          (0.019993 - t * 0.000101) * sin(2 * anomaly) + 0.000289 * sin(3 * anomaly);
    const double longitude = (mean_longitude + centre - 0.00569 - 0.00478 * sin(node(t))) * DEGREE;
    const double ascension = atan2(cos(obliquity(t)) * sin(longitude), cos(longitude));
    *ascension_ret = ascension < 0 ? ascension + 2 * M_PI : ascension;
    *declination_ret = asin(sin(obliquity(t)) * sin(longitude));
}

tc_sun tc_sun_over_earth(double julian)
{
    double ascension, declination;
    tc_sun_apparent(julian, &ascension, &declination);
    const double days = julian - J2000, t = days / CENTURY;
    const double greenwich = 280.46061837 + 360.98564736629 * days + t * t * 0.000387933 -
                             0.00478 * sin(node(t)) * cos(obliquity(t)); /* apparent sidereal time, degrees */
    return (tc_sun){
        .kind = TC_SUN_OVER, .longitude = remainder(ascension - greenwich * DEGREE, 2 * M_PI), .latitude = declination};
}
