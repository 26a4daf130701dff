/* datasets.h - real terrains for measurements, where TERRACLIP_DATA names the folder that holds them. */
#ifndef DATASETS_H
#define DATASETS_H

#include "common/terraclip.h"

typedef struct dataset {
    const char *name;     /* file name; "default": the synthetic default terrain */
    double spacing, unit; /* metres; 0: the file's own */
} dataset;

/* All there is to measure on: the default terrain and, by name, every elevation file of TERRACLIP_DATA; what it says of
 * files whose scale no file tells is known here for some. Returned is how many, at most capacity. Names stay valid
 * until the next call. */
enum { DATASETS_MAX = 64 };
int dataset_list(dataset *list, int capacity);

/* Loads a dataset as a grid. False, saying why on stdout, where it is not there. */
bool dataset_load(const dataset *d, tc_grid *grid);

/* A part of a dataset, `size` columns and rows where it has as many, from column x0 and row y0, north to south: its
 * heights, rows south to north, to be freed. NULL where dataset_load() says false. */
float *dataset_crop(const dataset *d, int64_t x0, int64_t y0, int64_t size, int64_t *width_ret, int64_t *height_ret);

#endif
