/* navigation_sphere.c - moving over a globe.
 *
 * Ways along the ground are great circles: heading turns on them with the meridians, so that who flies straight on over
 * a pole looks straight on behind it. Keys fly as over a flat map, the higher the faster. Places are normals: a way of
 * metres turns them by what the body's curvature says. */
#include "camera.h"
#include "flight.h"

#include <math.h>

#define DEGREE (M_PI / 180)

static void settle(tc_pose *view)
{
    view->y = fmax(-M_PI / 2, fmin(M_PI / 2, view->y));
    view->x = remainder(view->x, 2 * M_PI);
    view->z = fmax(-TC_POSE_LIMIT, fmin(TC_POSE_LIMIT, view->z));
}

/* Moves the foot point by an angle along a great circle that starts out east and north in this proportion. */
static void go(tc_pose *view, double east, double north, double angle)
{
    double length = hypot(east, north);
    if (!(length > 0) || angle == 0)
        return;
    east /= length, north /= length;
    double sy = sin(view->y), cy = cos(view->y), s = sin(angle), c = cos(angle);
    /* In the frame of the meridian: up (cy, 0, sy), east (0, 1, 0), north (-sy, 0, cy). */
    double p[3] = {cy * c - sy * north * s, east * s, sy * c + cy * north * s};
    /* Where the way goes on at its end. */
    double d[3] = {-cy * s - sy * north * c, east * c, -sy * s + cy * north * c};
    double rho = hypot(p[0], p[1]), turned = atan2(p[1], p[0]);
    double way = atan2(east, north), end;
    if (rho > 0)
        end = atan2((d[1] * p[0] - d[0] * p[1]) / rho, d[2] * rho - p[2] * (d[0] * p[0] + d[1] * p[1]) / rho);
    else
        end = way; /* on a pole: the meridian goes on */
    view->heading += end - way;
    view->x += turned;
    view->y = atan2(p[2], rho);
    settle(view);
}

/* Moves it by a way, metres east and north at a height, but by no more than this angle. */
static void move_by(tc_pose *view, const tc_body *body, double height, double east, double north, double most)
{
    double meridian, parallel;
    body->class->curvature(body, view->y, &meridian, &parallel);
    meridian += height, parallel += height;
    north *= parallel / meridian; /* as if it were as curved that way */
    go(view, east, north, fmin(hypot(east, north) / parallel, most));
}

static double highest(const tc_ground *ground, const tc_pose *view)
{
    double meridian, parallel;
    ground->body.class->curvature(&ground->body, view->y, &meridian, &parallel);
    return tc_highest_ground(ground, view->x, view->y, ground->clearance / parallel / fmax(cos(view->y), 1e-3),
                             ground->clearance / meridian);
}

static void step(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground)
{
    tc_pose *view = &flight->view;
    double move[3], above = view->z - highest(ground, view);
    tc_flight_move(flight, input, ground, above, move);
    move_by(view, &ground->body, view->z, move[0], move[1], 0.2);
    view->z += move[2];
    settle(view);
    view->z = fmax(view->z, highest(ground, view) + tc_flight_keeps(ground, above));
}

static void go_metres(const tc_body *body, tc_pose *view, double east, double north)
{
    move_by(view, body, view->z, east, north, 0.5);
}

/* The angle from a's foot point to b's, and the direction in which it starts out. */
static double arc(const tc_pose *a, const tc_pose *b, double *east_ret, double *north_ret)
{
    double along = b->x - a->x, sa = sin(a->y), ca = cos(a->y), sb = sin(b->y), cb = cos(b->y);
    *east_ret = cb * sin(along);
    *north_ret = ca * sb - sa * cb * cos(along);
    return atan2(hypot(*east_ret, *north_ret), sa * sb + ca * cb * cos(along));
}

static double apart(const tc_body *body, const tc_pose *a, const tc_pose *b)
{
    double east, north;
    return body->radius * arc(a, b, &east, &north);
}

static tc_pose between(const tc_pose *a, const tc_pose *b, double share)
{
    tc_pose view = *a;
    double east, north, angle = arc(a, b, &east, &north);
    if (!(hypot(east, north) > 0))
        north = 1; /* to the opposite point any way is the shortest */
    go(&view, east, north, share * angle);
    view.heading = a->heading;
    return view;
}

/* ---- The whole --------------------------------------------------------------------------------------------------- */

/* A view of the middle of a part of a globe, from so far, which looks so steeply down on it: the eye is on the meridian
 * of the middle, south of it; at the south pole, beyond which it would be, north of it. */
static tc_pose view_of(double longitude, double latitude, double radius, double distance, double pitch)
{
    /* In the plane of the meridian, from the middle: north and up. */
    const double POLE = -70 * DEGREE;
    const double north = -distance * cos(pitch), up = radius + distance * sin(-pitch), turned = atan2(north, up);
    return (tc_pose){.x = longitude,
                     .y = latitude < POLE ? latitude - turned : latitude + turned,
                     .heading = latitude < POLE ? M_PI : 0,
                     .z = hypot(north, up) - radius,
                     .pitch = fmax(pitch + turned, -M_PI / 2)};
}

