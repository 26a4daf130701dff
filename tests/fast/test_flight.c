/* test_flight.c - views in words, the view of a whole terrain, free flight, paths. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/view/camera.h"
#include "common/view/flight_path.h"
#include "common/view/navigation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double degree = 3.14159265358979323846 / 180;

/* A number in 0 .. 1, the same sequence each time. */
static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* ---- Views in words ----------------------------------------------------------------------------------------- */

static void printed_views_come_back_exactly(void **state)
{
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        double size = pow(10, 14 * next_random(&seed) - 2);
        tc_pose view = {size * (next_random(&seed) - 0.5), size * (next_random(&seed) - 0.5),
                        size * (next_random(&seed) - 0.5), 20 * (next_random(&seed) - 0.5),
                        3.2 * (next_random(&seed) - 0.5)};
        const tc_pose before = view;
        double spacing = pow(10, 6 * next_random(&seed) - 4);
        char text[TC_POSE_TEXT], again[TC_POSE_TEXT];
        tc_pose_format(&tc_plane_navigation, &view, spacing, text);
        tc_pose read;
        assert_true(tc_pose_parse(&tc_plane_navigation, text, &read));
        assert_memory_equal(&read, &view, sizeof view);
        tc_pose_format(&tc_plane_navigation, &read, spacing, again);
        assert_string_equal(text, again);
        assert_memory_equal(&read, &view, sizeof view);
        /* And it is next to what it was. */
        double step = fmin(1e-3, 1e-2 * spacing) + 1e-15 * size;
        if (fabs(before.x) <= TC_POSE_LIMIT)
            assert_true(fabs(view.x - before.x) <= step);
        assert_true(fabs(sin(view.heading) - sin(before.heading)) < 1e-5);
        assert_true(fabs(cos(view.heading) - cos(before.heading)) < 1e-5);
    }
    tc_pose view = {-1e-9, 0, 0, -1e-9, -1e-9};
    char text[TC_POSE_TEXT];
    tc_pose_format(&tc_plane_navigation, &view, 30, text);
    assert_string_equal(text, "0.000,0.000,0.000,0.0000,0.0000");
}

/* ---- The whole terrain -------------------------------------------------------------------------------------- */

/* How far outside the frame the worst corner is, as a share of half the frame; negative inside. */
static double worst_corner(const tc_flight_box *box, const tc_pose *view, const tc_camera *lens)
{
    tc_camera camera = *lens;
    tc_pose_to_camera(view, &camera);
    tc_basis basis = tc_camera_basis(&camera);
    double t[2], worst = -INFINITY;
    tc_camera_tangents(&camera, &t[0], &t[1]);
    for (int i = 0; i < 8; i++) {
        double d[3] = {(i & 1 ? box->east : 0) - view->x, (i & 2 ? box->north : 0) - view->y,
                       (i & 4 ? box->z_max : box->z_min) - view->z};
        double right = 0, up = 0, forward = 0;
        for (int k = 0; k < 3; k++) {
            right += d[k] * basis.right[k];
            up += d[k] * basis.up[k];
            forward += d[k] * basis.forward[k];
        }
        if (forward <= 0)
            return INFINITY;
        worst = fmax(worst, fmax(fabs(right) / (t[0] * forward), fabs(up) / (t[1] * forward)) - 1);
    }
    return worst;
}

