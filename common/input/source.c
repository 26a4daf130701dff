/* source.c - elevation input: which library reads a file, and what its samples mean.
 *
 * A file is known by its content, not by its name; only .hgt, which has no header, goes by name and size. GDAL comes
 * first for all but OpenEXR, also for 16-bit PNG and TIFF, which OpenImageIO could read as well: GDAL knows nodata,
 * scale and georeference, notices truncated strips, is silent about damaged files (libpng below OpenImageIO prints),
 * and loads in a fifth of the time. OpenImageIO has what GDAL leaves: EXR and the picture formats GDAL does not know.
 */
#include "source_internal.h"

#include "common/base/status.h"
#include "folder.h"
#include "plugin.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct tc_source {
    tc_source_info info;
    tc_source_options options;
    tc_raster *raster;
    tc_conversion conversion;
    bool flip_x, flip_y; /* the file's columns run east to west, its rows south to north */
    int64_t chunk_rows;  /* that fit the buffers */
    void *samples;       /* chunk_rows rows in the file's type; made when first needed */
    uint8_t *mask;       /* likewise; NULL where the raster has no mask */
    tc_suspicion suspicion;
    char path[];
};

/* Rows are read in chunks of about this size: large enough for GDAL to decode tiles in parallel, small against any
 * terrain worth caring. */
enum { CHUNK_BYTES = 16 << 20 };
/* A row must fit in memory; one longer than this comes from a damaged header. */
enum { LONGEST_ROW = 1 << 30 };

/* ---- Opening ---------------------------------------------------------------------------------------------------- */

tc_status tc_check_source_options(const tc_source_options *options, tc_error *error)
{
    if (options->spacing != 0 && !(options->spacing >= 1e-6 && options->spacing <= 1e7))
        return tc_fail(error, TC_ERR_USAGE, "spacing: expected 1e-6 to 1e7 metres, found %g", options->spacing);
    if (options->unit != 0 && !(fabs(options->unit) >= 1e-9 && fabs(options->unit) <= 1e9))
        return tc_fail(error, TC_ERR_USAGE, "unit: expected 1e-9 to 1e9 metres, found %g", options->unit);
    if (options->has_offset && !(fabs(options->offset) <= TC_HIGHEST))
        return tc_fail(error, TC_ERR_USAGE, "offset: expected -1e9 to 1e9 metres, found %g", options->offset);
    if (options->voids == TC_VOIDS_CONSTANT && !(fabs(options->void_constant) <= TC_HIGHEST))
        return tc_fail(error, TC_ERR_USAGE, "height of voids: expected -1e9 to 1e9 metres, found %g",
                       options->void_constant);
    return TC_OK;
}

