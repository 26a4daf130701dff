/* synthesis.h - heights finer than the data: levels beyond a field's finest one, made by decoding noise with what the
 * terrain's own levels tell of its detail (LH04 section 8 adds Gaussian noise of one variance a level).
 *
 * Level m + k comes from level m + k - 1 by the inverse of the pyramid's lifting (filter.h): D of it is that level
 * again, but for what is flat and what is cut to the terrain's range. Its details are
 *     d_b = A n_b + p_b          b: high in x, in y, in both
 * where A is local: log2 A^2 = a_k + b_k log2 E + c_k log2 S with the energy E of level m's own detail and its squared
 * slope S around; n_b is white noise smeared along or across the slope, and p_b what curvature foretells. All of it is
 * fitted to the terrain's two finest levels (synthesis_fit.c).
 *
 * Noise is a hash of (seed, chart, level, i, j) and arithmetic is that of IEEE numbers in one order, without those of the
 * C library's functions that differ (common/base/same_math.h): a height is the same on every machine, in whatever
 * rectangle and on whatever thread it is read. Areas of 3 x 3 equal samples stay as they are, and so does what touches
 * them. */
#ifndef TC_SYNTHESIS_H
#define TC_SYNTHESIS_H

#include "common/field/field.h"

/* Bands of details: high along x, along y, along both. */
enum { TC_HIGH_X, TC_HIGH_Y, TC_HIGH_XY, TC_DETAIL_BANDS };

/* How a terrain's detail goes from level to level. */
typedef struct tc_synthesis_fit {
    bool none;                       /* there is nothing to learn from, or no detail: levels are upsampled alone */
    float energy_floor, slope_floor; /* square metres; squares of slopes: added before logarithms are taken */
    struct {
        float a, b, c; /* of log2 A^2 */
        float cap;     /* metres, of A */
    } level[TC_SYNTHESIS_MOST];
    float band[TC_DETAIL_BANDS]; /* of the bands' noise, in A */
    float curvature[2];          /* shares of the second and of the sixth difference in a detail high along one axis */
    float spread;   /* of neighbours in the noise, along the axis that a band is low on; negative along the other */
    float smear;    /* -1 .. 1: along the slope, negative across it */
    float peak;     /* n + peak n^3 has the kurtosis of the terrain's own detail */
    double spacing; /* metres, of level m */
    double rms[3];  /* metres, of the details of levels m - 2, m - 1, m */
    double ratio;   /* of a level's rms to the next finer one's, from these */
    double anisotropy, kurtosis; /* of level m's detail, normalised: across the slope over along it; measured */
} tc_synthesis_fit;

/* Fits to what the field has; of a large one to samples of it. Reads it. */
tc_status tc_synthesis_learn(const tc_field *field, tc_synthesis_fit *fit_ret, tc_error *error);

/* One Gaussian a level, as LH04: the same rms as the fit's, everywhere. */
void tc_synthesis_uniform(tc_synthesis_fit *fit);

/* Factor of the noise at a sample of level m: where charts share a place. */
typedef struct tc_synthesis_share {
    float (*of)(const void *context, double i, double j);
    const void *context; /* lives as long as the field */
} tc_synthesis_share;

/* A field with `levels` more levels than `field`, which it takes over, also on failure. chart: of the map, a part of
 * what is hashed. share.of may be NULL. Reading is thread-safe. */
tc_status tc_synthesis_create(tc_field *field, int levels, const tc_synthesis_fit *fit, int chart,
                              tc_synthesis_share share, tc_field **field_ret, tc_error *error);

#endif
