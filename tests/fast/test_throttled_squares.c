/* test_throttled_squares.c - square grids drawn coarser than their windows: levels surround each other as ever, heights
 * follow the throttle evenly, and more of it is never more triangles. No OpenGL. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/view/throttle.h"
#include "planar/square_internal.h"
#include "tests/support/terrains.h"

enum { SIZE = 1025, SPACING = 30, POINTS = 800 };

typedef struct stage {
    tc_field *field;
    tc_surface *surface;
    tc_windows windows;
    tc_view *view;
    tc_frame frame;
    tc_camera camera;
    double error;
} stage;

/* error_px: the tolerance that blocks are chosen by; 0: none. */
static stage stage_of(terrain_kind kind, int width, int height, int n, double error_px)
{
    stage s = {.field = terrain_field(kind, width, height, SPACING, 3), .error = error_px};
    const tc_square_blocks blocks = {.shaded_n = n};
    const tc_ground_options options = {.n = n};
    tc_error error;
    if (tc_square_create(s.field, &options, error_px > 0 ? &blocks : NULL, &s.surface, &error) ||
        s.surface->make_windows(s.surface, &s.windows, &error) || !(s.view = tc_view_allocate(s.surface)) ||
        !tc_frame_allocate(s.surface, &s.frame))
        exit(99);
    return s;
}

static void stage_end(stage *s)
{
    tc_frame_free(&s->frame);
    free(s->view);
    tc_windows_destroy(&s->windows);
    s->surface->destroy(s->surface);
    tc_field_destroy(s->field);
}

static tc_camera camera_at(const tc_field *field, double x, double y, double above)
{
    tc_camera c = {.x = x, .y = y, .heading = 0.6, .pitch = -0.3, .fov = 1.3, .width = 640, .height = 480};
    tc_field_height(field, x, y, &c.z);
    c.z += above;
    return c;
}

/* The camera's view, its windows brought towards it; budget < 0: all of them. */
static void look(stage *s, const tc_camera *camera, double throttle, int64_t budget)
{
    tc_rect wanted[TC_MAX_CHARTS][TC_MAX_LEVELS];
    const tc_frame_options options = {.throttle = throttle, .error = s->error};
    s->camera = *camera;
    s->surface->look(s->surface, &s->windows, camera, &options, true, s->view);
    s->surface->wanted(s->view, wanted);
    tc_clipmap_update(s->windows.clipmap[0], wanted[0], budget, true, 0);
}

static const tc_clipmap *clipmap_of(const stage *s)
{
    return s->windows.clipmap[0];
}

static tc_rect region(const stage *s, int level)
{
    const square_viewer viewer = tc_square_viewer(clipmap_of(s), &s->camera, true);
    return tc_square_region(clipmap_of(s), level, &viewer, &s->view->options);
}

static const double steps[] = {0, 1e-9, 0.02, 0.3, 0.5, 0.77, 1, 1.31, 1.7, 2, 2.05, 2.5, 3, 7};
enum { STEPS = sizeof steps / sizeof *steps };

/* ---- Regions ----------------------------------------------------------------------------------------------------- */

/* Within eroded by 2, in the coarser level's samples, of which nothing is eroded where the terrain ends. */
static bool surrounded(tc_rect fine, tc_rect coarse, tc_rect extent)
{
    return fine.x0 / 2 >= coarse.x0 + (coarse.x0 > extent.x0 ? 2 : 0) &&
           fine.y0 / 2 >= coarse.y0 + (coarse.y0 > extent.y0 ? 2 : 0) &&
           (fine.x1 - 1) / 2 <= coarse.x1 - 1 - (coarse.x1 < extent.x1 ? 2 : 0) &&
           (fine.y1 - 1) / 2 <= coarse.y1 - 1 - (coarse.y1 < extent.y1 ? 2 : 0);
}

