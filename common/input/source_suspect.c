/* source_suspect.c - values that are taken for heights and may stand for none, since nothing in the file says so: they
 * are told, with the option that declares them. */
#include <math.h>

#include "source_internal.h"

/* Lowest heights that stand for "none" where a file says so, and often where it forgot to. */
static void suspect_lowest(tc_suspicion *s, const tc_conversion *c, float lowest, const tc_source_options *options)
{
    static const double suspects[] = {-9999, -32768, -32767, -99999};
    double stored = tc_stored_value(lowest, c->offset, c->scale);
    for (size_t i = 0; i < sizeof suspects / sizeof *suspects && !s->told_lowest; i++)
        if (fabs(stored - suspects[i]) < 1e-3) {
            s->told_lowest = true;
            tc_say(options, true,
                   "its lowest value, %.6g, is taken for a height; where it means none, --nodata %.6g says so",
                   suspects[i], suspects[i]);
        }
}

/* Zeros below all other heights: of a coast the next height is near, of what fills a gap or a frame it is not. */
void tc_suspect_row(tc_suspicion *s, const tc_conversion *c, const float *z, const uint8_t *voids, int64_t width,
                    const tc_statistics *statistics)
{
    const double coast = 10; /* stored units */
    float zero = (float)c->offset, lowest = statistics->low;
    if (s->no_zeros)
        return;
    s->highest = fmaxf(s->highest, statistics->high);
    s->no_zeros |= lowest < zero || !(c->scale > 0);
    if (s->no_zeros)
        return;
    if (lowest > zero) { /* none so far */
        s->next = fminf(s->next, lowest);
    } else {
        for (int64_t i = 0; i < width; i++) {
            s->zeros += z[i] == zero && !voids[i];
            s->next = z[i] > zero && !voids[i] && z[i] < s->next ? z[i] : s->next;
        }
    }
    s->no_zeros |= s->next <= zero + coast * c->scale;
}

static void tell_zeros(tc_suspicion *s, const tc_conversion *c, const tc_source_options *options)
{
    enum { LEAST_ZEROS = 16 };
    const double least_gap = 0.02; /* of the relief */
    double zero = (float)c->offset, gap = (double)s->next - zero;
    if (s->no_zeros || s->zeros < LEAST_ZEROS || !(s->next < INFINITY) ||
        !(gap >= least_gap * ((double)s->highest - zero)))
        return;
    tc_say(options, true,
           "%lld of its values are 0, and no other is below %.6g: taken for heights; where they mean none, --nodata 0 "
           "says so",
           (long long)s->zeros, tc_stored_value(s->next, c->offset, c->scale));
}

void tc_suspect_rows(tc_suspicion *s, const tc_conversion *c, int64_t rows, int64_t height,
                     const tc_statistics *statistics, const tc_source_options *options)
{
    if (statistics->low <= statistics->high)
        suspect_lowest(s, c, statistics->low, options);
    if (statistics->fills > 0 && !s->told_fills) {
        s->told_fills = true;
        tc_say(options, true, "values beyond 1e30 are taken as voids, though no nodata value announces them");
    }
    s->rows += rows;
    if (s->rows >= height && !s->told_zeros) {
        s->told_zeros = true;
        tell_zeros(s, c, options);
    }
}
