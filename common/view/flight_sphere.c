/* flight_sphere.c - Catmull-Rom curves on the sphere of normals, so over any globe.
 *
 * Foot points: the curve of flight_path.c between p1 and p2 is the Bezier curve with the inner points
 * p1 + (p2 - p0) / 6 and p2 - (p3 - p1) / 6. Here differences are arcs, taken at the point where they begin, and de
 * Casteljau's construction goes along arcs, too. Evenly spaced keys on a great circle then make an even flight on it,
 * over a pole as anywhere.
 *
 * Headings: as numbers they jump at a pole, and turn with the meridians elsewhere. A direction is carried along arcs
 * from key to key instead, which keeps the angle to them, and what is interpolated, as in flight_path.c, are the
 * angles that keys turn away from it. */
#include "flight_sphere.h"

#include <math.h>

typedef struct vector {
    double x, y, z;
} vector;

static vector add_scaled(vector a, double s, vector b)
{
    return (vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static double dot(vector a, vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector cross(vector a, vector b)
{
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static vector scaled(double s, vector a)
{
    return (vector){s * a.x, s * a.y, s * a.z};
}

/* ---- Foot points ------------------------------------------------------------------------------------------------ */

static vector foot_of(const tc_pose *view)
{
    return (vector){cos(view->y) * cos(view->x), cos(view->y) * sin(view->x), sin(view->y)};
}

static vector east_at(double longitude)
{
    return (vector){-sin(longitude), cos(longitude), 0};
}

/* The arc from one unit vector to another: a tangent at the first one, as long as the angle. Between opposite points
 * any will do; it starts out east, as far as there is one. */
static vector arc(vector from, vector to)
{
    vector axis = cross(from, to), tangent = cross(axis, from);
    double sine = sqrt(dot(axis, axis)), cosine = dot(from, to);
    if (sine > 1e-12)
        return scaled(atan2(sine, cosine) / sine, tangent);
    return cosine > 0 ? (vector){0} : scaled(M_PI, east_at(atan2(from.y, from.x)));
}

/* Where an arc ends. */
static vector go(vector from, vector arc)
{
    double angle = sqrt(dot(arc, arc));
    if (!(angle > 0))
        return from;
    vector to = add_scaled(scaled(cos(angle), from), sin(angle) / angle, arc);
    return scaled(1 / sqrt(dot(to, to)), to);
}

/* The same arc the other way: a tangent at its end. */
static vector way_back(vector from, vector arc)
{
    double angle = sqrt(dot(arc, arc));
    return add_scaled(scaled(angle * sin(angle), from), -cos(angle), arc);
}

static vector between(vector from, vector to, double t)
{
    return go(from, scaled(t, arc(from, to)));
}

/* ---- Directions ------------------------------------------------------------------------------------------------- */

/* Where a view looks, along the ground. On a pole east is what it is along the view's meridian. */
static vector direction_of(const tc_pose *view)
{
    vector east = east_at(view->x), north = cross(foot_of(view), east);
    return add_scaled(scaled(sin(view->heading), east), cos(view->heading), north);
}

/* Carries a direction along the arc from one point to another: opposite ones keep it. */
static vector carry(vector direction, vector from, vector to)
{
    double both = 1 + dot(from, to);
    vector way = add_scaled(from, 1, to);
    return both > 1e-12 ? add_scaled(direction, -dot(direction, to) / both, way) : direction;
}

/* The angle, clockwise, by which `to` is turned away from `from`, both directions at a point. */
static double turned(vector point, vector from, vector to)
{
    return atan2(dot(cross(to, from), point), dot(from, to));
}

/* The angle by which a key is turned away from the one before, carried to it. */
static double turned_between(const tc_pose *before, const tc_pose *key)
{
    vector foot = foot_of(key);
    return turned(foot, carry(direction_of(before), foot_of(before), foot), direction_of(key));
}

/* The heading at a point of what is turned by an angle away from a key's direction, carried there. */
static double heading_at(vector point, double longitude, const tc_pose *key, double angle)
{
    vector east = east_at(longitude), north = cross(point, east);
    vector direction = carry(direction_of(key), foot_of(key), point);
    return atan2(dot(direction, east), dot(direction, north)) + angle;
}

double tc_catmull_rom(double p0, double p1, double p2, double p3, double t)
{
    return p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)));
}

/* ---- Both ------------------------------------------------------------------------------------------------------- */

void tc_flight_on_sphere(const tc_pose key[4], bool begins, bool ends, double t, tc_pose *view)
{
    vector p[4];
    for (int k = 0; k < 4; k++)
        p[k] = foot_of(&key[k]);
    vector there = arc(p[1], p[2]), back = way_back(p[1], there);
    vector before = begins ? scaled(-1, there) : arc(p[1], p[0]), after = ends ? scaled(-1, back) : arc(p[2], p[3]);
    vector b[4] = {p[1], go(p[1], scaled(1. / 6, add_scaled(there, -1, before))),
                   go(p[2], scaled(1. / 6, add_scaled(back, -1, after))), p[2]};
    for (int count = 3; count > 0; count--)
        for (int k = 0; k < count; k++)
            b[k] = between(b[k], b[k + 1], t);
    view->x = atan2(b[0].y, b[0].x);
    view->y = atan2(b[0].z, hypot(b[0].x, b[0].y));

    double step = turned_between(&key[1], &key[2]);
    double first = begins ? -step : -turned_between(&key[0], &key[1]),
           last = step + (ends ? step : turned_between(&key[2], &key[3])),
           angle = tc_catmull_rom(first, 0, step, last, t);
    /* The curve is not the arc, and around an area directions turn: from either key it is another one. Each counts
     * where it is near, so that turning is smooth from stretch to stretch. */
    double from = heading_at(b[0], view->x, &key[1], angle), to = heading_at(b[0], view->x, &key[2], angle - step);
    view->heading = from + t * t * (3 - 2 * t) * remainder(to - from, 2 * M_PI);
}
