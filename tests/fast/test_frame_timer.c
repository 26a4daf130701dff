/* test_frame_timer.c - what frames take, with drivers that are made up: answers that come late or never, no timer, a
 * software renderer. */
#include "tests/support/test.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/base/clock.h"
#include "common/gl/frame_timer.h"
#include "common/view/throttle.h"

/* ---- A driver ---------------------------------------------------------------------------------------------------- */

static struct {
    const char *name;
    GLint bits;
    int late; /* frames until an answer is there */
    int created, deleted, begun, ended, finished, waited_for;
    GLuint running;
    int ended_at[64]; /* frame, by query */
    GLuint64 took[64], next;
} driver;

static const GLubyte *APIENTRY get_string(GLenum what)
{
    assert_int_equal(what, GL_RENDERER);
    return (const GLubyte *)driver.name;
}
static void APIENTRY get_queryiv(GLenum target, GLenum what, GLint *value)
{
    assert_int_equal(target, GL_TIME_ELAPSED);
    assert_int_equal(what, GL_QUERY_COUNTER_BITS);
    *value = driver.bits;
}
static void APIENTRY create_queries(GLenum target, GLsizei count, GLuint *names)
{
    assert_int_equal(target, GL_TIME_ELAPSED);
    for (GLsizei i = 0; i < count; i++)
        names[i] = (GLuint)++driver.created;
}
static void APIENTRY delete_queries(GLsizei count, const GLuint *names)
{
    assert_true(names[0] > 0);
    driver.deleted += count;
}
static void APIENTRY begin_query(GLenum target, GLuint name)
{
    assert_int_equal(target, GL_TIME_ELAPSED);
    assert_int_equal(driver.running, 0);
    driver.running = name;
    driver.begun++;
}
static void APIENTRY end_query(GLenum target)
{
    assert_int_equal(target, GL_TIME_ELAPSED);
    assert_true(driver.running > 0);
    driver.took[driver.running] = driver.next;
    driver.ended_at[driver.running] = driver.ended++;
    driver.running = 0;
}
static void APIENTRY get_query_result(GLuint name, GLenum what, GLuint64 *value)
{
    bool there = driver.ended > driver.ended_at[name] + driver.late;
    driver.waited_for += what == GL_QUERY_RESULT && !there;
    *value = what == GL_QUERY_RESULT_AVAILABLE ? there : driver.took[name];
}
static void APIENTRY finish(void)
{
    usleep(20000); /* what is still to be drawn */
    driver.finished++;
}

static const tc_gl gl = {.GetString = get_string,
                         .GetQueryiv = get_queryiv,
                         .CreateQueries = create_queries,
                         .DeleteQueries = delete_queries,
                         .BeginQuery = begin_query,
                         .EndQuery = end_query,
                         .GetQueryObjectui64v = get_query_result,
                         .Finish = finish};

