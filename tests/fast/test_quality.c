/* test_quality.c - a window draws as well as pictures do while it can keep up, and always at rest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/view/quality.h"

/* Frames of a machine that takes so long for a sample a pixel and the finest mesh. */
static double took(const tc_quality *q, double sample_ms)
{
    return sample_ms * (0.4 + 0.6 * q->samples) / (1 + q->octaves);
}

/* So many frames, changed or not; how many of them were drawn. */
static int frames(tc_quality *q, int count, bool changed, double sample_ms)
{
    int drawn = 0;
    for (int i = 0; i < count; i++) {
        tc_quality_before(q, changed, 0.02);
        if (q->draws) {
            tc_quality_drawn(q, true);
            tc_quality_took(q, took(q, sample_ms), 2);
        }
        drawn += q->draws;
    }
    return drawn;
}

static void a_fast_machine_draws_at_its_best_always(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, true, true, 50, false);
    assert_int_equal(frames(&q, 1000, true, 4), 1000);
    assert_int_equal(q.samples, 4);
    assert_true(q.octaves == 0);
    assert_true(frames(&q, 1000, false, 4) < 20); /* then it rests */
    assert_true(q.stands && !q.draws);
    tc_quality_before(&q, true, 0.02);
    assert_true(q.draws && q.samples == 4);
}

static void a_slow_one_while_it_rests(void **state)
{
    (void)state;
    for (int slow = 0; slow < 2; slow++) {
        tc_quality q = tc_quality_of(4, true, true, 50, slow);
        if (slow)
            assert_int_equal(q.samples, 1);
        frames(&q, 400, true, 80);
        assert_int_equal(q.samples, 1);
        assert_true(q.octaves > 0.3 && took(&q, 80) < 60);
        double moving = q.octaves;
        assert_true(frames(&q, 100, false, 80) < 20);
        assert_int_equal(q.samples, 4); /* of the last one drawn */
        assert_true(q.octaves == 0 && q.stands);
        tc_quality_before(&q, true, 0.02); /* and on as before */
        assert_int_equal(q.samples, 1);
        assert_true(q.octaves == moving);
    }
}

static void what_is_not_whole_is_drawn_on(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, true, false, 50, false);
    for (int i = 0; i < 100; i++) {
        tc_quality_before(&q, false, 0.02);
        assert_true(q.draws);
        tc_quality_drawn(&q, false);
        tc_quality_took(&q, 10, 0);
    }
    frames(&q, 2, false, 1);
    assert_int_equal(q.samples, 4);
    assert_true(q.stands);
}

static void it_becomes_fine_again_where_there_is_room(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, true, true, 50, true);
    frames(&q, 400, true, 80);
    assert_int_equal(q.samples, 1);
    frames(&q, 2000, true, 4); /* a smaller window */
    assert_int_equal(q.samples, 4);
    int changes = 0, before = q.samples; /* and does not go to and fro */
    for (int i = 0; i < 2000; i++) {
        frames(&q, 1, true, 15);
        changes += q.samples != before;
        before = q.samples;
    }
    assert_true(changes <= 1);
}

/* With a heavy scene it became coarse; with a light one it is neither that any more nor of one sample. */
static void all_comes_back_in_motion(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, true, true, 50, false);
    frames(&q, 600, true, 200);
    assert_true(q.samples == 1 && q.octaves > 1);
    frames(&q, 6000, true, 3);
    assert_true(q.samples == 4 && q.octaves == 0);
    /* One long frame is nothing, least of all the first. */
    q = tc_quality_of(4, true, true, 50, false);
    frames(&q, 1, true, 200);
    frames(&q, 10, true, 4);
    assert_int_equal(q.samples, 4);
}

/* A frame that takes long in the middle of a motion is no rest. */
static void a_long_frame_is_no_rest(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, true, true, 50, true);
    frames(&q, 100, true, 80);
    tc_quality_before(&q, false, 0.4);
    assert_int_equal(q.samples, 1);
}

static void without_rest_each_frame_is_drawn(void **state)
{
    (void)state;
    tc_quality q = tc_quality_of(4, false, false, 50, true);
    assert_int_equal(frames(&q, 500, false, 500), 500);
    assert_int_equal(q.samples, 4);
    assert_true(q.octaves == 0);
    q = tc_quality_of(1, false, true, 50, false); /* as --target-ms has it in measured flights */
    assert_int_equal(frames(&q, 500, false, 120), 500);
    assert_true(q.octaves > 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_fast_machine_draws_at_its_best_always),
                                       cmocka_unit_test(a_slow_one_while_it_rests),
                                       cmocka_unit_test(what_is_not_whole_is_drawn_on),
                                       cmocka_unit_test(it_becomes_fine_again_where_there_is_room),
                                       cmocka_unit_test(all_comes_back_in_motion),
                                       cmocka_unit_test(a_long_frame_is_no_rest),
                                       cmocka_unit_test(without_rest_each_frame_is_drawn)};
    return cmocka_run_group_tests_name("quality", tests, NULL, NULL);
}
