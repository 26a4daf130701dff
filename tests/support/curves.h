/* curves.h - bits against error of a codec, from some points of its curve. */
#ifndef CURVES_H
#define CURVES_H

typedef struct curve_point {
    double bits; /* a sample */
    double rms;  /* metres */
} curve_point;

/* Bits where the straight line through two points, in logarithms of both, has this rms. */
double curve_between(curve_point a, curve_point b, double rms);

/* Bits at which a codec has this rms, between the two points (in any order) nearest to it on either side; NAN where it
 * has none on one. Points without error, which have no logarithm, do not count. */
double curve_bits(const curve_point *points, int count, double rms);

#endif
