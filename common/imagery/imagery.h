/* imagery.h - pictures laid over a map: a field of colours for each of its charts.
 *
 * Samples of such a field are RGBA8: sRGB of the colour times its alpha, and alpha; those of a level lie at the places
 * of the chart's heights, as many powers of two finer or coarser as the finest picture calls for. Levels are made of
 * the pictures' own levels in linear light, each texel of the area that it stands for; later pictures lie over earlier
 * ones; where there is none alpha is 0. Tiles are made as they are needed, on the threads that ask for them or on one
 * that reads ahead, and those used last are kept. */
#ifndef TC_IMAGERY_H
#define TC_IMAGERY_H

#include "common/base/image.h"
#include "common/map/map.h"

typedef struct tc_imagery tc_imagery;

/* Lays pictures over a map, which outlives them; takes the images over, also on failure. One that says where it lies
 * (image->find) goes there; another covers the globe, -180 to 180 and 90 to -90 degrees, where the map goes around it,
 * else all of the map's samples. threads: that make tiles where they are waited for, 0 as many as there are processors.
 * TC_ERR_UNSUPPORTED for one that does not overlap the map. */
tc_status tc_imagery_create(const tc_map *map, tc_image *const *images, int count, int threads,
                            tc_imagery **imagery_ret, tc_error *error);
void tc_imagery_destroy(tc_imagery *imagery);

/* The colours of a chart of the map; lives as long as the imagery. */
const tc_field *tc_imagery_field(const tc_imagery *imagery, int chart);

int tc_imagery_charts(const tc_imagery *imagery);

/* Chart coordinates between its finest colours along both axes: those between heights times a power of two. */
void tc_imagery_texel(const tc_imagery *imagery, int chart, double texel_ret[2]);

/* Why a tile could not be made, the first time; TC_OK: all could. Thread-safe. */
tc_status tc_imagery_failed(const tc_imagery *imagery, tc_error *error);

#endif
