/* test_gestures.c - moving by the mouse: what is held stays under the pointer, over a plane, a sphere and an
 * ellipsoid, from all heights and at all tilts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/view/gestures.h"
#include "common/view/hold.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = M_PI / 180;

static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* Hills, some 2 km across over a plane and some 60 over a globe. */
static double hills_of_plane(void *context, double x, double y)
{
    (void)context;
    return 300 + 200 * sin(x / 350) * cos(y / 410);
}

static double hills_of_globe(void *context, double x, double y)
{
    (void)context;
    return 1500 + 1400 * sin(600 * x) * cos(500 * y);
}

enum { PLANE, SPHERE, ELLIPSOID, BODIES };
static tc_ground grounds[BODIES];
static tc_scenery scenery_of(int body)
{
    grounds[PLANE] = (tc_ground){.height = hills_of_plane, .clearance = 2, .body = tc_body_of(0)};
    grounds[SPHERE] = (tc_ground){.height = hills_of_globe, .clearance = 2, .body = tc_body_of(1737400)};
    grounds[ELLIPSOID] =
        (tc_ground){.height = hills_of_globe, .clearance = 2, .body = tc_body_flattened(6378137, 1 / 298.257223563)};
    return (tc_scenery){.navigation = body == PLANE ? &tc_plane_navigation : &tc_sphere_navigation,
                        .ground = &grounds[body],
                        .highest = body == PLANE ? 500 : 2900,
                        .far = body == PLANE ? 1e6 : 15 * grounds[body].body.radius,
                        .fov = 75 * degree,
                        .width = 800,
                        .height = 600};
}

/* A view from above the ground by a height drawn between these, evenly in its logarithm. */
static tc_pose random_view(const tc_scenery *scenery, uint64_t *seed, double low, double high, double least_pitch,
                           double most_pitch)
{
    tc_pose view = {.heading = 2 * M_PI * next_random(seed),
                    .pitch = (least_pitch + (most_pitch - least_pitch) * next_random(seed)) * degree};
    if (scenery->ground->body.radius > 0)
        view.x = M_PI * (2 * next_random(seed) - 1), view.y = asin(2 * next_random(seed) - 1);
    else
        view.x = 1e4 * next_random(seed), view.y = 1e4 * next_random(seed);
    view.z = scenery->navigation->highest(scenery->ground, &view) + low * pow(high / low, next_random(seed));
    return view;
}

static tc_pointer_event event(tc_pointer_kind kind, double x, double y, double seconds)
{
    return (tc_pointer_event){.kind = kind, .x = x, .y = y, .seconds = seconds};
}

static double off(const tc_scenery *scenery, const tc_pose *view, const double p[3], double x, double y)
{
    double x_is, y_is;
    return tc_pixel_of(scenery, view, p, &x_is, &y_is) ? hypot(x_is - x, y_is - y) : INFINITY;
}

static void assert_above(const tc_scenery *scenery, const tc_pose *view, double least)
{
    double above = view->z - scenery->ground->height(NULL, view->x, view->y);
    if (!(above >= least - 1e-6))
        fail_msg("%g m above ground", above);
}

/* ---- Picking ------------------------------------------------------------------------------------------------------
 */

static void a_picked_point_is_on_the_ground_and_at_its_pixel(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        int hits = 0;
        for (int i = 0; i < 2000; i++) {
            tc_pose view = random_view(&scenery, &seed, 0.02, body == PLANE ? 1e5 : 3e7, -90, 30);
            double x = 800 * next_random(&seed), y = 600 * next_random(&seed), p[3], place[3], eye[3];
            if (!tc_pick(&scenery, &view, x, y, p))
                continue;
            hits++;
            const tc_body *b = &scenery.ground->body;
            b->class->position(b, (double[3]){view.x, view.y, view.z}, eye);
            assert_true(b->class->place(b, p, place));
            double distance = sqrt(pow(p[0] - eye[0], 2) + pow(p[1] - eye[1], 2) + pow(p[2] - eye[2], 2));
            double above = place[2] - scenery.ground->height(NULL, place[0], place[1]);
            if (fabs(above) > 1e-5 * distance + 1e-6)
                fail_msg("body %d: %g m above the ground, %g m away", body, above, distance);
            assert_true(off(&scenery, &view, p, x, y) < 0.01);
        }
        assert_true(hits > 800);
    }
}

