/* image.h - pictures for imagery: any file of colours as a tc_image, within bounded memory.
 *
 * A picture that can be read in parts and has overviews is read where it lies. A small one is held in memory. Of others
 * the levels that are missing (all of those that can only be read from their beginning on: JPEG, PNG) are made once,
 * filtered in linear light, and kept under $XDG_CACHE_HOME (else ~/.cache) in terraclip/, by name, size and time of the
 * file: it is read as a whole once, and not again by the next program. GDAL comes first; OpenImageIO has what it does
 * not know. */
#ifndef TC_INPUT_IMAGE_H
#define TC_INPUT_IMAGE_H

#include "common/base/image.h"
#include "source.h"

/* The map that a picture is laid over: its places are coordinates of this system, x and y, degrees east and north on a
 * globe. */
typedef struct tc_image_map {
    bool known;          /* it says where it lies */
    const char *crs_wkt; /* NULL: but not in which system; a picture's is then taken, on a globe its degrees */
    bool globe;
} tc_image_map;

typedef struct tc_image_options {
    const tc_source_options *source; /* say and outputs of it */
    /* Called now and then with the share of making levels that is done, 0 to 1; false stops it. NULL: not called. */
    bool (*progress)(void *context, double done);
    void *progress_context;
} tc_image_options;

/* Opens a picture. Where it says where it lies, image->find and image->locate lead from the map's places to its pixels
 * and back. TC_ERR_UNSUPPORTED for what is no picture or cannot be transformed to the map's system. */
tc_status tc_image_open(const char *path, const tc_image_map *map, const tc_image_options *options,
                        tc_image **image_ret, tc_error *error);

#endif