static void check_regions(const stage *s, double throttle)
{
    const tc_clipmap *c = clipmap_of(s);
    for (int l = 1; l <= tc_clipmap_levels(c); l++) {
        const tc_clip_level *v = tc_clipmap_level(c, l);
        tc_rect r = region(s, l);
        assert_true(tc_rect_within(r, v->active));
        assert_true(throttle > 0 || tc_rect_equal(r, v->active));
        if (tc_rect_empty(r))
            continue;
        assert_true(r.x1 - r.x0 >= 3 && r.y1 - r.y0 >= 3);
        assert_true(!(r.x0 & 1) && !(r.y0 & 1) && !((r.x1 - 1) & 1) && !((r.y1 - 1) & 1));
        if (l == 1)
            continue;
        tc_rect coarser = region(s, l - 1);
        assert_true(!tc_rect_empty(coarser) && surrounded(r, coarser, tc_clipmap_level(c, l - 1)->extent));
        /* Along the perimeter alpha is 1, and the coarser level's 0. */
        const square_viewer viewer = tc_square_viewer(c, &s->camera, true);
        square_morph own = tc_square_morph(c, l, &viewer, &s->view->options);
        square_morph its = tc_square_morph(c, l - 1, &viewer, &s->view->options);
        double cell = ldexp(1, v->shift);
        for (int side = 0; side < 4; side++) {
            bool ends = side == 0   ? r.x0 == v->extent.x0
                        : side == 1 ? r.x1 == v->extent.x1
                        : side == 2 ? r.y0 == v->extent.y0
                                    : r.y1 == v->extent.y1;
            for (int k = 0; k <= 16 && !ends; k++) {
                double t = k / 16.0,
                       x = side < 2 ? (double)(side ? r.x1 - 1 : r.x0) : (double)r.x0 + t * (double)(r.x1 - 1 - r.x0);
                double y =
                    side < 2 ? (double)r.y0 + t * (double)(r.y1 - 1 - r.y0) : (double)(side == 3 ? r.y1 - 1 : r.y0);
                x -= (double)viewer.snap_x / cell, y -= (double)viewer.snap_y / cell;
                assert_true(tc_square_alpha(&own, x, y) == 1);
                assert_true(tc_square_alpha(&its, 0.5 * x, 0.5 * y) == 0);
            }
        }
    }
}