static void the_whole_terrain_is_in_frame(void **state)
{
    (void)state;
    static const int sizes[][2] = {{640, 480}, {1280, 720}, {480, 640}, {1, 16384}, {16384, 1}, {3, 3}};
    static const double fovs[] = {1, 30, 75, 90, 120, 170};
    static const tc_flight_box boxes[] = {{.east = 122880, .north = 122880, .z_min = 600, .z_max = 2600},
                                          {.east = 30, .north = 30, .z_min = 0, .z_max = 0},
                                          {.east = 1, .north = 100000, .z_min = -5, .z_max = 5},
                                          {.east = 100000, .north = 1, .z_min = 0, .z_max = 10},
                                          {.east = 1000, .north = 1000, .z_min = 0, .z_max = 65535},
                                          {.east = 1, .north = 1, .z_min = 0, .z_max = 1e5},
                                          {.east = 4096, .north = 4096, .z_min = 0, .z_max = 255},
                                          {.east = 2.1e6, .north = 20, .z_min = -10000, .z_max = 9000},
                                          {.east = 0, .north = 500, .z_min = 0, .z_max = 0},
                                          {.east = 500, .north = 0, .z_min = 0, .z_max = 100},
                                          {.east = 0, .north = 0, .z_min = 0, .z_max = 0},
                                          {.east = 1e-3, .north = 1e-3, .z_min = 8e3, .z_max = 8e3},
                                          {.east = 1e9, .north = 1e9, .z_min = -1e4, .z_max = 1e4},
                                          {.east = 10, .north = 10, .z_min = -1, .z_max = -0.5}};
    for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++)
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
            for (size_t f = 0; f < sizeof fovs / sizeof *fovs; f++) {
                const tc_camera lens = {.fov = fovs[f] * degree, .width = sizes[s][0], .height = sizes[s][1]};
                tc_pose view = tc_plane_navigation.whole(&boxes[b], lens.fov, lens.width, lens.height);
                assert_true(isfinite(view.x) && isfinite(view.y) && isfinite(view.z));
                assert_true(view.z > boxes[b].z_max);
                assert_true(view.pitch < 0 && view.pitch >= -90.001 * degree);
                if (fmax(fabs(view.y), view.z) >= TC_POSE_LIMIT)
                    continue; /* a strip of pixels and a terrain the size of the sun */
                double worst = worst_corner(&boxes[b], &view, &lens);
                if (worst > 0)
                    fail_msg("box %zu, size %zu, fov %g: %g outside", b, s, fovs[f], worst);
                /* As large as can be, where nothing odd had to be done. */
                if (b == 0 && f == 2 && s < 3)
                    assert_true(worst > -0.1);
            }
}

/* ---- Free flight -------------------------------------------------------------------------------------------- */

/* Waves 100 m high. */
static double waves(void *context, double x, double y)
{
    (void)context;
    return 100 * sin(x / 50) * cos(y / 70);
}

static const tc_ground ground = {.height = waves, .clearance = 2};

static void never_below_ground(void **state)
{
    (void)state;
    uint64_t seed = 5;
    tc_flight flight = {.view = {0, 0, -1000, 0, 0}, .speed = tc_flight_speed};
    for (int i = 0; i < 100000; i++) {
        const tc_flight_input input = {.right = floor(3 * next_random(&seed)) - 1,
                                       .forward = floor(3 * next_random(&seed)) - 1,
                                       .up = floor(3 * next_random(&seed)) - 1.2,
                                       .turn = next_random(&seed) - 0.5,
                                       .tilt = next_random(&seed) - 0.5,
                                       .fast = i % 7 == 0,
                                       .dt = 0.2 * next_random(&seed)};
        if (i % 100 == 0)
            tc_flight_faster(&flight, 10 * (next_random(&seed) - 0.5));
        tc_plane_navigation.step(&flight, &input, &ground);
        assert_true(flight.view.z >= waves(NULL, flight.view.x, flight.view.y) + 2);
        assert_true(fabs(flight.view.pitch) <= 90 * degree);
        assert_true(isfinite(flight.view.x) && fabs(flight.view.x) <= TC_POSE_LIMIT);
        assert_true(flight.speed > 0 && flight.speed <= 100);
    }
}

static void bounded_however_long_one_climbs(void **state)
{
    (void)state;
    tc_flight flight = {.view = {0, 0, 100, 0.5, 0.5}, .speed = 100};
    for (int i = 0; i < 1000; i++)
        tc_plane_navigation.step(&flight, &(tc_flight_input){.forward = 1, .up = 1, .fast = true, .dt = 0.1}, &ground);
    assert_true(flight.view.z <= TC_POSE_LIMIT && flight.view.x <= TC_POSE_LIMIT && flight.view.y <= TC_POSE_LIMIT);
}

