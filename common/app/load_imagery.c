/* load_imagery.c - pictures from files over a map. */
#include "load_imagery.h"

#include <stdlib.h>

#include "common/base/status.h"

/* A picture that does not say where it lies could be of a part of the map, or of more than it: what is done is said. */
static void tell_place(const tc_map *map, const tc_image *image, const tc_image_options *options)
{
    bool around = map->chart[0].wraps;
    bool globe = map->body.radius > 0 && image->level[0].width == 2 * image->level[0].height;
    if (image->find)
        return;
    tc_say(options->source, globe && !around,
           "%s: says nothing of where it lies: laid over all of the %s; a georeference puts it elsewhere", image->name,
           around ? "globe" : "terrain");
}

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
            tell_place(map, images[opened++], options);
    if (status == TC_OK)
        status = tc_imagery_create(map, images, count, threads, imagery_ret, error);
    else
        while (opened-- > 0)
            images[opened]->close(images[opened]);
    free(images);
    return status;
}
