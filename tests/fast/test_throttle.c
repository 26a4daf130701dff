/* test_throttle.c - the controller of complexity throttling against frames that cost what a model says: it gets there,
 * regrows, rests, and moves no faster than it says. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/view/throttle.h"
#include "tests/support/terrains.h"

static const double MOST = 3;

/* What frames cost: `full` milliseconds unthrottled, of which the share `fixed` is no matter of what is drawn; the rest
 * goes with 4^-throttle, all of it or, with steps, by so many leaps an octave. */
typedef struct model {
    double full, fixed;
    double steps;  /* an octave; 0: evenly */
    double noise;  /* relative, evenly spread to both sides */
    double spikes; /* share of frames that take six times as long */
    int late;      /* frames until a time is known */
} model;

typedef struct flight {
    tc_throttle throttle;
    test_random random;
    double shown[8]; /* throttle of the last frames */
    double fastest;  /* change in a frame */
    int turns;       /* of its direction */
    int way;
} flight;

static double cost(const model *m, flight *f, double throttle)
{
    double t = m->steps > 0 ? floor(throttle * m->steps) / m->steps : throttle;
    double ms = m->full * (m->fixed + (1 - m->fixed) * pow(4, -t));
    ms *= 1 + m->noise * (2 * test_random_unit(&f->random) - 1);
    return test_random_unit(&f->random) < m->spikes ? 6 * ms : ms;
}

static flight start(double target)
{
    return (flight){.throttle = tc_throttle_of(target), .random = {17}};
}

