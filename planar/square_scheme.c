/* square_scheme.c - square nested grids as large as the frame calls for. */
#include <math.h>
#include <stdlib.h>

#include "common/base/rect.h"
#include "common/view/camera.h"
#include "square_internal.h"

/* Cells of a level, whichever has most of them, out to which it is drawn over a rectangle of the terrain, shares of its
 * sides. No further than the terrain goes. */
static double cells_over(const tc_field *field, double tolerance, double x0, double y0, double x1, double y1)
{
    double cells = 0;
    for (int level = 2; level <= tc_field_info(field)->levels; level++) {
        const tc_level size = tc_field_level(field, level);
        const double w = (double)size.width, h = (double)size.height;
        const tc_rect r = {(int64_t)(x0 * w), (int64_t)(y0 * h), (int64_t)ceil(x1 * w), (int64_t)ceil(y1 * h)};
        const double g = fmin(size.spacing_x, size.spacing_y);
        cells = fmax(cells, fmin((double)tc_field_range(field, level, r).error / tolerance / g, fmax(w, h)));
    }
    return cells;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Blocks of 16 x 16 cells cost a driver less than twice as many of a quarter; but levels that are drawn out to few
 * cells are drawn out to some 3 more sides of a block. */
static int side_for(const tc_field *field, double tolerance)
{
    enum { PARTS = 16, SMALL = 8, LARGE = 16, FEW = 200 };
    double cells[PARTS * PARTS];
    for (int k = 0; k < PARTS * PARTS; k++) {
        const double x = k % PARTS, y = (int)(k / PARTS);
        cells[k] = cells_over(field, tolerance, x / PARTS, y / PARTS, (x + 1) / PARTS, (y + 1) / PARTS);
    }
    qsort(cells, PARTS * PARTS, sizeof *cells, compare);
    return cells[PARTS * PARTS / 2] < FEW ? SMALL : LARGE;
}

int tc_square_n_for(const tc_field *field, double error, const tc_camera *camera, int *side_ret)
{
    const double tolerance = error / tc_camera_pixel_scale(camera);
    const int most = (int)tc_min64(4 * (tc_clipmap_n_for(camera) + 1) - 1, TC_CLIPMAP_MAX_N);
    tc_field_know_errors(field);
    if (!isfinite(tc_field_range(field, tc_field_info(field)->levels, (tc_rect){0, 0, 1, 1}).error)) {
        /* Not known: levels go by the distance alone. */
        if (side_ret)
            *side_ret = 0;
        return (int)tc_max64(tc_clipmap_n_for(camera), TC_SQUARE_LEAST_N);
    }
    const double cells = cells_over(field, tolerance, 0, 0, 1, 1);
    const int side = side_for(field, tolerance);
    /* Heights and normals of all levels, bytes. */
    const double texel = 8 + 4 * 4, most_bytes = 0x1p30;
    int n = TC_SQUARE_LEAST_N;
    while (n < most && tc_square_tree_reach(n, side) < cells &&
           (2 * n + 2.0) * (2 * n + 2.0) * texel * tc_field_info(field)->levels <= most_bytes)
        n = 2 * n + 1;
    if (side_ret)
        *side_ret = side;
    return n;
}

/* Samples a side of the windows that the frame alone calls for, and of those that there are. */
static int shaded_size(const tc_surface_request *request)
{
    enum { LEAST = 63 };
    if (request->n)
        return request->n;
    int n = tc_clipmap_n_for(request->camera);
    for (int i = 0; i < request->halvings && n > LEAST; i++)
        n /= 2;
    return n;
}

/* The latter with a tolerance. */
static int size_within(const tc_surface_request *request, const tc_map *map, int *side_ret)
{
    const int n = shaded_size(request);
    int called_for = tc_square_n_for(tc_map_field(map, 0), request->error, request->camera, side_ret);
    if (request->n)
        return n;
    for (int i = 0; i < request->halvings && called_for > TC_SQUARE_LEAST_N; i++)
        called_for /= 2;
    return called_for > n ? called_for : n > TC_SQUARE_LEAST_N ? n : TC_SQUARE_LEAST_N;
}

static int size(const tc_surface_request *request)
{
    if (request->n || !(request->error > 0) || !request->map)
        return shaded_size(request);
    return size_within(request, request->map, NULL);
}

static tc_status create(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    (void)scheme;
    const bool by_error = request->error > 0;
    tc_square_blocks blocks = {.shaded_n = shaded_size(request)};
    const tc_ground_options options = {.n = by_error ? size_within(request, map, &blocks.side) : blocks.shaded_n,
                                       .max_levels = request->levels,
                                       .normals = request->needs->normals,
                                       .fine_normals = request->needs->fine_normals,
                                       .holes = request->needs->holes};
    return tc_square_create(tc_map_field(map, 0), &options, by_error ? &blocks : NULL, surface_ret, error);
}

const tc_scheme tc_square_schemes[] = {{"square", NULL, &tc_plane_body, size, create, NULL, NULL, true}, {0}};
