/* frame_clock.c - how long frames take. */
#include "frame_clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/clock.h"

enum { IN_A_ROW = 8 };

frame_clock frame_clock_of(const tc_gl *gl, bool gpu)
{
    frame_clock c = {.gl = gl, .gpu = gpu};
    if (gpu)
        gl->CreateQueries(GL_TIME_ELAPSED, 1, &c.query);
    return c;
}

frame_clock frame_clock_create(const tc_context *context)
{
    const tc_gl *gl = tc_context_gl(context);
    const char *renderer = (const char *)gl->GetString(GL_RENDERER);
    bool device = strcmp(tc_context_backend(context), "egl-device") == 0;
    return frame_clock_of(gl, device && renderer && !tc_gl_software(renderer));
}

void frame_clock_destroy(frame_clock *clock)
{
    if (clock->gpu)
        clock->gl->DeleteQueries(1, &clock->query);
    *clock = (frame_clock){0};
}

double frame_clock_ms(const frame_clock *clock, frame_function draw, void *context)
{
    const tc_gl *gl = clock->gl;
    if (!clock->gpu) {
        double start = tc_clock_ms();
        draw(context, true);
        return tc_clock_ms() - start;
    }
    GLuint64 ns = 0;
    gl->Finish();
    gl->BeginQuery(GL_TIME_ELAPSED, clock->query);
    for (int i = 0; i < IN_A_ROW; i++)
        draw(context, false);
    gl->EndQuery(GL_TIME_ELAPSED);
    gl->GetQueryObjectui64v(clock->query, GL_QUERY_RESULT, &ns); /* waits for it */
    if (gl->GetError() != GL_NO_ERROR) {
        fputs("frame clock: the driver's timer query failed\n", stderr);
        exit(99);
    }
    return 1e-6 * (double)ns / IN_A_ROW;
}

void frame_clock_repeat(const frame_clock *clock, frame_function draw, void *context, int count, double *ms)
{
    for (int i = 0; i < count; i++)
        ms[i] = frame_clock_ms(clock, draw, context);
}
