/* load_imagery.h - pictures from files over a map. */
#ifndef TC_LOAD_IMAGERY_H
#define TC_LOAD_IMAGERY_H

#include "common/imagery/imagery.h"
#include "common/input/image.h"

/* Opens files and lays them over the map, each over those before it. What is to be known of them is said by
 * options->source. Errors name the file. */
tc_status tc_imagery_load(const tc_map *map, const char *const *paths, int count, int threads,
                          const tc_image_options *options, tc_imagery **imagery_ret, tc_error *error);

#endif
