/* map_build.c - a map from a grid in memory. */
#include "map.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "common/chart/atlas_caps.h"
#include "common/base/rect.h"
#include "common/base/status.h"

/* ---- Caps -------------------------------------------------------------------------------------------------------- */

/* One grid of a cap, without heights yet, like that of the globe. */
static bool allocate_cap(const tc_grid *grid, int64_t side, double spacing, tc_grid *cap)
{
    *cap = (tc_grid){.width = side, .height = side, .spacing_x = spacing, .spacing_y = spacing};
    cap->z_base = grid->z_base;
    cap->voids_flat = grid->voids_flat;
    cap->void_height = grid->void_height;
    cap->georef.semi_major = grid->georef.semi_major; /* tells the body */
    cap->z = malloc((size_t)(side * side) * sizeof *cap->z);
    cap->voids = grid->void_count > 0 ? malloc((size_t)(side * side)) : NULL;
    return cap->z && (grid->void_count <= 0 || cap->voids);
}

static tc_status make_caps(const tc_grid *grid, const tc_lonlat *lonlat, double radius, int threads,
                           tc_grid cap[TC_CAPS])
{
    int64_t side = tc_caps_side(lonlat);
    tc_cap_target target[TC_CAPS];
    tc_cap_result result[TC_CAPS];
    for (int c = 0; c < TC_CAPS; c++) {
        if (!allocate_cap(grid, side, lonlat->dy * radius, &cap[c]))
            return TC_ERR_MEMORY;
        target[c] = (tc_cap_target){cap[c].z, cap[c].voids};
    }
    tc_caps *caps = NULL;
    tc_status status = tc_caps_create(lonlat, target, threads, &caps);
    if (status == TC_OK)
        status = tc_caps_put(caps, 0, grid->height, grid->z, grid->void_count > 0 ? grid->voids : NULL);
    if (status == TC_OK)
        status = tc_caps_finish(caps, result);
    tc_caps_destroy(caps);
    for (int c = 0; c < TC_CAPS && status == TC_OK; c++) {
        cap[c].z_min = result[c].z_min;
        cap[c].z_max = result[c].z_max;
        cap[c].void_count = result[c].void_count;
    }
    return status;
}

/* ---- A planet ---------------------------------------------------------------------------------------------------- */

static tc_status check(const tc_grid *grid, const tc_body *body, tc_lonlat *at, tc_error *error)
{
    if (!isfinite(body->radius))
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a radius above 0 m, found %g", body->radius);
    if (!grid->z || grid->width < 1 || grid->height < 1)
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a grid of samples, found none");
    if (!tc_lonlat_of(&grid->georef, grid->width, grid->height, at))
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a grid of longitude and latitude, found another");
    tc_status status = tc_map_check_grid("planet", grid, body, error);
    if (status != TC_OK)
        return status;
    if (at->round && tc_lonlat_width(at->width, at->height) != at->width)
        return tc_fail(error, TC_ERR_USAGE,
                       "planet: expected a width around the globe that can be halved until it and the height are at "
                       "most %d samples, found %" PRId64 " x %" PRId64,
                       (int)TC_MOST_ODD, at->width, at->height);
    return TC_OK;
}

static tc_status build_globe(tc_grid *grid, int threads, tc_map *map, tc_error *error)
{
    static const tc_chart_class *const caps[TC_CAPS] = {&tc_chart_north_cap, &tc_chart_south_cap};
    tc_lonlat at;
    tc_grid cap[TC_CAPS] = {{0}};
    tc_status status = check(grid, &map->body, &at, error);
    if (status != TC_OK)
        return status;
    tc_lonlat_close(&at);
    status = at.poles ? make_caps(grid, &at, map->body.radius, threads, cap) : TC_OK;
    if (status == TC_ERR_USAGE)
        tc_fail(error, status, "planet: expected at least 4 rows between the poles, none beyond, found %" PRId64,
                at.height);
    else if (status != TC_OK)
        tc_fail(error, status, "planet: not enough memory for its polar caps");
    double half = 0.5 * (double)(cap[0].width - 1) * at.dy;
    grid->wraps_x = at.round;
    grid->spacing_x = at.dx * map->body.radius;
    grid->spacing_y = at.dy * map->body.radius;
    for (int k = 0; k < (at.poles ? 1 + TC_CAPS : 1) && status == TC_OK; k++) {
        tc_field *field;
        if ((status = tc_field_build(k == 0 ? grid : &cap[k - 1], threads, &field, error)))
            break;
        map->chart[map->charts++] = k == 0 ? tc_chart_over(&tc_chart_lonlat, field, k, at.x0, at.y0, at.dx, at.dy)
                                           : tc_chart_over(caps[k - 1], field, k, -half, -half, at.dy, at.dy);
    }
    for (int c = 0; c < TC_CAPS; c++)
        tc_grid_free(&cap[c]);
    return status;
}

/* ---- A plane ----------------------------------------------------------------------------------------------------- */

static tc_status build_flat(tc_grid *grid, int threads, tc_map *map, tc_error *error)
{
    tc_field *field;
    double dx = grid->spacing_x, dy = grid->spacing_y;
    tc_status status = tc_field_build(grid, threads, &field, error);
    if (status == TC_OK)
        map->chart[map->charts++] = tc_chart_over(&tc_chart_plane, field, 0, 0, 0, dx, dy);
    return status;
}

static tc_status build(tc_grid *grid, tc_body body, int threads, tc_map **map_ret, tc_error *error)
{
    tc_map *map = tc_map_create(body, 1 + TC_CAPS);
    if (!map) {
        tc_grid_free(grid);
        return tc_fail(error, TC_ERR_MEMORY, "map: not enough memory");
    }
    map->width = grid->width, map->height = grid->height;
    map->georef = grid->georef;
    map->area_registered = grid->area_registered;
    map->georef.crs_wkt = NULL; /* the field's */
    tc_status status = body.radius > 0 ? build_globe(grid, threads, map, error) : build_flat(grid, threads, map, error);
    tc_grid_free(grid);
    if (status != TC_OK) {
        tc_map_destroy(map);
        return status;
    }
    tc_level finest = tc_field_level(map->chart[0].field, tc_field_info(map->chart[0].field)->levels);
    map->spacing_x = finest.spacing_x, map->spacing_y = finest.spacing_y;
    map->grid = tc_chart_grid(&map->chart[0]);
    map->voids = TC_VOIDS_FILL;
    *map_ret = map;
    return TC_OK;
}

tc_status tc_map_build(tc_grid *grid, double radius, int threads, tc_map **map_ret, tc_error *error)
{
    if (!(radius >= 0)) {
        tc_grid_free(grid);
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a radius above 0 m, found %g", radius);
    }
    return build(grid, tc_body_of(radius), threads, map_ret, error);
}

tc_status tc_map_build_ellipsoid(tc_grid *grid, double semi_major, double flattening, int threads, tc_map **map_ret,
                                 tc_error *error)
{
    if (!(semi_major > 0) || !(flattening >= 0 && flattening < 1)) {
        tc_grid_free(grid);
        return tc_fail(error, TC_ERR_USAGE,
                       "planet: expected a semi-major axis above 0 m and a flattening of 0 or more, below 1, found %g "
                       "and %g",
                       semi_major, flattening);
    }
    return build(grid, tc_body_flattened(semi_major, flattening), threads, map_ret, error);
}
