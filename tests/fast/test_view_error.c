/* test_view_error.c - the error on the screen from all heights: no height is worse than the others because a level has
 * just been left out, and rings are as fine as the frame calls for. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/measured.h"

enum { W = 160, H = 120 };

static tc_context *context;

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    tc_context_destroy(context);
    return 0;
}

static double error_of(scene *s, const measured *m, const tc_camera *c)
{
    const tc_truth truth = measured_truth(m);
    const tc_body body = measured_body(m);
    tc_error_stats e;
    assert_int_equal(tc_error_stats_init(&e), TC_OK);
    scene_draw(s, c, true);
    float *depth = planet_depth(s, c);
    assert_int_equal(tc_view_error_add(c, s->surface->near_plane, &body, depth, &truth, &e), TC_OK);
    double p999 = tc_error_stats_percentile(&e, 0.999);
    free(depth), tc_error_stats_free(&e);
    return p999;
}

/* n = 63 for 160 pixels and 90 degrees: cells of 5 pixels, as with 255 for 640. */
static void no_height_is_worse_than_others(void **state)
{
    (void)state;
    measured m = {.name = "default", .field = terrain_field(TERRAIN_DEFAULT, 1025, 1025, 30, 4)};
    scene s = measured_scene(context, &m, tc_clipmap_n_for(&(tc_camera){.fov = M_PI / 2, .width = W, .height = H}),
                             NULL, &(tc_scene_options){0});
    assert_int_equal(tc_clipmap_n(s.clipmap), 63);
    double worst = 0, worst_height = 0;
    for (double h = 20; h < 12000; h *= 1.12) {
        tc_camera c = measured_camera(&m, 3, 0, W, H);
        c.z += h - measured_height(&m, 3);
        c.pitch = -M_PI / 180 * (h < 500 ? 15 : 50);
        double p999 = error_of(&s, &m, &c);
        if (p999 > worst)
            worst = p999, worst_height = h;
    }
    print_message("squares, n 63, from 20 m to 12 km: 99.9 %% at most %.3f px, at %.0f m\n", worst, worst_height);
    assert_true(worst < 1.5);
    scene_destroy(&s), measured_close(&m);
}

/* A planet that is rough from sample to sample, and large enough for its samples to be seen. */
static void rings_are_as_fine_as_the_frame_calls_for(void **state)
{
    (void)state;
    measured m = {.name = "planet", .round = true};
    m.planet = planet_made(PLANET_DEFAULT, 1024, 1737400, 4);
    tc_camera frame = measured_camera(&m, 0, 0, 2 * W, 2 * H);
    frame.fov = 0.53; /* pixels as small as those of 640 and 60 degrees */
    int n_phi = tc_rings_n_phi_for(&frame);
    double worst[2] = {0};
    for (int k = 0; k < 2; k++) {
        scene s =
            measured_scene(context, &m, k ? n_phi / 64 * 32 : n_phi, &(tc_rings_options){0}, &(tc_scene_options){0});
        for (double h = 100; h < 2e6; h *= 2.5) {
            tc_camera c = measured_camera(&m, 1, 0, 2 * W, 2 * H);
            c.fov = frame.fov;
            c.z += h - measured_height(&m, 1);
            worst[k] = fmax(worst[k], error_of(&s, &m, &c));
        }
        scene_destroy(&s);
    }
    print_message("rings, n_phi %d, from 100 m to 2,000 km: 99.9 %% at most %.3f px; with half of them %.3f px\n",
                  n_phi, worst[0], worst[1]);
    assert_true(worst[0] < 1 && worst[1] > 1.2 * worst[0]);
    measured_close(&m);
}

/* Steps outwards are as long as those around, where indices allow so many. */
static void steps_follow_from_the_frame(void **state)
{
    (void)state;
    for (int n = 64; n <= 4096; n += 32) {
        int m = tc_rings_steps(n), most = n <= 1024 ? 64 : 128;
        assert_true(m >= 4 && m <= most && m % 2 == 0 && (n > 1024 || (m + 1) * (n + 64) <= 65535));
        assert_true(fabs(m - n / (4 * M_PI)) <= 1 || (n <= 1024 && (m + 3) * (n + 64) > 65535) || m == most);
    }
    assert_int_equal(tc_rings_steps(512), 40);
    static const struct {
        int width;
        double fov;
        int n_phi;
    } frame[] = {{160, 90, 512},   {640, 90, 512},   {640, 60, 512},  {1280, 75, 512},
                 {1920, 75, 1024}, {3840, 75, 2048}, {3840, 40, 4096}};
    for (int i = 0; i < 7; i++) {
        tc_camera c = {.fov = frame[i].fov * M_PI / 180, .width = frame[i].width, .height = 480};
        assert_int_equal(tc_rings_n_phi_for(&c), frame[i].n_phi);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_height_is_worse_than_others),
        cmocka_unit_test(rings_are_as_fine_as_the_frame_calls_for),
        cmocka_unit_test(steps_follow_from_the_frame),
    };
    return cmocka_run_group_tests_name("view error", tests, set_up, tear_down);
}
