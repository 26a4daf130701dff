/* view_error.h - how far a drawn picture is from the true terrain, in pixels (the design: screen-space error of a
 * view).
 *
 * Every pixel that shows terrain says where it saw it: its depth, unprojected. There |drawn height - true height| over
 * the distance from the eye, times W / (2 tan(fov / 2)), is its error. */
#ifndef TC_VIEW_ERROR_H
#define TC_VIEW_ERROR_H

#include "common/chart/body.h"
#include "common/terraclip.h"
#include "common/view/camera.h"
#include "error_stats.h"

/* Place of a reversed depth (near / w; above 0) at (x, y) pixels from the frame's top left corner (centres at + 0.5),
 * as a place on the body (body.h), as the camera's is. */
void tc_view_unproject(const tc_camera *camera, double near_plane, const tc_body *body, double x, double y, float depth,
                       double position_ret[3]);

/* What all rays of a camera share. */
typedef struct tc_lens {
    tc_basis basis;
    double tangent_x, tangent_y, width, height;
} tc_lens;
tc_lens tc_view_lens(const tc_camera *camera);

/* The direction, of length 1, of a ray through (x, y) pixels: east, north, up at the eye. */
void tc_lens_ray(const tc_lens *lens, double x, double y, double ray_ret[3]);
void tc_view_ray(const tc_camera *camera, double x, double y, double ray_ret[3]);

/* The place so far east, north and up of the eye. */
void tc_view_place(const tc_camera *camera, const tc_body *body, const double from_eye[3], double position_ret[3]);

/* The true terrain: metres absolute at a place in the camera's units; what is not finite is not counted. */
typedef struct tc_truth {
    tc_status (*height)(void *context, double x, double y, double *z_ret);
    void *context;
} tc_truth;

/* Adds the errors, in pixels, of a frame's pixels to *stats; depth: rows top to bottom, 0 where there is no terrain. */
tc_status tc_view_error_add(const tc_camera *camera, double near_plane, const tc_body *body, const float *depth,
                            const tc_truth *truth, tc_error_stats *stats);

#endif