static void the_sky_is_no_ground(void **state)
{
    (void)state;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        double p[3];
        tc_pose view = {.x = 0.3, .y = 0.4, .z = 3000, .pitch = 60 * degree};
        assert_false(tc_pick(&scenery, &view, 400, 300, p));
        view.pitch = -90 * degree;
        assert_true(tc_pick(&scenery, &view, 400, 300, p));
        if (body != PLANE) { /* past the ball */
            view.z = 4 * scenery.ground->body.radius;
            assert_true(tc_pick(&scenery, &view, 400, 300, p));
            assert_false(tc_pick(&scenery, &view, 5, 5, p));
        }
    }
}

/* ---- Pulling ------------------------------------------------------------------------------------------------------
 */

/* Drags by random ways: how many moves let the point slip by more than this, of how many. */
static void drag(int body, double low, double high, double least_pitch, double most_pitch, double reach, int *slips,
                 int *moves)
{
    const tc_scenery scenery = scenery_of(body);
    uint64_t seed = 11;
    for (int i = 0; i < 150; i++) {
        tc_pose view = random_view(&scenery, &seed, low, high, least_pitch, most_pitch);
        double x = 400 + 250 * (2 * next_random(&seed) - 1), y = 300 + 200 * (2 * next_random(&seed) - 1), p[3];
        if (!tc_pick(&scenery, &view, x, y, p))
            continue;
        double least = fmin(2, view.z - scenery.navigation->highest(scenery.ground, &view));
        tc_gestures hand = {0};
        tc_pointer_event e = event(TC_POINTER_PRESS, x, y, 1);
        tc_gestures_event(&hand, &scenery, &e, &view);
        for (int k = 0; k < 8; k++) {
            x = fmax(5, fmin(795, x + reach * (2 * next_random(&seed) - 1)));
            y = fmax(5, fmin(595, y + reach * (2 * next_random(&seed) - 1)));
            e = event(TC_POINTER_MOVE, x, y, 1 + 0.02 * k);
            tc_gestures_event(&hand, &scenery, &e, &view);
            double slip = off(&scenery, &view, p, x, y);
            *slips += !(slip <= 2);
            ++*moves;
            assert_above(&scenery, &view, least);
            assert_true(fabs(view.pitch) <= M_PI / 2);
        }
    }
}

static void what_is_pulled_stays_under_the_pointer(void **state)
{
    (void)state;
    static const struct {
        double low, high, least, most, reach;
    } cases[] = {{0.02, 2, -80, 5, 60}, {2, 200, -80, 5, 60}, {200, 2e4, -85, -5, 60}, {2e4, 3e5, -90, -30, 60}};
    for (int body = 0; body < BODIES; body++)
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
            int slips = 0, moves = 0;
            drag(body, cases[c].low, cases[c].high, cases[c].least, cases[c].most, cases[c].reach, &slips, &moves);
            print_message("body %d, from %g to %g m: %d of %d moves let it slip\n", body, cases[c].low, cases[c].high,
                          slips, moves);
            assert_true(moves > 300);
            if (slips > 0)
                fail_msg("body %d, from %g m: %d of %d moves let it slip", body, cases[c].low, slips, moves);
        }
}

/* From space, within the disc. */
static void a_globe_is_turned_by_what_is_held(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int body = SPHERE; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        double r = scenery.ground->body.radius;
        for (int i = 0; i < 300; i++) {
            tc_pose view = random_view(&scenery, &seed, r, 4 * r, -90, -90);
            if (i % 2)
                view.heading = 0;
            double disc = 300 / tan(scenery.fov / 2) / 0.75 * tan(asin(r / (r + view.z)));
            double reach = 0.8 * fmin(300, disc), p[3];
            tc_gestures hand = {0};
            tc_pointer_event e = event(TC_POINTER_PRESS, 400 + reach / 3, 300 - reach / 4, 1);
            assert_true(tc_pick(&scenery, &view, e.x, e.y, p));
            tc_gestures_event(&hand, &scenery, &e, &view);
            for (int k = 0; k < 30; k++) {
                double a = 2 * M_PI * next_random(&seed), s = reach * next_random(&seed);
                double x = e.x, y = e.y, x1 = 400 + s * cos(a), y1 = 300 + s * sin(a);
                for (int part = 1; part <= 4; part++) {
                    e = event(TC_POINTER_MOVE, x + part * (x1 - x) / 4, y + part * (y1 - y) / 4, 1 + k);
                    tc_gestures_event(&hand, &scenery, &e, &view);
                }
                double slip = off(&scenery, &view, p, e.x, e.y);
                if (!(slip <= 2))
                    fail_msg("body %d, view %d, move %d: slips by %g at %g %g, latitude %g", body, i, k, slip, e.x, e.y,
                             view.y / degree);
            }
            /* Away from poles north stays where it was. */
            if (i % 2 && fabs(view.y) < 60 * degree && fabs(p[2]) < 0.5 * r)
                assert_true(fabs(remainder(view.heading, 2 * M_PI)) < M_PI);
        }
    }
}

