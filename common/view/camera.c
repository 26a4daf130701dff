/* camera.c - a pinhole camera in the map's frame, with reversed infinite depth. */
#include "camera.h"

#include <math.h>

tc_basis tc_camera_basis(const tc_camera *camera)
{
    double sh = sin(camera->heading), ch = cos(camera->heading), sp = sin(camera->pitch), cp = cos(camera->pitch);
    return (tc_basis){{ch, -sh, 0}, {-sh * sp, -ch * sp, cp}, {sh * cp, ch * cp, sp}};
}

void tc_camera_tangents(const tc_camera *camera, double *half_width_ret, double *half_height_ret)
{
    *half_width_ret = tan(camera->fov / 2);
    *half_height_ret = *half_width_ret * camera->height / camera->width;
}

double tc_camera_pixel_scale(const tc_camera *camera)
{
    return camera->width / (2 * tan(camera->fov / 2));
}

void tc_camera_matrix(const tc_camera *camera, double near_plane, float matrix_ret[16])
{
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    for (int i = 0; i < 3; i++) {
        matrix_ret[4 * i + 0] = (float)(b.right[i] / tx);
        matrix_ret[4 * i + 1] = (float)(b.up[i] / ty);
        matrix_ret[4 * i + 2] = 0;
        matrix_ret[4 * i + 3] = (float)b.forward[i];
    }
    matrix_ret[12] = matrix_ret[13] = matrix_ret[15] = 0;
    matrix_ret[14] = (float)near_plane;
}

tc_frustum tc_camera_frustum(const tc_camera *camera)
{
    tc_basis b = tc_camera_basis(camera);
    double tx, ty;
    tc_camera_tangents(camera, &tx, &ty);
    tc_frustum f;
    for (int i = 0; i < 3; i++) {
        f.normal[0][i] = b.forward[i] * tx + b.right[i];
        f.normal[1][i] = b.forward[i] * tx - b.right[i];
        f.normal[2][i] = b.forward[i] * ty + b.up[i];
        f.normal[3][i] = b.forward[i] * ty - b.up[i];
    }
    return f;
}

bool tc_frustum_sees(const tc_frustum *frustum, const double lo[3], const double hi[3])
{
    for (int p = 0; p < 4; p++) {
        const double *n = frustum->normal[p];
        double d = 0;
        for (int i = 0; i < 3; i++)
            d += n[i] * (n[i] > 0 ? hi[i] : lo[i]); /* the corner furthest inwards */
        if (d < 0)
            return false;
    }
    return true;
}

bool tc_frustum_sees_ball(const tc_frustum *frustum, const double middle[3], double radius)
{
    for (int p = 0; p < 4; p++) {
        const double *n = frustum->normal[p];
        double d = n[0] * middle[0] + n[1] * middle[1] + n[2] * middle[2];
        if (d < 0 && d * d > radius * radius * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]))
            return false;
    }
    return true;
}
