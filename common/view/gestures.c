/* gestures.c - moving a view by the mouse; see gestures.h. */
#include "gestures.h"

#include "camera.h"
#include "hold.h"

#include <math.h>
#include <string.h>

static const double GRAZING = 0.12; /* sine of the angle below which ground turns the view instead of being pulled, */
static const double PULLED = 0.03;  /* and down to which a pull goes on */
static const double GLOBE_DIP =
    0.35;                           /* sine of the horizon's dip from which on a globe is seen as one: nothing turns */
static const double NOTCH = 0.2231; /* ln 1.25: a notch brings nearer by a fifth of the distance */
static const double DOUBLE_SECONDS = 0.35, DOUBLE_PIXELS = 6;
static const double COAST_SECONDS = 0.35, ZOOM_SECONDS = 0.09, NORTH_SECONDS = 0.12; /* to a part in e */

static double keeps(const tc_scenery *scenery, const tc_pose *view)
{
    return tc_flight_keeps(scenery->ground, view->z - scenery->navigation->highest(scenery->ground, view));
}

static void position(const tc_scenery *scenery, const tc_pose *view, double p_ret[3])
{
    const tc_body *body = &scenery->ground->body;
    body->class->position(body, (double[3]){view->x, view->y, view->z}, p_ret);
}

/* Whether the eye is so far from a globe that it sees it as a ball. */
static bool sees_a_ball(const tc_scenery *scenery, const tc_pose *view)
{
    double r = scenery->ground->body.radius, c = r / (r + fmax(view->z, 0));
    return r > 0 && c * c < 1 - GLOBE_DIP * GLOBE_DIP;
}

/* Holds p at the pointer; what a pull cannot do for the horizon, turning does. */
static bool hold(const tc_scenery *scenery, tc_gesture how, const double p[3], double x, double y, tc_pose *view)
{
    if (how == TC_GESTURE_TURN)
        return tc_hold_by_turning(scenery, p, x, y, view);
    bool ball = sees_a_ball(scenery, view);
    bool there = tc_hold_by_moving(scenery, p, x, y, ball ? 0 : PULLED, keeps(scenery, view), view);
    return there || (!ball && tc_hold_by_turning(scenery, p, x, y, view));
}

/* How a point of the ground is to be held. */
static tc_gesture hold_for(const tc_scenery *scenery, const tc_pose *view, const double p[3])
{
    double sine;
    tc_hold_distance(scenery, view, p, &sine);
    return sine < GRAZING && !sees_a_ball(scenery, view) ? TC_GESTURE_TURN : TC_GESTURE_PULL;
}

/* ---- Pulling, and running on ------------------------------------------------------------------------------------- */

static void track(tc_gestures *g, const tc_pointer_event *e)
{
    if (g->tracked == TC_GESTURE_TRACK)
        memmove(g->track, g->track + 1, (size_t)--g->tracked * sizeof *g->track);
    g->track[g->tracked++] = (struct tc_gesture_sample){e->x, e->y, e->seconds};
}

/* Takes hold of the ground; near it also of the sky, which is far away. */
static void begin_pull(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, const tc_pose *view)
{
    double ray[3];
    tc_gestures_rest(g);
    if (tc_pick(scenery, view, e->x, e->y, g->held)) {
        g->gesture = hold_for(scenery, view, g->held);
    } else if (!sees_a_ball(scenery, view)) {
        g->gesture = TC_GESTURE_TURN;
        position(scenery, view, g->held);
        tc_pixel_ray(scenery, view, e->x, e->y, ray);
        for (int i = 0; i < 3; i++)
            g->held[i] += scenery->far * ray[i];
    }
    g->x = e->x, g->y = e->y;
    g->tracked = 0;
    track(g, e);
}

