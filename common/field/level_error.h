/* level_error.h - how far the finest samples of a terrain are from the mesh of a coarser level. */
#ifndef TC_LEVEL_ERROR_H
#define TC_LEVEL_ERROR_H

#include "common/terraclip.h"

/* Two levels of one terrain, the coarse one `shift` halvings above the fine one; heights [j * width + i]. */
typedef struct tc_level_pair {
    tc_level fine, coarse;
    const float *z, *mesh;
    int shift;
    bool wraps; /* the coarse level goes on in x from its other side, else in a straight line */
} tc_level_pair;

/* The largest distance, metres up or down, over each of the tiles, 2^tile fine samples wide, of rows j0 .. j1 - 1 of
 * the fine level. scratch: two floats for each coarse column and four more. */
void tc_level_errors(const tc_level_pair *pair, int tile, int64_t j0, int64_t j1, float *errors_ret, float *scratch);

#endif
