/* codec_fit.h - the numbers behind training: linear least squares, and the scales of magnitudes. Nothing here
 * allocates; all functions are thread-safe. */
#ifndef TC_CODEC_FIT_H
#define TC_CODEC_FIT_H

#include <stddef.h>

#include "detail_model.h"

enum {
    TC_FIT_COLUMNS = TC_SCALE, /* unknowns at most */
    TC_SOLVE_MOST = 64,        /* and of any equations */
    TC_FIT_STRANDS = 8         /* coefficients that are summed side by side */
};

/* Normal equations, the right side in the last column. */
typedef struct tc_normal {
    double a[TC_FIT_COLUMNS][TC_FIT_COLUMNS + 1];
} tc_normal;

/* Adds one equation: `truth` is to be the sum of count weights times term[], whose numbers are two's complements. */
void tc_normal_add(tc_normal *n, const uint32_t *term, int count, double truth);

/* Adds the equations of another. */
void tc_normal_join(tc_normal *n, const tc_normal *other);

/* Solves `count` equations, at most TC_SOLVE_MOST, by elimination with pivots; a slight ridge keeps what the data does
 * not say at zero. a: rows of stride numbers, the last of them the right side; overwritten. */
void tc_solve_normal(double *a, ptrdiff_t stride, int count, double x[]);

/* The same of *n. */
void tc_normal_solve(tc_normal *n, int count, double x[]);

/* Features of some coefficients, and last their magnitudes; where there is no coefficient all is zero. */
typedef struct tc_strands {
    float of[TC_SCALE + 1][TC_FIT_STRANDS];
} tc_strands;

/* Goes from the weights of one phase of a band to those of its features, `count` of them side by side. */
void tc_fit_scale(const tc_strands *feature, int64_t count, uint16_t weight[TC_SCALE]);

#endif