/* Let go: with the speed of the last moment, if there was any. */
static void end_pull(tc_gestures *g, const tc_pointer_event *e)
{
    static const double MOMENT = 0.12, REST = 0.08; /* seconds */
    static const double LEAST = 40, MOST = 5000;    /* pixels a second */
    int first = g->tracked - 1;
    while (first > 0 && e->seconds - g->track[first - 1].seconds < fmax(MOMENT, 2.5 * g->frame))
        first--;
    const struct tc_gesture_sample *begin = &g->track[first], *last = &g->track[g->tracked - 1];
    double took = last->seconds - begin->seconds;
    if (!(took > 0) || e->seconds - last->seconds > fmax(REST, 1.5 * g->frame)) {
        tc_gestures_rest(g);
        return;
    }
    g->vx = (last->x - begin->x) / took, g->vy = (last->y - begin->y) / took;
    double speed = hypot(g->vx, g->vy);
    if (speed < LEAST) {
        tc_gestures_rest(g);
        return;
    }
    g->vx *= fmin(1, MOST / speed), g->vy *= fmin(1, MOST / speed);
    g->coasting = true;
}

static void coast(tc_gestures *g, const tc_scenery *scenery, double dt, tc_pose *view)
{
    static const double SLOW = 6; /* pixels a second that count as rest */
    double slower = exp(-dt / COAST_SECONDS), way = COAST_SECONDS * (1 - slower);
    g->x += g->vx * way, g->y += g->vy * way;
    g->vx *= slower, g->vy *= slower;
    if (!hold(scenery, g->gesture, g->held, g->x, g->y, view) || hypot(g->vx, g->vy) < SLOW)
        tc_gestures_rest(g);
}

/* ---- About a point ------------------------------------------------------------------------------------------------
 */

/* Heading and pitch of a direction in space by axes; straight up and down, where there is none, by what is up in the
 * frame. */
