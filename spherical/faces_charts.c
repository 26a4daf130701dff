/* faces_charts.c - the charts that are drawn: the map's, with finer levels where its cells are too wide.
 *
 * Heights go evenly over a cell's two triangles (tc_map_height()), which on a globe are curved; those that are drawn
 * are flat. Over samples kilometres apart their middles lie metres below the globe, and each finer level leaves a
 * quarter. */
#include <math.h>
#include <string.h>

#include "common/base/status.h"
#include "common/chart/joined.h"
#include "common/field/refined_field.h"
#include "faces_internal.h"

/* Levels until a cell's edge is so small an angle: its middle then is 1e-10 of the radius too low, on an Earth half a
 * millimetre. */
static int levels_until_flat(const tc_field *field)
{
    const double flat = 2.5e-5;
    const tc_terrain_info *info = tc_field_info(field);
    const double cell = M_PI / 2 / (double)(tc_field_level(field, info->levels).width - 1);
    int levels = 0;
    while (ldexp(flat, levels) < cell && info->levels + levels < TC_MAX_FIELD_LEVELS)
        levels++;
    return levels;
}

tc_status tc_faces_set_charts(faces_surface *s, tc_error *error)
{
    const int charts = s->map->charts, levels = levels_until_flat(s->map->chart[0].field);
    bool enough = true;
    memcpy(s->chart, s->map->chart, (size_t)charts * sizeof *s->chart);
    s->head.field = s->chart[0].field;
    if (levels == 0)
        return TC_OK;
    for (int k = 0; k < charts; k++) {
        const tc_chart *c = &s->map->chart[k];
        tc_field *field = tc_refined_field(c->field, levels);
        enough &= field != NULL;
        s->chart[k].field = NULL;
        if (field)
            s->chart[k] = tc_chart_face(c->class, field, k);
    }
    /* What lies beyond a side is a neighbour's, on these levels, too. */
    if (!enough || !tc_charts_join(s->chart, charts, NULL))
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", s->kind->name);
    s->head.field = s->chart[0].field;
    return TC_OK;
}

void tc_faces_drop_charts(faces_surface *s)
{
    for (int k = 0; k < s->map->charts; k++)
        if (s->chart[k].field != s->map->chart[k].field)
            tc_field_destroy(s->chart[k].field);
}
