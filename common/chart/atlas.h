/* atlas.h - ways of laying charts over a globe, by name. */
#ifndef TC_ATLAS_H
#define TC_ATLAS_H

#include "chart.h"

typedef struct tc_atlas {
    const char *name;            /* as on the command line */
    const tc_chart_class *class; /* of its first chart */
    int charts;                  /* faces; of lonlat the grid, with its caps */
} tc_atlas;

extern const tc_atlas tc_atlas_lonlat, tc_atlas_hex, tc_atlas_cube;

/* NULL: none of that name, or none that begins with such a chart. */
const tc_atlas *tc_atlas_named(const char *name);
const tc_atlas *tc_atlas_of(const tc_chart_class *class);

/* By name: each library has tables of its own. Both NULL: the same. */
bool tc_atlas_same(const tc_atlas *a, const tc_atlas *b);

#endif
