/* load_flat.c - a DEM or a picture of heights as a flat map. */
#include "load.h"

#include "common/base/clock.h"

tc_status tc_load_flat(const char *path, const tc_source_options *source, const tc_load_options *options,
                       tc_map **map_ret, tc_error *error)
{
    double start = tc_clock_ms();
    tc_grid grid;
    tc_map *map;
    tc_status status = tc_grid_load(path, source, &grid, error);
    if (status != TC_OK)
        return status;
    double read = tc_clock_ms();
    status = tc_map_build(&grid, 0, options->threads, &map, error);
    if (status != TC_OK)
        return status;
    map->voids = source->voids;
    map->read_ms = read - start;
    map->build_ms = tc_clock_ms() - read;
    *map_ret = map;
    return TC_OK;
}
