/* test_morph.c - the drawn surface moves no faster than the morph says.
 *
 * The viewer creeps over the terrain by 1/64 of the finest spacing, or climbs; the drawn height at fixed points may
 * change only by |z - z_c| times the change of alpha, whatever windows shift and levels drop meanwhile. Without morph
 * the same test must find the jumps. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "planar/square_internal.h"
#include "tests/support/terrains.h"

enum { N = 63, STEPS = 4096, POINTS = 1000 };

/* Terrains of 1025 x 1025 samples 30 m apart, some of them made of fewer. */
typedef struct walked {
    const char *name;
    terrain_kind kind;
    int synthesised; /* levels finer than the data */
} walked;
static const walked cliffs = {"cliffs of 4,000 m", TERRAIN_CLIFF, 0}, smooth = {"smooth", TERRAIN_SMOOTH, 0},
                    fine = {"synthesised", TERRAIN_DEFAULT, 4};

typedef struct walk {
    tc_field *field;
    tc_clipmap *clipmap;
    tc_camera camera;
    double x[POINTS], y[POINTS], drawn[POINTS], slack[POINTS];
} walk;

/* |z - z_c| at the corners of the cell of `level` that holds finest position (px, py); 0 outside its active region. */
static double cell_difference(const tc_clipmap *c, int level, double px, double py)
{
    const tc_clip_level *l = tc_clipmap_level(c, level);
    int64_t i = (int64_t)floor(px) >> l->shift, j = (int64_t)floor(py) >> l->shift, mask = tc_clipmap_n(c);
    double most = 0;
    for (int k = 0; k < 4; k++) {
        int64_t a = i + (k & 1), b = j + (k >> 1);
        if (a < l->active.x0 || b < l->active.y0 || a >= l->active.x1 || b >= l->active.y1)
            return 0;
        const float *z = tc_ground_heights(c, level)[(b & mask) * (mask + 1) + (a & mask)];
        most = fmax(most, fabs((double)z[0] - (double)z[1]));
    }
    return most;
}

/* The level drawn at the point, and with it how much the height may change when alpha of level l changes by
 * rate[l]. Both the level before and the one after a step count: at the seam they agree. */
static void look(walk *w, const double *alpha_step, bool no_morph, double *drawn, double *slack)
{
    tc_frame_options options = {.no_morph = no_morph};
    tc_level finest = tc_field_level(w->field, tc_field_info(w->field)->levels);
    square_viewer viewer = tc_square_viewer(w->clipmap, &w->camera, true);
    for (int k = 0; k < POINTS; k++) {
        assert_true(tc_square_height(w->clipmap, &viewer, &options, w->x[k], w->y[k], &drawn[k]));
        slack[k] = 0;
        for (int l = tc_clipmap_levels(w->clipmap); l >= 1 && slack[k] == 0; l--)
            slack[k] =
                alpha_step[l] * cell_difference(w->clipmap, l, w->x[k] / finest.spacing_x, w->y[k] / finest.spacing_y);
    }
}

static void settle(walk *w)
{
    tc_rect wanted[TC_MAX_LEVELS];
    square_viewer viewer = tc_square_viewer(w->clipmap, &w->camera, true);
    tc_square_wanted(w->clipmap, N, &viewer, wanted);
    tc_clipmap_update(w->clipmap, wanted, -1, true, 0);
    assert_true(tc_clipmap_resident(w->clipmap));
}

static walk start(const walked *g)
{
    int64_t apart = (int64_t)1 << g->synthesised, side = 1024 / apart + 1;
    walk w = {.field = terrain_synthesised(terrain_field(g->kind, side, side, 30 * (double)apart, 3), g->synthesised)};
    tc_ground_options options = {.n = N};
    assert_int_equal(tc_ground_create(w.field, &options, &w.clipmap, NULL), TC_OK);
    w.camera = (tc_camera){.x = 400 * 30 + 0.3, .y = 450 * 30 + 7, .z = 4100, .fov = 1.5, .width = 64, .height = 64};
    double ground;
    tc_field_height(w.field, w.camera.x, w.camera.y, &ground);
    w.camera.z = ground + 20;
    test_random r = {4};
    for (int k = 0; k < POINTS; k++) { /* around the path, most of them near */
        double reach = pow(2, test_random_range(&r, 2, 9)) * 30;
        w.x[k] = fmin(fmax(w.camera.x + test_random_range(&r, -reach, reach), 0), 1024 * 30);
        w.y[k] = fmin(fmax(w.camera.y + test_random_range(&r, -reach, reach), 0), 1024 * 30);
    }
    settle(&w);
    return w;
}