static double flat(void *context, double x, double y)
{
    (void)context, (void)x, (void)y;
    return 1000;
}

static void directions_and_speed(void **state)
{
    (void)state;
    const tc_ground plain = {.height = flat, .clearance = 2};
    const tc_flight start = {.view = {0, 0, 1500, 90 * degree, 0}, .speed = 1};
    /* East for 0.1 s at a height of 500 m: 50 m. */
    tc_flight f = start;
    tc_plane_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &plain);
    assert_float_equal(f.view.x, 50, 1e-9);
    assert_float_equal(f.view.y, 0, 1e-9);
    assert_float_equal(f.view.z, 1500, 1e-9);
    /* To the right of east is south. */
    f = start;
    tc_plane_navigation.step(&f, &(tc_flight_input){.right = 1, .dt = 0.1}, &plain);
    assert_float_equal(f.view.y, -50, 1e-9);
    /* Up is up wherever one looks; two keys together are no faster; a long frame counts as a tenth of a second. */
    f = start;
    tc_plane_navigation.step(&f, &(tc_flight_input){.up = 1, .dt = 9}, &plain);
    assert_float_equal(f.view.z, 1550, 1e-9);
    f = start;
    tc_plane_navigation.step(&f, &(tc_flight_input){.forward = 1, .right = 1, .fast = true, .dt = 0.1}, &plain);
    assert_float_equal(hypot(f.view.x, f.view.y), 400, 1e-9);
    /* Twice as high, twice as fast; near the ground one still moves. */
    f = start;
    f.view.z = 2000;
    tc_plane_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &plain);
    assert_float_equal(f.view.x, 100, 1e-9);
    f.view = (tc_pose){0, 0, 1002, 0, -1};
    tc_plane_navigation.step(&f, &(tc_flight_input){.forward = 1, .dt = 0.1}, &plain);
    assert_true(f.view.y > 0.1 && f.view.z >= 1002);
    /* Turning: right is clockwise, and nothing else moves. */
    f = start;
    tc_plane_navigation.step(&f, &(tc_flight_input){.turn = 0.25, .tilt = -9, .dt = 0.1}, &plain);
    assert_float_equal(f.view.heading, 90 * degree + 0.25, 1e-12);
    assert_float_equal(f.view.pitch, -90 * degree, 1e-12);
    assert_true(f.view.x == 0 && f.view.y == 0 && f.view.z == 1500);
    /* The wheel. */
    tc_flight_faster(&f, 1);
    assert_true(f.speed > 1.1);
    assert_true(tc_flight_clearance(30) == 2 && tc_flight_clearance(0.5) == 0.25);
}

/* ---- Paths -------------------------------------------------------------------------------------------------- */

static tc_flight_path path_of(const char *text)
{
    tc_flight_path path;
    tc_error error = {.text = ""};
    if (tc_flight_path_parse(&tc_plane_navigation, "path", text, &path, &error) != TC_OK)
        fail_msg("%s", error.text);
    return path;
}

