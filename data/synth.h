/* synth.h - `terraclip synth`: writes a synthetic terrain. */
#ifndef TC_SYNTH_H
#define TC_SYNTH_H

#include "common/terraclip.h"

#include <stdio.h>

/* argv[0] is "synth". On failure *error says why. */
tc_status tc_synth_main(int argc, char **argv, tc_error *error);

void tc_synth_help(FILE *file);

#endif
