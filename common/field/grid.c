/* grid.c - grids: heights in memory. */
#include "common/terraclip.h"

#include <stdlib.h>
#include <string.h>

void tc_grid_free(tc_grid *grid)
{
    if (!grid)
        return;
    free(grid->z);
    free(grid->voids);
    free(grid->georef.crs_wkt);
    memset(grid, 0, sizeof *grid);
}
