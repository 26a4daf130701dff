/* flat_data.h - datasets that are looked at as flat terrains. */
#ifndef FLAT_DATA_H
#define FLAT_DATA_H

#include "datasets.h"

/* Loads a dataset as dataset_load() does. False, saying why on stdout, also where it goes around a globe, or has more
 * than `most` samples (0: no limit), which is looked at before it is read; the default terrain is then 1025 x 1025. */
bool flat_data_load(const dataset *d, int64_t most, tc_grid *grid);

#endif
