/* load_folder.c - the files of a folder as one grid, placed by their georeferences. */
#include "load.h"

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/input/folder.h"
#include "common/input/mosaic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct taking {
    tc_grid *grid;
    const tc_source_options *options;
    double taken; /* samples; those of several files as often */
} taking;

/* Where two files have a sample the first one's holds, unless it is void. */
static tc_status take_band(void *context, tc_rect rect, const float *z, const uint8_t *voids, tc_error *error)
{
    taking *t = context;
    tc_grid *grid = t->grid;
    int64_t width = rect.x1 - rect.x0;
    for (int64_t j = rect.y0; j < rect.y1; j++)
        for (int64_t i = 0; i < width; i++) {
            int64_t to = j * grid->width + rect.x0 + i, from = (j - rect.y0) * width + i;
            if (!grid->voids[to] || voids[from])
                continue;
            grid->z[to] = z[from];
            grid->voids[to] = 0;
        }
    t->taken += (double)width * (double)(rect.y1 - rect.y0);
    return tc_tell_progress(t->options, "reading", fmin(1, t->taken / ((double)grid->width * (double)grid->height)),
                            error);
}

static tc_status read_mosaic(const char *path, const tc_source_options *options, tc_mosaic *mosaic, tc_grid *grid,
                             tc_error *error)
{
    const tc_pack_terrain *t = tc_mosaic_terrain(mosaic);
    *grid = (tc_grid){.width = t->width,
                      .height = t->height,
                      .spacing_x = t->spacing_x,
                      .spacing_y = t->spacing_y,
                      .z_base = t->z_base,
                      .area_registered = t->area_registered,
                      .georef = t->georef};
    grid->georef.crs_wkt = t->georef.crs_wkt ? strdup(t->georef.crs_wkt) : NULL;
    tc_status status = tc_grid_room(path, grid, error);
    if (status != TC_OK)
        return status;
    size_t samples = (size_t)(t->width * t->height);
    grid->voids = malloc(samples);
    if (!grid->voids)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %zu samples", path, samples);
    memset(grid->z, 0, samples * sizeof *grid->z);
    memset(grid->voids, 1, samples);
    taking taken = {.grid = grid, .options = options};
    status = tc_mosaic_read(mosaic, take_band, &taken, error);
    if (status != TC_OK)
        return status;
    tc_grid_measure(grid);
    if (grid->void_count == 0) {
        free(grid->voids);
        grid->voids = NULL;
    }
    return TC_OK;
}

tc_status tc_grid_read_folder(const char *path, const tc_source_options *options, tc_grid *grid, tc_error *error)
{
    tc_folder folder;
    tc_status status = tc_folder_list(path, options, &folder, error);
    if (status != TC_OK)
        return status;
    tc_mosaic *mosaic = NULL;
    status = tc_mosaic_open((const char *const *)folder.file, folder.count, options, &mosaic, error);
    if (status == TC_OK)
        status = read_mosaic(path, options, mosaic, grid, error);
    tc_mosaic_close(mosaic);
    tc_folder_free(&folder);
    return status;
}