static int ascending(const void *a, const void *b)
{
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

enum { MOST_FRAMES = 20000 };

/* Draws frames; the median of what the last half of them took. */
static double fly(flight *f, const model *m, int frames)
{
    static double took[MOST_FRAMES];
    for (int i = 0; i < frames; i++) {
        double before = f->throttle.value;
        memmove(f->shown + 1, f->shown, sizeof f->shown - sizeof *f->shown);
        f->shown[0] = before;
        took[i] = cost(m, f, before);
        double now = tc_throttle_step(&f->throttle, cost(m, f, f->shown[m->late]), MOST), change = now - before;
        assert_true(now >= 0 && now <= MOST);
        f->fastest = fmax(f->fastest, fabs(change));
        int way = (change > 0) - (change < 0);
        f->turns += way && f->way && way != f->way;
        f->way = way ? way : f->way;
    }
    qsort(took + frames / 2, (size_t)(frames - frames / 2), sizeof *took, ascending);
    return took[(frames + frames / 2) / 2];
}

static const double TARGET = 20;

static void frames_come_to_the_target(void **state)
{
    (void)state;
    const struct {
        double full, fixed, steps, noise, spikes;
        int late;
    } cases[] = {{40, 0.1, 0, 0, 0, 0},      {40, 0.1, 0, 0.1, 0.05, 2},  {40, 0.1, 15, 0.1, 0.05, 2},
                 {40, 0.3, 4, 0.1, 0.02, 3}, {200, 0.02, 0, 0.1, 0.1, 2}, {25, 0.2, 8, 0.15, 0.05, 1},
                 {21, 0, 0, 0, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const model m = {cases[i].full, cases[i].fixed, cases[i].steps, cases[i].noise, cases[i].spikes, cases[i].late};
        flight f = start(TARGET);
        fly(&f, &m, 400); /* there, at the latest, after so many */
        int turns = f.turns;
        double took = fly(&f, &m, 4000);
        printf("throttle: %5.1f ms unthrottled: %5.2f for %g after 400 frames, throttle %.2f, %d turns, then %d\n",
               m.full, took, TARGET, f.throttle.value, turns, f.turns - turns);
        assert_true(took <= 1.02 * TARGET && took >= 0.6 * TARGET);
        assert_true(turns <= 1 && f.turns - turns <= 2);
        assert_true(f.fastest <= TC_THROTTLE_STEP * (1 + 1e-9));
    }
}

static void at_rest_it_stays_where_it_is(void **state)
{
    (void)state;
    const model even = {40, 0.1, 0, 0.05, 0, 2};
    flight f = start(TARGET);
    fly(&f, &even, 1000);
    double before = f.throttle.value;
    f.fastest = 0;
    fly(&f, &even, 1000);
    assert_true(f.throttle.value == before && f.fastest == 0);
    const model fast = {0.9 * TARGET, 0.1, 0, 0,
                        0.1,          2}; /* never throttled: each frame in ten takes six times as long */
    f = start(TARGET);
    fly(&f, &fast, 5000);
    assert_true(f.throttle.value == 0 && f.fastest == 0);
}

static void it_regrows_where_there_is_room(void **state)
{
    (void)state;
    const model heavy = {80, 0.05, 0, 0.1, 0.03, 2}, light = {10, 0.05, 0, 0.1, 0.03, 2},
                middle = {30, 0.05, 0, 0.1, 0.03, 2};
    flight f = start(TARGET);
    fly(&f, &heavy, 500);
    assert_true(f.throttle.value > 0.9);
    fly(&f, &light, 300);
    assert_true(f.throttle.value == 0); /* all is drawn again */
    fly(&f, &heavy, 500);
    double heavily = f.throttle.value;
    double took = fly(&f, &middle, 500);
    assert_true(f.throttle.value > 0 && f.throttle.value < heavily - 0.3);
    assert_true(took > 0.6 * TARGET && took < 1.02 * TARGET);
    assert_true(f.fastest <= TC_THROTTLE_STEP * (1 + 1e-9));
}

/* The target lies within a leap that is larger than the band of rest: it must not go to and fro across it for ever. */
static void a_leap_is_not_crossed_for_ever(void **state)
{
    (void)state;
    const model leap = {44, 0, 1, 0.05, 0.02, 2}; /* 44, 11, 2.75 ms */
    flight f = start(TARGET);
    int turns[4];
    for (int i = 0; i < 4; i++) {
        int before = f.turns;
        fly(&f, &leap, 5000);
        turns[i] = f.turns - before;
    }
    printf("throttle: over a leap from 44 to 11 ms: %d, %d, %d, %d turns in 5,000 frames each\n", turns[0], turns[1],
           turns[2], turns[3]);
    assert_true(turns[0] > 2); /* it tries */
    assert_true(turns[3] <= 10 && turns[3] < turns[0]);
    /* Another view brings haste again. */
    const model light = {5, 0, 1, 0.05, 0.02, 2};
    fly(&f, &light, 400);
    assert_true(f.throttle.value == 0);
}

static void what_cannot_be_reached_is_drawn_as_coarse_as_can_be(void **state)
{
    (void)state;
    const model hopeless = {400, 0.5, 0, 0.1, 0.02, 2};
    flight f = start(TARGET);
    fly(&f, &hopeless, 1000);
    assert_true(f.throttle.value == MOST && f.turns == 0);
    /* A surface that takes less, or none. */
    assert_true(tc_throttle_step(&f.throttle, 400, 1.5) == 1.5);
    assert_true(tc_throttle_step(&f.throttle, 400, 0) == 0);
}

static void times_that_are_none_are_not_heard(void **state)
{
    (void)state;
    const model heavy = {80, 0.05, 0, 0, 0, 0};
    flight f = start(TARGET);
    fly(&f, &heavy, 500);
    tc_throttle before = f.throttle;
    const double none[] = {NAN, INFINITY, -INFINITY, -1};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_true(tc_throttle_step(&f.throttle, none[i], MOST) == before.value);
    assert_memory_equal(&before, &f.throttle, sizeof before);
    for (int i = 0; i < 300; i++) /* a clock too coarse to see the frame */
        tc_throttle_step(&f.throttle, 0, MOST);
    assert_true(f.throttle.value == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_to_the_target),
        cmocka_unit_test(at_rest_it_stays_where_it_is),
        cmocka_unit_test(it_regrows_where_there_is_room),
        cmocka_unit_test(a_leap_is_not_crossed_for_ever),
        cmocka_unit_test(what_cannot_be_reached_is_drawn_as_coarse_as_can_be),
        cmocka_unit_test(times_that_are_none_are_not_heard),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
