/* rings_scheme.c - concentric rings as fine as the frame calls for, by either map transform. */
#include "rings.h"

/* Steps around. */
static int size(const tc_surface_request *request)
{
    enum { LEAST = 128 };
    if (request->n)
        return request->n;
    int n_phi = tc_rings_n_phi_for(request->camera);
    for (int i = 0; i < request->halvings && n_phi > LEAST; i++)
        n_phi /= 2;
    return n_phi;
}

/* Samples a side of the windows that shading calls for. */
static int window_size(const tc_surface_request *request)
{
    enum { LEAST = 63 };
    int n = tc_clipmap_n_for(request->camera);
    for (int i = 0; i < request->halvings && n > LEAST; i++)
        n /= 2;
    return n;
}

static tc_status create(const tc_scheme *scheme, const tc_map *map, const tc_surface_request *request,
                        tc_surface **surface_ret, tc_error *error)
{
    const tc_rings_options options = {.scheme = *(const tc_rings_scheme *)scheme->kind,
                                      .n_phi = size(request),
                                      .m = request->steps,
                                      .n = window_size(request),
                                      .max_levels = request->levels,
                                      .normals = request->needs->normals,
                                      .fine_normals = request->needs->fine_normals,
                                      .holes = request->needs->holes,
                                      .throttle = request->needs->throttle,
                                      .outside = request->needs->plain ? request->needs->around.level : 0};
    return tc_rings_create(map, &options, surface_ret, error);
}

/* Steps and windows in one number. */
static int all_sizes(const tc_surface_request *request)
{
    return size(request) * 4096 + window_size(request);
}

static const tc_rings_scheme exact = TC_RINGS_EXACT, ch06 = TC_RINGS_CH06;

const tc_scheme tc_rings_schemes[] = {
    {"rings", NULL, &tc_sphere_body, all_sizes, create, &tc_atlas_lonlat, &exact, false},
    {"rings-ch06", "the paper's own map transform", &tc_sphere_body, all_sizes, create, &tc_atlas_lonlat, &ch06, false},
    {0}};
