/* extreme.c - the rows of `make test-extreme`. */
#include "extreme.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "made_files.h"

static struct {
    const char *family;
    FILE *csv;
    int passed, failed, skipped;
} run;

/* A field that may hold commas and quotes; line ends become spaces. */
static void put_quoted(const char *text)
{
    fputc('"', run.csv);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', run.csv);
        fputc(*text == '\n' ? ' ' : *text, run.csv);
    }
    fputc('"', run.csv);
}

static void row(const char *name, const char *figure, const char *value, const char *limit, const char *verdict,
                const char *note)
{
    printf("%s | %s | %s | %s | %s | %s%s%s\n", run.family, name, figure, value, limit, verdict, *note ? " | " : "",
           note);
    fflush(stdout);
    if (!run.csv)
        return;
    const char *const fields[] = {run.family, name, figure, value, limit, verdict, note};
    for (int i = 0; i < 7; i++) {
        if (i)
            fputc(',', run.csv);
        put_quoted(fields[i]);
    }
    fputc('\n', run.csv);
}

void extreme_begin(const char *family)
{
    run.family = family;
    const char *folder = getenv("TERRACLIP_EXTREME");
    if (!folder || !*folder)
        return;
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.csv", folder, family);
    run.csv = fopen(path, "w");
    if (!run.csv) {
        fprintf(stderr, "%s: cannot be written\n", path);
        exit(1);
    }
    fputs("family,case,figure,value,limit,verdict,note\n", run.csv);
}

void extreme_at_most(const char *name, const char *figure, double value, double limit, const char *note, ...)
{
    char text[1024], number[32], most[32];
    va_list arguments;
    va_start(arguments, note);
    vsnprintf(text, sizeof text, note, arguments);
    va_end(arguments);
    bool passed = value <= limit;
    snprintf(number, sizeof number, "%.6g", value);
    snprintf(most, sizeof most, "%.6g", limit);
    row(name, figure, number, most, passed ? "passed" : "FAILED", text);
    run.passed += passed;
    run.failed += !passed;
}

double extreme_of(int64_t count, double value)
{
    return count > 0 ? value : NAN;
}

void extreme_refused(const char *name, tc_status status, tc_status expected, const char *text)
{
    bool passed = status == expected && *text && !strchr(text, '\n');
    row(name, "refused", tc_status_text(status), tc_status_text(expected), passed ? "refused" : "FAILED",
        made_name(text));
    run.passed += passed;
    run.failed += !passed;
}

void extreme_skipped(const char *name, const char *why)
{
    row(name, "", "", "", "skipped", why);
    run.skipped++;
}

int extreme_end(void)
{
    printf("%s: %d passed, %d failed, %d skipped\n", run.family, run.passed, run.failed, run.skipped);
    if (run.csv && (ferror(run.csv) || fclose(run.csv))) {
        fprintf(stderr, "%s: the table could not be written\n", run.family);
        return 1;
    }
    return run.failed || !run.passed;
}
