/* map_exaggerate.c - a map whose heights are those of its data times a factor, and nowhere below a sea: the sea's field
 * lies over the data's, and that of the factor over both. */
#include "map.h"

#include <math.h>

#include "common/base/status.h"
#include "common/field/changed_field.h"
#include "common/field/flooded_field.h"
#include "common/field/scaled_field.h"

/* Heights that are drawn are no farther from 0, metres: what sources may have at most. */
static const double HIGHEST = 1e9;

static void release(tc_map *map)
{
    for (int k = 0; k < map->charts && map->exaggeration != 1; k++)
        map->chart[k].field = tc_changed_field_release(map->chart[k].field);
    map->exaggeration = 1;
}

/* Whether a height is near enough to 0 to be drawn, and leaves the body a surface. */
static bool within(const tc_map *map, double height)
{
    return fabs(height) <= HIGHEST &&
           map->body.class->check_relief(&map->body, "sea", fmin(height, 0), fmax(height, 0), NULL) == TC_OK;
}

/* Whether the heights of the data, times the factor, leave the body a surface. */
static tc_status check(const tc_map *map, double factor, tc_error *error)
{
    for (int k = 0; k < map->charts; k++) {
        const tc_terrain_info *info = tc_field_info(map->chart[k].field);
        double low = factor * (info->z_base + (double)info->z_min),
               high = factor * (info->z_base + (double)info->z_max);
        bool far = !(fabs(low) <= HIGHEST) || !(fabs(high) <= HIGHEST);
        if (far || map->body.class->check_relief(&map->body, "exaggeration", low, high, NULL) != TC_OK)
            return tc_fail(error, TC_ERR_FORMAT,
                           "exaggeration: expected one that leaves heights small beside the %s, found %g, which makes "
                           "%.6g to %.6g m of them",
                           map->body.radius > 0 ? "radius" : "limit of 1e9 m", factor, low, high);
    }
    if (map->sea.kind == TC_SEA_GIVEN && !within(map, factor * map->sea.level))
        return tc_fail(error, TC_ERR_FORMAT, "exaggeration: expected one that leaves the sea small, found %g, %.6g m",
                       factor, factor * map->sea.level);
    return TC_OK;
}

tc_status tc_map_exaggerate(tc_map *map, double factor, tc_error *error)
{
    const double before = map->exaggeration;
    tc_field *scaled[TC_MAP_CHARTS];
    if (!(factor >= TC_LEAST_EXAGGERATION && factor <= TC_MOST_EXAGGERATION))
        return tc_fail(error, TC_ERR_USAGE, "exaggeration: expected " TC_EXPECTED_EXAGGERATION ", found %g", factor);
    if (factor == before)
        return TC_OK;
    release(map);
    tc_status status = check(map, factor, error);
    if (status != TC_OK)
        factor = before;
    int made = 0;
    while (factor != 1 && made < map->charts &&
           (scaled[made] = tc_scaled_field_create(map->chart[made].field, factor)) != NULL)
        made++;
    if (factor != 1 && made < map->charts) { /* then heights are the data's own */
        while (made-- > 0)
            tc_changed_field_release(scaled[made]);
        return tc_fail(error, TC_ERR_MEMORY, "exaggeration: not enough memory");
    }
    for (int k = 0; k < made; k++)
        map->chart[k].field = scaled[k];
    map->exaggeration = factor;
    return status;
}

/* ---- The sea ----------------------------------------------------------------------------------------------------- */

static void drain(tc_map *map)
{
    for (int k = 0; k < map->charts && map->sea.kind == TC_SEA_GIVEN; k++)
        map->chart[k].field = tc_changed_field_release(map->chart[k].field);
    map->sea = (tc_sea){.kind = TC_SEA_FOUND};
}

/* Of heights that nothing is over. */
static tc_status flood(tc_map *map, tc_sea sea, tc_error *error)
{
    tc_field *flooded[TC_MAP_CHARTS];
    int made = 0;
    while (sea.kind == TC_SEA_GIVEN && made < map->charts &&
           (flooded[made] = tc_flooded_field_create(map->chart[made].field, sea.level)) != NULL)
        made++;
    if (sea.kind == TC_SEA_GIVEN && made < map->charts) { /* then there is none */
        while (made-- > 0)
            tc_changed_field_release(flooded[made]);
        return tc_fail(error, TC_ERR_MEMORY, "sea: not enough memory");
    }
    for (int k = 0; k < made; k++)
        map->chart[k].field = flooded[k];
    map->sea = sea;
    return TC_OK;
}

tc_status tc_map_flood(tc_map *map, tc_sea sea, tc_error *error)
{
    const double factor = map->exaggeration;
    if (sea.kind == map->sea.kind && sea.level == map->sea.level)
        return TC_OK;
    if (sea.kind == TC_SEA_GIVEN && !(within(map, sea.level) && within(map, factor * sea.level)))
        return tc_fail(error, TC_ERR_USAGE, "--sea: expected a level that is small beside the %s, found %.9g m",
                       map->body.radius > 0 ? "radius" : "limit of 1e9 m", sea.level);
    release(map);
    drain(map);
    tc_status status = flood(map, sea, error), again = tc_map_exaggerate(map, factor, status == TC_OK ? error : NULL);
    return status == TC_OK ? again : status;
}
