/* sight.h - where a frame is seen from and how it lies in its target: through a camera, or by a host's matrices. */
#ifndef TC_SIGHT_H
#define TC_SIGHT_H

#include "common/chart/body.h"
#include "common/terraclip_draw.h"
#include "common/view/camera.h"

typedef struct tc_sight {
    tc_camera camera;                /* where the eye is, and how fine its pixels are: what surfaces choose levels by */
    tc_camera around;                /* sees all that is seen, and perhaps more: what is culled for */
    tc_basis axes;                   /* of the eye, in the map's frame */
    double left, right, bottom, top; /* sides of the frame over the distance forward */
    float matrix[16];                /* column-major, from positions relative to the eye to clip space */
    bool through;                    /* a camera: `around` is that, */
    bool inverse; /* and depth near_plane / distance, by which shaders tell the distance; else they tell it by w */
    bool mirrored;
} tc_sight;

/* Through a camera. near_plane: metres; what lies behind it is not seen. There is no far plane. */
tc_sight tc_sight_through(const tc_camera *camera, tc_depth depth, double near_plane);

/* By matrices, column-major as OpenGL has them, from the map's frame: on a plane its metres, of a body those from its
 * centre (x towards longitude and latitude 0, z north). width, height: pixels.
 * TC_ERR_USAGE: numbers that are not finite, a view that is more than turning and moving, a projection that is
 * singular, no perspective, or of another depth. */
tc_status tc_sight_by(const double view[16], const double projection[16], tc_depth depth, const tc_body *body,
                      int width, int height, tc_sight *sight_ret, tc_error *error);

/* TC_ERR_USAGE for a camera that nothing can be seen through. */
tc_status tc_sight_check(const tc_camera *camera, tc_error *error);

#endif
