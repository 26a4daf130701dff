/* plugin_gdal_image.c - pictures through GDAL: where each level of one is kept.
 *
 * What can be read in parts, with overviews for all levels down to a small one, is read where it lies. A small picture
 * is held in memory. Else levels come from the cache: all of them, or only the overviews that are missing where the
 * picture itself can be read in parts. */
#include "plugin_gdal_image.h"

#include "common/base/image_levels.h"
#include "common/base/image_memory.h"
#include "common/base/rect.h"
#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum {
    COARSE_ENOUGH = 512, /* pixels a side of the last level that must be there */
    PART = 1 << 22,      /* pixels that are decoded for a part, at most */
};

/* A level: of the picture's own dataset, or a file of the cache. */
typedef struct level_source {
    GDALDatasetH dataset;
    const tc_gdal_pixels *pixels;
    int overview; /* of it; -1: itself */
} level_source;

typedef struct gdal_image {
    tc_image base;
    GDALDatasetH dataset;
    tc_gdal_pixels pixels;
    GDALDatasetH cached[TC_IMAGE_LEVELS];
    tc_gdal_pixels plain; /* of the cached ones */
    level_source level[TC_IMAGE_LEVELS];
    tc_image *small; /* levels in memory; NULL: as above */
    void *places;
    char path[];
} gdal_image;

/* ---- Reading ------------------------------------------------------------------------------------------------------
 */

static tc_status read_level(tc_image *image, int level, tc_rect rect, uint8_t (*rgba)[4], ptrdiff_t stride,
                            tc_error *error)
{
    gdal_image *g = (gdal_image *)image;
    const level_source *l = &g->level[level];
    if (g->small)
        return g->small->read(g->small, level, rect, rgba, stride, error);
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    bool good = tc_gdal_pixels_read(l->pixels, l->dataset, l->overview, rect, rgba, stride);
    const char *why = tc_gdal_heard(&said);
    return good ? TC_OK : tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read, damaged or truncated: %s", g->path, why);
}

/* The picture itself as rows. */
typedef struct gdal_rows {
    tc_image_rows base;
    gdal_image *image;
} gdal_rows;

static tc_status read_rows(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*rgba)[4], tc_error *error)
{
    gdal_image *g = ((gdal_rows *)rows)->image;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    bool good =
        tc_gdal_pixels_read(&g->pixels, g->dataset, -1, (tc_rect){0, row, rows->width, row + count}, rgba, rows->width);
    const char *why = tc_gdal_heard(&said);
    return good
               ? TC_OK
               : tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read to its end, damaged or truncated: %s", g->path, why);
}

static gdal_rows rows_of(gdal_image *g)
{
    return (gdal_rows){{.name = g->path,
                        .width = GDALGetRasterXSize(g->dataset),
                        .height = GDALGetRasterYSize(g->dataset),
                        .read = read_rows},
                       g};
}

static void find(tc_image *image, int count, double *x, double *y)
{
    tc_gdal_image_find(((gdal_image *)image)->places, count, x, y);
}

static void locate(tc_image *image, int count, double *x, double *y)
{
    tc_gdal_image_locate(((gdal_image *)image)->places, count, x, y);
}

static void close_image(tc_image *image)
{
    gdal_image *g = (gdal_image *)image;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    tc_gdal_image_places_close(g->places);
    for (int k = 0; k < TC_IMAGE_LEVELS; k++)
        if (g->cached[k])
            GDALClose(g->cached[k]);
    if (g->dataset)
        GDALClose(g->dataset);
    tc_gdal_heard(&said);
    tc_gdal_pixels_free(&g->pixels);
    tc_gdal_pixels_free(&g->plain);
    CSLDestroy(image->parts);
    if (g->small)
        g->small->close(g->small);
    free(g);
}

/* ---- Levels -------------------------------------------------------------------------------------------------------
 */

