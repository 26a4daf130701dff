/* say.c - what a source tells its user; the programs and the plugins each have it. */
#include "source.h"

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