/* The file's first bytes, after ruling out what no library needs to see. */
static tc_status read_signature(const char *path, unsigned char signature[8], tc_error *error)
{
    memset(signature, 0, 8);
    struct stat about;
    FILE *file = NULL;
    if (stat(path, &about) != 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if (S_ISDIR(about.st_mode)) /* a raster in many files, if at all */
        return tc_is_folder(path) ? tc_fail(error, TC_ERR_IO, "%s: expected a file, found a directory", path) : TC_OK;
    if (!S_ISREG(about.st_mode))
        return tc_fail(error, TC_ERR_IO, "%s: expected a regular file, found a device or pipe", path);
    if (about.st_size == 0)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected heights, found an empty file", path);
    file = fopen(path, "rb");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    size_t got = fread(signature, 1, 8, file);
    bool failed = got == 0 && ferror(file);
    fclose(file);
    return failed ? tc_fail(error, TC_ERR_IO, "%s: cannot be read", path) : TC_OK;
}

/* Closes a raster that is not GDAL's where something was asked for that only GDAL can do: nothing is passed over in
 * silence. layer_taken: it named a file of an archive. */
static tc_status refuse_gdals_options(const char *path, const tc_source_options *options, bool layer_taken,
                                      tc_raster **raster, tc_error *error)
{
    const char *name = options->crs                     ? "crs"
                       : options->band > 1              ? "band"
                       : options->layer && !layer_taken ? "layer"
                                                        : NULL;
    if (!name)
        return TC_OK;
    (*raster)->close(*raster);
    *raster = NULL;
    return tc_fail(error, TC_ERR_USAGE, "--%s: expected none for %s, which is not read by GDAL", name, path);
}

/* *raster_ret stays NULL where a file is no archive of an .hgt. */
static tc_status open_archived_hgt(const struct tc_gdal_plugin *gdal, const char *path,
                                   const tc_source_options *options, tc_raster **raster_ret, tc_error *error)
{
    char *name = NULL;
    void *bytes = NULL;
    size_t size = 0;
    bool layer_taken = false;
    tc_status status = gdal->unpack_hgt(path, options, &name, &layer_taken, &bytes, &size, error);
    if (bytes)
        status = tc_hgt_open_bytes(path, name, bytes, size, options, raster_ret, error);
    if (bytes && status == TC_OK)
        status = refuse_gdals_options(path, options, layer_taken, raster_ret, error);
    free(name);
    return status;
}

static tc_status open_raster(const char *path, const tc_source_options *options, tc_raster **raster_ret,
                             tc_error *error)
{
    unsigned char signature[8];
    tc_status status = read_signature(path, signature, error);
    if (status != TC_OK)
        return status;

    if (tc_is_tclip(signature))
        return tc_fail(error, TC_ERR_UNSUPPORTED,
                       "%s: expected an elevation file or a picture of heights, found a packed "
                       "terrain",
                       path);
    bool recognised = false;
    bool tiff = tc_is_tiff(signature), png = tc_is_png(signature);
    bool exr = memcmp(signature, "\x76\x2f\x31\x01", 4) == 0;
    if (!tiff && !png && !exr) {
        status = tc_hgt_open(path, options, &recognised, raster_ret, error);
        if (recognised)
            return status ? status : refuse_gdals_options(path, options, false, raster_ret, error);
    }
    status = tc_check_whole(path, error);
    if (status != TC_OK)
        return status;
    if (memcmp(signature, "P2", 2) == 0 && strchr(" \t\r\n", signature[2]))
        return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected a binary PGM (P5), found one written as text (P2)",
                       path);

    const void *table = NULL;
    if (!exr) {
        status = tc_plugin_load("gdal", &table, error);
        const struct tc_gdal_plugin *gdal = table;
        if (status == TC_OK && !tiff && !png) {
            status = open_archived_hgt(gdal, path, options, raster_ret, error);
            if (status != TC_OK || *raster_ret)
                return status;
        }
        if (status == TC_OK)
            status = gdal->open(path, options, &recognised, raster_ret, error);
        if (!table || recognised || tiff || png)
            return status;
    }
    status = tc_plugin_load("oiio", &table, error);
    if (status != TC_OK)
        return status;
    status = ((const struct tc_oiio_plugin *)table)->open(path, options, &recognised, raster_ret, error);
    if (status == TC_OK)
        status = refuse_gdals_options(path, options, false, raster_ret, error);
    if (recognised || exr)
        return status;
    return tc_fail(
        error, TC_ERR_UNSUPPORTED,
        "%s: expected an elevation file or a picture of heights, found what neither GDAL nor OpenImageIO knows", path);
}

/* ---- Meaning ---------------------------------------------------------------------------------------------------- */

/* Metres per unit of heights: by the band's own word, else by the vertical part of the coordinate system. */
static double find_unit(const tc_raster_info *raster, const tc_source_options *options)
{
    const tc_source_options silent = {0};
    const tc_source_options *said = options->unit == 0 ? options : &silent;
    double unit = tc_unit_by_name(raster->unit_name), feet = raster->crs == TC_CRS_PROJECTED ? raster->crs_unit : 1;
    if (*raster->unit_name && unit == 0)
        tc_say(said, true, "heights are in \"%s\", which is not known: taken as metres", raster->unit_name);
    if (*raster->unit_name)
        return unit == 0 ? 1 : unit;
    if (raster->vertical_unit > 0) {
        if (raster->vertical_unit != 1)
            tc_say(said, false, "heights in %s (%.9g m), by the coordinate system",
                   *raster->vertical_name ? raster->vertical_name : "units", raster->vertical_unit);
        return raster->vertical_unit;
    }
    if (fabs(feet - 0.3048) < 1e-4)
        tc_say(said, true,
               "the map is in feet, and nothing is said of heights: taken as metres; --unit %.7f takes them as feet",
               feet);
    return 1;
}

