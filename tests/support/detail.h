/* detail.h - what a level adds to the upsampled coarser one, measured: how it lies on slopes and along them. */
#ifndef DETAIL_H
#define DETAIL_H

#include "common/synthesis/synthesis.h"

enum { DETAIL_DECILES = 10, DETAIL_SCALES = 5 };

typedef struct detail_figures {
    double rms;                    /* metres */
    double decile[DETAIL_DECILES]; /* rms by decile of the coarser level's slope, relative to the whole */
    double kurtosis;               /* of the detail */
    double anisotropy;             /* energy of its gradient across the slope over along it, locally normalised */
    double spectrum; /* exponent of the radial power spectrum of heights, over the level's upper octaves */
} detail_figures;

/* Of level `level` of `field`, at most within its first `side` samples both ways; `slopes` is the field whose level
 * below tells slopes and what is void (of the same sizes there). */
detail_figures detail_measure(const tc_field *field, const tc_field *slopes, int level, int64_t side);

/* Mean and largest |log2| of two rows of deciles' ratio. */
void detail_compare(const detail_figures *a, const detail_figures *b, double *mean_ret, double *worst_ret);

/* How detail is made. */
typedef enum detail_kind {
    DETAIL_FITTED,
    DETAIL_GAUSSIAN, /* one a level, as LH04 */
    DETAIL_NONE      /* U alone */
} detail_kind;

/* A field with its finest levels dropped and made again from what is left, to which *fit is fitted. */
tc_field *detail_synthesise(const tc_field *field, int dropped, detail_kind kind, tc_synthesis_fit *fit);

#endif
