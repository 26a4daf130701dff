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
    const char *sweep = getenv("TERRACLIP_SWEEP");
    const int asked = sweep ? atoi(sweep) : 0, part = sweep_whole() ? 1 : asked > 0 ? asked : 6;
    return (cases + part - 1) / part;
}
