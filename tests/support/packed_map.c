/* packed_map.c */
#include "packed_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/field/field.h"
#include "test.h"

void packed_map(const tc_map *map, const char *path)
{
    const tc_field *field = tc_map_field(map, 0);
    int finest = tc_field_info(field)->levels;
    tc_level size = tc_field_level(field, finest);
    const tc_rect all = {0, 0, size.width, size.height};
    float *z = malloc((size_t)(size.width * size.height) * sizeof *z);
    assert_non_null(z);
    assert_int_equal(tc_field_read(field, finest, all, z, NULL, (ptrdiff_t)size.width), TC_OK);
    tc_pack_terrain terrain = {.width = size.width,
                               .height = size.height,
                               .spacing_x = size.spacing_x,
                               .spacing_y = size.spacing_y,
                               .sample_type = TC_SAMPLE_FLOAT32,
                               .unit = 1};
    if (map->body.radius > 0) {
        double step = 360.0 / (double)size.width, metres = map->body.radius * step * M_PI / 180;
        const double t[6] = {-180, step, 0, 90, 0, -step};
        terrain.wraps_x = true, terrain.radius = map->body.radius;
        terrain.spacing_x = terrain.spacing_y = metres;
        terrain.georef = (tc_georef){.known = true, .geographic = true, .semi_major = map->body.radius};
        memcpy(terrain.georef.transform, t, sizeof t);
    }
    tc_packer *packer = NULL;
    tc_pack_result result;
    tc_error error = {TC_OK, ""};
    if (tc_packer_create(path, &terrain, &(tc_pack_options){.error = 1}, &packer, &error) ||
        tc_packer_put(packer, all, z, NULL, (ptrdiff_t)size.width, &error) || tc_packer_finish(packer, &result, &error))
        fail_msg("%s", error.text);
    tc_packer_destroy(packer);
    free(z);
}