static void let_go_in_motion_it_runs_on_and_a_click_stops_it(void **state)
{
    (void)state;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        tc_pose view = {.x = 0.2, .y = 0.3, .z = 9000, .pitch = -60 * degree};
        tc_gestures hand = {0};
        tc_pointer_event e = event(TC_POINTER_PRESS, 400, 300, 1);
        tc_gestures_event(&hand, &scenery, &e, &view);
        for (int k = 1; k <= 6; k++) {
            e = event(TC_POINTER_MOVE, 400 + 10 * k, 300, 1 + 0.016 * k);
            tc_gestures_event(&hand, &scenery, &e, &view);
        }
        e = event(TC_POINTER_RELEASE, 460, 300, 1 + 0.016 * 6.5);
        tc_gestures_event(&hand, &scenery, &e, &view);
        assert_true(tc_gestures_moving(&hand));
        tc_gestures clicked = hand;
        tc_pose before = view, stopped = view;
        double last = 0;
        for (int k = 0; k < 400 && tc_gestures_moving(&hand); k++) {
            tc_pose now = view;
            tc_gestures_step(&hand, &scenery, 0.016, &view);
            double way = scenery.navigation->apart(&scenery.ground->body, &now, &view);
            assert_true(k == 0 || way <= 1.05 * last + 1e-9); /* ever slower */
            last = way;
        }
        assert_false(tc_gestures_moving(&hand));
        assert_true(scenery.navigation->apart(&scenery.ground->body, &before, &view) > 500);
        e = event(TC_POINTER_PRESS, 300, 300, 2);
        tc_gestures_event(&clicked, &scenery, &e, &stopped);
        assert_false(tc_gestures_moving(&clicked));
        /* A button that rests before it is let go throws nothing. */
        e = event(TC_POINTER_RELEASE, 300, 300, 2.5);
        tc_gestures_event(&clicked, &scenery, &e, &stopped);
        assert_false(tc_gestures_moving(&clicked));
        assert_memory_equal(&before, &stopped, sizeof before);
    }
}

/* ---- The wheel ----------------------------------------------------------------------------------------------------
 */

static void the_wheel_comes_nearer_to_what_is_under_the_pointer(void **state)
{
    (void)state;
    uint64_t seed = 9;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        double high = body == PLANE ? 1e5 : 2 * scenery.ground->body.radius;
        int tried = 0;
        for (int i = 0; i < 300; i++) {
            tc_pose view = random_view(&scenery, &seed, 50, high, -90, -15);
            double x = 400 + 150 * (2 * next_random(&seed) - 1), y = 300 + 100 * (2 * next_random(&seed) - 1), p[3];
            double sine, before, wheel = next_random(&seed) < 0.7 ? 1 : -1;
            if (!tc_pick(&scenery, &view, x, y, p))
                continue;
            before = tc_hold_distance(&scenery, &view, p, &sine);
            if (sine < 0.2 || before < 40)
                continue;
            tried++;
            tc_gestures hand = {0};
            tc_pointer_event e = event(TC_POINTER_WHEEL, x, y, 1);
            e.wheel = wheel;
            tc_gestures_event(&hand, &scenery, &e, &view);
            double last = before;
            for (int k = 0; k < 200 && tc_gestures_moving(&hand); k++) {
                tc_gestures_step(&hand, &scenery, 0.016, &view);
                double now = tc_hold_distance(&scenery, &view, p, &sine);
                if (sine < 0.05) /* it passes behind the horizon */
                    break;
                if (!(off(&scenery, &view, p, x, y) <= 2))
                    fail_msg("body %d, %d: slips by %g, %g m up, latitude %g, sine %g", body, i,
                             off(&scenery, &view, p, x, y), view.z, view.y / degree, sine);
                assert_true((now - last) * wheel <= 1e-3 * last); /* smoothly, one way */
                last = now;
            }
            if (sine < 0.05)
                continue;
            assert_false(tc_gestures_moving(&hand));
            double factor = last / before;
            if (!(wheel > 0 ? factor > 0.7 && factor < 0.87 : factor > 1.1 && factor < 1.4))
                fail_msg("body %d, %d: %g of the distance for a notch of %g", body, i, factor, wheel);
        }
        assert_true(tried > 100);
    }
}

