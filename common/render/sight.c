/* sight.c - cameras and matrices as one. */
#include "sight.h"

#include <math.h>
#include <string.h>

#include "common/base/status.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The matrix of a sight; clip z = a w + b at the distance w forward. */
static void set_matrix(tc_sight *s, double a, double b)
{
    double x = 2 / (s->right - s->left), y = 2 / (s->top - s->bottom);
    for (int i = 0; i < 3; i++) {
        double forward = s->axes.forward[i];
        s->matrix[4 * i + 0] = (float)(x * s->axes.right[i] - 0.5 * x * (s->right + s->left) * forward);
        s->matrix[4 * i + 1] = (float)(y * s->axes.up[i] - 0.5 * y * (s->top + s->bottom) * forward);
        s->matrix[4 * i + 2] = (float)(a * forward);
        s->matrix[4 * i + 3] = (float)forward;
    }
    s->matrix[12] = s->matrix[13] = s->matrix[15] = 0;
    s->matrix[14] = (float)b;
}

/* ---- Cameras ----------------------------------------------------------------------------------------------------- */

tc_status tc_sight_check(const tc_camera *c, tc_error *error)
{
    const double numbers[] = {c->x, c->y, c->z, c->heading, c->pitch, c->fov};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i]))
            return tc_fail(error, TC_ERR_USAGE, "camera: expected finite numbers, found %g", numbers[i]);
    if (!(c->fov > 0 && c->fov < M_PI) || c->width < 1 || c->height < 1)
        return tc_fail(error, TC_ERR_USAGE, "camera: expected an angle of 0 to pi and pixels, found %g and %d x %d",
                       c->fov, c->width, c->height);
    return TC_OK;
}

tc_sight tc_sight_through(const tc_camera *camera, tc_depth depth, double near_plane)
{
    tc_sight s = {.camera = *camera,
                  .around = *camera,
                  .axes = tc_camera_basis(camera),
                  .through = true,
                  .inverse = depth == TC_DEPTH_REVERSED};
    tc_camera_tangents(camera, &s.right, &s.top);
    s.left = -s.right, s.bottom = -s.top;
    if (depth == TC_DEPTH_REVERSED)
        tc_camera_matrix(camera, near_plane, s.matrix);
    else
        set_matrix(&s, 1, depth == TC_DEPTH_CONVENTIONAL ? -2 * near_plane : -near_plane);
    return s;
}

/* ---- Matrices ---------------------------------------------------------------------------------------------------- */

/* Element in a row and a column. */
static double at(const double m[16], int row, int column)
{
    return m[4 * column + row];
}

static tc_status check_finite(const char *name, const double m[16], tc_error *error)
{
    for (int i = 0; i < 16; i++)
        if (!isfinite(m[i]))
            return tc_fail(error, TC_ERR_USAGE, "%s matrix: expected finite numbers, found %g", name, m[i]);
    return TC_OK;
}

/* Whether it turns, perhaps mirrors, and moves. */
static tc_status check_view(const double m[16], tc_error *error)
{
    tc_status status = check_finite("view", m, error);
    double worst = fabs(at(m, 3, 3) - 1);
    for (int i = 0; i < 3; i++) {
        worst = fmax(worst, fabs(at(m, 3, i)));
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += at(m, i, k) * at(m, j, k);
            worst = fmax(worst, fabs(sum - (i == j)));
        }
    }
    if (status == TC_OK && !(worst < 1e-4)) /* also of what a host had as floats */
        status = tc_fail(error, TC_ERR_USAGE,
                         "view matrix: expected a rotation and a translation, found one that is off by "
                         "%.3g",
                         worst);
    return status;
}

static tc_status check_projection(const double m[16], tc_depth depth, tc_error *error)
{
    tc_status status = check_finite("projection", m, error);
    if (status)
        return status;
    static const int zeros[][2] = {{0, 1}, {0, 3}, {1, 0}, {1, 3}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 3}};
    for (size_t i = 0; i < sizeof zeros / sizeof *zeros; i++)
        if (at(m, zeros[i][0], zeros[i][1]) != 0)
            return tc_fail(error, TC_ERR_USAGE,
                           "projection matrix: expected a perspective without shear, found %g in row %d, column %d",
                           at(m, zeros[i][0], zeros[i][1]), zeros[i][0], zeros[i][1]);
    if (!(at(m, 3, 2) < 0) || at(m, 0, 0) == 0 || at(m, 1, 1) == 0 || at(m, 2, 3) == 0)
        return tc_fail(error, TC_ERR_USAGE, "projection matrix: expected one that can be inverted and looks along -z");
    if ((at(m, 2, 3) > 0) != (depth == TC_DEPTH_REVERSED))
        return tc_fail(error, TC_ERR_USAGE,
                       "projection matrix: expected depth that %s with the distance, found that it %s",
                       depth == TC_DEPTH_REVERSED ? "falls" : "grows", depth == TC_DEPTH_REVERSED ? "grows" : "falls");
    return TC_OK;
}

