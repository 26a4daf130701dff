/* map_resample.c - a planet's grid of longitude and latitude onto the faces of another atlas, in memory.
 *
 * Levels are filtered across seams: a level goes on beyond its sides with its neighbours' heights on that level
 * (joined.h), as far as the filter looks. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/chart/joined.h"
#include "common/field/fill.h"
#include "common/field/filter.h"
#include "common/field/memory_field.h"
#include "common/chart/resample.h"
#include "map.h"

enum { ROWS = 32, BAND = 64 };

/* ---- The finest level -------------------------------------------------------------------------------------------- */

typedef struct finest_level {
    const tc_map *from;
    const tc_chart_class *class;
    int face;
    int64_t cells;
    tc_grid *grid;
    _Atomic int status;
} finest_level;

static void resample_rows(void *context, int64_t n)
{
    finest_level *l = context;
    tc_rect rect = {0, n * ROWS, l->cells + 1, tc_min64((n + 1) * ROWS, l->cells + 1)};
    int64_t at = rect.y0 * (l->cells + 1);
    const tc_resample_source from = {l->from->chart, l->from->charts, l->from->voids == TC_VOIDS_CONSTANT};
    tc_status status = tc_resample(&from, l->class, l->face, l->cells, rect, l->grid->z + at,
                                   l->grid->voids ? l->grid->voids + at : NULL, l->cells + 1);
    if (status)
        l->status = (int)status;
}

static void measure(tc_grid *g)
{
    g->z_min = INFINITY, g->z_max = -INFINITY, g->void_count = 0;
    for (int64_t i = 0; i < g->width * g->height; i++)
        if (g->voids && g->voids[i])
            g->void_count++, g->void_height = g->z[i];
        else
            g->z_min = fminf(g->z_min, g->z[i]), g->z_max = fmaxf(g->z_max, g->z[i]);
    if (g->void_count == g->width * g->height)
        g->z_min = g->z_max = 0;
}

/* A face's grid; freed by the caller on failure, too. */
static tc_status make_grid(finest_level *l, const tc_atlas *atlas, int threads, tc_grid *g)
{
    const tc_field *field = l->from->chart[0].field;
    const tc_terrain_info *info = tc_field_info(field);
    const tc_georef *georef = tc_field_georef(field);
    int64_t side = l->cells + 1;
    bool voids = false;
    for (int k = 0; k < l->from->charts; k++)
        voids |= tc_field_info(l->from->chart[k].field)->void_count > 0;
    *g = (tc_grid){.width = side, .height = side, .z_base = info->z_base, .georef = *georef};
    g->spacing_x = g->spacing_y = tc_chart_face_spacing(l->from->body.radius, l->cells);
    g->georef.crs_wkt = georef->crs_wkt ? strdup(georef->crs_wkt) : NULL;
    g->z = malloc((size_t)(side * side) * sizeof *g->z);
    g->voids = voids ? malloc((size_t)(side * side)) : NULL;
    if (!g->z || (voids && !g->voids) || (georef->crs_wkt && !g->georef.crs_wkt))
        return TC_ERR_MEMORY;
    l->grid = g, l->class = atlas->class;
    tc_parallel_for(threads, (side + ROWS - 1) / ROWS, resample_rows, l);
    if (l->status)
        return (tc_status)l->status;
    measure(g);
    g->voids_flat = l->from->voids == TC_VOIDS_CONSTANT && g->void_count > 0;
    /* What is shown flat has no share in coarser levels. */
    return g->voids_flat && g->void_count < side * side ? tc_fill_voids(g->z, g->voids, side, side) : TC_OK;
}

/* ---- Coarser levels ---------------------------------------------------------------------------------------------- */

typedef struct step {
    const tc_chart *chart;
    int charts, face, level; /* of the result */
    _Atomic int status;
} step;

