/* sweep.c */
#include "sweep.h"

#include <stdlib.h>
#include <string.h>

bool sweep_whole(void)
{
    const char *sweep = getenv("TERRACLIP_SWEEP");
    return sweep && strcmp(sweep, "whole") == 0;
}

int sweep_of(int cases)
{
    return sweep_whole() ? cases : (cases + 5) / 6;
}
