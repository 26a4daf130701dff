/* say.c - what a source tells its user; the programs and the plugins each have it. */
#include "source.h"

#include "common/base/status.h"

#include <stdarg.h>
#include <stdio.h>

void tc_say(const tc_source_options *options, bool warning, const char *format, ...)
{
    if (!options->say)
        return;
    char line[512];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    options->say(options->say_context, warning, line);
}

tc_status tc_tell_progress(const tc_source_options *options, const char *what, double share, tc_error *error)
{
    return !options->progress || options->progress(options->progress_context, what, share)
               ? TC_OK
               : tc_fail(error, TC_ERR_IO, "interrupted");
}