/* Rows of a level from the next finer one, which goes on beyond its sides further than the filter looks. */
static void filter_band(void *context, int64_t n)
{
    enum { COARSE = TC_BEYOND / 2 };
    step *s = context;
    const tc_field *field = s->chart[s->face].field;
    const tc_level fine = tc_field_level(field, s->level + 1), coarse = tc_field_level(field, s->level);
    int64_t j0 = n * BAND, j1 = tc_min64(j0 + BAND, coarse.height);
    tc_rect rect = {-TC_BEYOND, 2 * j0 - TC_BEYOND, fine.width + TC_BEYOND,
                    tc_min64(2 * j1 + TC_BEYOND, fine.height + TC_BEYOND)};
    int64_t width = rect.x1 - rect.x0, height = rect.y1 - rect.y0, filtered = tc_coarse_size(width);
    float *in = malloc((size_t)(width * height) * sizeof *in), *out_z;
    float *scratch = malloc(tc_downsample_scratch(width, j1 - j0) * sizeof *scratch);
    float *out = malloc((size_t)(filtered * (j1 - j0)) * sizeof *out);
    uint8_t *voids, *fine_voids;
    tc_status status = in && scratch && out ? TC_OK : TC_ERR_MEMORY;
    if (!status)
        status = tc_joined_read(s->chart, s->charts, s->face, s->level + 1, rect, in, NULL, width);
    if (!status) {
        tc_downsample(in, width, height, false, COARSE, COARSE + j1 - j0, out, scratch);
        tc_memory_field_level((tc_field *)field, s->level + 1, &out_z, &fine_voids);
        tc_memory_field_level((tc_field *)field, s->level, &out_z, &voids);
    }
    for (int64_t j = j0; j < j1 && !status; j++) {
        memcpy(out_z + j * coarse.width, out + (j - j0) * filtered + COARSE, (size_t)coarse.width * sizeof *out);
        for (int64_t i = 0; i < coarse.width && voids; i++) /* outlines of holes meet at shared vertices */
            voids[j * coarse.width + i] = fine_voids[2 * j * fine.width + 2 * i];
    }
    free(in), free(scratch), free(out);
    if (status)
        s->status = (int)status;
}

static tc_status filter_levels(tc_chart *chart, int charts, int threads)
{
    int levels = tc_field_info(chart->field)->levels;
    step s = {.chart = chart, .charts = charts};
    tc_status status = TC_OK;
    for (s.level = levels - 1; s.level >= 1 && !status; s.level--) {
        int64_t rows = tc_field_level(chart->field, s.level).height;
        for (s.face = 0; s.face < charts; s.face++)
            tc_parallel_for(threads, (rows + BAND - 1) / BAND, filter_band, &s);
        status = s.status ? (tc_status)s.status : tc_joined_settle(chart, charts, s.level);
    }
    return status;
}

/* ---- The map ----------------------------------------------------------------------------------------------------- */

/* What is true of the source as a whole. */
static void describe(const tc_map *from, int64_t cells, tc_map *map)
{
    map->georef = from->georef;
    map->area_registered = from->area_registered;
    map->width = from->width, map->height = from->height;
    map->grid = from->grid;
    map->voids = from->voids;
    map->read_ms = from->read_ms, map->build_ms = from->build_ms;
    map->spacing_x = map->spacing_y = tc_chart_face_spacing(from->body.radius, cells);
}

tc_status tc_map_check_whole(const tc_map *map, const char *name, tc_error *error)
{
    const tc_atlas *atlas = tc_atlas_of(map->chart[0].class);
    if (!map->body.class->solid || atlas != &tc_atlas_lonlat)
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a planet in longitude and latitude, found %s", name,
                       atlas ? atlas->name : "a flat terrain");
    if (map->charts != atlas->charts)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a planet as a whole, around the globe and from pole to pole, found a part of one",
                       name);
    return TC_OK;
}

tc_status tc_map_resample(const tc_map *from, const tc_atlas *atlas, int threads, tc_map **map_ret, tc_error *error)
{
    tc_status status = tc_map_check_whole(from, "planet", error);
    if (status)
        return status;
    const tc_field *field = from->chart[0].field;
    int64_t cells = tc_resample_cells(tc_field_level(field, tc_field_info(field)->levels).width);
    tc_map *map = tc_map_create(from->body, atlas->charts);
    status = map ? TC_OK : TC_ERR_MEMORY;
    for (int face = 0; face < atlas->charts && !status; face++) {
        finest_level l = {.from = from, .face = face, .cells = cells};
        tc_grid grid;
        tc_field *made;
        if ((status = make_grid(&l, atlas, threads, &grid)))
            tc_grid_free(&grid);
        else if (!(status = tc_memory_field_begin(&grid, &made, NULL)))
            map->chart[map->charts++] = tc_chart_face(atlas->class, made, face);
    }
    if (!status)
        status = filter_levels(map->chart, map->charts, threads);
    for (int face = 0; face < atlas->charts && !status; face++)
        status = tc_memory_field_finish(map->chart[face].field, threads, NULL);
    if (!status && !tc_charts_join(map->chart, map->charts, NULL))
        status = TC_ERR_MEMORY;
    if (status) {
        tc_map_destroy(map);
        return tc_fail(error, status, "planet: cannot be resampled to %s: %s", atlas->name, tc_status_text(status));
    }
    describe(from, cells, map);
    *map_ret = map;
    return TC_OK;
}
