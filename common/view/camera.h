/* camera.h - bases, matrices and frusta of a camera. */
#ifndef TC_CAMERA_H
#define TC_CAMERA_H

#include "common/terraclip.h"

/* The camera's axes in the map's frame: unit vectors right, up, forward. */
typedef struct tc_basis {
    double right[3], up[3], forward[3];
} tc_basis;
tc_basis tc_camera_basis(const tc_camera *camera);

/* Focal lengths: half the frame is this many tangents wide and high. */
void tc_camera_tangents(const tc_camera *camera, double *half_width_ret, double *half_height_ret);

/* Pixels per unit of size over distance, W / (2 tan(fov / 2)): an object of size s at distance d covers s / d of these.
 */
double tc_camera_pixel_scale(const tc_camera *camera);

/* Column-major matrix from positions relative to the eye (map axes, metres) to clip space: reversed depth near / w in
 * [0, 1], infinite far plane. */
void tc_camera_matrix(const tc_camera *camera, double near_plane, float matrix_ret[16]);

/* The four side planes of the view: normals pointing inwards, through the eye. */
typedef struct tc_frustum {
    double normal[4][3];
} tc_frustum;
tc_frustum tc_camera_frustum(const tc_camera *camera);

/* Whether a box, relative to the eye, may be seen; false only where it surely is not. */
bool tc_frustum_sees(const tc_frustum *frustum, const double lo[3], const double hi[3]);

/* The same of a ball. */
bool tc_frustum_sees_ball(const tc_frustum *frustum, const double middle[3], double radius);

#endif
