/* rate_summary.h - our rates, errors and speeds against those of the other codecs, from the rows of one run. */
#ifndef RATE_SUMMARY_H
#define RATE_SUMMARY_H

#include "coders.h"

/* One encoding of one terrain, measured. */
typedef struct rate_row {
    int terrain; /* counted from 0 */
    const coder *coder;
    coder_goal goal;
    double bits;           /* a sample */
    double rms, max;       /* metres */
    double encode, decode; /* million samples a second of processor time */
    double roi;            /* milliseconds; NAN where the terrain is smaller than the region */
} rate_row;

/* Ours, which the others are held against. */
#define RATE_OURS "terraclip"

/* Prints a table by terrain and codec, and the median over terrains by codec. names: of the terrains. */
void rate_summary(const rate_row *rows, int count, const char *const *names, int terrains);

#endif