static void settle_unit(tc_source *source)
{
    const tc_raster_info *raster = &source->raster->info;
    const tc_source_options *options = &source->options;
    double unit = find_unit(raster, options);
    /* The option stands for the file's scale and unit; its offset stays what it is in metres. */
    source->info.unit = options->unit != 0 ? options->unit : raster->scale * unit;
    source->info.type = raster->type;
    source->info.added = options->has_offset ? options->offset : 0;
    source->info.offset = raster->offset * unit + source->info.added;
    source->info.has_nodata = raster->has_nodata || options->has_nodata;
    source->info.nodata = raster->has_nodata ? raster->nodata : options->nodata;
    source->conversion.type = raster->type;
    source->conversion.scale = source->info.unit;
    source->conversion.offset = source->info.offset;
    if (raster->has_nodata)
        source->conversion.nodata[source->conversion.nodata_count++] = raster->nodata;
    if (options->has_nodata)
        source->conversion.nodata[source->conversion.nodata_count++] = options->nodata;
    if (raster->type == TC_SAMPLE_UINT8 || raster->type == TC_SAMPLE_INT8)
        tc_say(options, true, "8-bit heights: 256 steps of %g m at most, so slopes will look like stairs",
               source->info.unit);
}

static tc_status make_buffers(tc_source *source, tc_error *error)
{
    if (source->samples)
        return TC_OK;
    size_t count = (size_t)source->chunk_rows * (size_t)source->info.width;
    source->samples = malloc(count * tc_sample_size(source->conversion.type));
    source->mask = source->raster->info.has_mask ? malloc(count) : NULL;
    if (!source->samples || (source->raster->info.has_mask && !source->mask)) {
        free(source->samples);
        source->samples = NULL;
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for %lld rows of %lld samples", source->path,
                       (long long)source->chunk_rows, (long long)source->info.width);
    }
    return TC_OK;
}

/* Floats count in steps of 1/128 m beyond 2^16 m. Types that can be finer there (32-bit integers, doubles, anything
 * with an offset) get a base near their first height, which leaves the floats to the relief: 1 mm on 1e6 m survives. */
static void take_base(tc_source *source, double first)
{
    if (fabs(first) > 65536 && fabs(first) <= TC_HIGHEST)
        source->info.z_base = round(first);
    source->conversion.offset -= source->info.z_base;
}

/* Heights about as large as the body itself are distances from its middle (NASA's and the USGS's grids of planets). */
static bool are_radii(const tc_source *source, double first)
{
    double radius = source->raster->info.semi_major;
    return !source->options.has_offset && radius >= 1000 && first >= 0.6 * radius && first <= 1.5 * radius;
}

static void take_first(tc_source *source, double first)
{
    double radius = source->raster->info.semi_major;
    if (are_radii(source, first)) {
        source->info.added = -radius;
        source->info.offset -= radius;
        source->conversion.offset -= radius;
        source->info.georef.inverse_flattening = 0; /* what is left is above a sphere */
        first -= radius;
        tc_say(&source->options, true,
               "its heights are distances from the body's middle: %.9g m, its radius, are taken off; --offset 0 keeps "
               "them",
               radius);
    }
    take_base(source, first);
}

/* Whether what is stored can be as large as the body. */
static bool may_be_radii(const tc_source *source)
{
    static const double most[] = {255, 127, 65535, 32767, 4294967295., 2147483647., INFINITY, INFINITY};
    const tc_conversion *c = &source->conversion;
    double radius = source->raster->info.semi_major;
    return radius >= 1000 && most[c->type] * fabs(c->scale) + fabs(c->offset) >= 0.6 * radius;
}

