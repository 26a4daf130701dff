/* error_stats.h - root mean square, percentile and maximum of many errors, in one pass. */
#ifndef TC_ERROR_STATS_H
#define TC_ERROR_STATS_H

#include "common/terraclip.h"

enum { TC_ERROR_BINS = 1 << 17 };

/* Sums and a histogram by the leading bits of the float: percentiles are exact to 1/512 of themselves. */
typedef struct tc_error_stats {
    int64_t count;
    double sum_squares, max;
    int64_t *bins; /* TC_ERROR_BINS, owned */
} tc_error_stats;

tc_status tc_error_stats_init(tc_error_stats *stats);
void tc_error_stats_free(tc_error_stats *stats);
void tc_error_stats_add(tc_error_stats *stats, double error);
void tc_error_stats_merge(tc_error_stats *into, const tc_error_stats *from);

/* How many are above a limit, to 1/512 of it. */
int64_t tc_error_stats_above(const tc_error_stats *stats, float limit);

double tc_error_stats_rms(const tc_error_stats *stats);
/* The error that `fraction` of all errors do not exceed (0.999: the 99.9th percentile). */
double tc_error_stats_percentile(const tc_error_stats *stats, double fraction);

#endif
