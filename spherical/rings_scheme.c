/* rings_scheme.c - concentric rings as fine as the frame calls for, by either map transform. */
#include "rings.h"

static tc_status create(tc_rings_scheme scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    int n_phi = request->n ? request->n : request->interactive ? 256 : tc_rings_n_phi_for(request->camera);
    const tc_rings_options options = {.scheme = scheme,
                                      .n_phi = n_phi,
                                      .m = request->steps,
                                      .n = request->interactive ? 255 : tc_clipmap_n_for(request->camera),
                                      .max_levels = request->levels,
                                      .normals = request->needs->light,
                                      .holes = request->needs->holes};
    return tc_rings_create(map, &options, surface_ret, error);
}

static tc_status create_rings(const tc_map *map, const tc_surface_request *request, tc_surface **surface_ret,
                              tc_error *error)
{
    return create(TC_RINGS_EXACT, map, request, surface_ret, error);
}

static tc_status create_ch06(const tc_map *map, const tc_surface_request *request, tc_surface **surface_ret,
                             tc_error *error)
{
    return create(TC_RINGS_CH06, map, request, surface_ret, error);
}

const tc_scheme tc_rings_schemes[] = {{"rings", NULL, &tc_sphere_body, create_rings},
                                      {"rings-ch06", "the paper's own map transform", &tc_sphere_body, create_ch06},
                                      {0}};
