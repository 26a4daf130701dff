/* frame_timer.c - what frames take; see frame_timer.h. */
#include "frame_timer.h"

#include <math.h>
#include <time.h>

#include "common/base/clock.h"

/* Processor time of this thread. */
static double thread_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

tc_frame_timer tc_frame_timer_create(const tc_gl *gl)
{
    tc_frame_timer t = {.waited = -1};
    GLint bits = 0;
    gl->GetQueryiv(GL_TIME_ELAPSED, GL_QUERY_COUNTER_BITS, &bits);
    t.waits = bits <= 0 || tc_gl_software((const char *)gl->GetString(GL_RENDERER));
    if (!t.waits)
        gl->CreateQueries(GL_TIME_ELAPSED, TC_FRAME_TIMES, t.query);
    return t;
}

void tc_frame_timer_destroy(const tc_gl *gl, tc_frame_timer *t)
{
    if (t->query[0])
        gl->DeleteQueries(TC_FRAME_TIMES, t->query);
    *t = (tc_frame_timer){0};
}

void tc_frame_timer_begin(const tc_gl *gl, tc_frame_timer *t)
{
    t->running = !t->waits && t->begun - t->read < TC_FRAME_TIMES;
    if (t->running)
        gl->BeginQuery(GL_TIME_ELAPSED, t->query[t->begun % TC_FRAME_TIMES]);
    t->start = t->waits ? tc_clock_ms() : thread_ms();
}

void tc_frame_timer_end(const tc_gl *gl, tc_frame_timer *t)
{
    if (t->waits) {
        gl->Finish();
        t->waited = tc_clock_ms() - t->start;
    } else if (t->running) {
        gl->EndQuery(GL_TIME_ELAPSED);
        t->processor_ms[t->begun++ % TC_FRAME_TIMES] = thread_ms() - t->start;
        t->running = false;
    }
}

bool tc_frame_timer_read(const tc_gl *gl, tc_frame_timer *t, double *ms_ret)
{
    if (t->waits) {
        *ms_ret = t->waited;
        t->waited = -1;
        return *ms_ret >= 0;
    }
    GLuint64 known = 0, ns = 0;
    int at = (int)(t->read % TC_FRAME_TIMES);
    if (t->read < t->begun)
        gl->GetQueryObjectui64v(t->query[at], GL_QUERY_RESULT_AVAILABLE, &known);
    if (!known)
        return false;
    gl->GetQueryObjectui64v(t->query[at], GL_QUERY_RESULT, &ns);
    t->read++;
    *ms_ret = fmax(t->processor_ms[at], 1e-6 * (double)ns);
    return true;
}
