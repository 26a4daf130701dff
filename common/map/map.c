/* map.c - what is the same for every map: its parts, and the height at a place. */
#include "map.h"

#include "common/field/point.h"

#include <math.h>
#include <stdlib.h>

tc_map *tc_map_create(tc_body body, int charts)
{
    tc_map *map = calloc(1, sizeof *map);
    tc_chart *chart = calloc((size_t)charts, sizeof *chart);
    if (!map || !chart) {
        free(map), free(chart);
        return NULL;
    }
    *map = (tc_map){.users = 1, .body = body, .chart = chart, .exaggeration = 1};
    return map;
}

tc_map *tc_map_flat(tc_field *field)
{
    tc_map *map = tc_map_create(tc_body_of(0), 1);
    if (!map) {
        tc_field_destroy(field);
        return NULL;
    }
    const tc_level finest = tc_field_level(field, tc_field_info(field)->levels);
    map->chart[map->charts++] = tc_chart_over(&tc_chart_plane, field, 0, 0, 0, finest.spacing_x, finest.spacing_y);
    map->width = finest.width, map->height = finest.height;
    map->grid = tc_chart_grid(&map->chart[0]);
    map->spacing_x = finest.spacing_x, map->spacing_y = finest.spacing_y;
    return map;
}

tc_map *tc_map_share(tc_map *map)
{
    atomic_fetch_add(&map->users, 1);
    return map;
}

void tc_map_destroy(tc_map *map)
{
    if (!map || atomic_fetch_sub(&map->users, 1) > 1)
        return;
    for (int k = 0; k < map->charts; k++)
        tc_field_destroy(map->chart[k].field);
    free(map->chart);
    free(map->noise);
    free(map->fit);
    free(map);
}

int tc_map_charts(const tc_map *map)
{
    return map->charts;
}

const tc_field *tc_map_field(const tc_map *map, int chart)
{
    return map->chart[chart].field;
}

double tc_map_radius(const tc_map *map)
{
    return map->body.radius;
}

tc_status tc_map_check_grid(const char *name, const tc_grid *grid, const tc_body *body, tc_error *error)
{
    double low = (double)grid->z_min, high = (double)grid->z_max;
    if (grid->voids_flat && grid->void_count > 0)
        low = fmin(low, (double)grid->void_height), high = fmax(high, (double)grid->void_height);
    return body->class->check_relief(body, name, grid->z_base + low, grid->z_base + high, error);
}

