/* load_flat.c - a DEM or a picture of heights as a flat map. */
#include "load.h"

#include "common/base/clock.h"

tc_status tc_load_flat(const char *path, const tc_source_options *source, const tc_load_options *options,
                       tc_map **map_ret, tc_error *error)
{
    double start = tc_clock_ms();
    tc_grid grid;
    tc_status status = tc_grid_load(path, source, &grid, error);
    const tc_body plane = tc_body_of(0);
    return status ? status : tc_load_build(&grid, &plane, source, options, start, map_ret, error);
}
