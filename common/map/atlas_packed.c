/* atlas_packed.c - charts over byte ranges of one file. */
#include "atlas_packed.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/base/status.h"
#include "common/packed/file/packed_file.h"

enum { CACHE_BYTES = 32 << 20 };

/* ---- Byte ranges of a source ------------------------------------------------------------------------------------ */

/* The source, closed with the last of those who read it. */
typedef struct shared {
    tc_byte_source source;
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

/* Opens `size` bytes from `begin` on, both within the source. */
static tc_status open_range(const char *name, shared *s, int64_t begin, int64_t size, const tc_open_options *options,
                            tc_field **field_ret, tc_error *error)
{
    range *r = malloc(sizeof *r);
    if (!r)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    *r = (range){s, begin};
    s->readers++;
    tc_byte_source source = {r, size, read_range, close_range};
    return tc_field_open_bytes(name, &source, options, field_ret, error);
}

/* ---- Charts ----------------------------------------------------------------------------------------------------- */

/* Places a chart whose finest levels may be missing: its samples are as far apart as those of the level that is left.
 */
static tc_chart place(tc_field *field, tc_projection projection, double x0, double y0, double dx, double dy)
{
    int missing = tc_field_packed_info(field)->levels_missing;
    return (tc_chart){field, projection, x0, y0, ldexp(dx, missing), ldexp(dy, missing), tc_field_info(field)->wraps_x};
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

static tc_status fail_cap(const char *name, tc_error *error)
{
    return tc_fail(error, TC_ERR_FORMAT, "%s: damaged: a cap that does not fit its planet", name);
}

/* A cap of version 2 must be what the planet says it is: a square of its own, of the planet's base. */
static tc_status check_cap(const char *name, const tc_packed_info *planet, const tc_field *cap, int64_t bytes,
                           double dy, tc_error *error)
{
    const tc_packed_info *info = tc_field_packed_info(cap);
    const tc_pack_terrain *t = &info->terrain;
    if (info->bytes != bytes || info->version != 1 || t->z_base != planet->terrain.z_base || !cap_fits(t, dy))
        return fail_cap(name, error);
    return TC_OK;
}

static tc_status open_cap(const char *name, shared *s, const tc_container *c, int n, const tc_globe *globe,
                          const tc_open_options *options, tc_chart *chart_ret, tc_error *error)
{
    int64_t begin = tc_container_cap_begin(c, n), bytes = c->cap_bytes[n];
    tc_field *field;
    tc_status status = open_range(name, s, begin, tc_min64(bytes, s->source.size - begin), options, &field, error);
    if (status)
        return status;
    if ((status = check_cap(name, &c->info, field, bytes, globe->dy, error))) {
        tc_field_destroy(field);
        return status;
    }
    double half = 0.5 * (double)(tc_field_packed_info(field)->terrain.width - 1) * globe->dy;
    *chart_ret = place(field, n == 0 ? TC_CAP_NORTH : TC_CAP_SOUTH, -half, -half, globe->dy, globe->dy);
    return TC_OK;
}

/* Caps of version 3, which share their source with the planet and were checked with it. */
static tc_status open_caps(const char *name, shared *s, const tc_container *c, const tc_globe *globe,
                           const tc_open_options *options, tc_atlas *atlas, tc_error *error)
{
    tc_status status = tc_atlas_check_relief(name, c->info.terrain.z_base + c->z_min, c->info.terrain.z_base + c->z_max,
                                             atlas->radius, error);
    for (int n = 1; n < c->info.charts && !status; n++) {
        tc_field *field;
        range *r = malloc(sizeof *r);
        if (!r)
            return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
        *r = (range){s, 0};
        s->readers++;
        tc_byte_source source = {r, s->source.size, read_range, close_range};
        if ((status = tc_packed_open_chart(name, &source, n, options, &field, error)))
            break;
        if (!cap_fits(&tc_field_container(field)->info.terrain, globe->dy)) {
            tc_field_destroy(field);
            return fail_cap(name, error);
        }
        double half = 0.5 * (double)(tc_field_container(field)->info.terrain.width - 1) * globe->dy;
        atlas->chart[atlas->charts++] =
            place(field, n == 1 ? TC_CAP_NORTH : TC_CAP_SOUTH, -half, -half, globe->dy, globe->dy);
    }
    return status;
}

static tc_status open_charts(const char *name, shared *s, const tc_open_options *options, tc_atlas *atlas,
                             tc_error *error)
{
    tc_field *field;
    tc_status status = open_range(name, s, 0, s->source.size, options, &field, error);
    if (status)
        return status;
    const tc_container *c = tc_field_container(field);
    tc_globe globe;
    atlas->chart[0].field = field;
    atlas->radius = c->info.terrain.radius;
    if (!(atlas->radius > 0) || !tc_terrain_globe(&c->info.terrain, &globe))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a planet, found a flat terrain", name);
    const tc_terrain_info *info = tc_field_info(field);
    status = tc_atlas_check_relief(name, info->z_base + (double)info->z_min, info->z_base + (double)info->z_max,
                                   atlas->radius, error);
    atlas->chart[0] = place(field, TC_LONLAT, globe.x0, globe.y0, globe.dx, globe.dy);
    atlas->charts = 1;
    if (c->info.version >= TC_ENVELOPE_VERSION)
        return open_caps(name, s, c, &globe, options, atlas, error);
    bool whole = c->info.charts > 1;
    for (int n = 0; n < TC_CAP_CHARTS && whole && !status; n++)
        status = find_head(name, &s->source, c, n, &whole, error);
    for (int n = 0; n < TC_CAP_CHARTS && whole && !status; n++)
        if (!(status = open_cap(name, s, c, n, &globe, options, &atlas->chart[1 + n], error)))
            atlas->charts++;
    return status;
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

tc_status tc_atlas_open_bytes(const char *name, const tc_byte_source *source, const tc_open_options *options,
                              tc_atlas *atlas_ret, tc_error *error)
{
    shared *s = malloc(sizeof *s);
    if (!s) {
        if (source->close)
            source->close(source->context);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", name);
    }
    *s = (shared){.source = *source, .readers = 1};
    tc_open_options own = options ? *options : (tc_open_options){0};
    own.cache_bytes = (own.cache_bytes ? own.cache_bytes : CACHE_BYTES) / 2; /* a view has one or two charts in it */
    tc_atlas atlas = {0};
    tc_status status = open_charts(name, s, &own, &atlas, error);
    release(s);
    if (status == TC_OK)
        *atlas_ret = atlas;
    else
        tc_atlas_free(&atlas);
    return status;
}

tc_status tc_atlas_open(const char *path, const tc_open_options *options, tc_atlas *atlas_ret, tc_error *error)
{
    tc_byte_source source;
    tc_status status = tc_file_source(path, &source, error);
    return status ? status : tc_atlas_open_bytes(path, &source, options, atlas_ret, error);
}
