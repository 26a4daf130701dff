/* plugin_gdal_image_cache.c - levels of a picture in tiled files of the user's cache: GeoTIFF without loss, a file a
 * level, made once. A file gets its name when it is whole. */
#include "plugin_gdal_image.h"

#include "common/base/image_levels.h"
#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { TILE_COLUMNS = 256, TILE_ROWS = 128 };

typedef struct level_file {
    GDALDatasetH dataset;
    char path[4200], temporary[4240];
    uint8_t (*rows)[4]; /* of tiles, until they are full */
    tc_image_size size;
} level_file;

typedef struct making {
    const tc_gdal_cache *cache;
    level_file level[TC_IMAGE_LEVELS]; /* [k - first] */
    tc_gdal_messages said;
} making;

static void name_file(const tc_gdal_cache *cache, int level, char path[4200])
{
    snprintf(path, 4200, "%s-%d.tif", cache->base, level);
}

/* All files, as they were left; false where one is missing or another picture's. */
static bool open_files(const tc_gdal_cache *cache, GDALDatasetH *dataset_ret)
{
    tc_image_size size[TC_IMAGE_LEVELS];
    tc_image_sizes(cache->width, cache->height, 1, size);
    bool good = true;
    for (int k = 0; k < cache->count; k++) {
        char path[4200];
        name_file(cache, cache->first + k, path);
        dataset_ret[k] =
            good ? GDALOpenEx(path, GDAL_OF_RASTER, (const char *const[]){"GTiff", NULL}, NULL, NULL) : NULL;
        good = good && dataset_ret[k] && GDALGetRasterCount(dataset_ret[k]) == 4 &&
               GDALGetRasterXSize(dataset_ret[k]) == size[cache->first + k].width &&
               GDALGetRasterYSize(dataset_ret[k]) == size[cache->first + k].height;
    }
    for (int k = 0; k < cache->count && !good; k++)
        if (dataset_ret[k])
            GDALClose(dataset_ret[k]), dataset_ret[k] = NULL;
    return good;
}

static bool begin_file(const tc_gdal_cache *cache, int level, tc_image_size size, level_file *f)
{
    name_file(cache, level, f->path);
    snprintf(f->temporary, sizeof f->temporary, "%s.%ld.tmp", f->path, (long)getpid());
    f->size = size;
    char **how = NULL;
    how = CSLSetNameValue(how, "TILED", "YES");
    how = CSLSetNameValue(how, "BLOCKXSIZE", CPLSPrintf("%d", TILE_COLUMNS));
    how = CSLSetNameValue(how, "BLOCKYSIZE", CPLSPrintf("%d", TILE_ROWS));
    how = CSLSetNameValue(how, "COMPRESS", "DEFLATE");
    how = CSLSetNameValue(how, "ZLEVEL", "1");
    how = CSLSetNameValue(how, "PREDICTOR", "2");
    how = CSLSetNameValue(how, "BIGTIFF", "IF_SAFER");
    how = CSLSetNameValue(how, "PHOTOMETRIC", "RGB");
    how = CSLSetNameValue(how, "ALPHA", "NON-PREMULTIPLIED");
    f->dataset =
        GDALCreate(GDALGetDriverByName("GTiff"), f->temporary, (int)size.width, (int)size.height, 4, GDT_Byte, how);
    CSLDestroy(how);
    f->rows = malloc((size_t)size.width * TILE_ROWS * 4);
    return f->dataset && f->rows;
}

static tc_status give_row(void *context, int level, int64_t y, uint8_t (*rgba)[4], tc_error *error)
{
    making *m = context;
    if (level < m->cache->first)
        return TC_OK;
    level_file *f = &m->level[level - m->cache->first];
    int64_t at = y % TILE_ROWS, w = f->size.width;
    memcpy(f->rows + at * w, rgba, (size_t)w * 4);
    if (at + 1 < TILE_ROWS && y + 1 < f->size.height)
        return TC_OK;
    if (GDALDatasetRasterIO(f->dataset, GF_Write, 0, (int)(y - at), (int)w, (int)at + 1, f->rows, (int)w, (int)at + 1,
                            GDT_Byte, 4, NULL, 4, (int)(4 * w), 1) != CE_None)
        return tc_fail(error, TC_ERR_IO, "%s: its levels cannot be written to %s: %s", m->cache->name, f->temporary,
                       m->said.failure);
    GDALFlushCache(f->dataset); /* keeps the memory bounded */
    return TC_OK;
}