static void levels_surround_each_other(void **state)
{
    (void)state;
    static const int sides[][2] = {{1025, 1025}, {1000, 613}};
    test_random r = {5};
    for (int k = 0; k < 2; k++)
        for (int n = 31; n <= 127; n = 2 * n + 1) {
            stage s = stage_of(TERRAIN_CLIFF, sides[k][0], sides[k][1], n, 0);
            double w = (sides[k][0] - 1) * SPACING, h = (sides[k][1] - 1) * SPACING;
            for (int i = 0; i < 400; i++) {
                bool lagging = i & 1;
                double beyond = i % 5 == 0 ? 0.3 : 0;
                tc_camera c =
                    camera_at(s.field, test_random_range(&r, -beyond, 1 + beyond) * w,
                              test_random_range(&r, -beyond, 1 + beyond) * h, pow(10, test_random_range(&r, 0, 4.5)));
                double throttle = i % 3 ? steps[i % STEPS] : test_random_range(&r, 0, 3);
                look(&s, &c, throttle, lagging ? test_random_int(&r, n, n * n) : -1);
                check_regions(&s, throttle);
            }
            stage_end(&s);
        }
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

/* |z - z_c| at the corners of the cell that is drawn at the point. */
static double difference(const stage *s, double x, double y)
{
    const tc_clipmap *c = clipmap_of(s);
    for (int l = tc_clipmap_levels(c); l >= 1; l--) {
        const tc_clip_level *v = tc_clipmap_level(c, l);
        tc_rect r = region(s, l);
        int64_t i = (int64_t)floor(x / SPACING) >> v->shift, j = (int64_t)floor(y / SPACING) >> v->shift;
        if (i < r.x0 || j < r.y0 || i + 1 >= r.x1 || j + 1 >= r.y1)
            continue;
        double most = 0;
        int64_t mask = tc_clipmap_n(c);
        for (int k = 0; k < 4; k++) {
            const float *z = tc_ground_heights(c, l)[((j + (k >> 1)) & mask) * (mask + 1) + ((i + (k & 1)) & mask)];
            most = fmax(most, fabs((double)z[0] - (double)z[1]));
        }
        return most;
    }
    return 0;
}

/* Moves the throttle up and down again while the view stands still. Returns the largest change, and how many there are
 * that the morph does not account for: alpha changes by no more than `rate` an octave. */
static double sweep(stage *s, double above, bool no_morph, int *jumps_ret)
{
    const double rate = 4.3; /* 6 ln 2 of the ramps, ln 2 / 0.2 of the passage by height */
    const double step = TC_THROTTLE_STEP;
    double x[POINTS], y[POINTS], before[POINTS], slack[POINTS], worst = 0;
    tc_camera c = camera_at(s->field, 401.3 * SPACING, 450.2 * SPACING, above);
    test_random r = {4};
    for (int k = 0; k < POINTS; k++) {
        double reach = pow(2, test_random_range(&r, 2, 9)) * SPACING;
        x[k] = fmin(fmax(c.x + test_random_range(&r, -reach, reach), 0), (SIZE - 1) * SPACING - 1);
        y[k] = fmin(fmax(c.y + test_random_range(&r, -reach, reach), 0), (SIZE - 1) * SPACING - 1);
    }
    int count = (int)ceil(2 * s->surface->most_throttle / step);
    *jumps_ret = 0;
    look(s, &c, 0, -1);
    for (int i = 0; i <= count; i++) {
        double throttle = s->surface->most_throttle - fabs(i * step - s->surface->most_throttle);
        look(s, &c, throttle, -1);
        s->view->options.no_morph = no_morph;
        for (int k = 0; k < POINTS; k++) {
            double z, own = difference(s, x[k], y[k]);
            assert_true(s->surface->height(s->view, x[k], y[k], &z));
            double change = i ? fabs(z - before[k]) : 0;
            *jumps_ret += i && change > 1.02 * rate * step * fmax(own, slack[k]) + 1e-3;
            worst = fmax(worst, change);
            before[k] = z, slack[k] = own;
        }
    }
    return worst;
}

static void heights_follow_the_throttle(void **state)
{
    (void)state;
    static const struct {
        terrain_kind kind;
        const char *name;
    } kinds[] = {{TERRAIN_CLIFF, "cliffs of 4,000 m"}, {TERRAIN_SMOOTH, "smooth"}, {TERRAIN_DEFAULT, "the default"}};
    for (int k = 0; k < 3; k++)
        for (int n = 63; n <= 127; n = 2 * n + 1) {
            stage s = stage_of(kinds[k].kind, SIZE, SIZE, n, 0);
            double worst = 0;
            for (double above = 2; above < 2e4; above *= 3.7) {
                int jumps;
                worst = fmax(worst, sweep(&s, above, false, &jumps));
                assert_int_equal(jumps, 0);
            }
            printf("throttled, %s, n %d: largest change in a step %.3f m\n", kinds[k].name, n, worst);
            stage_end(&s);
        }
}

static void without_morph_heights_jump(void **state)
{
    (void)state;
    stage s = stage_of(TERRAIN_CLIFF, SIZE, SIZE, 63, 0);
    int jumps;
    double worst = sweep(&s, 20, true, &jumps);
    printf("throttled without morph: %d jumps, the largest %.0f m\n", jumps, worst);
    assert_true(jumps > 100);
    stage_end(&s);
}

/* ---- Triangles --------------------------------------------------------------------------------------------------- */

static tc_frame *draws(stage *s, const tc_camera *camera, double throttle)
{
    look(s, camera, throttle, -1);
    const tc_layers layers = {.held = {tc_clipmap_levels(clipmap_of(s))}, .ready = {tc_clipmap_levels(clipmap_of(s))}};
    s->surface->draws(s->view, &layers, &s->frame);
    return &s->frame;
}

/* Of all of them. Within a view it is so but for what blocks are cut to: a coarser level's block reaches farther beyond
 * the view than the finer ones that it replaces. */
static void more_is_never_more_triangles(void **state)
{
    (void)state;
    enum { N = 127, BLOCK = (N + 1) / 16, STEP = 150, VIEWS = 60 };
    stage s = stage_of(TERRAIN_DEFAULT, SIZE, SIZE, N, 0);
    test_random r = {9};
    double extent = (SIZE - 1) * SPACING, left = 0;
    int64_t most = 0;
    int risen = 0, many = 0;
    for (int v = 0; v < VIEWS; v++) {
        tc_camera c = camera_at(s.field, test_random_range(&r, 0, extent), test_random_range(&r, 0, extent),
                                pow(10, test_random_range(&r, 0, 4)));
        c.heading = test_random_range(&r, 0, 6.28), c.pitch = test_random_range(&r, -1.2, 0.1);
        int64_t seen = INT64_MAX, all = INT64_MAX, first = 0;
        for (int i = 0; i <= STEP; i++) {
            const tc_frame *f = draws(&s, &c, s.surface->most_throttle * i / STEP);
            assert_true(f->triangles_unculled <= all && f->triangles <= f->triangles_unculled);
            first = i ? first : f->triangles;
            risen += f->triangles > seen;
            most = tc_max64(most, i ? f->triangles - seen : 0);
            seen = f->triangles, all = f->triangles_unculled;
        }
        many += first > 4000, left += first > 4000 ? (double)seen / (double)first : 0;
    }
    printf("throttled: triangles within the view rise in %d of %d steps, by at most %lld; of more than 4,000 %.3f are "
           "left at most_throttle\n",
           risen, STEP * VIEWS, (long long)most, left / many);
    assert_true(most <= 2 * 2 * BLOCK * BLOCK && risen < STEP * VIEWS / 20);
    assert_true(many > 10 && left / many < 0.15);
    stage_end(&s);
}

/* By a tolerance a throttled frame has a larger one, and shorter windows. From not far above the ground: from high up a
 * level is dropped as a whole, as nests drop theirs. */
static void by_a_tolerance_it_is_evenly_fewer(void **state)
{
    (void)state;
    enum { STEP = 100, VIEWS = 12 };
    stage s = stage_of(TERRAIN_DEFAULT, SIZE, SIZE, 255, 1);
    test_random r = {9};
    const double extent = (SIZE - 1) * SPACING;
    double rise = 0, drop = 0, left = 0;
    int many = 0;
    for (int v = 0; v < VIEWS; v++) {
        const tc_camera c = camera_at(s.field, test_random_range(&r, 0, extent), test_random_range(&r, 0, extent),
                                      pow(10, test_random_range(&r, 0, 3)));
        int64_t first = 0, before = 0, least = INT64_MAX;
        for (int i = 0; i <= STEP; i++) {
            const int64_t all = draws(&s, &c, s.surface->most_throttle * i / STEP)->triangles_unculled;
            first = i ? first : all;
            if (first < 4000)
                break;
            if (i) {
                rise = fmax(rise, (double)(all - least) / (double)first);
                drop = fmax(drop, (double)(before - all) / (double)first);
            }
            before = all, least = tc_min64(least, all);
        }
        many += first >= 4000, left += first >= 4000 ? (double)before / (double)first : 0;
    }
    printf("throttled, by a tolerance: triangles rise by at most %.4f of the first ones and fall by at most %.3f in a "
           "step; %.3f are left at most_throttle %.2f, of %d views\n",
           rise, drop, left / many, s.surface->most_throttle, many);
    assert_true(many > VIEWS / 3);
    assert_true(rise < 0.01 && drop < 0.1 && left / many < 0.3);
    stage_end(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_surround_each_other),        cmocka_unit_test(heights_follow_the_throttle),
        cmocka_unit_test(without_morph_heights_jump),        cmocka_unit_test(more_is_never_more_triangles),
        cmocka_unit_test(by_a_tolerance_it_is_evenly_fewer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