/* From space to the ground and back, however far, without getting stuck. */
static void down_to_the_ground_and_out_again(void **state)
{
    (void)state;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        tc_pose view = {.x = 0.2, .y = 0.3, .z = body == PLANE ? 3e5 : 2e7, .pitch = -90 * degree};
        tc_gestures hand = {0};
        tc_pointer_event e = event(TC_POINTER_WHEEL, 420, 310, 1);
        for (int way = 1; way >= -1; way -= 2) {
            for (int k = 0; k < 120; k++) {
                e.wheel = way;
                tc_gestures_event(&hand, &scenery, &e, &view);
                for (int f = 0; f < 4; f++)
                    tc_gestures_step(&hand, &scenery, 0.016, &view);
                assert_above(&scenery, &view, 2);
            }
            for (int k = 0; k < 100; k++)
                tc_gestures_step(&hand, &scenery, 0.016, &view);
            double above = view.z - scenery.ground->height(NULL, view.x, view.y);
            if (way > 0 ? above > 8 : above < 0.3 * scenery.far)
                fail_msg("body %d: %g m above ground", body, above);
        }
        /* From 1 cm above the ground. */
        view.z = scenery.ground->height(NULL, view.x, view.y) + 0.01;
        view.pitch = -20 * degree;
        for (int k = 0; k < 20; k++) {
            e.wheel = -1;
            tc_gestures_event(&hand, &scenery, &e, &view);
            for (int f = 0; f < 10; f++)
                tc_gestures_step(&hand, &scenery, 0.016, &view);
        }
        assert_above(&scenery, &view, 0.05);
        tc_flight flight = {.view = view, .speed = tc_flight_speed};
        flight.view.z = scenery.ground->height(NULL, view.x, view.y) + 0.01;
        tc_pose start = flight.view;
        for (int k = 0; k < 60; k++)
            scenery.navigation->step(&flight, &(tc_flight_input){.forward = 1, .dt = 1. / 60}, scenery.ground);
        double went = scenery.navigation->apart(&scenery.ground->body, &start, &flight.view);
        assert_true(went > 0.05 && went < 2);
    }
}

/* ---- About the middle ---------------------------------------------------------------------------------------------
 */

static void the_right_button_turns_about_the_middle(void **state)
{
    (void)state;
    uint64_t seed = 21;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        int tried = 0;
        for (int i = 0; i < 300; i++) {
            tc_pose view = random_view(&scenery, &seed, 20, body == PLANE ? 1e5 : 1e7, -90, -5);
            double p[3], sine, before;
            if (!tc_pick(&scenery, &view, 400, 300, p))
                continue;
            tried++;
            before = tc_hold_distance(&scenery, &view, p, &sine);
            tc_gestures hand = {0};
            tc_pointer_event e = event(TC_POINTER_PRESS, 200, 200, 1);
            e.button = TC_POINTER_RIGHT;
            tc_gestures_event(&hand, &scenery, &e, &view);
            for (int k = 0; k < 10; k++) {
                e = event(TC_POINTER_MOVE, e.x + 60 * (next_random(&seed) - 0.5), e.y + 60 * (next_random(&seed) - 0.5),
                          1);
                tc_gestures_event(&hand, &scenery, &e, &view);
                if (!(off(&scenery, &view, p, 400, 300) <= 2))
                    fail_msg("body %d, view %d: the middle is off by %g", body, i, off(&scenery, &view, p, 400, 300));
                assert_above(&scenery, &view, 2);
            }
            double after = tc_hold_distance(&scenery, &view, p, &sine);
            assert_true(after >= 0.999 * before && after < 1.5 * before + 1500);
            /* Then north, about the same point. */
            e = event(TC_POINTER_RELEASE, e.x, e.y, 1);
            e.button = TC_POINTER_RIGHT;
            tc_gestures_event(&hand, &scenery, &e, &view);
            tc_gestures_north(&hand, &scenery, &view);
            for (int k = 0; k < 300 && tc_gestures_moving(&hand); k++)
                tc_gestures_step(&hand, &scenery, 0.016, &view);
            assert_false(tc_gestures_moving(&hand));
            assert_true(view.heading == 0);
        }
        assert_true(tried > 100);
    }
}