static void a_path_passes_its_keys(void **state)
{
    (void)state;
    tc_flight_path path = path_of("# a flight\n\n 0,0,100,350,-10 # start\r\n1000,0,200,10,-20\n"
                                  "\t1500,800,150,100,0\n1600,900,150,300,5");
    assert_int_equal(path.count, 4);
    for (int i = 0; i < 4; i++) {
        tc_pose view = tc_flight_path_view(&path, 10 * i, 31);
        assert_float_equal(view.x, path.keys[i].x, 1e-9);
        assert_float_equal(view.y, path.keys[i].y, 1e-9);
        assert_float_equal(view.z, path.keys[i].z, 1e-9);
        assert_float_equal(view.heading, path.keys[i].heading, 1e-9);
        assert_float_equal(view.pitch, path.keys[i].pitch, 1e-9);
    }
    /* The short way from 350 to 10 and from 100 to 300 degrees. */
    assert_float_equal(path.keys[1].heading, 370 * degree, 1e-9);
    assert_float_equal(path.keys[3].heading, 300 * degree, 1e-9);
    /* Even steps: position and velocity do not jump. */
    tc_pose last = tc_flight_path_view(&path, 0, 3001);
    double last_step = -1;
    for (int i = 1; i < 3001; i++) {
        tc_pose view = tc_flight_path_view(&path, i, 3001);
        double step = hypot(view.x - last.x, view.y - last.y);
        if (last_step >= 0)
            assert_true(fabs(step - last_step) < 0.02);
        last_step = step;
        last = view;
    }
    tc_flight_path_free(&path);
    tc_flight_path_free(&path);
}

static void a_straight_path_is_even(void **state)
{
    (void)state;
    tc_flight_path path = path_of("0,0,0,0,0\n100,50,10,20,-1\n200,100,20,40,-2\n");
    for (int i = 0; i < 17; i++) {
        tc_pose view = tc_flight_path_view(&path, i, 17);
        assert_float_equal(view.x, 200 * i / 16.0, 1e-9);
        assert_float_equal(view.heading, 40 * degree * i / 16.0, 1e-12);
    }
    tc_flight_path_free(&path);
    path = path_of("0,0,0,0,0\n100,0,0,0,0");
    assert_float_equal(tc_flight_path_view(&path, 1, 3).x, 50, 1e-9);
    tc_flight_path_free(&path);
}

static tc_flight_path globe_path_of(const char *text)
{
    tc_flight_path path;
    tc_error error = {.text = ""};
    if (tc_flight_path_parse(&tc_sphere_navigation, "path", text, &path, &error) != TC_OK)
        fail_msg("%s", error.text);
    return path;
}

static void directions_of(const tc_pose *view, double foot[3], double forward[3])
{
    double sx = sin(view->x), cx = cos(view->x), sy = sin(view->y), cy = cos(view->y);
    double s = sin(view->heading), c = cos(view->heading);
    const double at[3] = {cy * cx, cy * sx, sy}, to[3] = {-s * sx - c * sy * cx, s * cx - c * sy * sx, c * cy};
    memcpy(foot, at, sizeof at), memcpy(forward, to, sizeof to);
}

/* Foot point and direction come along without a jump, and arrive at the keys. */
static void assert_smooth(const tc_flight_path *path, double most)
{
    const int steps = 1000, frames = steps * (path->count - 1) + 1;
    double last[2][3] = {{0}}, step[2][3] = {{0}};
    for (int i = 0; i < frames; i++) {
        tc_pose view = tc_flight_path_view(path, i, frames);
        double now[2][3];
        directions_of(&view, now[0], now[1]);
        for (int k = 0; k < 6; k++) {
            double is = now[k / 3][k % 3] - last[k / 3][k % 3], was = step[k / 3][k % 3];
            if (i > 0 && fabs(is) > most / steps)
                fail_msg("frame %d, number %d: a step of %g", i, k, is);
            if (i > 1 && fabs(is - was) > 20 * most / steps / steps)
                fail_msg("frame %d, number %d: a step of %g after one of %g", i, k, is, was);
            step[k / 3][k % 3] = i > 0 ? is : 0;
        }
        memcpy(last, now, sizeof now);
        if (i % steps == 0) {
            double key[2][3];
            directions_of(&path->keys[i / steps], key[0], key[1]);
            for (int k = 0; k < 6; k++)
                assert_float_equal(now[k / 3][k % 3], key[k / 3][k % 3], 1e-9);
        }
    }
}

