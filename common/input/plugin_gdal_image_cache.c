/* plugin_gdal_image_cache.c - levels of a picture in tiled files of the user's cache: GeoTIFF without loss, a file a
 * level, made once. A file gets its name when it is whole; until then it has none, so that nothing is left of it
 * whatever ends the program. */
#include "plugin_gdal_image.h"

#include "common/base/cache_folder.h"
#include "common/base/image_levels.h"
#include "common/base/outfile.h"
#include "common/base/rect.h"
#include "common/base/status.h"

#include <cpl_conv.h>
#include <cpl_string.h>

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
    TILE_COLUMNS = 256,
    ROWS_BYTES = 1 << 23, /* of a row of tiles of the finest level, about: fewer rows where the picture is wide */
    MOST_ROWS = 128,
    LEAST_ROWS = 16,
    MOST_COLUMNS = 1 << 22 /* of a picture, with that */
};

static int tile_rows(const tc_gdal_cache *cache)
{
    int rows = MOST_ROWS;
    while (rows > LEAST_ROWS && (cache->width >> cache->first) * 4 * rows > ROWS_BYTES)
        rows /= 2;
    return rows;
}

typedef struct level_file {
    GDALDatasetH dataset;
    char path[4200];
    int nameless;       /* its descriptor; -1: none */
    uint8_t (*rows)[4]; /* of tiles, until they are full */
    int tile_rows;
    tc_image_size size;
} level_file;

typedef struct making {
    const tc_gdal_cache *cache;
    level_file level[TC_IMAGE_LEVELS]; /* [k - first] */
    tc_gdal_messages said;
} making;

/* ---- Finding ------------------------------------------------------------------------------------------------------
 */

static uint64_t mix(uint64_t hash, const char *text) /* FNV-1a */
{
    for (const char *c = text; *c; c++)
        hash = (hash ^ (unsigned char)*c) * UINT64_C(0x100000001b3);
    return hash;
}

void tc_gdal_cache_name(tc_gdal_cache *cache, char *const *files)
{
    char name[32];
    uint64_t hash = mix(UINT64_C(0xcbf29ce484222325), "1"); /* of how levels are made */
    for (; *files; files++) {
        char real[PATH_MAX], times[96] = "";
        struct stat about;
        bool there = realpath(*files, real) && stat(real, &about) == 0;
        if (there)
            snprintf(times, sizeof times, " %jd %jd %ld ", (intmax_t)about.st_size, (intmax_t)about.st_mtim.tv_sec,
                     about.st_mtim.tv_nsec);
        hash = mix(mix(hash, there ? real : *files), times);
    }
    snprintf(name, sizeof name, "%016" PRIx64, hash);
    tc_cache_path(name, cache->base, sizeof cache->base);
}

static void name_file(const tc_gdal_cache *cache, int level, char path[4200])
{
    snprintf(path, 4200, "%s-%d.tif", cache->base, level);
}

void tc_gdal_cache_forget(const tc_gdal_cache *cache)
{
    char path[4200];
    for (int k = 0; k < cache->count; k++) {
        name_file(cache, cache->first + k, path);
        unlink(path);
    }
}

/* A number that GDAL tells of a block; -1: none. */
static int64_t about_block(GDALRasterBandH band, const char *what, int x, int y)
{
    const char *text = GDALGetMetadataItem(band, CPLSPrintf("BLOCK_%s_%d_%d", what, x, y), "TIFF");
    return text ? strtoll(text, NULL, 10) : -1;
}

/* Whether the file has all its blocks, of which the last row was written last. */
static bool is_whole(const tc_gdal_cache *cache, const char *path, GDALDatasetH dataset)
{
    GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
    struct stat about;
    int w, h;
    GDALGetBlockSize(band, &w, &h);
    if (w != TILE_COLUMNS || h != tile_rows(cache) || stat(path, &about) != 0)
        return false;
    int across = (GDALGetRasterXSize(dataset) + w - 1) / w, down = (GDALGetRasterYSize(dataset) + h - 1) / h;
    for (int x = 0; x < across; x++) {
        int64_t at = about_block(band, "OFFSET", x, down - 1), size = about_block(band, "SIZE", x, down - 1);
        if (at <= 0 || size <= 0 || at + size > about.st_size)
            return false;
    }
    return true;
}

/* All files, as they were left; false where one is missing, another picture's or not whole. */
static bool open_files(const tc_gdal_cache *cache, GDALDatasetH *dataset_ret)
{
    tc_image_size size[TC_IMAGE_LEVELS];
    tc_gdal_messages said;
    tc_image_sizes(cache->width, cache->height, 1, size);
    tc_gdal_listen(&said);
    bool good = true;
    for (int k = 0; k < cache->count && good; k++) {
        char path[4200];
        name_file(cache, cache->first + k, path);
        GDALDatasetH d = GDALOpenEx(path, GDAL_OF_RASTER, (const char *const[]){"GTiff", NULL}, NULL, NULL);
        dataset_ret[k] = d;
        good = d && GDALGetRasterCount(d) == 4 && GDALGetRasterXSize(d) == size[cache->first + k].width &&
               GDALGetRasterYSize(d) == size[cache->first + k].height && is_whole(cache, path, d);
    }
    for (int k = 0; k < cache->count && !good; k++)
        if (dataset_ret[k])
            GDALClose(dataset_ret[k]), dataset_ret[k] = NULL;
    tc_gdal_heard(&said);
    return good;
}

