/* plugin_gdal_image_levels.c - where each level of a picture is kept.
 *
 * A small picture is held in memory with all of them. Of others, what can be read in parts is read where it lies: the
 * picture itself, and its overviews, as long as they follow one another. What then is missing is made: from the
 * coarsest overview in memory, where that is small, else from the picture in the cache. */
#include "plugin_gdal_image.h"

#include "common/base/image_levels.h"
#include "common/base/image_memory.h"
#include "common/base/rect.h"
#include "common/base/status.h"

#include <cpl_string.h>

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

enum {
    COARSE_ENOUGH = 512,         /* pixels a side of the last level that must be there */
    PART = 1 << 22,              /* pixels that are decoded for a part, at most */
    VRT_PART = 1024,             /* pixels a side in which a VRT is read */
    GDAL_CACHE = 64 << 20,       /* bytes */
    LEAST_GDAL_CACHE = 24 << 20, /* while levels are made from parts that are read once */
    MOST_GDAL_CACHE = 512 << 20
};

/* ---- The picture, or an overview, from the top down ---------------------------------------------------------------
 */

typedef struct gdal_rows {
    tc_image_rows base;
    tc_gdal_image *image;
    int overview; /* -1: itself */
} gdal_rows;

static tc_status read_pixels(const gdal_rows *r, tc_rect rect, uint8_t (*rgba)[4], tc_error *error)
{
    tc_gdal_image *g = r->image;
    tc_gdal_messages said;
    tc_gdal_listen(&said);
    bool good = tc_gdal_pixels_read(&g->pixels, g->dataset, r->overview, rect, rgba, rect.x1 - rect.x0, &said);
    const char *why = tc_gdal_heard(&said);
    return good
               ? TC_OK
               : tc_fail(error, TC_ERR_FORMAT, "%s: cannot be read to its end, damaged or truncated: %s", g->path, why);
}

static tc_status read_rows(tc_image_rows *rows, int64_t row, int64_t count, uint8_t (*rgba)[4], tc_error *error)
{
    return read_pixels((gdal_rows *)rows, (tc_rect){0, row, rows->width, row + count}, rgba, error);
}

static tc_status read_part(tc_image_rows *rows, tc_rect rect, uint8_t (*rgba)[4], tc_error *error)
{
    return read_pixels((gdal_rows *)rows, rect, rgba, error);
}

static bool is_vrt(GDALDatasetH dataset)
{
    GDALDriverH driver = GDALGetDatasetDriver(dataset);
    return driver && EQUAL(GDALGetDriverShortName(driver), "VRT");
}

static GDALRasterBandH band_of(tc_gdal_image *g, int overview)
{
    GDALRasterBandH band = GDALGetRasterBand(g->dataset, g->pixels.band[0]);
    return overview < 0 ? band : GDALGetOverview(band, overview);
}

static gdal_rows rows_of(tc_gdal_image *g, int overview, bool parts)
{
    GDALRasterBandH band = band_of(g, overview);
    gdal_rows r = {{.name = g->path,
                    .width = GDALGetRasterBandXSize(band),
                    .height = GDALGetRasterBandYSize(band),
                    .read = read_rows},
                   g,
                   overview};
    if (parts) {
        int w, h;
        GDALGetBlockSize(band, &w, &h);
        r.base.read_part = read_part;
        r.base.part_width = is_vrt(g->dataset) ? VRT_PART : w;
        r.base.part_height = is_vrt(g->dataset) ? VRT_PART : h;
    }
    return r;
}

/* ---- What can be read in parts ------------------------------------------------------------------------------------
 */

/* Pixels that are decoded for one of them: a row in the middle of a compressed file costs all that is before it. */
static int64_t cost_of(GDALRasterBandH band)
{
    int w, h;
    int64_t width = GDALGetRasterBandXSize(band), height = GDALGetRasterBandYSize(band);
    GDALGetBlockSize(band, &w, &h);
    return w < width ? (int64_t)w * h : width * height;
}

/* Whether reading a part costs about what the part has. A VRT is what its files are. */
static bool in_parts(tc_gdal_image *g)
{
    if (cost_of(band_of(g, -1)) > PART)
        return false;
    for (char **file = is_vrt(g->dataset) ? g->base.parts : NULL; file && *file; file++) {
        GDALDatasetH part = GDALOpenEx(*file, GDAL_OF_RASTER, NULL, NULL, NULL);
        bool costly =
            part && !is_vrt(part) && GDALGetRasterCount(part) > 0 && cost_of(GDALGetRasterBand(part, 1)) > PART;
        if (part)
            GDALClose(part);
        if (costly)
            return false;
    }
    return true;
}

/* Whether an overview, or a mask's, has the size of a level. */
static bool is_size(GDALRasterBandH o, tc_image_size size)
{
    /* Formats round halves up or down. */
    return o && llabs(GDALGetRasterBandXSize(o) - size.width) <= 1 &&
           llabs(GDALGetRasterBandYSize(o) - size.height) <= 1;
}

/* Whether the picture's mask is known at an overview, too: where it is not, GDAL takes all for valid. */
static bool has_mask(tc_gdal_image *g, GDALRasterBandH o, tc_image_size size)
{
    GDALRasterBandH band = band_of(g, -1), mask = GDALGetMaskBand(band);
    int flags = GDALGetMaskFlags(band);
    if (!g->pixels.masks || flags & GMF_NODATA)
        return !g->pixels.masks || GDALGetMaskFlags(o) == flags;
    for (int i = 0; i < GDALGetOverviewCount(mask); i++)
        if (is_size(GDALGetOverview(mask, i), size))
            return true;
    return false;
}

