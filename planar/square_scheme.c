/* square_scheme.c - square nested grids as large as the frame calls for. */
#include "square.h"

/* Samples a side of the windows. */
static int size(const tc_surface_request *request)
{
    enum { LEAST = 63, MOST_IN_SOFTWARE = 255 };
    if (request->n)
        return request->n;
    int n = tc_clipmap_n_for(request->camera);
    if (request->interactive && n > MOST_IN_SOFTWARE)
        n = MOST_IN_SOFTWARE;
    for (int i = 0; i < request->halvings && n > LEAST; i++)
        n /= 2;
    return n;
}

static tc_status create(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    (void)scheme;
    const tc_ground_options options = {.n = size(request),
                                       .max_levels = request->levels,
                                       .normals = request->needs->normals,
                                       .fine_normals = request->needs->fine_normals,
                                       .holes = request->needs->holes};
    return tc_square_create(tc_map_field(map, 0), &options, surface_ret, error);
}

const tc_scheme tc_square_schemes[] = {{"square", NULL, &tc_plane_body, size, create, NULL, NULL}, {0}};
