/* globe_choice.h - which globe a map is laid on: --radius and --ellipsoid, else what its coordinate system says. */
#ifndef TC_GLOBE_CHOICE_H
#define TC_GLOBE_CHOICE_H

#include "arguments.h"
#include "common/chart/body.h"
#include "common/input/source.h"

/* What was asked for; zero: nothing. */
typedef struct tc_globe_choice {
    double radius;                 /* --radius: metres, of a sphere */
    bool unflattened;              /* --ellipsoid sphere: whatever flattening the file tells */
    double semi_major, flattening; /* another --ellipsoid: metres, 0 or more; the former is above 0 then */
} tc_globe_choice;

/* Reads a value of the option. */
#define TC_EXPECTED_ELLIPSOID "wgs84, sphere or A,1/F: metres of 0.001..1e12 and an inverse flattening above 1 or inf"
bool tc_read_ellipsoid(void *choice, const char *value); /* tc_globe_choice */

/* What was given of it, "--radius" or "--ellipsoid"; NULL: nothing. */
const char *tc_globe_given(const tc_globe_choice *choice);

/* TC_ERR_USAGE for a radius that is neither 0 nor a finite one above, and for one beside an ellipsoid that is no
 * sphere.
 */
tc_status tc_globe_check(const tc_globe_choice *choice, tc_error *error);

/* The globe: the choice's, else the ellipsoid of the georeference, else a sphere as large as the Earth. Says which it
 * is, and how to have another. */
tc_body tc_globe_body(const tc_globe_choice *choice, const tc_georef *georef, const tc_source_options *options);

#endif
