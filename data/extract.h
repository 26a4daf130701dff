/* extract.h - `terraclip extract`: writes a level of a packed terrain as a GeoTIFF. */
#ifndef TC_EXTRACT_H
#define TC_EXTRACT_H

#include "common/terraclip.h"

#include <stdio.h>

/* argv[0] is "extract". On failure *error says why. */
tc_status tc_extract_main(int argc, char **argv, tc_error *error);

void tc_extract_help(FILE *file);

#endif