static void finish(walk *w)
{
    tc_clipmap_destroy(w->clipmap);
    tc_field_destroy(w->field);
}

/* Creeps; returns how many heights changed more than they may. */
static int creep(const walked *g, bool no_morph, double *worst)
{
    walk w = start(g);
    double alpha_step[TC_MAX_LEVELS + 1], drawn[POINTS], slack[POINTS];
    const double step = 30 / 64.0, direction = 0.6;
    for (int l = 1; l <= tc_clipmap_levels(w.clipmap); l++) /* in cells of the level, over the transition's width */
        alpha_step[l] = 1 / 64.0 / ldexp(1, tc_clipmap_level(w.clipmap, l)->shift) / (N / 10.0);
    look(&w, alpha_step, no_morph, w.drawn, w.slack);
    int jumps = 0, moved = 0;
    *worst = 0;
    for (int s = 0; s < STEPS; s++) {
        w.camera.x += step * cos(direction), w.camera.y += step * sin(direction);
        double ground; /* the height above ground stays: this walk is about x and y */
        tc_field_height(w.field, w.camera.x, w.camera.y, &ground);
        w.camera.z = ground + 20;
        settle(&w);
        look(&w, alpha_step, no_morph, drawn, slack);
        for (int k = 0; k < POINTS; k++) {
            double change = fabs(drawn[k] - w.drawn[k]);
            jumps += change > fmax(slack[k], w.slack[k]) + 1e-3;
            moved += change > 1e-3;
            *worst = fmax(*worst, change);
            w.drawn[k] = drawn[k], w.slack[k] = slack[k];
        }
    }
    assert_true(moved > 1000); /* it was no idle walk */
    finish(&w);
    return jumps;
}

static void heights_follow_the_morph(void **state)
{
    (void)state;
    const walked *const grounds[] = {&cliffs, &smooth, &fine};
    for (int k = 0; k < 3; k++) {
        double worst;
        assert_int_equal(creep(grounds[k], false, &worst), 0);
        printf("continuity, %s: largest change in a step %.5f m\n", grounds[k]->name, worst);
    }
}

static void without_morph_heights_jump(void **state)
{
    (void)state;
    const walked *const grounds[] = {&cliffs, &fine};
    for (int k = 0; k < 2; k++) {
        double worst;
        int jumps = creep(grounds[k], true, &worst);
        printf("continuity, %s, without morph: %d jumps, the largest %.2f m\n", grounds[k]->name, jumps, worst);
        assert_true(jumps > 100);
    }
}

static void climb(const walked *g)
{
    walk w = start(g);
    double alpha_step[TC_MAX_LEVELS + 1] = {0}, drawn[POINTS], slack[POINTS], ground;
    tc_field_height(w.field, w.camera.x, w.camera.y, &ground);
    look(&w, alpha_step, false, w.drawn, w.slack);
    int first = tc_clipmap_levels(w.clipmap), least = first;
    for (double h = 20; h < 12000; h *= 1.002) {
        for (int l = 1; l <= first; l++) /* from 0.64 to 0.80 n g_l */
            alpha_step[l] = 0.002 * h / (0.16 * N * tc_clipmap_level(w.clipmap, l)->spacing_x);
        w.camera.z = ground + h;
        settle(&w);
        look(&w, alpha_step, false, drawn, slack);
        for (int k = 0; k < POINTS; k++)
            assert_true(fabs(drawn[k] - w.drawn[k]) <= 1.01 * fmax(slack[k], w.slack[k]) + 1e-3);
        for (int k = 0; k < POINTS; k++)
            w.drawn[k] = drawn[k], w.slack[k] = slack[k];
        int active = 0;
        for (int l = 1; l <= first; l++)
            active += tc_clipmap_level(w.clipmap, l)->active.x1 > 0;
        least = active < least ? active : least;
    }
    assert_true(least < first); /* levels were dropped */
    finish(&w);
}

static void climbing_drops_levels_without_a_jump(void **state)
{
    (void)state;
    climb(&cliffs);
    climb(&fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_follow_the_morph),
        cmocka_unit_test(without_morph_heights_jump),
        cmocka_unit_test(climbing_drops_levels_without_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
