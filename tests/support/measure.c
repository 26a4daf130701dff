/* measure.c - what benchmarks have in common. */
#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double measure_quantile(const double *values, int count, double q)
{
    if (count <= 0)
        return NAN;
    double at = q * (count - 1);
    int i = (int)at;
    return i + 1 < count ? values[i] + (at - i) * (values[i + 1] - values[i]) : values[count - 1];
}

measure_spread measure_of(double *values, int count)
{
    if (count <= 0)
        return (measure_spread){NAN, NAN, NAN, 0};
    qsort(values, (size_t)count, sizeof *values, by_value);
    return (measure_spread){measure_quantile(values, count, 0.5), measure_quantile(values, count, 0.1),
                            measure_quantile(values, count, 0.9), count};
}

static FILE *begin_table(const char *path, const char *header)
{
    FILE *f = fopen(path, "w");
    if (!f) {
        fprintf(stderr, "measure: %s: cannot be written\n", path);
        exit(1);
    }
    fprintf(f, "%s\n", header);
    return f;
}

measure_options measure_begin(int argc, char **argv, const char *header)
{
    measure_options o = {0};
    const char *file = NULL;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) {
            o.quick = true;
        } else if (strcmp(argv[i], "--csv") == 0 && i + 1 < argc) {
            file = argv[++i];
        } else {
            fprintf(stderr, "%s: %s: expected [--quick] [--csv FILE]\n", argv[0], argv[i]);
            exit(2);
        }
    }
    o.path = file;
    if (file)
        o.csv = begin_table(file, header);
    return o;
}

FILE *measure_beside(const measure_options *options, const char *name, const char *header)
{
    if (!options->csv)
        return NULL;
    char path[4096];
    const char *slash = strrchr(options->path, '/');
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash - options->path + 1) : 0, options->path, name);
    return begin_table(path, header);
}

void measure_put_text(FILE *csv, const char *text)
{
    if (!strpbrk(text, ",\"\n\r")) {
        fputs(text, csv);
        return;
    }
    fputc('"', csv);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', csv);
        fputc(*text == '\n' || *text == '\r' ? ' ' : *text, csv);
    }
    fputc('"', csv);
}

int measure_end(measure_options *options)
{
    bool failed = options->csv && (ferror(options->csv) || fclose(options->csv));
    options->csv = NULL;
    if (failed)
        fputs("measure: the table could not be written\n", stderr);
    return failed ? 1 : 0;
}
