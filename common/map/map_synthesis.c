/* map_synthesis.c - levels finer than the data on all charts of a map, by one fit. */
#include "map.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/chart/joined.h"
#include "common/field/field.h"
#include "common/packed/file/container.h"
#include "common/synthesis/synthesis.h"

struct tc_map_noise {
    const tc_map *map;
    tc_chart chart; /* with the spacing of the data's finest level */
};

/* Where charts share a place each one's noise is its own, of which a mean would have less: 1 / the root of the sum of
 * the shares' squares. */
static float noise_share(const void *context, double i, double j)
{
    const double degree = M_PI / 180, least = (TC_CAP_BLEND_START - 0.01) * degree,
                 most = (TC_CAP_BLEND_END + 0.01) * degree;
    const struct tc_map_noise *n = context;
    const tc_chart *c = &n->chart;
    const double x = c->x0 + i * c->dx, y = c->y0 + j * c->dy;
    if (c->class == &tc_chart_lonlat && (fabs(y) < least || fabs(y) > most)) /* most of a globe: no sine is needed */
        return 1;
    const double normal[3] = {0, 0, c->class->sine(c, x, y)}; /* caps look at no more */
    if (fabs(normal[2]) <= TC_CAP_BLEND_START_SINE || fabs(normal[2]) >= TC_CAP_BLEND_END_SINE)
        return 1;
    double share[TC_MAP_CHARTS], sum = 0;
    tc_map_shares(n->map, normal, share);
    for (int k = 0; k < n->map->charts; k++)
        sum += share[k] * share[k];
    return (float)(1 / sqrt(sum));
}

/* Towards the sides of a face noise goes out, within this many samples of the data: on a seam both faces' levels then
 * are the data's own, interpolated alike, and there is no step across it. */
static float noise_inside(const void *context, double i, double j)
{
    const double fade = 4;
    const struct tc_map_noise *n = context;
    double cells = rint(1 / n->chart.dx), near = fmin(fmin(i, cells - i), fmin(j, cells - j));
    return (float)fmin(fmax(near / fade, 0), 1);
}

/* Levels until samples are a tenth of a metre apart. */
static int levels_for(const tc_map *map)
{
    const double near = 0.1;
    const tc_field *field = map->chart[0].field;
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    double apart = fmax(finest.spacing_x, finest.spacing_y);
    int levels = 0;
    for (; apart > near && levels < TC_SYNTHESIS_MOST; apart /= 2)
        levels++;
    return levels;
}

/* Replaces a chart's field by one with more levels. */
static tc_status add_levels(tc_map *map, int k, int levels, const tc_synthesis_fit *fit, tc_error *error)
{
    tc_chart *c = &map->chart[k];
    const tc_level finest = tc_field_level(c->field, tc_field_info(c->field)->levels);
    if (finest.width < 2 && finest.height < 2)
        return TC_OK;
    tc_synthesis_share share = {NULL, NULL};
    if (map->charts > 1)
        share = (tc_synthesis_share){c->class->seam ? noise_inside : noise_share, &map->noise[k]};
    tc_field *field = c->field;
    c->field = NULL;
    tc_status status = tc_synthesis_create(field, levels, fit, k, share, &field, error);
    if (status == TC_OK)
        *c = tc_chart_over(c->class, field, k, c->x0, c->y0, ldexp(c->dx, -levels), ldexp(c->dy, -levels));
    return status;
}

/* The fit that was stored when the file was packed, or what the heights tell. A file cut short lacks the levels that
 * the stored one goes on from. */
static tc_status find_fit(const tc_map *map, tc_synthesis_fit *fit_ret, tc_error *error)
{
    const tc_field *field = map->chart[0].field;
    const tc_container *c = tc_field_container(field);
    const tc_packed_info *info = tc_field_packed_info(field);
    if (map->fit) {
        *fit_ret = *map->fit;
        return TC_OK;
    }
    if (!c || !c->synthesis || !info || info->levels_missing > 0)
        return tc_synthesis_learn(field, fit_ret, error);
    *fit_ret = *c->synthesis;
    return TC_OK;
}

tc_status tc_map_learn(const tc_map *map, struct tc_synthesis_fit **fit_ret, tc_error *error)
{
    tc_synthesis_fit *fit = malloc(sizeof *fit);
    if (!fit)
        return tc_fail(error, TC_ERR_MEMORY, "synthesis: not enough memory");
    tc_status status = find_fit(map, fit, error);
    if (status == TC_OK)
        *fit_ret = fit;
    else
        free(fit);
    return status;
}

/* The data's samples on sides are those of one face already; of what is synthesised it is not known. */
static bool join_again(tc_map *map)
{
    const tc_terrain_info *info = tc_field_info(map->chart[0].field);
    float apart[TC_MAX_FIELD_LEVELS];
    for (int l = 1; l <= info->levels; l++)
        apart[l - 1] = l > info->levels - info->synthesised ? INFINITY : 0;
    return tc_charts_join(map->chart, map->charts, apart);
}

tc_status tc_map_synthesise(tc_map *map, int levels, tc_error *error)
{
    const int most = 31; /* levels that views draw, less one */
    tc_synthesis_fit fit;
    if (levels == TC_SYNTHESIS_AUTO)
        levels = levels_for(map);
    for (int k = 0; k < map->charts; k++)
        levels = (int)fmin(levels, most - tc_field_info(map->chart[k].field)->levels);
    if (levels <= 0)
        return TC_OK;
    tc_status status = find_fit(map, &fit, error);
    if (status == TC_OK && !(map->noise = calloc((size_t)map->charts, sizeof *map->noise)))
        status = tc_fail(error, TC_ERR_MEMORY, "synthesis: not enough memory");
    for (int k = 0; k < map->charts && status == TC_OK; k++) {
        map->noise[k] = (struct tc_map_noise){map, map->chart[k]};
        status = add_levels(map, k, levels, &fit, error);
    }
    if (status == TC_OK && map->chart[0].class->seam && !join_again(map))
        status = tc_fail(error, TC_ERR_MEMORY, "synthesis: not enough memory");
    if (status == TC_OK)
        map->synthesised = tc_field_info(map->chart[0].field)->synthesised;
    return status;
}
