/* ellipsoid.c - an ellipsoid of revolution as a body: a sphere that is flattened at the poles.
 *
 * With the unit normal n, semi-axes a and b, e^2 = 1 - b^2/a^2 and the axis k, the place of height z is
 *     P(n) + z n,  P(n) = N (n - e^2 n_z k),  N = a / W,  W = sqrt(1 - e^2 n_z^2)
 * N is the radius of curvature along the parallel, M = a (1 - e^2) / W^3 that along the meridian. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "body.h"
#include "common/base/status.h"

static double squared_eccentricity(const tc_body *body)
{
    return body->flattening * (2 - body->flattening);
}

/* W at a sine of latitude. */
static double root(const tc_body *body, double sine)
{
    return sqrt(1 - squared_eccentricity(body) * sine * sine);
}

/* ---- Places ------------------------------------------------------------------------------------------------------ */

/* Of the meridian: how far from the axis, and along it. */
static void in_meridian(const tc_body *body, double latitude, double z, double p_ret[2])
{
    double s = sin(latitude), c = cos(latitude), n = body->radius / root(body, s);
    p_ret[0] = (n + z) * c;
    p_ret[1] = ((1 - squared_eccentricity(body)) * n + z) * s;
}

static void normal(const tc_body *body, const double place[3], double n_ret[3])
{
    tc_sphere_body.normal(body, place, n_ret);
}

static void axes(const tc_body *body, const double place[3], double axes_ret[3][3])
{
    tc_sphere_body.axes(body, place, axes_ret);
}

static void position(const tc_body *body, const double place[3], double p_ret[3])
{
    double m[2];
    in_meridian(body, place[1], place[2], m);
    p_ret[0] = m[0] * cos(place[0]);
    p_ret[1] = m[0] * sin(place[0]);
    p_ret[2] = m[1];
}

/* Latitude and height of a point of the meridian, `across` >= 0 from the axis. Its nearest point on the ellipse is
 * (a^2 x / (t + a^2), b^2 z / (t + b^2)) with the t at which F(t) = (a x / (t + a^2))^2 + (b z / (t + b^2))^2 - 1 is 0
 * (Eberly). F falls and is convex from -b^2 on, so that Newton's method from the left comes up to it without
 * overshooting; in units of a. Without any approximation near the surface it is as good far away, and deep inside. */
static void from_meridian(const tc_body *body, double across, double along, double *latitude_ret, double *z_ret)
{
    enum { MOST = 100 };
    const double b = 1 - body->flattening, b2 = b * b, x = across / body->radius, z = fabs(along) / body->radius;
    /* Where one of the two terms alone is 1 the sum is above it, and both roots are left of it. */
    double t = fmax(x - 1, b * z - b2);
    for (int k = 0; k < MOST; k++) {
        double u = x / (t + 1), v = t + b2 > 0 ? b * z / (t + b2) : 0; /* v is 1 there or z is 0 */
        double slope = -2 * (u * u / (t + 1) + (t + b2 > 0 ? v * v / (t + b2) : 0));
        double next = slope < 0 ? t - (u * u + v * v - 1) / slope : t;
        if (!(next > t)) /* it is there, but for a rounding */
            break;
        t = next;
    }
    double n[2] = {x / (t + 1), t + b2 > 0 ? z / (t + b2) : 0};
    if (!(t + b2 > 0)) /* in the plane of the equator, so deep that the nearest points are north and south of it */
        n[1] = sqrt(fmax(1 - n[0] * n[0], 0)) / b;
    const double length = hypot(n[0], n[1]);
    *latitude_ret = copysign(atan2(n[1], n[0]), along);
    *z_ret = t * length * body->radius;
}

/* The least and the most radius of curvature, both of meridians: at the equator, and at the poles. */
static void curvatures(const tc_body *body, double *least_ret, double *most_ret)
{
    const double b = 1 - body->flattening;
    *least_ret = body->radius * b * b;
    *most_ret = body->radius / b;
}

static bool place_of(const tc_body *body, const double p[3], double place_ret[3])
{
    double least, most;
    curvatures(body, &least, &most);
    place_ret[0] = atan2(p[1], p[0]);
    from_meridian(body, hypot(p[0], p[1]), p[2], &place_ret[1], &place_ret[2]);
    return place_ret[2] > -0.5 * least; /* normals meet from `least` on */
}

