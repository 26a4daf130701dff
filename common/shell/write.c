/* write.c - GeoTIFFs and pictures, through the plugins, atomically. */
#include "source.h"

#include "common/core/base/status.h"
#include "common/core/base/outfile.h"
#include "plugin.h"
#include "plugin_tables.h"

#include <limits.h>

tc_status tc_write_tiff(const char *path, const tc_tiff_options *options, tc_row_function row, void *context,
                        tc_error *error)
{
    if (options->width < 1 || options->height < 1 || options->width > INT_MAX || options->height > INT_MAX)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected 1 to 2147483647 columns and rows, found %lld x %lld", path,
                       (long long)options->width, (long long)options->height);
    if (!(options->spacing > 0 && options->spacing < 1e9))
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
    status = gdal->write_tiff(path, outfile.temporary, options, row, context, error);
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
