/* packed_map.h - a map that a test has made, as a file. */
#ifndef PACKED_MAP_H
#define PACKED_MAP_H

#include "common/map/map.h"

/* Packs chart 0's finest level with an rms of 1 m, as a planet (with caps of the packer's own) where the map is one.
 * The test fails where it cannot be. */
void packed_map(const tc_map *map, const char *path);

#endif
