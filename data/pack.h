/* pack.h - `terraclip pack`: compresses terrains into a file. */
#ifndef TC_PACK_H
#define TC_PACK_H

#include "common/terraclip.h"

#include <stdio.h>

/* argv[0] is "pack". On failure *error says why. */
tc_status tc_pack_main(int argc, char **argv, tc_error *error);

void tc_pack_help(FILE *file);

#endif
