/* load_imagery.c - pictures from files over a map. */
#include "load_imagery.h"

#include <stdlib.h>

#include "common/base/status.h"

tc_status tc_imagery_load(const tc_map *map, const char *const *paths, int count, int threads,
                          const tc_image_options *options, tc_imagery **imagery_ret, tc_error *error)
{
    const tc_georef *georef = tc_field_georef(map->chart[0].field);
    const tc_image_map where = {.known = map->georef.known,
                                .crs_wkt = map->georef.known ? georef->crs_wkt : NULL,
                                .globe = map->body.radius > 0};
    tc_image **images = calloc((size_t)count, sizeof *images);
    tc_status status = images ? TC_OK : tc_fail(error, TC_ERR_MEMORY, "imagery: not enough memory");
    int opened = 0;
    while (opened < count && status == TC_OK)
        if ((status = tc_image_open(paths[opened], &where, options, &images[opened], error)) == TC_OK)
            opened++;
    if (status == TC_OK)
        status = tc_imagery_create(map, images, count, threads, imagery_ret, error);
    else
        while (opened-- > 0)
            images[opened]->close(images[opened]);
    free(images);
    return status;
}
