/* map_open.c - a map from a packed file: charts over byte ranges of the same bytes. */
#include "map.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/chart/joined.h"
#include "common/field/field.h"
#include "common/packed/file/packed_file.h"
#include "common/packed/read/tile_store.h"

/* ---- Byte ranges of a source ------------------------------------------------------------------------------------ */

/* The source, closed with the last of those who read it, and what is kept of it for all charts. */
typedef struct shared {
    tc_byte_source source;
    tc_tile_store *store;
    _Atomic int readers;
} shared;

typedef struct range {
    shared *shared;
    int64_t begin;
} range;

static void release(shared *s)
{
    if (--s->readers > 0)
        return;
    if (s->source.close)
        s->source.close(s->source.context);
    free(s);
}

static tc_status read_range(void *context, int64_t offset, void *bytes, size_t size)
{
    const range *r = context;
    return r->shared->source.read(r->shared->source.context, r->begin + offset, bytes, size);
}

static void close_range(void *context)
{
    range *r = context;
    release(r->shared);
    free(r);
}

/* Opens a chart of the file that `size` bytes from `begin` on are, both within the source. */
static tc_status open_range(const char *name, shared *s, int64_t begin, int64_t size, int chart,
                            const tc_open_options *options, tc_field **field_ret, tc_error *error)
{
    range *r = malloc(sizeof *r);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    *r = (range){s, begin};
    s->readers++;
    tc_byte_source source = {r, size, read_range, close_range};
    return tc_packed_open_chart(name, &source, chart, options, s->store, field_ret, error);
}

/* ---- Charts ----------------------------------------------------------------------------------------------------- */

/* A chart whose finest levels may be missing: its samples are as far apart as those of the level that is left. */
static tc_chart place(const tc_chart_class *class, tc_field *field, int self, double x0, double y0, double dx,
                      double dy)
{
    int missing = tc_field_packed_info(field)->levels_missing;
    return tc_chart_over(class, field, self, x0, y0, ldexp(dx, missing), ldexp(dy, missing));
}

/* What the georeference counts are samples of all levels, also of those that are missing. */
static void set_grid(tc_map *map)
{
    int missing = tc_field_packed_info(map->chart[0].field)->levels_missing;
    map->grid = tc_chart_grid(&map->chart[0]);
    map->grid.dx = ldexp(map->grid.dx, -missing), map->grid.dy = ldexp(map->grid.dy, -missing);
}

/* Whether a cap's head is all within the file. */
static tc_status find_head(const char *name, const tc_byte_source *source, const tc_container *c, int n,
                           bool *whole_ret, tc_error *error)
{
    uint8_t bytes[TC_HEAD_FIXED];
    int64_t begin = tc_container_cap_begin(c, n);
    *whole_ret = begin <= source->size - (int64_t)sizeof bytes;
    tc_status status = *whole_ret ? source->read(source->context, begin, bytes, sizeof bytes) : TC_OK;
    if (status)
        return tc_fail(error, status, "%s: cannot be read: %s", name, tc_status_text(status));
    int64_t head = *whole_ret ? (int64_t)tc_load(bytes + TC_HEAD_SIZE_AT, 4) : 0;
    if (head > c->cap_bytes[n])
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: a cap's head of %lld bytes", name, (long long)head);
    *whole_ret &= source->size - begin >= head;
    return TC_OK;
}

/* Whether a cap of so many samples a side, of the planet's spacing, reaches from the pole down to where it is needed,
 * and not beyond the equator. */
static bool cap_fits(const tc_pack_terrain *cap, double dy)
{
    double half = 0.5 * (double)(cap->width - 1) * dy, edge = 2 * tan(0.5 * (90 - TC_CAP_EDGE) * M_PI / 180);
    return cap->width == cap->height && cap->width % 2 == 1 && half >= edge * (1 - 1e-9) && half <= 2 + 2 * dy;
}

/* Cap n, as chart 1 + n. It must be what the planet says it is: of version 2 a file of its own within the planet's,
 * whose bytes it names; of version 3 it was checked with the rest of the head. */
