/* height.h - `terraclip height`: tells heights at points. */
#ifndef TC_HEIGHT_H
#define TC_HEIGHT_H

#include "common/terraclip.h"

#include <stdio.h>

/* argv[0] is "height". On failure *error says why. */
tc_status tc_height_main(int argc, char **argv, tc_error *error);

void tc_height_help(FILE *file);

#endif