static void over_the_pole_along_a_meridian(void **state)
{
    (void)state;
    static const char *const texts[] = {"0,80,1e5,0,-30\n0,90,1e5,0,-30\n180,80,1e5,180,-30\n",
                                        /* On the pole the same direction along another meridian. */
                                        "0,80,1e5,0,-30\n90,90,1e5,90,-30\n-180,80,1e5,180,-30\n"};
    for (int k = 0; k < 2; k++) {
        tc_flight_path path = globe_path_of(texts[k]);
        for (int i = 0; i <= 200; i++) {
            tc_pose view = tc_flight_path_view(&path, i, 201);
            double over = i <= 100 ? 80 + 0.1 * i : 100 - 0.1 * i;
            assert_float_equal(view.y, (i <= 100 ? over : 180 - (80 + 0.1 * i)) * degree, 1e-9);
            if (i == 100)
                continue; /* the key itself */
            assert_float_equal(sin(view.x), 0, 1e-7);
            assert_true(cos(view.x) * (i < 100 ? 1 : -1) > 0.999);
            assert_float_equal(sin(view.heading), 0, 1e-7);
            assert_true(cos(view.heading) * (i < 100 ? 1 : -1) > 0.999);
            assert_float_equal(view.z, 1e5, 1e-6);
            assert_float_equal(view.pitch, -30 * degree, 1e-12);
        }
        assert_smooth(&path, 0.3);
        tc_flight_path_free(&path);
    }
    /* Past it. */
    tc_flight_path path = globe_path_of("10,80,1e5,5,0\n40,87,1e5,30,0\n150,84,1e5,160,0\n170,75,1e5,120,0\n");
    assert_smooth(&path, 2);
    tc_flight_path_free(&path);
}

static void over_the_antimeridian(void **state)
{
    (void)state;
    tc_flight_path path = globe_path_of("170,0,1e5,90,0\n-170,0,1e5,90,0\n-150,0,1e5,90,0\n");
    for (int i = 0; i <= 40; i++) {
        tc_pose view = tc_flight_path_view(&path, i, 41);
        assert_float_equal(remainder(view.x - (170 + i) * degree, 2 * M_PI), 0, 1e-9);
        assert_float_equal(view.y, 0, 1e-9);
        assert_float_equal(view.heading, 90 * degree, 1e-9);
    }
    assert_smooth(&path, 1);
    tc_flight_path_free(&path);
}

static void along_a_parallel(void **state)
{
    (void)state;
    tc_flight_path path = globe_path_of("0,50,1e5,90,0\n10,50,1e5,90,0\n20,50,1e5,90,0\n30,50,1e5,90,0\n");
    for (int i = 30; i <= 60; i++) {
        tc_pose view = tc_flight_path_view(&path, i, 91);
        assert_float_equal(view.x, i / 3. * degree, 0.01 * degree);
        assert_float_equal(view.y, 50 * degree, 0.02 * degree);
        assert_float_equal(view.heading, 90 * degree, 0.2 * degree);
    }
    assert_smooth(&path, 1);
    tc_flight_path_free(&path);
    /* On the spot, once around by thirds: evenly. */
    path = globe_path_of("7,50,1e5,0,0\n7,50,1e5,120,0\n7,50,1e5,240,0\n7,50,1e5,360,0\n");
    for (int i = 0; i <= 90; i++) {
        tc_pose view = tc_flight_path_view(&path, i, 91);
        assert_float_equal(remainder(view.heading - 4 * i * degree, 2 * M_PI), 0, 1e-9);
        assert_float_equal(view.x, 7 * degree, 1e-12);
    }
    tc_flight_path_free(&path);
    /* To the other side of the globe, some way. */
    path = globe_path_of("0,0,1e5,90,0\n180,0,1e5,90,0\n");
    tc_pose view = tc_flight_path_view(&path, 1, 3);
    assert_float_equal(view.x, 90 * degree, 1e-9);
    tc_flight_path_free(&path);
    /* A globe's lines have bounds. */
    tc_error error;
    assert_int_equal(tc_flight_path_parse(&tc_sphere_navigation, "p", "0,91,1,0,0", &path, &error), TC_ERR_FORMAT);
    assert_non_null(strstr(error.text, "p: line 1: expected LON,LAT,ALT,HEADING,PITCH in degrees and metres, |LON|"));
}

