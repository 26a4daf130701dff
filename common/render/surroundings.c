/* surroundings.c - what the edge of a map says of what lies beyond it. */
#include "surroundings.h"

#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/field/field.h"
#include "palette.h"

/* ---- Decisions --------------------------------------------------------------------------------------------------- */

bool tc_edge_at_sea(const tc_edge *edge, double relief, double *depth_ret)
{
    /* A shore as it is measured: half a metre of waves and tides, more where heights are coarse. */
    const double shore = fmax(0.5, 8e-4 * relief), SHARE = 0.1;
    int below = 0;
    while (below < edge->count && (double)edge->height[below] <= shore)
        below++;
    *depth_ret = below > 0 ? fmax(-(double)edge->height[below / 5], 0) : 0; /* deeper than most: shores are shallow */
    return below > 0 && below >= SHARE * edge->count;
}

double tc_edge_plain(const tc_edge *edge, double *depth_ret)
{
    *depth_ret = 0;
    if (edge->count == 0)
        return 0;
    const double low = (double)edge->height[edge->count / 20];
    *depth_ret = low - (double)edge->height[edge->count / 2];
    return low;
}

double tc_wall_below(double relief, double side)
{
    return fmax(0.1 * relief, 0.022 * side);
}

/* ---- The edge of a map ------------------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Heights of one side of a level that are no voids. */
static tc_status read_side(const tc_field *field, int level, tc_rect side, float *z, uint8_t *voids, tc_edge *edge,
                           tc_error *error)
{
    const ptrdiff_t width = side.x1 - side.x0, count = width * (side.y1 - side.y0);
    tc_status status = tc_field_read(field, level, side, z, voids, width);
    if (status != TC_OK)
        return tc_fail(error, status, "terrain: its edge cannot be read");
    for (ptrdiff_t i = 0; i < count; i++)
        if (!voids[i])
            edge->height[edge->count++] = (float)((double)z[i] + tc_field_info(field)->z_base);
    return TC_OK;
}

/* Of the finest level that is no larger than that. */
static tc_status read_edge(const tc_field *field, tc_edge *edge, tc_error *error)
{
    enum { MOST = 1024 };
    int level = tc_field_info(field)->levels;
    tc_level size = tc_field_level(field, level);
    while (level > 1 && (size.width > MOST || size.height > MOST))
        size = tc_field_level(field, --level);
    const int64_t w = size.width, h = size.height, most = tc_max64(w, h);
    float *z = malloc((size_t)most * sizeof *z);
    uint8_t *voids = malloc((size_t)most);
    *edge = (tc_edge){0, malloc((size_t)(2 * (w + h)) * sizeof *edge->height)};
    tc_status status = TC_OK;
    if (!z || !voids || !edge->height)
        status = tc_fail(error, TC_ERR_MEMORY, "terrain: not enough memory to look at its edge");
    const tc_rect sides[] = {{0, 0, w, 1}, {0, h - 1, w, h}, {0, 0, 1, h}, {w - 1, 0, w, h}};
    for (int i = 0; i < 4 && status == TC_OK; i++)
        status = read_side(field, level, sides[i], z, voids, edge, error);
    if (status == TC_OK)
        qsort(edge->height, (size_t)edge->count, sizeof *edge->height, compare);
    free(z);
    free(voids);
    return status;
}

/* Whether a globe's map leaves some of it out; and whether it is so small that its edge says what is around. */
static bool is_part(const tc_map *map, bool *small_ret)
{
    double lo[2], hi[2];
    tc_map_extent(map, lo, hi);
    *small_ret = hi[0] - lo[0] < 1 && hi[1] - lo[1] < 1;
    return hi[0] - lo[0] < 2 * M_PI - 0.1 || hi[1] - lo[1] < M_PI - 0.1;
}

/* Latitudes of a flat map, where its georeference is in degrees. */
static bool find_latitudes(const tc_map *map, double *south_ret, double *north_ret)
{
    const double *t = map->georef.transform, degree = M_PI / 180;
    *north_ret = t[3] * degree, *south_ret = (t[3] + t[5] * (double)map->height) * degree;
    return map->georef.known && map->georef.geographic && t[4] == 0 && fabs(*north_ret) <= 0.5 * M_PI + 0.01 &&
           fabs(*south_ret) <= 0.5 * M_PI + 0.01;
}

tc_status tc_surroundings_of(const tc_map *map, tc_surroundings *surroundings_ret, tc_error *error)
{
    const tc_field *field = map->chart[0].field;
    const tc_terrain_info *info = tc_field_info(field);
    const tc_level finest = tc_field_level(field, info->levels);
    const double relief = (double)info->z_max - (double)info->z_min, lowest = info->z_base + (double)info->z_min;
    const bool flat = !map->body.class->solid;
    bool small = flat;
    tc_surroundings s = {.walls = flat, .plain = !flat && is_part(map, &small), .climate = !flat};
    s.night_stars = flat && tc_palette_make(info).air; /* on a plane nobody leaves the air */
    s.stars = !s.night_stars;
    if (flat)
        s.climate = find_latitudes(map, &s.south, &s.north);
    tc_edge edge = {0};
    tc_status status = small ? read_edge(field, &edge, error) : TC_OK;
    if (status == TC_OK) {
        /* Of a map that is the sea's bottom alone it would be all that is seen. */
        const bool bottom = flat && info->z_base + (double)info->z_max < 0;
        s.sea = small && !info->other_body && map->sea.kind == TC_SEA_FOUND && !bottom &&
                tc_edge_at_sea(&edge, relief, &s.depth);
        if (map->sea.kind == TC_SEA_GIVEN)
            s.sea = true, s.level = map->sea.level * map->exaggeration;
        else if (small && !s.sea)
            s.level = tc_edge_plain(&edge, &s.depth);
        s.foot = lowest - tc_wall_below(relief, fmax((double)finest.width * finest.spacing_x,
                                                     (double)finest.height * finest.spacing_y));
        *surroundings_ret = s;
    }
    free(edge.height);
    return status;
}
