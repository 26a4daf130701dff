/* main.c - planar-viewer: a terrain as a flat map of square nested grids. */
#include "square.h"

#include "common/view/flight.h"
#include "common/app/viewer.h"

static tc_status make_surface(const tc_atlas *atlas, const tc_surface_request *request, tc_surface **surface_ret,
                              tc_error *error)
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
    tc_status status = tc_ground_create(atlas->chart[0].field, &options, &clipmap, error);
    return status ? status : tc_square_create(clipmap, surface_ret, error);
}

int main(int argc, char **argv)
{
    static const tc_viewer_program program = {
        .name = "planar-viewer",
        .summary =
            "Shows any elevation file (.hgt, GeoTIFF, VRT, PNG, EXR, ...) as a watertight terrain, in a window or "
            "as a picture.",
        .navigation = &tc_flat_navigation,
        .make_surface = make_surface,
    };
    return tc_viewer_main(&program, argc, argv);
}