/* ---- Flights ------------------------------------------------------------------------------------------------------
 */

static void flights_arrive_exactly_and_pass_evenly(void **state)
{
    (void)state;
    uint64_t seed = 33;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        for (int i = 0; i < 200; i++) {
            double high = body == PLANE ? 1e5 : 1e7;
            tc_pose from = random_view(&scenery, &seed, 3, high, -90, 10);
            tc_pose to = i % 10 ? random_view(&scenery, &seed, 3, high, -90, 10) : from;
            to.pitch = -0.5;
            tc_gestures hand = {0};
            tc_gestures_fly(&hand, &scenery, &from, &to);
            tc_pose view = from;
            double seconds = 0;
            while (tc_gestures_moving(&hand)) {
                tc_pose last = view;
                tc_gestures_step(&hand, &scenery, 0.01, &view);
                seconds += 0.01;
                assert_true(isfinite(view.x) && isfinite(view.y) && isfinite(view.z));
                if (tc_gestures_moving(&hand))
                    assert_above(&scenery, &view, 2);
                /* Never farther in a frame than what is seen. */
                double low = scenery.ground->height(NULL, last.x, last.y);
                double way = scenery.navigation->apart(&scenery.ground->body, &last, &view);
                double curved =
                    1 + fmax(0, last.z) / fmax(1, scenery.ground->body.radius ? scenery.ground->body.radius : 1e300);
                if (way > 0.25 * (last.z - low + 2000) * curved + 1e-3)
                    fail_msg("body %d, %d: %g m from %g m up", body, i, way, last.z - low);
                assert_true(seconds < 4.1);
            }
            scenery.navigation->settle(&to);
            assert_memory_equal(&view, &to, sizeof view);
        }
    }
}

static void twice_flies_there(void **state)
{
    (void)state;
    for (int body = 0; body < BODIES; body++) {
        const tc_scenery scenery = scenery_of(body);
        tc_pose view = {.x = 0.2, .y = 0.3, .z = 9000, .pitch = -60 * degree, .heading = 1};
        double p[3], sine, before, after;
        assert_true(tc_pick(&scenery, &view, 550, 200, p));
        before = tc_hold_distance(&scenery, &view, p, &sine);
        tc_gestures hand = {0};
        static const tc_pointer_kind kinds[] = {TC_POINTER_PRESS, TC_POINTER_RELEASE, TC_POINTER_PRESS,
                                                TC_POINTER_RELEASE};
        for (int k = 0; k < 4; k++) {
            tc_pointer_event e = event(kinds[k], 550, 200, 1 + 0.05 * k);
            tc_gestures_event(&hand, &scenery, &e, &view);
        }
        assert_true(tc_gestures_moving(&hand));
        for (int k = 0; k < 500 && tc_gestures_moving(&hand); k++)
            tc_gestures_step(&hand, &scenery, 0.016, &view);
        after = tc_hold_distance(&scenery, &view, p, &sine);
        assert_true(off(&scenery, &view, p, 400, 300) < 2);
        assert_float_equal(after / before, 0.25, 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picked_point_is_on_the_ground_and_at_its_pixel),
        cmocka_unit_test(the_sky_is_no_ground),
        cmocka_unit_test(what_is_pulled_stays_under_the_pointer),
        cmocka_unit_test(a_globe_is_turned_by_what_is_held),
        cmocka_unit_test(let_go_in_motion_it_runs_on_and_a_click_stops_it),
        cmocka_unit_test(the_wheel_comes_nearer_to_what_is_under_the_pointer),
        cmocka_unit_test(down_to_the_ground_and_out_again),
        cmocka_unit_test(the_right_button_turns_about_the_middle),
        cmocka_unit_test(flights_arrive_exactly_and_pass_evenly),
        cmocka_unit_test(twice_flies_there),
    };
    return cmocka_run_group_tests_name("gestures", tests, NULL, NULL);
}
