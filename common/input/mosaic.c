/* mosaic.c - several files as one terrain: what they say, and whether they agree. */
#include "mosaic.h"

#include "common/base/status.h"
#include "mosaic_internal.h"
#include "plugin.h"
#include "plugin_tables.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- What the files say ----------------------------------------------------------------------------------------- */

/* Passes lines of a source on: with the file's name where there are several, and not what was just said of another. */
static void say(void *context, bool warning, const char *line)
{
    tc_mosaic *m = context;
    if (!m->options.say || m->silent || strcmp(line, m->last_line) == 0)
        return;
    snprintf(m->last_line, sizeof m->last_line, "%s", line);
    char text[sizeof m->last_line + 512];
    snprintf(text, sizeof text, "%.500s: %s", m->parts[m->said_of].path, line);
    m->options.say(m->options.say_context, warning, m->count > 1 ? text : line);
}

tc_status tc_mosaic_open_part(tc_mosaic *m, int part, tc_source **source_ret, tc_error *error)
{
    tc_source_options options = m->options;
    options.say = say;
    options.say_context = m;
    if (m->placed) { /* by the first, that all heights are above the same base */
        options.has_base = true;
        options.z_base = m->terrain.z_base;
        options.has_offset = true;
        options.offset = m->first.added;
    }
    m->said_of = part;
    return tc_source_open(m->parts[part].path, &options, source_ret, error);
}

/* ---- Agreement -------------------------------------------------------------------------------------------------- */

static tc_status check_system(const tc_mosaic *m, const char *path, const tc_georef *georef, tc_error *error)
{
    const char *first = m->terrain.georef.crs_wkt, *wkt = georef->crs_wkt, *first_path = m->parts[0].path;
    if (!first != !wkt)
        return tc_fail(error, TC_ERR_FORMAT, "%s: coordinate system: expected %s as in %s, found %s", path,
                       first ? "one" : "none", first_path, wkt ? "one" : "none");
    bool same = !first || strcmp(first, wkt) == 0;
    if (!same) {
        /* The same system in other words? */
        const void *table = NULL;
        tc_status status = tc_plugin_load("gdal", &table, error);
        if (status != TC_OK)
            return status;
        same = ((const struct tc_gdal_plugin *)table)->same_crs(first, wkt);
    }
    if (!same || georef->geographic != m->terrain.georef.geographic) {
        const char *quote = wkt ? strchr(wkt, '"') : NULL; /* the first string is its name */
        int length = quote ? (int)strcspn(quote + 1, "\"") : 0;
        return tc_fail(error, TC_ERR_FORMAT, "%s: coordinate system: expected that of %s, found '%.*s'", path,
                       first_path, length > 80 ? 80 : length, quote ? quote + 1 : "");
    }
    return TC_OK;
}

static tc_status check_agreement(const tc_mosaic *m, const char *path, const tc_source_info *info, tc_error *error)
{
    if (!info->georef.known)
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: georeference: expected one, by which several inputs are placed, found none", path);
    if (m->count > 1 && path == m->parts[0].path)
        return TC_OK;
    return check_system(m, path, &info->georef, error);
}

/* ---- Opening ---------------------------------------------------------------------------------------------------- */

/* The first file sets the terrain. */
static tc_status take_first(tc_mosaic *m, const tc_source_info *info, tc_error *error)
{
    tc_pack_terrain *t = &m->terrain;
    *t = (tc_pack_terrain){.spacing_x = info->spacing_x,
                           .spacing_y = info->spacing_y,
                           .z_base = info->z_base,
                           .georef = info->georef,
                           .area_registered = info->area_registered,
                           .sample_type = info->type,
                           .unit = fabs(info->unit), /* a packed terrain has heights, not depths */
                           .offset = info->offset,
                           .has_nodata = info->has_nodata,
                           .nodata = info->nodata,
                           .voids = m->options.voids,
                           .void_constant = m->options.void_constant};
    t->georef.crs_wkt = info->georef.crs_wkt ? strdup(info->georef.crs_wkt) : NULL;
    if (info->georef.crs_wkt && !t->georef.crs_wkt)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", m->parts[0].path);
    m->first = *info;
    m->first.georef.crs_wkt = NULL;
    return TC_OK;
}

/* Another file may store its heights otherwise. */
static void take_storage(tc_mosaic *m, const tc_source_info *info)
{
    tc_pack_terrain *t = &m->terrain;
    if (info->type != t->sample_type || fabs(info->unit) != t->unit || info->offset != t->offset) {
        t->sample_type = TC_SAMPLE_FLOAT32;
        t->unit = 1;
        t->offset = 0;
        t->has_nodata = false;
        m->mixed = true;
    } else if (!m->mixed && !t->has_nodata && info->has_nodata) {
        t->has_nodata = true;
        t->nodata = info->nodata;
    }
}

static tc_status look_at(tc_mosaic *m, int i, tc_error *error)
{
    tc_mosaic_part *part = &m->parts[i];
    tc_source *source = NULL;
    tc_status status = tc_mosaic_open_part(m, i, &source, error);
    if (status != TC_OK)
        return status;
    const tc_source_info *info = tc_source_get_info(source);
    part->width = info->width;
    part->height = info->height;
    if (i == 0)
        status = take_first(m, info, error);
    if (status == TC_OK && m->count > 1)
        status = check_agreement(m, part->path, info, error);
    if (status == TC_OK && i > 0) {
        status = tc_mosaic_place(m, part->path, info, &part->column, &part->row, error);
        take_storage(m, info);
    }
    tc_source_close(source);
    m->placed = true;
    return status;
}

tc_status tc_mosaic_open(const char *const *paths, int count, const tc_source_options *options, tc_mosaic **mosaic_ret,
                         tc_error *error)
{
    static const tc_source_options defaults = {0};
    if (count < 1)
        return tc_fail(error, TC_ERR_USAGE, "mosaic: expected at least one file, found none");
    tc_mosaic *m = calloc(1, sizeof *m + (size_t)count * sizeof *m->parts);
    if (!m)
        return tc_fail(error, TC_ERR_MEMORY, "mosaic: not enough memory for %d files", count);
    m->options = options ? *options : defaults;
    m->count = count;
    tc_status status = TC_OK;
    for (int i = 0; i < count; i++)
        m->parts[i].path = paths[i];
    for (int i = 0; i < count && status == TC_OK; i++)
        status = look_at(m, i, error);
    if (status == TC_OK)
        status = tc_mosaic_lay_out(m, error);
    double all = (double)m->terrain.width * (double)m->terrain.height;
    if (status == TC_OK && (double)m->samples < 0.5 * all && m->options.say) {
        char text[200];
        snprintf(text, sizeof text,
                 "the inputs cover %.3g %% of the rectangle around them, %" PRId64 " x %" PRId64
                 " samples; the rest is void",
                 100 * (double)m->samples / all, m->terrain.width, m->terrain.height);
        m->options.say(m->options.say_context, true, text);
    }
    if (status == TC_OK)
        *mosaic_ret = m;
    else
        tc_mosaic_close(m);
    return status;
}

void tc_mosaic_close(tc_mosaic *m)
{
    if (!m)
        return;
    free(m->terrain.georef.crs_wkt);
    free(m);
}

const tc_pack_terrain *tc_mosaic_terrain(const tc_mosaic *m)
{
    return &m->terrain;
}

int tc_mosaic_files(const tc_mosaic *m)
{
    return m->count;
}

int64_t tc_mosaic_shared(const tc_mosaic *m)
{
    return m->shared;
}

int64_t tc_mosaic_samples(const tc_mosaic *m)
{
    return m->samples;
}
