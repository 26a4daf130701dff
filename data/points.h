/* points.h - lists of points, one a line, as people, spreadsheets and GPS tools write them.
 *
 * A line begins with two numbers, with blanks, a comma or a semicolon between; further columns are left alone. Empty
 * lines, lines that begin with # and a first line of words, which names the columns, hold no point. */
#ifndef TC_POINTS_H
#define TC_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct tc_points {
    FILE *file;
    char *text;     /* the line, without its end */
    int64_t number; /* of the line, from 1 */
    size_t room;
    bool begun; /* a line that may name the columns is behind */
} tc_points;

typedef enum tc_points_line { TC_POINTS_END, TC_POINTS_POINT, TC_POINTS_BAD } tc_points_line;

/* Reads on to the next line that holds a point or should. Begins with {.file = file}; free(text) at the end. */
tc_points_line tc_points_next(tc_points *points, double *x, double *y);

#endif
