/* info.h - `terraclip info`: shows what a packed terrain holds. */
#ifndef TC_INFO_H
#define TC_INFO_H

#include "common/terraclip.h"

#include <stdio.h>

/* argv[0] is "info". On failure *error says why. */
tc_status tc_info_main(int argc, char **argv, tc_error *error);

void tc_info_help(FILE *file);

#endif
