/* square_scheme.c - square nested grids as large as the frame calls for. */
#include <math.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "square_internal.h"

int tc_square_n_for(const tc_field *field, double error, const tc_camera *camera)
{
    const double tolerance = error / tc_camera_pixel_scale(camera);
    const int most = (int)tc_min64(4 * (tc_clipmap_n_for(camera) + 1) - 1, TC_CLIPMAP_MAX_N);
    double cells = 0;
    tc_field_know_errors(field);
    for (int level = 2; level <= tc_field_info(field)->levels; level++) {
        const tc_level size = tc_field_level(field, level);
        const tc_range r = tc_field_range(field, level, (tc_rect){0, 0, size.width, size.height});
        /* No further than the terrain goes. */
        const double g = fmin(size.spacing_x, size.spacing_y), far = r.error / tolerance / g;
        cells = fmax(cells, fmin(far, (double)tc_max64(size.width, size.height)));
    }
    int n = TC_SQUARE_LEAST_N;
    while (n < most && tc_square_tree_reach(n) < cells)
        n = 2 * n + 1;
    return n;
}

/* Samples a side of the windows that the frame alone calls for, and of those that there are. */
static int shaded_size(const tc_surface_request *request)
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

static int size(const tc_surface_request *request)
{
    int n = shaded_size(request);
    if (request->n || !(request->error > 0))
        return n;
    int called_for = tc_square_n_for(tc_map_field(request->map, 0), request->error, request->camera);
    for (int i = 0; i < request->halvings && called_for > TC_SQUARE_LEAST_N; i++)
        called_for /= 2;
    return called_for > n ? called_for : n > TC_SQUARE_LEAST_N ? n : TC_SQUARE_LEAST_N;
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
    return tc_square_create(tc_map_field(map, 0), &options, request->error > 0 ? shaded_size(request) : 0, surface_ret,
                            error);
}

const tc_scheme tc_square_schemes[] = {{"square", NULL, &tc_plane_body, size, create, NULL, NULL, true}, {0}};