double tc_map_flattening(const tc_map *map)
{
    return map->body.flattening;
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

static bool larger(const tc_field *field, int level, int64_t most)
{
    const tc_level size = tc_field_level(field, level);
    return size.width > most || size.height > most;
}

void tc_map_shares(const tc_map *map, const double normal[3], double *share_ret)
{
    tc_chart_shares(map->chart, map->charts, normal, share_ret);
}

/* Of the finest levels, or of those of at most `most` samples a side. */
static tc_status height(const tc_map *map, int64_t most, double x, double y, double *z_ret)
{
    const double place[3] = {x, y, 0};
    double z_base = tc_field_info(map->chart[0].field)->z_base, z = 0, share[TC_MAP_CHARTS], normal[3];
    map->body.class->normal(&map->body, place, normal);
    tc_map_shares(map, normal, share);
    for (int k = 0; k < map->charts; k++) {
        const tc_chart *c = &map->chart[k];
        int level = tc_field_info(c->field)->levels;
        double u, v, part = -z_base; /* where there is none, that of the body */
        bool there = false;
        if (share[k] <= 0)
            continue;
        while (level > 1 && larger(c->field, level, most))
            level--;
        c->class->from_place(c, x, y, &u, &v);
        tc_status status = c->class->height(c, level, u, v, &there, &part);
        if (status)
            return status;
        z += share[k] * part;
    }
    *z_ret = z + z_base;
    return TC_OK;
}

tc_status tc_map_height(const tc_map *map, double x, double y, double *z_ret)
{
    return height(map, INT64_MAX, x, y, z_ret);
}

tc_status tc_map_rough_height(const tc_map *map, double x, double y, double *z_ret)
{
    return height(map, TC_ROUGH_SIZE, x, y, z_ret);
}

tc_status tc_map_hole(const tc_map *map, double x, double y, bool *hole_ret)
{
    const double place[3] = {x, y, 0};
    double share[TC_MAP_CHARTS], normal[3], u, v;
    int most = 0;
    *hole_ret = false;
    if (map->voids != TC_VOIDS_HOLE)
        return TC_OK;
    map->body.class->normal(&map->body, place, normal);
    tc_map_shares(map, normal, share);
    for (int k = 1; k < map->charts; k++)
        most = share[k] > share[most] ? k : most;
    const tc_chart *c = &map->chart[most];
    const int level = tc_field_info(c->field)->levels;
    tc_cell cell;
    c->class->from_place(c, x, y, &x, &y);
    tc_chart_samples(c, level, x, y, &u, &v);
    tc_status status = tc_field_cell(c->field, level, u, v, true, &cell);
    *hole_ret = status == TC_OK && tc_cell_void(&cell);
    return status;
}

void tc_map_extent(const tc_map *map, double lo[2], double hi[2])
{
    const tc_chart *c = &map->chart[0];
    const tc_level finest = tc_field_level(c->field, tc_field_info(c->field)->levels);
    lo[0] = c->x0, hi[0] = c->x0 + (double)(finest.width - 1) * c->dx;
    lo[1] = c->y0, hi[1] = c->y0 + (double)(finest.height - 1) * c->dy;
    if (c->class->seam) /* faces: all around */
        lo[0] = -M_PI, hi[0] = M_PI, lo[1] = -M_PI / 2, hi[1] = M_PI / 2;
}

void tc_map_georef_samples(const tc_map *map, double x, double y, double *u, double *v)
{
    const double *g = map->georef.transform;
    const double determinant = g[1] * g[5] - g[2] * g[4];
    x -= g[0];
    y -= g[3];
    *u = (x * g[5] - y * g[2]) / determinant - 0.5;
    *v = (double)map->height - 0.5 - (y * g[1] - x * g[4]) / determinant;
}

tc_range tc_map_range(const tc_map *map)
{
    tc_range all = {INFINITY, -INFINITY, 0, 0};
    for (int chart = 0; chart < map->charts; chart++) {
        const tc_field *field = map->chart[chart].field;
        for (int l = 1; l <= tc_field_info(field)->levels; l++) {
            const tc_level size = tc_field_level(field, l);
            const tc_range one = tc_field_range(field, l, (tc_rect){0, 0, size.width, size.height});
            all.lo = fminf(all.lo, one.lo), all.hi = fmaxf(all.hi, one.hi);
        }
    }
    return all;
}

bool tc_map_has_ground(const tc_map *map, double x, double y)
{
    const tc_chart *c = &map->chart[0];
    int finest = tc_field_info(c->field)->levels;
    const tc_level size = tc_field_level(c->field, finest);
    double u, v;
    c->class->from_place(c, x, y, &x, &y);
    tc_chart_samples(c, finest, x, y, &u, &v);
    return map->body.class->solid ||
           (u >= 0 && u <= (double)(size.width - 1) && v >= 0 && v <= (double)(size.height - 1));
}

/* ---- Telling ----------------------------------------------------------------------------------------------------- */

static tc_field_stats tell(const tc_map *map)
{
    tc_field_stats all = {0};
    for (int k = 0; k < map->charts; k++) {
        const tc_field_stats one = tc_field_tell(map->chart[k].field);
        all.damaged += one.damaged;
        all.unreadable += one.unreadable;
        all.decoded += one.decoded;
    }
    return all;
}

int64_t tc_map_damaged(const tc_map *map)
{
    return tell(map).damaged;
}

int64_t tc_map_unreadable(const tc_map *map)
{
    return tell(map).unreadable;
}

int64_t tc_map_bytes_decoded(const tc_map *map)
{
    return tell(map).decoded;
}
