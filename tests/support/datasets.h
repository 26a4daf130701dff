/* datasets.h - real terrains for measurements, where TERRACLIP_DATA names the folder that holds them. */
#ifndef DATASETS_H
#define DATASETS_H

#include "common/terraclip.h"

typedef struct dataset {
    const char *name;     /* file name; "default": the synthetic default terrain */
    double spacing, unit; /* metres; 0: the file's own */
} dataset;

/* Loads a dataset as a grid. False, saying why on stdout, where it is not there. */
bool dataset_load(const dataset *d, tc_grid *grid);

#endif