static void beside(const tc_body *body, const double from[3], const double way[3], double place_ret[3])
{
    double s = sin(from[1]), c = cos(from[1]), m[2];
    in_meridian(body, from[1], from[2], m);
    double p[3] = {m[0] + c * way[2] - s * way[1], way[0], m[1] + s * way[2] + c * way[1]};
    place_ret[0] = from[0] + atan2(p[1], p[0]);
    from_meridian(body, hypot(p[0], p[1]), p[2], &place_ret[1], &place_ret[2]);
}

/* ---- Around a place ---------------------------------------------------------------------------------------------- */

/* P(n) - P(n_v) = N (d - e^2 d_z k) + (N - N_v) (n_v - e^2 n_vz k), of which with h = N - N_v
 *     h = N_v e^2 d_z (n_z + n_vz) / (W (W + W_v))
 * has no cancellation. Heights add z d. */
static void offset(const tc_body *body, const double place[3], const double d[3], double offset_ret[3])
{
    const double e2 = squared_eccentricity(body), s = sin(place[1]), c = cos(place[1]);
    const double dz = c * d[1] + s * d[2], nz = s + dz, w = root(body, nz), wv = root(body, s);
    const double nv = body->radius / wv, more = nv * e2 * dz * (nz + s) / (w * (w + wv));
    const double radius = nv + place[2] + more, along = e2 * ((nv + more) * dz + s * more);
    offset_ret[0] = radius * d[0];
    offset_ret[1] = radius * d[1] - along * c;
    offset_ret[2] = radius * d[2] - along * s + more;
}

static void curvature(const tc_body *body, double latitude, double *meridian_ret, double *parallel_ret)
{
    const double w = root(body, sin(latitude));
    *meridian_ret = body->radius * (1 - squared_eccentricity(body)) / (w * w * w);
    *parallel_ret = body->radius / w;
}

/* The eye is also told in a space that is stretched along the axis by a / b, in which the body is a sphere. */
static void uniforms(const tc_body *body, const double eye[3], double reference, float body_ret[TC_BODY_VECTORS][4])
{
    const double s = sin(eye[1]), c = cos(eye[1]), wv = root(body, s), stretch = 1 / (1 - body->flattening);
    double m[2];
    in_meridian(body, eye[1], eye[2], m);
    const double across = m[0], along = m[1] * stretch;
    const double all[TC_BODY_VECTORS][4] = {{0, c, s, squared_eccentricity(body)},
                                            {body->radius / wv + reference, eye[2] - reference, reference, wv},
                                            {across * -s + along * c, across * c + along * s, stretch, body->radius}};
    for (int i = 0; i < TC_BODY_VECTORS; i++)
        for (int k = 0; k < 4; k++)
            body_ret[i][k] = (float)all[i][k];
}

/* ---- The rest ---------------------------------------------------------------------------------------------------- */

/* They must not reach where normals meet, nor a radius beyond the ellipsoid, nor be none. */
static tc_status check_relief(const tc_body *body, const char *name, double z_min, double z_max, tc_error *error)
{
    double least, most;
    curvatures(body, &least, &most);
    if (!(z_min > -0.999 * least) || !(z_max < body->radius))
        return tc_fail(
            error, TC_ERR_FORMAT,
            "%s: expected heights that are small beside the radii of curvature of %.6g to %.6g m, found %.6g "
            "to %.6g m; --unit and --ellipsoid set the scale",
            name, least, most, z_min, z_max);
    return TC_OK;
}

static void describe(const tc_body *body, char *text, size_t size)
{
    snprintf(text, size, "semi-major axis %.10g m, flattening 1/%.10g", body->radius, 1 / body->flattening);
}

const tc_body_class tc_ellipsoid_body = {.name = "ellipsoid",
                                         .like = &tc_sphere_body,
                                         .glsl = "body_ellipsoid.glsl",
                                         .position = position,
                                         .normal = normal,
                                         .place = place_of,
                                         .axes = axes,
                                         .beside = beside,
                                         .offset = offset,
                                         .curvature = curvature,
                                         .curvatures = curvatures,
                                         .uniforms = uniforms,
                                         .check_relief = check_relief,
                                         .solid = true,
                                         .describe = describe};
