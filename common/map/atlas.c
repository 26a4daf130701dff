/* atlas.c - the charts of a planet from a grid in memory. */
#include "atlas.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/chart/atlas_caps.h"
#include "common/base/rect.h"
#include "common/base/status.h"

static const double pi = 3.141592653589793, degree = 0.017453292519943295;

int64_t tc_atlas_width(int64_t width, int64_t height)
{
    int halvings = 0;
    while (tc_ceil_shift(tc_max64(width, height), halvings) > TC_MOST_ODD)
        halvings++;
    return tc_ceil_shift(width, halvings) << halvings;
}

bool tc_atlas_around(int64_t columns, double turn)
{
    return fabs((double)columns - turn) <= 0.5 + 1e-6;
}

/* Where the grid's samples lie, rows south to north. */
static tc_lonlat lonlat_of(const tc_grid *grid)
{
    const double *t = grid->georef.transform;
    return (tc_lonlat){grid->width,
                       grid->height,
                       (t[0] + 0.5 * t[1]) * degree,
                       (t[3] + ((double)grid->height - 0.5) * t[5]) * degree,
                       t[1] * degree,
                       -t[5] * degree};
}

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

tc_status tc_atlas_check_relief(const char *name, double z_min, double z_max, double radius, tc_error *error)
{
    if (!(z_min > -0.999 * radius) || !(z_max < radius))
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: expected heights that are small beside the radius of %.6g m, found %.6g to %.6g m; "
                       "--unit and --radius set the scale",
                       name, radius, z_min, z_max);
    return TC_OK;
}

tc_status tc_atlas_check_grid(const char *name, const tc_grid *grid, double radius, tc_error *error)
{
    double low = (double)grid->z_min, high = (double)grid->z_max;
    if (grid->voids_flat && grid->void_count > 0)
        low = fmin(low, (double)grid->void_height), high = fmax(high, (double)grid->void_height);
    return tc_atlas_check_relief(name, grid->z_base + low, grid->z_base + high, radius, error);
}

static tc_status check(const tc_grid *grid, double radius, tc_error *error)
{
    const double *t = grid->georef.transform;
    if (!(radius > 0) || !isfinite(radius))
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a radius above 0 m, found %g", radius);
    if (!grid->z || grid->width < 1 || grid->height < 1)
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a grid of samples, found none");
    if (!grid->georef.known || !grid->georef.geographic || !(t[1] > 0) || !(t[5] < 0) || t[2] != 0 || t[4] != 0)
        return tc_fail(error, TC_ERR_USAGE, "planet: expected a grid of longitude and latitude, found another");
    return tc_atlas_check_grid("planet", grid, radius, error);
}

static tc_status build(tc_grid *grid, int threads, tc_grid cap[TC_CAPS], tc_atlas *atlas, tc_error *error)
{
    tc_lonlat at = lonlat_of(grid);
    double south = at.y0 + pi / 2, north = pi / 2 - (at.y0 + (double)(at.height - 1) * at.dy), row = 1.001 * at.dy;
    bool wraps = tc_atlas_around(at.width, 2 * pi / at.dx), poles = wraps && south < row && north < row;
    if (wraps && tc_atlas_width(at.width, at.height) != at.width)
        return tc_fail(error, TC_ERR_USAGE,
                       "planet: expected a width around the globe that can be halved until it and the height are at "
                       "most %d samples, found %" PRId64 " x %" PRId64,
                       (int)TC_MOST_ODD, at.width, at.height);
    if (wraps)
        at.dx = 2 * pi / (double)at.width;
    tc_status status = poles ? make_caps(grid, &at, atlas->radius, threads, cap) : TC_OK;
    if (status == TC_ERR_USAGE)
        return tc_fail(error, status, "planet: expected at least 4 rows between the poles, none beyond, found %" PRId64,
                       at.height);
    if (status != TC_OK)
        return tc_fail(error, status, "planet: not enough memory for its polar caps");

    double half = 0.5 * (double)(cap[0].width - 1) * at.dy;
    grid->wraps_x = wraps;
    grid->spacing_x = at.dx * atlas->radius;
    grid->spacing_y = at.dy * atlas->radius;
    atlas->charts = poles ? TC_MAX_CHARTS : 1;
    atlas->chart[0] = (tc_chart){NULL, TC_LONLAT, at.x0, at.y0, at.dx, at.dy, wraps};
    atlas->chart[1] = (tc_chart){NULL, TC_CAP_NORTH, -half, -half, at.dy, at.dy, false};
    atlas->chart[2] = (tc_chart){NULL, TC_CAP_SOUTH, -half, -half, at.dy, at.dy, false};
    for (int c = 0; c < atlas->charts && status == TC_OK; c++)
        status = tc_field_build(c == 0 ? grid : &cap[c - 1], threads, &atlas->chart[c].field, error);
    for (int c = atlas->charts; c < TC_MAX_CHARTS; c++)
        atlas->chart[c] = (tc_chart){0};
    return status;
}

tc_status tc_atlas_build(tc_grid *grid, double radius, int threads, tc_atlas *atlas_ret, tc_error *error)
{
    tc_atlas atlas = {.radius = radius};
    tc_grid cap[TC_CAPS] = {{0}};
    tc_status status = check(grid, radius, error);
    if (status == TC_OK)
        status = build(grid, threads, cap, &atlas, error);
    tc_grid_free(grid);
    for (int c = 0; c < TC_CAPS; c++)
        tc_grid_free(&cap[c]);
    if (status == TC_OK)
        *atlas_ret = atlas;
    else
        tc_atlas_free(&atlas);
    return status;
}

void tc_atlas_free(tc_atlas *atlas)
{
    for (int c = 0; atlas && c < TC_MAX_CHARTS; c++)
        tc_field_destroy(atlas->chart[c].field);
    if (atlas)
        *atlas = (tc_atlas){0};
}
