/* pack_planet.h - the inputs of `terraclip pack --planet` as rows around a globe. */
#ifndef TC_PACK_PLANET_H
#define TC_PACK_PLANET_H

#include "common/input/mosaic.h"
#include "common/app/globe_choice.h"
#include "common/app/planet_place.h"

/* How a mosaic becomes a planet. */
typedef struct tc_planet_input {
    tc_mosaic *mosaic;
    const char *path; /* of the first file, for messages */
    tc_planet_place place;
    tc_pack_terrain terrain; /* what is packed; crs_wkt is the mosaic's */
} tc_planet_input;

/* Places a mosaic that was opened with a spacing of 1 m, which here means none. globe: that is asked for. lossless:
 * refuses one that would have to be resampled. */
tc_status tc_planet_input_settle(tc_mosaic *mosaic, const char *path, const tc_source_options *options,
                                 const tc_globe_choice *globe, bool lossless, tc_planet_input *input_ret,
                                 tc_error *error);

/* Reads all files and gives the planet's samples, in rectangles of rows and in any order. scratch: beside which file a
 * temporary one may lie. */
tc_status tc_planet_input_read(const tc_planet_input *input, const char *scratch, tc_band_function give, void *context,
                               tc_error *error);

#endif