/* Whether reading a part costs about what the part has: pixels are kept in blocks that are much smaller than rows. */
static bool in_parts(const gdal_image *g)
{
    int w, h;
    GDALGetBlockSize(GDALGetRasterBand(g->dataset, g->pixels.band[0]), &w, &h);
    return w < GDALGetRasterXSize(g->dataset) && (int64_t)w * h <= PART;
}

/* The overview that is a level; -2: there is none. */
static int overview_of(const gdal_image *g, tc_image_size size)
{
    GDALRasterBandH band = GDALGetRasterBand(g->dataset, g->pixels.band[0]);
    for (int i = 0; i < GDALGetOverviewCount(band); i++) {
        GDALRasterBandH o = GDALGetOverview(band, i);
        /* Formats round halves up or down. */
        if (o && llabs(GDALGetRasterBandXSize(o) - size.width) <= 1 &&
            llabs(GDALGetRasterBandYSize(o) - size.height) <= 1)
            return i;
    }
    return -2;
}

/* Levels that the file has: the picture's own, which is not counted, and overviews that follow one another. */
static int own_levels(gdal_image *g)
{
    tc_image *image = &g->base;
    int k = 1;
    for (int overview; k < image->levels && (overview = overview_of(g, image->level[k])) >= 0; k++) {
        GDALRasterBandH o = GDALGetOverview(GDALGetRasterBand(g->dataset, g->pixels.band[0]), overview);
        image->level[k] = (tc_image_size){GDALGetRasterBandXSize(o), GDALGetRasterBandYSize(o)};
        g->level[k] = (level_source){g->dataset, &g->pixels, overview};
    }
    return k;
}

/* Where the cache keeps what was made of this file, as it is now. */
static void name_cache(const char *path, char base[4096])
{
    const char *home = getenv("XDG_CACHE_HOME"), *user = getenv("HOME");
    char real[PATH_MAX];
    struct stat about;
    *base = '\0';
    if (!realpath(path, real) || stat(real, &about) != 0)
        return;
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    char about_it[PATH_MAX + 96];
    snprintf(about_it, sizeof about_it, "1 %s %jd %jd %ld", real, (intmax_t)about.st_size,
             (intmax_t)about.st_mtim.tv_sec, about.st_mtim.tv_nsec);
    for (const char *c = about_it; *c; c++)
        hash = (hash ^ (unsigned char)*c) * UINT64_C(0x100000001b3);
    if (home && *home == '/')
        snprintf(base, 4096, "%s/terraclip/%016" PRIx64, home, hash);
    else if (user && *user == '/')
        snprintf(base, 4096, "%s/.cache/terraclip/%016" PRIx64, user, hash);
}

/* Levels from `first` on from the cache. */
static tc_status cached_levels(gdal_image *g, tc_image_rows *rows, int first, const tc_image_options *options,
                               tc_error *error)
{
    tc_gdal_cache cache = {
        .name = g->path, .first = first, .count = g->base.levels - first, .width = rows->width, .height = rows->height};
    name_cache(g->path, cache.base);
    tc_status status = tc_gdal_cache_open(&cache, rows, options, g->cached + first, error);
    if (status == TC_OK)
        status = tc_gdal_pixels_of(g->path, g->cached[first], options->source, &g->plain, error);
    tc_image_size size[TC_IMAGE_LEVELS];
    tc_image_sizes(rows->width, rows->height, 1, size);
    for (int k = first; k < g->base.levels; k++) {
        g->base.level[k] = size[k];
        g->level[k] = (level_source){g->cached[k], &g->plain, -1};
    }
    return status;
}

static tc_status make_levels(gdal_image *g, const tc_image_options *options, tc_error *error)
{
    gdal_rows rows = rows_of(g);
    tc_image *image = &g->base;
    image->levels = tc_image_sizes(rows.base.width, rows.base.height, COARSE_ENOUGH, image->level);
    if (rows.base.width * rows.base.height <= TC_IMAGE_SMALL) {
        tc_status status = tc_image_in_memory(&rows.base, &g->small, error);
        if (status == TC_OK) {
            image->levels = g->small->levels;
            memcpy(image->level, g->small->level, sizeof image->level);
        }
        return status;
    }
    g->level[0] = (level_source){g->dataset, &g->pixels, -1};
    bool parts = in_parts(g);
    int own = parts ? own_levels(g) : 0;
    /* A file that lacks some overviews gets all of them from the cache: its own may be filtered another way. */
    return own == image->levels ? TC_OK : cached_levels(g, &rows.base, parts ? 1 : 0, options, error);
}

