/* measure.h - what benchmarks have in common: their command line, medians with spread, and files of figures. */
#ifndef MEASURE_H
#define MEASURE_H

#include <stdbool.h>
#include <stdio.h>

/* Median with spread of repeated measurements: a tenth lies below `low`, a tenth above `high`. */
typedef struct measure_spread {
    double median, low, high;
    int count;
} measure_spread;

/* Of values in any order, which it sorts; all NAN where there is none. */
measure_spread measure_of(double *values, int count);

/* What a share q of them lies below, interpolated, of values that are sorted; NAN where there is none. */
double measure_quantile(const double *values, int count, double q);

/* bench_NAME [--quick] [--csv FILE]: fewer and smaller measurements; a table for the report. */
typedef struct measure_options {
    bool quick;
    FILE *csv;        /* with its header written; NULL: not asked for */
    const char *path; /* of it */
} measure_options;

/* Reads the command line; header: the CSV's first line, without its end. Other arguments, or a file that cannot be
 * written, end the program with a line on stderr and exit code 2 or 1. */
measure_options measure_begin(int argc, char **argv, const char *header);

/* One more table in the folder of the first; NULL where that was not asked for. Closed as a FILE. */
FILE *measure_beside(const measure_options *options, const char *name, const char *header);

/* A field of such a table: quoted where it holds what a table minds. */
void measure_put_text(FILE *csv, const char *text);

/* Closes the file. The program's exit code: 1, with a line on stderr, where a row could not be written. */
int measure_end(measure_options *options);

#endif