/* What compressing does not save must fit, too. */
static tc_status check_room(const tc_gdal_cache *cache, const tc_image_size *size, tc_error *error)
{
    double bytes = 0;
    struct statvfs disk;
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", cache->base);
    *strrchr(folder, '/') = '\0';
    for (int k = cache->first; k < cache->first + cache->count; k++)
        bytes += 4.0 * (double)size[k].width * (double)size[k].height;
    double free_bytes = statvfs(folder, &disk) == 0 ? (double)disk.f_bavail * (double)disk.f_frsize : 1e300;
    if (bytes > free_bytes)
        return tc_fail(error, TC_ERR_IO,
                       "%s: expected room for levels of %lld x %lld pixels, up to %.1f GB, in %s, found %.1f GB; or "
                       "overviews in the picture (gdaladdo)",
                       cache->name, (long long)cache->width, (long long)cache->height, bytes * 1e-9, folder,
                       free_bytes * 1e-9);
    return TC_OK;
}

static tc_status make_folder(const tc_gdal_cache *cache, tc_error *error)
{
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", cache->base);
    for (char *slash = strchr(folder + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(folder, 0700) != 0 && errno != EEXIST)
            return tc_fail(error, TC_ERR_IO, "%s: its levels cannot be kept in %s: %s", cache->name, folder,
                           strerror(errno));
        *slash = '/';
    }
    return TC_OK;
}

static tc_status make_files(const tc_gdal_cache *cache, tc_image_rows *rows, const tc_image_options *options,
                            tc_error *error)
{
    tc_image_size size[TC_IMAGE_LEVELS];
    making *m = calloc(1, sizeof *m);
    if (!m)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", cache->name);
    m->cache = cache;
    tc_image_sizes(cache->width, cache->height, 1, size);
    tc_status status = make_folder(cache, error);
    if (status == TC_OK)
        status = check_room(cache, size, error);
    tc_gdal_listen(&m->said);
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO"); /* no .aux.xml beside the file */
    for (int k = 0; k < cache->count && status == TC_OK; k++)
        if (!begin_file(cache, cache->first + k, size[cache->first + k], &m->level[k]))
            status = tc_fail(error, TC_ERR_IO, "%s: its levels cannot be written to %s: %s", cache->name,
                             m->level[k].temporary, m->said.failure);
    if (status == TC_OK)
        status = tc_image_make_levels(rows, cache->first + cache->count, size, give_row, m, options->progress,
                                      options->progress_context, error);
    for (int k = 0; k < cache->count; k++) {
        level_file *f = &m->level[k];
        free(f->rows);
        if (!f->dataset)
            continue;
        GDALClose(f->dataset); /* writes the directory; tells of failure only by a message */
        if (status == TC_OK && (*m->said.failure || rename(f->temporary, f->path) != 0))
            status = tc_fail(error, TC_ERR_IO, "%s: its levels cannot be written to %s: %s", cache->name, f->path,
                             *m->said.failure ? m->said.failure : strerror(errno));
        if (status != TC_OK)
            unlink(f->temporary);
    }
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", NULL);
    tc_gdal_heard(&m->said);
    free(m);
    return status;
}

tc_status tc_gdal_cache_open(const tc_gdal_cache *cache, tc_image_rows *rows, const tc_image_options *options,
                             GDALDatasetH *dataset_ret, tc_error *error)
{
    if (!*cache->base)
        return tc_fail(
            error, TC_ERR_IO,
            "%s: expected $XDG_CACHE_HOME or $HOME, to keep its levels there, found neither; or overviews in "
            "the picture (gdaladdo)",
            cache->name);
    if (open_files(cache, dataset_ret))
        return TC_OK;
    tc_say(options->source, false, "%s: levels of %lld x %lld pixels are made once, in %s-*.tif", cache->name,
           (long long)cache->width, (long long)cache->height, cache->base);
    tc_status status = make_files(cache, rows, options, error);
    if (status == TC_OK && !open_files(cache, dataset_ret))
        status =
            tc_fail(error, TC_ERR_IO, "%s: its levels cannot be read back from %s-*.tif", cache->name, cache->base);
    return status;
}
