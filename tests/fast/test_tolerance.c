/* test_tolerance.c - heights drawn by a tolerance move no faster than it allows, and are off by no more than it.
 *
 * Where blocks are chosen by their error, a viewer who moves by s metres changes no drawn height by more than RATE T s
 * / S (common/blocks/block_errors.h), whatever blocks and levels come and go. Without alpha the same walk must find
 * jumps. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "common/view/camera.h"
#include "planar/square_internal.h"
#include "tests/support/terrains.h"

enum { N = 1023, STEPS = 200, POINTS = 2000, SIDE = 1025, SPACING = 30 };
static const double RATE = 4;

typedef struct walk {
    tc_field *field;
    tc_surface *surface;
    tc_windows windows;
    tc_view *view;
    tc_camera camera;
    tc_frame_options options;
    double x[POINTS], y[POINTS], drawn[POINTS];
} walk;

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "tolerance: %s\n", error->text);
        exit(1);
    }
}

static void see(walk *w)
{
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    w->surface->look(w->surface, &w->windows, &w->camera, &w->options, true, w->view);
    w->surface->wanted(w->view, wanted);
    tc_clipmap_update(w->windows.clipmap[0], wanted[0], -1, true, 0);
    assert_true(tc_clipmap_resident(w->windows.clipmap[0]));
    w->surface->look(w->surface, &w->windows, &w->camera, &w->options, true, w->view);
}

static void begin(walk *w, terrain_kind kind, double error)
{
    tc_error e;
    *w = (walk){.field = terrain_field(kind, SIDE, SIDE, SPACING, 3), .options = {.error = error}};
    must(
        tc_square_create(w->field, &(tc_ground_options){.n = N}, &(tc_square_blocks){.shaded_n = 255}, &w->surface, &e),
        &e);
    must(w->surface->make_windows(w->surface, &w->windows, &e), &e);
    w->view = tc_view_allocate(w->surface);
    w->camera = (tc_camera){.x = 400 * SPACING + 0.3, .y = 450 * SPACING + 7, .fov = 1.5, .width = 640, .height = 480};
    test_random r = {4};
    for (int k = 0; k < POINTS; k++) { /* around the path, most of them near */
        const double reach = pow(2, test_random_range(&r, 0, 9)) * SPACING;
        w->x[k] = fmin(fmax(w->camera.x + test_random_range(&r, -reach, reach), 0), (SIDE - 1) * SPACING);
        w->y[k] = fmin(fmax(w->camera.y + test_random_range(&r, -reach, reach), 0), (SIDE - 1) * SPACING);
    }
}

static void end(walk *w)
{
    free(w->view);
    tc_windows_destroy(&w->windows);
    w->surface->destroy(w->surface);
    tc_field_destroy(w->field);
}

static double ground_at(const walk *w, double x, double y)
{
    double z;
    assert_int_equal(tc_field_height(w->field, x, y, &z), TC_OK);
    return z;
}

/* Creeps and climbs; returns heights that changed more than they may. */
static int creep(terrain_kind kind, double error, bool no_morph, double *worst)
{
    static walk w;
    int jumps = 0, moved = 0;
    begin(&w, kind, error);
    w.options.no_morph = no_morph;
    w.camera.z = ground_at(&w, w.camera.x, w.camera.y) + 5;
    *worst = 0;
    for (int s = 0; s <= STEPS; s++) {
        const double way[3] = {3 * cos(0.6), 3 * sin(0.6), s < STEPS / 2 ? 0 : 0.01 * (w.camera.z - 2000)};
        const double allowed = RATE * error / tc_camera_pixel_scale(&w.camera) * sqrt(9 + way[2] * way[2]);
        see(&w);
        for (int k = 0; k < POINTS; k++) {
            double z, change;
            assert_true(w.surface->height(w.view, w.x[k], w.y[k], &z));
            change = fabs(z - w.drawn[k]);
            if (s > 0) {
                jumps += change > allowed + 0.02;
                moved += change > 1e-3;
                *worst = fmax(*worst, change / allowed);
            }
            w.drawn[k] = z;
        }
        w.camera.x += way[0], w.camera.y += way[1], w.camera.z += way[2];
    }
    assert_true(moved > 100); /* it was no idle walk */
    end(&w);
    return jumps;
}

/* Tolerances for which windows are large enough, or heights would move by what distance asks for. */
static const struct {
    terrain_kind kind;
    const char *name;
    double error;
} walks[] = {{TERRAIN_CLIFF, "cliffs", 300},
             {TERRAIN_SMOOTH, "hills", 0.5},
             {TERRAIN_SMOOTH, "hills", 4},
             {TERRAIN_DEFAULT, "default terrain", 1},
             {TERRAIN_DEFAULT, "default terrain", 3}};

static void heights_move_no_faster(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof walks / sizeof *walks; k++) {
        double worst;
        const int jumps = creep(walks[k].kind, walks[k].error, false, &worst);
        printf("tolerance %.1f px, %s: %d jumps, largest change %.3f of what is allowed\n", walks[k].error,
               walks[k].name, jumps, worst);
        assert_int_equal(jumps, 0);
    }
}

static void without_alpha_heights_jump(void **state)
{
    (void)state;
    double worst;
    const int jumps = creep(TERRAIN_DEFAULT, 2, true, &worst);
    printf("tolerance 2 px, without alpha: %d jumps, the largest %.1f times what is allowed\n", jumps, worst);
    assert_true(jumps > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_move_no_faster),
        cmocka_unit_test(without_alpha_heights_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
