/* navigation_plane.c - moving over a flat map.
 *
 * Flying speed is proportional to the height above ground: what is seen then passes at the same pace whether the eye
 * is 2 m or 20 km up, and one key takes it from one to the other in a few seconds. */
#include "flight.h"

#include "camera.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180)

static void settle(tc_pose *view)
{
    double *const position[3] = {&view->x, &view->y, &view->z};
    for (int i = 0; i < 3; i++)
        *position[i] = fmax(-TC_POSE_LIMIT, fmin(TC_POSE_LIMIT, *position[i]));
}

/* ---- The whole terrain -------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The eye, looking as given, that is as close as can be with all corners of the box in the frame.
 *
 * In the view's axes, with the eye at (e_r, e_u, e_f) and t the tangent of half the field of view, corner c is within
 * left and right of the frame where |c_r - e_r| <= t (c_f - e_f), that is, where
 *     e_r + t e_f <= a = min (c_r + t c_f)   and   e_r - t e_f >= b = max (c_r - t c_f).
 * The largest e_f with both is (a - b) / 2t, in the middle e_r = (a + b) / 2; likewise up and down. The smaller of the
 * two e_f holds for both. */
static void eye_for(const tc_flight_box *box, const tc_camera *camera, double eye[3])
{
    /* A margin of 4 % around. */
    double t[2];
    tc_camera_tangents(camera, &t[0], &t[1]);
    t[0] /= 1.04;
    t[1] /= 1.04;
    const tc_basis axes = tc_camera_basis(camera);
    double a[2] = {INFINITY, INFINITY}, b[2] = {-INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; corner++) {
        double c[3] = {corner & 1 ? box->east : box->west, corner & 2 ? box->north : box->south,
                       corner & 4 ? box->z_max : box->z_min};
        double across[2] = {dot(c, axes.right), dot(c, axes.up)}, depth = dot(c, axes.forward);
        for (int i = 0; i < 2; i++) {
            a[i] = fmin(a[i], across[i] + t[i] * depth);
            b[i] = fmax(b[i], across[i] - t[i] * depth);
        }
    }
    double right = (a[0] + b[0]) / 2, up = (a[1] + b[1]) / 2;
    double forward = fmin((a[0] - b[0]) / (2 * t[0]), (a[1] - b[1]) / (2 * t[1]));
    for (int i = 0; i < 3; i++)
        eye[i] = right * axes.right[i] + up * axes.up[i] + forward * axes.forward[i];
}

static tc_pose whole(const tc_flight_box *box, double fov, int width, int height)
{
    /* A terrain of one sample has no size; any will do then. */
    tc_flight_box b = *box;
    double size = fmax(fmax(b.east - b.west, b.north - b.south), b.z_max - b.z_min);
    if (!(size > 0))
        size = 1;
    b.east = fmax(b.east, b.west + 1e-3 * size);
    b.north = fmax(b.north, b.south + 1e-3 * size);
    tc_pose view = {0};
    /* From a corner, so that two sides are seen. The flatter the terrain, the flatter one looks at it: relief is seen
     * against what is behind it. Steeper where it is so tall for its area that the eye would sit below its top.
     * Straight down it never does, so the loop ends. */
    const double HEADING = 24, FLATTEST = -21, STEEPEST = -31, TALL = 0.06; /* degrees; of the size */
    const double tall = fmin((b.z_max - b.z_min) / size / TALL, 1);
    for (double pitch = FLATTEST + (STEEPEST - FLATTEST) * tall; pitch >= -90;
         pitch = pitch > -90 ? fmax(pitch - 5, -90) : -91) {
        const tc_camera camera = {
            .heading = HEADING * DEGREE, .pitch = pitch * DEGREE, .fov = fov, .width = width, .height = height};
        double eye[3];
        eye_for(&b, &camera, eye);
        view = (tc_pose){eye[0], eye[1], eye[2], HEADING * DEGREE, pitch * DEGREE};
        if (view.z > b.z_max + 0.05 * size)
            break;
    }
    view.z = fmax(view.z, b.z_max + 0.05 * size);
    settle(&view);
    return view;
}

/* ---- Free flight -------------------------------------------------------------------------------------------- */

static double highest(const tc_ground *ground, const tc_pose *view)
{
    return tc_highest_ground(ground, view->x, view->y, ground->clearance, ground->clearance);
}

static void step(tc_flight *flight, const tc_flight_input *input, const tc_ground *ground)
{
    tc_pose *view = &flight->view;
    double move[3], above = view->z - highest(ground, view);
    tc_flight_move(flight, input, ground, above, move);
    view->x += move[0];
    view->y += move[1];
    view->z += move[2];
    settle(view);
    view->z = fmax(view->z, highest(ground, view) + tc_flight_keeps(ground, above));
}

static void go(const tc_body *body, tc_pose *view, double east, double north)
{
    (void)body;
    view->x += east;
    view->y += north;
}

static double apart(const tc_body *body, const tc_pose *a, const tc_pose *b)
{
    (void)body;
    return hypot(b->x - a->x, b->y - a->y);
}

static tc_pose between(const tc_pose *a, const tc_pose *b, double share)
{
    tc_pose view = *a;
    view.x += share * (b->x - a->x);
    view.y += share * (b->y - a->y);
    return view;
}

const tc_navigation tc_plane_navigation = {
    .form = "X,Y,Z,HEADING,PITCH",
    .bounds = "X,Y,Z,HEADING,PITCH in metres up to 1e12 and degrees, |PITCH| up to 90",
    .help = "eye in metres from the south-west sample, degrees clockwise from north, degrees up (default: all of the "
            "terrain)",
    .unit = 1,
    .x_limit = TC_POSE_LIMIT,
    .y_limit = TC_POSE_LIMIT,
    .settle = settle,
    .whole = whole,
    .step = step,
    .go = go,
    .apart = apart,
    .between = between,
    .highest = highest,
};