static void work_for(double ms) /* of this thread's processor time */
{
    struct timespec t;
    double from = -1, now;
    do {
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        now = (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
        from = from < 0 ? now : from;
    } while (now < from + ms);
}

/* A frame that takes the thread so long and the GPU so long, and waits within and behind it, as for a screen. */
static void frame(tc_frame_timer *t, double processor_ms, double gpu_ms, double waits_ms)
{
    tc_frame_timer_begin(&gl, t);
    work_for(processor_ms);
    usleep((useconds_t)(waits_ms * 1e3));
    driver.next = (GLuint64)(gpu_ms * 1e6);
    tc_frame_timer_end(&gl, t);
    usleep((useconds_t)(waits_ms * 1e3));
}

/* ---- Tests ------------------------------------------------------------------------------------------------------- */

static void a_gpu_is_asked_without_waiting(void **state)
{
    (void)state;
    memset(&driver, 0, sizeof driver);
    driver.name = "NVIDIA H200", driver.bits = 64, driver.late = 2;
    tc_frame_timer t = tc_frame_timer_create(&gl);
    double ms[40];
    int told = 0;
    for (int i = 0; i < 40; i++) {
        /* The GPU takes 7, 8, 9, ... ms, and in between the processor more than that. */
        frame(&t, i % 4 == 3 ? 60 : 0.1, 7 + i, i < 2 ? 30 : 0);
        while (tc_frame_timer_read(&gl, &t, &ms[told]))
            told++;
        assert_int_equal(told, i < 2 ? 0 : i - 1);
    }
    for (int i = 0; i < told; i++)
        if (i % 4 == 3) /* the slower of both; what the thread waits for is not its time */
            assert_true(ms[i] >= 59 && ms[i] < 90);
        else
            assert_float_equal(ms[i], 7 + i, 1e-6);
    assert_true(driver.finished == 0 && driver.waited_for == 0 && driver.begun == 40);
    tc_frame_timer_destroy(&gl, &t);
    assert_int_equal(driver.created, driver.deleted);
}

/* One that is a dozen frames late, or never answers, is not waited for; frames beyond the ring are not measured. */
static void late_answers_are_not_waited_for(void **state)
{
    (void)state;
    for (int never = 0; never < 2; never++) {
        memset(&driver, 0, sizeof driver);
        driver.name = "Intel", driver.bits = 36, driver.late = never ? 1000000 : TC_FRAME_TIMES - 1;
        tc_frame_timer t = tc_frame_timer_create(&gl);
        double ms;
        int told = 0;
        for (int i = 0; i < 100; i++) {
            frame(&t, 0, 5, 0);
            while (tc_frame_timer_read(&gl, &t, &ms))
                told++;
        }
        assert_int_equal(driver.begun, never ? TC_FRAME_TIMES : 100);
        assert_true(never ? told == 0 : told > 90);
        assert_true(driver.waited_for == 0 && driver.finished == 0);
        tc_frame_timer_destroy(&gl, &t);
    }
}

/* The clock runs until all is drawn, and no longer. */
static void without_a_timer_all_is_waited_for(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int bits;
    } drivers[] = {{"llvmpipe (LLVM 15.0.6, 256 bits)", 64}, {"Old card", 0}};
    for (int k = 0; k < 2; k++) {
        memset(&driver, 0, sizeof driver);
        driver.name = drivers[k].name, driver.bits = drivers[k].bits;
        tc_frame_timer t = tc_frame_timer_create(&gl);
        double ms, least = 1e9;
        for (int i = 0; i < 5; i++) {
            frame(&t, 5, 1000, 0);
            usleep(60000); /* the swap */
            assert_true(tc_frame_timer_read(&gl, &t, &ms));
            assert_true(ms >= 24.9);
            least = ms < least ? ms : least;
            assert_false(tc_frame_timer_read(&gl, &t, &ms));
        }
        assert_true(least < 60);
        assert_true(driver.finished == 5 && driver.created == 0 && driver.begun == 0);
        tc_frame_timer_destroy(&gl, &t);
        assert_int_equal(driver.deleted, 0);
    }
}

/* A screen of 60 Hz: each frame waits for its turn, the GPU takes 5 ms. With a target of 10 nothing is throttled. */
static void the_screens_turn_does_not_throttle(void **state)
{
    (void)state;
    memset(&driver, 0, sizeof driver);
    driver.name = "AMD Radeon", driver.bits = 64, driver.late = 2;
    tc_frame_timer t = tc_frame_timer_create(&gl);
    tc_throttle throttle = tc_throttle_of(10);
    for (int i = 0; i < 40; i++) {
        double ms;
        frame(&t, 0.2, 5, 8);
        while (tc_frame_timer_read(&gl, &t, &ms))
            tc_throttle_step(&throttle, ms, 3);
    }
    assert_true(throttle.value == 0);
    tc_frame_timer_destroy(&gl, &t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gpu_is_asked_without_waiting),
        cmocka_unit_test(late_answers_are_not_waited_for),
        cmocka_unit_test(without_a_timer_all_is_waited_for),
        cmocka_unit_test(the_screens_turn_does_not_throttle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
