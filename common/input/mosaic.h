/* mosaic.h - one terrain of one file or of several that share a lattice, read in bands of rows. */
#ifndef TC_MOSAIC_H
#define TC_MOSAIC_H

#include "common/terraclip.h"
#include "source.h"

typedef struct tc_mosaic tc_mosaic;

/* Opens every file once, one after the other, and places them by their georeferences, which must agree in coordinate
 * system, registration and pixel size and lie whole samples apart. The terrain is the rectangle around all of them. A
 * single file needs no georeference. The paths must outlive the mosaic. */
tc_status tc_mosaic_open(const char *const *paths, int count, const tc_source_options *options, tc_mosaic **mosaic_ret,
                         tc_error *error);
void tc_mosaic_close(tc_mosaic *mosaic);

/* The terrain: as the files store it, float32 where they differ in that. Its policy for voids is that of the options.
 */
const tc_pack_terrain *tc_mosaic_terrain(const tc_mosaic *mosaic);

/* Number of files. */
int tc_mosaic_files(const tc_mosaic *mosaic);

/* Samples that more than one file gives, void ones included, and samples that all files together give. */
int64_t tc_mosaic_shared(const tc_mosaic *mosaic);
int64_t tc_mosaic_samples(const tc_mosaic *mosaic);

/* Gives samples of rect (whole rows of one file, the files in order, each from the north): z[(j - rect.y0) * width + i]
 * with the rectangle's width, metres above z_base; voids likewise. */
typedef tc_status (*tc_band_function)(void *context, tc_rect rect, const float *z, const uint8_t *voids,
                                      tc_error *error);

/* Reads all files. A thread of its own reads ahead by one band while `give` works, which runs on the calling thread.
 * Stops at the first failure of either. */
tc_status tc_mosaic_read(tc_mosaic *mosaic, tc_band_function give, void *context, tc_error *error);

#endif
