/* image.c - which library reads a picture. */
#include "image.h"

#include "common/base/image_memory.h"
#include "common/base/status.h"
#include "plugin.h"
#include "plugin_tables.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* What no library needs to see. */
static tc_status check_file(const char *path, tc_error *error)
{
    struct stat about;
    if (stat(path, &about) != 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if (!S_ISREG(about.st_mode))
        return tc_fail(error, TC_ERR_IO, "%s: expected a picture, found a %s", path,
                       S_ISDIR(about.st_mode) ? "directory" : "device or pipe");
    if (about.st_size == 0)
        return tc_fail(error, TC_ERR_FORMAT, "%s: expected a picture, found an empty file", path);
    FILE *file = fopen(path, "rb");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    fclose(file);
    return TC_OK;
}

/* By OpenImageIO: pictures without a place. */
static tc_status open_other(const char *path, const tc_image_options *options, tc_image **image_ret, tc_error *error)
{
    const void *oiio, *gdal;
    tc_image_rows *rows = NULL;
    tc_status status = tc_plugin_load("oiio", &oiio, error);
    if (status == TC_OK)
        status = ((const struct tc_oiio_plugin *)oiio)->open_rows(path, options, &rows, error);
    if (status != TC_OK)
        return status;
    if (rows->width * rows->height <= TC_IMAGE_SMALL)
        status = tc_image_in_memory(rows, image_ret, error);
    else if ((status = tc_plugin_load("gdal", &gdal, error)) == TC_OK)
        status = ((const struct tc_gdal_plugin *)gdal)->cache_image(rows, options, image_ret, error);
    rows->close(rows);
    return status;
}

tc_status tc_image_open(const char *path, const tc_image_map *map, const tc_image_options *options,
                        tc_image **image_ret, tc_error *error)
{
    const void *gdal;
    bool recognised = false;
    const tc_outputs *outputs = options->source->outputs;
    tc_status status = check_file(path, error);
    if (status == TC_OK && outputs)
        status = tc_outputs_spare(outputs, path, error);
    if (status == TC_OK)
        status = tc_plugin_load("gdal", &gdal, error);
    if (status != TC_OK)
        return status;
    tc_image *image = NULL;
    status = ((const struct tc_gdal_plugin *)gdal)->open_image(path, map, options, &recognised, &image, error);
    if (status != TC_OK && !recognised)
        status = open_other(path, options, &image, error);
    for (char **part = status == TC_OK && outputs ? image->parts : NULL; part && *part && status == TC_OK; part++)
        status = tc_outputs_spare(outputs, *part, error);
    if (status == TC_OK)
        *image_ret = image;
    else if (image)
        image->close(image);
    return status;
}
