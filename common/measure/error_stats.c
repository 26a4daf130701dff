/* error_stats.c - one-pass statistics of errors. */
#include "error_stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The sign is 0; of the other 31 bits the leading 17 (8 of exponent, 9 of mantissa) choose the bin. */
enum { SHIFT = 31 - 17 };

tc_status tc_error_stats_init(tc_error_stats *stats)
{
    *stats = (tc_error_stats){.bins = calloc(TC_ERROR_BINS, sizeof *stats->bins)};
    return stats->bins ? TC_OK : TC_ERR_MEMORY;
}

void tc_error_stats_free(tc_error_stats *stats)
{
    free(stats->bins);
    stats->bins = NULL;
}

void tc_error_stats_add(tc_error_stats *stats, double error)
{
    float e = (float)fabs(error);
    uint32_t bits;
    memcpy(&bits, &e, sizeof bits);
    stats->bins[bits >> SHIFT]++;
    stats->count++;
    stats->sum_squares += error * error;
    if (fabs(error) > stats->max)
        stats->max = fabs(error);
}

void tc_error_stats_merge(tc_error_stats *into, const tc_error_stats *from)
{
    into->count += from->count;
    into->sum_squares += from->sum_squares;
    into->max = fmax(into->max, from->max);
    for (int i = 0; i < TC_ERROR_BINS; i++)
        into->bins[i] += from->bins[i];
}

int64_t tc_error_stats_above(const tc_error_stats *stats, float limit)
{
    int64_t above = 0;
    uint32_t bits;
    memcpy(&bits, &limit, sizeof bits);
    for (uint32_t i = (bits >> SHIFT) + 1; i < TC_ERROR_BINS; i++)
        above += stats->bins[i];
    return above;
}

double tc_error_stats_rms(const tc_error_stats *stats)
{
    return stats->count ? sqrt(stats->sum_squares / (double)stats->count) : 0;
}

double tc_error_stats_percentile(const tc_error_stats *stats, double fraction)
{
    int64_t seen = 0;
    double need = fraction * (double)stats->count;
    for (uint32_t i = 0; i < TC_ERROR_BINS && stats->count; i++) {
        seen += stats->bins[i];
        if ((double)seen >= need) { /* the bin's upper end, but nothing beyond the maximum */
            uint32_t bits = ((i + 1) << SHIFT) - 1;
            float upper;
            memcpy(&upper, &bits, sizeof upper);
            return fmin(upper, stats->max);
        }
    }
    return stats->max;
}
