/* sphere.c - the sphere as a body. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "body.h"
#include "common/base/status.h"

static void normal(const tc_body *body, const double place[3], double n_ret[3])
{
    (void)body;
    n_ret[0] = cos(place[1]) * cos(place[0]);
    n_ret[1] = cos(place[1]) * sin(place[0]);
    n_ret[2] = sin(place[1]);
}

static void position(const tc_body *body, const double place[3], double p_ret[3])
{
    normal(body, place, p_ret);
    for (int i = 0; i < 3; i++)
        p_ret[i] *= body->radius + place[2];
}

static bool place_of(const tc_body *body, const double p[3], double place_ret[3])
{
    double across = hypot(p[0], p[1]), away = hypot(across, p[2]);
    place_ret[0] = atan2(p[1], p[0]), place_ret[1] = atan2(p[2], across), place_ret[2] = away - body->radius;
    return away > 0.5 * body->radius;
}

static void axes(const tc_body *body, const double place[3], double axes_ret[3][3])
{
    (void)body;
    double cl = cos(place[0]), sl = sin(place[0]), cp = cos(place[1]), sp = sin(place[1]);
    const double own[3][3] = {{-sl, cl, 0}, {-sp * cl, -sp * sl, cp}, {cp * cl, cp * sl, sp}};
    memcpy(axes_ret, own, sizeof own);
}

static void beside(const tc_body *body, const double from[3], const double way[3], double place_ret[3])
{
    double s = sin(from[1]), c = cos(from[1]), up = body->radius + from[2] + way[2];
    double p[3] = {c * up - s * way[1], way[0], s * up + c * way[1]}; /* of the meridian of `from` */
    place_ret[0] = from[0] + atan2(p[1], p[0]);
    place_ret[1] = atan2(p[2], hypot(p[0], p[1]));
    place_ret[2] = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - body->radius;
}

static void offset(const tc_body *body, const double place[3], const double d[3], double offset_ret[3])
{
    for (int i = 0; i < 3; i++)
        offset_ret[i] = (body->radius + place[2]) * d[i];
}

static void curvature(const tc_body *body, double latitude, double *meridian_ret, double *parallel_ret)
{
    (void)latitude;
    *meridian_ret = *parallel_ret = body->radius;
}

static void curvatures(const tc_body *body, double *least_ret, double *most_ret)
{
    *least_ret = *most_ret = body->radius;
}

static void uniforms(const tc_body *body, const double eye[3], double reference, float body_ret[TC_BODY_VECTORS][4])
{
    memset(body_ret, 0, sizeof(float[TC_BODY_VECTORS][4]));
    body_ret[0][1] = (float)cos(eye[1]), body_ret[0][2] = (float)sin(eye[1]);
    body_ret[1][0] = (float)(body->radius + reference);
    body_ret[1][1] = (float)(eye[2] - reference);
    body_ret[1][2] = (float)reference;
}

/* They must not reach the centre, nor a radius beyond the sphere, nor be none. */
static tc_status check_relief(const tc_body *body, const char *name, double z_min, double z_max, tc_error *error)
{
    if (!(z_min > -0.999 * body->radius) || !(z_max < body->radius))
        return tc_fail(error, TC_ERR_FORMAT,
                       "%s: expected heights that are small beside the radius of %.6g m, found %.6g to %.6g m; "
                       "--unit and --radius set the scale",
                       name, body->radius, z_min, z_max);
    return TC_OK;
}

static void describe(const tc_body *body, char *text, size_t size)
{
    snprintf(text, size, "radius %.10g m", body->radius);
}

const tc_body_class tc_sphere_body = {.name = "sphere",
                                      .position = position,
                                      .normal = normal,
                                      .place = place_of,
                                      .axes = axes,
                                      .beside = beside,
                                      .glsl = "body_sphere.glsl",
                                      .offset = offset,
                                      .curvature = curvature,
                                      .curvatures = curvatures,
                                      .uniforms = uniforms,
                                      .check_relief = check_relief,
                                      .solid = true,
                                      .describe = describe};

tc_body tc_body_of(double radius)
{
    return (tc_body){radius > 0 ? &tc_sphere_body : &tc_plane_body, radius, 0};
}

tc_body tc_body_flattened(double radius, double flattening)
{
    return radius > 0 && flattening > 0 ? (tc_body){&tc_ellipsoid_body, radius, flattening} : tc_body_of(radius);
}
