/* view_error.c - depths of a picture back to places, and their distance to the true terrain. */
#include "view_error.h"

#include <math.h>

tc_lens tc_view_lens(const tc_camera *camera)
{
    tc_lens lens = {.basis = tc_camera_basis(camera), .width = camera->width, .height = camera->height};
    tc_camera_tangents(camera, &lens.tangent_x, &lens.tangent_y);
    return lens;
}

/* Towards (x, y), as long as it takes to be 1 along the camera's axis. */
static void direction(const tc_lens *lens, double x, double y, double d[3])
{
    const tc_basis *b = &lens->basis;
    double u = (2 * x / lens->width - 1) * lens->tangent_x, v = (1 - 2 * y / lens->height) * lens->tangent_y;
    for (int i = 0; i < 3; i++)
        d[i] = b->forward[i] + u * b->right[i] + v * b->up[i];
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void tc_lens_ray(const tc_lens *lens, double x, double y, double ray_ret[3])
{
    direction(lens, x, y, ray_ret);
    double l = length(ray_ret);
    for (int i = 0; i < 3; i++)
        ray_ret[i] /= l;
}

void tc_view_ray(const tc_camera *camera, double x, double y, double ray_ret[3])
{
    const tc_lens lens = tc_view_lens(camera);
    tc_lens_ray(&lens, x, y, ray_ret);
}

void tc_view_place(const tc_camera *camera, const tc_body *body, const double from_eye[3], double position_ret[3])
{
    const double eye[3] = {camera->x, camera->y, camera->z};
    body->class->beside(body, eye, from_eye, position_ret);
}

/* Relative to the eye. */
static void seen(const tc_lens *lens, double near_plane, double x, double y, float depth, double p[3])
{
    direction(lens, x, y, p);
    for (int i = 0; i < 3; i++)
        p[i] *= near_plane / (double)depth;
}

void tc_view_unproject(const tc_camera *camera, double near_plane, const tc_body *body, double x, double y, float depth,
                       double position_ret[3])
{
    const tc_lens lens = tc_view_lens(camera);
    double from_eye[3];
    seen(&lens, near_plane, x, y, depth, from_eye);
    tc_view_place(camera, body, from_eye, position_ret);
}

tc_status tc_view_error_add(const tc_camera *camera, double near_plane, const tc_body *body, const float *depth,
                            const tc_truth *truth, tc_error_stats *stats)
{
    const tc_lens lens = tc_view_lens(camera);
    double scale = tc_camera_pixel_scale(camera);
    for (int j = 0; j < camera->height; j++)
        for (int i = 0; i < camera->width; i++) {
            float d = depth[(size_t)j * (size_t)camera->width + (size_t)i];
            double from_eye[3], p[3], z;
            if (d <= 0)
                continue;
            seen(&lens, near_plane, i + 0.5, j + 0.5, d, from_eye);
            tc_view_place(camera, body, from_eye, p);
            tc_status status = truth->height(truth->context, p[0], p[1], &z);
            if (status)
                return status;
            if (isfinite(z))
                tc_error_stats_add(stats, fabs(p[2] - z) / length(from_eye) * scale);
        }
    return TC_OK;
}
