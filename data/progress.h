/* progress.h - what a subcommand tells a person while it works: a line that is redrawn, warnings, and no line in a
 * pipe. */
#ifndef TC_PROGRESS_H
#define TC_PROGRESS_H

#include "common/terraclip.h"

typedef struct tc_progress {
    const char *what; /* "pack" */
    double samples;   /* all of the work; 0: no rate is shown */
    bool quiet;       /* neither warnings nor the line */
    bool verbose;
    bool shown;         /* the line is there */
    double start, last; /* ms */
} tc_progress;

tc_progress tc_progress_begin(const char *what, bool quiet, bool verbose);

/* Redraws the line. done: 0 to 1. */
void tc_progress_show(tc_progress *progress, double done);

/* Takes the line away. */
void tc_progress_end(tc_progress *progress);

/* Seconds since the beginning. */
double tc_progress_seconds(const tc_progress *progress);

/* A say function of tc_source_options, context a tc_progress; may be called from any thread. */
void tc_progress_say(void *progress, bool warning, const char *line);

#endif