/* Whether all of the part's sides are in the frame, and none beyond the horizon. */
static bool shows(const tc_pose *view, const tc_flight_box *box, const double t[2])
{
    enum { STEPS = 16 };
    const tc_basis axes = tc_camera_basis(&(tc_camera){.heading = view->heading, .pitch = view->pitch});
    const double eye = box->radius + view->z, sy = sin(view->y), cy = cos(view->y);
    for (int k = 0; k < 4 * STEPS; k++) {
        const double share = (double)(k % STEPS) / STEPS, side = k / STEPS % 2 ? 1 : 0;
        const double u = k < 2 * STEPS ? share : side, v = k < 2 * STEPS ? side : share;
        const double longitude = box->west + u * (box->east - box->west) - view->x,
                     latitude = box->south + v * (box->north - box->south), radius = box->radius + box->z_max;
        /* From the eye: east, north, up. */
        const double x = cos(latitude) * sin(longitude), meridian = cos(latitude) * cos(longitude), z = sin(latitude);
        const double p[3] = {radius * x, radius * (z * cy - meridian * sy), radius * (z * sy + meridian * cy) - eye};
        double right = 0, up = 0, forward = 0;
        for (int i = 0; i < 3; i++)
            right += p[i] * axes.right[i], up += p[i] * axes.up[i], forward += p[i] * axes.forward[i];
        if (!(forward > 0) || fabs(right) > t[0] * forward || fabs(up) > t[1] * forward ||
            (p[2] + eye) * eye < 0.98 * box->radius * box->radius)
            return false;
    }
    return true;
}

/* A part of a globe from the south of its middle, near enough to fill the frame. The smaller, the flatter one looks. */
static tc_pose whole_part(const tc_flight_box *box, double fov, int width, int height)
{
    const double MARGIN = 0.96, FLATTEST = -30 * DEGREE, CURVED = -60 * DEGREE; /* a radian across */
    const double tx = tan(fov / 2), t[2] = {MARGIN * tx, MARGIN * tx * height / width};
    const double middle = 0.5 * (box->south + box->north), longitude = 0.5 * (box->west + box->east);
    const double size = fmax((box->east - box->west) * cos(middle), box->north - box->south);
    const double pitch = FLATTEST + (CURVED - FLATTEST) * fmin(size, 1);
    double near = 0.2 * size * box->radius + fmax(box->z_max, 0), far = near;
    tc_pose view = view_of(longitude, middle, box->radius, far, pitch);
    for (int i = 0; i < 20 && !shows(&view, box, t); i++, far *= 1.5)
        view = view_of(longitude, middle, box->radius, far, pitch);
    for (int i = 0; i < 20; i++) {
        const double between = 0.5 * (near + far);
        const tc_pose nearer = view_of(longitude, middle, box->radius, between, pitch);
        *(shows(&nearer, box, t) ? &far : &near) = between;
    }
    view = view_of(longitude, middle, box->radius, far, pitch);
    view.z = fmax(view.z, box->z_max + 0.02 * size * box->radius);
    return view;
}

/* The globe from where its disc fills most of the frame, over the middle of what there is; a smaller part of one from
 * the south of its middle, near enough to fill the frame. */
static tc_pose whole(const tc_flight_box *box, double fov, int width, int height)
{
    double tx = tan(fov / 2), half = atan(tx * fmin(1, (double)height / width));
    double top = box->radius + fmax(box->z_max, 0);
    double wide = box->east - box->west, tall = box->north - box->south, middle = 0.5 * (box->south + box->north);
    bool around = wide > 2 * M_PI - 0.1, poles = tall > M_PI - 0.1;
    tc_pose view = {.x = around ? 20 * DEGREE : 0.5 * (box->west + box->east), .y = middle, .pitch = -M_PI / 2};
    if (around && poles)
        view.y = 25 * DEGREE;
    else if (around && fabs(middle) > 0.2) /* all of it is about one pole */
        view.y = middle > 0 ? fmin(box->north, M_PI / 2) : fmax(box->south, -M_PI / 2);
    view.z = top / sin(0.88 * half) - box->radius;
    if (around && fabs(middle) > 0.2 && tall < 1) /* from above the pole, its cap */
        view.z = fmin(view.z, box->radius * (sin(tall) / tan(0.88 * half) - (1 - cos(tall))) + fmax(box->z_max, 0));
    if (wide * cos(middle) < 1 && tall < 1 && !around)
        view = whole_part(box, fov, width, height);
    settle(&view);
    return view;
}

const tc_navigation tc_sphere_navigation = {
    .form = "LON,LAT,ALT,HEADING,PITCH",
    .bounds = "LON,LAT,ALT,HEADING,PITCH in degrees and metres, |LON| up to 360, |LAT| and |PITCH| up to 90",
    .help = "eye in degrees east and north and metres above sphere or ellipsoid (at least on the ground), degrees "
            "clockwise "
            "from north, degrees up (default: the globe)",
    .unit = DEGREE,
    .x_limit = 360,
    .y_limit = 90,
    .x_period = 2 * M_PI,
    .settle = settle,
    .whole = whole,
    .step = step,
    .go = go_metres,
    .apart = apart,
    .between = between,
    .highest = highest,
};
