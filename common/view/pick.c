/* pick.c - between the pixels of a frame and places on the ground; see pick.h. */
#include "pick.h"

#include "camera.h"

#include <float.h>
#include <math.h>

static tc_camera camera_of(const tc_scenery *scenery, const tc_pose *view)
{
    tc_camera camera = {.fov = scenery->fov, .width = scenery->width, .height = scenery->height};
    tc_pose_to_camera(view, &camera);
    return camera;
}

void tc_pixel_ray(const tc_scenery *scenery, const tc_pose *view, double x, double y, double ray_ret[3])
{
    const tc_camera camera = camera_of(scenery, view);
    const tc_body *body = &scenery->ground->body;
    const tc_basis basis = tc_camera_basis(&camera);
    double t[2], axes[3][3], length = 0;
    tc_camera_tangents(&camera, &t[0], &t[1]);
    body->class->axes(body, (double[3]){view->x, view->y, view->z}, axes);
    double across = t[0] * (2 * x / scenery->width - 1), up = t[1] * (1 - 2 * y / scenery->height);
    for (int i = 0; i < 3; i++)
        ray_ret[i] = 0;
    for (int k = 0; k < 3; k++) {
        double along = basis.forward[k] + across * basis.right[k] + up * basis.up[k];
        length += along * along;
        for (int i = 0; i < 3; i++)
            ray_ret[i] += along * axes[k][i];
    }
    for (int i = 0; i < 3; i++)
        ray_ret[i] /= sqrt(length);
}

bool tc_pixel_of(const tc_scenery *scenery, const tc_pose *view, const double p[3], double *x_ret, double *y_ret)
{
    const tc_camera camera = camera_of(scenery, view);
    const tc_body *body = &scenery->ground->body;
    const tc_basis basis = tc_camera_basis(&camera);
    const double place[3] = {view->x, view->y, view->z};
    double t[2], axes[3][3], eye[3], right = 0, up = 0, forward = 0;
    tc_camera_tangents(&camera, &t[0], &t[1]);
    body->class->axes(body, place, axes);
    body->class->position(body, place, eye);
    for (int k = 0; k < 3; k++) {
        double along = 0;
        for (int i = 0; i < 3; i++)
            along += axes[k][i] * (p[i] - eye[i]);
        right += along * basis.right[k], up += along * basis.up[k], forward += along * basis.forward[k];
    }
    if (!(forward > 0))
        return false;
    *x_ret = 0.5 * scenery->width * (1 + right / (t[0] * forward));
    *y_ret = 0.5 * scenery->height * (1 - up / (t[1] * forward));
    return true;
}

/* ---- The ground that a pixel shows ------------------------------------------------------------------------------- */

/* A ray's point t metres from the eye: height above ground, and above the body; INFINITY deep inside it. */
typedef struct ray {
    const tc_ground *ground;
    double eye[3];
    const double *way;
} ray;

static void point_at(const ray *r, double t, double p_ret[3])
{
    for (int i = 0; i < 3; i++)
        p_ret[i] = r->eye[i] + t * r->way[i];
}

static double above_ground(const ray *r, double t, double *altitude_ret)
{
    const tc_body *body = &r->ground->body;
    double p[3], place[3];
    point_at(r, t, p);
    if (!body->class->place(body, p, place))
        return *altitude_ret = -INFINITY;
    *altitude_ret = place[2];
    return place[2] - r->ground->height(r->ground->context, place[0], place[1]);
}

bool tc_meet_ground(const tc_ground *ground, const double place[3], const double way[3], double highest, double from,
                    double to, const tc_ray_steps *steps, double *distance_ret, double p_ret[3])
{
    enum { HALVINGS = 60 };
    const double least = 4 * DBL_EPSILON; /* of the way, by which it still grows */
    ray r = {.ground = ground, .way = way};
    ground->body.class->position(&ground->body, place, r.eye);
    double altitude, last = from, t = from, above = above_ground(&r, t, &altitude), before = altitude;
    if (above < 0)
        return false;
    for (int64_t i = 0; i < steps->most && (above > 0 || i == 0); i++) {
        if (t >= to)
            return false;
        last = t;
        const double step = fmax(fmax(steps->by_height * above, steps->by_way * t), steps->shortest);
        t = fmin(t + fmax(fmax(fmin(step, steps->longest), altitude - highest), least * t), to);
        above = above_ground(&r, t, &altitude);
        if (altitude > before && altitude > highest && above > 0)
            return false;
        before = altitude;
    }
    if (!(above <= 0))
        return false;
    for (int i = 0; i < HALVINGS && t - last > 1e-11 * t; i++) {
        double middle = 0.5 * (last + t);
        if (above_ground(&r, middle, &altitude) > 0)
            last = middle;
        else
            t = middle;
    }
    if (above_ground(&r, last, &altitude) == INFINITY)
        return false;
    *distance_ret = t;
    point_at(&r, t, p_ret);
    return true;
}

bool tc_pick(const tc_scenery *scenery, const tc_pose *view, double x, double y, double p_ret[3])
{
    const tc_ray_steps steps = {0.4, 5e-3, 1e-3 * scenery->ground->clearance, INFINITY, 4000};
    double way[3], distance;
    tc_pixel_ray(scenery, view, x, y, way);
    return tc_meet_ground(scenery->ground, (double[3]){view->x, view->y, view->z}, way, scenery->highest, 0,
                          4 * (scenery->far + fabs(view->z)), &steps, &distance, p_ret);
}
