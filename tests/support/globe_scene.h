/* globe_scene.h - a planet of a function, seen through the rings: atlas, surface, renderer. */
#ifndef GLOBE_SCENE_H
#define GLOBE_SCENE_H

#include "common/map/map.h"
#include "common/render/renderer.h"
#include "scene.h"
#include "spherical/rings.h"

/* Height over radius at longitude and latitude, radians. */
typedef double (*globe_function)(double longitude, double latitude);

/* Mountains of 0.1 % of the radius from sample to sample, and ones as high that are as wide as continents. */
double globe_rough(double longitude, double latitude);
double globe_smooth(double longitude, double latitude);

/* Mountains as high, from octave to octave lower as terrains' are, down to some tens of kilometres on the Earth. */
double globe_fractal(double longitude, double latitude);

/* A globe of width x width / 2 samples, one of them on longitude 0; width as tc_lonlat_width says. Ends the program on
 * failure. */
tc_map *globe_atlas(globe_function f, int64_t width, double radius);

typedef struct globe_scene {
    const tc_gl *gl;
    const tc_map *atlas; /* not owned */
    tc_surface *surface;
    tc_renderer *renderer;
} globe_scene;

/* Unlit over magenta. Ends the program on failure. */
globe_scene globe_scene_create(const tc_context *context, const tc_map *atlas, const tc_rings_options *options);
void globe_scene_destroy(globe_scene *s);

/* A frame with all that it needs; draw: false leaves out the triangles. */
void globe_scene_frame(globe_scene *s, const tc_camera *camera, bool draw);

#endif
