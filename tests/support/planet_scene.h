/* planet_scene.h - planets made in memory, and scenes of rings over them. */
#ifndef PLANET_SCENE_H
#define PLANET_SCENE_H

#include "scene.h"
#include "spherical/faces.h"
#include "spherical/rings.h"
#include "terrains.h"

/* Metres above the sphere in direction p, of length 1. */
typedef double (*planet_function)(void *context, const double p[3]);

/* `width` columns, half as many rows, whose samples stand for areas. The program ends where something fails. */
tc_map *planet_atlas(int64_t width, double radius, planet_function height, void *context);

typedef enum planet_kind {
    PLANET_CLIFF,  /* samples and blocks of them at -3000 m or 5000 m at random */
    PLANET_SMOOTH, /* planet_smooth() with 3000 m */
    PLANET_DEFAULT /* what `terraclip synth --kind planet` makes */
} planet_kind;
tc_map *planet_made(planet_kind kind, int64_t width, double radius, uint64_t seed);

/* The planet itself, with so many levels finer than its data, fitted to it; 0: as it is. */
tc_map *planet_synthesised(tc_map *planet, int levels);

/* The same heights above an ellipsoid of that flattening, of the same radius at the equator. */
tc_map *planet_flattened(tc_map *planet, double flattening);

#define WGS84_FLATTENING (1 / 298.257223563)

/* Of a constant gradient in space: *(double *)context metres times a . p, |a| = 1. */
double planet_slope(void *context, const double p[3]);
/* The same with a few harmonics up to degree 12. */
double planet_smooth(void *context, const double p[3]);

/* The same functions, and an atlas' finest levels, at longitude and latitude, for tc_truth. */
typedef struct planet_truth {
    planet_function height;
    void *context;
} planet_truth;
tc_status planet_truth_height(void *truth, double longitude, double latitude, double *z_ret);
tc_status planet_atlas_height(void *atlas, double longitude, double latitude, double *z_ret);

/* A scene to be used as scene.h says. rings->normals, holes and throttle are set by what options need. */
scene planet_scene(const tc_context *context, const tc_map *atlas, const tc_rings_options *rings,
                   const tc_scene_options *options);
/* The same with a surface of one's own, which it takes over. */
scene planet_scene_of(const tc_context *context, const tc_map *atlas, tc_surface *surface,
                      const tc_scene_options *options);
tc_surface *planet_rings(const tc_map *atlas, const tc_rings_options *rings, const tc_scene_options *options);

/* A planet of longitude and latitude resampled to faces of that class, in place of it; and a surface over such a one.
 */
tc_map *planet_of_faces(tc_map *planet, const tc_chart_class *class);
tc_surface *planet_faces(const tc_map *map, const faces_kind *kind, int n, const tc_scene_options *options);

float *planet_depth(scene *s, const tc_camera *camera); /* of the drawn frame; caller frees */

/* Views from `low` metres above the ground to `high` above the sphere, log-uniform: all latitudes, many over or by the
 * poles, on the antimeridian and where caps take over; up and down, many towards the horizon. */
tc_camera planet_view(test_random *r, const tc_map *atlas, double low, double high);

#endif
