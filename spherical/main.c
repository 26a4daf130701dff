/* main.c - planet-viewer: a planet, or a part of one, on a sphere. */
#include "globe.h"
#include "rings.h"

#include <string.h>

#include "common/app/viewer.h"

static tc_status make_surface(const tc_atlas *atlas, const tc_surface_request *request, tc_surface **surface_ret,
                              tc_error *error)
{
    bool ch06 = request->scheme && strcmp(request->scheme, "rings-ch06") == 0;
    int n_phi = request->n ? request->n : request->interactive ? 256 : tc_rings_n_phi_for(request->camera);
    const tc_rings_options options = {.scheme = ch06 ? TC_RINGS_CH06 : TC_RINGS_EXACT,
                                      .n_phi = n_phi,
                                      .m = request->steps,
                                      .n = request->interactive ? 255 : tc_clipmap_n_for(request->camera),
                                      .max_levels = request->levels,
                                      .normals = request->needs->light,
                                      .holes = request->needs->holes};
    return tc_rings_create(atlas, &options, surface_ret, error);
}

int main(int argc, char **argv)
{
    static const tc_viewer_program program = {
        .name = "planet-viewer",
        .summary =
            "Shows a map of a planet in longitude and latitude, or of a part of one, as a globe: from space to the "
            "ground, in a window or as a picture.",
        .navigation = &tc_globe_navigation,
        .sphere = true,
        .make_surface = make_surface,
    };
    return tc_viewer_main(&program, argc, argv);
}
