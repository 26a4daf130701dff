/* planet_place.h - where a file's raster lies on a planet. */
#ifndef TC_PLANET_PLACE_H
#define TC_PLANET_PLACE_H

#include "common/input/source.h"

/* The part of a raster that is used, and where it lies. */
typedef struct tc_planet_place {
    int64_t columns;     /* used: the first ones; columns that come round again are left out */
    int64_t south, rows; /* used: from row `south` on, counted from the south; rows beyond a pole are left out */
    bool around;         /* all 360 degrees of longitude */
    int64_t width;       /* columns to be resampled to: as tc_lonlat_width() says where it goes around, else columns */
    double transform[6]; /* of width x rows samples: corner-based, rows north to south, degrees, not rotated */
} tc_planet_place;

/* Places a raster of width x height samples. options (for what is said) may be NULL. whole: it must go around.
 * TC_ERR_UNSUPPORTED where it is not in longitude and latitude, TC_ERR_FORMAT where its latitudes are none
 * or its samples too few, TC_ERR_USAGE where it does not go around but must. */
tc_status tc_planet_place_raster(const char *path, const tc_source_options *options, int64_t width, int64_t height,
                                 const tc_georef *georef, bool whole, tc_planet_place *place_ret, tc_error *error);

#endif