static void angles_of(double axes[3][3], const double way[3], const double up[3], double *heading_ret,
                      double *pitch_ret)
{
    double w[3] = {0}, u[3] = {0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            w[k] += axes[k][i] * way[i], u[k] += axes[k][i] * up[i];
    double level = hypot(w[0], w[1]);
    *pitch_ret = atan2(w[2], level);
    double sign = w[2] > 0 ? -1 : 1;
    *heading_ret = level > 1e-4 ? atan2(w[0], w[1]) : atan2(sign * u[0], sign * u[1]);
}

/* What is up in a view's frame and what forward, in space. */
static void directions(const tc_pose *view, double axes[3][3], double up_ret[3], double forward_ret[3])
{
    const tc_basis basis = tc_camera_basis(&(tc_camera){.heading = view->heading, .pitch = view->pitch});
    for (int i = 0; i < 3; i++) {
        up_ret[i] = basis.up[0] * axes[0][i] + basis.up[1] * axes[1][i] + basis.up[2] * axes[2][i];
        forward_ret[i] = basis.forward[0] * axes[0][i] + basis.forward[1] * axes[1][i] + basis.forward[2] * axes[2][i];
    }
}

static void axes_at(const tc_scenery *scenery, const double place[3], double axes_ret[3][3])
{
    const tc_body *body = &scenery->ground->body;
    body->class->axes(body, place, axes_ret);
}

static void begin_orbit(tc_gestures *g, const tc_scenery *scenery, const tc_pose *view, tc_gesture gesture)
{
    const tc_body *body = &scenery->ground->body;
    double place[3], axes[3][3], eye[3], way[3], up[3], sine;
    tc_gestures_rest(g);
    g->heading = view->heading, g->pitch = view->pitch, g->distance = 0;
    if (!tc_pick(scenery, view, 0.5 * scenery->width, 0.5 * scenery->height, g->held) ||
        !body->class->place(body, g->held, place)) {
        g->gesture = gesture == TC_GESTURE_ORBIT ? TC_GESTURE_LOOK : gesture;
        return;
    }
    g->gesture = gesture;
    g->distance = tc_hold_distance(scenery, view, g->held, &sine);
    position(scenery, view, eye);
    axes_at(scenery, (double[3]){view->x, view->y, view->z}, axes);
    directions(view, axes, up, way);
    for (int i = 0; i < 3; i++)
        way[i] = g->held[i] - eye[i];
    axes_at(scenery, place, axes);
    angles_of(axes, way, up, &g->heading, &g->pitch);
}

/* Puts the eye where the angles about the point say; without one, turns it. */
static void place_orbit(tc_gestures *g, const tc_scenery *scenery, tc_pose *view)
{
    const tc_body *body = &scenery->ground->body;
    double place[3], axes[3][3], eye[3], way[3], up[3];
    const tc_pose seen = {.heading = g->heading, .pitch = g->pitch};
    double keep = keeps(scenery, view);
    if (!(g->distance > 0)) {
        view->heading = g->heading, view->pitch = g->pitch;
        return;
    }
    body->class->place(body, g->held, place);
    axes_at(scenery, place, axes);
    directions(&seen, axes, up, way);
    for (int i = 0; i < 3; i++)
        eye[i] = g->held[i] - g->distance * way[i];
    if (!body->class->place(body, eye, place))
        return;
    view->x = place[0], view->y = place[1], view->z = place[2];
    axes_at(scenery, place, axes);
    angles_of(axes, way, up, &view->heading, &view->pitch);
    scenery->navigation->settle(view);
    if (tc_keep_above(scenery, keep, view))
        tc_hold_by_turning(scenery, g->held, 0.5 * scenery->width, 0.5 * scenery->height, view);
}

static void drag_orbit(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, tc_pose *view)
{
    const double across = M_PI / scenery->width, down = M_PI / 2 / scenery->height; /* radians a pixel */
    const double least = -M_PI / 2, most = g->distance > 0 ? -0.02 : M_PI / 2;
    double x = e->x - g->x, y = e->y - g->y;
    g->x = e->x, g->y = e->y;
    g->heading += across * x;
    g->pitch = fmax(least, fmin(fmax(most, g->pitch), g->pitch - down * y));
    place_orbit(g, scenery, view);
}

static void turn_north(tc_gestures *g, const tc_scenery *scenery, double dt, tc_pose *view)
{
    static const double CLOSE = 1e-3;
    g->heading = remainder(g->heading, 2 * M_PI) * exp(-dt / NORTH_SECONDS);
    bool there = fabs(g->heading) < CLOSE;
    if (there)
        g->heading = 0;
    place_orbit(g, scenery, view);
    if (there) {
        view->heading = 0;
        tc_gestures_rest(g);
    }
}

/* ---- Nearer -------------------------------------------------------------------------------------------------------
 */

static void begin_zoom(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, const tc_pose *view)
{
    static const double SAME = 3; /* pixels */
    if (g->gesture == TC_GESTURE_FLY || g->gesture == TC_GESTURE_NORTH || g->coasting)
        tc_gestures_rest(g);
    if (g->zoom == 0 || hypot(e->x - g->zoom_x, e->y - g->zoom_y) > SAME) {
        g->zoom_x = e->x, g->zoom_y = e->y;
        g->zoom_grounded = tc_pick(scenery, view, e->x, e->y, g->zoom_at);
    }
    g->zoom -= NOTCH * e->wheel;
}

/* What is approached where the pointer is on the sky: as far ahead as the ground is below; seen as a ball, that below.
 */
static void point_ahead(const tc_scenery *scenery, const tc_pose *view, double x, double y, double p_ret[3])
{
    const tc_body *body = &scenery->ground->body;
    double low = scenery->ground->height(scenery->ground->context, view->x, view->y), ray[3];
    if (sees_a_ball(scenery, view)) {
        body->class->position(body, (double[3]){view->x, view->y, low}, p_ret);
        return;
    }
    position(scenery, view, p_ret);
    tc_pixel_ray(scenery, view, x, y, ray);
    for (int i = 0; i < 3; i++)
        p_ret[i] += fmax(view->z - low, scenery->ground->clearance) * ray[i];
}

/* The eye goes along the line from p to this share of its distance. */
static void go_along(const tc_scenery *scenery, const double p[3], double share, tc_pose *view)
{
    const tc_body *body = &scenery->ground->body;
    double eye[3], place[3];
    position(scenery, view, eye);
    for (int i = 0; i < 3; i++)
        eye[i] = p[i] + share * (eye[i] - p[i]);
    if (!body->class->place(body, eye, place))
        return;
    view->x = place[0], view->y = place[1], view->z = place[2];
    scenery->navigation->settle(view);
}

/* To a share of the distance to what the wheel approaches. Far above a globe the eye's vertical turns on its way, and
 * what holds the point at its pixel again changes the distance: how far to go along the line is found by the secant
 * method. */
static void approach(tc_gestures *g, const tc_scenery *scenery, double share, tc_pose *view)
{
    enum { STEPS = 6 };
    static const double CLOSE = 1e-4;
    double p[3], sine, keep = keeps(scenery, view);
    memcpy(p, g->zoom_at, sizeof p);
    if (!g->zoom_grounded)
        point_ahead(scenery, view, g->zoom_x, g->zoom_y, p);
    const tc_pose before = *view;
    const tc_gesture how = hold_for(scenery, view, p);
    double distance = tc_hold_distance(scenery, view, p, &sine);
    share = fmin(share, fmax(1, scenery->far / distance));
    share = fmax(share, fmin(1, 2 * keep / distance)); /* no nearer than that */
    double wanted = log(share), s = wanted, last_s = 0, last_off = -wanted;
    for (int i = 0; i < STEPS; i++) {
        *view = before;
        go_along(scenery, p, exp(s), view);
        bool lifted = tc_keep_above(scenery, keep, view);
        if (!g->zoom_grounded)
            return;
        hold(scenery, how, p, g->zoom_x, g->zoom_y, view);
        double off = log(tc_hold_distance(scenery, view, p, &sine) / distance) - wanted;
        double slope = (off - last_off) / (s - last_s);
        if (lifted || fabs(off) <= CLOSE || !(slope > 0.1))
            return;
        last_s = s, last_off = off;
        s -= off / slope;
    }
}

static void zoom_on(tc_gestures *g, const tc_scenery *scenery, double dt, tc_pose *view)
{
    static const double REST = 1e-3;
    double part = fabs(g->zoom) < REST ? g->zoom : g->zoom * (1 - exp(-dt / ZOOM_SECONDS));
    g->zoom -= part;
    if (g->gesture == TC_GESTURE_ORBIT) {
        g->distance = fmax(4 * scenery->ground->clearance, fmin(scenery->far, g->distance * exp(part)));
        place_orbit(g, scenery, view);
        return;
    }
    approach(g, scenery, exp(part), view);
    if (g->gesture == TC_GESTURE_PULL || g->gesture == TC_GESTURE_TURN) /* what is held, stays */
        hold(scenery, g->gesture, g->held, g->x, g->y, view);
}

/* ---- There --------------------------------------------------------------------------------------------------------
 */

/* To a quarter of the distance from what was clicked, which comes to the middle. */
static void fly_there(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, const tc_pose *view)
{
    static const double STEEP = -0.35; /* radians; what is looked at more level is looked down at so */
    tc_gestures_rest(g);
    double p[3], sine;
    if (!tc_pick(scenery, view, e->x, e->y, p))
        return;
    tc_pose to = *view;
    to.pitch = fmin(to.pitch, STEEP);
    tc_gestures orbit = {.heading = to.heading, .pitch = to.pitch};
    memcpy(orbit.held, p, sizeof p);
    orbit.distance = fmax(tc_hold_distance(scenery, view, p, &sine) / 4, 4 * scenery->ground->clearance);
    place_orbit(&orbit, scenery, &to);
    tc_gestures_fly(g, scenery, view, &to);
}

/* ---- The whole ----------------------------------------------------------------------------------------------------
 */

void tc_gestures_rest(tc_gestures *g)
{
    g->gesture = TC_GESTURE_NONE;
    g->coasting = false;
    g->zoom = 0;
}

void tc_gestures_fly(tc_gestures *g, const tc_scenery *scenery, const tc_pose *from, const tc_pose *to)
{
    tc_gestures_rest(g);
    g->gesture = TC_GESTURE_FLY;
    g->flight = tc_fly_to_begin(scenery->navigation, scenery->ground, from, to);
}

void tc_gestures_north(tc_gestures *g, const tc_scenery *scenery, const tc_pose *view)
{
    begin_orbit(g, scenery, view, TC_GESTURE_NORTH);
}

bool tc_gestures_moving(const tc_gestures *g)
{
    return g->coasting || g->zoom != 0 || g->gesture == TC_GESTURE_NORTH || g->gesture == TC_GESTURE_FLY;
}

static bool held_by(const tc_gestures *g, tc_pointer_button button)
{
    bool pulls = g->gesture == TC_GESTURE_PULL || g->gesture == TC_GESTURE_TURN;
    bool orbits = g->gesture == TC_GESTURE_ORBIT || g->gesture == TC_GESTURE_LOOK;
    return button == TC_POINTER_LEFT ? pulls && !g->coasting : orbits;
}

static void press(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, tc_pose *view)
{
    if (e->button != TC_POINTER_LEFT) {
        begin_orbit(g, scenery, view, TC_GESTURE_ORBIT);
        g->x = e->x, g->y = e->y;
        return;
    }
    bool twice = e->seconds - g->clicked < fmax(DOUBLE_SECONDS, 2.5 * g->frame) && g->clicked > 0 &&
                 hypot(e->x - g->click_x, e->y - g->click_y) < DOUBLE_PIXELS;
    g->clicked = twice ? 0 : e->seconds;
    g->click_x = e->x, g->click_y = e->y;
    if (twice)
        fly_there(g, scenery, e, view);
    else
        begin_pull(g, scenery, e, view);
}

void tc_gestures_event(tc_gestures *g, const tc_scenery *scenery, const tc_pointer_event *e, tc_pose *view)
{
    switch (e->kind) {
    case TC_POINTER_PRESS: press(g, scenery, e, view); break;
    case TC_POINTER_WHEEL: begin_zoom(g, scenery, e, view); break;
    case TC_POINTER_RELEASE:
        if (held_by(g, TC_POINTER_LEFT) && e->button == TC_POINTER_LEFT)
            end_pull(g, e);
        else if (held_by(g, TC_POINTER_RIGHT) && e->button != TC_POINTER_LEFT)
            tc_gestures_rest(g);
        break;
    case TC_POINTER_MOVE:
        if (held_by(g, TC_POINTER_LEFT)) {
            track(g, e);
            g->x = e->x, g->y = e->y;
            hold(scenery, g->gesture, g->held, g->x, g->y, view);
        } else if (held_by(g, TC_POINTER_RIGHT)) {
            drag_orbit(g, scenery, e, view);
        }
        break;
    }
}

void tc_gestures_step(tc_gestures *g, const tc_scenery *scenery, double dt, tc_pose *view)
{
    g->frame = fmax(0, fmin(1, dt));
    dt = fmin(0.1, g->frame);
    if (g->gesture == TC_GESTURE_FLY) {
        if (!tc_fly_to_step(&g->flight, dt, view))
            tc_gestures_rest(g);
        return;
    }
    if (g->gesture == TC_GESTURE_NORTH)
        turn_north(g, scenery, dt, view);
    else if (g->coasting)
        coast(g, scenery, dt, view);
    if (g->zoom != 0)
        zoom_on(g, scenery, dt, view);
}