static tc_status open_cap(const char *name, shared *s, const tc_container *c, int n, const tc_lonlat *globe,
                          const tc_open_options *options, tc_map *map, tc_error *error)
{
    static const tc_chart_class *const class[TC_CAP_CHARTS] = {&tc_chart_north_cap, &tc_chart_south_cap};
    bool within = c->info.version >= TC_ENVELOPE_VERSION;
    int64_t begin = within ? 0 : tc_container_cap_begin(c, n), bytes = within ? s->source.size : c->cap_bytes[n];
    tc_field *field;
    tc_status status =
        open_range(name, s, begin, tc_min64(bytes, s->source.size - begin), within ? 1 + n : 0, options, &field, error);
    if (status)
        return status;
    const tc_packed_info *info = tc_field_packed_info(field);
    const tc_pack_terrain *t = &info->terrain;
    bool its_own = within || (info->bytes == bytes && info->version == 1 && t->z_base == c->info.terrain.z_base);
    if (!its_own || !cap_fits(t, globe->dy)) {
        tc_field_destroy(field);
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: a cap that does not fit its planet", name);
    }
    double half = 0.5 * (double)(t->width - 1) * globe->dy;
    map->chart[map->charts++] = place(class[n], field, 1 + n, -half, -half, globe->dy, globe->dy);
    return TC_OK;
}

/* The charts of a planet: the first one's field is `field`, which it takes over. */
static tc_status open_planet(const char *name, shared *s, tc_field *field, const tc_open_options *options, tc_map *map,
                             tc_error *error)
{
    const tc_container *c = tc_field_container(field);
    const tc_terrain_info *info = tc_field_info(field);
    tc_lonlat globe;
    if (!tc_terrain_globe(&c->info.terrain, &globe)) {
        tc_field_destroy(field);
        return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: a planet that is not in longitude and latitude", name);
    }
    map->chart[map->charts++] = place(&tc_chart_lonlat, field, 0, globe.x0, globe.y0, globe.dx, globe.dy);
    tc_status status = map->body.class->check_relief(&map->body, name, info->z_base + (double)info->z_min,
                                                     info->z_base + (double)info->z_max, error);
    bool whole = c->info.charts > 1;
    for (int n = 0; n < TC_CAP_CHARTS && whole && !status && c->info.version < TC_ENVELOPE_VERSION; n++)
        status = find_head(name, &s->source, c, n, &whole, error);
    for (int n = 0; n < TC_CAP_CHARTS && whole && !status; n++)
        status = open_cap(name, s, c, n, &globe, options, map, error);
    return status;
}

/* The faces of an atlas: the first one's field is `field`, which it takes over. Of a file that was cut short they must
 * still meet. */
static tc_status open_faces(const char *name, shared *s, tc_field *field, const tc_open_options *options, tc_map *map,
                            tc_error *error)
{
    const tc_container *c = tc_field_container(field);
    const tc_atlas *atlas = tc_kind_faces(c->kind);
    const int64_t cells = c->info.terrain.width - 1;
    const int missing = c->info.levels_missing;
    tc_status status = TC_OK;
    map->chart[map->charts++] = (tc_chart){.field = field};
    if ((cells >> missing) << missing != cells)
        return tc_fail(error, TC_ERR_FORMAT, "%s: cut short: too little is left of it for faces that meet", name);
    for (int n = 0; n < atlas->charts && !status; n++) {
        if (n > 0 && (status = open_range(name, s, 0, s->source.size, n, options, &field, error)))
            break;
        map->chart[n] = tc_chart_face(atlas->class, field, n);
        map->charts = n + 1;
        const tc_terrain_info *info = tc_field_info(field);
        status = map->body.class->check_relief(&map->body, name, info->z_base + (double)info->z_min,
                                               info->z_base + (double)info->z_max, error);
    }
    float apart[TC_MAX_FIELD_LEVELS];
    for (int l = 1; l <= c->levels; l++) {
        int rank = missing + c->levels - l;
        apart[l - 1] = rank < c->source.ranks ? c->source.apart[rank] : INFINITY;
    }
    if (!status && !tc_charts_join(map->chart, map->charts, apart))
        status = tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    /* The georeference is that of what they were resampled from. */
    const tc_face_source *from = &c->source;
    tc_lonlat grid;
    map->georef.known = map->georef.geographic = true;
    memcpy(map->georef.transform, from->transform, sizeof from->transform);
    map->width = from->width, map->height = from->height;
    tc_lonlat_of(&map->georef, map->width, map->height, &grid); /* was checked with the head */
    tc_lonlat_close(&grid);
    map->grid = (tc_chart){
        .class = &tc_chart_lonlat, .x0 = grid.x0, .y0 = grid.y0, .dx = grid.dx, .dy = grid.dy, .wraps = true};
    return status;
}

