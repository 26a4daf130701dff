/* main.c - planar-viewer: a terrain as a flat map of square nested grids. */
#include "square.h"

#include "common/app/options.h"
#include "common/app/viewer.h"
#include "common/base/numbers.h"

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

static bool read_n(void *n, const char *value)
{
    int *samples = n;
    return tc_read_int(value, 15, 2047, samples) && (*samples & (*samples + 1)) == 0;
}

int main(int argc, char **argv)
{
    static const tc_scheme schemes[] = {{"square", NULL, create}};
    static const tc_option options[] = {
        {.help = "Geometry clipmap"},
        {0, "n", "N", "2^k - 1 of 15..2047", "samples a side of each level's window (by the frame's width)", read_n,
         offsetof(tc_options, n)},
        TC_LEVELS_OPTION,
        TC_BUDGET_OPTION,
    };
    static const tc_viewer_program program = {
        .name = "planar-viewer",
        .summary =
            "Shows any elevation file (.hgt, GeoTIFF, VRT, PNG, EXR, ...) as a watertight terrain, in a window or "
            "as a picture.",
        .body = &tc_plane_body,
        .navigation = &tc_plane_navigation,
        .schemes = schemes,
        .scheme_count = sizeof schemes / sizeof *schemes,
        .options = options,
        .option_count = sizeof options / sizeof *options,
    };
    return tc_viewer_main(&program, argc, argv);
}
