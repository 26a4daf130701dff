/* same_math.h - functions that give the same bits on every machine, which a C library's do not: + - * / of doubles in
 * one order, to a few units in the last place. For what heights follow from. */
#ifndef TC_SAME_MATH_H
#define TC_SAME_MATH_H

#include <math.h>

/* The sum of the first count terms of a power series, c[0] + c[1] x + ... */
static inline double tc_series(const double *c, int count, double x)
{
    double sum = c[count - 1];
    for (int k = count - 2; k >= 0; k--)
        sum = sum * x + c[k];
    return sum;
}

/* Logarithm to the base 2: of the odd powers of (m - 1) / (m + 1), m within a factor sqrt(2) of 1. */
static inline double tc_log2(double v)
{
    static const double c[] = {1,        1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,  1.0 / 11,
                               1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21, 1.0 / 23};
    int e;
    if (!(v > 0) || isinf(v))
        return v == 0 ? -INFINITY : v > 0 ? v : NAN;
    double m = frexp(v, &e);
    if (m < 0.70710678118654752)
        m *= 2, e--;
    double s = (m - 1) / (m + 1);
    return e + 2.8853900817779268 * (s * tc_series(c, sizeof c / sizeof *c, s * s)); /* 2 / log(2) */
}

/* 2 to a power. */
static inline double tc_exp2(double v)
{
    static const double c[] = {
        1,          1,           1.0 / 2,      1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,
        1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1 / 3628800., 1 / 39916800., 1 / 479001600., 1 / 6227020800.};
    if (!(fabs(v) < 1100))
        return v > 0 ? INFINITY : v < 0 ? 0 : v;
    double whole = floor(v + 0.5);
    return ldexp(tc_series(c, sizeof c / sizeof *c, 0.69314718055994531 * (v - whole)), (int)whole);
}

/* Sine of an angle of a quarter turn at most; somewhat beyond it is still good to 1e-15. */
static inline double tc_sine(double x)
{
    static const double c[] = {1,
                               -1.0 / 6,
                               1.0 / 120,
                               -1.0 / 5040,
                               1.0 / 362880,
                               -1.0 / 39916800,
                               1.0 / 6227020800,
                               -1.0 / 1307674368000,
                               1.0 / 355687428096000,
                               -1.0 / 121645100408832000,
                               1.0 / 51090942171709440000.,
                               -1.0 / 25852016738884976640000.,
                               1.0 / 15511210043330985984000000.};
    return x * tc_series(c, sizeof c / sizeof *c, x * x);
}

#endif