static void a_path_of_one_key_stands_still(void **state)
{
    (void)state;
    tc_flight_path path = path_of("1,2,3,4,5");
    for (int i = 0; i < 5; i++)
        assert_true(tc_flight_path_view(&path, i, 5).z == 3);
    assert_true(tc_flight_path_view(&path, 0, 1).z == 3);
    tc_flight_path_free(&path);
}

static void bad_paths_name_the_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *error;
    } cases[] = {
        {"", "p: expected lines of X,Y,Z,HEADING,PITCH, found none"},
        {"# nothing\n\n  \n", "p: expected lines of X,Y,Z,HEADING,PITCH, found none"},
        {"1,2,3,4,5\n#\n1,2,3,4\n", "p: line 3: expected X,Y,Z,HEADING,PITCH, found '1,2,3,4'"},
        {"1,2,3,4,5 6\n", "p: line 1: "},
        {"1,2,3,nan,5\n", "p: line 1: "},
        {"1,2,3,4,5\n1, 2, 3, 4, 5\n", "p: line 2: "},
        {"\x89PNG\x1a", "p: line 1: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tc_flight_path path = {.count = 77};
        tc_error error = {.text = ""};
        assert_int_equal(tc_flight_path_parse(&tc_plane_navigation, "p", cases[i].text, &path, &error), TC_ERR_FORMAT);
        if (strncmp(error.text, cases[i].error, strlen(cases[i].error)) != 0)
            fail_msg("%zu: '%s'", i, error.text);
        assert_int_equal(path.count, 77);
    }
    char *endless = malloc(100001);
    assert_non_null(endless);
    memset(endless, '1', 100000);
    endless[100000] = '\0';
    tc_flight_path path;
    assert_int_equal(tc_flight_path_parse(&tc_plane_navigation, "p", endless, &path, NULL), TC_ERR_FORMAT);
    free(endless);
    assert_int_equal(tc_flight_path_load(&tc_plane_navigation, "/nonexistent/path", &path, NULL), TC_ERR_IO);
    assert_int_equal(tc_flight_path_load(&tc_plane_navigation, "/", &path, NULL), TC_ERR_IO);
    assert_int_equal(tc_flight_path_load(&tc_plane_navigation, "/dev/zero", &path, NULL), TC_ERR_FORMAT);
}

static void a_path_file_is_read(void **state)
{
    (void)state;
    char name[] = "/tmp/tc-path-XXXXXX";
    int fd = mkstemp(name);
    assert_true(fd >= 0);
    FILE *file = fdopen(fd, "w");
    for (int i = 0; i < 5000; i++)
        fprintf(file, "%d,0,100,0,0 # key %d\n", i, i);
    fclose(file);
    tc_flight_path path;
    tc_status status = tc_flight_path_load(&tc_plane_navigation, name, &path, NULL);
    unlink(name);
    assert_int_equal(status, TC_OK);
    assert_int_equal(path.count, 5000);
    assert_true(path.keys[4999].x == 4999);
    tc_flight_path_free(&path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(printed_views_come_back_exactly),
        cmocka_unit_test(the_whole_terrain_is_in_frame),
        cmocka_unit_test(never_below_ground),
        cmocka_unit_test(bounded_however_long_one_climbs),
        cmocka_unit_test(directions_and_speed),
        cmocka_unit_test(a_path_passes_its_keys),
        cmocka_unit_test(a_straight_path_is_even),
        cmocka_unit_test(over_the_pole_along_a_meridian),
        cmocka_unit_test(over_the_antimeridian),
        cmocka_unit_test(along_a_parallel),
        cmocka_unit_test(a_path_of_one_key_stands_still),
        cmocka_unit_test(bad_paths_name_the_line),
        cmocka_unit_test(a_path_file_is_read),
    };
    return cmocka_run_group_tests_name("flight", tests, NULL, NULL);
}
