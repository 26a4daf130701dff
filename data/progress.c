/* progress.c - see progress.h. */
#include "progress.h"

#include "common/base/clock.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

tc_progress tc_progress_begin(const char *what, bool quiet, bool verbose)
{
    return (tc_progress){.what = what, .quiet = quiet, .verbose = verbose, .start = tc_clock_ms(), .last = -INFINITY};
}

double tc_progress_seconds(const tc_progress *progress)
{
    return (tc_clock_ms() - progress->start) / 1000;
}

void tc_progress_show(tc_progress *p, double done)
{
    double now = tc_clock_ms();
    if (p->quiet || now - p->last < 100 || !isatty(STDERR_FILENO))
        return;
    p->last = now;
    p->shown = true;
    done = fmin(fmax(done, 0), 1);
    double seconds = (now - p->start) / 1000, left = done > 0 ? seconds * (1 - done) / done : 0;
    char rate[48] = "", rest[48] = "";
    if (p->samples > 0 && seconds > 0)
        snprintf(rate, sizeof rate, ", %.1f Msamples/s", done * p->samples / seconds * 1e-6);
    if (seconds > 1 && done > 0.01 && left < 1e6)
        snprintf(rest, sizeof rest, ", %d:%02d:%02d left", (int)(left / 3600), (int)fmod(left / 60, 60),
                 (int)fmod(left, 60));
    fprintf(stderr, "\r\033[K%s: %3.0f %%%s%s", p->what, floor(100 * done), rate, rest);
}

void tc_progress_end(tc_progress *p)
{
    if (p->shown)
        fputs("\r\033[K", stderr);
    p->shown = false;
}

void tc_progress_say(void *progress, bool warning, const char *line)
{
    const tc_progress *p = progress;
    /* In one piece, over the line if it is there; the next call draws it anew. */
    if (warning ? !p->quiet : p->verbose)
        fprintf(stderr, "%sterraclip: %s%s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", warning ? "warning: " : "",
                line);
}