/* What the head says of the whole. */
static void describe(const tc_pack_terrain *t, const tc_open_options *options, tc_map *map)
{
    map->georef = t->georef;
    map->area_registered = t->area_registered;
    map->georef.crs_wkt = NULL; /* the field's */
    map->width = t->width, map->height = t->height;
    map->spacing_x = t->spacing_x, map->spacing_y = t->spacing_y;
    map->voids = options->has_policy ? options->voids : t->voids;
}

static tc_status open_charts(const char *name, shared *s, const tc_open_options *options, tc_map **map_ret,
                             tc_error *error)
{
    tc_field *field;
    tc_status status = open_range(name, s, 0, s->source.size, 0, options, &field, error);
    if (status)
        return status;
    const tc_pack_terrain *t = &tc_field_packed_info(field)->terrain;
    bool faces = tc_kind_faces(tc_field_container(field)->kind) != NULL;
    double radius = options->flat && !faces ? 0 : t->radius;
    tc_map *map = tc_map_create(tc_body_flattened(radius, t->flattening), TC_MAP_CHARTS);
    if (!map) {
        tc_field_destroy(field);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    describe(t, options, map);
    if (faces)
        status = open_faces(name, s, field, options, map, error);
    else if (radius > 0)
        status = open_planet(name, s, field, options, map, error);
    else
        map->chart[map->charts++] = place(&tc_chart_plane, field, 0, 0, 0, t->spacing_x, t->spacing_y);
    if (status == TC_OK && !faces)
        set_grid(map);
    if (status == TC_OK)
        *map_ret = map;
    else
        tc_map_destroy(map);
    return status;
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

tc_status tc_map_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                            tc_map **map_ret, tc_error *error)
{
    static const tc_open_options defaults = {0};
    shared *s = malloc(sizeof *s);
    if (!s) {
        if (source->close)
            source->close(source->context);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    options = options ? options : &defaults;
    *s = (shared){.source = *source, .store = tc_tile_store_create(options->cache_bytes), .readers = 1};
    tc_status status = s->store ? open_charts(name, s, options, map_ret, error)
                                : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    tc_tile_store_release(s->store); /* its charts' from now on */
    release(s);
    return status;
}

tc_status tc_map_open(const char *path, const tc_open_options *options, tc_map **map_ret, tc_error *error)
{
    tc_byte_source source;
    tc_status status = tc_file_source(path, &source, error);
    return status ? status : tc_map_open_bytes(path, &source, options, map_ret, error);
}

/* ---- A flat terrain as a part of a globe --------------------------------------------------------------------------
 */

tc_status tc_map_onto_globe(tc_map *map, const char *name, tc_body body, bool *gap_ret, tc_error *error)
{
    tc_chart *c = &map->chart[0];
    const tc_terrain_info *info = tc_field_info(c->field);
    tc_lonlat at;
    if (!tc_lonlat_of(&map->georef, map->width, map->height, &at))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a terrain in longitude and latitude, or one packed with --planet, found a flat "
                       "one",
                       name);
    tc_status status = body.class->check_relief(&body, name, info->z_base + (double)info->z_min,
                                                info->z_base + (double)info->z_max, error);
    if (status != TC_OK)
        return status;
    map->body = body;
    *c = place(&tc_chart_lonlat, c->field, 0, at.x0, at.y0, at.dx, at.dy);
    set_grid(map);
    *gap_ret = at.round || (double)map->width > at.turn;
    return TC_OK;
}
