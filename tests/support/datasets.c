/* datasets.c - real terrains for measurements. */
#include "datasets.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "common/base/rect.h"
#include "common/app/load.h"
#include "terrains.h"

/* Pictures of heights do not say how far apart their samples are. */
static const dataset scales[] = {{"ps_height_1k.png", 160, 0.1}, {"moon_gld100_256ppd_ne_4097.png", 118.45, 0}};

static int by_name(const void *a, const void *b)
{
    return strcmp((const char *)a, (const char *)b);
}

static bool elevation_name(const char *name)
{
    static const char *const ends[] = {".hgt", ".tif", ".tiff", ".png", ".pgm", ".vrt",
                                       ".jp2", ".asc", ".img",  ".exr", ".dem"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof ends / sizeof *ends; i++)
        if (strcasecmp(dot, ends[i]) == 0)
            return true;
    return false;
}

int dataset_list(dataset *list, int capacity)
{
    static char names[DATASETS_MAX][256];
    int count = 0, files = 0;
    list[count++] = (dataset){"default", 0, 0};
    const char *folder = getenv("TERRACLIP_DATA");
    DIR *d = folder && *folder ? opendir(folder) : NULL;
    for (struct dirent *e; d && (e = readdir(d)) && files < DATASETS_MAX;)
        if (elevation_name(e->d_name) && strlen(e->d_name) < sizeof *names)
            strcpy(names[files++], e->d_name);
    if (d)
        closedir(d);
    qsort(names, (size_t)files, sizeof *names, by_name);
    for (int i = 0; i < files && count < capacity; i++) {
        list[count] = (dataset){names[i], 0, 0};
        for (size_t k = 0; k < sizeof scales / sizeof *scales; k++)
            if (strcmp(names[i], scales[k].name) == 0)
                list[count] = (dataset){names[i], scales[k].spacing, scales[k].unit};
        count++;
    }
    return count;
}

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
