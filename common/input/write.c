/* write.c - GeoTIFFs and pictures, through the plugins, atomically. */
#include "source.h"

#include "common/base/status.h"
#include "common/base/outfile.h"
#include "plugin.h"
#include "source_internal.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* Rows of values on their way into the file's type. */
typedef struct rows {
    const char *path;
    const tc_tiff_options *options;
    tc_row_function row;
    void *context;
    double *values;
    tc_error *error;
} rows;

static const char *type_name(tc_sample_type type)
{
    static const char *const names[] = {"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"};
    return names[type];
}

static tc_status give_samples(void *context, int64_t y, void *samples)
{
    const rows *r = context;
    const tc_tiff_options *o = r->options;
    tc_status status = r->row(r->context, y, r->values);
    if (status != TC_OK)
        return tc_fail(r->error, status, "%s: row %lld could not be made: %s", r->path, (long long)y,
                       tc_status_text(status));
    int64_t i = tc_store_row(o->type, r->values, o->width, o->has_nodata ? o->nodata : NAN, samples);
    if (i >= 0)
        return tc_fail(r->error, TC_ERR_USAGE, "%s: value at %lld,%lld: expected one within the range of %s, found %g",
                       r->path, (long long)i, (long long)y, type_name(o->type), r->values[i]);
    return TC_OK;
}

tc_status tc_write_tiff(const char *path, const tc_tiff_options *options, tc_row_function row, void *context,
                        tc_error *error)
{
    if (options->width < 1 || options->height < 1 || options->width > INT_MAX || options->height > INT_MAX)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected 1 to 2147483647 columns and rows, found %lld x %lld", path,
                       (long long)options->width, (long long)options->height);
    bool by_spacing = !options->georef || !options->georef->known;
    if (by_spacing && !(options->spacing > 0 && options->spacing < 1e9))
        return tc_fail(error, TC_ERR_USAGE, "%s: spacing: expected a positive number of metres, found %g", path,
                       options->spacing);
    const void *table = NULL;
    tc_status status = tc_plugin_load("gdal", &table, error);
    if (status != TC_OK)
        return status;
    const struct tc_gdal_plugin *gdal = table;
    tc_outfile outfile;
    status = tc_outfile_begin(path, &outfile, error);
    if (status != TC_OK)
        return status;
    rows r = {path, options, row, context, malloc((size_t)options->width * sizeof *r.values), error};
    status = r.values ? gdal->write_tiff(path, outfile.temporary, options, give_samples, &r, error)
                      : tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory for its rows", path);
    free(r.values);
    return tc_outfile_end(&outfile, status, error);
}

/* The plugin that writes pictures, if it knows path's extension. */
static tc_status find_writer(const char *path, const struct tc_oiio_plugin **oiio_ret, tc_error *error)
{
    const void *table = NULL;
    tc_status status = tc_plugin_load("oiio", &table, error);
    if (status != TC_OK)
        return status;
    *oiio_ret = table;
    return (*oiio_ret)->can_write(path)
               ? TC_OK
               : tc_fail(error, TC_ERR_USAGE,
                         "%s: expected the extension of a picture format (.png, .jpg, .tif, .exr), found "
                         "none that can be written",
                         path);
}

tc_status tc_check_picture_name(const char *path, tc_error *error)
{
    const struct tc_oiio_plugin *oiio;
    return find_writer(path, &oiio, error);
}

tc_status tc_write_picture(const char *path, int width, int height, const uint8_t *rgb, tc_error *error)
{
    if (width < 1 || height < 1)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected a picture of at least one pixel, found %d x %d", path, width,
                       height);
    const struct tc_oiio_plugin *oiio;
    tc_status status = find_writer(path, &oiio, error);
    if (status != TC_OK)
        return status;
    tc_outfile outfile;
    status = tc_outfile_begin(path, &outfile, error);
    if (status != TC_OK)
        return status;
    status = oiio->write_picture(path, outfile.temporary, width, height, rgb, error);
    return tc_outfile_end(&outfile, status, error);
}
