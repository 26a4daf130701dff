/* ray.h - where a ray meets a terrain. */
#ifndef TC_RAY_H
#define TC_RAY_H

#include "common/map/map.h"

/* Prints to the standard output where the ray that `text`, a view as the viewers' --view has it, looks along first
 * meets the ground of a map: its place in the same numbers, and metres from the eye. TC_ERR_USAGE where the text is
 * none, TC_ERR_IO where the eye is below the ground or the ray meets none. name: the file's, for errors. */
tc_status tc_ray_tell(const tc_map *map, const char *name, const char *text, tc_error *error);

#endif
