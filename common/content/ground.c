/* ground.c - the contents that a terrain's windows have. */
#include "ground.h"

tc_status tc_ground_create(const tc_field *field, const tc_ground_options *options, tc_clipmap **clipmap_ret,
                           tc_error *error)
{
    tc_clipmap_options windows = {.n = options->n,
                                  .max_levels = options->max_levels,
                                  .coarsest = options->coarsest,
                                  .wraps = options->wraps,
                                  .spacing_x = options->spacing_x,
                                  .spacing_y = options->spacing_y};
    windows.content[windows.contents++] = (tc_content){.class = &tc_heights_content};
    if (options->normals)
        windows.content[windows.contents++] =
            (tc_content){.class = options->fine_normals ? &tc_fine_normals_content : &tc_normals_content,
                         .parameter = options->relief,
                         .context = options->shear};
    if (options->holes)
        windows.content[windows.contents++] = (tc_content){.class = &tc_voids_content};
    return tc_clipmap_create(field, &windows, clipmap_ret, error);
}

void tc_ground_bytes(const tc_clipmap *clipmap, size_t *heights_ret, size_t *normals_ret)
{
    *heights_ret = tc_clipmap_bytes(clipmap, NULL) + tc_clipmap_bytes(clipmap, &tc_heights_content) +
                   tc_clipmap_bytes(clipmap, &tc_voids_content);
    *normals_ret = tc_clipmap_bytes(clipmap, &tc_normals_content) + tc_clipmap_bytes(clipmap, &tc_fine_normals_content);
}
