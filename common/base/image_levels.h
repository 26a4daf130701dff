/* image_levels.h - the levels of a picture from its rows, as they come: each half of the one before, in linear light,
 * pixels weighed by their alpha. Memory of two rows a level; where the first one is not given and the picture is kept
 * in parts, of a row of parts of the second. */
#ifndef TC_IMAGE_LEVELS_H
#define TC_IMAGE_LEVELS_H

#include "image.h"

/* Sizes of all levels until both sides are at most `least`; returns how many. */
int tc_image_sizes(int64_t width, int64_t height, int64_t least, tc_image_size size_ret[TC_IMAGE_LEVELS]);

/* What is done with row y of a level. */
typedef tc_status (*tc_image_row_function)(void *context, int level, int64_t y, uint8_t (*rgba)[4], tc_error *error);

/* What to make, and who hears of it. */
typedef struct tc_image_making {
    int first, levels; /* those from first on, of so many, are given */
    const tc_image_size *size;
    tc_image_row_function give; /* rows of each level from the top on, as soon as they are known */
    void *context;
    bool (*progress)(void *context, double done); /* as in common/input/image.h; false is TC_ERR_IO */
    void *progress_context;
} tc_image_making;
tc_status tc_image_make_levels(tc_image_rows *rows, const tc_image_making *making, tc_error *error);

#endif
