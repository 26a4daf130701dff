/* atlas.c - the table of atlases. */
#include "atlas.h"

#include <string.h>

const tc_atlas tc_atlas_lonlat = {"lonlat", &tc_chart_lonlat, 3}, tc_atlas_hex = {"hex", &tc_chart_hex, 4},
               tc_atlas_cube = {"cube", &tc_chart_cube, 6};

static const tc_atlas *const atlases[] = {&tc_atlas_lonlat, &tc_atlas_hex, &tc_atlas_cube};
enum { ATLASES = sizeof atlases / sizeof *atlases };

const tc_atlas *tc_atlas_named(const char *name)
{
    for (int k = 0; k < ATLASES; k++)
        if (strcmp(atlases[k]->name, name) == 0)
            return atlases[k];
    return NULL;
}

const tc_atlas *tc_atlas_of(const tc_chart_class *class)
{
    for (int k = 0; k < ATLASES; k++)
        if (atlases[k]->class == class)
            return atlases[k];
    return NULL;
}

bool tc_atlas_same(const tc_atlas *a, const tc_atlas *b)
{
    return a == b || (a && b && strcmp(a->name, b->name) == 0);
}