/* ---- Making -------------------------------------------------------------------------------------------------------
 */

static tc_status cannot_keep(const making *m, const level_file *f, const char *why, tc_error *error)
{
    return tc_fail(error, TC_ERR_IO, "%s: its levels cannot be kept in %s: %s", m->cache->name, f->path,
                   why                ? why
                   : *m->said.failure ? m->said.failure
                                      : strerror(errno));
}

static bool begin_file(const tc_gdal_cache *cache, int level, tc_image_size size, level_file *f)
{
    name_file(cache, level, f->path);
    f->size = size, f->tile_rows = tile_rows(cache);
    f->nameless = tc_outfile_nameless(f->path);
    if (f->nameless < 0)
        return false;
    char **how = NULL;
    how = CSLSetNameValue(how, "TILED", "YES");
    how = CSLSetNameValue(how, "BLOCKXSIZE", CPLSPrintf("%d", TILE_COLUMNS));
    how = CSLSetNameValue(how, "BLOCKYSIZE", CPLSPrintf("%d", f->tile_rows));
    how = CSLSetNameValue(how, "COMPRESS", "DEFLATE");
    how = CSLSetNameValue(how, "ZLEVEL", "1");
    how = CSLSetNameValue(how, "PREDICTOR", "2");
    how = CSLSetNameValue(how, "BIGTIFF", "IF_SAFER");
    how = CSLSetNameValue(how, "PHOTOMETRIC", "RGB");
    how = CSLSetNameValue(how, "ALPHA", "NON-PREMULTIPLIED");
    f->dataset = GDALCreate(GDALGetDriverByName("GTiff"), CPLSPrintf("/proc/self/fd/%d", f->nameless), (int)size.width,
                            (int)size.height, 4, GDT_Byte, how);
    CSLDestroy(how);
    f->rows = malloc((size_t)size.width * (size_t)f->tile_rows * 4);
    return f->dataset && f->rows;
}

static tc_status give_row(void *context, int level, int64_t y, uint8_t (*rgba)[4], tc_error *error)
{
    making *m = context;
    level_file *f = &m->level[level - m->cache->first];
    int64_t at = y % f->tile_rows, w = f->size.width;
    memcpy(f->rows + at * w, rgba, (size_t)w * 4);
    if (at + 1 < f->tile_rows && y + 1 < f->size.height)
        return TC_OK;
    bool good = GDALDatasetRasterIO(f->dataset, GF_Write, 0, (int)(y - at), (int)w, (int)at + 1, f->rows, (int)w,
                                    (int)at + 1, GDT_Byte, 4, NULL, 4, (int)(4 * w), 1) == CE_None;
    for (int band = 1; band <= 4;
         band++) /* keeps the memory bounded; the whole would read and write the directory, too */
        GDALFlushRasterCache(GDALGetRasterBand(f->dataset, band));
    return good && !*m->said.failure ? TC_OK : cannot_keep(m, f, NULL, error);
}

/* A file that is written, or is not: gets its name, or is gone. */
static tc_status end_file(making *m, level_file *f, tc_status status, tc_error *error)
{
    tc_outfile out;
    tc_error why = {0};
    if (f->dataset)
        GDALClose(f->dataset); /* writes the directory; tells of failure only by a message */
    if (status == TC_OK && *m->said.failure)
        status = cannot_keep(m, f, NULL, error);
    if (status == TC_OK) {
        status = tc_outfile_begin(f->path, &out, &why);
        if (status == TC_OK)
            status = tc_outfile_end(&out, tc_outfile_adopt(&out, f->nameless, &why), &why);
        if (status != TC_OK)
            status = cannot_keep(m, f, why.text, error);
    }
    if (f->nameless >= 0)
        close(f->nameless);
    free(f->rows);
    return status;
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
                       "%s: expected room for levels of %lld x %lld pixels, up to %.0f MB, in %s, found %.0f MB; or "
                       "overviews in the picture (gdaladdo)",
                       cache->name, (long long)cache->width, (long long)cache->height, bytes * 1e-6, folder,
                       free_bytes * 1e-6);
    return TC_OK;
}

static tc_status make_folder(const tc_gdal_cache *cache, tc_error *error)
{
    tc_error why;
    if (tc_cache_make_folder(cache->base, &why) != TC_OK)
        return tc_fail(error, TC_ERR_IO, "%s: its levels cannot be kept in %s", cache->name, why.text);
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
    int begun = 0;
    for (; begun < cache->count && status == TC_OK; begun++)
        if (!begin_file(cache, cache->first + begun, size[cache->first + begun], &m->level[begun]))
            status = cannot_keep(m, &m->level[begun], NULL, error);
    const tc_image_making what = {.first = cache->first,
                                  .levels = cache->first + cache->count,
                                  .size = size,
                                  .give = give_row,
                                  .context = m,
                                  .progress = options->progress,
                                  .progress_context = options->progress_context};
    if (status == TC_OK)
        status = tc_image_make_levels(rows, &what, error);
    for (int k = 0; k < begun; k++)
        status = end_file(m, &m->level[k], status, error);
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
    if (cache->width > MOST_COLUMNS)
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected at most %d columns, or overviews in the picture (gdaladdo), found %lld columns",
                       cache->name, MOST_COLUMNS, (long long)cache->width);
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