static tc_status settle_base(tc_source *source, tc_error *error)
{
    const tc_raster_info *raster = &source->raster->info;
    if (source->options.has_base) {
        source->info.z_base = source->options.z_base;
        source->conversion.offset -= source->info.z_base;
        return TC_OK;
    }
    bool wide =
        raster->type == TC_SAMPLE_UINT32 || raster->type == TC_SAMPLE_INT32 || raster->type == TC_SAMPLE_FLOAT64;
    bool based = wide || source->conversion.offset != 0;
    if (!based && !may_be_radii(source))
        return TC_OK;
    int64_t height = source->info.height, width = source->info.width;
    for (int64_t row = 0, rows; row < height; row += rows) {
        /* A single block first: most files have their first height there. */
        rows = row == 0 && raster->block_rows < source->chunk_rows ? raster->block_rows : source->chunk_rows;
        rows = height - row < rows ? height - row : rows;
        tc_status status = make_buffers(source, error);
        if (status == TC_OK)
            status = source->raster->read(source->raster, row, rows, source->samples, source->mask, error);
        if (status != TC_OK)
            return status;
        for (int64_t i = 0; i < rows * width; i++) {
            double z = tc_convert_one(&source->conversion, source->samples, source->mask, i);
            if (isnan(z))
                continue;
            if (based || are_radii(source, z))
                take_first(source, z);
            return TC_OK;
        }
    }
    return TC_OK;
}

static tc_status settle(tc_source *source, tc_error *error)
{
    const tc_raster_info *raster = &source->raster->info;
    tc_source_info *info = &source->info;
    info->width = raster->width;
    info->height = raster->height;
    info->sample_type = raster->type_name;
    info->integer = raster->integer;
    tc_settle_georef(raster, &source->options, &info->georef, &info->spacing_x, &info->spacing_y, &source->flip_x,
                     &source->flip_y);
    info->georef.crs_wkt = raster->crs_wkt;
    info->area_registered = raster->area_registered;
    info->crs_unit = tc_crs_unit(raster, &info->georef);
    info->inverse_flattening = raster->inverse_flattening;
    settle_unit(source);

    int64_t row_bytes = raster->width * (int64_t)tc_sample_size(raster->type);
    if (row_bytes > LONGEST_ROW)
        return tc_fail(error, TC_ERR_MEMORY, "%s: expected rows of at most 1 GiB, found %lld samples of %.1f GiB",
                       source->path, (long long)raster->width, (double)row_bytes / LONGEST_ROW);
    int64_t block = raster->block_rows < raster->height ? raster->block_rows : raster->height;
    int64_t rows = CHUNK_BYTES / row_bytes / block * block;
    /* Whole rows of blocks, unless those are enormous (a file stored as one block). */
    source->chunk_rows = rows > 0 ? rows : block * row_bytes <= 16 * (int64_t)CHUNK_BYTES ? block : 1;
    if (source->chunk_rows > raster->height)
        source->chunk_rows = raster->height;
    return settle_base(source, error);
}

tc_status tc_source_open(const char *path, const tc_source_options *options, tc_source **source_ret, tc_error *error)
{
    static const tc_source_options defaults = {0};
    options = options ? options : &defaults;
    tc_status status = tc_check_source_options(options, error);
    if (status != TC_OK)
        return status;
    tc_raster *raster = NULL;
    status = tc_outputs_spare(options->outputs, path, error);
    if (status == TC_OK)
        status = open_raster(path, options, &raster, error);
    if (status != TC_OK)
        return status;
    tc_source *source = calloc(1, sizeof *source + strlen(path) + 1);
    if (!source) {
        raster->close(raster);
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory to open it", path);
    }
    strcpy(source->path, path);
    source->options = *options;
    source->suspicion = TC_SUSPICION_NONE;
    source->raster = raster;
    for (char **part = raster->info.parts; part && *part && status == TC_OK; part++) {
        status = tc_outputs_spare(options->outputs, *part, error);
        if (status == TC_OK)
            status = tc_check_whole(*part, error);
    }
    if (status == TC_OK)
        status = settle(source, error);
    if (status != TC_OK) {
        tc_source_close(source);
        return status;
    }
    *source_ret = source;
    return TC_OK;
}

void tc_source_close(tc_source *source)
{
    if (!source)
        return;
    source->raster->close(source->raster);
    free(source->samples);
    free(source->mask);
    free(source);
}

const tc_source_info *tc_source_get_info(const tc_source *source)
{
    return &source->info;
}

