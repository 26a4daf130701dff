/* lerc.h - LERC (in GeoTIFF, with zstd) by GDAL, to compare with. */
#ifndef LERC_H
#define LERC_H

#include "common/terraclip.h"

/* Bytes of the heights as integers of `unit` metres, each off by at most max_error metres (0: exact); 0 where GDAL was
 * built without it. The error is checked. */
int64_t lerc_bytes(const tc_grid *grid, double unit, double max_error);

#endif