/* ---- Opening ------------------------------------------------------------------------------------------------------
 */

static bool has_place(GDALDatasetH dataset)
{
    static const double unset[6] = {0, 1, 0, 0, 0, 1};
    double t[6];
    bool transform = GDALGetGeoTransform(dataset, t) == CE_None && memcmp(t, unset, sizeof t) != 0;
    return transform || GDALGetGCPCount(dataset) > 0;
}

/* Pixels around the globe, of a picture in longitude and latitude. */
static double period_of(GDALDatasetH dataset)
{
    double t[6];
    OGRSpatialReferenceH own = GDALGetSpatialRef(dataset);
    if (!own || !OSRIsGeographic(own) || OSRIsDerivedGeographic(own) || GDALGetGeoTransform(dataset, t) != CE_None ||
        t[2] != 0 || !(t[1] != 0))
        return 0;
    return fabs(2 * M_PI / OSRGetAngularUnits(own, NULL) / t[1]);
}

static tc_status place(gdal_image *g, const tc_image_map *map, const tc_image_options *options, tc_error *error)
{
    if (!has_place(g->dataset))
        return TC_OK;
    bool named = GDALGetSpatialRef(g->dataset) || GDALGetGCPSpatialRef(g->dataset);
    if (!map->known) {
        tc_say(options->source, true,
               "%s: says where it lies, but the terrain does not: it is laid over all of the terrain", g->path);
        return TC_OK;
    }
    if (!named)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected a coordinate system with its transform, found none: gdal_edit.py -a_srs or a VRT "
                       "gives it one",
                       g->path);
    g->places = tc_gdal_image_places(g->path, g->dataset, map, error);
    if (!g->places)
        return TC_ERR_UNSUPPORTED;
    g->base.find = find, g->base.locate = locate;
    g->base.period = period_of(g->dataset);
    return TC_OK;
}

static gdal_image *make_image(const char *path)
{
    gdal_image *g = calloc(1, sizeof *g + strlen(path) + 1);
    if (!g)
        return NULL;
    strcpy(g->path, path);
    g->base = (tc_image){.name = g->path, .read = read_level, .close = close_image};
    return g;
}

tc_status tc_gdal_cache_image(tc_image_rows *rows, const tc_image_options *options, tc_image **image_ret,
                              tc_error *error)
{
    tc_gdal_start();
    gdal_image *g = make_image(rows->name);
    if (!g)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", rows->name);
    g->base.levels = tc_image_sizes(rows->width, rows->height, COARSE_ENOUGH, g->base.level);
    tc_status status = cached_levels(g, rows, 0, options, error);
    if (status == TC_OK)
        *image_ret = &g->base;
    else
        close_image(&g->base);
    return status;
}

tc_status tc_gdal_open_image(const char *path, const tc_image_map *map, const tc_image_options *options,
                             bool *recognised, tc_image **image_ret, tc_error *error)
{
    tc_gdal_start();
    *recognised = false;
    gdal_image *g = make_image(path);
    if (!g)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    tc_status status = tc_gdal_open_dataset(path, path, &g->dataset, recognised, error);
    if (status == TC_OK)
        g->base.parts = tc_gdal_all_files(g->dataset);
    if (status == TC_OK)
        status = tc_gdal_pixels_of(path, g->dataset, options->source, &g->pixels, error);
    if (status == TC_OK)
        status = place(g, map, options, error);
    if (status == TC_OK)
        status = make_levels(g, options, error);
    if (status == TC_OK)
        *image_ret = &g->base;
    else
        close_image(&g->base);
    return status;
}
