/* status.c - statuses in words and as exit codes. */
#include "status.h"

#include <stdarg.h>
#include <stdio.h>

const char *tc_status_text(tc_status status)
{
    switch (status) {
    case TC_OK: return "done";
    case TC_ERR_USAGE: return "wrong usage";
    case TC_ERR_MEMORY: return "not enough memory";
    case TC_ERR_IO: return "input or output failed";
    case TC_ERR_FORMAT: return "damaged or unexpected content";
    case TC_ERR_UNSUPPORTED: return "not supported";
    case TC_ERR_CONTEXT: return "no usable display or OpenGL context";
    }
    return "unknown status";
}

int tc_exit_code(tc_status status)
{
    return status == TC_OK ? 0 : status == TC_ERR_USAGE ? 2 : 1;
}

const char *tc_version(void)
{
    return TC_VERSION;
}

tc_status tc_fail(tc_error *error, tc_status status, const char *format, ...)
{
    if (error) {
        error->status = status;
        va_list args;
        va_start(args, format);
        vsnprintf(error->text, sizeof error->text, format, args);
        va_end(args);
        /* One line, whatever a library or a file name brought along. */
        for (char *c = error->text; *c; c++)
            if (*c == '\n' || *c == '\r')
                *c = ' ';
    }
    return status;
}
