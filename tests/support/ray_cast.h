/* ray_cast.h - rays against the finest level of a terrain or a planet, in double: the picture as it should be. */
#ifndef RAY_CAST_H
#define RAY_CAST_H

#include "common/map/map.h"
#include "common/terraclip.h"

/* The mesh of tc_field_height(): every triangle that a ray passes over is met exactly, large blocks of cells that it
 * passes above are left out by the maximum of their heights. Ends the program when there is no memory. */
typedef struct ray_flat ray_flat;
ray_flat *ray_flat_create(const tc_field *field);
void ray_flat_destroy(ray_flat *f);

/* Distance from the eye, metres, of the first point along direction d, of length 1 (tc_view_ray()), where a ray passes
 * from above to below the terrain. False where there is none, and where the ray begins below it or comes in under its
 * edge. */
bool ray_flat_hit(const ray_flat *f, const tc_camera *camera, const double d[3], double *distance_ret);

/* The surface of tc_map_height(), which is bilinear on its charts: steps of at most a fiftieth of the distance and an
 * eighth of a sample, and secants; larger ones where maxima of tiles show that nothing is in the way. */
typedef struct ray_globe ray_globe;
ray_globe *ray_globe_create(const tc_map *atlas);
void ray_globe_destroy(ray_globe *g);
bool ray_globe_hit(const ray_globe *g, const tc_camera *camera, const double d[3], double *distance_ret);

#endif
