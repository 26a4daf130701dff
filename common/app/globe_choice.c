/* globe_choice.c - which globe a map is laid on. */
#include "globe_choice.h"

#include <math.h>
#include <string.h>

#include "common/base/numbers.h"
#include "common/base/status.h"

static const double earth_radius = 6371000, wgs84_semi_major = 6378137, wgs84_inverse_flattening = 298.257223563;

/* From here on it is a sphere: of the Earth's size a few millimetres are left. */
static const double nearly_round = 1e9;

static double flattening_of(double inverse)
{
    return inverse > 1 && inverse < nearly_round ? 1 / inverse : 0;
}

bool tc_read_ellipsoid(void *choice, const char *value)
{
    tc_globe_choice *c = choice;
    double inverse = INFINITY;
    c->unflattened = false, c->semi_major = c->flattening = 0;
    if (strcmp(value, "sphere") == 0)
        return c->unflattened = true;
    if (strcmp(value, "wgs84") == 0) {
        c->semi_major = wgs84_semi_major, c->flattening = 1 / wgs84_inverse_flattening;
        return true;
    }
    if (!tc_take_number(&value, &c->semi_major) || !(c->semi_major >= 1e-3 && c->semi_major <= 1e12) || *value++ != ',')
        return false;
    if (strcmp(value, "inf") != 0 && (!tc_take_number(&value, &inverse) || *value || !(inverse > 1)))
        return false;
    c->flattening = flattening_of(inverse);
    return true;
}

const char *tc_globe_given(const tc_globe_choice *choice)
{
    return choice->unflattened || choice->semi_major > 0 ? "--ellipsoid" : choice->radius != 0 ? "--radius" : NULL;
}

tc_status tc_globe_check(const tc_globe_choice *choice, tc_error *error)
{
    if (!(choice->radius >= 0) || !isfinite(choice->radius))
        return tc_fail(error, TC_ERR_USAGE, "--radius: expected metres above 0, found %g", choice->radius);
    if (choice->radius > 0 && choice->semi_major > 0)
        return tc_fail(error, TC_ERR_USAGE,
                       "--radius: expected no --ellipsoid but sphere with it, found %.10g m beside one of %.10g m",
                       choice->radius, choice->semi_major);
    return TC_OK;
}

tc_body tc_globe_body(const tc_globe_choice *choice, const tc_georef *georef, const tc_source_options *options)
{
    if (choice->semi_major > 0)
        return tc_body_flattened(choice->semi_major, choice->flattening);
    if (choice->radius > 0)
        return tc_body_of(choice->radius);
    const double radius = georef->semi_major > 0 ? georef->semi_major : earth_radius;
    const double flattening = flattening_of(georef->inverse_flattening);
    if (choice->unflattened || flattening == 0) {
        tc_say(options, false, "taken to be on a sphere of %.10g m%s", radius,
               choice->unflattened ? "" : "; --ellipsoid wgs84 or A,1/F takes another body");
        return tc_body_of(radius);
    }
    tc_say(options, false,
           "taken to be on the ellipsoid of its coordinate system, %.10g m and 1/%.10g; --ellipsoid sphere takes a "
           "sphere",
           radius, georef->inverse_flattening);
    return tc_body_flattened(radius, flattening);
}