int64_t tc_source_chunk_rows(const tc_source *source)
{
    return source->chunk_rows;
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

static void mirror_row(float *z, uint8_t *voids, int64_t width)
{
    for (int64_t i = 0, j = width - 1; i < j; i++, j--) {
        float height = z[i];
        z[i] = z[j];
        z[j] = height;
        uint8_t is_void = voids[i];
        voids[i] = voids[j];
        voids[j] = is_void;
    }
}

/* Refuses a height from which the stored value does not come back. */
static tc_status check_exact(const tc_source *source, int64_t row, const void *samples, const uint8_t *voids,
                             const float *z, tc_error *error)
{
    int64_t i = tc_find_inexact(&source->conversion, samples, voids, source->info.width, z);
    if (i < 0)
        return TC_OK;
    const tc_conversion as_stored = {.type = source->conversion.type, .scale = 1};
    return tc_fail(
        error, TC_ERR_UNSUPPORTED,
        "%s: column %lld, row %lld: expected a value that a 32-bit float can stand for, found %.17g; without "
        "loss it cannot be kept",
        source->path, (long long)i, (long long)row, tc_convert_one(&as_stored, samples, NULL, i));
}

/* Refuses heights that must come from a wrong unit, naming the first. */
static tc_status check_heights(const tc_source *source, int64_t y, const float *z, tc_error *error)
{
    for (int64_t i = 0; i < source->info.width; i++)
        if (fabs(z[i] + source->info.z_base) > TC_HIGHEST)
            return tc_fail(error, TC_ERR_FORMAT,
                           "%s: height at column %lld, row %lld: expected metres within 1e9, found %g", source->path,
                           (long long)i, (long long)(source->info.height - 1 - y), (double)z[i] + source->info.z_base);
    return TC_OK;
}

tc_status tc_source_read_counted(tc_source *source, int64_t y0, int64_t rows, float *z, uint8_t *voids,
                                 tc_statistics *statistics, tc_error *error)
{
    int64_t width = source->info.width, height = source->info.height;
    if (y0 < 0 || rows < 0 || y0 > height - rows)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected rows within 0 to %lld, found %lld to %lld", source->path,
                       (long long)height - 1, (long long)y0, (long long)(y0 + rows - 1));
    tc_status status = make_buffers(source, error);
    if (status != TC_OK)
        return status;

    /* The file's rows, in its own order, chunk by chunk. */
    size_t size = tc_sample_size(source->conversion.type);
    int64_t first = source->flip_y ? y0 : height - y0 - rows, end = first + rows;
    for (int64_t row = first; row < end; row += source->chunk_rows) {
        int64_t count = end - row < source->chunk_rows ? end - row : source->chunk_rows;
        status = source->raster->read(source->raster, row, count, source->samples, source->mask, error);
        if (status != TC_OK)
            return status;
        for (int64_t k = 0; k < count; k++) {
            int64_t y = source->flip_y ? row + k : height - 1 - (row + k);
            float *to = z + (y - y0) * width;
            uint8_t *to_voids = voids + (y - y0) * width;
            const uint8_t *mask = source->mask ? source->mask + k * width : NULL;
            const void *samples = (const char *)source->samples + (size_t)(k * width) * size;
            tc_convert_row(&source->conversion, samples, mask, width, to, to_voids, statistics);
            tc_suspect_row(&source->suspicion, &source->conversion, to, to_voids, width, statistics);
            if (source->options.exact) {
                status = check_exact(source, row + k, samples, to_voids, to, error);
                if (status != TC_OK)
                    return status;
            }
            if (statistics->low + source->info.z_base < -TC_HIGHEST ||
                statistics->high + source->info.z_base > TC_HIGHEST) {
                status = check_heights(source, y, to, error);
                if (status != TC_OK)
                    return status;
            }
            if (source->flip_x)
                mirror_row(to, to_voids, width);
        }
    }
    tc_suspect_rows(&source->suspicion, &source->conversion, rows, height, statistics, &source->options);
    return TC_OK;
}

tc_status tc_source_read(tc_source *source, int64_t y0, int64_t rows, float *z, uint8_t *voids, tc_error *error)
{
    tc_statistics statistics = TC_STATISTICS_NONE;
    return tc_source_read_counted(source, y0, rows, z, voids, &statistics, error);
}
