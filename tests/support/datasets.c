/* datasets.c - real terrains for measurements. */
#include "datasets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/core/base/rect.h"
#include "common/shell/source.h"
#include "terrains.h"

bool dataset_load(const dataset *d, tc_grid *grid)
{
    if (strcmp(d->name, "default") == 0) {
        *grid = terrain_grid(TERRAIN_DEFAULT, 4097, 4097, 30, 4);
        return true;
    }
    const char *folder = getenv("TERRACLIP_DATA");
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "", d->name);
    if (!folder || !*folder || access(path, R_OK) != 0) {
        printf("%s: skipped: not in TERRACLIP_DATA\n", d->name);
        return false;
    }
    tc_source_options options = {.spacing = d->spacing, .unit = d->unit};
    tc_error error;
    if (tc_grid_load(path, &options, grid, &error)) {
        printf("%s: %s\n", d->name, error.text);
        exit(1);
    }
    return true;
}

float *dataset_crop(const dataset *d, int64_t x0, int64_t y0, int64_t size, int64_t *width_ret, int64_t *height_ret)
{
    tc_grid g;
    if (!dataset_load(d, &g))
        return NULL;
    int64_t w = tc_min64(size, g.width), h = tc_min64(size, g.height), south = tc_max64(g.height - y0 - h, 0);
    float *z = malloc((size_t)(w * h) * sizeof *z);
    if (!z)
        puts("dataset: no memory"), exit(99);
    for (int64_t y = 0; y < h; y++)
        memcpy(z + y * w, g.z + (south + y) * g.width + x0, (size_t)w * sizeof *z);
    tc_grid_free(&g);
    *width_ret = w, *height_ret = h;
    return z;
}