/* Axes and place of the eye. */
static tc_status set_eye(tc_sight *s, const double view[16], const tc_body *body, tc_error *error)
{
    double eye[3], place[3], axes[3][3];
    for (int i = 0; i < 3; i++)
        eye[i] = -(at(view, 0, i) * at(view, 0, 3) + at(view, 1, i) * at(view, 1, 3) + at(view, 2, i) * at(view, 2, 3));
    if (!body->class->place(body, eye, place))
        return tc_fail(error, TC_ERR_USAGE,
                       "view matrix: expected an eye above the ground, found it %g m from the centre of a body of %g m",
                       sqrt(dot(eye, eye)), body->radius);
    body->class->axes(body, place, axes);
    for (int i = 0; i < 3; i++) {
        const double row[3][3] = {{at(view, 0, 0), at(view, 0, 1), at(view, 0, 2)},
                                  {at(view, 1, 0), at(view, 1, 1), at(view, 1, 2)},
                                  {-at(view, 2, 0), -at(view, 2, 1), -at(view, 2, 2)}};
        s->axes.right[i] = dot(axes[i], row[0]);
        s->axes.up[i] = dot(axes[i], row[1]);
        s->axes.forward[i] = dot(axes[i], row[2]);
    }
    s->camera.x = place[0], s->camera.y = place[1], s->camera.z = place[2];
    const double *f = s->axes.forward;
    s->camera.heading = atan2(f[0], f[1]);
    s->camera.pitch = atan2(f[2], hypot(f[0], f[1]));
    return TC_OK;
}

/* The camera without roll that holds the corners of what is seen. */
static tc_camera camera_around(const tc_sight *s)
{
    enum { WIDTH = 10000 };
    tc_camera c = s->camera;
    const tc_basis b = tc_camera_basis(&c);
    double wide = 0, high = 0;
    for (int k = 0; k < 4; k++) {
        double x = k & 1 ? s->right : s->left, y = k & 2 ? s->top : s->bottom, ray[3];
        for (int i = 0; i < 3; i++)
            ray[i] = s->axes.forward[i] + x * s->axes.right[i] + y * s->axes.up[i];
        wide = fmax(wide, fabs(dot(ray, b.right)) / dot(ray, b.forward));
        high = fmax(high, fabs(dot(ray, b.up)) / dot(ray, b.forward));
    }
    c.fov = 2 * atan(wide * (1 + 1e-6));
    c.width = WIDTH;
    c.height = (int)fmin(fmax(ceil(WIDTH * high / wide), 1), 1e9);
    return c;
}

tc_status tc_sight_by(const double view[16], const double projection[16], tc_depth depth, const tc_body *body,
                      int width, int height, tc_sight *sight_ret, tc_error *error)
{
    tc_sight s = {.camera = {.width = width, .height = height}};
    tc_status status = check_view(view, error);
    if (status == TC_OK)
        status = check_projection(projection, depth, error);
    if (status == TC_OK)
        status = set_eye(&s, view, body, error);
    if (status != TC_OK)
        return status;
    double w = -at(projection, 3, 2), x = at(projection, 0, 0) / w, y = at(projection, 1, 1) / w;
    double shift_x = at(projection, 0, 2) / w, shift_y = at(projection, 1, 2) / w;
    s.left = (shift_x - 1) / x, s.right = (shift_x + 1) / x;
    s.bottom = (shift_y - 1) / y, s.top = (shift_y + 1) / y;
    s.camera.fov = 2 * atan(fmin(fabs(1 / x), width / fabs(y) / height));
    set_matrix(&s, -at(projection, 2, 2) / w, at(projection, 2, 3) / w);
    s.around = camera_around(&s);
    const double *r = s.axes.right, *u = s.axes.up, *f = s.axes.forward;
    double turned = r[0] * (u[1] * f[2] - u[2] * f[1]) + r[1] * (u[2] * f[0] - u[0] * f[2]) +
                    r[2] * (u[0] * f[1] - u[1] * f[0]); /* right x up = -forward */
    s.mirrored = turned > 0;
    if (x * y < 0)
        s.mirrored = !s.mirrored;
    *sight_ret = s;
    return TC_OK;
}
