/* square_scheme.c - square nested grids as large as the frame calls for. */
#include "square.h"

static tc_status create(const tc_map *map, const tc_surface_request *request, tc_surface **surface_ret, tc_error *error)
{
    tc_ground_options options = {.n = request->n,
                                 .max_levels = request->levels,
                                 .normals = request->needs->light,
                                 .holes = request->needs->holes};
    if (!options.n) {
        options.n = tc_clipmap_n_for(request->camera);
        if (request->interactive && options.n > 255)
            options.n = 255;
    }
    tc_clipmap *clipmap;
    tc_status status = tc_ground_create(tc_map_field(map, 0), &options, &clipmap, error);
    return status ? status : tc_square_create(clipmap, surface_ret, error);
}

const tc_scheme tc_square_schemes[] = {{"square", NULL, &tc_plane_body, create}, {0}};