/* The overview that is a level; -1: there is none. */
static int overview_of(tc_gdal_image *g, tc_image_size size)
{
    GDALRasterBandH band = band_of(g, -1);
    for (int i = 0; i < GDALGetOverviewCount(band); i++) {
        GDALRasterBandH o = GDALGetOverview(band, i);
        if (is_size(o, size) && cost_of(o) <= PART && has_mask(g, o, size))
            return i;
    }
    return -1;
}

/* Overviews that follow one another from level 1 on: the first level that is none. */
static int own_levels(tc_gdal_image *g)
{
    tc_image *image = &g->base;
    int k = 1;
    for (int overview; k < image->levels && (overview = overview_of(g, image->level[k])) >= 0; k++) {
        GDALRasterBandH o = band_of(g, overview);
        image->level[k] = (tc_image_size){GDALGetRasterBandXSize(o), GDALGetRasterBandYSize(o)};
        g->level[k] = (tc_gdal_level){g->dataset, &g->pixels, overview, NULL, 0};
    }
    return k;
}

/* ---- What is made -------------------------------------------------------------------------------------------------
 */

/* Levels from k on in memory, from the picture or an overview, which becomes the first of them. */
static tc_status in_memory(tc_gdal_image *g, int k, int overview, tc_error *error)
{
    gdal_rows rows = rows_of(g, overview, false);
    tc_image *image = &g->base;
    tc_status status = tc_image_in_memory(&rows.base, &g->small, error);
    if (status != TC_OK)
        return status;
    for (int n = 0; n < g->small->levels && k < TC_IMAGE_LEVELS; n++, k++) {
        image->level[k] = g->small->level[n];
        g->level[k] = (tc_gdal_level){.small = g->small, .small_level = n};
    }
    image->levels = k;
    return TC_OK;
}

/* Levels first .. first + count - 1 from the cache. */
static tc_status from_cache(tc_gdal_image *g, tc_image_rows *rows, int first, int count,
                            const tc_image_options *options, tc_error *error)
{
    tc_gdal_cache *cache = &g->cache;
    char *const itself[] = {g->path, NULL};
    cache->name = g->path, cache->first = first, cache->count = count;
    cache->width = rows->width, cache->height = rows->height;
    tc_gdal_cache_name(cache, g->base.parts ? g->base.parts : itself);
    tc_status status = tc_gdal_cache_open(cache, rows, options, g->cached + first, error);
    if (status == TC_OK)
        status = tc_gdal_pixels_of(g->path, g->cached[first], options->source, &g->plain, error);
    tc_image_size size[TC_IMAGE_LEVELS];
    tc_image_sizes(rows->width, rows->height, 1, size);
    for (int k = first; k < first + count; k++) {
        g->base.level[k] = size[k];
        g->level[k] = (tc_gdal_level){g->cached[k], &g->plain, -1, NULL, 0};
    }
    return status;
}

/* Rows are read some at a time: no row of blocks should be decoded twice for that. Parts need none, unless they are of
 * a picture so wide that they are read several times (image_levels.c). */
static void keep_a_row_of_blocks(tc_gdal_image *g, bool parts)
{
    int w, h;
    GDALRasterBandH band = band_of(g, -1);
    GDALGetBlockSize(band, &w, &h);
    GIntBig bytes = (GIntBig)GDALGetRasterXSize(g->dataset) * h * GDALGetRasterCount(g->dataset) *
                    GDALGetDataTypeSizeBytes(GDALGetRasterDataType(band));
    bytes += bytes / 8;
    GDALSetCacheMax64(parts ? LEAST_GDAL_CACHE : tc_clamp64(bytes, LEAST_GDAL_CACHE, MOST_GDAL_CACHE));
}

/* Gives back what making levels took: a program has the most memory when it has also begun to draw. */
static void make_room(tc_gdal_image *g)
{
    GDALSetCacheMax64(GDAL_CACHE);
    GDALFlushCache(g->dataset);
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

static tc_status make_missing(tc_gdal_image *g, bool parts, const tc_image_options *options, tc_error *error)
{
    gdal_rows rows = rows_of(g, -1, parts);
    int own = own_levels(g), levels = g->base.levels;
    const tc_image_size last = g->base.level[own - 1];
    if (own < levels && own > 1 && last.width * last.height <= TC_IMAGE_SMALL) {
        tc_status status = in_memory(g, own - 1, g->level[own - 1].overview, error);
        if (status != TC_OK)
            return status;
        own = levels;
    }
    /* What lacks overviews for more than that gets all of them from the cache: its own may be filtered another way. */
    int first = parts ? 1 : 0, count = own >= levels ? 1 - first : levels - first;
    if (count == 0)
        return TC_OK;
    keep_a_row_of_blocks(g, parts);
    tc_status status = from_cache(g, &rows.base, first, count, options, error);
    make_room(g);
    return status;
}

tc_status tc_gdal_image_levels(tc_gdal_image *g, tc_image_rows *rows, const tc_image_options *options, tc_error *error)
{
    const tc_image_size size = rows ? (tc_image_size){rows->width, rows->height}
                                    : (tc_image_size){GDALGetRasterXSize(g->dataset), GDALGetRasterYSize(g->dataset)};
    g->base.levels = tc_image_sizes(size.width, size.height, COARSE_ENOUGH, g->base.level);
    if (rows)
        return from_cache(g, rows, 0, g->base.levels, options, error);
    if (size.width * size.height <= TC_IMAGE_SMALL)
        return in_memory(g, 0, -1, error);
    g->level[0] = (tc_gdal_level){g->dataset, &g->pixels, -1, NULL, 0};
    return make_missing(g, in_parts(g), options, error);
}
