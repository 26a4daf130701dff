/* hold.c - a point of the ground is held at a pixel; see hold.h.
 *
 * Two unknowns (metres east and north, or heading and pitch) for two numbers (the pixel's place): Newton's method with
 * differences as derivatives, in steps of at most some pixels. It knows nothing of the body. */
#include "hold.h"

#include <math.h>

static const double CLOSE = 0.02;                              /* pixels that count as there */
static const double POLAR = 75 * 3.14159265358979323846 / 180; /* latitude from which on headings turn with meridians */
static const double LEAST_SINE = 1e-4;

double tc_hold_distance(const tc_scenery *scenery, const tc_pose *view, const double p[3], double *sine_ret)
{
    const tc_body *body = &scenery->ground->body;
    double eye[3], place[3], up[3], along = 0, distance = 0;
    body->class->position(body, (double[3]){view->x, view->y, view->z}, eye);
    if (!body->class->place(body, p, place)) {
        *sine_ret = -1;
        return 0;
    }
    body->class->normal(body, place, up);
    for (int i = 0; i < 3; i++)
        along += up[i] * (eye[i] - p[i]), distance += (eye[i] - p[i]) * (eye[i] - p[i]);
    distance = sqrt(distance);
    *sine_ret = distance > 0 ? along / distance : 1;
    return distance;
}

/* ---- Two unknowns ------------------------------------------------------------------------------------------------ */

typedef struct unknowns {
    void (*change)(const tc_scenery *scenery, tc_pose *view, double a, double b);
    double least_sine; /* p must be seen at least so steeply; -1: anyhow */
} unknowns;

/* As great circles do. */
static void by_going(const tc_scenery *scenery, tc_pose *view, double east, double north)
{
    double z = view->z;
    scenery->navigation->go(&scenery->ground->body, view, east, north);
    view->z = z;
}

/* North stays where it is in the frame. */
static void by_moving(const tc_scenery *scenery, tc_pose *view, double east, double north)
{
    double heading = view->heading;
    by_going(scenery, view, east, north);
    view->heading = heading;
}

static void by_turning(const tc_scenery *scenery, tc_pose *view, double right, double up)
{
    (void)scenery;
    view->heading += right;
    view->pitch = fmax(-M_PI / 2, fmin(M_PI / 2, view->pitch + up));
}

/* How far p is from the pixel. False where it is not seen as it must be. */
static bool miss(const tc_scenery *scenery, const unknowns *u, const double p[3], const double pixel[2],
                 const tc_pose *view, double miss_ret[2])
{
    double x, y, sine = 1;
    if (u->least_sine > -1)
        tc_hold_distance(scenery, view, p, &sine);
    if (!(sine >= u->least_sine) || !tc_pixel_of(scenery, view, p, &x, &y))
        return false;
    miss_ret[0] = pixel[0] - x, miss_ret[1] = pixel[1] - y;
    return true;
}

/* One of Newton's steps, shortened until it helps. */
static bool improve(const tc_scenery *scenery, const unknowns *u, const double p[3], const double pixel[2], double unit,
                    tc_pose *view, double off[2])
{
    double column[2][2];
    for (int k = 0; k < 2; k++) {
        tc_pose probe = *view;
        double there[2];
        u->change(scenery, &probe, k == 0 ? unit : 0, k == 1 ? unit : 0);
        double x, y, x0, y0;
        if (!tc_pixel_of(scenery, &probe, p, &x, &y) || !tc_pixel_of(scenery, view, p, &x0, &y0))
            return false;
        there[0] = x - x0, there[1] = y - y0;
        column[k][0] = there[0], column[k][1] = there[1];
    }
    double determinant = column[0][0] * column[1][1] - column[1][0] * column[0][1];
    if (!(fabs(determinant) > 0))
        return false;
    double a = (off[0] * column[1][1] - off[1] * column[1][0]) / determinant;
    double b = (off[1] * column[0][0] - off[0] * column[0][1]) / determinant;
    for (int k = 0; k < 12; k++, a /= 2, b /= 2) {
        tc_pose probe = *view;
        double there[2];
        u->change(scenery, &probe, a * unit, b * unit);
        if (miss(scenery, u, p, pixel, &probe, there) && hypot(there[0], there[1]) < hypot(off[0], off[1])) {
            *view = probe;
            off[0] = there[0], off[1] = there[1];
            return true;
        }
    }
    return false;
}

static bool solve(const tc_scenery *scenery, const unknowns *u, const double p[3], double x, double y, double unit,
                  tc_pose *view)
{
    enum { MOST = 40 };
    const double pixel[2] = {x, y};
    double off[2];
    if (!miss(scenery, u, p, pixel, view, off))
        return false;
    for (int i = 0; i < MOST && hypot(off[0], off[1]) > CLOSE; i++)
        if (!improve(scenery, u, p, pixel, unit, view, off))
            break;
    return hypot(off[0], off[1]) <= 0.1;
}

bool tc_keep_above(const tc_scenery *scenery, double keeps, tc_pose *view)
{
    double low = scenery->navigation->highest(scenery->ground, view) + keeps;
    if (!(view->z < low))
        return false;
    view->z = low;
    return true;
}

bool tc_hold_by_moving(const tc_scenery *scenery, const double p[3], double x, double y, double sine, double keeps,
                       tc_pose *view)
{
    const unknowns moving = {by_moving, fmax(LEAST_SINE, sine)}, going = {by_going, moving.least_sine};
    const bool polar = scenery->navigation->x_period > 0 && fabs(view->y) > POLAR;
    bool there = false;
    /* Lifted out of a slope that was moved into, the eye stands elsewhere. */
    for (int tries = 0; tries < 4; tries++) {
        double unused, distance = tc_hold_distance(scenery, view, p, &unused);
        const tc_pose before = *view;
        there = !polar && solve(scenery, &moving, p, x, y, 1e-4 * distance, view);
        if (!there) { /* close to a pole there may be no such place */
            *view = before;
            there = solve(scenery, &going, p, x, y, 1e-4 * distance, view);
        }
        if (!tc_keep_above(scenery, keeps, view))
            break;
        there = false;
    }
    scenery->navigation->settle(view);
    return there;
}

bool tc_hold_by_turning(const tc_scenery *scenery, const double p[3], double x, double y, tc_pose *view)
{
    const unknowns turning = {by_turning, -1};
    return solve(scenery, &turning, p, x, y, 1e-4, view);
}
