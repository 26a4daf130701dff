/* datasets.c - real terrains for measurements. */
#include "datasets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
