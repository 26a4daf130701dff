/* look_at.c - views of a place. */
#include "look_at.h"

#include "camera.h"

#include <math.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void tc_look_towards(const tc_body *body, const double place[3], tc_pose *view)
{
    const double here[3] = {view->x, view->y, view->z};
    double from[3], to[3], axes[3][3], way[3], along[3];
    body->class->position(body, here, from);
    body->class->position(body, place, to);
    body->class->axes(body, here, axes);
    for (int i = 0; i < 3; i++)
        way[i] = to[i] - from[i];
    for (int i = 0; i < 3; i++)
        along[i] = dot(way, axes[i]);
    const double across = hypot(along[0], along[1]), length = hypot(across, along[2]);
    if (!(length > 0))
        return;
    view->pitch = atan2(along[2], across);
    if (across > 1e-9 * length) /* straight up or down any heading will do */
        view->heading = atan2(along[0], along[1]);
}

tc_pose tc_look_at(const tc_body *body, const double place[3], double heading, double pitch, double distance)
{
    const tc_basis axes = tc_camera_basis(&(tc_camera){.heading = heading, .pitch = pitch});
    double way[3], eye[3];
    for (int i = 0; i < 3; i++)
        way[i] = -distance * axes.forward[i];
    body->class->beside(body, place, way, eye);
    tc_pose view = {eye[0], eye[1], eye[2], heading, pitch};
    if (distance > 1e-6 * body->radius && body->radius > 0) /* nearer the horizons are one, and digits are few */
        tc_look_towards(body, place, &view);
    return view;
}
